"""Which vertices, edges and triangles are near each other, and what contacts gave."""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import cores, warp
from ...worlds.arrays import F64
from ..passes import Pass, Passes
from ..team import team
from . import end_kernels as ends
from . import list_kernels as lists
from . import near_kernels as near
from .near_lists import Slots, Surface, Surfaces
from .pick_kernels import bounds as bounds_of
from .pick_kernels import pick

if TYPE_CHECKING:
    from .setup import ClothSetup

__all__ = ["Contacts"]

FAR = 0.6
"""Reach of the search within sheets, in shortest edges: in a flat sheet nothing but neighbours lies within."""
SPARE = 0.6
"""Share of what may be moved until the lists no longer hold, after which they are made anew."""
FARTHEST = 2.5
"""Most reach of the search for solids in shortest edges."""


class Contacts:
    """Contacts of one run.

    Args:
        passes: where its kernels are kept.
        state: arrays of the engine by name (x, u, v, inverse, mass, radius, clock, held, reaction).
        surfaces: of the sheets and solids.
        friction: among sheets, then with each body.
        setup: whether sheets meet themselves and each other, and how many rounds of impulses there are.
        shortest: edge of the sheets [m].
        touch: largest distance of contact among sheets, and with solids [m].
        soft: whether vertices of solids move by themselves, so that what each got is counted.
    """

    def __init__(
        self,
        passes: Passes,
        state: dict[str, Any],
        surfaces: Surfaces,
        friction: F64,
        *,
        setup: ClothSetup,
        shortest: float,
        touch: tuple[float, float],
        soft: bool = False,
    ) -> None:
        wp, device = warp(), passes.device
        faces, sheet_vertices, solid_faces, solid_body, holder, kin = surfaces
        self.passes, self.state, self.n = passes, state, sheet_vertices
        self.self_collision, self.iterations = setup.self_collision, setup.iterations
        self.touch, self.shortest = touch, shortest
        self.sheet = Surface(faces, device)
        self.kin = wp.array(np.ascontiguousarray(kin[faces], dtype=np.int32), dtype=wp.vec3i, device=device)
        self.solid = Surface(solid_faces, device) if len(solid_faces) else None
        self.active = self.self_collision or self.solid is not None
        self.held_count = int((holder != -2).sum())
        self.body_of = wp.array(solid_body.astype(np.int32), dtype=wp.int32, device=device)
        self.holder = wp.array(holder.astype(np.int32), dtype=wp.int32, device=device)
        self.friction = wp.array(friction, dtype=wp.float64, device=device)
        self.bodies = len(friction) - 1
        self.soft, self._felt = soft, np.zeros((len(state["x"]) - sheet_vertices if soft else 0, 3))
        self._work_by_row = np.zeros(self.bodies)
        self._make_lists()
        self.anchor = wp.zeros(sheet_vertices, dtype=wp.vec3d, device=device)
        self.drift, self.none = (wp.zeros(1, dtype=wp.vec3d, device=device) for _ in range(2))
        self.plan = wp.zeros(sheet_vertices, dtype=wp.vec3d, device=device)
        self.span = wp.zeros(1, dtype=wp.float64, device=device)
        self.budget = wp.zeros(4, dtype=wp.float64, device=device)
        self.reach = wp.zeros(2, dtype=wp.float64, device=device)
        self.held_back = wp.zeros(sheet_vertices, dtype=wp.vec3d, device=device)
        # Trees are made of the first places, so that a run that goes on from a checkpoint walks them in the same order.
        self.sheet.fit(passes, "boxes", *self._moving(self.drift))
        if self.solid is not None:
            self.solid.fit(passes, "solid_boxes", *self._moving(self.none))
        self.fresh = False
        self.searches = 0
        self.solid_margin = 0.0
        self._grow(256)

    def _make_lists(self) -> None:
        """Room for what triangles find."""
        wp, device = warp(), self.passes.device
        self._nearby = Slots(device, self.sheet.count, 40, bare=True)
        self._box = np.empty((self.sheet.count, 6))
        self.own, self.others = Slots(device, self.sheet.count, 8), Slots(device, self.sheet.count, 16)
        self._all = wp.ones(self.sheet.count, dtype=wp.int32, device=device)
        self.count, self._room, self.looked_at = 0, 0, 0
        self._start = wp.zeros(self.n + 1, dtype=wp.int32, device=device)
        self._ranges = self._start[:-1], self._start[1:]
        self._over = wp.zeros(2, dtype=wp.int32, device=device)

    def _moving(self, drift: Any) -> tuple[Any, Any, Any, Any]:
        return self.state["x"], self.state["u"], self.span, drift

    def _grow(self, count: int) -> None:
        if count <= self._room:
            return
        wp, device = warp(), self.passes.device
        self._room = room = int(1.5 * count)
        self.pairs = wp.zeros(room, dtype=wp.vec4i, device=device)
        self.kinds = wp.zeros(room, dtype=wp.vec2i, device=device)
        self.share = wp.zeros(room, dtype=wp.vec4d, device=device)
        self.normal = wp.zeros(room, dtype=wp.vec4d, device=device)
        self.wanted = wp.zeros(room, dtype=wp.float64, device=device)
        self.impulse = wp.zeros(room, dtype=wp.vec3d, device=device)
        self.slack = wp.zeros(room, dtype=wp.float64, device=device)
        self.limit = wp.zeros(room, dtype=wp.vec4d, device=device)
        # Twice the room: sorting needs it.
        self._keys, self._items = (wp.zeros(8 * room, dtype=wp.int32, device=device) for _ in range(2))
        self.given, self.turned = (wp.zeros(room, dtype=wp.vec3d, device=device) for _ in range(2))

    # ------------------------------------------------------------------ search

    def margins(self, speed: float, drift: float) -> tuple[float, float]:
        """Distances that vertices may move until the lists of sheets and of solids no longer hold [m].

        Args:
            speed: fastest of the sheets' vertices against their mean velocity [m/s].
            drift: that mean velocity [m/s].
        """
        own = 0.5 * (FAR * self.shortest - self.touch[0])
        most = 0.5 * (FARTHEST * self.shortest - self.touch[1])
        return own, min(max(own * (1.0 + drift / max(speed, 1e-3)), own), most)

    def search(self, speed: float, drift: F64, span: float = 0.0) -> None:
        """Look for all pairs anew.

        Args:
            speed: fastest of the sheets' vertices against their mean velocity [m/s].
            drift: that mean velocity, (3,) [m/s].
            span: time [s] over which all are taken to go on as they move; pairs that could meet within are found too, and what counts
                from then on is how far vertices stray from there. 0: how far they move counts.
        """
        self._aim(speed, drift, span)
        found = list[Slots]()
        if self.self_collision:
            self.sheet.fit(self.passes, "boxes", *self._moving(self.drift))
            found.append(self.find_own(self.state["x"], self.state["u"], self.span))
        if self.solid is not None:
            if span > 0.0 or not self.self_collision:
                self.sheet.fit(self.passes, "boxes_lab", *self._moving(self.none))
            found.append(self.find_others(self.state["x"], self.state["u"], self.span))
        self._take(found)
        self.fresh = True
        self.searches += 1

    def find_own(self, places: Any, speeds: Any, span: Any, due: Any = None) -> Slots:
        """Pairs of sheets, by the triangles' bounds as they are; of those that are due, or all."""
        while True:
            self._pick(places, speeds, span, self._all if due is None else due)
            if self.own.fits():
                return self.own
            due = None

    def _pick(self, places: Any, speeds: Any, span: Any, due: Any) -> None:
        """Pairs of sheets on a CPU: near triangles first, then what of them is near."""
        s, o = self.sheet, self.own
        while True:
            inputs = [s.tree.id, s.lower, s.upper, self.reach, due, self._nearby.room, self._nearby.found, self._nearby.others]
            self.passes("near_ones", near.near_ones, s.count, inputs)()
            if self._nearby.fits():
                break
        x, faces = places.numpy(), s.faces.numpy()
        bounds_of(faces, x, self._box)
        rows = (
            due.numpy(), self._nearby.others.numpy(), self._nearby.found.numpy(), self._nearby.room, x, speeds.numpy(), float(span.numpy()[0]),
            float(self.reach.numpy()[0]), faces, self.kin.numpy(), s.owned.numpy(), s.spread.numpy(), self._box, o.found.numpy(), o.room,
            o.pairs.numpy(), o.kinds.numpy(),
        )  # fmt: skip
        cuts = [s.count * k // (4 * cores()) for k in range(4 * cores() + 1)]
        team(cores() - 1)([partial(pick, a, b, *rows) for a, b in pairwise(cuts)])

    def find_others(self, places: Any, speeds: Any, span: Any) -> Slots:
        """Pairs of sheets with solids, by the triangles' bounds as they are."""
        assert self.solid is not None
        self.solid.fit(self.passes, "solid_boxes", places, speeds, span, self.none)
        while True:
            self.near_solids(places, speeds, span)()
            if self.others.fits():
                return self.others

    def near_solids(self, places: Any, speeds: Any, span: Any) -> Pass:
        """The pass that finds them."""
        s, solid, o = self.sheet, self.solid, self.others
        assert solid is not None
        return self.passes(
            "near_solids", near.near_solids, s.count,
            [solid.tree.id, places, speeds, span, s.faces, s.owned, self.holder, s.lower, s.upper, s.spread, solid.faces,
             solid.owned, self.body_of, solid.spread, self.reach, o.room, o.found, o.pairs, o.kinds],
        )  # fmt: skip

    def _aim(self, speed: float, drift: F64, span: float) -> None:
        """Set how far is looked and how far vertices may move until the next search; arguments as `search`."""
        wp = warp()
        own, others = self.margins(speed, float(np.linalg.norm(drift)))
        far = 1e9
        if span > 0.0:
            others = own
            budget = [SPARE * own, far, own, far]
            wp.copy(self.plan, self.state["u"], count=self.n)
        else:
            within = own if self.self_collision else far
            away = others if self.solid else far
            budget = [SPARE * within, SPARE * away, within, away]
            self.plan.assign(np.tile(np.asarray(drift, dtype=np.float64), (self.n, 1)))
        self.reach.assign(np.array([self.touch[0] + 2 * own, self.touch[1] + 2 * others]))
        self.budget.assign(np.array(budget))
        self.span.assign(np.array([span]))
        self.drift.assign(np.asarray(drift, dtype=np.float64).reshape(1, 3))
        self.solid_margin = SPARE * others if span == 0.0 else far
        wp.copy(self.anchor, self.state["x"], count=self.n)

    def _take(self, found: list[Slots]) -> None:
        """Make lists of what was found, in the order of the triangles that found it."""
        totals = [slots.total() for slots in found]
        self.count = self.looked_at = sum(totals)
        self._grow(self.count)
        if self.count == 0:
            self._start.zero_()
            return
        p, corners, behind = self.passes, 4 * self.count, 0
        for slots, total in zip(found, totals, strict=True):
            inputs = [slots.room, behind, slots.found, slots.before, slots.pairs, slots.kinds, self.pairs, self.kinds]
            p("together", lists.together, slots.count, inputs)()
            behind += total
        p("by_vertex", ends.by_vertex, corners, [self.n, self.pairs, self._keys, self._items])()
        warp().utils.radix_sort_pairs(self._keys, self._items, corners)
        p("starts", ends.starts, self.n + 1, [corners, self._keys, self._start])()
        self._solids_from = totals[0] if self.self_collision else 0
        self.given.zero_()
        self.turned.zero_()
        self.slack.zero_()

    # ------------------------------------------------------------------ books

    def ends(self) -> list[Pass]:
        """Passes at the end of a step with contacts: what impulses gave to solids, and the move, cut short where anything would cross."""
        p, s, n, count, made = self.passes, self.state, self.n, self.count, []
        if count:
            if self.solid is not None:
                made.append(p("tell", ends.tell, count, [s["x"], self.pairs, self.kinds, self.share, self.wanted, self.impulse, s["center"], s["velocity"], s["clock"], self.given, self.turned]))  # fmt: skip
            made.append(p("bound", ends.bound, count, [s["x"], s["u"], s["inverse"], s["radius"], self.pairs, self.kinds, self.share, self.normal, self.wanted, s["clock"], self.limit]))  # fmt: skip
        made.append(
            p("move", ends.move, n, [s["clock"], *self._ranges, self._items, self.kinds, self.wanted, self.limit, self.normal, s["mass"],
              s["inverse"], self.anchor, self.plan, self.budget, s["u"], s["x"], s["v"], self.held_back, self._over])
        )  # fmt: skip
        return made

    def collect(self) -> F64:
        """Impulses given to the bodies in such steps since the last call, (b, 6)."""
        total = np.zeros((self.bodies, 6))
        if self.count == 0 or self.solid is None:
            return total
        own = slice(self._solids_from, self.count)
        if own.stop > own.start:
            rows = (self.kinds[own].numpy()[:, 0] - 2) // 4
            both = np.concatenate([self.given[own].numpy(), self.turned[own].numpy()], axis=1)
            for k in range(6):
                total[:, k] = np.bincount(rows, weights=both[:, k], minlength=self.bodies)
        self.given.zero_()
        self.turned.zero_()
        return total

    def soft_books(self) -> tuple[bool, F64, F64]:
        """True if vertices of solids move by themselves; what they got, and works on their bodies, to be added to."""
        return self.soft, self._felt, self._work_by_row

    def books(self) -> tuple[F64, F64]:
        """Impulses and works that soft bodies have felt so far, for `reopen`."""
        return self._felt.copy(), self._work_by_row.copy()

    def reopen(self, books: tuple[F64, F64]) -> None:
        """Forget what was found and given since these books; pairs are looked for anew."""
        self._felt[:], self._work_by_row[:] = books
        self.collect()
        self.fresh = False

    def felt_by_vertices(self) -> tuple[F64, F64]:
        """Impulses given to the vertices of solids by what was collected since the last call, (m, 3), and work on the solids (b,)."""
        found = self._felt.copy(), self._work_by_row.copy()
        self._felt[:], self._work_by_row[:] = 0.0, 0.0
        return found
