"""Explicit steps on CPUs: only what could meet in a step is looked at, and lists are made anew where something did not go as expected.

When all pairs are looked for, each vertex is expected to go on as it does for `AHEAD` steps, and those pairs are listed that then come
near. Where one strays from there by a part of what the lists allow, all that have strayed by half as much are looked for anew, with all
triangles that are near theirs; the others keep their pairs.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import cores, warp
from ...worlds.arrays import F64
from ..team import team
from . import near_kernels as near
from .contacts import FARTHEST, Contacts
from .fold_kernels import GUARD, lean, press, tell, wake
from .fold_move_kernels import binding, cut, gather, move, renew, sway

if TYPE_CHECKING:
    from .arrays import ClothArrays
    from .near_lists import Slots

__all__ = ["Folds", "OutranError"]

AHEAD = 8
"""Steps for which pairs are listed that come near as all goes on."""
STRAY = 0.15
"""Share of the shortest edge, less the distance of contact, by which a vertex may stray from where it is expected."""
SPARE = 0.6
"""Share of that after which it is looked for anew."""
AGAIN = 0.3
"""Share of that after which it is looked for anew where another one is."""
FEW = 3000
"""Pairs below which no other thread is asked to help."""


class OutranError(Exception):
    """A vertex moved further in one step than the search for contacts allows."""


class _Rows:
    """Pairs of one kind side by side, and what is known of them."""

    def __init__(self) -> None:
        self._two = [self._made(0), self._made(0)]
        self.start = np.zeros(0, np.int64)

    @staticmethod
    def _made(count: int) -> tuple[Any, ...]:
        """Pairs, kinds, distances, how fast they fall at most, and the step in which they were last looked at."""
        pairs = np.zeros((count, 4), np.int32), np.zeros((count, 2), np.int32)
        return *pairs, np.zeros(count), np.zeros(count), np.zeros(count, np.int64)

    @property
    def rows(self) -> tuple[Any, ...]:
        """As `_made`."""
        return self._two[0]

    def take(self, slots: Slots, due: Any) -> None:
        """Take what triangles found; of those that are not due the distances stay."""
        found, before, known = slots.found.numpy(), self.start, self._two[0]
        start = np.zeros(len(found) + 1, np.int64)
        np.cumsum(found, out=start[1:])
        if len(self._two[1][2]) < start[-1]:
            self._two[1] = self._made(int(1.5 * start[-1]) + 1)
        if due is None:
            due, before = np.zeros(0, np.int32), np.zeros(0, np.int64)
        gather(found, slots.room, slots.pairs.numpy(), slots.kinds.numpy(), due, before, known, start, self._two[1])
        self._two.reverse()
        self.start = start


class Folds:
    """Explicit steps of one run on a CPU.

    Args:
        arrays: what they move.
        contacts: what it meets.
        forces: passes to the velocities after all forces but those of contacts.
        carry: the pass that moves the solids' vertices, if any move.
    """

    def __init__(
        self, arrays: ClothArrays, contacts: Contacts, forces: Callable[[], list[Any]], carry: Callable[[], Any] | None
    ) -> None:
        self._of, self._contacts, self._forces, self._carry = arrays, contacts, forces, carry
        e, of, wp = arrays, contacts, warp()
        self._x, self._v, self._u = e.x.numpy(), e.v.numpy(), e.u.numpy()
        # How far all can have strayed from their plans since these were made: by the start of a step, and by its end.
        self._strays, self._ahead = np.zeros(e.total), np.zeros(e.total)
        self._number, self._time = 0, 0.0
        self._crowd, self._spot, self._part = np.zeros(e.total, np.int32), np.full(e.total, -1, np.int32), np.ones(e.n)
        self._moved, self._due = (wp.zeros(k, dtype=wp.int32, device="cpu") for k in (e.n, of.sheet.count))
        # Where all are expected now and how fast they go on; solids are taken to stay, their motion is allowed for.
        self._places, self._plans = (wp.zeros(e.total, dtype=wp.vec3d, device="cpu") for _ in range(2))
        self._place, self._plan = self._places.numpy()[: e.n], self._plans.numpy()[: e.n]
        self._span, self._drift = wp.zeros(1, dtype=wp.float64, device="cpu"), wp.zeros(1, dtype=wp.vec3d, device="cpu")
        self._speed, self._before = np.zeros((e.n, 3)), np.zeros((e.total, 3))
        self._allowed = STRAY * (of.shortest - of.touch[0])
        self._left = self._margin = self._apart = 0.0
        self._searches, self._worn = -1, False
        self._lists = _Rows(), _Rows()
        self._room(0)

    def _room(self, count: int) -> None:
        """Room for so many pairs that could meet."""
        self._held = held = int(1.5 * count) + 1
        self._corner, self._kind = np.empty((held, 4), np.int32), np.empty(held, np.int32)
        self._share, self._way, self._aim = np.empty((held, 4)), np.empty((held, 4)), np.empty(held)
        self._bound, self._value = np.empty(4 * held, np.int32), np.empty(4 * held)
        self._which, self._impulse = np.empty(held, np.int32), np.empty((held, 3))
        self._pressed = 0

    # ------------------------------------------------------------------ search

    def _search(self, solid_speed: float, dt: float, *, anew: bool = False) -> None:
        """Have lists that hold for the next step; all of them are made anew where asked for."""
        of = self._contacts
        known = of.fresh and of.searches == self._searches and not anew and self._left > 0.5 * dt
        late = of.solid is not None and (self._apart + dt) * solid_speed > self._margin
        if known and not self._worn and not late:
            return
        if known:
            renew(self._x, self._v, AGAIN * self._allowed, self._place, self._plan, self._strays, self._moved.numpy())
            self._find(self._due, solid_speed)
        else:
            of.collect()
            self._place[:], self._plan[:] = self._x[: self._of.n], self._v
            self._left, self._time = AHEAD * dt, 0.0
            self._strays[:] = 0.0
            self._find(None, solid_speed)
            of.searches += 1
            self._searches, of.count = of.searches, 0
        of.fresh, self._worn = True, False
        self._lay()

    def _find(self, due: Any, solid_speed: float) -> None:
        """Look for pairs of sheets that are due to be looked for, or all, and for those with solids."""
        e, of, p = self._of, self._contacts, self._of.passes
        s, aim = of.sheet, (self._places, self._plans, self._span)
        self._margin = min(solid_speed * self._left, 0.5 * FARTHEST * of.shortest)
        of.reach.assign(np.array([of.touch[0] + 2 * self._allowed, of.touch[1] + self._allowed + self._margin]))
        self._span.assign(np.array([self._left]))
        self._drift.assign((e.mass @ self._plan / e.mass.sum()).reshape(1, 3))
        if of.self_collision:
            s.fit(p, "boxes", *aim, self._drift)
            if due is not None:
                due.zero_()
                p("mark", near.mark, s.count, [s.tree.id, self._moved, s.faces, s.lower, s.upper, of.reach, due])()
            room = of.own.room
            slots = of.find_own(*aim, due)
            self._lists[0].take(slots, None if due is None or slots.room != room else due.numpy())
        if of.solid is not None:
            self._places.numpy()[e.n :] = self._x[e.n :]
            self._apart = 0.0
            p("boxes_lab", near.boxes, s.count, [*aim, of.none, s.faces, s.lower, s.upper, s.spread])()
            slots = of.find_others(*aim)
            self._lists[1].take(slots, None)

    def _lay(self) -> None:
        """Share the pairs among threads; each part has its place in the lists."""
        of, at, helpers = self._contacts, 0, cores()
        self._calls, starts = [], []
        for one in self._lists:
            count = int(one.start[-1]) if len(one.start) else 0
            cuts = [count * k // helpers for k in range(helpers + 1)]
            for first, end in pairwise(cuts):
                starts.append(at)
                self._calls.append((first, end, at, *one.rows))
                at += end - first
        of.looked_at = at
        if at > self._held:
            self._room(at)
        self._starts = np.array(starts, dtype=np.int64)
        self._counts, self._binds = np.zeros(len(starts), np.int64), np.zeros(len(starts), np.int64)

    # ------------------------------------------------------------------ step

    def run(self, dt: float, count: int, solid_speed: float) -> F64:
        """Take `count` steps; the impulses given to the bodies by contact, (b, 6)."""
        e, of = self._of, self._contacts
        total, clock = np.zeros((max(of.bodies, 1), 6)), e.clock.numpy()
        clock[0] = dt
        forces, own = self._forces(), (self._u, self._speed, self._plan, self._place, self._x, self._v)
        goes = (dt, self._part, e.mass, *own, of.held_back.numpy(), self._ahead, self._strays)
        for _ in range(count):
            self._search(solid_speed, dt)
            for one in forces:
                one()
            self._before[:] = self._u
            strayed = self._contact(dt)
            if strayed > self._allowed:
                self._u[:] = self._before
                self._part[:] = 1.0
                self._search(solid_speed, dt, anew=True)
                strayed = self._contact(dt)
                if strayed > self._allowed:
                    move(*goes)
                    raise OutranError
            self._worn = strayed > SPARE * self._allowed
            self._told(float(clock[1]), total)
            move(*goes)
            if self._carry is not None:
                self._carry()()
            clock[1] += dt
            self._time += dt
            self._left -= dt
            self._apart += dt
        return total[: of.bodies]

    def _contact(self, dt: float) -> float:
        """From the velocities after all other forces to those with which vertices go; the farthest that any strays [m]."""
        e, of, x, u = self._of, self._contacts, self._x, self._u
        inverse, radius, plan = e.inverse.numpy(), of.state["radius"].numpy(), self._plans.numpy()
        moving = e.n if self._carry is None else e.total
        sway(plan, u, dt, self._strays, self._ahead[:moving])
        self._number += 1
        lists = self._corner, self._kind, self._share, self._way
        starts, counts, late = self._starts, self._counts, False

        def look(k: int) -> None:
            first, end, at, *rows = self._calls[k]
            more = wake(
                first, end, at + counts[k], *rows, self._number, self._time, dt, x, plan, u, radius, self._strays, self._ahead, late, *lists,
                self._aim,
            )  # fmt: skip
            counts[k] += more

        def hold(k: int) -> None:
            self._binds[k] = binding(starts[k], counts[k], *lists, x, u, inverse, radius, dt, self._bound, self._value)

        counts[:] = 0
        self._shared(look)
        self._pressed, kicked = press(
            starts, counts, *lists, self._aim, of.friction.numpy(), inverse, of.iterations, u, self._which, self._impulse, self._crowd,
            self._spot, dt, self._before, self._ahead,
        )  # fmt: skip
        if 2 * kicked > GUARD * min(of.touch):
            late = True
            self._shared(look)
        self._shared(hold)
        return float(
            cut(
                starts, self._binds, self._bound, self._value, *lists[:2], self._way, self._part, dt, x, u, self._place, self._plan,
                self._speed,
            )
        )  # fmt: skip

    def _told(self, since: float, total: F64) -> None:
        """Count what contacts gave to the bodies and to what holds vertices, `since` seconds after bodies' states were given."""
        e, of = self._of, self._contacts
        if not self._pressed:
            return
        own = (self._pressed, self._which, self._corner)
        if of.solid is not None:
            bodies = (of.state["center"].numpy(), of.state["velocity"].numpy(), since, total)
            tell(*own, self._kind, self._share, self._impulse, self._x, self._u, *bodies, *of.soft_books())
        if of.held_count:
            lean(*own, self._share, self._impulse, e.inverse.numpy(), e.reaction.numpy())

    def _shared(self, work: Any) -> None:
        """Do all parts, by several threads where that is worth it."""
        calls = [partial(work, k) for k in range(len(self._calls))]
        if len(calls) > 1 and self._contacts.looked_at > FEW:
            team(cores() - 1)(calls)
            return
        for call in calls:
            call()

    def farthest(self) -> int:
        """The vertex that went farthest from where it was expected."""
        return int(((self._x[: self._of.n] - self._place) ** 2).sum(1).argmax())

    def solids_at(self, vertex: int) -> list[int]:
        """Rows of the bodies that a vertex got impulses from in the last step, those of its triangles' pairs included."""
        which = self._which[: self._pressed]
        given = (self._impulse[: self._pressed] != 0.0).any(axis=1)
        own = which[given & (self._corner[which] == vertex).any(axis=1) & (self._kind[which] > 1)]
        return sorted({int(k) for k in (self._kind[own] - 2) // 4})
