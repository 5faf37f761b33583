"""Furniture to keep things in: wardrobes, cupboards, bookcases, filing cabinets, display cases."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import GAP, Style, carcass, cornice, door, drawer, feet, pick
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Joint, Made, Place

__all__ = ["GENERATORS"]

WOODS = ("oak", "walnut", "pine", "birch", "cherry_wood", "mahogany")
METALS = ("brass", "stainless_steel", "mild_steel", "bronze")
Handles = Literal["varied", "bar", "bow", "knob"]


class WardrobeParameters(Parameters):
    """A wardrobe: doors, a shelf, a clothes rail, and drawers below if wanted."""

    width: float = Field(default=1.2, ge=0.55, le=2.4, description="along x [m]")
    depth: float = Field(default=0.6, ge=0.45, le=0.7, description="along y [m]")
    height: float = Field(default=2.0, ge=1.6, le=2.4, description="along z [m]")
    doors: int = Field(default=2, ge=1, le=4, description="doors; fewer where they would be narrower than 0.28 m")
    drawers: bool = Field(default=True, description="drawers under the doors")
    handles: Handles = Field(default="varied", description="of doors and drawers")
    fronts: Literal["varied", "flat", "framed"] = Field(default="varied", description="of doors and drawers")
    metal: str = material(*METALS, of="handles")
    material: str = material(*WOODS)


def _wardrobe(p: WardrobeParameters, rng: np.random.Generator) -> Made:
    body, thick, rise, crown = Body("wardrobe", p.material), 0.02, 0.08, 0.06
    style = Style(p.material, "birch", p.metal, pick(p.handles, rng, "bar", "bow", "knob"), pick(p.fronts, rng, "flat", "framed"))
    made, reach = Made.of(body), float(rng.uniform(0.01, 0.03))
    x, high = p.width / 2 - reach - 0.006, p.height - crown
    front, back = -p.depth / 2 + reach + 0.006 + style.thick, p.depth / 2
    carcass(body, (-x, front, rise), (x, back, high), thick)
    feet(body, "plinth", (2 * x, p.depth - 0.04), rise)
    cornice(body, (-x, front, high), (x, back, p.height), reach + style.thick)
    doors = max(1, min(p.doors, int(2 * x / 0.28)))
    wide, floor = (2 * x - (doors - 1) * GAP) / doors, rise + thick
    lower, bays = rise + 0.002, -(-doors // 2)
    if p.drawers:
        floor = rise + thick + 0.2
        lower = floor + thick / 2 + GAP / 2
        floor += thick
    for bay in range(bays):
        pair = min(2, doors - 2 * bay)
        first = -x + 2 * bay * (wide + GAP)
        left = -x + thick if bay == 0 else first - GAP / 2 + thick / 2
        last = bay == bays - 1
        right = x - thick if last else first + 2 * (wide + GAP) - GAP / 2 - thick / 2
        inside = (left, right, front, back - 0.006)
        _bay(made, p, f"{bay + 1}", inside, (floor, high - thick))
        if not last:
            body.box(f"divider_{bay + 1}", (right, front, rise + thick), (right + thick, back - 0.006, high - thick))
        if p.drawers:
            body.box(f"deck_{bay + 1}", (left, front, floor - thick), (right, back - 0.006, floor))
            cover = (first, first + pair * wide + (pair - 1) * GAP, rise + 0.002, floor - thick / 2 - GAP / 2)
            drawer(made, f"drawer_{bay + 1}", cover, (left, right, rise + thick, floor - thick), inside[2:], style)
        for k in range(pair):
            a = first + k * (wide + GAP)
            side: Literal["left", "right"] = "right" if k == 1 else "left"
            door(
                made, f"door_{2 * bay + k + 1}", (a, a + wide, lower, high - 0.004), front - 0.0015, style, hinge=side, grip=0.48
            )
    return made


def _bay(
    made: Made, p: WardrobeParameters, name: str, inside: tuple[float, float, float, float], levels: tuple[float, float]
) -> None:
    """A shelf with a clothes rail under it between two upright boards, in a room of least and greatest x and y [m]."""
    x0, x1, y0, y1 = inside
    shelf = levels[1] - 0.32
    body, middle = made.main, (y0 + y1) / 2
    body.box(f"shelf_{name}", (x0, y0 + 0.03, shelf), (x1, y1, shelf + 0.018))
    body.cylinder(f"clothes_rail_{name}", (x0, middle, shelf - 0.06), (x1, middle, shelf - 0.06), 0.0125, material=p.metal)
    made.places[f"shelf_{name}"] = Place(((x0 + x1) / 2, middle, shelf + 0.018), (x1 - x0 - 0.02, y1 - y0 - 0.06), 0.3)
    made.places[f"inside_{name}"] = Place(
        ((x0 + x1) / 2, middle, levels[0]), (x1 - x0 - 0.02, y1 - y0 - 0.04), shelf - levels[0] - 0.08
    )


class BookcaseParameters(Parameters):
    """A bookcase: shelves between two sides before a back, with a face frame and a cornice."""

    width: float = Field(default=0.9, ge=0.4, le=1.8, description="along x [m]")
    depth: float = Field(default=0.3, ge=0.2, le=0.45, description="along y [m]")
    height: float = Field(default=1.8, ge=0.7, le=2.4, description="along z [m]")
    shelves: int = Field(
        default=4, ge=1, le=7, description="shelves between the bottom and the top; fewer where books of 0.2 m would not fit"
    )
    back: bool = Field(default=True, description="a panel at the back")
    frame: Literal["varied", "plain", "faced", "cornice"] = Field(
        default="varied", description="plain boards; strips before their edges; or with a cornice as well"
    )
    base: Literal["closed", "open"] = Field(
        default="closed", description="a kick board under the lowest shelf, or open room there, into which small things roll"
    )
    rise: float = Field(default=0.07, ge=0.05, le=0.2, description="from the floor to the lowest shelf [m]")
    material: str = material(*WOODS)


def _bookcase(p: BookcaseParameters, rng: np.random.Generator) -> Made:
    body, frame = Body("bookcase", p.material), pick(p.frame, rng, "plain", "faced", "cornice")
    made, thick, rise, closed = Made.of(body), 0.022, p.rise, p.base == "closed"
    crown = 0.05 if frame == "cornice" else 0.0
    reach = 0.02 if crown else 0.0
    strip = 0.0 if frame == "plain" else 0.016
    more = reach + 0.006 if crown else 0.0
    x, front, back, high = p.width / 2 - more, -p.depth / 2 + strip + more, p.depth / 2, p.height - crown
    body.box("side_left", (-x, front, 0), (-x + thick, back, high))
    body.box("side_right", (x - thick, front, 0), (x, back, high))
    inner, rear = x - thick, back - (0.006 if p.back else 0.0)
    if closed:
        body.box("kick", (-inner, front + 0.02, 0), (inner, front + 0.038, rise))
    if p.back:
        body.box("back", (-inner, rear, rise), (inner, back, high))
    board = min(0.034, max(0.018, 2 * inner / 42))
    count = max(1, min(p.shelves, int((high - rise) / 0.22) - 1))
    weights = 1 + 0.18 * rng.uniform(-1, 1, count + 1)
    room = high - rise - (count + 2) * board
    level = rise
    for number in range(count + 2):
        name = "bottom" if number == 0 else "top_board" if number == count + 1 else f"shelf_{number}"
        body.box(name, (-inner, front, level), (inner, rear, level + board))
        level += board
        if number <= count:
            free = room * float(weights[number] / weights.sum())
            made.places["bottom" if number == 0 else f"shelf_{number}"] = Place(
                (0, (front + rear) / 2, level), (2 * inner, rear - front), free
            )
            level += free
    if strip:
        wide = 0.045
        body.box("face_left", (-x, front - strip, 0), (-x + wide, front, high))
        body.box("face_right", (x - wide, front - strip, 0), (x, front, high))
        body.box("face_top", (-x + wide, front - strip, high - 0.06), (x - wide, front, high))
        foot = 0.0 if closed else rise
        body.box("face_bottom", (-x + wide, front - strip, foot), (x - wide, front, rise + 0.5 * board))
    if crown:
        cornice(body, (-x, front - strip, high), (x, back, p.height), reach)
    made.places["top"] = Place((0, (front + back) / 2, p.height), (2 * x, back - front))
    return made


class CupboardParameters(Parameters):
    """A cupboard with two hinged doors and shelves within."""

    width: float = Field(default=0.9, ge=0.5, le=1.4, description="along x [m]")
    depth: float = Field(default=0.42, ge=0.28, le=0.6, description="along y [m]")
    height: float = Field(default=1.2, ge=0.6, le=2.1, description="along z [m]")
    shelves: int = Field(default=2, ge=0, le=5, description="shelves within; fewer where they would be closer than 0.16 m")
    feet: Literal["varied", "legs", "plinth"] = Field(default="varied", description="on which it stands")
    handles: Handles = Field(default="varied", description="of the doors")
    fronts: Literal["varied", "flat", "framed", "glazed"] = Field(default="varied", description="of the doors")
    metal: str = material(*METALS, of="handles")
    material: str = material(*WOODS)


def _cupboard(p: CupboardParameters, rng: np.random.Generator) -> Made:
    body, thick = Body("cupboard", p.material), 0.02
    panel = pick(p.fronts, rng, "flat", "framed", "framed", "glazed")
    style = Style(p.material, "birch", p.metal, pick(p.handles, rng, "bar", "bow", "knob"), panel)
    made, stand = Made.of(body), pick(p.feet, rng, "legs", "plinth")
    rise = 0.14 if stand == "legs" else 0.07
    x, high = p.width / 2 - 0.02, p.height - 0.026
    front, back = -p.depth / 2 + 0.015 + style.thick, p.depth / 2
    carcass(body, (-x, front, rise), (x, back, high), thick)
    feet(body, stand, (2 * x, p.depth - 0.05), rise)
    body.box("slab", (-p.width / 2, -p.depth / 2, high + 0.006), (p.width / 2, back, p.height))
    body.box("moulding", (-x - 0.008, front - style.thick - 0.004, high), (x + 0.008, back, high + 0.006))
    inside, rear = x - thick, back - 0.006
    levels = high - rise - 2 * thick
    count = max(0, min(p.shelves, int(levels / 0.18) - 1))
    pitch = levels / (count + 1)
    for number in range(count + 1):
        floor = rise + thick + number * pitch
        if number:
            body.box(f"shelf_{number}", (-inside, front + 0.03, floor - 0.016), (inside, rear, floor))
        name = f"shelf_{number}" if number else "bottom"
        free = pitch - (0.016 if number < count else 0)
        made.places[name] = Place((0, (front + rear) / 2 + 0.015, floor), (2 * inside - 0.02, rear - front - 0.04), free)
    rects = (("left", -x, -GAP / 2), ("right", GAP / 2, x))
    for side, a, b in rects:
        hinge: Literal["left", "right"] = "left" if side == "left" else "right"
        door(made, f"door_{side}", (a, b, rise + 0.002, high - GAP), front - 0.0015, style, hinge=hinge, grip=0.6)
    made.places["top"] = Place((0, 0, p.height), (p.width, p.depth))
    return made


class FilingCabinetParameters(Parameters):
    """A filing cabinet of sheet steel with deep drawers."""

    width: float = Field(default=0.46, ge=0.38, le=0.6, description="along x [m]")
    depth: float = Field(default=0.62, ge=0.45, le=0.75, description="along y [m]")
    drawers: int = Field(default=4, ge=2, le=5, description="drawers, one above the other")
    drawer: float = Field(default=0.31, ge=0.2, le=0.34, description="height of a drawer [m]")
    handles: Literal["varied", "bar", "bow"] = Field(default="varied", description="of the drawers")
    metal: str = material("stainless_steel", "brass", "mild_steel", of="handles")
    material: str = material("mild_steel", "aluminium_alloy", "zinc")


def _filing_cabinet(p: FilingCabinetParameters, rng: np.random.Generator) -> Made:
    body, sheet, rise = Body("filing cabinet", p.material), 0.0015, 0.05
    style = Style(p.material, p.material, p.metal, pick(p.handles, rng, "bar", "bow"), "pressed", 0.018, 0.003)
    made, high = Made.of(body), rise + p.drawers * p.drawer + 0.03
    x, front, back = p.width / 2, -p.depth / 2 + style.thick, p.depth / 2
    carcass(body, (-x, front, rise), (x, back, high), sheet)
    body.box("cap", (-x, front - style.thick, high), (x, back, high + 0.02))
    feet(body, "plinth", (2 * x, p.depth - 0.03), rise)
    body.box("weight", (-x + 0.03, back - 0.12, rise + sheet), (x - 0.03, back - 0.008, rise + 0.012))
    for number in range(p.drawers):
        z0 = rise + 0.014 + number * p.drawer
        z1 = z0 + p.drawer
        if number:
            body.box(f"rail_{number}", (-x + sheet, front, z0 - 0.008), (x - sheet, front + 0.02, z0 + 0.008))
        name = f"drawer_{p.drawers - number}"
        cover, own = (-x, x, z0 + 0.002, z1 - 0.002), (-x + sheet, x - sheet, z0 + 0.009, z1 - 0.009)
        drawer(made, name, cover, own, (front, back - 0.006), style)
        label = made.bodies[name]
        face, at = front - 0.0015 - style.thick, z0 + 0.78 * p.drawer
        label.box("card", (-0.035, face - 0.001, at - 0.016), (0.035, face, at + 0.016), material="cardboard")
        label.box("card_holder", (-0.04, face - 0.003, at - 0.02), (0.04, face, at - 0.016), material=p.metal)
    made.places["top"] = Place((0, 0, high + 0.02), (p.width - 0.02, p.depth - 0.02))
    return made


class DisplayCaseParameters(Parameters):
    """A display case as in a museum: panes of glass on a plinth; the front pane is a door."""

    width: float = Field(default=0.8, ge=0.4, le=1.6, description="along x [m]")
    depth: float = Field(default=0.5, ge=0.4, le=0.9, description="along y [m]")
    base: float = Field(default=0.85, ge=0.4, le=1.0, description="height of the deck on which exhibits lie [m]")
    glass: float = Field(default=0.5, ge=0.25, le=1.2, description="height of the panes over the deck [m]")
    pane: float = Field(default=0.008, ge=0.005, le=0.012, description="thickness of the panes [m]")
    stand: Literal["varied", "plinth", "legs"] = Field(default="varied", description="below the deck")
    metal: str = material("brass", "bronze", "aluminium_alloy", "stainless_steel", of="corner posts and hinges")
    material: str = material("walnut", "oak", "mahogany", "mdf")


def _display_case(p: DisplayCaseParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("display case", p.material)), Made.of(own)
    x, y, deck, post, t = p.width / 2, p.depth / 2, p.base - 0.03, 0.014, p.pane
    body.box("deck", (-x, -y, deck), (x, y, p.base))
    body.box("lining", (-x + 0.03, -y + 0.03, p.base), (x - 0.03, y - 0.03, p.base + 0.002), material="felt")
    if pick(p.stand, rng, "plinth", "legs") == "legs":
        for number, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
            at = (sx * (x - 0.035), sy * (y - 0.035))
            body.taper(f"leg_{number}", (*at, 0), (*at, deck - 0.09), (0.03, 0.03), (0.05, 0.05))
        body.box("apron", (-x + 0.01, -y + 0.01, deck - 0.09), (x - 0.01, y - 0.01, deck))
    else:
        body.box("kick", (-x + 0.04, -y + 0.04, 0), (x - 0.04, y - 0.04, 0.08))
        body.box("plinth_floor", (-x + 0.01, -y + 0.01, 0.08), (x - 0.01, y - 0.01, 0.1))
        for side, a in (("left", -x + 0.01), ("right", x - 0.03)):
            body.box(f"plinth_{side}", (a, -y + 0.03, 0.1), (a + 0.02, y - 0.03, deck))
        for side, b in (("front", -y + 0.01), ("back", y - 0.03)):
            body.box(f"plinth_{side}", (-x + 0.01, b, 0.1), (x - 0.01, b + 0.02, deck))
        inner = x - 0.09
        foot = [(a, -y + 0.01, z) for a in (-inner, inner) for z in (0.14, deck - 0.06)]
        body.hull(
            "plinth_panel", [*foot, *((a, -y + 0.003, z) for a in (-inner + 0.02, inner - 0.02) for z in (0.16, deck - 0.08))]
        )
    low, high = p.base, p.base + p.glass
    for number, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1)), start=1):
        at = (sx * (x - post / 2), sy * (y - post / 2))
        corners = [(at[0] + s * post / 2, at[1] + s * post / 2) for s in (-1, 1)]
        body.box(f"post_{number}", (*corners[0], low), (*corners[1], high), material=p.metal)
    glass = "soda_lime_glass"
    body.box("pane_back", (-x + post, y - t, low), (x - post, y, high), material=glass)
    for side, a in (("left", -x), ("right", x - t)):
        body.box(f"pane_{side}", (a, -y + post, low), (a + t, y - post, high), material=glass)
    body.box("lid", (-x, -y, high), (x, y, high + t), material=glass)
    rect = (-x + post + GAP, x - post - GAP, low + 0.002, high - 0.002)
    pane = made.bodies["door"] = Body("door", glass)
    pane.box("pane", (rect[0], -y, rect[2]), (rect[1], -y + t, rect[3]))
    pane.cylinder(
        "lock", (rect[1] - 0.03, -y, (low + high) / 2), (rect[1] - 0.03, -y - 0.018, (low + high) / 2), 0.011, material=p.metal
    )
    made.joints["door"] = Joint(
        "door", "hinge", (rect[0], -y, (low + high) / 2), MAIN, axis=(0, 0, -1), range=(0.0, 1.9), damping=0.5, friction=0.5
    )
    made.places["inside"] = Place((0, 0, low + 0.002), (2 * x - 0.08, 2 * y - 0.08), p.glass - 0.002)
    return made


GENERATORS = (
    Generator(
        "wardrobe", "wardrobe with hinged doors, a clothes rail, and drawers that slide out", WardrobeParameters, _wardrobe,
        ("closet", "armoire", "clothes", "bedroom", "furniture", "storage"),
    ),
    Generator(
        "bookcase", "bookcase with shelves between two sides", BookcaseParameters, _bookcase,
        ("bookshelf", "shelf", "shelves", "library", "study", "furniture", "storage", "shelving"),
    ),
    Generator(
        "cupboard", "cupboard with two hinged doors and shelves within", CupboardParameters, _cupboard,
        ("cabinet", "sideboard", "dresser", "storage", "furniture", "vitrine", "hutch"),
    ),
    Generator(
        "filing_cabinet", "steel cabinet with deep drawers that slide out", FilingCabinetParameters, _filing_cabinet,
        ("office", "file", "storage", "furniture", "drawers"),
    ),
    Generator(
        "display_case", "glass case on a plinth, its front pane is a door", DisplayCaseParameters, _display_case,
        ("vitrine", "museum", "showcase", "exhibit", "glass", "shop", "furniture"),
    ),
)  # fmt: skip
