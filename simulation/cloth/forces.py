"""Forces on the vertices of sheets but those of contacts, and what bodies take along: the passes of a step that all schemes share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import F64
from ..passes import FEW
from . import force_kernels as forces
from . import step_kernels as steps
from .arrays import ClothArrays
from .setup import ClothSetup, still_air

__all__ = ["ClothForces"]


class ClothForces(ClothArrays):
    """Arrays with what acts on them.

    Args:
        setup: what does not change.

    Attributes:
        carries: True if the solids' vertices move.
    """

    def __init__(self, setup: ClothSetup) -> None:
        super().__init__(setup)
        self._air_rests = False
        self.carries = bool(self.led_count or self._soft.rows) and self.total > self.n

    def lead(self) -> Any:
        """The pass that leads what bodies take along."""
        return self.passes("lead", steps.lead, self.led_count, [*self._led, self._rotation, self._origin, self._center, self._velocity, self._spin, self.clock, self.x, self.target, self.u])  # fmt: skip

    def blow(self, time: float, x: F64) -> F64:
        """Take the air and the fields as they are now; the acceleration of vertices but for gravity, (n, 3)."""
        self.breathe(time, lambda: x)
        for one in self.airing():
            one()
        return np.asarray(self.acceleration.numpy() - self.setup.gravity)

    def breathe(self, time: float, where: Callable[[], F64]) -> None:
        """Take the air and the fields as they are now at the vertices, which are asked for `where` they are (n, 3) only if that matters."""
        setup = self.setup
        if setup.acceleration is not None or self.loads is not None:
            pull = np.zeros((self.n, 3)) if setup.acceleration is None else setup.acceleration(where(), time)
            self._pulled.assign(setup.gravity + pull + (0.0 if self.loads is None else self.loads / self.mass[:, None]))
            if not self.blown:
                warp().copy(self.acceleration, self._pulled)
        if self.blown and not self._air_rests:
            x = where()
            self.air.assign(setup.air((x[self.faces[:, 0]] + x[self.faces[:, 1]] + x[self.faces[:, 2]]) / 3.0, time))
            self._air_rests = setup.air is still_air

    def airing(self) -> list[Any]:
        """Passes to the acceleration of the vertices by gravity, fields and the air."""
        if not self.blown:
            return []
        p = self.passes
        return [
            p("blow", steps.blow, len(self.faces), [self.x, self.v, self.face_array, self.air, self.drag, self._blast]),
            p("catch", steps.catch_air, self.n, [self.masses, *self.corners, self._blast, self._pulled, self.acceleration]),
        ]

    def forces(self) -> list[Any]:
        """Passes to the velocities after all forces but those of contacts."""
        p, n = self.passes, self.n
        inner = [self.x, self.v, self.face_array, self.rest, self.law, self.force]
        made = [p("membrane", forces.membrane, len(self.faces), inner, block=FEW)]
        if len(self.host_hinges):
            made.append(p("bending", forces.bending, len(self.host_hinges), [self.x, self.v, self.hinges, self.weight, self.hinge_law, self.pull], block=FEW))  # fmt: skip
        if self.led_count:
            made.append(self.lead())
        made.append(
            p("fall", steps.fall, n, [self.x, self.v, self.masses, *self.corners, self.force, *self.ends, self.weights, self.pull,
              self.acceleration, self.inverse, self.target, self.clock, self.reaction, self.u], block=FEW)
        )  # fmt: skip
        return made

    def carry(self) -> Any:
        """The pass that moves the solids' vertices."""
        return self.passes("carry", steps.carry, self.total - self.n, [self.n, self.clock, self.u, self.x])
