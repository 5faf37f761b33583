"""Inflows and outflows: particles enter in layers and leave by boxes and open sides, each with its mass."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ....worlds.errors import InputError
from ...grids.runner import Runner
from ..engine import Inflow, LiquidSetup, Particles
from ..stages import Stages
from . import solid_kernels
from .markers import Markers

__all__ = ["Sources"]


class _Mouth:
    """One inflow: a lattice of points, each of which stands for a part of its area."""

    def __init__(self, inflow: Inflow, step: float) -> None:
        self.inflow, self.step = inflow, step
        half = inflow.half_size
        counts = [max(1, round(2.0 * h / step)) for h in half]
        ticks = [((np.arange(n) + 0.5) / n * 2.0 - 1.0) * h for n, h in zip(counts, half, strict=True)]
        grid = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 2)
        area = 4.0 * half[0] * half[1]
        if inflow.round:
            grid = grid[(grid[:, 0] / half[0]) ** 2 + (grid[:, 1] / half[1]) ** 2 <= 1.0]
            area *= math.pi / 4.0
        self.points = grid
        self.part = area / len(grid)
        """Area of one point [m^2]."""
        self.size = np.array([2.0 * h / n for h, n in zip(half, counts, strict=True)])
        self.travel = 0.0
        """Way of the flow since the last layer [m]."""
        self.share = 1.0
        """Part of its speed at which it flows in this step."""
        self.layers = 0

    def world(self, points: F64, ahead: float | F64) -> F64:
        """World coordinates of points of the plane, moved along its normal."""
        local = np.column_stack([points, np.broadcast_to(ahead, len(points))])
        return np.asarray(self.inflow.center + local @ np.asarray(self.inflow.rotation).T)

    @property
    def speed(self) -> float:
        """Speed of the flow in this step [m/s]."""
        return self.share * self.inflow.speed

    def active(self, time: float, dt: float) -> float:
        """Seconds of a step during which it may flow."""
        return max(0.0, min(time + dt, self.inflow.end) - max(time, self.inflow.start))


class Sources:
    """Everything that lets liquid in and out of one run."""

    def __init__(self, run: Runner, setup: LiquidSetup, origin: F64) -> None:
        self.run, self.setup = run, setup
        self._cell = float(setup.spacing)
        self._origin = origin
        self.mouths = [_Mouth(inflow, 0.5 * self._cell) for inflow in setup.inflows]
        wp, many = warp(), len(setup.outflows)

        def cells(points: Any) -> NDArray[np.float32]:
            return ((np.asarray(points, dtype=np.float64).reshape(-1, 3) - origin) / self._cell).astype(np.float32)

        self._half = np.array([o.half_size for o in setup.outflows]).reshape(many, 3) / self._cell
        self._boxes = [
            run.upload("outflow/center", cells([o.center for o in setup.outflows]), wp.vec3),
            run.upload("outflow/rotation", np.array([o.rotation for o in setup.outflows], np.float32).reshape(many, 3, 3), wp.mat33),
            run.upload("outflow/half", self._half.astype(np.float32), wp.vec3),
        ]  # fmt: skip
        count = len(self.mouths)
        self._planes = [
            run.upload("inflow/center", cells([m.inflow.center for m in self.mouths]), wp.vec3),
            run.upload(
                "inflow/rotation", np.array([m.inflow.rotation for m in self.mouths], np.float32).reshape(count, 3, 3), wp.mat33
            ),
        ]
        self._losing = bool(setup.outflows) or "open" in setup.sides
        self.stages = Stages(setup)

    def look(self, markers: Markers, dt: float) -> None:
        """Open and shut what holds a level for a step, by where the surface is now."""
        if not self.stages.acts:
            return
        place = self.run.read(markers.position, markers.total)
        self.stages.look(markers.origin + self._cell * place[:, :3].astype(np.float64), place[:, 3] * self._cell**3, dt)
        for mouth, share in zip(self.mouths, self.stages.inflow, strict=True):
            mouth.share = float(share)
        half = self._half * np.where(self.stages.outflow > 0.0, np.cbrt(self.stages.outflow), -1.0)[:, None]
        self._boxes[2] = self.run.upload("outflow/half", half.astype(np.float32), warp().vec3)

    def clear_solids(self, distance: Any) -> None:
        """Drop the points of openings that lie in solids or outside the domain; `distance` maps world points to cells.

        Raises:
            InputError: an inflow has no free point.
        """
        lower, upper = np.asarray(self.setup.lower), np.asarray(self.setup.upper)
        for mouth in self.mouths:
            world = mouth.world(mouth.points, 0.25 * self._cell)
            free = (distance(world) > 0.0) & (world >= lower).all(axis=1) & (world <= upper).all(axis=1)
            if not free.any():
                raise InputError(
                    f"inflow {mouth.inflow.name!r} lies in a solid or outside the domain at all of its {len(world)} points; "
                    "move it into the open"
                )
            mouth.points = mouth.points[free]

    def speeds(self, time: float, dt: float) -> tuple[F64, Any]:
        """Velocities of the openings [m/s], shape (k, 3), and their half sizes for the grid; shut ones are marked."""
        half = np.array([(*m.inflow.half_size, 0.0) for m in self.mouths]).reshape(-1, 3) / self._cell
        velocity = np.zeros((len(self.mouths), 3))
        for n, mouth in enumerate(self.mouths):
            velocity[n] = mouth.speed * np.asarray(mouth.inflow.rotation)[:, 2]
            half[n, 2] = 1.0 if mouth.inflow.round else 0.0
            if mouth.active(time, dt) <= 0.0 or mouth.share <= 0.0:
                half[n, 2] = -1.0
        return velocity, self.run.upload("inflow/half", half.astype(np.float32), warp().vec3)

    def shape(self) -> list[Any]:
        """Planes of the openings on the device: centres and rotations."""
        return self._planes

    def let_in(self, markers: Markers, time: float, dt: float) -> dict[str, float]:
        """Append the layers that crossed the openings in a step; mass by inflow [kg]."""
        added = {}
        for number, mouth in enumerate(self.mouths):
            inflow = mouth.inflow
            mouth.travel += mouth.speed * mouth.active(time, dt)
            mass = 0.0
            while mouth.travel >= mouth.step:
                mouth.travel -= mouth.step
                random = np.random.default_rng((self.setup.seed, number, mouth.layers))
                mouth.layers += 1
                n = len(mouth.points)
                spread = 0.25 * random.uniform(-1.0, 1.0, (n, 2)) * mouth.size
                position = mouth.world(mouth.points + spread, mouth.travel)
                inset = 1e-3 * self._cell
                position = np.clip(position, np.asarray(self.setup.lower) + inset, np.asarray(self.setup.upper) - inset)
                fluid = self.setup.fluids[inflow.fluid]
                markers.add(
                    Particles(
                        position,
                        np.tile(mouth.speed * np.asarray(inflow.rotation)[:, 2], (n, 1)),
                        np.arange(markers.next, markers.next + n, dtype=np.int32),
                        np.full(n, inflow.fluid, np.int32),
                        np.full(n, mouth.part * mouth.step),
                        np.full(n, fluid.density),
                        np.zeros(n),
                        np.full(n, fluid.temperature),
                    )
                )
                mass += fluid.density * mouth.part * mouth.step * n
            added[inflow.name] = mass
        return added

    def take_out(self, markers: Markers, left: Any) -> dict[str, float]:
        """Remove particles that `left` the domain or are in an outflow; mass by outflow and `domain` [kg]."""
        removed = dict.fromkeys([o.name for o in self.setup.outflows], 0.0) | {"domain": 0.0}
        if not self._losing or markers.total == 0:
            return removed
        run, n = self.run, markers.total
        run(solid_kernels.take_out, n, [len(self.setup.outflows), *self._boxes, markers.position, left], grain=16384)
        gone = run.read(left, n)
        rows = np.flatnonzero(gone)
        if not len(rows):
            return removed
        slot = run.read(markers.slot, n)[rows]
        mass = markers.volume[slot] * np.array([f.density for f in self.setup.fluids])[markers.fluid[slot]]
        for code, name in enumerate(["domain", *(o.name for o in self.setup.outflows)], start=1):
            removed[name] = float(mass[gone[rows] == code].sum())
        markers.dead += len(rows)
        return removed
