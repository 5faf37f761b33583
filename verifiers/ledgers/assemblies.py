"""Which entities of a rigid instance move as one because joints or ropes tie them, and which are tied to something fixed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.bonds import WORLD
from ...worlds.spec import SpringJoint

if TYPE_CHECKING:
    from .balance import Books, Flags

__all__ = ["assemblies_of", "joined"]

SLACK = 1e-9
"""[s] Times this close are equal."""


def assemblies_of(books: Books) -> tuple[NDArray[np.int64], Flags]:
    """Label per interval and entity, shape (F - 1, E), and whether its group is tied to what does not move freely."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count, spans = len(books.entities), books.frames - 1
    links = [(p, c, books.detached.get(n, np.inf)) for n, p, c in joined(books)]
    fixed = books.free_time < books.duration - SLACK
    joints = np.zeros((spans, count), dtype=bool)
    rows, cols = [], []
    for parent, child, until in links:
        acting = np.flatnonzero(books.times[:-1] < until - SLACK)
        for side, other in ((parent, child), (child, parent)):
            if side is not None and other is None:
                joints[acting, side] = True
            elif side is not None and other is not None:
                joints[acting, side] |= fixed[acting, other]
        if parent is not None and child is not None:
            rows.append(acting * count + parent)
            cols.append(acting * count + child)
    _bonded(books, joints)
    if not rows:
        return np.arange(spans * count).reshape(spans, count), joints
    row, col = np.concatenate(rows), np.concatenate(cols)
    graph = coo_array((np.ones(len(row)), (row, col)), shape=(spans * count, spans * count))
    label = connected_components(graph, directed=False)[1].astype(np.int64)
    anchored = np.zeros(label.max(initial=0) + 1, dtype=bool)
    np.logical_or.at(anchored, label, (joints | (fixed & books.jointed)).ravel())
    return label.reshape(spans, count), anchored[label].reshape(spans, count)


def _bonded(books: Books, joints: Flags) -> None:
    """Mark breakable entities of which the world still holds a piece at an interval's start: what the world gives is not logged."""
    first = 0
    for name in books.cache.index.breakables:
        bonds = books.candidate.entity(name).bonds
        count = 0 if bonds is None else len(bonds)
        if bonds is not None and name in books.row and (bonds.pieces[:, 1] == WORLD).any():
            broken = np.asarray(books.cache.series("bond/broken"))[:-1, first : first + count]
            joints[:, books.row[name]] |= (broken[:, bonds.pieces[:, 1] == WORLD] == 0).any(axis=1)
        first += count


def joined(books: Books) -> list[tuple[str, int | None, int | None]]:
    """Joint, rows of parent and child; None for what is static or the world."""
    found: list[tuple[str, int | None, int | None]] = []
    members = set(books.cache.index.colliders) | set(books.entities)
    for name, joint in books.candidate.spec.simulation.joints.items():
        if isinstance(joint, SpringJoint) or joint.child not in members:
            continue
        found.append((name, books.row.get(joint.parent or ""), books.row.get(joint.child)))
    for name in books.entities:
        rope = books.candidate.spec.entities[name].generator
        for end in (rope.attach_start, rope.attach_end) if rope is not None else ():
            if end is not None:
                found.append((name, books.row.get(end), books.row[name]))
    return found
