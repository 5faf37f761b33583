"""A gas in a fixed box of cells: velocities on faces, amounts in cells, one projection or two per step.

A step: velocities are carried, forces act, the projection gives every cell the outflow that its expansion asks for, and that flow takes
the amounts along, so that their sums stay. Lightness is 1 - density / density of the ambient air (at one pressure that is
1 - ambient temperature / temperature), so heat and mass are one quantity; Boussinesq gas has its excess temperature there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import chosen_device, warp
from ...physics.substances import AIR_HEAT_CAPACITY, air_density
from ...worlds.arrays import F64
from ..grids.columns import vec6i
from ..grids.multigrid import Solution
from ..grids.row_kernels import greatest_of_three
from ..grids.runner import BEFORE, Runner
from . import box_kernels as boxes
from . import force_kernels as forces
from . import transport_kernels as transport
from .border import Border, side_faces
from .carry import Carrier, Motion, motion
from .fields import FUEL, LIGHTNESS, MOTION, PACKED, PRODUCT, SOOT, GasFields
from .fire import Fire
from .levels import Levels
from .pressure import Flow, Projection
from .pressure_kernels import densities
from .regions import Regions
from .settings import GasSettings, Side
from .solids import Solids, enclosed, passable
from .transport import ALL, RUNS, Transport

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["FUEL", "LIGHTNESS", "MOTION", "PACKED", "PRODUCT", "SOOT", "Gas", "GasReport", "Solids"]

MADE = 0.5
"""Own choice: most volume that sources and heat make per volume in a step."""
LEAST_SPEED = 1e-9
ROWS = 64
"""Own choice: rows of cells that are worth a thread of a CPU."""


@dataclass(frozen=True)
class GasReport:
    """One step."""

    seconds: float
    iterations: int
    capped: bool
    divergence: float
    """Largest difference of the flux out of a cell from what it should be, over the largest speed."""
    courant: float


class Gas(GasFields):
    """A gas in a box.

    Args:
        shape: cells along x, y, z.
        cell: their size [m].
        sides: x-, x+, y-, y+, z-, z+; an axis is periodic on both or none.
        settings: of the engine.
        gravity: [m/s^2].
        solids: what is not open; the whole box when left out.
        moves: whether solids will move (`step`): cells then have their true room, and steps take longer.
        device: where it runs.
    """

    def __init__(
        self, shape: tuple[int, int, int], cell: float, sides: Sequence[Side], settings: GasSettings | None = None, *,
        gravity: tuple[float, float, float] = (0.0, 0.0, -9.81), solids: Solids | None = None, moves: bool = False,
        device: str | None = None,
    ) -> None:  # fmt: skip
        wp = warp()
        self.shape, self.cell, self.settings, self.gravity = shape, cell, settings or GasSettings(), gravity
        self.run = Runner(chosen_device(device), keeps=True)
        self.elements = math.prod(n + 1 for n in shape)
        self._box = boxes.Box()
        self._box.nx, self._box.ny, self._box.nz = shape
        self._pull = wp.vec3(*gravity)
        self._box.wraps = wp.vec3i(*(int(sides[2 * a] == "periodic") for a in range(3)))
        self._sides = self._box.opens = vec6i(*(int(s == "open") for s in sides))
        starts, self.outer = side_faces(shape)
        """Middles of the faces of all sides [cells], shape (n, 3)."""
        self._box.starts = wp.vec3i(*starts)
        self._box.beyond = self.run.upload("gas/beyond", np.zeros((len(self.outer), 3), np.float32), wp.vec3)
        self._named, self._moves = tuple(sides), moves
        self._no_slip = self.run.upload("gas/no_slip", np.array([s == "closed" for s in sides], np.int32), wp.int32)
        self._walls = self.run.upload("gas/walls", np.zeros((6, 2), np.float32), wp.vec2)
        self._expansion = self.run.upload("gas/expansion", np.zeros(self.elements, np.float32), wp.float32)
        self._growth = self.run.upload("gas/growth", np.zeros(self.elements, np.float32), wp.float32)
        self._levels = Levels(self.run, self._box, shape)
        self._carrier = Carrier(self.run, self._box, shape)
        self._stand(enclosed(shape, sides, solids, widen=not moves))
        # Air lies before the first element too, below the first row.
        self._air = self.run.upload("gas/density", np.ones(self.elements + 2 * BEFORE, np.float32), wp.float32)[BEFORE:]
        self._content = self.run.upload("gas/content", np.zeros((self.elements, 4), np.float32), wp.vec4)
        self._rate = self.run.upload("gas/rate", np.zeros(self.elements, np.float32), wp.float32)
        self._heating = self.run.upload("gas/heating", np.zeros(self.elements, np.float32), wp.float32)
        self.density = air_density(self.settings.ambient_temperature)
        """Density of the ambient air [kg/m^3]."""
        self.load = 1.0 / self.density
        """Density that a unit of soot [kg/m^3] adds, relative to the air's."""
        self._sums = wp.zeros((4, -(-self.elements // self.run.block)), dtype=wp.float64, device=self.run.device)
        self.border = Border(self.run, shape)
        self.transport = Transport(self.run, shape, self._box, cell, self.border, expands=self.settings.expands)
        self.transport.fit(self._opening)
        self.fire = self._light()
        self._box.density = 0.0 if self.fire is None else self.density
        self.steps, self._last = 0, 0.0
        self.injected = np.zeros(4)
        """Amounts that sources have added."""
        self.velocity = np.zeros((self.elements, 3), np.float32)
        self.run.upload("state", np.zeros((self.elements, 4), np.float32), wp.vec4)

    def _stand(self, solids: Solids) -> None:
        """Take over solids that stand."""
        self._at, self._turned = solids, False
        self._fit(solids, solids.room, solids.room)
        self._growth.zero_()

    def _turn(self, solids: Solids, seconds: float) -> None:
        """Take over solids that reach another place at the end of a step: faces are open by the mean over it, and what cells lose of their
        room is what their gas has to leave."""
        before, after = self._at, enclosed(self.shape, self._named, solids, widen=False)
        grown = after.room - before.room
        middle = Solids(0.5 * (before.room + after.room), passable(before, after), after.velocity)
        self._fit(middle, before.room, after.room)
        # Gas shut up where nothing is left at the end has nowhere to go: it is counted as crushed.
        shut = np.append(self.regions.sealed & (self.regions.volume <= 0.0), False)[self.regions.number].reshape(grown.shape)
        self.run.upload("gas/growth", (np.where(shut, 0.0, grown) / seconds).astype(np.float32).ravel(), warp().float32)
        self._grown = self.regions.sums(grown)
        self._at, self._turned = after, True

    def _fit(self, solids: Solids, held: NDArray[np.float32], end: NDArray[np.float32]) -> None:
        """Faces, regions and the pressure system of a step between solids; `held` and `end`: rooms of cells at its start and its end."""
        run = self.run
        room, opening, velocity = solids.room, solids.opening, solids.velocity
        self._room = run.upload("gas/room", end.ravel(), warp().float32)
        wet = self._room if end is room else run.upload("gas/wet_room", room.ravel(), warp().float32)
        self._opening = run.upload("gas/opening", opening.reshape(-1, 3), warp().vec3)
        self._solid = run.upload("gas/solid", velocity.reshape(-1, 3), warp().vec3)
        before = (self.regions, held) if hasattr(self, "regions") else None
        self.regions = Regions.find(run, solids, end, self._named, before)
        self._grown = np.zeros(len(self.regions.sealed))
        self.projection = Projection(
            self._levels, self._sides, wet=wet, room=self._room, opening=self._opening, regions=self.regions
        )
        self._fastest_solid = float(np.abs(velocity).max())
        if hasattr(self, "transport"):
            self.transport.fit(self._opening)

    # ------------------------------------------------------------ sources

    def ignite(self, where: F64) -> None:
        """Set where fuel burns whatever its temperature (nx, ny, nz), above 0."""
        self.run.upload("gas/spark", self._scalar(where), warp().float32)

    def _light(self) -> Fire | None:
        """The fire of what may burn."""
        settings = self.settings
        if settings.fuel is None:
            return None
        if not settings.expands:
            raise ValueError("fire is for gas that expands; set expands to true")
        air = (settings.ambient_temperature, self.density, AIR_HEAT_CAPACITY)
        gravity = float(np.linalg.norm(self.gravity))
        self.transport.quantities = ALL
        return Fire(self.run, self.elements, settings.fuel, self.cell, air=air, gravity=gravity)

    def heat(self, rate: F64) -> None:
        """Set the volume that heat makes per volume and second [1/s], (nx, ny, nz): power density / (density heat capacity temperature),
        at the ambient pressure."""
        self.run.upload("gas/heating", self._scalar(rate), warp().float32)
        self._heated = float(np.max(np.abs(rate)))

    _heated = _fed = 0.0

    def emit(self, rate: F64, content: Sequence[float] | F64) -> None:
        """Set a source: gas per volume and second [1/s], (nx, ny, nz), at the ambient pressure, of one composition (4,) or that of each cell
        (nx, ny, nz, 4)."""
        held = np.broadcast_to(np.asarray(content, float), (*self.shape, 4))
        full = np.zeros((*(n + 1 for n in self.shape), 4), np.float32)
        full[tuple(slice(0, n) for n in self.shape)] = held
        self.run.upload("gas/rate", self._scalar(rate), warp().float32)
        self.run.upload("gas/content", full.reshape(-1, 4), warp().vec4)
        self._emitted = np.tensordot(rate, held, axes=3)
        self.transport.carry(held)
        self._fed = float(np.max(rate))

    _emitted: F64 = np.zeros(4)

    def blow(self, speeds: F64) -> None:
        """Set the velocity of the air beyond each of the `outer` faces [m/s]."""
        self.run.upload("gas/beyond", np.asarray(speeds, np.float32), warp().vec3)

    def warm(self, walls: Sequence[float | None]) -> None:
        """Set excess temperatures of closed sides, as shares of the ambient one; None conducts nothing."""
        values = np.array([(0.0, 0.0) if w is None else (1.0, w) for w in walls], np.float32)
        self.run.upload("gas/walls", values, warp().vec2)

    # ------------------------------------------------------------ steps

    def advance(self, seconds: float, solids: Callable[[float], Solids] | None = None) -> list[GasReport]:
        """Steps over a time; each as long as the Courant number and the forces allow.

        Args:
            seconds: how long.
            solids: where they are at a time from now on, where they move.
        """
        found, left = [], seconds
        while left > 1e-9 * seconds:
            longest = min(left, self.longest())
            # Equal steps to the end, rather than a short last one.
            dt = left / math.ceil(left / longest - 1e-6)
            left -= dt
            found.append(self.step(dt, None if solids is None else solids(seconds - left)))
        return found

    def longest(self) -> float:
        """Longest step now [s]."""
        speed, light = self._fastest("velocity"), self._lightest()
        pull = float(np.linalg.norm(self.gravity)) * light
        # The speed that buoyancy gives within the step counts too: speed dt + pull dt^2 / 2 = courant cell.
        reach = self.settings.courant * self.cell
        dt = 2.0 * reach / (speed + math.sqrt(speed * speed + 2.0 * pull * reach) + LEAST_SPEED)
        limits = [dt, self.cell / (self._fastest_solid + LEAST_SPEED)]
        flow = max(self.settings.viscosity, self.settings.diffusivity)
        if flow > 0.0:
            limits.append(self.cell**2 / (8.0 * flow))
        if self.fire is not None:
            limits.append(self.fire.longest)
        if self._heated + self._fed > 0.0:
            limits.append(MADE / (self._heated + self._fed))
        return min(limits)

    def step(self, seconds: float, solids: Solids | None = None) -> GasReport:
        """One step; solids that move are at its end where they are given."""
        # Cells that solids which may move cut are as small as they are, also while these stand: no more leaves them than they hold.
        held = self._at.room if self._moves else None
        if solids is not None:
            if not self._moves:
                raise ValueError("solids of this gas stand; make it with moves=True")
            self._turn(solids, seconds)
        elif self._turned:
            self._stand(self._at)
        report = self._step(seconds, held)
        self.regions.compress(self.run, self.projection.asked / self.cell, seconds, self._grown)
        return report

    def _step(self, seconds: float, held: NDArray[np.float32] | None) -> GasReport:
        """A step; `held` is the room of cells at its start where solids may move."""
        half = 0.5 * seconds if self.settings.scheme == "reflection" else seconds
        self._expand(seconds)
        iterations, capped = 0, False
        # Velocities are carried by the flow halfway through the time that this takes; half a step lies between flows that reflection knows.
        ahead = (0.5 * seconds / self._last if self._last > 0.0 else 0.0, "velocity", "velocity/before")
        if self.settings.scheme == "reflection":
            self._carry("velocity", ahead, half, "velocity/raw")
            self._push("velocity/raw", half)
            warp().copy(self._face("velocity/middle"), self._face("velocity/raw"), count=self.elements)
            first = self._project("velocity/middle", coarser=True)
            self._transport("velocity/middle", seconds, held)
            self._carry((1.0, "velocity/middle", "velocity/raw"), (0.5, "velocity/middle", "velocity"), half, "velocity")
            self.run.swap("velocity/before", "velocity/middle")
            self._push("velocity", half)
            iterations, capped = first.iterations, first.capped
        else:
            self._carry("velocity", ahead, seconds, "velocity/raw")
            warp().copy(self._face("velocity/before"), self._face("velocity"), count=self.elements)
            self.run.swap("velocity", "velocity/raw")
            self._push("velocity", seconds)
        last = self._project("velocity", coarser=self.settings.scheme != "reflection")
        if self.settings.scheme != "reflection":
            self._transport("velocity", seconds, held)
        self.steps += 1
        self._last = seconds
        speed = max(self._fastest("velocity"), LEAST_SPEED)
        left = self.projection.residual(self._flow("velocity"))
        return GasReport(seconds, iterations + last.iterations, capped or last.capped, left / speed, speed * seconds / self.cell)

    def _face(self, name: str) -> Any:
        return self.run.array(name, self.elements, warp().vec3)

    def _cells(self, name: str) -> Any:
        return self.run.array(name, self.elements, warp().vec4)

    def _carry(self, source: Motion, carrier: Motion, seconds: float, out: str) -> None:
        """MacCormack: a velocity carried by another."""
        what, by = ((ratio, self._face(now), self._face(before)) for ratio, now, before in map(motion, (source, carrier)))
        self._carrier(what, by, seconds / self.cell, self._face("velocity/carried"))
        self.run.swap("velocity/carried", out)

    def _push(self, name: str, seconds: float) -> None:
        """Forces on a velocity."""
        settings, run = self.settings, self.run
        expands = int(settings.expands)
        pushed = [self._pull, seconds, expands, self._densities(), self._face(name)]
        run.rows(self._box, self.shape, [(forces.buoy, pushed)], grain=ROWS)
        if settings.confinement > 0.0:
            run(forces.curl, self.elements, [self._box, self.cell, self._face(name), self._face("vorticity")])
            push = settings.confinement * self.cell * seconds
            run(forces.confine, self.elements, [self._box, push, self._face("vorticity"), self._face(name)])
        if settings.viscosity > 0.0:
            number = settings.viscosity * seconds / self.cell**2
            run(forces.spread, self.elements, [self._box, number, self._no_slip, self._face(name), self._face("spread")])
            run.swap("spread", name)

    def _project(self, name: str, *, coarser: bool) -> Solution:
        # Half of what is allowed: the residual that the solver knows is rounded otherwise than the flow's.
        tolerance = 0.5 * self.settings.tolerance
        bound = tolerance * max(self._fastest(name), LEAST_SPEED)
        # Gas that starts from rest: a cell whose outflow is r has a face of speed r / 6 at least.
        return self.solve(bound, self.settings.iterations, name, share=tolerance / 6.0, coarser=coarser, known=True)

    def solve(
        self, bound: float, cap: int, name: str = "velocity", *, share: float = 0.0, coarser: bool = True, known: bool = False
    ) -> Solution:
        """Project a velocity until no residual exceeds a bound [m/s] or a share of the largest one, in at most `cap` iterations; `coarser`:
        the coarser levels of the pressure take over the densities too; `known`: densities have been worked out since amounts changed."""
        self.projection.weigh(self._air if known else self._densities(), expands=self.settings.expands, coarser=coarser)
        for press in self.pressing:
            press(self, name)
        return self.projection(self._flow(name), bound=bound, cap=cap, share=share)

    def _flow(self, name: str) -> Flow:
        return Flow(self._face(name), self._solid, self._expansion, self._growth, self.cell)

    def _densities(self) -> Any:
        """Densities of elements now, over that of the ambient air."""
        self._runs(densities, [self.load, self._cells("state"), self._air])
        return self._air

    def _runs(self, kernel: Any, inputs: Sequence[Any]) -> None:
        """Run a kernel over runs of elements."""
        span = self.run.span(self.run.block)
        self.run(kernel, -(-self.elements // span), [span, self.elements, *inputs], grain=RUNS if span > 1 else 1)

    def _expand(self, seconds: float) -> None:
        """Volume per volume and second that sources and heat ask for, and conduction."""
        wp, run = warp(), self.run
        rate, heating = run.array("gas/rate", self.elements, wp.float32), run.array("gas/heating", self.elements, wp.float32)
        regions = [self.regions.numbers, self.regions.ratios]
        self._runs(transport.expansion_of, [rate, heating, int(self.settings.expands), *regions, self._expansion])
        if self.settings.diffusivity > 0.0:
            number = self.settings.diffusivity * seconds / self.cell**2
            walls = run.array("gas/walls", 6, wp.vec2)
            state = [self._box, number, walls, self._opening, self._cells("state"), int(self.settings.expands), seconds]
            run(transport.conduct, self.elements, [*state, *regions, self._cells("state/next"), self._expansion])
            run.swap("state", "state/next")
        if self.fire is not None:
            state = self._cells("state")
            self.fire(seconds, self._box, self.regions, self._room, self._face("velocity"), state, self._expansion)

    def _transport(self, carrier: str, seconds: float, held: NDArray[np.float32] | None) -> None:
        """Move the amounts with a projected flow, in parts that take little out of each cell."""
        velocity, wp = self._face(carrier), warp()
        rate, heating = (self.run.array(name, self.elements, wp.float32) for name in ("gas/rate", "gas/heating"))
        source = [rate, self._cells("gas/content"), heating]
        if held is not None:
            self.transport.moving(seconds, self._fastest(carrier), velocity, self._opening, held=held, room=self._at.room)
            self.transport.inject(seconds, source)
        else:
            parts = self.transport.parts(seconds, velocity, self._opening, self._room)
            fields = {"room": self._room, "made": [self._expansion, *self.projection.taken], "source": source}
            for part in range(parts):
                self.transport.standing(seconds / parts, self.steps + part, **fields)
        self.injected = self.injected + seconds * self._emitted

    # ------------------------------------------------------------ sums

    def _fastest(self, name: str) -> float:
        many = -(-self.elements // self.run.block)
        out = self.run.array("fastest", many, warp().float32)
        self.run(greatest_of_three, many, [self.elements, self.run.block, self._face(name), out], grain=RUNS)
        return float(self.run.read(out, many).max())

    def _lightest(self) -> float:
        """Largest size of a cell's lightness."""
        many = -(-self.elements // self.run.block)
        out = self.run.array("fastest", many, warp().float32)
        self.run(transport.lightest, many, [self.elements, self.run.block, self._cells("state"), out], grain=RUNS)
        return float(self.run.read(out, many).max())

    def totals(self) -> F64:
        """(4,) sums of lightness, soot, fuel and product over cells times their open volume [cells]."""
        many = -(-self.elements // self.run.block)
        inputs = [self._box, self.elements, self.run.block, self._room, self._cells("state"), self._sums]
        self.run(transport.amounts, many, inputs, grain=RUNS)
        return np.asarray(self._sums.numpy().sum(axis=1), np.float64)
