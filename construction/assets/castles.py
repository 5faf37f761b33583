"""Castles: round towers at the corners of a court, curtain walls between them, and a gatehouse with two leaves in the front wall."""

from __future__ import annotations

import itertools
import math
from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made, Place, Point
from .masonry import BattlementParameters, battlement, block
from .towers import TowerParameters, clipped, ring, tower
from .turning import moved

__all__ = ["GENERATORS"]

GAP = 2e-3
"""[m] Between bodies that stand beside one another."""
PLINTH, ROUGH = 0.08, 0.02
"""[m] How far a tower's first course and the stones of its others stand out."""
JUNCTION = 0.35
"""[m] Length of the masonry that joins a wall to a round tower."""
PIER, DEEPER = 1.3, 0.8
"""[m] Width of the gatehouse beside its passage; how much deeper than the walls it is."""
VOUSSOIRS, VOUSSOIR = 11, 0.35
"""Stones of the arch; their height [m]."""
LEAF, BEFORE = 0.08, 0.02
"""[m] Thickness of a leaf of the gate; its distance from the wall."""
SIDES = ("front", "right", "back", "left")


class CastleParameters(Parameters):
    """A castle about a court: four round towers, walls with wall walks and merlons, a gatehouse at the front whose leaves open inwards."""

    width: float = Field(default=22.0, ge=16.0, le=40.0, description="along x between the middles of towers [m]")
    depth: float = Field(default=18.0, ge=12.0, le=40.0, description="along y between the middles of towers [m]")
    wall: float = Field(default=4.5, ge=3.5, le=6.0, description="height of the wall walk [m]")
    thickness: float = Field(default=1.2, ge=0.8, le=1.6, description="of the walls [m]")
    tower: float = Field(default=4.4, ge=3.5, le=6.0, description="diameter of the towers [m]")
    higher: float = Field(default=3.0, ge=1.5, le=6.0, description="platforms of towers over the wall walk [m]")
    gate: float = Field(default=2.6, ge=2.0, le=3.2, description="clear width of the gate [m]")
    spring: float = Field(default=1.8, ge=1.5, le=2.2, description="height at which the gate's arch begins [m]")
    top: Literal["crenels", "cone"] = Field(default="crenels", description="of the towers")
    tiles: str = material("slate", "roof_tile", "copper", of="pointed roofs")
    wood: str = material("oak", "larch", of="doors")
    material: str = material("limestone", "sandstone", "granite", "gneiss")


def _put(body: Body, other: Body, by: Point, turn: float, prefix: str) -> None:
    """Add the parts of another body, turned about the z axis [rad] and moved [m]."""
    for name, part in other.parts.items():
        rolled = part.pose.euler or (0.0, 0.0, 0.0)
        (at,) = moved([part.pose.position], by, turn)
        own = part.material or (other.material if other.material != body.material else None)
        body.add(f"{prefix}{name}", part.shape, at, euler=(rolled[0], rolled[1], rolled[2] + turn), material=own)


def _castle(p: CastleParameters, rng: np.random.Generator) -> Made:
    gatehouse = Body("gatehouse", p.material)
    made = Made.of(gatehouse)
    x, y = p.width / 2, p.depth / 2
    plan = TowerParameters(
        diameter=p.tower, height=p.wall + p.higher, batter=0.0, top=p.top, tiles=p.tiles, wood=p.wood, material=p.material
    )
    # Doors look into the court.
    for name, sx, sy, turn in (("a", -1, -1, 0.75), ("b", 1, -1, -0.75), ("c", 1, 1, -0.25), ("d", -1, 1, 0.25)):
        body = made.bodies[f"tower_{name}"] = Body("castle tower", p.material)
        one = tower(plan, rng)
        _put(body, one.main, (sx * x, sy * y, 0), turn * math.pi, "")
        if "platform" in one.places:
            made.places[f"tower_{name}"] = Place((sx * x, sy * y, plan.height), one.places["platform"].size, body=f"tower_{name}")
    half = p.gate / 2 + PIER
    _gatehouse(gatehouse, p, -y)
    made.places["walk"] = Place((0, -y, _top(p)), (2 * half - 0.2, 0.5 * p.thickness))
    ends = {"front": ((-x, -half - GAP), (half + GAP, x)), "back": ((-x, x),), "right": ((-y, y),), "left": ((-y, y),)}
    for k, side in enumerate(SIDES):
        for j, (a, b) in enumerate(ends[side]):
            name = f"wall_{side}" if len(ends[side]) == 1 else f"wall_{side}_{'ab'[j]}"
            body = made.bodies[name] = Body("castle wall", p.material)
            reach = x if side in ("front", "back") else y
            _wall(body, p, rng, (a, b), (a == -reach, b == reach))
            turned, by = Body(body.role, p.material), (0, -y, 0) if k % 2 == 0 else (0, -x, 0)
            (at,) = moved([by], (0, 0, 0), k * math.pi / 2)
            _put(turned, body, at, k * math.pi / 2, "")
            made.bodies[name] = turned
    for name, sign in (("left", -1), ("right", 1)):
        _leaf(made, p, name, sign, -y + (p.thickness + DEEPER) / 2)
    return made


def _wall(
    body: Body, p: CastleParameters, rng: np.random.Generator, ends: tuple[float, float], towers: tuple[bool, bool]
) -> None:
    """A wall along x that looks to -y, its middle at y = 0, between two places or the middles of towers."""
    away = p.tower / 2 + PLINTH + ROUGH + 3 * GAP + JUNCTION
    low, high = (e + s * away * t for e, t, s in zip(ends, towers, (1, -1), strict=True))
    number = max(1, math.ceil((high - low) / 8.0))
    long = (high - low) / number
    for k in range(number):
        plan = BattlementParameters(length=long, height=p.wall, thickness=p.thickness, material=p.material)
        _put(body, battlement(plan, rng).main, (low + (k + 0.5) * long, 0, 0), 0.0, f"bay_{k + 1}_")
    for name, end, joined, sign in (("a", ends[0], towers[0], 1), ("b", ends[1], towers[1], -1)):
        if joined:
            _junction(body, p, name, end, sign, away)


def _junction(body: Body, p: CastleParameters, name: str, middle: float, sign: int, away: float) -> None:
    """Masonry from the flat end of a wall to the sides of a round tower, in its plinth's height and above."""
    half, courses = p.thickness / 2, max(5, min(22, round((p.wall + p.higher - 0.85) / 0.5)))
    plinth = (p.wall + p.higher - 0.85) / courses
    for level, (a, b, out) in enumerate(((0.0, plinth, PLINTH + ROUGH), (plinth, p.wall, ROUGH))):
        plan = ring(p.tower / 2 + out + 3 * GAP)
        for s in (1.0, -1.0):
            plan = clipped(plan, 0.0, s, half)
        line = sorted(((u, v) for u, v in plan if u > 0), key=lambda q: q[1])
        for k, ((u0, v0), (u1, v1)) in enumerate(itertools.pairwise(line)):
            corners = [(u0, v0), (u1, v1), (away, v1), (away, v0)]
            body.hull(f"junction_{name}_{level + 1}_{k + 1}", [(middle + sign * u, v, z) for u, v in corners for z in (a, b)])


def _top(p: CastleParameters) -> float:
    """Height of the gatehouse's platform [m]."""
    return max(p.wall + 0.8, p.spring + p.gate / 2 + VOUSSOIR + 0.5)


def _gatehouse(body: Body, p: CastleParameters, y: float) -> None:
    """Piers, an arch of voussoirs, the wall above it and merlons on both faces."""
    deep, half, top = (p.thickness + DEEPER) / 2, p.gate / 2 + PIER, _top(p)
    courses = max(3, round(p.spring / 0.45))
    for side, s in (("left", -1), ("right", 1)):
        for k in range(courses):
            a, b = sorted((s * p.gate / 2, s * half))
            levels = k * p.spring / courses, (k + 1) * p.spring / courses
            block(body, f"pier_{side}_{k + 1}", (a, y - deep, levels[0]), (b, y + deep, levels[1]), chamfer=0.02)
    angles = [math.pi * k / VOUSSOIRS for k in range(VOUSSOIRS + 1)]
    inner, outer = ([(r * math.cos(t), p.spring + r * math.sin(t)) for t in angles] for r in (p.gate / 2, p.gate / 2 + VOUSSOIR))
    for k in range(VOUSSOIRS):
        stones = (inner[k], inner[k + 1], outer[k], outer[k + 1])
        body.hull(f"voussoir_{k + 1}", [(u, y + v, z) for u, z in stones for v in (-deep, deep)])
        above = (outer[k], outer[k + 1], (outer[k][0], top), (outer[k + 1][0], top))
        body.hull(f"spandrel_{k + 1}", [(u, y + v, z) for u, z in above for v in (-deep, deep)])
    for side, s in (("left", -1), ("right", 1)):
        a, b = sorted((s * outer[0][0], s * half))
        block(body, f"shoulder_{side}", (a, y - deep, p.spring), (b, y + deep, top), chamfer=0.02)
    number = max(2, round(2 * half / 1.4))
    pitch = 2 * half / number
    for face, v in (("front", y - deep), ("back", y + deep - 0.35)):
        block(body, f"breast_{face}", (-half, v, top), (half, v + 0.35, top + 0.55), chamfer=0.015)
        for k in range(number):
            a = -half + (k + 0.18) * pitch
            block(body, f"merlon_{face}_{k + 1}", (a, v, top + 0.55), (a + 0.64 * pitch, v + 0.35, top + 1.3), chamfer=0.015)
    axis = p.gate / 2 + 0.15
    for side, s in (("left", -1), ("right", 1)):
        for k, z in enumerate(_hinges(p)):
            a, b = sorted((s * (axis + 0.002), s * (axis + 0.1)))
            body.box(f"pintle_{side}_{k + 1}", (a, y + deep, z), (b, y + deep + BEFORE + LEAF, z + 0.12), material="cast_iron")


def _hinges(p: CastleParameters) -> tuple[float, float]:
    """Heights of the two hinges of a leaf [m]."""
    return 0.35, p.spring + 0.2


def _leaf(made: Made, p: CastleParameters, name: str, sign: int, face: float) -> None:
    """A leaf of planks with rails on the court's side, before a face of the gatehouse; it turns into the court."""
    leaf = made.bodies[f"leaf_{name}"] = Body("leaf of a castle gate", p.wood)
    axis, low, high = p.gate / 2 + 0.15, 0.03, p.spring + p.gate / 2 + 0.1
    front, rails, back = face + BEFORE, face + BEFORE + 0.05, face + BEFORE + LEAF
    planks = 7
    for k in range(planks):
        a, b = sorted(sign * (0.003 + (axis - 0.003) * j / planks) for j in (k, k + 1))
        leaf.box(f"plank_{k + 1}", (a, front, low), (b, rails, high))
    for k, z in enumerate((*_hinges(p), 0.5 * sum(_hinges(p)))):
        a, b = sorted((sign * 0.05, sign * axis))
        leaf.box(f"rail_{k + 1}", (a, rails, z - 0.02), (b, back, z + 0.14))
    made.joints[f"leaf_{name}"] = Joint(
        f"leaf_{name}",
        "hinge",
        (sign * axis, back, _hinges(p)[0] + 0.06),
        axis=(0, 0, -sign),
        range=(0.0, math.radians(95)),
        damping=15.0,
        friction=8.0,
    )


GENERATORS = (
    Generator("castle", "castle: four towers, curtain walls about a court, a gatehouse whose two leaves open", CastleParameters, _castle,
              ("fortress", "walls", "gate", "court", "medieval", "keep", "burg", "stronghold"), motion="static"),
)  # fmt: skip
