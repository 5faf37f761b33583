"""Pieces that are still bonded to one another: one rigid body each, at rest where the world holds one of them."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.bonds import WORLD, components

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...worlds.built import BuiltEntity

__all__ = ["Cluster", "clusters_of", "elimination", "matter"]


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
_found: deque[tuple[BuiltEntity, bytes, list[Cluster]]] = deque(maxlen=8)
"""The latest clusters: model and loads are made of the same ones."""


def matter(built: BuiltEntity) -> tuple[F64, F64, F64]:
    """Masses (n,), centres in the entity's frame (n, 3) and inertias (n, 3, 3) of the pieces."""
    found = next((own for entity, own in _known if entity is built), None)
    if found is None:
        mass = np.array([b.mass for b in built.bodies])
        middle = np.array([b.pose.apply(b.center[None])[0] for b in built.bodies])
        found = mass, middle, np.array([b.inertia for b in built.bodies])
        _known.append((built, found))
    return found


def clusters_of(built: BuiltEntity, whole: Any) -> list[Cluster]:
    """Clusters of a breakable entity whose bonds `whole`, shape (b,), hold; in the order of their first pieces."""
    key = np.asarray(whole, dtype=bool).tobytes()
    found = next((clusters for entity, bonds, clusters in _found if entity is built and bonds == key), None)
    if found is None:
        found = _clusters(built, whole)
        _found.append((built, key, found))
    return list(found)


def _clusters(built: BuiltEntity, whole: Any) -> list[Cluster]:
    assert built.bonds is not None
    labels, fixed = components(len(built.bodies), built.bonds, whole)
    mass, middle, own = matter(built)
    order = np.argsort(labels, kind="stable")
    pieces = np.split(order, np.cumsum(np.bincount(labels))[:-1])
    total = np.bincount(labels, weights=mass)
    center = np.zeros((len(fixed), 3))
    np.add.at(center, labels, mass[:, None] * middle)
    center /= total[:, None]
    arm = middle - center[labels]
    square = np.einsum("ni,ni->n", arm, arm)
    about = own + (mass * square)[:, None, None] * np.eye(3) - mass[:, None, None] * arm[:, :, None] * arm[:, None, :]
    inertia = np.zeros((len(fixed), 3, 3))
    np.add.at(inertia, labels, about)
    return [
        Cluster(
            built.entity,
            f"{built.entity}/{built.bodies[own_pieces[0]].name}",
            tuple(own_pieces.tolist()),
            bool(held),
            float(total[k]),
            center[k],
            inertia[k],
        )
        for k, (held, own_pieces) in enumerate(zip(fixed.tolist(), pieces, strict=True))
    ]


def elimination(built: BuiltEntity, clusters: Sequence[Cluster]) -> list[int]:
    """The clusters that move, in an order in which a factorisation of what they do to those that they touched stays sparse.

    Minimum degree, of contacts between neighbours of the whole body: most pieces of a broken wall still lie where they were. What
    is far from its first neighbours costs a little more, and the order follows from the bonds alone.
    """
    from scipy.sparse import coo_array, eye_array
    from scipy.sparse.linalg import splu

    assert built.bonds is not None
    row = np.full(len(built.bodies), -1, dtype=np.int64)
    free = [k for k, c in enumerate(clusters) if not c.fixed]
    for k, own in enumerate(free):
        row[list(clusters[own].pieces)] = k
    ends = row[built.bonds.pieces[built.bonds.pieces[:, 1] != WORLD]]
    ends = ends[(ends >= 0).all(axis=1) & (ends[:, 0] != ends[:, 1])]
    if not len(ends):
        return free
    both = np.concatenate([ends, ends[:, ::-1]]).T
    count = len(free)
    graph = coo_array((np.full(both.shape[1], -1.0), (both[0], both[1])), shape=(count, count))
    # Only the pattern matters; a large diagonal keeps the factorisation from failing.
    graph = graph + (len(ends) + 1.0) * eye_array(count)
    found = splu(graph.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return [free[k] for k in np.argsort(found.perm_c)]
