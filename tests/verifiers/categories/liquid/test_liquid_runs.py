"""The judge of liquids on real runs of an engine: sound ones pass every row, and one edited afterwards does not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.liquid_worlds import liquid_world, water
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.verifiers.categories import check as category
from worldagent.worlds.cache import read_container, write_container
from worldagent.worlds.candidate import Candidate

CLOSED = ("closed",) * 5 + ("open",)


def run(folder: Path, cfl: float) -> Candidate:
    """A column of water that breaks in a smooth box, in steps of at most `cfl` cells."""
    column = water((0.16, 0.2, 0.28), (-0.12, 0.0, 0.14), 0.04)
    low, high = (-0.2, -0.1, 0.0), (0.24, 0.1, 0.8)
    spec = liquid_world({"pool": column}, spacing=0.04, low=low, high=high, sides=CLOSED, frames=20, engine="flip")
    solver: Any = spec.simulation.solvers["water"]
    chosen = solver.model_copy(update={"settings": solver.settings.model_copy(update={"cfl": cfl})})
    plan = spec.simulation.model_copy(update={"solvers": {**spec.simulation.solvers, "water": chosen}})
    return simulate(folder, spec.model_copy(update={"simulation": plan}))


@pytest.mark.slow
def test_a_front_that_long_steps_press_into_a_wall_is_found(tmp_path: Path) -> None:
    """Known gap: the default of three cells a step leaves a compression of 0.052 where the front hits the wall; one cell leaves 0.018."""
    row = {r.id: r for r in category.check(run(tmp_path, cfl=3.0))}["category:liquid:density:water"]
    assert (row.status, row.first_failing_frame) == ("fail", 6)


@pytest.mark.slow
def test_a_sound_run_passes_and_one_edited_afterwards_does_not(tmp_path: Path) -> None:
    candidate = run(tmp_path, cfl=1.0)
    rows = [*category.check(candidate), *category.check_numerical(candidate)]
    assert [(r.id, r.evidence["explanation"]) for r in rows if r.status not in ("pass", "not_applicable")] == []
    cache = candidate.caches["water"]
    digests = cache.digests()
    for k in range(10, cache.index.frames):
        held = read_container(cache.path(k))
        keep = np.arange(len(held["particle/id"])) % 100 != 0
        held |= {n: v[keep] for n, v in held.items() if n.startswith("particle/")}
        digests[k] = write_container(cache.path(k), held)
    cache.begin_digests(digests)
    fresh = Candidate(candidate.folder, candidate.spec, candidate.built, "probe", candidate.caches, "run", "edited")
    failed = {r.id: r.first_failing_frame for r in category.check(fresh) if r.status == "fail"}
    assert failed["category:liquid:mass:water"] == 10
    assert failed["category:liquid:identity:water"] == 10
