"""Surfaces cut into small pieces, for integrals over them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..worlds.arrays import F64, I32

__all__ = ["Patches", "patches_of"]


class Patches(NamedTuple):
    """Pieces of a surface."""

    point: F64
    """Their middles [m], shape (n, 3)."""
    area: F64
    """[m^2], shape (n,)."""


def patches_of(vertices: F64, faces: I32, size: float, low: F64, high: F64) -> Patches:
    """Pieces of the triangles that reach into a box: each cut into n^2 equal ones whose edges are no longer than `size`; only those with their middle in the box.

    Args:
        vertices: [m], shape (n, 3).
        faces: shape (m, 3).
        size: longest edge of a piece [m].
        low: least corner of the box [m], shape (3,).
        high: its greatest corner.
    """
    corners = vertices[faces]
    near = ((corners.max(axis=1) >= low) & (corners.min(axis=1) <= high)).all(axis=1)
    corners = corners[near]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    counts = np.maximum(1, np.ceil(edges.max(axis=1, initial=0.0) / size - 1e-9)).astype(int)
    points, areas = [np.zeros((0, 3))], [np.zeros(0)]
    for count in np.unique(counts):
        held = corners[counts == count]
        middles = _middles(int(count))
        points.append(np.einsum("pk,tkd->tpd", middles, held).reshape(-1, 3))
        whole = 0.5 * np.linalg.norm(np.cross(held[:, 1] - held[:, 0], held[:, 2] - held[:, 0]), axis=1)
        areas.append(np.repeat(whole / len(middles), len(middles)))
    point, area = np.concatenate(points), np.concatenate(areas)
    inside = ((point >= low) & (point <= high)).all(axis=1)
    return Patches(point[inside], area[inside])


def _middles(count: int) -> F64:
    """Middles of the count^2 equal triangles that a triangle is cut into, as weights of its corners, shape (count^2, 3)."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(count), np.arange(count), indexing="ij"))
    upright = np.stack([i, j], axis=1)[i + j < count] + 1.0 / 3.0
    turned = np.stack([i, j], axis=1)[i + j < count - 1] + 2.0 / 3.0
    both = np.concatenate([upright, turned]) / count
    return np.column_stack([1.0 - both.sum(axis=1), both])
