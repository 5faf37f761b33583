"""Force fields on rigid bodies: drag of the area they show to the flow, and accelerations, at their centres of mass; lift where it is declared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ...physics.drag import Medium, area_vectors, drag_force, projected_area
from ...worlds.arrays import F64, I64
from ...worlds.built import BuiltEntity
from ...worlds.fields import Answer, Carrier, Dragged, Fields, fields_of
from ...worlds.spec import WorldSpec
from .lifting import Lifted, Lifting
from .model import RigidModel
from .rows import row_centers, spread

__all__ = ["FieldForces"]


class FieldForces:
    """Forces of all fields on the bodies of one instance, and the impulses that they gave.

    Attributes:
        impulse: since `begin`, in the order of `rigid.bodies` [N s], shape (n, 3).
        present: forces that are applied now [N], shape (n, 3).
        twist: angular impulses about the centres of mass since `begin` [N m s], shape (n, 3).
        turning: torques that are applied now [N m], shape (n, 3).
    """

    def __init__(
        self,
        spec: WorldSpec,
        rigid: RigidModel,
        built: Mapping[str, BuiltEntity],
        without: frozenset[str],
        media: Mapping[str, Carrier] | None = None,
    ) -> None:
        self.rigid = rigid
        self.impulse: F64 = np.zeros((len(rigid.bodies), 3))
        owners = [b.split("/", 1) for b in rigid.bodies]
        by_fields: dict[tuple[str, ...], tuple[Fields, list[int]]] = {}
        present = {e: fields_of(spec, e, without, media) for e in dict.fromkeys(e for e, _ in owners)}
        for row, (entity, _) in enumerate(owners):
            fields = present[entity]
            if fields:
                by_fields.setdefault(fields.names, (fields, []))[1].append(row)
        self._sets = [(fields, np.array(rows, dtype=np.int64)) for fields, rows in by_fields.values()]
        vectors, owner, dragged = [np.zeros((0, 3))], [np.zeros(0, dtype=np.int64)], []
        for row, (entity, body) in enumerate(owners):
            if any(row in rows and fields.has_medium for fields, rows in self._sets):
                parts = built[entity].parts_of(body)
                dragged.append(row)
                if parts:
                    found = area_vectors(np.concatenate([p.render.vertices for p in parts]))
                    vectors.append(found)
                    owner.append(np.full(len(found), row))
        self._vectors, self._owner = np.concatenate(vectors), np.concatenate(owner)
        self._mass = np.where(rigid.kin_rows, rigid.masses, rigid.model.body_mass[rigid.body_ids])
        self._lifting = Lifting.of(spec, rigid, built, dragged, self._mass)
        self._entities = [entity for entity, _ in owners]
        self.present, self.turning, self.twist = (np.zeros((len(owners), 3)) for _ in range(3))
        self._given, self._twisted = self.present, self.turning
        self._felt: list[tuple[Answer, F64]] = []
        """Media that feel the bodies, and what drag of each gave to these in the last step [N s]."""
        self._still = np.zeros(len(owners), dtype=bool)

    def __bool__(self) -> bool:
        return bool(self._sets)

    def begin(self) -> None:
        """Count impulses anew."""
        self.impulse[:] = 0.0
        self.twist[:] = 0.0

    def channels(self) -> dict[str, F64]:
        """Channels of a frame."""
        told = {"field/impulse": self.impulse.copy()}
        return told if self._lifting is None else {**told, "field/twist": self.twist.copy()}

    def take_over(self, old: FieldForces) -> None:
        """Go on with what another model's bodies, the same ones, were given."""
        self.impulse[:] = old.impulse
        self.twist[:] = old.twist

    def forces(self, data: Any, time: float, dt: float) -> tuple[F64, F64]:
        """Forces [N] and torques [N m] on the bodies in the present state at `time` [s], as they act over a step of `dt`, each shape (n, 3).

        Drag is divided by one plus the share of the speed that it would take within the step, so that it never turns a body round.
        """
        ids = self.rigid.body_ids
        center = row_centers(self.rigid, data)
        spin = data.cvel[ids, :3]
        velocity = data.cvel[ids, 3:] + np.cross(spin, center - data.subtree_com[self.rigid.model.body_rootid[ids]])
        total, turning = np.zeros((len(ids), 3)), np.zeros((len(ids), 3))
        for fields, rows in self._sets:
            total[rows] += self._mass[rows, None] * fields.acceleration(center[rows], time)
            if not fields.has_medium:
                continue
            medium = fields.medium(center[rows], time)
            flow = np.zeros_like(center)
            flow[rows] = medium.velocity - velocity[rows]
            area = projected_area(self._vectors, self._owner, data.xmat[ids].reshape(-1, 3, 3), flow)[rows]
            push = drag_force(medium, area, velocity[rows])
            speed = np.maximum(np.linalg.norm(flow[rows], axis=1), 1e-12)
            rate = np.linalg.norm(push, axis=1) / (speed * np.maximum(self._mass[rows], 1e-12))
            lifted = None if self._lifting is None else self._lifted(data, rows, medium, (velocity, spin), dt)
            if lifted is not None:
                rate[lifted[0]] = lifted[1].rate
            taken = dt * rate / (1.0 + dt * rate)
            moved = np.where(self._still[rows], 0.0, self._mass[rows])
            dragged = Dragged(velocity[rows], moved, taken, rate, dt, np.sqrt(area / np.pi))
            felt = fields.answer(center[rows], time, dragged)
            if felt is not None:
                push = push + (self._mass[rows] * rate)[:, None] * felt.change
                if lifted is not None:
                    met = replace(medium, velocity=medium.velocity + felt.change)
                    lifted = self._lifted(data, rows, met, (velocity, spin), dt)
            given, paid = push / (1.0 + dt * rate)[:, None], dt * push / (1.0 + dt * rate)[:, None]
            if lifted is not None:
                given[lifted[0]], paid[lifted[0]] = lifted[1].force, dt * lifted[1].force
                turning[rows[lifted[0]]] = lifted[1].torque
            if felt is not None:
                self._felt.append((felt, np.where(self._still[rows, None], 0.0, paid)))
            total[rows] += given
        return total, turning

    def _lifted(self, data: Any, rows: I64, medium: Medium, motion: tuple[F64, F64], dt: float) -> tuple[I64, Lifted] | None:
        """Places among some rows of those that lift acts on, and what it and drag do to these; None where there are none."""
        assert self._lifting is not None
        own = np.flatnonzero(np.isin(rows, self._lifting.rows))
        return (own, self._lifting.act(data, rows[own], medium.at(own), motion, dt)) if len(own) else None

    def apply(self, data: Any, time: float, dt: float, held: frozenset[str]) -> None:
        """Add the forces of this step to what is applied to the bodies, in place of those of the last step.

        Bodies that are held, or asleep, feel none.
        """
        ids = self.rigid.body_ids
        awake = data.body_awake[ids] != 0
        stopped = np.array([e in held for e in self._entities], dtype=bool)
        self._still, self._felt = stopped | ~awake, []
        found, turning = self.forces(data, time, dt)
        found[stopped] = turning[stopped] = 0.0
        self._push(data, found - self.present, turning - self.turning)
        self.present, self.turning = found, turning
        self._given, self._twisted = dt * found * awake[:, None], dt * turning * awake[:, None]
        self.impulse += self._given
        self.twist += self._twisted
        for felt, given in self._felt:
            felt.take(given)

    def undo(self, data: Any) -> None:
        """Take back the last step, its forces and what it counted: it is taken again."""
        if self:
            self.impulse -= self._given
            self.twist -= self._twisted
            for felt, given in self._felt:
                felt.take(given, back=True)
            self.end(data)

    def end(self, data: Any) -> None:
        """Take the forces of the last step away."""
        self._push(data, -self.present, -self.turning)
        self.present, self.turning = np.zeros_like(self.present), np.zeros_like(self.turning)

    def _push(self, data: Any, force: F64, torque: F64) -> None:
        """Add forces at the rows' centres of mass, and torques about these, to what is applied."""
        data.xfrc_applied += spread(self.rigid, data, np.concatenate([force, torque], axis=1))
