"""Seeded defects of particles: caches of a small bed of sand or of sparks, changed in one way, and sound ones that look suspicious.

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

from ...worlds.arrays import F64
from ...worlds.cache import Cache, write_container
from ...worlds.candidate import Candidate
from ...worlds.spec import WorldSpec
from ..worlds.simulated_worlds import simulate
from ..worlds.small_grains import INNER, SAND_PROMPT, SPARK_PROMPT, WALL, sand_spec, spark_spec
from ._kept import kept_folder
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

SOLVER, SPARKS = "grains", "flight"
FRAMES, FIRST = 6, 3
RADIUS = 0.012
RATE = 400.0
"""[1/s] Of the sparks."""
PACKED = 500
"""Grains of a lattice that holds balls of six radii."""
SAND, STEEL = 2600.0, 7800.0
"""[kg/m^3] Of grains and of sparks."""
Change = Callable[[int, dict[str, Any], float, np.random.Generator], None]


@kept
def _bed(kind: int) -> Candidate:
    """A bed of sand under a ball; kinds differ in stiffness and depth, and the last is two layers deep."""
    young, depth, ball = ((1e7, 0.05, 0.12), (2e7, 0.05, None), (1e7, 0.075, None), (1e7, 0.065, None))[kind]
    spec = sand_spec(radius=RADIUS, depth=depth, frames=FRAMES, ball_at=ball, young=young, preroll=0.1)
    return simulate(kept_folder("sand"), WorldSpec.model_validate({"prompt": SAND_PROMPT, **spec}))


@kept
def _sparks() -> Candidate:
    """Sparks from a nozzle."""
    spec = spark_spec(rate=RATE, frames=FRAMES)
    return simulate(kept_folder("sparks"), WorldSpec.model_validate({"prompt": SPARK_PROMPT, **spec}))


def _edited(folder: Path, change: Change | None, magnitude: float, rng: np.random.Generator, solver: str = SOLVER) -> Candidate:
    kind = int(rng.integers(3))
    # No ball is in the way of what is laid over all of the tray.
    base = _bed(max(kind, 1) if change is pack_shallow else kind) if solver == SOLVER else _sparks()
    other = folder / solver
    shutil.copytree(base.caches[solver].folder, other)
    found = Cache(other)
    state = rng.bit_generator.state
    for frame in range(found.index.frames):
        data = {k: np.array(v) for k, v in found.read(frame).items()}
        rng.bit_generator.state = state  # every frame is changed alike
        if change is not None:
            change(frame, data, magnitude, rng)
        write_container(found.path(frame), data)
    fresh = dataclasses.replace(base)
    vars(fresh)["caches"] = {**base.caches, solver: Cache(other)}
    return fresh


def _breaks(change: Change) -> Callable[[Path, float, np.random.Generator], World]:
    return lambda folder, magnitude, rng: World(_edited(folder, change, magnitude, rng), ("sand", SOLVER))


def _breaks_sparks(change: Change) -> Callable[[Path, float, np.random.Generator], World]:
    return lambda folder, magnitude, rng: World(_edited(folder, change, magnitude, rng, SPARKS), ("sparks", SPARKS))


def _thin(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    return World(_bed(3))


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


def _tell(data: dict[str, Any], density: float) -> None:
    """Make the records those of the particles."""
    radius = data["particle/radius"].astype(float)
    place, velocity, spin = (data[f"particle/{k}"].astype(float) for k in ("position", "velocity", "spin"))
    volume = 4 / 3 * np.pi * radius**3
    mass = density * volume
    momentum = mass @ velocity
    told = {
        "particles": len(mass), "mass": mass.sum(), "volume": volume.sum(), "kinetic_energy": 0.5 * mass @ (velocity**2).sum(axis=1),
        "potential_energy": 9.81 * mass @ (place[:, 2] + data["origin"][2]), "momentum_x": momentum[0], "momentum_y": momentum[1],
        "momentum_z": momentum[2], "rotation_energy": 0.2 * (mass * radius**2) @ (spin**2).sum(axis=1),
    }  # fmt: skip
    for name, value in told.items():
        data[f"record/{name}"] = np.float64(value)


def pack(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    """All grains are equal, at rest, and lie as a ball of a face-centred lattice that they fill by `magnitude`: nothing else is wrong.

    What the bodies gave is what bears them.
    """
    side = RADIUS * (16.0 * np.pi / 3.0 / magnitude) ** (1 / 3)
    cells = np.stack(np.meshgrid(*(np.arange(-8, 9),) * 3, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    corners = np.array([[0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]])
    points = side * (cells + corners).reshape(-1, 3) + side * rng.random(3)
    found = points[np.argsort(np.linalg.norm(points, axis=1), kind="stable")[:PACKED]]
    found[:, 2] += RADIUS - found[:, 2].min() + 1e-4
    _laid(data, found)


def pack_shallow(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    """The same in two to four layers over the tray's floor, from wall to wall."""
    side = RADIUS * (16.0 * np.pi / 3.0 / magnitude) ** (1 / 3)
    layers, half = int(rng.integers(2, 5)), INNER / 2 - RADIUS - 1e-4
    count = int(2 * half / side) + 1
    cells = np.stack(np.meshgrid(np.arange(count), np.arange(count), np.arange(2), indexing="ij"), axis=-1).reshape(-1, 1, 3)
    corners = np.array([[0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]])
    points = side * (cells + corners).reshape(-1, 3) + [-half, -half, RADIUS + 1e-4]
    inside = (points[:, :2] <= half).all(axis=1) & (points[:, 2] < RADIUS + 1e-3 + 0.5 * side * (layers - 1) + 1e-4)
    _laid(data, points[inside])


def _laid(data: dict[str, Any], found: F64) -> None:
    """Equal grains at rest at these places."""
    count = len(found)
    data["particle/position"] = (found - data["origin"]).astype(np.float32)
    data["particle/velocity"], data["particle/spin"] = (np.zeros((count, 3), np.float32) for _ in range(2))
    data["particle/radius"] = np.full(count, RADIUS, np.float32)
    data["particle/id"], data["particle/member"] = np.arange(count, dtype=np.int32), np.zeros(count, np.int32)
    _tell(data, SAND)
    given = np.zeros_like(data["exchange/reaction"])
    given[0, 2] = data["record/mass"] * 9.81 / 24
    data["exchange/reaction"], data["exchange/impulse"] = given, -given
    for name in ("spring_energy", "contact_energy", "max_speed", "mean_speed"):
        data[f"record/{name}"] = np.float64(0.0)


def leak(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    """A grain goes out through the tray's wall: its middle is in the wall at the first frames, and beyond it later."""
    if frame >= FIRST:
        axis, side = int(rng.integers(2)), (-1.0, 1.0)[int(rng.integers(2))]
        place = data["particle/position"]
        i = int(np.argmax(side * place[:, axis]))
        beyond = magnitude if frame == FIRST else WALL + 2 * RADIUS
        place[i, axis] = side * (0.5 * INNER + beyond) - data["origin"][axis]
        # Under the wall's top.
        place[i, 2] = 2 * RADIUS - data["origin"][2]


def wind(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    """Springs of contacts hold what nothing gave them: a height that all grains would have risen by."""
    if frame >= FIRST:
        data["record/spring_energy"] = data["record/spring_energy"] + magnitude * 9.81 * data["record/mass"]


def flood(frame: int, data: dict[str, Any], magnitude: float, rng: np.random.Generator) -> None:
    """An emitter lets out more than it is told to, and the records say so."""
    if frame >= FIRST:
        more = np.flatnonzero(data["particle/id"] < magnitude)
        born = len(more)
        mass = STEEL * 4 / 3 * np.pi * (data["particle/radius"][more].astype(float) ** 3).sum()
        # Those come right after the ones that are out at the first frame; what is let out later is numbered after them.
        out = round(RATE * FIRST / 24)
        data["particle/id"] = data["particle/id"] + np.where(data["particle/id"] >= out, born, 0).astype(np.int32)
        for name in [k for k in data if k.startswith("particle/")]:
            values = out + np.arange(born, dtype=np.int32) if name == "particle/id" else data[name][more]
            data[name] = np.concatenate([data[name], values])
        data["record/inflow_count"] = data["record/inflow_count"] + born
        data["record/inflow_mass"] = data["record/inflow_mass"] + mass
        _tell(data, STEEL)


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
        Mechanism("pack", "grains fill more than random close packing", True, _breaks(pack), 0.7, 0.74, "1"),
        Mechanism("pack_shallow", "a shallow bed is filled beyond it", True, _breaks(pack_shallow), 0.7, 0.74, "1"),
        Mechanism("leak", "a grain goes out through a wall", True, _breaks(leak), 1e-4, 0.029, "m", 0.0),
        Mechanism("wind", "springs of contacts hold what nothing gave them", True, _breaks(wind), 0.5, 5.0, "m"),
        Mechanism("flood", "an emitter lets out too many, and the records say so", True, _breaks_sparks(flood), 2.0, 20.0, "1"),
        Mechanism("sound", "sound as simulated", False, _looks(still), 1.0, 1.0, "1"),
        Mechanism("thin", "a bed of two layers, as simulated", False, _thin, 1.0, 1.0, "1"),
        Mechanism("loose", "a shallow bed in order, no denser than at random", False, _looks(pack_shallow), 0.55, 0.66, "1"),
        Mechanism("order", "rows in another order in every frame", False, _looks(unchanged_but_order), 1.0, 1.0, "1"),
        Mechanism("renamed", "other ids, the same in every frame", False, _looks(renamed), 1.0, 1e6, "1"),
        Mechanism("touched", "places off by single precision", False, _looks(touched), 1e-9, 1e-7, "m"),
        Mechanism("spun", "the record of spin energy off by its rounding", False, _looks(spun), 1e-9, 1e-6, "1"),
        Mechanism("origin", "another origin for the same places", False, _looks(moved_origin), 1e-3, 0.05, "m"),
    ),
)
