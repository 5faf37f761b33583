"""A gas that feels what it carries: it loses what that gets, where it is; what an engine does wrong is found; pushes and lines of the register."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.simulation.gas.reaction import YieldingGas
from worldagent.testing.defects._gas_scenes import scene
from worldagent.testing.worlds.carried_worlds import JET_PROMPT, stream_spec
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.verifiers.categories.cloth.register import cloth_lines
from worldagent.verifiers.categories.gas.check import category_rows
from worldagent.verifiers.categories.gas.pushing import pushing_lines
from worldagent.verifiers.categories.registry import JUDGES
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import WorldSpec


def rows_of(candidate: Candidate) -> dict[str, Any]:
    return {r.id.split(":")[2]: r for r in category_rows(candidate, "air")}


def small(folder: Path, thing: str = "ball") -> Candidate:
    document = stream_spec(thing=thing, frames=4)
    document["simulation"]["couplings"]["carries"]["direction"] = "two_way"
    return simulate(folder, WorldSpec.model_validate({"prompt": JET_PROMPT, **document}))


@pytest.mark.parametrize("kind", ["felt", "swarm", "draped", "deflected"])
def test_a_gas_loses_what_it_gives_and_every_row_holds(kind: str) -> None:
    candidate = scene(kind)
    found = rows_of(candidate)
    assert found["returned"].status == found["returned_there"].status == found["pushed"].status == "pass"
    assert found["returned"].measured < 1e-6
    pairs = [(judge, solver) for judge in JUDGES.values() for solver in judge.instances(candidate.spec)]
    rows = [
        r for judge, solver in pairs for r in (*judge.category_rows(candidate, solver), *judge.numerical_rows(candidate, solver))
    ]
    assert [r.id for r in rows if r.status not in ("pass", "not_applicable")] == []


def test_a_gas_that_feels_nothing_is_not_asked() -> None:
    assert "returned" not in rows_of(scene("borne"))


WRONG = {"dropped": 0.0, "doubled": 2.0, "reversed": -1.0}


@pytest.mark.parametrize("wrong", WRONG)
def test_an_engine_that_returns_it_wrongly_is_found(wrong: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The gas itself counts what its velocities took, so that no record hides it."""
    right, factor = YieldingGas._pay, WRONG[wrong]

    def pay(gas: YieldingGas, held: Any, mean: Any, rest: Any, sign: float) -> None:
        right(gas, held, mean, rest, factor * sign)

    monkeypatch.setattr(YieldingGas, "_pay", pay)
    row = rows_of(small(tmp_path))["returned"]
    assert row.status == "fail"
    assert row.measured == pytest.approx(abs(factor - 1.0), rel=0.01)
    assert "ball got" in row.evidence["explanation"]


def test_what_is_lost_elsewhere_is_found(tmp_path: Path) -> None:
    def aside(frame: int, data: dict[str, Any]) -> None:
        data["gas_returned"] = np.roll(data["gas_returned"], 9, axis=0)

    found = rows_of(edited(scene("felt"), tmp_path, "air", aside))
    assert found["returned"].status == "pass"
    assert found["returned_there"].status == "fail"
    assert found["returned_there"].measured == pytest.approx(1.0)


def test_work_of_what_falls_through_a_gas_explains_its_motion(tmp_path: Path) -> None:
    """Without it, air that grains take along moves by nothing."""
    assert rows_of(scene("swarm"))["energy"].status == "pass"

    def untold(frame: int, data: dict[str, Any]) -> None:
        data["gas_returned"] = 0.0 * data["gas_returned"]

    assert rows_of(edited(scene("swarm"), tmp_path, "air", untold))["energy"].status == "fail"


def test_both_push_each_other_and_the_register_says_so() -> None:
    felt, borne = scene("felt"), scene("borne")
    assert ("ball", "smoke") in JUDGES["gas"].unfelt(borne.spec)
    assert ("ball", "smoke") not in JUDGES["gas"].unfelt(felt.spec)
    lines = pushing_lines(felt)
    assert "feels the drag of 'ball', spread over the cells about each" in lines[0]["what"]
    assert "N s from it in all" in lines[0]["effect"]
    assert not any("does not feel" in line["what"] for line in lines)
    moved = [any("air is not moved by" in line["what"] for line in cloth_lines(scene(kind))) for kind in ("waved", "draped")]
    assert moved == [True, False]


@pytest.mark.parametrize("thing", ["ball", "sheet"])
def test_a_resumed_run_equals_an_unbroken_one(thing: str, tmp_path: Path) -> None:
    document = stream_spec(thing=thing, frames=15)
    document["simulation"]["couplings"]["carries"]["direction"] = "two_way"
    spec = WorldSpec.model_validate({"prompt": JET_PROMPT, **document})
    whole = simulate(tmp_path / "whole", spec)
    shutil.copytree(tmp_path / "whole", tmp_path / "part")
    assert {"air", "bodies"} <= set(whole.caches)
    for cache in whole.caches.values():
        there = tmp_path / "part" / cache.folder.relative_to(tmp_path / "whole")
        for frame in (13, 14):
            (there / cache.path(frame).name).unlink()
    part = simulate(tmp_path / "part", spec)
    pairs = [(cache.read(k), part.caches[name].read(k)) for name, cache in whole.caches.items() for k in (13, 14)]
    assert [one.keys() for one, _ in pairs] == [other.keys() for _, other in pairs]
    assert [n for a, b in pairs for n in a if not np.array_equal(np.asarray(a[n]), np.asarray(b[n]))] == []
