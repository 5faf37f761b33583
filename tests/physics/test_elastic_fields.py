"""Force fields on elastic bodies against closed forms: even accelerations, a wind on a block, a beam that is drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.rigid import SolverRigid
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_worlds import box, world
from worldagent.verifiers.categories.elastic import check as elastic
from worldagent.worlds.cache import read_container, write_container
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.spec import ElasticPhysics, FieldDriver, Material, Pin, RigidSettings, WorldSpec
from worldagent.worlds.spec.fields import AttractionField, WindField

SIDE, DENSE = 0.2, 50.0
EVEN = AttractionField(center=(1e5, 0, 1), acceleration=4.0, distance=1.0, exponent=0.0)
MATERIALS = {"wood": Material(density=DENSE, friction=0.6)}


def block(driver: FieldDriver, *, frames: int = 7, pins: dict[str, Pin] | None = None) -> WorldSpec:
    soft = ElasticPhysics(young_modulus=2e4, resolution=SIDE / 2, damping=1e-3, pins=pins or {})
    things = {"block": box(SIDE, SIDE, SIDE, motion="dynamic", at=(0, 0, 1), physics=soft)}
    settings = RigidSettings(step=2e-3)
    return world(things, frames=frames, materials=MATERIALS, settings=settings, gravity=(0, 0, 0), drivers={"field": driver})


def simulate(folder: Path, spec: WorldSpec) -> Candidate:
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return Candidate(folder, spec, built, "probe", caches, "run", cache_digest(caches))


def rows_of(candidate: Candidate) -> dict[str, str]:
    return {r.id.split(":")[2]: r.status for r in elastic.category_rows(candidate, "rigid")}


def test_an_even_acceleration_moves_all_alike_and_is_in_the_books(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, block(FieldDriver(field=EVEN, start=1 / 24)))
    frame = candidate.caches["rigid"].read(6)
    assert np.allclose(frame["vertex/velocity"], (4 * 5 / 24, 0, 0), atol=1e-5)
    mass = DENSE * SIDE**3
    assert frame["field/soft"][0] == pytest.approx((mass * 4 / 24, 0, 0), abs=1e-5)
    # Semi-implicit steps of 2 ms do a little more work than the true path.
    work = sum(float(candidate.caches["rigid"].read(k)["record/soft_field_work"]) for k in range(7))
    assert work == pytest.approx(0.5 * mass * (4 * 5 / 24) ** 2, rel=0.02)
    rows = rows_of(candidate)
    assert (rows["fields"], rows["energy"], rows["records"]) == ("pass", "pass", "pass")


def test_a_wind_pushes_a_block_as_its_drag_says(tmp_path: Path) -> None:
    wind = WindField(velocity=(0, 12, 0), coefficient=1.05)
    candidate = simulate(tmp_path, block(FieldDriver(field=wind), frames=13))
    speed = candidate.caches["rigid"].read(12)["vertex/velocity"].mean(axis=0)
    # dv/dt = k (V - v)^2 with k = rho C A / 2 m: v = V - V / (1 + V k t).
    k = 0.5 * 1.204 * 1.05 * SIDE**2 / (DENSE * SIDE**3)
    assert speed[1] == pytest.approx(12 - 12 / (1 + 12 * k * 0.5), rel=0.02)
    assert rows_of(candidate)["fields"] == "pass"


def test_records_that_were_edited_are_found(tmp_path: Path) -> None:
    candidate = simulate(tmp_path, block(FieldDriver(field=EVEN)))
    cache = candidate.caches["rigid"]
    digests = cache.digests()
    held = read_container(cache.path(3))
    digests[3] = write_container(cache.path(3), held | {"field/soft": 1.3 * held["field/soft"]})
    cache.begin_digests(digests)
    fresh = Candidate(candidate.folder, candidate.spec, candidate.built, "probe", candidate.caches, "run", "edited")
    row = next(r for r in elastic.category_rows(fresh, "rigid") if ":fields:" in r.id)
    assert (row.status, row.first_failing_frame, row.first_failing_entity) == ("fail", 3, "block")


@pytest.mark.slow
def test_a_block_that_hangs_in_a_field_stretches_as_a_bar_does(tmp_path: Path) -> None:
    """Law: rho a L^2 / (2 E) for a bar that is pulled evenly from one end, Poisson's ratio 0 at the pinned face."""
    pins = {"wall": Pin(center=(-SIDE / 2, 0, 0), size=(1e-3, 1, 1))}
    strong = EVEN.model_copy(update={"acceleration": 40.0})
    spec = block(FieldDriver(field=strong), frames=73, pins=pins)
    soft = spec.entities["block"].physics.model_copy(update={"poisson_ratio": 0.0, "damping": 0.01})
    entity = spec.entities["block"].model_copy(update={"physics": soft})
    candidate = simulate(tmp_path, spec.model_copy(update={"entities": {"block": entity}}))
    moved = candidate.caches["rigid"].read(72)["vertex/position"][:, 0].max() - SIDE / 2
    assert moved == pytest.approx(DENSE * 40 * SIDE**2 / (2 * 2e4), rel=0.03)
    assert rows_of(candidate)["fields"] == "pass"


def test_a_run_that_goes_on_from_a_checkpoint_is_blown_alike() -> None:
    spec = block(FieldDriver(field=WindField(velocity=(5, 9, 0), gust=0.5)), frames=4)
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    one, two = SolverRigid(spec, built, "rigid"), SolverRigid(spec, built, "rigid")
    one.prepare()
    one.advance(1)
    state = one.checkpoint()
    one.advance(2)
    two.prepare(resumed=True)
    two.restore(state, 1)
    two.advance(2)
    assert all(np.array_equal(one.frame_data()[k], two.frame_data()[k]) for k in one.frame_data())
    assert one.frame_data()["field/soft"][0, 1] > 0
