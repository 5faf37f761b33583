"""Furniture to work or stand at: desks, workbenches, bar counters."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import GAP, Style, carcass, drawer, pick
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Joint, Made, Place
from .profiles import circle

__all__ = ["GENERATORS"]

CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))


class DeskParameters(Parameters):
    """A desk: a top on pedestals of drawers, or on a pedestal and legs."""

    width: float = Field(default=1.4, ge=1.05, le=2.0, description="along x [m]")
    depth: float = Field(default=0.7, ge=0.55, le=0.95, description="along y [m]; one sits at -y")
    height: float = Field(default=0.74, ge=0.68, le=0.78, description="to the upper side of the top [m]")
    pedestals: Literal["left", "right", "both"] = Field(default="right", description="sides with drawers")
    drawers: int = Field(default=3, ge=2, le=3, description="drawers of a pedestal")
    handles: Literal["varied", "bar", "bow", "knob"] = Field(default="varied", description="of the drawers")
    fronts: Literal["varied", "flat", "framed"] = Field(default="varied", description="of the drawers")
    metal: str = material("brass", "stainless_steel", "mild_steel", "bronze", of="handles")
    material: str = material("oak", "walnut", "mahogany", "birch", "pine", "cherry_wood")


def _desk(p: DeskParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("desk", p.material)), Made.of(own)
    style = Style(p.material, "birch", p.metal, pick(p.handles, rng, "bar", "bow", "knob"), pick(p.fronts, rng, "flat", "framed"))
    x, y, under = p.width / 2, p.depth / 2, p.height - 0.028
    body.box("top", (-x, -y, under), (x, y, p.height))
    wide = min(0.42, 0.3 * p.width)
    left, right = -x + 0.03, x - 0.03
    if p.pedestals in ("left", "both"):
        _pedestal(made, p, "left", (left, left + wide), style)
    if p.pedestals in ("right", "both"):
        _pedestal(made, p, "right", (right - wide, right), style)
    for side, sign in (("left", -1), ("right", 1)):
        if p.pedestals in (side, "both"):
            continue
        for end, b in (("front", -y + 0.055), ("back", y - 0.055)):
            at = (sign * (x - 0.06), b)
            body.box(f"leg_head_{side}_{end}", (at[0] - 0.03, b - 0.03, under - 0.09), (at[0] + 0.03, b + 0.03, under))
            body.taper(f"leg_{side}_{end}", (*at, 0), (*at, under - 0.09), (0.036, 0.036), (0.06, 0.06))
        a = sign * (x - 0.06)
        body.box(f"rail_{side}", (a - 0.011, -y + 0.085, under - 0.09), (a + 0.011, y - 0.085, under))
    a = left + wide if p.pedestals in ("left", "both") else -x + 0.09
    b = right - wide if p.pedestals in ("right", "both") else x - 0.09
    body.box("modesty_panel", (a, y - 0.065, 0.32), (b, y - 0.045, under))
    opening = (a + 0.012, b - 0.012, under - 0.085, under)
    for side, c in (("left", a), ("right", b - 0.012)):
        body.box(f"cheek_{side}", (c, -y + 0.035, under - 0.085), (c + 0.012, y - 0.065, under))
    front = -y + 0.035
    drawer(made, "pencil_drawer", (a + GAP, b - GAP, under - 0.08, under - GAP), opening, (front, y - 0.1), style)
    made.places["top"] = Place((0, 0, p.height), (p.width, p.depth))
    return made


def _pedestal(made: Made, p: DeskParameters, name: str, sides: tuple[float, float], style: Style) -> None:
    """A cabinet of drawers under a desk between two x [m]."""
    x0, x1, y, under, thick, rise = *sides, p.depth / 2, p.height - 0.028, 0.018, 0.05
    front, back = -y + 0.035, y - 0.045
    shell = Body("shell", p.material)
    carcass(shell, (x0, front, rise), (x1, back, under), thick)
    shell.box("plinth", (x0 + 0.02, front + 0.03, 0), (x1 - 0.02, back - 0.02, rise))
    for part, own in shell.parts.items():
        made.main.add(f"{part}_{name}", own.shape, own.pose.position)
    pitch = (under - rise - 2 * thick) / (p.drawers + 0.6)
    top = under - thick
    for number in range(p.drawers):
        low = top - pitch * (1.6 if number == p.drawers - 1 else 1.0)
        last, first = number == p.drawers - 1, number == 0
        cover = (x0, x1, low + GAP / 2 - (thick if last else 0), top - GAP / 2 + (thick - GAP if first else 0))
        opening = (x0 + thick, x1 - thick, low + (0 if last else 0.002), top - (0 if first else 0.002))
        drawer(made, f"drawer_{name}_{number + 1}", cover, opening, (front, back - 0.006), style)
        top = low


class WorkbenchParameters(Parameters):
    """A workbench with a thick top, a shelf between its legs, and a vice whose jaw slides."""

    width: float = Field(default=1.6, ge=1.2, le=2.4, description="along x [m]")
    depth: float = Field(default=0.65, ge=0.55, le=0.9, description="along y [m]; one stands at -y")
    height: float = Field(default=0.88, ge=0.75, le=1.0, description="to the upper side of the top [m]")
    top: float = Field(default=0.07, ge=0.045, le=0.1, description="thickness of the top [m]")
    leg: float = Field(default=0.09, ge=0.07, le=0.12, description="side of a leg [m]")
    jaw: float = Field(default=0.26, ge=0.18, le=0.32, description="width of the vice's jaw [m]")
    back: bool = Field(default=True, description="a board along the back that keeps things from falling")
    material: str = material("beech", "maple", "oak", "pine", "birch")


def _workbench(p: WorkbenchParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("workbench", p.material)), Made.of(own)
    x, y, under, leg = p.width / 2, p.depth / 2, p.height - p.top, p.leg
    planks = int(rng.integers(3, 6))
    for number in range(planks):
        b = -y + p.depth * number / planks
        body.box(f"plank_{number + 1}", (-x, b, under), (x, b + p.depth / planks, p.height))
    if p.back:
        body.box("back_board", (-x, y, under), (x, y + 0.02, p.height + 0.12))
    fx, fy = x - 0.12 - leg / 2, y - 0.05 - leg / 2
    for number, (sx, sy) in enumerate(CORNERS, start=1):
        body.box(f"leg_{number}", (sx * fx - leg / 2, sy * fy - leg / 2, 0), (sx * fx + leg / 2, sy * fy + leg / 2, under))
    low, inner = 0.14, fx - leg / 2
    for side, sign in (("left", -1), ("right", 1)):
        for level, z in (("low", low), ("high", under - 0.1)):
            body.box(
                f"side_rail_{side}_{level}", (sign * fx - 0.022, -fy + leg / 2, z), (sign * fx + 0.022, fy - leg / 2, z + 0.09)
            )
    for side, sign in (("front", -1), ("back", 1)):
        body.box(f"long_rail_{side}", (-inner, sign * fy - 0.022, low), (inner, sign * fy + 0.022, low + 0.09))
    body.box("apron_back", (-inner, fy - 0.022, under - 0.09), (inner, fy + 0.022, under))
    shelf = low + 0.09
    for side, sign in (("left", -1), ("right", 1)):
        a = sign * 0.5 * inner
        body.box(f"bearer_{side}", (a - 0.02, -fy + 0.022, low + 0.03), (a + 0.02, fy - 0.022, shelf))
    boards = 5
    for number in range(boards):
        b = -fy - 0.022 + (2 * fy + 0.044) * number / boards
        body.box(f"shelf_{number + 1}", (-inner, b + 0.002, shelf), (inner, b + (2 * fy + 0.044) / boards - 0.002, shelf + 0.018))
    for number in range(int(rng.integers(2, 5))):
        at = x - 0.2 - 0.14 * number
        body.box(f"dog_{number + 1}", (at - 0.01, -y + 0.09, p.height), (at + 0.01, -y + 0.11, p.height + 0.03))
    _vice(made, p, -inner + p.jaw / 2 + 0.03)
    made.places["top"] = Place((0.15 * p.width, 0.1 * p.depth, p.height), (0.6 * p.width, 0.7 * p.depth))
    made.places["shelf"] = Place((0, 0, shelf + 0.018), (2 * inner, 2 * fy - 0.04), under - shelf - 0.118)
    return made


def _vice(made: Made, p: WorkbenchParameters, x: float) -> None:
    """The jaw of a front vice at an x [m], with its screw, its guides and its bar, and the block under the top that bears them."""
    body, y, under, half = made.main, -p.depth / 2, p.height - p.top, p.jaw / 2
    level, reach = under - 0.065, min(0.4, p.depth - 0.2)
    for name, a, b in (("left", x - half, x - half + 0.03), ("right", x + half - 0.03, x + half)):
        body.box(f"guide_{name}", (a, y + 0.06, under - 0.1), (b, y + 0.14, under), material="cast_iron")
    jaw = made.bodies["jaw"] = Body("jaw", p.material)
    front = y - 0.004
    rim = [(x - half, under - 0.11), (x + half, under - 0.11), (x + half, p.height - 0.02), (x + half - 0.02, p.height - 0.002)]
    jaw.prism("cheek", [*rim, (x - half + 0.02, p.height - 0.002), (x - half, p.height - 0.02)], front - 0.055, front, axis="y")
    jaw.cylinder("screw", (x, front, level), (x, front + reach, level), 0.014, material="mild_steel")
    for name, sign in (("left", -1), ("right", 1)):
        a = x + sign * (half - 0.042)
        jaw.cylinder(f"rod_{name}", (a, front, level), (a, front + reach, level), 0.011, material="mild_steel")
    hub = front - 0.055
    jaw.cylinder("hub", (x, hub, level), (x, hub - 0.06, level), 0.024, material="cast_iron")
    hub -= 0.06
    jaw.cylinder("bar", (x - 0.13, hub - 0.009, level), (x + 0.13, hub - 0.009, level), 0.009)
    for name, sign in (("left", -1), ("right", 1)):
        a = x + sign * 0.13
        jaw.cylinder(f"bar_end_{name}", (a, hub - 0.009, level), (a + sign * 0.018, hub - 0.009, level), 0.015)
    made.joints["jaw"] = Joint(
        "jaw",
        "slide",
        (x - half + 0.0305, y + 0.1, level),
        MAIN,
        axis=(0, -1, 0),
        range=(0.0, 0.18),
        damping=200.0,
        friction=60.0,
    )


class BarCounterParameters(Parameters):
    """A bar counter with a panelled front, a projecting top, a foot rail, and shelves behind."""

    width: float = Field(default=2.2, ge=1.0, le=4.0, description="along x [m]; guests stand at -y")
    depth: float = Field(default=0.6, ge=0.5, le=0.8, description="of the top along y [m]")
    height: float = Field(default=1.1, ge=0.95, le=1.2, description="to the upper side of the top [m]")
    panel: float = Field(default=0.55, ge=0.35, le=0.9, description="width of the panels of the front [m], about")
    rail: bool = Field(default=True, description="a foot rail on brackets")
    top: str = material("walnut", "marble", "oak", "granite", "zinc", "copper", of="the top")
    metal: str = material("brass", "copper", "stainless_steel", of="foot rail")
    material: str = material("mahogany", "oak", "walnut", "pine")


def _bar_counter(p: BarCounterParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("bar counter", p.material)), Made.of(own)
    x, y, under, thick = p.width / 2, p.depth / 2, p.height - 0.04, 0.025
    edge = [(-y, under + 0.012), (-y + 0.012, under), (y, under), (y, p.height), (-y + 0.012, p.height), (-y, p.height - 0.012)]
    body.prism("top", edge, -x, x, axis="x", material=p.top)
    front, back, end = -y + 0.14, y - 0.02, x - 0.03
    body.box("wall", (-end, front, 0.1), (end, front + thick, under))
    body.box("kick", (-end, front - 0.012, 0), (end, front + thick, 0.1))
    for side, a in (("left", -end), ("right", end - thick)):
        body.box(f"end_{side}", (a, front + thick, 0), (a + thick, back, under))
    bays = max(1, round(2 * end / 0.9))
    for number in range(1, bays):
        a = -end + 2 * end * number / bays
        body.box(f"divider_{number}", (a - thick / 2, front + thick, 0), (a + thick / 2, back - 0.02, under))
    for number in range(bays):
        a, b = (-end + 2 * end * (number + k) / bays for k in (0, 1))
        a, b = a + (thick if number == 0 else thick / 2), b - (thick if number == bays - 1 else thick / 2)
        for level, z in ((1, 0.12), (2, 0.12 + 0.5 * (under - 0.12))):
            body.box(f"shelf_{number + 1}_{level}", (a, front + thick, z), (b, back - 0.03, z + 0.02))
            free = 0.5 * (under - 0.12) - 0.02
            made.places[f"shelf_{number + 1}_{level}"] = Place(
                ((a + b) / 2, (front + back) / 2, z + 0.02), (b - a - 0.02, back - front - thick - 0.05), free
            )
    _panelling(body, p, (-end, end, 0.1, under), front)
    if p.rail:
        _foot_rail(body, p, end - 0.08, front - 0.012)
    made.places["top"] = Place((0, 0, p.height), (p.width, p.depth - 0.03))
    return made


def _panelling(body: Body, p: BarCounterParameters, rect: tuple[float, float, float, float], front: float) -> None:
    """Stiles, rails and raised fields on the front of a counter whose face is at y = `front` [m]."""
    x0, x1, z0, z1 = rect
    count, stile = max(1, round((x1 - x0) / p.panel)), 0.07
    face = front - 0.012
    body.box("rail_high", (x0, face, z1 - 0.1), (x1, front, z1))
    body.box("rail_low", (x0, face, z0), (x1, front, z0 + 0.08))
    pitch = (x1 - x0 - stile) / count
    for number in range(count + 1):
        a = x0 + number * pitch
        body.box(f"stile_{number + 1}", (a, face, z0 + 0.08), (a + stile, front, z1 - 0.1))
        if number < count:
            a, b, low, high = a + stile + 0.015, a + pitch - 0.015, z0 + 0.095, z1 - 0.115
            foot = [(c, front, z) for c in (a, b) for z in (low, high)]
            crown = [(c, front - 0.01, z) for c in (a + 0.03, b - 0.03) for z in (low + 0.03, high - 0.03)]
            body.hull(f"field_{number + 1}", [*foot, *crown])


def _foot_rail(body: Body, p: BarCounterParameters, half: float, face: float) -> None:
    """A tube before the kick board on bent brackets."""
    level, out, radius = 0.2, 0.13, 0.019
    body.cylinder("foot_rail", (-half, face - out, level), (half, face - out, level), radius, material=p.metal)
    for side, sign in (("left", -1), ("right", 1)):
        body.sphere(f"foot_rail_end_{side}", (sign * (half + 0.024), face - out, level), 0.024, material=p.metal)
    count = max(2, round(2 * half / 0.9) + 1)
    z0 = 0.05
    for number in range(count):
        a = -half + 0.06 + (2 * half - 0.12) * number / (count - 1)
        path = [(a, face, z0), (a, face - out + 0.03, z0), (a, face - out, z0 + 0.03), (a, face - out, level - radius)]
        body.sweep(f"bracket_{number + 1}", path, circle(0.01, 8), material=p.metal)


GENERATORS = (
    Generator(
        "desk", "desk with pedestals of drawers that slide out", DeskParameters, _desk,
        ("writing", "office", "table", "study", "furniture", "bureau"),
    ),
    Generator(
        "workbench", "workbench with a shelf and a vice whose jaw slides", WorkbenchParameters, _workbench,
        ("workshop", "bench", "vise", "vice", "joiner", "carpenter", "table", "garage"),
    ),
    Generator(
        "bar_counter", "panelled bar counter with a foot rail, and shelves behind", BarCounterParameters, _bar_counter,
        ("bar", "pub", "counter", "cafe", "shop", "reception", "furniture", "restaurant"),
    ),
)  # fmt: skip
