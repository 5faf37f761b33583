"""Impulses in the log that the bodies did not take: turned, or raised together with all else that is said of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from . import _scenes as scenes
from ._films import Film
from .cases import Mechanism, World

__all__ = ["MECHANISMS"]


def _blow(rng: np.random.Generator) -> tuple[Film, int]:
    """Two bodies that meet in the air, and the frame in which they do."""
    film = scenes.thrown_pair(int(rng.integers(scenes.VARIANTS)))
    return film, max(range(1, film.count), key=lambda k: float(film.frames[k]["contact/impulse"].max(initial=0.0)))


def _judged(film: Film, folder: Path) -> World:
    return World(film.candidate(folder), ("left", "right"))


def turned(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The impulse of a blow is turned by `magnitude` [rad] about an axis across it."""
    film, k = _blow(rng)
    given = np.array(film.frames[k]["contact/vector"])
    size = np.linalg.norm(given, axis=1, keepdims=True)
    along = given / np.maximum(size, 1e-12)
    across = np.cross(along, rng.normal(size=3))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    film.frames[k]["contact/vector"] = size * (np.cos(magnitude) * along + np.sin(magnitude) * across)
    return _judged(film, folder)


def raised(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """All that is said of the impulse of a blow is `magnitude` times what it was."""
    film, k = _blow(rng)
    for name in ("contact/impulse", "contact/vector", "contact/max_force", "event/impulse"):
        film.frames[k][name] = magnitude * film.frames[k][name]
    return _judged(film, folder)


def invented(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A touch is logged in free flight, whose impulse would change the lighter body's velocity by `magnitude`."""
    film, _ = _blow(rng)
    k = next(k for k in range(1, film.count) if not len(film.frames[k]["contact/pair"]))
    light = min(film.built[n].bodies[0].mass for n in ("left", "right"))
    direction = rng.normal(size=3)
    film.touch(k, "left", "right", magnitude * light * direction / np.linalg.norm(direction))
    return _judged(film, folder)


MECHANISMS = (
    Mechanism("turned", "a blow gave its impulse in another direction", True, turned, 0.05, np.pi, "rad"),
    Mechanism("raised", "a blow gave more than its bodies took, in every entry of the log", True, raised, 1.05, 50.0, "1"),
    Mechanism("invented", "a touch is logged where the bodies fly", True, invented, 2.1e-3, 2.0, "m/s", 2e-3),
)
