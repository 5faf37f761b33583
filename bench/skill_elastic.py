"""Do the cells of `elastic-bodies` help? Cantilevers of drawn size under their weight, with the skill's cells and with one for all.

The bodies are data in `skills/elastic-bodies/evals/cases.json`, the rule in `skills/elastic-bodies/cells.json`. The figure is the share
whose tip sags within 5 % of Timoshenko's beam.
"""

from __future__ import annotations

import json
import math
import random
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..construction.build import build_entity
from ..simulation.rigid import SolverRigid
from ..testing.worlds.small_worlds import box, world
from ..worlds.spec import ElasticPhysics, Material, Pin, RigidSettings

__all__ = ["beam_error", "by_skill", "cases", "measure"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "elastic-bodies"
G, POISSON, SHEAR = 9.81, 0.3, 5 / 6
ALLOWED = 0.05
PER_PERIOD, PERIODS = 24, 2
"""Frames per period of the first mode, and periods over which the tip is averaged: an undamped beam swings about its sag."""
STEPS = 500
"""Steps per period."""


def cases() -> dict[str, Any]:
    """Drawn bodies by name."""
    found: dict[str, Any] = json.loads((SKILL / "evals" / "cases.json").read_text())
    return found


def by_skill(extent: Sequence[float]) -> float:
    """Edge of the cells [m] of a body of these extents [m], by the rule of the skill."""
    rule = json.loads((SKILL / "cells.json").read_text())
    slender = max(extent) > rule["slender_from"] * min(extent)
    return float(min(extent) * rule["cell_of_slender" if slender else "cell_of_compact"])


def beam_error(case: Mapping[str, Any], cell: float) -> float:
    """Error of the tip's sag, relative to Timoshenko's beam, of a body with `length`, `height` [m], `young` [Pa], `density`."""
    length, height, young, density = (case[k] for k in ("length", "height", "young", "density"))
    area, inertia = height**2, height**4 / 12
    bending = density * G * area * length**4 / (8 * young * inertia)
    shear = density * G * length**2 / (2 * SHEAR * young / (2 * (1 + POISSON)))
    first = 3.516 * math.sqrt(young * inertia / (density * area * length**4))
    period = 2 * math.pi / first
    physics = ElasticPhysics(
        young_modulus=young,
        poisson_ratio=POISSON,
        damping=period / STEPS,
        resolution=cell,
        pins={"wall": Pin(center=(-length / 2, 0, 0), size=(1e-3 * length, 1, 1))},
    )
    things = {"beam": box(length, height, height, motion="dynamic", at=(0, 0, 1), physics=physics)}
    matter = {"wood": Material(density=density)}
    settings = RigidSettings(step=min(1e-3, period / STEPS), skin=min(5e-4, 0.05 * height))
    fps = min(240, max(1, round(PER_PERIOD / period)))
    frames = round(PERIODS * period * fps) + 1
    spec = world(things, frames=frames, fps=fps, materials=matter, settings=settings)
    built = {"beam": build_entity(spec, "beam", Path())}
    solver = SolverRigid(spec, built, "rigid")
    solver.prepare()
    mesh = built["beam"].parts[0].simulation
    assert mesh is not None
    tip = mesh.vertices[:, 0] > length / 2 - 1e-9
    sags = []
    for frame in range(1, frames):
        solver.advance(frame)
        sags.append(1 - float(solver.frame_data()["vertex/position"][tip, 2].mean()))
    return float(np.mean(sags) / (bending + shear) - 1)


def measure(seeds: Sequence[int]) -> dict[str, Any]:
    """Bodies, and how many are within `ALLOWED` per arm."""
    drawn, within, worst = 0, {"with": 0, "without": 0}, {"with": 0.0, "without": 0.0}
    for seed in seeds:
        for name, case in cases().items():
            chance = random.Random(f"{name} {seed}")
            length = chance.uniform(*case["length"])
            height = length / chance.uniform(*case["slender"])
            young = math.exp(chance.uniform(*(math.log(v) for v in case["young_modulus"])))
            body = {"length": length, "height": height, "young": young, "density": case["density"]}
            drawn += 1
            for arm, cell in (("with", by_skill((length, height, height))), ("without", length)):
                error = beam_error(body, cell)
                within[arm] += abs(error) <= ALLOWED
                worst[arm] = max(worst[arm], abs(error))
                print(f"{name} {seed} {arm}: {error:+.2%}", file=sys.stderr)
    return {
        "bodies": drawn,
        **{f"within_{arm}": n for arm, n in within.items()},
        **{f"worst_{a}": round(w, 4) for a, w in worst.items()},
    }
