"""The judge of liquids on real runs of an engine: sound ones pass every row, and one edited afterwards does not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.bench.liquid_worlds import liquid_world, water
from worldagent.bench.simulated_worlds import simulate
from worldagent.verifiers import category, numerical
from worldagent.worlds.cache import read_container, write_container
from worldagent.worlds.candidate import Candidate

CLOSED = ("closed",) * 5 + ("open",)


def run(folder: Path) -> Candidate:
    """A column of water that breaks in a smooth box."""
    column = water((0.16, 0.2, 0.28), (-0.12, 0.0, 0.14), 0.04)
    low, high = (-0.2, -0.1, 0.0), (0.24, 0.1, 0.8)
    spec = liquid_world({"pool": column}, spacing=0.04, low=low, high=high, sides=CLOSED, frames=20, engine="flip")
    return simulate(folder, spec)


@pytest.mark.slow
def test_a_sound_run_passes_and_one_edited_afterwards_does_not(tmp_path: Path) -> None:
    candidate = run(tmp_path)
    rows = [*category.check(candidate), *numerical.check(candidate)]
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
