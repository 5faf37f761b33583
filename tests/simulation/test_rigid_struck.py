"""Exchanges of liquids in vessels that something strikes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.small_liquids import tank_spec
from worldagent.worlds.cache import Cache
from worldagent.worlds.patch import parse_spec

ALLOWED = 0.006
"""Mean compression that the row `category:liquid:density` lets an engine record."""
FRAMES = 3


def box(size: tuple[float, ...], at: tuple[float, ...]) -> dict[str, Any]:
    return {"shape": {"kind": "box", "size": list(size)}, "pose": {"position": list(at)}}


def cup_on_a_table(ball_speed: float) -> dict[str, Any]:
    """A wooden cup of water, 12 cm wide, and a steel ball a hand's breadth from it."""
    spec = tank_spec(spacing=0.015, depth=0.09, frames=FRAMES, crate_at=None)
    walls = {
        "bottom": box((0.16, 0.16, 0.02), (0, 0, -0.01)),
        "left": box((0.02, 0.16, 0.12), (-0.07, 0, 0.06)),
        "right": box((0.02, 0.16, 0.12), (0.07, 0, 0.06)),
        "front": box((0.12, 0.02, 0.12), (0, -0.07, 0.06)),
        "back": box((0.12, 0.02, 0.12), (0, 0.07, 0.06)),
    }
    table = {"size": [2.0, 1.0, 0.05]}
    spec["entities"] = {
        "table": {"role": "table", "motion": "static", "material": "stone", "dimensions": table,
                  "pose": {"position": [0, 0, -0.0455]}, "parts": {"top": {"shape": {"kind": "box", **table}}}},
        "cup": {"role": "cup", "motion": "dynamic", "material": "wood", "dimensions": {"size": [0.16, 0.16, 0.14]}, "parts": walls},
        "ball": {"role": "ball", "motion": "dynamic", "material": "stone", "dimensions": {"size": [0.08, 0.08, 0.08]},
                 "pose": {"position": [-0.15, 0, 0.02]}, "physics": {"category": "rigid", "linear_velocity": [ball_speed, 0, 0]},
                 "parts": {"body": {"shape": {"kind": "sphere", "radius": 0.04}}}},
        "water": {**spec["entities"]["water"], "dimensions": {"size": [0.12, 0.12, 0.09]}, "pose": {"position": [0, 0, 0.045]},
                  "parts": {"body": {"shape": {"kind": "box", "size": [0.12, 0.12, 0.09]}}}},
    }  # fmt: skip
    spec["simulation"]["solvers"]["rigid"]["members"] = ["table", "cup", "ball"]
    spec["simulation"]["solvers"]["rigid"]["settings"] = {"step": 0.0005, "skin": 0.0004}
    return spec


def run(spec: dict[str, Any], folder: Path) -> Cache:
    world = parse_spec({**spec, "prompt": "A ball strikes a cup of water."})
    built = {name: build_entity(world, name, folder) for name in world.entities}
    return run_frames(world, built, folder / "run", frames=FRAMES)["water"]


def steps_and_compression(cache: Cache) -> tuple[list[float], list[float]]:
    frames = [cache.read(k, ("record/step", "record/density_error_mean")) for k in range(1, FRAMES)]
    return [float(f["record/step"]) for f in frames], [float(f["record/density_error_mean"]) for f in frames]


def test_a_vessel_that_is_struck_presses_its_water_together_no_more_than_the_row_of_density_allows(tmp_path: Path) -> None:
    """Choice: exchanges are as short as closing speed and width of the vessel ask, with no `max_step` from the agent."""
    steps, compression = steps_and_compression(run(cup_on_a_table(3.0), tmp_path))
    assert max(compression) <= ALLOWED
    assert steps[0] < 1e-3


def test_a_vessel_that_nothing_comes_near_keeps_its_long_steps(tmp_path: Path) -> None:
    steps, compression = steps_and_compression(run(cup_on_a_table(0.0), tmp_path))
    assert max(compression) <= ALLOWED
    assert steps == pytest.approx([1 / 240] * (FRAMES - 1))
