"""Does the rule for the step of `cloth` help? Fabrics of drawn weight, stiffness and edge, and the step that the engine takes.

The figure is the share of sheets whose step, and so whose cost, is foretold within a quarter.
"""

from __future__ import annotations

import json
import math
import random
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..simulation.cloth.engine import SAFE
from ..simulation.cloth.mesh import Fabric, sheet_of
from ..simulation.cloth.stability import highest_frequency, longest_step
from ..worlds.categories.cloth.facts import sheet_grid
from ..worlds.spec import Sheet

__all__ = ["by_skill", "measure", "taken_step"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "cloth"
ALLOWED = 0.25
USUAL = 5e-4
"""[s] What one would take who knows rigid bodies only: the default step of theirs."""
SIDE = 12
"""Squares along a side."""


def by_skill(area_density: float, stretch: float, edge: float) -> float:
    """Step by the rule of the skill [s]."""
    rule = json.loads((SKILL / "step.json").read_text())
    return float(rule["factor"] * edge * math.sqrt(area_density / stretch))


def taken_step(area_density: float, stretch: float, bend: float, edge: float) -> float:
    """Step that the engine takes with a flat sheet [s]."""
    place, faces = sheet_grid(Sheet(size=(SIDE * edge, SIDE * edge), resolution=edge))
    fabric = Fabric(area_density, (stretch, stretch), 0.1 * stretch, bend, 0.0, 1e-3)
    return SAFE * longest_step(highest_frequency(sheet_of(place, faces, fabric, flat=True)), 0.0)


def measure(seeds: Sequence[int]) -> dict[str, Any]:
    """Sheets, and how many are within `ALLOWED` per arm."""
    drawn, within = 0, {"with": 0, "without": 0}
    for seed in seeds:
        for name, case in json.loads((SKILL / "evals" / "cases.json").read_text()).items():
            chance = random.Random(f"{name} {seed}")
            weight, stretch, edge = (chance.uniform(*case[k]) for k in ("area_density", "stretch_stiffness", "edge"))
            taken = taken_step(weight, stretch, case["bend_stiffness"], edge)
            drawn += 1
            for arm, told in (("with", by_skill(weight, stretch, edge)), ("without", USUAL)):
                within[arm] += abs(told / taken - 1) <= ALLOWED
                print(f"{name} {seed} {arm}: {told:.3g} s of {taken:.3g} s", file=sys.stderr)
    return {"sheets": drawn, **{f"within_{arm}": n for arm, n in within.items()}}
