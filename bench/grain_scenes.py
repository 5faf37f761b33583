"""Parts of the scenes with columns and heaps of grains: slabs, rough ground, a pipe, the engine's setup, walls at rest."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..simulation.boundaries import BodyState, Boundary
from ..simulation.particles.engine import Grains
from ..simulation.particles.setup import GrainSetup, Kind, wall_law
from ..worlds.arrays import F64
from ..worlds.built import TriangleMesh

__all__ = ["EXCHANGE", "SAND", "SPREAD", "G", "pipe", "rest", "rough_ground", "setup_of", "slab", "still"]

G = 9.81
SAND = Kind("sand", 2600.0, 1e7, 0.25, 0.3, 0.5, 0.1, 0.0)
"""Contact settings that `skill://particles` names for sand: friction 0.5, rolling resistance 0.1."""
SPREAD = 0.15
EXCHANGE = 1e-2
"""[s] Between looks of the host at the walls, which stand still."""


def slab(low: Any, high: Any, name: str) -> Boundary:
    """A box with outward faces between two corners [m]."""
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], dtype=np.int32)
    return Boundary(name, TriangleMesh(corners, faces), "static", True, 0.0)


def rough_ground(low: Any, high: Any, pitch: float, height: float, name: str) -> Boundary:
    """Ground with a random height up to `height` at every `pitch`, its highest points at z = 0, as a sheet."""
    counts = [max(2, round((high[k] - low[k]) / pitch) + 1) for k in (0, 1)]
    x, y = (np.linspace(low[k], high[k], counts[k]) for k in (0, 1))
    z = -height * np.random.default_rng(11).random(counts)
    points = np.stack([*np.meshgrid(x, y, indexing="ij"), z], axis=-1).reshape(-1, 3)
    corner = np.arange(counts[0] * counts[1]).reshape(counts)
    a, b, c, d = (corner[s].ravel() for s in (np.s_[:-1, :-1], np.s_[1:, :-1], np.s_[1:, 1:], np.s_[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)
    return Boundary(name, TriangleMesh(points, faces), "static", False, 0.0)


def pipe(radius: float, height: float, name: str, sides: int = 64) -> Boundary:
    """An open upright pipe, a sheet whose inside has at least this radius."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = radius / math.cos(np.pi / sides) * np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=1)
    points = np.concatenate([ring, ring + np.array([0.0, 0.0, height])])
    k = np.arange(sides)
    n = (k + 1) % sides
    faces = np.concatenate([np.stack([k, n, n + sides], axis=1), np.stack([k, n + sides, k + sides], axis=1)]).astype(np.int32)
    return Boundary(name, TriangleMesh(points, faces), "static", False, 0.0)


def setup_of(
    kind: Kind, position: F64, radius: F64, walls: list[Boundary], smooth: set[int], lower: Any, upper: Any, device: str
) -> GrainSetup:
    """Grains of one kind at rest; walls in `smooth` have no friction, the others that of the grains."""
    laws = {(b, 0): wall_law(kind, 0.0 if b in smooth else kind.friction, kind.restitution) for b in range(len(walls))}
    for b in smooth:
        laws[b, 0] = replace(laws[b, 0], rolling=0.0)
    return GrainSetup(
        lower=np.asarray(lower, dtype=float), upper=np.asarray(upper, dtype=float), kinds=(kind,), position=position,
        velocity=np.zeros_like(position), radius=radius, kind=np.zeros(len(radius), dtype=np.int32),
        gravity=np.array([0.0, 0.0, -G]), boundaries=tuple(walls), centers=tuple(np.zeros(3) for _ in walls), walls=laws, device=device,
    )  # fmt: skip


def still(count: int, away: int | None = None) -> BodyState:
    """Walls at rest; the one that is taken away stands high above."""
    zero = np.zeros((count, 3))
    place = zero.copy()
    if away is not None:
        place[away, 2] = 100.0
    return BodyState(
        place, np.tile(np.eye(3), (count, 1, 1)), place.copy(), zero, zero, np.zeros(count), np.zeros((count, 3, 3)), zero
    )


def rest(engine: Grains, walls: BodyState, seconds: float) -> int:
    """Go on for some seconds with walls that stand still; the steps that it took."""
    steps = 0
    for _ in range(max(1, round(seconds / EXCHANGE))):
        steps += engine.step(EXCHANGE, walls).steps
    return steps
