"""Groups of bodies that rest by weight alone, told without a linear program: each stands with its load over what carries it.

The proof: a vertical force at any level contact lies within its friction pyramid, and such forces >= 0 at points around a vertical line have a
resultant of any size on it. So each body can pass its weight and its load, on the line through their common centre, to one carrier, or shares of
them on two lines with that centre to two, from the top down; no other contact need push. Where that fails nothing is said.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np

from ...worlds.arrays import F64

if TYPE_CHECKING:
    from .touching import Contacts

__all__ = ["Bodies", "rests_by_weight"]

TILT = 1e-6
"""Sine of the slope of a contact up to which it counts as level."""
ROUGH_ENOUGH = 1e-3
"""[1] Own choice: friction from which on a vertical force lies well within the pyramid of a contact that is level but for `TILT`."""
SHARE = 0.01
"""[1] Own choice: the least share of a load that one of two carriers is given."""
AROUND = 1e-6
"""[rad] Own choice: by so much the widest gap between points, seen from the line, must be less than a half turn; rounding is far less."""
AT = 1e-9
"""[m] Own choice: points so near the line are left out, for their direction is rounding."""


class Bodies(Protocol):
    """Free bodies that touch each other, and every contact of theirs: `equilibrium.Group`."""

    @property
    def members(self) -> tuple[str, ...]:
        """Their names."""

    @property
    def contacts(self) -> tuple[tuple[str, str, Contacts], ...]:
        """(pushed body, pushing body, contacts)."""

    @property
    def centers(self) -> F64:
        """Centres of mass [m], shape (members, 3)."""

    @property
    def weights(self) -> F64:
        """[N], shape (members,)."""

    @property
    def down(self) -> F64:
        """Unit vector along gravity, shape (3,)."""


class _Base(NamedTuple):
    """Level contacts from below of one body with one thing, or with all that is no member of the group."""

    carrier: str | None
    points: F64
    """Across gravity [m], shape (n, 2)."""


def rests_by_weight(group: Bodies) -> bool:
    """True if it is proven that every body of a group rests on contacts from below alone; False says nothing."""
    across = np.linalg.svd(group.down[None])[2][1:]
    bases = {m: _bases(group, m, across) for m in group.members}
    weight = dict(zip(group.members, group.weights.tolist(), strict=True))
    moment = {m: w * at for (m, w), at in zip(weight.items(), group.centers @ across.T, strict=True)}
    above = dict.fromkeys(group.members, 0)
    for some in bases.values():
        for base in some:
            if base.carrier is not None:
                above[base.carrier] += 1
    ready = [m for m, count in above.items() if count == 0]
    done = 0
    while ready:
        at = ready.pop()
        if not weight[at] > 0.0:
            return False
        passed = _passed(bases[at], moment[at] / weight[at])
        if not passed:
            return False
        done += 1
        for carrier, share, place in passed:
            if carrier is not None:
                weight[carrier] += share * weight[at]
                moment[carrier] = moment[carrier] + share * weight[at] * place
        for base in bases[at]:
            if base.carrier is not None:
                above[base.carrier] -= 1
                ready += [base.carrier] if above[base.carrier] == 0 else []
    return done == len(group.members)


def _bases(group: Bodies, body: str, across: F64) -> Sequence[_Base]:
    """Where a body may stand: on all that is no member together, then on each member."""
    level = np.sqrt(1.0 - TILT * TILT)
    fixed: list[F64] = []
    found: dict[str, list[F64]] = {}
    for pushed, pushing, contacts in group.contacts:
        if body not in (pushed, pushing):
            continue
        other, sign = (pushing, 1.0) if body == pushed else (pushed, -1.0)
        up = (sign * contacts.normals @ group.down <= -level) & (contacts.friction >= ROUGH_ENOUGH)
        if up.any():
            points = contacts.points[up] @ across.T
            (found.setdefault(other, []) if other in group.members else fixed).append(points)
    ground = [_Base(None, np.concatenate(fixed))] if fixed else []
    return [*ground, *(_Base(name, np.concatenate(some)) for name, some in found.items())]


def _passed(bases: Sequence[_Base], line: F64) -> list[tuple[str | None, float, F64]]:
    """Who may carry a load on a vertical line: carriers, their shares, and on which lines; empty where neither one nor two can."""
    for base in bases:
        if _surrounds(base.points - line):
            return [(base.carrier, 1.0, line)]
    for one, two in combinations(bases, 2):
        middle = one.points.mean(axis=0)  # equal forces at all points act there
        way = middle - two.points.mean(axis=0)
        share = float((line - middle + way) @ way / max(float(way @ way), AT * AT))
        if SHARE <= share <= 1.0 - SHARE:
            rest = (line - share * middle) / (1.0 - share)
            if _surrounds(two.points - rest):
                return [(one.carrier, share, middle), (two.carrier, 1.0 - share, rest)]
    return []


def _surrounds(points: F64) -> bool:
    """True if the origin lies within the hull of points in the plane, not on its rim."""
    far = points[np.abs(points).max(axis=1) > AT]
    if len(far) < 3:
        return False
    turns = np.sort(np.arctan2(far[:, 1], far[:, 0]))
    widest = max(float(np.diff(turns).max()), float(turns[0] + 2.0 * np.pi - turns[-1]))
    return widest < np.pi - AROUND
