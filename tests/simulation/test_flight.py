"""Flying particles and what is taken away from them: without an emitter, a run goes on from the checkpoint of one that had it."""

from __future__ import annotations

import numpy as np
from worldagent.simulation.particles.flight import SolverFlight
from worldagent.simulation.protocol import Intervention
from worldagent.testing.worlds.small_grains import SPARK_PROMPT, spark_spec
from worldagent.testing.worlds.small_worlds import build_all
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


def test_rain_as_the_skill_has_it_falls_at_its_terminal_speed_and_ends_on_the_floor() -> None:
    spec = spark_spec(frames=14, on_hit="die")
    spec["materials"]["iron"]["density"] = 1000.0
    spec["materials"]["iron"].pop("substance")
    spec["entities"]["sparks"]["physics"] |= {"radius": 0.0015, "radius_spread": 0.0, "life": None}
    pose = {"position": [0, 0, 3.0], "euler": [3.1416, 0, 0]}
    spec["simulation"]["drivers"] = {
        "cloud": {"kind": "emitter", "entity": "sparks", "rate": 300.0, "speed": 6.0, "size": [2.0, 2.0], "pose": pose},
        "air": {"kind": "field", "field": {"kind": "drag"}},
    }
    world = WorldSpec.model_validate({"prompt": SPARK_PROMPT, **spec})
    run = SolverFlight(world, build_all(world), "flight")
    run.prepare()
    for frame in range(1, 14):
        run.advance(frame)
    c = run.columns()
    low = c["position"][:, 2] < 0.5
    # Drops of 3 mm fall at 8.06 m/s (Gunn, Kinzer 1949); after 3 m they have most of it, and spheres have a little more.
    assert low.sum() > 5
    assert 6.5 < -c["velocity"][low, 2].mean() < 8.7
    assert np.ptp(c["position"][:, 0]) > 1.5
    assert float(run.frame_data()["record/died_count"]) > 10
