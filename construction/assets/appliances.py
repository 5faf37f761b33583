"""Appliances: stoves, fridges, televisions, radiators."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import GAP, Style, drawer, handle, leaf, pick, pivots, stacked
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Joint, Made, Place, Point
from .profiles import rounded

__all__ = ["GENERATORS"]

STEEL = "stainless_steel"


def _shell(body: Body, name: str, low: Point, high: Point, wall: float, metal: str) -> None:
    """Five boards of a box that is open to the front, between its outer corners [m]."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    body.box(f"{name}_left", low, (x0 + wall, y1, z1), material=metal)
    body.box(f"{name}_right", (x1 - wall, y0, z0), high, material=metal)
    body.box(f"{name}_bottom", (x0 + wall, y0, z0), (x1 - wall, y1, z0 + wall), material=metal)
    body.box(f"{name}_top", (x0 + wall, y0, z1 - wall), (x1 - wall, y1, z1), material=metal)
    body.box(f"{name}_back", (x0 + wall, y1 - wall, z0 + wall), (x1 - wall, y1, z1 - wall), material=metal)


class StoveParameters(Parameters):
    """A stove: oven with a glazed door that drops open, knobs, four hobs, and a drawer below."""

    width: float = Field(default=0.6, ge=0.5, le=0.9, description="along x [m]")
    depth: float = Field(default=0.6, ge=0.56, le=0.7, description="along y [m]")
    height: float = Field(default=0.9, ge=0.84, le=0.94, description="to the hob's plate [m]")
    hobs: Literal["varied", "flames", "plates"] = Field(default="varied", description="burners under grates, or plates of iron")
    splash: bool = Field(default=True, description="an upright plate behind the hobs")
    metal: str = material("stainless_steel", "brass", "aluminium_alloy", of="handle and trim")
    material: str = material("porcelain", "stainless_steel", "cast_iron", "abs")


def _stove(p: StoveParameters, rng: np.random.Generator) -> Made:
    body, made, t = (own := Body("stove", p.material)), Made.of(own), 0.003
    x, back, front = p.width / 2, p.depth / 2, -p.depth / 2 + 0.03
    plate = p.height - 0.006
    for number, (a, b) in enumerate(((a, b) for a in (-x + 0.05, x - 0.05) for b in (front + 0.06, back - 0.05)), start=1):
        body.cylinder(f"foot_{number}", (a, b, 0), (a, b, 0.04), 0.018, material="abs")
    _shell(body, "case", (-x, front, 0.04), (x, back, plate - 0.002), t, p.material)
    body.box("plate", (-x - 0.002, front - 0.02, plate - 0.002), (x + 0.002, back, p.height))
    inner, low, high = x - 0.055, 0.24, plate - 0.14
    rear = back - 0.06
    _shell(body, "oven", (-inner, front, low), (inner, rear, high), 0.004, "mild_steel")
    for side, a, b in (("left", -x + t, -inner), ("right", inner, x - t)):
        body.box(f"frame_{side}", (a, front, 0.04 + t), (b, front + 0.012, plate - 0.002 - t))
    for number in (1, 2):
        level = low + 0.004 + (high - low) * 0.3 * number
        for side, a, b in (("left", -inner + 0.004, -inner + 0.014), ("right", inner - 0.014, inner - 0.004)):
            body.box(f"ledge_{side}_{number}", (a, front + 0.01, level - 0.004), (b, rear - 0.02, level), material="mild_steel")
    _rack(made, (inner - 0.004, front + 0.01, rear - 0.02), low + 0.004 + (high - low) * 0.3)
    face = Body("panel", p.material)
    leaf(face, (-x, x, high + 0.002, plate - 0.003), front, Style(p.material, p.material, panel="pressed", thick=0.018))
    for part, own_part in face.parts.items():
        body.add(f"control_{part}", own_part.shape, own_part.pose.position)
    knobs, middle = 5, (high + plate) / 2
    for number in range(knobs):
        a = (number - (knobs - 1) / 2) * (2 * x - 0.12) / (knobs - 1)
        at = (a, front - 0.018, middle)
        body.turned(
            f"knob_{number + 1}",
            [(0, 0), (0.021, 0), (0.019, 0.022), (0, 0.022)],
            at,
            segments=20,
            euler=(math.pi / 2, 0, 0),
            material="abs" if p.material != "abs" else p.metal,
        )
        body.box(
            f"pointer_{number + 1}",
            (a - 0.002, front - 0.044, middle - 0.004),
            (a + 0.002, front - 0.04, middle + 0.017),
            material=p.metal,
        )
    _oven_door(made, p, (-x + GAP / 2, x - GAP / 2, low - 0.01, high - 0.002), front - 0.0015)
    style = Style(p.material, "mild_steel", p.metal, "bar", "pressed", 0.016, 0.003)
    wide = inner
    drawer(
        made, "drawer", (-x + GAP / 2, x - GAP / 2, 0.044, low - 0.014), (-wide, wide, 0.046, low - 0.004), (front, rear), style
    )
    for side, a, b in (("left", -x + t, -wide), ("right", wide, x - t)):
        body.box(f"guide_{side}", (a, front + 0.012, 0.08), (b, rear - 0.01, 0.14), material="mild_steel")
    if p.splash:
        body.box("splash", (-x, back - 0.012, p.height), (x, back, p.height + 0.12))
    _hobs(made, p, pick(p.hobs, rng, "flames", "plates"), (x, front, back))
    made.places["oven"] = Place(
        (0, (front + rear) / 2, low + 0.004), (2 * inner - 0.04, rear - front - 0.04), 0.3 * (high - low) - 0.02
    )
    return made


def _rack(made: Made, extent: tuple[float, float, float], level: float) -> None:
    """A rack of bars on the lower ledges of an oven, of half width x and least and greatest y [m]."""
    x, y0, y1 = extent
    rack = made.bodies["rack"] = Body("oven rack", STEEL)
    z, edge = level + 0.001, x - 0.0015
    for name, a, b in (("left", -edge, -edge + 0.008), ("right", edge - 0.008, edge)):
        rack.box(f"rim_{name}", (a, y0 + 0.01, z), (b, y1 - 0.004, z + 0.006))
    bars = 10
    for number in range(bars):
        c = y0 + 0.013 + (y1 - y0 - 0.02) * number / (bars - 1)
        rack.box(f"bar_{number + 1}", (-edge + 0.008, c - 0.002, z + 0.001), (edge - 0.008, c + 0.002, z + 0.005))
    made.carries.append((MAIN, "rack"))


def _oven_door(made: Made, p: StoveParameters, rect: tuple[float, float, float, float], back: float) -> None:
    """A glazed door on a level hinge along its lower edge, which drops open to the front."""
    x0, x1, z0, z1 = rect
    thick = 0.014
    oven = made.bodies["door"] = Body("oven door", p.material)
    leaf(oven, rect, back, Style(p.material, p.material, panel="glazed", thick=thick))
    handle(oven, "handle", "bar", (0, back - thick, z1 - 0.035), 0.7 * (x1 - x0), material=p.metal)
    anchor = (0, back - thick, z0)
    for side, a in (("left", x0), ("right", x1 - 0.016)):
        low, high = (a, back - thick - 0.001, z0 - 0.0019), (a + 0.016, back + 0.0015, z0 - 0.0007)
        made.main.box(f"pivot_door_{side}", low, high, material=p.metal)
    made.joints["door"] = Joint(
        "door", "hinge", anchor, MAIN, axis=(1, 0, 0), range=(0.0, math.pi / 2), damping=1.0, friction=1.5
    )


def _hobs(made: Made, p: StoveParameters, kind: str, extent: tuple[float, float, float]) -> None:
    """Four hobs on the plate: half width x, front and back y [m]."""
    (x, front, back), body, z = extent, made.main, p.height
    middle, reach = (front + back) / 2 - 0.01, 0.5 * min(2 * x, back - front - 0.03) - 0.012
    spots = [(sx * 0.5 * x, middle + sy * 0.25 * (back - front - 0.02)) for sy in (-1, 1) for sx in (-1, 1)]
    for number, (a, b) in enumerate(spots, start=1):
        half = (0.5 * reach, 0.42 * reach)[number % 2]
        if kind == "plates":
            disc = [(0, 0), (half, 0), (half, 0.01), (half - 0.004, 0.014), (0, 0.014)]
            body.turned(f"hob_{number}", disc, (a, b, z), segments=40, material="cast_iron")
            made.places[f"hob_{number}"] = Place((a, b, z + 0.014), (1.6 * half, 1.6 * half))
            continue
        burner = [(0.045, 0.0), (0.045, 0.006), (0.03, 0.009), (0.03, 0.016)]
        stacked(body, f"burner_{number}", burner, (a, b, z), material="aluminium_alloy")
        top, arm = z + 0.034, 0.5 * reach
        body.box(f"grate_{number}_x", (a - arm, b - 0.004, top - 0.01), (a + arm, b + 0.004, top), material="cast_iron")
        for end, sign in (("front", -1), ("back", 1)):
            c, d = sorted((b + sign * 0.004, b + sign * arm))
            body.box(f"grate_{number}_{end}", (a - 0.004, c, top - 0.01), (a + 0.004, d, top), material="cast_iron")
        for foot, (u, v) in enumerate(((-1, 0), (1, 0), (0, -1), (0, 1)), start=1):
            c, d = a + u * (arm - 0.004), b + v * (arm - 0.004)
            body.box(
                f"grate_{number}_foot_{foot}", (c - 0.004, d - 0.004, z), (c + 0.004, d + 0.004, top - 0.01), material="cast_iron"
            )
        made.places[f"hob_{number}"] = Place((a, b, top), (1.6 * arm, 1.6 * arm))


class FridgeParameters(Parameters):
    """A fridge with insulated walls, glass shelves, racks in its door, and a freezer if wanted."""

    width: float = Field(default=0.6, ge=0.48, le=0.8, description="along x [m]")
    depth: float = Field(default=0.64, ge=0.54, le=0.72, description="along y, with the door [m]")
    height: float = Field(default=1.75, ge=0.85, le=2.0, description="along z [m]")
    shelves: int = Field(default=3, ge=1, le=5, description="glass shelves; fewer where they would be closer than 0.15 m")
    freezer: bool = Field(default=True, description="a freezer below with a door of its own, if it is 1.3 m high or more")
    hinge: Literal["left", "right"] = Field(default="right", description="side of the hinges")
    metal: str = material("stainless_steel", "aluminium_alloy", "abs", of="handles")
    material: str = material("polystyrene", "stainless_steel", "porcelain", "abs")


def _fridge(p: FridgeParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("fridge", p.material)), Made.of(own)
    thick, rise = 0.055, 0.04
    x, back, front = p.width / 2, p.depth / 2, -p.depth / 2 + thick + 0.003
    for number, (a, b) in enumerate(((a, b) for a in (-x + 0.05, x - 0.05) for b in (front + 0.05, back - 0.05)), start=1):
        body.cylinder(f"foot_{number}", (a, b, 0), (a, b, rise), 0.02, material="abs")
    layers = (("skin", 0.002, p.material), ("foam", 0.04, "rigid_foam"), ("liner", 0.003, "polystyrene"))
    gone = 0.0
    for name, wall, stuff in layers:
        _shell(body, name, (-x + gone, front, rise + gone), (x - gone, back - gone, p.height - gone), wall, stuff)
        gone += wall
    inner, floor, ceiling, rear = x - gone, rise + gone, p.height - gone, back - gone
    split = 0.0
    if p.freezer and p.height >= 1.3:
        split = rise + 0.36 * (p.height - rise)
        body.box("divider", (-inner, front, split - 0.02), (inner, rear, split + 0.02), material="rigid_foam")
        body.box("divider_face", (-inner, front, split + 0.02), (inner, rear, split + 0.023), material="polystyrene")
        for number in (1, 2):
            level = floor + (split - floor) * number / 3
            body.box(
                f"freezer_shelf_{number}", (-inner, front + 0.03, level - 0.004), (inner, rear, level), material="polystyrene"
            )
        made.places["freezer"] = Place((0, 0, floor), (2 * inner - 0.04, rear - front - 0.08), (split - floor) / 3 - 0.01)
        floor = split + 0.023
    count = max(1, min(p.shelves, int((ceiling - floor) / 0.16) - 1))
    for number in range(1, count + 1):
        level = floor + (ceiling - floor) * (number + 0.25) / (count + 1.25)
        body.box(f"shelf_{number}", (-inner, front + 0.09, level - 0.005), (inner, rear, level), material="soda_lime_glass")
        body.box(
            f"shelf_rim_{number}",
            (-inner, front + 0.08, level - 0.012),
            (inner, front + 0.09, level + 0.003),
            material="polystyrene",
        )
        free = (ceiling - floor) / (count + 1.25) - 0.015
        made.places[f"shelf_{number}"] = Place(
            (0, (front + rear) / 2 + 0.04, level), (2 * inner - 0.04, rear - front - 0.14), free
        )
    made.places["bottom"] = Place((0, (front + rear) / 2 + 0.04, floor), (2 * inner - 0.04, rear - front - 0.14), 0.14)
    if split:
        _fridge_door(made, p, "freezer_door", (rise + 0.004, split - 0.003), (front, thick), 0.85)
    low = split + 0.003 if split else rise + 0.004
    _fridge_door(made, p, "door", (low, p.height - 0.003), (front, thick), 0.25 if split else 0.6)
    _door_racks(made.bodies["door"], (inner - 0.02, front), (max(floor, low) + 0.06, ceiling - 0.25), 2 if p.height < 1.3 else 3)
    return made


def _fridge_door(
    made: Made, p: FridgeParameters, name: str, levels: tuple[float, float], depths: tuple[float, float], grip: float
) -> None:
    """An insulated door before a front y, of a thickness [m], on an upright hinge at its front edge."""
    (z0, z1), (front, thick), x = levels, depths, p.width / 2
    leaf_body = made.bodies[name] = Body("door", p.material)
    back, face, skin = front - 0.003, front - thick - 0.003, 0.002
    rim = 0.012
    outline = [
        (-x, face + rim),
        (-x + 0.4 * rim, face + 0.3 * rim),
        (-x + rim, face),
        (x - rim, face),
        (x - 0.4 * rim, face + 0.3 * rim),
        (x, face + rim),
    ]
    leaf_body.prism("panel", outline, z0, z1)
    y = face + rim
    for side, a in (("left", -x), ("right", x - skin)):
        leaf_body.box(f"edge_{side}", (a, y, z0), (a + skin, back - 0.003, z1))
    for side, c in (("low", z0), ("high", z1 - skin)):
        leaf_body.box(f"edge_{side}", (-x + skin, y, c), (x - skin, back - 0.003, c + skin))
    leaf_body.box("foam", (-x + skin, y, z0 + skin), (x - skin, back - 0.003, z1 - skin), material="rigid_foam")
    leaf_body.box("liner", (-x, back - 0.003, z0), (x, back, z1), material="polystyrene")
    sign = 1 if p.hinge == "left" else -1
    span = min(0.45, 0.5 * (z1 - z0))
    at = (sign * (x - 0.045), face, z0 + grip * (z1 - z0) + (0.5 - grip) * span * 0.8)
    handle(leaf_body, "handle", "bar", at, span, upright=True, material=p.metal)
    anchor = (-sign * x, face + rim, (z0 + z1) / 2)
    pivots(made.main, name, anchor[:2], (sign, front), levels, p.metal)
    made.joints[name] = Joint(name, "hinge", anchor, MAIN, axis=(0, 0, -sign), range=(0.0, 1.7), damping=0.8, friction=0.8)


def _door_racks(body: Body, extent: tuple[float, float], levels: tuple[float, float], count: int) -> None:
    """Racks on the inside of a door: half width and y of the cabinet's front, least and greatest height [m]."""
    x, back = extent[0], extent[1] - 0.003
    wide = x - 0.02
    for number in range(count):
        z = levels[0] + (levels[1] - levels[0]) * number / max(1, count - 1)
        body.box(f"rack_{number + 1}_floor", (-wide, back, z), (wide, back + 0.075, z + 0.003), material="polystyrene")
        body.box(
            f"rack_{number + 1}_rim", (-wide, back + 0.072, z + 0.003), (wide, back + 0.075, z + 0.06), material="polystyrene"
        )
        for side, a in (("left", -wide), ("right", wide - 0.003)):
            body.box(
                f"rack_{number + 1}_{side}", (a, back, z + 0.003), (a + 0.003, back + 0.072, z + 0.06), material="polystyrene"
            )


class TelevisionParameters(Parameters):
    """A flat television on its stand."""

    diagonal: float = Field(default=1.1, ge=0.5, le=2.0, description="of the picture [m]")
    thick: float = Field(default=0.03, ge=0.02, le=0.06, description="of the screen [m]")
    stand: Literal["varied", "column", "feet"] = Field(default="varied", description="on which it stands")
    metal: str = material("aluminium_alloy", "mild_steel", "stainless_steel", of="the stand")
    material: str = material("abs", "polystyrene", "pvc", "aluminium_alloy")


def _television(p: TelevisionParameters, rng: np.random.Generator) -> Made:
    body, rim = Body("television", p.material), 0.012
    width, tall = p.diagonal * 16 / math.hypot(16, 9), p.diagonal * 9 / math.hypot(16, 9)
    low = 0.06 + 0.02 * p.diagonal
    x, z0, z1, front = width / 2 + rim, low, low + tall + 2 * rim, -p.thick / 2
    glass = front + 0.006
    for side, a in (("left", -x), ("right", x - rim)):
        body.box(f"bezel_{side}", (a, front, z0), (a + rim, glass, z1))
    for side, c in (("low", z0), ("high", z1 - rim)):
        body.box(f"bezel_{side}", (-x + rim, front, c), (x - rim, glass, c + rim))
    body.box("screen", (-x + rim, front + 0.002, z0 + rim), (x - rim, glass, z1 - rim), material="abs")
    shrink = [(-x, z0), (x, z0), (x, z1), (-x, z1)]
    body.hull(
        "rear", [(a, glass, c) for a, c in shrink] + [(0.96 * a, p.thick / 2, z0 + 0.02 + 0.93 * (c - z0)) for a, c in shrink]
    )
    body.box("housing", (-0.5 * x, p.thick / 2, z0 + 0.06), (0.5 * x, p.thick / 2 + 0.03, z0 + 0.5 * tall))
    deep = max(0.2, 0.24 * width)
    if pick(p.stand, rng, "column", "feet") == "feet":
        for side, sign in (("left", -1), ("right", 1)):
            a = sign * 0.72 * x
            for end, e in (("front", -1), ("back", 1)):
                body.hull(
                    f"leg_{side}_{end}",
                    [
                        (a + s * 0.008, *q)
                        for s in (-1, 1)
                        for q in (
                            (0.0, z0),
                            (e * 0.5 * p.thick, z0),
                            (0.0, z0 - 0.02),
                            (e * deep / 2, 0.0),
                            (e * (deep / 2 - 0.03), 0.0),
                        )
                    ],
                    material=p.metal,
                )
        return Made.of(body)
    plate = [(u, v + 0.01) for u, v in rounded(0.42 * width, deep, 0.03, 4)]
    body.prism("foot", plate, 0.0, 0.01, material=p.metal)
    body.taper("column", (0, 0, 0.01), (0, -0.2 * p.thick, z0), (0.14, 0.035), (0.1, 0.6 * p.thick), material=p.metal)
    return Made.of(body)


class RadiatorParameters(Parameters):
    """A radiator of columns on feet, with a valve."""

    width: float = Field(default=0.8, ge=0.3, le=1.2, description="along x [m]")
    height: float = Field(default=0.6, ge=0.35, le=0.9, description="along z [m]")
    depth: float = Field(default=0.14, ge=0.08, le=0.2, description="of the columns along y [m]")
    column: float = Field(default=0.055, ge=0.045, le=0.08, description="pitch of the columns [m]; at most 16 of them")
    metal: str = material("brass", "stainless_steel", "copper", of="valve and pipes")
    material: str = material("cast_iron", "mild_steel", "aluminium_alloy")


def _radiator(p: RadiatorParameters, rng: np.random.Generator) -> Made:
    body = Body("radiator", p.material)
    count = max(4, min(16, round(p.width / p.column)))
    pitch, y = p.width / count, p.depth / 2
    half, foot = 0.38 * pitch, 0.07
    low, high, r = foot + 0.05, p.height - 0.04, 0.02
    tubes = 2 if p.depth < 0.13 else 3
    for number in range(count):
        a = -p.width / 2 + pitch * (number + 0.5)
        for level, z in (("low", low), ("high", high)):
            rim = [(b, z + c) for b, c in rounded(p.depth, 0.07, 0.03, 3)]
            body.prism(f"head_{number + 1}_{level}", rim, a - half, a + half, axis="x")
        for tube in range(tubes):
            b = (tube - (tubes - 1) / 2) * (p.depth - 0.04) / max(1, tubes - 1)
            body.prism(
                f"tube_{number + 1}_{tube + 1}",
                [(a + u, b + v) for u, v in rounded(2 * half, 0.03, 0.35 * half, 2)],
                low + 0.035,
                high - 0.035,
            )
        if number:
            for level, z in (("low", low), ("high", high)):
                body.cylinder(f"nipple_{number}_{level}", (a - pitch + half, 0, z), (a - half, 0, z), r)
    end = p.width / 2 - pitch / 2
    for side, a in (("left", -end), ("right", end)):
        for number, b in enumerate((-y + 0.025, y - 0.025), start=1):
            body.taper(f"foot_{side}_{number}", (a, 1.1 * b, 0), (a, b, low - 0.035), (0.02, 0.024), (1.6 * half, 0.03))
    edge = p.width / 2 - pitch / 2 + half
    body.cylinder("valve_pipe", (edge, 0, low), (edge + 0.05, 0, low), 0.011, material=p.metal)
    body.turned(
        "valve",
        [(0, -0.03), (0.016, -0.03), (0.016, 0.03), (0.02, 0.035), (0.02, 0.075), (0.014, 0.082), (0, 0.082)],
        (edge + 0.066, 0, low),
        segments=20,
        material=p.metal,
    )
    body.cylinder("pipe", (edge + 0.066, 0, 0), (edge + 0.066, 0, low - 0.03), 0.008, material=p.metal)
    return Made.of(body)


GENERATORS = (
    Generator(
        "stove", "stove with hobs, an oven whose door drops open, and a drawer that slides out", StoveParameters, _stove,
        ("cooker", "oven", "range", "hob", "kitchen", "appliance"),
    ),
    Generator(
        "fridge", "fridge with hinged doors, glass shelves, and a freezer below", FridgeParameters, _fridge,
        ("refrigerator", "freezer", "kitchen", "appliance"),
    ),
    Generator(
        "television", "flat television on its stand", TelevisionParameters, _television, ("tv", "screen", "monitor", "living", "appliance"),
    ),
    Generator(
        "radiator", "radiator of columns on feet, with a valve", RadiatorParameters, _radiator, ("heating", "heater", "wall"), "static",
    ),
)  # fmt: skip
