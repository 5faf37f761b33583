"""Stairs of a stairwell: two flights with a landing between the walls, which bear on floors and landing alone."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made, Place
from .stairs import STRIDE, Flight, handrail

__all__ = ["GENERATORS", "WellStairsParameters", "well_run"]

EYE = 0.1
"""[m] Own choice: gap between the two flights."""
WAIST = 0.16
"""[m] Own choice: thickness of the slab under the steps, measured upright."""
BEARING = 0.04
"""[m] Own choice: height over which flights bear on the landing."""


class WellStairsParameters(Parameters):
    """Two flights side by side, joined by a landing at the back; they begin and end at the front (-y), and lie between walls.

    Steps are at most 0.19 m high and at least 0.25 m deep, and 2 R + G is from 0.55 to 0.70 m (UK Approved Document K).
    """

    rise: float = Field(default=2.8, ge=2.2, le=4.5, description="from floor to floor [m]")
    width: float = Field(default=1.9, ge=1.7, le=3.6, description="between the walls, along x [m]")
    riser: float = Field(default=0.18, ge=0.15, le=0.19, description="height of a step at most, made even [m]")
    going: float = Field(default=0.27, ge=0.25, le=0.32, description="of a tread [m]")
    landing: float = Field(default=0.95, ge=0.8, le=1.8, description="depth of the landing [m]")
    rail: str = material("oak", "beech", "mild_steel", of="handrails")
    material: str = material("concrete_c30", "limestone", "granite", "marble")


def _risers(p: WellStairsParameters) -> tuple[int, int, float]:
    """Steps up to the landing, and from there on, and the going of a tread [m]."""
    count = max(4, math.ceil(p.rise / p.riser - 1e-9))
    return (count + 1) // 2, count // 2, max(p.going, STRIDE[0] - 2 * p.rise / count)


def well_run(p: WellStairsParameters) -> float:
    """Length in plan of the flights of a stairwell, without the landing [m]."""
    lower, _, going = _risers(p)
    return (lower - 1) * going


def _well_stairs(p: WellStairsParameters, rng: np.random.Generator) -> Made:
    body = Body("stairs", p.material)
    made = Made.of(body)
    lower, upper, going = _risers(p)
    rise, flight = p.rise / (lower + upper), (p.width - EYE) / 2
    run, level = (lower - 1) * going, lower * rise
    depth = run + p.landing
    x, y = (flight + EYE) / 2, depth / 2
    one = Flight(lower - 1, rise, going, flight, lambda a, b, c: (a - x, b - y, c), "lower_", bars=True)
    two = Flight(upper - 1, rise, going, flight, lambda a, b, c: (x - a, run - y - b, level + c), "upper_", bars=True)
    body.box("landing", (-p.width / 2, run - y, level - rise - BEARING), (p.width / 2, depth - y, level))
    for f, floor in ((one, 0.0), (two, -math.inf)):
        for k in range(f.steps):
            ends = [k * f.going, (k + 1) * f.going]
            points = [(b, max(floor, b / f.going * f.rise - WAIST)) for b in ends] + [(b, (k + 1) * f.rise) for b in ends]
            f.hull(body, f"step_{k + 1}", [(a, b, c) for a in (-flight / 2, flight / 2) for b, c in points])
            top = f.turn(0.0, (k + 0.5) * f.going, (k + 1) * f.rise)
            made.places[f"{f.name}tread_{k + 1}"] = Place(top, (flight - 0.3, f.going - 0.04))
        rails = Body("rails", p.rail)
        handrail(rails, f, 1, solid=True)
        for name, part in rails.parts.items():
            body.parts[name] = part.model_copy(update={"material": p.rail})
    made.places["landing"] = Place((0.0, (run + p.landing / 2) - y, level), (p.width - 0.3, p.landing - 0.2))
    return made


GENERATORS = (
    Generator("well_stairs", "stairs of a stairwell: two flights and a landing between walls, with handrails; ends at the floor above", WellStairsParameters, _well_stairs,
              ("staircase", "dogleg", "steps", "storey", "building", "landing"), motion="static", stands=False),
)  # fmt: skip
