"""Columns, arches and walls of stones that touch, or that lie loosely."""

from __future__ import annotations

import itertools
import math
from typing import Literal

import numpy as np
from pydantic import Field

from ...worlds.arrays import F64
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Made, Place
from .railings import spindle

__all__ = ["GENERATORS", "BattlementParameters", "battlement", "block"]

GAP = 1.1e-3
"""Between loose stones [m]."""


def block(
    body: Body,
    name: str,
    low: tuple[float, float, float],
    high: tuple[float, float, float],
    *,
    chamfer: float = 0.01,
    material: str | None = None,
) -> None:
    """Add a stone whose front and back are chamfered about their edges, so that its joints show."""
    c = min(chamfer, 0.3 * min(h - a for a, h in zip(low, high, strict=True)))
    points = []
    for y, inset in ((low[1], c), (low[1] + c, 0.0), (high[1] - c, 0.0), (high[1], c)):
        points += [(x, y, z) for x in (low[0] + inset, high[0] - inset) for z in (low[2] + inset, high[2] - inset)]
    body.hull(name, points, material=material)


class ColumnParameters(Parameters):
    """A column: plinth and turned base, shaft with entasis, capital with abacus."""

    height: float = Field(default=3.0, ge=1.0, le=6.0, description="over all [m]")
    slenderness: float = Field(default=8.0, ge=5.0, le=10.0, description="height over the shaft's lower diameter")
    order: Literal["tuscan", "doric"] = Field(default="tuscan", description="mouldings; doric has a fluted shaft and no base")
    entasis: float = Field(default=0.83, ge=0.7, le=1.0, description="upper diameter of the shaft over the lower one")
    drums: int = Field(default=4, ge=1, le=8, description="stones of the shaft, with joints that show")
    material: str = material("limestone", "marble", "sandstone", "granite")


def _column(p: ColumnParameters, rng: np.random.Generator) -> Made:
    body = Body("column", p.material)
    r = p.height / p.slenderness / 2
    base, capital = (0.0 if p.order == "doric" else r), 0.9 * r
    if base:
        body.box("plinth", (-1.4 * r, -1.4 * r, 0), (1.4 * r, 1.4 * r, 0.35 * r))
        lower = [
            (1.38 * r, 0.35 * r),
            (1.4 * r, 0.45 * r),
            (1.33 * r, 0.6 * r),
            (1.1 * r, 0.66 * r),
            (1.12 * r, 0.76 * r),
            (1.22 * r, 0.84 * r),
            (1.12 * r, 0.93 * r),
            (1.03 * r, base),
        ]
        spindle(body, "base", lower, segments=48, at=(0, 0, 0))
    top = p.height - capital
    flutes = 20

    def radius(z: float) -> float:
        share = (z - base) / (top - base)
        return float(r * (1 - (1 - p.entasis) * share**1.6))

    cuts = np.linspace(base, top, p.drums + 1)
    joint = 0.004
    for k in range(p.drums):
        a, b = float(cuts[k]), float(cuts[k + 1])
        if p.order == "doric":
            ring = [
                (
                    (1.0 if j % 2 == 0 else 0.935) * math.cos(math.pi * j / flutes),
                    (1.0 if j % 2 == 0 else 0.935) * math.sin(math.pi * j / flutes),
                )
                for j in range(2 * flutes)
            ]
            body.sweep(f"drum_{k + 1}", [(0, 0, a), (0, 0, b)], ring, scales=[radius(a), radius(b)])
            continue
        steps = [a + joint, *np.linspace(a, b, 4)[1:-1], b - joint]
        outline = [(radius(a) - joint, a), *((radius(float(z)), float(z)) for z in steps), (radius(b) - joint, b)]
        body.turned(f"drum_{k + 1}", [(0, a), *outline, (0, b)], segments=48)
    neck = radius(top)
    echinus = [
        (neck, top),
        (neck * 1.06, top + 0.1 * capital),
        (neck * 1.02, top + 0.18 * capital),
        (neck * 1.02, top + 0.3 * capital),
    ]
    bell = [(1.25 * neck, top + 0.48 * capital), (1.4 * neck, top + 0.62 * capital)]
    spindle(body, "capital", [*echinus, *bell], segments=48, at=(0, 0, 0))
    half, under = 1.45 * neck, top + 0.62 * capital
    body.box("abacus", (-half, -half, under), (half, half, p.height - 0.08 * capital))
    body.box(
        "fillet", (-half - 0.06 * r, -half - 0.06 * r, p.height - 0.08 * capital), (half + 0.06 * r, half + 0.06 * r, p.height)
    )
    made = Made.of(body)
    made.places["top"] = Place((0, 0, p.height), (2 * half, 2 * half))
    return made


class ArchParameters(Parameters):
    """An arch of voussoirs with a keystone on two piers, in one body or of loose stones between piers that stand fast."""

    span: float = Field(default=1.8, ge=0.6, le=5.0, description="clear width [m]")
    spring: float = Field(default=1.4, ge=0.2, le=4.0, description="height of the springing [m]")
    shape: Literal["round", "segmental", "pointed"] = Field(default="round", description="of the curve")
    ring: float = Field(default=0.2, ge=0.16, le=0.35, description="depth of the voussoirs over half the span")
    depth: float = Field(default=0.45, ge=0.2, le=1.5, description="along y [m]")
    stones: int = Field(default=13, ge=7, le=25, description="voussoirs with the keystone, made odd")
    loose: bool = Field(default=False, description="voussoirs are bodies of their own, held by each other")
    material: str = material("limestone", "sandstone", "granite", "marble", "brick_masonry")


def _curve(p: ArchParameters) -> tuple[list[tuple[F64, F64]], float]:
    """Joints (inner, outer point) from the left springing to the right one, x and z [m], and the depth of the ring."""
    half, n = p.span / 2, p.stones | 1
    deep = p.ring * half
    if p.shape == "pointed":
        radius = 1.25 * p.span
        center = radius - half
        most = math.acos(center / radius)
        # The keystone spans the apex: the last joint of each side stands half a stone before it.
        side = [most * k / (n / 2) for k in range(n // 2 + 1)]
        left = []
        for a in side:
            way = np.array([-math.cos(a), math.sin(a)])
            left.append((np.array([center, p.spring]) + radius * way, np.array([center, p.spring]) + (radius + deep) * way))
        mirror = np.array([-1.0, 1.0])
        return [*left, *((i * mirror, o * mirror) for i, o in reversed(left))], deep
    opening = math.pi if p.shape == "round" else math.radians(110)
    radius = half / math.sin(opening / 2)
    middle = np.array([0.0, p.spring - radius * math.cos(opening / 2)])
    joints = []
    for k in range(n + 1):
        a = math.pi / 2 + opening / 2 - opening * k / n
        way = np.array([math.cos(a), math.sin(a)])
        joints.append((middle + radius * way, middle + (radius + deep) * way))
    return joints, deep


def _arch(p: ArchParameters, rng: np.random.Generator) -> Made:
    joints, deep = _curve(p)
    made = Made.of(Body("arch", p.material, "static" if p.loose else None))
    y = p.depth / 2
    _piers(made.main, joints, p, deep)
    half = p.span / 2 + max(deep, 0.3 * p.spring)
    made.main.box("footing", (-half, -y - 0.04, 0), (half, y + 0.04, 0.08))
    last = MAIN
    n = len(joints) - 1
    for k in range(n):
        (i0, o0), (i1, o1) = joints[k], joints[k + 1]
        key = k == n // 2
        if key and p.shape != "pointed":
            o0, o1 = o0 + 0.25 * (o0 - i0), o1 + 0.25 * (o1 - i1)
        out = y + (0.03 if key else float(rng.uniform(0.0, 0.008)))
        body, name = made.main, f"stone_{k + 1}"
        quad = [i0, o0, o1, i1]
        if p.loose:
            body = made.bodies[name] = Body("keystone" if key else "voussoir", p.material, "dynamic")
            quad = _shrunk(quad)
            made.carries.append((last, name) if k <= n // 2 else (name, last))
            last = name
        c = 0.012
        inner = [q + c * (sum(quad) / 4 - q) / np.linalg.norm(sum(quad) / 4 - q) * 1.4 for q in quad]
        points = [(q[0], s * (out - c), q[1]) for q in quad for s in (-1, 1)]
        body.hull("stone" if p.loose else name, [*points, *((q[0], s * out, q[1]) for q in inner for s in (-1, 1))])
    if p.loose:
        made.carries.append((MAIN, last))
    return made


def _shrunk(quad: list[F64]) -> list[F64]:
    """A voussoir with half a gap less at both joints."""
    i0, o0, o1, i1 = quad
    found = []
    for a, b, ahead in ((i0, o0, i1), (i1, o1, i0)):
        line = (b - a) / np.linalg.norm(b - a)
        normal = np.array([-line[1], line[0]])
        normal *= math.copysign(GAP / 2, float(normal @ (ahead - a)))
        found.append((a + normal, b + normal))
    return [found[0][0], found[0][1], found[1][1], found[1][0]]


def _piers(body: Body, joints: list[tuple[F64, F64]], p: ArchParameters, deep: float) -> None:
    """Piers by courses up to the springing, their topmost stone cut to the first joint."""
    y, c = p.depth / 2, GAP / 2 if p.loose else 0.0
    (i, o) = joints[0]
    wide = max(deep, 0.3 * p.spring)
    foot, top = 0.08, min(float(i[1]), float(o[1]))
    high = max(float(i[1]), float(o[1]))
    courses = max(1, round((top - foot - 0.05) / 0.35))
    levels = np.linspace(foot, top - 0.05 if high > top + 1e-9 else top, courses + 1)
    for sign, side in ((-1, "left"), (1, "right")):
        a, b = -p.span / 2 - wide, -p.span / 2
        for k in range(courses):
            low, up = float(levels[k]), float(levels[k + 1]) - (c if k == courses - 1 and high <= top + 1e-9 else 0.0)
            x0, x1 = sorted((-sign * a, -sign * b))
            block(body, f"pier_{side}_{k + 1}", (x0, -y, low), (x1, y, up), chamfer=0.012)
        if high > top + 1e-9:
            line = (o - i) / np.linalg.norm(o - i)
            normal = np.array([-line[1], line[0]]) * math.copysign(1.0, -line[0])
            down = normal * c if normal[1] < 0 else -normal * c
            low = float(levels[-1])
            outline = [(a, low), (b, low), tuple(i + down), tuple(o + down), (a, float((o + down)[1]))]
            body.hull(f"skewback_{side}", [(-sign * x, s * y, z) for x, z in outline for s in (-1, 1)])


class WallParameters(Parameters):
    """A wall of stones or bricks in running bond; stones grow where there would be more than 110 of them."""

    length: float = Field(default=2.0, ge=0.5, le=8.0, description="along x [m]")
    height: float = Field(default=1.0, ge=0.2, le=4.0, description="along z [m]")
    thickness: float = Field(default=0.2, ge=0.1, le=0.8, description="along y [m]")
    stone: float = Field(default=0.4, ge=0.2, le=1.2, description="length of a stone [m]")
    course: float = Field(default=0.18, ge=0.065, le=0.5, description="height of a course [m]")
    rough: float = Field(default=0.006, ge=0.0, le=0.02, description="by how much faces stand out unevenly [m]")
    loose: bool = Field(default=False, description="stones are bodies of their own that lie on each other")
    material: str = material("brick_masonry", "limestone", "sandstone", "granite", "concrete_c30")


def _wall(p: WallParameters, rng: np.random.Generator) -> Made:
    stone, course = min(p.stone, p.length / 1.5), min(p.course, p.height)
    grown = max(1.0, math.sqrt(p.length / stone * (p.height / course) / 105))
    number, courses = max(1, int(p.length / (stone * grown))), max(1, int(p.height / (course * grown) + 1e-9))
    unit, high = p.length / number, p.height / courses
    made = Made()
    body = Body("wall", p.material)
    rows: list[list[tuple[float, float, str]]] = []
    for k in range(courses):
        ends = [0.0, *((j + 0.5 * (k % 2)) * unit for j in range(1 - k % 2, number)), p.length]
        row = []
        for j, (a, b) in enumerate(itertools.pairwise(ends)):
            rough = float(rng.uniform(0, p.rough))
            gap = GAP / 2 if p.loose else 0.0
            name = f"stone_{k + 1}_{j + 1}"
            low = (a - p.length / 2 + gap * (a > 0), -p.thickness / 2 - rough, k * high + (GAP if k and p.loose else 0.0))
            top = (b - p.length / 2 - gap * (b < p.length), p.thickness / 2 + rough, (k + 1) * high)
            if p.loose:
                name = MAIN if not made.bodies else name
                body = made.bodies[name] = Body("stone of a wall", p.material)
            block(body, "stone" if p.loose else name, low, top, chamfer=min(0.01, 0.08 * high))
            row.append((a, b, name))
        rows.append(row)
    if not p.loose:
        made.bodies[MAIN] = body
        made.places["top"] = Place((0, 0, p.height), (p.length, p.thickness))
        return made
    for below, above in itertools.pairwise(rows):
        made.carries += [(m, n) for a, b, n in above for c, d, m in below if min(b, d) - max(a, c) > 1e-6]
    return made


class BattlementParameters(Parameters):
    """A curtain wall of ashlar with a wall walk behind a parapet of merlons with loopholes."""

    length: float = Field(default=5.0, ge=2.0, le=10.0, description="along x [m]")
    height: float = Field(default=3.2, ge=1.2, le=6.0, description="of the wall walk [m]")
    thickness: float = Field(default=1.2, ge=0.8, le=2.0, description="along y [m]")
    parapet: float = Field(default=0.4, ge=0.25, le=0.5, description="thickness of the parapet [m]")
    merlon: float = Field(default=0.9, ge=0.6, le=1.5, description="width of a merlon with its loophole [m]")
    crenel: float = Field(default=0.6, ge=0.4, le=1.0, description="width of the gaps between merlons [m]")
    material: str = material("limestone", "sandstone", "granite", "gneiss")


def battlement(p: BattlementParameters, rng: np.random.Generator) -> Made:
    """A curtain wall, see `BattlementParameters`."""
    body = Body("battlement", p.material)
    half, front = p.length / 2, -p.thickness / 2
    grown = max(1.0, math.sqrt(p.length / 0.75 * (p.height / 0.4) / 60))
    courses, number = max(2, round(p.height / (0.4 * grown))), max(2, round(p.length / (0.75 * grown)))
    high, unit = (p.height - 0.12) / courses, p.length / number
    for k in range(courses):
        ends = [
            0.0,
            *((j + 0.5 * (k % 2)) * unit + float(rng.uniform(-0.12, 0.12)) * unit for j in range(1 - k % 2, number)),
            p.length,
        ]
        batter = 0.05 * (k == 0)
        for j, (a, b) in enumerate(itertools.pairwise(ends)):
            rough = float(rng.uniform(0, 0.015)) + batter
            block(
                body,
                f"stone_{k + 1}_{j + 1}",
                (a - half, front - rough, k * high),
                (b - half, p.thickness / 2 + rough, (k + 1) * high),
                chamfer=0.02,
            )
    z = p.height - 0.12
    body.prism(
        "string_course",
        [(front - 0.1, p.height), (front - 0.1, p.height - 0.05), (front, z), (p.thickness / 2, z), (p.thickness / 2, p.height)],
        -half,
        half,
        axis="x",
    )
    breast = p.height + 0.7
    back = front + p.parapet
    number = max(1, int((p.length + p.crenel) / (p.merlon + p.crenel)))
    pitch = p.length / number
    crenel = pitch - p.merlon if pitch > p.merlon + 0.3 else 0.4 * pitch
    block(body, "breast", (-half, front, p.height), (half, back, breast), chamfer=0.015)
    for k in range(number):
        a, b = -half + k * pitch + crenel / 2, -half + (k + 1) * pitch - crenel / 2
        mid, slit, top = (a + b) / 2, 0.05, breast + 0.85
        for x0, x1, name in ((a, mid - slit, "left"), (mid + slit, b, "right")):
            block(body, f"merlon_{k + 1}_{name}", (x0, front, breast), (x1, back, top), chamfer=0.015)
        c = (front + back) / 2
        ridge = [
            (x, y, zz)
            for x in (a - 0.03, b + 0.03)
            for y, zz in (
                (front - 0.04, top),
                (back + 0.04, top),
                (front - 0.04, top + 0.06),
                (back + 0.04, top + 0.06),
                (c, top + 0.16),
            )
        ]
        body.hull(f"cap_{k + 1}", ridge)
    made = Made.of(body)
    made.places["walk"] = Place((0, (back + p.thickness / 2) / 2, p.height), (p.length, p.thickness - p.parapet - 0.05))
    return made


GENERATORS = (
    Generator("column", "column with base, tapering shaft of drums and capital", ColumnParameters, _column,
              ("pillar", "temple", "classical", "doric", "museum", "palace", "stone")),
    Generator("arch", "arch of voussoirs with a keystone on piers, of one piece or of loose stones", ArchParameters, _arch,
              ("vault", "gateway", "ruin", "stone", "masonry", "castle", "door"), motion="static"),
    Generator("wall_by_courses", "wall of bricks or stones in running bond, of one piece or of loose stones", WallParameters, _wall,
              ("masonry", "brick", "garden", "ruin", "building", "demolition")),
    Generator("battlement", "castle wall with a wall walk, merlons and crenels", BattlementParameters, battlement,
              ("castle", "fortress", "curtain", "crenellated", "rampart", "wall", "parapet"), motion="static"),
)  # fmt: skip
