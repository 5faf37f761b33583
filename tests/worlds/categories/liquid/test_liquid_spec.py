"""Liquids in a specification: what the schema takes, what the audit asks of them, what they will cost (R57, R58, R66)."""

from __future__ import annotations

import math
import re
from typing import Any

import pytest
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.categories.liquid.facts import liquid_estimate, liquid_seconds
from worldagent.worlds.errors import LimitError, SpecError
from worldagent.worlds.extents import shape_volume
from worldagent.worlds.limits import check_limits, estimate_counts
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.schema_words import described
from worldagent.worlds.spec import Box, Capsule, Cylinder, Extrusion, FlipInstance, Mesh, Revolution, Sphere, Wedge, WorldSpec

WATER = "/simulation/solvers/water"
INFLOW = {"kind": "inflow", "entity": "water", "pose": {"position": [0, 0, 0.45]}, "size": [0.1, 0.1], "speed": 1.0}
DRAIN = {"kind": "outflow", "entity": "water", "pose": {"position": [0, 0, 0.05]}, "size": [0.1, 0.1, 0.1], "level": 0.1}


def base(**options: Any) -> WorldSpec:
    return parse_spec({**tank_spec(**options), "prompt": PROMPT})


def broken(*operations: tuple[str, Any]) -> WorldSpec:
    patch = [{"op": "remove", "path": p} if v is None else {"op": "add", "path": p, "value": v} for p, v in operations]
    return apply_patch(base(), patch)


def problems(spec: WorldSpec, row: str) -> str:
    found = next(r for r in audit(spec).rows if r.id == f"audit:{row}")
    return " ".join(found.evidence.get("problems", []))


def test_a_tank_of_water_passes_the_audit_and_bakes_bodies_with_their_liquid() -> None:
    report = audit(base())
    assert [r.id for r in report.rows if r.status != "pass"] == []
    assert report.bake_order == ("rigid", "water")


def test_a_liquid_without_coupling_comes_after_the_bodies_that_it_reads() -> None:
    spec = broken(("/simulation/couplings/float", None))
    solvers = spec.simulation.solvers
    turned = spec.model_copy(
        update={"simulation": spec.simulation.model_copy(update={"solvers": dict(reversed(solvers.items()))})}
    )
    assert list(turned.simulation.solvers) == ["water", "rigid"]
    assert audit(turned).bake_order == ("rigid", "water")


BROKEN: dict[str, tuple[list[tuple[str, Any]], str, str]] = {
    "a liquid in a rigid instance": ([("/simulation/solvers/rigid/members/-", "water")], "ownership", "take it out"),
    "a solid in a liquid instance": ([(f"{WATER}/members/-", "crate")], "ownership", "does not move"),
    "a static liquid": ([("/entities/water/motion", "static")], "liquids", "liquids are dynamic"),
    "no instance": ([(WATER, None), ("/simulation/couplings", {})], "ownership", "'water' .* is in no solver"),
    "a coarse resolution": ([("/entities/water/physics/resolution", 0.1)], "liquids", "0.2 m thin, less than 3 spacings"),
    "two resolutions": (
        [("/entities/oil", {**tank_spec()["entities"]["water"], "physics": {"category": "liquid", "resolution": 0.05}}),
         (f"{WATER}/members/-", "oil")], "liquids", "an instance has one"),
    "a domain that cuts the water": ([(f"{WATER}/settings/domain/size", [0.3, 0.6, 0.6])], "liquids", "cuts the initial volume of 'water'"),
    "an inflow outside": (
        [("/simulation/drivers/tap", {**INFLOW, "pose": {"position": [0, 0, 2]}})], "liquids", "'tap' .* reaches out of the domain"),
    "a narrow inflow": ([("/simulation/drivers/tap", {**INFLOW, "size": [0.1, 0.02]})], "liquids", "0.02 m wide, less than 3 spacings"),
    "a late inflow": ([("/simulation/drivers/tap", {**INFLOW, "start": 9})], "liquids", "after the last frame"),
    "an inflow of wood": ([("/simulation/drivers/tap", {**INFLOW, "entity": "crate"})], "liquids", "which is no liquid"),
    "a level of particles": ([("/simulation/drivers/tap", {**INFLOW, "level": 0.2})], "liquids", "at one speed only; use engine flip"),
    "a gauge without a level": ([("/simulation/drivers/tap", {**INFLOW, "gauge": [0, 0]})], "liquids", "has a gauge and no level"),
    "a level at the floor": ([("/simulation/drivers/drain", {**DRAIN, "level": -0.05})], "liquids", "the domain reaches from -0.1 to 0.5 m"),
    "a gauge outside": ([("/simulation/drivers/drain", {**DRAIN, "gauge": [2, 0]})], "liquids", "outside of the domain"),
    "a level without a down": (
        [("/simulation/drivers/drain", DRAIN), ("/simulation/gravity", [1, 0, -9.81])], "liquids", "does not point down"),
    "a force on water": (
        [("/simulation/drivers/push", {"kind": "force", "entity": "water", "end": 1})], "liquids", "'force' cannot act on a liquid"),
    "a liquid that drives bodies one way": (
        [("/simulation/couplings/float/direction", "one_way")], "couplings", "one_way goes from the rigid"),
    "a coupling without forces": ([("/simulation/couplings/float/variables", ["motion"])], "couplings", "it exchanges wrench too"),
    "heat": ([("/simulation/couplings/float/variables", ["motion", "wrench", "heat"])], "couplings", "heat is exchanged by no engine"),
    "a coupling with itself": ([("/simulation/couplings/float/source", "rigid")], "couplings", "joins two rigid instances"),
    "an order that cannot be": (
        [("/simulation/couplings", {}), ("/simulation/order", ["water", "rigid"])], "couplings|liquids", "put it after"),
}  # fmt: skip


def test_a_bath_and_a_grid_stream_that_hold_a_level_pass_the_audit() -> None:
    bath = broken(("/simulation/drivers/drain", {**DRAIN, "gauge": [0.1, 0.1]}))
    fed = apply_patch(base(engine="flip"), [{"op": "add", "path": "/simulation/drivers/tap", "value": {**INFLOW, "level": 0.22}}])
    assert [problems(spec, "liquids") for spec in (bath, fed)] == ["", ""]


@pytest.mark.parametrize("name", BROKEN)
def test_the_audit_names_what_is_wrong(name: str) -> None:
    operations, rows, text = BROKEN[name]

    spec = broken(*operations)
    said = " ".join(problems(spec, r) for r in rows.split("|") if any(x.id == f"audit:{r}" for x in audit(spec).rows))
    assert re.search(text, said), said


@pytest.mark.parametrize("height", [0.0, 0.1, 0.06, 0.345])
@pytest.mark.parametrize("side", [0.2, 0.09, 0.1])
def test_the_spacing_that_a_message_asks_for_is_taken(side: float, height: float) -> None:
    water = tank_spec()["entities"]["water"]
    place, size = water["pose"]["position"], [0.4, 0.4, side]
    operations = [
        ("/entities/water/pose/position", [*place[:2], height + side / 2]),
        ("/entities/water/dimensions/size", size),
        ("/entities/water/parts", {"body": {"shape": {"kind": "box", "size": size}}}),
    ]
    said = problems(broken(*operations, ("/entities/water/physics/resolution", 0.5 * side)), "liquids")
    asked = float(re.search(r"use at most (\S+) m", said)[1])
    assert asked == pytest.approx(side / 3, rel=1e-3)
    assert "thin" not in problems(broken(*operations, ("/entities/water/physics/resolution", asked)), "liquids")


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ((f"{WATER}/settings", {}), "domain"),
        ((f"{WATER}/engine", "sph"), "mujoco, dfsph, flip"),
        ((f"{WATER}/settings/step", 1e-3), "max_step"),
        (("/simulation/drivers/tap", {k: v for k, v in INFLOW.items() if k != "speed"}), "give either speed or rate"),
    ],
)
def test_the_schema_says_what_may_stand_there(change: tuple[str, Any], text: str) -> None:
    with pytest.raises(SpecError, match=text):
        broken(change)


def test_settings_of_an_instance_are_described_by_its_engine() -> None:
    document = base().model_dump(mode="json")
    assert described("/simulation/solvers/water/settings", document)["type"] == "DfsphSettings"
    assert described("/simulation/solvers/rigid/settings", document)["type"] == "RigidSettings"
    assert set(described("SolverInstance")["options"]) == {"mujoco", "dfsph", "flip", "gas", "shell", "dem", "ballistic"}


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (Box(size=(1, 2, 3)), 6.0),
        (Wedge(size=(1, 2, 3)), 3.0),
        (Sphere(radius=2), 32 / 3 * math.pi),
        (Cylinder(radius=2, height=3), 12 * math.pi),
        (Capsule(radius=1, length=2), 10 / 3 * math.pi),
        (Extrusion(polygon=[(0, 0), (2, 0), (2, 1), (0, 1)], height=3), 6.0),
        (Revolution(profile=[(1, 0), (2, 0), (2, 3), (1, 3)]), 9 * math.pi),
        (Mesh(vertices=[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], faces=[(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]), 1 / 6),
    ],
)
def test_volumes_of_shapes_are_exact(shape: Any, volume: float) -> None:
    assert shape_volume(shape) == pytest.approx(volume, rel=1e-12)


def test_particles_are_counted_from_volume_and_inflow() -> None:
    still = liquid_estimate(base(), "water")
    assert still.particles == pytest.approx(0.4 * 0.4 * 0.2 / 0.025**3)
    fed = liquid_estimate(broken(("/simulation/drivers/tap", {**INFLOW, "start": 0.5, "end": 0.75})), "water")
    assert fed.particles - still.particles == pytest.approx(0.01 * 1.0 * 0.25 / 0.025**3)
    assert fed.steps > 23 / 24 / 5e-3 - 1e-9
    grid = liquid_estimate(base(engine="flip"), "water")
    assert grid.cells == pytest.approx(0.6**3 / 0.025**3)
    assert grid.particles == pytest.approx(8 * still.particles)


@pytest.mark.parametrize(("engine", "least"), [("dfsph", 0.009), ("flip", 0.035)])
def test_a_step_takes_its_time_however_few_particles_there_are(engine: str, least: float) -> None:
    """A glass of 900 particles took 17 ms a step, of which its particles were 6: probes were passed three to five times."""
    spec = apply_patch(base(engine=engine), [{"op": "add", "path": "/entities/water/physics/resolution", "value": 0.05}])
    found, seconds = liquid_estimate(spec, "water"), liquid_seconds(spec)
    assert seconds is not None
    assert seconds == pytest.approx(found.steps * (least + found.particles / {"dfsph": 1.5e5, "flip": 1e6}[engine]))


def test_too_many_particles_are_refused_with_the_knob() -> None:
    with pytest.raises(LimitError, match=r"particles: estimated .* cap 20,000,000\. Knob: .*resolution"):
        check_limits(broken(("/entities/water/physics/resolution", 0.001)))
    assert estimate_counts(base())["steps"] > 0


def test_a_world_of_before_loads_unchanged() -> None:
    from worldagent.tests.stories.small_run import PROMPT as SMALL
    from worldagent.tests.stories.small_run import small_spec

    spec = parse_spec({**small_spec(), "prompt": SMALL})
    again = parse_spec(spec.model_dump(mode="json"))
    assert again == spec
    assert list(spec.simulation.rigid) == ["rigid"]
    assert spec.simulation.liquid == {}
    assert isinstance(base(engine="flip").simulation.liquid["water"], FlipInstance)
