"""Logs of contacts in which one entry was edited, and the real ones beside them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from . import _scenes as scenes
from ._films import Film
from .cases import Mechanism, World

__all__ = ["MECHANISMS"]

SOLVER = "rigid"


def _begins(film: Film) -> tuple[int, int]:
    """A frame in which a contact begins between bodies that are awake, and its row in the log."""
    for k in range(2, film.count):
        before = film.frames[k - 1]["contact/pair"].tolist()
        begun = film.frames[k]["event/pair"].tolist()
        for row, pair in enumerate(film.frames[k]["contact/pair"].tolist()):
            if pair in begun and pair not in before:
                return k, row
    raise RuntimeError("nothing begins to touch in this film")


def _film(rng: np.random.Generator) -> Film:
    make = (scenes.bounce, scenes.thrown_pair)[int(rng.integers(2))]
    return make(int(rng.integers(scenes.VARIANTS)))


def louder(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The impulse of one pair in one frame is `magnitude` times what it was."""
    film = _film(rng)
    frame, row = _begins(film)
    impulse = np.array(film.frames[frame]["contact/impulse"])
    impulse[row] *= magnitude
    film.frames[frame]["contact/impulse"] = impulse
    return World(film.candidate(folder), (SOLVER, *film.index.colliders))


def unheard(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A contact begins and its event is missing."""
    film = _film(rng)
    frame, row = _begins(film)
    data = film.frames[frame]
    keep = (data["event/pair"] != data["contact/pair"][row]).any(axis=1)
    for name in [n for n in data if n.startswith("event/")]:
        data[name] = data[name][keep]
    return World(film.candidate(folder), (SOLVER, *film.index.colliders))


def blows(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Blows between frames as they were."""
    return World(_film(rng).candidate(folder))


MECHANISMS = (
    Mechanism("louder", "a contact pushed more than it did", True, louder, 1.001, 50.0, "1", named=(1.001, 1.2, 50.0)),
    Mechanism("unheard", "a contact begins and no event tells of it", True, unheard, 1.0, 1.0, "events", named=(1.0,)),
    Mechanism("blows", "blows in the air and on the floor", False, blows, 1.0, 2.0, "variant", named=(1.0,)),
)
