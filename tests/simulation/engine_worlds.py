"""One small world per engine and per kind of member that adds channels, for tests that run over every engine."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from worldagent.construction.build import build_entity
from worldagent.testing.worlds.small_cloth import CATCH_PROMPT, PULLED_PROMPT, catch_spec, pulled_spec
from worldagent.testing.worlds.small_grains import SAND_PROMPT, SPARK_PROMPT, sand_spec, spark_spec
from worldagent.testing.worlds.small_liquids import PROMPT, jelly_tank_spec, tank_spec
from worldagent.testing.worlds.small_soft import HAMMOCK_PROMPT, hammock_spec
from worldagent.tests.physics import fracture_world, rigid_world
from worldagent.worlds.built import BuiltEntity
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import WorldSpec

__all__ = ["WORLDS", "built_world"]

FRAMES = 4
DRAG = {"kind": "field", "field": {"kind": "drag"}}


def _rigid() -> WorldSpec:
    hinge = {"kind": "hinge", "parent": "post", "child": "door", "axis": [0, 0, 1], "anchor": [0, 0, 1]}
    entities = {
        "ground": rigid_world.floor(),
        "ball": rigid_world.ball(0.1, at=(1, 0, 0.11), v=(0.5, 0, 0)),
        "post": rigid_world.box(0.05, 0.05, 2.0, at=(0, 0, 1.0), motion="static"),
        "door": rigid_world.box(0.6, 0.04, 1.0, at=(0.4, 0, 1)),
    }
    wind = {"kind": "field", "field": {"kind": "wind", "velocity": [2.0, 0.0, 0.0]}}
    return rigid_world.world(entities, seconds=(FRAMES - 1) / 24, joints={"hinge": hinge}, drivers={"wind": wind})


def _breaking() -> WorldSpec:
    return fracture_world.struck_wall(12.0, tension=1e4, seconds=0.12)


def _jelly_in_air() -> WorldSpec:
    spec = jelly_tank_spec(frames=FRAMES, spacing=0.05)
    spec["simulation"]["drivers"]["air"] = DRAG
    return parse_spec({**spec, "prompt": PROMPT})


def _hot_tank(engine: str) -> WorldSpec:
    grid = engine == "flip"
    spec = tank_spec(frames=FRAMES, spacing=0.03 if grid else 0.05, engine=engine, coupled=not grid, closed=grid)
    spec["entities"]["water"]["physics"]["temperature"] = 350.0
    return parse_spec({**spec, "prompt": PROMPT})


def _torn() -> WorldSpec:
    return parse_spec({**pulled_spec(stretch=0.2, strength=20.0, frames=FRAMES), "prompt": PULLED_PROMPT})


WORLDS: dict[str, Callable[[], WorldSpec]] = {
    "rigid": _rigid,
    "breaking": _breaking,
    "jelly in a tank": _jelly_in_air,
    "particle liquid": lambda: _hot_tank("dfsph"),
    "grid liquid": lambda: _hot_tank("flip"),
    "cloth that tears": _torn,
    "cloth that catches": lambda: parse_spec({**catch_spec(frames=FRAMES, resolution=0.1), "prompt": CATCH_PROMPT}),
    "jelly on cloth": lambda: parse_spec(
        {**hammock_spec(frames=FRAMES, edge=0.055, drop=0.002, radius=None), "prompt": HAMMOCK_PROMPT}
    ),
    "grains": lambda: parse_spec({**sand_spec(frames=FRAMES, radius=0.016, preroll=0.02), "prompt": SAND_PROMPT}),
    "flight": lambda: parse_spec({**spark_spec(frames=FRAMES), "prompt": SPARK_PROMPT}),
}
"""Specifications by what is special about them."""


def built_world(name: str) -> tuple[WorldSpec, dict[str, BuiltEntity]]:
    """A world of the table and its geometry."""
    spec: Any = WORLDS[name]()
    return spec, {n: build_entity(spec, n, Path()) for n in spec.entities}
