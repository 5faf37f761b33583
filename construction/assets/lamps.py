"""Lamps that stand on tables, on floors, and hang from ceilings."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import pick, stacked
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Joint, Made
from .profiles import circle, rounded

__all__ = ["GENERATORS"]

Flat = list[tuple[float, float]]
METALS = ("brass", "stainless_steel", "mild_steel", "copper", "bronze")
SHADES = ("linen", "cotton", "silk", "cardboard")
Shades = Literal["varied", "cone", "drum", "empire", "dome"]


SHAPES: dict[str, Flat] = {
    "cone": [(1.0, 0.0), (0.5, 1.0)],
    "drum": [(1.0, 0.0), (0.9, 1.0)],
    "empire": [(1.0, 0.0), (0.74, 0.32), (0.5, 1.0)],
    "dome": [(1.0, 0.0), (0.94, 0.35), (0.72, 0.72), (0.35, 1.0)],
    "globe": [(0.3, 0.0), (0.8, 0.2), (1.0, 0.5), (0.8, 0.8), (0.3, 1.0)],
}
"""Outlines of shades: share of the radius, share of the height."""
WALL, AROUND = 0.0015, 24
"""Thickness of shades [m], and segments around them."""


def _shade(
    body: Body, kind: str, radius: float, levels: tuple[float, float], stuff: str, at: tuple[float, float] = (0.0, 0.0)
) -> None:
    """A hollow shade of a greatest radius, open below and above, between two heights about an upright axis [m]."""
    low, high = levels
    outer = [(radius * r, low + (high - low) * z) for r, z in SHAPES[kind]]
    inner = [(r - WALL, z) for r, z in outer]
    body.turned("shade", [*outer, *inner[::-1]], (*at, 0.0), segments=AROUND, material=stuff)


def _spider(body: Body, kind: str, radius: float, levels: tuple[float, float], level: float, metal: str) -> None:
    """A ring about the lamp's holder at a height, and three arms from it that bear a shade as `_shade` makes it."""
    ring = [(0.014, level - 0.004), (0.019, level - 0.004), (0.019, level), (0.014, level)]
    body.turned("ring", ring, segments=AROUND, material=metal)
    share = (level - 0.0005 - levels[0]) / (levels[1] - levels[0])
    rows = SHAPES[kind]
    reach = radius * float(np.interp(share, [z for _, z in rows], [r for r, _ in rows])) - WALL
    facet = math.cos(math.pi / AROUND)
    for number in range(3):
        turn = math.pi / AROUND + math.tau * number / 3
        c, s, z = math.cos(turn), math.sin(turn), level - 0.002
        foot, head = ((r * facet * c, r * facet * s, z) for r in (0.019, reach))
        body.cylinder(f"arm_{number + 1}", foot, head, 0.0015, material=metal)


def _bulb(body: Body, level: float, radius: float, *, down: bool = False) -> None:
    """A holder of plastic with a bulb of glass above a height, or below it."""
    d = -1 if down else 1
    holder = [(0.014, 0.0), (0.014, 0.04), (0.017, 0.045)]
    body.turned("holder", [(r, level + d * z) for r, z in ((0.0, 0.0), *holder, (0.0, 0.045))], segments=AROUND, material="abs")
    glass = [
        (0.012, 0.045),
        (0.014, 0.055),
        (radius, 0.045 + 1.3 * radius),
        (0.9 * radius, 0.045 + 1.9 * radius),
        (0.5 * radius, 0.045 + 2.3 * radius),
    ]
    outline = [(0.0, 0.045), *glass, (0.0, 0.045 + 2.35 * radius)]
    body.turned("bulb", [(r, level + d * z) for r, z in outline], segments=20, material="soda_lime_glass")


class TableLampParameters(Parameters):
    """A table lamp: a turned foot, or a thin stem, under a shade with its bulb."""

    height: float = Field(default=0.5, ge=0.32, le=0.75, description="along z [m]")
    shade: float = Field(default=0.32, ge=0.2, le=0.42, description="diameter of the shade's lower edge [m]")
    foot: Literal["varied", "vase", "ball", "stem", "block"] = Field(default="varied", description="kind of foot")
    shape: Shades = Field(default="varied", description="of the shade")
    cover: str = material(*SHADES, of="the shade")
    metal: str = material(*METALS, of="stem and ring")
    material: str = material("porcelain", "terracotta", "oak", "walnut", "brass", "marble")


def _table_lamp(p: TableLampParameters, rng: np.random.Generator) -> Made:
    body, foot = Body("table lamp", p.material), pick(p.foot, rng, "vase", "ball", "stem", "block")
    tall, width = min(0.45 * p.height, 0.85 * p.shade), min(p.shade, 0.85 * p.height)
    low = p.height - tall
    base, neck = 0.36 * width, low - 0.02
    if foot == "block":
        side = 0.28 * width
        body.prism("foot", rounded(1.2 * side, 1.2 * side, 0.01, 3), 0.0, 0.012, material=p.metal)
        body.hull(
            "block",
            [(a * side * k, b * side * k, z) for a in (-0.5, 0.5) for b in (-0.5, 0.5) for k, z in ((1.0, 0.012), (0.8, neck))],
        )
    elif foot == "stem":
        stacked(body, "foot", [(base, 0), (base, 0.008), (0.9 * base, 0.016), (0.014, 0.024)], segments=40)
        body.cylinder("stem", (0, 0, 0.024), (0, 0, neck), 0.007, material=p.metal)
    else:
        swell = float(rng.uniform(0.8, 1.05)) * base
        curve = {
            "vase": [
                (0.55, 0.0),
                (0.6, 0.04),
                (0.42, 0.1),
                (0.62, 0.2),
                (0.8, 0.32),
                (0.93, 0.46),
                (1.0, 0.6),
                (0.96, 0.72),
                (0.82, 0.84),
                (0.6, 0.93),
                (0.3, 1.0),
            ],
            "ball": [
                (0.6, 0.0),
                (0.6, 0.05),
                (0.35, 0.1),
                (0.62, 0.17),
                (0.84, 0.28),
                (0.97, 0.42),
                (1.0, 0.5),
                (0.97, 0.58),
                (0.84, 0.72),
                (0.62, 0.83),
                (0.22, 0.92),
                (0.22, 1.0),
            ],
        }[foot]
        stacked(body, "foot", [(r * swell, z * neck) for r, z in curve], segments=40)
    body.turned("neck", [(0, neck), (0.012, neck), (0.012, low), (0, low)], segments=18, material=p.metal)
    kind = pick(p.shape, rng, "cone", "drum", "empire")
    _bulb(body, low, min(0.03, 0.25 * tall))
    levels = (low - 0.01, p.height)
    _shade(body, kind, width / 2, levels, p.cover)
    _spider(body, kind, width / 2, levels, low + 0.03, p.metal)
    return Made.of(body)


class FloorLampParameters(Parameters):
    """A floor lamp: on a column or three legs under a shade, or with a reflector whose head tilts."""

    height: float = Field(default=1.6, ge=1.2, le=1.85, description="along z [m]")
    shade: float = Field(default=0.42, ge=0.3, le=0.55, description="diameter of the shade's lower edge [m]")
    kind: Literal["varied", "column", "tripod", "reading"] = Field(default="varied", description="of stand")
    shape: Literal["varied", "cone", "drum", "empire"] = Field(default="varied", description="of the shade")
    cover: str = material(*SHADES, of="the shade")
    metal: str = material(*METALS, of="column, foot and reflector")
    material: str = material("oak", "walnut", "beech", "birch")


def _floor_lamp(p: FloorLampParameters, rng: np.random.Generator) -> Made:
    body, kind = Body("floor lamp", p.material), pick(p.kind, rng, "column", "tripod", "reading")
    made, tall = Made.of(body), min(0.28, 0.75 * p.shade)
    low, radius = p.height - tall, p.shade / 2
    if kind != "tripod":
        body.turned("weight", [(0, 0), (0.14, 0), (0.14, 0.012), (0.13, 0.02), (0, 0.02)], segments=40, material="cast_iron")
        body.turned("foot", [(0, 0.02), (0.12, 0.02), (0.02, 0.035), (0, 0.035)], segments=32, material=p.metal)
    if kind == "reading":
        _reading(made, p, min(0.11, 0.4 * radius + 0.03))
        return made
    if kind == "tripod":
        hub = low - 0.12
        stacked(body, "hub", [(0.05, hub), (0.05, hub + 0.03), (0.02, hub + 0.045)])
        reach, turn = 0.26 + 0.06 * float(rng.random()), float(rng.uniform(0, math.tau))
        for number in range(3):
            a = turn + math.tau * number / 3
            c, s = math.cos(a), math.sin(a)
            body.taper(f"leg_{number + 1}", (reach * c, reach * s, 0), (0.03 * c, 0.03 * s, hub), (0.026, 0.026), (0.022, 0.022))
        body.cylinder("stem", (0, 0, hub + 0.045), (0, 0, low), 0.01, material=p.metal)
    else:
        body.cylinder("stem", (0, 0, 0.035), (0, 0, 0.45 * low), 0.0125, material=p.metal)
        body.turned(
            "joint",
            [(0, 0.45 * low), (0.02, 0.45 * low), (0.024, 0.45 * low + 0.02), (0.02, 0.45 * low + 0.04), (0, 0.45 * low + 0.04)],
            segments=24,
        )
        body.cylinder("rod", (0, 0, 0.45 * low + 0.04), (0, 0, low), 0.01, material=p.metal)
    shape = pick(p.shape, rng, "cone", "drum", "empire")
    levels = (low - 0.01, p.height)
    _bulb(body, low, 0.03)
    _shade(body, shape, radius, levels, p.cover)
    _spider(body, shape, radius, levels, low + 0.03, p.metal)
    return made


def _reading(made: Made, p: FloorLampParameters, radius: float) -> None:
    """A column bent to the front, and a reflector under its end that tilts on a hinge."""
    body, top, out = made.main, p.height - 0.012, radius + 0.04
    bend = [(-0.06 + 0.06 * math.cos(a), top - 0.06 + 0.06 * math.sin(a)) for a in np.linspace(0, math.pi / 2, 6)]
    body.sweep("stem", [(0, 0, 0.035), *((0, y, z) for y, z in bend), (0, -out, top)], circle(0.011, 10), material=p.metal)
    head = made.bodies["head"] = Body("lamp head", p.metal)
    y, half = -out - 0.02, 0.01
    body.box("fork", (-0.016, -out - 0.003, top - 0.008), (0.016, -out, top + 0.008), material=p.metal)
    for side, a in (("left", -0.016), ("right", 0.012)):
        body.box(f"cheek_{side}", (a, y - 0.008, top - 0.008), (a + 0.004, -out - 0.003, top + 0.008), material=p.metal)
    head.box("knuckle", (-half, y - half, top - half), (half, y + half, top + half))
    high = top - half - 0.03
    head.cylinder("neck", (0, y, high), (0, y, top - half), 0.007)
    levels = (high - 1.1 * radius, high - 0.012)
    head.turned("cap", [(0, levels[1]), (0.35 * radius, levels[1]), (0.02, high), (0, high)], (0, y, 0), segments=AROUND)
    _shade(head, "dome", radius, levels, p.metal, (0.0, y))
    holder = Body("bulb", "abs")
    _bulb(holder, levels[1], 0.022, down=True)
    for name, part in holder.parts.items():
        head.add(name, part.shape, (0, y, 0), material=part.material or "abs")
    made.joints["head"] = Joint(
        "head", "hinge", (0, y, top), MAIN, axis=(1, 0, 0), range=(-1.0, 0.0), damping=0.02, friction=0.15
    )


class PendantLampParameters(Parameters):
    """A lamp that hangs on a cord from a rose at the ceiling and may swing."""

    drop: float = Field(default=0.9, ge=0.35, le=2.0, description="from the ceiling to the shade's lower edge [m]")
    shade: float = Field(default=0.36, ge=0.18, le=0.6, description="greatest diameter of the shade [m]")
    shape: Literal["varied", "dome", "cone", "drum", "globe"] = Field(
        default="varied", description="of the shade; globe: of glass"
    )
    cover: str = material("linen", "cotton", "silk", "cardboard", of="a drum")
    material: str = material("mild_steel", "copper", "brass", "aluminium_alloy", "abs")


def _pendant_lamp(p: PendantLampParameters, rng: np.random.Generator) -> Made:
    kind = pick(p.shape, rng, "dome", "cone", "drum", "globe")
    lamp, rose = Body("pendant lamp", p.material), Body("ceiling rose", p.material, motion="static")
    made = Made({MAIN: lamp, "rose": rose})
    rose.turned("rose", [(0, -0.03), (0.02, -0.03), (0.045, -0.016), (0.05, 0), (0, 0)], segments=24)
    radius = p.shade / 2
    tall = {"dome": 0.75, "cone": 0.7, "drum": 0.8, "globe": 1.9}[kind] * radius
    low, high = -p.drop, min(-p.drop + tall, -0.15)
    levels, lid = (low, high), high + 0.5 * radius * 0.35
    if kind == "drum":
        hang = high - 0.03
        lamp.turned(
            "socket", [(0, hang), (0.012, hang), (0.012, hang + 0.03), (0.004, hang + 0.045), (0, hang + 0.045)], segments=AROUND
        )
        _shade(lamp, kind, radius, levels, p.cover)
        _bulb(lamp, hang, 0.03, down=True)
        _spider(lamp, kind, radius, levels, hang - 0.02, p.material)
        top = hang + 0.045
    else:
        stuff = "soda_lime_glass" if kind == "globe" else p.material
        edge = SHAPES[kind][-1][0] * radius
        _shade(lamp, kind, radius, levels, stuff)
        top = min(lid, high + 0.04)
        lamp.turned(
            "cap", [(0, high), (edge, high), (0.6 * edge, high + 0.6 * (top - high)), (0.008, top), (0, top)], segments=AROUND
        )
        _bulb(lamp, high, min(0.03, 0.2 * radius), down=True)
    lamp.cylinder("cord", (0, 0, top), (0, 0, -0.031), 0.003, material="neoprene")
    made.joints["hanging"] = Joint(MAIN, "ball", (0, 0, -0.0305), "rose", damping=0.004)
    return made


GENERATORS = (
    Generator(
        "table_lamp", "table lamp with a shade", TableLampParameters, _table_lamp, ("light", "bedside", "desk", "living"),
    ),
    Generator(
        "floor_lamp", "floor lamp with a shade, or with a reflector that tilts", FloorLampParameters, _floor_lamp,
        ("light", "standard", "reading", "living", "furniture"),
    ),
    Generator(
        "pendant_lamp", "lamp that hangs on a cord and swings; the ceiling is at z = 0", PendantLampParameters, _pendant_lamp,
        ("light", "ceiling", "hanging", "chandelier", "kitchen", "dining"), stands=False,
    ),
)  # fmt: skip
