"""Two faults that have nothing to do with each other are mended in one edit; what has, or reaches further, is refused."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.conftest import Agent
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.workflow.joint_repairs import said_of
from worldagent.workflow.session import Session

PROMPT = "A ball hits a block. A sled slides."
MARKED = "A [ball](thing ball) [hits](event hit) a [block](thing block). A [sled](thing sled) [slides](event slide)."
FRAMES = 30
FASTER = {"op": "replace", "path": "/entities/ball/physics/linear_velocity", "value": [1.2, 0, 0]}
SMOOTHER = {"op": "replace", "path": "/materials/ice/friction", "value": 0.15}
HIT = {"row": "beat:hit", "group": "initial_state", "expect": "higher", "hypothesis": "the ball is too slow to come there"}
SLIDE = {"row": "beat:slide", "group": "material", "expect": "higher", "hypothesis": "friction stops the sled early"}


def _body(role: str, material: str, shape: dict[str, Any], size: list[float], at: list[float], **physics: Any) -> dict[str, Any]:
    return {
        "role": role, "motion": "dynamic", "material": material, "dimensions": {"size": size}, "pose": {"position": at},
        "parts": {"body": {"shape": shape}}, "physics": {"category": "rigid", **physics},
    }  # fmt: skip


def _yard() -> dict[str, Any]:
    box = {"kind": "box", "size": [0.2, 0.2, 0.1]}
    floor = _body("floor", "stone", {"kind": "box", "size": [8, 8, 0.2]}, [8, 8, 0.2], [0, 0, -0.1]) | {"motion": "static"}
    beats = {
        "hit": {"text": "the ball hits the block", "owner": "rigid", "subject": "ball", "frames": [1, 12],
                "predicate": {"kind": "contact", "a": "ball", "b": "block", "min_impulse": 0.05}},
        "slide": {"text": "the sled slides", "owner": "rigid", "subject": "sled", "frames": [1, 25],
                  "predicate": {"kind": "slides", "entity": "sled", "min": 0.25}},
    }  # fmt: skip
    return {
        "title": "A yard", "spec_version": "2", "story": {"beats": beats},
        "materials": {
            "stone": {"density": 2600, "substance": "stone", "friction": 0.1, "appearance": {"color": [0.4, 0.4, 0.4]}},
            "steel": {"density": 7850, "substance": "steel", "friction": 0.1, "rolling_friction": 0.0005},
            "ice": {"density": 917, "substance": "ice", "friction": 0.9},
        },
        "entities": {
            "floor": floor,
            "ball": _body("ball", "steel", {"kind": "sphere", "radius": 0.05}, [0.1] * 3, [-0.5, 1, 0.051], linear_velocity=[0.3, 0, 0]),
            "block": _body("block", "steel", {"kind": "box", "size": [0.1] * 3}, [0.1] * 3, [0, 1, 0.051]),
            "sled": _body("sled", "ice", box, [0.2, 0.2, 0.1], [0, -1, 0.051], linear_velocity=[1.2, 0, 0]),
        },
        "graph": {"relations": {
            **{f"on_{n}": {"kind": "supports", "a": "floor", "b": n} for n in ("ball", "block", "sled")},
            "meet": {"kind": "interacts", "a": "ball", "b": "block"},
        }},
        "shots": {"only": {"frames": [0, FRAMES - 1], "covers": ["hit", "slide"], "intent": "all of it",
                           "keys": {"a": {"frame": 0, "position": [0, -4, 3], "target": [0, 0, 0], "fov_deg": 50}}}},
        "simulation": {"fps": 24, "frames": FRAMES, "solvers": {"rigid": {
            "engine": "mujoco", "members": ["floor", "ball", "block", "sled"], "settings": {"step": 0.0005, "skin": 0.0005}}}},
        "look": {"sky": "studio", "width": 64, "height": 64, "samples": 2},
    }  # fmt: skip


@pytest.fixture
def yard(agent: Agent, monkeypatch: pytest.MonkeyPatch) -> Agent:
    """A client whose world `w` failed twice in its probe: the ball comes too late, the sled stops too early."""
    run_jobs_inline(monkeypatch)
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=_yard(), claims=MARKED)
    agent.call("place_object", world="w")
    found = agent.call("probe_sim", world="w")
    assert {"beat:hit", "beat:slide"} <= {r["id"] for r in found["open_rows"]}
    return agent


def test_independent_faults_are_mended_at_once_and_each_hears_of_its_own(yard: Agent) -> None:
    text = yard.refused("edit_spec", world="w", patch=[FASTER, SMOOTHER], hypothesis="too slow and too rough")
    assert "repairs=[" in text
    yard.call("edit_spec", world="w", patch=[FASTER, SMOOTHER], repairs=[HIT, SLIDE])
    found = yard.call("probe_sim", world="w")
    said = {r["row"]: r for r in found["repairs"]}
    assert {n: (r["said"], r["group"]) for n, r in said.items()} == {
        "beat:hit": ("confirmed", "initial_state"), "beat:slide": ("confirmed", "material"),
    }  # fmt: skip
    assert said["beat:slide"]["after"] > 0.25 > said["beat:slide"]["before"]
    kept = yard.call("inspect_world", world="w", part="iterations")["iterations"]
    assert {i["said"]["row"] for i in kept} == {"beat:hit", "beat:slide"}


def test_a_repair_may_name_the_field_that_it_changes(yard: Agent) -> None:
    """Two agents of trials wrote the field's name, and read the list of groups in a refusal."""
    fields = [{**HIT, "group": "linear_velocity"}, {**SLIDE, "group": "/materials/ice/friction"}]
    yard.call("edit_spec", world="w", patch=[FASTER, SMOOTHER], repairs=fields)
    kept = Session.open(yard.workspace, "w").ledger.open_iterations()
    assert {i["grp"] for i in kept} == {"initial_state", "material"}


def test_a_repair_may_answer_a_row_that_is_not_mandatory(yard: Agent) -> None:
    session = Session.open(yard.workspace, "w")
    slide = next(r for r in session.ledger.rows() if r.id == "beat:slide")
    session.ledger.put_rows([slide.model_copy(update={"mandatory": False})], revision=session.revision, stage="probe")
    yard.call("edit_spec", world="w", patch=[FASTER, SMOOTHER], repairs=[HIT, SLIDE])
    found = yard.call("probe_sim", world="w")
    assert {r["row"]: r["said"] for r in found["repairs"]} == {"beat:hit": "confirmed", "beat:slide": "confirmed"}


def test_a_repair_that_does_not_what_it_promised_is_refuted_beside_one_that_does(yard: Agent) -> None:
    rougher = {**SMOOTHER, "value": 1.0}
    yard.call("edit_spec", world="w", patch=[FASTER, rougher], repairs=[HIT, SLIDE])
    found = yard.call("probe_sim", world="w", sketch={"until": "slide"})
    assert {r["row"]: r["said"] for r in found["repairs"]} == {"beat:hit": "confirmed", "beat:slide": "refuted"}


@pytest.mark.parametrize(
    ("patch", "repairs", "told"),
    [
        ([FASTER, {**SMOOTHER, "path": "/materials/steel/friction"}], [HIT, SLIDE], "material reaches ball, block, which had no part in beat:slide"),
        ([FASTER, SMOOTHER, {"op": "add", "path": "/simulation/solvers/rigid/settings/step", "value": 0.0004}],
         [HIT, SLIDE, {**SLIDE, "group": "step", "row": "beat:slid"}], "repairs name row 'beat:slid', which does not fail"),
        ([FASTER, {"op": "add", "path": "/simulation/solvers/rigid/settings/step", "value": 0.0004}],
         [HIT, {**SLIDE, "group": "step"}], "step acts on the whole world, so that it is changed alone"),
        ([FASTER, SMOOTHER], [HIT, {**SLIDE, "group": "mass"}], "group 'mass', which this edit does not change; it changes initial_state (/entities/ball/physics/linear_velocity); material (/materials/ice/friction)"),
        ([FASTER, SMOOTHER], [HIT, {**HIT, "group": "material"}], "repairs name 'beat:hit' twice"),
        ([FASTER, SMOOTHER, {"op": "add", "path": "/entities/block/physics/mass", "value": 3.0}], [HIT, SLIDE], "the change of mass (/entities/block/physics/mass) answers no row"),
    ],
)  # fmt: skip
def test_what_has_to_do_with_each_other_or_reaches_further_is_refused(
    yard: Agent, patch: list[dict[str, Any]], repairs: list[dict[str, Any]], told: str
) -> None:
    assert told in yard.refused("edit_spec", world="w", patch=patch, repairs=repairs)


def test_rows_whose_bodies_met_before_they_failed_are_not_independent(agent: Agent, monkeypatch: pytest.MonkeyPatch) -> None:
    run_jobs_inline(monkeypatch)
    spec = _yard()
    spec["entities"]["sled"]["pose"]["position"] = [0.25, 1, 0.051]  # the ball pushes the block against it
    spec["entities"]["ball"]["physics"]["linear_velocity"] = [4.0, 0, 0]
    spec["entities"]["sled"]["physics"]["linear_velocity"] = [0, 0, 0]
    spec["story"]["beats"]["hit"]["predicate"]["min_impulse"] = 50.0
    spec["story"]["beats"]["slide"]["predicate"]["min"] = 3.0
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=spec, claims=MARKED)
    agent.call("probe_sim", world="w")
    text = agent.refused("edit_spec", world="w", patch=[FASTER, SMOOTHER], repairs=[HIT, SLIDE])
    assert "not independent" in text
    assert "sled" in text


@pytest.mark.parametrize(
    ("after", "said"),
    [
        ({"status": "pass", "measured": 1.0}, "confirmed"),
        ({"status": "fail", "measured": 1.5}, "confirmed"),
        ({"status": "fail", "measured": 2.0}, "refuted"),
        ({"status": "fail", "measured": None}, "refuted"),
        (None, "untested"),
    ],
)
def test_the_outcome_of_a_repair(after: dict[str, Any] | None, said: str) -> None:
    kept = {
        "expect": "lower", "probe": "p", "grp": "step", "failing_before": ["a"], "before": {"a": {"status": "fail", "measured": 2.0}},
        "after": {} if after is None else {"a": after},
    }  # fmt: skip
    found = said_of(kept)
    assert found is not None
    assert found["said"] == said
    assert said_of({**kept, "probe": None}) is None
    assert said_of({**kept, "expect": ""}) is None
