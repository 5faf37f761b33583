"""Per-frame quantities of a rigid instance: energies, momentum, travel, joint gaps."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64

__all__ = ["Ledger", "velocities"]


def velocities(model: Any, data: Any) -> tuple[F64, F64]:
    """Velocities of all bodies' centres of mass and angular velocities, world axes, each (nbody, 3)."""
    angular = data.cvel[:, :3]
    arm = data.xipos - data.subtree_com[model.body_rootid]
    return data.cvel[:, 3:] + np.cross(angular, arm), angular.copy()


class Ledger:
    """Measures the state of one instance; needs positions and velocities brought up to date.

    Args:
        model: the compiled model.
        moving: MuJoCo bodies of the cache's rows.
        kinematic: whether each of them is authored; such bodies are not part of energy, momentum and mass.
    """

    def __init__(self, model: Any, moving: Any, kinematic: Any) -> None:
        self.model, self.moving = model, moving
        self.free, self.authored = moving[~kinematic], moving[kinematic]
        self._reach = np.zeros(model.nbody)
        np.maximum.at(self._reach, model.geom_bodyid, model.geom_rbound + np.linalg.norm(model.geom_pos, axis=1))

    def energy(self, data: Any, bodies: Any, speeds: tuple[F64, F64]) -> tuple[float, float]:
        """Kinetic and gravitational potential energy of some bodies [J]."""
        if not len(bodies):
            return 0.0, 0.0
        model, (linear, angular) = self.model, speeds
        mass = model.body_mass[bodies]
        spin = np.einsum("nji,nj->ni", data.ximat[bodies].reshape(-1, 3, 3), angular[bodies])
        kinetic = float(mass @ (linear[bodies] ** 2).sum(1)) + float((model.body_inertia[bodies] * spin**2).sum())
        return 0.5 * kinetic, -float(mass @ (data.xipos[bodies] @ model.opt.gravity))

    def authored_energy(self, data: Any) -> float:
        """Energy of the bodies on paths [J]: what drivers put into them is not put into the others."""
        return sum(self.energy(data, self.authored, velocities(self.model, data))) if len(self.authored) else 0.0

    def spring_energy(self, data: Any) -> float:
        """Energy stored in joint springs and tendons [J]."""
        import mujoco

        model = self.model
        if not model.jnt_stiffness.any() and not model.ntendon:
            return 0.0
        mujoco.mj_tendon(model, data)
        gravity = model.opt.gravity.copy()
        model.opt.gravity[:] = 0.0
        mujoco.mj_energyPos(model, data)
        model.opt.gravity[:] = gravity
        return float(data.energy[0])

    def joint_error(self, data: Any) -> float:
        """Largest gap of a weld or connect constraint in the last step [m]; joints of the kinematic tree are exact."""
        import mujoco

        if not data.ne:
            return 0.0
        rows = data.efc_type[: data.nefc] == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        return float(np.abs(data.efc_pos[: data.nefc][rows]).max(initial=0.0))

    def measure(self, data: Any, speeds: tuple[F64, F64], step: float) -> dict[str, float]:
        """Records of the present state; `step` [s] turns speeds into travel."""
        model, (linear, angular) = self.model, speeds
        kinetic, potential = self.energy(data, self.free, speeds)
        mass = model.body_mass[self.free]
        momentum = mass @ linear[self.free] if len(self.free) else np.zeros(3)
        surface = np.linalg.norm(linear, axis=1) + np.linalg.norm(angular, axis=1) * self._reach
        return {
            "kinetic_energy": kinetic,
            "potential_energy": potential + self.spring_energy(data),
            "momentum_x": float(momentum[0]),
            "momentum_y": float(momentum[1]),
            "momentum_z": float(momentum[2]),
            "mass": float(mass.sum()),
            "body_count": float(len(self.moving)),
            "max_speed": float(np.linalg.norm(linear[self.moving], axis=1).max(initial=0.0)),
            "max_travel_per_step": float(surface[self.moving].max(initial=0.0)) * step,
        }
