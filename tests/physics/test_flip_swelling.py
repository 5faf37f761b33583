"""Air that is mixed into the grid liquid leaves it again, and what surfaces take of a cell's density is no air.

Where water lies still over a flat bed, its centre of mass lies at half its depth: `swelling` is twice that height over the depth that
its volume has. No pressure of air is known to the engine: a hollow is air at no pressure and falls in.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.simulation.boundaries import Boundary
from worldagent.simulation.liquid.engine import LiquidSetup
from worldagent.simulation.liquid.flip.engine import Flip
from worldagent.simulation.liquid.flip.settings import FlipSettings
from worldagent.tests.physics.test_flip import box_mesh
from worldagent.tests.simulation.liquid.flip_setup import advance, block, no_bodies, tank
from worldagent.worlds.arrays import F64

G = 9.81
CELL = 1 / 16
KINDS: dict[str, dict[str, Any]] = {"flip": {}, "pic": {"flip_ratio": 0.0}, "apic": {"transfer": "apic"}}
kinds = pytest.mark.parametrize("settings", KINDS.values(), ids=KINDS.keys())


def swelling(engine: Flip, base: float, start: float = 0.0) -> float:
    """Space that liquid over a flat bed of an area takes, over its volume; `start`: least x of the bed [m]."""
    found = engine.particles()
    here = found.position[:, 0] > start
    volume = float(found.volume[here].sum())
    return 2.0 * float(found.volume[here] @ found.position[here, 2]) * base / volume**2


def markers(setup: LiquidSetup, cell: float) -> LiquidSetup:
    """Cubes of a setup as single markers in cells of another size."""
    return LiquidSetup(**{**vars(setup), "spacing": cell})


def foam(share: float, size: tuple[float, float, float], **more: Any) -> LiquidSetup:
    """Markers on a share of the places that a full block has."""
    places = block((0, 0, 0), size, CELL / 2)
    kept = places[np.random.default_rng(1).random(len(places)) < share]
    return markers(tank((size[0], size[1], 1.5 * size[2]), kept, CELL / 2, **more), CELL)


@kinds
@pytest.mark.parametrize("share", [0.6, 0.7, 0.8])
def test_water_that_is_full_of_air_gives_it_off(share: float, settings: dict[str, Any]) -> None:
    """A tank of 16 cells of depth, evenly mixed; 2 s. While cells of 28 % of air made their neighbours count as surface, it kept 8 to 27 %."""
    engine = Flip(foam(share, (0.5, 0.5, 1.0)), FlipSettings(**settings))
    reports = advance(engine, 2.0)
    assert swelling(engine, 0.25) == pytest.approx(1.0, abs=0.02)
    assert abs(reports[-1].density_error[0]) < 0.005
    assert engine.volume == pytest.approx(engine.particles().volume.sum(), rel=0.02)


@pytest.mark.parametrize("settings", [KINDS["pic"], KINDS["apic"]], ids=["pic", "apic"])
def test_a_splash_returns_to_its_volume_when_it_calms(settings: dict[str, Any]) -> None:
    """Lumps of a cell fall into a tank through 0.3 of its room, in short steps: 7 cells deep, 3 s. PIC kept 11 % of air."""
    lumps = block((0, 0, 0), (0.5, 0.5, 1.5), CELL)
    lumps = lumps[np.random.default_rng(1).random(len(lumps)) < 0.3]
    engine = Flip(tank((0.5, 0.5, 2.0), lumps, CELL), FlipSettings(max_step=0.012, cfl=1.0, **settings))
    advance(engine, 3.0)
    found = engine.particles()
    depth = found.volume.sum() / 0.25
    assert np.sqrt((found.velocity**2).sum(axis=1).mean()) < 0.1 * np.sqrt(G * depth)
    assert swelling(engine, 0.25) == pytest.approx(1.0, abs=0.02)


def steps_down(width: float, cell: float) -> tuple[LiquidSetup, list[F64]]:
    """A dam in a corridor, three steps of two cells behind it and a hall below; solids and their centres."""
    spans = [
        ((-0.3, 7.725), (-0.15, 0.45)),
        ((7.725, 8.025), (-0.15, 0.3)),
        ((8.025, 8.325), (-0.15, 0.15)),
        ((8.0, 10.8), (-0.3, 0.0)),
    ]
    solids, places = [], []
    for n, ((x0, x1), (z0, z1)) in enumerate(spans):
        solids.append(Boundary(f"floor{n}", box_mesh((x1 - x0, width + 0.3, z1 - z0)), "static"))
        places.append(np.array([(x0 + x1) / 2, width / 2, (z0 + z1) / 2]))
    water = block((0, 0, 0.45), (2.25, width, 1.425), cell)
    setup = tank((10.425, width, 2.1), water, cell, boundaries=tuple(solids))
    return LiquidSetup(**{**vars(setup), "lower": np.array([0.0, 0.0, -0.15])}), places


@pytest.mark.slow
@pytest.mark.parametrize("settings", [KINDS["flip"], KINDS["pic"]], ids=["flip", "pic"])
def test_water_that_came_down_steps_lies_as_high_as_its_volume(settings: dict[str, Any]) -> None:
    """A flood over a cascade, cells of 0.075 m, 10 s: the hall is 7 cells deep, and half a cell may hide at its bed and surface.

    Ten hundredths of it were air before. At a bed on which water rises markers lie up to 0.15 cells too high: what tents do not see.
    """
    cell, width = 0.075, 0.3
    setup, places = steps_down(width, cell)
    state = no_bodies(len(places))
    state.position[:] = state.center[:] = places
    engine = Flip(setup, FlipSettings(cfl=1.0, max_step=0.012, roughness=0.005, **settings))
    advance(engine, 10.0, state)
    found = engine.particles()
    depth = found.volume[found.position[:, 0] > 8.325].sum() / (2.1 * width)
    assert depth > 6 * cell
    assert (swelling(engine, 2.1 * width, 8.325) - 1.0) * depth < 0.5 * cell


SLOPES = {"flat": (0.0, 0.0), "one in two": (26.565, 0.0), "half right": (45.0, 0.0), "corners": (54.7356, 45.0)}


@pytest.mark.parametrize("slope", SLOPES.values(), ids=SLOPES.keys())
def test_what_lies_under_a_slope_is_not_squeezed(slope: tuple[float, float]) -> None:
    """Gravity across the cells, half a cube of water, 1 s: its centre stays within a twentieth of a cell, and its surface holds its volume."""
    lean, turn = np.radians(slope)
    up = np.array([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), np.cos(lean)])
    water = block((0, 0, 0), (1.0, 1.0, 1.0), CELL / 2)
    water = water[water @ up < 0.5 * up.sum() - 1e-9]
    engine = Flip(markers(tank((1.0, 1.0, 1.0), water, CELL / 2, gravity=-G * up), CELL))
    before = engine.particles().position.mean(axis=0)
    reports = advance(engine, 1.0)
    assert (engine.particles().position.mean(axis=0) - before) @ up == pytest.approx(0.0, abs=0.05 * CELL)
    assert abs(reports[-1].density_error[0]) < 1e-3
    assert engine.volume == pytest.approx(engine.particles().volume.sum(), rel=0.02)


def test_air_that_leaves_takes_no_momentum() -> None:
    """A cube that is a third air draws together without gravity: nothing moves after it, and its centre stays within a hundredth of a cell.

    Its outermost cells stay as they are: nothing tells spray beside a surface from air below it, but gravity.
    """
    places = block((0.5, 0.5, 0.5), (1.0, 1.0, 1.0), CELL / 2)
    places = places[np.random.default_rng(1).random(len(places)) < 0.67]
    engine = Flip(markers(tank((1.5, 1.5, 1.5), places, CELL / 2, gravity=np.zeros(3)), CELL))
    before = engine.particles().position
    assert abs(engine.step(0.04, no_bodies()).density_error[0]) > 0.2
    error = advance(engine, 1.0)[-1].density_error[0]
    after = engine.particles()
    assert abs(error) < 0.01
    assert np.abs(after.velocity).max() == 0.0
    assert np.abs(after.position.mean(axis=0) - before.mean(axis=0)).max() < 0.01 * CELL
