"""A block that pushes another: the world that counterfactual judging and the runs behind it are tested on."""

from __future__ import annotations

from typing import Any

from worldagent.testing.worlds.simulated_worlds import SLICK, beat
from worldagent.testing.worlds.small_worlds import box, ground, world
from worldagent.verifiers.story.counterfactual import check
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Contact, Displacement
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import WorldSpec

N = 25
"""Frames."""


def only(candidate: Candidate) -> Row:
    rows = check(candidate)
    assert len(rows) == 1
    return rows[0]


def pushed(**more: Any) -> WorldSpec:
    """A sliding block strikes a second one, which slides on; frames 0 to 24 at 24 fps."""
    entities = {
        "floor": ground(),
        "a": box(0.1, 0.1, 0.1, motion="dynamic", at=(0, 0, 0.051), velocity=(1.5, 0, 0)),
        "b": box(0.1, 0.1, 0.1, motion="dynamic", at=(0.3, 0, 0.051)),
        **more.pop("entities", {}),
    }
    beats = more.pop("beats", None) or {
        "hit": beat("b", Contact(a="a", b="b"), frames=(1, 20)),
        "slide": beat("b", Displacement(entity="b", min=0.05), frames=(1, 24), causes=["hit"]),
    }
    return world(entities, beats=beats, frames=N, materials=SLICK, **more)
