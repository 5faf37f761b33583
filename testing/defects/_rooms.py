"""A room with a door and generated things at any place and angle, for the seeded defects of interiors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ...construction.assets.documents import asset_documents
from ...construction.assets.posing import posed
from ...construction.assets.registry import generator, make
from ...construction.build import build_entity
from ...worlds.arrays import F64, RigidPose, euler_to_quaternion, rotation_matrix
from ...worlds.built import BuiltPart
from ...worlds.candidate import Candidate
from ...worlds.patch import apply_patch
from ...worlds.scaled import scaled_entity
from ...worlds.spec import BoxRegion, Connects
from ..worlds.small_worlds import world
from .cases import World

__all__ = ["DOOR", "GAP", "Room", "room"]

RNG = np.random.Generator
GAP = 1e-3
"""[m] Two collision skins at the default: so far above each other things stand."""
DOOR = 0.86
"""[m] Clear width of the door."""
HINGE, POST = 0.006, 0.04
"""[m] From the axis of the hinges to the face of the closed leaf; radius of a post."""
WALL, TALL, HALF, DEEP = 0.12, 2.4, 2.6, 1.8
"""[m] Thickness and height of the wall, half the length of the floor along x, half its depth."""


@dataclass
class Room:
    """A floor with a wall across it at x = 0 and a door in the wall, at some place and angle; regions `a` and `b` on its sides."""

    rng: RNG
    yaw: float
    place: F64
    documents: dict[str, dict[str, Any]] = field(default_factory=dict)
    joints: dict[str, dict[str, Any]] = field(default_factory=dict)
    relations: dict[str, dict[str, Any]] = field(default_factory=dict)

    def pose(self, at: Sequence[float], turn: float = 0.0) -> RigidPose:
        """Pose in the world of what stands at a point of the room, turned about z [rad]."""
        turned = rotation_matrix(euler_to_quaternion((0.0, 0.0, self.yaw)))
        return RigidPose(self.place + turned @ np.array(at, dtype=np.float64), euler_to_quaternion((0.0, 0.0, self.yaw + turn)))

    def blocks(
        self,
        name: str,
        role: str,
        boxes: Mapping[str, tuple[Sequence[float], Sequence[float]]],
        *,
        motion: str = "static",
        **more: Any,
    ) -> None:
        """An entity of upright boxes, from their least to their greatest corners in the room [m]."""
        low, high = (np.array([b[k] for b in boxes.values()], dtype=np.float64) for k in (0, 1))
        middle = 0.5 * (low.min(axis=0) + high.max(axis=0))
        parts = {
            key: {
                "shape": {"kind": "box", "size": (np.array(b[1]) - np.array(b[0])).tolist()},
                "pose": {"position": (0.5 * (np.array(b[0]) + np.array(b[1])) - middle).tolist()},
            }
            for key, b in boxes.items()
        }
        self.documents[name] = {
            "role": role,
            "motion": motion,
            "material": more.pop("material", "oak"),
            "dimensions": {"size": (high.max(axis=0) - low.min(axis=0)).tolist()},
            "pose": _pose(self.pose(middle.tolist())),
            "parts": parts,
            **more,
        }

    def put(
        self,
        name: str,
        kind: str,
        at: Sequence[float],
        /,
        *,
        facing: float = 0.0,
        motion: str | None = None,
        positions: Mapping[str, float] | None = None,
        fixed: bool = False,
        **parameters: Any,
    ) -> None:
        """A generated thing at a point of the room, turned about z [rad]; `fixed` holds what joints would."""
        made = posed(make(kind, parameters, int(self.rng.integers(1000))), positions or {})
        record = {"generator": kind, "parameters": parameters, "seed": 0, "fixed": fixed}
        found = asset_documents(name, record, made, self.pose(at, facing), motion=motion or generator(kind).motion)
        self.documents |= found.entities
        self.joints |= found.joints
        self.relations |= found.relations

    def shell(self, *, ajar: float = 0.0) -> None:
        """Floor, wall and door; its leaf turns into the side of negative x."""
        self.blocks("floor", "floor", {"slab": ((-HALF, -DEEP, -0.2), (HALF, DEEP, 0.0))}, material="concrete_c30")
        half = DOOR / 2 + 0.0451
        x, top = WALL / 2 - 1e-4, 2.03 + 0.0451
        self.blocks(
            "wall",
            "wall",
            {
                "left": ((-x, -DEEP, 0.0), (x, -half, TALL)),
                "right": ((-x, half, 0.0), (x, DEEP, TALL)),
                "over": ((-x, -half, top), (x, half, TALL)),
            },
            material="gypsum_plaster",
        )
        turned = {"leaf": ajar} if ajar else None
        self.put("door", "door", (0.0, 0.0, 0.0), facing=-math.pi / 2, positions=turned, width=DOOR, depth=WALL, casing=False)

    def post(self, angle: float) -> None:
        """A post that the leaf of the closed door meets after an angle [rad], below its handle."""
        anchor, axis = (np.array(self.joints["door_leaf"][k]) for k in ("anchor", "axis"))
        turn = rotation_matrix(np.array([math.cos(angle / 2), *(math.sin(angle / 2) * axis)]))
        # Closed, the leaf lies along y of the room, its hinge at one end, and its face looks to negative x.
        room = rotation_matrix(euler_to_quaternion((0.0, 0.0, self.yaw)))
        hinge = room.T @ (anchor - self.place)
        out = np.array([0.0, -0.8 * DOOR * np.sign(hinge[1]), 0.0])
        face = np.array([hinge[0] + HINGE - POST, hinge[1], 0.0]) + out
        at = room.T @ turn @ room @ (face - hinge) + hinge
        self.documents["post"] = {
            "role": "post",
            "motion": "static",
            "material": "oak",
            "dimensions": {"size": [2 * POST, 2 * POST, 0.7]},
            "pose": _pose(self.pose([at[0], at[1], 0.35])),
            "parts": {"post": {"shape": {"kind": "cylinder", "radius": POST, "height": 0.7}}},
        }

    def sill(self, height: float) -> None:
        """A sill right behind the doorway [m]."""
        self.blocks("sill", "sill", {"board": ((0.1, -0.7 * DOOR, 0.0), (0.16, 0.7 * DOOR, height))})

    def resized(self, name: str, factor: float) -> None:
        """Make a thing of one body larger or smaller about its foot."""
        self.documents[name] |= {"scale": factor}

    def world(
        self,
        folder: Path,
        *culprits: str,
        way: Connects | None = None,
        parts: Mapping[str, BuiltPart] | None = None,
    ) -> World:
        """The room to judge: its specification with all that it names, and its geometry.

        Args:
            folder: of the world.
            culprits: what is wrong with it.
            way: a connection from region `a` to region `b`.
            parts: parts that were built otherwise, by entity.
        """
        regions = {
            side: BoxRegion(min=(x0, -DEEP + 0.2, 0.2), max=(x1, DEEP - 0.2, 0.7), relative_to="floor")
            for side, x0, x1 in (("a", -HALF + 0.2, -HALF + 0.9), ("b", HALF - 0.9, HALF - 0.2))
        }
        base = world({}, regions=regions if way is not None else None, relations=None if way is None else {"way": way})
        factors = {n: d.pop("scale") for n, d in self.documents.items() if "scale" in d}
        edits = [{"op": "add", "path": f"/entities/{n}", "value": d} for n, d in self.documents.items()]
        edits += [{"op": "add", "path": f"/simulation/joints/{n}", "value": d} for n, d in self.joints.items()]
        edits += [{"op": "add", "path": f"/graph/relations/{n}", "value": d} for n, d in self.relations.items()]
        moving = [n for n, d in self.documents.items() if d["motion"] != "static"]
        solver = {"engine": "mujoco", "members": list(self.documents)}
        edits.append({"op": "add", "path": "/simulation/solvers", "value": {"rigid": solver} if moving else {}})
        spec = apply_patch(base, edits)
        for name, factor in factors.items():
            value = scaled_entity(spec, name, factor)
            spec = apply_patch(spec, [{"op": "add", "path": f"/entities/{name}", "value": value}])
        built = {n: build_entity(spec, n, folder) for n in spec.entities}
        for name, part in (parts or {}).items():
            others = tuple(part if p.part == part.part else p for p in built[name].parts)
            built[name] = replace(built[name], parts=others)
        return World(Candidate(folder, spec, built, "static"), culprits)


def _pose(pose: RigidPose) -> dict[str, Any]:
    return {"position": pose.position.tolist(), "quaternion": pose.quaternion.tolist()}


def room(rng: RNG, *, ajar: float = 0.0) -> Room:
    """A room with its shell, at a random place and angle."""
    found = Room(rng, float(rng.uniform(-math.pi, math.pi)), np.array([*rng.uniform(-20.0, 20.0, 2), 0.0]))
    found.shell(ajar=ajar)
    return found
