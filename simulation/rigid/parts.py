"""Everything of a rigid instance that belongs to one compiled model, and the passage from one model to the next.

Where bonds break, the clusters of pieces change, and with them the bodies of the model. The model is compiled anew (7 ms for
a wall of 500 bricks, 0.1 s where all 500 lie loose) and the state carried over: each new body goes on with the velocity
field of the body it was part of, so that momentum and angular momentum stay what they were.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64, cross
from .drivers import Drivers
from .fields import FieldForces
from .flex import Flexes
from .flex_fields import FlexFields
from .gyration import Gyration
from .model import RigidModel, build_model
from .monitor import ContactMonitor
from .records import Ledger
from .work import DriverWork

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...worlds.built import BuiltEntity
    from ...worlds.fields import Carrier
    from ...worlds.spec import RigidSettings, WorldSpec
    from ..protocol import Intervention

__all__ = ["Parts", "carry_over", "make_parts"]


@dataclass
class Parts:
    """One model, its states, and those who read or write them."""

    rigid: RigidModel
    data: Any
    saved: Any
    """State at the start of the frame."""
    drivers: Drivers
    work: DriverWork
    gyration: Gyration
    monitor: ContactMonitor
    ledger: Ledger
    fields: FieldForces
    flexes: Flexes | None


def make_parts(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    members: tuple[str, ...],
    settings: RigidSettings,
    intervention: Intervention,
    whole: Mapping[str, Any],
    media: Mapping[str, Carrier],
) -> Parts:
    """Compile the model in which these bonds hold; `media` of instances drag its bodies along."""
    import mujoco

    rigid = build_model(spec, built, members, settings, apart=intervention.apart, whole=whole)
    model = rigid.model
    drivers = Drivers(spec, rigid, frozenset(members), intervention)
    own, rows, body = np.unique(rigid.body_ids, return_index=True, return_inverse=True)
    kinematic = np.array([rigid.bodies[r].split("/", 1)[0] in drivers.kinematic for r in np.sort(rows)], dtype=bool)
    far = np.zeros(len(own))
    np.maximum.at(far, body, np.where(rigid.kin_rows, np.linalg.norm(rigid.centers - rigid.offsets, axis=1), 0.0))
    order = np.argsort(rows)
    flexes = Flexes(model, rigid.flexes) if rigid.flexes else None
    if flexes is not None:
        flexes.fields = FlexFields(spec, flexes, intervention.without, media) or None
    return Parts(
        rigid=rigid,
        data=mujoco.MjData(model),
        saved=mujoco.MjData(model),
        drivers=drivers,
        work=DriverWork(model, rigid.actuator_of, drivers),
        gyration=Gyration(model),
        monitor=ContactMonitor(rigid),
        ledger=Ledger(model, own[order], kinematic, len(rigid.bodies), far[order]),
        fields=FieldForces(spec, rigid, built, intervention.without, media),
        flexes=flexes,
    )


def carry_over(old: Parts, new: Parts, time: float) -> None:
    """Give a new model the state and the memory of the old one, at `time` [s] within a frame.

    Both have the same entities; only the clusters of breakable ones differ.
    """
    import mujoco

    one, two = old.rigid.model, new.rigid.model
    before, after = old.data, new.data
    after.time = before.time
    kept = new.data.qpos.copy()
    clustered = _clustered(new)
    for joint in range(two.njnt):
        name = mujoco.mj_id2name(two, mujoco.mjtObj.mjOBJ_JOINT, joint)
        known = mujoco.mj_name2id(one, mujoco.mjtObj.mjOBJ_JOINT, name)
        body = int(two.jnt_bodyid[joint])
        if known >= 0 and body not in clustered:
            sizes = {0: (7, 6), 1: (4, 3)}.get(int(two.jnt_type[joint]), (1, 1))
            to, source = int(two.jnt_qposadr[joint]), int(one.jnt_qposadr[known])
            after.qpos[to : to + sizes[0]] = before.qpos[source : source + sizes[0]]
            kept[to : to + sizes[0]] = old.drivers.kept_poses()[source : source + sizes[0]]
            to, source = int(two.jnt_dofadr[joint]), int(one.jnt_dofadr[known])
            for field in ("qvel", "qacc_warmstart"):
                getattr(after, field)[to : to + sizes[1]] = getattr(before, field)[source : source + sizes[1]]
    for body, row in clustered.items():
        if two.body_dofnum[body]:
            _carry_cluster(old, new, body, row, kept)
    new.drivers.keep_poses(kept)
    new.monitor.take_over(old.monitor, time)
    new.ledger.take_over(old.ledger)
    new.fields.take_over(old.fields)
    if new.rigid.law.kin is not None and old.rigid.law.kin is not None:
        new.rigid.law.kin.take_over(old.rigid.law.kin)


def _clustered(parts: Parts) -> dict[int, int]:
    """Body -> one of its rows, for bodies of breakable entities."""
    rows = np.flatnonzero(parts.rigid.kin_rows)
    bodies, first = np.unique(parts.rigid.body_ids[rows], return_index=True)
    return dict(zip(bodies.tolist(), rows[first].tolist(), strict=True))


def _carry_cluster(old: Parts, new: Parts, body: int, row: int, kept: F64) -> None:
    """State of one cluster from that of the cluster its pieces were in."""
    source = int(old.rigid.body_ids[row])
    one, two, before, after = old.rigid.model, new.rigid.model, old.data, new.data
    shift = new.rigid.offsets[row] - old.rigid.offsets[row]
    at, dof = int(two.jnt_qposadr[two.body_jntadr[body]]), int(two.body_dofadr[body])
    if one.body_dofnum[source]:
        place, first = int(one.jnt_qposadr[one.body_jntadr[source]]), int(one.body_dofadr[source])
        position, quaternion = before.qpos[place : place + 3], before.qpos[place + 3 : place + 7]
        spin = before.qvel[first + 3 : first + 6]
        turn = _rotation(quaternion)
        after.qvel[dof : dof + 3] = before.qvel[first : first + 3] + turn @ cross(spin, shift)
        after.qvel[dof + 3 : dof + 6] = spin
        after.qacc_warmstart[dof : dof + 6] = before.qacc_warmstart[first : first + 6]
        held = old.drivers.kept_poses()[place : place + 7]
        kept[at : at + 3] = held[:3] + _rotation(held[3:]) @ shift
        kept[at + 3 : at + 7] = held[3:]
    else:
        position, quaternion = before.xpos[source], before.xquat[source]
        turn = _rotation(quaternion)
    after.qpos[at : at + 3] = position + turn @ shift
    after.qpos[at + 3 : at + 7] = quaternion


def _rotation(quaternion: F64) -> F64:
    import mujoco

    out = np.empty(9)
    mujoco.mju_quat2Mat(out, np.ascontiguousarray(quaternion, dtype=np.float64))
    return out.reshape(3, 3)
