"""Pieces that are still bonded to one another: one rigid body each, at rest where the world holds one of them."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.bonds import components

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity

__all__ = ["Cluster", "clusters_of"]


@dataclass(frozen=True)
class Cluster:
    """Mass properties in the entity's frame; the cluster's own frame has its axes and stands in its centre of mass."""

    entity: str
    name: str
    """`entity/` and its first piece: name of its body in the model."""
    pieces: tuple[int, ...]
    fixed: bool
    mass: float
    """[kg]"""
    center: F64
    """[m], shape (3,)."""
    inertia: F64
    """About the centre of mass [kg m^2], shape (3, 3)."""


_known: deque[tuple[BuiltEntity, tuple[F64, F64, F64]]] = deque(maxlen=8)
"""Mass, centre and inertia of the pieces of the latest entities: clusters are found anew at every break."""


def _matter(built: BuiltEntity) -> tuple[F64, F64, F64]:
    """Masses (n,), centres in the entity's frame (n, 3) and inertias (n, 3, 3) of the pieces."""
    found = next((matter for entity, matter in _known if entity is built), None)
    if found is None:
        mass = np.array([b.mass for b in built.bodies])
        middle = np.array([b.pose.apply(b.center[None])[0] for b in built.bodies])
        found = mass, middle, np.array([b.inertia for b in built.bodies])
        _known.append((built, found))
    return found


def clusters_of(built: BuiltEntity, whole: Any) -> list[Cluster]:
    """Clusters of a breakable entity whose bonds `whole`, shape (b,), hold; in the order of their first pieces."""
    assert built.bonds is not None
    labels, fixed = components(len(built.bodies), built.bonds, whole)
    mass, middle, own = _matter(built)
    found = []
    for label, held in enumerate(fixed.tolist()):
        pieces = np.flatnonzero(labels == label)
        total = float(mass[pieces].sum())
        center = mass[pieces] @ middle[pieces] / total
        arm = middle[pieces] - center
        square = np.einsum("ni,ni->n", arm, arm)
        inertia = own[pieces].sum(axis=0) + (mass[pieces] @ square) * np.eye(3) - (mass[pieces, None] * arm).T @ arm
        name = f"{built.entity}/{built.bodies[pieces[0]].name}"
        found.append(Cluster(built.entity, name, tuple(pieces.tolist()), bool(held), total, center, inertia))
    return found
