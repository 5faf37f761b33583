"""Postures of what deforms and of what has several bodies: measured by the same rules, and open where no record tells who bears it (R131, R155)."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.claimed_worlds import claimed
from worldagent.testing.worlds.simulated_worlds import simulate as simulated
from worldagent.testing.worlds.small_cloth import FLAG_PROMPT, flag_spec
from worldagent.testing.worlds.small_worlds import box, entity, ground, make_candidate, world
from worldagent.testing.worlds.soft_worlds import block_mesh, deformed_candidate
from worldagent.tests.physics.fracture_world import simulate, struck_wall
from worldagent.verifiers.claims.described.check import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.poses import pose_said, subjects_of
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import CameraKey, ElasticPhysics, Rope, Shot, WorldSpec

SIZE = (0.2, 0.2, 0.6)
SHOT = Shot(frames=(0, 12), keys={"k": CameraKey(frame=0, position=(0, -4, 1), target=(0, 0, 0.2))}, subjects=[])


def said(spec: WorldSpec, prompt: str, quote: str, place: str, thing: str) -> WorldSpec:
    claims = {n: (n, "thing", [f"/entities/{n}"]) for n in (place, thing)}
    return claimed(spec, prompt, {**claims, "it": (quote, "place", [f"/entities/{place}"])})


def row(candidate: Candidate) -> Row:
    (found,) = check(candidate)
    return found


def column(folder: Path, verb: str, move: Callable[[float, Any], Any], *, z: float = 0.3, lies: bool = False, **more: Any) -> Row:
    """A column of jelly over a floor, and what a sentence says of it."""
    physics = ElasticPhysics(young_modulus=1e5, pins=more.pop("pins", {}))
    size = (SIZE[2], SIZE[1], SIZE[0]) if lies else SIZE
    spec = world(
        {"floor": ground(), "jelly": box(*size, motion="dynamic", at=(0, 0, z), physics=physics)}, frames=13, shots={"only": SHOT}
    )
    spec = said(spec, f"A jelly {verb} on the floor.", "on", "floor", "jelly")
    mesh = block_mesh(size, (6, 2, 2) if lies else (2, 2, 6))
    return row(deformed_candidate(folder, spec, {"jelly": mesh}, {"jelly": move}, **more))


def stay(time: float, rest: Any) -> Any:
    return rest


def sunk(time: float, rest: Any) -> Any:
    """Half as high as at rest, from its foot on."""
    return rest * np.array([1.4, 1.4, 0.5])


def dropped(time: float, rest: Any) -> Any:
    return rest - np.array([0.0, 0.0, 0.5 * 9.81 * time**2])


def slid(time: float, rest: Any) -> Any:
    return rest + np.array([2.0 * time, 0.0, 0.0])


CASES: dict[str, tuple[str, Callable[[float, Any], Any], dict[str, Any], str, str]] = {
    "stands": ("stands", stay, {}, "pass", "stands"),
    "sits": ("sits", stay, {}, "pass", "sits"),
    "lies": ("lies", stay, {"lies": True, "z": 0.1}, "pass", "lies"),
    "lies, but stands": ("lies", stay, {}, "fail", "it stands"),
    "stands, but has sunk in": ("stands", sunk, {}, "fail", "sunk in on itself: it is 0.3 m high"),
    "stands, but slides": ("stands", slid, {}, "fail", "not at rest"),
    "sits, but falls": ("sits", dropped, {"z": 0.301}, "fail", "not at rest"),
    "hangs, but stands": ("hangs", stay, {}, "fail", "'floor' bears it from below"),
}


@pytest.mark.parametrize("name", list(CASES))
def test_what_deforms_has_the_posture_that_is_measured(name: str, tmp_path: Path) -> None:
    verb, move, more, status, told = CASES[name]
    found = column(tmp_path, verb, move, **more)
    assert (found.status, told in found.evidence["explanation"]) == (status, True), found.evidence


@pytest.mark.parametrize("verb", ["stands", "sits", "lies"])
def test_without_a_record_of_who_bears_it_a_posture_is_open_with_a_next_step(verb: str, tmp_path: Path) -> None:
    lies = verb == "lies"
    found = column(tmp_path, verb, stay, lies=lies, z=0.1 if lies else 0.3, without=("vertex/velocity",))
    assert found.status == "unverified", found.evidence
    assert "no record tells who bears 'jelly', which deforms" in found.evidence["explanation"]
    assert "bake_sim" in str(found.corrections)


def test_what_is_held_above_and_stands_hangs_only_where_a_record_tells_how_much(tmp_path: Path) -> None:
    held = {"top": {"center": [0, 0, 0.3], "size": [0.3, 0.3, 0.1]}}
    found = column(tmp_path, "hangs", stay, pins=held, without=("contact/vector",))
    assert found.status == "unverified", found.evidence
    assert "how much of the weight of 'jelly', which deforms, 'floor' bears from below" in found.evidence["explanation"]
    free = column(tmp_path / "free", "hangs", lambda time, rest: rest + np.array([0.0, 0.0, 0.5]), pins=held)
    assert free.status == "fail", "it does not touch the floor"


# ---------------------------------------------------------------- several bodies


@pytest.fixture(scope="module")
def wall(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A wall of many bodies that nothing strikes yet."""
    return simulate(tmp_path_factory.mktemp("wall"), struck_wall(0.0, tension=4e5, seconds=0.2, size=(0.4, 0.6), refine=0))


@pytest.mark.parametrize(("verb", "status"), [("stands", "pass"), ("sits", "pass"), ("lies", "fail"), ("hangs", "fail")])
def test_what_has_several_bodies_is_measured_as_one(wall: Candidate, verb: str, status: str) -> None:
    spec = said(wall.spec, f"A wall {verb} on the floor.", "on", "floor", "wall")
    found = row(dataclasses.replace(wall, spec=spec))
    assert len(wall.entity("wall").bodies) > 1
    assert found.status == status, found.evidence


@pytest.mark.parametrize(("tied", "z", "status"), [("beam", 0.0, "pass"), (None, -0.1, "fail"), (None, -1.99, "fail")])
def test_a_rope_hangs_from_what_it_is_tied_to(tied: str | None, z: float, status: str, tmp_path: Path) -> None:
    """Tied to a beam; under it and tied to nothing; on the floor."""
    points = [(0, 0, 2 + z), (0, 0, 1.5)] if z > -1.0 else [(0, 0, 2 + z), (0.5, 0, 2 + z)]
    rope = entity(rope=Rope(points=points, radius=0.005, segments=5, attach_start=tied), motion="dynamic")
    beam = box(2.0, 0.1, 0.1, at=(0, 0, 2.055))
    spec = world({"floor": ground(), "beam": beam, "rope": rope}, frames=13, shots={"only": SHOT})
    found = row(make_candidate(tmp_path, said(spec, "A rope hangs from the beam.", "hangs from", "beam", "rope"), tracks={}))
    assert found.status == status, found.evidence


# ---------------------------------------------------------------- cloth that hangs


@pytest.mark.parametrize(("verb", "status"), [("hangs", "pass"), ("stands", "fail"), ("lies", "fail")])
def test_a_flag_that_pins_hold_hangs_and_does_not_stand(verb: str, status: str, tmp_path: Path) -> None:
    document = flag_spec(frames=13, resolution=0.1)
    document["simulation"]["drivers"] = {}
    flag = simulated(tmp_path, parse_spec({**document, "prompt": FLAG_PROMPT}))
    holder = next(p.to for p in flag.spec.entities["flag"].physics.pins.values())  # type: ignore[union-attr]
    spec = said(flag.spec, f"A flag {verb} on the {holder}.", "on", str(holder), "flag")
    found = row(dataclasses.replace(flag, spec=spec))
    assert found.status == status, found.evidence
    assert np.isfinite(found.measured or 0.0)


def test_a_participle_is_about_the_thing_right_before_it(tmp_path: Path) -> None:
    """A flag hangs, and not the ground that the sentence begins with."""
    document = flag_spec(frames=3, resolution=0.1)
    document["simulation"]["drivers"] = {}
    flag = simulated(tmp_path, parse_spec({**document, "prompt": FLAG_PROMPT}))
    pole = next(n for n in flag.spec.entities if n not in ("flag", "ground"))
    for verb, about in (("hung from", ["flag", "ground"]), ("hangs from", ["ground"])):
        prompt = f"A ground lies under a flag {verb} the {pole}."
        claims = {n: (n, "thing", [f"/entities/{n}"]) for n in ("flag", "ground", pole)}
        spec = claimed(flag.spec, prompt, {**claims, "it": ("from", "place", [f"/entities/{pole}"])})
        posed = pose_said(spec, "it")
        assert posed is not None
        assert sorted(subjects_of(spec, posed)) == about
