"""Amounts of a gas on their way with a projected flow."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import warp
from . import sweep_kernels as sweeps
from . import transport_kernels as kernels

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from ..grids.runner import Runner
    from .border import Border

__all__ = ["Transport"]

MOST_TAKEN = 0.9
"""Own choice: most of what a cell holds that one sweep takes out of it, between solids that stand."""
COURANT_MOVING = 0.4
"""Own choice: most of a cell that leaves it through one face in a part, between solids that move; it may lose as much through the opposite one."""
ROUNDS = 6
"""Own choice: most rounds of sweeps in which cells that solids fill give what they hold; each leaves a small part of what is left."""
SPENT = 1e-6
"""Volume [cells] that is let be when it has not passed."""
ALL, FIRST = 4, 2
"""Quantities that are carried: all, or lightness and soot where there is neither fuel nor product."""
ROWS, RUNS = 512, 16
"""Own choice: rows of cells, and blocks of elements, that are worth a thread of a CPU: some 50 microseconds of work."""


class Transport:
    """Sweeps over the cells of a box.

    Args:
        run: arrays and launches; the concentrations are its array "state".
        shape: cells along each axis.
        box: `Box` of the kernels.
        cell: its size [m].
        border: counts what leaves the box.
        expands: whether lightness is that of a density that is kept.
    """

    def __init__(self, run: Runner, shape: tuple[int, int, int], box: Any, cell: float, border: Border, *, expands: bool) -> None:
        self.run, self.box, self.cell, self.border = run, box, cell, border
        self.shape = shape
        self.rows = (shape[0] + 1) * (shape[1] + 1)
        self.elements = self.rows * (shape[2] + 1)
        self.expands = int(expands)
        self.quantities = FIRST
        """Count of what is carried: `ALL` or `FIRST`."""
        self.crushed = np.zeros(4)
        """Air [cells of ambient density], soot, fuel and product in cells that solids have filled before they could leave."""
        self.let_in = 0.0
        """Air [cells of ambient density] that came through gaps finer than cells into room that opened where none could reach it."""

    def _array(self, name: str) -> Any:
        wp = warp()
        if name == "state":
            return self.run.array(name, self.elements, wp.vec4)
        planes = 4 if name.split("/")[0] in {"share", "moved", "amount"} else 1
        return self.run.array(f"gas/{name}", planes * self.elements, wp.float32)

    def _axes(self, name: str) -> list[Any]:
        return [self._array(f"{name}/{axis}") for axis in range(3)]

    def fit(self, opening: Any) -> None:
        """Take over open shares of faces."""
        for axis, slopes in enumerate(self._axes("slopes")):
            self.run(sweeps.smooth, self.elements, [self.box, axis, opening, slopes])

    def carry(self, contents: NDArray[Any]) -> None:
        """Carry all quantities from now on if there is fuel or product among contents (..., 4)."""
        if np.any(contents[..., FIRST:]):
            self.quantities = ALL

    def _start(self, room: Any) -> None:
        state = [room, self._array("state"), *map(self._array, ("amount", "volume", "share"))]
        self._together([(sweeps.shares, [self.elements, self.quantities, *state])])

    def _ask(self, cells: float, velocity: Any, opening: Any, names: str) -> None:
        self._together([(sweeps.crossed, [cells, velocity, opening, *self._axes(names)])])

    def _together(self, calls: Sequence[tuple[Any, Sequence[Any]]]) -> None:
        """Run kernels over runs of cells along z one after the other, in slices of whole layers: only sweeps along x look beyond these."""
        self.run.rows(self.box, self.shape, calls, grain=ROWS)

    def _fluxes(self, axis: int, through: Any) -> tuple[Any, list[Any]]:
        """Amounts that pass lower faces along an axis, into the array "moved/axis"."""
        fields = [self._array(n) for n in (f"slopes/{axis}", "volume", "share", f"moved/{axis}")]
        return sweeps.fluxes, [axis, self.quantities, self.elements, through, *fields]

    def _settle(self, axis: int, through: Any) -> tuple[Any, list[Any]]:
        fields = [self._array(n) for n in (f"moved/{axis}", "amount", "volume", "share")]
        return sweeps.settle, [axis, self.quantities, self.elements, through, *fields]

    def _sweep(self, axis: int, through: Any) -> None:
        """Move amounts along one axis with the volumes that pass lower faces."""
        self._together([self._fluxes(axis, through)])
        self._together([self._settle(axis, through)])

    def _counting(self) -> tuple[Any, list[Any]]:
        """Kernel that counts what has left with sweeps along all axes, with its parameters."""
        return self.border.counting(self.quantities, self._axes("through"), self._axes("moved"))

    def parts(self, seconds: float, velocity: Any, opening: Any, room: Any) -> int:
        """Parts in which `standing` carries amounts over a step, each with the volumes that are now known to pass faces in it.

        Args:
            seconds: of the step.
            velocity: of faces [m/s].
            opening: open shares of faces.
            room: of cells.
        """
        run = self.run
        self._ask(seconds / self.cell, velocity, opening, "through")
        out = run.array("gas/demand", self.rows, warp().float32)
        run(kernels.demand, self.rows, [self.box, MOST_TAKEN, room, *self._axes("through"), out], grain=ROWS)
        found = max(1, math.ceil(float(run.read(out, self.rows).max())))
        if found > 1:
            self._ask(seconds / found / self.cell, velocity, opening, "through")
        return found

    def standing(self, seconds: float, turn: int, *, room: Any, made: Sequence[Any], source: Sequence[Any]) -> None:
        """A part of a step between solids that stand, after `parts`.

        Args:
            seconds: of the part.
            turn: order of the axes.
            room: of cells.
            made: volume that cells make per volume and second [1/s], their regions, and what each of these takes up by its pressure [m/s].
            source: as of `inject`.
        """
        throughs = self._axes("through")
        x, y, z = ([self._fluxes(axis, through), self._settle(axis, through)] for axis, through in enumerate(throughs))
        state = [self.elements, self.quantities, room, self._array("amount")]
        begin = [(sweeps.shares, [*state[:3], self._array("state"), *map(self._array, ("amount", "volume", "share"))])]
        end = [
            (kernels.finish_standing, [self.expands, *state, seconds, self.cell, *made, self._array("state")]),
            (kernels.inject, [seconds, self.expands, *source, self._array("state")]),
            self._counting(),
        ]
        if turn % 2 == 0:
            self._together(begin)
            self._together(x[:1])
            self._together([*x[1:], *y, *z, *end])
        else:
            self._together([*begin, *z, *y])
            self._together(x[:1])
            self._together([*x[1:], *end])

    def inject(self, seconds: float, source: Sequence[Any]) -> None:
        """Let a source add gas: volume per volume and time [1/s], its composition, heating."""
        self._together([(kernels.inject, [seconds, self.expands, *source, self._array("state")])])

    def moving(
        self, seconds: float, fastest: float, velocity: Any, opening: Any, *, held: NDArray[np.float32], room: NDArray[np.float32]
    ) -> None:
        """A step in parts, in which solids change the room of cells from `held` to `room`, with gas of at most a speed; else as `standing`."""
        wp, run = warp(), self.run
        parts = max(1, math.ceil(fastest * seconds / (COURANT_MOVING * self.cell)))
        self._start(run.upload("gas/held", held.ravel(), wp.float32))
        volume = self._array("volume")
        for part in range(parts):
            self._ask(seconds / parts / self.cell, velocity, opening, "left")
            for _ in range(ROUNDS):
                for axis in (0, 1, 2) if part % 2 == 0 else (2, 1, 0):
                    through, left = self._array(f"through/{axis}"), self._array(f"left/{axis}")
                    run(kernels.limit, self.elements, [self.box, axis, left, volume, through])
                    run(kernels.spend, self.elements, [through, left])
                    self._sweep(axis, through)
                self._together([self._counting()])
                if self._most_left() < SPENT:
                    break
        self._balance(room)
        end = run.upload("gas/held", room.ravel(), wp.float32)
        inputs = [self.box, self.expands, self.elements, end, *map(self._array, ("amount", "volume", "state"))]
        run(kernels.finish, self.elements, inputs)

    def _most_left(self) -> float:
        """Largest volume that has not passed [cells]."""
        run, many = self.run, -(-self.elements // self.run.block)
        out = run.array("gas/demand", many, warp().float32)
        run(kernels.largest, many, [self.elements, run.block, *self._axes("left"), out], grain=16)
        return float(run.read(out, many).max())

    def _balance(self, after: NDArray[np.float32]) -> None:
        """Count what is left in cells without room, and what `finish` gives to cells that no air has reached."""
        amount = self.run.read(self._array("amount"), 4 * self.elements).reshape(4, -1)
        volume = self.run.read(self._array("volume"), self.elements)
        inner = np.zeros(after.shape, bool)
        inner[tuple(slice(0, n - 1) for n in after.shape)] = True
        room = after.ravel()
        full = inner.ravel() & (room <= 0.0)
        found = amount[:, full].astype(np.float64).sum(axis=1)
        found[0] = volume[full].astype(np.float64).sum() - found[0]
        self.crushed = self.crushed + found
        bare = inner.ravel() & (room > 0.0) & (volume <= kernels.NO_AIR * room)
        self.let_in += float(room[bare].astype(np.float64).sum()) * self.expands
