"""Pushes between bodies whose visible surfaces do not meet: a collision hull that fills what is drawn open (R108).

Criterion. Where the log says that two bodies gave each other an impulse within a frame, their visible surfaces came as near to each other
on the way through that frame as what counts as contact (S3): skins and facet error, at most `GAP_CAP`. The way is the cubic
of `geometry/motions.py`; by as much as contacts may have bent it, the surfaces may seem to be farther apart.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import Lowest, Sweep, lowest_clearances
from ...worlds.arrays import F64
from .bounds import PRECISION
from .paths import Paths

if TYPE_CHECKING:
    from ..scene.surfaces import Surfaces

__all__ = ["Unseen", "find_unseen"]


class Unseen(NamedTuple):
    """Two entities push each other up to `frame` although their visible surfaces stay apart."""

    a: str
    b: str
    frame: int
    """The first such frame."""
    gap: float
    """Least distance of the visible surfaces on every path that the states allow, where it is largest [m]."""
    bound: float
    """Largest gap that counts as contact [m]."""
    frames: int
    """Number of such frames."""


def find_unseen(surfaces: Surfaces) -> tuple[list[Unseen], int]:
    """Pairs that push each other where nothing is drawn, and the number of pushes looked at.

    Raises:
        EvidenceError: a rigid cache has no log of contacts.
    """
    paths = Paths(surfaces)
    found: list[Unseen] = []
    inspected = 0
    soft = surfaces.candidate.deforming
    for (a, b), pushed in sorted(paths.log.pushed().items()):
        if {a, b} & surfaces.missing.keys() or a in soft or b in soft:
            continue  # what deforms collides with the vertices that are drawn
        inspected += len(pushed)
        bound = surfaces.contact_gap(a, b)
        near = surfaces.series(a, b) <= bound
        usable = min(paths.usable(a), paths.usable(b))
        rows = np.array([k - 1 for k in pushed if k <= usable and not (near[k] or near[k - 1])], dtype=np.intp)
        if not len(rows):
            continue
        gap = _gaps(paths, a, b, rows, bound)
        far = np.flatnonzero(gap > bound)
        if len(far):
            found.append(Unseen(a, b, int(rows[far[0]]) + 1, float(gap[far].max()), bound, len(far)))
    return found, inspected


def _gaps(paths: Paths, a: str, b: str, rows: NDArray[np.intp], bound: float) -> F64:
    """Least distance [m] of the visible surfaces in each interval, less what contacts may have bent the paths; shape (n,).

    Where they come within the bound on the cubics themselves, it is no more than that: how deep they get is not asked.
    """
    least = np.full(len(rows), np.inf)
    for lowest, _bent in _lowest(paths, a, b, rows, bound, settled=True):
        least = np.minimum(least, lowest.value)
    open_ = np.flatnonzero(least >= bound)
    gap = np.full(len(rows), np.inf)
    for lowest, bent in _lowest(paths, a, b, rows[open_], bound, settled=False):
        gap[open_] = np.minimum(gap[open_], lowest.value - bent - PRECISION * bound)
    return np.where(least < bound, least, gap)


def _lowest(paths: Paths, a: str, b: str, rows: NDArray[np.intp], bound: float, *, settled: bool) -> Iterator[tuple[Lowest, F64]]:
    """Of every two parts their lowest clearance in each interval, and how far contacts may have bent their paths [m].

    Args:
        paths: of all bodies.
        a: an entity.
        b: another one.
        rows: intervals.
        bound: largest gap that counts as contact [m].
        settled: any value below the bound will do; else the lowest is wanted as far up as bent paths may come within the bound.
    """
    surfaces = paths.surfaces
    asked, slack = [], []
    for i, j in ((i, j) for i in surfaces.parts_of[a] for j in surfaces.parts_of[b] if len(rows)):
        one, two = (paths.body(surfaces.parts[k]).flight for k in (i, j))
        slack.append((one.slack(paths.radius[i]) + two.slack(paths.radius[j]))[rows])
        below = bound if settled else bound + float(slack[-1].max())
        solids = surfaces.parts[i].solid, surfaces.parts[j].solid
        sweep = Sweep(solids[0], one.motion.take(rows), solids[1], two.motion.take(rows), below, PRECISION * bound)
        asked.append(sweep._replace(first_found=settled, names=f"{a} and {b}"))
    yield from zip(lowest_clearances(asked), slack, strict=True)
