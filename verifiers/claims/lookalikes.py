"""Bodies that look the same at a glance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .bounds import ALIKE

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["alike"]


def alike(candidate: Candidate, a: str, b: str) -> bool:
    """True where two bodies look the same at a glance: extents, volume, colour."""
    spec, volumes, extents, colours = candidate.spec, [], [], []
    for name in (a, b):
        entity = spec.entities[name]
        extents.append(np.sort(np.array(entity.dimensions.size)))
        volumes.append(sum(body.volume for body in candidate.entity(name).bodies))
        colours.append(np.array(spec.materials[entity.material].appearance.color))
    near = np.abs(extents[0] - extents[1]) <= ALIKE * np.maximum(extents[0], extents[1])
    full = abs(volumes[0] - volumes[1]) <= ALIKE * max(volumes)
    return bool(near.all() and full and (np.abs(colours[0] - colours[1]) <= ALIKE).all())
