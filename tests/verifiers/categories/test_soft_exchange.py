"""Soft matter that meets other matter: small simulated worlds that pass, and copies broken in one way that fail."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.simulated_worlds import edited
from worldagent.testing.worlds.small_soft import HAMMOCK_PROMPT, HIGH, hammock_spec
from worldagent.verifiers.categories.cloth import check as cloth
from worldagent.verifiers.categories.elastic import check as elastic
from worldagent.verifiers.categories.particles import check as particles
from worldagent.verifiers.categories.registry import judge_of
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.story.phase_contacts import first_contact
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.predicates import Contact, TouchEvent

Edit = Callable[[int, dict[str, Any]], None]


def simulate(folder: Path, given: dict[str, Any]) -> Candidate:
    """The motion that a specification leads to."""
    spec = parse_spec({**given, "prompt": HAMMOCK_PROMPT})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return Candidate(folder, spec, built, "probe", caches, "run", cache_digest(caches))


@pytest.fixture(scope="module")
def caught(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A jelly that has just reached the cloth that it drops on."""
    spec = hammock_spec(frames=5, edge=0.055, drop=0.002, radius=None)
    return simulate(tmp_path_factory.mktemp("caught"), spec)


def test_a_jelly_is_told_apart_among_what_a_cloth_presses(caught: Candidate) -> None:
    pressed = [t for t in judge_of(caught.spec, "cloth").touches(caught) if t.body == "jelly"]
    assert len(pressed) == 1
    assert not pressed[0].pressed[0]
    assert pressed[0].pressed.any()
    assert not [t for t in judge_of(caught.spec, "cloth").touches(caught) if t.body == "posts"], "they hold its pins"


@pytest.mark.slow
def test_a_jelly_lands_on_the_cloth_that_takes_its_fall(tmp_path: Path) -> None:
    """It is the first contact of the run, too."""
    spec = hammock_spec(frames=13, edge=0.055, drop=0.02, radius=None)
    spec["entities"]["cloth"]["physics"] |= {
        "damping": 0.01,
        "stretch_stiffness": 4000.0,
        "pins": {"a": {"edge": "-x"}, "b": {"edge": "+x"}},
    }
    spec["entities"]["jelly"]["physics"] |= {"damping": 0.05, "resolution": 0.06}
    spec["graph"] = {"relations": {"meet": {"kind": "interacts", "a": "jelly", "b": "cloth"}}}
    dropped = simulate(tmp_path, spec)
    last = dropped.last_frame
    landed = evaluate(dropped, TouchEvent(kind="lands", entity="jelly", other="cloth"), (0, last))
    assert landed.status == "pass", landed.explanation
    assert evaluate(dropped, TouchEvent(kind="lands", entity="jelly", other="ground"), (0, last)).status == "fail"
    assert evaluate(dropped, TouchEvent(kind="lands", entity="jelly", other="cloth"), (0, 4)).status == "fail"
    met = first_contact(dropped, 0, 0)
    assert met is not None
    assert "jelly" in met.text
    assert 1 < met.frame < 5


@pytest.fixture(scope="module")
def strewn(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """Grains that fall between a jelly below them and a cloth above it, which they meet one way."""
    spec = hammock_spec(frames=3, edge=0.055, radius=0.012)
    spec["entities"]["sand"]["pose"]["position"] = [0.0, 0.0, HIGH + 0.045]
    spec["entities"]["sand"]["parts"]["bed"]["shape"]["size"] = spec["entities"]["sand"]["dimensions"]["size"] = [
        0.12,
        0.12,
        0.05,
    ]
    spec["entities"]["jelly"]["pose"]["position"] = [0.0, 0.0, 0.15]
    spec["simulation"]["preroll"] = 0.0
    spec["simulation"]["couplings"] = {
        "led": {"source": "cloth", "target": "grains", "direction": "one_way", "variables": ["motion"]}
    }
    return simulate(tmp_path_factory.mktemp("strewn"), spec)


def on_cloth(couplings: dict[str, Any]) -> dict[str, Any]:
    """A handful of grains just over a cloth, and nothing below it."""
    spec = hammock_spec(frames=4, edge=0.055, radius=0.012)
    bed = spec["entities"]["sand"]
    bed["pose"]["position"] = [0.0, 0.0, HIGH + 0.035]
    bed["parts"]["bed"]["shape"]["size"] = bed["dimensions"]["size"] = [0.12, 0.12, 0.04]
    del spec["entities"]["jelly"]
    spec["simulation"]["solvers"]["bodies"]["members"].remove("jelly")
    return {**spec, "simulation": {**spec["simulation"], "preroll": 0.0, "drivers": {}, "couplings": couplings}}


@pytest.mark.slow
def test_grains_that_lie_on_a_cloth_which_feels_them_pass(tmp_path: Path) -> None:
    pairs = (("cloth", "bodies"), ("bodies", "grains"), ("cloth", "grains"))
    felt = {f"{a}_{b}": {"source": a, "target": b, "direction": "two_way", "variables": ["motion", "wrench"]} for a, b in pairs}
    rows = particles.category_rows(simulate(tmp_path, on_cloth(felt)), "grains")
    assert [(r.id, r.evidence.get("explanation")) for r in rows if r.status == "fail"] == []
    declared = next(r for r in rows if r.id.endswith("declared:grains"))
    assert declared.status == "pass"


def verdicts(rows: list[Any]) -> dict[str, str]:
    return {r.id.split(":")[2]: r.status for r in rows}


def test_what_a_cloth_and_a_jelly_give_each_other_is_judged(caught: Candidate) -> None:
    rows = verdicts(elastic.category_rows(caught, "bodies"))
    assert {rows[n] for n in ("exchange", "together", "energy", "records", "shape", "self")} == {"pass"}
    assert verdicts(cloth.category_rows(caught, "cloth"))["solids"] == "pass"
    assert verdicts(cloth.category_rows(caught, "cloth"))["momentum"] == "pass"


def test_a_jelly_touches_the_cloth_that_it_drops_on(caught: Candidate, tmp_path: Path) -> None:
    """By the cloth's record: without it nothing tells a contact."""

    def silent(frame: int, data: dict[str, Any]) -> None:
        data["exchange/impulse"][:] = 0.0

    cloth_id = next(n for n, e in caught.spec.entities.items() if e.physics.category == "cloth")
    asked = Contact(a="jelly", b=cloth_id, min_impulse=1e-3)
    assert evaluate(caught, asked, (0, 4)).status == "pass"
    assert evaluate(edited(caught, tmp_path, "cloth", silent), asked, (0, 4)).status == "fail"


def test_an_impulse_that_was_given_and_not_received_is_told(caught: Candidate, tmp_path: Path) -> None:
    def lost(frame: int, data: dict[str, Any]) -> None:
        data["exchange/soft"] = data["exchange/soft"] * (0.9 if frame == 4 else 1.0)

    rows = {r.id.split(":")[2]: r for r in elastic.category_rows(edited(caught, tmp_path, "bodies", lost), "bodies")}
    assert (rows["exchange"].status, rows["exchange"].first_failing_frame) == ("fail", 4)
    assert rows["exchange"].measured == pytest.approx(0.1, rel=1e-6)


def test_energy_that_comes_from_the_exchange_is_told(caught: Candidate, tmp_path: Path) -> None:
    def stored(frame: int, data: dict[str, Any]) -> None:
        data["record/stretch_energy"] = np.float64(data["record/stretch_energy"] + (0.1 if frame == 3 else 0.0))

    rows = {r.id.split(":")[2]: r for r in elastic.category_rows(edited(caught, tmp_path, "cloth", stored), "bodies")}
    assert (rows["together"].status, rows["together"].first_failing_frame) == ("fail", 3)


def test_cloth_in_a_jelly_is_told(caught: Candidate, tmp_path: Path) -> None:
    def sunk(frame: int, data: dict[str, Any]) -> None:
        data["vertex/position"] = data["vertex/position"] - [0.0, 0.0, 0.02 if frame == 2 else 0.0]

    broken = edited(caught, tmp_path, "bodies", sunk)
    rows = {r.id.split(":")[2]: r for r in cloth.category_rows(broken, "cloth")}
    assert (rows["solids"].status, rows["solids"].first_failing_frame) == ("fail", 2)
    assert "jelly" in rows["solids"].evidence["explanation"]


def test_grains_outside_a_jelly_and_over_a_cloth_pass(strewn: Candidate) -> None:
    assert verdicts(particles.category_rows(strewn, "grains"))["inside"] == "pass"


def test_grains_in_a_jelly_are_told(strewn: Candidate, tmp_path: Path) -> None:
    def risen(frame: int, data: dict[str, Any]) -> None:
        data["vertex/position"] = data["vertex/position"] + [0.0, 0.0, HIGH - 0.1 if frame == 2 else 0.0]

    rows = {r.id.split(":")[2]: r for r in particles.category_rows(edited(strewn, tmp_path, "bodies", risen), "grains")}
    assert (rows["inside"].status, rows["inside"].first_failing_frame) == ("fail", 2)
    assert rows["inside"].evidence["solid"] == "jelly"


def test_grains_that_go_through_a_cloth_are_told(strewn: Candidate, tmp_path: Path) -> None:
    def risen(frame: int, data: dict[str, Any]) -> None:
        data["vertex/position"] = data["vertex/position"] + [0.0, 0.0, 0.06 if frame == 2 else 0.0]

    rows = {r.id.split(":")[2]: r for r in particles.category_rows(edited(strewn, tmp_path, "cloth", risen), "grains")}
    assert (rows["inside"].status, rows["inside"].first_failing_frame) == ("fail", 2)
    assert rows["inside"].evidence["solid"] == "cloth"


@pytest.mark.parametrize(("joules", "status"), [(2e-5, "pass"), (2e-3, "fail")])
def test_noise_of_a_jelly_that_is_held_yet_is_not_all_there_is_in_play(tmp_path: Path, joules: float, status: str) -> None:
    """A run that is judged while nothing has moved yet: what a millimetre of the weight gives is in play."""
    spec = hammock_spec(frames=3, edge=0.055, drop=0.02, radius=None)
    spec["simulation"]["drivers"]["let_go"]["time"] = 1.0
    still = simulate(tmp_path / "still", spec)

    def more(frame: int, data: dict[str, Any]) -> None:
        if frame > 0:
            data["record/elastic_potential_energy"] = data["record/elastic_potential_energy"] + joules

    found = edited(still, tmp_path / "more", "bodies", more)
    rows = [r for r in elastic.category_rows(found, "bodies") if r.id.startswith("category:elastic:together")]
    assert [r.status for r in rows] == [status]
