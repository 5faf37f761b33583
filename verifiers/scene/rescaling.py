"""Patches that scale an entity: its parts, and its contract with them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import Box, Capsule, Cylinder, Extrusion, Mesh, Sphere, Wedge
from ..rows.corrections import pointer, set_value

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Entity

__all__ = ["scaled", "scaled_parts"]

SOLIDS = Box | Sphere | Cylinder | Capsule | Wedge | Extrusion | Mesh
"""Shapes whose lengths all stand in `LENGTHS`."""
LENGTHS = ("size", "radius", "height", "length", "scale", "polygon")
"""Fields of shapes that are lengths [m], or factors on them."""
EQUAL = 1e-9
"""[1] Relative: factors this near to each other scale alike along all axes."""


def scaled_parts(name: str, entity: Entity, factors: F64) -> tuple[dict[str, Any], ...]:
    """Patch that scales the parts along the entity's axes, about its origin; empty where their shapes cannot be scaled so.

    Args:
        name: the entity.
        entity: its contract.
        factors: along x, y and z [1], shape (3,).
    """
    alike = float(np.ptp(factors)) <= EQUAL * float(factors.max())
    if entity.generator is not None or not entity.parts:
        return ()
    patch: list[dict[str, Any]] = []
    for part, content in entity.parts.items():
        turned = content.pose.euler is not None or content.pose.quaternion is not None
        straight = isinstance(content.shape, Box | Wedge) and not turned
        if not (alike and isinstance(content.shape, SOLIDS)) and not straight:
            return ()
        place = pointer("entities", name, "parts", part)
        for field in LENGTHS:
            value = getattr(content.shape, field, None)
            if value is not None:
                by = factors if field == "size" and len(value) == 3 else factors[0]
                patch += set_value(f"{place}/shape/{field}", _rounded(np.asarray(value, dtype=np.float64) * by))
        if any(content.pose.position):
            at = _rounded(np.asarray(content.pose.position) * factors)
            value = content.pose.model_dump(mode="json", exclude_none=True) | {"position": at}
            patch += set_value(f"{place}/pose", value)
    return tuple(patch)


def scaled(candidate: Candidate, name: str, factor: float) -> tuple[dict[str, Any], ...]:
    """Patch that scales parts and contract alike and leaves the entity standing where it stands; empty where its shapes cannot be scaled."""
    entity = candidate.spec.entities[name]
    patch = scaled_parts(name, entity, np.full(3, factor))
    if not patch:
        return ()
    size = _rounded(np.asarray(entity.dimensions.size) * factor)
    gravity = np.asarray(candidate.spec.simulation.gravity)
    strength, origin = float(np.linalg.norm(gravity)), np.asarray(entity.pose.position)
    foot = origin
    if strength > 0.0:
        down = gravity / strength
        reach = float(((candidate.vertices(name, 0) - origin) @ down).max())
        foot = origin + (1.0 - factor) * reach * down
    pose = entity.pose.model_dump(mode="json", exclude_none=True) | {"position": _rounded(foot)}
    return (
        *patch,
        *set_value(pointer("entities", name, "dimensions", "size"), size),
        *set_value(pointer("entities", name, "pose"), pose),
    )


def _rounded(values: F64) -> Any:
    """Numbers as a specification has them, to six digits."""
    if values.ndim == 0:
        return float(f"{float(values):.7g}")
    return [_rounded(np.asarray(v)) for v in values]
