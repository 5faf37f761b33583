"""Benchmark `skills`: what a scripted solver achieves with the data of each skill and without it.

Cases lie in `skills/<name>/evals/`. With no options one seed and a few cases per skill are run, in two to three minutes
on an idle machine with two cores; `--variants N` takes N seeds and all cases.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

from . import (
    skill_assets,
    skill_building,
    skill_cloth,
    skill_elastic,
    skill_fracture,
    skill_gas,
    skill_interiors,
    skill_liquids,
    skill_materials,
    skill_particles,
    skill_repair,
    skill_settings,
    skill_terrain,
)

__all__ = ["run"]

FEW_FLAWS = 8
"""Flaws of a short run."""


def run(*, variants: int | None = None, seed: int | None = None, checks: tuple[str, ...] = ()) -> dict[str, Any]:
    """Figures per skill, with and without.

    Args:
        variants: seeds; each runs every case. Default one seed and a sample of the flaws.
        seed: the first seed; default a new one.
        checks: only these skills.
    """
    first = random.SystemRandom().randrange(10**6) if seed is None else seed
    seeds = range(first, first + (variants or 1))
    flaws: tuple[str, ...] = ()
    arms = tuple(skill_repair.ARMS)
    if variants is None:
        flaws = tuple(random.Random(first).sample(sorted(skill_repair.cases()["flaws"]), FEW_FLAWS))
        arms = ("with", "without")
    evals: dict[str, Callable[[], dict[str, Any]]] = {
        "assets": lambda: skill_assets.measure(seeds),
        "cloth": lambda: skill_cloth.measure(seeds),
        "fracture": lambda: skill_fracture.measure(seeds),
        "coupled-systems": lambda: skill_liquids.measure_floating(seeds),
        "elastic-bodies": lambda: skill_elastic.measure(seeds),
        "gas": lambda: skill_gas.measure(seeds),
        "interiors": lambda: skill_interiors.measure(seeds),
        "liquids": lambda: skill_liquids.measure_resolution(seeds),
        "materials": lambda: skill_materials.measure(seeds),
        "outdoor-terrain": lambda: skill_terrain.measure(seeds),
        "particles": lambda: skill_particles.measure(seeds),
        "repair": lambda: skill_repair.measure(seeds, flaws, arms),
        "rigid-bodies": lambda: skill_settings.measure(seeds),
        "world-building": lambda: skill_building.measure(seeds),
    }
    return {
        "seed": first,
        "seeds": len(seeds),
        "skills": {name: make() for name, make in evals.items() if not checks or name in checks},
    }
