"""The approximation register tells what engines simplify, of the world as it is declared and of no other."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
from worldagent.bench.small_cloth import DRAPE_PROMPT, FLAG_PROMPT, drape_spec, flag_spec
from worldagent.bench.small_grains import SAND_PROMPT, sand_spec
from worldagent.bench.small_liquids import tank_spec
from worldagent.bench.small_soft import HAMMOCK_PROMPT, hammock_spec
from worldagent.construction.build import build_entity
from worldagent.simulation.rigid import SolverRigid
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import STONE, bond
from worldagent.verifiers.register import approximations
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.patch import parse_spec

WIND = {"kind": "field", "field": {"kind": "wind", "velocity": [10, 0, 0]}}


def _told(data: dict[str, Any], prompt: str = "p") -> dict[str, str]:
    """Lines of a world that is built and not simulated, by what they say is simplified."""
    spec = parse_spec({**data, "prompt": prompt})
    built = {n: build_entity(spec, n, Path()) for n, e in spec.entities.items() if e.physics.category in ("elastic", "rigid")}
    return {a["what"]: a["effect"] for a in approximations(Candidate(folder=Path(), spec=spec, built=built, stage="static"))}


def _any(lines: dict[str, str], *words: str) -> bool:
    return any(all(w in what for w in words) for what in lines)


def test_matter_of_instances_that_do_not_meet_is_told_where_their_domains_do() -> None:
    """Sand and water of one tank pass through each other; so do bodies of two rigid instances, and two liquids."""
    sand, water = sand_spec(ball_at=None), tank_spec(crate_at=None, spacing=0.05)
    both = deepcopy(sand)
    both["materials"] = {**water["materials"], **sand["materials"]}
    both["entities"]["water"] = water["entities"]["water"]
    both["simulation"]["solvers"]["water"] = deepcopy(water["simulation"]["solvers"]["water"])
    both["simulation"]["solvers"]["water"]["settings"]["domain"] = {"center": [0, 0, 0.2], "size": [1, 1, 1]}
    (grains,) = (n for n, s in both["simulation"]["solvers"].items() if s["engine"] == "dem")
    wanted = f"the particles of {grains!r} and the liquid of 'water' do not meet"
    assert "pass through each other" in _told(both)[wanted]
    both["simulation"]["solvers"]["water"]["settings"]["domain"]["center"] = [50, 0, 0.2]
    assert wanted not in _told(both)
    bodies = rigid_world.world({"a": rigid_world.ball(0.1, at=(0, 0, 1)), "b": rigid_world.ball(0.1, at=(1, 0, 1))}).model_dump()
    own = bodies["simulation"]["solvers"]["main"]
    bodies["simulation"]["solvers"] = {"one": {**own, "members": ["a"]}, "two": {**own, "members": ["b"]}}
    assert _any(_told(bodies), "the bodies of 'one' and the bodies of 'two' do not meet")


def test_who_moves_without_air_is_told_and_that_air_bears_nothing() -> None:
    still = drape_spec()
    drivers = still["simulation"].pop("drivers", {})
    still["simulation"]["drivers"] = {k: d for k, d in drivers.items() if d["kind"] != "field"}
    lines = _told(still, DRAPE_PROMPT)
    assert "no air: no field declares a medium" in lines
    assert not _any(lines, "the air is not moved by")
    windy = _told(flag_spec(), FLAG_PROMPT)
    assert _any(windy, "the air is not moved by 'cloth'")
    assert not _any(windy, "no air")
    (effect,) = (e for w, e in windy.items() if "medium of field" in w)
    assert "buoyed" in effect
    some = _told({**sand_spec(), "simulation": {**sand_spec()["simulation"], "drivers": {"w": {**WIND, "entities": ["sand"]}}}})
    assert "no air for ball" in some
    assert _any(some, "on particles is that of single spheres")


def test_a_breakable_body_in_the_wind_is_pushed_as_much_too_hard_as_the_register_says() -> None:
    """Known gap: each piece feels the wind alone. A ball shows the same area whatever way it is turned."""
    pushed, told = {}, {}
    for name, breakable in (("whole", None), ("cut", {"pattern": {"kind": "voronoi", "pieces": 40}, "bond": bond(1e8)})):
        more = {} if breakable is None else {"breakable": breakable}
        ball = rigid_world.ball(0.2, at=(0, 0, 5), material="brick", **more)
        spec = rigid_world.world({"ball": ball}, seconds=0.25, materials=STONE, drivers={"air": WIND})
        built = {"ball": build_entity(spec, "ball", Path())}
        solver = SolverRigid(spec, built, "main")
        solver.prepare()
        solver.advance(1)
        pushed[name] = float(solver.frame_data()["field/impulse"][:, 0].sum())
        lines = approximations(Candidate(folder=Path(), spec=spec, built=built, stage="static"))
        told[name] = [a["effect"] for a in lines if "as if it stood alone" in a["what"]]
    assert told["whole"] == []
    (effect,) = told["cut"]
    times = float(effect.split("up to ")[1].split(" ")[0])
    assert times > 2
    assert pushed["cut"] / pushed["whole"] == pytest.approx(times, rel=0.2)


def test_no_wind_breaks_what_a_register_says_that_it_cannot() -> None:
    """Known gap: fields load no bonds. A gale bends the foot of this wall with 1.5 rho v^2 (h / t)^2, ten times what its bonds bear."""
    gale = {"kind": "field", "field": {"kind": "wind", "velocity": [0, 60, 0]}}
    pattern = {"kind": "bricks", "size": [0.5, 0.1, 0.2], "joint": 0.0}
    breakable = {"pattern": pattern, "bond": bond(6e4), "fixed": ["z-"]}
    wall = rigid_world.box(1.0, 0.1, 1.0, at=(0, 0, 0.51), material="brick", breakable=breakable)
    spec = rigid_world.world({"wall": wall}, seconds=0.25, materials=STONE, drivers={"gale": gale})
    built = {"wall": build_entity(spec, "wall", Path())}
    solver = SolverRigid(spec, built, "main")
    solver.prepare()
    for frame in range(1, 5):
        solver.advance(frame)
    data = solver.frame_data()
    assert data["field/impulse"][:, 1].sum() > 50
    assert not data["bond/broken"].any()
    lines = [a["what"] for a in approximations(Candidate(folder=Path(), spec=spec, built=built, stage="static"))]
    assert "fields (gale) load no bonds of 'wall'" in lines


def test_long_steps_of_cloth_are_told_where_they_are_taken_and_as_long_as_they_are() -> None:
    free = _told(flag_spec(), FLAG_PROMPT)
    assert _any(free, "meets nothing its steps are up to 0.00417 s")
    assert _any(free, "touches something", "0.00417 s")
    gpu = flag_spec()
    gpu["simulation"]["solvers"]["cloth"]["settings"] = {"device": "cuda"}
    assert not _any(_told(gpu, FLAG_PROMPT), "its steps are")
    caught = _told(hammock_spec(radius=None), HAMMOCK_PROMPT)
    assert _any(caught, "meets nothing its steps are up to 0.001 s")
    assert not _any(caught, "touches something")


def test_what_holds_for_all_sheets_of_an_instance_is_told_of_all() -> None:
    data = flag_spec()
    data["entities"]["other"] = {**deepcopy(data["entities"]["flag"]), "pose": {"position": [0.65, 2, 2.1]}, "material": "rubber"}
    data["simulation"]["solvers"]["cloth"]["members"].append("other")
    data["entities"]["flag"]["physics"] |= {"ignores": ["pole"], "self_collision": False}
    lines = _told(data, FLAG_PROMPT)
    assert "'flag', 'other' of 'cloth' do not meet 'pole'" in lines
    assert _any(lines, "all sheets of 'cloth' rub alike")
    assert not _any(lines, "do not meet themselves")  # the other one asks for it, and the engine keeps all apart
    data["entities"]["other"]["physics"]["self_collision"] = False
    assert _any(_told(data, FLAG_PROMPT), "do not meet themselves or each other")
    data["entities"]["flag"]["physics"]["pins"]["hoist"]["to"] = "pole"
    assert _any(_told(data, FLAG_PROMPT), "'flag' that hang on 'pole' do not meet it")


def test_implicit_steps_and_contacts_of_elastic_bodies_are_told() -> None:
    lines = _told(hammock_spec(radius=None), HAMMOCK_PROMPT)
    (effect,) = (e for w, e in lines.items() if "implicit steps of 'jelly'" in w)
    assert "0.99%" in effect  # half of (2 pi)^2 times 0.5 ms; tests/physics/test_elastic.py measures it
    assert _any(lines, "'jelly' does not meet itself")
    fine = hammock_spec(radius=None)
    fine["entities"]["jelly"]["physics"]["resolution"] = 0.03
    assert not _any(_told(fine, HAMMOCK_PROMPT), "does not meet itself")


def test_energy_of_what_elastic_bodies_exchange_is_told_by_a_row_that_judges_it() -> None:
    """With grains in the group too, the row of jelly and cloth together has no case; each one's own judges it."""
    two = hammock_spec(radius=None)
    assert any(e.endswith("category:elastic:together:bodies") for e in _told(two, HAMMOCK_PROMPT).values())
    three = hammock_spec()
    three["simulation"]["couplings"]["sand"] = {**two["simulation"]["couplings"]["both"], "source": "grains"}
    told = _told(three, HAMMOCK_PROMPT)
    assert {e.rsplit(" ", 1)[1] for e in told.values() if "energy that the exchange" in e} == {
        "category:cloth:energy:cloth",
        "category:particles:energy:grains",
    }
    assert _any(told, "take no couples from grains of 'grains'")


def test_grains_coupled_with_other_bodies_do_not_push_those_of_another_coupling() -> None:
    """A coupling of something else with the bodies is none of the grains."""
    data: dict[str, Any] = sand_spec(coupled=False)
    solvers = data["simulation"]["solvers"]
    (grains,), (bodies,) = ([n for n, s in solvers.items() if s["engine"] == e] for e in ("dem", "mujoco"))
    solvers["others"] = {**deepcopy(solvers[bodies]), "members": ["tray"]}
    both = {"direction": "two_way", "variables": ["motion", "wrench"]}
    water = tank_spec(crate_at=None, spacing=0.05)
    data["materials"] = {**water["materials"], **data["materials"]}
    data["entities"]["water"] = water["entities"]["water"]
    solvers["water"] = water["simulation"]["solvers"]["water"]
    data["simulation"]["couplings"] = {
        "a": {"source": "others", "target": grains, **both},
        "b": {"source": bodies, "target": "water", **both},
    }
    lines = _told(data, SAND_PROMPT)
    assert f"grains of {grains!r} are pushed by bodies of {bodies!r} and do not push them" in lines
    assert _any(lines, "two-way coupling 'a' in exchanges")
    assert _any(lines, f"particles of {grains!r} that leave its domain are gone")
