"""Cloth instances: coupled with bodies, let go later, held by interventions, gone on from checkpoints."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.cloth.solver import SolverCloth
from worldagent.simulation.protocol import Intervention
from worldagent.simulation.runs import make_run
from worldagent.testing.worlds.small_cloth import CATCH_PROMPT, DRAPE_PROMPT, FLAG_PROMPT, catch_spec, drape_spec, flag_spec
from worldagent.worlds.bake_plan import groups_of
from worldagent.worlds.cache import digest_arrays
from worldagent.worlds.errors import EngineError
from worldagent.worlds.patch import parse_spec


def _made(spec: dict[str, Any], prompt: str) -> tuple[Any, dict[str, Any]]:
    parsed = parse_spec({**spec, "prompt": prompt})
    return parsed, {n: build_entity(parsed, n, Path()) for n in parsed.entities}


def test_a_ball_and_the_cloth_it_falls_into_give_each_other_what_they_get() -> None:
    """Law: what MuJoCo received is what the cloth gave; the cloth's momentum adds up; the ball is caught."""
    spec, built = _made(catch_spec(frames=12, resolution=0.1), CATCH_PROMPT)
    (group,) = groups_of(spec)
    assert group == ("rigid", "cloth")
    run = make_run(spec, built, group)
    run.prepare()
    cloth, rigid = run.solvers["cloth"], run.solvers["rigid"]
    given, received, heights = [], [], []
    for k in range(1, 12):
        run.advance(k)
        row = cloth.index().colliders.index("ball/body")
        given.append(cloth.frame_data()["exchange/impulse"][row])
        received.append(rigid.frame_data()["exchange/impulse"][0])
        heights.append(float(rigid.frame_data()["position"][0, 2]))
    assert np.abs(np.array(given) - np.array(received)).max() < 1e-12
    assert np.array(given)[:, 2].max() > 0.01
    assert min(heights) > 0.5
    data = cloth.frame_data()
    told = sum(float(data[f"record/{by}_impulse_z"]) for by in ("air", "hold", "solid", "cut"))
    fallen = -9.81 * float(data["record/mass"]) * 11 / 24
    assert float(data["record/momentum_z"]) == pytest.approx(told + fallen, abs=1e-12)


def test_cloth_waits_for_its_release_and_under_an_intervention_for_ever() -> None:
    spec = deepcopy(drape_spec(frames=6, resolution=0.2))
    spec["simulation"]["drivers"]["let_go"]["time"] = 0.1
    parsed, built = _made(spec, DRAPE_PROMPT)
    free, held = (
        SolverCloth(parsed, built, "cloth", intervention=i) for i in (None, Intervention(without=frozenset({"let_go"})))
    )
    for solver in (free, held):
        solver.prepare()
    start = free.frame_data()["vertex/position"].copy()
    for k in range(1, 6):
        free.advance(k)
        held.advance(k)
        assert np.array_equal(free.frame_data()["vertex/position"], start) == (k <= 2)
    assert np.array_equal(held.frame_data()["vertex/position"], start)
    seconds = 5 / 24 - 0.1
    fallen = (start - free.frame_data()["vertex/position"])[:, 2].mean()
    assert 0.5 * 9.81 * seconds**2 * 0.3 < fallen < 0.5 * 9.81 * seconds**2


def test_a_resumed_run_equals_an_unbroken_one() -> None:
    spec, built = _made(flag_spec(frames=6, resolution=0.1), FLAG_PROMPT)
    one = SolverCloth(spec, built, "cloth")
    one.prepare()
    for k in (1, 2):
        one.advance(k)
    state = one.checkpoint()
    one.advance(3)
    other = SolverCloth(spec, built, "cloth")
    other.prepare(resumed=True)
    other.restore(state, 2)
    other.advance(3)
    assert digest_arrays(one.frame_data()) == digest_arrays(other.frame_data())


def test_what_is_ignored_or_kept_apart_is_passed_through() -> None:
    spec = deepcopy(drape_spec(frames=8, resolution=0.2))
    spec["entities"]["cloth"]["physics"]["ignores"] = ["ball"]
    parsed, built = _made(spec, DRAPE_PROMPT)
    plain, _ = _made(drape_spec(frames=8, resolution=0.2), DRAPE_PROMPT)
    lowest = []
    for kind, done in ((parsed, None), (plain, Intervention(apart=frozenset({("ball", "cloth")}))), (plain, None)):
        solver = SolverCloth(kind, built, "cloth", intervention=done)
        solver.prepare()
        for k in range(1, 8):
            solver.advance(k)
        x = solver.frame_data()["vertex/position"]
        lowest.append(x[np.linalg.norm(x[:, :2], axis=1) < 0.16, 2].min())
    assert lowest[0] == lowest[1] < 0.45
    assert lowest[2] > 0.455


def _struck_hard() -> tuple[Any, Any, Any]:
    """A run in which 20 kg at 10 m/s fall into a sheet of 0.2 kg that is held at its corners, and its two solvers."""
    spec = deepcopy(catch_spec(frames=4, resolution=0.1))
    spec["entities"]["ball"]["physics"] = {"category": "rigid", "mass": 20.0, "linear_velocity": [0, 0, -10]}
    del spec["simulation"]["drivers"]["let_go"]
    spec["story"]["beats"] = {}
    spec["claims"] = {}
    parsed, built = _made(spec, CATCH_PROMPT)
    run = make_run(parsed, built, groups_of(parsed)[0])
    run.prepare()
    return run, run.solvers["cloth"], run.solvers["rigid"]


def test_a_sheet_that_is_struck_hard_takes_its_steps_again_half_as_long() -> None:
    """Law: what the ball received is what the sheet gave, in frames with steps that were taken again too. Measured: at frame 2 vertices
    leave at 80 m/s, in steps that were chosen when the fastest went at 10 m/s."""
    run, cloth, rigid = _struck_hard()
    for k in range(1, 4):
        run.advance(k)
        row = cloth.index().colliders.index("ball/body")
        given, received = cloth.frame_data()["exchange/impulse"][row], rigid.frame_data()["exchange/impulse"][0]
        assert np.abs(given - received).max() < 1e-9
    assert rigid.frame_data()["position"][0, 2] < 0.7
    assert np.isfinite(cloth.frame_data()["vertex/position"]).all()


def test_a_sheet_that_cannot_go_on_tells_where_and_at_what(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worldagent.simulation.cloth.engine.HALVINGS", 0)
    run, _, _ = _struck_hard()
    run.advance(1)
    with pytest.raises(EngineError, match=r"cloth at \[.*\] m moves at .* m/s at ball/body.*snaps back"):
        run.advance(2)
