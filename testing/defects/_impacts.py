"""Mechanisms of the category check about impacts: what they give, energy that they make, and springs on what sleeps."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from . import _impact_scenes as scenes
from ._contact_given import MECHANISMS as GIVEN
from ._films import Film
from .cases import Mechanism, World

__all__ = ["IMPACTS"]


def _sound(make: Callable[[int], Film]) -> Callable[[Path, float, np.random.Generator], World]:
    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        del rng
        return World(make(int(magnitude)).candidate(folder))

    return build


def _clean(name: str, text: str, make: Callable[[int], Film]) -> Mechanism:
    return Mechanism(name, text, False, _sound(make), 1.0, float(scenes.VARIANTS), "variant", named=(1.0, 2.0, 4.0))


IMPACTS = (
    *GIVEN,
    Mechanism("old_law", "contacts that open give energy while an impact passes through", True, scenes.old_law, 1.0, 2.0, "law"),
    Mechanism(
        "forged_cradle",
        "an impact gives energy, and the record of its step is forged",
        True,
        scenes.forged_cradle,
        1.0,
        2.0,
        "law",
    ),
    Mechanism("forged_gain", "one step gave energy and the next took it again", True, scenes.forged_gain, 0.0105, 1.0, "1", 0.01),
    Mechanism(
        "less_inside", "impacts handed on in a row give back less than declared", True, scenes.less_inside, 0.07, 0.5, "1", 0.05
    ),
    Mechanism("untold_impact", "an impact among balls is missing from the log", True, scenes.untold, 1.0, 1.0, "impacts"),
    Mechanism(
        "lost_spring", "the spring of a sleeping body reads as of another length", True, scenes.lost_spring, 0.05, 1.0, "m"
    ),
    _clean("touching_cradle", "balls that touch hand an impact on", scenes.cradle),
    _clean("rack", "a ball runs into six that touch", scenes.rack),
    _clean("hard_bounce", "a hard ball bounces from the floor", scenes.bouncing),
    _clean("on_an_edge", "a box lands obliquely on an edge and loses no more than it must", scenes.on_an_edge),
    _clean("landing", "a stack falls on the floor and comes to rest", scenes.landing),
    _clean("asleep_on_a_spring", "a box sleeps under a spring that pulls by less than its weight", scenes.on_a_spring),
)
