"""Impulses of a gas on what it carries: the row that works it out anew, chains of pushes, momentum by origin, runs without the gas's driver."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.simulation.protocol import Intervention
from worldagent.simulation.variants import run_variant
from worldagent.testing.defects._gas_scenes import scene
from worldagent.testing.worlds.carried_worlds import JET_PROMPT, jet_spec
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.verifiers.categories.gas.check import category_rows
from worldagent.verifiers.categories.gas.frames import box_of
from worldagent.verifiers.categories.gas.pushed import given_by
from worldagent.verifiers.categories.gas.pushing import pushing_lines
from worldagent.verifiers.categories.registry import JUDGES
from worldagent.verifiers.ledgers.fields import blown_at
from worldagent.verifiers.ledgers.origins import Origin, origins_of
from worldagent.verifiers.story.chains import chains_of
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import WorldSpec


@pytest.fixture(scope="module")
def ball() -> Candidate:
    return scene("borne")


def pushed(candidate: Candidate) -> Any:
    return next(r for r in category_rows(candidate, "air") if r.id == "category:gas:pushed:air")


@pytest.mark.parametrize("kind", ["borne", "waved"])
def test_what_was_given_is_what_the_stream_gives(kind: str) -> None:
    row = pushed(scene(kind))
    assert row.status == "pass"
    assert 0.0 < row.measured < 0.02


def test_every_row_about_the_worlds_holds(ball: Candidate) -> None:
    pairs = [(judge, solver) for judge in JUDGES.values() for solver in judge.instances(ball.spec)]
    rows = [r for judge, solver in pairs for r in (*judge.category_rows(ball, solver), *judge.numerical_rows(ball, solver))]
    assert {"category:gas:pushed:air", "category:rigid:fields:bodies"} <= {r.id for r in rows if r.status == "pass"}
    assert [r.id for r in rows if r.status not in ("pass", "not_applicable")] == []


def test_a_gas_that_carries_nothing_is_not_asked() -> None:
    assert pushed(scene("room")).status == "not_applicable"


def test_more_than_the_stream_gives_is_found(ball: Candidate, tmp_path: Path) -> None:
    def more(frame: int, data: dict[str, Any]) -> None:
        data["field/impulse"] *= 1.1

    row = pushed(edited(ball, tmp_path, "bodies", more))
    assert row.status == "fail"
    assert row.measured == pytest.approx(0.1, abs=0.02)
    assert "ball" in row.evidence["explanation"]


def test_the_momentum_of_a_ball_comes_from_the_gas(ball: Candidate) -> None:
    """Without gravity all of it: what the origin tells is the change of its momentum."""
    found = origins_of(ball, "ball")
    given = found[Origin("fields", "air")].impulse
    speed = np.asarray(ball.caches["bodies"].series("velocity"))[:, 0]
    assert given.sum(axis=0) == pytest.approx(ball.body("ball", "body").mass * (speed[-1] - speed[0]), rel=1e-3, abs=1e-9)
    assert np.abs(given[:, 0]).sum() > 100 * np.abs(given[:, 1:]).sum()


def test_the_gas_pushes_the_ball_and_the_ball_not_the_gas(ball: Candidate) -> None:
    found = [p for frame in JUDGES["gas"].pushes(ball) for p in frame]
    assert {(p.a, p.b) for p in found} == {("smoke", "ball")}
    total = sum(p.impulse for p in found)
    assert total == pytest.approx(float(np.linalg.norm(given_by(box_of(ball, "air"))[0].recorded.sum(axis=0))), rel=0.02)
    assert ("ball", "smoke") in JUDGES["gas"].unfelt(ball.spec)
    # What the gas gives is no push of a field besides.
    assert blown_at(ball, "ball", 3) == {}


def test_a_chain_leads_from_the_gas_to_the_ball() -> None:
    """The smoke that leaves a source drifts, and so passes on."""
    candidate = scene("borne")
    reach = chains_of(candidate).spread(["smoke"], 0.0, candidate.last_frame, subject="ball", acting_until=candidate.last_frame)
    assert reach.time("ball") is not None
    (hop,) = reach.chain("ball")
    assert tuple(hop)[:2] == ("smoke", "ball")


def test_without_the_source_of_the_gas_the_ball_stays_where_the_jet_moved_it(tmp_path: Path) -> None:
    """The bodies are simulated anew because the gas is, which no driver of theirs tells."""
    document = jet_spec(frames=13, resolution=0.05, speed=8.0)
    jet = simulate(tmp_path, WorldSpec.model_validate({"prompt": JET_PROMPT, **document}))
    ways = [
        np.asarray(c.caches["bodies"].series("position"))[:, 0, 0]
        for c in (jet, run_variant(jet, Intervention(without=frozenset({"jet"})), start=0, end=jet.last_frame))
    ]
    assert ways[0][-1] - ways[0][0] > 0.02
    assert abs(ways[1][-1] - ways[1][0]) < 1e-4


def test_the_register_says_what_is_omitted_and_how_much_that_is(ball: Candidate) -> None:
    lines = pushing_lines(ball)
    assert "carries 'ball' and does not feel them" in lines[0]["what"]
    assert "N s in all" in lines[0]["effect"]
    assert pushing_lines(scene("room")) == []
