"""Does the rule for the box of `gas` help? Sources of drawn size and heat, in the skill's box and in one as wide for all.

Cases are data in `skills/gas/evals/cases.json`, the rule in `skills/gas/box.json`. The figure is the share of runs in which no open side
cuts off what is seen; the cells of both boxes are told beside it.
"""

from __future__ import annotations

import json
import math
import random
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from ..testing.worlds.simulated_worlds import simulate
from ..verifiers.categories.gas.check import category_rows
from ..worlds.spec import WorldSpec

__all__ = ["Box", "Source", "by_guess", "by_skill", "measure", "world"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "gas"
AIR = 1.204
"""[kg/m^3] At 20 degrees C and sea level."""
AMBIENT = 293.15
"""[K]"""
GRAVITY = 9.81
"""[m/s^2]"""
GUESS = (6.0, 12.0)
"""Width and height over those of the source that one may take who has no rule; own choice."""
FPS = 24


class Source(NamedTuple):
    """Ball at the origin that lets the gas out."""

    substance: str
    radius: float
    """[m]"""
    speed: float
    """Rate over its section [m/s]."""
    temperature: float
    """[K]"""
    soot_density: float
    """[kg/m^3]"""
    seconds: float
    """Length of the run [s]."""

    @property
    def rate(self) -> float:
        """Volume of gas let out per second, at its temperature [m^3/s]."""
        return self.speed * math.pi * self.radius**2


class Box(NamedTuple):
    """Room around the source [m], and its cells."""

    half: float
    below: float
    above: float
    cell: float


def by_skill(source: Source) -> Box:
    """Box by the rule of the skill."""
    rule = json.loads((SKILL / "box.json").read_text())
    lift = GRAVITY * max(0.0, 1.0 - AMBIENT / source.temperature - source.soot_density / AIR)
    rise = rule["rise"] * (lift * source.rate) ** 0.25 * source.seconds**0.75
    width = 2.0 * source.radius
    return Box(width + rule["spread"] * rise, rule["below"] * width, width + rise, width / rule["across"])


def by_guess(source: Source) -> Box:
    """A box that is as wide as for every source."""
    width = 2.0 * source.radius
    return Box(0.5 * GUESS[0] * width, width, (GUESS[1] - 1.0) * width, width / 3.0)


def world(source: Source, box: Box) -> WorldSpec:
    """The source over open ground, in still air."""
    width = 2.0 * source.radius
    ground = {"size": [0.1, 0.1, 0.1]}
    smoke = {
        "role": "what rises", "motion": "dynamic", "material": "smoke", "dimensions": {"size": [width] * 3},
        "parts": {"ball": {"shape": {"kind": "sphere", "radius": source.radius}}},
        "physics": {
            "category": "gas", "temperature": source.temperature, "soot_density": source.soot_density, "resolution": box.cell,
        },
    }  # fmt: skip
    floor = {
        "role": "ground far below", "motion": "static", "material": "stone", "dimensions": ground,
        "pose": {"position": [0.0, 0.0, -box.below - 1.0]}, "parts": {"slab": {"shape": {"kind": "box", **ground}}},
    }  # fmt: skip
    high = box.above + box.below
    domain = {"center": [0.0, 0.0, 0.5 * high - box.below], "size": [2.0 * box.half, 2.0 * box.half, high], "sides": ["open"] * 6}
    return WorldSpec.model_validate({
        "prompt": "It rises.", "title": "a source",
        "materials": {"stone": {"density": 2400.0}, "smoke": {"density": 1000.0, "substance": source.substance}},
        "entities": {"floor": floor, "smoke": smoke},
        "simulation": {
            "fps": FPS, "frames": round(source.seconds * FPS) + 1,
            "solvers": {
                "bodies": {"engine": "mujoco", "members": ["floor"]},
                "air": {"engine": "gas", "members": ["smoke"], "settings": {"domain": domain}},
            },
            "drivers": {"source": {"kind": "emission", "entity": "smoke", "rate": source.rate}},
        },
    })  # fmt: skip


def measure(seeds: Sequence[int]) -> dict[str, Any]:
    """Runs, and per arm those in which no open side cuts off what is seen, and the cells of its boxes."""
    runs, whole, cells = 0, {"with": 0, "without": 0}, {"with": 0, "without": 0}
    for seed in seeds:
        for name, case in json.loads((SKILL / "evals" / "cases.json").read_text()).items():
            draw = random.Random(f"{name} {seed}")
            keys = ("radius", "speed", "temperature", "soot_density", "seconds")
            source = Source(case["substance"], *(draw.uniform(*case[k]) for k in keys))
            runs += 1
            for arm, box in (("with", by_skill(source)), ("without", by_guess(source))):
                with TemporaryDirectory() as folder:
                    candidate = simulate(Path(folder), world(source, box))
                    row = next(r for r in category_rows(candidate, "air") if r.id == "category:gas:cut:air")
                count = round(4.0 * box.half**2 * (box.above + box.below) / box.cell**3)
                whole[arm] += row.status == "pass"
                cells[arm] += count
                print(f"{name} {seed} {arm}: {row.measured:.2g} of {row.bound:g}, {count} cells", file=sys.stderr)
    return {"runs": runs, **{f"whole_{arm}": n for arm, n in whole.items()}, **{f"cells_{arm}": n for arm, n in cells.items()}}
