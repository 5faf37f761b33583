"""Furniture of bedrooms: beds, bedside tables, chests of drawers, wardrobes."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import GAP, Style, carcass, drawer, feet, pick
from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .upholstery import padded

__all__ = ["GENERATORS"]

Handles = Literal["varied", "bar", "bow", "knob"]
WOODS = ("oak", "walnut", "pine", "birch", "cherry_wood", "mahogany", "beech")
METALS = ("brass", "stainless_steel", "mild_steel", "bronze")


class BedParameters(Parameters):
    """A bed: frame with legs and rails, mattress, headboard, pillows and a quilt."""

    width: float = Field(default=1.4, ge=0.8, le=2.0, description="of the mattress along x [m]")
    length: float = Field(default=2.0, ge=1.8, le=2.2, description="of the mattress along y [m]; the head is at +y")
    height: float = Field(default=0.5, ge=0.4, le=0.65, description="to the upper side of the mattress [m]")
    headboard: float = Field(default=1.0, ge=0.75, le=1.4, description="height of the headboard [m]")
    mattress: float = Field(default=0.2, ge=0.14, le=0.26, description="thickness of the mattress [m]")
    head: Literal["varied", "slats", "panel", "arched", "padded"] = Field(default="varied", description="kind of headboard")
    quilt: bool = Field(default=True, description="a quilt over the lower part")
    linen: str = material("cotton", "linen", "silk", of="mattress and pillows")
    cover: str = material("wool", "felt", "carpet", "linen", of="quilt and padding")
    material: str = material("oak", "pine", "walnut", "beech", "birch")


def _bed(p: BedParameters, rng: np.random.Generator) -> Made:
    body = Body("bed", p.material)
    x, y, leg, rail = p.width / 2 + 0.01, p.length / 2 + 0.01, 0.07, 0.028
    base = p.height - p.mattress
    top = base + 0.06
    for number, (sx, sy) in enumerate(((-1, -1), (1, -1)), start=1):
        at = (sx * (x - 0.02), sy * (y - 0.02))
        body.taper(f"leg_{number}", (*at, 0), (*at, base - 0.1), (0.04, 0.04), (leg, leg))
    low = base - 0.1
    foot = top + float(rng.choice((0.0, 0.06, 0.2)))
    body.box("rail_left", (-x - rail, -y, low), (-x, y, top))
    body.box("rail_right", (x, -y, low), (x + rail, y, top))
    body.box("foot_board", (-x - rail, -y - rail, low), (x + rail, -y, foot))
    for number, (a, b) in enumerate(((-x, -x + 0.03), (x - 0.03, x), (-0.04, 0.04)), start=1):
        body.box(f"bearer_{number}", (a, -y, low), (b, y, base - 0.02))
    slats = 11
    for number in range(slats):
        middle = -y + 2 * y * (number + 0.5) / slats
        body.box(f"slat_{number + 1}", (-x, middle - 0.04, base - 0.02), (x, middle + 0.04, base))
    _headboard(body, p, pick(p.head, rng, "slats", "panel", "arched", "padded"), (x + rail, y))
    half = p.mattress / 2
    padded(body, "mattress", (0, 0, base + half), (p.width, p.length, p.mattress), p.linen, bevel=(0.03, 0.02))
    count = 1 if p.width < 1.2 else 2
    wide = min(0.75, (p.width - 0.1) / count - 0.06)
    thick = float(rng.uniform(0.09, 0.12))
    made = Made.of(body)
    for number in range(count):
        pillow = made.bodies[f"pillow_{number + 1}"] = Body("pillow", "cotton")
        middle = (number - (count - 1) / 2) * (p.width - 0.06) / count
        spot = (middle, p.length / 2 - 0.3, p.height + 0.001 + thick / 2)
        padded(pillow, "pillow", spot, (wide, 0.4, thick), p.linen, form="lens")
        made.carries.append(("", f"pillow_{number + 1}"))
    if p.quilt:
        _quilt(made, p, float(rng.uniform(0.55, 1.0)))
    else:
        made.places["top"] = Place((0, -0.1 * p.length, p.height), (0.8 * p.width, 0.5 * p.length))
    return made


def _quilt(made: Made, p: BedParameters, share: float) -> None:
    """A quilt over the lower part of the mattress that hangs down at both sides, with its edge turned back."""
    quilt = made.bodies["quilt"] = Body("quilt", p.cover)
    x, z, thick = p.width / 2 + 0.001, p.height + 0.001, 0.009
    low = p.height - 0.5 * (p.mattress - 0.06)
    y0 = -p.length / 2
    y1 = y0 + share * (p.length - 0.62)
    rim = [(x, low), (x + thick, low), (x + thick, z + 0.002), (x + 0.002, z + thick), (-x - 0.002, z + thick)]
    quilt.prism("sheet", [*rim, (-x - thick, z + 0.002), (-x - thick, low), (-x, low), (-x, z), (x, z)], y0, y1, axis="y")
    turned = [(y1 - 0.24, z + thick), (y1, z + thick), (y1 - 0.004, z + thick + 0.008), (y1 - 0.236, z + thick + 0.008)]
    quilt.prism("turned_back", turned, -x + 0.01, x - 0.01, axis="x", material=p.linen)
    made.carries.append(("", "quilt"))
    end = y1 - 0.26
    made.places["top"] = Place((0, (y0 + end) / 2, z + thick), (0.8 * p.width, 0.8 * (end - y0)), body="quilt")


def _headboard(body: Body, p: BedParameters, kind: str, corner: tuple[float, float]) -> None:
    """Posts and what is between them at the head of a bed, in front of y = `corner[1]` + 6 cm."""
    x, y = corner
    y1, post, low = y + 0.06, 0.06, p.height - p.mattress - 0.1
    high = max(p.headboard, p.height + 0.15)
    for name, sign in (("left", -1), ("right", 1)):
        at = (sign * (x - post / 2), y + 0.03)
        body.box(f"post_{name}", (at[0] - post / 2, y, 0), (at[0] + post / 2, y1, high))
        body.hull(
            f"finial_{name}",
            [(at[0] + a * post / 2, at[1] + b * post / 2, high) for a in (-1, 1) for b in (-1, 1)] + [(*at, high + 0.03)],
        )
    inner, front = x - post, y + 0.015
    body.box("head_rail_low", (-inner, front, low), (inner, front + 0.03, low + 0.14))
    floor = low + 0.14
    if kind == "padded":
        body.box("head_panel", (-inner, front, floor), (inner, front + 0.03, high))
        count = max(2, round(2 * inner / 0.5))
        wide = 2 * inner / count
        for number in range(count):
            spot = (-inner + wide * (number + 0.5), front - 0.028, (p.height + 0.04 + high) / 2)
            size = (wide - 0.004, high - p.height - 0.06, 0.056)
            padded(body, f"pad_{number + 1}", spot, size, p.cover, form="sharp" if count > 2 else "box", lean=math.pi / 2)
        return
    if kind == "arched":
        bow = [
            (inner, high - 0.14),
            *((inner * math.cos(a), high - 0.14 + 0.16 * math.sin(a)) for a in np.linspace(0, math.pi, 13)[1:-1]),
        ]
        body.prism(
            "head_panel", [(-inner, floor), (inner, floor), *bow, (-inner, high - 0.14)], front + 0.004, front + 0.022, axis="y"
        )
        return
    body.box("head_rail_high", (-inner, front, high - 0.1), (inner, front + 0.03, high - 0.02))
    if kind == "panel":
        body.box("head_panel", (-inner, front + 0.008, floor), (inner, front + 0.022, high - 0.1))
        return
    count = max(4, round(2 * inner / 0.14))
    for number in range(count):
        middle = -inner + 2 * inner * (number + 0.5) / count
        body.box(f"spindle_{number + 1}", (middle - 0.022, front + 0.006, floor), (middle + 0.022, front + 0.024, high - 0.1))


class ChestOfDrawersParameters(Parameters):
    """A chest of drawers on feet or a plinth, with a top that projects."""

    width: float = Field(default=0.9, ge=0.5, le=1.6, description="along x [m]")
    depth: float = Field(default=0.48, ge=0.36, le=0.6, description="along y [m]")
    height: float = Field(default=0.95, ge=0.6, le=1.35, description="along z [m]")
    drawers: int = Field(default=4, ge=2, le=6, description="rows of drawers")
    split: bool = Field(default=True, description="two small drawers in the upper row")
    feet: Literal["varied", "legs", "plinth"] = Field(default="varied", description="on which it stands")
    handles: Handles = Field(default="varied", description="of the drawers")
    fronts: Literal["varied", "flat", "framed"] = Field(default="varied", description="of the drawers")
    metal: str = material(*METALS, of="handles")
    material: str = material(*WOODS)


def _style(p: ChestOfDrawersParameters | BedsideTableParameters, rng: np.random.Generator) -> Style:
    handle = pick(p.handles, rng, "bar", "bow", "knob")
    return Style(
        p.material, "birch" if p.material != "birch" else "plywood", p.metal, handle, pick(p.fronts, rng, "flat", "framed")
    )


def _chest_of_drawers(p: ChestOfDrawersParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("chest of drawers", p.material)), Made.of(own)
    style, stand, thick = _style(p, rng), pick(p.feet, rng, "legs", "plinth"), 0.02
    rise = 0.12 if stand == "legs" else 0.07
    x, y, high = p.width / 2 - 0.015, p.depth / 2, p.height - 0.024
    front = -y + 0.022 + 0.012
    feet(body, stand, (2 * x, 2 * y), rise)
    carcass(body, (-x, front, rise), (x, y, high), thick)
    body.box("slab", (-x - 0.015, -y, high), (x + 0.015, y, p.height))
    rows = min(p.drawers, int((high - rise - 2 * thick) / 0.13))
    shares = 1.0 + 0.12 * np.arange(rows) if rng.random() < 0.5 else np.ones(rows)
    levels = high - thick - (high - rise - 2 * thick) * np.concatenate([[0.0], np.cumsum(shares) / shares.sum()])
    for row in range(rows):
        z0, z1 = float(levels[row + 1]), float(levels[row])
        rail = 0.0 if row == 0 else 0.009
        if row:
            body.box(f"rail_{row}", (-x + thick, front, z1 - 0.009), (x - thick, front + 0.05, z1 + 0.009))
        own_z = (z0 + (0.009 if row < rows - 1 else 0.0), z1 - rail)
        cover_z = (z0 + GAP / 2 - (thick if row == rows - 1 else 0), z1 - GAP / 2 + (thick - GAP if row == 0 else 0))
        _row(made, f"drawer_{row + 1}", (x, thick), (own_z, cover_z), (front, y - 0.006), style, halves=p.split and row == 0)
    made.places["top"] = Place((0, 0, p.height), (p.width, p.depth))
    return made


def _row(
    made: Made,
    name: str,
    half: tuple[float, float],
    levels: tuple[tuple[float, float], tuple[float, float]],
    depths: tuple[float, float],
    style: Style,
    *,
    halves: bool,
) -> None:
    """One drawer over a whole row, or two with a board between them.

    Args:
        made: gets them.
        name: of the drawer; two have "_left" and "_right" after it.
        half: half of the width outside, and thickness of the sides [m].
        levels: of the opening and of the front [m].
        depths: front of the cabinet and inside of its back [m].
        style: of the fronts.
        halves: two drawers.
    """
    (x, thick), (own, cover) = half, levels
    if not halves:
        drawer(made, name, (-x, x, *cover), (-x + thick, x - thick, *own), depths, style)
        return
    made.main.box(f"{name}_between", (-0.01, depths[0], own[0]), (0.01, depths[1], own[1]))
    drawer(made, f"{name}_left", (-x, -GAP / 2, *cover), (-x + thick, -0.01, *own), depths, style)
    drawer(made, f"{name}_right", (GAP / 2, x, *cover), (0.01, x - thick, *own), depths, style)


class BedsideTableParameters(Parameters):
    """A bedside table with a drawer over an open shelf."""

    width: float = Field(default=0.45, ge=0.34, le=0.65, description="along x [m]")
    depth: float = Field(default=0.38, ge=0.3, le=0.5, description="along y [m]")
    height: float = Field(default=0.55, ge=0.42, le=0.75, description="along z [m]")
    drawer: float = Field(default=0.14, ge=0.1, le=0.18, description="height of the drawer [m]")
    handles: Handles = Field(default="varied", description="of the drawer")
    fronts: Literal["varied", "flat", "framed"] = Field(default="varied", description="of the drawer")
    metal: str = material(*METALS, of="handle")
    material: str = material(*WOODS)


def _bedside_table(p: BedsideTableParameters, rng: np.random.Generator) -> Made:
    body = Body("bedside table", p.material)
    made, style, thick = Made.of(body), _style(p, rng), 0.018
    x, y, leg = p.width / 2 - 0.012, p.depth / 2 - 0.012, 0.036
    under = p.height - 0.02
    floor = under - p.drawer - thick
    shelf = max(0.08, 0.35 * floor)
    front = -y + 0.0225
    body.box("top", (-p.width / 2, -p.depth / 2, under), (p.width / 2, p.depth / 2, p.height))
    for number, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        at = (sx * (x - leg / 2), sy * (y - leg / 2))
        body.box(f"post_{number}", (at[0] - leg / 2, at[1] - leg / 2, shelf), (at[0] + leg / 2, at[1] + leg / 2, under))
        body.taper(f"leg_{number}", (*at, 0), (*at, shelf), (0.6 * leg, 0.6 * leg), (leg, leg))
    for side, a in (("left", -x + 0.006), ("right", x - 0.006 - thick)):
        body.box(f"side_{side}", (a, -y + leg, floor), (a + thick, y - leg, under))
    body.box("back", (-x + leg, y - 0.03, floor + thick), (x - leg, y - 0.012, under))
    body.box("floor", (-x + leg, front, floor), (x - leg, y - 0.012, floor + thick))
    body.box("shelf", (-x + leg, -y + 0.008, shelf), (x - leg, y - 0.008, shelf + 0.016))
    cover = (-x + leg + GAP, x - leg - GAP, floor + 0.001, under - GAP)
    drawer(made, "drawer", cover, (-x + leg, x - leg, floor + thick, under), (front, y - 0.03), style)
    made.places["top"] = Place((0, 0, p.height), (p.width, p.depth))
    made.places["shelf"] = Place((0, 0, shelf + 0.016), (2 * (x - leg), 2 * (y - leg)), floor - shelf - 0.016)
    return made


GENERATORS = (
    Generator(
        "bed", "bed with mattress, headboard, loose pillows and a quilt", BedParameters, _bed,
        ("bedroom", "sleep", "double", "single", "furniture", "hotel"),
    ),
    Generator(
        "chest_of_drawers", "chest of hollow drawers that slide out", ChestOfDrawersParameters, _chest_of_drawers,
        ("dresser", "commode", "bureau", "storage", "bedroom", "furniture", "sideboard"),
    ),
    Generator(
        "bedside_table", "bedside table with a drawer that slides out, over a shelf", BedsideTableParameters, _bedside_table,
        ("nightstand", "night", "bedroom", "furniture"),
    ),
)  # fmt: skip
