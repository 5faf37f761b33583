"""Forces of the grid liquid on walls, thick and thin, and how it slides along them."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.geometry.solids import Solid
from worldagent.simulation.boundaries import Boundary
from worldagent.simulation.liquid.engine import LiquidSetup
from worldagent.simulation.liquid.filling import PlacedSolid
from worldagent.simulation.liquid.flip.engine import Flip
from worldagent.simulation.liquid.marker_filling import fill_markers
from worldagent.tests.simulation.liquid.flip_setup import advance, block, no_bodies, tank
from worldagent.worlds.arrays import RigidPose
from worldagent.worlds.built import TriangleMesh

from .test_flip import G, box_mesh, one_body

UPRIGHT = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
SIDE = 0.2
"""Side of the water in the basin, a cube [m]."""


def moved(size: tuple[float, ...], at: tuple[float, ...]) -> TriangleMesh:
    """A box at a place."""
    mesh = box_mesh(size)  # type: ignore[arg-type]
    return TriangleMesh(mesh.vertices + np.array(at), mesh.faces)


def basin(cell: float, thickness: float) -> LiquidSetup:
    """A cube of water in a box of five slabs [cells thick], each a boundary of its own: floor, -x, +x, -y, +y."""
    strong = thickness * cell
    outer, middle = SIDE + 2 * strong, SIDE / 2 + strong / 2
    parts = [((outer, outer, strong), (0.0, 0.0, -strong / 2))]
    parts += [((strong, outer, 0.3), (s * middle, 0.0, 0.15)) for s in (-1, 1)]
    parts += [((SIDE, strong, 0.3), (0.0, s * middle, 0.15)) for s in (-1, 1)]
    shift = np.array([0.3, 0.3, 0.1])
    walls = tuple(
        Boundary(f"wall{n}", TriangleMesh(box_mesh(size).vertices + np.array(at) + shift, box_mesh(size).faces), "static")
        for n, (size, at) in enumerate(parts)
    )
    low = shift - np.array([SIDE / 2, SIDE / 2, 0.0])
    water = block(tuple(low), tuple(low + SIDE), cell / 2)
    return LiquidSetup(**{**vars(tank((0.6, 0.6, 0.45), water, cell / 2, boundaries=walls)), "spacing": cell})


@pytest.mark.parametrize("thickness", [1.2, 3.0])
def test_each_wall_of_a_basin_feels_the_weight_of_the_water_beside_it(thickness: float) -> None:
    """8 cells of depth; the floor carries it all, each side half as much."""
    engine = Flip(basin(0.025, thickness))
    advance(engine, 0.1, no_bodies(5))
    reports = advance(engine, 0.1, no_bodies(5))
    force = sum(r.impulse[:, :3] for r in reports) / sum(r.dt for r in reports)
    weight = 1000 * G * SIDE**3
    out = np.array([[0, 0, -1], [-0.5, 0, 0], [0.5, 0, 0], [0, -0.5, 0], [0, 0.5, 0]])
    assert force == pytest.approx(weight * out, abs=0.01 * weight)
    assert all(np.abs(r.impulse + r.reaction)[:, :3].max() <= 1e-5 * weight * r.dt for r in reports)


@pytest.mark.parametrize("thickness", [0.0, 1.0, 3.0])
def test_still_water_keeps_its_level_between_walls_that_cut_cells(thickness: float) -> None:
    """A basin 13.3 cells wide, of the domain's sides or of boxes [cells thick]: its middle stays within 0.4 % of its height."""
    cell, wide, depth = 0.03, 0.4, 0.2
    walls = ()
    if thickness:
        strong = thickness * cell
        parts = [((wide + 2 * strong,) * 2 + (strong,), (0.0, 0.0, -strong / 2))]
        for k in (-1, 1):
            across = (0.0, k * (wide + strong) / 2)
            parts += [((wide + 2 * strong, strong, 0.3), (*across, 0.15)), ((strong, wide, 0.3), (*across[::-1], 0.15))]
        walls = tuple(Boundary(f"wall{n}", moved(size, at), "static") for n, (size, at) in enumerate(parts))
    own = PlacedSolid("water", Solid.from_mesh(moved((wide, wide, depth), (0.0, 0.0, depth / 2)), closed=True), UPRIGHT)
    filled = fill_markers(own, [], cell / 2, 0)
    reach = wide / 2 + (0.1 if thickness else 0.0)
    setup = tank((1.0, 1.0, 1.0), filled.position, cell, boundaries=walls)
    setup = LiquidSetup(
        **{**vars(setup), "volume": np.full(len(filled.position), filled.volume), "scattered": True,
           "lower": np.array([-reach, -reach, -0.1 if thickness else 0.0]), "upper": np.array([reach, reach, 0.5])}
    )  # fmt: skip
    engine = Flip(setup)
    before = engine.particles().position[:, 2].mean()
    reports = advance(engine, 0.3, no_bodies(len(walls)))
    assert engine.particles().position[:, 2].mean() == pytest.approx(before, abs=0.004 * depth / 2)
    assert max(abs(r.density_error[0]) for r in reports) < 0.01


@pytest.mark.parametrize("solid", [True, False], ids=["bed", "side of the domain"])
def test_water_slides_along_a_smooth_bed_without_loss(solid: bool) -> None:
    """A block of 4 cells of depth that runs and spreads for half a second; the cells inside the bed once held a quarter of its momentum."""
    cell = 1 / 16
    bed = Boundary("bed", box_mesh((6.0, 2.0, 0.25)), "static")
    floor = 0.125 if solid else 0.0
    water = block((0.5, 0, floor), (1.5, 0.5, floor + 0.25), cell)
    velocity = np.tile([1.0, 0.0, 0.0], (len(water), 1))
    engine = Flip(tank((4.0, 0.5, 0.5), water, cell, velocity=velocity, boundaries=(bed,) if solid else ()))
    advance(engine, 0.5, one_body(np.array([2.0, 0.25, 0.0])) if solid else None)
    found = engine.particles()
    assert (found.volume * found.velocity[:, 0]).sum() / found.volume.sum() == pytest.approx(1.0, abs=0.02)


def test_drops_that_lie_on_a_bed_come_to_rest() -> None:
    """Markers alone in their cells feel no pressure; on a bed that cuts cells they once fell on without moving, ever faster."""
    cell = 0.1
    bed = Boundary("bed", moved((3.0, 3.0, 0.3), (0.5, 0.5, 0.013)), "static")
    drops = np.array([[0.15 + 0.3 * i, 0.15 + 0.3 * j, 0.25] for i in range(3) for j in range(3)])
    setup = tank((1.0, 1.0, 0.6), drops, cell / 2, boundaries=(bed,))
    engine = Flip(LiquidSetup(**{**vars(setup), "spacing": cell, "scattered": True}))
    advance(engine, 1.0, no_bodies(1))
    found = engine.particles()
    assert len(found.position) == 9
    assert np.abs(found.position[:, 2] - 0.163).max() < 0.2 * cell
    assert np.linalg.norm(found.velocity, axis=1).max() < 0.5
