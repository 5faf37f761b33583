"""Seeded defects of the category check (elastic bodies): shapes, strains, holds and books that cannot be, and sound ones beside them.

Motions are written by hand as functions of place and time, records follow from them, and each broken world differs from a sound one
in one way.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import ElasticPhysics, Pin, ReleaseDriver
from ..worlds.small_worlds import Touch, box, ground, world
from ..worlds.soft_worlds import Motion, block_mesh, deformed_candidate
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

FRAMES, FPS, G, STIFF = 10, 24, 9.81, 1e7
NAME = "soft"
LAST = (FRAMES - 1) / FPS
CELLS = (4, 2, 2)


class _Draw:
    """A block of drawn size and place."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        short = float(rng.uniform(0.05, 0.3))
        self.size = (short * float(rng.uniform(1.5, 3.0)), short, short)
        self.at: F64 = np.array([*rng.uniform(-0.5, 0.5, 2), short / 2])
        self.start = float(rng.uniform(0.1, 0.28))
        """When something begins to happen [s]."""

    def world(
        self, folder: Path, move: Motion, *, lift: float = 0.0, touch: bool = True, drivers: Any = None, **more: Any
    ) -> World:
        physics = {"young_modulus": STIFF, **more.pop("physics", {})}
        self.at[2] += lift
        block = box(*self.size, motion="dynamic", at=tuple(self.at), physics=ElasticPhysics(**physics))
        spec = world({"floor": ground(), NAME: block}, frames=FRAMES, fps=FPS, drivers=drivers)
        touches = [Touch(k, "floor", NAME, impulse=0.1) for k in range(FRAMES)] if touch else []
        meshes = {NAME: block_mesh(self.size, CELLS)}
        return World(deformed_candidate(folder, spec, meshes, {NAME: move}, touches=touches, **more), (NAME, "rigid"))

    def local(self, x: F64) -> F64:
        return x - self.at

    def late(self, time: float) -> float:
        """0 before the start, then up to 1 within two frames."""
        return float(np.clip((time - self.start) * FPS / 2, 0.0, 1.0))


Maker = Callable[[Path, float, np.random.Generator], World]


def _still(time: float, x: F64) -> F64:
    return x


def overstretched(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    draw = _Draw(rng)
    way = int(rng.integers(3))

    def move(time: float, x: F64) -> F64:
        scale = np.ones(3)
        scale[way] += 0.1 * magnitude * draw.late(time)
        return draw.local(x) * scale + draw.at

    return draw.world(folder, move, physics={"max_strain": 0.1}, strain_energy=None)


def inside_out(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A vertex is pushed through its neighbours by `magnitude` of their distance."""
    draw = _Draw(rng)
    inner = 22  # in the middle of the grid

    def move(time: float, x: F64) -> F64:
        x = x.copy()
        x[inner] += np.array([0.0, 0.0, magnitude * draw.size[2] / CELLS[2]]) * draw.late(time)
        return x

    return draw.world(folder, move, physics={"max_strain": 8.0}, strain_energy=None)


def mirrored(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """All of the body is turned inside out."""
    draw = _Draw(rng)

    def move(time: float, x: F64) -> F64:
        scale = np.array([1.0, 1.0 - (1.0 + magnitude) * draw.late(time), 1.0])
        return np.asarray(draw.local(x) * scale + draw.at)

    return draw.world(folder, move, physics={"max_strain": 8.0}, strain_energy=None)


def lost(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Vertices that are no numbers from a frame on."""
    draw = _Draw(rng)
    return draw.world(folder, lambda t, x: x * (np.nan if t > magnitude / FPS else 1.0))


def shrunk(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    draw = _Draw(rng)

    def move(time: float, x: F64) -> F64:
        return np.asarray(draw.local(x) * (1.0 - magnitude * draw.late(time)) ** (1 / 3) + draw.at)

    return draw.world(folder, move, physics={"max_strain": 0.5, "poisson_ratio": 0.49}, strain_energy=None)


def dented(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A dent that stays, in a body whose weight explains none of it; of the size, beyond what is allowed."""
    draw = _Draw(rng)
    draw.start = min(draw.start, 0.15)  # so that it rests long enough to be judged
    size = float(np.linalg.norm(draw.size))

    def move(time: float, x: F64) -> F64:
        here = draw.local(x)
        depth = 2.5 * magnitude * size * draw.late(time) * np.exp(-((here[:, 0] / (0.3 * draw.size[0])) ** 2))
        return x - np.stack([0 * depth, 0 * depth, depth * (here[:, 2] / draw.size[2] + 0.5)], axis=1)

    return draw.world(folder, move, physics={"recovery": 0.01, "max_strain": 8.0}, strain_energy=None)


def _pinned(draw: _Draw) -> dict[str, Any]:
    pin = Pin(center=(-draw.size[0] / 2, 0, 0), size=(1e-3, 1, 1))
    return {"pins": {"wall": pin}, "max_strain": 8.0}


def slipped(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The force of a pin is recorded too small, by a share of it."""
    draw = _Draw(rng)
    way = rng.normal(size=3)
    shift = magnitude * np.sqrt(2) * draw.size[1] * way / np.linalg.norm(way)
    return draw.world(
        folder, lambda t, x: x + shift * draw.late(t), lift=1.0, touch=False, physics=_pinned(draw), strain_energy=None
    )


def hovering(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Gravity acts with a share `magnitude` less."""
    draw = _Draw(rng)
    fall = 0.5 * G * (1.0 - magnitude)
    return draw.world(folder, lambda t, x: x - [0, 0, fall * t * t], lift=3.0, touch=False, strain_energy=None)


def pushed(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """In flight, a body is given a speed by nothing [m/s]."""
    draw = _Draw(rng)
    way = rng.normal(size=3)
    way *= magnitude / np.linalg.norm(way)

    def move(time: float, x: F64) -> F64:
        return x - [0, 0, 0.5 * G * time * time] + way * max(0.0, time - draw.start)

    return draw.world(folder, move, lift=3.0, touch=False, strain_energy=None)


def leaping(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    draw = _Draw(rng)
    # Least median edge of the surface's triangles: between the blocks' edges and their diagonals.
    return draw.world(folder, _still, travel=magnitude * 0.75 * draw.size[0] / CELLS[0])


def unsolved(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    return _Draw(rng).world(folder, _still, residual=magnitude)


def gained(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """Strain energy from nowhere, as a share of the energy in play."""
    draw = _Draw(rng)
    frame = int(rng.integers(1, FRAMES))
    mass = 600 * float(np.prod(draw.size))
    stored = np.where(np.arange(FRAMES) >= frame, magnitude * mass * G * 1e-3, 0.0)
    return draw.world(folder, _still, strain_energy=stored)


def cooked(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The record of the kinetic energy is another than that of the vertices."""
    draw = _Draw(rng)
    factor = 1.0 / (1.0 + 2.0 * magnitude)
    return draw.world(folder, lambda t, x: x - [0, 0, 0.5 * G * t * t], lift=3.0, touch=False, kinetic=factor, strain_energy=None)


def unrecorded(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    names = ("strain_energy", "elastic_kinetic_energy", "solve_residual", "elastic_travel_per_step")
    return _Draw(rng).world(folder, _still, without=(f"record/{names[int(magnitude) % len(names)]}",))


# ---------------------------------------------------------------- sound worlds


def rests(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    return _Draw(rng).world(folder, _still)


def tumbles(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A free body that falls and turns, at `magnitude` rad/s about its long axis."""
    draw = _Draw(rng)

    def move(time: float, x: F64) -> F64:
        c, s = np.cos(magnitude * time), np.sin(magnitude * time)
        turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        middle = draw.at + np.array([1.0 * time, 0, -0.5 * G * time * time])
        return np.asarray(draw.local(x) @ turn.T + middle)

    return draw.world(folder, move, lift=4.0, touch=False, strain_energy=None)


def almost_overstretched(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    draw = _Draw(rng)

    def move(time: float, x: F64) -> F64:
        scale = np.array([1.0, 1.0, 1.0 - 0.3 * magnitude * np.sin(np.pi * np.clip(time / LAST, 0, 1)) ** 4])
        return np.asarray(draw.local(x) * scale + draw.at)

    return draw.world(folder, move, physics={"max_strain": 0.3}, strain_energy=None)


def swings(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A pinned bar swings, its tip by a share of its height."""
    draw = _Draw(rng)

    def move(time: float, x: F64) -> F64:
        along = (draw.local(x)[:, 0] / draw.size[0] + 0.5) ** 2
        return np.asarray(
            x - np.stack([0 * along, 0 * along, magnitude * draw.size[2] * along * np.sin(7 * max(time, 0.0))], axis=1)
        )

    return draw.world(folder, move, lift=1.0, touch=False, physics=_pinned(draw), strain_energy=None)


def yields(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A dent that stays in a body that may yield."""
    draw = _Draw(rng)

    def move(time: float, x: F64) -> F64:
        scale = np.array([1.0, 1.0, 1.0 - magnitude * draw.late(time)])
        return np.asarray(draw.local(x) * scale + draw.at)

    return draw.world(folder, move, physics={"yield_strain": 0.02}, strain_energy=None)


def let_go(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body is held for some frames, and then falls."""
    draw = _Draw(rng)
    time_of = round(magnitude) / FPS

    def move(time: float, x: F64) -> F64:
        return x - [0, 0, 0.5 * G * max(0.0, time - time_of) ** 2]

    hold = {"hold": ReleaseDriver(entity=NAME, time=time_of)}
    return draw.world(folder, move, lift=3.0, touch=False, drivers=hold, strain_energy=None)


def _defect(name: str, text: str, build: Maker, low: float, high: float, unit: str, bound: float | None = None) -> Mechanism:
    return Mechanism(name, text, True, build, low, high, unit, bound)


def _clean(name: str, text: str, build: Maker, low: float, high: float, unit: str) -> Mechanism:
    return Mechanism(name, text, False, build, low, high, unit)


SUITE = Suite(
    "category",
    (
        _defect("overstretched", "strain beyond the contract", overstretched, 1.001, 8.0, "bounds", 1.0),
        _defect("inside_out", "a vertex goes through its neighbours", inside_out, 1.05, 3.0, "edges"),
        _defect("mirrored", "a body is turned inside out", mirrored, 0.05, 1.0, "1"),
        _defect("lost", "vertices that are no numbers", lost, 1.0, 8.0, "frames"),
        _defect("shrunk", "a body that keeps its volume loses it", shrunk, 0.031, 0.5, "1", 0.03),
        _defect("dented", "a dent stays", dented, 0.03, 0.2, "sizes"),
        _defect("slipped", "a pin slips", slipped, 0.11, 3.0, "1", 0.1),
        _defect("hovering", "a body falls too slowly with nothing under it", hovering, 0.025, 1.0, "1"),
        _defect("pushed", "a body in flight is pushed by nothing", pushed, 0.02, 3.0, "m/s"),
        _defect("leaping", "nodes go so far in a step that surfaces may jump", leaping, 1.05, 10.0, "1"),
        _defect("unsolved", "steps that did not converge", unsolved, 1.01e-3, 5.0, "1", 1e-3),
        _defect("gained", "energy from nowhere", gained, 0.0205, 2.0, "1", 0.02),
        _defect("cooked", "a record of energy that is not that of the motion", cooked, 0.13, 2.0, "1"),
        Mechanism("unrecorded", "a record is missing", True, unrecorded, 1.0, 4.0, "record", finds=("unverified",)),
        _clean("rests", "a body lies on the floor", rests, 1.0, 2.0, "1"),
        _clean("tumbles", "a body falls and turns", tumbles, 0.5, 6.0, "rad/s"),
        _clean(
            "almost_overstretched", "squashed to just below the contract, and back", almost_overstretched, 0.3, 0.99, "bounds"
        ),
        _clean("swings", "a pinned bar swings", swings, 0.01, 0.5, "heights"),
        _clean("yields", "a body that may yield keeps a dent", yields, 0.02, 0.3, "1"),
        _clean("let_go", "a held body is let go", let_go, 1.0, 6.0, "frames"),
    ),
)
