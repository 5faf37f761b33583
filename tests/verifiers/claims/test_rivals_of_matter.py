"""Rivals of kinds of event of matter, on motions whose truth is known: none is true, and a body at rest of which the same is true voids the claim.

Every kind of event is in this file or in `test_rivals.py`.

Who does it is no body where matter does: exchanged roles are then no reading at all, and never pass.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects._gas_scenes import SOLVER, SOOT, scene
from worldagent.testing.defects._liquid_scenes import pool
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.bodies_in_liquid import crate_in_tank
from worldagent.testing.worlds.liquid_worlds import Flow, stream
from worldagent.testing.worlds.simulated_worlds import edited
from worldagent.testing.worlds.simulated_worlds import simulate as simulated
from worldagent.testing.worlds.small_cloth import FLAG_PROMPT, PULLED_PROMPT, flag_spec, pulled_spec
from worldagent.testing.worlds.soft_worlds import Motion, deformed_candidate
from worldagent.tests.physics.fracture_world import simulate, struck_wall
from worldagent.tests.verifiers.categories import test_flows as flowing
from worldagent.tests.verifiers.categories import test_vessels as vessels
from worldagent.tests.verifiers.categories.elastic import test_elastic_events as soft
from worldagent.tests.verifiers.categories.liquid import test_floating as floating
from worldagent.tests.verifiers.categories.liquid import test_splashing as splashing
from worldagent.tests.verifiers.categories.particles import test_bury_event as burying
from worldagent.tests.verifiers.claims import test_rivals as of_bodies
from worldagent.tests.verifiers.claims.claimed import claimed
from worldagent.verifiers.claims.check import check
from worldagent.verifiers.claims.rivals import AT_REST, rivals_of
from worldagent.verifiers.predicates.evaluators import evaluate
from worldagent.verifiers.story.vacuity import check_vacuity
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.predicates.events import EVENT_KINDS
from worldagent.worlds.spec import ElasticPhysics

CLAIM = {"e": {"quote": "it happens", "type": "event", "by": ["/story/beats/b"]}}


def bar(folder: Path, move: Motion) -> Candidate:
    """A bar that deforms, over a floor."""
    physics = ElasticPhysics(young_modulus=1e5)
    things = {"floor": sw.ground(), "bar": sw.box(*soft.SIZE, motion="dynamic", at=(0, 0, 1.0), physics=physics)}
    return deformed_candidate(folder, sw.world(things, frames=soft.FRAMES), {"bar": soft.MESH}, {"bar": move})


def stone(folder: Path) -> Candidate:
    """A stone that goes down in a shallow pool."""
    z = np.maximum(0.3 - 0.4 * np.arange(floating.FRAMES) / 24, 0.05)
    lies = np.where(z <= 0.05 + 1e-9, 0.6, 0.0)
    return crate_in_tank(z, density=2500.0, depth=0.15, tank_share=lies).candidate(folder)


def wall(folder: Path) -> Candidate:
    """A small wall that an iron ball goes through."""
    return simulate(folder, struck_wall(15.0, tension=4e5, seconds=0.3, size=(0.6, 0.4), refine=0))


def strip(folder: Path) -> Candidate:
    """A notched strip that is drawn out until it tears, its post at rest."""
    spec = pulled_spec(stretch=0.018, strength=20.0, frames=10, notch=True)
    return simulated(folder, parse_spec({**spec, "prompt": PULLED_PROMPT}))


def flag(folder: Path) -> Candidate:
    """A flag that waves by a sine, written over one that hangs."""
    spec = flag_spec(frames=49, resolution=0.1)
    spec["simulation"]["drivers"] = {}
    hung = simulated(folder, parse_spec({**spec, "prompt": FLAG_PROMPT}))
    rest = hung.caches["cloth"].read(0)["vertex/position"]
    place = (rest - rest.min(axis=0)) / np.ptp(rest, axis=0).max()

    def wave(k: int, data: dict[str, Any]) -> None:
        data["vertex/position"] = rest + np.outer(place[:, 0] * 0.2 * np.sin(2 * np.pi * 2.9 * k / 24 + 0.4), [0.0, 1.0, 0.0])

    return edited(hung, folder / "waves", "cloth", wave)


def haze(folder: Path) -> Candidate:
    """Smoke in half of its box up to frame 5, a hundredth of that afterwards."""

    def paint(k: int, data: dict[str, Any]) -> None:
        data["gas_soot"][:] = 0.0
        data["gas_soot"][:8] = 0.5 * SOOT * (1.0 if k <= 5 else 0.01)

    return edited(scene("cold"), folder, SOLVER, paint)


def snuffed(folder: Path) -> Candidate:
    """A fire that is out from frame 7 on."""

    def snuff(k: int, data: dict[str, Any]) -> None:
        data["gas_released"] *= k < 7

    return edited(scene("fire"), folder, SOLVER, snuff)


def splash() -> Flow:
    """Still water of which some stands 0.3 m higher at one frame."""
    flow = pool(np.random.default_rng(1))
    top = np.argsort(flow.position[0][:, 2])[::-1]
    flow.position[5][top[:8], 2] += 0.3
    return flow


def flow(make: Callable[[], Flow]) -> Callable[[Path], Candidate]:
    """A motion of water, with somebody who rests far off."""

    def of(folder: Path) -> Candidate:
        moved = make()
        entities = {**moved.spec.entities, "witness": sw.box(0.1, 0.1, 0.1, at=(9, 9, 0.05))}
        return moved.edited(spec=moved.spec.model_copy(update={"entities": entities})).candidate(folder)

    return of


POST = sw.box(0.1, 0.1, 0.2, at=(0.0, 0.0, 0.1))
DISC = {"point": [0, 0, 0.6], "normal": [0, 0, -1], "radius": 0.2}
WORLDS: dict[str, tuple[Callable[[Path], Candidate], dict[str, Any]]] = {
    "floats": (flow(lambda: crate_in_tank(floating.still(floating.AFLOAT))), {"entity": "crate", "other": "pool"}),
    "bobs": (flow(lambda: crate_in_tank(floating.bobbing(0.005))), {"entity": "crate", "other": "pool"}),
    "sinks": (stone, {"entity": "crate", "other": "pool"}),
    "splashes": (flow(lambda: splashing.thrown(splashing.struck())), {"entity": "pool", "other": "crate"}),
    "pours": (flow(vessels.poured), {"entity": "pool", "other": "tank"}),
    "fills": (flow(vessels.filled), {"entity": "pool", "other": "tank"}),
    "overflows": (flow(vessels.overflowed), {"entity": "pool", "other": "tank"}),
    "leaks": (flow(vessels.leaked), {"entity": "pool", "other": "tank"}),
    "flows": (flow(lambda: stream(speed=1.0)), {"entity": "pool", **DISC}),
    "spreads": (flow(lambda: flowing.flattened(np.linspace(1.0, 1.5, 24))), {"entity": "pool"}),
    "bends": (lambda folder: bar(folder, soft.arched), {"entity": "bar"}),
    "stretches": (lambda folder: bar(folder, soft.drawn), {"entity": "bar"}),
    "wobbles": (lambda folder: bar(folder, soft.MOTIONS["swings up and down"][0]), {"entity": "bar"}),
    "breaks": (wall, {"entity": "wall"}),
    "cracks": (wall, {"entity": "wall"}),
    "buries": (lambda folder: burying.laid(burying.sand(folder / "run"), folder), {"entity": "sand", "other": "ball"}),
    "tears": (strip, {"entity": "strip"}),
    "torn": (strip, {"entity": "strip", "min": 0.001}),
    "flutters": (flag, {"entity": "flag", "min_amplitude": 0.05}),
    "broken": (wall, {"entity": "wall", "min": 0.02}),
    "breach": (wall, {"entity": "wall", "point": [0, 0, 0.24], "direction": [0, 1, 0], "min_width": 0.04, "min_height": 0.04}),
    "liquid_arrives": (flow(lambda: stream(others={"post": POST})), {"entity": "pool", "target": "post"}),
    "liquid_flux_through": (flow(lambda: stream(speed=1.0)), {"entity": "pool", **DISC, "min": 1e-4}),
    "splash_height": (flow(splash), {"entity": "pool", "min": 0.1}),
    "gas_arrives": (haze, {"entity": "smoke", "target": "floor"}),
    "gas_clears": (haze, {"entity": "smoke", "max_share": 0.02}),
    "burns": (snuffed, {"entity": "smoke"}),
    "goes_out": (snuffed, {"entity": "smoke"}),
}
"""By kind, a motion in which it happens and who does it to whom."""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Candidate]:
    """Motions by kind, each made once."""
    kept: dict[Any, Candidate] = {}

    def of(kind: str) -> Candidate:
        make = WORLDS[kind][0]
        if make not in kept:
            kept[make] = make(tmp_path_factory.mktemp(kind))
        return kept[make]

    return of


def staged(candidate: Candidate, predicate: dict[str, Any], who: str, start: int = 0) -> Candidate:
    """The motion with one beat and a claim of it."""
    beat = {"owner": "stage", "subject": who, "predicate": predicate, "frames": [start, candidate.last_frame]}
    return dataclasses.replace(candidate, spec=claimed(candidate.spec, CLAIM, beats={"b": beat}))


def row(candidate: Candidate) -> Any:
    (found,) = [r for r in check(candidate) if r.id.startswith("claim:event:")]
    return found


def test_every_kind_of_event_has_a_world_in_which_its_rivals_are_the_truth() -> None:
    bodies, matter = set(of_bodies.KINDS), set(WORLDS)
    assert bodies | matter == set(EVENT_KINDS)
    assert not bodies & matter


@pytest.mark.parametrize("kind", WORLDS)
def test_no_rival_of_a_kind_is_true_of_its_motion(kind: str, made: Callable[[str], Candidate]) -> None:
    told = {"kind": kind, **WORLDS[kind][1]}
    candidate = staged(made(kind), told, told["entity"])
    found = row(candidate)
    assert found.status == "pass", found.evidence
    rivals = rivals_of(candidate, "b")
    assert any("roles swapped" in r.text for r in rivals) == EVENT_KINDS[kind].directed
    assert any("rests throughout" in r.text for r in rivals) == (kind not in AT_REST)
    judged = {r.text: evaluate(candidate, r.predicate, r.frames).status for r in rivals}
    assert "pass" not in judged.values()
    # Whom nobody can tell of is printed, and not counted among those that are not true.
    undecided = {text for text, status in judged.items() if status == "unverified"}
    assert set(found.evidence["undecided_rivals"]) == undecided
    assert f"none of {len(rivals) - len(undecided)} rivals" in found.evidence["explanation"]
    assert all(text in found.evidence["explanation"] for text in undecided)


@pytest.mark.parametrize("kind", [k for k in WORLDS if k not in AT_REST])
def test_a_body_at_rest_is_found_where_the_same_is_true_of_it(kind: str, made: Callable[[str], Candidate]) -> None:
    # Whoever rests meets one of two branches: that it does the event, or that it lies where it lay.
    told = {"kind": kind, **WORLDS[kind][1]}
    lies = {"kind": "displacement", "entity": told["entity"], "max": 1e-6, "when": "always"}
    void = row(staged(made(kind), {"kind": "or", "of": [told, lies]}, told["entity"]))
    assert void.status == "fail"
    assert any("rests throughout" in text for text in void.evidence["true_rivals"])


@pytest.mark.parametrize("kind", WORLDS)
def test_the_same_before_its_onset_is_no_event_of_the_interval(kind: str, made: Callable[[str], Candidate]) -> None:
    """No rival of matter asks it: the beat is empty (`beat:vacuous`), or the event is over and does not come true."""
    told = {"kind": kind, **WORLDS[kind][1]}
    honest = staged(made(kind), told, told["entity"])
    asked = honest.spec.story.beats["b"].predicate
    first = evaluate(honest, asked, (0, honest.last_frame)).first_true_frame
    assert first is not None
    told_by = next((k for k in range(first, honest.last_frame) if evaluate(honest, asked, (0, k)).status == "pass"), None)
    assert told_by is not None
    late = staged(made(kind), told, told["entity"], told_by + 1)
    assert not [r for r in rivals_of(late, "b") if "before frame" in r.text]
    statuses = {*(r.status for r in check_vacuity(late, "b")), row(late).status}
    assert "fail" in statuses, kind
