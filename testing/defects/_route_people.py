"""Walkers that are no person, and carriers that are none and say so, for the seeded defects of navigability."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...worlds.spec import Connects
from ...worlds.walkers import PERSON
from ._routes import site
from .cases import World

__all__ = ["no_person", "small_carrier", "tall_person"]

RNG = np.random.Generator
WAYS = {"width": -1.0, "headroom": -1.0, "max_step": 1.0, "max_slope": 1.0}
"""Which way a measure is easier."""


def _way(rng: RNG, times: float) -> Connects:
    """A way for a walker of which one measure is so many times easier than a person's."""
    field = str(rng.choice(list(WAYS)))
    value = min(PERSON[field].value * times ** WAYS[field], 1.5 if field == "max_slope" else 100.0)
    return Connects(a="a", b="b", **{field: value})


def no_person(folder: Path, m: float, rng: RNG) -> World:
    """A narrow, low, striding or climbing walker in an empty hall, through which anyone could walk."""
    hall, way = site(rng, half=1.6), _way(rng, m)
    hall.ends()
    hall.clutter()
    return hall.world(folder, way, "way")


def small_carrier(folder: Path, m: float, rng: RNG) -> World:
    """The same measures as an object's, through a door in which no person gets."""
    hall = site(rng, half=1.6)
    way = Connects(a="a", b="b", carrier="object", width=PERSON["width"].value / m, headroom=PERSON["headroom"].value / m)
    hall.wall("wall", 0.0, way.width * 1.2)
    hall.ends()
    return hall.world(folder, way)


def tall_person(folder: Path, m: float, rng: RNG) -> World:
    """A walker just as small as a person is, or larger, in a hall in which it gets on."""
    hall = site(rng, half=1.6)
    way = Connects(
        a="a", b="b", width=PERSON["width"].value * m, headroom=PERSON["headroom"].value, max_step=PERSON["max_step"].value
    )
    hall.wall("wall", 0.0, way.width * 1.2)
    hall.ends()
    return hall.world(folder, way)
