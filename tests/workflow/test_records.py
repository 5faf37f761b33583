"""`inspect_world(part='records')` answers in worlds of every category: what is said to be recorded is in the caches, and the other way round."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from worldagent.construction import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.simulated_worlds import edited
from worldagent.testing.worlds.small_cloth import PULLED_PROMPT, catch_spec, flag_spec, pulled_spec
from worldagent.testing.worlds.small_gas import dust_spec, kindled_spec, smoke_spec, stirred_spec
from worldagent.testing.worlds.small_grains import sand_spec, spark_spec
from worldagent.testing.worlds.small_liquids import PROMPT, jelly_tank_spec, tank_spec
from worldagent.testing.worlds.small_worlds import ball, box, ground, world
from worldagent.tests.physics.fracture_world import struck_wall
from worldagent.workflow import measurements
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.categories.registry import CATEGORIES
from worldagent.worlds.channels import QUANTITIES
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import ElasticPhysics, FieldDriver, RigidSettings, WorldSpec
from worldagent.worlds.spec.fields import WindField

FRAMES = 3


def _soft(**more: Any) -> WorldSpec:
    block = box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.11), physics=ElasticPhysics(young_modulus=2e4, resolution=0.1))
    return world({"floor": ground(), "block": block}, frames=FRAMES, settings=RigidSettings(step=2e-3), **more)


def _rigid() -> WorldSpec:
    return world({"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.5))}, frames=FRAMES)


def _parsed(spec: dict[str, Any], prompt: str = PROMPT) -> WorldSpec:
    return parse_spec({"prompt": prompt, **spec})


WORLDS = {
    "rigid": _rigid,
    "elastic": _soft,
    "elastic in a wind": lambda: _soft(drivers={"wind": FieldDriver(field=WindField(velocity=(3, 0, 0)))}),
    "elastic in a wind for another": lambda: _soft_and_hard(),
    "elastic in water": lambda: _parsed(jelly_tank_spec(frames=FRAMES, spacing=0.06)),
    "breakable": lambda: struck_wall(5.0, seconds=0.1),
    "liquid": lambda: _parsed(tank_spec(frames=FRAMES, spacing=0.06)),
    "cloth in a wind": lambda: _parsed(flag_spec(frames=FRAMES, resolution=0.15)),
    "cloth and a ball": lambda: _parsed(catch_spec(frames=FRAMES, resolution=0.15)),
    "cloth that tears": lambda: _parsed(pulled_spec(frames=FRAMES, stretch=0.02, strength=20.0, notch=True), PULLED_PROMPT),
    "grains": lambda: _parsed(sand_spec(frames=FRAMES)),
    "sparks": lambda: _parsed(spark_spec(frames=FRAMES)),
    "smoke": lambda: _parsed(smoke_spec(frames=FRAMES, resolution=0.1)),
    "smoke that a body stirs": lambda: _parsed(stirred_spec(frames=FRAMES)),
    "a fire that kindles": lambda: _parsed(kindled_spec(frames=FRAMES)),
    "dust of an impact": lambda: _parsed(dust_spec(frames=FRAMES)),
}


def _soft_and_hard() -> WorldSpec:
    """A wind that acts on the rigid body beside the elastic one only."""
    soft = _soft().entities["block"]
    things = {"floor": ground(), "block": soft, "ball": ball(0.1, motion="dynamic", at=(1, 0, 0.5))}
    wind = FieldDriver(field=WindField(velocity=(3, 0, 0)), entities=["ball"])
    return world(things, frames=FRAMES, settings=RigidSettings(step=2e-3), drivers={"wind": wind})


def test_the_worlds_hold_every_category() -> None:
    assert {category for make in WORLDS.values() for category in _categories(make())} == set(CATEGORIES)


def _categories(spec: WorldSpec) -> set[str]:
    breakable = {"fracture" for e in spec.entities.values() if e.breakable is not None}
    return {e.physics.category for e in spec.entities.values()} | breakable


@pytest.mark.parametrize("kind", WORLDS)
def test_records_are_told_of_every_category(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = WORLDS[kind]()
    built = {n: build_entity(spec, n, tmp_path) for n in spec.entities}
    caches = run_frames(spec, built, tmp_path / "run", frames=FRAMES)
    candidate = Candidate(tmp_path, spec, built, "probe", caches, "run", cache_digest(caches))
    monkeypatch.setattr(measurements, "latest_candidate", lambda *_: candidate)
    session: Any = SimpleNamespace(folder=SimpleNamespace(id="w"), spec=spec, shown=lambda *_: "")
    told = measurements.measured(session, "records", entities=None, frames=None, limit=50, offset=0)
    written = {n for c in caches.values() for n in c.read(FRAMES - 1) if n.startswith("record/")}
    beside = {
        f"record/{n}" for n, q in QUANTITIES.items() if q.of == ("surface",)
    }  # written where surfaces are made, not by frames
    assert {f"record/{n}" for n in told["records"]} - beside == written & {f"record/{n}" for n in QUANTITIES}
    assert all(len(r["values"]) == FRAMES for r in told["records"].values())


def test_one_record_that_an_older_run_lacks_does_not_take_the_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = _rigid()
    built = {n: build_entity(spec, n, tmp_path) for n in spec.entities}
    caches = run_frames(spec, built, tmp_path / "run", frames=FRAMES)
    base = Candidate(tmp_path, spec, built, "probe", caches, "run", cache_digest(caches))
    name = next(iter(caches))
    older = edited(base, tmp_path / "older", name, lambda _, data: data.pop("record/joint_error"))
    monkeypatch.setattr(measurements, "latest_candidate", lambda *_: older)
    session: Any = SimpleNamespace(folder=SimpleNamespace(id="w"), spec=spec, shown=lambda *_: "")
    told = measurements.measured(session, "records", entities=None, frames=None, limit=50, offset=0)
    assert "joint_error" not in told["records"]
    assert "kinetic_energy" in told["records"]
    assert "joint_error" in told["summary"]


@pytest.mark.parametrize("kind", WORLDS)
def test_the_account_tells_of_every_category_and_holds_no_id(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = WORLDS[kind]()
    built = {n: build_entity(spec, n, tmp_path) for n in spec.entities}
    caches = run_frames(spec, built, tmp_path / "run", frames=FRAMES)
    candidate = Candidate(tmp_path, spec, built, "probe", caches, "run", cache_digest(caches))
    monkeypatch.setattr(measurements, "latest_candidate", lambda *_: candidate)
    session: Any = SimpleNamespace(folder=SimpleNamespace(id="w"), spec=spec, shown=lambda *_: "")
    told = measurements.measured(session, "account", entities=None, frames=None, limit=50, offset=0)
    assert told["account"].startswith(f"{len(spec.entities)} things, {FRAMES} frames")
    assert told["account"].count("\n- ") >= len({e.physics.category for e in spec.entities.values()})
    forms = {"ball", "box", "wall", "sheet", "liquid", "grains", "smoke", "dust"}  # ids that are words of the account too
    assert [n for n in spec.entities if n not in forms and n in told["account"]] == []
    assert told["left_out"] == {}
    assert not re.search(r"\b(inf|nan)\b", told["account"])
