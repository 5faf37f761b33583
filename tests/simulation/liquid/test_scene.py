"""Specification to setup: volumes are filled with what was declared, and what is not resolved is refused by its name (R58)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree
from worldagent.construction.build import build_entity
from worldagent.geometry.inside import contains
from worldagent.geometry.solids import Solid
from worldagent.simulation.liquid.scene import LiquidScene, build_scene
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.worlds.errors import InputError
from worldagent.worlds.patch import apply_patch, parse_spec

TANK = tank_spec()["entities"]["tank"]


def scene(*changes: tuple[str, Any], **options: Any) -> LiquidScene:
    spec = parse_spec({**tank_spec(**options), "prompt": PROMPT})
    spec = apply_patch(spec, [{"op": "add", "path": p, "value": v} for p, v in changes])
    return build_scene(spec, {n: build_entity(spec, n, Path()) for n in spec.entities}, "water")


def solid(name: str, size: list[float], at: list[float], **more: Any) -> list[tuple[str, Any]]:
    entity = {**TANK, "role": name, "parts": {"a": {"shape": {"kind": "box", "size": size}, "pose": {"position": at}}}}
    return [
        (f"/entities/{name}", {**entity, "dimensions": {"size": size}, **more}),
        ("/simulation/solvers/rigid/members/-", name),
    ]


HALF_FULL = [
    ("/entities/water/parts/body/shape", {"kind": "box", "size": [0.185, 0.4, 0.2]}),
    ("/entities/water/pose/position", [-0.1075, 0, 0.1]),
]


def test_a_box_of_water_is_a_lattice_that_fits_it() -> None:
    setup = scene().setup
    assert len(setup.position) == 16 * 16 * 8
    assert setup.volume.sum() == pytest.approx(0.4 * 0.4 * 0.2, rel=1e-12)
    assert setup.position.min(axis=0) == pytest.approx([-0.1875, -0.1875, 0.0125])
    assert [b.name for b in setup.boundaries] == ["crate/body", "tank/body"]
    assert {f.name: f.density for f in setup.fluids} == {"water": 1000.0}


@pytest.mark.parametrize(
    ("shape", "box"),
    [
        ({"kind": "cylinder", "radius": 0.15, "height": 0.2}, [0.3, 0.3, 0.2]),
        ({"kind": "sphere", "radius": 0.1}, [0.2, 0.2, 0.2]),
        ({"kind": "box", "size": [0.31, 0.33, 0.19]}, [0.31, 0.33, 0.19]),
    ],
)
def test_other_shapes_hold_their_volume_evenly(shape: dict[str, Any], box: list[float]) -> None:
    """Law: particles' volumes sum to the declared one; nearest neighbours are at least 0.85 of a spacing apart."""
    spec = parse_spec({**tank_spec(crate_at=None), "prompt": PROMPT})
    changes = [("/entities/water/parts/body/shape", shape), ("/entities/water/dimensions/size", box)]
    spec = apply_patch(spec, [{"op": "add", "path": p, "value": v} for p, v in changes])
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    setup = build_scene(spec, built, "water").setup
    own = Solid.from_mesh(built["water"].parts[0].render, closed=True)
    assert setup.volume.sum() == pytest.approx(own.volume, rel=1e-9)
    assert setup.volume[0] == pytest.approx(setup.spacing**3, rel=0.15)
    assert contains(own, setup.position - [0, 0, 0.1]).all()
    near = cKDTree(setup.position).query(setup.position, k=2)[0][:, 1]
    assert near.min() > 0.85 * setup.spacing


def test_solids_in_the_water_take_their_place() -> None:
    """A crate at half draft in the declared box: its wet half holds no particles and is no volume of the liquid."""
    setup = scene(crate_at=0.2).setup
    wet = 0.5 * 0.12**3
    assert setup.volume.sum() == pytest.approx(0.032 - wet, rel=0.01)
    beyond = np.abs(setup.position - [0, 0, 0.2]) - 0.06
    distance = np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0)
    assert distance.min() > 0.4 * setup.spacing
    near = cKDTree(setup.position).query(setup.position, k=2)[0][:, 1]
    assert near.min() > 0.85 * setup.spacing


def test_of_the_ground_only_what_the_domain_feels_is_a_boundary() -> None:
    x, y = np.meshgrid(np.linspace(-20, 20, 81), np.linspace(-20, 20, 81))
    heights = (-0.2 + 0.001 * (x**2 + y**2)).tolist()
    ground = {"kind": "heightfield", "size": [40, 40], "heights": heights, "base": 1.0}
    made = scene(
        ("/entities/ground", {**TANK, "role": "ground", "parts": {"a": {"shape": ground}}, "dimensions": {"size": [40, 40, 2]}}),
        ("/simulation/solvers/rigid/members/-", "ground"),
    )
    mesh = next(b.mesh for b in made.setup.boundaries if b.name == "ground/body")
    whole = Solid.from_mesh(mesh, closed=True)
    assert whole.is_watertight
    assert np.abs(mesh.vertices[:, :2]).max() <= 1.5
    assert contains(whole, np.array([[0.0, 0.0, -0.3], [0.3, 0.3, -0.25]])).all()
    assert not contains(whole, np.array([[0.0, 0.0, -0.1]])).any()


def test_solids_beyond_the_domain_are_no_boundary() -> None:
    made = scene(*solid("far", [0.1, 0.1, 0.1], [3, 0, 0]))
    assert "far/body" not in [b.name for b in made.setup.boundaries]


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        (
            [("/simulation/drivers/tap", {"kind": "inflow", "entity": "water", "pose": {"position": [0.2, 0, 0.1]},
                                          "size": [0.1, 0.1], "speed": 1})],
            "of inflow 'tap' lies in 'tank'",
        ),
        ([*solid("gate", [0.03, 0.4, 0.26], [0, 0, 0.17]), *HALF_FULL], "passage at .* between 'gate' and 'tank'|'tank' and 'gate'"),
        ([*solid("sheet", [0.005, 0.4, 0.3], [0, 0, 0.15]), *HALF_FULL], "'sheet' is 0.005 m thick .* resolution of at most 0.01 m"),
        ([*solid("rock", [0.39, 0.39, 0.18], [0, 0, 0.1])], "of the liquid 'water' lies in solids"),
    ],
)  # fmt: skip
def test_what_is_not_resolved_is_refused_by_its_name(changes: list[tuple[str, Any]], text: str) -> None:
    with pytest.raises(InputError, match=text):
        scene(*changes, crate_at=None)


@pytest.mark.parametrize("shape", [
    {"kind": "box", "size": [0.0125, 0.4, 0.3]},
    {"kind": "revolution", "profile": [[0.1, -0.15], [0.1125, -0.15], [0.1125, 0.15], [0.1, 0.15]]},
])  # fmt: skip
def test_a_wall_exactly_as_thick_as_is_resolved_is_taken(shape: dict[str, Any]) -> None:
    """Half a spacing of 25 mm; a ring of facets is a little thinner than its circles."""
    size = shape.get("size", [0.225, 0.225, 0.3])
    parts = {"a": {"shape": shape, "pose": {"position": [0, 0, 0.15]}}}
    made = scene(*solid("sheet", size, [0, 0, 0.15], parts=parts), *HALF_FULL, crate_at=None)
    assert "sheet/body" in [b.name for b in made.setup.boundaries]


def test_a_passage_that_is_wide_enough_is_taken() -> None:
    made = scene(*solid("gate", [0.03, 0.4, 0.2], [0, 0, 0.2]), *HALF_FULL, crate_at=None)
    assert len(made.setup.position)


@pytest.mark.parametrize(("size", "reaches"), [([0.3, 0.04], False), ([0.04, 0.27], True)])
def test_a_slit_counts_where_an_inflow_can_lift_the_liquid_to_it(size: list[float], reaches: bool) -> None:
    """A slit 4 cm over water at rest: a wide and low inflow below it does not reach it, a narrow and high one does."""
    gate = {n: {"shape": {"kind": "box", "size": [0.03, 0.4, h]}, "pose": {"position": [0, 0, z]}} for n, h, z in (("low", 0.24, 0.12), ("high", 0.06, 0.31))}  # fmt: skip
    tap = {"kind": "inflow", "entity": "water", "pose": {"position": [-0.15, 0, 0.14], "quaternion": [0.5, 0.5, 0.5, 0.5]}, "size": size, "speed": 0.1}  # fmt: skip
    changes = [*solid("gate", [0.03, 0.4, 0.34], [0, 0, 0], parts=gate), *HALF_FULL, ("/simulation/drivers/tap", tap)]
    if reaches:
        with pytest.raises(InputError, match=r"passage at .* liquid would not pass"):
            scene(*changes, crate_at=None)
    else:
        assert len(scene(*changes, crate_at=None).setup.inflows) == 1


def test_a_closed_gate_is_no_passage() -> None:
    made = scene(*solid("gate", [0.03, 0.4, 0.3], [0, 0, 0.15]), *HALF_FULL, crate_at=None)
    assert (made.setup.position[:, 0] < 0).all()


def test_openings_come_with_their_axes_and_times() -> None:
    tap = {"kind": "inflow", "entity": "water", "pose": {"position": [0, 0, 0.45], "euler": [np.pi, 0, 0]}, "size": [0.1, 0.1],
           "round": True, "rate": 0.001, "start": 0.1, "end": 0.3}  # fmt: skip
    sink = {"kind": "outflow", "entity": "water", "pose": {"position": [0.1, 0, 0.05]}, "size": [0.1, 0.2, 0.1]}
    made = scene(("/simulation/drivers/tap", tap), ("/simulation/drivers/sink", sink), ("/simulation/preroll", 0.5))
    inflow, outflow = made.setup.inflows[0], made.setup.outflows[0]
    assert inflow.rotation[:, 2] == pytest.approx([0, 0, -1])
    assert inflow.speed == pytest.approx(0.001 / (np.pi * 0.05**2))
    assert (inflow.start, inflow.end) == pytest.approx((0.6, 0.8)), "the engine's clock starts with the preroll"
    assert outflow.half_size == pytest.approx((0.05, 0.1, 0.05))
