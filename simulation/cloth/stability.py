"""The longest step that an explicit scheme can take with a sheet."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import ArpackNoConvergence, eigsh

from ...worlds.arrays import F64, I32
from .mesh import Sheet

__all__ = ["highest_frequency", "longest_step"]

EIGEN_ERROR = 1e-3
"""Relative error of the largest eigenvalue, far within what `SAFE` leaves."""


def highest_frequency(sheet: Sheet) -> float:
    """Highest angular frequency of the sheet at rest [rad/s]: in its plane and by bending, added up as squares."""
    inner = _largest(*_membrane(sheet), np.repeat(sheet.mass, 2))
    outer = _largest(*_plate(sheet), sheet.mass) if len(sheet.hinges) and sheet.hinge_law[:, 0].any() else 0.0
    return float(np.sqrt(inner + outer))


def longest_step(frequency: float, damping: float) -> float:
    """Longest stable step [s] of central differences with velocities half a step behind, damped by `damping` times the stiffness."""
    b = damping * frequency
    return float((np.sqrt(b * b + 4.0) - b) / frequency)


def _membrane(sheet: Sheet) -> tuple[I32, F64]:
    """Degrees of freedom (t, 6) and stiffness (t, 6, 6) of the triangles in their own planes."""
    grad = sheet.inverse_rest.reshape(-1, 2, 2).transpose(0, 2, 1)
    shape = np.concatenate([-grad.sum(axis=1, keepdims=True), grad], axis=1)
    strain = np.zeros((len(sheet.faces), 3, 6))
    strain[:, 0, 0::2], strain[:, 1, 1::2] = shape[:, :, 0], shape[:, :, 1]
    strain[:, 2, 0::2], strain[:, 2, 1::2] = shape[:, :, 1], shape[:, :, 0]
    law = sheet.modulus[:, :3] * sheet.area[:, None]
    freedom = (2 * sheet.faces[:, :, None] + np.arange(2)).reshape(-1, 6)
    return freedom.astype(np.int32), np.einsum("tki,tk,tkj->tij", strain, law, strain)


def _plate(sheet: Sheet) -> tuple[I32, F64]:
    w = sheet.hinge_weight
    return sheet.hinges, sheet.hinge_law[:, 0, None, None] * w[:, :, None] * w[:, None, :]


def _largest(freedom: I32, stiffness: F64, mass: F64) -> float:
    """Largest eigenvalue of stiffness against lumped mass [1/s^2]."""
    n, k = len(mass), freedom.shape[1]
    scaled = stiffness / np.sqrt(mass[freedom][:, :, None] * mass[freedom][:, None, :])
    rows, columns = np.repeat(freedom, k, axis=1).ravel(), np.tile(freedom, (1, k)).ravel()
    matrix = sp.coo_matrix((scaled.ravel(), (rows, columns)), shape=(n, n)).tocsr()
    # Gershgorin's bound where the iteration does not close in, and for what is too small for it.
    bound = float(abs(matrix).sum(axis=1).max())
    if n < 8:
        return bound
    start = np.random.default_rng(0).standard_normal(n)
    try:
        found = float(eigsh(matrix, k=1, which="LA", return_eigenvectors=False, tol=EIGEN_ERROR, v0=start)[0])
    except ArpackNoConvergence:
        return bound
    return min(found * (1 + 2 * EIGEN_ERROR), bound)
