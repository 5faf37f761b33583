"""Seeded defects of force fields on liquids: a drop that an attraction draws aside as it falls, and books that say otherwise."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...worlds.spec import FieldDriver
from ...worlds.spec.fields import AttractionField
from ..worlds.liquid_worlds import DENSITY, Flow, G, lattice, liquid_world, water
from .cases import World

__all__ = ["drawn", "undrawn"]

SPACING, SIDE = 0.04, 0.16
FRAMES = 10


def drawn(rng: np.random.Generator, *, pull: float = 3.0, gain: float = 1.0) -> Flow:
    """A cube of water in free fall under a field of even acceleration.

    Args:
        rng: gives the direction.
        pull: of the field [m/s^2].
        gain: recorded impulses over those that it gave.
    """
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    way = np.array([np.cos(angle), np.sin(angle), 0.0])
    far = 1e4
    field = AttractionField(center=tuple(far * way), acceleration=pull, distance=1.0, exponent=0.0)
    spec = liquid_world(
        {"pool": water((SIDE,) * 3, (0.0, 0.0, 1.0), SPACING)}, spacing=SPACING, low=(-2.0, -2.0, -0.6), high=(2.0, 2.0, 1.4),
        sides=("open",) * 6, frames=FRAMES, drivers={"draw": FieldDriver(field=field)},
    )  # fmt: skip
    base = lattice((-SIDE / 2, -SIDE / 2, 1.0 - SIDE / 2), (SIDE,) * 3, SPACING)
    total = pull * way - np.array([0.0, 0.0, G])
    times = np.arange(FRAMES) / spec.simulation.fps
    position = [base + 0.5 * total * t * t for t in times]
    velocity = [np.broadcast_to(total * t, base.shape).copy() for t in times]
    flow = Flow(spec, position, velocity, [np.arange(len(base))] * FRAMES, SPACING**3)
    mass = len(base) * SPACING**3 * DENSITY
    for k, t in enumerate(times.tolist()):
        given = gain * mass * pull * t * way
        flow.change |= {(k, f"record/field_impulse_{a}"): np.array(given[i]) for i, a in enumerate("xyz")}
        # A force of constant size along the way that it moved.
        flow.change[k, "record/field_work"] = np.array(gain * mass * 0.5 * (pull * t) ** 2)
    return flow


def undrawn(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Recorded impulses of a field lack a share of what it gives."""
    return World(drawn(rng, gain=1.0 - magnitude).candidate(folder), ("water", "pool"))
