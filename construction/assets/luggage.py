"""Suitcases, baskets and toolboxes: containers that are carried by a handle."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import rectangle, rounded
from .turning import TRIM, drawn, facet, half, hollow, moved

__all__ = ["GENERATORS"]


class SuitcaseParameters(Parameters):
    """A hollow suitcase that stands upright, its handle above."""

    width: float = Field(default=0.55, ge=0.35, le=0.75, description="along x [m]")
    height: float = Field(default=0.38, ge=0.28, le=0.5, description="without feet and handle [m]")
    depth: float = Field(default=0.17, ge=0.13, le=0.28, description="along y [m]")
    metal: str = material("brass", "stainless_steel", "mild_steel", of="locks, feet and corners")
    trim: str = material("leather", "neoprene", "oak", of="handle and straps")
    material: str = material("leather", "cardboard", "abs", "aluminium_alloy", "polycarbonate")


def _suitcase(p: SuitcaseParameters, rng: np.random.Generator) -> Made:
    body, foot, t = Body("suitcase", p.material), 0.012, 0.004
    x, y, low, top = p.width / 2, p.depth / 2, foot, foot + p.height
    corner, seam = float(rng.uniform(0.03, 0.05)), 0.004
    middle = (low + top) / 2
    for name, s in (("front", -1), ("back", 1)):
        outline = [(a, b + middle) for a, b in rounded(p.width, p.height, corner, 3)]
        body.prism(f"panel_{name}", outline, *sorted((s * y, s * (y - t))), axis="y")
        inside = rounded(p.width - t, p.height - t, corner - t / 2, 3)
        depth = y - t - seam / 2
        centre = s * (seam / 2 + depth / 2)
        body.sweep(f"frame_{name}", [(a, centre, b + middle) for a, b in inside], rectangle(depth, t), closed=True)
    inner = rounded(p.width - 1.5 * t, p.height - 1.5 * t, corner - 0.75 * t, 3)
    body.sweep("seam", [(a, 0, b + middle) for a, b in inner], rectangle(seam, 0.5 * t), closed=True, material=p.metal)
    for number, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        at = (sx * (x - 0.07), sy * (y - 0.03))
        body.cylinder(f"foot_{number}", (*at, 0), (*at, low), 0.009, material=p.metal)
    for number, s in enumerate((-1, 1), start=1):
        lock = s * max(0.3 * p.width, 0.11)
        body.box(
            f"lock_{number}",
            (lock - 0.02, -y + 0.012, top),
            (lock + 0.02, y - 0.012 - 0.5 * p.depth, top + 0.006),
            material=p.metal,
        )
        hold = s * 0.075
        body.box(f"mount_{number}", (hold - 0.012, -0.014, top), (hold + 0.012, 0.014, top + 0.006), material=p.metal)
        for face, side in (("front", -1), ("back", 1)):
            ys = sorted((side * y, side * (y + 0.0025)))
            strap = s * 0.3 * p.width
            body.box(
                f"strap_{face}_{number}",
                (strap - 0.016, ys[0], low + 0.002),
                (strap + 0.016, ys[1], top - 0.002),
                material=p.trim,
            )
    up = top + 0.006
    rise = [
        (-0.075, 0, up),
        (-0.075, 0, up + 0.018),
        (-0.05, 0, up + 0.034),
        (0.05, 0, up + 0.034),
        (0.075, 0, up + 0.018),
        (0.075, 0, up),
    ]
    body.sweep("handle", rise, rounded(0.012, 0.022, 0.004, 2), material=p.trim)
    return Made.of(body)


class BasketParameters(Parameters):
    """A round basket of ribs and woven bands, with a bow over it."""

    diameter: float = Field(default=0.32, ge=0.18, le=0.5, description="of the rim [m]")
    height: float = Field(default=0.17, ge=0.1, le=0.4, description="without the bow [m]")
    taper: float = Field(default=0.78, ge=0.65, le=0.95, description="diameter of the foot over that of the rim")
    bow: bool = Field(default=True, description="a bow to carry it by")
    material: str = material("bamboo", "ash", "linen", "birch")


def _basket(p: BasketParameters, rng: np.random.Generator) -> Made:
    segments, rim, top = 14, p.diameter / 2, p.height
    foot = p.taper * rim
    outer = [(foot, 0), (rim, top)]
    body = Body("basket", p.material)
    body.turned("wall", hollow(outer, 0.003, 0.006), segments=segments, euler=half(segments))
    bands, thick = 3, 0.006
    for number in range(bands):
        high = 0.13 * top
        low = (top - high) * number / (bands - 1)
        inner = [(foot + (rim - foot) * z / top, z) for z in (low, low + high)]
        proud = [(r + thick * (1.6 if number == bands - 1 else 1.0), z) for r, z in reversed(inner)]
        body.turned(f"band_{number + 1}", [*inner, *proud], segments=segments, euler=half(segments))
    gap = (top - bands * 0.13 * top) / (bands - 1)
    for k in range(segments):
        for number in range(bands - 1):
            low = 0.13 * top + number * (gap + 0.13 * top)
            ends = [facet(outer, z, segments) for z in (low, low + gap)]
            rise = thick * float(rng.uniform(0.5, 0.9))
            broad = 0.55 * ends[0].x * math.tan(math.pi / segments)
            points = [(f.x + a, s * broad, f.z) for f in ends for a in (0.0, rise) for s in (-1, 1)]
            body.hull(f"rib_{k + 1}_{number + 1}", moved(points, turn=2 * math.pi * k / segments))
    if p.bow:
        reach = rim * math.cos(math.pi / segments) + 0.5 * thick
        steps = np.linspace(0, math.pi, 9)
        arch = [(reach * math.cos(a), 0, top + 0.02 + 0.9 * rim * math.sin(a)) for a in steps]
        body.sweep("bow", [(reach, 0, top), *arch, (-reach, 0, top)], rounded(0.022, 0.007, 0.003, 1))
    made = Made.of(body)
    made.places["inside"] = Place((0, 0, 0.006), (1.2 * foot, 1.2 * foot), top if not p.bow else 0.8 * top)
    return made


class ToolboxParameters(Parameters):
    """An open wooden toolbox with gabled ends and a round bar to carry it by."""

    width: float = Field(default=0.5, ge=0.3, le=0.8, description="along x [m]")
    depth: float = Field(default=0.24, ge=0.16, le=0.35, description="along y [m]")
    height: float = Field(default=0.26, ge=0.18, le=0.36, description="to the bar [m]")
    divider: bool = Field(default=True, description="a board that parts it in two")
    bar: str = material("beech", "ash", "mild_steel", of="the bar")
    material: str = material("pine", "plywood", "oak", "mild_steel")


def _toolbox(p: ToolboxParameters, rng: np.random.Generator) -> Made:
    body, t = Body("toolbox", p.material), 0.014
    x, y, side = p.width / 2, p.depth / 2, float(rng.uniform(0.4, 0.48)) * p.height
    tip = 0.04
    gable = [(-y, 0), (y, 0), (y, side), (tip, p.height), (-tip, p.height), (-y, side)]
    for s, name in ((-1, "left"), (1, "right")):
        body.prism(f"end_{name}", gable, *sorted((s * x, s * (x - t))), axis="x")
    body.box("bottom", (-x + t, -y, 0), (x - t, y, t))
    for s, name in ((-1, "front"), (1, "back")):
        ys = sorted((s * y, s * (y - t)))
        body.box(name, (-x + t, ys[0], t), (x - t, ys[1], side))
    z = p.height - 0.03
    body.cylinder("bar", (-x + t, 0, z), (x - t, 0, z), 0.015, material=p.bar)
    if p.divider:
        body.box("divider", (-x + t, -0.005, t), (x - t, 0.005, side))
    for number, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        body.cylinder(
            f"screw_{number}",
            (sx * x, sy * 0.7 * y, side * 0.5),
            (sx * (x + TRIM), sy * 0.7 * y, side * 0.5),
            0.005,
            material="mild_steel",
        )
        drawn(body, f"screw_{number}")
    made = Made.of(body)
    free = y - t - (0.005 if p.divider else 0.0)
    made.places["inside"] = Place((0, -free / 2 - 0.005 if p.divider else 0.0, t), (p.width - 2 * t, free), side)
    return made


GENERATORS = (
    Generator("suitcase", "suitcase with handle, locks and straps", SuitcaseParameters, _suitcase, ("luggage", "trunk", "travel", "bag", "case")),
    Generator("basket", "basket of ribs and bands with a bow", BasketParameters, _basket, ("wicker", "shopping", "picnic", "fruit", "container")),
    Generator("toolbox", "open wooden toolbox with a carrying bar", ToolboxParameters, _toolbox, ("tools", "workshop", "tote", "container")),
)  # fmt: skip
