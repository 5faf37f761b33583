"""Surfaces of bodies as walls that no particle passes, beside the pressure that keeps liquid off them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ...boundaries import Boundary
from ...passes import FEW
from ..engine import LiquidSetup

if TYPE_CHECKING:
    from ...passes import Passes
    from .bodies import Coupling
    from .store import Work

__all__ = ["KeepOut"]

PASSED, RESTING, MOVING, SHEET, SOFT, SOFT_SHEET = range(6)


class KeepOut:
    """Meshes of all boundaries on a device. Those that deform are laid anew at the start of every step."""

    def __init__(self, setup: LiquidSetup, origin: F64, passes: Passes) -> None:
        from .boundary_kernels import Surfaces

        wp = warp()
        self.spacing, self.passes = setup.spacing, passes
        self._meshes: list[Any] = []
        ids, kinds = [], []
        for boundary in setup.boundaries:
            kinds.append(_kind(boundary))
            at = np.asarray(boundary.mesh.vertices, dtype=float)
            if boundary.motion == "static" or boundary.deforming:
                at = at - origin
            made = wp.Mesh(
                points=wp.array(at.astype(np.float32), dtype=wp.vec3, device=passes.device),
                indices=wp.array(boundary.mesh.faces.astype(np.int32).ravel(), dtype=wp.int32, device=passes.device),
            )
            self._meshes.append(made)
            ids.append(made.id)
        size = max(1, len(ids))
        self.surfaces = s = Surfaces()
        s.mesh = wp.array(np.array(ids or [0], dtype=np.uint64), dtype=wp.uint64, device=passes.device)
        s.kind = wp.array(np.array(kinds or [PASSED], dtype=np.int32), dtype=wp.int32, device=passes.device)
        s.rotation = wp.zeros(size, dtype=wp.mat33, device=passes.device)
        s.position = wp.zeros(size, dtype=wp.vec3, device=passes.device)
        self._soft = [k for k, b in enumerate(setup.boundaries) if b.deforming]
        self._fixed = np.array([b.motion == "static" for b in setup.boundaries], dtype=bool)

    def place(self, coupling: Coupling) -> None:
        """Carry the surfaces to where the bodies are at the start of a step."""
        if not coupling.count:
            return
        rotation, position = (one.copy() for one in coupling.placed)
        rotation[self._fixed] = np.eye(3, dtype=np.float32)
        position[self._fixed] = 0.0
        self.surfaces.rotation.assign(rotation)
        self.surfaces.position.assign(position)
        for row in self._soft:
            coupling.soft.lay_surface(row, self._meshes[row])

    def apply(self, w: Work, s: Any, coupling: Coupling, n: int) -> None:
        """Turn the ways of the step aside so that none leads through a surface, and velocities with them; book what that gives."""
        from . import keep_out_kernels as kernels

        if not coupling.total:
            return
        inputs = [
            s.x, w.lightness, s.volume, w.settings, self.spacing, coupling.pairs, coupling.bodies, self.surfaces,
            s.v, w.way, coupling.pair_force, coupling.pair_return,
        ]  # fmt: skip
        self.passes("keep_out", kernels.keep_out, n, inputs, block=FEW)()
        coupling.rubbed()


def _kind(boundary: Boundary) -> int:
    if boundary.deforming:
        return SOFT if boundary.closed else SOFT_SHEET
    if not boundary.closed:
        return SHEET
    return RESTING if boundary.motion == "static" else MOVING
