"""Solids that catch fire: their mass is their gas, their heat that of the fire, and what nothing heats does not burn."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter
from worldagent.simulation.protocol import Intervention
from worldagent.simulation.variants import run_variant
from worldagent.testing.defects._gas_scenes import FRAMES, SOLVER, scene, scene_spec
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.testing.worlds.small_gas import KINDLED_PROMPT
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.categories.gas.check import category_rows
from worldagent.verifiers.categories.gas.frames import box_of
from worldagent.verifiers.categories.gas.kindling import Kindling
from worldagent.verifiers.categories.gas.pushing import Pushing
from worldagent.verifiers.categories.gas.steaming import Steaming
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.verifiers.scene.relations import check
from worldagent.verifiers.story.chains import chains_of
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Predicate
from worldagent.worlds.spec import WorldSpec

SPAN = (0, FRAMES - 1)


def asked(candidate: Candidate, **fields: Any) -> Outcome:
    predicate: Any = TypeAdapter(Predicate).validate_python(fields)
    return evaluate(candidate, predicate, SPAN)


def rows(candidate: Candidate) -> dict[str, Any]:
    return {r.id.split(":")[2]: r for r in category_rows(candidate, SOLVER)}


def test_a_sheet_beside_a_fire_burns_and_every_row_passes() -> None:
    kindled = scene("kindled")
    found = rows(kindled)
    assert {n: r.status for n, r in found.items() if r.status != "pass" and r.mandatory} == dict.fromkeys(
        ["outflow", *Steaming.questions, *Pushing.questions], "not_applicable"
    )
    assert {found[n].status for n in Kindling.questions} == {"pass"}
    assert found["gasified"].evidence["given_off_kg"] > 0.0
    assert asked(kindled, kind="burns", entity="sheet").status == "pass"


def test_a_sheet_far_from_the_fire_warms_and_does_not_burn() -> None:
    spared = scene("spared")
    assert asked(spared, kind="burns", entity="sheet").status == "fail"
    surfaces = box_of(spared, SOLVER).surfaces
    assert surfaces is not None
    assert surfaces.lost().max() == 0.0
    assert surfaces.state[-1].temperature.max() > 300.0


def test_mass_and_heat_are_kept_between_solid_and_gas() -> None:
    """The mass that the sheet lost is fuel of the gas; the heat that gas and flames gave it is in it or has made gas."""
    box = box_of(scene("kindled"), SOLVER)
    surfaces = box.surfaces
    assert surfaces is not None
    lost, last = surfaces.lost()[-1], box.frames - 1
    assert box.record("gasified_fuel")[last] == pytest.approx(lost, rel=1e-9)
    own = box.record("emitted_fuel")[last] - lost
    volume = sum(s.emitted(last * box.duration) for s in box.sources)
    assert own == pytest.approx(volume * box.source_tracer("smoke"), rel=1e-6)
    took = box.record("taken_heat")[last] + box.record("taken_light")[last]
    held = box.record("surface_heat")[last] + box.record("gasification_heat")[last]
    assert took == pytest.approx(held, rel=1e-9)
    assert box.record("gasification_heat")[last] == pytest.approx(2.0e5 * lost, rel=1e-9)
    assert box.record("taken_light")[last] < box.record("lost_heat")[last]


def test_no_fire_no_gas() -> None:
    """Without the spark nothing lights the fire, and the sheet stays as it was; the run with it is the same to the byte."""
    base = scene("kindled")
    cold, again = (run_variant(base, Intervention(without=frozenset(w)), start=0, end=6).caches[SOLVER] for w in ({"spark"}, ()))
    names = ("burning_left", "burning_heat", "gas_fuel")
    end, known = (c.read(6, names) for c in (again, base.caches[SOLVER]))
    assert all(np.array_equal(end[n], known[n]) for n in names)
    assert (known["burning_left"] < base.caches[SOLVER].read(0, names)["burning_left"]).any()
    assert np.array_equal(cold.read(6, names)["burning_left"], base.caches[SOLVER].read(0, names)["burning_left"])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda s: s["materials"]["paper"].pop("flammable"), "cannot burn"),
        (lambda s: s["materials"]["paper"]["flammable"].update(fuel="heptane"), "cannot burn"),
    ],
)
def test_what_is_not_flammable_cannot_burn(tmp_path: Path, change: Any, words: str) -> None:
    document = scene_spec("kindled")
    change(document)
    document["simulation"]["frames"] = 3
    found = simulate(tmp_path, WorldSpec.model_validate({"prompt": KINDLED_PROMPT, **document}))
    outcome = evaluate(found, TypeAdapter(Predicate).validate_python({"kind": "burns", "entity": "sheet"}), (0, 2))
    assert (outcome.status, words in outcome.explanation) == ("fail", True)
    assert {rows(found)[n].status for n in Kindling.questions} == {"not_applicable"}


def test_finer_pieces_burn_alike(tmp_path: Path) -> None:
    """Pieces as wide as a cell or half of it: the sheet takes the same heat."""
    from worldagent.simulation.gas import kindling, pieces

    taken = []
    for share in (1.0, 0.5):
        with pytest.MonkeyPatch.context() as patch:
            cut = pieces.cut_into_pieces
            patch.setattr(kindling, "cut_into_pieces", lambda mesh, widest, cut=cut, share=share: cut(mesh, share * widest))
            spec = WorldSpec.model_validate({"prompt": KINDLED_PROMPT, **scene_spec("spared")})
            box = box_of(simulate(tmp_path / str(share), spec), SOLVER)
        taken.append(box.record("surface_heat")[-1])
    assert np.ptp(taken) < 0.05 * max(taken)


@pytest.mark.parametrize(("gap", "status"), [(0.05, "pass"), (0.01, "fail")])
def test_a_source_of_gas_stands_beside_a_body_by_its_declared_box(gap: float, status: str) -> None:
    """The source has no surface of its own; the sheet stands 0.03 m from it."""
    base = scene("kindled")
    relation = {"kind": "adjacent", "a": "sheet", "b": "smoke", "gap": gap}
    document = {"prompt": KINDLED_PROMPT, **scene_spec("kindled"), "graph": {"relations": {"beside": relation}}}
    (row,) = check(replace(base, spec=WorldSpec.model_validate(document)))
    assert (row.status, row.measured) == (status, pytest.approx(0.03, abs=1e-6))


def test_the_fire_is_what_sets_the_sheet_on_fire() -> None:
    """A chain leads from the gas to the sheet by heat, and none to a sheet that stays cold."""
    kindled = chains_of(scene("kindled")).spread(["smoke"], 0.0, FRAMES - 1, subject="sheet", acting_until=FRAMES - 1)
    assert kindled.time("sheet") is not None
    assert [h.impulse for h in kindled.chain("sheet")] == [None]
    assert not kindled.negligible


def test_a_sheet_that_does_not_burn_says_how_warm_it_became() -> None:
    text = asked(scene("spared"), kind="burns", entity="sheet").explanation
    assert "gives off gas from 420 K on" in text
