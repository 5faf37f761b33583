"""Ways of fluids: openings measured, resolved by the solver's cells, and not above the source (R21, R58, R94)."""

from __future__ import annotations

import pytest
from worldagent.testing.worlds.small_worlds import box, entity
from worldagent.tests.verifiers.routes.test_navigability import block, row_of, slab
from worldagent.worlds.spec import BoxRegion, LiquidPhysics


def basins(hole, resolution=None):
    """Two closed basins, joined by a square hole in a wall of 10 cm."""
    walls = [
        block(-0.6, 0.6, -0.4, 0.4, -0.05, 0),
        block(-0.6, 0.6, -0.4, 0.4, 0.6, 0.65),
        block(-0.65, -0.6, -0.4, 0.4, 0, 0.6),
        block(0.6, 0.65, -0.4, 0.4, 0, 0.6),
        block(-0.6, 0.6, -0.45, -0.4, 0, 0.6),
        block(-0.6, 0.6, 0.4, 0.45, 0, 0.6),
    ]
    low, high = 0.2, 0.2 + hole
    wall = [
        block(0, 0.1, -0.4, -hole / 2, 0, 0.6),
        block(0, 0.1, hole / 2, 0.4, 0, 0.6),
        block(0, 0.1, -hole / 2, hole / 2, 0, low),
        block(0, 0.1, -hole / 2, hole / 2, high, 0.6),
    ]
    things = {"tank": entity(*walls), "wall": entity(*wall)}
    if resolution is not None:
        water = entity(block(-0.5, -0.1, -0.3, 0.3, 0.01, 0.3))
        things["water"] = water.model_copy(update={"physics": LiquidPhysics(resolution=resolution)})
    return things, {
        "a": BoxRegion(min=(-0.5, -0.3, 0.1), max=(-0.1, 0.3, 0.5)),
        "b": BoxRegion(min=(0.3, -0.3, 0.1), max=(0.5, 0.3, 0.5)),
    }


def test_an_opening_for_a_fluid_is_measured_and_must_be_resolved(tmp_path):
    asked = {"carrier": "fluid", "width": 0.25}
    things, regions = basins(0.26, resolution=0.05)
    row = row_of(tmp_path, things, regions=regions, **asked)
    assert row.status == "pass"
    assert row.measured == pytest.approx(0.26, rel=0.02)
    assert row.evidence["solver_cells_across"] == pytest.approx(5.2, rel=0.02)
    things, regions = basins(0.26, resolution=0.1)
    row = row_of(tmp_path, things, regions=regions, **asked)
    assert (row.status, row.evidence["reason"], row.first_failing_entity) == ("fail", "unresolved", "water")
    things, regions = basins(0.2, resolution=0.05)
    row = row_of(tmp_path, things, regions=regions, **asked)
    assert (row.status, row.evidence["reason"], row.first_failing_entity) == ("fail", "too narrow", "wall")
    assert row.measured == pytest.approx(0.2, rel=0.02)


def test_an_opening_without_a_fluid_that_states_its_resolution_is_unverified(tmp_path):
    things, regions = basins(0.26)
    row = row_of(tmp_path, things, regions=regions, carrier="fluid", width=0.25)
    assert row.status == "unverified"
    assert "no liquid or gas states the resolution" in row.evidence["explanation"]


def test_a_liquid_does_not_rise_above_where_it_comes_from(tmp_path):
    weir = {"bed": slab(-1, 1, -0.3, 0.3), "weir": box(0.1, 0.6, 0.5, at=(0, 0, 0.25))}
    weir |= {"near": box(2, 0.05, 1.0, at=(0, -0.325, 0.5)), "far": box(2, 0.05, 1.0, at=(0, 0.325, 0.5))}
    weir |= {"west": box(0.05, 0.7, 1.0, at=(-1.025, 0, 0.5)), "east": box(0.05, 0.7, 1.0, at=(1.025, 0, 0.5))}
    water = box(0.5, 0.5, 0.3, at=(-0.5, 0, 0.16))
    weir["water"] = water.model_copy(update={"physics": LiquidPhysics(resolution=0.05)})
    goal = BoxRegion(min=(0.3, -0.2, 0.05), max=(0.8, 0.2, 0.4))
    for top, status in ((0.4, "fail"), (0.9, "pass")):
        source = BoxRegion(min=(-0.8, -0.2, 0.05), max=(-0.2, 0.2, top))
        row = row_of(tmp_path, weir, regions={"a": source, "b": goal}, carrier="fluid", width=0.2)
        assert row.status == status, row.evidence
