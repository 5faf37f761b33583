"""Still water in an open tank of five boxes, as users build tanks: all of it stays in, keeps its level and weighs on the floor."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.boundaries import BodyState
from worldagent.simulation.liquid.engine import Engine
from worldagent.simulation.liquid.scene import LiquidScene, build_scene
from worldagent.testing.worlds import small_liquids
from worldagent.worlds.spec import WorldSpec

SPACING = 0.025
DEPTH = 0.2
THIN = 0.08
"""On walls of about one cell the grid engine's force is some 6 % low (its README): pressure is taken at cell centres."""


def tank(tmp_path: Path, engine: str, wall: float, monkeypatch: pytest.MonkeyPatch) -> LiquidScene:
    monkeypatch.setattr(small_liquids, "WALL", wall)
    spec = WorldSpec.model_validate({
        "prompt": "p", **small_liquids.tank_spec(crate_at=None, engine=engine, spacing=SPACING, depth=DEPTH),
    })  # fmt: skip
    return build_scene(spec, {n: build_entity(spec, n, tmp_path) for n in spec.entities}, "water")


def engine_of(name: str, scene: LiquidScene) -> Engine:
    if name == "flip":
        from worldagent.simulation.liquid.flip.engine import Flip
        from worldagent.simulation.liquid.flip.settings import FlipSettings

        return Flip(scene.setup, FlipSettings())
    from worldagent.simulation.liquid.dfsph.engine import Dfsph
    from worldagent.simulation.liquid.dfsph.settings import DfsphSettings

    return Dfsph(scene.setup, DfsphSettings())


def resting(scene: LiquidScene) -> BodyState:
    count = len(scene.setup.boundaries)
    place = np.array([p.position for p in scene.surround.start])
    none = np.zeros((count, 3))
    return BodyState(place, np.tile(np.eye(3), (count, 1, 1)), place, none, none, np.zeros(count), np.zeros((count, 3, 3)), none)


@pytest.mark.parametrize("wall", [0.03, 0.1])
@pytest.mark.parametrize("engine", ["dfsph", "flip"])
def test_still_water_stays_in_its_tank(tmp_path: Path, engine: str, wall: float, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = tank(tmp_path, engine, wall, monkeypatch)
    running, bodies = engine_of(engine, scene), resting(scene)
    start, time, pushes = float(scene.setup.volume.sum()), 0.0, []
    removed: dict[str, Any] = {}
    while time < 0.5:
        report = running.step(min(5e-3, 0.5 - time), bodies)
        time += report.dt
        if time > 0.25:
            pushes.append((report.dt, report.impulse[:, 2].sum()))
        removed |= {n: m for n, m in report.removed.items() if m > 0}
    found = running.particles()
    x, y, z = found.position.T
    half = 0.2 + 0.25 * SPACING
    inside = (np.abs(x) < half) & (np.abs(y) < half) & (z > -0.25 * SPACING)
    if engine == "dfsph":
        # Where walls meet, particles keep off both: crowded into the edges, they were compressed by 0.025.
        assert report.density_error[0] < 1e-3
    assert not removed
    assert int((~inside).sum()) == 0, f"{int((~inside).sum())} of {len(x)} particles left the tank"
    assert found.volume.sum() == pytest.approx(start, rel=1e-6)
    assert z.max() == pytest.approx(DEPTH, abs=SPACING)
    weight = 1000.0 * start * 9.81
    mean = sum(j for _, j in pushes) / sum(t for t, _ in pushes)
    assert mean == pytest.approx(-weight, rel=THIN if engine == "flip" and wall < 2 * SPACING else 0.05)


@pytest.mark.parametrize("engine", ["dfsph", "flip"])
def test_a_turned_and_moved_trough_holds_what_runs_down_in_it(tmp_path: Path, engine: str) -> None:
    """A fixed body stands where its pose says: no particle gets below its sloping bed, and the block runs down as on an incline."""
    spacing, tilt, at = 0.05, 0.35, np.array([0.3, -0.2, 0.4])
    turn = np.array([[np.cos(tilt), 0, np.sin(tilt)], [0, 1, 0], [-np.sin(tilt), 0, np.cos(tilt)]])

    def part(size: tuple[float, ...], place: tuple[float, ...]) -> dict[str, Any]:
        return {"shape": {"kind": "box", "size": list(size)}, "pose": {"position": list(place)}}

    def entity(
        motion: str, material: str, size: tuple[float, ...], place: Any, parts: dict[str, Any], **more: Any
    ) -> dict[str, Any]:
        pose = {"position": list(place), "euler": [0, tilt, 0]}
        return {"role": material, "motion": motion, "material": material, "dimensions": {"size": list(size)}, "pose": pose, "parts": parts, **more}  # fmt: skip

    block = (0.5, 0.4, 0.2)
    trough = {"bed": part((2, 0.6, 0.2), (0, 0, -0.1)), "left": part((2, 0.1, 0.4), (0, 0.25, 0.2)), "right": part((2, 0.1, 0.4), (0, -0.25, 0.2)), "end": part((0.1, 0.4, 0.4), (-0.95, 0, 0.2))}  # fmt: skip
    spec = WorldSpec.model_validate({
        "prompt": "p",
        "title": "A trough",
        "materials": {"water": {"density": 1000}, "stone": {"density": 2600}},
        "entities": {
            "trough": entity("static", "stone", (2, 0.6, 0.6), at, trough),
            "water": entity("dynamic", "water", block, at + turn @ [-0.5, 0, 0.1], {"b": part(block, (0, 0, 0))},
                            physics={"category": "liquid", "resolution": spacing}),
        },
        "simulation": {"frames": 2, "solvers": {
            "rigid": {"engine": "mujoco", "members": ["trough"]},
            "water": {"engine": engine, "members": ["water"], "settings": {"domain": {"center": [0.3, -0.2, 0.5], "size": [2.4, 1, 1.8]}}},
        }},
    })  # fmt: skip
    scene = build_scene(spec, {n: build_entity(spec, n, tmp_path) for n in spec.entities}, "water")
    running, bodies, time = engine_of(engine, scene), resting(scene), 0.0
    while time < 0.3:
        time += running.step(min(5e-3, 0.3 - time), bodies).dt
    local = (running.particles().position - at) @ turn
    assert local[:, 2].min() > -0.25 * spacing
    assert np.abs(local[:, 1]).max() < 0.2 + 0.25 * spacing
    slid = local[:, 0].mean() + 0.5
    assert slid == pytest.approx(0.5 * 9.81 * np.sin(tilt) * 0.3**2, rel=0.1)
