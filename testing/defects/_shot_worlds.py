"""Scenes for the suite of shots: everything is placed in the frame of a camera, so that pictures are known by construction."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.predicates import Displacement
from ...worlds.spec import Appearance, Beat, Box, CameraKey, Entity, Material, Part, Pose, Shape, Shot
from ..worlds.small_worlds import MATERIALS, entity, make_candidate, world
from ._support_worlds import quaternion_of
from .cases import World

__all__ = ["ASPECT", "RNG", "Rig"]

RNG = np.random.Generator
ASPECT = 16 / 9
GLASS = Material(density=2500.0, friction=0.4, substance="glass", appearance=Appearance(transmission=1.0))


class Rig:
    """One camera, and things placed by where they are in its picture."""

    def __init__(self, rng: RNG, *, frames: int = 24, fov: float | None = None, crowd: bool = True) -> None:
        self.rng = rng
        self.frames = frames
        self.fov = float(rng.uniform(20, 70)) if fov is None else fov
        self.tall = math.tan(math.radians(self.fov) / 2)
        reach = float(rng.choice([1.0, 100.0, 1e4]))
        self.eye = rng.uniform(-reach, reach, 3)
        yaw, pitch = rng.uniform(-np.pi, np.pi), rng.uniform(-1.0, 1.0)
        back = np.array([math.cos(pitch) * math.cos(yaw), math.cos(pitch) * math.sin(yaw), math.sin(pitch)])
        right = np.cross([0.0, 0.0, 1.0], back)
        right /= np.linalg.norm(right)
        self.axes = np.stack([right, np.cross(back, right), back])
        """Rows: right, up, backwards."""
        self.distance = float(rng.uniform(2, 10))
        """From the camera to what it aims at [m]."""
        self.entities: dict[str, Entity] = {}
        self.paths: dict[str, Any] = {}
        self.shots: dict[str, Shot] = {}
        self.beats: dict[str, Beat] = {}
        for k in range(int(rng.integers(0, 12)) if crowd else 0):
            x, y = rng.uniform(-0.9, 0.9, 2)
            self.add(f"other{k}", Box(size=tuple(rng.uniform(0.1, 1.0, 3))), self.spot(x, y, 40.0 + 3 * k))

    @property
    def wide(self) -> float:
        """Width of the picture at the aim's distance [m]."""
        return 2.0 * self.tall * ASPECT * self.distance

    def spot(self, x: float, y: float, depth: float | None = None) -> F64:
        """World point that is seen at x, y (-1..1 across the picture, right and up) at a depth [m]; default the aim's."""
        d = self.distance if depth is None else depth
        return self.at(x * self.tall * ASPECT * d, y * self.tall * d, d)

    def at(self, right: float, up: float, ahead: float) -> F64:
        """World point by its place seen from the camera [m]."""
        return np.asarray(self.eye + self.axes.T @ np.array([right, up, -ahead]))

    def add(
        self,
        name: str,
        shape: Shape | Part | tuple[Part, ...],
        place: F64,
        *,
        roll: float = 0.0,
        path: F64 | None = None,
        glass: bool = False,
    ) -> None:
        """A thing that faces the camera (x right, y up, z towards it), turned by `roll`; it moves where it has a path."""
        c, s = math.cos(roll), math.sin(roll)
        turn = self.axes.T @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        shapes = shape if isinstance(shape, tuple) else (shape,)
        made = entity(*shapes, motion="static" if path is None else "kinematic")
        where = Pose(position=tuple(place), quaternion=tuple(quaternion_of(turn)))
        self.entities[name] = made.model_copy(update={"pose": where, "material": "glass" if glass else "wood"})
        if path is not None:
            self.paths[name] = (path, quaternion_of(turn))

    def key(self, frame: int = 0, *, eye: F64 | None = None, aim: F64 | None = None, fov: float | None = None) -> CameraKey:
        """The camera as it is, or moved."""
        return CameraKey(
            frame=frame,
            position=tuple(self.eye if eye is None else eye),
            target=tuple(self.at(0, 0, self.distance) if aim is None else aim),
            fov_deg=self.fov if fov is None else fov,
        )

    def shot(self, name: str, frames: tuple[int, int] | None = None, *keys: CameraKey, **more: Any) -> None:
        """A shot; default over all frames from the camera as it is."""
        named = {f"k{i}": k for i, k in enumerate(keys or (self.key(),))}
        self.shots[name] = Shot(frames=frames or (0, self.frames - 1), keys=named, **more)

    def beat(self, name: str, subject: str, frames: tuple[int, int] | None = None) -> None:
        """A beat that comes true at the first frame at which its subject is displaced."""
        self.beats[name] = Beat(
            text="it moves",
            owner="rigid",
            subject=subject,
            frames=frames or (0, self.frames - 1),
            predicate=Displacement(entity=subject, min=1e-3),
        )

    def still(self, place: F64) -> F64:
        """A path that stays, shape (frames, 3)."""
        return np.tile(place, (self.frames, 1))

    def world(self, folder: Path, *culprits: str) -> World:
        """Finish, with entities in any order."""
        names = list(self.entities)
        placed = {names[i]: self.entities[names[i]] for i in self.rng.permutation(len(names))}
        materials = {**MATERIALS, "glass": GLASS}
        spec = world(placed, frames=self.frames, beats=self.beats, shots=self.shots, materials=materials)
        return World(make_candidate(folder, spec, tracks=self.paths), culprits)
