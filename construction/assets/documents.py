"""An asset as it stands in a specification: entities, joints and relations as JSON."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64, RigidPose, compose, pose_of, rotation_matrix
from ...worlds.assemblies import pose_json
from ...worlds.shapes import Pose
from ..kept_shapes import kept_shape
from .made import MAIN, Body, Joint, Made

__all__ = ["AssetDocuments", "asset_documents", "asset_size", "body_boxes", "body_id", "feet", "part_boxes"]

DIGITS = 9
"""Decimals to which lengths [m] and directions are written."""
TOUCH = 1e-4
"""[m] Own choice: depth to which what is fastened may overlap; nothing that a generator makes does."""
FIXED = "made as fixed: it stays as it hangs, and does not open"
"""Reason of the relation that holds a body in place of its joint."""
GROUND = 1e-4
"""[m] Own choice: what is no higher stands on the ground."""


class AssetDocuments(NamedTuple):
    """Members of the collections of a specification that an asset is, by id."""

    entities: dict[str, dict[str, Any]]
    joints: dict[str, dict[str, Any]]
    relations: dict[str, dict[str, Any]]


def body_id(asset: str, body: str) -> str:
    """Entity id of a body of an asset."""
    return asset if body == MAIN else f"{asset}_{body}"


def asset_documents(
    name: str,
    record: dict[str, Any],
    made: Made,
    pose: RigidPose,
    *,
    motion: str,
    boxes: Mapping[str, tuple[F64, F64]] | None = None,
) -> AssetDocuments:
    """Documents of an asset that stands at a pose.

    Args:
        name: id of the asset, which its main body bears.
        record: its field `asset`: generator, parameters and seed; where it says `fixed`, what joints would hold is static and
            fastened to what they hang it on; of a static thing so is what lies loosely on it (a lid, a pile).
        made: its bodies.
        pose: of the asset's frame in the world.
        motion: of its main body where that does not say it; the others are dynamic.
        boxes: of its bodies, where they are known, see `body_boxes`.
    """
    known = body_boxes(made) if boxes is None else boxes
    hung = {j.child: j.parent for j in made.joints.values()}
    fixed = hung if record.get("fixed") else {}
    entities = {
        body_id(name, key): _entity(body, known[key], pose, "dynamic" if key in hung else motion, whole=key == MAIN)
        for key, body in made.bodies.items()
    }
    for key in made.bodies if record.get("fixed") and motion == "static" else fixed:
        entities[body_id(name, key)]["motion"] = "static"
    entities[name]["asset"] = record | {"bodies": [body_id(name, key) for key in made.bodies if key != MAIN]}
    joints = {} if fixed else {f"{name}_{key}": _joint(name, joint, pose) for key, joint in made.joints.items()}
    relations: dict[str, dict[str, Any]] = {
        f"{body_id(name, a)}_carries_{b}": {"kind": "supports", "a": body_id(name, a), "b": body_id(name, b)}
        for a, b in made.carries
    }
    for child, parent in fixed.items():
        a, b = body_id(name, parent), body_id(name, child)
        relations[f"{b}_fixed"] = {"kind": "fastened", "a": a, "b": b, "max_depth": TOUCH, "reason": FIXED}
    return AssetDocuments(entities, joints, relations)


def _entity(body: Body, box: tuple[F64, F64], pose: RigidPose, motion: str, *, whole: bool) -> dict[str, Any]:
    """Entity whose own frame is the asset's for the main body, and stands under the middle of any other."""
    low, high = box
    own = np.zeros(3) if whole else np.array([*(0.5 * (low + high))[:2], low[2]])
    parts = {}
    for key, part in body.parts.items():
        document = part.model_dump(mode="json", exclude_none=True, exclude_defaults=True)
        document["shape"] = part.shape.model_dump(mode="json", exclude_none=True, exclude_defaults=True) | {
            "kind": part.shape.kind
        }
        position = np.array(part.pose.position) - own
        document["pose"] = {**document.get("pose", {}), "position": [round(float(c), DIGITS) + 0.0 for c in position]}
        parts[key] = document
    return {
        "role": body.role,
        "motion": body.motion or (motion if whole else "dynamic"),
        "material": body.material,
        "dimensions": {"size": [round(float(c), DIGITS) for c in high - low]},
        "pose": pose_json(compose(pose, RigidPose(own, np.array([1.0, 0.0, 0.0, 0.0])))),
        "parts": parts,
        **({} if body.breakable is None else {"breakable": body.breakable}),
        **({} if body.physics is None else {"physics": body.physics}),
    }


def _boxes(body: Body) -> tuple[F64, F64]:
    """Least and greatest corners of the visible surfaces of a body's parts in the asset's frame [m], shape (n, 3) each."""
    points = [
        pose_of(Pose.model_validate(p.pose)).apply(kept_shape(p.shape, Path()).geometry.render.vertices)
        for p in body.parts.values()
    ]
    return np.array([p.min(0) for p in points]), np.array([p.max(0) for p in points])


def part_boxes(made: Made) -> dict[str, tuple[F64, F64]]:
    """Least and greatest corners of the parts of each body of an asset, in its own frame [m], shape (n, 3) each."""
    return {name: _boxes(body) for name, body in made.bodies.items()}


def body_boxes(made: Made) -> dict[str, tuple[F64, F64]]:
    """Least and greatest corner of each body of an asset, in its own frame [m], shape (3,) each."""
    return {name: (low.min(0), high.max(0)) for name, (low, high) in part_boxes(made).items()}


def feet(made: Made, boxes: Mapping[str, tuple[F64, F64]] | None = None, *, stands: bool = True) -> list[str]:
    """Names of the bodies by which an asset stands or hangs.

    Those that no joint holds and no other body of it carries; of what stands on jointed bodies alone (wheels), those.
    """
    known = body_boxes(made) if boxes is None else boxes
    grounded = {name for name, (low, _) in known.items() if abs(float(low[2])) < GROUND}
    jointed = {j.child for j in made.joints.values()}
    free = [name for name in made.bodies if name not in jointed and name not in {b for _, b in made.carries}]
    wheels = [name for name in made.bodies if name in jointed and name in grounded]
    if stands and wheels and not grounded & set(free):
        return wheels
    return free


def asset_size(made: Made) -> tuple[float, float, float]:
    """Extents x, y, z of an asset with all its bodies [m]."""
    boxes = body_boxes(made).values()
    x, y, z = np.max([high for _, high in boxes], axis=0) - np.min([low for low, _ in boxes], axis=0)
    return (float(x), float(y), float(z))


def _joint(name: str, joint: Joint, pose: RigidPose) -> dict[str, Any]:
    turn = rotation_matrix(pose.quaternion)
    document: dict[str, Any] = {
        "kind": joint.kind,
        "parent": body_id(name, joint.parent),
        "child": body_id(name, joint.child),
        "anchor": _numbers(pose.apply(np.array([joint.anchor], dtype=np.float64))[0]),
    }
    if joint.axis is not None:
        document["axis"] = _numbers(turn @ np.array(joint.axis, dtype=np.float64))
    if joint.range is not None:
        document["range"] = [float(v) for v in joint.range]
    return document | {k: v for k, v in (("damping", joint.damping), ("friction", joint.friction)) if v}


def _numbers(values: F64) -> list[float]:
    return [round(float(v), DIGITS) + 0.0 for v in values]
