"""Loads of coupled solvers on elastic bodies: forces at the vertices of their surfaces, taken to the nodes that carry those."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64

if TYPE_CHECKING:
    from .flex import FlexBody, Flexes

__all__ = ["SoftLoads"]


class SoftLoads:
    """Forces on all elastic bodies of a model, and what the engine integrated of them in a frame.

    A vertex is a fixed mean of its nodes: by the transpose of those weights, forces and moments at the nodes sum to what was given.
    """

    def __init__(self, flexes: Flexes) -> None:
        self._flexes = flexes
        self._bodies = {f.entity: f for f in flexes.bodies}
        self.wrench: F64 = np.zeros((flexes.model.nbody, 6))
        """Now, on the model's bodies [N, N m]."""
        self._forces: dict[str, F64] = {}
        self.impulse: F64 = np.zeros((len(flexes.bodies), 6))
        """Impulse over the frame, about the centres of mass [N s, N m s]."""
        self.work = 0.0
        """Work over the frame [J]."""

    def begin(self) -> None:
        """Start a frame."""
        self.impulse[:], self.work = 0.0, 0.0

    def lay(self, data: Any, forces: Mapping[str, F64]) -> None:
        """Forces that hold from now on, at the vertices of each entity's surface, shape (v, 3) [N]."""
        self.wrench[:] = 0.0
        self._forces = {name: self._bodies[name].lattice.to_nodes(given) for name, given in forces.items()}
        for name, force in self._forces.items():
            body = self._bodies[name]
            arm = self._flexes.places(data, body) - data.xipos[body.body_ids]
            np.add.at(self.wrench, body.body_ids, np.concatenate([force, np.cross(arm, force)], axis=1))
        self._before = {name: self._flexes.places(data, self._bodies[name]) for name in self._forces}

    def lift(self, data: Any) -> None:
        """They end; what they did is counted."""
        for name, force in self._forces.items():
            way = self._flexes.places(data, self._bodies[name]) - self._before[name]
            self.work += float((force * way).sum())
        self._forces = {}
        self.wrench[:] = 0.0

    def take(self, applied: F64, data: Any, seconds: float) -> None:
        """Count what the engine integrated over `seconds` of wrenches `applied` to the model's bodies, shape (nbody, 6)."""
        for row, body in enumerate(self._flexes.bodies):
            if body.entity not in self._forces:
                continue
            places = self._flexes.places(data, body)
            held = np.where(body.free[:, None], applied[body.body_ids, :3], self._forces[body.entity])
            center = _center(body, places)
            self.impulse[row, :3] += seconds * held.sum(axis=0)
            self.impulse[row, 3:] += seconds * np.cross(places - center, held).sum(axis=0)


def _center(body: FlexBody, places: F64) -> F64:
    return np.asarray(body.masses @ places / body.masses.sum())
