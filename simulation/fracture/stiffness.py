"""The stiffness of one cluster, which follows the bonds that the cluster loses.

A factorisation is kept while bonds break: K' = K - V V^T with six columns per lost bond, and K' x = b by the identity of Sherman,
Morrison and Woodbury (W. W. Hager, SIAM Review 31 (1989) 221). A lost bond costs six solutions, a factorisation of 500 pieces a
hundred.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.bonds import WORLD

if TYPE_CHECKING:
    from .network import BondNetwork

__all__ = ["Stiffness"]

MOST_LOST = 24
"""Lost bonds after which a new factorisation is cheaper."""
DENSE = 40
"""Pieces up to which a dense factorisation is cheaper than a sparse one."""


class Stiffness:
    """Stiffness of a connected cluster.

    Args:
        network: pieces and bonds of the entity.
        pieces: of the cluster, sorted.
        whole: which of the entity's bonds hold, shape (b,).
        held: whether the world holds one of the pieces.
        within: time in which the loads act [s]: the pieces' own inertia then carries what stiffness does not, as in one step of
            backward Euler; 0: for ever, so that only bonds carry.
    """

    def __init__(self, network: BondNetwork, pieces: Any, whole: Any, *, held: bool, within: float = 0.0) -> None:
        self._network, self._within = network, within
        self.pieces = self._base = np.asarray(pieces, dtype=np.int64)
        self.bonds = self._known = np.flatnonzero(np.asarray(whole, dtype=bool) & np.isin(network.bonds.pieces[:, 0], pieces))
        """Whole bonds of the cluster."""
        self.faces = network.faces(self.bonds)
        self.held = held
        # Where neither the world nor inertia holds it, one piece stays where it is.
        self._ground = -1 if held or within else int(self._base[0])
        free = self._base[self._base != self._ground]
        self._row = np.full(len(network.mass), len(free), dtype=np.int64)
        self._row[free] = np.arange(len(free))
        self._size = len(free)
        self._solve = _factorised(self._blocks(), self._size) if len(free) else None
        self._lost = np.zeros(0, dtype=np.int64)
        self._answers: F64 = np.zeros((6 * self._size, 0))
        """K^-1 V."""
        self._capacity: F64 = np.zeros((0, 0))
        """(1 - V^T K^-1 V)^-1."""

    def _blocks(self) -> tuple[F64, F64, Any]:
        """Stiffness of each piece against itself (n, 6, 6), and off the diagonal (m, 6, 6) with rows and columns (2, m)."""
        network, ends = self._network, self._rows(self._known)
        blocks = network.blocks[self._known]
        own = np.zeros((self._size + 1, 6, 6))
        np.add.at(own, ends[:, 0], blocks[:, :6, :6])
        np.add.at(own, ends[:, 1], blocks[:, 6:, 6:])
        if self._within:
            free = self._base
            own[: self._size, [0, 1, 2], [0, 1, 2]] += network.mass[free, None] / self._within**2
            own[: self._size, 3:, 3:] += network.inertia[free] / self._within**2
        inner = (ends < self._size).all(axis=1)
        pairs = np.concatenate([ends[inner], ends[inner][:, ::-1]]).T
        return own[: self._size], np.concatenate([blocks[inner, :6, 6:], blocks[inner, 6:, :6]]), pairs

    def _rows(self, bonds: Any) -> Any:
        """Rows of the unknowns at both ends of bonds, the number of unknowns where nothing moves, shape (m, 2)."""
        ends = self._network.bonds.pieces[bonds]
        return np.where(ends == WORLD, self._size, self._row[np.maximum(ends, 0)])

    def follow(self, pieces: Any, whole: Any) -> bool:
        """Be the stiffness of what is left of the cluster; whether it can, and is not better made anew."""
        pieces = np.asarray(pieces, dtype=np.int64)
        if len(pieces) == len(self.pieces) and np.asarray(whole)[self.bonds].all():
            return True  # bonds never heal
        if self._ground >= 0 and self._ground not in pieces:
            return False
        present = np.zeros(len(self._network.mass) + 1, dtype=bool)
        present[pieces] = True
        ends = self._network.bonds.pieces[self._known]
        inside = present[ends] | (ends == WORLD)
        holds = np.asarray(whole, dtype=bool)[self._known]
        gone = np.isin(self._known, self._lost)
        lose = present[ends].any(axis=1) & ~holds & ~gone
        across = lose & ~inside.all(axis=1)
        if not self._within and across.any():
            lose &= ~self._carried(across, ends, present, gone)
        if len(self._lost) + lose.sum() > MOST_LOST:
            return False
        self._lose(self._known[lose])
        bonds = self._known[holds & inside.all(axis=1)]
        if len(bonds) != len(self.bonds):
            self.faces = self._network.faces(bonds)
        self.pieces, self.bonds = pieces, bonds
        return True

    def _carried(self, across: Any, ends: Any, present: Any, gone: Any) -> Any:
        """Broken bonds to pieces that came off which are left in: one per group of those that nothing else holds.

        Such a group bears no load, so that a single bond to it carries nothing; without one it would be free to move.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        count = len(present) - 1
        outside = ~present[ends] & (ends != WORLD)
        pairs = ends[outside.all(axis=1) & ~gone]
        graph = coo_array((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
        label = connected_components(graph, directed=False)[1]
        fast = outside[:, 0] & (ends[:, 1] == WORLD) & ~gone
        anchored = np.zeros(count, dtype=bool)
        anchored[label[ends[fast, 0]]] = True
        kept = np.zeros(len(across), dtype=bool)
        bonds = np.flatnonzero(across)
        groups = label[np.where(outside[bonds, 0], ends[bonds, 0], ends[bonds, 1])]
        _, first = np.unique(groups, return_index=True)
        first = first[~anchored[groups[first]]]
        kept[bonds[first]] = True
        return kept

    def _lose(self, bonds: Any) -> None:
        if not len(bonds):
            return
        self._lost = np.concatenate([self._lost, bonds])
        index = self._index(bonds)
        columns = np.zeros((6 * self._size + 6, 6 * len(bonds)))
        for k, bond in enumerate(bonds.tolist()):
            columns[index[k], 6 * k : 6 * k + 6] = self._network.rooted[bond].T
        assert self._solve is not None
        found = self._solve(columns[:-6])
        self._answers = np.concatenate([self._answers, found], axis=1)
        self._capacity = np.asarray(np.linalg.inv(np.eye(self._answers.shape[1]) - self._over(self._answers)), dtype=np.float64)

    def _index(self, bonds: Any) -> Any:
        """Unknowns at both ends of bonds, shape (m, 12); the last six stand for what does not move."""
        return (6 * self._rows(bonds)[:, :, None] + np.arange(6)).reshape(-1, 12)

    def _over(self, moved: F64) -> F64:
        """V^T times motions, shape (6 n, ...) -> (6 lost, ...)."""
        padded = np.concatenate([moved, np.zeros((6, *moved.shape[1:]))])
        found = np.einsum("bki,bi...->bk...", self._network.rooted[self._lost], padded[self._index(self._lost)])
        return np.asarray(found.reshape(-1, *moved.shape[1:]))

    def moved(self, loads: F64) -> F64:
        """Motions of the cluster's pieces under loads on them, shape (n, 6)."""
        if self._solve is None:
            return np.zeros_like(loads)
        whole = np.zeros((self._size + 1, 6))
        whole[self._row[self.pieces]] = loads
        found = self._solve(whole[:-1].ravel())
        if len(self._lost):
            found = found + self._answers @ (self._capacity @ self._over(found))
        whole[:-1], whole[-1] = found.reshape(-1, 6), 0.0
        return np.asarray(whole[self._row[self.pieces]])


def _factorised(blocks: tuple[F64, F64, Any], size: int) -> Any:
    """Loads -> motions for a symmetric positive definite matrix of blocks."""
    own, others, (rows, columns) = blocks
    if size <= DENSE:
        from scipy.linalg import cho_factor, cho_solve

        full = np.zeros((size, size, 6, 6))
        np.add.at(full, (rows, columns), others)
        full[np.arange(size), np.arange(size)] += own
        factor = cho_factor(full.transpose(0, 2, 1, 3).reshape(6 * size, 6 * size), check_finite=False)
        return lambda load: cho_solve(factor, load, check_finite=False)
    from scipy.sparse import bsr_array
    from scipy.sparse.linalg import splu

    order = np.argsort(rows, kind="stable")
    place = np.concatenate([np.arange(size), rows[order]])
    sort = np.argsort(place, kind="stable")
    data = np.concatenate([own, others[order]])[sort]
    column = np.concatenate([np.arange(size), columns[order]])[sort]
    starts = np.concatenate([[0], np.cumsum(np.bincount(place, minlength=size))])
    matrix = bsr_array((data, column, starts), shape=(6 * size, 6 * size)).tocsc()
    matrix.sum_duplicates()
    found = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return found.solve
