"""Does the rule of `interiors` for windows help? Rooms of drawn area, by the rule and by the defaults: what finds no place.

The figure is the number of things that a room should have and that found no place; rooms are planned and furnished, not simulated.
"""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..construction.interiors.build import build_interior
from ..worlds.spec import Interior

__all__ = ["lacking", "measure"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "interiors"
GAP = 1e-3


def lacking(kind: str, area: float, seed: int, rule: dict[str, Any]) -> int:
    """Things of a room of a kind and area [m^2] that found no place."""
    room = {"kind": kind, "area": area, "doors": ["outside"], **rule}
    return len(
        build_interior("house", Interior.model_validate({"rooms": {"room": room}, "seed": seed, "density": 0.0}), gap=GAP).lacking
    )


def measure(seeds: Sequence[int]) -> dict[str, Any]:
    """Rooms, and per arm how many things found no place and how many rooms have all."""
    rule = json.loads((SKILL / "rooms.json").read_text())
    rooms, none, full = 0, {"with": 0, "without": 0}, {"with": 0, "without": 0}
    for seed in seeds:
        for name, case in json.loads((SKILL / "evals" / "cases.json").read_text()).items():
            area = round(random.Random(f"{name} {seed}").uniform(*case["area"]), 1)
            rooms += 1
            for arm, given in (("with", rule), ("without", {})):
                found = lacking(case["kind"], area, seed, given)
                none[arm] += found
                full[arm] += found == 0
                print(f"{name} {seed} {arm}: {found} found no place on {area} m^2", file=sys.stderr)
    return {"rooms": rooms, **{f"complete_{a}": n for a, n in full.items()}, **{f"no_place_{a}": n for a, n in none.items()}}
