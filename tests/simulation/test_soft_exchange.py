"""Bodies and sheets that deform as boundaries of each other: what one gives is what the other gets, at its own vertices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.elastic import Lattice
from worldagent.simulation.runs import make_run
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_soft import HAMMOCK_PROMPT, hammock_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.bake_plan import groups_of
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
    plan = hammock_spec(frames=FRAMES, edge=0.055, drop=0.002, radius=None)["simulation"]
    plan["drivers"]["air"] = {"kind": "field", "field": {"kind": "drag"}}
    spec, built = _world(simulation=plan)
    assert audit(spec).passed
    (group,) = groups_of(spec)
    run = make_run(spec, built, group)
    run.prepare()
    cloth, bodies = run.solvers["cloth"], run.solvers["bodies"]
    row = cloth.index().colliders.index("jelly/body")
    given, received, work, blown = [], [], [], 0.0
    for k in range(1, FRAMES):
        run.advance(k)
        given.append(cloth.frame_data()["exchange/impulse"][row])
        received.append(bodies.frame_data()["exchange/soft"][0])
        work.append(float(bodies.frame_data()["record/soft_exchange_work"]))
        blown += float(bodies.frame_data()["field/soft"][0, 2])  # still air
    assert np.abs(np.array(given)[:, :3] - np.array(received)[:, :3]).max() < 1e-13
    assert np.array(given)[:, 2].max() > 0.01
    seconds, mass = (FRAMES - 1) / 24, built["jelly"].bodies[0].mass
    momentum = float(bodies.frame_data()["record/elastic_momentum_z"])
    assert momentum == pytest.approx(-9.81 * mass * seconds + np.array(received)[:, 2].sum() + blown, rel=1e-6)
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


def sand_under_jelly(frames: int) -> dict[str, Any]:
    """A specification without its prompt: the jelly falls into the tray, no cloth in between."""
    spec = hammock_spec(frames=frames, radius=0.01)
    del spec["entities"]["cloth"], spec["simulation"]["solvers"]["cloth"]
    spec["entities"]["jelly"]["pose"]["position"] = [0.0, 0.0, 0.1]
    spec["simulation"]["couplings"] = {
        "both": {"source": "bodies", "target": "grains", "direction": "two_way", "variables": ["motion", "wrench"]}
    }
    return spec


@pytest.mark.slow
def test_a_jelly_rests_on_sand_and_both_get_what_the_other_gives() -> None:
    """Law: impulses are equal and opposite; at rest sand carries the jelly's weight, and no grain is in it."""
    frames = 12
    spec = parse_spec({**sand_under_jelly(frames), "prompt": HAMMOCK_PROMPT})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    (group,) = groups_of(spec)
    run = make_run(spec, built, group)
    run.prepare()
    grains, bodies = run.solvers["grains"], run.solvers["bodies"]
    row, given, work = grains.index().colliders.index("jelly/body"), [], 0.0
    for k in range(1, frames):
        run.advance(k)
        mine, theirs = grains.frame_data(), bodies.frame_data()["exchange/soft"][0]
        assert mine["exchange/impulse"][row, :3] == pytest.approx(theirs[:3], abs=1e-12)
        assert mine["exchange/impulse"][row] == pytest.approx(-mine["exchange/reaction"][row], abs=1e-12)
        given.append(mine["exchange/impulse"][row, 2])
        work += float(bodies.frame_data()["record/soft_exchange_work"])
    weight = built["jelly"].bodies[0].mass * 9.81
    assert np.mean(given[-6:]) * 24 == pytest.approx(weight, rel=0.25)
    assert work < 0
    surface = bodies.frame_data()["vertex/position"]
    top = (mine["particle/position"] + mine["origin"])[:, 2].max()
    assert surface[:, 2].min() > 0.02
    assert top < surface[:, 2].max()


def test_exchanges_are_short_only_while_grains_can_meet_what_gives_way() -> None:
    """Choice: a jelly that falls on sand is far from it for two frames; before it touches a grain, exchanges are those of collisions."""
    spec = sand_under_jelly(6)
    spec["entities"]["jelly"]["pose"]["position"] = [0.0, 0.0, 0.17]
    made = parse_spec({**spec, "prompt": HAMMOCK_PROMPT})
    built = {n: build_entity(made, n, Path()) for n in made.entities}
    run = make_run(made, built, groups_of(made)[0])
    run.prepare()
    grains = run.solvers["grains"]
    row, exchanges, given = grains.index().colliders.index("jelly/body"), [], []
    for k in range(1, 6):
        run.advance(k)
        data = grains.frame_data()
        exchanges.append(int(data["record/exchanges"]))
        given.append(float(np.abs(data["exchange/impulse"][row]).max()))
    touched = next(k for k, push in enumerate(given) if push > 0.0)
    assert touched >= 2
    assert exchanges[0] == 42  # of a millisecond each
    assert exchanges[touched] > 5 * exchanges[0]
    # Of exchanges of collisions in every frame, the first would have had as many.
    assert max(exchanges[: touched - 1]) == 42
