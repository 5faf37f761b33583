"""Flying particles and what is taken away from them: without an emitter, a run goes on from the checkpoint of one that had it."""

from __future__ import annotations

import numpy as np
from worldagent.bench.small_grains import SPARK_PROMPT, spark_spec
from worldagent.bench.small_worlds import build_all
from worldagent.simulation.particles.flight import SolverFlight
from worldagent.simulation.protocol import Intervention
from worldagent.worlds.spec import WorldSpec


def _runs(*without: frozenset[str]) -> list[SolverFlight]:
    spec = spark_spec(frames=8, rate=100.0)
    drivers = spec["simulation"]["drivers"]
    drivers["second"] = {**drivers["grinder"], "pose": {"position": [0.5, 0, 1.0]}}
    world = WorldSpec.model_validate({"prompt": SPARK_PROMPT, **spec})
    built = build_all(world)
    runs = [SolverFlight(world, built, "flight", intervention=Intervention(without=names)) for names in without]
    for run in runs:
        run.prepare()
    return runs


def test_a_run_without_an_emitter_goes_on_from_a_checkpoint_with_it() -> None:
    whole, less = _runs(frozenset(), frozenset({"grinder"}))
    for frame in (1, 2, 3):
        whole.advance(frame)
    state, before = whole.checkpoint(), len(whole.columns()["mass"])
    less.restore(state, 3)
    for run in (whole, less):
        run.advance(4)
    both, one = (r.columns() for r in (whole, less))
    assert len(one["mass"]) - before < len(both["mass"]) - before
    assert len(one["mass"]) > before
    # What the second emitter lets out is the same with and without the first.
    late = one["position"][one["identity"] >= before]
    apart = np.linalg.norm(late[:, None] - both["position"][None], axis=2).min(axis=1)
    assert apart.max() < 1e-9
