"""Parts that cabinets share: carcasses, doors on hinges, drawers on slides, handles, cornices."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from .made import MAIN, Body, Joint, Made, Place, Point
from .profiles import circle, rounded

__all__ = [
    "BACK",
    "GAP",
    "SIDE",
    "Rect",
    "Style",
    "carcass",
    "cornice",
    "door",
    "drawer",
    "feet",
    "handle",
    "knob",
    "leaf",
    "pick",
    "pivots",
    "stacked",
]

Rect = tuple[float, float, float, float]
"""Least x, greatest x, least z, greatest z [m] of something that faces the front."""
GAP = 0.003
"""[m] Joint between neighbouring fronts."""
SIDE = 0.009
"""[m] Free space at each side of a drawer, in which its runners are."""
BACK = 0.006
"""[m] Thickness of back panels."""
SHEET = 0.0015
"""[m] Thickness of pressed fronts."""
OPEN = 1.9
"""[rad] Opening angle of doors."""


@dataclass(frozen=True)
class Style:
    """Materials and shapes of fronts."""

    front: str
    """Material of doors and of fronts of drawers."""
    inner: str
    """Material of drawer boxes."""
    metal: str = "stainless_steel"
    handle: str = "bar"
    """bar, bow, knob, or none."""
    panel: str = "flat"
    """flat, framed, glazed, or pressed (of sheet metal, with edges folded back)."""
    thick: float = 0.019
    """Thickness of fronts [m]."""
    wall: float = 0.012
    """Thickness of the sides of drawers [m]; their bottom has half of it."""


def pick(value: str, rng: np.random.Generator, *options: str) -> str:
    """A choice as asked for, or one of the options by the seed where it is "varied"."""
    drawn = options[int(rng.integers(len(options)))]
    return drawn if value == "varied" else value


def stacked(
    body: Body,
    name: str,
    curve: Sequence[tuple[float, float]],
    at: Point = (0, 0, 0),
    *,
    segments: int = 32,
    material: str | None = None,
) -> None:
    """Add a solid turned thing as convex pieces, one on the other, cut at its waists.

    Args:
        body: gets the parts.
        name: of the parts.
        curve: (r, z) from its foot to its head [m]; z never falls.
        at: origin of the curve's axis.
        segments: around the axis.
        material: of the parts.
    """
    start, number = 0, 1
    for k in range(1, len(curve)):
        if k < len(curve) - 1:
            (a, b), (c, d), (e, f) = curve[k - 1 : k + 2]
            if (c - a) * (f - d) - (d - b) * (e - c) >= 0:
                continue
        piece = list(curve[start : k + 1])
        if piece[-1][1] > piece[0][1]:
            outline = [(0.0, piece[0][1]), *piece, (0.0, piece[-1][1])]
            level = [q for q in outline if q[0] > 0 or q in (outline[0], outline[-1])]
            body.turned(f"{name}_{number}", level, at, segments=segments, material=material)
            number += 1
        start = k


def carcass(body: Body, low: Point, high: Point, thick: float, *, back: bool = True) -> None:
    """Sides, bottom and top board of a box that is open to the front, and its back panel, between two corners [m]."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    body.box("side_left", low, (x0 + thick, y1, z1))
    body.box("side_right", (x1 - thick, y0, z0), high)
    body.box("bottom", (x0 + thick, y0, z0), (x1 - thick, y1, z0 + thick))
    body.box("top", (x0 + thick, y0, z1 - thick), (x1 - thick, y1, z1))
    if back:
        body.box("back", (x0 + thick, y1 - BACK, z0 + thick), (x1 - thick, y1, z1 - thick))


def cornice(body: Body, low: Point, high: Point, reach: float) -> None:
    """A moulding on top of a box between two corners: it spreads by `reach` to the front and the sides, then a slab."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    waist = z0 + 0.6 * (z1 - z0)
    foot = [(x, y, z0) for x in (x0, x1) for y in (y0, y1)]
    head = [(x, y, waist) for x in (x0 - reach, x1 + reach) for y in (y0 - reach, y1)]
    body.hull("cornice", [*foot, *head])
    more = reach + 0.006
    body.box("cornice_slab", (x0 - more, y0 - more, waist), (x1 + more, y1, z1))


def feet(body: Body, kind: str, extent: tuple[float, float], height: float) -> None:
    """Four tapered feet, or a plinth that stands back, under a cabinet of an extent x, y [m]."""
    x, y = extent[0] / 2, extent[1] / 2
    if kind == "plinth":
        for side, a in (("left", -x + 0.03), ("right", x - 0.048)):
            body.box(f"plinth_{side}", (a, -y + 0.05, 0), (a + 0.018, y - 0.02, height))
        body.box("plinth_front", (-x + 0.03, -y + 0.032, 0), (x - 0.03, -y + 0.05, height))
        return
    for number, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        head = (sx * (x - 0.04), sy * (y - 0.04))
        foot = (sx * (x - 0.03), sy * (y - 0.03))
        body.taper(f"leg_{number}", (*foot, 0), (*head, height), (0.026, 0.026), (0.05, 0.05))


def knob(body: Body, name: str, at: Point, radius: float, *, material: str | None = None) -> None:
    """A turned knob on a face that looks to the front, at a point of the face [m]."""
    x, y, z = at
    neck = 0.8 * radius
    body.cylinder(f"{name}_neck", (x, y, z), (x, y - neck, z), 0.45 * radius, material=material)
    head = [
        (0, 0),
        (0.7 * radius, 0),
        (radius, 0.35 * radius),
        (0.95 * radius, 0.7 * radius),
        (0.5 * radius, radius),
        (0, radius),
    ]
    body.turned(name, head, (x, y - neck, z), segments=20, euler=(math.pi / 2, 0, 0), material=material)


def handle(
    body: Body, name: str, kind: str, at: Point, span: float, *, upright: bool = False, material: str | None = None
) -> None:
    """A handle on a face that looks to the front, about a point of the face [m].

    Args:
        body: gets the parts.
        name: of the part.
        kind: bar, bow, knob or none.
        at: middle of the handle on the face.
        span: distance of its feet; a knob is a tenth of it thick.
        upright: along z rather than x.
        material: of the handle.
    """
    if kind == "none":
        return
    if kind == "knob":
        knob(body, name, at, min(0.018, max(0.011, 0.12 * span)), material=material)
        return
    x, y, z = at
    half, reach = span / 2, 0.03
    if kind == "bow":
        curve = [(half * math.cos(a), 0.008 + (reach - 0.008) * math.sin(a)) for a in np.linspace(0, math.pi, 6)]
        way = [(half, 0.0), *curve, (-half, 0.0)]
    else:
        way = [(half, 0.0), (half, reach), (-half, reach), (-half, 0.0)]
    path = [(x, y - out, z - along) if upright else (x - along, y - out, z) for along, out in way]
    body.sweep(name, path, rounded(0.012, 0.009, 0.003, 2) if kind == "bar" else circle(0.005, 8), material=material)


def leaf(body: Body, rect: Rect, back: float, style: Style) -> None:
    """The board of a door: a slab, or a frame about a raised panel or a pane, with its back at y = `back` [m]."""
    x0, x1, z0, z1 = rect
    front = back - style.thick
    stile = min(0.07, 0.22 * (x1 - x0), 0.22 * (z1 - z0))
    if style.panel == "pressed":
        skin = front + SHEET
        body.box("board", (x0, front, z0), (x1, skin, z1))
        for side, a in (("left", x0), ("right", x1 - SHEET)):
            body.box(f"fold_{side}", (a, skin, z0), (a + SHEET, back, z1))
        for side, a in (("low", z0), ("high", z1 - SHEET)):
            body.box(f"fold_{side}", (x0 + SHEET, skin, a), (x1 - SHEET, back, a + SHEET))
        return
    if style.panel == "flat" or stile < 0.03:
        body.box("board", (x0, front, z0), (x1, back, z1))
        return
    body.box("stile_left", (x0, front, z0), (x0 + stile, back, z1))
    body.box("stile_right", (x1 - stile, front, z0), (x1, back, z1))
    x0, x1 = x0 + stile, x1 - stile
    body.box("rail_low", (x0, front, z0), (x1, back, z0 + stile))
    body.box("rail_high", (x0, front, z1 - stile), (x1, back, z1))
    z0, z1 = z0 + stile, z1 - stile
    middle = (front + back) / 2
    if style.panel == "glazed":
        body.box("pane", (x0, middle - 0.002, z0), (x1, middle + 0.002, z1), material="soda_lime_glass")
        return
    body.box("panel", (x0, middle, z0), (x1, middle + 0.006, z1))
    rim, field = 0.006, min(0.03, 0.2 * (x1 - x0), 0.2 * (z1 - z0))
    foot = [(x, middle, z) for x in (x0 + rim, x1 - rim) for z in (z0 + rim, z1 - rim)]
    body.hull("field", [*foot, *((x, middle - 0.007, z) for x in (x0 + field, x1 - field) for z in (z0 + field, z1 - field))])


def pivots(
    body: Body, name: str, at: tuple[float, float], reach: tuple[int, float], levels: tuple[float, float], metal: str
) -> None:
    """Thin plates under and over a door, which bear the pins on which it turns.

    Args:
        body: the cabinet.
        name: of the door.
        at: x, y of the door's axis [m].
        reach: side of the axis on which the door is when shut (1: at greater x), and y of the cabinet's front [m].
        levels: lower and upper edge of the door [m].
        metal: material.
    """
    (x, y), (sign, front) = at, reach
    left, right = sorted((x, x + sign * 0.016))
    for end, low in (("low", levels[0] - 0.0019), ("high", levels[1] + 0.0007)):
        body.box(f"pivot_{name}_{end}", (left, y - 0.001, low), (right, front, low + 0.0012), material=metal)


def door(
    made: Made,
    name: str,
    rect: Rect,
    back: float,
    style: Style,
    *,
    hinge: Literal["left", "right"] = "left",
    grip: float = 0.5,
    parent: str = MAIN,
) -> None:
    """Add a door on an upright hinge, as a body of its own.

    It turns about its front edge, so that it never reaches beyond its side.

    Args:
        made: gets the body and its joint.
        name: of the body and the joint.
        rect: of the door.
        back: y of its back [m]; at least 0.5 mm before what is behind.
        style: of the door and its handle.
        hinge: side of the hinge as seen from the front.
        grip: height of its handle as a share of its own.
        parent: body that bears the hinge.
    """
    x0, x1, z0, z1 = rect
    body = made.bodies[name] = Body("door", style.front)
    leaf(body, rect, back, style)
    sign = 1 if hinge == "left" else -1
    stile = min(0.07, 0.22 * (x1 - x0))
    at = (x1 - stile / 2 if sign > 0 else x0 + stile / 2, back - style.thick, z0 + grip * (z1 - z0))
    handle(body, "handle", style.handle, at, min(0.14, 0.3 * (z1 - z0)), upright=True, material=style.metal)
    anchor = (x0 if sign > 0 else x1, back - style.thick, (z0 + z1) / 2)
    pivots(made.bodies[parent], name, anchor[:2], (sign, back + 0.0015), (z0, z1), style.metal)
    made.joints[name] = Joint(name, "hinge", anchor, parent, axis=(0, 0, -sign), range=(0.0, OPEN), damping=0.5, friction=0.5)


def drawer(
    made: Made, name: str, cover: Rect, opening: Rect, depths: tuple[float, float], style: Style, *, parent: str = MAIN
) -> None:
    """Add a hollow drawer on a slide, as a body of its own, and its runners on the sides of the cabinet.

    Args:
        made: gets the body, its joint and a place in it.
        name: of the body, the joint and the place.
        cover: of its front.
        opening: free space between the boards of the cabinet.
        depths: y of the cabinet's front and of the inside of its back [m].
        style: of the front and its handle.
        parent: the cabinet.
    """
    x0, x1, z0, z1 = opening
    front, rear = depths[0] - 0.0015, depths[1] - 0.012
    body = made.bodies[name] = Body("drawer", style.inner)
    face = Body("front", style.front)
    leaf(face, cover, front, style)
    for part, own in face.parts.items():
        body.add(part, own.shape, own.pose.position, euler=own.pose.euler, material=own.material or style.front)
    wide, low, high = style.wall, z0 + 0.006, z0 + 0.006 + 0.8 * (z1 - z0 - 0.012)
    left, right, floor = x0 + SIDE, x1 - SIDE, z0 + 0.006 + style.wall / 2
    face_y, middle = front - style.thick, (cover[0] + cover[1]) / 2
    if "field" in body.parts:
        face_y = front - style.thick / 2 - 0.007
    if style.panel == "pressed":
        front = face_y + SHEET
    body.box("box_left", (left, front, low), (left + wide, rear, high))
    body.box("box_right", (right - wide, front, low), (right, rear, high))
    body.box("box_back", (left + wide, rear - wide, low), (right - wide, rear, high))
    body.box("box_bottom", (left + wide, front, low), (right - wide, rear - wide, floor))
    if style.panel != "flat" and "board" not in body.parts:
        body.box("box_front", (left + wide, front, floor), (right - wide, front + wide, high))
    width = cover[1] - cover[0]
    at = (middle, face_y, (cover[2] + cover[3]) / 2)
    if style.handle == "knob" and width > 0.55:
        for side, sign in (("left", -1), ("right", 1)):
            knob(body, f"knob_{side}", (middle + sign * width / 4, *at[1:]), 0.016, material=style.metal)
    else:
        handle(body, "handle", style.handle, at, min(0.16, 0.35 * width), material=style.metal)
    _runners(made.bodies[parent], name, (x0, x1, low, high), (depths[0], rear))
    length = rear - front
    anchor = (x0 + SIDE - 0.0005, (depths[0] + rear) / 2, (low + high) / 2)
    made.joints[name] = Joint(
        name, "slide", anchor, parent, axis=(0, -1, 0), range=(0.0, 0.75 * length), damping=10.0, friction=4.0
    )
    size = (right - left - 2 * wide, 0.9 * (length - 2 * wide))
    made.places[name] = Place((middle, (front + rear) / 2, floor), size, z1 - floor - 0.004, name)


def _runners(body: Body, name: str, opening: Rect, depths: tuple[float, float]) -> None:
    """Steel strips beside a drawer, 1 mm away from it."""
    x0, x1, low, high = opening
    middle, half = (low + high) / 2, min(0.01, 0.2 * (high - low))
    for side, a, b in (("left", x0, x0 + SIDE - 0.001), ("right", x1 - SIDE + 0.001, x1)):
        body.box(f"runner_{name}_{side}", (a, depths[0], middle - half), (b, depths[1], middle + half), material="mild_steel")
