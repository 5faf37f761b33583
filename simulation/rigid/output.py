"""Channels of a rigid instance in a frame, and the names of their rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.cache import CacheIndex
from .rows import row_velocities

if TYPE_CHECKING:
    from ...worlds.arrays import F64
    from ...worlds.spec import WorldSpec
    from ..fracture import Breakage
    from .exchange import Exchange
    from .parts import Parts

__all__ = ["frame_channels", "index_of"]


def frame_channels(
    parts: Parts,
    speeds: tuple[F64, F64],
    span: tuple[float, float],
    breakage: Breakage,
    exchange: Exchange,
    *,
    coupled: bool,
) -> dict[str, Any]:
    """Channels of the frame over `span` [s], given velocities and spins of the model's bodies at its end."""
    data, rigid = parts.data, parts.rigid
    ids = rigid.body_ids
    soft = exchange.soft
    return {
        "position": data.xpos[ids] - np.einsum("nij,nj->ni", data.xmat[ids].reshape(-1, 3, 3), rigid.offsets),
        "quaternion": data.xquat[ids].copy(),
        "velocity": row_velocities(rigid, data, speeds),
        "angular_velocity": speeds[1][ids],
        "asleep": parts.monitor.sleeping(data, ids, span[0]),
        "joint": data.qpos[rigid.joint_qpos].copy() if rigid.joints else np.zeros(0),
        "driver/active": parts.drivers.active(*span),
        **({"exchange/impulse": exchange.received.copy()} if coupled else {}),
        **(parts.fields.channels() if parts.fields else {}),
        **parts.monitor.arrays(),
        **({} if parts.flexes is None else parts.flexes.channels(data)),
        **({} if soft is None else {"exchange/soft": soft.impulse.copy()}),
        **(breakage.arrays() if breakage else {}),
    }


def index_of(spec: WorldSpec, parts: Parts, name: str, breakables: tuple[str, ...]) -> CacheIndex:
    """Names behind the channels' rows of the instance `name`."""
    import mujoco

    rigid = parts.rigid
    return CacheIndex(
        solver=name,
        engine="mujoco",
        fps=spec.simulation.fps,
        frames=spec.simulation.frames,
        bodies=rigid.bodies,
        colliders=rigid.colliders,
        joints=rigid.joints,
        drivers=parts.drivers.names,
        settings="",
        breakables=breakables,
        versions={"mujoco": mujoco.__version__, "numpy": np.__version__},
        deformables=tuple(f"{f.entity}/{f.part}" for f in rigid.flexes),
        vertices=tuple(len(f.lattice.mesh.vertices) for f in rigid.flexes),
    )
