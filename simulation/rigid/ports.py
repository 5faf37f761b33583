"""Where others may push a rigid instance, and how its bodies answer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.spec import ElasticPhysics
from ..protocol import Port

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...worlds.arrays import F64
    from ...worlds.built import BuiltEntity
    from ...worlds.spec import WorldSpec
    from .model import RigidModel

__all__ = ["ports_of", "response"]


def ports_of(spec: WorldSpec, built: Mapping[str, BuiltEntity], members: tuple[str, ...]) -> tuple[Port, ...]:
    """Every part of every free body takes wrenches and gives motion."""
    return tuple(
        Port(entity, part.part, "wrench", "both")
        for entity in members
        if spec.entities[entity].motion == "dynamic" and not isinstance(spec.entities[entity].physics, ElasticPhysics)
        for part in built[entity].parts
    )


def response(rigid: RigidModel, data: Any, built: BuiltEntity, port: Port, wrench: F64) -> F64:
    """Acceleration (6,) [linear, angular] of the port's body under a wrench (6,) at its centre of mass."""
    import mujoco

    model = rigid.model
    part = next(p for p in built.parts if p.part == port.part)
    body = int(rigid.body_ids[rigid.bodies.index(f"{port.entity}/{part.body}")])
    force = np.zeros(model.nv)
    mujoco.mj_crb(model, data)
    mujoco.mj_factorM(model, data)
    mujoco.mj_applyFT(model, data, wrench[:3], wrench[3:], data.xipos[body], body, force)
    answer = np.zeros((1, model.nv))
    mujoco.mj_solveM(model, data, answer, force[None])
    linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jacBodyCom(model, data, linear, angular, body)
    return np.concatenate([linear @ answer[0], angular @ answer[0]])
