"""Pavings: setts and cobbles on a bed, flush so that wheels roll over them."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import MAIN, Body, Made, Place

__all__ = ["GENERATORS"]

MOST = 220
"""Setts of one piece at most: an entity has no more than 256 parts."""
BED, SETT = 0.06, 0.1
"""Thickness of the bed and height of the setts over it [m]."""


class CobblesParameters(Parameters):
    """A piece of cobbled ground: courses of setts with worn edges, every other one moved by half a sett, on a bed; pieces stand side by side."""

    length: float = Field(default=3.0, ge=0.6, le=12.0, description="along x, the way that wheels roll [m]")
    width: float = Field(default=2.0, ge=0.6, le=6.0, description="along y [m]")
    sett: float = Field(
        default=0.16, ge=0.08, le=0.4, description="length of a sett along y; grows where there would be more than 220 [m]"
    )
    joint: float = Field(default=0.008, ge=0.003, le=0.02, description="width of the joints [m]")
    worn: float = Field(default=0.008, ge=0.0, le=0.02, description="by how much the edges of the tops are worn off [m]")
    bed: str = material("concrete_c30", "cement_mortar", of="bed")
    material: str = material("granite", "basalt", "sandstone", "limestone")


def _cobbles(p: CobblesParameters, rng: np.random.Generator) -> Made:
    grown = max(1.0, math.sqrt(p.length * p.width / (0.75 * p.sett**2) / (0.85 * MOST)))
    # A sett lies in the middle: an odd number in a course, and of courses one more than a multiple of four.
    courses, number = 1 + 4 * round(p.length / (3.0 * p.sett * grown)), 1 + 2 * int(0.5 * p.width / (p.sett * grown))
    deep, wide = p.length / courses, p.width / number
    body = Body("cobbled ground", p.material)
    body.box("bed", (-p.length / 2, -p.width / 2, 0), (p.length / 2, p.width / 2, BED), material=p.bed)
    for k in range(courses):
        inner = [(j + 0.5 * (k % 2)) * wide for j in range(1 - k % 2, number)]
        moved = rng.uniform(-0.1, 0.1, len(inner)) * wide
        ends = [0.0, *(float(a + b) for a, b in zip(inner, moved, strict=True)), p.width]
        x = (-p.length / 2 + k * deep + p.joint / 2, -p.length / 2 + (k + 1) * deep - p.joint / 2)
        for j in range(len(ends) - 1):
            y = (ends[j] - p.width / 2 + p.joint / 2, ends[j + 1] - p.width / 2 - p.joint / 2)
            _sett(body, f"sett_{k + 1}_{j + 1}", x, y, BED + SETT, p.worn)
    made = Made()
    made.bodies[MAIN] = body
    made.places["top"] = Place((0, 0, BED + SETT), (p.length, p.width))
    return made


def _sett(body: Body, name: str, x: tuple[float, float], y: tuple[float, float], top: float, worn: float) -> None:
    """A stone whose top is worn at its edges."""
    c = min(worn, 0.2 * (x[1] - x[0]), 0.2 * (y[1] - y[0]))
    levels = ((BED, 0.0), (top, 0.0)) if c < 1e-4 else ((BED, 0.0), (top - 0.6 * c, 0.0), (top, c))
    body.hull(
        name, [(a, b, z) for z, inset in levels for a in (x[0] + inset, x[1] - inset) for b in (y[0] + inset, y[1] - inset)]
    )


GENERATORS = (
    Generator("cobbles", "piece of cobbled ground: setts in courses on a bed, flush so that wheels roll", CobblesParameters, _cobbles,
              ("paving", "pavement", "street", "lane", "road", "courtyard", "market", "square", "setts", "stone", "village"), motion="static"),
)  # fmt: skip
