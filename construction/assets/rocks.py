"""Rocks by joint planes: boulders and pebbles."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from ...worlds.arrays import F64
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Made

__all__ = ["GENERATORS"]


def _directions(count: int, rng: np.random.Generator) -> F64:
    """Unit vectors spread evenly with some disorder."""
    k = np.arange(count) + 0.5
    z, turn = 1 - 2 * k / count, math.pi * (1 + math.sqrt(5)) * k
    flat = np.sqrt(1 - z * z)
    points = np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1) + 0.3 / math.sqrt(count) * rng.normal(
        size=(count, 3)
    )
    found: F64 = points / np.linalg.norm(points, axis=1, keepdims=True)
    return found


def _planes(roundness: float, rng: np.random.Generator) -> F64:
    """Half-spaces (n, d) with n x + d <= 0 of a block by three sets of joints, its edges worn by planes about a ball."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    tilt = 0.25 * rng.normal(size=(6, 3))
    normals = np.concatenate([turn, -turn]) + tilt
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    joints = np.column_stack([normals, -rng.uniform(0.7, 0.95, len(normals))])
    around = _directions(18 + round(38 * roundness), rng)
    worn = np.column_stack([around, -rng.uniform(1.06 - 0.16 * roundness, 1.22 - 0.24 * roundness, len(around))])
    return np.concatenate([joints, worn])


def _corners(planes: F64) -> F64:
    from scipy.spatial import HalfspaceIntersection

    found = HalfspaceIntersection(planes, np.zeros(3)).intersections
    rounded = np.unique(np.round(found, 7), axis=0)
    corners: F64 = rounded[:250]
    return corners


class BoulderParameters(Parameters):
    """A boulder cut by joint planes and worn round, of one block, with a joint through it, or in beds."""

    width: float = Field(default=1.0, ge=0.1, le=4.0, description="along x [m]")
    depth: float = Field(default=0.8, ge=0.1, le=4.0, description="along y [m]")
    height: float = Field(
        default=0.7, ge=0.08, le=3.0, description="along z; at most 1.2 times the lesser of width and depth [m]"
    )
    roundness: float = Field(default=0.35, ge=0.0, le=1.0, description="0 is sharp-edged, 1 worn round")
    structure: Literal["massive", "jointed", "bedded"] = Field(
        default="massive", description="one block, two blocks at a joint, or layers"
    )
    material: str = material("granite", "limestone", "sandstone", "basalt", "gneiss", "slate")


def _boulder(p: BoulderParameters, rng: np.random.Generator) -> Made:
    body = Body("boulder", p.material)
    planes = _planes(p.roundness, rng)
    floor = float(rng.uniform(-0.62, -0.5))
    base = np.array([[0.0, 0.0, -1.0, floor]])
    corners = _corners(np.concatenate([planes, base]))
    low, high = corners.min(0), corners.max(0)
    size = np.array([p.width, p.depth, min(p.height, 1.2 * min(p.width, p.depth))])

    def scaled(points: F64) -> list[tuple[float, float, float]]:
        moved = (points - low) / (high - low) * size - np.array([p.width / 2, p.depth / 2, 0.0])
        return [(float(a), float(b), float(c)) for a, b, c in moved]

    if p.structure == "massive":
        body.hull("stone", scaled(corners))
    elif p.structure == "jointed":
        cut = float(rng.uniform(-0.15, 0.15))
        lean = np.array([1.0, float(rng.uniform(-0.3, 0.3)), float(rng.uniform(-0.25, 0.25))])
        lean /= np.linalg.norm(lean)
        inner = planes.copy()
        inner[:, 3] += rng.uniform(0.08, 0.2)
        body.hull("stone_1", scaled(_cut(np.concatenate([planes, base]), np.append(lean, -cut))))
        body.hull("stone_2", scaled(_cut(np.concatenate([inner, base]), np.append(-lean, cut))))
    else:
        layers = int(rng.integers(4, 7))
        levels = np.linspace(low[2], high[2], layers + 1)
        levels[1:-1] += rng.uniform(-0.25, 0.25, layers - 1) * (levels[1] - levels[0])
        for k in range(layers):
            worn = 0.0 if k == 0 else float(rng.uniform(0.0, 0.24))
            body.hull(f"bed_{k + 1}", scaled(_bed(planes, worn, (float(levels[k]), float(levels[k + 1])))))
    return Made.of(body)


def _bed(planes: F64, worn: float, levels: tuple[float, float]) -> F64:
    """Corners of a layer whose sides are worn back, less where nothing of it would be left."""
    slab = np.array([[0, 0, -1.0, levels[0]], [0, 0, 1.0, -levels[1]]])
    for share in (1.0, 0.5, 0.2, 0.0):
        inner = planes.copy()
        inner[:, 3] += share * worn
        if _room(np.concatenate([inner, slab]))[3] > 0.03:
            break
    return _cut(np.concatenate([inner, slab[:1]]), slab[1])


def _room(planes: F64) -> F64:
    """Middle and radius of the greatest ball within planes, (4,); the radius is -1 where there is none."""
    from scipy.optimize import linprog

    reach = np.linalg.norm(planes[:, :3], axis=1)
    best = linprog([0, 0, 0, -1], np.column_stack([planes[:, :3], reach]), -planes[:, 3], bounds=[(None, None)] * 3 + [(0, None)])
    return np.array(best.x) if best.success else np.array([0.0, 0.0, 0.0, -1.0])


def _cut(planes: F64, plane: F64) -> F64:
    """Corners of what is left within planes and one plane more."""
    from scipy.spatial import HalfspaceIntersection

    every = np.concatenate([planes, plane[None]])
    corners: F64 = np.unique(np.round(HalfspaceIntersection(every, _room(every)[:3]).intersections, 7), axis=0)[:250]
    return corners


class PebblesParameters(Parameters):
    """Loose pebbles on a patch of ground, each a body."""

    count: int = Field(default=9, ge=3, le=40, description="pebbles")
    size: float = Field(default=0.06, ge=0.01, le=0.3, description="length of the greatest [m]")
    spread: float = Field(default=1.6, ge=1.1, le=4.0, description="room for each over its length")
    roundness: float = Field(default=0.9, ge=0.0, le=1.0, description="0 is sharp-edged, 1 worn round")
    material: str = material("granite", "limestone", "sandstone", "basalt", "marble")


def _pebbles(p: PebblesParameters, rng: np.random.Generator) -> Made:
    made = Made()
    spots: list[tuple[float, float, float]] = []
    radius = p.spread * p.size * math.sqrt(p.count) / 2
    for k in range(p.count):
        length = p.size * (1.0 if k == 0 else float(rng.uniform(0.45, 1.0)))
        for _ in range(400):
            a, r = float(rng.uniform(0, 2 * math.pi)), radius * math.sqrt(float(rng.uniform()))
            x, y = r * math.cos(a), r * math.sin(a)
            if all(math.hypot(x - u, y - v) > 0.5 * (length + other) * 1.02 + 0.001 for u, v, other in spots):
                break
            radius *= 1.01
        spots.append((x, y, length))
        corners = _corners(np.concatenate([_planes(p.roundness, rng), [[0.0, 0.0, -1.0, -0.62]]]))
        turn = float(rng.uniform(0, 2 * math.pi))
        flat = np.array([1.0, float(rng.uniform(0.6, 0.9)), float(rng.uniform(0.4, 0.65))])
        points = corners * flat
        points *= length / 2 / np.linalg.norm(points[:, :2], axis=1).max()
        c, s = math.cos(turn), math.sin(turn)
        points = points @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T
        points += np.array([x, y, -points[:, 2].min()])
        body = made.bodies[MAIN if k == 0 else f"pebble_{k + 1}"] = Body("pebble", p.material)
        body.hull("stone", points)
    return made


GENERATORS = (
    Generator("boulder", "boulder cut by joints and worn, of one block, split or in beds", BoulderParameters, _boulder,
              ("rock", "stone", "cliff", "mountain", "landscape", "scree")),
    Generator("pebbles", "loose pebbles on a patch of ground", PebblesParameters, _pebbles,
              ("stones", "gravel", "beach", "rocks", "rubble", "landscape")),
)  # fmt: skip
