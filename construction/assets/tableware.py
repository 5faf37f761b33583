"""Bowls, plates, cups, teapots, cutlery, boards and rolling pins."""

from __future__ import annotations

import itertools
import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import circle, rectangle, rounded
from .turning import breaking, bulged, curve, facet, grip, half, hollow, lying, solid
from .vessels import BREAKABLE, CLEAR

__all__ = ["GENERATORS"]


class BowlParameters(Parameters):
    """A round bowl on a foot ring."""

    diameter: float = Field(default=0.16, ge=0.09, le=0.36, description="of the rim [m]")
    depth: float = Field(default=0.42, ge=0.3, le=0.6, description="height over diameter")
    wall: float = Field(default=0.004, ge=0.0025, le=0.008, description="thickness of the wall [m]")
    breakable: bool = BREAKABLE
    material: str = material("porcelain", "terracotta", "soda_lime_glass", "stainless_steel", "beech", "walnut")


def _bowl(p: BowlParameters, rng: np.random.Generator) -> Made:
    rim, top = p.diameter / 2, p.depth * p.diameter
    foot, ring = 0.45 * rim, 0.05 * top + 0.002
    full = float(rng.uniform(0.8, 0.9))
    body = Body("bowl", p.material)
    outer = [(foot, ring), (full * rim, ring + 0.36 * (top - ring)), (rim, top)]
    body.turned("bowl", hollow(outer, p.wall, p.wall, fine=bulged(outer, 4)), segments=16)
    body.turned("foot", solid([(0.92 * foot, 0), (foot, ring)]), segments=16)
    body.breakable = breaking(p.material, 14, int(rng.integers(1000)), p.wall) if p.breakable else None
    made = Made.of(body)
    made.places["inside"] = Place((0, 0, ring + p.wall), (foot, foot))
    return made


class PlateParameters(Parameters):
    """A plate with a well and a raised rim."""

    diameter: float = Field(default=0.26, ge=0.15, le=0.34, description="[m]")
    height: float = Field(default=0.024, ge=0.016, le=0.045, description="of the rim [m]")
    well: float = Field(default=0.64, ge=0.5, le=0.75, description="diameter of the flat middle over that of the plate")
    wall: float = Field(default=0.004, ge=0.003, le=0.007, description="thickness [m]")
    breakable: bool = BREAKABLE
    material: str = material("porcelain", "terracotta", "stainless_steel", "tin", "soda_lime_glass")


def _dish(body: Body, radius: float, well: float, height: float, wall: float) -> float:
    """A foot ring, a flat middle and a rim that rises in two steps; returns the height of the middle [m]."""
    foot = 0.15 * height + 0.001
    mid = well + 0.35 * (radius - well)
    outer = [(well, foot), (mid, foot + 0.55 * (height - foot)), (radius, height)]
    body.turned("plate", hollow(outer, wall, wall), segments=24)
    body.turned("foot", solid([(0.9 * well, 0), (0.93 * well, foot)]), segments=24)
    return foot + wall


def _plate(p: PlateParameters, rng: np.random.Generator) -> Made:
    body = Body("plate", p.material)
    radius = p.diameter / 2
    low = _dish(body, radius, p.well * radius * float(rng.uniform(0.96, 1.0)), p.height, p.wall)
    body.breakable = breaking(p.material, 14, int(rng.integers(1000)), p.wall) if p.breakable else None
    made = Made.of(body)
    made.places["middle"] = Place((0, 0, low), (1.2 * p.well * radius, 1.2 * p.well * radius))
    return made


class SaucerParameters(Parameters):
    """A saucer with a flat middle for a cup."""

    diameter: float = Field(default=0.15, ge=0.11, le=0.18, description="[m]")
    height: float = Field(default=0.018, ge=0.014, le=0.028, description="of the rim [m]")
    material: str = material("porcelain", "terracotta", "soda_lime_glass")


def _saucer(p: SaucerParameters, rng: np.random.Generator) -> Made:
    body = Body("saucer", p.material)
    radius = p.diameter / 2
    well = radius * float(rng.uniform(0.48, 0.56))
    low = _dish(body, radius, well, p.height, 0.0035)
    made = Made.of(body)
    made.places["middle"] = Place((0, 0, low), (1.3 * well, 1.3 * well))
    return made


class MugParameters(Parameters):
    """A mug with a handle; a breakable one has none."""

    height: float = Field(default=0.095, ge=0.06, le=0.13, description="[m]")
    diameter: float = Field(default=0.082, ge=0.06, le=0.11, description="of the rim [m]")
    wall: float = Field(default=0.004, ge=0.003, le=0.006, description="thickness of the wall [m]")
    breakable: bool = BREAKABLE
    material: str = material("porcelain", "terracotta", "stainless_steel", "soda_lime_glass", "tin")


def _mug(p: MugParameters, rng: np.random.Generator) -> Made:
    segments, rim, top = 20, p.diameter / 2, p.height
    foot = float(rng.uniform(0.88, 1.0)) * rim
    outer = [(foot - 0.003, 0), (foot, 0.003), (rim, top)]
    body = Body("mug", p.material)
    profile = hollow([(foot, 0), (rim, top)], p.wall, 1.3 * p.wall, fine=outer)
    body.turned("mug", profile, segments=segments, euler=half(segments))
    if p.breakable:
        body.breakable = breaking(p.material, 12, int(rng.integers(1000)), p.wall)
    else:
        low, high = facet(outer, 0.24 * top, segments), facet(outer, 0.8 * top, segments)
        broad = 0.92 * 2 * low.x * math.tan(math.pi / segments)
        body.sweep("handle", grip(low, high, 0.028), rounded(broad, 0.0065, 0.0025, 2))
    made = Made.of(body)
    made.places["inside"] = Place((0, 0, 1.3 * p.wall), (foot, foot), top - 1.3 * p.wall)
    return made


class TeapotParameters(Parameters):
    """A round teapot with spout, handle and a loose lid."""

    height: float = Field(default=0.13, ge=0.09, le=0.18, description="without the lid [m]")
    diameter: float = Field(default=0.15, ge=0.11, le=0.2, description="of the belly [m]")
    wall: float = Field(default=0.004, ge=0.003, le=0.006, description="thickness of the wall [m]")
    material: str = material("porcelain", "terracotta", "cast_iron", "silver")


def _teapot(p: TeapotParameters, rng: np.random.Generator) -> Made:
    segments, wide, top = 14, p.diameter / 2, p.height
    mouth = 0.5 * wide
    full = float(rng.uniform(0.4, 0.48))
    coarse = [(0.55 * wide, 0), (wide, full * top), (mouth, top)]
    outer = bulged(coarse, 4)
    body = Body("teapot", p.material)
    body.turned("pot", hollow(coarse, p.wall, 1.5 * p.wall, fine=outer), segments=segments, euler=half(segments))
    low, high = facet(outer, 0.3 * top, segments), facet(outer, 0.82 * top, segments)
    broad = min(0.016, 0.8 * 2 * high.x * math.tan(math.pi / segments))
    body.sweep("handle", grip(low, high, 0.42 * top, steps=8), rounded(broad, 0.55 * broad, 0.2 * broad, 2))
    start = facet(outer, (full + 0.06) * top, segments)
    r = 0.72 * start.x * math.tan(math.pi / segments)
    tip = np.array([1.72 * wide, 0, top + 0.004])
    bend = [start.out(0.9 * r), start.out(0.36 * wide) + np.array([0, 0, 0.12 * top]), tip - (0.1 * wide, 0, 0.14 * top), tip]
    path = [start.out(0), *(np.array(q) for q in curve(bend, 2))]
    scales = list(np.linspace(1.0, 0.55, len(path)))
    body.sweep("spout", [q * (-1, 1, 1) for q in path], circle(r, 8), scales=scales)
    lid = Body("lid", p.material)
    over = top + CLEAR
    plug = (mouth - 2.2 * p.wall) * 0.9
    lid.turned("plug", solid([(0.9 * plug, top - 0.008), (plug, over)]), segments=24)
    lid.turned(
        "dome", solid([(0.97 * mouth, over), (0.8 * mouth, over + 0.09 * wide), (0.3 * mouth, over + 0.16 * wide)]), segments=24
    )
    up, size = over + 0.16 * wide, 0.22 * mouth
    lid.turned("stem", solid([(0.6 * size, up), (0.6 * size, up + 0.5 * size)]), segments=16)
    lid.sphere("knob", (0, 0, up + 1.29 * size), 0.79 * size)
    made = Made({"": body, "lid": lid})
    made.carries.append(("", "lid"))
    return made


class CutleryParameters(Parameters):
    """A piece of cutlery, lying with its handle towards the front."""

    length: float = Field(default=0.2, ge=0.13, le=0.26, description="[m]")
    thickness: float = Field(default=0.0025, ge=0.0018, le=0.004, description="of the metal [m]")
    grip: str = material("stainless_steel", "silver", "oak", "abs", of="the handle")
    material: str = material("stainless_steel", "silver", "brass")


def _handle(body: Body, p: CutleryParameters, rng: np.random.Generator, end: float) -> None:
    """A handle from the front end to y = `end`, wide at its end, narrow at its neck."""
    back = -p.length / 2
    wide, long = 0.1 * p.length * float(rng.uniform(0.9, 1.1)), end - back
    half_outline = [(0.28, 0.0), (0.46, 0.06), (0.46, 0.2), (0.2, 0.85), (0.2, 1.0)]
    right = [(w * wide, back + long * s) for w, s in half_outline]
    thick = p.thickness if p.grip == p.material else 3 * p.thickness
    body.prism("handle", [*right, *((-x, y) for x, y in reversed(right))], 0, thick, material=p.grip)


def _knife(p: CutleryParameters, rng: np.random.Generator) -> Made:
    body = Body("knife", p.material)
    neck, tip = -0.02 * p.length, p.length / 2
    _handle(body, p, rng, neck)
    wide = 0.1 * p.length
    rows = ((neck, -0.2, 0.2), (neck + 0.08 * p.length, -0.5, 0.42), (tip - 0.09 * p.length, -0.46, 0.42), (tip, 0.2, 0.32))
    points = [
        (x * wide, y, z)
        for y, low, high in rows
        for x, z in ((low, 0), (high, 0), (high, p.thickness), (0.5 * (low + high), p.thickness))
    ]
    body.hull("blade", points)
    return Made.of(body)


def _tines(body: Body, p: CutleryParameters, count: int, start: float) -> None:
    """Tines that bend up and down again, side by side."""
    wide, t, tip = 0.11 * p.length, p.thickness, p.length / 2
    each = wide / (2 * count - 1)
    for number in range(count):
        x = -wide / 2 + each * (2 * number + 0.5)
        rows = ((0.0, 0.004), (0.12, 0.004), (0.45, 0.0), (0.6, 0.0), (1.0, 0.004))
        path = [(x, start + share * (tip - start), t / 2 + lift) for share, lift in rows]
        body.sweep(f"tine_{number + 1}", path, rectangle(each, t), scales=[1, 1, 1, 1, 0.6])


def _fork(p: CutleryParameters, rng: np.random.Generator) -> Made:
    body = Body("fork", p.material)
    neck, root = 0.12 * p.length, 0.28 * p.length
    _handle(body, p, rng, neck)
    t, wide, slim = p.thickness, 0.11 * p.length, 0.02 * p.length
    lift = 0.004
    rows = (
        (neck, slim, 0.0),
        (neck + 0.06 * p.length, slim, 0.5 * lift),
        (neck + 0.1 * p.length, wide / 2, lift),
        (root, wide / 2, lift),
    )
    for number, ((y0, w0, z0), (y1, w1, z1)) in enumerate(itertools.pairwise(rows), start=1):
        ends = ((y0, w0, z0), (y1, w1, z1))
        body.hull(f"neck_{number}", [(s * w, y, z + h) for y, w, z in ends for s in (-1, 1) for h in (0, t)])
    _tines(body, p, int(rng.integers(3, 5)), root)
    return Made.of(body)


def _spoon(p: CutleryParameters, rng: np.random.Generator) -> Made:
    body = Body("spoon", p.material)
    neck = 0.14 * p.length
    _handle(body, p, rng, neck)
    t, slim, tip = p.thickness, 0.02 * p.length, p.length / 2
    long, wide, deep = tip - neck - 0.07 * p.length, 0.1 * p.length, 0.028 * p.length
    join = neck + 0.07 * p.length
    body.hull("neck", [(s * slim, y, z + h) for y, z in ((neck, 0.0), (join, deep)) for s in (-1, 1) for h in (0, t)])
    middle, count = join + long / 2, 12

    def ring(share: float, z: float) -> list[tuple[float, float, float]]:
        turns = (2 * math.pi * (k + 0.5) / count for k in range(count))
        reach = 1 / math.cos(math.pi / count)
        return [(share * wide * math.sin(a), middle + share * reach * long / 2 * math.cos(a), z) for a in turns]

    out, inner, low, floor = ring(1.0, deep + t), ring(1 - 1.2 * t / wide, deep + t), ring(0.55, 0.0), ring(0.5, t)
    for k in range(count):
        m = (k + 1) % count
        body.hull(f"side_{k + 1}", [q[n] for q in (out, inner, low, floor) for n in (k, m)])
    body.hull("bottom", [*low, *floor])
    return Made.of(body)


class ChoppingBoardParameters(Parameters):
    """A chopping board with a hole to hang it."""

    length: float = Field(default=0.38, ge=0.22, le=0.6, description="along x [m]")
    width: float = Field(default=0.25, ge=0.15, le=0.4, description="along y [m]")
    thickness: float = Field(default=0.02, ge=0.012, le=0.04, description="[m]")
    handle: bool = Field(default=True, description="a handle with a hole at the right end")
    material: str = material("beech", "oak", "walnut", "bamboo", "polyethylene")


def _chopping_board(p: ChoppingBoardParameters, rng: np.random.Generator) -> Made:
    body = Body("chopping board", p.material)
    corner = float(rng.uniform(0.06, 0.2)) * p.width
    x = p.length / 2
    if not p.handle:
        body.prism("board", rounded(p.length, p.width, corner, 4), 0, p.thickness)
    else:
        body.prism("board", rounded(p.length, p.width, corner, 4), 0, p.thickness)
        wide, hole, segments = 0.055, 0.012, 16
        body.box("neck", (x, -wide / 2, 0), (x + 0.05, wide / 2, p.thickness))
        outer = wide / 2
        at = x + 0.05 + outer * math.cos(math.pi / segments)
        body.turned(
            "eye",
            [(hole, 0), (outer, 0), (outer, p.thickness), (hole, p.thickness)],
            (at, 0, 0),
            segments=segments,
            euler=half(segments),
        )
    made = Made.of(body)
    made.places["top"] = Place((0, 0, p.thickness), (p.length - corner, p.width - corner))
    return made


class RollingPinParameters(Parameters):
    """A rolling pin with turned handles, lying along x."""

    length: float = Field(default=0.42, ge=0.3, le=0.55, description="with its handles [m]")
    diameter: float = Field(default=0.055, ge=0.04, le=0.075, description="of the roller [m]")
    handle: float = Field(default=0.2, ge=0.15, le=0.26, description="length of a handle over the whole length")
    material: str = material("beech", "maple", "pine", "marble", "walnut")


def _rolling_pin(p: RollingPinParameters, rng: np.random.Generator) -> Made:
    body = Body("rolling pin", p.material)
    r, sides = p.diameter / 2, 40
    long, grip_r = p.handle * p.length, 0.42 * r * float(rng.uniform(0.9, 1.1))
    half_roll = p.length / 2 - long
    flat = r * math.cos(math.pi / sides)
    roller = [(0.94 * r, -half_roll), (r, -half_roll + 0.004), (r, half_roll - 0.004), (0.94 * r, half_roll)]
    body.turned("roller", solid(roller), (0, 0, flat), segments=sides, euler=lying(sides))
    shape = [(0.75, 0.0), (0.6, 0.08), (0.95, 0.5), (1.0, 0.75), (0.8, 0.95), (0.4, 1.0)]
    for name, side in (("left", -1), ("right", 1)):
        rows = [(grip_r * w, side * (half_roll + long * s)) for w, s in shape]
        body.turned(f"handle_{name}", solid(rows[1:] if side > 0 else rows[:0:-1]), (0, 0, flat), segments=20, euler=lying(20))
        body.cylinder(f"axle_{name}", (side * half_roll, 0, flat), (side * (half_roll + 0.08 * long), 0, flat), 0.5 * grip_r)
    return Made.of(body)


GENERATORS = (
    Generator("bowl", "round bowl on a foot ring; may shatter", BowlParameters, _bowl, ("dish", "salad", "soup", "vessel", "kitchen", "tableware")),
    Generator("plate", "plate with a raised rim; may shatter", PlateParameters, _plate, ("dish", "dinner", "kitchen", "tableware", "crockery")),
    Generator("saucer", "saucer for a cup", SaucerParameters, _saucer, ("dish", "cup", "tea", "tableware", "crockery")),
    Generator(
        "mug", "mug with a handle; a breakable one has no handle", MugParameters, _mug,
        ("cup", "coffee", "tea", "beaker", "vessel", "tableware", "crockery"),
    ),
    Generator("teapot", "teapot with spout, handle and a loose lid", TeapotParameters, _teapot, ("tea", "pot", "vessel", "tableware", "crockery")),
    Generator("knife", "table knife", CutleryParameters, _knife, ("cutlery", "tableware", "kitchen", "blade")),
    Generator("fork", "table fork", CutleryParameters, _fork, ("cutlery", "tableware", "kitchen")),
    Generator("spoon", "table spoon", CutleryParameters, _spoon, ("cutlery", "tableware", "kitchen", "ladle")),
    Generator(
        "chopping_board", "chopping board with a handle", ChoppingBoardParameters, _chopping_board, ("cutting", "bread", "kitchen", "tray"),
    ),
    Generator("rolling_pin", "rolling pin with turned handles", RollingPinParameters, _rolling_pin, ("baking", "dough", "kitchen")),
)  # fmt: skip
