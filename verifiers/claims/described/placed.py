"""Bodies at a frame as words of place see them: surfaces and centres, with heights along gravity."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...scene.bounds import SUPPORT_SLOPE
from ...scene.surfaces import surfaces_of
from .bounds import TOUCHING
from .outlines import Seen, frame_along, is_under

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate

__all__ = ["Place", "apart"]


class Place:
    """Bodies at a frame, turned so that the third axis points against gravity."""

    def __init__(self, candidate: Candidate, grounds: list[str], frame: int) -> None:
        self.candidate, self.frame = candidate, frame
        self.grounds = [g for g in grounds if g in candidate.solids]
        self.turn = frame_along(np.array(candidate.spec.simulation.gravity, dtype=np.float64))
        self.slack = TOUCHING * candidate.spec.simulation.limits.contact_gap
        self._seen: dict[str, Seen] = {}

    def seen(self, body: str) -> Seen:
        """Its triangles and centre."""
        if body not in self._seen:
            parts = self.candidate.entity(body).parts
            corners = [self.candidate.surface(body, p.part, self.frame)[p.render.faces] for p in parts]
            self._seen[body] = Seen(np.concatenate(corners) @ self.turn.T, self.turn @ self.candidate.center(body, self.frame))
        return self._seen[body]

    def box(self, body: str) -> F64:
        """Least and greatest corner [m], shape (2, 3)."""
        points = self.seen(body).triangles.reshape(-1, 3)
        return np.stack([points.min(axis=0), points.max(axis=0)])

    def center(self, body: str) -> F64:
        """Centre of mass [m]."""
        return self.seen(body).center

    def touches(self, a: str, b: str) -> bool:
        """True where their surfaces are as near as those that touch; a liquid has none that bears or is borne."""
        parts = surfaces_of(self.candidate).parts_of
        if not parts.get(a) or not parts.get(b):
            return False
        return apart(self.box(a), self.box(b)) <= self.slack and self.gap(a, b) <= self.slack

    def gap(self, a: str, b: str, offset: F64 | None = None) -> float:
        """Distance of their surfaces [m], with the first moved by an offset [m], shape (3,)."""
        return surfaces_of(self.candidate).gap(a, b, self.frame, offset=offset).distance

    def bears(self, below: str, above: str) -> bool:
        """True where a body that touches another stands in the way of its falling: lifted, that parts from it.

        The least rise of their distance per lift is that of checks of support (`SUPPORT_SLOPE`).
        """
        return self.gap(above, below, self.turn[2] * self.slack) - self.gap(above, below) >= SUPPORT_SLOPE * self.slack

    def under(self, lower: str, upper: str) -> bool:
        """True where one body lies under another as seen along gravity."""
        return is_under(self.seen(lower), self.seen(upper), self.slack)


def apart(a: F64, b: F64) -> float:
    """Distance of two boxes [m]; 0 where they meet."""
    return float(np.linalg.norm(np.maximum(np.maximum(a[0] - b[1], b[0] - a[1]), 0.0)))
