"""Sheets of one instance told apart: who falls freely, who is carried down; and what air is advised for."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
from worldagent.construction import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_cloth import drape_spec
from worldagent.verifiers.categories.cloth.diagnosis import sheet_names
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.verifiers.story import beats
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.predicates import BodyEvent
from worldagent.worlds.spec import WorldSpec

LAST = 17


def _spec(*, second: bool = True, **sheet: Any) -> dict[str, Any]:
    """A light cloth high over a ball in still air; with it a second one, which a tray on a path takes down slowly."""
    spec = drape_spec(frames=LAST + 1, resolution=0.2)
    spec["prompt"] = "A cloth falls over a ball and drapes it."
    cloth = spec["entities"]["cloth"]
    cloth["pose"]["position"] = [0.0, 0.0, 1.6]
    cloth["physics"] |= {"area_density": 0.05, **sheet}
    if not second:
        return spec
    spec["entities"]["second"] = deepcopy(cloth)
    spec["entities"]["second"]["pose"]["position"] = [2.0, 0.0, 1.0]
    size = [1.2, 1.2, 0.04]
    spec["entities"]["tray"] = {
        "role": "tray", "motion": "kinematic", "material": "stone", "dimensions": {"size": size},
        "pose": {"position": [2.0, 0.0, 0.974]}, "parts": {"body": {"shape": {"kind": "box", "size": size}}},
    }  # fmt: skip
    plan = spec["simulation"]
    plan["solvers"]["cloth"]["members"].append("second")
    plan["solvers"]["rigid"]["members"].append("tray")
    keys = {f"k{k}": {"time": t, "pose": {"position": [2.0, 0.0, z]}} for k, (t, z) in enumerate([(0.0, 0.974), (0.75, 0.78)])}
    plan["drivers"]["lower"] = {"kind": "path", "entity": "tray", "keys": keys}
    return spec


def _run(folder: Path, document: dict[str, Any]) -> Candidate:
    spec = WorldSpec.model_validate(document)
    built = {n: build_entity(spec, n, folder) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return Candidate(folder, spec, built, "probe", caches, "run", cache_digest(caches))


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return _run(tmp_path_factory.mktemp("pair"), _spec())


def _falls(candidate: Candidate, entity: str, way: float = 0.3) -> Outcome:
    return evaluate(candidate, BodyEvent(kind="falls", entity=entity, min=way), (0, LAST))


def test_a_light_sheet_that_air_slows_falls_though_the_record_of_air_is_that_of_two(pair: Candidate) -> None:
    outcome = _falls(pair, "cloth")
    assert outcome.status == "pass"
    assert outcome.value is not None
    assert outcome.value > 0.3


def test_a_sheet_that_a_tray_takes_down_does_not_fall(pair: Candidate) -> None:
    # It goes down by 0.19 m, as slowly as the tray, which bears the most of it.
    assert _falls(pair, "second", 0.1).status == "fail"
    assert pair.center("second", 0)[2] - pair.center("second", LAST)[2] > 0.15


def test_sheets_side_by_side_are_not_told_apart(tmp_path: Path) -> None:
    document = _spec()
    document["entities"]["second"]["pose"]["position"] = [0.0, 0.0, 1.602]
    document["entities"]["tray"]["pose"]["position"] = [2.0, 0.0, 0.974]
    close = _run(tmp_path, document)
    assert _falls(close, "cloth").status == "fail"


def _short(folder: Path, kind: str, **sheet: Any) -> Any:
    """The row of a beat that asks more of the cloth than it does, with its causes."""
    document = _spec(second=False, **sheet)
    asked: dict[str, Any] = {"kind": kind, "entity": "cloth"}
    asked |= {"point": [0.0, 0.0, 0.0], "min_amplitude": 0.5} if kind == "flutters" else {"min": 5.0}
    document["story"]["beats"]["event"]["predicate"] = asked
    candidate = _run(folder, document)
    (row,) = [r for r in beats.check(candidate) if r.id == "beat:event"]
    assert row.status == "fail"
    return diagnose(row, candidate.spec), candidate


def test_a_sheet_that_falls_too_short_a_way_is_raised_and_not_given_a_wind(tmp_path: Path) -> None:
    row, candidate = _short(tmp_path, "falls")
    assert not [c for c in row.corrections if "wind" in c.action]
    (raised,) = [c for c in row.corrections if c.group == "placement"]
    assert raised.patch[0]["path"] == "/entities/cloth/pose/position/2"
    assert raised.patch[0]["value"] == pytest.approx(1.6 + row.bound)
    assert "becalmed" not in {k for k, v in sheet_names(candidate.spec, "cloth", row).items() if v}


def test_a_sheet_that_does_not_flutter_in_still_air_is_given_a_wind(tmp_path: Path) -> None:
    row, _ = _short(tmp_path, "flutters")
    assert [c for c in row.corrections if "wind" in c.action]
