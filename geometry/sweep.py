"""Clearance of two moving bodies between two known states: deepest overlap or nearest pass, with a proven bound.

Signed clearance changes no faster than the bodies move against each other: the nearest points, or the deepest point and
its foot, move by at most `relative_travel`. With values c0, c1 at both ends of a piece of the path, no value within is
lower than (c0 + c1 - travel) / 2. Pieces that could hold a lower value than wanted are halved.
Conservative advancement after Mirtich (1996), "Impulse-based dynamic simulation of rigid body systems", chapter 2.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64
from ..worlds.errors import EvidenceError
from .batch import clearance_batch
from .clearance import Care, clearance_series
from .forest import Forest
from .motions import Motion, relative_travel

if TYPE_CHECKING:
    from .solids import Solid

__all__ = [
    "Lowest",
    "Sweep",
    "lowest_clearance",
    "lowest_clearances",
]

DEPTH_ERROR = 0.01
"""Relative error that `clearance` promises for depths; widens the bound of a piece."""
DEPTH_SHARE = 0.25
"""Share of the precision of a search by which single depths may be too small."""
TOGETHER = 200_000
"""Clearances of many searches measured in one batch."""
FARTHEST = 1e8
"""Own choice: a way longer than this many times the precision is not searched (1 km at 10 um): where surfaces stay near each other on
it, halving it down to the precision would not end."""


class Lowest(NamedTuple):
    """Lowest clearance found on each of n motions."""

    value: F64
    """[m], shape (n,); negative is minus the depth."""
    time: F64
    """Where, in 0..1, shape (n,)."""
    ends: F64
    """Clearance at both ends [m], shape (n, 2)."""


def _radius(solid: Solid, motion: Motion) -> float:
    return float(np.linalg.norm(solid.vertices - motion.center, axis=1).max())


class _Pair:
    """Clearances of one pair at chosen times of its motions."""

    def __init__(self, a: Solid, motion_a: Motion, b: Solid, motion_b: Motion, *, skip_above: float) -> None:
        self.a, self.motion_a, self.radius_a = a, motion_a, _radius(a, motion_a)
        self.b, self.motion_b, self.radius_b = b, motion_b, _radius(b, motion_b)
        self.skip_above = skip_above

    def clearance(self, rows: NDArray[np.intp], s: F64) -> F64:
        if len(rows) == 0:
            return np.empty(0)
        at_a, at_b = self.motion_a.take(rows).at(s), self.motion_b.take(rows).at(s)
        return clearance_series(self.a, at_a, self.b, at_b, skip_above=self.skip_above)

    def travel(self, rows: NDArray[np.intp], s: F64, e: F64) -> F64:
        a, b = self.motion_a.take(rows), self.motion_b.take(rows)
        return relative_travel(a, self.radius_a, b, self.radius_b, s, e)


class Sweep(NamedTuple):
    """One pair on n motions, and what is asked about it."""

    a: Solid
    """One surface, in its own frame."""
    motion_a: Motion
    """Its motion, n intervals."""
    b: Solid
    motion_b: Motion
    below: float = np.inf
    """Only lower values [m] are searched: where none exists the value returned is some value of the motion, or a lower bound
    that is not below."""
    precision: float = 0.0
    """The value is at most this much [m] above the true one where that is lower than `below`."""
    first_found: bool = False
    """True if any value lower than `below` ends the search of its motion."""
    ends_above: float = -np.inf
    """Motions with a lower clearance [m] at one of their ends are not searched."""
    names: str = "two surfaces"
    """Names of both surfaces, for messages."""


class _Ask(NamedTuple):
    """Clearances that a search needs next: of motions `rows` at times `s`, exact where below `enough` [m] and deeper than `idle` [m]."""

    rows: NDArray[np.intp]
    s: F64
    enough: F64
    idle: F64


def lowest_clearance(sweep: Sweep, *, skip_above: float = 0.0) -> Lowest:
    """Lowest signed clearance of two surfaces over each of n motions.

    Args:
        sweep: the surfaces, their motions and what is asked about them.
        skip_above: bounding-box gap [m] from which on a lower bound of the clearance is enough.

    Raises:
        EvidenceError: surfaces that may meet move more than `FARTHEST` precisions.
    """
    pair = _Pair(sweep.a, sweep.motion_a, sweep.b, sweep.motion_b, skip_above=skip_above)
    search = _search(pair, sweep)
    ask = next(search)
    while True:
        try:
            ask = search.send(pair.clearance(ask.rows, ask.s))
        except StopIteration as end:
            return cast("Lowest", end.value)


def lowest_clearances(sweeps: Sequence[Sweep]) -> list[Lowest]:
    """`lowest_clearance` of many pairs side by side: what all of them need next is measured in one batch."""
    index: dict[int, int] = {}
    solids: list[Solid] = []
    for solid in (s for sweep in sweeps for s in (sweep.a, sweep.b)):
        if id(solid) not in index:
            index[id(solid)] = len(solids)
            solids.append(solid)
    forest = Forest(solids)
    found: list[Lowest | None] = [None] * len(sweeps)
    searches = {}
    for k, sweep in enumerate(sweeps):
        pair = _Pair(sweep.a, sweep.motion_a, sweep.b, sweep.motion_b, skip_above=0.0)
        search = _search(pair, sweep)
        searches[k] = (search, pair, next(search))
    tolerance = DEPTH_SHARE * min((sweep.precision for sweep in sweeps), default=0.0)
    while searches:
        for portion in _portions(searches):
            for k, values in _together(forest, index, {k: searches[k] for k in portion}, tolerance).items():
                search, pair, _ = searches[k]
                try:
                    searches[k] = (search, pair, search.send(values))
                except StopIteration as end:
                    found[k] = end.value
                    del searches[k]
    return cast("list[Lowest]", found)


def _portions(searches: dict[int, tuple[Any, _Pair, _Ask]]) -> list[list[int]]:
    """The searches in groups that ask for about `TOGETHER` clearances each."""
    total = np.cumsum([len(ask.rows) for _, _, ask in searches.values()])
    groups: dict[int, list[int]] = {}
    for k, so_far in zip(searches, total, strict=True):
        groups.setdefault(int(so_far) // TOGETHER, []).append(k)
    return list(groups.values())


def _together(
    forest: Forest, index: dict[int, int], searches: dict[int, tuple[Any, _Pair, _Ask]], tolerance: float
) -> dict[int, F64]:
    """Answers of one batch to several searches."""
    one: list[tuple[F64, F64]] = []
    two: list[tuple[F64, F64]] = []
    for _, pair, ask in searches.values():
        one.append(pair.motion_a.take(ask.rows).at(ask.s))
        two.append(pair.motion_b.take(ask.rows).at(ask.s))
    counts = [len(ask.rows) for _, _, ask in searches.values()]
    named = [(index[id(pair.a)], index[id(pair.b)]) for _, pair, _ in searches.values()]
    poses = [(np.concatenate([p for p, _ in side]), np.concatenate([q for _, q in side])) for side in (one, two)]
    enough, idle = (np.concatenate([getattr(ask, name) for _, _, ask in searches.values()]) for name in ("enough", "idle"))
    pairs = np.repeat(named, counts, axis=0)
    values = clearance_batch(forest, pairs, *poses, skip_above=enough, care=Care(tolerance, idle=idle)).distance
    return dict(zip(searches, np.split(values, np.cumsum(counts)[:-1]), strict=True))


def _idle(sweep: Sweep, travel: F64) -> F64:
    """Depth [m] from which no motion of so little travel gets below what is asked, shape (n,): no matter how deep it is up to there."""
    if not sweep.below < 0.0:
        return np.zeros(len(travel))
    room = (-sweep.below - 0.5 * travel - DEPTH_SHARE * sweep.precision) / (1.0 + DEPTH_ERROR)
    return np.clip((1.0 - 1e-9) * room, 0.0, max(-sweep.ends_above, 0.0))


def _search(pair: _Pair, sweep: Sweep) -> Generator[_Ask, F64, Lowest]:
    count = len(sweep.motion_a)
    rows = np.arange(count)
    zero, one = np.zeros(count), np.ones(count)
    # Within an interval no value lies lower than that at its end by more than the travel.
    spare = max(sweep.below, 0.0)
    way = np.tile(pair.travel(rows, zero, one), 2)
    c0, c1 = np.split((yield _Ask(np.tile(rows, 2), np.concatenate([zero, one]), way + spare, _idle(sweep, way))), 2)
    ends = np.stack([c0, c1], axis=1)
    best, when = np.minimum(c0, c1), np.where(c1 < c0, 1.0, 0.0)
    keep = np.flatnonzero(best >= sweep.ends_above)
    rows, s, e, c0, c1 = keep, zero[keep], one[keep], c0[keep], c1[keep]
    while len(rows):
        slack = DEPTH_ERROR * np.maximum(0.0, -np.minimum(c0, c1)) + DEPTH_SHARE * sweep.precision
        travel = pair.travel(rows, s, e)
        bound = 0.5 * (c0 + c1 - travel) - slack
        open_ = bound < np.minimum(best[rows] - sweep.precision - slack, sweep.below)
        if sweep.first_found:
            open_ &= best[rows] >= sweep.below
        rows, s, e, c0, c1, travel = rows[open_], s[open_], e[open_], c0[open_], c1[open_], travel[open_]
        if len(rows) == 0:
            break
        if travel.max() > FARTHEST * sweep.precision > 0.0:
            raise EvidenceError(
                f"{sweep.names} move by up to {travel.max():.3g} m against each other between two frames; ways beyond "
                f"{FARTHEST * sweep.precision:.3g} m are not searched; lower their speed or spin, or raise fps"
            )
        middle = 0.5 * (s + e)
        c = yield _Ask(rows, middle, travel + spare, _idle(sweep, 0.5 * travel))
        order = np.argsort(-c, kind="stable")
        lower = order[c[order] < best[rows[order]]]
        # Sorted from high to low, so that the lowest value of an interval is written last.
        best[rows[lower]], when[rows[lower]] = c[lower], middle[lower]
        rows = np.concatenate([rows, rows])
        s, e = np.concatenate([s, middle]), np.concatenate([middle, e])
        c0, c1 = np.concatenate([c0, c]), np.concatenate([c, c1])
    return Lowest(best, when, ends)
