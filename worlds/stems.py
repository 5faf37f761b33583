"""Trunks and boulders of a landscape as upright solids: what stands in the way of walkers and bodies.

Sizes are those of the forms that are drawn, per metre of height. Shrubs, grass and pebbles yield and stand in nobody's way.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .arrays import F64, RigidPose
from .built import Convex
from .landscape import SavedLandscape

__all__ = ["FORMS", "ROCK_MIDDLE", "SINK", "StemForm", "Stems", "pieces_of", "stem_table", "stems_from", "stems_of"]


class StemForm(NamedTuple):
    """The solid part of a plant or stone, per metre of its height."""

    radius: float
    top: float
    """Height of its top above the foot."""


FORMS: dict[str, StemForm] = {
    "broad": StemForm(0.028, 0.4),
    "cone": StemForm(0.02, 0.95),
    "palm": StemForm(0.07, 0.86),
    "column": StemForm(0.06, 0.97),
    "rock": StemForm(0.75, 0.95),
}
"""By the shape of a species. `radius` holds the foot of a trunk and a palm's lean; a boulder is the round that holds it."""
LEAST_RADIUS = 0.02
"""Own choice: thinner ones bend [m]."""
LEAST_TOP = 0.15
"""Own choice: what is lower is stepped over or rolled over [m]: pebbles, saplings."""


SAPLING = 4e-6
"""Own choice: share of a ground's area below which the walls of a trunk are dust, which gives no entity its size: 0.26 m^2, a tree
of 2 m, on 256 x 256 m."""
SINK = 0.3
"""Depth of a trunk's end below its foot [m]."""


UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
ROCK_MIDDLE = 0.3 / 0.95
"""Height of the widest place of a boulder over that of its top, as it is drawn."""
_TURN, _RISE = (v.ravel() for v in np.meshgrid(2 * np.pi * np.arange(12) / 12, np.array([-0.9, -0.45, 0.0, 0.45, 0.9])))
_BALL: F64 = np.concatenate(
    [np.stack([np.cos(_TURN) * np.cos(_RISE), np.sin(_TURN) * np.cos(_RISE), np.sin(_RISE)], axis=1), [[0, 0, -1.0], [0, 0, 1.0]]]
)
"""Points of a unit ball, whose hull is a boulder."""


class Stems(NamedTuple):
    """Upright solids, all shapes (n,) unless said otherwise."""

    foot: F64
    """Middle of the foot [m], shape (n, 3)."""
    radius: F64
    """[m]"""
    top: F64
    """Height above the foot [m]."""
    rock: np.ndarray
    """True where it is a boulder."""
    plant: np.ndarray
    """Its number among the plants of the landscape."""

    def inside(self, low: F64, high: F64) -> Stems:
        """Those that reach into a rectangle [m], shapes (2,)."""
        reach = self.radius[:, None]
        keep = (self.foot[:, :2] + reach >= low) & (self.foot[:, :2] - reach <= high)
        return self.chosen(np.all(keep, axis=1))

    def standing(self, low: F64, high: F64) -> Stems:
        """Those whose feet are in a rectangle [m], shapes (2,), without saplings that are dust beside its ground."""
        walls = 2.0 * np.pi * self.radius * self.top
        inside = ((self.foot[:, :2] >= low) & (self.foot[:, :2] <= high)).all(axis=1)
        return self.chosen(inside & (walls >= SAPLING * float(np.prod(high - low))))

    def chosen(self, keep: np.ndarray) -> Stems:
        """Those that a mask or indices choose."""
        return Stems(*(values[keep] for values in self))


def stems_of(land: SavedLandscape) -> Stems:
    """All trunks and boulders of a landscape.

    Raises:
        EvidenceError: the file is missing or damaged.
    """
    if "plant_position" not in land.names:
        none = np.zeros(0)
        return Stems(np.zeros((0, 3)), none, none, none.astype(bool), none.astype(np.int64))
    shapes = land.about["plant_shapes"]
    kind, height = land.raw("plant_kind").astype(np.int64), land.raw("plant_height").astype(np.float64)
    forms = [FORMS.get(shape, StemForm(0.0, 0.0)) for shape in shapes]
    radius = np.array([f.radius for f in forms])[kind] * height
    top = np.array([f.top for f in forms])[kind] * height
    keep = np.flatnonzero((radius >= LEAST_RADIUS) & (top >= LEAST_TOP))
    rock = np.array([shape == "rock" for shape in shapes])[kind]
    return Stems(land.raw("plant_position")[keep].astype(np.float64), radius[keep], top[keep], rock[keep], keep)


def stem_table(stems: Stems) -> F64:
    """As one table, for a file: foot (3), radius, top, whether a boulder, number of the plant; shape (n, 7)."""
    return np.column_stack([stems.foot, stems.radius, stems.top, stems.rock, stems.plant]).astype(np.float64)


def stems_from(table: np.ndarray) -> Stems:
    """Stems from a table of `stem_table`.

    Raises:
        ValueError: it is no such table.
    """
    if table.ndim != 2 or table.shape[1] != 7 or table.dtype != np.float64 or not np.isfinite(table).all():
        raise ValueError(f"shape {table.shape} of {table.dtype}, not seven columns of finite numbers")
    if not (table[:, 3:5] > 0).all():
        raise ValueError("a radius or height that is not positive")
    return Stems(table[:, :3], table[:, 3], table[:, 4], table[:, 5] > 0.5, table[:, 6].astype(np.int64))


def pieces_of(stems: Stems, sink: float = SINK) -> tuple[Convex, ...]:
    """Convex pieces in place of trunks (upright cylinders) and boulders (hulls of their round), in the world's frame.

    Args:
        stems: which; `Stems.inside` gives those of a rectangle.
        sink: how far a trunk reaches below its foot [m], so that no slope leaves a gap under it.
    """
    found = []
    for foot, radius, top, rock in zip(stems.foot, stems.radius, stems.top, stems.rock, strict=True):
        if rock:
            pose = RigidPose(foot + np.array([0.0, 0.0, ROCK_MIDDLE * top]), UPRIGHT)
            found.append(Convex("hull", (), pose, _BALL * [radius, radius, (1.0 - ROCK_MIDDLE) * top]))
        else:
            pose = RigidPose(foot + np.array([0.0, 0.0, 0.5 * (top - sink)]), UPRIGHT)
            found.append(Convex("cylinder", (float(radius), float(0.5 * (top + sink))), pose, np.zeros((0, 3))))
    return tuple(found)
