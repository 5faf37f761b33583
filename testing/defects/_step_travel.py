"""Worlds in which bodies travel too far in a step for what they could meet, or far enough from what is thin."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...worlds.spec import Box, Part, RigidSettings
from ..worlds.small_worlds import ball, box, entity, ground, pose, world
from . import _scenes as scenes
from ._films import Film, film_of
from .cases import World

__all__ = ["at_the_arm", "at_the_foot", "coarse_travel", "past_the_pane", "thin_and_slow", "through_the_pane"]

STEP = 5e-4
"""[s]"""


def _thickness(film: Film, name: str) -> float:
    pieces = [c for part in film.built[name].parts for c in part.collision]
    return min(2 * c.params[0] if c.kind == "sphere" else 2 * min(c.params) for c in pieces)


def coarse_travel(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Travel per step is `magnitude` times half of the thinner of two that touch, in one frame."""
    make = (scenes.bounce, scenes.stack)[int(rng.integers(2))]
    film = make(int(rng.integers(scenes.VARIANTS)))
    touching = [k for k in range(1, film.count) if len(film.frames[k]["contact/pair"])]
    k = int(rng.choice(touching))
    pairs = film.frames[k]["contact/pair"]
    pair = [film.index.colliders[c] for c in pairs[int(rng.integers(len(pairs)))]]
    travel = film.series("record/max_travel_per_step")
    travel[k] = max(float(travel[k]), magnitude * 0.5 * min(_thickness(film, n) for n in pair))
    film.set_record("max_travel_per_step", travel)
    return World(film.candidate(folder), film.index.colliders)


def _pane(rng: np.random.Generator, travel: float, beside: float) -> Film:
    """A ball that flies at or past a pane of glass, `travel` of half of its thickness in a step, and stands `beside` its edge."""
    thick, radius = float(rng.uniform(0.004, 0.01)), float(rng.uniform(0.02, 0.05))
    speed = travel * 0.5 * thick / STEP
    width = float(rng.uniform(0.3, 0.6))
    frames = int(np.ceil(0.8 / speed * 48)) + 2
    entities = {
        "pane": box(thick, width, 1.0, at=(0, beside + (width / 2 + radius if beside else 0.0), 1.0)),
        "ball": ball(radius, motion="dynamic", at=(-0.4, 0, 1.0), velocity=(speed, 0, 0)),
        "bystander": box(0.1, 0.1, 0.1, motion="dynamic", at=(2.0, 2.0, 1.0)),
    }
    return film_of(world(entities, frames=frames, fps=48, gravity=(0, 0, 0), settings=RigidSettings(step=STEP, refine=0)))


def through_the_pane(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A ball flies at a pane and travels `magnitude` of half of its thickness in a step."""
    return World(_pane(rng, magnitude, 0.0).candidate(folder), ("pane", "ball"))


def past_the_pane(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The same ball flies past the pane at a distance of `magnitude` [m]."""
    return World(_pane(rng, 3.0, magnitude).candidate(folder))


def thin_and_slow(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A card of a tenth of a millimetre falls, slower per step than half of its thickness."""
    del rng
    entities = {"floor": ground(), "card": box(0.1, 0.06, float(magnitude), motion="dynamic", at=(0, 0, 0.3))}
    film = film_of(world(entities, frames=4, fps=48, settings=RigidSettings(step=2e-5)))
    return World(film.candidate(folder))


def _lamp(rng: np.random.Generator, travel: float, height: float, aim: float) -> Film:
    """A lamp of a foot and a thin arm, `height` above it, and a ball that flies at one of them, at height `aim`, `travel` of half of the arm in a step."""
    thick, radius = float(rng.uniform(0.002, 0.004)), float(rng.uniform(0.02, 0.04))
    speed = travel * 0.5 * thick / STEP
    frames = int(np.ceil(0.4 / speed * 48)) + 3
    arm = Part(shape=Box(size=(thick, 0.3, thick)), pose=pose((0, 0, height)))
    entities = {
        "lamp": entity(Box(size=(0.2, 0.2, 0.1)), arm, motion="dynamic"),
        "ball": ball(radius, motion="dynamic", at=(-0.3, 0, aim), velocity=(speed, 0, 0)),
    }
    return film_of(world(entities, frames=frames, fps=48, gravity=(0, 0, 0), settings=RigidSettings(step=STEP, refine=0)))


def at_the_foot(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The ball strikes the lamp's foot, `magnitude` [m] below an arm that it is too fast for."""
    return World(_lamp(rng, 2.0, magnitude, 0.0).candidate(folder))


def at_the_arm(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The ball flies at the arm, `magnitude` of half of it in a step."""
    return World(_lamp(rng, magnitude, 0.3, 0.3).candidate(folder), ("lamp", "ball"))
