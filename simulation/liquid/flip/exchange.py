"""Momentum between liquid and boundaries: bodies inside the pressure system (Batty et al. 2007), wrenches, what the liquid felt.

At a thin wall no cell inside the solid carries the pressure: the half cell of liquid before it moves as the wall does. Its momentum
goes to the wall when the solve starts, and a body that reacts is heavier by it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ...boundaries import BodyState
from ...grids.multigrid import Level
from ...grids.runner import Runner
from . import exchange_kernels as kernels
from .solids import Solids, reacting
from .supports import Support

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
        """Mass of a full cell [kg]."""
        self.supports: dict[int, Support] = {}
        """Bodies that do not give way along what bears them."""
        wp, rows = warp(), level.rows
        flags = [run.array(f"touch/{name}", rows + 1, wp.int32) for name in ("flag", "thin")]
        run(kernels.touching, rows, [shut, *flags])
        self._touched, self._count = self._listed("rows", flags[0], rows)
        self._thin, self._thin_count = self._touched, 0
        if self.solids.count:
            self._thin, self._thin_count = self._listed("thin rows", flags[1], rows)
        self.reacting = reacting(solids.setup.boundaries, bodies)
        self._owners = [*range(solids.count + len(mouths)), -1]

    def _listed(self, name: str, flag: Any, rows: int) -> tuple[Any, int]:
        """Flagged rows and how many they are."""
        wp, run = warp(), self.run
        before = run.array("touch/before", rows + 1, wp.int32)
        flag[rows : rows + 1].zero_()
        count = run.scan(flag, before, rows + 1)
        listed = run.array(f"touch/{name}", count, wp.int32)
        run(kernels.list_rows, rows, [flag, before, listed])
        return listed, count

    def _hold(self, speeds: Any) -> None:
        """Take the half cells at thin walls along: their momentum, their inertia, and what reacting bodies make of both.

        Sets `_momentum` (n, 6) and `_inertia` (n, 6, 6) of all owners [kg m/s, kg m^2/s; kg, kg m, kg m^2] and `_give`, from an
        impulse to a change of velocity and spin (reacting bodies, 6, 6).
        """
        wp, run, many = warp(), self.run, len(self._owners)
        found = np.zeros((many, 27))
        if self._thin_count:
            blocks = -(-self._thin_count // BLOCK)
            sums = run.array("hold/sums", many * blocks, kernels.vec27d)
            who = run.upload("hold/owners", np.array(self._owners, np.int32), wp.int32)
            inputs = [self._grid, self._shut, self._thin, self._thin_count, BLOCK, blocks, who, self.walls, speeds, sums]
            run(kernels.hold, many * blocks, inputs, grain=4)
            found = self.mass * run.read(sums, many * blocks).reshape(many, blocks, 27).sum(axis=1)
        size = np.repeat([1.0, self.solids._cell], 3)
        self._momentum = found[:, :6] * size
        upper = np.zeros((many, 6, 6))
        upper[(slice(None), *np.triu_indices(6))] = found[:, 6:]
        whole = upper + np.triu(upper, 1).transpose(0, 2, 1)
        self._inertia = whole * size[:, None] * size
        own = np.zeros((len(self.reacting), 6, 6))
        for k, row in enumerate(self.reacting):
            own[k, :3, :3] = self._lightness(row)
        own[:, 3:, 3:] = self.bodies.mobilities()[1][self.reacting]
        self._give = np.linalg.solve(np.eye(6) + own @ self._inertia[self.reacting], own)
        before = self._of_owners()
        kick, spin = self._given(self._stuck(before)[self.reacting])
        self.moved(kick, spin)

    def _lightness(self, row: int) -> F64:
        """Change of a body's velocity by an impulse (3, 3) [1/kg]; where nobody told what holds it, none along what bears it.

        What is told is taken as it is: contacts are a little soft, and push a body that the liquid presses on upwards where it does not.
        """
        whole = self.bodies.mobilities()[0][row]
        if self.bodies.mobility is not None or row not in self.supports:
            return np.asarray(whole)
        across = np.eye(3) - np.outer(self.supports[row].way, self.supports[row].way)
        return np.asarray(across @ whole @ across)

    def _of_owners(self) -> F64:
        """Velocity and spin of every owner now, (n, 6)."""
        result = np.zeros((len(self._owners), 6))
        count = self.solids.count
        result[:count, :3], result[:count, 3:], result[count:-1, :3] = self.velocity, self.spin, self.mouths
        return result

    def _stuck(self, motion: F64) -> F64:
        """Impulse on every owner of the half cells that now move with it, (n, 6)."""
        return np.asarray(self._momentum - np.einsum("nij,nj->ni", self._inertia, motion))

    def _given(self, impulse: F64) -> tuple[F64, F64]:
        """Changes of velocity and spin of all boundaries by impulses on the reacting ones, half cells at them included."""
        kick, spin = np.zeros((self.solids.count, 3)), np.zeros((self.solids.count, 3))
        change = np.einsum("nij,nj->ni", self._give, impulse)
        kick[self.reacting], spin[self.reacting] = change[:, :3], change[:, 3:]
        return kick, spin

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

    def start(self, right: Any, speeds: Any, dt: float) -> None:
        """Add the flux of walls that move by themselves, and by the half cells that stick to them, to the right side.

        Args:
            right: of the rows.
            speeds: of faces before the pressure.
            dt: of the step [s].
        """
        bodies = self.bodies
        self.velocity = bodies.velocity + dt * bodies.acceleration * (bodies.inverse_mass > 0.0)[:, None]
        self.spin = bodies.angular_velocity
        self.walls = self.solids.walls("walls", bodies, self.velocity, self.spin, self.mouths)
        self._still = not (self.velocity.any() or bodies.angular_velocity.any() or self.mouths.any())
        self.again(right, speeds)

    def add(self, p: Any, ap: Any) -> float:
        """Add the answer of reacting bodies to A p; returns its part of p A p."""
        rows = self.reacting
        if not rows:
            return 0.0
        sums = self._sums(rows, p, self.walls)
        kick, spin = self._given(self.mass * sums)
        walls = self.solids.walls("answer", self.bodies, kick, spin, np.zeros_like(self.mouths))
        self._push(ap, walls, 1.0)
        return float((sums[:, :3] * kick[rows]).sum() + (sums[:, 3:] * spin[rows]).sum())

    def moved(self, kick: F64, spin: F64) -> Any:
        """Take changes of the boundaries' velocities (b, 3) and give the walls' motion after them."""
        self.velocity, self.spin = self.velocity + kick, self.spin + spin
        self._still = self._still and not (kick.any() or spin.any())
        self.walls = self.solids.walls("walls", self.bodies, self.velocity, self.spin, self.mouths)
        return self.walls

    def again(self, right: Any, speeds: Any) -> None:
        """Add the flux of walls as they move now to the right side of a second solve."""
        if self.solids.count:
            self._hold(speeds)
        if not self._still:
            self._push(right, self.walls, -1.0)

    def path(self) -> Any:
        """Mean motion of the boundaries over the step, for kernels: forces act evenly over it."""
        velocity, spin = (
            0.5 * (a + b) for a, b in ((self.bodies.velocity, self.velocity), (self.bodies.angular_velocity, self.spin))
        )
        return self.solids.walls("path", self.bodies, velocity, spin, self.mouths)

    def answer(self, rows: list[int], impulse: F64) -> tuple[F64, F64]:
        """Changes of velocity and angular velocity of all boundaries by impulses on the given ones (n, 6)."""
        kick, spin = np.zeros((self.solids.count, 3)), np.zeros((self.solids.count, 3))
        for n, given in zip(rows, impulse, strict=True):
            kick[n] = self._lightness(n) @ given[:3]
            spin[n] = self.bodies.mobilities()[1][n] @ given[3:]
        return kick, spin

    def end(self, q: Any) -> F64:
        """Impulse on each boundary, then on openings and on the domain (last) [N s, N m s]; walls move as after it."""
        many = self.solids.count + len(self.mouths)
        if not self.solids.count:
            return np.zeros((many + 1, 6))
        impulse = self.mass * self._sums(self._owners, q, self.walls)
        self.moved(*self._given(impulse[self.reacting]))
        return np.asarray(impulse + self._stuck(self._of_owners()))

    def felt(self, impulse: F64, change: F64) -> F64:
        """Change of the liquid's own momentum through each boundary, about its centre (b, 6).

        Args:
            impulse: of `end`.
            change: measured change of the liquid's momentum by the pressure, about the grid's origin [kg m/s, kg m^2/s].

        The measured change has no place of its own for each boundary: what it differs from the sum of all impulses by is shared in
        proportion to them.
        """
        count = self.solids.count
        centers = np.zeros((len(impulse), 3))
        centers[:count] = self.bodies.center - self.solids._origin
        force, turn = impulse[:, :3], impulse[:, 3:]
        more = _shared(force, change[:3] + force.sum(axis=0))
        rest = change[3:] + (turn + np.cross(centers, force - more)).sum(axis=0)
        return np.column_stack([more - force, _shared(turn, rest) - turn])[:count]


def _shared(size: F64, rest: F64) -> F64:
    """Parts of `rest` in proportion to the sizes of rows, axis by axis."""
    part = np.abs(size)
    return np.asarray(part / np.maximum(part.sum(axis=0), 1e-300) * rest)
