"""Furniture and appliances of kitchens."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import BACK, GAP, Style, carcass, door, drawer, pick
from .generator import Generator, Parameters, material
from .made import Body, Made, Place, Point
from .plumbing import tap

__all__ = ["GENERATORS"]

FRONTS = ("polystyrene", "oak", "birch", "walnut", "pine", "mdf")
TOPS = ("granite", "oak", "marble", "beech", "slate", "stainless_steel")
Handles = Literal["varied", "bar", "bow", "knob"]
Panels = Literal["varied", "flat", "framed"]
BOARD = 0.018
PLINTH = 0.1
"""[m] Thickness of carcasses, and height of plinths."""


class KitchenBaseParameters(Parameters):
    """A base cabinet of a kitchen: worktop, a drawer, and one or two doors below."""

    width: float = Field(default=0.6, ge=0.3, le=1.2, description="along x [m]; two doors from 0.65")
    depth: float = Field(default=0.6, ge=0.5, le=0.7, description="of the worktop along y [m]")
    height: float = Field(default=0.9, ge=0.82, le=0.95, description="to the upper side of the worktop [m]")
    worktop: float = Field(default=0.035, ge=0.02, le=0.05, description="thickness of the worktop [m]")
    contents: Literal["door", "drawers", "door and drawer"] = Field(default="door and drawer", description="of the front")
    handles: Handles = Field(default="varied", description="of doors and drawers")
    fronts: Panels = Field(default="varied", description="of doors and drawers")
    top: str = material(*TOPS, of="the worktop")
    metal: str = material("stainless_steel", "brass", "mild_steel", of="handles")
    material: str = material(*FRONTS)


def _base(p: KitchenBaseParameters | SinkUnitParameters, role: str) -> Made:
    """Carcass on a plinth, with its front at 0.04 m behind the edge of the worktop."""
    body = Body(role, "birch")
    x, y, under = p.width / 2, p.depth / 2, p.height - p.worktop
    front = -y + 0.04
    carcass(body, (-x, front, PLINTH), (x, y, under), BOARD)
    for side, a in (("left", -x + 0.02), ("right", x - 0.038)):
        body.box(f"plinth_{side}", (a, front + 0.068, 0), (a + BOARD, y - 0.03, PLINTH), material=p.material)
    body.box("plinth_front", (-x, front + 0.05, 0), (x, front + 0.068, PLINTH), material=p.material)
    return Made.of(body)


def _fronts(made: Made, p: KitchenBaseParameters | SinkUnitParameters, style: Style, top: float) -> None:
    """One or two doors below a height [m]."""
    x, y = p.width / 2, p.depth / 2
    front, low = -y + 0.04, PLINTH + 0.002
    if p.width < 0.65:
        door(made, "door", (-x + GAP / 2, x - GAP / 2, low, top), front - 0.0015, style, grip=0.85)
        return
    door(made, "door_left", (-x + GAP / 2, -GAP / 2, low, top), front - 0.0015, style, grip=0.85)
    door(made, "door_right", (GAP / 2, x - GAP / 2, low, top), front - 0.0015, style, hinge="right", grip=0.85)


def _kitchen_base(p: KitchenBaseParameters, rng: np.random.Generator) -> Made:
    made = _base(p, "base cabinet")
    body, x, y, under = made.main, p.width / 2, p.depth / 2, p.height - p.worktop
    style = Style(p.material, "birch", p.metal, pick(p.handles, rng, "bar", "bow", "knob"), pick(p.fronts, rng, "flat", "framed"))
    rim = [(-y, under), (y, under), (y, p.height), (-y + 0.006, p.height), (-y, p.height - 0.006)]
    body.prism("worktop", rim, -x, x, axis="x", material=p.top)
    front, rear, inner = -y + 0.04, y - 0.006, x - BOARD
    cover_top, floor, ceiling = under - GAP, PLINTH + BOARD, under - BOARD
    count = {"door": 0, "door and drawer": 1, "drawers": 3}[p.contents]
    high = ceiling
    levels = (
        [ceiling - 0.16 * k for k in range(2)] if count == 1 else list(np.linspace(ceiling, floor, count + 1)) if count else []
    )
    for number in range(1, len(levels)):
        a, b = float(levels[number]), float(levels[number - 1])
        last = count == 3 and number == count
        if not last:
            body.box(f"rail_{number}", (-inner, front, a - 0.009), (inner, front + 0.06, a + 0.009))
        cover = (-x + GAP / 2, x - GAP / 2, PLINTH + 0.002 if last else a + GAP / 2, cover_top if number == 1 else b - GAP / 2)
        opening = (-inner, inner, a + (0 if last else 0.009), b - (0 if number == 1 else 0.009))
        drawer(made, f"drawer_{number}", cover, opening, (front, rear), style)
        high = a - 0.009
        cover_top = a - GAP / 2
    if count < 3:
        _fronts(made, p, style, cover_top)
        shelf = (floor + high) / 2
        body.box("shelf", (-inner, front + 0.08, shelf - 0.016), (inner, rear, shelf))
        made.places["shelf"] = Place((0, 0.04, shelf), (2 * inner - 0.02, rear - front - 0.1), high - shelf)
        made.places["bottom"] = Place((0, 0.02, floor), (2 * inner - 0.02, rear - front - 0.04), shelf - 0.016 - floor)
    made.places["top"] = Place((0, 0, p.height), (p.width, p.depth))
    return made


class WallCabinetParameters(Parameters):
    """A cabinet that hangs on a wall, with one or two doors and shelves."""

    width: float = Field(default=0.6, ge=0.3, le=1.2, description="along x [m]; two doors from 0.55")
    depth: float = Field(default=0.34, ge=0.25, le=0.45, description="along y [m]")
    height: float = Field(default=0.7, ge=0.35, le=1.0, description="along z [m]")
    shelves: int = Field(default=1, ge=0, le=3, description="shelves within; fewer where they would be closer than 0.15 m")
    handles: Handles = Field(default="varied", description="of the doors")
    fronts: Literal["varied", "flat", "framed", "glazed"] = Field(default="varied", description="of the doors")
    metal: str = material("stainless_steel", "brass", "mild_steel", of="handles")
    material: str = material(*FRONTS)


def _wall_cabinet(p: WallCabinetParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("wall cabinet", p.material)), Made.of(own)
    panel = pick(p.fronts, rng, "flat", "framed", "glazed")
    style = Style(p.material, "birch", p.metal, pick(p.handles, rng, "bar", "bow", "knob"), panel)
    x, front, inner, rear = p.width / 2, -p.depth + style.thick + 0.002, p.width / 2 - BOARD, -BACK
    carcass(body, (-x, front, 0), (x, 0, p.height), BOARD)
    count = max(0, min(p.shelves, int((p.height - 2 * BOARD) / 0.166) - 1))
    pitch = (p.height - 2 * BOARD) / (count + 1)
    for number in range(count + 1):
        floor = BOARD + number * pitch
        if number:
            body.box(f"shelf_{number}", (-inner, front + 0.03, floor - 0.016), (inner, rear, floor))
        made.places[f"shelf_{number}" if number else "bottom"] = Place(
            (0, (front + rear) / 2, floor), (2 * inner - 0.02, rear - front - 0.06), pitch - (0.016 if number < count else 0)
        )
    rects = [(-x + GAP / 2, x - GAP / 2)] if p.width < 0.55 else [(-x + GAP / 2, -GAP / 2), (GAP / 2, x - GAP / 2)]
    for number, (a, b) in enumerate(rects, start=1):
        hinge: Literal["left", "right"] = "left" if number == 1 else "right"
        door(made, f"door_{number}", (a, b, 0.002, p.height - 0.002), front - 0.0015, style, hinge=hinge, grip=0.2)
    made.places["top"] = Place((0, front / 2, p.height), (p.width, -front))
    return made


class SinkUnitParameters(Parameters):
    """A base cabinet with a sink in its worktop and a tap whose spout turns."""

    width: float = Field(default=0.9, ge=0.6, le=1.4, description="along x [m]; two doors from 0.65")
    depth: float = Field(default=0.6, ge=0.55, le=0.7, description="of the worktop along y [m]")
    height: float = Field(default=0.9, ge=0.82, le=0.95, description="to the upper side of the worktop [m]")
    worktop: float = Field(default=0.035, ge=0.025, le=0.05, description="thickness of the worktop [m]")
    bowl: float = Field(default=0.42, ge=0.3, le=0.5, description="width of the bowl [m]")
    bowl_depth: float = Field(default=0.18, ge=0.12, le=0.24, description="depth of the bowl [m]")
    spout: Literal["varied", "arch", "straight"] = Field(default="varied", description="of the tap")
    handles: Handles = Field(default="varied", description="of the doors")
    fronts: Panels = Field(default="varied", description="of the doors")
    basin: str = material("stainless_steel", "porcelain", "copper", of="the bowl")
    top: str = material(*TOPS, of="the worktop")
    metal: str = material("stainless_steel", "brass", "copper", of="tap and handles")
    material: str = material(*FRONTS)


def _sink_unit(p: SinkUnitParameters, rng: np.random.Generator) -> Made:
    made = _base(p, "sink unit")
    body, x, y, under = made.main, p.width / 2, p.depth / 2, p.height - p.worktop
    del body.parts["top"]
    style = Style(p.material, "birch", p.metal, pick(p.handles, rng, "bar", "bow", "knob"), pick(p.fronts, rng, "flat", "framed"))
    half, deep = min(p.bowl, p.width - 0.12) / 2, 0.19
    middle = 0.0 if p.width < 0.8 else float(rng.choice([-1.0, 1.0])) * (x - half - 0.08)
    near, far, wall = -0.02 - deep, -0.02 + deep, 0.004
    front = -y + 0.04
    for side, sign in (("front", -1), ("back", 1)):
        b = front if sign < 0 else y - 0.08
        body.box(f"rail_{side}", (-x + BOARD, b, under - 0.06), (x - BOARD, b + BOARD, under))
    low, high = (middle - half - wall, near - wall), (middle + half + wall, far + wall)
    body.box("worktop_left", (-x, -y, under), (low[0], y, p.height), material=p.top)
    body.box("worktop_right", (high[0], -y, under), (x, y, p.height), material=p.top)
    body.box("worktop_front", (low[0], -y, under), (high[0], low[1], p.height), material=p.top)
    body.box("worktop_back", (low[0], high[1], under), (high[0], y, p.height), material=p.top)
    floor = p.height - p.bowl_depth
    _bowl(body, (middle - half, near, floor), (middle + half, far, p.height - 0.002), wall, p.basin)
    _fronts(made, p, style, under - GAP)
    kind = pick(p.spout, rng, "arch", "straight")
    tap(made, (middle, y - 0.06, p.height), (0.19, 0.24), kind, p.metal)
    body.cylinder("drain", (middle, far - 0.09, floor), (middle, far - 0.09, floor + 0.002), 0.04, material=p.metal)
    made.places["bowl"] = Place((middle, near + 0.12, floor), (2 * half - 0.08, 0.16), p.bowl_depth)
    made.places["bottom"] = Place((0, 0, PLINTH + BOARD), (2 * x - 0.06, p.depth - 0.16), floor - PLINTH - BOARD - 0.01)
    if middle:
        free = (x + (low[0] if middle > 0 else -high[0])) / 2
        made.places["top"] = Place((math.copysign(x - free, -middle), 0, p.height), (2 * free - 0.04, p.depth - 0.1))
    return made


def _bowl(body: Body, low: Point, high: Point, wall: float, metal: str) -> None:
    """A bowl open to the top: its inside from its least to its greatest corner [m], with walls about it."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    body.box("bowl_floor", (x0 - wall, y0 - wall, z0 - wall), (x1 + wall, y1 + wall, z0), material=metal)
    for side, a, b in (("left", x0 - wall, x0), ("right", x1, x1 + wall)):
        body.box(f"bowl_{side}", (a, y0 - wall, z0), (b, y1 + wall, z1), material=metal)
    for side, a, b in (("front", y0 - wall, y0), ("back", y1, y1 + wall)):
        body.box(f"bowl_{side}", (x0, a, z0), (x1, b, z1), material=metal)


GENERATORS = (
    Generator(
        "kitchen_base", "kitchen base cabinet with a worktop, hinged doors and drawers that slide out", KitchenBaseParameters, _kitchen_base,
        ("kitchen", "cabinet", "counter", "cupboard", "unit", "furniture"),
    ),
    Generator(
        "wall_cabinet", "cabinet with hinged doors that hangs on a wall, its back plane is y = 0", WallCabinetParameters, _wall_cabinet,
        ("kitchen", "cabinet", "cupboard", "unit", "furniture", "bathroom"), "static", stands=False,
    ),
    Generator(
        "sink_unit", "kitchen sink in a cabinet with doors, and a tap whose spout turns", SinkUnitParameters, _sink_unit,
        ("kitchen", "basin", "tap", "faucet", "counter", "furniture"),
    ),
)  # fmt: skip
