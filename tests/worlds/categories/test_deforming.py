"""Deforming bodies as everybody reads them: bound surfaces, best rigid fits, files, and the rigid checks on their true shape."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from worldagent.geometry.camera import Camera
from worldagent.rendering import id_view
from worldagent.testing.worlds.small_worlds import box, ground, world
from worldagent.testing.worlds.soft_worlds import block_mesh, deformed_candidate
from worldagent.verifiers.contact import check as contact
from worldagent.verifiers.ledgers import motion
from worldagent.verifiers.scene.surfaces import surfaces_of
from worldagent.worlds.built import load_built, save_built
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.spec import ElasticPhysics

SOFT = ElasticPhysics(young_modulus=1e5)
SIZE = (0.4, 0.2, 0.2)


@pytest.fixture
def things():
    return {"floor": ground(), "soft": box(*SIZE, motion="dynamic", at=(0, 0, 0.3), physics=SOFT)}


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def made(tmp_path, things, move, frames=6):
    return deformed_candidate(tmp_path, world(things, frames=frames), {"soft": block_mesh(SIZE, (4, 2, 2))}, {"soft": move})


def test_a_simulation_mesh_survives_its_file(tmp_path, things):
    built = made(tmp_path, things, lambda t, x: x).built["soft"]
    save_built(built, tmp_path / "soft.built")
    again = load_built(tmp_path / "soft.built")
    assert again.digest() == built.digest()
    mesh, before = again.parts[0].simulation, built.parts[0].simulation
    for field in dataclasses.fields(mesh):
        assert np.array_equal(getattr(mesh, field.name), getattr(before, field.name))


def test_the_fit_of_a_rigid_motion_is_that_motion(tmp_path, things):
    """Law: a body that only moves and turns has the pose, velocity and spin of a rigid body."""

    def move(t, x):
        return (x - [0, 0, 0.3]) @ turned(2.0 * t).T + [0.5 * t, 0, 0.3]

    candidate = made(tmp_path, things, move)
    pose = candidate.pose("soft", 5)
    assert pose.position == pytest.approx([0.5 * 5 / 24, 0, 0.3], abs=1e-9)
    assert pose.quaternion == pytest.approx([np.cos(5 / 24), 0, 0, np.sin(5 / 24)], abs=1e-9)
    assert motion.velocities(candidate, "soft")[5] == pytest.approx([0.5, 0, 0], abs=1e-5)
    assert candidate.deforming["soft"].spin(5) == pytest.approx([0, 0, 2.0], abs=1e-5)
    rest = candidate.built["soft"].parts[0].render.vertices
    assert candidate.shape("soft", "p0", 5) == pytest.approx(rest, abs=1e-9)


def test_rigid_checks_measure_the_deformed_surface(tmp_path, things):
    """A bar that sags in its middle until it dips into the floor: its fit alone would not touch it."""

    def move(t, x):
        sag = 1.25 * t * (1.0 - (x[:, 0] / 0.2) ** 2)
        return np.column_stack([x[:, 0], x[:, 1], x[:, 2] - sag])

    candidate = made(tmp_path, things, move)
    surfaces = surfaces_of(candidate)
    low = [candidate.surface("soft", "p0", k)[:, 2].min() for k in range(6)]
    assert low == pytest.approx([0.2 - 1.25 * k / 24 for k in range(6)], abs=1e-12)
    assert surfaces.gap("soft", "floor", 3).distance == pytest.approx(low[3], abs=1e-9)
    rows = {r.id: r for r in contact.check(candidate)}
    row = rows["contact:floor:soft"]
    assert row.status == rows["contact:scene"].status == "fail"
    assert (row.first_failing_entity, row.first_failing_frame) == ("soft", 4)
    assert row.measured == pytest.approx(low[5], rel=1e-6)


def test_pictures_show_the_deformed_surface(tmp_path, things):
    candidate = made(tmp_path, things, lambda t, x: x * [1.0, 1.0, 1.0 + 10 * t] - [0, 0, 3.0 * t])
    camera = Camera(np.array([0, -3.0, 0.4]), np.array([0, 0, 0.4]), 40.0, 160, 120)
    first, last = (id_view(candidate, k, camera=camera) for k in (0, 5))
    assert (first != last).any(axis=2).sum() > 500


def test_a_cache_of_another_mesh_is_no_evidence(tmp_path, things):
    candidate = made(tmp_path, things, lambda t, x: x)
    other = dataclasses.replace(candidate.built["soft"].parts[0], simulation=block_mesh(SIZE, (2, 2, 2)))
    built = {**candidate.built, "soft": dataclasses.replace(candidate.built["soft"], parts=(other,))}
    with pytest.raises(EvidenceError, match="does not belong"):
        dataclasses.replace(candidate, built=built).pose("soft", 0)
