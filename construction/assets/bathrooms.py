"""Fittings of bathrooms: bathtubs, toilets, washbasins, shower trays."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import pick
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Joint, Made, Place
from .plumbing import tap
from .profiles import circle, inset, oval, rounded

__all__ = ["GENERATORS"]

Flat = list[tuple[float, float]]
METALS = ("stainless_steel", "brass", "copper", "bronze")


def _walled(
    body: Body, name: str, outline: Flat, wall: Flat, floor: tuple[float, float, float], *, metal: str | None = None
) -> None:
    """A basin: a profile (outwards, up) carried about an outline, and a floor within.

    Args:
        body: gets the parts.
        name: of the parts.
        outline: counter-clockwise polygon (x, y) [m].
        wall: profile of the wall about it [m].
        floor: way inwards from the outline to the floor's edge, and its lower and upper height [m].
        metal: material, if not the body's.
    """
    body.sweep(f"{name}_wall", [(x, y, 0.0) for x, y in outline], wall, closed=True, material=metal)
    body.prism(f"{name}_floor", inset(outline, floor[0]), floor[1], floor[2], material=metal)


class BathtubParameters(Parameters):
    """A bathtub: with an apron to be built in, or free on four feet, with a tap."""

    length: float = Field(default=1.7, ge=1.4, le=1.9, description="along x [m]")
    width: float = Field(default=0.75, ge=0.68, le=0.9, description="along y [m]")
    height: float = Field(default=0.58, ge=0.5, le=0.65, description="to the rim [m]")
    kind: Literal["varied", "apron", "feet"] = Field(default="varied", description="with an apron, or free on feet")
    taps: bool = Field(default=True, description="a tap on the rim, or on a pipe beside a free bathtub")
    metal: str = material(*METALS, of="tap and feet")
    material: str = material("porcelain", "polystyrene", "cast_iron", "copper")


def _bathtub(p: BathtubParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("bathtub", p.material)), Made.of(own)
    if pick(p.kind, rng, "apron", "feet") == "apron":
        high = p.height
        outline = rounded(p.length, p.width, 0.03, 2)
        body.sweep(
            "apron", [(x, y, 0.0) for x, y in outline],
            [(-0.012, 0.0), (0.0, 0.0), (0.0, high - 0.012), (-0.012, high - 0.012)], closed=True,
        )  # fmt: skip
        inner = rounded(p.length - 0.16, p.width - 0.14, 0.2, 5)
        _rim(body, rounded(p.length + 0.01, p.width + 0.01, 0.03, 2), inner, (high - 0.012, high))
        wall = [(-0.075, 0.085), (-0.055, 0.085), (0.014, high - 0.012), (0.0, high - 0.012), (-0.075, 0.1)]
        _walled(body, "tub", inner, wall, (0.075, 0.085, 0.1))
        if p.taps:
            at = (0.0, p.width / 2 - 0.036, high)
            tap(made, at, (0.13, 0.12), pick("varied", rng, "arch", "straight"), p.metal, turn=0.6)
        floor, way = 0.1, 0.075
    else:
        low, high = 0.16, p.height
        outline, way = rounded(p.length - 0.06, p.width - 0.06, 0.44 * p.width, 6), 0.115
        rim = [(-0.004, high - 0.03), (0.02, high - 0.03), (0.028, high - 0.012), (0.018, high), (-0.018, high)]
        _walled(body, "tub", outline, [(-way, low), (-way + 0.02, low), *rim, (-way, low + 0.014)], (way, low, low + 0.014))
        _claws(body, p, low)
        if p.taps:
            _standpipe(body, p, high)
        floor = low + 0.014
    drain = (0.5 * p.length - 0.42, 0.0)
    body.cylinder("drain", (*drain, floor), (*drain, floor + 0.003), 0.028, material=p.metal)
    made.places["inside"] = Place((0, 0, floor), (0.5 * (p.length - 2 * way), 0.5 * (p.width - 2 * way)), p.height - floor)
    return made


def _rim(body: Body, outer: Flat, inner: Flat, levels: tuple[float, float], *, metal: str | None = None) -> None:
    """A level rim between two outlines that both look right at their first point, in a left and a right half."""
    for name, sign in (("right", 1), ("left", -1)):
        far = sorted((q for q in outer if sign * q[0] > 0), key=lambda q: q[1])
        near = sorted((q for q in inner if sign * q[0] > 0), key=lambda q: -q[1])
        low, high = min(y for _, y in outer), max(y for _, y in outer)
        below, above = min(y for _, y in inner), max(y for _, y in inner)
        ring = [(0.0, low), *far, (0.0, high), (0.0, above), *near, (0.0, below)]
        body.prism(f"rim_{name}", ring, *levels, material=metal)


def _claws(body: Body, p: BathtubParameters, low: float) -> None:
    """Four curved feet under a free bathtub, with a ball each."""
    x, y = 0.5 * p.length - 0.42, 0.5 * p.width - 0.21
    for number, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        a, b = sx * x, sy * y
        knee, ankle = (a + 0.035 * sx, b + 0.06 * sy, 0.1), (a + 0.03 * sx, b + 0.055 * sy, 0.04)
        body.taper(f"claw_{number}", knee, (a, b, low), (0.05, 0.045), (0.09, 0.075), material=p.metal)
        body.taper(f"ankle_{number}", ankle, knee, (0.026, 0.026), (0.05, 0.045), material=p.metal)
        body.turned(
            f"paw_{number}", [(0, 0), (0.026, 0), (0.032, 0.012), (0.028, 0.034), (0.018, 0.04), (0, 0.04)],
            (a + 0.03 * sx, b + 0.055 * sy, 0), segments=20, material=p.metal,
        )  # fmt: skip


def _standpipe(body: Body, p: BathtubParameters, high: float) -> None:
    """A pipe beside a free bathtub that bends over its rim."""
    y = p.width / 2 + 0.05
    top = high + 0.18
    bend = [(y - 0.07 + 0.07 * math.cos(a), top + 0.07 * math.sin(a)) for a in np.linspace(0, math.pi / 2, 5)]
    body.turned("pipe_flange", [(0, 0), (0.035, 0), (0.03, 0.012), (0, 0.012)], (0, y, 0), segments=24, material=p.metal)
    path = [
        (0.0, y, 0.012),
        *((0.0, b, c) for b, c in bend),
        (0.0, y - 0.18, top + 0.07),
        (0.0, y - 0.2, top + 0.05),
        (0.0, y - 0.2, top + 0.02),
    ]
    around = circle(0.013, 10)
    side_x, side_y = max(u for u, _ in around), max(v for _, v in around)
    body.sweep("pipe", path, around, material=p.metal)
    tub = p.width / 2 - 0.002
    body.cylinder("pipe_stay", (0, tub, high - 0.018), (0, y - side_y, high - 0.018), 0.006, material=p.metal)
    for side, sign in (("cold", -1), ("hot", 1)):
        body.cylinder(f"valve_{side}", (sign * side_x, y, high + 0.08), (sign * 0.05, y, high + 0.08), 0.008, material=p.metal)
        body.cylinder(f"wheel_{side}", (sign * 0.05, y, high + 0.08), (sign * 0.062, y, high + 0.08), 0.022, material=p.metal)


class ShowerTrayParameters(Parameters):
    """A shower: tray with a drain, a riser with its head at the back, and a glass screen with a door if wanted."""

    width: float = Field(default=0.9, ge=0.7, le=1.4, description="along x [m]")
    depth: float = Field(default=0.9, ge=0.7, le=1.1, description="along y [m]; the wall is at +y")
    height: float = Field(default=0.09, ge=0.06, le=0.15, description="of the tray [m]")
    head: float = Field(default=2.05, ge=1.9, le=2.2, description="height of the shower's head [m]")
    screen: bool = Field(default=True, description="panes at the right side and the front, with a hinged door")
    metal: str = material("stainless_steel", "brass", "aluminium_alloy", of="pipes and frame")
    material: str = material("porcelain", "polystyrene", "slate", "marble")


def _shower_tray(p: ShowerTrayParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("shower tray", p.material)), Made.of(own)
    y, high = p.depth / 2, p.height
    outline = rounded(p.width, p.depth, 0.09, 4)
    _walled(
        body,
        "tray",
        outline,
        [(-0.05, 0.0), (0.0, 0.0), (0.0, high - 0.006), (-0.006, high), (-0.04, high), (-0.05, 0.035)],
        (0.05, 0.0, 0.035),
    )
    body.cylinder("drain", (0, 0.25 * p.depth, 0.035), (0, 0.25 * p.depth, 0.038), 0.045, material=p.metal)
    square = float(rng.choice([0.0, 1.0]))
    out, r = 0.25 * p.depth, 0.011
    wall = y - 0.03
    body.box("plate", (-0.13, wall, 1.02), (0.13, wall + 0.03, 1.1), material=p.metal)
    body.box("riser_foot", (-0.02, wall - 0.03, 1.04), (0.02, wall, 1.08), material=p.metal)
    bend = [
        (wall - 0.015 - 0.06 + 0.06 * math.cos(a), p.head - 0.06 + 0.06 * math.sin(a)) for a in np.linspace(0, math.pi / 2, 5)
    ]
    path = [
        (0.0, wall - 0.015, 1.08),
        *((0.0, b, c) for b, c in bend),
        (0.0, wall - out, p.head),
        (0.0, wall - out - 0.02, p.head - 0.02),
        (0.0, wall - out - 0.02, p.head - 0.05),
    ]
    body.sweep("riser", path, circle(r, 10), material=p.metal)
    tip = (0.0, wall - out - 0.02, p.head - 0.05)
    if square:
        body.box("head", (-0.11, tip[1] - 0.11, tip[2] - 0.014), (0.11, tip[1] + 0.11, tip[2]), material=p.metal)
    else:
        body.turned("head", [(0, -0.03), (0.1, -0.03), (0.105, -0.02), (0.03, 0), (0, 0)], tip, segments=32, material=p.metal)
    body.box("post_wall", (-0.015, wall, p.height), (0.015, wall + 0.03, 1.02), material=p.metal)
    for side, sign in (("cold", -1), ("hot", 1)):
        body.cylinder(f"valve_{side}", (sign * 0.09, wall, 1.06), (sign * 0.09, wall - 0.05, 1.06), 0.02, material=p.metal)
    made.places["floor"] = Place((0, 0, 0.035), (p.width - 0.14, p.depth - 0.3), 1.0)
    if p.screen:
        _screen(made, p)
    return made


def _screen(made: Made, p: ShowerTrayParameters) -> None:
    """Panes of glass on the tray's rim at the right and in front, and a door of glass."""
    body, x, y, low, high, t = made.main, p.width / 2 - 0.02, p.depth / 2 - 0.02, p.height, 1.95, 0.008
    post = 0.01
    for name, a, b in (("front_left", -x, -y), ("front_right", x, -y), ("back_right", x, y)):
        body.box(f"post_{name}", (a - post, b - post, low), (a + post, b + post, high), material=p.metal)
    body.box("pane_side", (x - t / 2, -y + post, low), (x + t / 2, y - post, high), material="soda_lime_glass")
    body.box("head_rail", (-x + post, -y - post, high - 0.02), (x - post, -y + post, high), material=p.metal)
    body.box("side_rail", (x - post, -y + post, high), (x + post, y - post, high + 0.012), material=p.metal)
    door = made.bodies["door"] = Body("door", "soda_lime_glass")
    a, b = -x + post + 0.003, x - post - 0.003
    z0, z1 = low + 0.006, high - 0.024
    door.box("pane", (a, -y - t / 2, z0), (b, -y + t / 2, z1))
    for side, sign in (("outside", -1), ("inside", 1)):
        door.cylinder(
            f"knob_{side}",
            (b - 0.05, -y + sign * t / 2, 1.0),
            (b - 0.05, -y + sign * (t / 2 + 0.03), 1.0),
            0.016,
            material=p.metal,
        )
    made.joints["door"] = Joint(
        "door", "hinge", (a, -y - t / 2, 1.0), MAIN, axis=(0, 0, -1), range=(0.0, 1.6), damping=0.5, friction=0.5
    )


class WashbasinParameters(Parameters):
    """A washbasin on a pedestal, with a tap whose spout turns."""

    width: float = Field(default=0.58, ge=0.48, le=0.75, description="along x [m]")
    depth: float = Field(default=0.46, ge=0.42, le=0.55, description="along y [m]; the wall is at +y")
    height: float = Field(default=0.85, ge=0.78, le=0.92, description="to the rim [m]")
    bowl: float = Field(default=0.14, ge=0.1, le=0.18, description="depth of the bowl [m]")
    outline: Literal["varied", "square", "round"] = Field(default="varied", description="of the rim")
    metal: str = material(*METALS, of="the tap")
    material: str = material("porcelain", "marble", "terracotta", "polystyrene")


def _washbasin(p: WashbasinParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("washbasin", p.material)), Made.of(own)
    x, y, high, thick = p.width / 2, p.depth / 2, p.height, 0.03
    square = pick(p.outline, rng, "square", "round") == "square"
    middle = -0.045
    hole = [(a, b + middle) for a, b in rounded(p.width - 0.12, p.depth - 0.19, 0.42 * (p.depth - 0.19), 5)]
    outer = rounded(p.width, p.depth, 0.05 if square else 0.45 * p.depth, 4 if square else 6)
    if not square:
        outer = [q for q in outer if q[1] < 0] + [(x, y - 0.03), (x - 0.03, y), (-x + 0.03, y), (-x, y - 0.03)]
    _rim(body, outer, hole, (high - thick, high))
    low, way = high - p.bowl, 0.075
    wall = [(-way, low - 0.014), (-way + 0.02, low - 0.014), (0.016, high - thick), (0.0, high - thick), (-way, low)]
    _walled(body, "bowl", hole, wall, (way, low - 0.014, low))
    body.box("splash_back", (-x + 0.02, y - 0.02, high), (x - 0.02, y, high + 0.03))
    foot, neck = oval(0.24, 0.22, 16, middle=0.0), oval(0.15, 0.14, 16, middle=0.0)
    inner = min(y - 0.19 / 2 - way - 0.03, 0.075)
    head = oval(2 * inner + 0.04, 2 * inner, 16, middle=middle)
    waist, top = 0.06, low - 0.014
    body.hull("foot", [(*q, z) for q in foot for z in (0.0, 0.03)] + [(*q, waist + 0.05) for q in neck])
    body.hull("pedestal", [(*q, waist + 0.05) for q in neck] + [(*q, top) for q in head])
    body.cylinder("drain", (0, middle, low), (0, middle, low + 0.002), 0.022, material=p.metal)
    kind = "arch" if rng.random() < 0.4 else "straight"
    tap(made, (0, y - 0.056, high), (0.13, 0.14), kind, p.metal)
    made.places["bowl"] = Place((0.064, middle, low), (0.07, 0.05), p.bowl)
    return made


class ToiletParameters(Parameters):
    """A toilet with a cistern, and a seat and a lid on hinges."""

    width: float = Field(default=0.37, ge=0.33, le=0.42, description="of the bowl along x [m]")
    depth: float = Field(default=0.68, ge=0.62, le=0.76, description="along y with the cistern [m]; the wall is at +y")
    rim: float = Field(default=0.4, ge=0.36, le=0.46, description="height of the bowl's rim [m]")
    cistern: float = Field(default=0.36, ge=0.3, le=0.42, description="height of the cistern [m]")
    lid: str = material("polystyrene", "oak", "mahogany", "pine", "abs", of="seat and lid")
    metal: str = material("stainless_steel", "brass", of="button and hinges")
    material: str = material("porcelain", "terracotta")


def _toilet(p: ToiletParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("toilet", p.material)), Made.of(own)
    back, long, rim = p.depth / 2, p.depth - 0.21, p.rim
    middle = -p.depth / 2 + long / 2
    egg = oval(p.width, long, 20, middle=middle)
    wall = [(-0.1, 0.22), (-0.06, 0.22), (0.0, rim - 0.05), (0.0, rim), (-0.045, rim)]
    body.sweep("bowl_wall", [(a, b, 0.0) for a, b in egg], wall, closed=True)
    body.prism("bowl_floor", inset(egg, 0.06), 0.205, 0.22)
    foot = oval(0.6 * p.width, 0.72 * long, 20, middle=middle + 0.06)
    body.hull("foot", [(*q, z) for q in foot for z in (0.0, 0.02)] + [(*q, 0.205) for q in inset(egg, 0.06)])
    rear = max(b for _, b in egg)
    far = max(b for _, b in foot)
    half = 0.5 * p.width + 0.005
    notch = [q for q in egg if q[1] > middle + 0.28 * long]
    deck = [(half, notch[0][1]), (half, back - 0.02), (-half, back - 0.02), (-half, notch[-1][1]), *notch[::-1]]
    body.prism("deck", deck, rim - 0.05, rim)
    start = max(far, rear) + 0.001
    body.box("shank", (-0.09, start, 0.0), (0.09, back - 0.03, rim - 0.05))
    tank, top = back - 0.17, rim + p.cistern
    wide = 0.5 * p.width + float(rng.uniform(0.0, 0.03))
    slope = float(rng.uniform(0.0, 0.03))
    base = [(a, b, rim) for a in (-wide + slope, wide - slope) for b in (tank + 0.01, back)]
    body.hull("cistern", [*base, *((a, b, top - 0.03) for a in (-wide, wide) for b in (tank, back))])
    cap = [(tank - 0.008, top - 0.03), (back, top - 0.03), (back, top), (tank + 0.004, top), (tank - 0.008, top - 0.012)]
    body.prism("cistern_lid", cap, -wide - 0.008, wide + 0.008, axis="x")
    body.turned(
        "button", [(0, 0), (0.028, 0), (0.024, 0.006), (0, 0.006)], (0, (tank + back) / 2, top), segments=24, material=p.metal
    )
    _seat(made, p, egg, rear)
    made.places["cistern"] = Place((0.55 * wide, (tank + back) / 2, top), (0.5 * wide, 0.13))
    return made


def _seat(made: Made, p: ToiletParameters, egg: Flat, rear: float) -> None:
    """The seat over the rim, and the lid over the seat, each on a hinge behind."""
    seat, lid = Body("seat", p.lid), Body("lid", p.lid)
    made.bodies["seat"], made.bodies["lid"] = seat, lid
    low, pivot = p.rim + 0.002, rear + 0.0065
    ring = [(-0.06, low), (0.004, low), (0.004, low + 0.016), (0.002, low + 0.018), (-0.045, low + 0.018), (-0.06, low + 0.01)]
    seat.sweep("ring", [(a, b, 0.0) for a, b in egg], ring, closed=True)
    over = low + 0.02
    lid.hull(
        "board",
        [(*q, z) for q in inset(egg, -0.004) for z in (over, over + 0.008)] + [(*q, over + 0.016) for q in inset(egg, 0.012)],
    )
    # The axis lies between the lower edge of the ring and a plate on the deck, over which the seat swings.
    made.main.box("hinge_plate", (-0.02, pivot - 0.001, p.rim), (0.02, pivot + 0.016, low - 0.0005), material=p.metal)
    anchor = (0, pivot, low - 0.0003)
    made.joints["seat"] = Joint("seat", "hinge", anchor, MAIN, axis=(-1, 0, 0), range=(0.0, 1.4), damping=0.1, friction=0.2)
    made.joints["lid"] = Joint(
        "lid", "hinge", (0, rear + 0.004, over - 0.001), "seat", axis=(-1, 0, 0), range=(0.0, 1.55), damping=0.1, friction=0.2
    )


GENERATORS = (
    Generator(
        "bathtub", "bathtub with an apron or on feet, and a tap", BathtubParameters, _bathtub, ("bath", "tub", "bathroom"), "static",
    ),
    Generator(
        "shower_tray", "shower tray with riser and head, and a glass screen with a hinged door", ShowerTrayParameters, _shower_tray,
        ("shower", "cubicle", "bathroom", "wet"), "static",
    ),
    Generator(
        "washbasin", "washbasin on a pedestal, and a tap whose spout turns", WashbasinParameters, _washbasin,
        ("sink", "basin", "bathroom", "tap", "faucet"), "static",
    ),
    Generator(
        "toilet", "toilet with a cistern, and a hinged seat and lid", ToiletParameters, _toilet, ("wc", "lavatory", "bathroom", "loo"), "static",
    ),
)  # fmt: skip
