"""Seeded defects of lumps of one mesh: apart from each other, in the air, and joined."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.spec import Box, Limits, Mesh, Part, Pose
from ..worlds.small_worlds import mesh_of
from ._support_worlds import RNG, Scene
from .cases import Mechanism, World

__all__ = ["LUMP_MECHANISMS"]

WIDE = 0.02
"""Gap over which no two lumps of this suite hang together, less than 1.6 m in diagonal [m]."""
GAP = Limits().contact_gap


def _lumps(folder: Path, m: float, rng: RNG, *culprits: str, between: bool = False) -> World:
    """A mesh of two blocks over each other, m apart; or a bar joins them."""
    scene, motion = Scene(rng), "static" if rng.random() < 0.5 else "dynamic"
    x, y, z = rng.uniform(0.05, 0.3, 3).tolist()
    points: list[Any] = []
    faces: list[Any] = []
    for height in rng.permutation([z / 2, 1.5 * z + m]):
        made = mesh_of(Box(size=(x, y, z)))
        faces += (made.faces + len(points)).tolist()
        points += (made.vertices + np.array([0, 0, height])).tolist()
    shape = Mesh(vertices=[tuple(v) for v in points], faces=[tuple(f) for f in faces])
    parts: list[Any] = [Part(shape=shape)]
    if between:
        parts.append(Part(shape=Box(size=(0.5 * x, 0.5 * y, m)), pose=Pose(position=(0, 0, z + m / 2))))
    scene.add("thing", *parts, at=(0, 0, 1e-4), motion=motion)
    return scene.world(folder, *culprits, still=True)


def _lumps_apart(folder: Path, m: float, rng: RNG) -> World:
    return _lumps(folder, m, rng, "thing")


def _lumps_together(folder: Path, m: float, rng: RNG) -> World:
    return _lumps(folder, m, rng)


def _lumps_joined(folder: Path, m: float, rng: RNG) -> World:
    return _lumps(folder, m, rng, between=True)


LUMP_MECHANISMS = (
    Mechanism("lumps-apart", "lumps of one mesh with nothing between", True, _lumps_apart, WIDE, 0.6, "m"),
    Mechanism("lumps-together", "lumps of one mesh that touch", False, _lumps_together, 1e-6, 0.95 * GAP, "m"),
    Mechanism("lumps-joined", "lumps of one mesh with a bar between", False, _lumps_joined, WIDE, 0.6, "m"),
)
"""Mechanisms of the suite `support` about lumps of one mesh."""
