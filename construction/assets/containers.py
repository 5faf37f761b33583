"""Barrels, buckets, crates, boxes, chests, suitcases, baskets and toolboxes."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made, Place
from .profiles import arc, circle
from .turning import TRIM, drawn, facet, half, hollow, moved, solid

__all__ = ["GENERATORS"]

GAP = 6e-4
"""[m] Between bodies."""


class BarrelParameters(Parameters):
    """A barrel of bulging staves held by hoops, with a head at both ends."""

    height: float = Field(default=0.85, ge=0.3, le=1.2, description="[m]")
    diameter: float = Field(default=0.62, ge=0.25, le=0.9, description="of the belly [m]")
    bulge: float = Field(default=0.84, ge=0.75, le=0.95, description="diameter at the ends over that of the belly")
    staves: int = Field(default=16, ge=12, le=18, description="staves")
    thickness: float = Field(default=0.024, ge=0.016, le=0.032, description="of a stave [m]")
    open: bool = Field(default=False, description="without its upper head")
    hoop: str = material("mild_steel", "cast_iron", "zinc", of="the hoops")
    material: str = material("oak", "ash", "pine", "larch")


def _barrel(p: BarrelParameters, rng: np.random.Generator) -> Made:
    body, wide, n = Body("barrel", p.material), p.diameter / 2, p.staves
    shares = ((0.0, 0.0), (0.24, 0.72), (0.5, 1.0), (0.76, 0.72), (1.0, 0.0))
    levels = [(s * p.height, wide * (p.bulge + (1 - p.bulge) * b)) for s, b in shares]

    def radius(z: float) -> float:
        return float(np.interp(z, [q for q, _ in levels], [r for _, r in levels]))

    flat = math.cos(math.pi / n)
    inset = p.thickness / flat
    for k in range(n):
        for number in range(4):
            points = []
            for z, r in levels[number : number + 2]:
                side = r * math.sin(math.pi / n) - 0.0007
                narrow = (r - inset) * math.sin(math.pi / n) - 0.0007
                points += [(r * flat, s * side, z) for s in (-1, 1)] + [((r - inset) * flat, s * narrow, z) for s in (-1, 1)]
            body.hull(f"stave_{k + 1}_{number + 1}", moved(points, turn=2 * math.pi * (k + 0.5) / n))
    broad = 0.045 * p.height
    first, second = 0.015 * p.height, float(rng.uniform(0.17, 0.185)) * p.height
    starts = (first, second, p.height - second - broad, p.height - first - broad)
    for number, low in enumerate(starts, start=1):
        ends = [(radius(z), z) for z in (low, low + broad)]
        body.turned(f"hoop_{number}", [*ends, *((r + TRIM, z) for r, z in reversed(ends))], segments=n, material=p.hoop)
        drawn(body, f"hoop_{number}")  # it stands and rolls on its staves
    made = Made.of(body)
    recess, thick = 0.05 * p.height, 0.02
    heads = [("foot", recess)] if p.open else [("foot", recess), ("head", p.height - recess - thick)]
    for name, low in heads:
        body.turned(name, solid([(radius(z) - inset, z) for z in (low, low + thick)]), segments=n)
    level = recess + thick if p.open else p.height - recess
    made.places["inside" if p.open else "top"] = Place((0, 0, level), (wide, wide))
    return made


class BucketParameters(Parameters):
    """A bucket with a bail handle that swings on its ears."""

    height: float = Field(default=0.27, ge=0.15, le=0.4, description="[m]")
    diameter: float = Field(default=0.28, ge=0.16, le=0.4, description="of the rim [m]")
    taper: float = Field(default=0.74, ge=0.6, le=0.9, description="diameter of the foot over that of the rim")
    handle: str = material("mild_steel", "stainless_steel", "polypropylene", of="the handle")
    material: str = material("zinc", "polypropylene", "mild_steel", "copper", "tin")


def _bucket(p: BucketParameters, rng: np.random.Generator) -> Made:
    segments, rim, top = 20, p.diameter / 2, p.height
    outer = [(p.taper * rim, 0), (rim, top)]
    body = Body("bucket", p.material)
    body.turned("bucket", hollow(outer, 0.002, 0.004), segments=segments, euler=half(segments))
    band = 0.008
    slope = rim * (1 - p.taper) / top
    body.turned(
        "rim",
        [(rim - band * slope, top - band), (rim + 0.004, top - band), (rim + 0.004, top), (rim, top)],
        segments=segments,
        euler=half(segments),
    )
    low, high = (facet(outer, z, segments) for z in (top - 0.05, top - band - 0.001))
    pivot, ear = top - 0.028, high.x + 0.009
    for name, s in (("right", 1), ("left", -1)):
        body.hull(f"ear_{name}", [(s * x, y, f.z) for f in (low, high) for x in (f.x, ear) for y in (-0.013, 0.013)])
    wire = float(rng.uniform(0.0028, 0.0036))
    reach = max(ear + GAP + wire * 1.06 + 5e-4, math.hypot(rim + 0.006 + 1.1 * wire, top - pivot))
    bail = Body("handle of the bucket", p.handle)
    steps = 20
    points = [(reach * math.cos(a), -reach * math.sin(a), pivot) for a in np.linspace(0, math.pi, steps + 1)]
    points[1:-1] = [(1.004 * x, y * 1.004 - 0.004, z) for x, y, z in points[1:-1]]
    bail.sweep("bail", points, circle(wire, 8))
    made = Made({"": body, "handle": bail})
    made.joints["handle"] = Joint(
        "handle", "hinge", (reach, 0, pivot), axis=(-1, 0, 0), range=(0.0, math.pi), damping=0.002, friction=0.003
    )
    made.places["inside"] = Place((0, 0, 0.004), (1.2 * p.taper * rim, 1.2 * p.taper * rim), top)
    return made


class WoodenCrateParameters(Parameters):
    """An open crate of slats on corner posts."""

    width: float = Field(default=0.5, ge=0.25, le=0.9, description="along x [m]")
    depth: float = Field(default=0.35, ge=0.2, le=0.6, description="along y [m]")
    height: float = Field(default=0.28, ge=0.14, le=0.6, description="[m]")
    slats: int = Field(default=3, ge=2, le=5, description="slats of a side, one over the other")
    thickness: float = Field(default=0.01, ge=0.006, le=0.018, description="of a slat [m]")
    material: str = material("pine", "spruce", "plywood", "larch", "birch")


def _wooden_crate(p: WoodenCrateParameters, rng: np.random.Generator) -> Made:
    body, t, post = Body("wooden crate", p.material), p.thickness, 0.03
    x, y = p.width / 2, p.depth / 2
    for number, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        a, b = (sx * (x - t), sy * (y - t)), (sx * (x - t - post), sy * (y - t - post))
        low, high = np.minimum(a, b), np.maximum(a, b)
        body.box(f"post_{number}", (*low, t), (*high, p.height))
    pitch = p.height / p.slats
    broad = pitch * 0.8
    for k in range(p.slats):
        low = k * pitch + (pitch - broad) * (k / max(p.slats - 1, 1))
        jitter = 0.001 * rng.uniform(-1, 1, 4)
        for s, name, j in ((-1, "front", 0), (1, "back", 1)):
            ys = sorted((s * y, s * (y - t)))
            body.box(f"{name}_{k + 1}", (-x, ys[0], low), (x + jitter[j], ys[1], low + broad))
        for s, name in ((-1, "left"), (1, "right")):
            xs = sorted((s * x, s * (x - t)))
            body.box(f"{name}_{k + 1}", (xs[0], -y + t, low), (xs[1], y - t, low + broad))
    boards = max(3, round((p.depth - 2 * t) / 0.09))
    each = (p.depth - 2 * t) / boards
    for k in range(boards):
        low_y = -y + t + k * each
        body.box(f"floor_{k + 1}", (-x + t, low_y, 0.0), (x - t, low_y + each - (0.006 if k + 1 < boards else 0.0), t))
    made = Made.of(body)
    middle = -y + t + (boards // 2) * each + each / 2
    made.places["inside"] = Place((0, middle, t), (p.width - 2 * t - 2 * post, 0.6 * p.depth), p.height - t)
    return made


class CardboardBoxParameters(Parameters):
    """A cardboard box, taped shut or with its flaps folded out."""

    width: float = Field(default=0.4, ge=0.15, le=0.8, description="along x [m]")
    depth: float = Field(default=0.3, ge=0.12, le=0.6, description="along y [m]")
    height: float = Field(default=0.3, ge=0.1, le=0.6, description="[m]")
    open: bool = Field(default=False, description="flaps folded out and down a little, else shut with a tape")
    material: str = material("cardboard")


def _cardboard_box(p: CardboardBoxParameters, rng: np.random.Generator) -> Made:
    body, t = Body("cardboard box", p.material), 0.004
    x, y, top = p.width / 2, p.depth / 2, p.height
    wall = top if p.open else top - t
    body.box("bottom", (-x, -y, 0), (x, y, t))
    for s, name in ((-1, "front"), (1, "back")):
        ys = sorted((s * y, s * (y - t)))
        body.box(name, (-x, ys[0], t), (x, ys[1], wall))
    for s, name in ((-1, "left"), (1, "right")):
        xs = sorted((s * x, s * (x - t)))
        body.box(name, (xs[0], -y + t, t), (xs[1], y - t, wall))
    made = Made.of(body)
    if not p.open:
        body.box("flap_front", (-x, -y, wall), (x, -0.0005, top))
        body.box("flap_back", (-x, 0.0005, wall), (x, y, top))
        body.box("tape", (-x, -0.025, top), (x, 0.025, top + 0.0004), material="polypropylene")
        body.box("tape_left", (-x - 0.0004, -0.025, top - 0.06), (-x, 0.025, top + 0.0004), material="polypropylene")
        body.box("tape_right", (x, -0.025, top - 0.06), (x + 0.0004, 0.025, top + 0.0004), material="polypropylene")
        drawn(body, "tape", "tape_left", "tape_right")
        made.places["top"] = Place((0, 0, top + 0.0004), (0.9 * p.width, 0.9 * p.depth))
        return made
    for name, turn, reach, long in (("front", -1, y, x), ("right", 0, x, y), ("back", 1, y, x), ("left", 2, x, y)):
        lean = float(rng.uniform(-0.5, 0.9))
        flap = 0.95 * min(x, y)
        far, up = reach + flap * math.cos(lean), top + flap * math.sin(lean)
        corners = ((reach, top), (reach - t, top + t), (far, up), (far - t * math.sin(lean), up + t * math.cos(lean)))
        points = [(r, s * (long - 0.01), z) for r, z in corners for s in (-1, 1)]
        body.hull(f"flap_{name}", moved(points, turn=turn * math.pi / 2))
    made.places["inside"] = Place((0, 0, t), (p.width - 2 * t, p.depth - 2 * t), top)
    return made


class ChestParameters(Parameters):
    """A box with a hinged lid, flat or vaulted, with metal straps."""

    width: float = Field(default=0.5, ge=0.15, le=1.2, description="along x [m]")
    depth: float = Field(default=0.32, ge=0.1, le=0.6, description="along y [m]")
    height: float = Field(default=0.26, ge=0.08, le=0.6, description="without the lid [m]")
    lid: Literal["flat", "vaulted"] = Field(default="vaulted", description="form of the lid")
    straps: int = Field(default=2, ge=0, le=3, description="metal straps over lid and front")
    metal: str = material("brass", "cast_iron", "mild_steel", of="straps and lock")
    material: str = material("oak", "pine", "walnut", "cherry_wood", "mahogany")


def _chest(p: ChestParameters, rng: np.random.Generator) -> Made:
    x, y, top = p.width / 2, p.depth / 2, p.height
    t = min(0.016, 0.08 * p.depth)
    foot = 0.06 * p.height
    body = Body("chest", p.material)
    body.box("plinth_front", (-x, -y, 0), (x, -y + 2 * t, foot))
    body.box("plinth_back", (-x, y - 2 * t, 0), (x, y, foot))
    body.box("bottom", (-x, -y, foot), (x, y, foot + t))
    for s, name in ((-1, "front"), (1, "back")):
        ys = sorted((s * y, s * (y - t)))
        body.box(name, (-x, ys[0], foot + t), (x, ys[1], top))
    for s, name in ((-1, "left"), (1, "right")):
        xs = sorted((s * x, s * (x - t)))
        body.box(name, (xs[0], -y + t, foot + t), (xs[1], y - t, top))
    over, thin, wide = top + GAP, 0.002, min(0.03, 0.08 * p.width)
    lid = Body("lid of the chest", p.material)
    if p.lid == "flat":
        lid.box("lid", (-x, -y, over), (x, y, over + 1.4 * t))
        outline = [(y, over + 1.4 * t), (-y, over + 1.4 * t)]
    else:
        low, rise = over + 1.2 * t, float(rng.uniform(0.28, 0.36)) * p.depth
        r = (y * y + rise * rise) / (2 * rise)
        spread = math.asin(min(1.0, y / r))
        outline = arc((0.0, low + rise - r), r, math.pi / 2 - spread, math.pi / 2 + spread, 8)
        outline[0], outline[-1] = (y, low), (-y, low)
        shell = arc((0.0, low + rise - r), r - t, math.pi / 2 + 0.94 * spread, math.pi / 2 - 0.94 * spread, 8)
        shell[0], shell[-1] = (-y + t, low), (y - t, low)
        lid.prism("vault", [*outline, *shell], -x, x, axis="x")
        for s, name in ((-1, "left"), (1, "right")):
            lid.prism(f"end_{name}", list(reversed(shell)), *sorted((s * x, s * (x - t))), axis="x")
        for s, name in ((-1, "front"), (1, "back")):
            lid.box(f"edge_{name}", (-x, min(s * y, s * (y - t)), over), (x, max(s * y, s * (y - t)), low))
        for s, name in ((-1, "left"), (1, "right")):
            lid.box(f"edge_{name}", (min(s * x, s * (x - t)), -y + t, over), (max(s * x, s * (x - t)), y - t, low))
    _straps(p, body, lid, outline, (wide, thin, foot))
    made = Made({"": body, "lid": lid})
    made.joints["lid"] = Joint(
        "lid", "hinge", (0, y, top + GAP / 2), axis=(-1, 0, 0), range=(0.0, 1.8), damping=0.2, friction=0.3
    )
    made.places["inside"] = Place((0, 0, foot + t), (p.width - 2 * t, p.depth - 2 * t), top - foot - t)
    return made


def _straps(
    p: ChestParameters, body: Body, lid: Body, outline: list[tuple[float, float]], sizes: tuple[float, float, float]
) -> None:
    """Metal straps over the lid's outline (y, z) and down the front, and a lock plate."""
    (wide, thin, foot), y, top = sizes, p.depth / 2, p.height
    for k in range(p.straps):
        x = p.width * ((k + 0.5) / p.straps - 0.5)
        raised = [(a, b + thin) if 0 < n < len(outline) - 1 or len(outline) == 2 else (a, b) for n, (a, b) in enumerate(outline)]
        if len(outline) > 2:
            raised = [outline[1], *((a, b + thin) for a, b in outline[1:-1]), outline[-2]]
            lid.prism(
                f"strap_{k + 1}", [*raised, *reversed(outline[2:-2])], x - wide / 2, x + wide / 2, axis="x", material=p.metal
            )
        else:
            lid.prism(f"strap_{k + 1}", [*outline, *reversed(raised)], x - wide / 2, x + wide / 2, axis="x", material=p.metal)
        body.box(f"strap_{k + 1}", (x - wide / 2, -y - thin, foot), (x + wide / 2, -y, top), material=p.metal)
    if p.straps != 1 and p.straps != 3:
        size = min(0.05, 0.3 * p.height, 0.2 * p.width)
        body.box("lock", (-size / 2, -y - 2 * thin, top - size), (size / 2, -y, top), material=p.metal)


GENERATORS = (
    Generator("barrel", "barrel of staves with hoops", BarrelParameters, _barrel, ("cask", "keg", "wine", "rain", "cellar", "container")),
    Generator("bucket", "bucket with a bail handle that swings", BucketParameters, _bucket, ("pail", "water", "garden", "cleaning", "container")),
    Generator("wooden_crate", "open crate of slats", WoodenCrateParameters, _wooden_crate, ("box", "fruit", "container", "storage", "slats")),
    Generator("cardboard_box", "cardboard box, shut or with open flaps", CardboardBoxParameters, _cardboard_box, ("carton", "parcel", "moving", "storage", "container")),
    Generator("chest", "box with a lid on hinges, flat or vaulted", ChestParameters, _chest, ("box", "trunk", "casket", "treasure", "lid", "container", "storage")),
)  # fmt: skip
