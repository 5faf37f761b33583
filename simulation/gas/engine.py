"""A gas in a fixed box of cells: velocities on faces, amounts in cells, one projection or two per step.

A step: velocities are carried, forces act, the projection gives every cell the outflow that its expansion asks for, and that flow takes
the amounts along, so that their sums stay. Lightness is 1 - density / density of the ambient air (at one pressure that is
1 - ambient temperature / temperature), so heat and mass are one quantity; Boussinesq gas has its excess temperature there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import chosen_device, warp
from ...worlds.arrays import F64
from ..grids.columns import vec6i
from ..grids.multigrid import Solution
from ..grids.runner import Runner
from . import box_kernels as boxes
from . import force_kernels as forces
from . import transport_kernels as transport
from .border import Border, side_faces
from .pressure import Flow, Projection
from .settings import GasSettings, Side

__all__ = ["LIGHTNESS", "SOOT", "Gas", "GasReport", "Solids"]

LIGHTNESS, SOOT, FUEL, PRODUCT = range(4)
"""Quantities of a cell, in this order."""
MOTION = ("velocity", "velocity/before")
TRANSPORT_COURANT = 0.4
"""Own choice: most of a cell that leaves it through one face in a sweep; it may lose as much through the opposite one."""
LEAST_SPEED = 1e-9
AIR = 1.2
"""Density of the ambient air [kg/m^3]."""


@dataclass(frozen=True)
class Solids:
    """Open shares of a box between solids that stand or move; fields have one element more than cells along each axis.

    Attributes:
        room: (nx + 1, ny + 1, nz + 1) open share of each cell.
        opening: (nx + 1, ny + 1, nz + 1, 3) open share of the lower faces.
        velocity: as `opening`: speed of what closes them [m/s].
    """

    room: NDArray[np.float32]
    opening: NDArray[np.float32]
    velocity: NDArray[np.float32]


@dataclass(frozen=True)
class GasReport:
    """One step."""

    seconds: float
    iterations: int
    capped: bool
    divergence: float
    """Largest difference of the flux out of a cell from what it should be, over the largest speed."""
    courant: float


class Gas:
    """A gas in a box.

    Args:
        shape: cells along x, y, z.
        cell: their size [m].
        sides: x-, x+, y-, y+, z-, z+; an axis is periodic on both or none.
        settings: of the engine.
        gravity: [m/s^2].
        solids: what is not open; the whole box when left out.
        device: where it runs.
    """

    def __init__(
        self, shape: tuple[int, int, int], cell: float, sides: Sequence[Side], settings: GasSettings | None = None, *,
        gravity: tuple[float, float, float] = (0.0, 0.0, -9.81), solids: Solids | None = None, device: str | None = None,
    ) -> None:  # fmt: skip
        wp = warp()
        self.shape, self.cell, self.settings, self.gravity = shape, cell, settings or GasSettings(), gravity
        self.run = Runner(chosen_device(device))
        self.elements = math.prod(n + 1 for n in shape)
        self._box = boxes.Box()
        self._box.nx, self._box.ny, self._box.nz = shape
        self._box.wraps = wp.vec3i(*(int(sides[2 * a] == "periodic") for a in range(3)))
        self._sides = self._box.opens = vec6i(*(int(s == "open") for s in sides))
        starts, self.outer = side_faces(shape)
        """Middles of the faces of all sides [cells], shape (n, 3)."""
        self._box.starts = wp.vec3i(*starts)
        self._box.beyond = self.run.upload("gas/beyond", np.zeros((len(self.outer), 3), np.float32), wp.vec3)
        self._no_slip = self.run.upload("gas/no_slip", np.array([s == "closed" for s in sides], np.int32), wp.int32)
        self._walls = self.run.upload("gas/walls", np.zeros((6, 2), np.float32), wp.vec2)
        self._close(sides, solids)
        self._content = self.run.upload("gas/content", np.zeros((self.elements, 4), np.float32), wp.vec4)
        self._rate = self.run.upload("gas/rate", np.zeros(self.elements, np.float32), wp.float32)
        self._heating = self.run.upload("gas/heating", np.zeros(self.elements, np.float32), wp.float32)
        self.load = 1.0 / AIR
        """Density that a unit of soot [kg/m^3] adds, relative to the air's."""
        self._sums = wp.zeros((5, -(-self.elements // self.run.block)), dtype=wp.float64, device=self.run.device)
        self.border = Border(self.run, shape, [s == "periodic" for s in sides[::2]])
        self.steps = 0
        self._last = 0.0
        self.injected = np.zeros(4)
        """Amounts that sources have added."""
        self.velocity = np.zeros((self.elements, 3), np.float32)
        self.run.upload("state", np.zeros((self.elements, 4), np.float32), wp.vec4)

    def _close(self, sides: Sequence[Side], solids: Solids | None) -> None:
        """Open shares of cells and faces, with the closed sides of the box."""
        wp = warp()
        padded = tuple(n + 1 for n in self.shape)
        room = np.zeros(padded, np.float32)
        opening = np.zeros((*padded, 3), np.float32)
        inner = tuple(slice(0, n) for n in self.shape)
        room[inner] = 1.0 if solids is None else solids.room[inner]
        opening[...] = 1.0 if solids is None else solids.opening
        for axis in range(3):
            opening[..., axis] *= np.all(
                [_within(padded, a, self.shape[a] + int(a == axis and sides[2 * a] != "periodic")) for a in range(3)], axis=0
            )
            for upper, place in ((0, 0), (1, self.shape[axis])):
                if sides[2 * axis + upper] == "closed":
                    opening[(slice(None),) * axis + (place,)][..., axis] = 0.0
        opening[opening < 0.05] = 0.0
        # What flows through a cell must fit in it: a cell cut smaller than its faces counts as large as the widest of them.
        widest = np.zeros(padded, np.float32)
        for axis in range(3):
            ahead = np.roll(opening[..., axis], -1, axis=axis)
            if sides[2 * axis] == "periodic":
                ahead[(slice(None),) * axis + (self.shape[axis] - 1,)] = opening[(slice(None),) * axis + (0,)][..., axis]
            widest = np.maximum(widest, np.maximum(opening[..., axis], ahead))
        room[inner] = np.where(widest[inner] > 0.0, np.maximum(room[inner], widest[inner]), 0.0)
        solid = np.zeros_like(opening) if solids is None else solids.velocity
        self._room_host = room
        self._room = self.run.upload("gas/room", room.ravel(), wp.float32)
        self._opening = self.run.upload("gas/opening", opening.reshape(-1, 3), wp.vec3)
        self._solid = self.run.upload("gas/solid", solid.reshape(-1, 3).astype(np.float32), wp.vec3)
        self._expansion = self.run.upload("gas/expansion", np.zeros(self.elements, np.float32), wp.float32)
        self.projection = Projection(self.run, self.shape, self._box, self._sides, self._room, self._opening)

    # ------------------------------------------------------------ fields

    @property
    def velocity(self) -> NDArray[np.float32]:
        """(nx + 1, ny + 1, nz + 1, 3) speeds of lower faces [m/s]; a copy."""
        return self._padded("velocity", warp().vec3, 3)

    @velocity.setter
    def velocity(self, values: NDArray[np.float32]) -> None:
        for name in MOTION:
            self.run.upload(name, np.asarray(values, np.float32).reshape(-1, 3), warp().vec3)

    @property
    def state(self) -> NDArray[np.float32]:
        """(nx, ny, nz, 4) lightness, soot, fuel and product of cells; a copy."""
        return self._padded("state", warp().vec4, 4)[tuple(slice(0, n) for n in self.shape)]

    @state.setter
    def state(self, values: NDArray[np.float32]) -> None:
        full = np.zeros((*(n + 1 for n in self.shape), 4), np.float32)
        full[tuple(slice(0, n) for n in self.shape)] = values
        self.run.upload("state", full.reshape(-1, 4), warp().vec4)

    def _padded(self, name: str, dtype: Any, width: int) -> NDArray[np.float32]:
        found = self.run.read(self.run.array(name, self.elements, dtype), self.elements)
        return found.reshape(*(n + 1 for n in self.shape), width)

    def heat(self, rate: F64) -> None:
        """Set the volume that heat makes per volume and second [1/s], (nx, ny, nz): power density / (density heat capacity temperature)."""
        self.run.upload("gas/heating", self._scalar(rate), warp().float32)

    def emit(self, rate: F64, content: Sequence[float]) -> None:
        """Set a source: gas per volume and second [1/s], (nx, ny, nz), of one composition."""
        self.run.upload("gas/rate", self._scalar(rate), warp().float32)
        self.run.upload("gas/content", np.tile(np.asarray(content, np.float32), (self.elements, 1)), warp().vec4)
        self._emitted = np.asarray(content, float) * float(np.sum(rate))

    _emitted: F64 = np.zeros(4)

    def blow(self, speeds: F64) -> None:
        """Set the velocity of the air beyond each of the `outer` faces [m/s]."""
        self.run.upload("gas/beyond", np.asarray(speeds, np.float32), warp().vec3)

    def warm(self, walls: Sequence[float | None]) -> None:
        """Set excess temperatures of closed sides, as shares of the ambient one; None conducts nothing."""
        values = np.array([(0.0, 0.0) if w is None else (1.0, w) for w in walls], np.float32)
        self.run.upload("gas/walls", values, warp().vec2)

    @property
    def room(self) -> NDArray[np.float32]:
        """(nx, ny, nz) open share of cells."""
        return self._room_host[tuple(slice(0, n) for n in self.shape)]

    def pack(self) -> dict[str, Any]:
        """Everything that the next step depends on but sources, solids and the air beyond open sides."""
        fields = {name: self._padded(name, warp().vec3, 3) for name in MOTION}
        return {**fields, "state": self.state, "clock": np.array([self.steps, self._last])}

    def unpack(self, found: Mapping[str, Any]) -> None:
        """Continue from such a state; raises ValueError where it has another shape."""
        if found["state"].shape != (*self.shape, 4):
            raise ValueError(f"it has {found['state'].shape[:3]} cells, not {self.shape}")
        for name in MOTION:
            self.run.upload(name, found[name].reshape(-1, 3), warp().vec3)
        self.state = found["state"]
        self.steps, self._last = int(found["clock"][0]), float(found["clock"][1])

    def _scalar(self, values: F64) -> NDArray[np.float32]:
        full = np.zeros(tuple(n + 1 for n in self.shape), np.float32)
        full[tuple(slice(0, n) for n in self.shape)] = values
        return full.ravel()

    # ------------------------------------------------------------ steps

    def advance(self, seconds: float) -> list[GasReport]:
        """Steps over a time; each as long as the Courant number and the forces allow."""
        found, left = [], seconds
        while left > 1e-9 * seconds:
            longest = min(left, self.longest())
            # Equal steps to the end, rather than a short last one.
            dt = left / math.ceil(left / longest - 1e-6)
            found.append(self.step(dt))
            left -= dt
        return found

    def longest(self) -> float:
        """Longest step now [s]."""
        speed, light = self._fastest("velocity"), self._totals()[4]
        pull = float(np.linalg.norm(self.gravity)) * light
        # The speed that buoyancy gives within the step counts too: speed dt + pull dt^2 / 2 = courant cell.
        reach = self.settings.courant * self.cell
        dt = 2.0 * reach / (speed + math.sqrt(speed * speed + 2.0 * pull * reach) + LEAST_SPEED)
        flow = max(self.settings.viscosity, self.settings.diffusivity)
        return min(dt, self.cell**2 / (8.0 * flow)) if flow > 0.0 else dt

    def step(self, seconds: float) -> GasReport:
        """One step."""
        half = 0.5 * seconds if self.settings.scheme == "reflection" else seconds
        self._expand(seconds)
        iterations, capped = 0, False
        if self.settings.scheme == "reflection":
            self._carry("velocity", "velocity", half, "velocity/raw")
            self._push("velocity/raw", half)
            warp().copy(self._face("velocity/middle"), self._face("velocity/raw"), count=self.elements)
            first = self._project("velocity/middle")
            self._transport("velocity/middle", seconds)
            reflected = [1.0, self._face("velocity/middle"), self._face("velocity/raw"), self._face("velocity/back")]
            self.run(boxes.extrapolate, self.elements, reflected)
            self._carry("velocity/back", "velocity/middle", half, "velocity")
            self._push("velocity", half)
            iterations, capped = first.iterations, first.capped
        else:
            ratio = 0.5 * seconds / self._last if self._last > 0.0 else 0.0
            ahead = [ratio, self._face("velocity"), self._face("velocity/before"), self._face("velocity/middle")]
            self.run(boxes.extrapolate, self.elements, ahead)
            warp().copy(self._face("velocity/before"), self._face("velocity"), count=self.elements)
            self._carry("velocity", "velocity/middle", seconds, "velocity/raw")
            self.run.swap("velocity", "velocity/raw")
            self._push("velocity", seconds)
        last = self._project("velocity")
        if self.settings.scheme != "reflection":
            self._transport("velocity", seconds)
        self.steps += 1
        self._last = seconds
        speed = max(self._fastest("velocity"), LEAST_SPEED)
        flow = Flow(self._face("velocity"), self._solid, self._expansion, self._cells("state"), self.cell, self.load)
        left = self.projection.residual(flow)
        return GasReport(seconds, iterations + last.iterations, capped or last.capped, left / speed, speed * seconds / self.cell)

    def _face(self, name: str) -> Any:
        return self.run.array(name, self.elements, warp().vec3)

    def _cells(self, name: str) -> Any:
        return self.run.array(name, self.elements, warp().vec4)

    def _carry(self, source: str, carrier: str, seconds: float, out: str) -> None:
        """MacCormack: a velocity carried by another."""
        state = [self._box, seconds / self.cell, self._face(carrier), self._face(source)]
        found = [self._face("velocity/once"), self._face("velocity/low"), self._face("velocity/high")]
        self.run(boxes.carry, self.elements, [*state, *found], grain=512)
        self.run(boxes.correct, self.elements, [*state, *found, self._face("velocity/carried")], grain=512)
        self.run.swap("velocity/carried", out)

    def _push(self, name: str, seconds: float) -> None:
        """Forces on a velocity."""
        settings, run = self.settings, self.run
        expands = int(settings.expands)
        gravity = warp().vec3(*self.gravity)
        run(
            forces.buoy, self.elements,
            [self._box, gravity, seconds, self.load, expands, self._cells("state"), self._face(name)],
        )  # fmt: skip
        if settings.confinement > 0.0:
            run(forces.curl, self.elements, [self._box, self.cell, self._face(name), self._face("vorticity")])
            push = settings.confinement * self.cell * seconds
            run(forces.confine, self.elements, [self._box, push, self._face("vorticity"), self._face(name)])
        if settings.viscosity > 0.0:
            number = settings.viscosity * seconds / self.cell**2
            run(forces.spread, self.elements, [self._box, number, self._no_slip, self._face(name), self._face("spread")])
            run.swap("spread", name)

    def _project(self, name: str) -> Solution:
        # Half of what is allowed: the residual that the solver knows is rounded otherwise than the flow's.
        bound = 0.5 * self.settings.tolerance * max(self._fastest(name), LEAST_SPEED)
        return self.solve(bound, self.settings.iterations, name)

    def solve(self, bound: float, cap: int, name: str = "velocity") -> Solution:
        """Project a velocity until no residual exceeds a bound [m/s], in at most `cap` iterations."""
        state, expands = self._cells("state"), self.settings.expands
        self.projection.weigh(state, self.load, expands=expands)
        flow = Flow(self._face(name), self._solid, self._expansion, state, self.cell, self.load)
        return self.projection(flow, expands=expands, bound=bound, cap=cap)

    def _expand(self, seconds: float) -> None:
        """Volume per volume and second that sources and heat ask for, and conduction."""
        wp, run = warp(), self.run
        rate, heating = run.array("gas/rate", self.elements, wp.float32), run.array("gas/heating", self.elements, wp.float32)
        run(transport.expansion_of, self.elements, [rate, heating, int(self.settings.expands), self._expansion])
        if self.settings.diffusivity > 0.0:
            number = self.settings.diffusivity * seconds / self.cell**2
            walls = run.array("gas/walls", 6, wp.vec2)
            state = [self._box, number, walls, self._opening, self._cells("state"), int(self.settings.expands), seconds]
            run(transport.conduct, self.elements, [*state, self._cells("state/next"), self._expansion])
            run.swap("state", "state/next")

    def _transport(self, carrier: str, seconds: float) -> None:
        """Move the amounts with a projected flow."""
        wp, run, expands = warp(), self.run, int(self.settings.expands)
        parts = max(1, math.ceil(self._fastest(carrier) * seconds / (TRANSPORT_COURANT * self.cell)))
        dt = seconds / parts
        velocity = self._face(carrier)
        for part in range(parts):
            volume = run.array("volume", self.elements, wp.float32)
            run(transport.start, self.elements, [self._room, self._cells("state"), self._cells("amount"), volume])
            order = (0, 1, 2) if (self.steps + part) % 2 == 0 else (2, 1, 0)
            for axis in order:
                before = [self._cells("amount"), run.array("volume", self.elements, wp.float32)]
                after = [self._cells("amount/next"), run.array("volume/next", self.elements, wp.float32)]
                flow = [self._box, axis, dt / self.cell, velocity, self._opening]
                self.border.count(axis, flow, before)
                run(transport.sweep, self.elements, [*flow, *before, *after], grain=1024)
                run.swap("amount", "amount/next")
                run.swap("volume", "volume/next")
            done = [self._cells("amount"), run.array("volume", self.elements, wp.float32), self._cells("state")]
            run(transport.finish, self.elements, [self._box, expands, self._room, *done])
            rate, heating = (run.array(name, self.elements, wp.float32) for name in ("gas/rate", "gas/heating"))
            source = [dt, expands, rate, self._cells("gas/content"), heating, self._cells("state")]
            run(transport.inject, self.elements, source)
        self.injected = self.injected + seconds * self._emitted

    # ------------------------------------------------------------ sums

    def _fastest(self, name: str) -> float:
        many = -(-self.elements // self.run.block)
        out = self.run.array("fastest", many, warp().float64)
        self.run(boxes.fastest, many, [self.elements, self.run.block, self._face(name), out], grain=16)
        return float(self.run.read(out, many).max())

    def _totals(self) -> F64:
        many = -(-self.elements // self.run.block)
        out = self._sums
        inputs = [self._box, self.elements, self.run.block, self._room, self._cells("state"), out]
        self.run(transport.amounts, many, inputs, grain=16)
        found = np.array(out.numpy(), dtype=np.float64)
        return np.append(found[:4].sum(axis=1), found[4].max())

    def totals(self) -> F64:
        """(4,) sums of lightness, soot, fuel and product over cells times their open volume [cells]."""
        return self._totals()[:4]


def _within(padded: tuple[int, ...], axis: int, count: int) -> NDArray[np.bool_]:
    """True for elements whose index along an axis is below a count."""
    shape = [1, 1, 1]
    shape[axis] = padded[axis]
    return np.broadcast_to((np.arange(padded[axis]) < count).reshape(shape), padded)
