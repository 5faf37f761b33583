"""Coat racks and rugs."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .cabinetry import pick, stacked
from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .profiles import circle, rounded

__all__ = ["GENERATORS"]

HOOP = 0.62
"""[m] Height of a coat rack's hoop."""


class CoatRackParameters(Parameters):
    """A coat rack: a turned post on curved feet with two rows of hooks."""

    height: float = Field(default=1.75, ge=1.5, le=1.95, description="along z [m]")
    post: float = Field(default=0.05, ge=0.036, le=0.07, description="diameter of the post [m]")
    reach: float = Field(default=0.28, ge=0.24, le=0.36, description="of a foot from the post's axis [m]")
    feet: int = Field(default=4, ge=3, le=5, description="feet")
    hooks: int = Field(default=4, ge=3, le=6, description="hooks of a row")
    rows: int = Field(default=2, ge=1, le=2, description="rows of hooks")
    ring: bool = Field(default=True, description="a hoop for umbrellas about the post")
    metal: str = material("brass", "mild_steel", "bronze", "oak", of="hooks and hoop")
    material: str = material("oak", "walnut", "mahogany", "beech", "mild_steel")


def _coat_rack(p: CoatRackParameters, rng: np.random.Generator) -> Made:
    body, r = Body("coat rack", p.material), p.post / 2
    low, top, sides = 0.2, p.height - 3.2 * r, 8 * p.feet
    waist = float(rng.uniform(0.7, 0.9)) * r
    curve = [(0.5 * r, low - 0.03), (1.35 * r, low), (1.35 * r, low + 0.1), (0.9 * r, low + 0.12), (r, low + 0.16)]
    levels = [top - 0.13 - 0.09 * p.height] * (p.rows == 2) + [top - 0.13]
    for level in [HOOP] * p.ring + levels:
        neck = r if level == levels[0] else waist
        curve += [(neck, level - 0.04), (1.3 * r, level - 0.022), (1.3 * r, level + 0.022), (0.9 * r, level + 0.04)]
    stacked(body, "post", [*curve, (r, top - 0.05), (1.3 * r, top - 0.04), (1.3 * r, top), (0.7 * r, top + 0.01)], segments=sides)
    z = top + 0.01
    head = [(0.7 * r, z), *((1.25 * r * math.sin(a), z + 1.25 * r * (0.83 - math.cos(a))) for a in np.linspace(0.75, 2.6, 7))]
    stacked(body, "finial", [*head, (0.05 * r, p.height)], segments=32)
    edge = 1.35 * r * math.cos(math.pi / sides)
    for number in range(p.feet):
        turn = math.pi / sides + math.tau * number / p.feet
        c, s = math.cos(turn), math.sin(turn)
        way = [
            (edge, low + 0.05),
            (edge + 0.03, low + 0.05),
            (0.45 * p.reach, low - 0.0),
            (0.72 * p.reach, 0.08),
            (0.88 * p.reach, 0.024),
            (p.reach, 0.016),
            (p.reach + 0.02, 0.016),
        ]
        path = [(d * c, d * s, h) for d, h in way]
        body.sweep(f"foot_{number + 1}", path, rounded(0.024, 0.032, 0.006, 2), scales=[1.3, 1.25, 1.1, 1.0, 0.95, 1.0, 1.0])
    for row, level in enumerate(levels, start=1):
        _hooks(body, p, row, (1.3 * r, level))
    if p.ring:
        _hoop(body, p, 1.3 * r)
    return Made.of(body)


def _hooks(body: Body, p: CoatRackParameters, row: int, at: tuple[float, float]) -> None:
    """A row of hooks that bend upwards from the post, whose radius and height there are `at` [m]."""
    (r, z), sides = at, 8 * p.feet
    edge = r * math.cos(math.pi / sides)
    way = [
        (edge, z),
        (edge + 0.03, z),
        (edge + 0.065, z + 0.008),
        (edge + 0.092, z + 0.03),
        (edge + 0.1, z + 0.055),
        (edge + 0.1, z + 0.075),
    ]
    for number in range(p.hooks):
        facet = round((number + 0.5 * (row == 2)) / p.hooks * sides)
        a = math.tau * (facet + 0.5) / sides
        c, s = math.cos(a), math.sin(a)
        path, far = [(d * c, d * s, h) for d, h in way], edge + 0.1
        body.sweep(f"hook_{row}_{number + 1}", path, circle(0.0065, 8), scales=[1.2, 1.1, 1, 0.95, 0.9, 0.9], material=p.metal)
        body.sphere(f"hook_end_{row}_{number + 1}", (far * c, far * s, z + 0.0855), 0.0105, material=p.metal)


def _hoop(body: Body, p: CoatRackParameters, r: float) -> None:
    """A hoop about the post, of radius `r` [m] there, on spokes."""
    radius, sides, around = 0.13, 8 * p.feet, circle(0.005, 6)
    path = [(radius * math.cos(a), radius * math.sin(a), HOOP) for a in math.tau * np.arange(sides) / sides]
    body.sweep("hoop", path, around, closed=True, material=p.metal)
    facet = math.cos(math.pi / sides)
    ends = (r * facet, radius * facet - max(u for u, _ in around))
    for number in range(p.feet):
        turn = math.pi / sides + math.tau * number / p.feet
        foot, head = ((d * math.cos(turn), d * math.sin(turn), HOOP) for d in ends)
        body.cylinder(f"spoke_{number + 1}", foot, head, 0.004, material=p.metal)


class RugParameters(Parameters):
    """A rug: field with borders and a figure in the middle, with fringes; or round."""

    width: float = Field(default=2.0, ge=0.6, le=3.5, description="along x [m]; a round one is as deep as wide")
    depth: float = Field(default=1.4, ge=0.5, le=2.5, description="along y [m]")
    thick: float = Field(default=0.01, ge=0.006, le=0.02, description="thickness [m]")
    pattern: Literal["varied", "plain", "bordered", "medallion", "stripes", "round"] = Field(
        default="varied", description="of the rug"
    )
    fringe: bool = Field(default=True, description="fringes at both narrow ends, if it is not round")
    border: str = material("wool", "cotton", "leather", "linen", of="borders")
    figure: str = material("felt", "cotton", "wool", "leather", of="the figure, and of stripes")
    material: str = material("carpet", "wool", "felt", "linen")


def _rug(p: RugParameters, rng: np.random.Generator) -> Made:
    body = Body("rug", p.material)
    kind = pick(p.pattern, rng, "plain", "bordered", "medallion", "stripes", "round")
    made, x, y, t = Made.of(body), p.width / 2, p.depth / 2, p.thick
    made.places["top"] = Place((0, 0, t), (1.3 * x, 1.3 * (x if kind == "round" else y)))
    if kind == "round":
        edges = [0.0, *np.sort(rng.uniform(0.3, 0.8, 2)).tolist(), 0.9, 1.0]
        stuffs = (
            [p.figure, p.material, p.border, p.material]
            if edges[2] - edges[1] > 0.1
            else [p.material, p.material, p.border, p.material]
        )
        a = 0.0
        for number, (b, stuff) in enumerate(zip(edges[1:], stuffs, strict=True), start=1):
            if b - a < 1e-3:
                continue
            body.turned(f"ring_{number}", [(a * x, 0.0), (b * x, 0.0), (b * x, t), (a * x, t)], segments=40, material=stuff)
            a = b
        return made
    least = min(x, y)
    if kind != "plain":
        for number, (share, stuff) in enumerate(((0.06, p.material), (0.16, p.border), (0.04, p.figure)), start=1):
            way = share * least
            _band(body, f"border_{number}", (x, y), way, (t, stuff))
            x, y = x - way, y - way
    if kind == "medallion":
        _medallion(body, p, (x, y), float(rng.uniform(0.4, 0.75)))
    elif kind == "stripes":
        count = 2 * int(rng.integers(3, 7)) + 1
        cuts = np.linspace(-x, x, count + 1)
        for number in range(count):
            stuff = p.material if number % 2 == 0 else (p.figure if number % 4 == 1 else p.border)
            body.box(f"stripe_{number + 1}", (float(cuts[number]), -y, 0), (float(cuts[number + 1]), y, t), material=stuff)
    else:
        body.box("field", (-x, -y, 0), (x, y, t))
    if p.fringe:
        _fringe(body, p)
    return made


def _band(body: Body, name: str, extent: tuple[float, float], way: float, stuff: tuple[float, str]) -> None:
    """Four mitred strips inside a rectangle of half sides x, y, of a width, a thickness and a material."""
    (x, y), (t, metal) = extent, stuff
    outer = [(-x, -y), (x, -y), (x, y), (-x, y)]
    inner = [(-x + way, -y + way), (x - way, -y + way), (x - way, y - way), (-x + way, y - way)]
    for number in range(4):
        body.prism(
            f"{name}_{number + 1}", [outer[number - 1], outer[number], inner[number], inner[number - 1]], 0.0, t, material=metal
        )


def _medallion(body: Body, p: RugParameters, extent: tuple[float, float], share: float) -> None:
    """A lozenge within a lozenge on the field of half sides x, y."""
    (x, y), t = extent, p.thick
    a, b = share * x, share * y
    lozenge = [(a, 0.0), (0.0, b), (-a, 0.0), (0.0, -b)]
    corners = [(x, y), (-x, y), (-x, -y), (x, -y)]
    sides = [(x, 0.0), (0.0, y), (-x, 0.0), (0.0, -y)]
    for number in range(4):
        quad = [lozenge[number], sides[number], corners[number], sides[(number + 1) % 4], lozenge[(number + 1) % 4]]
        body.prism(f"field_{number + 1}", quad, 0.0, t)
        small = [(0.6 * u, 0.6 * v) for u, v in lozenge]
        ring = [small[number], lozenge[number], lozenge[(number + 1) % 4], small[(number + 1) % 4]]
        body.prism(f"lozenge_{number + 1}", ring, 0.0, t, material=p.border)
    body.prism("heart", [(0.6 * u, 0.6 * v) for u, v in lozenge], 0.0, t, material=p.figure)


def _fringe(body: Body, p: RugParameters) -> None:
    """Tassels at both ends of a rug along x."""
    count = min(26, max(10, round(p.depth / 0.04)))
    pitch = p.depth / count
    for side, sign in (("left", -1), ("right", 1)):
        for number in range(count):
            b = -p.depth / 2 + pitch * (number + 0.5)
            low, high = sorted((sign * p.width / 2, sign * (p.width / 2 + 0.05)))
            body.box(
                f"tassel_{side}_{number + 1}",
                (low, b - 0.28 * pitch, 0),
                (high, b + 0.28 * pitch, 0.35 * p.thick),
                material="cotton",
            )


GENERATORS = (
    Generator(
        "coat_rack", "coat rack with hooks on a turned post", CoatRackParameters, _coat_rack, ("hat", "stand", "hall", "hook", "furniture"),
    ),
    Generator("rug", "rug with a pattern and fringes", RugParameters, _rug, ("carpet", "mat", "textile", "living", "bedroom")),
)  # fmt: skip
