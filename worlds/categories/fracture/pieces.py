"""Sizes and strengths of the pieces of a built breakable body, for solver and judge alike."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...bonds import WORLD
from .facts import CRUMBLE

if TYPE_CHECKING:
    from ...arrays import I32
    from ...built import BuiltEntity
    from ...spec import Breakable

__all__ = ["bonded_pairs", "crumble_of", "crumbled_force", "middle_size", "piece_overlap"]

TIGHT = 1e-4
"""Overlap of pieces in contact, in parts of the middle piece's size: contacts sink by that much under load."""
CORNERS = 20.0
"""Contact points over which a crumbled face carries its load."""


def middle_size(built: BuiltEntity) -> float:
    """Edge of a cube as large as the middle piece [m]."""
    return float(np.cbrt(np.median([b.volume for b in built.bodies])))


def crumble_of(breakable: Breakable, built: BuiltEntity) -> float:
    """Distance that two pieces may close over a face that they shared [m]."""
    declared = breakable.bond.crumble
    if declared is not None:
        return declared
    if breakable.pattern.kind == "bricks":
        return breakable.pattern.joint / 2
    return CRUMBLE * middle_size(built)


def piece_overlap(breakable: Breakable, built: BuiltEntity) -> float:
    """Depth that two pieces may lie in one another [m]: what crumbled, and `TIGHT` of a piece."""
    return crumble_of(breakable, built) + TIGHT * middle_size(built)


def crumbled_force(breakable: Breakable, built: BuiltEntity) -> float:
    """Most that a contact point carries while its face crumbles [N]: what the bond bore in shear, shared by the points."""
    assert built.bonds is not None
    area = float(np.mean(built.bonds.area)) if len(built.bonds) else 0.0
    return breakable.bond.shear * area / CORNERS


def bonded_pairs(built: BuiltEntity) -> I32:
    """Pairs of pieces that share a face, the smaller index first, shape (p, 2), sorted."""
    assert built.bonds is not None
    inner = built.bonds.pieces[built.bonds.pieces[:, 1] != WORLD]
    return np.asarray(np.unique(np.sort(inner, axis=1), axis=0), dtype=np.int32)
