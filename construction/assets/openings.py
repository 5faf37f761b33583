"""Doors and windows: static frames with leaves that turn on hinges."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made, Place
from .profiles import circle, convex_outline

__all__ = ["GENERATORS"]

KNUCKLE = 0.006
"""Radius of a hinge's knuckle [m]; its axis is so far before the leaf and half as far inside of its edge."""
PLAY = 0.0008
"""Gap between the knuckles of a hinge [m]."""
JAMB = 0.045
"""Thickness of a frame [m]."""


class _Leaf(NamedTuple):
    """Outline of a leaf [m]: its front is at `front`, it is hinged at the left (-1) or the right (1)."""

    left: float
    right: float
    low: float
    high: float
    front: float
    thick: float
    hinged: int

    @property
    def back(self) -> float:
        return self.front + self.thick

    @property
    def axis(self) -> tuple[float, float]:
        """Place of the hinge in plan."""
        return (self.left if self.hinged < 0 else self.right) - self.hinged * KNUCKLE / 2, self.front - KNUCKLE

    @property
    def latch(self) -> float:
        """x of the edge that moves."""
        return self.right if self.hinged < 0 else self.left


def _swing(thick: float, width: float) -> float:
    """Gap that the far corner of a leaf needs on its way out, and 2 mm of air [m]."""
    return 0.002 + (thick + KNUCKLE) ** 2 / (2 * width)


def _bearing(leaf: _Leaf) -> list[tuple[float, float]]:
    """Outline of what the frame holds a hinge's pin with: round about the axis, and flat on the front of the jamb."""
    x, y = leaf.axis
    pin = [(x + 0.0045 * math.cos(a), y + 0.0045 * math.sin(a)) for a in (math.pi * k / 4 for k in range(8))]
    foot = [(x + leaf.hinged * reach, leaf.front) for reach in (0.010, 0.018)]
    return convex_outline([*pin, *foot])


def _hang(made: Made, name: str, body: Body, leaf: _Leaf, limit_deg: float, *, metal: str) -> None:
    """Hang a leaf on its hinge, with knuckles that show."""
    x, y = leaf.axis
    height = leaf.high - leaf.low
    for number, share in enumerate((0.12, 0.5, 0.88) if height > 1.2 else (0.15, 0.85), start=1):
        z = leaf.low + share * height
        body.cylinder(f"knuckle_{number}", (x, y, z - 0.04), (x, y, z + 0.04), KNUCKLE, material=metal)
        low, high = z + 0.04 + PLAY, z + 0.072
        made.main.prism(f"hinge_{name}_{number}".strip("_"), _bearing(leaf), low, high, material=metal)
    made.bodies[name] = body
    made.joints[name] = Joint(
        name, "hinge", (x, y, leaf.low + height / 2), axis=(0, 0, leaf.hinged),
        range=(0.0, math.radians(limit_deg)), damping=0.5, friction=0.5 if height < 1.2 else 1.0,
    )  # fmt: skip


def _frame(body: Body, width: float, height: float, depth: float, *, foot: float) -> None:
    """Two jambs, a head and a sill about an opening that begins at height `foot` [m]."""
    x, y = width / 2, depth / 2
    body.box("jamb_left", (-x - JAMB, -y, 0), (-x, y, height))
    body.box("jamb_right", (x, -y, 0), (x + JAMB, y, height))
    body.box("head", (-x - JAMB, -y, height), (x + JAMB, y, height + JAMB))
    body.box("sill", (-x, -y, 0), (x, y, foot))


def _stops(body: Body, width: float, low: float, height: float, levels: tuple[float, float]) -> None:
    """Strips on which the leaves close."""
    x, (front, back), deep = width / 2, levels, 0.013
    body.box("stop_left", (-x, front, low), (-x + deep, back, height))
    body.box("stop_right", (x - deep, front, low), (x, back, height))
    body.box("stop_head", (-x + deep, front, height - deep), (x - deep, back, height))


def _casing(body: Body, width: float, height: float, depth: float, *, foot: float = 0.0) -> None:
    """Mouldings about the opening at the front and at the back, with a cap."""
    inner, wide, thick = width / 2 + 0.014, 0.075, 0.016
    for side, y in (("front", -depth / 2 - thick), ("back", depth / 2)):
        for sign, name in ((-1, "left"), (1, "right")):
            a, b = sorted((sign * inner, sign * (inner + wide)))
            body.box(f"casing_{side}_{name}", (a, y, foot), (b, y + thick, height + 0.014))
        reach = inner + wide
        body.box(f"casing_{side}_head", (-reach, y, height + 0.014), (reach, y + thick, height + 0.1))
        low, high = (y - 0.014, y + thick) if side == "front" else (y, y + thick + 0.014)
        body.hull(
            f"cap_{side}",
            [(s * (reach + w), e, z) for s in (-1, 1) for w, z in ((0.0, height + 0.1), (0.018, height + 0.13))
             for e in ((low if w else max(low, y)), (high if w else min(high, y + thick)))],
        )  # fmt: skip


def _panelled(body: Body, leaf: _Leaf, *, glazed: bool, rng: np.random.Generator) -> None:
    """Stiles, rails and raised panels; upper panels of glass where asked for."""
    width, height = leaf.right - leaf.left, leaf.high - leaf.low
    stile, front, back = min(0.11, 0.2 * width), leaf.front, leaf.back
    inner = (leaf.left + stile, leaf.right - stile)
    body.box("stile_left", (leaf.left, front, leaf.low), (inner[0], back, leaf.high))
    body.box("stile_right", (inner[1], front, leaf.low), (leaf.right, back, leaf.high))
    lock = float(rng.uniform(0.38, 0.48))
    levels = [(0.0, 0.2), (lock * height - 0.07, lock * height + 0.07), (height - 0.11, height)]
    if not glazed and rng.integers(2):
        levels.insert(2, (0.8 * height - 0.05, 0.8 * height + 0.05))
    for number, (low, high) in enumerate(levels, start=1):
        body.box(f"rail_{number}", (inner[0], front, leaf.low + low), (inner[1], back, leaf.low + high))
    columns = 2 if width > 0.55 else 1
    mullion = 0.09 if columns == 2 else 0.0
    middle, y = sum(inner) / 2, (front + back) / 2
    for row in range(len(levels) - 1):
        low, high = leaf.low + levels[row][1], leaf.low + levels[row + 1][0]
        if columns == 2:
            body.box(f"mullion_{row + 1}", (middle - mullion / 2, front, low), (middle + mullion / 2, back, high))
        for column in range(columns):
            x0 = inner[0] if column == 0 else middle + mullion / 2
            x1 = inner[1] if column == columns - 1 else middle - mullion / 2
            name = f"panel_{row + 1}_{column + 1}"
            if glazed and row > 0:
                body.box(name, (x0, y - 0.003, low), (x1, y + 0.003, high), material="soda_lime_glass")
            else:
                raised = min(0.045, 0.25 * (x1 - x0), 0.25 * (high - low))
                rims = ((0.0, 0.18), (raised, 0.42))
                body.hull(
                    name,
                    [
                        (x, y + s * t * leaf.thick, z)
                        for r, t in rims
                        for x in (x0 + r, x1 - r)
                        for z in (low + r, high - r)
                        for s in (-1, 1)
                    ],
                )


def _planked(body: Body, leaf: _Leaf, *, metal: str, rng: np.random.Generator) -> None:
    """Upright boards with V joints before ledges and braces; iron straps at the front."""
    width, height, groove = leaf.right - leaf.left, leaf.high - leaf.low, 0.006
    count = max(3, round(width / 0.14))
    middle = leaf.front + 0.6 * leaf.thick
    cuts = [0.0, *(k / count + float(rng.uniform(-0.1, 0.1)) / count for k in range(1, count)), 1.0]
    for k in range(count):
        x0, x1 = leaf.left + cuts[k] * width, leaf.left + cuts[k + 1] * width
        a, b = groove * (k > 0), groove * (k < count - 1)
        front = [(x0, leaf.front + a), (x0 + a, leaf.front), (x1 - b, leaf.front), (x1, leaf.front + b)]
        outline = [(x0, middle), *dict.fromkeys(front), (x1, middle)]
        body.prism(f"board_{k + 1}", outline, leaf.low, leaf.high)
    levels = [leaf.low + share * height for share in (0.1, 0.5, 0.9)]
    for k, z in enumerate(levels, start=1):
        body.box(f"ledge_{k}", (leaf.left + 0.03, middle, z - 0.07), (leaf.right - 0.03, leaf.back, z + 0.07))
    for k in range(2):
        low, high = levels[k] + 0.07, levels[k + 1] - 0.07
        a, b = (leaf.left + 0.05, leaf.right - 0.05)[:: -leaf.hinged]
        w = 0.1 * (1 if b > a else -1)
        points = [(x, y, z) for x, z in ((a, low), (a + w, low), (b - w, high), (b, high)) for y in (middle, leaf.back)]
        body.hull(f"brace_{k + 1}", points)
    for k, z in enumerate((levels[0], levels[2]), start=1):
        a = leaf.axis[0] - leaf.hinged * 1.1 * KNUCKLE
        b = a - leaf.hinged * 0.7 * width
        w = 0.05 * leaf.hinged
        tip = [(a, z - 0.022), (a, z + 0.022), (b + w, z - 0.014), (b + w, z + 0.014), (b, z)]
        body.hull(f"strap_{k}", [(x, y, zz) for x, zz in tip for y in (leaf.front - 0.0045, leaf.front)], material=metal)


def _lever(body: Body, leaf: _Leaf, height: float, *, metal: str) -> None:
    """A lever on its rose on both sides."""
    x = leaf.latch + leaf.hinged * 0.055
    for name, face, out in (("front", leaf.front, -1), ("back", leaf.back, 1)):
        rose = face + out * 0.007
        body.cylinder(f"rose_{name}", (x, face, height), (x, rose, height), 0.026, material=metal)
        y, along = face + out * 0.05, leaf.hinged
        path = [(x, rose, height), (x, y - out * 0.012, height), (x + along * 0.012, y, height), (x + along * 0.12, y, height)]
        body.sweep(f"lever_{name}", path, circle(0.009, 8), material=metal)


def _pull(body: Body, leaf: _Leaf, height: float, *, metal: str) -> None:
    """A bow of iron to pull at the front."""
    x, y = leaf.latch + leaf.hinged * 0.07, leaf.front
    path = [
        (x, y, height - 0.09), (x, y - 0.03, height - 0.09), (x, y - 0.045, height - 0.07),
        (x, y - 0.045, height + 0.07), (x, y - 0.03, height + 0.09), (x, y, height + 0.09),
    ]  # fmt: skip
    body.sweep("pull", path, circle(0.008, 8), material=metal)


Style = Literal["panelled", "planks", "glazed", "flush"]


def _leaf_body(leaf: _Leaf, style: Style, wood: str, metal: str, rng: np.random.Generator) -> Body:
    body = Body("door leaf", wood)
    handle = leaf.low + min(1.0, 0.5 * (leaf.high - leaf.low))
    if style == "planks":
        _planked(body, leaf, metal=metal, rng=rng)
        _pull(body, leaf, handle + 0.1, metal=metal)
        return body
    if style == "flush":
        body.box("slab", (leaf.left, leaf.front, leaf.low), (leaf.right, leaf.back, leaf.high))
        body.box(
            "plate",
            (leaf.left + 0.02, leaf.front - 0.0015, leaf.low + 0.01),
            (leaf.right - 0.02, leaf.front, leaf.low + 0.2),
            material=metal,
        )
    else:
        _panelled(body, leaf, glazed=style == "glazed", rng=rng)
    _lever(body, leaf, handle, metal=metal)
    return body


class DoorParameters(Parameters):
    """A door in its frame; its leaf opens towards the front (-y)."""

    width: float = Field(default=0.86, ge=0.62, le=1.2, description="clear width between the jambs [m]; 0.82 for wheelchairs")
    height: float = Field(default=2.03, ge=1.8, le=2.4, description="clear height [m]")
    depth: float = Field(default=0.12, ge=0.09, le=0.5, description="of the frame, as thick as the wall [m]")
    leaf: float = Field(default=0.042, ge=0.035, le=0.07, description="thickness of the leaf [m]")
    style: Style = Field(default="panelled", description="of the leaf")
    hinged: Literal["left", "right"] = Field(default="left", description="side of the hinges, seen from the front")
    open_deg: float = Field(default=105.0, ge=80.0, le=115.0, description="how far it opens [degrees]")
    casing: bool = Field(default=True, description="mouldings about the frame on both sides")
    metal: str = material("brass", "stainless_steel", "cast_iron", of="handle and hinges")
    material: str = material("oak", "pine", "walnut", "spruce", "mahogany")


def _door(p: DoorParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("door frame", p.material, "static"))
    front, foot, side = -p.depth / 2, 0.016, -1 if p.hinged == "left" else 1
    _frame(made.main, p.width, p.height, p.depth, foot=foot)
    _stops(made.main, p.width, foot, p.height, (front + p.leaf + 0.003, front + p.leaf + 0.025))
    if p.casing:
        _casing(made.main, p.width, p.height, p.depth)
    gap = _swing(p.leaf, p.width)
    edges = (-p.width / 2 + 0.003, p.width / 2 - gap)
    left, right = edges if side < 0 else (-edges[1], -edges[0])
    leaf = _Leaf(left, right, foot + 0.005, p.height - 0.003, front, p.leaf, side)
    _hang(made, "leaf", _leaf_body(leaf, p.style, p.material, p.metal, rng), leaf, p.open_deg, metal=p.metal)
    made.places["threshold"] = Place((0, p.leaf / 2, foot), (0.9 * p.width, 0.8 * (p.depth - p.leaf)), p.height - foot)
    return made


class DoubleDoorParameters(Parameters):
    """A door or gate of two leaves in a frame; they open towards the front (-y)."""

    width: float = Field(default=1.5, ge=1.2, le=3.0, description="clear width between the jambs [m]")
    height: float = Field(default=2.15, ge=1.9, le=3.2, description="clear height [m]")
    depth: float = Field(default=0.16, ge=0.12, le=0.8, description="of the frame, as thick as the wall [m]")
    leaf: float = Field(default=0.045, ge=0.035, le=0.09, description="thickness of the leaves [m]")
    style: Style = Field(default="panelled", description="of the leaves")
    open_deg: float = Field(default=100.0, ge=80.0, le=115.0, description="how far they open [degrees]")
    casing: bool = Field(default=True, description="mouldings about the frame on both sides")
    metal: str = material("brass", "cast_iron", "bronze", of="handles and hinges")
    material: str = material("oak", "pine", "walnut", "teak", "mahogany")


def _double_door(p: DoubleDoorParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("door frame", p.material, "static"))
    front, foot = -p.depth / 2, 0.016
    _frame(made.main, p.width, p.height, p.depth, foot=foot)
    _stops(made.main, p.width, foot, p.height, (front + p.leaf + 0.003, front + p.leaf + 0.025))
    if p.casing:
        _casing(made.main, p.width, p.height, p.depth)
    meet = _swing(p.leaf, p.width / 2) / 2
    state = int(rng.integers(2**31))
    for side, name, edges in ((-1, "left", (-p.width / 2 + 0.003, -meet)), (1, "right", (meet, p.width / 2 - 0.003))):
        leaf = _Leaf(*edges, foot + 0.005, p.height - 0.003, front, p.leaf, side)
        body = _leaf_body(leaf, p.style, p.material, p.metal, np.random.default_rng(state))
        _hang(made, name, body, leaf, p.open_deg, metal=p.metal)
    return made


class WindowParameters(Parameters):
    """A window: frame with sill, sashes with panes that open towards the front (-y), the inside."""

    width: float = Field(default=1.1, ge=0.4, le=2.0, description="clear width of the frame [m]")
    height: float = Field(default=1.3, ge=0.4, le=2.2, description="clear height of the frame [m]")
    depth: float = Field(default=0.12, ge=0.09, le=0.5, description="of the frame [m]")
    sashes: int = Field(default=2, ge=1, le=2, description="sashes side by side")
    columns: int = Field(default=2, ge=1, le=3, description="panes of a sash side by side")
    rows: int = Field(default=3, ge=1, le=4, description="panes of a sash one above the other")
    open_deg: float = Field(default=90.0, ge=45.0, le=115.0, description="how far they open [degrees]")
    sill: float = Field(default=0.08, ge=0.02, le=0.25, description="depth of the sill before the outer face, at the back [m]")
    metal: str = material("brass", "stainless_steel", "cast_iron", of="handles and hinges")
    material: str = material("pine", "oak", "larch", "aluminium_alloy", "pvc")


def _sash(leaf: _Leaf, p: WindowParameters) -> Body:
    body = Body("window sash", p.material)
    rim, bar = 0.05, 0.022
    x0, x1, z0, z1 = leaf.left + rim, leaf.right - rim, leaf.low + rim, leaf.high - rim
    body.box("stile_left", (leaf.left, leaf.front, leaf.low), (x0, leaf.back, leaf.high))
    body.box("stile_right", (x1, leaf.front, leaf.low), (leaf.right, leaf.back, leaf.high))
    body.box("rail_low", (x0, leaf.front, leaf.low), (x1, leaf.back, z0))
    body.box("rail_high", (x0, leaf.front, z1), (x1, leaf.back, leaf.high))
    columns = min(p.columns, max(1, int((x1 - x0) / 0.12)))
    rows = min(p.rows, max(1, int((z1 - z0) / 0.12)))
    wide, high = (x1 - x0 - (columns - 1) * bar) / columns, (z1 - z0 - (rows - 1) * bar) / rows
    y = (leaf.front + leaf.back) / 2
    for k in range(1, columns):
        x = x0 + k * wide + (k - 1) * bar
        body.box(f"upright_{k}", (x, y - 0.014, z0), (x + bar, y + 0.014, z1))
    for i in range(columns):
        x = x0 + i * (wide + bar)
        for j in range(rows):
            z = z0 + j * (high + bar)
            body.box(f"pane_{i + 1}_{j + 1}", (x, y - 0.002, z), (x + wide, y + 0.002, z + high), material="soda_lime_glass")
            if j:
                body.box(f"bar_{i + 1}_{j}", (x, y - 0.014, z - bar), (x + wide, y + 0.014, z))
    x, z = leaf.latch + leaf.hinged * 0.025, (leaf.low + leaf.high) / 2
    body.cylinder("rose", (x, leaf.front, z), (x, leaf.front - 0.006, z), 0.014, material=p.metal)
    path = [
        (x, leaf.front - 0.006, z),
        (x, leaf.front - 0.028, z),
        (x, leaf.front - 0.036, z - 0.01),
        (x, leaf.front - 0.036, z - 0.1),
    ]
    body.sweep("handle", path, circle(0.006, 8), material=p.metal)
    return body


def _window(p: WindowParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("window frame", p.material, "static"))
    foot, thick = JAMB, 0.045
    top, front = foot + p.height, -p.depth / 2
    _frame(made.main, p.width, top, p.depth, foot=foot)
    _stops(made.main, p.width, foot, top, (front + thick + 0.003, front + thick + 0.025))
    made.main.box(
        "stop_sill",
        (-p.width / 2 + 0.013, front + thick + 0.003, foot),
        (p.width / 2 - 0.013, front + thick + 0.025, foot + 0.013),
    )
    reach, out, y = p.width / 2 + JAMB, p.sill, p.depth / 2
    made.main.hull(
        "ledge",
        [
            (s * (reach + 0.03 * (d > y)), d, z)
            for s in (-1, 1)
            for d, zs in ((y, (0.0, 0.04)), (y + out, (0.0, 0.025)))
            for z in zs
        ],
    )
    board = front - 0.1
    made.main.box("board", (-reach - 0.04, board, 0), (reach + 0.04, front, 0.028))
    edges = [-p.width / 2 + 0.003, p.width / 2 - 0.003]
    if p.sashes == 1:
        edges[1] = p.width / 2 - _swing(thick, p.width)
        leaves = [("sash", _Leaf(edges[0], edges[1], foot + 0.003, top - 0.003, front, thick, -1))]
    else:
        meet = _swing(thick, p.width / 2) / 2
        leaves = [
            ("sash_left", _Leaf(edges[0], -meet, foot + 0.003, top - 0.003, front, thick, -1)),
            ("sash_right", _Leaf(meet, edges[1], foot + 0.003, top - 0.003, front, thick, 1)),
        ]
    for name, leaf in leaves:
        _hang(made, name, _sash(leaf, p), leaf, p.open_deg, metal=p.metal)
    made.places["board"] = Place((0, board + 0.05, 0.028), (2 * reach, 0.08))
    return made


GENERATORS = (
    Generator("door", "door in a static frame, its leaf with panels and handle on a hinge", DoorParameters, _door,
              ("entrance", "room", "house", "interior", "doorway", "opening", "building"), motion="static"),
    Generator("double_door", "door or gate of two hinged leaves in a static frame", DoubleDoorParameters, _double_door,
              ("entrance", "portal", "hall", "church", "castle", "barn", "gate", "opening", "building"), motion="static"),
    Generator("window", "window with glass panes in hinged sashes, a static frame and a sill", WindowParameters, _window,
              ("casement", "glass", "house", "opening", "building", "glazing"), motion="static"),
)  # fmt: skip
