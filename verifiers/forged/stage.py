"""A stage on which a motion is written down and not simulated: bodies with velocities per frame, and the contacts that account for them.

Contacts obey the balance of momentum: what a contact gives is what gravity and drivers leave over of a body's change of momentum, so that
the evaluators of events find the ledgers of such a motion in order.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64, RigidPose, rotation_matrix
from ...worlds.built import BuiltBody, BuiltEntity, BuiltPart, Convex, TriangleMesh
from ...worlds.cache import Cache, CacheIndex
from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ...worlds.spec import (
    Box,
    Dimensions,
    Entity,
    ForceDriver,
    Material,
    Part,
    Pose,
    RigidInstance,
    SimulationPlan,
    Sphere,
    WorldSpec,
)

__all__ = ["FPS", "G", "Stage"]

FPS = 24
G = 9.81
"""[m/s^2]"""
DENSITY = 600.0
"""[kg/m^3]"""
SUBDIVISIONS = 3
"""Corners of an icosahedron that stands for a ball."""


class CacheForged(Cache):
    """A cache in memory."""

    def __init__(self, index: CacheIndex, frames: list[dict[str, Any]]) -> None:
        super().__init__(Path())
        self._frames = frames
        self.__dict__["index"] = index

    def _channel(self, frame: int, name: str) -> Any:
        return self.read(frame, (name,))[name]

    def read(self, frame: int, names: Any = None) -> dict[str, Any]:
        """Channels of one frame."""
        data = self._frames[frame]
        try:
            return dict(data) if names is None else {n: data[n] for n in names}
        except KeyError as error:
            raise EvidenceError(f"a forged motion has no channel {error}") from error


@dataclass
class Actor:
    """A body on the stage."""

    size: tuple[float, ...]
    """Extents of a box, or the radius of a ball [m]."""
    motion: str
    positions: F64
    quaternions: F64
    velocities: F64
    spins: F64
    """World axes [rad/s]."""
    mass: float
    inertia: F64


@dataclass
class Stage:
    """Bodies and their motion over some frames; +z is up."""

    frames: int
    gravity: float = G
    joints: dict[str, Any] = field(default_factory=dict)
    drivers: dict[str, Any] = field(default_factory=dict)
    regions: dict[str, Any] = field(default_factory=dict)
    actors: dict[str, Actor] = field(default_factory=dict)
    given: dict[tuple[str, str], F64] = field(default_factory=dict)
    """(by, on) -> impulse per interval [N s], shape (F - 1, 3)."""
    blows: list[tuple[int, str, str, float, F64]] = field(default_factory=list)
    """Contacts that begin: interval, by, on, closing speed [m/s], point [m]."""

    @property
    def times(self) -> F64:
        """[s], shape (F,)."""
        return np.arange(self.frames) / FPS

    def add(
        self,
        name: str,
        size: tuple[float, ...],
        at: Any,
        *,
        motion: str = "dynamic",
        velocity: Any = (0.0, 0.0, 0.0),
        spin: Any = (0.0, 0.0, 0.0),
        arm: Any = None,
        turn: tuple[Any, float] = ((0.0, 0.0, 1.0), 0.0),
    ) -> None:
        """Put a body on the stage.

        Args:
            name: of the entity.
            size: extents of a box, or the radius of a ball [m].
            at: its centre at frame 0 [m].
            motion: as of an entity.
            velocity: of its centre [m/s], shape (3,) or (F, 3); it goes their mean over each interval.
            spin: about its centre, world axes, of one direction [rad/s], shape (3,) or (F, 3).
            arm: from a fixed point to its centre at frame 0 [m]: it turns about that point, and `velocity` counts for nothing.
            turn: axis and angle [rad] by which it stands turned at frame 0.
        """
        spins = np.array(np.broadcast_to(np.asarray(spin, dtype=np.float64), (self.frames, 3)))
        angles = _summed(spins)
        quaternions = np.array([_times(_turned(a), _turned(_scaled(*turn))) for a in angles])
        if arm is not None:
            arms = np.array([rotation_matrix(_turned(a)[None])[0] @ np.asarray(arm, dtype=np.float64) for a in angles])
            positions = np.asarray(at, dtype=np.float64) + arms - arms[0]
            velocities = np.cross(spins, arms)
        else:
            velocities = np.array(np.broadcast_to(np.asarray(velocity, dtype=np.float64), (self.frames, 3)))
            positions = np.asarray(at, dtype=np.float64) + _summed(velocities)
        if len(size) == 1:
            mass = DENSITY * 4.0 / 3.0 * np.pi * size[0] ** 3
            inertia = 0.4 * mass * size[0] ** 2 * np.eye(3)
        else:
            mass = DENSITY * float(np.prod(size))
            square = np.square(size)
            inertia = np.diag(mass / 12.0 * (square.sum() - square))
        self.actors[name] = Actor(size, motion, positions, quaternions, velocities, spins, float(mass), inertia)

    def missing(self, on: str) -> F64:
        """Impulse that a body's change of momentum needs beside gravity, drivers and what contacts give already [N s], shape (F - 1, 3)."""
        actor = self.actors[on]
        need: F64 = actor.mass * np.diff(actor.velocities, axis=0)
        need[:, 2] += actor.mass * self.gravity / FPS
        for driver in self.drivers.values():
            if isinstance(driver, ForceDriver) and driver.entity == on:
                need -= np.array(driver.force) / FPS
        for (by, other), given in self.given.items():
            need += given if by == on else 0.0
            need -= given if other == on else 0.0
        return need

    def touch(self, by: str, on: str, *, impulse: Any = None, over: slice = slice(None), speed: float | None = None) -> None:
        """Let one body touch another over some intervals, and give it an impulse; default what it is missing.

        Args:
            by: who gives.
            on: who takes.
            impulse: [N s], shape (3,) or (F - 1, 3).
            over: the intervals.
            speed: closing speed with which the contact begins [m/s].
        """
        asked = (
            self.missing(on) if impulse is None else np.broadcast_to(np.asarray(impulse, dtype=np.float64), (self.frames - 1, 3))
        )
        given = self.given.setdefault((by, on), np.zeros((self.frames - 1, 3)))
        given[over] += asked[over]
        if speed is not None:
            start = over.start or 0
            one, two = (self.actors[n].positions[start] for n in (by, on))
            self.blows.append((start, by, on, speed, 0.5 * (one + two)))

    # ---------------------------------------------------------------- what evaluators read

    def open(self) -> Candidate:
        """The candidate of this motion."""
        spec = self._spec()
        built = {name: self._built(name) for name in self.actors}
        moving = [n for n, a in self.actors.items() if a.motion != "static"]
        bodies, colliders = tuple(f"{n}/body" for n in moving), tuple(self.actors)
        hinges = tuple(n for n, j in self.joints.items() if j.kind == "hinge")
        index = CacheIndex("stage", "mujoco", FPS, self.frames, bodies, colliders, hinges, tuple(self.drivers), "", {})
        frames = [self._frame(k, moving, list(colliders), hinges) for k in range(self.frames)]
        cache = CacheForged(index, frames)
        return Candidate(Path(), spec, built, "full", {"stage": cache}, "forged", "forged")

    def _spec(self) -> WorldSpec:
        entities = {}
        for name, actor in self.actors.items():
            ball = len(actor.size) == 1
            extents = (2.0 * actor.size[0],) * 3 if ball else actor.size
            entities[name] = Entity(
                role="actor",
                motion=actor.motion,
                dimensions=Dimensions(size=extents),
                pose=Pose(position=tuple(actor.positions[0]), quaternion=tuple(actor.quaternions[0])),
                material="matter",
                parts={"p": Part(shape=Sphere(radius=actor.size[0]) if ball else Box(size=actor.size))},
            )
        plan = SimulationPlan(
            fps=FPS,
            frames=self.frames,
            gravity=(0.0, 0.0, -self.gravity),
            solvers={"stage": RigidInstance(engine="mujoco", members=list(self.actors))},
            joints=self.joints,
            drivers=self.drivers,
        )
        materials = {"matter": Material(density=DENSITY, friction=0.9, substance="wood")}
        return WorldSpec.model_validate(
            {
                "title": "forged",
                "prompt": "A forged motion.",
                "materials": materials,
                "entities": entities,
                "simulation": plan,
                "graph": {"regions": self.regions},
            }
        )

    def _built(self, name: str) -> BuiltEntity:
        import trimesh

        actor, nowhere = self.actors[name], RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
        if len(actor.size) == 1:
            shape: Any = trimesh.creation.icosphere(subdivisions=SUBDIVISIONS, radius=actor.size[0])
            piece = Convex("sphere", actor.size, nowhere, np.zeros((0, 3)))
        else:
            shape = trimesh.creation.box(extents=actor.size)
            piece = Convex("box", tuple(0.5 * s for s in actor.size), nowhere, np.zeros((0, 3)))
        mesh = TriangleMesh(np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int32))
        part = BuiltPart("p", "body", "matter", mesh, (piece,), True, (0.0, 0.0), len(actor.size) == 1)
        body = BuiltBody("body", nowhere, actor.mass, np.zeros(3), actor.inertia, actor.mass / DENSITY)
        return BuiltEntity(name, (body,), (part,), "forged")

    def _frame(self, k: int, moving: list[str], colliders: list[str], hinges: tuple[str, ...]) -> dict[str, Any]:
        cast = [self.actors[n] for n in moving]
        frame: dict[str, Any] = {
            "position": np.array([a.positions[k] for a in cast]),
            "quaternion": np.array([a.quaternions[k] for a in cast]),
            "velocity": np.array([a.velocities[k] for a in cast]),
            "angular_velocity": np.array([a.spins[k] for a in cast]),
            "asleep": np.zeros(len(cast), dtype=np.uint8),
            "joint": np.array([self._angle(n, k) for n in hinges]),
            "driver/active": np.ones(len(self.drivers), dtype=np.uint8),
            "field/impulse": self._blown(k, moving),
        }
        pairs, vectors = [], []
        for (by, on), given in self.given.items() if k > 0 else ():
            if given[k - 1].any():
                first, second = colliders.index(by), colliders.index(on)
                pairs.append(sorted((first, second)))
                vectors.append(given[k - 1] if first < second else -given[k - 1])
        sizes = np.linalg.norm(np.array(vectors).reshape(-1, 3), axis=1)
        begun = [b for b in self.blows if b[0] == k - 1]
        frame |= {
            "contact/pair": np.array(pairs, dtype=np.int32).reshape(-1, 2),
            "contact/vector": np.array(vectors, dtype=np.float64).reshape(-1, 3),
            "contact/impulse": sizes,
            "contact/max_force": sizes * FPS,
            "contact/min_gap": np.zeros(len(sizes)),
            "event/time": np.array([(k - 1) / FPS for _ in begun]),
            "event/pair": np.array(
                [sorted((colliders.index(b[1]), colliders.index(b[2]))) for b in begun], dtype=np.int32
            ).reshape(-1, 2),
            "event/point": np.array([b[4] for b in begun], dtype=np.float64).reshape(-1, 3),
            "event/speed": np.array([b[3] for b in begun]),
            "event/impulse": np.array([float(np.linalg.norm(self.given[b[1], b[2]][k - 1])) for b in begun]),
            "impact/time": np.zeros(0),
            "impact/pair": np.zeros((0, 2), dtype=np.int32),
            "impact/turn": np.zeros(0, dtype=np.int32),
            "impact/normal": np.zeros((0, 3)),
            "impact/vector": np.zeros((0, 3)),
        }
        return frame

    def _angle(self, joint: str, k: int) -> float:
        """Angle through which the child of a hinge has turned [rad]."""
        hinge = self.joints[joint]
        return float(_summed(self.actors[hinge.child].spins)[k] @ np.array(hinge.axis, dtype=np.float64))

    def _blown(self, k: int, moving: list[str]) -> F64:
        """Impulses of fields on the bodies [N s]: all that nothing else gives, where a field acts."""
        result = np.zeros((len(moving), 3))
        if k > 0 and any(d.kind == "field" for d in self.drivers.values()):
            for row, name in enumerate(moving):
                result[row] = self.missing(name)[k - 1]
        return result


def _summed(rates: F64) -> F64:
    """Way over the frames of what changes at some rates, shape as these."""
    steps = 0.5 * (rates[:-1] + rates[1:]) / FPS
    result: F64 = np.concatenate([np.zeros((1, rates.shape[1])), np.cumsum(steps, axis=0)])
    return result


def _scaled(axis: Any, angle: float) -> F64:
    unit = np.asarray(axis, dtype=np.float64)
    return np.asarray(unit / np.linalg.norm(unit) * angle)


def _turned(angle: F64) -> F64:
    """Quaternion of a rotation vector [rad]."""
    size = float(np.linalg.norm(angle))
    axis = angle / size if size > 0.0 else np.array([0.0, 0.0, 1.0])
    return np.concatenate([[np.cos(size / 2)], np.sin(size / 2) * axis])


def _times(a: F64, b: F64) -> F64:
    """Product of two quaternions: first b, then a."""
    w, v = a[0], a[1:]
    result: F64 = np.concatenate([[w * b[0] - v @ b[1:]], w * b[1:] + b[0] * v + np.cross(v, b[1:])])
    return result
