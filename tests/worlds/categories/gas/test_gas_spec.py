"""Audit of gases, their estimated cost, and how a probe coarsens them."""

from __future__ import annotations

import copy
import re
from typing import Any

import pytest
from worldagent.testing.worlds.small_gas import SMOKE_PROMPT, smoke_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.categories.gas.facts import gas_counts, gas_seconds, grid_of
from worldagent.worlds.coarsening import coarsened, overrides_for
from worldagent.worlds.errors import LimitError
from worldagent.worlds.limits import check_limits
from worldagent.worlds.spec import WorldSpec

SMOKE = {"prompt": SMOKE_PROMPT, **smoke_spec()}
AIR = "/simulation/solvers/air/settings"
WIND = {"kind": "field", "field": {"kind": "wind", "velocity": [1, 0, 0]}}
FAR = {"kind": "sphere", "center": [30, 0, 0], "radius": 1}
PULL = {"kind": "field", "field": {"kind": "attraction", "center": [0, 0, 0], "acceleration": 1.0, "distance": 1.0}}
BOTH = {"source": "bodies", "target": "air", "direction": "two_way", "variables": ["motion", "wrench"]}


def changed(*edits: tuple[str, Any]) -> WorldSpec:
    """The small world with other values at some pointers."""
    document = copy.deepcopy(SMOKE)
    for pointer, value in edits:
        *way, last = pointer.strip("/").split("/")
        node = document
        for step in way:
            node = node[step]
        node[last] = value
    return WorldSpec.model_validate(document)


def row(spec: WorldSpec, name: str) -> Any:
    return next(r for r in audit(spec).rows if r.id == f"audit:{name}")


def test_a_sound_gas_passes_with_and_without_wind() -> None:
    for spec in (changed(), changed(("/simulation/drivers/wind", WIND))):
        assert row(spec, "gases").status == "pass"
        assert row(spec, "ownership").status == "pass"


SPARK = {"kind": "ignition", "entity": "smoke", "center": [0, 0, 0.1], "radius": 0.1}
GAS = {"category": "gas", "temperature": 400.0, "resolution": 0.05, "fuel": "wood"}


def burning(*edits: tuple[str, Any]) -> WorldSpec:
    """The small world with a fire in the bowl, and other values at some pointers."""
    return changed(("/entities/smoke/physics", dict(GAS)), ("/simulation/drivers/spark", dict(SPARK)), *edits)


def test_a_gas_with_fuel_and_a_spark_passes_and_one_hot_enough_needs_none() -> None:
    assert row(burning(), "gases").status == "pass"
    hot = changed(("/entities/smoke/physics", {**GAS, "temperature": 700.0}))
    assert row(hot, "gases").status == "pass"


@pytest.mark.parametrize(
    ("edit", "text"),
    [
        (
            ("/simulation/drivers", {"fire": {"kind": "emission", "entity": "smoke", "rate": 0.004}}),
            "nothing lights 'smoke'.*from 623 K",
        ),
        ((f"{AIR}/expands", False), "burns, and hot gas is light: let it expand"),
        (("/entities/smoke/physics/fuel", None), "which is no gas with a fuel"),
        (("/simulation/drivers/spark/start", 9.0), "'spark' starts at 9 s, after the last frame"),
        (("/simulation/drivers/spark/center", [0, 0, 5]), "outside the box of the gas of 'air'"),
    ],
)
def test_a_fire_that_cannot_be_is_told_with_the_way_out(edit: tuple[str, Any], text: str) -> None:
    found = row(burning(edit), "gases")
    assert found.status == "fail"
    assert re.search(text, str(found.model_dump()))


def test_the_spark_that_the_audit_offers_lights_it() -> None:
    unlit = burning(("/simulation/drivers", {"fire": {"kind": "emission", "entity": "smoke", "rate": 0.004}}))
    patch = next(c.patch[0] for c in row(unlit, "gases").corrections if c.patch)
    mended = burning(
        (
            "/simulation/drivers",
            {**{k: d.model_dump() for k, d in unlit.simulation.drivers.items()}, "smoke-spark": patch["value"]},
        )
    )
    assert row(mended, "gases").status == "pass"


WRONG = [
    (("/entities/smoke/motion", "static"), "gases are dynamic"),
    (("/entities/smoke/pose", {"position": [0.38, 0, 0.05]}), "reaches out of the box"),
    (("/entities/smoke/physics/resolution", 0.08), "less than 2 cells of 0.08 m; use at most 0.05 m"),
    ((f"{AIR}/domain/size", [0.8, 0.15, 1.2]), "is 3 cells of 0.05 m wide, at least 4 hold a flow"),
    ((f"{AIR}/domain/sides", ["closed"] * 6), "without an open side"),
    ((f"{AIR}/expands", False), "36% from the ambient 293.15 K"),
    (("/simulation/solvers/air/members", ["smoke", "plate"]), "has 2 gases, a box has 1"),
    (("/simulation/drivers", {}), "nothing makes the gas 'smoke'"),
    (("/simulation/drivers/fire/entity", "plate"), "which is no gas"),
    (("/simulation/drivers/fire/start", 5.0), "after the last frame"),
    (("/simulation/drivers/push", {"kind": "force", "entity": "smoke", "force": [1, 0, 0], "end": 1}), "cannot act on a gas"),
    (("/simulation/drivers/pull", PULL), "feels no pull but gravity"),
    (("/simulation/drivers/wind", {**WIND, "region": FAR}), "blows at no time"),
    (("/simulation/couplings", {"c": BOTH}), "does not push and feel at once"),
]


@pytest.mark.parametrize(("edit", "said"), WRONG, ids=[said for _, said in WRONG])
def test_the_audit_names_what_is_wrong(edit: tuple[str, Any], said: str) -> None:
    found = row(changed(edit), "gases")
    assert found.status == "fail"
    assert any(said in problem for problem in found.evidence["problems"]), found.evidence["problems"]


def test_a_box_is_offered_that_holds_the_source() -> None:
    moved = ("/entities/smoke/pose", {"position": [0.38, 0, 0.05]})
    (patch,) = (c.patch for c in row(changed(moved), "gases").corrections if c.patch)
    (domain,) = (op["value"] for op in patch)
    assert row(changed(moved, (f"{AIR}/domain", domain)), "gases").status == "pass"


def test_a_box_is_whole_cells_about_the_middle_of_its_domain() -> None:
    spec = changed((f"{AIR}/domain/size", [0.82, 0.8, 1.18]))
    grid = grid_of(spec.simulation.gas["air"], 0.05)
    assert grid.shape == (16, 16, 24)
    assert grid.corner == pytest.approx([-0.4, -0.4, 0.0])
    assert grid.cells == 16 * 16 * 24


def test_finer_cells_cost_more_and_too_many_are_refused() -> None:
    coarse, fine = gas_counts(changed()), gas_counts(changed(("/entities/smoke/physics/resolution", 0.025)))
    assert fine["cells"] == 8 * coarse["cells"]
    assert 8 * coarse["cell_steps"] <= fine["cell_steps"] <= 16 * coarse["cell_steps"]
    assert 0.1 < (gas_seconds(changed()) or 0.0) < 60.0
    with pytest.raises(LimitError, match="cells"):
        check_limits(changed(("/entities/smoke/physics/resolution", 0.002)))


def test_a_probe_coarsens_its_cells() -> None:
    spec = changed()
    coarse = coarsened(spec, overrides_for(spec, 1.5))
    assert grid_of(coarse.simulation.gas["air"], coarse.entities["smoke"].physics.flow_cell).cells < 16 * 16 * 24


@pytest.mark.parametrize(
    "event", [{"kind": "spreads"}, {"kind": "fills", "other": "plate"}, {"kind": "rises"}, {"kind": "drifts"}]
)
def test_what_gas_meets_by_a_definition_of_its_own_needs_no_record_of_another_engine(event: dict[str, Any]) -> None:
    beat = {"text": "it does", "frames": [1, 20], "owner": "air", "subject": "smoke", "predicate": {"entity": "smoke", **event}}
    assert row(changed(("/story", {"semantics": "smoke", "beats": {"it": beat}})), "evidence").status == "pass"


def test_a_gas_that_is_followed_lies_in_still_air_and_in_a_box_that_is_worth_it() -> None:
    """A wind would have to be told of the air beyond the part that is solved; a field that does not reach the box is no wind there."""
    tall = (f"{AIR}/follows", True), (f"{AIR}/domain/size", [1.6, 1.6, 2.4]), (f"{AIR}/domain/center", [0, 0, 1.2])
    assert row(changed(*tall), "gases").status == "pass"
    found = row(changed(*tall, ("/simulation/drivers/wind", WIND)), "gases")
    assert found.status == "fail"
    told = found.evidence["problems"][0] if "problems" in found.evidence else str(found)
    assert "1 m/s" in str(told)
    assert "set follows to false" in str(told)
    small = row(
        changed((f"{AIR}/follows", True), (f"{AIR}/domain/size", [0.8, 0.8, 1.0]), (f"{AIR}/domain/center", [0, 0, 0.5])), "gases"
    )
    assert small.status == "fail"
    assert "20 cells long" in str(small)


def test_a_gas_that_is_followed_costs_less() -> None:
    tall = (f"{AIR}/domain/size", [1.6, 1.6, 2.4]), (f"{AIR}/domain/center", [0, 0, 1.2])
    whole, part = gas_counts(changed(*tall)), gas_counts(changed(*tall, (f"{AIR}/follows", True)))
    assert part["cell_steps"] == pytest.approx(0.6 * whole["cell_steps"])
    assert part["cells"] == whole["cells"]
