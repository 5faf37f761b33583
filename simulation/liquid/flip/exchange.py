"""Momentum between liquid and boundaries: bodies inside the pressure system (Batty et al. 2007), wrenches, what the liquid felt."""

from __future__ import annotations

from typing import Any

import numpy as np

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ...boundaries import BodyState
from . import solid_kernels as kernels
from .multigrid import Level
from .run import Runner
from .solids import Solids, reacting

__all__ = ["Exchange"]

BLOCK = 256
"""Touching rows summed by one thread."""


class Exchange:
    """One step's exchange."""

    def __init__(
        self, run: Runner, solids: Solids, bodies: BodyState, level: Level, grid: Any, shut: kernels.Shut, mouths: F64
    ) -> None:
        self.run, self.solids, self.bodies = run, solids, bodies
        self._grid, self._shut = grid, shut
        self.mouths = mouths
        self.mass = 0.0
        """Of a full cell [kg]."""
        wp, rows = warp(), level.rows
        flag, before = run.array("touch/flag", rows + 1, wp.int32), run.array("touch/before", rows + 1, wp.int32)
        run(kernels.touching, rows, [shut, flag])
        flag[rows : rows + 1].zero_()
        self._count = run.scan(flag, before, rows + 1)
        self._touched = run.array("touch/rows", self._count, wp.int32)
        run(kernels.list_rows, rows, [flag, before, self._touched])
        self.reacting = reacting(solids.setup.boundaries, bodies)

    def _sums(self, owners: list[int], q: Any, walls: Any) -> F64:
        """Sums of q over the solid faces of each owner: along axes, and about its centre [m], (n, 6)."""
        wp, run = warp(), self.run
        blocks = -(-self._count // BLOCK)
        many = len(owners)
        if not many or not blocks:
            return np.zeros((many, 6))
        sums = run.array("wrench/sums", many * blocks, kernels.vec6d)
        who = run.upload("wrench/owners", np.array(owners, np.int32), wp.int32)
        inputs = [self._grid, self._shut, self._touched, self._count, BLOCK, blocks, who, walls, q, sums]
        run(kernels.wrench, many * blocks, inputs, grain=4)
        found = run.read(sums, many * blocks).reshape(many, blocks, 6).sum(axis=1)
        found[:, 3:] *= self.solids._cell
        return np.asarray(found)

    def _push(self, target: Any, walls: Any, scale: float) -> None:
        self.run(kernels.push_rows, self._count, [self._grid, self._shut, self._touched, walls, target, scale], grain=1024)

    def start(self, right: Any, dt: float) -> None:
        """Add the flux of walls that move by themselves to the right side."""
        bodies = self.bodies
        self.velocity = bodies.velocity + dt * bodies.acceleration * (bodies.inverse_mass > 0.0)[:, None]
        self.spin = bodies.angular_velocity
        self.walls = self.solids.walls("walls", bodies, self.velocity, self.spin, self.mouths)
        self._still = not (self.velocity.any() or bodies.angular_velocity.any() or self.mouths.any())
        if not self._still:
            self._push(right, self.walls, -1.0)

    def add(self, p: Any, ap: Any) -> float:
        """Add the answer of reacting bodies to A p; returns its part of p A p."""
        rows = self.reacting
        if not rows:
            return 0.0
        sums = self._sums(rows, p, self.walls)
        kick, spin = self.answer(rows, self.mass * sums)
        walls = self.solids.walls("answer", self.bodies, kick, spin, np.zeros_like(self.mouths))
        self._push(ap, walls, 1.0)
        return float((sums[:, :3] * kick[rows]).sum() + (sums[:, 3:] * spin[rows]).sum())

    def moved(self, kick: F64, spin: F64) -> Any:
        """Take changes of the boundaries' velocities (b, 3) and give the walls' motion after them."""
        self.velocity, self.spin = self.velocity + kick, self.spin + spin
        self._still = self._still and not (kick.any() or spin.any())
        self.walls = self.solids.walls("walls", self.bodies, self.velocity, self.spin, self.mouths)
        return self.walls

    def again(self, right: Any) -> None:
        """Add the flux of walls as they move now to the right side of a second solve."""
        if not self._still:
            self._push(right, self.walls, -1.0)

    def answer(self, rows: list[int], impulse: F64) -> tuple[F64, F64]:
        """Changes of velocity and angular velocity of all boundaries by impulses on the given ones (n, 6)."""
        kick, spin = np.zeros((self.solids.count, 3)), np.zeros((self.solids.count, 3))
        for n, given in zip(rows, impulse, strict=True):
            kick[n] = self.bodies.inverse_mass[n] * given[:3]
            spin[n] = self.bodies.inverse_inertia[n] @ given[3:]
        return kick, spin

    def end(self, q: Any) -> F64:
        """Impulse on each boundary, then on mouths and on the domain (last) [N s, N m s]; walls move as after it."""
        many = self.solids.count + len(self.mouths)
        if not self.solids.count:
            return np.zeros((many + 1, 6))
        impulse = self.mass * self._sums([*range(many), -1], q, self.walls)
        kick, spin = self.answer(self.reacting, impulse[self.reacting])
        self.moved(kick, spin)
        return impulse

    def felt(self, impulse: F64, change: F64) -> F64:
        """What the liquid's own momentum changed by through each boundary, about its centre (b, 6).

        Args:
            impulse: of `end`.
            change: measured change of the liquid's momentum by the pressure, about the grid's origin [kg m/s, kg m^2/s].

        The measured change has no place of its own for each boundary: what it differs from the sum of all impulses by is shared in
        proportion to them.
        """
        count = self.solids.count
        centers = self.bodies.center - self.solids._origin
        about = impulse.copy()
        about[:count, 3:] += np.cross(centers, impulse[:count, :3])
        if len(self.mouths):
            about[count:-1, 3:] += np.cross(self._mouth_centers(), impulse[count:-1, :3])
        rest = change + about.sum(axis=0)
        size = np.abs(about)
        part = size / np.maximum(size.sum(axis=0), 1e-300)
        felt = -about + part * rest
        felt[:count, 3:] -= np.cross(centers, felt[:count, :3])
        return np.asarray(felt[:count])

    def _mouth_centers(self) -> F64:
        return np.zeros((len(self.mouths), 3))
