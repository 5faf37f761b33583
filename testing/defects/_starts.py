"""Seeded defects of frame 0: what stands, moves or is as much there as nobody declared, and sound starts beside them.

Sound worlds are simulated once per kind for a frame or two, and kept.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache as kept
from pathlib import Path
from typing import Any

import numpy as np

from ...construction.build import build_entity
from ...simulation.schedule import run_frames
from ...worlds.candidate import Candidate, cache_digest
from ...worlds.patch import parse_spec
from ...worlds.spec import Fastened, WeldJoint, WorldSpec
from ..worlds.simulated_worlds import edited, simulate
from ..worlds.small_cloth import drape_spec
from ..worlds.small_grains import sand_spec
from ..worlds.small_liquids import tank_spec
from ..worlds.small_worlds import box, ground, world
from . import _scenes as scenes
from ._films import free_body
from ._kept import kept_folder
from .cases import Mechanism, World

__all__ = ["START_MECHANISMS", "embedded"]

FRAMES = 2
DEPTH = 0.1
"""[m] Of a crate in its base."""
Frame = dict[str, Any]


@kept
def _liquid(engine: str) -> Candidate:
    return _simulated("tank", tank_spec(engine=engine, spacing=0.03, frames=FRAMES))


@kept
def _cloth() -> Candidate:
    return _simulated("drape", drape_spec(frames=FRAMES, resolution=0.1))


@kept
def _sand() -> Candidate:
    return _simulated("sand", sand_spec(frames=FRAMES, radius=0.012, preroll=0.0))


def _simulated(kind: str, given: dict[str, Any]) -> Candidate:
    spec, folder = parse_spec({**given, "prompt": "A world at its start."}), kept_folder(kind)
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return Candidate(folder, spec, built, "full", caches, "run", cache_digest(caches))


def embedded(*, welded: bool, depth: float = DEPTH, frames: int = FRAMES) -> WorldSpec:
    """A crate that stands in its base by a depth [m] which is declared, welded to it or not."""
    things = {"ground": ground(), "base": box(1.0, 1.0, 0.4, at=(0, 0, 0.2))}
    things["crate"] = box(0.4, 0.4, 0.4, at=(0, 0, 0.6 - depth), motion="dynamic")
    relation = Fastened(a="crate", b="base", max_depth=1.1 * depth, reason="the crate stands in a pit of its base")
    joints = {"fast": WeldJoint(child="crate", parent="base", anchor=(0, 0, 0.4))} if welded else {}
    return world(things, frames=frames, relations={"in": relation}, joints=joints)


@kept
def _embedded() -> Candidate:
    return simulate(kept_folder("embedded"), embedded(welded=True), stage="full")


@kept
def _settled() -> Candidate:
    """Two crates that come to rest in a preroll, one on the other."""
    things = {"floor": ground(), "low": box(0.3, 0.3, 0.2, at=(0, 0, 0.103), motion="dynamic")}
    things["high"] = box(0.2, 0.2, 0.2, at=(0, 0, 0.307), motion="dynamic")
    return simulate(kept_folder("settled"), world(things, frames=FRAMES, preroll=0.3), stage="full")


def _edited(base: Candidate, folder: Path, solver: str, change: Callable[[Frame], None]) -> Candidate:
    """The same in every frame."""
    return edited(base, folder / "changed", solver, lambda frame, data: change(data))


def _way(rng: np.random.Generator) -> Any:
    way = rng.normal(size=3)
    return way / np.linalg.norm(way)


def pushed_apart(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A crate that is declared to stand in its base has been pushed out of it."""

    def change(data: Frame) -> None:
        data["position"][0, 2] += magnitude

    return World(_edited(_embedded(), folder, "rigid", change), ("crate",))


def misplaced(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body is elsewhere in all frames, and moves as declared."""
    film = scenes.flight(int(rng.integers(scenes.VARIANTS)))
    name = free_body(film, rng)
    film.add("position", name, magnitude * _way(rng))
    return World(film.candidate(folder), (name,))


def turned(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body begins turned about a drawn axis [rad]."""
    film = scenes.flight(int(rng.integers(scenes.VARIANTS)))
    name = free_body(film, rng)
    half = np.concatenate([[np.cos(magnitude / 2)], np.sin(magnitude / 2) * _way(rng)])
    w, v = half[0], half[1:]
    held = film.series("quaternion", name)
    scalar = w * held[:, 0] - held[:, 1:] @ v
    vector = w * held[:, 1:] + held[:, :1] * v + np.cross(v, held[:, 1:])
    film.put("quaternion", np.column_stack([scalar, vector]), name)
    return World(film.candidate(folder), (name,))


def thrown(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body begins with another velocity [m/s]."""
    film = scenes.flight(int(rng.integers(scenes.VARIANTS)))
    name, change = free_body(film, rng), magnitude * _way(rng)
    film.add("velocity", name, (np.arange(film.count) == 0)[:, None] * change)
    return World(film.candidate(folder), (name,))


def spun(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A body begins with another spin [rad/s]."""
    film = scenes.flight(int(rng.integers(scenes.VARIANTS)))
    name, change = free_body(film, rng), magnitude * _way(rng)
    film.add("angular_velocity", name, (np.arange(film.count) == 0)[:, None] * change)
    return World(film.candidate(folder), (name,))


def drained(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A share of the liquid is missing from the first frame on."""
    base, seed = _liquid(("dfsph", "flip")[int(rng.integers(2))]), int(rng.integers(2**31))

    def change(data: Frame) -> None:
        count = len(data["particle/id"])
        keep = np.sort(np.random.default_rng(seed).permutation(count)[round(magnitude * count) :])
        for name in [n for n in data if n.startswith("particle/")]:
            data[name] = data[name][keep]

    return World(_edited(base, folder, "water", change), ("water",))


def poured_elsewhere(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """All of a liquid stands so many spacings beside its place."""
    base, shift = _liquid(("dfsph", "flip")[int(rng.integers(2))]), 0.03 * magnitude * _way(rng)

    def change(data: Frame) -> None:
        data["particle/position"] = (data["particle/position"] + shift).astype(np.float32)

    return World(_edited(base, folder, "water", change), ("water",))


def stirred(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A liquid begins with a velocity that nobody declared [m/s]."""
    base, shift = _liquid(("dfsph", "flip")[int(rng.integers(2))]), magnitude * _way(rng)

    def change(data: Frame) -> None:
        data["particle/velocity"] = (data["particle/velocity"] + shift).astype(np.float32)

    return World(_edited(base, folder, "water", change), ("water",))


def hung_elsewhere(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A cloth begins beside its place, all of it or a corner."""
    way, whole = _way(rng), bool(rng.integers(2))

    def change(data: Frame) -> None:
        some = slice(None) if whole else slice(0, 3)
        data["vertex/position"][some] += magnitude * way

    return World(_edited(_cloth(), folder, "cloth", change), ("cloth",))


def scooped(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A share of the grains is missing from the first frame on."""
    seed = int(rng.integers(2**31))

    def change(data: Frame) -> None:
        count = len(data["particle/id"])
        keep = np.sort(np.random.default_rng(seed).permutation(count)[round(magnitude * count) :])
        for name in [n for n in data if n.startswith("particle/")]:
            data[name] = data[name][keep]

    return World(_edited(_sand(), folder, "grains", change), ("sand",))


def _sound(make: Callable[[], Candidate]) -> Callable[[Path, float, np.random.Generator], World]:
    return lambda folder, magnitude, rng: World(make())


def _honest(name: str, text: str, make: Callable[[], Candidate]) -> Mechanism:
    return Mechanism(name, text, False, _sound(make), 1.0, 1.0, "1", named=(1,))


START_MECHANISMS = (
    Mechanism("pushed_apart", "a crate is pushed out of the base that it is fastened in", True, pushed_apart, 0.01, 0.1, "m"),
    Mechanism("misplaced", "a body begins elsewhere", True, misplaced, 0.05, 5.0, "m"),
    Mechanism("turned", "a body begins turned", True, turned, 0.5, 3.0, "rad"),
    Mechanism("thrown", "a body begins with another velocity", True, thrown, 1e-2, 5.0, "m/s"),
    Mechanism("spun", "a body begins with another spin", True, spun, 0.05, 20.0, "rad/s"),
    Mechanism(
        "drained", "a tenth of a liquid is missing", True, drained, 0.015, 0.3, "1", bound=0.01, check="category", named=(0.1,)
    ),
    Mechanism("poured_elsewhere", "a liquid begins elsewhere", True, poured_elsewhere, 0.55, 5.0, "spacings", bound=0.5),
    Mechanism("stirred", "a liquid begins with another velocity", True, stirred, 2e-3, 2.0, "m/s", bound=1e-3),
    Mechanism("hung_elsewhere", "a cloth begins elsewhere", True, hung_elsewhere, 2e-6, 0.5, "m", bound=1e-6),
    Mechanism("scooped", "grains are missing", True, scooped, 0.25, 0.6, "1"),
    _honest("embedded", "a crate welded into the base that it is fastened in", _embedded),
    _honest("settled", "crates that come to rest in a preroll", _settled),
    _honest("filled", "water in a tank", lambda: _liquid("dfsph")),
    _honest("filled_flip", "water in a tank, on a grid", lambda: _liquid("flip")),
    _honest("hung", "a cloth over a ball", _cloth),
    _honest("heaped", "sand in a tray", _sand),
)
