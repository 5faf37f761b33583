"""Really simulated small worlds, kept in memory so that a defect can be written into them before they become a candidate.

A film is what the engine wrote, frame by frame. Energies and momenta are recomputed here from masses and velocities where a
defect changes the motion and an adversary would change the records with it.
"""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ...simulation.rigid import SolverRigid
from ...worlds.arrays import F64, rotation_matrix
from ...worlds.built import BuiltEntity
from ...worlds.cache import Cache, CacheIndex, write_container
from ...worlds.candidate import Candidate
from ...worlds.spec import Box, Entity, Part, WorldSpec
from ..worlds.small_worlds import build_all, entity, pose

__all__ = ["Film", "cached", "copied", "film_of", "frame_of_walls", "free_body", "still"]


@dataclass
class Film:
    """All frames of one instance and what they are of."""

    spec: WorldSpec
    built: dict[str, BuiltEntity]
    index: CacheIndex
    frames: list[dict[str, Any]]
    damage: list[Callable[[Path], None]] = field(default_factory=list)
    """Changes made to the cache folder after it is written."""

    @property
    def count(self) -> int:
        """Frames held."""
        return len(self.frames)

    @property
    def duration(self) -> float:
        """Time between two frames [s]."""
        return 1.0 / self.spec.simulation.fps

    def row(self, entity: str, body: str = "body") -> int:
        """Row of a body."""
        return self.index.bodies.index(f"{entity}/{body}")

    def series(self, channel: str, entity: str | None = None, body: str = "body") -> F64:
        """A copy of a channel over the frames, or of one body's."""
        stacked = np.stack([f[channel] for f in self.frames]).astype(np.float64)
        return stacked if entity is None else stacked[:, self.row(entity, body)].copy()

    def put(self, channel: str, values: Any, entity: str | None = None, body: str = "body") -> None:
        """Write a channel over all frames, or one body's."""
        for frame, value in zip(self.frames, np.asarray(values), strict=True):
            if entity is None:
                frame[channel] = np.asarray(value, dtype=np.asarray(frame[channel]).dtype)
            else:
                frame[channel] = frame[channel].copy()
                frame[channel][self.row(entity, body)] = value

    def add(self, channel: str, entity: str, values: Any, body: str = "body") -> None:
        """Add to one body's channel over all frames."""
        self.put(channel, self.series(channel, entity, body) + values, entity, body)

    def push(self, entity: str, frame: int, change: F64, *, place: bool = True) -> None:
        """Another velocity from `frame` on [m/s], with the places that follow from it."""
        late = np.clip(np.arange(self.count) - frame + 1, 0, None)[:, None] * self.duration
        self.add("velocity", entity, np.where(late > 0, change, 0.0))
        if place:
            self.add("position", entity, (late - 0.5 * self.duration * (late > 0)) * change)

    def set_record(self, name: str, values: Any) -> None:
        """Write a record over all frames."""
        for frame, value in zip(self.frames, np.broadcast_to(np.asarray(values, dtype=np.float64), (self.count,)), strict=True):
            frame[f"record/{name}"] = np.float64(value)

    def drop_contacts(self, entity: str | None = None) -> None:
        """Take contacts and events out of the log: of one entity, or all."""
        for frame in self.frames:
            for kind in ("contact", "event"):
                pairs = frame[f"{kind}/pair"]
                mine = (
                    np.ones(len(pairs), dtype=bool)
                    if entity is None
                    else (pairs == self.index.colliders.index(entity)).any(axis=1)
                )
                for name in [n for n in frame if n.startswith(f"{kind}/")]:
                    frame[name] = frame[name][~mine]

    def touch(self, frame: int, a: str, b: str, impulse: F64) -> None:
        """Log one more contact that gives `a` this impulse [N s], shape (3,), along its normal."""
        data = self.frames[frame]
        pair = sorted((self.index.colliders.index(a), self.index.colliders.index(b)))
        given = impulse if self.index.colliders.index(a) == pair[1] else -impulse
        data["contact/vector"] = np.concatenate([data["contact/vector"], given[None]])
        size = float(np.linalg.norm(impulse))
        data["contact/pair"] = np.concatenate([data["contact/pair"], np.array([pair], dtype=np.int32)])
        for name, value in (("impulse", size), ("max_force", size / self.duration), ("min_gap", 5e-4)):
            data[f"contact/{name}"] = np.append(data[f"contact/{name}"], value)

    def settle_records(self) -> None:
        """Energy, momentum and peak records as the changed motion would have them; springs keep what they had."""
        gravity = np.array(self.spec.simulation.gravity)
        before = self._energies(gravity)[1]
        kinetic, potential, momentum = self._sums(gravity)
        spring = self.series("record/potential_energy") - before if self._original is not None else 0.0
        self.set_record("kinetic_energy", kinetic)
        self.set_record("potential_energy", potential + spring)
        for i, axis in enumerate("xyz"):
            self.set_record(f"momentum_{axis}", momentum[:, i])
        speed = np.linalg.norm(self.series("velocity"), axis=2).max(axis=1, initial=0.0)
        way = np.linalg.norm(np.diff(self.series("position"), axis=0, prepend=self.series("position")[:1]), axis=2)
        peak = np.maximum(self.series("record/max_speed"), np.maximum(speed, 1.2 * way.max(axis=1, initial=0.0) / self.duration))
        step = self.series("record/step")
        self.set_record("max_travel_per_step", np.maximum(self.series("record/max_travel_per_step"), 1.5 * peak * step))
        self.set_record("max_speed", peak)

    _original: F64 | None = None

    def _energies(self, gravity: F64) -> tuple[F64, F64]:
        if self._original is None:
            self._original = self._sums(gravity)[1]
        return self._original, self._original

    def _sums(self, gravity: F64) -> tuple[F64, F64, F64]:
        kinetic, potential, momentum = np.zeros(self.count), np.zeros(self.count), np.zeros((self.count, 3))
        for name in self.index.bodies:
            entity, body_name = name.split("/", 1)
            if self.spec.entities[entity].motion == "kinematic":
                continue
            body = next(b for b in self.built[entity].bodies if b.name == body_name)
            turns = rotation_matrix(self.series("quaternion", entity, body_name))
            center = self.series("position", entity, body_name) + turns @ body.center
            speed = self.series("velocity", entity, body_name)
            local = np.einsum("fji,fj->fi", turns, self.series("angular_velocity", entity, body_name))
            kinetic += 0.5 * body.mass * (speed**2).sum(axis=1) + 0.5 * np.einsum("fi,ij,fj->f", local, body.inertia, local)
            potential -= body.mass * (center @ gravity)
            momentum += body.mass * speed
        return kinetic, potential, momentum

    def candidate(self, folder: Path) -> Candidate:
        """Write the cache and open it as a complete bake."""
        cache = Cache(folder / "cache" / "rigid")
        cache.write_index(self.index)
        digests = [write_container(cache.path(k), frame) for k, frame in enumerate(self.frames)]
        (cache.folder / "digests.txt").write_text("".join(f"{d}\n" for d in digests))
        for damage in self.damage:
            damage(cache.folder)
        return Candidate(folder, self.spec, self.built, "full", {"rigid": cache}, "cache/rigid", "test")


def film_of(spec: WorldSpec, built: dict[str, BuiltEntity] | None = None) -> Film:
    """Simulate a small world."""
    geometry = built or build_all(spec)
    solver = SolverRigid(spec, geometry, "rigid")
    solver.prepare()
    frames = [dict(solver.frame_data())]
    for k in range(1, spec.simulation.frames):
        solver.advance(k)
        frames.append(dict(solver.frame_data()))
    film = Film(spec, geometry, solver.index(), frames)
    film._energies(np.array(spec.simulation.gravity))
    return film


def cached(make: Callable[[int], WorldSpec]) -> Callable[[int], Film]:
    """Films of a family of worlds, simulated once per variant; every call gives a fresh copy."""

    @lru_cache(maxsize=64)
    def once(variant: int) -> Film:
        return film_of(make(variant))

    return lambda variant: copied(once(variant))


def copied(film: Film) -> Film:
    """A film that can be changed without changing the one it is of."""
    return dataclasses.replace(film, frames=copy.deepcopy(film.frames), built=dict(film.built), damage=[])


def frame_of_walls(half: float) -> Entity:
    """Four walls of 1 m around a square of half side `half` [m]."""
    walls = [
        Part(shape=Box(size=(0.1, 2 * half + 0.2, 1.0)), pose=pose((sign * (half + 0.05), 0, 0))) for sign in (-1.0, 1.0)
    ] + [Part(shape=Box(size=(2 * half, 0.1, 1.0)), pose=pose((0, sign * (half + 0.05), 0))) for sign in (-1.0, 1.0)]
    return entity(*walls, at=(0, 0, 0.5))


def still(film: Film, name: str, place: F64) -> None:
    """Put a body to sleep at a place [m], shape (3,), in every frame."""
    film.put("position", np.repeat(place[None], film.count, axis=0), name)
    film.put("quaternion", np.repeat([[1.0, 0.0, 0.0, 0.0]], film.count, axis=0), name)
    for channel in ("velocity", "angular_velocity"):
        film.put(channel, np.zeros((film.count, 3)), name)
    film.put("asleep", np.ones(film.count), name)


def free_body(film: Film, rng: np.random.Generator) -> str:
    """A body that moves freely."""
    names = [b.split("/")[0] for b in film.index.bodies]
    return str(rng.choice([n for n in names if film.spec.entities[n].motion == "dynamic"]))
