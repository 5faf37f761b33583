"""Elastic bodies and cloth: parts whose surfaces bend from frame to frame."""

from __future__ import annotations

import numpy as np

from ...worlds.built import BuiltPart
from ..tracer.surfaces import Surface
from .layer import PartsLayer
from .soft_part import SoftPart

__all__ = ["DeformingLayer"]

ROUNDED = 5
"""Digits to which normals at rest must agree for corners to be shaded as one."""


class DeformingLayer(PartsLayer):
    """Elastic bodies and cloth; rigid in their shape at rest until they are simulated."""

    def bends(self, entity: str) -> bool:
        """True where a cache holds the deformation of an entity."""
        return entity in self.candidate.deforming

    def soft(self, entity: str, part: BuiltPart, surface: Surface, start: int) -> SoftPart | None:
        """Binding of a batch's vertices from row `start` on; None at the static stage."""
        return _soft_part(entity, part, surface, start) if self.bends(entity) else None


def _soft_part(entity: str, part: BuiltPart, surface: Surface, start: int) -> SoftPart:
    """A part whose `surface` at rest stands in a batch from row `start` on."""
    from scipy.spatial import cKDTree

    source = cKDTree(part.render.vertices).query(surface.positions)[1].astype(np.int64)
    if len(surface.faces) == len(part.render.faces):
        # Vertices of one place need not stay together.
        source[surface.faces.reshape(-1)] = part.render.faces.reshape(-1)
    key = np.concatenate([np.round(surface.positions, 9), np.round(surface.normals, ROUNDED)], axis=1)
    group = np.unique(key, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)
    mesh = part.simulation
    loose = mesh is not None and len(mesh.tets) == 0 and len(mesh.vertices) == mesh.faces.size
    return SoftPart(entity, part.part, slice(start, start + len(source)), source, group, surface.faces, loose)
