"""Bodies that move, and cloth, burn: their pieces go along, their books are kept, and what nothing lights does not burn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter
from worldagent.simulation.protocol import Intervention
from worldagent.simulation.variants import run_variant
from worldagent.testing.defects._gas_scenes import CELL, FRAMES, SOLVER, scene, scene_spec
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.testing.worlds.small_gas import KINDLED_PROMPT, hung_spec, torch_spec
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.categories.gas.check import category_rows
from worldagent.verifiers.categories.gas.frames import box_of
from worldagent.verifiers.categories.gas.judge import GasJudge
from worldagent.verifiers.categories.gas.kindling import Kindling
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.categories.gas.audit import gas_problems
from worldagent.worlds.categories.gas.burning import flammable_parts
from worldagent.worlds.predicates import Predicate
from worldagent.worlds.spec import WorldSpec

BURNING = ("torch", "hung")


def asked(candidate: Candidate, **fields: Any) -> Outcome:
    predicate: Any = TypeAdapter(Predicate).validate_python(fields)
    return evaluate(candidate, predicate, (0, FRAMES - 1))


def spec_of(document: dict[str, Any]) -> WorldSpec:
    return WorldSpec.model_validate({"prompt": KINDLED_PROMPT, **document})


@pytest.mark.parametrize("kind", BURNING)
def test_what_moves_and_cloth_burn_and_every_row_passes(kind: str) -> None:
    found = {r.id.split(":")[2]: r for r in category_rows(scene(kind), SOLVER)}
    assert {r.status for r in found.values() if r.mandatory} <= {"pass", "not_applicable"}
    assert {found[n].status for n in Kindling.questions} == {"pass"}
    assert found["gasified"].evidence["given_off_kg"] > 0.0


@pytest.mark.parametrize("kind", BURNING)
def test_mass_and_heat_are_kept_between_what_moves_and_the_gas(kind: str) -> None:
    """To rounding: gas is mass that was lost, heat that came is there or has made gas of it."""
    box = box_of(scene(kind), SOLVER)
    surfaces, last = box.surfaces, box.frames - 1
    assert surfaces is not None
    lost = surfaces.lost()[last]
    assert box.record("gasified_fuel")[last] == pytest.approx(lost, rel=1e-9)
    took = box.record("taken_heat")[last] + box.record("taken_light")[last]
    assert took == pytest.approx(box.record("surface_heat")[last] + box.record("gasification_heat")[last], rel=1e-9)
    cost = scene_spec(kind)["materials"]["paper"]["flammable"]["gasification"]
    assert box.record("gasification_heat")[last] == pytest.approx(cost * lost, rel=1e-9)


@pytest.mark.parametrize("kind", BURNING)
def test_pieces_go_along_with_what_carries_them(kind: str) -> None:
    """They move by centimetres, and keep their places on its surface to rounding."""
    box = box_of(scene(kind), SOLVER)
    surfaces = box.surfaces
    assert surfaces is not None
    way = np.linalg.norm(surfaces.state[-1].point - surfaces.state[0].point, axis=1)
    assert way.max() > 0.5 * CELL
    assert max(surfaces.carried.astray(k).max() for k in range(FRAMES)) < 1e-9


def test_cloth_is_consumed_where_it_burns_longest() -> None:
    surfaces = box_of(scene("hung"), SOLVER).surfaces
    assert surfaces is not None
    gone = surfaces.state[-1].left == 0.0
    assert 0 < gone.sum() < len(gone)
    share = surfaces.share("sheet")[-1]
    assert share == pytest.approx(asked(scene("hung"), kind="burnt_share", entity="sheet", min=0.05).value, rel=1e-12)
    assert surfaces.area[gone].sum() / surfaces.area.sum() <= share < 1.0


@pytest.mark.parametrize(
    ("fields", "status"),
    [
        ({"kind": "burnt_share", "entity": "sheet", "min": 0.02}, "pass"),
        ({"kind": "burnt_share", "entity": "sheet", "min": 0.9}, "fail"),
        ({"kind": "burnt_share", "entity": "sheet", "max": 0.001, "when": "always"}, "fail"),
        ({"kind": "burnt_share", "entity": "smoke", "min": 0.02}, "fail"),
        ({"kind": "burnt_share", "entity": "floor", "min": 0.02}, "fail"),
    ],
)
def test_burnt_share_is_that_of_the_mass_that_can_become_gas(fields: dict[str, Any], status: str) -> None:
    assert asked(scene("hung"), **fields).status == status


def test_without_the_spark_the_cloth_stays_whole_and_with_it_the_run_is_the_same() -> None:
    base, names = scene("hung"), ("burning_left", "burning_point", "gas_fuel")
    cold, again = (
        run_variant(base, Intervention(without=frozenset(w)), start=0, end=FRAMES - 1).caches[SOLVER] for w in ({"spark"}, ())
    )
    first, end = base.caches[SOLVER].read(0, names), base.caches[SOLVER].read(FRAMES - 1, names)
    assert all(np.array_equal(again.read(FRAMES - 1, names)[n], end[n]) for n in names)
    assert (end["burning_left"] < first["burning_left"]).any()
    assert np.array_equal(cold.read(FRAMES - 1, names)["burning_left"], first["burning_left"])
    assert np.array_equal(cold.read(FRAMES - 1, names)["burning_point"], end["burning_point"])


def test_a_body_that_falls_past_a_fire_takes_its_pieces_along(tmp_path: Path) -> None:
    document = torch_spec(frames=6, motion="dynamic", thick=4e-3, gap=0.02)
    document["entities"]["sheet"]["pose"]["position"][2] = 0.7
    found = simulate(tmp_path, spec_of(document))
    surfaces = box_of(found, SOLVER).surfaces
    assert surfaces is not None
    fallen = surfaces.state[0].point[:, 2] - surfaces.state[-1].point[:, 2]
    assert fallen == pytest.approx(0.5 * 9.81 * (5 / 24) ** 2, rel=0.05)
    rows = {r.id.split(":")[2]: r.status for r in category_rows(found, SOLVER)}
    assert {rows[n] for n in Kindling.questions} == {"pass"}


def test_cloth_that_nothing_couples_is_told_with_the_coupling_that_it_needs() -> None:
    document = hung_spec()
    coupling = document["simulation"].pop("couplings")["burns"]
    spec = spec_of(document)
    assert flammable_parts(spec, SOLVER) == {}
    (problem,) = [p for p in gas_problems(spec) if p.pointer == "/simulation/couplings"]
    assert problem.patch is not None
    assert problem.patch["value"] == coupling
    assert gas_problems(spec_of(hung_spec())) == []


@pytest.mark.parametrize(
    ("field", "value", "least"), [("char", 0.0, 0.02), ("gasification", 3.0e5, 1.25 * 1300.0 * (623.0 - 293.15))]
)
def test_cloth_that_nothing_would_be_left_of_is_refused(field: str, value: float, least: float) -> None:
    document = hung_spec()
    document["materials"]["paper"]["flammable"][field] = value
    (problem,) = gas_problems(spec_of(document))
    assert problem.pointer == f"/materials/paper/flammable/{field}"
    assert problem.patch is not None
    assert problem.patch["value"] >= least
    document["materials"]["paper"]["flammable"][field] = problem.patch["value"]
    assert gas_problems(spec_of(document)) == []


def test_what_moves_burns_in_one_gas_alone() -> None:
    document = torch_spec()
    entities, plan = document["entities"], document["simulation"]
    entities["other"] = {**entities["smoke"], "pose": {"position": [3.0, 0.0, 0.1]}}
    domain = {**plan["solvers"][SOLVER]["settings"]["domain"], "center": [3.0, 0.0, 0.6]}
    plan["solvers"]["elsewhere"] = {"engine": "gas", "members": ["other"], "settings": {"domain": domain}}
    plan["drivers"] |= {
        "more": {**plan["drivers"]["fire"], "entity": "other"},
        "pilot": {**plan["drivers"]["spark"], "entity": "other", "center": [3.0, 0.0, 0.1]},
    }
    told = [p.text for p in gas_problems(spec_of(document))]
    assert [t for t in told if "books would both count its mass" in t]


@pytest.mark.parametrize("kind", BURNING)
def test_the_register_tells_how_much_mass_motion_does_not_feel(kind: str) -> None:
    base = scene(kind)
    surfaces = box_of(base, SOLVER).surfaces
    assert surfaces is not None
    share = surfaces.lost("sheet")[-1] / sum(p.mass for p in surfaces.parts)
    (line,) = [n for n in GasJudge().lines(base) if "does not feel that it burns" in n["what"]]
    assert f"{share:.1%} of its mass" in line["effect"]
