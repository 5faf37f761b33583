"""A body that stands, sits, hangs, leans or lies somewhere has that posture there, at the frames that the words speak of (R131, R155)."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects._films import film_of
from worldagent.testing.worlds.claimed_worlds import claimed
from worldagent.testing.worlds.liquid_worlds import pool_in_tank
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, ground, make_candidate, world
from worldagent.verifiers.claims.described.check import check
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import BallJoint, CameraKey, Entity, Shot, Supports, WorldSpec

N = 25
HIGH = 0.3
TABLE = box(1.0, 1.0, 0.5, at=(0, 0, 0.25))
WALL = box(2.0, 0.1, 2.0, at=(0, 0.55, 1.5))
BEAM = box(2.0, 0.1, 0.1, at=(0, 0, 2.05))
LAID = (0, np.pi / 2, 0)


def thing(at: tuple[float, float, float], euler: tuple[float, float, float] = (0, 0, 0), motion: str = "dynamic") -> Entity:
    """A slender body, upright along its own z axis."""
    return box(0.1, 0.1, HIGH, motion=motion, at=at, euler=euler)


def scene(bodies: dict[str, Entity], **more: Any) -> WorldSpec:
    camera = CameraKey(frame=0, position=(0, -4, 1), target=(0, 0, 0.2))
    return world(
        {"floor": ground(), **bodies}, frames=N, shots={"only": Shot(frames=(0, N - 1), keys={"k": camera}, subjects=[])}, **more
    )


def row_of(folder: Path, prompt: str, quote: str, by: list[str], *, tracks: Any = None, **bodies: Any) -> Row:
    more = {k: bodies.pop(k) for k in ("joints", "relations") if k in bodies}
    things = {n: (n, "thing", [f"/entities/{n}"]) for n in bodies if n in prompt}
    made = claimed(scene(bodies, **more), prompt, {**things, "it": (quote, "place", by)})
    (row,) = check(make_candidate(folder, made, tracks=tracks or {}))
    return row


PINNED = {"hook": BallJoint(anchor=(0, 0, 2.0), child="vase", parent="beam")}
ON_TABLE, ON_FLOOR, UNDER_BEAM = (0, 0, 0.5 + HIGH / 2), (1.5, 0, HIGH / 2), (0, 0, 2.0 - HIGH / 2)
WALL_DOWN = box(2.0, 0.1, 2.0, at=(0, 0.55, 1.0))
TURN = 0.15
SLANTED = box(
    0.05, 0.05, 1.0, motion="dynamic",
    at=(0, 0.5 - 0.5 * np.sin(TURN) - 0.025 * np.cos(TURN), 0.5 * np.cos(TURN) + 0.025 * np.sin(TURN)), euler=(-TURN, 0, 0),
)  # fmt: skip

SOUND: dict[str, tuple[str, str, dict[str, Any]]] = {
    "stands": ("A vase stands on the table.", "on", {"vase": thing(ON_TABLE), "table": TABLE}),
    "stands, in the claim's words": ("A vase stands on the table.", "stands on", {"vase": thing(ON_TABLE), "table": TABLE}),
    "stands, modelled lying": (
        "A vase stands on the table.",
        "on",
        {"vase": box(HIGH, 0.1, 0.1, motion="dynamic", at=ON_TABLE, euler=LAID), "table": TABLE},
    ),
    "stands, of a wide body": (
        "A bench stands on the table.",
        "on",
        {"bench": box(0.9, 0.3, 0.2, motion="dynamic", at=(0, 0, 0.6)), "table": TABLE},
    ),
    "stands beside": ("A vase stands beside the table.", "beside", {"vase": thing((0.6, 0, HIGH / 2)), "table": TABLE}),
    "stehen": ("Eine vase steht auf dem table.", "auf", {"vase": thing(ON_TABLE), "table": TABLE}),
    "fronted": ("Auf dem table steht eine vase.", "Auf", {"vase": thing(ON_TABLE), "table": TABLE}),
    "sits": ("A ball sits on the table.", "on", {"ball": ball(0.1, motion="dynamic", at=(0, 0, 0.6)), "table": TABLE}),
    "hangs": ("A vase hangs from the beam.", "hangs from", {"vase": thing(UNDER_BEAM), "beam": BEAM, "joints": PINNED}),
    "hangs, glued": ("A vase hangs from the beam.", "hangs from", {"vase": thing(UNDER_BEAM, motion="static"), "beam": BEAM}),
    "hangs on a wall": ("A vase hangs on the wall.", "on", {"vase": thing((0, 0.45, 1.5), motion="static"), "wall": WALL}),
    "hangs on a wall, on a nail": (
        "A vase hangs on the wall.",
        "on",
        {
            "vase": thing((0, 0.45, 1.5), motion="static"),
            "wall": WALL,
            "nail": box(0.02, 0.02, 0.02, at=(0, 0.45, 1.5 - HIGH / 2 - 0.01)),
        },
    ),
    "juts out": (
        "A bar hangs over the edge of the table.",
        "over",
        {"bar": box(0.8, 0.1, 0.05, motion="dynamic", at=(0.3, 0, 0.525)), "table": TABLE},
    ),
    "leans": ("A rod leans against the wall.", "against", {"rod": SLANTED, "wall": WALL_DOWN}),
    "leans on": ("A rod leans on the wall.", "leans on", {"rod": SLANTED, "wall": WALL_DOWN}),
    "lies": ("A bar lies on the table.", "on", {"bar": thing((0, 0, 0.55), LAID), "table": TABLE}),
    "lies, compact": ("A ball lies on the table.", "on", {"ball": ball(0.1, motion="dynamic", at=(0, 0, 0.6)), "table": TABLE}),
    "another verb": ("A vase is on the table.", "on", {"vase": thing((0, 0, 0.55), LAID), "table": TABLE}),
}
BROKEN: dict[str, tuple[str, str, dict[str, Any], str]] = {
    "stands, but lies": ("A vase stands on the table.", "on", {"vase": thing((0, 0, 0.55), LAID), "table": TABLE}, "it lies"),
    "stands in its own words, but lies": ("A vase stands on the table.", "stands on", {"vase": thing((0, 0, 0.55), LAID), "table": TABLE}, "it lies"),
    "steht, aber liegt": ("Auf dem table steht eine vase.", "Auf", {"vase": thing((0, 0, 0.55), LAID), "table": TABLE}, "it lies"),
    "stands in the air": ("A vase stands beside the table.", "beside", {"vase": thing((0.6, 0, 0.3)), "table": TABLE}, "nothing bears it"),
    "sits in the air": ("A ball sits beside the table.", "beside", {"ball": ball(0.1, motion="dynamic", at=(0.7, 0, 0.3)), "table": TABLE}, "nothing bears it"),
    "stands, but hangs": ("A vase stands under the beam.", "under", {"vase": thing(UNDER_BEAM), "beam": BEAM, "joints": PINNED}, "it hangs by"),
    "hangs, but stands": ("A vase hangs from the beam.", "hangs from", {"vase": thing(ON_FLOOR), "beam": BEAM}, "'floor' bears it"),
    "hangs above what it stands on": ("A vase hangs above the table.", "above", {"vase": thing(ON_TABLE), "table": TABLE}, "'table' bears it"),
    "hängt, aber steht": ("Eine vase hängt über dem table.", "über", {"vase": thing(ON_TABLE), "table": TABLE}, "'table' bears it"),
    "hangs on a wall, but stands": (
        "A vase hangs on the wall.", "on",
        {"vase": thing((0, 0.45, HIGH / 2), motion="static"), "wall": box(2.0, 0.1, 2.0, at=(0, 0.55, 1.0))},
        "'floor' bears it",
    ),
    "hangs in the air": ("A vase hangs from the beam.", "hangs from", {"vase": thing((0, 0, 1.0)), "beam": BEAM}, "nothing holds it"),
    "lies, but stands": ("A vase lies on the table.", "on", {"vase": thing(ON_TABLE), "table": TABLE}, "it stands"),
    "leans, held by the wall alone": ("A rod leans against the wall.", "against", {"rod": box(0.05, 0.05, 1.0, motion="dynamic", at=(0, 0.475, 1.5)), "wall": WALL}, "nothing bears it"),
}  # fmt: skip


@pytest.mark.parametrize("name", list(SOUND))
def test_what_has_the_posture_passes(name: str, tmp_path: Path) -> None:
    prompt, quote, bodies = SOUND[name]
    place = next(n for n in ("table", "beam", "wall") if n in bodies)
    row = row_of(tmp_path, prompt, quote, [f"/entities/{place}"], **bodies)
    assert row.status == "pass", row.evidence


@pytest.mark.parametrize("name", list(BROKEN))
def test_what_has_another_posture_fails(name: str, tmp_path: Path) -> None:
    prompt, quote, bodies, said = BROKEN[name]
    place = next(n for n in ("table", "beam", "wall") if n in bodies)
    row = row_of(tmp_path, prompt, quote, [f"/entities/{place}"], **bodies)
    assert row.status == "fail", row.evidence
    assert said in row.evidence["explanation"]


def moved(*points: tuple[int, float, float]) -> Any:
    """A track of an upright body over frames, by level place and height [m]."""
    frames, x, z = zip(*points, strict=True)
    at = np.arange(N)
    return np.stack([np.interp(at, frames, x), 0 * at, np.interp(at, frames, z)], axis=1), IDENTITY


REST = 0.5 + HIGH / 2
SLIDES = moved((0, -0.4, REST), (N - 1, 0.4, REST))
COMES = moved((0, -0.4, 1.5), (12, 0.0, REST), (N - 1, 0.0, REST))
GOES = moved((0, 0.0, REST), (4, 0.0, REST), (N - 1, 1.5, 0.0))
SWAYS = moved(*((k, 0.05 * float(np.sin(k)), 2.0 - HIGH / 2) for k in range(N)))


@pytest.mark.parametrize(
    ("prompt", "quote", "track", "status"),
    [
        ("A vase stands on the table.", "on", GOES, "pass"),
        ("A vase stands on the table.", "on", SLIDES, "fail"),
        ("A vase stands on the table.", "on", COMES, "fail"),
        ("In the end a vase stands on the table.", "on", COMES, "pass"),
        ("A vase is on the table.", "on", COMES, "pass"),
    ],
)
def test_rest_is_asked_when_the_words_speak_of_it(prompt: str, quote: str, track: Any, status: str, tmp_path: Path) -> None:
    row = row_of(tmp_path, prompt, quote, ["/entities/table"], tracks={"vase": track}, vase=thing(ON_TABLE), table=TABLE)
    assert row.status == status, row.evidence


def test_an_event_before_may_bring_it_there(tmp_path: Path) -> None:
    made = claimed(
        scene({"vase": thing((-0.4, 0, 1.5)), "table": TABLE}),
        "A vase drops and stands on the table.",
        {
            "vase": ("vase", "thing", ["/entities/vase"]),
            "drop": ("drops", "event", ["/story/beats/drop"]),
            "it": ("on", "place", ["/entities/table"]),
        },
    )
    (row,) = [r for r in check(make_candidate(tmp_path, made, tracks={"vase": COMES})) if r.id == "claim:place:it"]
    assert row.status == "pass", row.evidence


def test_what_hangs_may_sway(tmp_path: Path) -> None:
    bodies = {"vase": thing(UNDER_BEAM), "beam": BEAM, "joints": PINNED}
    row = row_of(tmp_path, "A vase hangs from the beam.", "hangs from", ["/entities/beam"], tracks={"vase": SWAYS}, **bodies)
    assert row.status == "pass", row.evidence


def test_what_stands_in_a_row_is_what_the_place_names(tmp_path: Path) -> None:
    rolls = moved((0, -2.0, 0.1), (N - 1, 2.0, 0.1))
    for name, euler, z, status in (("up", (0, 0, 0), HIGH / 2, "pass"), ("laid", LAID, 0.05, "fail")):
        bodies = {n: thing((x, 1.0, z), euler) for n, x in (("first", 0.0), ("second", 0.5))}
        made = claimed(
            scene({**bodies, "ball": ball(0.1, motion="dynamic", at=(-2, 0, 0.1))}),
            "Two slabs stand in a row, and a ball rolls past.",
            {
                "slabs": ("slabs", "thing", ["/entities/first", "/entities/second"]),
                "ball": ("ball", "thing", ["/entities/ball"]),
                "it": ("in a row", "place", ["/entities/first", "/entities/second"]),
            },
        )
        (row,) = check(make_candidate(tmp_path / name, made, tracks={"ball": rolls}))
        assert row.status == status, row.evidence


def test_a_relation_says_where_and_not_how(tmp_path: Path) -> None:
    for name, body, status in (("up", thing(ON_TABLE), "pass"), ("laid", thing((0, 0, 0.55), LAID), "fail")):
        relations = {"bears": Supports(a="table", b="vase", frames=(0, 0))}
        by = ["/graph/relations/bears"]
        row = row_of(tmp_path / name, "A vase stands on the table.", "on", by, vase=body, table=TABLE, relations=relations)
        assert row.status == status, row.evidence


def _film(bodies: dict[str, dict[str, Any]]) -> Any:
    """A second of what the engine makes of boxes, given by size, place and motion."""
    entities = {
        n: {
            "role": n, "motion": b.get("motion", "dynamic"), "material": "m", "dimensions": {"size": b["size"]}, "pose": {"position": b["at"]},
            "parts": {"body": {"shape": {"kind": "box", "size": b["size"]}}},
        }
        for n, b in bodies.items()
    }  # fmt: skip
    document = {
        "prompt": "x", "spec_version": "2", "title": "x", "entities": entities, "materials": {"m": {"density": 600}},
        "simulation": {"fps": 24, "frames": 12, "solvers": {"rigid": {"engine": "mujoco", "members": list(bodies)}}},
    }  # fmt: skip
    return film_of(parse_spec(document))


@pytest.mark.parametrize(("under", "status"), [("static", "pass"), ("dynamic", "fail")])
def test_a_vase_that_falls_with_its_table_does_not_stand(under: str, status: str, tmp_path: Path) -> None:
    """Seen from the table it rests: what falls is told by who bears it."""
    bodies: dict[str, dict[str, Any]] = {
        "vase": {"size": [0.1, 0.1, HIGH], "at": [0, 0, 3 + HIGH / 2 + 0.0005]},
        "table": {"size": [0.5, 0.5, 0.1], "at": [0, 0, 2.95], "motion": under},
    }
    film = _film(bodies)
    things = {n: (n, "thing", [f"/entities/{n}"]) for n in bodies}
    made = claimed(film.spec, "A vase stands on the table.", {**things, "it": ("on", "place", ["/entities/table"])})
    rows = check(dataclasses.replace(film, spec=made).candidate(tmp_path))
    (row,) = [r for r in rows if r.id == "claim:place:it"]
    assert row.status == status, row.evidence
    assert status == "pass" or "it falls" in row.evidence["explanation"]


def test_water_in_a_tank_bears_nothing_and_hinders_no_answer(tmp_path: Path) -> None:
    """A liquid is no surface that touches: asking for its gap ended the judgement of a tank full of water."""
    flow = pool_in_tank(size=(0.3, 0.2, 0.15), spacing=0.02, wall=0.02, frames=6)
    bodies = {**flow.spec.entities, "table": box(1.0, 1.0, 0.1, at=(0, 0, -0.07))}
    spec = flow.spec.model_copy(update={"entities": bodies})
    things = {
        "tank": ("tank", "thing", ["/entities/tank"]),
        "table": ("table", "thing", ["/entities/table"]),
        "it": ("on", "place", ["/entities/table"]),
    }
    made = claimed(spec, "A tank stands on the table.", things)
    (row,) = check(flow.edited(spec=made).candidate(tmp_path))
    assert row.status == "pass", row.evidence
