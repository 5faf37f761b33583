"""Tracks: films on places that no liquid touched must have come from a wet surface that was there (part of the row `wet`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.categories.liquid.wet import Texels

if TYPE_CHECKING:
    from .solids import Piece

__all__ = ["Carried", "Unfounded"]

NEAR = 1.5
"""[distances of places] Places of surfaces that touch are this near to each other at most."""
ROUND = 1e-3
"""By which a film may be thicker than that which it came from: single precision."""


class Unfounded(NamedTuple):
    """The film at a frame that is founded worst."""

    film: float
    """0 where all are founded."""
    entity: str
    where: F64
    """World (3,) [m]."""


class Carried:
    """Films of all places, frame by frame; drying left out, so that a film is never taken for thinner than it can be.

    Args:
        texels: the places.
        pieces: the surface of each part.
        groups: rows of each part's places.
        gap: surfaces this near to each other touch [m].
    """

    def __init__(self, texels: Texels, pieces: Sequence[Piece], groups: Sequence[NDArray[np.intp]], gap: float) -> None:
        self._texels, self._pieces, self._groups, self._gap = texels, pieces, groups, gap
        self._film = np.zeros(len(texels.area))

    def see(self, frame: int, held: Mapping[str, Any]) -> Unfounded:
        """Compare one frame; frames come in order."""
        before = self._film.copy()
        before[held["wet/texel"]] = 1.0
        rows, film = held["track/texel"], held["track/film"].astype(np.float64)
        source = before.copy()
        self._film = before.copy()
        self._film[rows] = film
        if not len(rows):
            return Unfounded(0.0, "", np.zeros(3))
        odd = ~((film >= 0.0) & (film <= 1.0))
        founded = film <= before[rows] + ROUND
        source[rows] = np.maximum(source[rows], film)
        for piece, mine in zip(self._pieces, self._groups, strict=True):
            own = np.flatnonzero(np.isin(rows, mine))
            if not len(own):
                continue
            places = self._places(piece, rows[own], frame)
            founded[own] |= self._given(piece, places, film[own], source, frame)
        bad = odd | ~founded
        if not bad.any():
            return Unfounded(0.0, "", np.zeros(3))
        worst = int(rows[bad][np.argmax(np.nan_to_num(np.abs(film[bad]), nan=np.inf))])
        piece = self._pieces[int(self._texels.part[worst])]
        value = float(np.nan_to_num(np.abs(film[bad]), nan=np.inf).max())
        return Unfounded(value, piece.entity, self._places(piece, np.array([worst]), frame)[0])

    def _places(self, piece: Piece, rows: NDArray[Any], frame: int) -> F64:
        return piece.world(self._texels.position[rows], frame)

    def _given(self, mine: Piece, places: F64, film: F64, source: F64, frame: int) -> NDArray[np.bool_]:
        """True where another surface with at least that film was near, at the frame or on the way to it."""
        from scipy.spatial import cKDTree

        found = np.zeros(len(places), dtype=bool)
        for piece, rows in zip(self._pieces, self._groups, strict=True):
            wet = rows[source[rows] > 0.0]
            if not len(wet) or (piece.entity, piece.body) == (mine.entity, mine.body) or (piece.still and mine.still):
                continue
            now, last = (self._places(piece, wet, k) for k in (frame, max(frame - 1, 0)))
            way = float(np.linalg.norm(now - last, axis=1).max())
            if not mine.still:
                local = mine.local(places, frame)
                way += float(np.linalg.norm(places - mine.world(local, max(frame - 1, 0)), axis=1).max())
            reach = NEAR * self._texels.size + self._gap + way
            for k, near in enumerate(cKDTree(now).query_ball_point(places, reach)):
                found[k] |= bool(near) and bool((source[wet[near]] >= film[k] - ROUND).any())
        return found
