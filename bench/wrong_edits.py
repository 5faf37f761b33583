"""Wrong edits of recorded worlds, as data: each passes audit and static step, and makes a beat false from some frame on."""

from __future__ import annotations

from typing import Any, NamedTuple

__all__ = ["EDITS", "WORLDS", "WrongEdit"]

TWO = "world-building/examples/two_blocks"
STILL = "world-building/examples/route_past_still_life"
WORLDS = (
    TWO, STILL, "cloth/flag", "elastic-bodies/jelly", "fracture/pot", "fracture/breach",
    "particles/collapse", "particles/sparks", "particles/dust",
)  # fmt: skip
"""Recorded worlds of skills, as they are: right ones."""


class WrongEdit(NamedTuple):
    """One edit that spoils a world."""

    world: str
    """A recorded world, as `skills/<world>.json`."""
    wrong: str
    """The mistake."""
    values: dict[str, Any]
    """New values by JSON pointer."""


def _driver(name: str, field: str) -> str:
    return f"/simulation/drivers/{name}/{field}"


def _entity(name: str, place: str) -> str:
    return f"/entities/{name}/{place}"


EDITS: tuple[WrongEdit, ...] = (
    WrongEdit(TWO, "the steel block is too slow to come there", {_entity("steel_block", "physics/linear_velocity/0"): 0.5}),
    WrongEdit(TWO, "it pushes too weakly", {_entity("steel_block", "physics/linear_velocity/0"): 1.0}),
    WrongEdit(TWO, "it pushes too hard", {_entity("steel_block", "physics/linear_velocity/0"): 2.0}),
    WrongEdit(TWO, "friction stops it on the way", {"/materials/steel/friction": 1.0}),
    WrongEdit(TWO, "the wooden block stands too far away", {_entity("wooden_block", "pose/position/0"): 0.6}),
    WrongEdit(STILL, "the apple is let go too late", {_driver("let_go", "time"): 0.9}),
    WrongEdit(STILL, "the apple bounces", {"/materials/fruit/restitution": 0.9, "/materials/oak/restitution": 0.9}),
    WrongEdit(STILL, "the apple falls beside the table", {_entity("apple", "pose/position/1"): 0.4}),
    WrongEdit("cloth/flag", "the gust is a breath", {_driver("gust", "field/velocity"): [1.0, 0.2, 0.0]}),
    WrongEdit("cloth/flag", "the gust comes too late", {_driver("gust", "start"): 4.0}),
    WrongEdit("cloth/flag", "the wind falls asleep again", {_driver("gust", "end"): 3.0}),
    WrongEdit("elastic-bodies/jelly", "the jelly is let go too late", {_driver("let_go", "time"): 0.5}),
    WrongEdit("elastic-bodies/jelly", "the die is let go too late", {_driver("drop", "time"): 1.1}),
    WrongEdit("elastic-bodies/jelly", "the jelly is as hard as rubber", {_entity("jelly", "physics/young_modulus"): 400000.0}),
    WrongEdit("elastic-bodies/jelly", "nothing wobbles in so much damping", {_entity("jelly", "physics/damping"): 0.1}),
    WrongEdit("fracture/pot", "the pot is let go too late", {_driver("let_go", "time"): 0.5}),
    WrongEdit("fracture/pot", "the pot falls from a hand's height", {_entity("pot", "pose/position/2"): 0.35}),
    WrongEdit(
        "fracture/pot",
        "the clay is as strong as steel",
        {_entity("pot", "breakable/bond/tension"): 5e7, _entity("pot", "breakable/bond/shear"): 1e8},
    ),
    WrongEdit("fracture/breach", "the ball is too slow", {_entity("ball", "physics/linear_velocity/1"): 1.5}),
    WrongEdit("fracture/breach", "the ball flies over the wall", {_entity("ball", "physics/linear_velocity/2"): 9.0}),
    WrongEdit("fracture/breach", "the ball is thrown too late", {_driver("thrown", "time"): 0.4}),
    WrongEdit(
        "fracture/breach",
        "the mortar holds",
        {_entity("wall", "breakable/bond/tension"): 5e7, _entity("wall", "breakable/bond/shear"): 1e8},
    ),
    WrongEdit("particles/collapse", "the gate rises too slowly", {_driver("pull", "keys/b/time"): 1.2}),
    WrongEdit("particles/collapse", "the tile stands too far away", {_entity("tile", "pose/position/0"): 0.24}),
    WrongEdit(
        "particles/collapse",
        "the gate hardly opens",
        {_driver("pull", "keys/b/pose/position/2"): 0.15, _driver("pull", "keys/c/pose/position/2"): 0.15},
    ),
    WrongEdit("particles/sparks", "they come too late", {_driver("spray", "start"): 0.8, _driver("spray", "end"): 1.2}),
    WrongEdit("particles/sparks", "there are too few", {_driver("spray", "rate"): 20.0}),
    WrongEdit("particles/sparks", "they fly up", {_driver("spray", "pose/euler"): [0.0, 0.1, 0.0]}),
    WrongEdit("particles/sparks", "they live too briefly", {_entity("sparks", "physics/life"): 0.1}),
    WrongEdit("particles/dust", "the puff is too weak", {_driver("puff", "speed"): 0.2}),
    WrongEdit("particles/dust", "the puff comes too late", {_driver("puff", "start"): 0.9, _driver("puff", "end"): 1.2}),
    WrongEdit("particles/dust", "there is too little dust", {_driver("puff", "rate"): 60.0}),
)
