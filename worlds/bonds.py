"""Faces that the pieces of a breakable body share, with what a bond over each needs to carry load."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from .arrays import F64, I32

__all__ = ["WORLD", "Bonds", "bond_arrays", "bonds_from", "components"]

WORLD = -1
"""Stands for the world as the second piece of a bond."""


@dataclass(frozen=True)
class Bonds:
    """Bonds of one entity, b of them, in the entity's frame."""

    pieces: I32
    """Indices of the two pieces, shape (b, 2); the second is `WORLD` where the first is bonded to the world."""
    area: F64
    """[m^2], shape (b,)."""
    point: F64
    """Centroid of the face [m], shape (b, 3)."""
    frame: F64
    """Rows: normal from the first piece to the second, and the face's two principal axes, shape (b, 3, 3)."""
    second: F64
    """Second moments of area about the two principal axes [m^4], shape (b, 2)."""
    corners: F64
    """Corners of the face along its principal axes from the centroid [m], shape (b, k, 2); the last one is repeated."""
    length: F64
    """Distance of the two centres of mass along the normal [m], shape (b,)."""
    factor: F64
    """Strength in parts of the declared one, shape (b,); differs from 1 across the grain of wood."""

    def __len__(self) -> int:
        return len(self.area)


def bond_arrays(bonds: Bonds) -> dict[str, Any]:
    """Arrays of the bonds by the names of their fields."""
    return {f.name: getattr(bonds, f.name) for f in fields(Bonds)}


def bonds_from(arrays: dict[str, Any]) -> Bonds:
    """Bonds from the arrays of `bond_arrays`.

    Raises:
        KeyError: an array is missing.
        ValueError: shapes do not belong together.
    """
    found = Bonds(**{f.name: arrays[f.name] for f in fields(Bonds)})
    count = len(found.area)
    wanted = {"pieces": (count, 2), "point": (count, 3), "frame": (count, 3, 3), "second": (count, 2), "length": (count,)}
    for name, shape in wanted.items():
        if getattr(found, name).shape != shape:
            raise ValueError(f"bonds have {name} of shape {getattr(found, name).shape}, not {shape}")
    return found


def components(count: int, bonds: Bonds, whole: Any) -> tuple[I32, Any]:
    """Connected pieces.

    Args:
        count: number of pieces.
        bonds: all bonds.
        whole: which of them hold, shape (b,).

    Returns:
        Label per piece, shape (count,), numbered in the order of their first pieces; and per label whether the world holds it.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    held = np.asarray(whole, dtype=bool)
    inner = held & (bonds.pieces[:, 1] != WORLD)
    pairs = bonds.pieces[inner]
    order = np.argsort(pairs[:, 0], kind="stable")
    starts = np.concatenate([[0], np.cumsum(np.bincount(pairs[:, 0], minlength=count))])
    graph = csr_array((np.ones(len(pairs)), pairs[order, 1], starts), shape=(count, count))
    raw = connected_components(graph, directed=False)[1]
    _, first, inverse = np.unique(raw, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first, kind="stable"), kind="stable")
    labels = rank[inverse.reshape(-1)].astype(np.int32)
    fixed = np.zeros(len(first), dtype=bool)
    fixed[labels[bonds.pieces[held & ~inner, 0]]] = True
    return labels, fixed
