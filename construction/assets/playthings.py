"""Toy cars with wheels that turn, and ducks."""

from __future__ import annotations

import itertools
import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Joint, Made
from .turning import TRIM, drawn, half, solid

__all__ = ["GENERATORS"]

GAP = 8e-4
"""[m] Between a wheel and the car."""


class ToyCarParameters(Parameters):
    """A toy car whose front is at -y, with four wheels on axles along x."""

    length: float = Field(default=0.16, ge=0.06, le=0.6, description="along y [m]")
    wheel: float = Field(default=0.24, ge=0.18, le=0.27, description="diameter of a wheel over the length")
    cabin: float = Field(default=0.5, ge=0.35, le=0.65, description="length of the cabin over that of the car")
    tyre: str = material("natural_rubber", "neoprene", "beech", "walnut", of="the wheels")
    trim: str = material("maple", "acrylic", "brass", "polystyrene", of="cabin, lights and hubs")
    material: str = material("cherry_wood", "beech", "mahogany", "roof_tile", "maize", "mild_steel")


def _toy_car(p: ToyCarParameters, rng: np.random.Generator) -> Made:
    long = p.length
    r, half_long, wide = p.wheel * long / 2, long / 2, 0.19 * long
    body = Body("toy car", p.material)
    low, deck = 0.55 * r, 0.55 * r + 0.17 * long
    nose = float(rng.uniform(0.25, 0.5))
    rows = [
        (-half_long, low + 0.03 * long, low + 0.09 * long),
        (-0.46 * long, low, deck - nose * 0.08 * long),
        (-0.12 * long, low, deck),
    ]
    rows += [(0.42 * long, low, deck), (half_long, low + 0.04 * long, deck - 0.03 * long)]
    for number, ends in enumerate(itertools.pairwise(rows), start=1):
        body.hull(f"hull_{number}", [(s * wide, y, z) for y, *zs in ends for z in zs for s in (-1, 1)])
    front, top = -0.12 * long, deck + 0.16 * long
    back = min(front + p.cabin * long, 0.42 * long)
    roof = (front + 0.3 * (back - front), back - 0.14 * (back - front))
    cabin = [(s * 0.92 * wide, y, deck) for s in (-1, 1) for y in (front, back)]
    body.hull("cabin", [*cabin, *((s * 0.74 * wide, y, top) for s in (-1, 1) for y in roof)], material=p.trim)
    body.hull("roof", [(s * w * wide, y, z) for s in (-1, 1) for w, z in ((0.74, top), (0.7, top + 0.018 * long)) for y in roof])
    for name, s in (("left", -1), ("right", 1)):
        at = (s * 0.62 * wide, -half_long, low + 0.06 * long)
        body.cylinder(f"light_{name}", at, (at[0], -half_long - TRIM, at[2]), 0.026 * long, material=p.trim)
        tail = (s * 0.62 * wide, half_long, low + 0.08 * long)
        body.box(
            f"lamp_{name}",
            (tail[0] - 0.03 * long, half_long, tail[2] - 0.015 * long),
            (tail[0] + 0.03 * long, half_long + TRIM, tail[2] + 0.015 * long),
            material=p.trim,
        )
        drawn(body, f"light_{name}", f"lamp_{name}")
    made = Made.of(body)
    broad = 0.075 * long
    for name, sx, y in (("front_left", -1, -0.29), ("front_right", 1, -0.29), ("back_left", -1, 0.29), ("back_right", 1, 0.29)):
        wheel = Body("wheel", p.tyre)
        inner = wide + GAP
        wheel.cylinder("tyre", (sx * inner, y * long, r), (sx * (inner + broad), y * long, r), r)
        outer = inner + broad + TRIM
        wheel.cylinder("hub", (sx * (inner + broad), y * long, r), (sx * outer, y * long, r), 0.5 * r, material=p.trim)
        drawn(wheel, "hub")
        made.bodies[f"wheel_{name}"] = wheel
        friction = 1e-4 * (long / 0.16) ** 3
        made.joints[f"wheel_{name}"] = Joint(
            f"wheel_{name}", "hinge", (sx * wide, y * long, r), axis=(1, 0, 0), friction=friction
        )
    return made


class ToyDuckParameters(Parameters):
    """A duck that looks towards -y, light enough to swim."""

    length: float = Field(default=0.1, ge=0.05, le=0.4, description="along y, about [m]")
    plump: float = Field(default=0.72, ge=0.6, le=0.85, description="width over length")
    beak: str = material("terracotta", "roof_tile", "cherry_wood", "basalt_lava", of="the beak")
    material: str = material("maize", "rigid_foam", "polystyrene", "maple")


def _toy_duck(p: ToyDuckParameters, rng: np.random.Generator) -> Made:
    body, b = Body("toy duck", p.material), p.length / 2
    a, c, mid = p.plump * b, 0.62 * b, 0.52 * b
    side, back, level, neck, at = 0.9 * a, 0.93 * b, mid + 0.72 * c, 0.34 * b, -0.36 * b
    points = []
    for t in np.linspace(-math.pi / 2, math.pi / 2, 11):
        for u in np.linspace(0, 2 * math.pi, 20, endpoint=False):
            q = (a * math.cos(t) * math.cos(u), b * math.cos(t) * math.sin(u), mid + c * math.sin(t))
            points.append((max(-side, min(side, q[0])), min(back, q[1]), max(0.0, min(level, q[2]))))
    for k in np.linspace(0, 2 * math.pi, 16, endpoint=False):
        points.append((0.98 * neck * math.cos(k), at + 0.98 * neck * math.sin(k), level))
    body.hull("body", points)
    _duck_head(body, p.beak, (at, level), 0.44 * b * float(rng.uniform(0.95, 1.08)), neck)
    rows = ((-0.35, 0.1, 0.35), (0.1, -0.1, 0.42), (0.5, 0.2, 0.36))
    for name, s in (("left", -1), ("right", 1)):
        flank = [(s * side, 0.5 * y * b, mid + z * c) for y, *zs in rows for z in zs]
        edge = [(s * (side + 0.07 * a), 0.4 * y * b, mid + 0.9 * z * c) for y, *zs in rows for z in zs]
        body.hull(f"wing_{name}", [*flank, *edge])
    tail = [(s * 0.2 * a, back, mid + z * c) for s in (-1, 1) for z in (-0.12, 0.14)]
    tip = [(s * 0.1 * a, back + 0.3 * b, mid + 0.46 * c) for s in (-1, 1)]
    body.hull("tail", [*tail, *tip, (0, back + 0.26 * b, mid + 0.6 * c)])
    return Made.of(body)


def _duck_head(body: Body, beak: str, foot: tuple[float, float], r: float, neck: float) -> None:
    """Head of radius `r` with beak and eyes on a neck.

    Args:
        body: it is added to.
        beak: material of the beak.
        foot: y and z of the middle of the neck's foot [m].
        r: radius of the head [m].
        neck: radius of the neck [m].
    """
    (at, level), n = foot, 24
    low, flat = level + 0.52 * r, 0.16 * r
    outer = [(0.9 * neck, level), (0.9 * r, low - 0.3 * r), (r, low), (r, low + 2 * flat), (0.88 * r, low + 0.68 * r)]
    outer += [(0.62 * r, low + r), (0.3 * r, low + 1.16 * r), (0.0, low + 1.2 * r)]
    body.turned("head", solid(outer), (0, at, 0), segments=n, euler=half(n))
    reach = r * math.cos(math.pi / n)
    face, side = at - reach, 2 * r * math.tan(math.pi / n)
    root = [(s * side, face, low + z * flat) for s in (-1, 1) for z in (0.1, 1.7)]
    tip = [(s * 1.2 * side, face - 0.6 * r, low + z * flat) for s in (-1, 1) for z in (0.5, 1.0)]
    body.hull("beak", [*root, *tip], material=beak)
    for name, s in (("left", -1), ("right", 1)):
        way = np.array([s, -1, 0]) / math.sqrt(2)
        eye = np.array([0, at, low + 1.1 * flat]) + reach * way
        body.cylinder(f"eye_{name}", eye, eye + max(0.06 * r, 0.0012) * way, 0.11 * r, material="abs")
        # Painted on: as a collider so thin a disc would ask for short steps of all that could meet it.
        body.parts[f"eye_{name}"] = body.parts[f"eye_{name}"].model_copy(update={"collides": False})


GENERATORS = (
    Generator("toy_car", "toy car with four wheels that turn", ToyCarParameters, _toy_car, ("toy", "vehicle", "wheels", "children", "roll")),
    Generator("toy_duck", "toy duck", ToyDuckParameters, _toy_duck, ("toy", "rubber", "bath", "bird", "swim", "float")),
)  # fmt: skip
