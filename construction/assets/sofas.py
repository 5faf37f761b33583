"""Upholstered seats: sofas and armchairs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from pydantic import Field

from .cabinetry import pick
from .generator import Generator, Parameters, material
from .made import Body, Made, Place, Point
from .profiles import arc, rounded
from .upholstery import covered, padded

__all__ = ["GENERATORS"]

LEG, CUSHION = 0.12, 0.15
"""[m] Height of the legs and thickness of the seat's cushions."""


class SofaParameters(Parameters):
    """A sofa: an upholstered frame on legs with cushions to sit on and to lean against."""

    width: float = Field(default=2.0, ge=1.3, le=2.8, description="along x [m]")
    depth: float = Field(default=0.9, ge=0.75, le=1.05, description="along y [m]; one sits looking to -y")
    seat: float = Field(default=0.43, ge=0.38, le=0.48, description="height of the seat [m]")
    height: float = Field(default=0.84, ge=0.7, le=1.0, description="to the top of the back [m]")
    arm: float = Field(default=0.16, ge=0.1, le=0.24, description="width of an arm [m]")
    seats: int = Field(default=3, ge=2, le=3, description="cushions side by side; fewer where they would be narrower than 0.45 m")
    arms: Literal["varied", "square", "rolled", "sloping"] = Field(default="varied", description="shape of the arms")
    wood: str = material("oak", "walnut", "beech", "mild_steel", of="legs")
    material: str = material("wool", "linen", "leather", "felt", "cotton", "carpet")


class ArmchairParameters(Parameters):
    """An armchair: upholstered, or cushions in an open frame of wood."""

    width: float = Field(default=0.82, ge=0.68, le=1.1, description="along x [m]")
    depth: float = Field(default=0.84, ge=0.72, le=1.0, description="along y [m]; one sits looking to -y")
    seat: float = Field(default=0.42, ge=0.38, le=0.47, description="height of the seat [m]")
    height: float = Field(default=0.86, ge=0.75, le=1.1, description="to the top of the back [m]")
    arms: Literal["varied", "square", "rolled", "sloping", "open"] = Field(
        default="varied", description="shape of the arms; open: of wood"
    )
    wood: str = material("oak", "walnut", "beech", "teak", of="legs, and of an open frame")
    material: str = material("wool", "linen", "leather", "felt", "cotton", "carpet")


class _Frame(NamedTuple):
    """Sizes of an upholstered seat [m]."""

    width: float
    depth: float
    seat: float
    height: float
    arm: float
    seats: int
    wood: str
    cover: str


def _sofa(p: SofaParameters, rng: np.random.Generator) -> Made:
    arm = min(p.arm, 0.14 * p.width)
    seats = max(1, min(p.seats, int((p.width - 2 * arm) / 0.45)))
    frame = _Frame(p.width, p.depth, p.seat, p.height, arm, seats, p.wood, p.material)
    return _upholstered("sofa", frame, pick(p.arms, rng, "square", "rolled", "sloping"), rng)


def _armchair(p: ArmchairParameters, rng: np.random.Generator) -> Made:
    arms = pick(p.arms, rng, "square", "rolled", "sloping", "open", "open")
    frame = _Frame(p.width, p.depth, p.seat, p.height, min(0.15, 0.17 * p.width), 1, p.wood, p.material)
    return _open_frame(frame, rng) if arms == "open" else _upholstered("armchair", frame, arms, rng)


def _block(x: tuple[float, float], y: tuple[float, float], z: float) -> list[Point]:
    return [(x[0], y[0], z), (x[1], y[0], z), (x[1], y[1], z), (x[0], y[1], z)]


def _legs(body: Body, p: _Frame, kind: str) -> None:
    """Four legs, and two more in the middle of a long seat."""
    x, y = p.width / 2 - 0.05, p.depth / 2 - 0.06
    feet: Sequence[float] = (-x, x) if p.width < 1.7 else (-x, 0.0, x)
    for number, (a, b) in enumerate(((a, b) for a in feet for b in (-y, y)), start=1):
        if kind == "turned":
            body.turned(
                f"leg_{number}",
                [(0, 0), (0.016, 0), (0.026, 0.1), (0.022, LEG), (0, LEG)],
                (a, b, 0),
                segments=16,
                material=p.wood,
            )
        else:
            body.taper(f"leg_{number}", (1.02 * a, 1.04 * b, 0), (a, b, LEG), (0.03, 0.03), (0.05, 0.05), material=p.wood)


def _upholstered(role: str, p: _Frame, arms: str, rng: np.random.Generator) -> Made:
    body = Body(role, p.cover)
    made, deck, tilt = Made.of(body), p.seat - CUSHION, math.radians(float(rng.uniform(9, 15)))
    _legs(body, p, str(rng.choice(["turned", "square"])))
    x, y = p.width / 2, p.depth / 2
    inner, rise, back = x - p.arm, (p.height - deck) * math.tan(tilt), 0.14
    covered(body, "base", _block((-inner, inner), (-y, y), LEG), _block((-inner, inner), (-y, y), deck), p.cover)
    low = y - back - rise
    covered(
        body, "back",
        _block((-inner, inner), (low, low + back), deck), _block((-inner, inner), (low + rise, y), p.height), p.cover,
    )  # fmt: skip
    level = p.seat + float(rng.uniform(0.14, 0.22))
    for name, sign in (("left", -1), ("right", 1)):
        _arm(body, f"arm_{name}", sign, arms, p, min(level, p.height - 0.08))
    wide, long = 2 * inner / p.seats, low + y - 0.01
    for number in range(p.seats):
        middle = -inner + wide * (number + 0.5)
        at = (middle, -y + 0.01 + long / 2, deck + CUSHION / 2)
        padded(body, f"seat_{number + 1}", at, (wide, long, CUSHION), p.cover)
        high = (p.height - p.seat) / math.cos(tilt) + 0.01
        _leaning(body, f"cushion_{number + 1}", (middle, low, deck), (wide, high, 0.16), (CUSHION, tilt), p.cover)
    made.places["seat"] = Place((-inner + wide / 2, -y + 0.3 * long, p.seat), (0.5 * wide, 0.4 * long))
    return made


def _arm(body: Body, name: str, sign: int, kind: str, p: _Frame, level: float) -> None:
    """An arm of a sofa: a block, with a roll on it, or one that falls towards the front."""
    y = p.depth / 2
    x: tuple[float, float] = (-p.width / 2, -p.width / 2 + p.arm) if sign < 0 else (p.width / 2 - p.arm, p.width / 2)
    foot = _block(x, (-y, y), LEG)
    if kind == "sloping":
        head = [(a, b, level + 0.06 if b > 0 else level - 0.05) for a, b, _ in foot]
        covered(body, name, foot, head, p.cover)
        return
    if kind == "square":
        covered(body, name, foot, _block(x, (-y, y), level), p.cover)
        return
    radius = 0.56 * p.arm
    middle, top = (x[0] + x[1]) / 2 + sign * max(0.012, 0.065 * p.arm), level - 1.75 * radius
    covered(body, name, foot, _block(x, (-y, y), top), p.cover)
    start, end = -0.27 * math.pi, 1.27 * math.pi
    center = (middle, top + radius * math.sin(0.27 * math.pi))
    outer = arc(center, radius, start, end, 10)
    thin = 1 - 0.006 / radius
    inside = [
        (middle + thin * (a - middle), top if k in (0, 10) else center[1] + thin * (b - center[1]))
        for k, (a, b) in enumerate(outer)
    ]
    body.prism(f"{name}_roll_core", inside, -y + 0.006, y, axis="y", material="rigid_foam")
    body.prism(f"{name}_roll", [*outer, *inside[::-1]], -y + 0.006, y, axis="y")
    body.prism(f"{name}_roll_end", outer, -y, -y + 0.006, axis="y")


def _open_frame(p: _Frame, rng: np.random.Generator) -> Made:
    """Two side frames of wood with broad arms, rails and slats between them, and two cushions."""
    body = Body("armchair", p.wood)
    made, deck, tilt = Made.of(body), p.seat - 0.122, math.radians(float(rng.uniform(12, 18)))
    x, y, post = p.width / 2 - 0.04, p.depth / 2, 0.04
    rise = (p.height - deck) * math.tan(tilt)
    front, rear, level = -y + 0.06, y - rise - 0.02, p.seat + float(rng.uniform(0.16, 0.21))
    low, half = deck - 0.07, post / 2
    splay = float(rng.uniform(0.0, 0.05))
    for name, sign in (("left", -1), ("right", 1)):
        a = sign * x
        for end, b, out in (("front", front, -0.6 * splay), ("rear", rear, splay + 0.04)):
            body.box(f"{end}_post_{name}", (a - half, b - half, low), (a + half, b + half, level))
            body.taper(f"{end}_leg_{name}", (a, b + out, 0), (a, b, low), (0.026, 0.028), (post, post))
        rim, middle = rounded(0.08, rear - front + 0.14, 0.03, 4), (front + rear) / 2
        body.prism(f"arm_{name}", [(a + u, v + middle) for u, v in rim], level, level + 0.022)
        body.box(f"side_rail_{name}", (a - 0.012, front + half, low + 0.01), (a + 0.012, rear - half, deck))
    for end, b in (("front", front), ("rear", rear)):
        body.box(f"{end}_rail", (-x + half, b - 0.012, low + 0.01), (x - half, b + 0.012, deck))
    start, long, slats = front + half, rear - front - post, 5
    for number in range(slats):
        b = start + long * (number + 0.2) / slats
        body.box(f"slat_{number + 1}", (-x - 0.012, b, deck), (x + 0.012, b + 0.6 * long / slats, deck + 0.012))
    inner, lean = x - 0.046, math.tan(tilt)
    for name, sign in (("left", -1), ("right", 1)):
        at = sign * (inner - 0.018)
        body.taper(f"stile_{name}", (at, rear, deck), (at, rear + rise, p.height), (0.036, 0.024), (0.036, 0.024))
    rungs = int(rng.integers(3, 6))
    for number in range(rungs):
        z = p.height - 0.05 - (p.height - p.seat - 0.06) * number / rungs
        corners = [
            (s * (inner - 0.036), rear + (h - deck) * lean + d, h)
            for s in (-1, 1)
            for h in (z, z + 0.04)
            for d in (-0.008, 0.008)
        ]
        body.hull(f"rung_{number + 1}", corners)
    long = rear - front - 0.01
    padded(body, "seat", (0, rear - 0.03 - long / 2, deck + 0.067), (2 * inner, long, 0.11), p.cover)
    high = (p.height - p.seat) / math.cos(tilt) - 0.02
    _leaning(body, "cushion", (0.0, rear - 0.012, deck), (2 * inner - 0.02, high, 0.11), (0.123, tilt), p.cover)
    made.places["seat"] = Place((0, front + 0.3 * long, p.seat), (inner, 0.4 * long))
    return made


def _leaning(body: Body, name: str, foot: Point, size: Point, lie: tuple[float, float], cover: str) -> None:
    """A cushion against a leaning back.

    Args:
        body: gets it.
        name: of it.
        foot: point of the back's plane [m].
        size: width, height along the back, thickness [m].
        lie: height of its lower edge over that point [m], and angle of the back from upright [rad].
        cover: its material.
    """
    (level, tilt), half = lie, size[2] / 2
    along, c, s = level / math.cos(tilt) + 0.001 + size[1] / 2, math.cos(tilt), math.sin(tilt)
    at = (foot[0], foot[1] + along * s - half * c, foot[2] + along * c + half * s)
    padded(body, name, at, size, cover, bevel=(0.07, 0.06), lean=math.pi / 2 - tilt)


GENERATORS = (
    Generator(
        "sofa", "upholstered sofa with cushions", SofaParameters, _sofa,
        ("couch", "settee", "living", "lounge", "seat", "furniture"),
    ),
    Generator(
        "armchair", "armchair, upholstered or with cushions in an open frame of wood", ArmchairParameters, _armchair,
        ("easy", "lounge", "seat", "living", "chair", "furniture", "club"),
    ),
)  # fmt: skip
