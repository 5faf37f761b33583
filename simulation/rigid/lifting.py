"""Lift of media on rigid bodies that declare it, as it acts over a step: it turns their flow and never feeds it (R18, R66)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...physics.lift import Hull, hull_of, stacked, wrenches
from ...worlds.arrays import F64, I64, cross
from ...worlds.errors import InputError

if TYPE_CHECKING:
    from ...physics.drag import Medium
    from ...worlds.built import BuiltEntity
    from ...worlds.spec import WorldSpec
    from .model import RigidModel

__all__ = ["Lifted", "Lifting"]

STEEPEST = 2.2
"""[1/rad] Steepest rise of a plate's normal force with the angle of attack, over that across the flow: 1.7 / 1.15 in 40 degrees."""
STIFFEST = 0.65
"""[1/rad] Steepest change of its moment about its middle, over its length: that rise at 0.3 of the length."""
TINY = 1e-300


class Lifted(NamedTuple):
    """Force and torque on n bodies over a step."""

    force: F64
    """[N], shape (n, 3)."""
    torque: F64
    """About the centres of mass [N m], shape (n, 3)."""
    rate: F64
    """Rate at which drag takes the flow past them at first [1/s], shape (n,)."""


class Lifting:
    """Bodies of an instance that lift acts on.

    Attributes:
        rows: of them, in the order of `rigid.bodies`.
    """

    def __init__(self, rigid: RigidModel, rows: I64, hulls: list[Hull], mass: F64) -> None:
        self.rigid, self.rows, self._mass = rigid, rows, mass
        self._hulls = held = stacked(hulls)
        reach = STIFFEST * held.length + STEEPEST * np.linalg.norm(held.center, axis=1)
        self._stiff: F64 = 0.5 * held.flatness * held.surface * reach
        """Steepest change of the torque with the angle to the flow, over 1/2 rho C u^2 [m^3], shape (n,)."""

    @classmethod
    def of(
        cls, spec: WorldSpec, rigid: RigidModel, built: Mapping[str, BuiltEntity], rows: list[int], mass: F64
    ) -> Lifting | None:
        """Those among `rows` whose entities declare it; None where none does.

        Raises:
            InputError: the parts of one of them enclose nothing.
        """
        hulls: dict[int, Hull] = {}
        for row in rows:
            entity, body = rigid.bodies[row].split("/", 1)
            if not spec.entities[entity].physics.lifted:
                continue
            parts = built[entity].parts_of(body)
            hull = hull_of(np.concatenate([p.render.vertices for p in parts]), rigid.centers[row]) if parts else None
            if hull is None:
                raise InputError(
                    f"entity {entity!r}: lift acts on the hull of body {body!r}, and its parts enclose nothing; set physics/lift to false"
                )
            hulls[row] = hull
        order = sorted(hulls)
        return cls(rigid, np.array(order, dtype=np.int64), [hulls[r] for r in order], mass[order]) if order else None

    def act(self, data: Any, rows: I64, medium: Medium, motion: tuple[F64, F64], dt: float) -> Lifted:
        """Push of a medium on some of them.

        The flow past a body is slowed by drag and turned by lift, each as it would over the step if it went on as it began: the
        first implicitly, the second by an angle, so that what is left is never faster. Torques are divided by one plus what their
        steepest change with the turn would give back within the step.

        Args:
            data: the present state.
            rows: of them, in order.
            medium: at their centres of mass.
            motion: velocities of all bodies [m/s] and spins [rad/s], each shape (bodies, 3).
            dt: step [s].
        """
        which, ids = np.searchsorted(self.rows, rows), self.rigid.body_ids[rows]
        hulls, mass, (velocity, spin) = self._hulls.of(which), self._mass[which], (m[rows] for m in motion)
        turns, pressure = data.xmat[ids].reshape(-1, 3, 3), 0.5 * medium.density * medium.coefficient
        found = wrenches(hulls, turns, medium.velocity - velocity, spin, pressure)
        speed = np.linalg.norm(found.flow, axis=1)
        way = found.flow / np.maximum(speed, TINY)[:, None]
        along = (found.force * way).sum(axis=1)
        across = found.force - along[:, None] * way
        lift = np.linalg.norm(across, axis=1)
        slow = np.maximum(mass * speed, TINY)
        turn = 2.0 * np.arctan(0.5 * dt * lift / slow)
        left = (speed / (1.0 + dt * along / slow))[:, None] * (
            np.cos(turn)[:, None] * way - (np.sin(turn) / np.maximum(lift, TINY))[:, None] * across
        )
        force = (mass / dt)[:, None] * (found.flow - left)
        arm = np.einsum("nij,nj->ni", turns, hulls.center)
        torque = found.torque - cross(arm, found.force) + cross(arm, force)
        torque -= np.einsum("nij,nj->ni", found.resistance, spin)
        given_back = dt * found.resistance + (dt**2 * pressure * speed**2 * self._stiff[which])[:, None, None] * np.eye(3)
        return Lifted(force, _limited(self._inertia(data, ids), given_back, torque), along / slow)

    def _inertia(self, data: Any, ids: I64) -> F64:
        """Inertia of the bodies about their centres of mass, world axes [kg m^2], shape (n, 3, 3)."""
        axes = data.ximat[ids].reshape(-1, 3, 3)
        return np.asarray(np.einsum("nij,nj,nkj->nik", axes, self.rigid.model.body_inertia[ids], axes))


def _limited(inertia: F64, given_back: F64, torque: F64) -> F64:
    """Torques over a step that gives back so much of a spin that it gains, per that spin [kg m^2], shape (n, 3)."""
    return np.asarray(np.einsum("nij,nj->ni", inertia, np.linalg.solve(inertia + given_back, torque[:, :, None])[:, :, 0]))
