"""The log of tears: what a frame's channels hold of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.categories.cloth.tears import following
from .tearing import Tear

if TYPE_CHECKING:
    from ..boundaries import Surround
    from .pieces import Piece
    from .setup import ClothReport

__all__ = ["TearEvent", "cause_of", "tear_channels", "torn_length"]


class TearEvent(NamedTuple):
    """A tear with its time and cause."""

    time: float
    """End of the exchange after which it opened [s]."""
    first: int
    """Written vertex at which the torn part's begin."""
    cause: int
    tear: Tear


def cause_of(report: ClothReport, surround: Surround) -> int:
    """Row of the moving body that the sheets pushed or pulled most; -1: none, but air, weight or their own motion."""
    moving = np.array([b.motion != "static" for b in surround.boundaries], dtype=bool)
    size = np.where(moving, np.linalg.norm(report.impulse[:, :3], axis=1), 0.0)
    return int(np.argmax(size)) if size.max(initial=0.0) > 0.0 else -1


def torn_length(pieces: Sequence[Piece]) -> float:
    """Length at rest of all edges that are open [m]."""
    total = 0.0
    for piece in pieces:
        if piece.tearing is not None:
            side = np.flatnonzero(piece.tearing.opened).astype(np.int32)
            total += 0.5 * float(np.linalg.norm(piece.rest[following(side)] - piece.rest[side], axis=1).sum())
    return total


def tear_channels(pieces: Sequence[Piece], events: Sequence[TearEvent]) -> dict[str, Any]:
    """Channels of a frame in which these tears happened."""
    opened = [np.zeros(len(p.rest), dtype=np.uint8) if p.tearing is None else p.tearing.opened.astype(np.uint8) for p in pieces]
    sides = [np.column_stack([np.full(len(e.tear.sides), k), e.tear.sides + e.first]) for k, e in enumerate(events)]
    around = [np.column_stack([np.full(len(e.tear.triangles), k), e.first + 3 * e.tear.triangles]) for k, e in enumerate(events)]
    places = [e.tear.places for e in events]
    return {
        "edge/open": np.concatenate(opened),
        "tear/time": np.array([e.time for e in events]),
        "tear/corner": np.array([e.first + e.tear.corner for e in events], dtype=np.int32),
        "tear/point": np.array([e.tear.point for e in events]).reshape(-1, 3),
        "tear/tension": np.array([e.tear.tension for e in events]),
        "tear/cause": np.array([e.cause for e in events], dtype=np.int32),
        "tear/side": np.concatenate([np.empty((0, 3)), *sides]).astype(np.int32),
        "tear/triangle": np.concatenate([np.empty((0, 2)), *around]).astype(np.int32),
        "tear/place": np.concatenate([np.empty((0, 3, 3)), *places]),
    }
