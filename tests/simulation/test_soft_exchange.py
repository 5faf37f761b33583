"""Bodies and sheets that deform as boundaries of each other: what one gives is what the other gets, at its own vertices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.bench.small_soft import HAMMOCK_PROMPT, hammock_spec
from worldagent.construction.build import build_entity
from worldagent.simulation.elastic import Lattice
from worldagent.simulation.runs import groups_of, make_run
from worldagent.simulation.schedule import run_frames
from worldagent.worlds.audit import audit
from worldagent.worlds.patch import parse_spec

FRAMES = 5


def _world(**changes: Any) -> tuple[Any, dict[str, Any]]:
    spec = parse_spec({**hammock_spec(frames=FRAMES, edge=0.055, drop=0.002, radius=None, **changes), "prompt": HAMMOCK_PROMPT})
    return spec, {n: build_entity(spec, n, Path()) for n in spec.entities}


def test_forces_at_vertices_and_at_the_nodes_that_carry_them_are_the_same_to_rounding() -> None:
    """Law: the transpose of the binding keeps force, moment and power."""
    _, built = _world()
    mesh = built["jelly"].parts[0].simulation
    assert mesh is not None
    lattice, rng = Lattice(mesh), np.random.default_rng(3)
    force, bend = rng.normal(size=mesh.vertices.shape), rng.normal(size=(3, 3))
    nodes, places = lattice.to_nodes(force), lattice.nodes @ bend
    there = lattice.at_vertices(places)
    assert nodes.sum(axis=0) == pytest.approx(force.sum(axis=0), abs=1e-11)
    assert np.cross(places, nodes).sum(axis=0) == pytest.approx(np.cross(there, force).sum(axis=0), abs=1e-11)
    assert float((places * nodes).sum()) == pytest.approx(float((there * force).sum()), abs=1e-11)


def test_a_jelly_and_the_cloth_it_drops_on_give_each_other_what_they_get() -> None:
    """Law: what the cloth gave, the engine of the jelly integrated; both momenta add up from their own vertices."""
    spec, built = _world()
    assert audit(spec).passed
    (group,) = groups_of(spec)
    run = make_run(spec, built, group)
    run.prepare()
    cloth, bodies = run.solvers["cloth"], run.solvers["bodies"]
    row = cloth.index().colliders.index("jelly/body")
    given, received, work = [], [], []
    for k in range(1, FRAMES):
        run.advance(k)
        given.append(cloth.frame_data()["exchange/impulse"][row])
        received.append(bodies.frame_data()["exchange/soft"][0])
        work.append(float(bodies.frame_data()["record/soft_exchange_work"]))
    assert np.abs(np.array(given)[:, :3] - np.array(received)[:, :3]).max() < 1e-13
    assert np.array(given)[:, 2].max() > 0.01
    seconds, mass = (FRAMES - 1) / 24, built["jelly"].bodies[0].mass
    momentum = float(bodies.frame_data()["record/elastic_momentum_z"])
    assert momentum == pytest.approx(-9.81 * mass * seconds + np.array(received)[:, 2].sum(), rel=1e-4)
    data = cloth.frame_data()
    told = sum(float(data[f"record/{by}_impulse_z"]) for by in ("air", "hold", "solid", "cut", "load"))
    assert float(data["record/momentum_z"]) == pytest.approx(told - 9.81 * float(data["record/mass"]) * seconds, abs=1e-12)
    # A falling body that is caught loses energy to what catches it.
    assert sum(work) < 0


def test_one_way_the_cloth_follows_the_jelly_of_the_cache_which_falls_freely(tmp_path: Path) -> None:
    """Choice: without a coupling the cloth gives way to the jelly, and the jelly does not feel it."""
    plan = {**hammock_spec(frames=FRAMES, edge=0.055, drop=0.002, radius=None)["simulation"], "couplings": {}}
    spec, built = _world(simulation=plan)
    assert groups_of(spec) == [("bodies",), ("cloth",)]
    caches = run_frames(spec, built, tmp_path, frames=FRAMES)
    jelly, sheet = (caches[n].series("vertex/position") for n in ("bodies", "cloth"))
    fallen = (jelly[0] - jelly[-1])[:, 2].mean()
    assert fallen == pytest.approx(0.5 * 9.81 * ((FRAMES - 1) / 24) ** 2, rel=0.01)
    assert np.abs(caches["cloth"].series("exchange/impulse")[:, -1]).max() > 0
    assert sheet[-1, :, 2].min() < jelly[-1, :, 2].min()
