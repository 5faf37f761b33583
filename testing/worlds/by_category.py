"""A small world of each category of matter, from which tests that run over the registries take it. A new category is a line here."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from ...worlds.patch import parse_spec
from ...worlds.spec import WorldSpec
from .small_bodies import door_spec, struck_wall_spec
from .small_cloth import PULLED_PROMPT, pulled_spec
from .small_gas import SMOKE_PROMPT, smoke_spec
from .small_grains import SAND_PROMPT, sand_spec
from .small_liquids import PROMPT, jelly_tank_spec, tank_spec

__all__ = ["FRAMES", "SMALL_WORLDS", "SmallWorld", "spec_of"]

FRAMES = 4
"""Frames of each: as many as a run that is continued from its checkpoint needs."""
DRAG = {"kind": "field", "field": {"kind": "drag"}}


class SmallWorld(NamedTuple):
    """A specification with matter of one category."""

    entity: str
    """Name of an entity of the category in it."""
    make: Callable[[], WorldSpec]


def spec_of(data: Mapping[str, Any], prompt: str) -> WorldSpec:
    """The specification of a document without its prompt."""
    return parse_spec({**data, "prompt": prompt})


def hot_tank(engine: str = "dfsph") -> WorldSpec:
    """A crate and warm water in a tank, as particles or on a grid."""
    grid = engine == "flip"
    spec = tank_spec(frames=FRAMES, spacing=0.03 if grid else 0.05, engine=engine, coupled=not grid, closed=grid)
    spec["entities"]["water"]["physics"]["temperature"] = 350.0
    return spec_of(spec, PROMPT)


def _jelly_in_air() -> WorldSpec:
    spec = jelly_tank_spec(frames=FRAMES, spacing=0.05)
    spec["simulation"]["drivers"]["air"] = DRAG
    return spec_of(spec, PROMPT)


SMALL_WORLDS: Mapping[str, SmallWorld] = {
    "rigid": SmallWorld("ball", lambda: door_spec(frames=FRAMES)),
    "fracture": SmallWorld("wall", lambda: struck_wall_spec(frames=FRAMES)),
    "elastic": SmallWorld("jelly", _jelly_in_air),
    "liquid": SmallWorld("water", hot_tank),
    "cloth": SmallWorld("strip", lambda: spec_of(pulled_spec(stretch=0.2, strength=20.0, frames=FRAMES), PULLED_PROMPT)),
    "gas": SmallWorld("smoke", lambda: spec_of(smoke_spec(frames=FRAMES), SMOKE_PROMPT)),
    "particles": SmallWorld("sand", lambda: spec_of(sand_spec(frames=FRAMES, radius=0.016, preroll=0.02), SAND_PROMPT)),
}
"""By name of the category, for those that an engine moves."""
