"""Does the rule for the weight of `fracture` help? Cantilevers of drawn size that shall just hold, by the rule and by the usual strength.

The figure is the share of which the beam itself holds, and one that is a tenth longer breaks; both are simulated.
"""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..construction.build import build_entity
from ..simulation.rigid import SolverRigid
from ..testing.worlds.small_worlds import box, ground, world
from ..worlds.spec import Material

__all__ = ["breaks", "by_skill", "measure"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "fracture"
G = 9.81
SAFETY, LONGER = 1.1, 1.1
PIECES = 5


def by_skill(length: float, height: float, density: float) -> float:
    """Strength in tension [Pa] of a beam that just holds, by the rule of the skill."""
    rule = json.loads((SKILL / "weight.json").read_text())
    return float(SAFETY * rule["factor"] * density * G * length**2 / height)


def breaks(length: float, height: float, density: float, tension: float) -> bool:
    """True if a beam that is bonded to the world at one end breaks by its own weight."""
    pattern = {"kind": "bricks", "size": (length / PIECES, height, height), "joint": 0.0}
    breakable = {"pattern": pattern, "bond": {"tension": tension, "shear": 1e9}, "fixed": ["x-"]}
    beam = box(length, height, height, motion="dynamic", at=(0, 0, 3), breakable=breakable)
    spec = world(
        {"floor": ground(), "beam": beam},
        materials={"wood": Material(density=density)},
        frames=2,
    )
    solver = SolverRigid(spec, {n: build_entity(spec, n, Path()) for n in spec.entities}, "rigid")
    solver.prepare()
    solver.advance(1)
    return bool(solver.frame_data()["bond/broken"].any())


def measure(seeds: Sequence[int]) -> dict[str, Any]:
    """Beams, and how many just hold per arm."""
    drawn, right = 0, {"with": 0, "without": 0}
    for seed in seeds:
        for name, case in json.loads((SKILL / "evals" / "cases.json").read_text()).items():
            chance = random.Random(f"{name} {seed}")
            length = chance.uniform(*case["length"])
            height, density = length / chance.uniform(*case["slender"]), case["density"]
            drawn += 1
            for arm, tension in (("with", by_skill(length, height, density)), ("without", case["usual"])):
                held, longer = (not breaks(k * length, height, density, tension) for k in (1.0, LONGER))
                right[arm] += held and not longer
                print(
                    f"{name} {seed} {arm}: {'holds' if held else 'breaks'}, longer {'holds' if longer else 'breaks'}",
                    file=sys.stderr,
                )
    return {"beams": drawn, **{f"right_{arm}": n for arm, n in right.items()}}
