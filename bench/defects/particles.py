"""Seeded defects of particles: caches of a small bed of sand, changed in one way, and sound beds that look suspicious.

A sound bed is simulated once per drawn kind (a second or two) and kept; a broken one is that cache changed by a magnitude.
"""

from __future__ import annotations

import dataclasses
import shutil
from collections.abc import Callable
from functools import cache as kept
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.cache import Cache, write_container
from ...worlds.candidate import Candidate
from ...worlds.spec import WorldSpec
from ..simulated_worlds import simulate
from ..small_grains import SAND_PROMPT, sand_spec
from ._kept import kept_folder
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

SOLVER = "grains"
FRAMES, FIRST = 6, 3
RADIUS = 0.012
Change = Callable[[int, dict[str, Any], float, np.random.Generator], None]


@kept
def _bed(kind: int) -> Candidate:
    """A bed of sand under a ball; kinds differ in stiffness and depth."""
    young, depth, ball = ((1e7, 0.05, 0.12), (2e7, 0.05, None), (1e7, 0.075, None))[kind]
    spec = sand_spec(radius=RADIUS, depth=depth, frames=FRAMES, ball_at=ball, young=young, preroll=0.1)
    return simulate(kept_folder("sand"), WorldSpec.model_validate({"prompt": SAND_PROMPT, **spec}))


def _edited(folder: Path, change: Change | None, magnitude: float, rng: np.random.Generator) -> Candidate:
    base = _bed(int(rng.integers(3)))
    other = folder / SOLVER
    shutil.copytree(base.caches[SOLVER].folder, other)
    found = Cache(other)
    state = rng.bit_generator.state
    for frame in range(found.index.frames):
        data = {k: np.array(v) for k, v in found.read(frame).items()}
        rng.bit_generator.state = state  # every frame is changed alike
        if change is not None:
            change(frame, data, magnitude, rng)
        write_container(found.path(frame), data)
    fresh = dataclasses.replace(base)
    vars(fresh)["caches"] = {**base.caches, SOLVER: Cache(other)}
    return fresh


def _breaks(change: Change) -> Callable[[Path, float, np.random.Generator], World]:
    return lambda folder, magnitude, rng: World(_edited(folder, change, magnitude, rng), ("sand", SOLVER))


def _looks(change: Change | None) -> Callable[[Path, float, np.random.Generator], World]:
    return lambda folder, magnitude, rng: World(_edited(folder, change, magnitude, rng))


def _one(data: dict[str, Any], rng: np.random.Generator) -> int:
    return int(rng.integers(len(data["particle/id"])))


def vanish(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    if frame >= FIRST:
        n = len(data["particle/id"])
        keep = np.sort(rng.permutation(n)[max(1, round(magnitude * n)) :])
        for name in [k for k in data if k.startswith("particle/")]:
            data[name] = data[name][keep]


def swell(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    if frame >= FIRST:
        data["particle/radius"] = (data["particle/radius"] * (1 + magnitude)).astype(np.float32)


def overlap(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    if frame >= FIRST:
        position, radius = data["particle/position"], data["particle/radius"]
        i = _one(data, rng)
        way = position - position[i]
        j = int(np.argsort(np.linalg.norm(way, axis=1))[1])
        unit = way[j] / np.linalg.norm(way[j])
        depth = magnitude * min(float(radius[i]), float(radius[j]))
        position[j] = position[i] + unit * (radius[i] + radius[j] - depth)


def sink(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    if frame >= FIRST:
        lowest = int(np.argmin(data["particle/position"][:, 2]))
        data["particle/position"][lowest, 2] = -magnitude - data["origin"][2]


def shove(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    if frame >= FIRST:
        turn = rng.uniform(0, 2 * np.pi)
        push = magnitude * np.array([np.cos(turn), np.sin(turn), 0.0])
        data["particle/velocity"] = (data["particle/velocity"] + push).astype(np.float32)
        for k, axis in enumerate("xyz"):
            data[f"record/momentum_{axis}"] = data[f"record/momentum_{axis}"] + data["record/mass"] * push[k]
        data["record/kinetic_energy"] = data["record/kinetic_energy"] + 0.5 * data["record/mass"] * magnitude**2


def cook(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    if frame >= FIRST:
        data["record/mass"] = data["record/mass"] * (1 + magnitude)


def forge(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    data["exchange/impulse"] = data["exchange/impulse"] * (1 + magnitude)


def twin(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    if frame >= FIRST:
        data["particle/id"][0] = data["particle/id"][1]


def unchanged_but_order(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    order = rng.permutation(len(data["particle/id"]))
    for name in [k for k in data if k.startswith("particle/")]:
        data[name] = data[name][order]


def renamed(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    data["particle/id"] = data["particle/id"] + np.int32(round(magnitude))


def touched(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    """Places off by rounding."""
    data["particle/position"] = data["particle/position"] + np.float32(magnitude)


def spun(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    """A record of spin energy off by what single precision leaves."""
    data["record/rotation_energy"] = data["record/rotation_energy"] * (1 + magnitude)


def still(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    """Nothing is changed: sound as simulated."""


def moved_origin(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    data["origin"] = data["origin"] + magnitude
    data["particle/position"] = (data["particle/position"].astype(np.float64) - magnitude).astype(np.float32)


SUITE = Suite(
    "category",
    (
        Mechanism("vanish", "a share of the grains is gone from a frame on", True, _breaks(vanish), 0.01, 0.5, "1"),
        Mechanism("swell", "grains grow from a frame on", True, _breaks(swell), 1e-3, 0.05, "1"),
        Mechanism("overlap", "two grains overlap by a share of the radius", True, _breaks(overlap), 0.11, 0.9, "1", 0.1),
        Mechanism("sink", "a grain's middle lies in the floor", True, _breaks(sink), 1e-4, 0.02, "m", 0.0),
        Mechanism(
            "shove", "all grains are faster from a frame on, and the records with them", True, _breaks(shove), 0.02, 1.0, "m/s"
        ),
        Mechanism("cook", "the record of mass is too large", True, _breaks(cook), 1e-3, 0.5, "1"),
        Mechanism("forge", "what grains gave to bodies is not what they lost", True, _breaks(forge), 1e-4, 0.5, "1"),
        Mechanism("twin", "two grains have one id", True, _breaks(twin), 1.0, 1.0, "1"),
        Mechanism("sound", "sound as simulated", False, _looks(still), 1.0, 1.0, "1"),
        Mechanism("order", "rows in another order in every frame", False, _looks(unchanged_but_order), 1.0, 1.0, "1"),
        Mechanism("renamed", "other ids, the same in every frame", False, _looks(renamed), 1.0, 1e6, "1"),
        Mechanism("touched", "places off by single precision", False, _looks(touched), 1e-9, 1e-7, "m"),
        Mechanism("spun", "the record of spin energy off by its rounding", False, _looks(spun), 1e-9, 1e-6, "1"),
        Mechanism("origin", "another origin for the same places", False, _looks(moved_origin), 1e-3, 0.05, "m"),
    ),
)
