"""Stress in bonds, found from what construction wrote and the cache tells: by the judge, for the judge.

Unknowns are the small motions of the pieces. Each whole bond is six springs between the halves it joins (opening, two ways of
sliding, twisting, two ways of bending), written as rows of one matrix; the stiffness is that matrix squared.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....worlds.arrays import F64
from ....worlds.bonds import WORLD
from ....worlds.categories.fracture.facts import SHARES

if TYPE_CHECKING:
    from ....worlds.bonds import Bonds
    from ....worlds.built import BuiltEntity
    from ....worlds.spec import Bond

__all__ = ["Loaded", "stress_ratios"]


class Loaded:
    """One entity's pieces as a structure.

    Args:
        built: the entity.
        bond: strength and stiffness.
    """

    def __init__(self, built: BuiltEntity, bond: Bond) -> None:
        assert built.bonds is not None
        self.bonds: Bonds = built.bonds
        self.bond = bond
        self.centers: F64 = np.array([b.pose.apply(b.center[None])[0] for b in built.bodies])
        self.mass: F64 = np.array([b.mass for b in built.bodies])
        self.inertia: F64 = np.array([b.inertia for b in built.bodies])
        young, shear = bond.young_modulus, bond.young_modulus / (2.0 + 2.0 * bond.poisson_ratio)
        area, second = self.bonds.area, self.bonds.second
        per = [young * area, shear * area, shear * area, shear * second.sum(1), young * second[:, 0], young * second[:, 1]]
        self.stiffness: F64 = np.stack(per, axis=1) / self.bonds.length[:, None]

    def ratios(self, pieces: Any, whole: Any, lasting: F64, sudden: F64) -> tuple[Any, F64]:
        """Bonds of a connected cluster and their stress over strength, with what toughness takes off: shape (b,), and (t, b) at each
        share of the contact time.

        Args:
            pieces: of the cluster.
            whole: which bonds of the entity hold, shape (b,).
            lasting: loads on its pieces that are in equilibrium, shape (n, 6); unbalanced ones are met by acceleration.
            sudden: loads that the pieces' inertia meets within the contact time, shape (n, 6).
        """
        own = np.flatnonzero(np.asarray(whole, dtype=bool) & np.isin(self.bonds.pieces[:, 0], pieces))
        if not len(own):
            return own, np.zeros((1, 0))
        gaps = self._gaps(own, pieces)
        held = bool((self.bonds.pieces[own, 1] == WORLD).any())
        force = self._forces(own, gaps, lasting, held, 0.0)
        if np.abs(sudden).max(initial=0.0) == 0:
            return own, self._over(own, force)[None]
        times = [share * self.bond.contact_time for share in SHARES]
        both = [self._over(own, force + self._forces(own, gaps, sudden, held, t, pieces)) for t in times]
        return own, np.array(both)

    def _over(self, own: Any, force: F64) -> F64:
        """Stress over strength, or the root of energy over toughness where that is less."""
        found = stress_ratios(self.bonds, self.bond, own, force)
        if self.bond.toughness > 0:
            energy = 0.5 * (force**2 / self.stiffness[own]).sum(axis=1)
            found = np.minimum(found, np.sqrt(energy / (self.bond.toughness * self.bonds.area[own])))
        return found

    def _gaps(self, own: Any, pieces: Any) -> Any:
        """Matrix from motions of the pieces to relative motions over the bonds, shape (6 b, 6 n)."""
        from scipy.sparse import csr_array

        column = {int(p): 6 * k for k, p in enumerate(pieces)}
        rows, columns, values = [], [], []
        for k, bond in enumerate(own.tolist()):
            axes, point = self.bonds.frame[bond], self.bonds.point[bond]
            for piece, sign in zip(self.bonds.pieces[bond].tolist(), (-1.0, 1.0), strict=True):
                if piece == WORLD:
                    continue
                block = np.zeros((6, 6))
                block[:3, :3] = block[3:, 3:] = sign * axes
                # A turn w moves the face by w x r = -(r x w).
                block[:3, 3:] = -sign * np.cross(point - self.centers[piece], axes) * -1.0
                i, j = np.nonzero(block)
                rows.append(6 * k + i)
                columns.append(column[piece] + j)
                values.append(block[i, j])
        shape = (6 * len(own), 6 * len(pieces))
        return csr_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=shape)

    def _forces(self, own: Any, gaps: Any, loads: F64, held: bool, within: float, pieces: Any = None) -> F64:
        from scipy.sparse import block_diag, diags_array
        from scipy.sparse.linalg import spsolve

        springs = diags_array(self.stiffness[own].ravel())
        matrix = gaps.T @ springs @ gaps
        if within > 0:
            blocks = []
            for p in pieces:
                block = np.zeros((6, 6))
                block[:3, :3], block[3:, 3:] = self.mass[p] * np.eye(3), self.inertia[p]
                blocks.append(block / within**2)
            matrix = matrix + block_diag(blocks)
        elif not held:
            # A free cluster may move as one; its loads are balanced, so that holding one piece changes no bond.
            grip = np.zeros(matrix.shape[0])
            grip[:6] = float(matrix.diagonal().max())
            matrix = matrix + diags_array(grip)
        moved = spsolve(matrix.tocsc(), loads.ravel())
        return np.asarray(self.stiffness[own] * (gaps @ moved).reshape(-1, 6))

    def balanced(self, pieces: Any, contact: F64, spin: F64) -> F64:
        """Contact loads on a free cluster with the inertia that balances them, shape (n, 6)."""
        mass, inertia = self.mass[pieces], self.inertia[pieces]
        middle = mass @ self.centers[pieces] / mass.sum()
        arm = self.centers[pieces] - middle
        whole = inertia.sum(axis=0)
        for m, r in zip(mass, arm, strict=True):
            whole = whole + m * (float(r @ r) * np.eye(3) - np.outer(r, r))
        push = contact[:, :3].sum(axis=0) / mass.sum()
        torque = contact[:, 3:].sum(axis=0) + np.cross(arm, contact[:, :3]).sum(axis=0)
        turn = np.linalg.solve(whole, torque - np.cross(spin, whole @ spin))
        own = contact.copy()
        own[:, :3] -= mass[:, None] * (push + np.cross(turn, arm) + np.cross(spin, np.cross(spin, arm)))
        own[:, 3:] -= inertia @ turn + np.cross(spin, inertia @ spin)
        return own


def stress_ratios(bonds: Bonds, bond: Bond, own: Any, force: F64) -> F64:
    """Stress over strength of bonds that carry opening, sliding, twisting and bending, shape (b, 6) -> (b,)."""
    worst = np.zeros(len(own))
    for k, row in enumerate(own.tolist()):
        area, (about_1, about_2) = bonds.area[row], bonds.second[row]
        corners = bonds.corners[row]
        normal = force[k, 0] / area + force[k, 4] * corners[:, 1] / about_1 - force[k, 5] * corners[:, 0] / about_2
        sliding = float(np.hypot(*force[k, 1:3])) / area
        sliding += abs(force[k, 3]) * float(np.hypot(*corners.T).max()) / (about_1 + about_2)
        pressed = max(0.0, -force[k, 0] / area)
        strength = bonds.factor[row]
        worst[k] = max(
            float(normal.max()) / (strength * bond.tension), sliding / (strength * bond.shear + bond.friction * pressed)
        )
    return worst
