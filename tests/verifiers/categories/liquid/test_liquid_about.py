"""A body counts as under water where liquid is there, not only near by and higher."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.liquid_worlds import DENSITY, Flow, G, pool_in_tank, tank
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.categories import check as category
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.arrays import F64
from worldagent.worlds.predicates import SubmergedFraction
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Box, Entity, Material, Part

S = 0.02
SIZE = (0.4, 0.32, 0.2)
WALL = 0.03
FRAMES = 10
OUTSIDE = SIZE[0] / 2 + WALL
"""Outer face of the tank [m]."""


def among(others: dict[str, Entity], *taken: tuple[F64, F64], wall: float = WALL, **more: Any) -> Flow:
    """Still water in a tank, out of which some boxes (lower corner, upper corner) are taken."""
    flow = pool_in_tank(size=SIZE, spacing=S, wall=wall, frames=FRAMES, others=others, **more)
    points = flow.position[0]
    keep = np.ones(len(points), dtype=bool)
    for low, high in taken:
        keep &= ~((points > low) & (points < high)).all(axis=1)
    rest = points[keep]
    return flow.edited(
        position=[rest.copy() for _ in range(FRAMES)],
        velocity=[np.zeros_like(rest) for _ in range(FRAMES)],
        identity=[np.arange(len(rest))] * FRAMES,
    )


def around(at: tuple[float, ...], size: tuple[float, ...]) -> tuple[F64, F64]:
    return np.array(at) - 0.5 * np.array(size), np.array(at) + 0.5 * np.array(size)


def share(flow: Flow, folder: Path, entity: str = "block") -> Outcome:
    candidate = flow.candidate(folder)
    return evaluate(candidate, SubmergedFraction(entity=entity, liquid="pool", min=0.0, max=1.0, when="always"), (0, FRAMES - 1))


def buoyancy(flow: Flow, folder: Path) -> Row:
    (row,) = [r for r in category.check(flow.candidate(folder)) if ":buoyancy:" in r.id]
    return row


@pytest.mark.parametrize("engine", ["dfsph", "flip"])
@pytest.mark.parametrize("wall", [WALL, 0.004])
def test_a_block_outside_the_wall_of_a_tank_is_dry(tmp_path: Path, wall: float, engine: str) -> None:
    """Law: lower than the water is not in it. Flush with the wall, however thin that is."""
    block = sw.box(0.06, 0.06, 0.06, at=(SIZE[0] / 2 + wall + 0.03, 0.0, 0.03))
    assert share(among({"block": block}, wall=wall, engine=engine), tmp_path).value == 0.0


@pytest.mark.parametrize("motion", ["static", "dynamic"])
def test_a_block_in_an_empty_vessel_in_the_water_is_dry_and_the_vessel_is_not(tmp_path: Path, motion: str) -> None:
    """The vessel counts by what of its walls and floor is lower than the water."""
    inner, thick, foot = (0.12, 0.12, 0.24), 0.02, 0.04
    vessel = tank(inner, thick, at=(0.0, 0.0, foot + thick)).model_copy(update={"motion": motion})
    block = sw.box(0.06, 0.06, 0.06, at=(0.0, 0.0, foot + thick + 0.03))
    hole = (np.array([-0.08, -0.08, foot]), np.array([0.08, 0.08, 1.0]))
    flow = among({"vessel": vessel, "block": block}, hole)
    assert share(flow, tmp_path / "a").value == 0.0
    floor, sides, under = 0.16**2 * thick, (0.16**2 - 0.12**2) * inner[2], SIZE[2] - foot - thick
    wanted = (floor + sides * under / inner[2]) / (floor + sides)
    # Walls a fifteenth of the vessel across are met by few of the points.
    assert share(flow, tmp_path / "b", "vessel").value == pytest.approx(wanted, abs=0.1)


@pytest.mark.parametrize("deep", [0.25, 0.5, 0.75])
def test_a_block_wedged_against_a_wall_counts_by_its_draft(tmp_path: Path, deep: float) -> None:
    """Flush with one wall of the tank, liquid on the other sides; the tolerance is that of the crate that floats in the open."""
    size = (0.12, 0.12, 0.12)
    at = (SIZE[0] / 2 - 0.06, 0.0, SIZE[2] - deep * 0.12 + 0.06)
    flow = among({"block": sw.box(*size, at=at)}, around(at, size))
    assert share(flow, tmp_path).value == pytest.approx(deep, abs=0.03)


def test_a_block_in_a_corner_counts_by_its_draft(tmp_path: Path) -> None:
    size = (0.12, 0.12, 0.12)
    at = (SIZE[0] / 2 - 0.06, SIZE[1] / 2 - 0.06, SIZE[2] - 0.06 + 0.06)
    flow = among({"block": sw.box(*size, at=at)}, around(at, size))
    assert share(flow, tmp_path).value == pytest.approx(0.5, abs=0.03)


def test_a_bracket_over_the_wall_counts_on_the_wet_side_alone(tmp_path: Path) -> None:
    """Two equal legs hang down on both sides of the wall; the one in the water is half under its level."""
    rim, leg, deep = 2 * SIZE[2], 0.3, 0.1
    inner, outer = SIZE[0] / 2 - 0.04, OUTSIDE + 0.04
    top = rim + 0.03
    legs = [((0.04, 0.08, leg), (x, 0.0, top - leg / 2)) for x in (inner, outer)]
    bridge = ((outer - inner - 0.04, 0.08, 0.02), ((inner + outer) / 2, 0.0, top - 0.01))
    bracket = sw.entity(
        *(Part(shape=Box(size=s), pose=sw.pose(p)) for s, p in [*legs, bridge]), size=(outer - inner + 0.04, 0.08, leg)
    )
    hole = (np.array([inner - 0.02, -0.04, top - leg]), np.array([inner + 0.02, 0.04, 1.0]))
    flow = among({"block": bracket}, hole)
    deep = SIZE[2] - (top - leg)
    whole = 2 * leg * 0.04 * 0.08 + float(np.prod(bridge[0]))
    assert share(flow, tmp_path).value == pytest.approx(deep * 0.04 * 0.08 / whole, abs=0.03)


def test_a_plug_in_a_narrow_tube_is_in_the_water_that_stands_over_it(tmp_path: Path) -> None:
    """Nothing is beside it but the tube; what is over it is its own column's water."""
    tube = tank((0.06, 0.06, 0.3), 0.02, at=(0.0, 0.0, 0.0))
    at, size = (0.0, 0.0, 0.05), (0.06, 0.06, 0.06)
    flow = among({"tube": tube, "block": sw.box(*size, at=at)}, around(at, size))
    assert share(flow, tmp_path).value == pytest.approx(1.0)


def test_a_block_under_a_lid_in_the_water_is_in_it(tmp_path: Path) -> None:
    """A duct, open at its ends, hides the surface from what lies in it."""
    plates = [
        ((0.3, 0.2, 0.02), (0.0, 0.0, 0.13)),
        ((0.3, 0.02, 0.12), (0.0, 0.09, 0.06)),
        ((0.3, 0.02, 0.12), (0.0, -0.09, 0.06)),
    ]
    duct = sw.entity(*(Part(shape=Box(size=s), pose=sw.pose(p)) for s, p in plates), size=(0.3, 0.2, 0.14))
    at, size = (0.0, 0.0, 0.05), (0.06, 0.06, 0.06)
    flow = among({"duct": duct, "block": sw.box(*size, at=at)}, *(around(p, s) for s, p in plates), around(at, size))
    assert share(flow, tmp_path).value == pytest.approx(1.0)


def coupled(at: tuple[float, ...], *, push: float) -> Flow:
    """A light piece that stays where it is, lower than the water, pushed up by `push` of what it would displace."""
    size = (0.06, 0.2, 0.06)
    piece = sw.box(*size, motion="dynamic", at=at).model_copy(update={"material": "cork"})
    flow = among({"piece": piece}, around(at, size), two_way=True, below=0.1)
    spec = flow.spec.model_copy(update={"materials": {**flow.spec.materials, "cork": Material(density=500.0)}})
    given = np.zeros((FRAMES, 6))
    given[1:, 2] = push * DENSITY * G * float(np.prod(size)) / 24.0
    return flow.edited(
        spec=spec,
        share={flow.colliders.index("piece/body"): given},
        tracks={"piece": (np.tile(at, (FRAMES, 1)), sw.IDENTITY)},
        rigid={"velocity": np.zeros((FRAMES, 1, 3)), "exchange/impulse": given[:, None]},
    )


def test_no_lift_is_asked_of_water_behind_a_wall(tmp_path: Path) -> None:
    """A piece lies on a ledge beside the tank, as low as the water in it; the same piece in the water must be lifted."""
    beside = buoyancy(coupled((OUTSIDE + 0.03, 0.0, 0.1), push=0.0), tmp_path / "a")
    assert beside.status == "not_applicable", beside.evidence
    within = buoyancy(coupled((SIZE[0] / 2 - 0.03, 0.0, 0.1), push=0.0), tmp_path / "b")
    assert (within.status, within.first_failing_entity) == ("fail", "piece")
    assert buoyancy(coupled((SIZE[0] / 2 - 0.03, 0.0, 0.1), push=1.0), tmp_path / "c").status == "pass"
