"""Strains and shapes of deforming bodies, from the vertices of their simulation meshes alone (float64, no solver)."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ...worlds.simulation_mesh import volumes

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.categories.deforming import Deforming

__all__ = ["Strains", "deflections", "require_deforming", "strains_of"]

SLIVER = 0.05
"""Own choice: tetrahedra of less than this share of the median volume are too thin for a strain; their volume counts all the same."""


class Strains(NamedTuple):
    """Strains of one body over the frames; NaN where its vertices are not finite."""

    largest: F64
    """Largest principal strain by amount, shape (F,)."""
    place: F64
    """Where [m], world, shape (F, 3)."""
    least_volume: F64
    """Least ratio of a tetrahedron's volume to that at rest, shape (F,); below 0 it is inverted."""
    inverted: NDArray[np.intp]
    """Inverted tetrahedra, shape (F,)."""
    volume: F64
    """Volume of all [m^3], shape (F,)."""
    rest: float
    """The same at rest."""


def require_deforming(candidate: Candidate, entity: str) -> Deforming:
    """The deformation of an entity.

    Raises:
        EvidenceError: it is no deforming body, or no cache holds it.
    """
    if entity not in candidate.deforming:
        kind = (
            candidate.spec.entities[entity].physics.category if entity in candidate.spec.entities else "not in the specification"
        )
        raise EvidenceError(
            f"no cache holds how {entity!r} ({kind}) deforms; only elastic bodies and cloth do, once probed or baked"
        )
    return candidate.deforming[entity]


@lru_cache(maxsize=16)
def strains_of(soft: Deforming, frames: int) -> Strains:
    """Strains of a body with tetrahedra over its first frames; bodies are those of one candidate and compared by identity.

    Raises:
        EvidenceError: it has no tetrahedra.
    """
    meshes = [(name, m) for name, m in soft.meshes.items() if len(m.tets)]
    if not meshes:
        raise EvidenceError(f"{soft.entity!r} is a sheet: it has no tetrahedra whose strain could be measured")
    largest, place = np.zeros(frames), np.full((frames, 3), np.nan)
    least, inverted, volume = np.full(frames, np.inf), np.zeros(frames, dtype=np.intp), np.zeros(frames)
    total = 0.0
    for name, mesh in meshes:
        rest = volumes(mesh.vertices, mesh.tets)
        total += float(rest.sum())
        edges = mesh.vertices[mesh.tets]
        undo = np.linalg.inv(np.swapaxes(edges[:, 1:] - edges[:, :1], 1, 2))
        thick = rest > SLIVER * float(np.median(rest))
        for frame in range(frames):
            at = soft.positions(frame, name)
            if not np.isfinite(at).all():
                largest[frame] = least[frame] = volume[frame] = np.nan
                continue
            corner = at[mesh.tets]
            now = volumes(at, mesh.tets)
            gradient = np.swapaxes(corner[:, 1:] - corner[:, :1], 1, 2) @ undo
            stretch = np.linalg.svd(gradient[thick], compute_uv=False)
            strain = np.abs(stretch - 1.0).max(axis=1)
            worst = int(strain.argmax())
            if strain[worst] >= largest[frame]:
                largest[frame], place[frame] = strain[worst], corner[thick][worst].mean(axis=0)
            ratio = now / rest
            least[frame] = min(least[frame], float(ratio.min()))
            inverted[frame] += int((ratio <= 0.0).sum())
            volume[frame] += float(now.sum())
    return Strains(largest, place, least, inverted, volume, total)


def deflections(candidate: Candidate, entity: str) -> F64:
    """Farthest that a visible point is from the rest shape where that fits best [m], shape (F,).

    Raises:
        EvidenceError: no cache holds how it deforms.
    """
    soft = require_deforming(candidate, entity)
    found = np.zeros(candidate.frame_count)
    for part in soft.built.parts:
        rest = soft.meshes[part.part].bound(soft.meshes[part.part].vertices)
        for frame in range(candidate.frame_count):
            away = candidate.shape(entity, part.part, frame) - rest
            found[frame] = np.maximum(found[frame], np.linalg.norm(away, axis=1).max())
    return found
