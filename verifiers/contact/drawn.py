"""Pushes between bodies whose visible surfaces do not meet: a collision hull that fills what is drawn open (R108).

Criterion. Where the log says that two bodies gave each other an impulse within a frame, their visible surfaces came as near to each other
on the way through that frame as what counts as contact (S3): skins and facet error, at most `GAP_CAP`. The way is the cubic
of `geometry/motions.py`; by as much as contacts may have bent it, the surfaces may seem to be farther apart.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import Sweep, lowest_clearances
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
    """Least distance [m] of the visible surfaces in each interval, less what contacts may have bent the paths; shape (n,)."""
    surfaces = paths.surfaces
    least = np.full(len(rows), np.inf)
    pairs = [(i, j) for i in surfaces.parts_of[a] for j in surfaces.parts_of[b]]
    asked, slack = [], []
    for i, j in pairs:
        one, two = (paths.body(surfaces.parts[k]).flight for k in (i, j))
        slack.append((one.slack(paths.radius[i]) + two.slack(paths.radius[j]))[rows])
        below = bound + float(slack[-1].max())
        names = f"{a} and {b}"
        asked.append(
            Sweep(
                surfaces.parts[i].solid,
                one.motion.take(rows),
                surfaces.parts[j].solid,
                two.motion.take(rows),
                below,
                PRECISION * bound,
                names=names,
            )
        )
    for lowest, bent in zip(lowest_clearances(asked), slack, strict=True):
        least = np.minimum(least, lowest.value - bent - PRECISION * bound)
    return least
