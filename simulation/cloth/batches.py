"""Explicit steps on a GPU: some hundred launches in three graphs, which ask the host for nothing until a batch of steps is done.

Each vertex is expected to go on as it does for a batch of steps, and those pairs are listed that then come near. Where one strayed
farther from there than the list allows, or something had no room, the batch is taken back and done again, with fewer steps or more room.
What a launch adds up does not depend on the order of its threads, so that lists are in any order and results the same to the byte.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import F64, I64
from .. import sum_kernels as sums
from ..passes import ALONE, FEW
from . import batch_kernels as batch
from . import bound_kernels as bounds
from . import contact_kernels as contact
from . import list_kernels as lists
from . import near_kernels as near
from . import pace_kernels as pace
from . import step_kernels as steps
from .folds import OutranError
from .near_lists import Slots
from .near_part_kernels import LANES, later_ones, pick_pairs

if TYPE_CHECKING:
    from .contacts import Contacts
    from .forces import ClothForces

__all__ = ["Batches"]

AHEAD = 13
"""Most steps with the same lists."""
FAR = (0.6, 0.95, 1.3)
"""Reach of the search for them within sheets, in shortest edges: at least, at most, and in batches that are taken again. Half of it, less
the distance of contact, may be strayed. From 1 on all rows of a flat sheet are near the next ones."""
WIDER, CLOSER = 1.4, 0.95
"""Factors on how far one may stray where one went too far, and where none went half of it."""
QUANTUM = 2.0**-20
"""Quantum in which impulses on bodies add up, times the mass of all sheets [m/s]; parts of it are counted too (`contact_kernels.FINE`)."""
HEAD = 8
"""Places of the book before what bodies got: pairs with solids and within sheets, how far one strayed,
most of a triangle and near one, and pairs that press."""
NEAR = 64
"""Triangles that have room near each at first."""
BLOCK = 128
"""Threads of a block in the search among triangles that are near each other."""
THREADS = 1 << 17
"""Most threads that share the pairs: about as many as run at once."""
PRESSING = 1 << 13
"""Most threads that share those that press."""
LEAST = 256
"""Pairs of each sort that have room at first."""


class Batches:
    """Explicit steps of one run on a GPU.

    Args:
        arrays: what they move, and the forces on it.
        contacts: what it meets.
    """

    def __init__(self, arrays: ClothForces, contacts: Contacts) -> None:
        self._of, self._contacts = arrays, contacts
        e, of, wp = arrays, contacts, warp()
        zeros, device = wp.zeros, e.device
        self._weight = float(e.mass.sum())
        self._strays = [0.5 * (k * of.shortest - of.touch[0]) for k in FAR]
        self._quantum = QUANTUM * self._weight
        self._edges = wp.array(e.host_edges, dtype=wp.vec2i, device=device)
        self._lengths = wp.array(e.host_lengths, dtype=wp.float64, device=device)
        parts = e.passes.parts(max(e.n, len(e.host_edges)))
        self._partial = zeros((4, parts), dtype=wp.float64, device=device)
        self._found, self._aims = (zeros(12, dtype=wp.float64, device=device) for _ in range(2))
        self._momentum, self._most, self._stretch = self._found[:3], self._found[3:5], self._found[5:7]
        self._air, self._taken = self._found[8:12], zeros(4, dtype=wp.float64, device=device)
        self._kept = [tuple(zeros(n, dtype=wp.vec3d, device=device) for n in (e.total, e.n, e.total, e.n, e.n)) for _ in range(2)]
        self._part = zeros(e.n, dtype=wp.float64, device=device)
        self._many = zeros(e.total, dtype=wp.int32, device=device)
        self._sums = zeros(3 * e.total, dtype=wp.int64, device=device)
        self._allowed = zeros(1, dtype=wp.float64, device=device)
        self._felt = zeros(6 * (e.total - e.n) if of.soft else 1, dtype=wp.int64, device=device)
        self._leaned = zeros(6 * e.n if of.held_count else 1, dtype=wp.int64, device=device)
        self._book = zeros(HEAD + 14 * max(of.bodies, 1), dtype=wp.int64, device=device)
        self._given = self._book[HEAD:]
        self._own = Slots(device, of.sheet.count, NEAR, bare=True)
        self._rooms = [LEAST, LEAST]
        self.begin()
        self._ready: dict[str, Any] = {}
        self._refits = [s.tree.refit for s in (of.sheet, of.solid) if s is not None]
        self._make()

    def begin(self) -> None:
        """Forget how far vertices strayed, so that a run that goes on from a checkpoint has the batches and lists of one that took it."""
        self._stray, self._ahead = self._strays[0], AHEAD

    def _make(self) -> None:
        """Room for pairs: those with solids come first."""
        wp, room, device = warp(), sum(self._rooms), self._of.device
        self._pairs = wp.zeros(room, dtype=wp.vec4i, device=device)
        self._kinds = wp.zeros(room, dtype=wp.vec2i, device=device)
        self._share, self._normal = (wp.zeros(room, dtype=wp.vec4d, device=device) for _ in range(2))
        self._wanted, self._slack = (wp.zeros(room, dtype=wp.float64, device=device) for _ in range(2))
        self._pressing = wp.zeros(room, dtype=wp.int32, device=device)
        self._impulse = wp.zeros(room, dtype=wp.vec3d, device=device)

    # ------------------------------------------------------------------ launches

    def _graph(self, name: str, made: Callable[[], list[Any]]) -> Any:
        """The chain of this name, of passes that are made where room has changed."""
        if name not in self._ready:
            self._ready[name] = self._of.passes.chain(name, made())
        return self._ready[name]

    def _look(self) -> list[Any]:
        """Passes that find the mean velocity, the greatest speed against it, the greatest acceleration by air and fields, and how edges are stretched;
        and keep the moment."""
        e, p, count = self._of, self._of.passes, len(self._of.host_edges)
        gravity = warp().vec3d(*e.setup.gravity)
        return [
            *e.airing(), self._keeps(0),
            p.fold("drifts", pace.drifts, e.n, [e.masses, e.v, self._partial]),
            p.close("drifts_close", sums.close, e.n, [self._partial[:3], self._momentum]),
            p.fold("fastest", pace.fastest, e.n, [self._weight, self._momentum, e.v, e.acceleration, gravity, self._contacts.drift, self._partial]),
            p.close("fastest_close", pace.close_most, e.n, [self._partial, self._most]),
            p.fold("stretches", pace.stretches, count, [e.x, self._edges, self._lengths, self._partial]),
            p.close("stretches_close", pace.close_most, count, [self._partial, self._stretch]),
        ]  # fmt: skip

    def _keeps(self, level: int) -> Any:
        e = self._of
        arrays = [e.n, *self._changing(), *self._kept[level]]
        return e.passes(f"keep_{level}", batch.keep, e.total, arrays)

    def _changing(self) -> tuple[Any, ...]:
        e = self._of
        return e.x, e.v, e.u, e.reaction, self._contacts.held_back

    def _back(self, level: int) -> None:
        """Take back all steps since `_look` (0) or the last batch (1)."""
        e = self._of
        e.passes(f"back_{level}", batch.keep, e.total, [e.n, *self._kept[level], *self._changing()])()
        self._felt.zero_()
        self._leaned.zero_()

    def _search(self) -> list[Any]:
        """Passes that begin a batch and look for pairs."""
        e, of, p = self._of, self._contacts, self._of.passes
        places = max(e.total, len(self._book))
        made = [
            self._keeps(1),
            p("begin", batch.begin, places, [e.n, self._aims, e.x, e.v, e.clock, of.reach, of.span, self._allowed, of.anchor, of.plan, e.u, self._part,
              self._many, self._sums, self._book]),
        ]  # fmt: skip
        if e.led_count:
            made += [e.lead(), p("expect", batch.expect, e.n, [e.u, of.plan])]
        fit, s, own = (e.x, e.u, of.span), of.sheet, self._own
        into = [self._pairs, self._kinds, self._slack, self._book]
        if of.self_collision:
            made += [
                p("boxes", near.boxes, s.count, [*fit, of.drift, s.faces, s.lower, s.upper, s.spread]), self._refits[0],
                p("later_ones", later_ones, s.count, [s.tree.id, s.lower, s.upper, of.reach, own.room, own.found, own.others, self._book], block=FEW),
                p("pick_pairs", pick_pairs, LANES * s.count,
                  [LANES, own.room, *self._rooms, e.x, e.u, of.span, s.faces, of.kin, s.owned, s.spread, of.reach, own.found, own.others, *into],
                  smallest=ALONE, block=BLOCK),
            ]  # fmt: skip
        if of.solid is not None:
            o, solid = of.others, of.solid
            made += [
                p("boxes_lab", near.boxes, s.count, [*fit, of.none, s.faces, s.lower, s.upper, s.spread]),
                p("solid_boxes", near.boxes, solid.count, [*fit, of.none, solid.faces, solid.lower, solid.upper, solid.spread]),
                self._refits[1], of.near_solids(*fit),
                p("gather_solids", lists.gather, s.count,
                  [o.room, self._rooms[0], o.found, o.pairs, o.kinds, *into], smallest=ALONE),
            ]  # fmt: skip
        return made

    def _step(self) -> list[Any]:
        """Passes of one step."""
        e, of, p = self._of, self._contacts, self._of.passes
        if not of.active:
            return [*e.forces(), p("stride", bounds.stride, e.n, [e.clock, e.u, e.x, e.v]), p("tick", steps.tick, 1, [e.clock])]
        pairs, inverse = (self._pairs, self._kinds), e.inverse
        met = (self._share, self._normal, self._wanted, self._impulse)
        threads, few = (min(len(self._slack), k) for k in (THREADS, PRESSING))

        def over(name: str, kernel: Any, inputs: list[Any]) -> Any:
            """The pass of a kernel over all pairs that are listed."""
            return p(name, kernel, threads, [threads, self._book, *self._rooms, *inputs], smallest=ALONE)

        def over_pressing(name: str, kernel: Any, inputs: list[Any]) -> Any:
            """The pass of a kernel over those that press."""
            return p(name, kernel, few, [few, self._book, self._pressing, *inputs], smallest=ALONE, block=FEW)

        made = [
            *e.forces(),
            over(
                "meet",
                contact.meet,
                [e.n, e.x, e.v, e.u, of.state["radius"], *pairs, e.clock, *met, self._slack, self._many, self._pressing],
            ),
        ]
        press = over_pressing("press", contact.press, [inverse, self._many, e.u, *pairs, of.friction, *met, self._sums])
        made += [press, p("give_way", contact.give_way, e.total, [self._sums, e.u], block=FEW)] * of.iterations
        bodies = (of.state["center"], of.state["velocity"], e.clock, self._given, self._felt, self._leaned)
        if of.solid is not None or of.held_count:
            what = [
                e.n,
                int(of.held_count > 0),
                int(of.soft),
                self._quantum,
                e.x,
                e.u,
                inverse,
                *pairs,
                self._share,
                self._impulse,
            ]
            made.append(over_pressing("tell", contact.tell, [*what, *bodies]))
        made += [
            over("bound", bounds.bound, [e.n, e.x, e.u, inverse, of.state["radius"], *pairs, *met[:3], e.clock, self._part, self._sums]),
            p("move", bounds.move, e.total, [e.n, int(e.carries), e.clock, e.masses, inverse, of.anchor, of.plan, self._allowed, e.u, e.x, e.v,
              of.held_back, self._part, self._sums, self._many, self._book], block=FEW),
        ]  # fmt: skip
        return made

    # ------------------------------------------------------------------ step

    def look(self) -> tuple[float, float, float, tuple[float, float]]:
        """Keep the moment, and look at it: the greatest speed against the mean velocity [m/s], the greatest acceleration by air and fields
        [m/s^2], that mean velocity's size [m/s], and the greatest and least length of edges over that at rest."""
        self._graph("look", self._look)()
        found = self._found.numpy()
        drift = float(np.linalg.norm(found[:3])) / self._weight
        return math.sqrt(found[3]), math.sqrt(found[4]), drift, (float(found[5]), float(-found[6]))

    def take_back(self) -> None:
        """Take back all steps since `look`."""
        self._back(0)

    def finish(self) -> None:
        """Count what air and fields gave since `look`, for `take_air`."""
        self._graph("finish", self._finish)()

    def take_air(self, span: float) -> F64:
        """Momentum [N s] and energy [J] that air and fields gave in all parts of `span` seconds, from `look` to `finish`, since the last call, (4,)."""
        force = self._taken.numpy().copy()
        self._taken.zero_()
        return np.array([*(force[:3] * span), force[3]])

    def _finish(self) -> list[Any]:
        """Passes that find what air and fields gave."""
        e, p = self._of, self._of.passes
        gravity = warp().vec3d(*e.setup.gravity)
        return [
            p.fold("airs", pace.airs, e.n, [e.masses, e.acceleration, gravity, e.x, self._kept[0][0], self._partial]),
            p.close("airs_close", sums.close, e.n, [self._partial, self._air]),
            p("add", pace.add, 4, [self._air, self._taken]),
        ]

    def run(self, dt: float, count: int, since: float) -> F64:
        """Take `count` steps, the first of them `since` seconds after bodies' states were given; impulses given to the bodies by contact
        (b, 6).

        Raises:
            OutranError: a vertex outran the search for contacts in a single step.
        """
        e, of = self._of, self._contacts
        total, done = np.zeros((len(e.setup.boundaries), 6)), 0
        felt = of.books()
        while done < count:
            each = min(self._ahead, count - done)
            reach = (k + 2 * self._stray for k in of.touch)
            self._aims.assign(np.array([dt, since + done * dt, *reach, each * dt, self._stray, *([0.0] * 6)]))
            self._graph("search", self._search)()
            step = self._graph("step", self._step)
            for _ in range(each):
                step()
            book = self._book.numpy()
            if not self._fits(book):
                self._back(1)
                continue
            strayed, (least, most, widest) = int(book[2]), self._strays
            if strayed <= 1000:
                total += self._told(book)
                done += each
                self._stray = min(max(self._stray * (1.0 if strayed else CLOSER), least), most)
                self._ahead = self._ahead if strayed else min(2 * self._ahead, AHEAD)
                continue
            if self._stray == widest and each == 1:
                of.reopen(felt)
                raise OutranError
            self._back(1)
            self._ahead = max(each // 2, 1) if self._stray == widest else self._ahead
            self._stray = min(WIDER * self._stray, widest)
        of.searches += 1
        return total

    def _fits(self, book: I64) -> bool:
        """True if all that was found had room; if not there is more from now on."""
        of, fits = self._contacts, True
        for slots, most in ((of.others, int(book[3])), (self._own, int(book[4]))):
            if most > slots.room:
                slots.widen(most)
                fits = False
        if book[0] > self._rooms[0] or book[1] > self._rooms[1]:
            self._rooms = [max(r, int(1.5 * k)) for r, k in zip(self._rooms, book[:2], strict=True)]
            self._make()
            fits = False
        if not fits:
            self._ready.clear()
        of.looked_at = int(book[0] + book[1])
        return fits

    def _told(self, book: I64) -> F64:
        """Impulses given to the bodies in a batch (b, 6); counts what soft ones felt, and what held vertices did."""
        e, of = self._of, self._contacts
        if of.held_count:
            e.passes("lean", contact.lean, of.held_count, [self._quantum, of.state["held"], self._leaned, e.reaction])()
        given = self._summed(book[HEAD:]).reshape(-1, 7)[: of.bodies]
        if of.soft:
            _, felt, work = of.soft_books()
            felt += self._summed(self._felt.numpy()).reshape(-1, 3)
            work += given[:, 6]
            self._felt.zero_()
        return given[:, :6]

    def _summed(self, sums: I64) -> F64:
        """Values of sums of whole and fine quanta."""
        two = sums.reshape(-1, 2).astype(np.float64)
        return np.asarray(self._quantum * (two[:, 0] + two[:, 1] / float(contact.FINE)))

    def solids_at(self, vertex: int) -> list[int]:
        """Rows of the bodies that a vertex of a sheet gets impulses from in the last step, those of its triangles' pairs included."""
        count = min(int(self._book.numpy()[0]), self._rooms[0])
        wanted, kind, corners = (a[:count].numpy() for a in (self._wanted, self._kinds, self._pairs))
        own = (wanted > -1e29) & (self._impulse[:count].numpy() != 0.0).any(axis=1) & (corners == vertex).any(axis=1)
        return sorted({int(k) for k in (kind[own, 0] - 2) // 4})

    def farthest(self) -> int:
        """The vertex that went farthest from where pairs were last looked for."""
        e = self._of
        return int(((e.x.numpy()[: e.n] - self._contacts.anchor.numpy()) ** 2).sum(1).argmax())
