"""Scenes for the suite of support: built upright about the origin, then turned, moved and crowded as a whole."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import Box, Cylinder, Entity, Fastened, Material, Mesh, Part, Pose, Shape, Supports, WorldSpec
from ..worlds.small_worlds import MATERIALS, entity, make_candidate, mesh_of, world
from .cases import World

__all__ = ["FRAMES", "RNG", "Scene", "block", "inside_out", "quaternion_of", "turn"]

RNG = np.random.Generator
FRAMES = 16
G = 9.81
UPRIGHT = np.eye(3)


def turn(axis: str, angle: float) -> F64:
    """Rotation about a coordinate axis, shape (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    made = np.eye(3)
    made[[i, j], [i, j]] = c
    made[i, j], made[j, i] = -s, s
    return made


def quaternion_of(matrix: F64) -> F64:
    """Unit quaternion (w, x, y, z) of rotation matrices, shape (..., 4)."""
    from scipy.spatial.transform import Rotation

    return np.asarray(np.roll(Rotation.from_matrix(matrix).as_quat(), 1, axis=-1))


def inside_out(shape: Shape) -> Mesh:
    """The shape's surface as an import whose faces look inwards."""
    made = mesh_of(shape)
    faces = made.faces[:, ::-1]
    return Mesh(vertices=[tuple(v) for v in made.vertices.tolist()], faces=[tuple(f) for f in faces.tolist()])


def block(rng: RNG, size: F64) -> Shape:
    """Something with level ends and its centre of mass in the middle; `size` are full extents."""
    if rng.random() < 0.3:
        return Cylinder(radius=float(min(size[:2])) / 2, height=float(size[2]))
    return Box(size=tuple(size))


class Scene:
    """Entities with places and paths in an upright frame."""

    def __init__(self, rng: RNG, *, friction: float = 0.5, floor: bool = True, crowd: bool = True) -> None:
        self.rng = rng
        self.entities: dict[str, tuple[Entity, F64, F64]] = {}
        self.paths: dict[str, tuple[F64, F64]] = {}
        self.relations: dict[str, Any] = {}
        self.more: dict[str, Any] = {"materials": {**MATERIALS, "wood": _wood(friction)}}
        self.channels: dict[str, Any] = {}
        self.turned = _somehow(rng)
        reach = float(rng.choice([0.0, 10.0, 1e3]))
        self.moved = rng.uniform(-reach, reach, 3)
        if floor:
            self.add("floor", Box(size=(30, 30, 0.2)), at=(0, 0, -0.1))
        for k in range(int(rng.integers(0, 12)) if crowd else 0):
            half = rng.uniform(0.02, 0.2)
            self.add(f"other{k}", Box(size=(2 * half,) * 3), at=(6 + 0.5 * k, -8, half + 1e-4), motion="dynamic")

    def add(
        self,
        name: str,
        *shapes: Shape | Part,
        at: Any,
        rotation: F64 = UPRIGHT,
        motion: str = "static",
        path: Any = None,
        turns: Any = None,
        **more: Any,
    ) -> None:
        """An entity; `path` shape (frames, 3) and `turns` shape (frames, 3, 3) where it moves."""
        self.entities[name] = (entity(*shapes, motion=motion, **more), np.asarray(at, dtype=float), rotation)
        if path is not None or turns is not None:
            where = np.broadcast_to(self.entities[name][1] if path is None else path, (FRAMES, 3))
            self.paths[name] = (where, np.broadcast_to(rotation if turns is None else turns, (FRAMES, 3, 3)))

    def post(self, x: float, y: float, top: float, *, founded: bool = False) -> None:
        """A thin static post on the floor, or set into it, that reaches up to `top` [m]."""
        name = f"post{sum(n.startswith('post') for n in self.entities)}"
        self.add(name, Box(size=(0.02, 0.02, top)), at=(x, y, top / 2))
        if founded:
            self.found(name)

    def found(self, name: str) -> None:
        """Set an upright thing into the floor: what hangs on its side does not tip it."""
        reason = f"the {name.rstrip('0123456789')} is set into the floor"
        self.relations[f"set_{name}"] = Fastened(a="floor", b=name, max_depth=1e-3, reason=reason)

    def gallows(self) -> None:
        """A static beam along x with its underside at 3 m, on an arm and a post beside it, which is set into the floor."""
        self.add("beam", Box(size=(1, 0.1, 0.1)), at=(0, 0, 3.05))
        self.add("arm", Box(size=(0.05, 2.0, 0.1)), at=(0.47, 1.05, 3.05))
        self.post(0.47, 2.0, 3.05, founded=True)

    def on(self, a: str, b: str, **more: Any) -> None:
        """Declare that `a` carries `b`."""
        self.relations[f"r{len(self.relations)}"] = Supports(a=a, b=b, **more)

    def point(self, place: Any) -> tuple[float, ...]:
        """World coordinates of a point of the upright frame."""
        return tuple(self.turned @ np.asarray(place, dtype=float) + self.moved)

    def way(self, direction: Any) -> tuple[float, ...]:
        """World direction."""
        return tuple(self.turned @ np.asarray(direction, dtype=float))

    def spec(self, frames: int = FRAMES) -> WorldSpec:
        """The specification, turned and moved."""
        names = list(self.entities)
        order = [names[i] for i in self.rng.permutation(len(names))]
        placed = {}
        for name in order:
            made, at, rotation = self.entities[name]
            where = Pose(position=self.point(at), quaternion=tuple(quaternion_of(self.turned @ rotation)))
            placed[name] = made.model_copy(update={"pose": where})
        gravity = self.way((0, 0, -G))
        return world(placed, relations=self.relations, gravity=gravity, frames=frames, **self.more)

    def world(self, folder: Path, *culprits: str, still: bool = False) -> World:
        """Finish: before any simulation (only where `still`), or with the paths as caches."""
        spec = self.spec()
        if still and not self.paths and self.rng.random() < 0.3:
            return World(make_candidate(folder, spec), culprits)
        tracks = {
            n: (where @ self.turned.T + self.moved, quaternion_of(self.turned @ turns))
            for n, (where, turns) in self.paths.items()
        }
        return World(make_candidate(folder, spec, tracks=tracks, **self.channels), culprits)


def _wood(friction: float) -> Material:
    return Material(density=600.0, friction=friction, substance="wood")


def _somehow(rng: RNG) -> F64:
    """Upright, turned about the vertical, or with gravity along any direction."""
    kind = int(rng.integers(3))
    if kind == 0:
        return UPRIGHT
    about = turn("z", float(rng.uniform(-3, 3)))
    if kind == 1:
        return about
    return turn("x", float(rng.uniform(-3, 3))) @ turn("y", float(rng.uniform(-3, 3))) @ about
