"""Stresses in the bonds of a cluster: rigid pieces joined by elastic faces, in equilibrium with their loads.

Each face is a bed of springs of the two half pieces beside it (T. Kawai, Nuclear Engineering and Design 48 (1978) 207,
rigid-body-spring model): E A / l against opening, G A / l against sliding, E I / l against bending, G (I1 + I2) / l against
twisting. A row of such pieces carries exactly the forces and moments of a beam; how the load parts where there are several
ways follows the stiffness.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.bonds import WORLD, Bonds

if TYPE_CHECKING:
    from ...worlds.spec import Bond

__all__ = ["BondNetwork", "BondState", "Factor"]


class BondState(NamedTuple):
    """What bonds carry, one row per bond."""

    ratio: F64
    """Largest stress in parts of the strength, shape (b,)."""
    energy: F64
    """Elastic energy of the pieces beside the face [J], shape (b,)."""


class Factor(NamedTuple):
    """A factorised cluster."""

    solve: Any
    """Right-hand side -> displacements of the free pieces."""
    pieces: Any
    """Pieces of the cluster, sorted."""
    bonds: Any
    """Whole bonds of the cluster."""
    free: Any
    """Which of the cluster's pieces are unknowns: all, but one where the world holds none of them."""


def _cross(arms: F64) -> F64:
    """Matrices [r] with [r] v = r x v, shape (n, 3) -> (n, 3, 3)."""
    out = np.zeros((len(arms), 3, 3))
    x, y, z = arms.T
    out[:, 0, 1], out[:, 0, 2] = -z, y
    out[:, 1, 0], out[:, 1, 2] = z, -x
    out[:, 2, 0], out[:, 2, 1] = -y, x
    return out


class BondNetwork:
    """The pieces and bonds of one entity, in its frame.

    Args:
        bonds: its bonds.
        centers: centres of mass of the pieces [m], shape (n, 3).
        bond: strength and stiffness.
        mass: of the pieces [kg], shape (n,).
        inertia: about their centres [kg m^2], shape (n, 3, 3).
    """

    def __init__(self, bonds: Bonds, centers: F64, bond: Bond, mass: F64, inertia: F64) -> None:
        self.bonds, self.bond, self.mass, self.inertia = bonds, bond, mass, inertia
        young, shear = bond.young_modulus, bond.young_modulus / (2 * (1 + bond.poisson_ratio))
        area, second, length = bonds.area, bonds.second, bonds.length
        self.stiffness = np.stack(
            [
                young * area / length,
                shear * area / length,
                shear * area / length,
                shear * second.sum(axis=1) / length,
                young * second[:, 0] / length,
                young * second[:, 1] / length,
            ],
            axis=1,
        )
        """Against opening, two ways of sliding, twisting and two ways of bending, shape (b, 6)."""
        first, other = bonds.pieces[:, 0], np.maximum(bonds.pieces[:, 1], 0)
        axes = bonds.frame
        motion = np.zeros((len(bonds), 6, 12))
        motion[:, :3, :3], motion[:, 3:, 3:6] = -axes, -axes
        motion[:, :3, 3:6] = axes @ _cross(bonds.point - centers[first])
        held = bonds.pieces[:, 1] == WORLD
        motion[:, :3, 6:9], motion[:, 3:, 9:] = axes, axes
        motion[:, :3, 9:] = -axes @ _cross(bonds.point - centers[other])
        motion[held, :, 6:] = 0.0
        self.motion = motion
        """Relative motion over each face from the motions of its two pieces, shape (b, 6, 12)."""
        self.reach = np.linalg.norm(bonds.corners, axis=2).max(axis=1)
        """Farthest corner from the centroid [m], shape (b,)."""

    def factor(self, pieces: Any, whole: Any, *, held: bool, within: float = 0.0) -> Factor:
        """Factorise the stiffness of a connected cluster.

        Args:
            pieces: its pieces, sorted.
            whole: which of the entity's bonds hold, shape (b,).
            held: whether the world holds one of them.
            within: time in which the loads act [s]: the pieces' own inertia then carries what stiffness does not, as in one
                step of backward Euler; 0: for ever, so that only bonds carry.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.linalg import splu

        own = np.flatnonzero(np.asarray(whole, dtype=bool) & np.isin(self.bonds.pieces[:, 0], pieces))
        row = np.full(int(max(pieces)) + 1, -1)
        free = np.arange(len(pieces)) if held or within else np.arange(1, len(pieces))
        row[np.asarray(pieces)[free]] = np.arange(len(free))
        ends = self.bonds.pieces[own]
        place = np.where(ends == WORLD, -1, row[np.maximum(ends, 0)])
        motion, stiffness = self.motion[own], self.stiffness[own]
        blocks = np.einsum("bki,bk,bkj->bij", motion, stiffness, motion)
        index = np.where(place[:, :, None] >= 0, 6 * place[:, :, None] + np.arange(6), -1).reshape(len(own), 12)
        rows, columns = np.repeat(index, 12, axis=1).ravel(), np.tile(index, (1, 12)).ravel()
        inside = (rows >= 0) & (columns >= 0)
        size = 6 * len(free)
        matrix = coo_array((blocks.ravel()[inside], (rows[inside], columns[inside])), shape=(size, size)).tocsc()
        if within:
            matrix = matrix + self._inertia_over(np.asarray(pieces)[free], within)
        solved = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        return Factor(solved.solve, np.asarray(pieces), own, free)

    def _inertia_over(self, pieces: Any, within: float) -> Any:
        from scipy.sparse import block_diag

        blocks = np.zeros((len(pieces), 6, 6))
        blocks[:, :3, :3] = self.mass[pieces, None, None] * np.eye(3)
        blocks[:, 3:, 3:] = self.inertia[pieces]
        return block_diag(list(blocks / within**2), format="csc")

    def carry(self, factor: Factor, loads: F64) -> F64:
        """What the bonds of a cluster carry under loads on its pieces: opening force, two sliding forces, twisting, two
        bending moments, shape (b, 6) [N, N m].

        Args:
            factor: the cluster.
            loads: forces and torques about the pieces' centres, in the entity's frame, shape (pieces, 6) [N, N m]; where the
                world holds no piece they must be in balance, unless they act for a limited time.
        """
        moved = np.zeros((len(factor.pieces), 6))
        if len(factor.free):
            moved[factor.free] = factor.solve(loads[factor.free].ravel()).reshape(-1, 6)
        row = np.zeros(int(factor.pieces.max()) + 1, dtype=np.int64)
        row[factor.pieces] = np.arange(len(factor.pieces))
        ends = self.bonds.pieces[factor.bonds]
        both = np.concatenate([moved[row[ends[:, 0]]], moved[row[np.maximum(ends[:, 1], ends[:, 0])]]], axis=1)
        return np.asarray(self.stiffness[factor.bonds] * np.einsum("bij,bj->bi", self.motion[factor.bonds], both))

    def state(self, rows: Any, force: F64) -> BondState:
        """How near to breaking bonds are that carry this, shape (b, 6)."""
        return BondState(self.ratio(rows, force), 0.5 * (force**2 / self.stiffness[rows]).sum(axis=1))

    def limit(self, rows: Any, state: BondState) -> F64:
        """How many times bonds are loaded beyond breaking, shape (b,): in stress and, where they have a toughness, in energy."""
        if self.bond.toughness == 0:
            return state.ratio
        need = self.bond.toughness * self.bonds.area[rows]
        return np.asarray(np.minimum(state.ratio, np.sqrt(state.energy / need)))

    def ratio(self, rows: Any, force: F64) -> F64:
        """Stress over strength of bonds from what they carry, shape (b, 6)."""
        bonds, bond = self.bonds, self.bond
        area, second, corners = bonds.area[rows], bonds.second[rows], bonds.corners[rows]
        mean = force[:, 0] / area
        bending = force[:, 4, None] * corners[:, :, 1] / second[:, :1] - force[:, 5, None] * corners[:, :, 0] / second[:, 1:]
        tension = mean + bending.max(axis=1)
        shear = np.hypot(force[:, 1], force[:, 2]) / area
        shear = shear + np.abs(force[:, 3]) * self.reach[rows] / second.sum(axis=1)
        factor = bonds.factor[rows]
        held = factor * bond.shear + bond.friction * np.maximum(-mean, 0.0)
        return np.asarray(np.maximum(tension / (factor * bond.tension), shear / held))
