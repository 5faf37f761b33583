"""Boundaries on the grid: distances, cut faces, and the exchange of momentum with bodies inside the pressure solve."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ....worlds.errors import InputError
from ...boundaries import BodyState, Boundary
from ...grids.runner import Runner
from ..engine import LiquidSetup
from . import distance_kernels as kernels

__all__ = ["Solids"]

NODES = 600_000
"""Most nodes of one body's distance grid; larger bodies get a coarser one."""
FINE = 0.25
"""Spacing of a body's distance grid in cells."""
RIM = 3.0
"""Cells around a body that its grid covers."""


class Solids:
    """Boundaries of one run; `update` puts them where they are at the start of a step."""

    def __init__(self, run: Runner, setup: LiquidSetup, origin: F64) -> None:
        self.run, self.setup = run, setup
        self._cell, self._origin = float(setup.spacing), origin
        self.count = len(setup.boundaries)
        for boundary in setup.boundaries:
            if boundary.deforming:
                raise InputError(
                    f"the grid engine takes no deforming boundary ({boundary.name!r}); use engine 'dfsph' beside cloth and elastic bodies"
                )
        self._moving = [n for n, b in enumerate(setup.boundaries) if b.motion != "static"]
        self._meshes: list[Any] = []
        self.fixed: list[Any] | None = None
        """Mesh ids and owners of fixed boundaries, once they have been placed."""
        self.moving = kernels.Moving()
        self.reuse = 0
        """1 where the last step's distances of fixed boundaries hold."""

    def _mesh(self, points: F64, faces: NDArray[Any], closed: bool) -> int:
        wp, device = warp(), self.run.device
        mesh = wp.Mesh(
            points=wp.array(points.astype(np.float32), dtype=wp.vec3, device=device),
            indices=wp.array(np.ascontiguousarray(faces, np.int32).reshape(-1), dtype=wp.int32, device=device),
            support_winding_number=closed,
        )
        self._meshes.append(mesh)
        return int(mesh.id)

    def _place_fixed(self, bodies: BodyState) -> None:
        wp, ids, owners = warp(), [], []
        for closed in (True, False):
            points, faces, owner = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)], [np.zeros(0, np.int32)]
            offset = 0
            for n, boundary in enumerate(self.setup.boundaries):
                if boundary.motion != "static" or boundary.closed != closed:
                    continue
                world = boundary.mesh.vertices @ bodies.rotation[n].T + bodies.position[n]
                points.append((world - self._origin) / self._cell)
                faces.append(boundary.mesh.faces.astype(np.int64) + offset)
                owner.append(np.full(len(boundary.mesh.faces), n, np.int32))
                offset += len(world)
            all_faces = np.concatenate(faces)
            ids.append(wp.uint64(self._mesh(np.concatenate(points), all_faces, closed) if len(all_faces) else 0))
            owners.append(self.run.upload(f"owner/{closed}", np.concatenate(owner), wp.int32))
        self.fixed = [*ids, *owners]

    def _build_moving(self) -> None:
        """Distance grids in the bodies' frames [cells]."""
        wp, run = warp(), self.run
        first, sizes, lowers, steps = [], [], [], []
        total = 0
        for n in self._moving:
            points = self.setup.boundaries[n].mesh.vertices / self._cell
            low, high = points.min(axis=0) - RIM, points.max(axis=0) + RIM
            step = max(FINE, float(np.cbrt(np.prod(high - low) / NODES)))
            size = np.ceil((high - low) / step).astype(int) + 1
            first.append(total)
            sizes.append(size)
            lowers.append(low)
            steps.append(step)
            total += int(np.prod(size))
        distance = run.array("body/distance", total, wp.float32)
        for at, size, low, step, n in zip(first, sizes, lowers, steps, self._moving, strict=True):
            boundary = self.setup.boundaries[n]
            mesh = self._mesh(boundary.mesh.vertices / self._cell, boundary.mesh.faces, boundary.closed)
            ids = [wp.uint64(mesh if boundary.closed else 0), wp.uint64(0 if boundary.closed else mesh)]
            inputs = [*ids, wp.vec3(*low), step, wp.vec3i(*(int(s) for s in size)), float(kernels.SHELL), at, distance]
            run(kernels.sample_mesh, int(np.prod(size)), inputs, grain=1024)
        moving = self.moving
        moving.count = len(self._moving)
        moving.row = run.upload("body/row", np.array(self._moving, np.int32), wp.int32)
        moving.first = run.upload("body/first", np.array(first, np.int32), wp.int32)
        moving.size = run.upload("body/size", np.array(sizes, np.int32).reshape(-1, 3), wp.vec3i)
        moving.lower = run.upload("body/lower", np.array(lowers, np.float32).reshape(-1, 3), wp.vec3)
        moving.step = run.upload("body/step", np.array(steps, np.float32), wp.float32)
        moving.distance = distance
        self._corners = [
            np.array(list(np.ndindex(2, 2, 2))) * (s - 1) * d + low for s, d, low in zip(sizes, steps, lowers, strict=True)
        ]

    def update(self, bodies: BodyState) -> None:
        """Place all boundaries.

        Raises:
            InputError: the bodies are not as many as the boundaries.
        """
        wp, run = warp(), self.run
        if len(bodies.position) != self.count:
            raise InputError(
                f"the state of {len(bodies.position)} bodies was given for {self.count} boundaries; give one row each"
            )
        if self.fixed is None:
            self._place_fixed(bodies)
            self._build_moving()
        rows = self._moving
        position = (bodies.position[rows] - self._origin) / self._cell
        low, high = np.zeros((len(rows), 3)), np.zeros((len(rows), 3))
        for m, n in enumerate(rows):
            corners = self._corners[m] @ bodies.rotation[n].T + position[m]
            low[m], high[m] = corners.min(axis=0), corners.max(axis=0)
        self.moving.position = run.upload("body/position", position.astype(np.float32), wp.vec3)
        self.moving.rotation = run.upload("body/rotation", bodies.rotation[rows].astype(np.float32).reshape(-1, 3, 3), wp.mat33)
        self.moving.box_low = run.upload("body/box_low", low.astype(np.float32), wp.vec3)
        self.moving.box_high = run.upload("body/box_high", high.astype(np.float32), wp.vec3)

    def walls(self, name: str, bodies: BodyState, velocity: F64, spin: F64, mouths: F64) -> Any:
        """Motion of boundaries and openings for kernels."""
        wp, run = warp(), self.run
        many = self.count + len(mouths)
        rows = np.zeros((3, many, 3), np.float32)
        rows[0, : self.count], rows[0, self.count :] = velocity, mouths
        rows[1, : self.count] = spin
        rows[2, : self.count] = (bodies.center - self._origin) / self._cell
        walls = kernels.Walls()
        walls.velocity = run.upload(f"{name}/velocity", rows[0], wp.vec3)
        walls.spin = run.upload(f"{name}/spin", rows[1], wp.vec3)
        walls.center = run.upload(f"{name}/center", rows[2], wp.vec3)
        walls.cell = self._cell
        return walls

    def distance(self, points: F64, bodies: BodyState) -> F64:
        """Distance of world points to fixed boundaries [cells]."""
        wp, run = warp(), self.run
        if self.fixed is None:
            self._place_fixed(bodies)
            self._build_moving()
        assert self.fixed is not None
        result = np.empty(len(points))
        out = run.array("distance/points", 1, wp.float32)
        for n, point in enumerate((points - self._origin) / self._cell):
            inputs = [*self.fixed[:2], wp.vec3(*point), 1.0, wp.vec3i(1, 1, 1), float(kernels.SHELL), 0, out]
            run(kernels.sample_mesh, 1, inputs)
            result[n] = run.read(out, 1)[0]
        return result


def reacting(boundaries: tuple[Boundary, ...], bodies: BodyState) -> list[int]:
    """Rows of the boundaries whose bodies are moved by the liquid."""
    return [n for n, b in enumerate(boundaries) if b.motion == "dynamic" and bodies.inverse_mass[n] > 0.0]
