"""Pianos and their stools."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import pick, stacked
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Joint, Made, Place

__all__ = ["GENERATORS"]

KEY = 0.0235
"""[m] Pitch of the white keys."""
BLACK = (0, 1, 3, 4, 5)
"""White keys of an octave from C that have a black one to their right."""


class PianoParameters(Parameters):
    """An upright piano: case, keys, pedals, a fall board and a top lid on hinges."""

    octaves: int = Field(default=7, ge=4, le=7, description="octaves of keys, from C to C; the case is as wide")
    height: float = Field(default=1.24, ge=1.08, le=1.36, description="to the top [m]")
    depth: float = Field(default=0.62, ge=0.6, le=0.7, description="along y with the keyboard [m]; one plays at -y")
    keys: float = Field(default=0.73, ge=0.7, le=0.75, description="height of the upper side of the white keys [m]")
    fall: Literal["open", "closed"] = Field(default="open", description="the board over the keys at first")
    panels: Literal["varied", "plain", "framed"] = Field(default="varied", description="front of the case")
    metal: str = material("brass", "bronze", "stainless_steel", of="pedals, hinges and castors")
    material: str = material("mahogany", "walnut", "oak", "cherry_wood", "abs")


def _piano(p: PianoParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("piano", p.material)), Made.of(own)
    whites = 7 * p.octaves + 1
    half, cheek, board = whites * KEY / 2 + 0.03, 0.03, 0.035
    x = half + cheek
    back, front = p.depth / 2, -p.depth / 2
    face = back - 0.34
    top = p.height - 0.02
    for name, sign in (("left", -1), ("right", 1)):
        a, b = sorted((sign * half, sign * x))
        body.box(f"side_{name}", (a, face, 0.03), (b, back, top))
        arm = [
            (front, p.keys - 0.1),
            (face, p.keys - 0.1),
            (face, p.keys + 0.12),
            (face - 0.07, p.keys + 0.12),
            (front + 0.03, p.keys + 0.03),
            (front, p.keys + 0.005),
        ]
        body.prism(f"cheek_{name}", arm, a, b, axis="x")
        leg = sign * (half + cheek / 2)
        profile = [(0.026, 0.05), (0.03, 0.09), (0.018, 0.13), (0.026, 0.4), (0.016, p.keys - 0.14), (0.028, p.keys - 0.1)]
        shift = 0.015 * sign
        stacked(body, f"leg_{name}", profile, (leg - shift, front + 0.06, 0))
        body.box(f"shoe_{name}", (a - 0.008, front + 0.02, 0.03), (b + 0.008, face, 0.05))
        for end, c in (("front", front + 0.06), ("back", back - 0.06)):
            body.cylinder(f"castor_{name}_{end}", (leg - 0.009, c, 0.015), (leg + 0.009, c, 0.015), 0.015, material=p.metal)
    body.box("back", (-half, back - 0.02, 0.1), (half, back, top))
    body.box("bottom", (-half, face, 0.08), (half, back - 0.02, 0.1))
    body.box("key_bed", (-half, front, p.keys - 0.06), (half, face + 0.12, p.keys - 0.06 + board))
    _keys(body, p, whites, front)
    for name, sign in (("left", -1), ("right", 1)):
        a, b = sorted((sign * whites * KEY / 2, sign * half))
        body.box(f"key_block_{name}", (a, front, p.keys - 0.025), (b, front + 0.16, p.keys + 0.002))
    framed = pick(p.panels, rng, "plain", "framed") == "framed"
    _front(body, p, "lower", (half, face, 0.1, p.keys - 0.06), framed=framed)
    _front(body, p, "upper", (half, face + 0.05, p.keys + 0.055, top), framed=framed)
    body.box("name_board", (-half, front + 0.2, p.keys + 0.04), (half, face + 0.05, p.keys + 0.055))
    desk = face + 0.05
    body.box("desk", (-0.36, desk - 0.06, p.keys + 0.13), (0.36, desk, p.keys + 0.142))
    body.box("desk_lip", (-0.36, desk - 0.06, p.keys + 0.142), (0.36, desk - 0.053, p.keys + 0.158))
    _pedals(body, p, face)
    _lids(made, p, (x, half), (front, face, back, top))
    made.places["desk"] = Place((0, desk - 0.027, p.keys + 0.142), (0.7, 0.05), p.height - p.keys - 0.2)
    return made


def _keys(body: Body, p: PianoParameters, whites: int, front: float) -> None:
    """White keys with black ones on them, from C to C."""
    low, start, end = p.keys - 0.025, front + 0.015, front + 0.16
    for number in range(whites):
        a = (number - whites / 2) * KEY
        body.box(f"white_{number + 1}", (a + 0.0005, start, low), (a + KEY - 0.0005, end, p.keys), material="porcelain")
        if number % 7 in BLACK and number < whites - 1:
            b, c = a + KEY - 0.0055, a + KEY + 0.0055
            foot = [(u, v, p.keys) for u in (b, c) for v in (start + 0.05, end)]
            head = [(u, v, p.keys + 0.011) for u in (b + 0.001, c - 0.001) for v in (start + 0.057, end)]
            body.hull(f"black_{number + 1}", [*foot, *head], material="abs")


def _front(body: Body, p: PianoParameters, name: str, rect: tuple[float, float, float, float], *, framed: bool) -> None:
    """A panel of the case from its half width, y of its face, and its least and greatest z [m]; framed with raised fields."""
    x, y, z0, z1 = rect
    body.box(f"{name}_panel", (-x, y, z0), (x, y + 0.018, z1))
    if not framed:
        return
    count = 3 if name == "upper" else 2
    for number in range(count):
        a, b = (-x + 0.04 + (2 * x - 0.08) * (number + k) / count for k in (0, 1))
        a, b, low, high = a + 0.012, b - 0.012, z0 + 0.1, z1 - 0.05
        foot = [(u, y, v) for u in (a, b) for v in (low, high)]
        body.hull(
            f"{name}_field_{number + 1}",
            [*foot, *((u, y - 0.01, v) for u in (a + 0.02, b - 0.02) for v in (low + 0.02, high - 0.02))],
        )


def _pedals(body: Body, p: PianoParameters, face: float) -> None:
    """Two pedals of metal that stand out of the lower panel."""
    for number, a in enumerate((-0.06, 0.06), start=1):
        path = [(a, face, 0.13), (a, face - 0.04, 0.13), (a, face - 0.14, 0.115)]
        body.sweep(
            f"pedal_{number}",
            path,
            [(-0.014, -0.005), (0.014, -0.005), (0.014, 0.005), (-0.014, 0.005)],
            scales=[0.7, 0.7, 1.3],
            material=p.metal,
        )


def _lids(made: Made, p: PianoParameters, halves: tuple[float, float], depths: tuple[float, float, float, float]) -> None:
    """The fall board over the keys and the lid of the case, each on a hinge at its back."""
    (x, half), (front, face, back, top) = halves, depths
    lid = made.bodies["lid"] = Body("lid", p.material)
    edge, z = face - 0.015, top + 0.0015
    rim = [(edge, z), (back, z), (back, p.height), (edge + 0.006, p.height), (edge, p.height - 0.006)]
    lid.prism("board", rim, -x - 0.015, x + 0.015, axis="x")
    made.joints["lid"] = Joint(
        "lid", "hinge", (0, back - 0.001, top + 0.001), MAIN, axis=(-1, 0, 0), range=(0.0, 1.7), damping=0.5, friction=0.5
    )
    made.places["top"] = Place((0, (edge + back) / 2, p.height), (2 * x, back - edge), body="lid")
    fall = made.bodies["fall"] = Body("fall board", p.material)
    pivot, z0, reach, wide, angle = front + 0.18, p.keys + 0.035, 0.15, half - 0.002, 1.75
    shell = [(0.0, -0.008), (0.0, 0.008), (-reach, -0.004), (-reach, -0.02)]
    lip = [(-reach, -0.004), (-reach - 0.014, -0.008), (-reach - 0.014, -0.03), (-reach, -0.03)]
    c, s = (math.cos(angle), math.sin(angle)) if p.fall == "open" else (1.0, 0.0)
    for part, outline in (("board", shell), ("lip", lip)):
        fall.prism(part, [(pivot + c * b + s * h, z0 - s * b + c * h) for b, h in outline], -wide, wide, axis="x")
    reach_range = (-angle, 0.0) if p.fall == "open" else (0.0, angle)
    made.joints["fall"] = Joint(
        "fall", "hinge", (0, pivot, z0), MAIN, axis=(-1, 0, 0), range=reach_range, damping=0.5, friction=0.5
    )


class PianoStoolParameters(Parameters):
    """A round piano stool whose padded seat turns on a column with curved feet."""

    seat: float = Field(default=0.5, ge=0.42, le=0.58, description="height of the seat [m]")
    diameter: float = Field(default=0.34, ge=0.3, le=0.4, description="of the seat [m]")
    feet: int = Field(default=3, ge=3, le=5, description="feet around the column")
    cover: str = material("leather", "wool", "carpet", of="the seat")
    material: str = material("mahogany", "walnut", "oak", "beech")


def _piano_stool(p: PianoStoolParameters, rng: np.random.Generator) -> Made:
    body, made = (own := Body("piano stool", p.material)), Made.of(own)
    low, high = 0.14, p.seat - 0.115
    swell = float(rng.uniform(0.9, 1.25))
    profile = [
        (0.02, low - 0.03),
        (0.045, low),
        (0.045, low + 0.05),
        (0.026, low + 0.07),
        (0.04 * swell, 0.55 * (low + high)),
        (0.026, high - 0.03),
        (0.036, high),
    ]
    stacked(body, "column", profile, segments=8 * p.feet)
    start = math.pi / (8 * p.feet)
    for number in range(p.feet):
        turn = start + math.tau * number / p.feet
        c, s = math.cos(turn), math.sin(turn)
        curve = [
            (0.045 * math.cos(start), low + 0.025),
            (0.065, low + 0.025),
            (0.1, low + 0.022),
            (0.17, low - 0.03),
            (0.21, 0.035),
            (0.235, 0.016),
            (0.26, 0.016),
        ]
        path = [(r * c, r * s, z) for r, z in curve]
        body.sweep(f"foot_{number + 1}", path, [(-0.012, -0.016), (0.012, -0.016), (0.012, 0.016), (-0.012, 0.016)])
    seat = made.bodies["seat"] = Body("seat", p.material)
    radius, z = p.diameter / 2, high + 0.001
    seat.turned("boss", [(0, z), (0.05, z), (0.03, z + 0.03), (0, z + 0.03)], segments=24)
    seat.turned(
        "plate", [(0, z + 0.03), (radius - 0.01, z + 0.03), (radius, z + 0.04), (radius, z + 0.06), (0, z + 0.06)], segments=40
    )
    rim, base = p.seat - 0.022, z + 0.06
    seat.turned(
        "padding", [(0, base), (radius - 0.012, base), (radius - 0.012, rim), (0, rim)], segments=24, material="soft_foam"
    )
    band = [
        (radius - 0.012, base),
        (radius - 0.006, base),
        (radius - 0.002, (base + rim) / 2),
        (radius - 0.006, rim),
        (radius - 0.012, rim),
    ]
    seat.turned("cover", band, segments=24, material=p.cover)
    dome = [(0, rim), (radius - 0.006, rim), (0.85 * radius, rim + 0.012), (0.5 * radius, p.seat), (0, p.seat)]
    seat.turned("cover_top", dome, segments=24, material=p.cover)
    made.joints["seat"] = Joint("seat", "hinge", (0, 0, z), MAIN, axis=(0, 0, 1), damping=0.05, friction=0.3)
    made.places["seat"] = Place((0, 0, p.seat), (radius, radius), body="seat")
    return made


GENERATORS = (
    Generator(
        "upright_piano", "upright piano with keys, pedals, and a lid and a fall board on hinges", PianoParameters, _piano,
        ("music", "instrument", "keyboard", "furniture", "living"),
    ),
    Generator(
        "piano_stool", "round stool whose padded seat turns", PianoStoolParameters, _piano_stool, ("seat", "music", "stool", "furniture"),
    ),
)  # fmt: skip
