"""The small world of each category, and one per engine and per kind of member that adds channels which none of these has."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from worldagent.construction.build import build_entity
from worldagent.testing.worlds.by_category import FRAMES, SMALL_WORLDS, hot_tank, spec_of
from worldagent.testing.worlds.carried_worlds import JET_PROMPT, cloud_spec, stream_spec
from worldagent.testing.worlds.small_cloth import CATCH_PROMPT, catch_spec
from worldagent.testing.worlds.small_gas import KINDLED_PROMPT, SMOKE_PROMPT, followed_spec, kindled_spec, stirred_spec
from worldagent.testing.worlds.small_grains import SPARK_PROMPT, spark_spec
from worldagent.testing.worlds.small_soft import HAMMOCK_PROMPT, hammock_spec
from worldagent.testing.worlds.small_steam import QUENCH_PROMPT, quench_spec
from worldagent.worlds.built import BuiltEntity
from worldagent.worlds.spec import WorldSpec

__all__ = ["WORLDS", "built_world"]

WORLDS: dict[str, Callable[[], WorldSpec]] = {
    **{name: world.make for name, world in SMALL_WORLDS.items()},
    "liquid on a grid": lambda: hot_tank("flip"),
    "cloth that catches": lambda: spec_of(catch_spec(frames=FRAMES, resolution=0.1), CATCH_PROMPT),
    "jelly on cloth": lambda: spec_of(hammock_spec(frames=FRAMES, edge=0.055, drop=0.002, radius=None), HAMMOCK_PROMPT),
    "fire": lambda: spec_of(kindled_spec(frames=FRAMES), KINDLED_PROMPT),
    "steam": lambda: spec_of(quench_spec(frames=FRAMES), QUENCH_PROMPT),
    "stirred gas": lambda: spec_of(stirred_spec(frames=FRAMES), SMOKE_PROMPT),
    "gas that feels": lambda: spec_of(cloud_spec(frames=FRAMES, count=100, resolution=0.1), JET_PROMPT),
    "lifted": lambda: spec_of(stream_spec(frames=FRAMES, thing="card", resolution=0.1), JET_PROMPT),
    "followed gas": lambda: spec_of(followed_spec(frames=FRAMES), SMOKE_PROMPT),
    "flight": lambda: spec_of(spark_spec(frames=FRAMES), SPARK_PROMPT),
}
"""Specifications by what is special about them."""


def built_world(name: str) -> tuple[WorldSpec, dict[str, BuiltEntity]]:
    """A world of the table and its geometry."""
    spec: Any = WORLDS[name]()
    return spec, {n: build_entity(spec, n, Path()) for n in spec.entities}
