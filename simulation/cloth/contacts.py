"""Which vertices, edges and triangles are near each other, and the impulses between them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import F64, I32
from ..passes import Pass, Passes
from . import bound_kernels as bounds
from . import contact_kernels as contact
from . import list_kernels as lists
from . import near_kernels as near
from . import soft_kernels as softly

if TYPE_CHECKING:
    from .setup import ClothSetup

__all__ = ["Contacts", "Surfaces", "ownership"]

FAR = 0.6
"""Reach of the search within sheets, in shortest edges: in a flat sheet nothing but neighbours lies within."""
SPARE = 0.6
"""Share of what may be moved until the lists no longer hold, after which they are made anew."""
FARTHEST = 2.5
"""Most reach of the search for solids in shortest edges."""


def ownership(faces: I32) -> I32:
    """For each triangle bits of the vertices (1, 2, 4) and of the edges from vertex c to the next (8, 16, 32) that it stands for."""
    owned = np.zeros(len(faces), dtype=np.int32)
    flat = faces.ravel()
    _, first = np.unique(flat, return_index=True)
    np.bitwise_or.at(owned, first // 3, (1 << (first % 3)).astype(np.int32))
    ends = np.sort(np.stack([flat, np.roll(faces, -1, axis=1).ravel()], axis=1), axis=1)
    _, first = np.unique(ends[:, 0].astype(np.int64) * (int(flat.max(initial=0)) + 1) + ends[:, 1], return_index=True)
    np.bitwise_or.at(owned, first // 3, (8 << (first % 3)).astype(np.int32))
    return owned


class _Surface:
    """Triangles with their bounds and a tree over them."""

    def __init__(self, faces: I32, device: str) -> None:
        wp = warp()
        self.count = len(faces)
        self.faces = wp.array(np.ascontiguousarray(faces, dtype=np.int32), dtype=wp.vec3i, device=device)
        self.owned = wp.array(ownership(faces), dtype=wp.int32, device=device)
        self.lower = wp.zeros(self.count, dtype=wp.vec3, device=device)
        self.upper = wp.zeros(self.count, dtype=wp.vec3, device=device)
        self.tree: Any = None

    def fit(self, passes: Passes, name: str, x: Any, u: Any, span: Any, drift: Any) -> None:
        passes(name, near.boxes, self.count, [x, u, span, drift, self.faces, self.lower, self.upper])()
        if self.tree is None:
            self.tree = warp().Bvh(self.lower, self.upper)
        else:
            self.tree.refit()


class _Slots:
    """Room for what each triangle finds."""

    def __init__(self, count: int, room: int, device: str) -> None:
        self.count, self.room, self.device = count, room, device
        self._make()

    def _make(self) -> None:
        wp = warp()
        self.found, self.before = (wp.zeros(self.count, dtype=wp.int32, device=self.device) for _ in range(2))
        self.pairs = wp.zeros(self.count * self.room, dtype=wp.vec4i, device=self.device)
        self.kinds = wp.zeros(self.count * self.room, dtype=wp.vec2i, device=self.device)

    def fits(self) -> bool:
        """True if all found room; if not there is more from now on."""
        most = int(self.found.numpy().max(initial=0))
        if most <= self.room:
            return True
        self.room = int(1.5 * most) + 1
        self._make()
        return False

    def total(self) -> int:
        """Number of pairs found; where each triangle's begin among them is known from then on."""
        warp().utils.array_scan(self.found, self.before, inclusive=False)
        return int(self.before[-1:].numpy()[0]) + int(self.found[-1:].numpy()[0])


class Surfaces(NamedTuple):
    """The triangles that can meet."""

    faces: I32
    """Triangles of the sheets, shape (m, 3)."""
    sheet_vertices: int
    """Number of vertices that are the sheets'; the others are the solids'."""
    solid_faces: I32
    """Triangles of all solids, indices among all vertices."""
    solid_body: I32
    """Row of each of those triangles."""
    holder: I32
    """Row of the body that holds each vertex; -1: the world, -2: nothing."""
    kin: I32
    """A number for each vertex of the sheets, the same for those that were one before a tear."""


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
        self.sheet = _Surface(faces, device)
        self._kin = wp.array(np.ascontiguousarray(kin[faces], dtype=np.int32), dtype=wp.vec3i, device=device)
        self.solid = _Surface(solid_faces, device) if len(solid_faces) else None
        self.active = self.self_collision or self.solid is not None
        self.held_count = int((holder != -2).sum())
        self.body_of = wp.array(solid_body.astype(np.int32), dtype=wp.int32, device=device)
        self.holder = wp.array(holder.astype(np.int32), dtype=wp.int32, device=device)
        self.friction = wp.array(friction, dtype=wp.float64, device=device)
        self.bodies = len(friction) - 1
        self._own = _Slots(self.sheet.count, 8, device)
        self._others = _Slots(self.sheet.count, 16, device)
        self.count, self._room = 0, 0
        self._soft, self._felt = soft, np.zeros((len(state["x"]) - sheet_vertices if soft else 0, 3))
        self._work_by_row, self._yielding = np.zeros(self.bodies), len(state["x"]) if soft else sheet_vertices
        self._start = wp.zeros(self._yielding + 1, dtype=wp.int32, device=device)
        self.split = wp.zeros(len(state["x"]), dtype=wp.float64, device=device)
        self.anchor = wp.zeros(sheet_vertices, dtype=wp.vec3d, device=device)
        self.drift, self._none = (wp.zeros(1, dtype=wp.vec3d, device=device) for _ in range(2))
        self.plan = wp.zeros(sheet_vertices, dtype=wp.vec3d, device=device)
        self.span = wp.zeros(1, dtype=wp.float64, device=device)
        self.budget = wp.zeros(4, dtype=wp.float64, device=device)
        self.reach = wp.zeros(2, dtype=wp.float64, device=device)
        self.over = wp.zeros(2, dtype=wp.int32, device=device)
        self.held_back = wp.zeros(sheet_vertices, dtype=wp.vec3d, device=device)
        # Trees are made of the first places, so that a run that goes on from a checkpoint walks them in the same order.
        self.sheet.fit(passes, "boxes", *self._moving(self.drift))
        if self.solid is not None:
            self.solid.fit(passes, "solid_boxes", *self._moving(self._none))
        self.fresh = False
        self.far = FAR
        self.searches = 0
        self.solid_margin = 0.0
        self._grow(256)

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
        self.change = wp.zeros(room, dtype=wp.vec3d, device=device)
        self.slack = wp.zeros(room, dtype=wp.float64, device=device)
        self.limit = wp.zeros(room, dtype=wp.vec4d, device=device)
        # Twice the room: sorting needs it.
        self._keys, self._items = (wp.zeros(8 * room, dtype=wp.int32, device=device) for _ in range(2))
        self.given = wp.zeros(room, dtype=wp.vec3d, device=device)
        self.turned = wp.zeros(room, dtype=wp.vec3d, device=device)
        self.felt = wp.zeros(4 * room if self._soft else 1, dtype=wp.vec3d, device=device)
        self.worked = wp.zeros(room if self._soft else 1, dtype=wp.float64, device=device)

    # ------------------------------------------------------------------ search

    def margins(self, speed: float, drift: float) -> tuple[float, float]:
        """Distances that vertices may move until the lists of sheets and of solids no longer hold [m].

        Args:
            speed: fastest of the sheets' vertices against their mean velocity [m/s].
            drift: that mean velocity [m/s].
        """
        own = 0.5 * (self.far * self.shortest - self.touch[0])
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
        s, found = self.sheet, list[_Slots]()
        x, u, time = self.state["x"], self.state["u"], self.span
        if self.self_collision:
            s.fit(self.passes, "boxes", *self._moving(self.drift))
        while self.self_collision:
            o = self._own
            self.passes(
                "near_self", near.near_self, s.count,
                [s.tree.id, x, u, time, s.faces, self._kin, s.owned, s.lower, s.upper, self.reach, o.room, o.found, o.pairs, o.kinds],
            )()  # fmt: skip
            if o.fits():
                found.append(o)
                break
        if self.solid is not None:
            solid, o = self.solid, self._others
            if span > 0.0 or not self.self_collision:
                s.fit(self.passes, "boxes_lab", *self._moving(self._none))
            solid.fit(self.passes, "solid_boxes", *self._moving(self._none))
            while True:
                self.passes(
                    "near_solids", near.near_solids, s.count,
                    [solid.tree.id, x, u, time, s.faces, s.owned, self.holder, s.lower, s.upper, solid.faces, solid.owned, self.body_of,
                     self.reach, o.room, o.found, o.pairs, o.kinds],
                )()  # fmt: skip
                if o.fits():
                    found.append(o)
                    break
        self._take(found)
        self.fresh = True
        self.searches += 1

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
        self.over.zero_()

    def _take(self, found: list[_Slots]) -> None:
        """Make lists of what was found, in the order of the triangles that found it."""
        totals = [slots.total() for slots in found]
        self.count = sum(totals)
        self._grow(self.count)
        if self.count == 0:
            self._start.zero_()
            return
        p, corners, behind = self.passes, 4 * self.count, 0
        for slots, total in zip(found, totals, strict=True):
            inputs = [slots.room, behind, slots.found, slots.before, slots.pairs, slots.kinds, self.pairs, self.kinds]
            p("together", lists.together, slots.count, inputs)()
            behind += total
        p("by_vertex", lists.by_vertex, corners, [self._yielding, self.pairs, self._keys, self._items])()
        warp().utils.radix_sort_pairs(self._keys, self._items, corners)
        p("starts", lists.starts, self._yielding + 1, [corners, self._keys, self._start])()
        self.host_kinds = self.kinds.numpy()[: self.count, 0]
        self.given.zero_()
        self.turned.zero_()
        self.felt.zero_()
        self.worked.zero_()
        self.slack.zero_()

    # ------------------------------------------------------------------ step

    def steps(self) -> list[Pass]:
        """Passes of one step from the velocities after all other forces to the places at its end."""
        p, s, n, made = self.passes, self.state, self.n, []
        if self.count:
            count = self.count
            made += [
                p("meet", contact.meet, count, [n, s["x"], s["v"], s["u"], s["radius"], self.pairs, self.kinds, s["clock"], self.share, self.normal, self.wanted, self.impulse, self.slack]),
                p("crowd", contact.crowd, self._yielding, [self._start, self._items, self.wanted, s["inverse"], self.split]),
            ]  # fmt: skip
            press = p("press", contact.press, count, [s["u"], self.split, self.pairs, self.kinds, self.friction, self.share, self.normal, self.wanted, self.impulse, self.change])  # fmt: skip
            yields = p(
                "yield",
                contact.yield_to,
                self._yielding,
                [self._start, self._items, self.wanted, self.share, self.change, s["inverse"], s["u"]],
            )
            made += [press, yields] * self.iterations
            if self.held_count:
                made.append(p("lean", contact.lean, self.held_count, [s["held"], self._start, self._items, self.wanted, self.share, self.impulse, s["reaction"]]))  # fmt: skip
        return [*made, *self.ends()]

    def ends(self) -> list[Pass]:
        """Passes at the end of a step: what impulses gave to solids, and the move, cut short where anything would cross."""
        p, s, n, count, made = self.passes, self.state, self.n, self.count, []
        if self.count:
            if self.solid is not None:
                made.append(p("tell", contact.tell, count, [s["x"], self.pairs, self.kinds, self.share, self.wanted, self.impulse, s["center"], s["velocity"], s["clock"], self.given, self.turned]))  # fmt: skip
            if self._soft:
                made.append(p("tell_vertices", softly.tell_vertices, count, [n, self.pairs, self.kinds, self.share, self.wanted, self.impulse, s["u"], self.felt, self.worked]))  # fmt: skip
            made.append(p("bound", bounds.bound, count, [s["x"], s["u"], s["inverse"], s["radius"], self.pairs, self.kinds, self.share, self.normal, self.wanted, s["clock"], self.limit]))  # fmt: skip
        made.append(
            p("move", bounds.move, n, [s["clock"], self._start, self._items, self.kinds, self.wanted, self.limit, self.normal, s["mass"], s["inverse"],
              self.anchor, self.plan, self.budget, s["u"], s["x"], s["v"], self.held_back, self.over])
        )  # fmt: skip
        return made

    def worn(self) -> tuple[bool, bool]:
        """Two answers: the lists should be made anew; they should have been before."""
        over = self.over.numpy()
        return bool(over[0]), bool(over[1])

    def solids_at(self, vertex: int) -> list[int]:
        """Rows of the bodies that a vertex of a sheet gets impulses from in the last step, those of its triangles' pairs included."""
        if self.count == 0 or self.solid is None:
            return []
        solid = np.flatnonzero(self.host_kinds[: self.count] > 1)
        pressed = np.linalg.norm(self.impulse.numpy()[: self.count][solid], axis=1) > 0.0
        own = (self.pairs.numpy()[: self.count][solid] == vertex).any(axis=1)
        return sorted({int(k) for k in (self.host_kinds[solid[pressed & own]] - 2) // 4})

    def books(self) -> tuple[F64, F64]:
        """What soft bodies have felt so far, for `reopen`."""
        return self._felt.copy(), self._work_by_row.copy()

    def reopen(self, books: tuple[F64, F64]) -> None:
        """Forget what was found and given since these books; pairs are looked for anew."""
        self.collect()
        self._felt[:], self._work_by_row[:] = books
        self.over.zero_()
        self.fresh = False

    def collect(self) -> F64:
        """Impulses given to the bodies since the last call, (b, 6)."""
        total = np.zeros((self.bodies, 6))
        if self.count == 0 or self.solid is None:
            return total
        solid = np.flatnonzero(self.host_kinds > 1)
        if len(solid):
            rows = (self.host_kinds[solid] - 2) // 4
            both = np.concatenate([self.given.numpy()[solid], self.turned.numpy()[solid]], axis=1)
            for k in range(6):
                total[:, k] = np.bincount(rows, weights=both[:, k], minlength=self.bodies)
            if self._soft:
                corner = self.pairs.numpy()[solid]
                theirs = corner >= self.n
                felt = self.felt.numpy()[: 4 * self.count].reshape(-1, 4, 3)[solid]
                np.add.at(self._felt, corner[theirs] - self.n, felt[theirs])
                self._work_by_row += np.bincount(rows, weights=self.worked.numpy()[solid], minlength=self.bodies)
                self.felt.zero_()
                self.worked.zero_()
        self.given.zero_()
        self.turned.zero_()
        return total

    def felt_by_vertices(self) -> tuple[F64, F64]:
        """Impulses given to the vertices of solids by what was collected since the last call, (m, 3), and work on the solids (b,)."""
        found = self._felt.copy(), self._work_by_row.copy()
        self._felt[:], self._work_by_row[:] = 0.0, 0.0
        return found
