"""Force fields on elastic bodies: accelerations of their nodes, and the push of a medium on the faces that it blows against (R18, R63)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...physics.drag import face_drag
from ...worlds.arrays import F64
from ...worlds.errors import EngineError
from ...worlds.fields import Carrier, Fields, fields_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...worlds.spec import WorldSpec
    from .flex import FlexBody, Flexes

__all__ = ["FlexFields"]


class FlexFields:
    """Forces of all fields on the elastic bodies of one model, with their impulses and work in a frame.

    Attributes:
        impulse: since `begin`, in the order of the bodies [N s], shape (n, 3).
        work: since `begin` [J].
        present: what is applied now to the model's bodies [N], shape (nbody, 3).
    """

    def __init__(
        self, spec: WorldSpec, flexes: Flexes, without: frozenset[str], media: Mapping[str, Carrier] | None = None
    ) -> None:
        self._flexes = flexes
        self._fields: list[Fields] = [fields_of(spec, b.entity, without, media) for b in flexes.bodies]
        self.impulse: F64 = np.zeros((len(flexes.bodies), 3))
        self.work = 0.0
        self.present: F64 = np.zeros((flexes.model.nbody, 3))
        self._open: list[tuple[FlexBody, F64, F64]] = []

    def __bool__(self) -> bool:
        return any(self._fields)

    def begin(self) -> None:
        """Count anew."""
        self.impulse[:], self.work = 0.0, 0.0

    def channels(self) -> dict[str, Any]:
        """Channel and record of the frame."""
        return {"field/soft": self.impulse.copy(), "record/soft_field_work": np.float64(self.work)}

    def apply(self, data: Any, time: float, dt: float, held: frozenset[str]) -> None:
        """Put the forces of a step of `dt` from `time` [s] in place of those of the last step; held bodies feel none."""
        self.end(data)
        for row, (body, fields) in enumerate(zip(self._flexes.bodies, self._fields, strict=True)):
            if body.entity in held or not fields.acts(time, time + dt):
                continue
            places, speeds = self._flexes.nodes(data, body)
            force = self._forces(body, fields, places, speeds, time, dt)
            np.add.at(self.present, body.body_ids, force)
            self.impulse[row] += dt * force.sum(axis=0)
            self._open.append((body, places, force))
        data.xfrc_applied[:, :3] += self.present

    def end(self, data: Any) -> None:
        """Take the forces of the last step away, and count what they did on the way since."""
        for body, places, force in self._open:
            self.work += float((force * (self._flexes.places(data, body) - places)).sum())
        self._open = []
        data.xfrc_applied[:, :3] -= self.present
        self.present[:] = 0.0

    def undo(self, data: Any) -> None:
        """Take back what the last step counted: it is taken again.

        Raises:
            EngineError: elastic and breakable bodies do not stand in one instance.
        """
        del data
        raise EngineError("a step with elastic bodies was taken again")

    def _forces(self, body: FlexBody, fields: Fields, places: F64, speeds: F64, time: float, dt: float) -> F64:
        """On the nodes that move by themselves [N], shape (n, 3)."""
        force = body.masses[:, None] * fields.acceleration(places, time)
        if fields.has_medium:
            lattice = body.lattice
            faces, vertices = lattice.mesh.faces, lattice.at_vertices(places)
            corners = vertices[faces]
            medium = fields.medium(corners.mean(axis=1), time)
            found = face_drag(medium, corners, lattice.at_vertices(speeds)[faces].mean(axis=1))
            # As on rigid bodies, never more than what stops the relative motion within the step.
            damped = found.force / (1.0 + dt * found.rate.sum() / body.masses.sum())
            pushed = np.zeros_like(vertices)
            np.add.at(pushed, faces.reshape(-1), np.repeat(damped / 3.0, 3, axis=0))
            force += lattice.to_nodes(pushed)
        return np.where(body.free[:, None], force, 0.0)
