"""Energies and stretch of sheets, for records."""

from __future__ import annotations

import numpy as np

from ...worlds.arrays import F64
from .mesh import Sheet

__all__ = ["bending_energy", "edge_ratios", "membrane_energy"]


def membrane_energy(sheet: Sheet, x: F64) -> float:
    """Energy of stretch and shear [J] with vertices at x (n, 3)."""
    p, q = x[sheet.faces[:, 1]] - x[sheet.faces[:, 0]], x[sheet.faces[:, 2]] - x[sheet.faces[:, 0]]
    r = sheet.inverse_rest[:, :, None]
    u, v = r[:, 0] * p + r[:, 1] * q, r[:, 2] * p + r[:, 3] * q
    lu, lv = np.linalg.norm(u, axis=1), np.linalg.norm(v, axis=1)
    shear = (u * v).sum(1) / np.maximum(lu * lv, 1e-30)
    k = sheet.modulus
    return float(0.5 * sheet.area @ (k[:, 0] * (lu - 1) ** 2 + k[:, 1] * (lv - 1) ** 2 + k[:, 2] * shear**2))


def bending_energy(sheet: Sheet, x: F64) -> float:
    """Energy of the hinges [J]."""
    if len(sheet.hinges) == 0:
        return 0.0
    corner = x[sheet.hinges]
    s = np.einsum("hk,hkj->hj", sheet.hinge_weight, corner)
    x0 = corner[:, 0]
    normal = np.cross(corner[:, 1] - x0, corner[:, 2] - x0) + np.cross(corner[:, 3] - x0, corner[:, 1] - x0)
    rest = sheet.hinge_law[:, 1] * np.where((s * normal).sum(1) < 0, -1.0, 1.0)
    return float(0.5 * sheet.hinge_law[:, 0] @ (np.linalg.norm(s, axis=1) - rest) ** 2)


def edge_ratios(sheet: Sheet, x: F64) -> F64:
    """Lengths of all edges over those at rest, (e,)."""
    return np.asarray(np.linalg.norm(x[sheet.edges[:, 0]] - x[sheet.edges[:, 1]], axis=1) / sheet.edge_length)
