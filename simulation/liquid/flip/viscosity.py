"""Viscosity of one step: an implicit solve for the velocities of faces and of the bodies that the liquid drags along."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ...grids import columns
from ...grids.runner import Runner
from ..engine import Fluid, LiquidSetup
from . import viscous_kernels as kernels
from .exchange import Exchange
from .exchange_kernels import vec6d
from .grid import Grid
from .markers import Markers

__all__ = ["Viscosity"]

LEAST = 1e-3
"""Diffusion in a step (viscosity dt / (density cell^2)) below which viscosity is left out: a tenth of what PIC's share smooths away."""
ERROR = 1e-2
"""Relative residual at which the solve ends."""


def at_temperature(fluid: Fluid, temperature: F64) -> F64:
    """Dynamic viscosity by Arrhenius' law [Pa s]."""
    return np.asarray(fluid.viscosity * np.exp(fluid.activation * (1.0 / temperature - 1.0 / fluid.temperature)))


@dataclass(frozen=True)
class Rubbed:
    """Result of a viscous step."""

    impulse: F64
    """On boundaries, openings and the domain (last), linear and about their centres [N s, N m s]."""
    kick: F64
    """Change of the boundaries' velocities (b, 3) [m/s]."""
    spin: F64
    """And of their angular velocities [rad/s]."""
    iterations: int
    capped: bool


class Viscosity:
    """Viscosity of one run. Boundaries rub by their `friction`, closed sides of the domain are smooth."""

    def __init__(self, run: Runner, setup: LiquidSetup) -> None:
        self.run, self.setup = run, setup
        self._cell, self._density = float(setup.spacing), setup.fluids[0].density
        friction = [b.friction for b in setup.boundaries] + [0.0] * len(setup.inflows)
        self.friction = run.upload("viscous/friction", np.array([*friction, 0.0], np.float32), warp().float32)
        self._slots = -1
        self.least = self.most = 0.0
        """Least and greatest viscosity of the particles [Pa s]."""

    def look(self, markers: Markers, dt: float) -> float | None:
        """Share of motion below a cell's size that survives viscosity in a step of `dt`; None where viscosity does not count."""
        if len(markers.identity) != self._slots:
            self._slots = len(markers.identity)
            known = np.zeros(self._slots)
            for n, fluid in enumerate(self.setup.fluids):
                mine = markers.fluid == n
                known[mine] = at_temperature(fluid, markers.temperature[mine])
            self.least, self.most = (float(f(known)) if len(known) else 0.0 for f in (np.min, np.max))
            self.run.upload("viscous/known", known.astype(np.float32), warp().float32)
        scale = dt / (self._density * self._cell**2)
        return math.exp(-(math.pi**2) * self.least * scale) if self.most * scale >= LEAST else None

    def apply(self, grid: Grid, exchange: Exchange, markers: Markers, row: Any, dt: float, cap: int) -> Rubbed:
        """Change the velocities of faces (`new`)."""
        wp, run, n = warp(), self.run, grid.cells
        self._grid, self._exchange = grid, exchange

        def faces(name: str) -> Any:
            return run.array(name, n, wp.vec3)

        def numbers(name: str) -> Any:
            return run.array(name, n, wp.float32)

        solids = int(exchange.solids.count > 0)
        wall, thickness = run.array("viscous/wall", n, wp.vec3i), numbers("viscous/thickness")
        scale = dt / (self._density * self._cell**2)
        many = grid.columns.nx * grid.columns.ny
        known = run.array("viscous/known", 1, wp.float32)
        state = [grid.columns, grid.head, markers.position, markers.slot, known, scale, thickness, numbers("viscous/count")]
        run(kernels.thicken, many, state, grain=64)
        opening, owner = faces("opening"), run.array("face_owner", n, wp.vec3i)
        mass, legs = faces("viscous/mass"), run.array("viscous/legs", n, columns.vec6)
        run(
            kernels.find_mass, n, [grid.near, numbers("phi"), solids, numbers("solid"), opening, owner, self.friction, mass, wall]
        )
        middle, edge = numbers("viscous/middle"), faces("viscous/edge")
        state = [grid.near, numbers("phi"), numbers("room"), solids, numbers("solid"), self.friction, thickness, wall]
        run(kernels.find_weights, n, [*state, middle, edge, legs])
        inverse = faces("viscous/inverse")
        run(kernels.divide, n, [grid.near, middle, edge, legs, mass, wall, inverse])
        self._u, self._r, self._p, self._ap = (faces(f"viscous/{name}") for name in ("u", "r", "p", "ap"))
        normal, shear = faces("viscous/normal"), faces("viscous/shear")
        self._wall, self._inverse = wall, inverse
        self._strain, self._stress = [grid.near, middle, edge, legs], [normal, shear]
        self._force = [grid.near, legs, mass, wall]
        wp.copy(self._u, faces("new"), count=n)
        rubbed = self._solve(mass, cap)
        run(kernels.put_back, n, [grid.near, row, opening, self._u, faces("new")])
        return rubbed

    def _multiply(self, u: Any, walls: Any, out: Any) -> None:
        self.run(kernels.fill_walls, self._grid.cells, [self._grid.columns, self._wall, walls, u])
        self.run(kernels.strain, self._grid.cells, [*self._strain, u, *self._stress])
        self.run(kernels.force, self._grid.cells, [*self._force, u, *self._stress, out])

    def _walls(self, name: str, kick: F64, spin: F64) -> Any:
        exchange = self._exchange
        return exchange.solids.walls(f"viscous/{name}", exchange.bodies, kick, spin, np.zeros_like(exchange.mouths))

    def _pull(self, owners: list[int], walls: Any, force: Any) -> F64:
        """Sums of `force` over the wall faces of owners: along axes, and about their centres [m]."""
        run, n, wp = self.run, self._grid.cells, warp()
        blocks = -(-n // run.block)
        if not owners:
            return np.zeros((0, 6))
        sums = run.array("viscous/pulls", len(owners) * blocks, vec6d)
        who = run.upload("viscous/owners", np.array(owners, np.int32), wp.int32)
        inputs = [n, run.block, blocks, self._grid.columns, who, self._wall, walls, force, sums]
        run(kernels.drag, len(owners) * blocks, inputs, grain=16)
        found = run.read(sums, len(owners) * blocks).reshape(len(owners), blocks, 6).sum(axis=1)
        found[:, 3:] *= self._cell
        return np.asarray(found)

    def _product(self, a: Any, b: Any, scaled: bool) -> float:
        run, n = self.run, self._grid.cells
        blocks = -(-n // run.block)
        sums = run.array("viscous/sums", blocks, warp().float64)
        run(kernels.sum_pairs, blocks, [n, run.block, self._inverse, a, b, int(scaled), sums], grain=16)
        return float(run.read(sums, blocks).sum())

    def _solve(self, mass: Any, cap: int) -> Rubbed:
        """Conjugate gradients over faces and reacting bodies, from the velocities before."""
        run, n, exchange = self.run, self._grid.cells, self._exchange
        rows, count = exchange.reacting, exchange.solids.count
        u, r, p, ap = self._u, self._r, self._p, self._ap
        self._multiply(u, exchange.walls, r)
        pull = self._pull(rows, exchange.walls, r)
        run(kernels.begin, n, [mass, u, r])
        p.zero_()
        body_r = -pull
        # Of reacting bodies: change of velocity, direction of search, and that times their mass in cells.
        moved, way, weighed = (np.zeros((len(rows), 6)) for _ in range(3))
        before = first = 0.0
        iterations, capped = 0, False
        while True:
            kick, spin = exchange.answer(rows, exchange.mass * body_r)
            asked = np.column_stack([kick[rows], spin[rows]])
            now = self._product(r, r, scaled=True) + float((body_r * asked).sum())
            first = first or now
            if now <= ERROR**2 * first or now <= 1e-16 * self._product(u, u, scaled=False):
                break
            if iterations == cap:
                capped = True
                break
            beta = now / before if before > 0.0 else 0.0
            before = now
            run(kernels.turn, n, [beta, self._inverse, r, p])
            way, weighed = asked + beta * way, body_r + beta * weighed
            kick, spin = np.zeros((count, 3)), np.zeros((count, 3))
            kick[rows], spin[rows] = way[:, :3], way[:, 3:]
            walls = self._walls("way", kick, spin)
            self._multiply(p, walls, ap)
            body_ap = self._pull(rows, walls, ap) + weighed
            alpha = now / (self._product(p, ap, scaled=False) + float((way * body_ap).sum()))
            run(kernels.advance_all, n, [alpha, self._inverse, p, ap, u, r])
            moved, body_r = moved + alpha * way, body_r - alpha * body_ap
            iterations += 1
        kick, spin = np.zeros((count, 3)), np.zeros((count, 3))
        kick[rows], spin[rows] = moved[:, :3], moved[:, 3:]
        impulse = self._impulse(kick, spin) if count else np.zeros((count + len(exchange.mouths) + 1, 6))
        return Rubbed(impulse, kick, spin, iterations, capped)

    def _impulse(self, kick: F64, spin: F64) -> F64:
        """On every boundary, opening and the domain, at the velocities found."""
        exchange = self._exchange
        walls = exchange.moved(kick, spin)
        self._multiply(self._u, walls, self._ap)
        owners = [*range(exchange.solids.count + len(exchange.mouths)), -1]
        return -exchange.mass * self._pull(owners, walls, self._ap)
