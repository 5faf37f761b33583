"""Elastic bodies that lie: large flat sides rest, the ground carries the weight at every vertex, small things stay outside between vertices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.rigid import SolverRigid
from worldagent.simulation.rigid.flex_contacts import MOST, surfaces_of
from worldagent.testing.worlds.small_worlds import ball, box, ground, world
from worldagent.worlds.simulation_mesh import volumes
from worldagent.worlds.spec import ElasticPhysics, Entity, Material, RigidSettings

G, SKIN, FPS = 9.81, 8e-4, 24
RUBBER = {"wood": Material(density=900.0, friction=0.8)}


def _cushion(side: float = 0.5, *, on: float = 0.0) -> Entity:
    """A slab of rubber 0.1 m high, one cell of it."""
    soft = ElasticPhysics(young_modulus=1.5e6, poisson_ratio=0.45, damping=3e-4, resolution=0.125)
    return box(side, side, 0.1, motion="dynamic", at=(0, 0, on + 0.05 + 2 * SKIN), physics=soft)


def _run(things: dict[str, Entity], frames: int, *, preroll: float = 0.05) -> tuple[SolverRigid, list[dict[str, Any]]]:
    spec = world(things, frames=frames, fps=FPS, preroll=preroll, materials=RUBBER, settings=RigidSettings(step=5e-4, skin=SKIN))
    solver = SolverRigid(spec, {n: build_entity(spec, n, Path()) for n in things}, "rigid")
    solver.prepare()
    found = [dict(solver.frame_data())]
    for k in range(1, frames):
        solver.advance(k)
        found.append(dict(solver.frame_data()))
    return solver, found


@pytest.fixture(scope="module")
def lying() -> tuple[SolverRigid, list[dict[str, Any]]]:
    """A rubber cushion of 22 kg on a flat floor: 81 vertices of its surface lie on it."""
    return _run({"floor": ground(), "cushion": _cushion()}, 4)


def test_a_cushion_on_a_flat_floor_lies_still(lying: tuple[SolverRigid, list[dict[str, Any]]]) -> None:
    """Equilibrium: its motion falls below 1e-6 of the energy that it would have at 1 m/s.

    With one contact per flat tetrahedron, 50 of them at most and others in every step, a cushion of 46 kg kept 0.01 J for ever, 4e-4 of it.
    """
    solver, frames = lying
    mass = float(sum(b.masses.sum() for b in solver.rigid.flexes))
    assert [f["record/elastic_kinetic_energy"] < 1e-6 * mass / 2 for f in frames[1:]] == [True] * 3


def test_the_floor_carries_the_weight_at_every_vertex(lying: tuple[SolverRigid, list[dict[str, Any]]]) -> None:
    """Balance of momentum: the impulse of a frame is the weight times its duration within 0.5 %; as many contacts as vertices lie there."""
    solver, frames = lying
    mass = float(sum(b.masses.sum() for b in solver.rigid.flexes))
    mesh = solver.rigid.flexes[0].lattice.mesh
    under = np.count_nonzero(np.isclose(mesh.vertices[np.unique(mesh.faces), 2], -0.05))
    assert under > MOST
    for frame in frames[1:]:
        assert float(frame["contact/impulse"].sum()) == pytest.approx(mass * G / FPS, rel=5e-3)
        assert int(frame["record/contacts_max"]) == under


def test_a_marble_lies_between_vertices_and_stays_outside() -> None:
    """A ball of 2 cm between vertices 6 cm apart: its lowest point stays over the deformed faces, at every frame."""
    things = {
        "floor": ground(),
        "cushion": _cushion(),
        "marble": ball(0.01, motion="dynamic", at=(0.02, 0.04, 0.1115 + 2 * SKIN)),
    }
    solver, frames = _run(things, 6)
    top = frames[0]["vertex/position"][:, 2].max()
    row = solver.index().bodies.index("marble/body")
    heights = [float(f["position"][row, 2] - 0.01 - top) for f in frames]
    assert min(heights) > -2e-5
    assert heights[-1] < 2 * SKIN


def test_one_cushion_carries_another() -> None:
    """Elastic bodies meet each other by the flexes with the elasticity: the upper one stays on the lower."""
    upper = _cushion(0.25, on=0.1 + 2 * SKIN)
    solver, frames = _run({"floor": ground(), "lower": _cushion(), "upper": upper}, 4)
    mass = float(sum(b.masses.sum() for b in solver.rigid.flexes))
    colliders = solver.index().colliders
    pairs = [sorted(colliders[i] for i in p) for p in frames[-1]["contact/pair"].tolist()]
    assert sorted(pairs) == [["floor", "lower"], ["lower", "upper"]]
    assert float(frames[-1]["contact/impulse"][pairs.index(["floor", "lower"])]) == pytest.approx(mass * G / FPS, rel=0.1)


def test_surfaces_hold_every_vertex_and_face_in_small_parts(lying: tuple[SolverRigid, list[dict[str, Any]]]) -> None:
    lattice = lying[0].rigid.flexes[0].lattice
    parts = surfaces_of(lattice, SKIN)
    assert max(len(p.tets) for p in parts) <= MOST
    assert all((volumes(p.vertices, p.tets) > 0).all() for p in parts)
    ends = np.concatenate([p.vertices[p.tets[:, 0]] for p in parts if p.margin > 0])
    assert {tuple(v) for v in ends.tolist()} == {tuple(v) for v in lattice.mesh.vertices[np.unique(lattice.mesh.faces)].tolist()}
    behind = np.concatenate([p.tets for p in parts if p.margin == 0])
    held = {frozenset(f) for tet in behind.tolist() for f in ((tet[:k] + tet[k + 1 :]) for k in range(4))}
    assert {frozenset(f) for f in lattice.mesh.faces.tolist()} <= held
