"""Viscosity, friction at walls, and heat of one step."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ....geometry.launch import warp

if TYPE_CHECKING:
    from ...passes import Passes
    from ..engine import LiquidSetup
    from .bodies import Coupling
    from .store import Work

__all__ = ["Viscosity"]

UNFELT = 1e-6
"""Viscosity times dt / (density spacing^2) below which nothing is done: a velocity would change by 1e-5 of itself."""
EXPLICIT = 0.01
"""The same, up to which one explicit step is stable and exact enough."""
HEAT_STEP = 0.05
"""Diffusivity times dt / spacing^2 of one explicit step of conduction; longer steps are cut into several."""


class Viscosity:
    """Viscous and thermal properties of the fluids on a device."""

    def __init__(self, setup: LiquidSetup, density: Any, passes: Passes) -> None:
        wp = warp()
        self.setup, self.passes, self._density = setup, passes, density
        device = passes.device
        rows = [(f.viscosity, f.activation, f.temperature) for f in setup.fluids]
        self._thickness = wp.array(rows, dtype=wp.vec3, device=device)
        self._heat = wp.array([(f.conductivity, f.heat_capacity) for f in setup.fluids], dtype=wp.vec2, device=device)
        self._diffusivity = max(f.conductivity / (f.density * f.heat_capacity) for f in setup.fluids)
        self._scalars = wp.zeros(2, dtype=wp.float32, device=device)
        self._ledger = wp.zeros(5, dtype=wp.float64, device=device)
        self._varies = any(f.activation for f in setup.fluids)
        self._room = 0
        self.iterations = 0

    def _make_room(self, count: int) -> None:
        if count > self._room:
            wp, device = warp(), self.passes.device
            self._room = count
            self._rest, self._way, self._image = (wp.zeros(count, dtype=wp.vec3, device=device) for _ in range(3))
            self._partial = wp.zeros(self.passes.parts(count), dtype=wp.float64, device=device)

    def apply(self, w: Work, s: Any, coupling: Coupling, h: float, n: int, dt: float, *, tolerance: float, most: int) -> bool:
        """Change velocities by viscosity; False where the solve stopped at its cap."""
        from . import viscous_kernels as kernels

        self.iterations = 0
        run = self.passes
        run("thicken", kernels.thicken, n, [s.fluid, s.temperature, self._thickness, w.viscosity])()
        light = min(f.density for f in self.setup.fluids)
        thickest = float(w.viscosity[:n].numpy().max()) if self._varies else max(f.viscosity for f in self.setup.fluids)
        number = thickest * dt / (light * self.setup.spacing**2)
        if number < UNFELT:
            return True
        self._make_room(w.capacity)
        coupling.soft.slow(coupling, w)
        lists = [w.viscosity, w.lightness, *w.lists, h, coupling.pairs, coupling.bodies]
        if number < EXPLICIT:
            coupling.rub(s.v)
            run("viscous", kernels.direct, n, [s.x, s.v, *lists, 1.0, w.settings, self._image])()
            run("explicit", kernels.blend, n, [s.v, self._image, 2.0, -1.0, s.v])()
            coupling.rubbed()
            return True
        run("viscous", kernels.direct, n, [s.x, s.v, *lists, 1.0, w.settings, self._image])()
        run("rest", kernels.blend, n, [s.v, self._image, 1.0, -1.0, self._rest])()
        run("way", kernels.blend, n, [self._rest, self._rest, 1.0, 0.0, self._way])()
        done = self._solve(w, s, lists, n, tolerance, most)
        coupling.rub(s.v)
        coupling.rubbed()
        return done

    def _dot(self, w: Work, s: Any, one: Any, two: Any, n: int, part: int) -> list[Callable[[], None]]:
        """Passes of one product and of what follows from it."""
        from . import viscous_kernels as kernels

        run, name = self.passes, f"steer{part}"
        return [
            run.fold(f"dots{part}", kernels.dots, n, [s.volume, w.lightness, one, two, self._partial]),
            run.close(name, kernels.steer, n, [self._partial, part, self._ledger, self._scalars, w.going]),
        ]

    def _solve(self, w: Work, s: Any, lists: list[Any], n: int, tolerance: float, most: int) -> bool:
        """Conjugate gradients on (1 - dt L) v = v0."""
        from . import viscous_kernels as kernels

        run, image, way, rest = self.passes, self._image, self._way, self._rest
        self._ledger.assign(np.array([0.0, 0.0, 0.0, tolerance**2, most]))
        run.chain("before_viscous", self._dot(w, s, rest, rest, n, 0))()
        iteration: list[Callable[[], None]] = [
            run("image", kernels.direct, n, [s.x, way, *lists, 0.0, w.settings, image]),
            *self._dot(w, s, way, image, n, 1),
            run("update", kernels.update, n, [self._scalars, way, image, s.v, rest]),
            *self._dot(w, s, rest, rest, n, 2),
            run("direction", kernels.warm, n, [self._scalars, rest, way]),
        ]
        run.chain("viscous", iteration, going=w.going)()
        first, left, done = (float(one) for one in self._ledger.numpy()[:3])
        self.iterations = int(done)
        return left <= tolerance**2 * first

    def conduct(self, w: Work, s: Any, h: float, n: int, dt: float) -> None:
        """Heat between neighbours; walls are insulated."""
        from . import viscous_kernels as kernels

        if self._diffusivity == 0.0:
            return
        parts = max(1, int(np.ceil(self._diffusivity * dt / (HEAT_STEP * self.setup.spacing**2))))
        lists = [*w.lists, h, dt / parts]
        for _ in range(parts):
            run = self.passes
            run("conduct", kernels.conduct, n, [s.x, s.fluid, self._density, self._heat, s.temperature, *lists, w.rate])()
            warp().copy(s.temperature, w.rate, count=n)
