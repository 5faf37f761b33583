"""Surfaces of bodies as walls that no particle passes, beside the pressure that keeps liquid off them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ..engine import Boundary, LiquidSetup

if TYPE_CHECKING:
    from ...passes import Passes
    from .bodies import Coupling
    from .store import Work

__all__ = ["KeepOut"]

PASSED, RESTING, MOVING, SHEET = range(4)


class KeepOut:
    """Meshes of all boundaries on a device. Those that deform are passed over: their particles alone hold the liquid."""

    def __init__(self, setup: LiquidSetup, origin: F64, passes: Passes) -> None:
        wp = warp()
        self.spacing, self.passes = setup.spacing, passes
        self._meshes: list[Any] = []
        ids, kinds = [], []
        for boundary in setup.boundaries:
            kinds.append(_kind(boundary))
            at = np.asarray(boundary.mesh.vertices, dtype=float)
            if boundary.motion == "static":
                at = at - origin
            made = wp.Mesh(
                points=wp.array(at.astype(np.float32), dtype=wp.vec3, device=passes.device),
                indices=wp.array(boundary.mesh.faces.astype(np.int32).ravel(), dtype=wp.int32, device=passes.device),
            )
            self._meshes.append(made)
            ids.append(made.id)
        self.ids = wp.array(np.array(ids or [0], dtype=np.uint64), dtype=wp.uint64, device=passes.device)
        self.kinds = wp.array(np.array(kinds or [PASSED], dtype=np.int32), dtype=wp.int32, device=passes.device)
        self._fixed = np.array([b.motion == "static" for b in setup.boundaries], dtype=bool)
        size = max(1, len(ids))
        self._rotation = wp.zeros(size, dtype=wp.mat33, device=passes.device)
        self._position = wp.zeros(size, dtype=wp.vec3, device=passes.device)

    def apply(self, w: Work, s: Any, coupling: Coupling, n: int) -> None:
        """Change the velocities of the end of the step so that no way of it leads through a surface; book what that gives."""
        from . import keep_out_kernels as kernels

        if not coupling.total:
            return
        rotation, position = (one.copy() for one in coupling.placed)
        rotation[self._fixed] = np.eye(3, dtype=np.float32)
        position[self._fixed] = 0.0
        self._rotation.assign(rotation)
        self._position.assign(position)
        inputs = [
            s.x, w.lightness, s.volume, w.settings, self.spacing, coupling.pairs, coupling.bodies, self._rotation, self._position,
            self.ids, self.kinds, s.v, coupling.pair_force, coupling.pair_return,
        ]  # fmt: skip
        self.passes("keep_out", kernels.keep_out, n, inputs)()
        coupling.rubbed()


def _kind(boundary: Boundary) -> int:
    if boundary.deforming:
        return PASSED
    if not boundary.closed:
        return SHEET
    return RESTING if boundary.motion == "static" else MOVING
