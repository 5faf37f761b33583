"""Bends, stretches and wobbles: changes of shape in the body's own frame, on motions in closed form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_worlds import box, ground, make_candidate, world
from worldagent.testing.worlds.soft_worlds import Motion, block_mesh, deformed_candidate
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.arrays import F64
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.categories.elastic.events import DeformEvent
from worldagent.worlds.predicates import PairEvent
from worldagent.worlds.spec import ElasticPhysics

SIZE, FRAMES = (0.8, 0.1, 0.1), 25
MESH = block_mesh(SIZE, (16, 2, 2))
KINDS = ("bends", "stretches", "wobbles")


def judged(folder: Path, move: Motion) -> dict[str, Outcome]:
    physics = ElasticPhysics(young_modulus=1e5)
    things = {"floor": ground(), "bar": box(*SIZE, motion="dynamic", at=(0, 0, 1.0), physics=physics)}
    candidate = deformed_candidate(folder, world(things, frames=FRAMES), {"bar": MESH}, {"bar": move})
    events = {kind: DeformEvent.model_validate({"kind": kind, "entity": "bar"}) for kind in KINDS}
    return {kind: evaluate(candidate, event, (0, FRAMES - 1)) for kind, event in events.items()}


def arched(t: float, x: F64, *, share: float = 0.05, rate: float = 0.0) -> F64:
    """The middle goes down by a share of the length, once or to and fro at a rate [Hz]."""
    much = share * SIZE[0] * (np.sin(2 * np.pi * rate * t) if rate else t)
    return x - np.outer(much * np.cos(np.pi * x[:, 0] / SIZE[0]), [0, 0, 1])


def turned(t: float, x: F64) -> F64:
    """It goes about its middle as a whole, by a radian and to and fro, and falls."""
    a = np.sin(4 * np.pi * t)
    y = x - [0, 0, 1.0]
    return np.stack([y[:, 0] * np.cos(a) + y[:, 2] * np.sin(a), y[:, 1], y[:, 2] * np.cos(a) - y[:, 0] * np.sin(a) - t], axis=1)


def drawn(t: float, x: F64) -> F64:
    return x * [1.0 + 0.1 * t, 1.0, 1.0]


MOTIONS: dict[str, tuple[Motion, set[str]]] = {
    "sags once": (arched, {"bends"}),
    "swings up and down": (lambda t, x: arched(t, x, rate=2.0), {"bends", "wobbles"}),
    "swings too little to be seen": (lambda t, x: arched(t, x, share=0.002, rate=2.0), set()),
    "is drawn out": (drawn, {"stretches"}),
    "turns to and fro as a whole": (turned, set()),
    "is bent all the time": (lambda t, x: arched(1.0, x), set()),
    "rests": (lambda t, x: x, set()),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_each_change_of_shape_is_its_own_event(name: str, tmp_path: Path) -> None:
    move, wanted = MOTIONS[name]
    assert {kind for kind, found in judged(tmp_path, move).items() if found.status == "pass"} == wanted


def test_measures_are_of_the_length(tmp_path: Path) -> None:
    bent = judged(tmp_path / "bent", arched)["bends"]
    # Slices are eighths of the length: the line goes from the middle of the first to that of the last.
    assert bent.value == pytest.approx(0.05 * (np.cos(np.pi / 16) - np.cos(7 * np.pi / 16)), rel=0.05)
    assert judged(tmp_path / "drawn", drawn)["stretches"].value == pytest.approx(0.1, rel=0.02)
    swung = judged(tmp_path / "swung", lambda t, x: arched(t, x, rate=2.0))["wobbles"]
    assert swung.value == pytest.approx(4.0)


def test_a_body_that_does_not_deform_is_no_evidence(tmp_path: Path) -> None:
    candidate = make_candidate(tmp_path, world({"block": box(0.1, 0.1, 0.1, motion="dynamic")}, frames=2), tracks={})
    assert evaluate(candidate, DeformEvent(kind="bends", entity="block"), (0, 1)).status == "unverified"


def test_a_jelly_hits_the_floor_in_a_world_in_which_nothing_rigid_moves(tmp_path: Path) -> None:
    physics = ElasticPhysics(young_modulus=2e4, resolution=0.1)
    things = {"floor": ground(), "jelly": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.06), physics=physics)}
    spec = world(things, frames=5)
    built = {name: build_entity(spec, name, Path()) for name in spec.entities}
    caches = run_frames(spec, built, tmp_path / "run", frames=5)
    candidate = Candidate(tmp_path, spec, built, "probe", caches, "run", cache_digest(caches))
    lands = evaluate(candidate, PairEvent(kind="hits", entity="jelly", other="floor"), (0, 4))
    assert lands.status == "pass", lands
    late = evaluate(candidate, PairEvent(kind="hits", entity="jelly", other="floor"), (3, 4))
    assert late.status == "fail"
    pushed = evaluate(candidate, PairEvent(kind="hits", entity="floor", other="jelly"), (0, 4))
    assert pushed.status == "fail", "the floor stands"
