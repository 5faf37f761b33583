"""Dominoes, balls, blocks, marbles and their track, dice, skittles, spinning tops."""

from __future__ import annotations

import itertools
import math
from typing import Literal

import numpy as np
from pydantic import Field

from ...worlds.spec import Box
from .generator import Generator, Parameters, material
from .made import Body, Made
from .profiles import arc
from .turning import drawn, moved, solid, stacked

__all__ = ["GENERATORS"]

GAP = 1.01e-3
"""[m] Between bodies."""
CLEAR = 1e-6
"""[m] Between a surface and what is drawn onto it, beyond rounding to single precision."""
WOODS = ("maple", "cherry_wood", "walnut", "beech", "mahogany", "oak", "white_pine", "teak")


class DominoesParameters(Parameters):
    """Domino stones that stand in a row along x, straight or in a bow."""

    count: int = Field(default=12, ge=2, le=60, description="stones")
    height: float = Field(default=0.048, ge=0.02, le=0.4, description="[m]")
    spacing: float = Field(default=0.5, ge=0.25, le=0.85, description="between the middles of two stones over their height")
    bend_deg: float = Field(default=0.0, ge=-15.0, le=15.0, description="turn from one stone to the next [degrees]")
    material: str = material("polystyrene", "abs", "maple", "oak", "marble")


def _dominoes(p: DominoesParameters, rng: np.random.Generator) -> Made:
    made = Made({})
    high, wide, thick = p.height, 0.5 * p.height, 0.16 * p.height
    limit = 300.0 / p.count
    bend = math.radians(max(-limit, min(limit, p.bend_deg)))
    at, heading, places = np.zeros(2), 0.0, []
    for _ in range(p.count):
        places.append((at.copy(), heading))
        at = at + p.spacing * high * np.array([math.cos(heading + bend / 2), math.sin(heading + bend / 2)])
        heading += bend
    middle = np.mean([q for q, _ in places], axis=0)
    for number, (q, turn) in enumerate(places):
        body = Body("domino", p.material)
        x, y = q - middle
        body.add("stone", _box(thick, wide, high), (x, y, high / 2), euler=(0, 0, turn))
        c, s = math.cos(turn), math.sin(turn)
        front = -thick / 2 - 0.0001 - CLEAR
        body.add(
            "line",
            _box(0.0002, 0.9 * wide, 0.02 * high),
            (x + c * front, y + s * front, high / 2),
            euler=(0, 0, turn),
            material="abs" if p.material != "abs" else "polystyrene",
        )
        drawn(body, "line")
        made.bodies["" if number == 0 else f"stone_{number + 1}"] = body
    return made


def _box(x: float, y: float, z: float) -> Box:
    return Box(size=(round(x, 9), round(y, 9), round(z, 9)))


class BallParameters(Parameters):
    """A ball of a kind, of about its mass; a football is sewn of panels."""

    kind: Literal["football", "basketball", "tennis", "table_tennis", "billiard", "bowling", "rubber"] = Field(
        default="football", description="gives diameter and material"
    )
    panels: bool = Field(
        default=True, description="of a football: 32 panels, 0.3 % of the radius from round; false: an exact ball"
    )


BALLS = {
    "football": (0.22, "rigid_foam"),
    "basketball": (0.24, "inflated_basketball"),
    "tennis": (0.067, "wool"),
    "table_tennis": (0.04, "rigid_foam"),
    "billiard": (0.0572, "pvc"),
    "bowling": (0.216, "neoprene"),
    "rubber": (0.06, "natural_rubber"),
}
"""Diameter [m] (rules of the sports) and a row of about the density of the whole ball."""


def _ball(p: BallParameters, rng: np.random.Generator) -> Made:
    diameter, row = BALLS[p.kind]
    r = diameter / 2
    body = Body(f"{p.kind.replace('_', ' ')} ball", row)
    if p.kind == "football" and p.panels:
        _panels(body, r)
    else:
        body.sphere("ball", (0, 0, r), r)
    return Made.of(body)


def _panels(body: Body, radius: float) -> None:
    """A core and the 12 pentagons and 20 hexagons of a truncated icosahedron, bulged to the ball."""
    g = (1 + math.sqrt(5)) / 2
    tops = [np.array(q) for a, b in itertools.product((-1, 1), (-g, g)) for q in ((0, a, b), (a, b, 0), (b, 0, a))]
    edge = 2.0
    near = [[k for k, q in enumerate(tops) if 0 < np.linalg.norm(q - t) < edge + 0.1] for t in tops]
    centre = np.array([0, 0, radius])
    faces = [[(2 * t + tops[k]) / 3 for k in own] for t, own in zip(tops, near, strict=True)]
    for a, b, c in itertools.combinations(range(12), 3):
        if b in near[a] and c in near[a] and c in near[b]:
            faces.append([(2 * tops[i] + tops[j]) / 3 for i, j in itertools.permutations((a, b, c), 2)])
    inner = min(float(np.linalg.norm(np.mean(f, axis=0)) / np.linalg.norm(f[0])) for f in faces) * radius
    body.sphere("core", centre, inner)
    for number, face in enumerate(faces, start=1):
        middle = np.mean(face, axis=0)
        axis = middle / np.linalg.norm(middle)
        one = face[0] - middle
        two = np.cross(axis, one)
        turns = [math.atan2((q - middle) @ two, (q - middle) @ one) for q in face]
        ordered = [face[k] for k in np.argsort(turns)]
        base = [q * inner / (q @ axis) for q in ordered]
        grid = [q + (w - q) * k / 4 for q, w in zip(ordered, [*ordered[1:], ordered[0]], strict=True) for k in range(4)]
        rings = [middle + (q - middle) * s for q in grid for s in (1.0, 0.7, 0.4)] + [middle]
        outer = [q * radius / np.linalg.norm(q) for q in rings]
        row = "felt" if len(face) == 5 else "rigid_foam"
        body.hull(f"panel_{number}", [q + centre for q in (*base, *outer)], material=row)


class BuildingBlocksParameters(Parameters):
    """Loose blocks, stacked as a tower, a wall or a pyramid, or laid in a grid."""

    form: Literal["pyramid", "tower", "wall", "grid"] = Field(default="pyramid", description="how they are laid")
    block: float = Field(default=0.045, ge=0.02, le=0.5, description="side of a block, height too [m]")
    length: float = Field(default=1.0, ge=1.0, le=2.0, description="of a block along x over its height")
    rows: int = Field(default=4, ge=1, le=10, description="courses; of a grid: rows and columns")
    paint: bool = Field(default=True, description="blocks of various woods, else all of one")
    material: str = material("beech", "maple", "pine", "concrete_c30", "granite")


def _building_blocks(p: BuildingBlocksParameters, rng: np.random.Generator) -> Made:
    made, side, long = Made({}), p.block, p.block * p.length
    pitch, gap = long + GAP, GAP
    spots: list[tuple[float, float, int]] = []
    for k in range(p.rows):
        if p.form == "pyramid":
            spots += [(pitch * (n - (p.rows - k - 1) / 2), 0.0, k) for n in range(p.rows - k)]
        elif p.form == "tower":
            spots.append((0.0, 0.0, k))
        elif p.form == "wall":
            shift = 0.5 * (k % 2)
            spots += [(pitch * (n - 1.5 + 0.5 * shift * 2), 0.0, k) for n in range(3 if k % 2 else 4)]
        else:
            spots += [(pitch * (n - (p.rows - 1) / 2), (side + GAP) * (k - (p.rows - 1) / 2), 0) for n in range(p.rows)]
    names = []
    for number, (x, y, level) in enumerate(spots):
        body = Body("building block", WOODS[int(rng.integers(len(WOODS)))] if p.paint else p.material)
        z = level * (side + gap)
        jog = float(rng.uniform(-0.03, 0.03)) * side if p.form == "tower" and level else 0.0
        bevel = 0.06 * side
        body.hull("block", _bevelled((x + jog, y, z + side / 2), (long, side, side), bevel))
        names.append("" if number == 0 else f"block_{number + 1}")
        made.bodies[names[-1]] = body
    for (a, one), (b, other) in itertools.permutations(zip(names, spots, strict=True), 2):
        if other[2] == one[2] + 1 and abs(other[0] - one[0]) < 0.98 * long:
            made.carries.append((a, b))
    return made


def _bevelled(centre: tuple[float, float, float], size: tuple[float, float, float], bevel: float) -> list[tuple[float, ...]]:
    """Corners of a box with bevelled edges."""
    half = [s / 2 for s in size]
    found = []
    for signs in itertools.product((-1, 1), repeat=3):
        for k in range(3):
            found.append(
                tuple(c + s * (h - (0 if n == k else bevel)) for n, (c, s, h) in enumerate(zip(centre, signs, half, strict=True)))
            )
    return found


class MarbleParameters(Parameters):
    """A glass marble."""

    diameter: float = Field(default=0.016, ge=0.01, le=0.05, description="[m]")
    material: str = material("soda_lime_glass", "porcelain", "mild_steel", "silver")


def _marble(p: MarbleParameters, rng: np.random.Generator) -> Made:
    body = Body("marble", p.material)
    body.sphere("marble", (0, 0, p.diameter / 2), p.diameter / 2)
    return Made.of(body)


class DiceParameters(Parameters):
    """A few dice with pips, lying side by side."""

    count: int = Field(default=2, ge=1, le=6, description="dice")
    side: float = Field(default=0.016, ge=0.01, le=0.2, description="[m]")
    pips: str = material("abs", "polystyrene", of="the pips")
    material: str = material("polystyrene", "nylon", "maple", "marble")


PIPS = {1: [(0, 0)], 2: [(-1, -1), (1, 1)], 3: [(-1, -1), (0, 0), (1, 1)], 4: [(-1, -1), (1, 1), (-1, 1), (1, -1)]}
PIPS |= {5: [*PIPS[4], (0, 0)], 6: [*PIPS[4], (-1, 0), (1, 0)]}


def _dice(p: DiceParameters, rng: np.random.Generator) -> Made:
    made, side = Made({}), p.side
    for number in range(p.count):
        body = Body("die", p.material)
        place = (1.9 * side * (number - (p.count - 1) / 2), float(rng.uniform(-0.3, 0.3)) * side, side / 2)
        turn, top = float(rng.uniform(0, 2 * math.pi)), int(rng.integers(1, 7))
        body.hull("cube", moved(_bevelled((0, 0, 0), (side, side, side), 0.1 * side), place, turn))
        front = int(rng.choice([v for v in range(1, 7) if v not in (top, 7 - top)]))
        right = next(v for v in range(1, 7) if v not in (top, 7 - top, front, 7 - front))
        sides = ((0, 0, 1, top), (0, -1, 0, front), (0, 1, 0, 7 - front), (1, 0, 0, right), (-1, 0, 0, 7 - right))
        for x, y, z, value in sides:
            normal = np.array([x, y, z], dtype=np.float64)
            u = np.array([0.0, 0, 1]) if z == 0 else np.array([1.0, 0, 0])
            v = np.cross(normal, u)
            for k, (a, b) in enumerate(PIPS[value], start=1):
                middle = 0.24 * side * (a * u + b * v) + (0.5 * side + CLEAR) * normal
                foot, head = moved([middle, middle + 0.0002 * normal], place, turn)
                body.cylinder(f"pip_{value}_{k}", foot, head, 0.09 * side, material=p.pips)
                drawn(body, f"pip_{value}_{k}")
        made.bodies["" if number == 0 else f"die_{number + 1}"] = body
    return made


class SkittlesParameters(Parameters):
    """Pins set up in a triangle, its point towards the front."""

    rows: int = Field(default=4, ge=1, le=6, description="rows of the triangle; four rows are ten pins")
    height: float = Field(default=0.38, ge=0.1, le=0.5, description="of a pin [m]")
    spacing: float = Field(default=0.8, ge=0.45, le=1.2, description="of the pins over their height")
    material: str = material("maple", "beech", "polystyrene", "pine")


def _skittles(p: SkittlesParameters, rng: np.random.Generator) -> Made:
    made, high, pitch = Made({}), p.height, p.spacing * p.height
    belly = float(rng.uniform(0.29, 0.33))
    shape = [
        (0.068, 0),
        (0.078, 0.01),
        (0.15, belly),
        (0.14, belly + 0.1),
        (0.062, 0.66),
        (0.06, 0.72),
        (0.084, 0.87),
        (0.07, 0.95),
        (0.035, 1.0),
    ]
    number = 0
    for row in range(p.rows):
        for k in range(row + 1):
            body = Body("pin", p.material)
            at = (pitch * (k - row / 2), pitch * math.sqrt(3) / 2 * (row - (p.rows - 1) / 2), 0)
            stacked(body, "pin", [(r * high, z * high) for r, z in shape], at, segments=24)
            number += 1
            made.bodies["" if number == 1 else f"pin_{number}"] = body
    return made


class SpinningTopParameters(Parameters):
    """A spinning top, upright on its point; it falls unless it spins."""

    diameter: float = Field(default=0.06, ge=0.03, le=0.12, description="[m]")
    height: float = Field(default=0.07, ge=0.04, le=0.14, description="with its stem [m]")
    point: str = material("mild_steel", "brass", of="the point")
    material: str = material("beech", "maple", "polystyrene", "brass")


def _spinning_top(p: SpinningTopParameters, rng: np.random.Generator) -> Made:
    body, wide, high = Body("spinning top", p.material), p.diameter / 2, p.height
    stem, tip = 0.1 * wide + 0.0015, 0.002
    full = float(rng.uniform(0.4, 0.5)) * high
    body.turned("point", solid([(0, 0), (0.7 * tip, 0.3 * tip), (tip, tip), (tip, 0.12 * high)]), segments=24, material=p.point)
    outer = [
        (tip, 0.12 * high),
        (0.75 * wide, 0.75 * full),
        (wide, full),
        (0.92 * wide, full + 0.06 * high),
        (stem, full + 0.14 * high),
    ]
    outer += [(0.9 * stem, 0.86 * high), (1.5 * stem, 0.92 * high), (1.4 * stem, 0.97 * high), (0.6 * stem, high)]
    stacked(body, "top", outer, segments=40)
    return Made.of(body)


class MarbleTrackParameters(Parameters):
    """An inclined half-pipe on posts, with an end that runs out level, falling from left to right."""

    length: float = Field(default=1.0, ge=0.4, le=3.0, description="of the slope along x [m]")
    fall: float = Field(default=0.12, ge=0.04, le=0.4, description="fall over length")
    bore: float = Field(default=0.03, ge=0.02, le=0.12, description="inner diameter of the pipe [m]")
    low: float = Field(default=0.06, ge=0.03, le=0.4, description="height of the lower end over the ground [m]")
    material: str = material("beech", "pine", "polypropylene", "aluminium_alloy", "acrylic")


def _marble_track(p: MarbleTrackParameters, rng: np.random.Generator) -> Made:
    body, r = Body("marble track", p.material), p.bore / 2
    wall = 0.16 * r + 0.001
    inner = arc((0.0, 0.0), r, math.pi, 2 * math.pi, 10)
    outer = arc((0.0, 0.0), r + wall, 2 * math.pi, math.pi, 10)
    drop, run = p.fall * p.length, 0.25 * p.length
    z = p.low + r + wall
    left = -(p.length + run) / 2
    bend = left + p.length
    path = [
        (left, 0, z + drop),
        (bend - 0.1 * p.length, 0, z + 0.1 * drop),
        (bend + 0.1 * p.length, 0, z + 0.0),
        (left + p.length + run, 0, z),
    ]
    body.sweep("track", path, [*inner, *outer])
    side, foot = max(0.012, 0.5 * r), 0.0
    count = max(2, round(p.length / 0.5) + 1)
    spots = [left + 0.04 + (bend - 0.12 * p.length - left - 0.04) * k / (count - 1) for k in range(count)] + [
        left + p.length + run - 0.03
    ]
    slope = 0.9 * drop / (0.9 * p.length)
    for number, x in enumerate(spots, start=1):
        rise = slope if x < bend - 0.1 * p.length else 0.0
        level = (z + drop - rise * (x - left)) if rise else z
        under = (r + wall) * math.hypot(1, rise)
        width = 2 * (r + wall) * math.sin(math.pi / 20) * 0.98
        top = [(x + d, y, level - under - rise * d) for d in (-side / 2, side / 2) for y in (-width / 2, width / 2)]
        body.hull(
            f"post_{number}", [*top, *((x + d, y, foot + 0.008) for d in (-side / 2, side / 2) for y in (-side / 2, side / 2))]
        )
        body.box(f"foot_{number}", (x - side, -1.6 * r - 0.02, 0), (x + side, 1.6 * r + 0.02, 0.008))
    return Made.of(body)


GENERATORS = (
    Generator("dominoes", "row of domino stones, each loose", DominoesParameters, _dominoes, ("toy", "game", "chain", "topple", "stones")),
    Generator("ball", "ball by its kind, of about its mass: football, basketball, tennis, billiard, bowling", BallParameters, _ball, ("toy", "sport", "sphere", "soccer", "roll"), stands=False),
    Generator("building_blocks", "loose blocks as pyramid, tower, wall or grid", BuildingBlocksParameters, _building_blocks, ("toy", "bricks", "stack", "cubes", "children")),
    Generator("marble", "marble", MarbleParameters, _marble, ("toy", "ball", "glass", "sphere", "roll"), stands=False),
    Generator("marble_track", "inclined half-pipe on posts for marbles", MarbleTrackParameters, _marble_track, ("toy", "marble", "run", "ramp", "chute", "slope")),
    Generator("dice", "dice with pips", DiceParameters, _dice, ("toy", "game", "die", "cube")),
    Generator("skittles", "pins set up in a triangle, each loose", SkittlesParameters, _skittles, ("toy", "game", "bowling", "pins", "ninepins")),
    Generator("spinning_top", "spinning top on its point", SpinningTopParameters, _spinning_top, ("toy", "gyroscope", "spin", "children"), stands=False),
)  # fmt: skip
