"""Fruit, vegetables, bread, cheese, eggs, pizza: of the rows of the table that come nearest in colour and density."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made
from .profiles import arc, circle
from .turning import TRIM, drawn, solid, stacked

__all__ = ["GENERATORS"]


def _stalk(
    body: Body, foot: tuple[float, float, float], long: float, radius: float, rng: np.random.Generator, *, leaf: bool
) -> None:
    """A bent stalk, with a leaf at its end."""
    lean = float(rng.uniform(0.15, 0.45)) * long
    turn = float(rng.uniform(0, 2 * math.pi))
    x, y, z = foot
    tip = (x + lean * math.cos(turn), y + lean * math.sin(turn), z + long)
    path = [foot, (x, y, z + 0.35 * long), tip]
    body.sweep("stalk", path, circle(radius, 6), scales=[1.0, 0.8, 1.1], material="pine_bark")
    if leaf:
        c, s = math.cos(turn), math.sin(turn)
        rows = ((0.0, 0.0, 0.0), (0.6, 0.42, 0.2), (1.4, 0.4, 0.1), (2.2, 0.0, -0.25))
        points = [
            (tip[0] + long * (u * c - w * v * s), tip[1] + long * (u * s + w * v * c), tip[2] + long * h + t)
            for u, v, h in rows
            for w in (-1, 1)
            for t in (0.0, 0.0006)
        ]
        body.hull("leaf", points, material="grass")


class AppleParameters(Parameters):
    """An apple with stalk and leaf."""

    diameter: float = Field(default=0.076, ge=0.05, le=0.1, description="[m]")
    height: float = Field(default=0.88, ge=0.78, le=1.0, description="over the diameter")
    leaf: bool = Field(default=True, description="a leaf at the stalk")
    material: str = material("maize", "potatoes", "terracotta", "carpet")


def _apple(p: AppleParameters, rng: np.random.Generator) -> Made:
    body, r, h = Body("apple", p.material), p.diameter / 2, p.height * p.diameter
    full, core = float(rng.uniform(0.54, 0.62)), 0.1
    outline = [
        (core, 0.05),
        (0.3, 0.0),
        (0.62, 0.06),
        (0.88, 0.26),
        (1.0, full),
        (0.94, 0.78),
        (0.72, 0.95),
        (0.46, 1.0),
        (core, 0.86),
    ]
    body.turned("flesh", [(u * r, v * h) for u, v in outline], segments=24)
    body.turned("core", solid([(core * r, 0.05 * h), (core * r, 0.86 * h)]), segments=24)
    _stalk(body, (0, 0, 0.86 * h), 0.32 * h, 0.03 * r, rng, leaf=p.leaf)
    return Made.of(body)


class OrangeParameters(Parameters):
    """An orange or another round fruit of its family: a ball that rolls, with a button where the stalk was."""

    diameter: float = Field(
        default=0.075, ge=0.045, le=0.15, description="[m]: 0.055 of a mandarin, 0.075 of an orange, 0.11 of a grapefruit"
    )
    material: str = material("maize", "potatoes", "terracotta")


def _orange(p: OrangeParameters, rng: np.random.Generator) -> Made:
    body, r = Body("orange", p.material), p.diameter / 2
    body.sphere("flesh", (0, 0, r), r)
    wide = float(rng.uniform(0.06, 0.09)) * r
    body.cylinder("button", (0, 0, 2 * r), (0, 0, 2 * r + TRIM), wide, material="grass")
    drawn(body, "button")
    return Made.of(body)


class PearParameters(Parameters):
    """A pear that stands, with its stalk."""

    height: float = Field(default=0.1, ge=0.07, le=0.14, description="without the stalk [m]")
    width: float = Field(default=0.68, ge=0.58, le=0.78, description="diameter over height")
    material: str = material("maize", "potatoes", "grass")


def _pear(p: PearParameters, rng: np.random.Generator) -> Made:
    body, h, r = Body("pear", p.material), p.height, p.width * p.height / 2
    neck = float(rng.uniform(0.4, 0.5))
    outer = [
        (0.36, 0.0),
        (0.66, 0.03),
        (0.9, 0.13),
        (1.0, 0.28),
        (0.92, 0.44),
        (0.7, 0.6),
        (neck, 0.78),
        (0.9 * neck, 0.88),
        (0.66 * neck, 0.96),
        (0.3 * neck, 1.0),
    ]
    stacked(body, "flesh", [(u * r, v * h) for u, v in outer], segments=24)
    _stalk(body, (0, 0, h), 0.2 * h, 0.045 * r, rng, leaf=False)
    return Made.of(body)


class BananaParameters(Parameters):
    """A banana lying on its side."""

    length: float = Field(default=0.19, ge=0.12, le=0.24, description="along its arc [m]")
    diameter: float = Field(default=0.036, ge=0.028, le=0.044, description="in the middle [m]")
    bend_deg: float = Field(default=75.0, ge=35.0, le=110.0, description="from end to end [degrees]")
    material: str = material("maize", "grass")


def _banana(p: BananaParameters, rng: np.random.Generator) -> Made:
    body, bend = Body("banana", p.material), math.radians(p.bend_deg)
    reach, r = p.length / bend, p.diameter / 2
    profile = circle(r, 8)
    under = max(v for _, v in profile)
    ends = float(rng.uniform(0.5, 0.62))
    shares = (0.0, 0.05, 0.15, 0.3, 0.5, 0.7, 0.85, 0.95, 1.0)
    scales = [0.26, ends, 1.0, 1.0, 1.0, 1.0, 1.0, 0.6, 0.3]
    path = []
    for s in shares:
        a = bend * (s - 0.5) - math.pi / 2
        path.append((reach * math.cos(a), reach * (math.sin(a) + 1), under))
    body.sweep("flesh", path, profile, scales=scales)
    first, second = np.array(path[0]), np.array(path[1])
    way = (first - second) / np.linalg.norm(first - second)
    body.cylinder("stalk", first, first + 0.16 * p.length * way, 0.2 * r, material="pine_bark")
    return Made.of(body)


class CarrotParameters(Parameters):
    """A carrot lying along x, with its leaves to the left."""

    length: float = Field(default=0.17, ge=0.1, le=0.25, description="of the root [m]")
    diameter: float = Field(default=0.032, ge=0.02, le=0.05, description="[m]")
    leaves: int = Field(default=4, ge=0, le=6, description="leaves")
    material: str = material("maize", "terracotta", "roof_tile")


def _carrot(p: CarrotParameters, rng: np.random.Generator) -> Made:
    body, long = Body("carrot", p.material), p.length
    slim = float(rng.uniform(0.66, 0.78))
    rows = ((0.0, 0.6), (0.03, 0.94), (0.1, 1.0), (0.55, slim), (0.9, 0.3), (1.0, 0.08))
    points = []
    for s, k in rows:
        ring = circle(k * p.diameter / 2, 12)
        low = max(v for _, v in ring)
        points += [(long * (s - 0.5), u, low + v) for u, v in ring]
    body.hull("root", points)
    crown = -long / 2
    level = max(v for _, v in circle(0.6 * p.diameter / 2, 12))
    for k in range(p.leaves):
        spread = (k - (p.leaves - 1) / 2) / 3
        y = 0.12 * p.diameter * (k - (p.leaves - 1) / 2)
        reach = float(rng.uniform(0.35, 0.6)) * long
        z = level + 0.003
        path = [
            (crown, y, z),
            (crown - 0.01, y, z),
            (crown - 0.18 * long, y + 0.18 * spread * long, z + 0.1 * reach),
            (crown - reach, y + spread * (0.18 * long + 0.6 * (reach - 0.18 * long)), z + 0.04 * reach),
        ]
        body.sweep(f"leaf_{k + 1}", path, circle(0.036 * p.diameter, 6), scales=[1, 1, 1.1, 0.6], material="grass")
    return Made.of(body)


class LoafParameters(Parameters):
    """A loaf of bread in lobes between its cuts."""

    length: float = Field(default=0.28, ge=0.15, le=0.6, description="along x [m]")
    width: float = Field(default=0.13, ge=0.06, le=0.18, description="along y [m]")
    height: float = Field(default=0.1, ge=0.05, le=0.14, description="[m]")
    cuts: int = Field(default=4, ge=1, le=8, description="cuts across the top")
    material: str = material("cork", "potatoes", "wheat")


def _loaf(p: LoafParameters, rng: np.random.Generator) -> Made:
    body, lobes = Body("loaf", p.material), p.cuts + 1
    step = p.length / lobes
    skew = float(rng.uniform(-0.3, 0.3)) * step

    def section(s: float, deep: float) -> list[tuple[float, float, float]]:
        u = 2 * s - 1
        k = math.sqrt(max(0.0, 1 - (0.93 * u) ** 4))
        base = [(1.0, 0.0), (1.0, 0.12), (0.97, 0.42), (0.82, 0.72), (0.55, 0.92), (0.2, 1.0)]
        half = [(0.5 * p.width * k * (0.9 if v == 0 else 1.0) * a, p.height * (0.55 + 0.45 * k) * v * deep) for a, v in base]
        return [(p.length * (s - 0.5) + skew * (y / p.width), y, z) for a, z in half for y in (-a, a)]

    for number in range(lobes):
        a, b = number / lobes, (number + 1) / lobes
        ends = [section(a, 0.86 if number else 0.75), section(b, 0.86 if number + 1 < lobes else 0.75)]
        middle = [section(a + f * (b - a), 1.0) for f in (0.25, 0.5, 0.75)]
        body.hull(f"lobe_{number + 1}", [q for part in (*ends, *middle) for q in part])
    return Made.of(body)


class CheeseWheelParameters(Parameters):
    """A wheel of cheese with a rind, a wedge cut out of it that lies beside it."""

    diameter: float = Field(default=0.3, ge=0.1, le=0.6, description="[m]")
    height: float = Field(default=0.1, ge=0.03, le=0.16, description="[m]")
    wedge_deg: float = Field(default=45.0, ge=0.0, le=90.0, description="cut out, less than 10: none [degrees]")
    rind: str = material("potatoes", "terracotta", "cork", "carpet", of="the rind")
    material: str = material("maize", "flour", "barley")


def _sector(body: Body, radius: float, height: float, angles: tuple[float, float], at: tuple[float, float], rind: str) -> None:
    """A sector of a wheel between two angles [rad], rind outside."""
    steps = max(2, math.ceil((angles[1] - angles[0]) / math.radians(15)))
    inner = 0.94 * radius
    for k in range(steps):
        a, b = (angles[0] + (angles[1] - angles[0]) * n / steps for n in (k, k + 1))
        near = arc(at, inner, a, b, 1)
        body.prism(f"cheese_{k + 1}", [at, *near], 0, height)
        body.prism(f"rind_{k + 1}", [*arc(at, radius, a, b, 1), *reversed(near)], 0, height, material=rind)


def _cheese_wheel(p: CheeseWheelParameters, rng: np.random.Generator) -> Made:
    body, r = Body("cheese", p.material), p.diameter / 2
    cut = math.radians(p.wedge_deg) if p.wedge_deg >= 10 else 0.0
    start = -math.pi / 2 + cut / 2
    made = Made.of(body)
    if cut == 0:
        body.turned("cheese", solid([(0.94 * r, 0), (0.94 * r, p.height)]), segments=32)
        body.turned("rind", [(0.94 * r, 0), (r, 0.0), (r, p.height), (0.94 * r, p.height)], segments=32, material=p.rind)
        return made
    _sector(body, r, p.height, (start, start + 2 * math.pi - cut), (0.0, 0.0), p.rind)
    wedge = Body("wedge of cheese", p.material)
    away = float(rng.uniform(0.3, 0.6)) * r
    _sector(wedge, r, p.height, (start - cut, start), (0.0, -away), p.rind)
    made.bodies["wedge"] = wedge
    return made


class EggParameters(Parameters):
    """An egg, upright on its blunt end; it does not stand by itself."""

    height: float = Field(default=0.057, ge=0.03, le=0.15, description="[m]")
    width: float = Field(default=0.76, ge=0.68, le=0.82, description="diameter over height")
    material: str = material("nylon", "potatoes", "alumina", "flour")


def _egg(p: EggParameters, rng: np.random.Generator) -> Made:
    body, h, r = Body("egg", p.material), p.height, p.width * p.height / 2
    lean = float(rng.uniform(0.1, 0.16))
    outline = []
    for t in np.linspace(0, math.pi, 17):
        z = (1 - math.cos(t)) / 2
        outline.append((r * math.sin(t) * (1 - lean * (2 * z - 1)) / (1 + 0.2 * lean * lean), h * z))
    outline[0], outline[-1] = (0.0, 0.0), (0.0, h)
    body.turned("egg", outline, segments=32)
    return Made.of(body)


class PumpkinParameters(Parameters):
    """A ribbed pumpkin with its stalk."""

    diameter: float = Field(default=0.28, ge=0.1, le=0.6, description="[m]")
    height: float = Field(default=0.72, ge=0.5, le=0.9, description="over the diameter")
    ribs: int = Field(default=10, ge=8, le=14, description="ribs")
    depth: float = Field(default=0.1, ge=0.04, le=0.16, description="of the grooves over the radius")
    material: str = material("maize", "terracotta", "grass")


def _pumpkin(p: PumpkinParameters, rng: np.random.Generator) -> Made:
    body, r, h = Body("pumpkin", p.material), p.diameter / 2, p.height * p.diameter
    outline = [(0.28, 0.0), (0.62, 0.05), (0.88, 0.2), (1.0, 0.46), (0.94, 0.7), (0.74, 0.9), (0.46, 1.0)]
    core = 0.1
    for k in range(p.ribs):
        points = [(0.0, 0.0, 0.06 * h), (0.0, 0.0, 0.84 * h)]
        swell = float(rng.uniform(0.97, 1.03))
        for f in (-0.5, -0.3, 0.0, 0.3, 0.5):
            a = 2 * math.pi * (k + 0.5 + f) / p.ribs
            grow = (1 - p.depth * (2 * f) ** 2) * (1 + (swell - 1) * (1 - (2 * f) ** 2))
            points += [(u * r * grow * math.cos(a), u * r * grow * math.sin(a), v * h) for u, v in outline]
        body.hull(f"rib_{k + 1}", points)
    core * r
    reach, foot, top = 0.5 * core * r, 0.84 * h, 1.08 * h
    ring = [(math.cos(a), math.sin(a)) for a in np.linspace(0, 2 * math.pi, 6, endpoint=False)]
    lean = float(rng.uniform(-1, 1)) * core * r
    body.hull(
        "stalk",
        [
            (0, 0, foot),
            *((reach * u, reach * v, h) for u, v in ring),
            *((lean + 0.8 * reach * u, 0.8 * reach * v, top) for u, v in ring),
        ],
        material="pine_bark",
    )
    return Made.of(body)


class PizzaParameters(Parameters):
    """A pizza with a raised crust and toppings."""

    diameter: float = Field(default=0.32, ge=0.2, le=0.45, description="[m]")
    toppings: int = Field(default=9, ge=0, le=16, description="slices of sausage on it")
    crust: str = material("cork", "potatoes", of="the crust")
    material: str = material("maize", "flour")


def _pizza(p: PizzaParameters, rng: np.random.Generator) -> Made:
    body, r, n = Body("pizza", p.material), p.diameter / 2, 24
    wide, base = 0.09 * r + 0.004, 0.006
    inner = r - wide
    body.turned("base", solid([(inner, 0), (inner, base)]), segments=n, material=p.crust)
    rim = [
        (inner, 0),
        (r - 0.3 * wide, 0),
        (r, 0.35 * wide),
        (r - 0.15 * wide, 0.9 * wide + base),
        (r - 0.6 * wide, wide + base),
        (inner, base + 0.4 * wide),
    ]
    body.turned("crust", rim, segments=n, material=p.crust)
    body.turned("sauce", solid([(inner, base), (inner, base + 0.0012)]), segments=n, material="carpet")
    body.turned("cheese", solid([(0.96 * inner, base + 0.0012), (0.93 * inner, base + 0.004)]), segments=n)
    size, top = 0.13 * r, base + 0.004
    spots: list[tuple[float, float]] = []
    for _ in range(400):
        if len(spots) == p.toppings:
            break
        reach, a = (0.93 * inner - 1.1 * size) * math.sqrt(float(rng.uniform())), float(rng.uniform(0, 2 * math.pi))
        q = (reach * math.cos(a), reach * math.sin(a))
        if all(math.hypot(q[0] - s[0], q[1] - s[1]) > 2.15 * size for s in spots):
            spots.append(q)
    for k, (x, y) in enumerate(spots, start=1):
        body.cylinder(f"sausage_{k}", (x, y, top), (x, y, top + 0.002), size, material="roof_tile")
    return Made.of(body)


GENERATORS = (
    Generator("apple", "apple with stalk and leaf", AppleParameters, _apple, ("fruit", "food", "kitchen")),
    Generator("orange", "orange, a ball that rolls", OrangeParameters, _orange, ("fruit", "citrus", "mandarin", "grapefruit", "food", "kitchen"), stands=False),
    Generator("pear", "pear with its stalk", PearParameters, _pear, ("fruit", "food", "kitchen")),
    Generator("banana", "banana lying on its side", BananaParameters, _banana, ("fruit", "food", "kitchen")),
    Generator("carrot", "carrot with leaves", CarrotParameters, _carrot, ("vegetable", "food", "kitchen", "garden")),
    Generator("loaf", "loaf of bread", LoafParameters, _loaf, ("bread", "baguette", "food", "kitchen", "bakery")),
    Generator("cheese_wheel", "wheel of cheese with a loose wedge cut from it", CheeseWheelParameters, _cheese_wheel, ("food", "kitchen", "cheese", "market")),
    Generator("egg", "egg", EggParameters, _egg, ("food", "kitchen", "hen", "nest"), stands=False),
    Generator("pumpkin", "ribbed pumpkin", PumpkinParameters, _pumpkin, ("vegetable", "gourd", "food", "garden", "autumn")),
    Generator("pizza", "pizza with crust and toppings", PizzaParameters, _pizza, ("food", "kitchen", "restaurant")),
)  # fmt: skip
