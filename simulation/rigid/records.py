"""Per-frame quantities of a rigid instance: energies, momentum, travel, joint gaps."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64

__all__ = ["Ledger", "velocities"]

BATCH = 256
"""Steps after which what was copied is evaluated, so that a frame of many steps needs no memory."""


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
        count: rows of the cache; pieces that are bonded to one another share a body.
        arms: how far the rows of each of `moving` lie from its centre of mass at most [m]: pieces turn about that of all.
    """

    def __init__(self, model: Any, moving: Any, kinematic: Any, count: int, arms: F64) -> None:
        self.model, self.moving, self.count, self._row_arms = model, moving, count, arms
        self.free = moving[~kinematic]
        reach = np.zeros(model.nbody)
        np.maximum.at(reach, model.geom_bodyid, model.geom_rbound + np.linalg.norm(model.geom_pos, axis=1))
        self._reach = reach[moving]
        roots = np.bincount(model.body_rootid[1:], minlength=model.nbody)
        self._articulated = bool((roots[model.body_rootid[moving]] > 1).any())
        self.begin()

    def begin(self) -> None:
        """Start a frame: no step of it is seen yet."""
        self._twists: list[Any] = []
        self._arms: list[Any] = []
        self._speed, self._surface = 0.0, 0.0

    def take_over(self, other: Ledger) -> None:
        """Go on with a frame that another ledger, of the model before, has begun."""
        other._evaluate()
        self._speed, self._surface = other._speed, other._surface

    def watch(self, data: Any) -> None:
        """Copy the velocities of a step's beginning; once per step and at the end of the frame."""
        self._twists.append(data.cvel.copy())
        if self._articulated:
            self._arms.append(data.xipos - data.subtree_com[self.model.body_rootid])
        if len(self._twists) >= BATCH:
            self._evaluate()

    def _evaluate(self) -> None:
        """Turn the copied steps into the largest speeds of the frame; a NaN stays one.

        Nothing is left to do where the last copy has just filled a batch, or no step was copied yet.
        """
        if not self._twists:
            return
        twists = np.stack(self._twists)[:, self.moving]
        angular, linear = twists[..., :3], twists[..., 3:]
        if self._articulated:
            linear = linear + np.cross(angular, np.stack(self._arms)[:, self.moving])
        speed, turning = np.linalg.norm(linear, axis=-1), np.linalg.norm(angular, axis=-1)
        surface = speed + turning * self._reach
        self._speed = float(np.maximum(self._speed, (speed + turning * self._row_arms).max(initial=0.0)))
        self._surface = float(np.maximum(self._surface, surface.max(initial=0.0)))
        self._twists, self._arms = [], []

    def energy(self, data: Any, bodies: Any, speeds: tuple[F64, F64]) -> tuple[float, float]:
        """Kinetic and gravitational potential energy of some bodies [J]."""
        if not len(bodies):
            return 0.0, 0.0
        model, (linear, angular) = self.model, speeds
        mass = model.body_mass[bodies]
        spin = np.einsum("nji,nj->ni", data.ximat[bodies].reshape(-1, 3, 3), angular[bodies])
        kinetic = float(mass @ (linear[bodies] ** 2).sum(1)) + float((model.body_inertia[bodies] * spin**2).sum())
        return 0.5 * kinetic, -float(mass @ (data.xipos[bodies] @ model.opt.gravity))

    def spring_energy(self, data: Any) -> float:
        """Energy stored in joint springs and tendons [J]."""
        import mujoco

        model = self.model
        if not model.jnt_stiffness.any() and not model.ntendon:
            return 0.0
        # Where bodies may sleep the engine leaves out the springs of those that do: they would read as of no length.
        gravity, flags = model.opt.gravity.copy(), model.opt.enableflags
        model.opt.gravity[:], model.opt.enableflags = 0.0, flags & ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        mujoco.mj_tendon(model, data)
        mujoco.mj_energyPos(model, data)
        model.opt.gravity[:], model.opt.enableflags = gravity, flags
        return float(data.energy[0])

    def joint_error(self, data: Any) -> float:
        """Largest gap of a weld or connect constraint in the last step [m]; joints of the kinematic tree are exact."""
        import mujoco

        if not data.ne:
            return 0.0
        rows = data.efc_type[: data.nefc] == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
        return float(np.abs(data.efc_pos[: data.nefc][rows]).max(initial=0.0))

    def measure(self, data: Any, speeds: tuple[F64, F64], step: float) -> dict[str, float]:
        """Records of the present state and of the frame's fastest step; `step` [s] turns speeds into travel."""
        model, (linear, _) = self.model, speeds
        kinetic, potential = self.energy(data, self.free, speeds)
        mass = model.body_mass[self.free]
        momentum = mass @ linear[self.free] if len(self.free) else np.zeros(3)
        self.watch(data)
        self._evaluate()
        return {
            "kinetic_energy": kinetic,
            "potential_energy": potential + self.spring_energy(data),
            "momentum_x": float(momentum[0]),
            "momentum_y": float(momentum[1]),
            "momentum_z": float(momentum[2]),
            "mass": float(mass.sum()),
            "body_count": float(self.count),
            "max_speed": self._speed,
            "max_travel_per_step": self._surface * step,
        }
