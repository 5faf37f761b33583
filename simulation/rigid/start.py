"""Declared velocities at frame 0: of free bodies, of pieces, and of what joints hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.spec import RigidPhysics

if TYPE_CHECKING:
    from ...worlds.spec import WorldSpec

__all__ = ["set_velocities"]

OFF = 1e-4
"""[m/s], and share of the declared speed, by which a joint may let a body start differently: the bound of the row on velocities at frame 0."""
STILL = 1e-6
"""[m/s] Speed that counts as none."""


def set_velocities(
    spec: WorldSpec,
    model: Any,
    data: Any,
    dofs: Mapping[str, Sequence[int]],
    bodies: Mapping[str, Sequence[int]],
    kinematic: frozenset[str],
) -> None:
    """Write the declared velocities at frame 0 [m/s, rad/s] into `data.qvel`.

    What hangs on joints gets the rates of its joints that give its bodies the declared velocity, parents before children.

    Args:
        spec: the specification.
        model: the compiled model.
        data: its state, with positions brought up to date.
        dofs: degrees of freedom by entity.
        bodies: bodies of the model by entity.
        kinematic: entities that follow paths: they start as their paths say.

    Raises:
        InputError: joints do not allow a declared velocity; the message names the nearest one that they allow.
    """
    import mujoco

    mujoco.mj_comPos(model, data)
    moving = [
        e for e in spec.entities if dofs.get(e) and e not in kinematic and isinstance(spec.entities[e].physics, RigidPhysics)
    ]
    for entity in sorted(moving, key=lambda e: min(bodies[e])):
        physics = spec.entities[entity].physics
        assert isinstance(physics, RigidPhysics)
        linear, angular = np.array(physics.linear_velocity), np.array(physics.angular_velocity)
        own, its_bodies = list(dofs[entity]), list(bodies[entity])
        if int(model.jnt_type[model.dof_jntid[own[0]]]) != int(mujoco.mjtJoint.mjJNT_FREE):
            _start_on_joints(entity, model, data, own, its_bodies, linear, angular)
        elif spec.entities[entity].breakable is not None:
            _start_clusters(model, data, its_bodies, linear, angular)
        elif linear.any() or angular.any():
            body = int(model.dof_bodyid[own[0]])
            center = data.subtree_com[body] if len(its_bodies) > 1 else data.xipos[body]
            data.qvel[own[:3]] = linear + np.cross(angular, data.xpos[body] - center)
            data.qvel[own[3:6]] = data.xmat[body].reshape(3, 3).T @ angular


def _start_clusters(model: Any, data: Any, bodies: list[int], linear: F64, angular: F64) -> None:
    """Give the clusters of a breakable entity the velocities of one body."""
    if not linear.any() and not angular.any():
        return
    mass = model.body_mass[bodies]
    center = mass @ data.xipos[bodies] / mass.sum()
    for body in bodies:
        dof = int(model.body_dofadr[body])
        data.qvel[dof : dof + 3] = linear + np.cross(angular, data.xpos[body] - center)
        data.qvel[dof + 3 : dof + 6] = data.xmat[body].reshape(3, 3).T @ angular


def _start_on_joints(entity: str, model: Any, data: Any, own: list[int], bodies: list[int], linear: F64, angular: F64) -> None:
    """Rates of joints by least squares on the velocities of the bodies' centres of mass, and on their turning by their own size."""
    import mujoco

    mass = model.body_mass[bodies]
    center = mass @ data.xipos[bodies] / mass.sum()
    rows, wanted, sizes = [], [], []
    for body in bodies:
        shift, turn = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        mujoco.mj_jac(model, data, shift, turn, data.xipos[body], body)
        size = float(np.sqrt(model.body_inertia[body].sum() / model.body_mass[body]))
        rows += [shift, size * turn]
        wanted += [linear + np.cross(angular, data.xipos[body] - center), size * angular]
        sizes.append(size)
    jacobian, target = np.concatenate(rows), np.concatenate(wanted)
    carried = jacobian @ data.qvel
    if np.abs(target).max() <= STILL and np.abs(carried).max() <= STILL:
        return
    data.qvel[own] += np.linalg.lstsq(jacobian[:, own], target - carried, rcond=None)[0]
    reached = jacobian @ data.qvel
    off, speed = (float(np.linalg.norm(v.reshape(-1, 3), axis=1).max()) for v in (reached - target, target))
    if off <= OFF * (1.0 + speed):
        return
    allowed = reached.reshape(-1, 3)
    near_linear, near_angular = mass @ allowed[0::2] / mass.sum(), allowed[1] / max(sizes[0], 1e-12)
    raise InputError(
        f"the joints of entity {entity!r} do not let it start with linear_velocity {_text(linear)} m/s (of its centre of mass, at "
        f"{_text(center)}) and angular_velocity {_text(angular)} rad/s: that is {off:.3g} m/s from the nearest that they allow. Declare that "
        f"one, linear_velocity {_text(near_linear)} and angular_velocity {_text(near_angular)}, or move it by a motor or a force"
        + (
            "; if it is to start at rest, what it hangs on moves at frame 0: brake or hold that in the preroll"
            if speed <= STILL
            else ""
        )
    )


def _text(values: F64) -> str:
    return "(" + ", ".join(f"{float(v):.6g}" for v in np.asarray(values) + 0.0) + ")"
