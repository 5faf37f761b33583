"""Preconditioner of implicit steps: the sheets at rest, along warp, along weft and across, factored once for each length of step."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from ...worlds.arrays import F64, I32
from .factor_kernels import decompose, shape_of
from .mesh import Sheet

__all__ = ["Factor", "Preconditioner", "bending_matrix"]

TAUT = 0.005
"""Own choice, measured on swinging sheets: stiffness across over stiffness along, for tension and for what small folds take over."""
BENDS = 4.0
"""Where bending adds more than this share of a vertex' mass, its neighbours count too."""
EASY = 10.0
"""Where nothing adds more than this share of a vertex' mass, no neighbours count."""
PARTS = 2
"""Lengths of step that have a factor of their own, in an octave."""


Single = npt.NDArray[np.float32]


class Factor(NamedTuple):
    """L D L^T of three matrices side by side, in the order that `precondition` takes."""

    start: I32
    row: I32
    lower: Single
    """(entries, 3)"""
    pivot: Single
    """(free vertices, 3): inverse."""


class Preconditioner:
    """Factors of the free vertices of all sheets.

    Args:
        sheets: at rest.
        free: vertices that are not held, among all.
    """

    def __init__(self, sheets: tuple[Sheet, ...], free: I32) -> None:
        self.free = free
        self.mass = np.concatenate([s.mass for s in sheets])[free]
        warp, weft, across, bend = (
            sp.block_diag(parts, format="csr") for parts in zip(*(_stiff(s) for s in sheets), strict=True)
        )
        self._parts = [m[free][:, free].tocsr() for m in (warp, weft, across, bend)]
        self._known: dict[int, Factor] = {}
        self._order: dict[bool, I32] = {}

    def factor(self, step: float) -> tuple[I32, Factor]:
        """Vertices in the order of the factor's rows, and the factor, for a step of about this length [s] (theta included)."""
        key = round(PARTS * math.log2(step))
        place = self._place(far=self._far(2.0 ** (2 * key / PARTS)))
        if key not in self._known:
            self._known[key] = self._made(step, place)
        return self.free[place].astype(np.int32), self._known[key]

    def _place(self, *, far: bool) -> I32:
        """Order of the free vertices with few entries in the factor."""
        if far not in self._order:
            pattern = abs(self._parts[0]) + abs(self._parts[2])
            if far:
                pattern = pattern + abs(self._parts[3])
            pattern = pattern + sp.diags(1.0 + np.asarray(pattern.sum(axis=1)).ravel())
            if pattern.shape[0] < 2:
                return np.arange(pattern.shape[0], dtype=np.int32)
            symbolic = splu(pattern.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
            self._order[far] = np.argsort(symbolic.perm_c).astype(np.int32)
        return self._order[far]

    def matrices(self, step: float) -> list[sp.csr_matrix]:
        """The matrices of a step of about this length [s]: mass and squared step times stiffness, of the free vertices, three times."""
        square = 2.0 ** (2 * round(PARTS * math.log2(step)) / PARTS)
        warp, weft, across, bend = self._parts
        own = bend if self._far(square) else sp.diags(bend.diagonal())
        found = [(sp.diags(self.mass) + square * (part + own)).tocsr() for part in (warp, weft, across)]
        if not any((m.diagonal() > EASY * self.mass).any() for m in found):
            found = [sp.diags(m.diagonal()).tocsr() for m in found]
        return found

    def _far(self, square: float) -> bool:
        return bool((square * self._parts[3].diagonal() > BENDS * self.mass).any())

    def _made(self, step: float, place: I32) -> Factor:
        matrices = [m[place][:, place] for m in self.matrices(step)]
        upper = [sp.triu(m).tocsc() for m in matrices]
        # One pattern for all, with zeros where one has no entry.
        pattern = sum((abs(u) for u in upper[1:]), abs(upper[0])).tocsc()
        pattern.sort_indices()
        columns = np.repeat(np.arange(pattern.shape[1]), np.diff(pattern.indptr))
        values = np.stack([np.asarray(u[pattern.indices, columns]).ravel() for u in upper], axis=1)
        start, row = pattern.indptr.astype(np.int32), pattern.indices.astype(np.int32)
        parent, count = shape_of(start, row)
        first = np.concatenate([[0], np.cumsum(count)]).astype(np.int32)
        found, lower = np.zeros(int(first[-1]), np.int32), np.zeros((int(first[-1]), 3))
        pivot = np.zeros((len(place), 3))
        decompose(start, row, values, parent, first, found, lower, pivot)
        # Single precision halves what a solve reads; conjugate gradients bear it.
        return Factor(first, found, lower.astype(np.float32), pivot.astype(np.float32))


def _stiff(sheet: Sheet) -> tuple[sp.csr_matrix, sp.csr_matrix, sp.csr_matrix, sp.csr_matrix]:
    """Scalar stiffness [N/m] of a sheet at rest: along warp, along weft, across, and of bending."""
    n, grad = len(sheet.mass), sheet.inverse_rest.reshape(-1, 2, 2).transpose(0, 2, 1)
    shape = np.concatenate([-grad.sum(axis=1, keepdims=True), grad], axis=1)
    law = sheet.modulus[:, :3] * sheet.area[:, None]

    def spread(u: F64, v: F64) -> sp.csr_matrix:
        g = shape[:, :, None, :] * shape[:, None, :, :]
        values = u[:, None, None] * g[..., 0] + v[:, None, None] * g[..., 1]
        rows, columns = np.repeat(sheet.faces, 3, axis=1).ravel(), np.tile(sheet.faces, (1, 3)).ravel()
        return sp.coo_matrix((values.ravel(), (rows, columns)), shape=(n, n)).tocsr()

    taut = TAUT * np.maximum(law[:, 0], law[:, 1])
    return (
        spread(law[:, 0], law[:, 2]),
        spread(law[:, 2], law[:, 1]),
        spread(taut, taut),
        bending_matrix(sheet, sheet.hinge_law[:, 0]),
    )


def bending_matrix(sheet: Sheet, stiffness: F64) -> sp.csr_matrix:
    """Scalar matrix (n, n) of hinges with a stiffness each."""
    w, n = sheet.hinge_weight, len(sheet.mass)
    values = stiffness[:, None, None] * w[:, :, None] * w[:, None, :]
    rows, columns = np.repeat(sheet.hinges, 4, axis=1).ravel(), np.tile(sheet.hinges, (1, 4)).ravel()
    return sp.coo_matrix((values.ravel(), (rows, columns)), shape=(n, n)).tocsr()
