"""The bonds of one entity that break under the loads on its pieces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64, cross
from ...worlds.bonds import WORLD, components
from ...worlds.categories.fracture.facts import SHARES
from .clusters import Cluster, clusters_of
from .pieces import NO_CAUSE
from .records import Break

if TYPE_CHECKING:
    from .pieces import Pieces
    from .records import Records

__all__ = ["Breaker"]

TOGETHER = 0.6
"""Bonds of the two pieces at the worst bond that are loaded to this share of it break with it. A load that grows breaks bonds
one after the other, and what it does to the others depends on those that broke; so the load of all others is found anew."""
LIGHT = 0.1
"""Where lasting loads take no bond to more than this share of its strength, a blow breaks what it breaks before they are found
anew."""
FAINT_CAUSE = 1e-3
"""Loads below this share of a piece's weight are not what breaks a bond."""


class _Steady(NamedTuple):
    """Forces in the bonds under lasting loads."""

    bonds: Any
    force: F64
    """Shape (b, 6)."""
    most: float
    """Largest share of its strength that a bond bears."""


class Breaker:
    """Breaks bonds.

    Args:
        pieces: the entity's.
        index: of the entity among the breakable members.
        gravity: [m/s^2], shape (3,).
        records: of the instance.
    """

    def __init__(self, pieces: Pieces, index: int, gravity: F64, records: Records) -> None:
        self.pieces, self._index, self._gravity, self._records = pieces, index, gravity, records
        self._weight = float(np.linalg.norm(gravity))

    def judge(self, cluster: Cluster, data: Any, time: float) -> bool:
        """Break what a cluster's load breaks; whether it fell apart.

        What the world still holds is judged again at once: what pushes it pushes no less where other pieces give way. What
        came off is pushed less, and waits for the step to be taken again.
        """
        if not self._break(cluster, data, time):
            return False
        own, todo = self.pieces, [cluster]
        while todo:
            held = set(todo.pop().pieces)
            for part in clusters_of(own.built, own.whole):
                if part.fixed and part.pieces[0] in held and self._break(part, data, time):
                    todo.append(part)
        return True

    def cause(self, cluster: Cluster) -> int:
        """Collider that pushes the cluster most; none where its own weight outdoes that."""
        rows = np.array(cluster.pieces)
        strength = np.abs(self.pieces.load[rows]).max(axis=1)
        heaviest = int(strength.argmax())
        weight = self._weight * float(self.pieces.mass[rows].mean())
        return int(self.pieces.cause[rows[heaviest]]) if strength[heaviest] > FAINT_CAUSE * weight else NO_CAUSE

    def _break(self, cluster: Cluster, data: Any, time: float) -> bool:
        """Break what the load of a cluster breaks until it falls apart; whether it does."""
        own, rows = self.pieces, np.array(cluster.pieces)
        lasting = own.lasting[rows]
        loads = np.concatenate([lasting, own.load[rows] - lasting], axis=1)
        body = int(own.ids[rows[0]])
        turn = data.xmat[body].reshape(3, 3)
        spin = np.zeros(3) if cluster.fixed else turn.T @ data.cvel[body, :3]
        total = lasting + self._own_forces(cluster, lasting, turn, spin)
        case, steady = -1, None
        shares = SHARES if np.abs(loads[:, 6:]).max(initial=0.0) > 0 else (0.0,)
        while True:
            latest = steady is None
            steady = steady or self._steady(cluster, total)
            for share in shares:
                stiffness = own.stiffness(cluster, share)
                force = steady.force[np.searchsorted(steady.bonds, stiffness.bonds)]
                if share:
                    force = force + own.network.carry(stiffness, loads[:, 6:])
                ratio, energy = own.network.limit(stiffness.faces, force)
                worst = float(ratio.max(initial=0.0))
                if worst > 1.0:
                    break
            if worst <= 1.0 and not latest:
                steady = None
                continue
            if worst <= 1.0:
                self._records.stressed(self._index, stiffness.bonds, ratio)
                own.keep(cluster, loads, worst, self._weight, time)
                return False
            ends = own.network.bonds.pieces[stiffness.bonds]
            around = np.isin(ends, [e for e in ends[int(ratio.argmax())] if e != WORLD]).any(axis=1)
            broken = np.flatnonzero(around & (ratio > 1.0) & (ratio >= TOGETHER * worst))
            if case < 0:
                case = self._records.case(self._index, rows, loads, spin)
            self._note(cluster, stiffness.bonds[broken], ratio[broken], energy[broken], case, data, time)
            own.whole[stiffness.bonds[broken]] = False
            own.drop(cluster)
            if self._fell_apart(cluster):
                return True
            if shares == (0.0,) or steady.most > LIGHT:
                steady = None

    def _steady(self, cluster: Cluster, loads: F64) -> _Steady:
        """Forces in the bonds of a cluster under lasting loads, shape (pieces, 6)."""
        network, stiffness = self.pieces.network, self.pieces.stiffness(cluster, 0.0)
        force = network.carry(stiffness, loads)
        return _Steady(stiffness.bonds, force, float(network.ratio(stiffness.faces, force).max(initial=0.0)))

    def _own_forces(self, cluster: Cluster, loads: F64, turn: F64, spin: F64) -> F64:
        """Gravity, or inertia against the loads where the cluster is free to move; cluster's pieces, shape (n, 6)."""
        rows = np.array(cluster.pieces)
        mass, inertia = self.pieces.mass[rows], self.pieces.inertia[rows]
        own = np.zeros((len(rows), 6))
        if cluster.fixed:
            own[:, :3] = mass[:, None] * (turn.T @ self._gravity)
            return own
        arm = self.pieces.centers[rows] - cluster.center
        force = loads[:, :3].sum(axis=0)
        torque = loads[:, 3:].sum(axis=0) + cross(arm, loads[:, :3]).sum(axis=0)
        turning = _skew(spin)
        gain = np.linalg.solve(cluster.inertia, torque - turning @ cluster.inertia @ spin)
        speedup = force / cluster.mass + arm @ (_skew(gain) + turning @ turning).T
        own[:, :3] = -mass[:, None] * speedup
        own[:, 3:] = -(inertia @ gain + inertia @ spin @ turning.T)
        return own

    def _fell_apart(self, cluster: Cluster) -> bool:
        own = self.pieces
        labels, fixed = components(len(own.mass), own.network.bonds, own.whole)
        mine = labels[list(cluster.pieces)]
        return bool((mine != mine[0]).any() or fixed[mine[0]] != cluster.fixed)

    def _note(self, cluster: Cluster, broken: Any, ratio: F64, energy: F64, case: int, data: Any, time: float) -> None:
        """Record bonds that break, with the energy that they hold when the growing load reaches their strength."""
        own, piece = self.pieces, cluster.pieces[0]
        body = int(own.ids[piece])
        turn = data.xmat[body].reshape(3, 3)
        origin = data.xpos[body] - turn @ own.middle[piece]
        cause, first = self.cause(cluster), int(self._records.first_bond[self._index])
        for bond, times, held in zip(broken.tolist(), ratio.tolist(), energy.tolist(), strict=True):
            at = origin + turn @ own.network.bonds.point[bond]
            self._records.broke(Break(time, first + bond, at, cause, times, held / times**2, case))


def _skew(a: F64) -> F64:
    """Matrix [a] with [a] b = a x b."""
    x, y, z = a.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
