"""Mechanisms of the category check about lift: engines that give too little of it, too much, or turned round, and twists that are told wrong.

The engine that is broken here flies the body as it is, so that motion, momentum and records fit each other; only the law is another.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from ...physics import lift
from ...worlds.spec import FieldDriver, RigidPhysics, RigidSettings, WorldSpec
from ..worlds.small_worlds import box, world
from ._films import Film, cached, film_of
from .cases import Mechanism, World

__all__ = ["LIFTED"]

VARIANTS = 6
STEP = 1e-3
ENGINE = "worldagent.simulation.rigid.lifting.wrenches"
Wrong = Callable[[lift.Wrench, float], lift.Wrench]


def _card(variant: int, *, low: bool = False) -> WorldSpec:
    """A card that is let go in a wind; `low`: over a floor on which it comes down."""
    rng = np.random.default_rng([variant, 31])
    size = (float(rng.uniform(0.1, 0.3)), float(rng.uniform(0.1, 0.3)), 0.002)
    made = box(
        *size,
        motion="dynamic",
        at=(0, 0, 0.3 if low else 4.0),
        euler=(float(rng.uniform(-0.3, 0.3)), float(rng.uniform(0.3, 0.9)), 0),
    )
    spun = tuple(float(w) for w in rng.normal(size=3) * (3.0 if variant % 2 else 0.0))
    assert isinstance(made.physics, RigidPhysics)
    physics = made.physics.model_copy(update={"lift": True, "angular_velocity": spun, "mass": 600.0 * float(np.prod(size))})
    wind = {"kind": "wind", "velocity": (float(rng.uniform(3.0, 9.0)), 0, 0), "coefficient": 1.15}
    return world(
        {"floor": box(60, 60, 0.2, at=(0, 0, -0.1)), "card": made.model_copy(update={"physics": physics})},
        settings=RigidSettings(step=STEP),
        drivers={"wind": FieldDriver.model_validate({"kind": "field", "field": wind})},
        frames=22 if low else 12,
    )


_flight, _landing = cached(_card), cached(lambda variant: _card(variant, low=True))


def _across(found: lift.Wrench, share: float) -> lift.Wrench:
    """The law with a share of the lift; the torque stays."""
    way = found.flow / np.maximum(np.linalg.norm(found.flow, axis=1), 1e-300)[:, None]
    along = (found.force * way).sum(axis=1)[:, None] * way
    return dataclasses.replace(found, force=along + share * (found.force - along))


def _turned(found: lift.Wrench, share: float) -> lift.Wrench:
    """The law with a share of the torque."""
    return dataclasses.replace(found, torque=share * found.torque, resistance=share * found.resistance)


def _engine(wrong: Wrong, sign: float) -> Callable[[Path, float, np.random.Generator], World]:
    """Worlds of an engine whose law has one less, or more, a magnitude of something."""

    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        spec = _card(int(rng.integers(VARIANTS)))

        def broken(*given: Any) -> lift.Wrench:
            return wrong(lift.wrenches(*given), 1.0 + sign * magnitude)

        with patch(ENGINE, broken):
            film = film_of(spec)
        return World(film.candidate(folder), ("category:rigid:fields",))

    return build


def _told(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Twists are told a share larger than they were."""
    film = _flight(int(rng.integers(VARIANTS)))
    film.put("field/twist", (1.0 + magnitude) * film.series("field/twist"))
    return World(film.candidate(folder), ("card",))


def _undeclared(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body flew with lift that declares none."""
    del magnitude
    film = _flight(int(rng.integers(VARIANTS)))
    data = film.spec.model_dump(mode="json")
    data["entities"]["card"]["physics"]["lift"] = False
    return World(dataclasses.replace(film, spec=WorldSpec.model_validate(data)).candidate(folder), ("card",))


def _sound(make: Callable[[int], Film]) -> Callable[[Path, float, np.random.Generator], World]:
    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        del rng
        return World(make(int(magnitude)).candidate(folder))

    return build


def _clean(name: str, text: str, make: Callable[[int], Film]) -> Mechanism:
    return Mechanism(name, text, False, _sound(make), 1.0, float(VARIANTS), "variant", named=(1.0, 2.0, 4.0))


LIFTED = (
    Mechanism(
        "weak_lift",
        "a card in a wind got too little lift, none (1) or the opposite one (2)",
        True,
        _engine(_across, -1.0),
        0.2,
        2.0,
        "1",
    ),
    Mechanism("strong_lift", "a card in a wind got too much lift, twice as much (1)", True, _engine(_across, 1.0), 0.2, 2.0, "1"),
    Mechanism(
        "weak_turn",
        "a card in a wind was turned too little, not at all (1) or the other way (2)",
        True,
        _engine(_turned, -1.0),
        0.2,
        2.0,
        "1",
    ),
    Mechanism("told_twist", "the wind is told to have turned a card more than it did", True, _told, 0.2, 2.0, "1"),
    Mechanism("undeclared_lift", "a body that declares no lift was lifted", True, _undeclared, 1.0, 1.0, "1"),
    _clean("lifted", "cards fly and tumble in a wind", _flight),
    _clean("landing_card", "cards come down, slide and lie still in a wind", _landing),
)
