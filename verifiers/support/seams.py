"""Seams between things that never move: which of their parts touch at frame 0, and how far what touches is apart.

What falls comes to rest on its support, whatever the gap at its start; what never moves is drawn with that gap for ever. Its seams are
therefore narrower than the contact tolerance of free bodies, small against the things that they join, and few: `support/held.py`
bounds their sum along a chain.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ..scene.bounds import GAP_CAP, ROUNDING
from .bounds import SEAM_LEAST, SEAM_MOST, SEAM_SHARE
from .one_piece import own_touches

if TYPE_CHECKING:
    from ..scene.surfaces import Surfaces

__all__ = ["facets", "seam", "seams_between"]


def seam(surfaces: Surfaces, a: str, b: str) -> float:
    """The widest gap over which two things that never move touch [m]: a share of the smaller one, within limits, and facet error."""
    share = SEAM_SHARE * min(surfaces.size(a), surfaces.size(b))
    return min(max(share, SEAM_LEAST), SEAM_MOST) + facets(surfaces, a, b) + ROUNDING


def facets(surfaces: Surfaces, a: str, b: str) -> float:
    """The distance by which the drawn surfaces of two entities may fall short of their shapes [m]."""
    return float(min(GAP_CAP, sum(max(surfaces.parts[i].deviation for i in surfaces.parts_of[n]) for n in (a, b))))


def seams_between(surfaces: Surfaces, names: Sequence[str]) -> Mapping[int, dict[int, float]]:
    """For each part of some things that never move the parts that it touches, and the gap to each [m], 0 within facet error."""
    parts = [i for n in names for i in surfaces.parts_of[n]]
    found: dict[int, dict[int, float]] = {i: {} for i in parts}

    def enter(i: int, j: int, gap: float) -> None:
        found[i][j] = found[j][i] = gap

    assert surfaces.first is not None  # measures parts of different entities
    for (i, j), gap in surfaces.at_start.items():
        if i in found and j in found:
            a, b = surfaces.parts[i].entity, surfaces.parts[j].entity
            if gap <= seam(surfaces, a, b):
                enter(i, j, max(0.0, round(gap - facets(surfaces, a, b), 6)))
    for name in names:
        own = surfaces.parts_of[name]
        wide, narrow = (list(own_touches(surfaces, own, gap=g)) for g in (seam(surfaces, name, name), _closed(surfaces, name)))
        for i, j in wide:
            enter(i, j, 0.0 if (i, j) in narrow else seam(surfaces, name, name))
    return found


def _closed(surfaces: Surfaces, name: str) -> float:
    """Gap within which parts of one entity have none between them [m]."""
    return facets(surfaces, name, name) + ROUNDING
