"""Stairs of legal rise and run: straight, with a landing, spiral.

Rise R and going G of a step keep 0.55 m <= 2 R + G <= 0.70 m, R <= 0.22 m, G >= 0.22 m (UK Approved Document K), and a flight has
at most 18 steps (DIN 18065).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place

__all__ = ["GENERATORS", "STRIDE", "Flight", "StairsParameters", "handrail", "stairs_run"]

FLIGHT = 18
"""Most steps without a landing."""
STRIDE = (0.55, 0.70)
"""Bounds of 2 R + G [m]."""
NOSING = 0.022
"""Overhang of a tread before its riser [m]."""
TREAD = 0.036
"""Thickness of a tread [m]."""
Turn = Callable[[float, float, float], tuple[float, float, float]]


class Flight(NamedTuple):
    """Steps that climb along +y of their own frame from y = 0, z = 0; `turn` leads to the asset's frame."""

    steps: int
    rise: float
    going: float
    width: float
    turn: Turn
    name: str = ""
    bars: bool = False
    """Bars along the railings instead of balusters."""

    @property
    def run(self) -> float:
        """Its length in plan [m]."""
        return self.steps * self.going

    def box(self, body: Body, name: str, low: tuple[float, float, float], high: tuple[float, float, float]) -> None:
        """Add an upright box of its own frame."""
        ends = np.array([self.turn(*low), self.turn(*high)])
        body.box(f"{self.name}{name}", ends.min(0), ends.max(0))

    def hull(self, body: Body, name: str, points: list[tuple[float, float, float]]) -> None:
        """Add the hull of points of its own frame."""
        body.hull(f"{self.name}{name}", [self.turn(*p) for p in points])


def _steps(rise: float, wanted: float, most: int) -> int:
    """Number of steps whose rise is the wanted one at most, and legal in any case."""
    return max(1, min(most, math.ceil(rise / wanted - 1e-9)), math.ceil(rise / 0.22 - 1e-9))


def _going(rise: float, wanted: float) -> float:
    """Going that is legal with a rise, as near to the wanted one as can be [m]."""
    return max(0.22, min(max(wanted, STRIDE[0] - 2 * rise), STRIDE[1] - 2 * rise))


def _solid(body: Body, f: Flight, floor: float) -> None:
    """Steps of stone on a solid base, with slabs that project."""
    half, slab = f.width / 2, min(0.045, 0.4 * f.rise)
    for k in range(f.steps):
        y, z = k * f.going, (k + 1) * f.rise
        f.box(body, f"core_{k + 1}", (-half + 0.02, y, -floor), (half - 0.02, y + f.going, z - slab))
        front = y - (NOSING if k or f.rise - slab > 0.01 else 0.0)
        f.box(body, f"tread_{k + 1}", (-half, front, z - slab), (half, y + f.going - NOSING * (k < f.steps - 1), z))


def _wooden(body: Body, f: Flight, floor: float, *, risers: bool, posts: bool) -> None:
    """Treads between two strings; posts under their upper end where the flight stands on the floor."""
    string, half = 0.045, f.width / 2
    inner, slope = half - string, f.rise / f.going
    top = f.steps * f.rise + 0.05
    lift, depth = f.rise + 0.05, 0.15 + 0.5 * f.rise
    foot = -NOSING - 0.03

    def line(y: float, offset: float) -> float:
        return y * slope + offset

    meet = (top - lift) / slope
    begin = depth / slope
    outline = [
        (foot, 0.0),
        (begin, 0.0),
        (f.run, line(f.run, -depth)),
        (f.run, top),
        (min(meet, f.run), min(top, line(f.run, lift))),
        (foot, line(foot, lift)),
    ]
    if begin > f.run - 0.02:
        outline[1:3] = [(f.run, 0.0)]
    for sign, name in ((-1, "left"), (1, "right")):
        xs = (sign * inner, sign * half)
        f.hull(body, f"string_{name}", [(x, y, z) for x in xs for y, z in outline])
        if posts and begin < f.run - 0.2:
            a, b = f.run - 0.09, f.run
            f.hull(body, f"post_{name}", [(x, y, z) for x in xs for y in (a, b) for z in (-floor, line(y, -depth))])
    for k in range(f.steps):
        y, z = k * f.going, (k + 1) * f.rise
        back = y + f.going if k == f.steps - 1 else y + f.going + 0.02
        f.box(body, f"tread_{k + 1}", (-inner, y - NOSING, z - TREAD), (inner, back, z))
        if risers:
            low = k * f.rise if k else 0.0
            f.box(body, f"riser_{k + 1}", (-inner, y, low), (inner, y + 0.018, z - TREAD))


def handrail(body: Body, f: Flight, side: int, *, solid: bool, height: float = 0.92) -> None:
    """Newel posts, a handrail parallel to the flight and upright balusters, on its left (-1) or right (1) side."""
    name, slope, half = "left" if side < 0 else "right", f.rise / f.going, f.width / 2
    x = side * (half - (0.05 if solid else 0.0225))
    lift = f.rise + (0.0 if solid else 0.05)
    newel, first, last = 0.04, 0.5 * f.going, f.run - 0.5 * f.going

    def foot(y: float) -> float:
        if solid:
            return f.rise * (math.floor(y / f.going + 1e-9) + 1)
        return min(y * slope + lift, f.steps * f.rise + 0.05)

    def under(y: float) -> float:
        return y * slope + f.rise + height - 0.05

    ends = (first, last) if f.steps > 2 else (first, f.run - newel)
    for end, y in zip(("low", "high"), ends, strict=True):
        xs = (x - newel, x + newel) if solid else (x - 0.0225, x + 0.0225)
        ys = (y - newel, y + newel)
        base = [(a, b, foot(b) if not solid else foot(y)) for a in xs for b in ys]
        top = under(y) + 0.17
        f.hull(body, f"newel_{name}_{end}", [*base, *((a, b, top) for a in xs for b in ys)])
        mid = (sum(xs) / 2, y)
        f.hull(body, f"cap_{name}_{end}", [*((a, b, top) for a in xs for b in ys), (*mid, top + 0.03),
               *((mid[0] + s * 0.035 * 1.3, mid[1] + t * 0.052, top + 0.012) for s in (-1, 1) for t in (-1, 1))])  # fmt: skip
    a, b = ends[0] + newel, ends[1] - newel
    if b <= a:
        return
    f.hull(
        body,
        f"handrail_{name}",
        [(x + s * w, y, under(y) + z) for y in (a, b) for s in (-1, 1) for w, z in ((0.022, 0.0), (0.03, 0.025), (0.02, 0.055))],
    )
    if f.bars:
        for k, share in enumerate((0.25, 0.5, 0.75), start=1):
            points = [
                (x + s * 0.012, y, y * slope + f.rise + share * height + z)
                for y in (a, b)
                for s in (-1, 1)
                for z in (-0.02, 0.02)
            ]
            f.hull(body, f"bar_{name}_{k}", points)
        return
    per = 2 if f.steps <= (6 if f.name else 12) else 1
    for k in range(f.steps * per):
        y = (k + 0.5) * f.going / per + (0.25 * f.going if per == 1 else 0.0)
        ys = (y - 0.014, y + 0.014)
        if ys[0] < a or ys[1] > b or (solid and foot(ys[0]) != foot(ys[1])):
            continue
        f.hull(body, f"baluster_{name}_{k + 1}", [(x + s * 0.014, e, z(e)) for s in (-1, 1) for e in ys for z in (foot, under)])


Railings = Literal["none", "left", "right", "both"]
SIDES = {"none": (), "left": (-1,), "right": (1,), "both": (-1, 1)}
Build = Literal["closed", "open", "stone"]


def _flight(body: Body, f: Flight, build: Build, railings: Railings, floor: float = 0.0, *, posts: bool = True) -> None:
    if build == "stone":
        _solid(body, f, floor)
    else:
        _wooden(body, f, floor, risers=build == "closed", posts=posts)
    for side in SIDES[railings]:
        handrail(body, f, side, solid=build == "stone")


def _places(made: Made, f: Flight) -> None:
    for k in range(f.steps):
        low, high = f.turn(-f.width / 2 + 0.05, k * f.going, 0), f.turn(f.width / 2 - 0.05, (k + 1) * f.going - NOSING, 0)
        z = f.turn(0, 0, (k + 1) * f.rise)[2]
        size = (abs(high[0] - low[0]), abs(high[1] - low[1]))
        made.places[f"{f.name}tread_{k + 1}"] = Place(((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, z), size)


class StairsParameters(Parameters):
    """A straight flight that climbs from the front (-y) to the back; its last tread is level with the floor above."""

    rise: float = Field(default=2.7, ge=0.3, le=3.4, description="height of the floor above [m]")
    width: float = Field(default=0.95, ge=0.7, le=2.0, description="along x [m]")
    riser: float = Field(default=0.175, ge=0.14, le=0.2, description="height of a step at most, made even over the flight [m]")
    going: float = Field(default=0.28, ge=0.23, le=0.37, description="of a tread, kept where 2 R + G is from 0.55 to 0.70 [m]")
    build: Build = Field(default="closed", description="wood with risers, wood without, or solid stone")
    railing: Railings = Field(default="right", description="sides that have a railing")
    posts: bool = Field(default=True, description="posts under the upper end of wood; false where the floor above carries it")
    material: str = material("oak", "beech", "pine", "limestone", "granite", "marble")


def stairs_run(p: StairsParameters) -> float:
    """Length of a straight flight in plan [m]."""
    steps = _steps(p.rise, p.riser, FLIGHT)
    return steps * _going(p.rise / steps, p.going)


def _stairs(p: StairsParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("stairs", p.material))
    steps = _steps(p.rise, p.riser, FLIGHT)
    rise = p.rise / steps
    going = _going(rise, p.going)
    run = steps * going
    f = Flight(steps, rise, going, p.width, lambda x, y, z: (x, y - run / 2, z))
    _flight(made.main, f, p.build, p.railing, posts=p.posts)
    _places(made, f)
    return made


class LandingStairsParameters(Parameters):
    """Two flights with a landing between them: straight on, a quarter turn to the right, or back beside the first."""

    rise: float = Field(default=2.8, ge=1.2, le=4.0, description="height of the floor above [m]")
    width: float = Field(default=1.0, ge=0.8, le=1.6, description="of a flight [m]")
    riser: float = Field(default=0.17, ge=0.15, le=0.19, description="height of a step at most [m]")
    going: float = Field(default=0.28, ge=0.23, le=0.36, description="of a tread, kept where 2 R + G is from 0.55 to 0.70 [m]")
    turn: Literal["straight", "quarter", "half"] = Field(default="half", description="of the way at the landing")
    build: Build = Field(default="closed", description="wood with risers, wood without, or solid stone")
    railing: bool = Field(default=True, description="railings along the flights and the landing")
    material: str = material("oak", "beech", "ash", "limestone", "granite")


def _landing_frame(p: LandingStairsParameters, run: float, level: float, second: float) -> tuple[Turn, Turn]:
    """Frames of both flights, about the middle of the whole."""
    w, gap = p.width, 0.12
    if p.turn == "straight":
        shift = (run + w + second) / 2
        return (lambda x, y, z: (x, y - shift, z)), (lambda x, y, z: (x, y + run + w - shift, z + level))
    if p.turn == "quarter":
        dx, dy = second / 2, (run + w) / 2
        return (
            lambda x, y, z: (x - dx, y - dy, z),
            lambda x, y, z: (y + w / 2 - dx, run + w / 2 - x - dy, z + level),
        )
    dx, dy = (w + gap) / 2, (run + w) / 2
    return (lambda x, y, z: (x - dx, y - dy, z)), (lambda x, y, z: (dx - x, run - y - dy, z + level))


def _landing(body: Body, low: np.ndarray, high: np.ndarray, level: float, *, stone: bool) -> None:
    """A platform: a slab on posts, or a solid block."""
    thick = 0.045 if stone else TREAD
    body.box("landing", (*low, level - thick), (*high, level))
    if stone:
        body.box("landing_core", (*(low + 0.02), 0), (*(high - 0.02), level - thick))
        return
    beam, side = 0.14, 0.08
    for k, (x, y) in enumerate(
        ((low[0], low[1]), (high[0] - side, low[1]), (high[0] - side, high[1] - side), (low[0], high[1] - side)), start=1
    ):
        body.box(f"landing_post_{k}", (x, y, 0), (x + side, y + side, level - thick))
    under, top = level - thick - beam, level - thick
    for k, y in enumerate((low[1] + 0.015, high[1] - 0.065), start=1):
        body.box(f"landing_beam_{k}", (low[0] + side, y, under), (high[0] - side, y + 0.05, top))
    for k, x in enumerate((low[0] + 0.015, high[0] - 0.065), start=3):
        body.box(f"landing_beam_{k}", (x, low[1] + side, under), (x + 0.05, high[1] - side, top))


def _guard(body: Body, name: str, ends: tuple[np.ndarray, np.ndarray], level: float, *, bars: bool) -> None:
    """A level railing between two points of an edge."""
    a, b = (np.append(e, level) for e in ends)
    way = (b - a) / np.linalg.norm(b - a)
    across = np.array([-way[1], way[0], 0])
    up, top = np.array([0, 0, 1.0]), 0.95

    def bar(part: str, start: np.ndarray, end: np.ndarray, half: float, levels: tuple[float, float]) -> None:
        body.hull(f"{name}_{part}", [p + s * half * across + z * up for p in (start, end) for s in (-1, 1) for z in levels])

    for k, p in enumerate((a, b), start=1):
        bar(f"newel_{k}", p - 0.035 * way, p + 0.035 * way, 0.035, (0.0, top + 0.1))
    bar("rail", a + 0.035 * way, b - 0.035 * way, 0.028, (top - 0.05, top))
    if bars:
        for k, z in enumerate((0.25, 0.5, 0.75), start=1):
            bar(f"bar_{k}", a + 0.035 * way, b - 0.035 * way, 0.012, (z * 0.92 - 0.02, z * 0.92 + 0.02))
        return
    length = float(np.linalg.norm(b - a)) - 0.07
    count = max(1, round(length / 0.13))
    for k in range(1, count):
        p = a + (0.035 + length * k / count) * way
        bar(f"baluster_{k}", p - 0.013 * way, p + 0.013 * way, 0.013, (0.0, top - 0.05))


def _landing_stairs(p: LandingStairsParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("stairs", p.material))
    body, stone = made.main, p.build == "stone"
    steps = _steps(p.rise, p.riser, 2 * FLIGHT)
    first = (steps + 1) // 2
    rise = p.rise / steps
    going = _going(rise, p.going)
    run, level, second = first * going, first * rise, (steps - first) * going
    one, two = _landing_frame(p, run, level, second)
    w = p.width
    rails: Railings = "both" if p.railing else "none"
    low, high = one(-w / 2, run, 0), one(w / 2, run + w, 0)
    flights = [
        Flight(first, rise, going, w, one, "lower_", bars=steps > 10),
        Flight(steps - first, rise, going, w, two, "upper_", bars=steps > 10),
    ]
    corner = np.array(high[:2])
    if p.turn == "half":
        corner[0] = -low[0]
    _landing(body, np.array(low[:2]), corner, level, stone=stone)
    for f, floor in zip(flights, (0.0, level), strict=True):
        _flight(body, f, p.build, rails, floor)
        _places(made, f)
    if p.railing:
        (x0, y0), (x1, y1), e = low[:2], corner, 0.04
        end = y1 - (0.1 if p.turn == "straight" else e)
        lines = [((x0 + e, y0 + 0.1), (x0 + e, end))]
        if p.turn != "straight":
            lines.append(((x0 + e + 0.08, y1 - e), (x1 - e - 0.08, y1 - e)))
        if p.turn != "quarter":
            lines.append(((x1 - e, y0 + 0.1), (x1 - e, end)))
        for k, (a, b) in enumerate(lines, start=1):
            _guard(body, f"guard_{k}", (np.array(a), np.array(b)), level, bars=steps > 10)
    middle = (np.array(low[:2]) + corner) / 2
    made.places["landing"] = Place((*middle, level), (float(corner[0] - low[0]) - 0.2, float(corner[1] - low[1]) - 0.2))
    return made


GENERATORS = (
    Generator("stairs", "straight flight of stairs of legal rise and run, in wood or stone, with railings", StairsParameters, _stairs,
              ("staircase", "steps", "house", "building", "climb", "storey"), motion="static"),
    Generator("landing_stairs", "two flights of stairs with a landing and railings, turning or straight", LandingStairsParameters,
              _landing_stairs, ("staircase", "steps", "house", "building", "dogleg", "storey"), motion="static"),
)  # fmt: skip
