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
    from .stiffness import Stiffness

__all__ = ["BondNetwork", "Faces"]


class Faces(NamedTuple):
    """Some bonds, one row each."""

    pieces: Any
    motion: F64
    """From the motions of the two pieces to what the bond carries, shape (b, 6, 12)."""
    compliance: F64
    """Half the inverse stiffness, shape (b, 6)."""
    area: F64
    corners: F64
    """Stress at each corner per bending moment [1/m^3], shape (b, k, 2)."""
    reach: F64
    """Shear stress at the farthest corner per twisting moment [1/m^3], shape (b,)."""
    tension: F64
    """Strength [Pa], shape (b,)."""
    shear: F64


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
        self.rooted: F64 = np.sqrt(self.stiffness)[:, :, None] * motion
        """The same times the roots of the stiffness, shape (b, 6, 12)."""
        self.blocks: F64 = self.rooted.transpose(0, 2, 1) @ self.rooted
        """Stiffness of each bond between its two pieces, shape (b, 12, 12)."""
        # Stress at the corners per bending moment.
        corners = [bonds.corners[:, :, 1] / bonds.second[:, :1], -bonds.corners[:, :, 0] / bonds.second[:, 1:]]
        self._faces = Faces(
            pieces=bonds.pieces,
            motion=self.stiffness[:, :, None] * motion,
            compliance=0.5 / self.stiffness,
            area=bonds.area,
            corners=np.stack(corners, axis=2),
            reach=np.linalg.norm(bonds.corners, axis=2).max(axis=1) / bonds.second.sum(axis=1),
            tension=bonds.factor * bond.tension,
            shear=bonds.factor * bond.shear,
        )

    def faces(self, rows: Any) -> Faces:
        """Data of some bonds from which their forces follow."""
        return Faces(*(values[rows] for values in self._faces))

    def carry(self, stiffness: Stiffness, loads: F64) -> F64:
        """Forces in the bonds of a cluster under loads on its pieces: opening force, two sliding forces, twisting, two
        bending moments, shape (b, 6) [N, N m].

        Args:
            stiffness: the cluster's.
            loads: forces and torques about the pieces' centres, in the entity's frame, shape (pieces, 6) [N, N m]; where the
                world holds no piece they must be in balance, unless they act for a limited time.
        """
        moved = np.zeros((len(self.mass) + 1, 6))
        moved[stiffness.pieces] = stiffness.moved(loads)
        # What is bonded to the world has no second piece: the last row stays at rest.
        both = moved[stiffness.faces.pieces].reshape(-1, 12, 1)
        return np.asarray((stiffness.faces.motion @ both)[:, :, 0])

    def limit(self, faces: Faces, force: F64) -> tuple[F64, F64]:
        """Factor by which bonds that carry this, shape (b, 6), are loaded beyond breaking, shape (b,): in stress and, where they
        have a toughness, in energy; and the elastic energy of the pieces beside the faces [J], shape (b,)."""
        ratio = self.ratio(faces, force)
        energy = (force**2 * faces.compliance).sum(axis=1)
        if self.bond.toughness > 0:
            ratio = np.minimum(ratio, np.sqrt(energy / (self.bond.toughness * faces.area)))
        return ratio, energy

    def ratio(self, faces: Faces, force: F64) -> F64:
        """Stress over strength of bonds from what they carry, shape (b, 6)."""
        mean = force[:, 0] / faces.area
        tension = mean + (faces.corners @ force[:, 4:, None])[:, :, 0].max(axis=1)
        shear = np.sqrt(force[:, 1] ** 2 + force[:, 2] ** 2) / faces.area + np.abs(force[:, 3]) * faces.reach
        held = faces.shear + self.bond.friction * np.maximum(-mean, 0.0)
        return np.asarray(np.maximum(tension / faces.tension, shear / held))
