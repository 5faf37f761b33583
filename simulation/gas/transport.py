"""Amounts of a gas on their way with a projected flow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import warp
from . import transport_kernels as kernels

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from ..grids.runner import Runner
    from .border import Border

__all__ = ["Transport"]

ROUNDS = 6
"""Own choice: most rounds of sweeps in which cells that solids fill give what they hold; each leaves a small part of what is left."""
SPENT = 1e-6
"""Volume [cells] that is let be when it has not passed."""


class Transport:
    """Sweeps over the cells of a box.

    Args:
        run: arrays and launches; the concentrations are its array "state".
        elements: of the fields.
        box: `Box` of the kernels.
        cell: its size [m].
        border: counts what leaves the box.
        expands: whether lightness is that of a density that is kept.
    """

    def __init__(self, run: Runner, elements: int, box: Any, cell: float, border: Border, *, expands: bool) -> None:
        self.run, self.elements, self.box, self.cell, self.border = run, elements, box, cell, border
        self.expands = int(expands)
        self.crushed = np.zeros(4)
        """Air [cells of ambient density], soot, fuel and product in cells that solids have filled before they could leave."""
        self.let_in = 0.0
        """Air [cells of ambient density] that came through gaps finer than cells into room that opened where none could reach it."""

    def _array(self, name: str) -> Any:
        wp = warp()
        kind = {"volume": wp.float32, "left": wp.vec3, "through": wp.vec3}.get(name.split("/")[0], wp.vec4)
        return self.run.array(name, self.elements, kind)

    def _sweep(self, axis: int, through: Any, opening: Any) -> None:
        """Move amounts along one axis with the volumes that pass lower faces."""
        share, volume, moved, amount = (self._array(n) for n in ("share", "volume", "moved", "amount"))
        self.run(kernels.fluxes, self.elements, [self.box, axis, through, share, volume, opening, moved], grain=2048)
        self.border.count(self.box, axis, through, moved)
        self.run(kernels.settle, self.elements, [self.box, axis, through, moved, amount, volume, share])

    def standing(self, seconds: float, turn: int, velocity: Any, opening: Any, room: Any, made: Sequence[Any]) -> None:
        """A part of a step between solids that stand.

        Args:
            seconds: of the part.
            turn: order of the axes.
            velocity: of faces [m/s].
            opening: open shares of faces.
            room: of cells.
            made: volume that cells make per volume and second [1/s], their regions, and what each of these takes up by its pressure [m/s].
        """
        run, through = self.run, self._array("through")
        run(kernels.start, self.elements, [room, self._array("state"), *map(self._array, ("amount", "volume", "share"))])
        run(kernels.ask, self.elements, [seconds / self.cell, velocity, opening, through])
        for axis in (0, 1, 2) if turn % 2 == 0 else (2, 1, 0):
            self._sweep(axis, through, opening)
        inputs = [self.box, self.expands, room, self._array("amount"), seconds, self.cell, *made, self._array("state")]
        run(kernels.finish_standing, self.elements, inputs)

    def moving(
        self, seconds: float, parts: int, velocity: Any, opening: Any, *, held: NDArray[np.float32], room: NDArray[np.float32]
    ) -> None:
        """A step in parts, in which solids change the room of cells from `held` to `room`; else as `standing`."""
        wp, run = warp(), self.run
        start = run.upload("gas/held", held.ravel(), wp.float32)
        run(kernels.start, self.elements, [start, self._array("state"), *map(self._array, ("amount", "volume", "share"))])
        many = -(-self.elements // run.block)
        most = run.array("fastest", many, wp.float64)
        for part in range(parts):
            run(kernels.ask, self.elements, [seconds / parts / self.cell, velocity, opening, self._array("left")])
            for _ in range(ROUNDS):
                for axis in (0, 1, 2) if part % 2 == 0 else (2, 1, 0):
                    through = self._array("through")
                    limits = [self._array("left"), self._array("volume"), self._array("left/next"), through]
                    run(kernels.limit, self.elements, [self.box, axis, *limits])
                    run.swap("left", "left/next")
                    self._sweep(axis, through, opening)
                run(kernels.fastest, many, [self.elements, run.block, self._array("left"), most], grain=16)
                if float(run.read(most, many).max()) < SPENT:
                    break
        self._balance(room)
        end = run.upload("gas/held", room.ravel(), wp.float32)
        run(
            kernels.finish,
            self.elements,
            [self.box, self.expands, end, *map(self._array, ("amount", "volume")), self._array("state")],
        )

    def _balance(self, after: NDArray[np.float32]) -> None:
        """Count what is left in cells without room, and what `finish` gives to cells that no air has reached."""
        amount = self.run.read(self._array("amount"), self.elements)
        volume = self.run.read(self._array("volume"), self.elements)
        inner = np.zeros(after.shape, bool)
        inner[tuple(slice(0, n - 1) for n in after.shape)] = True
        room = after.ravel()
        full = inner.ravel() & (room <= 0.0)
        found = amount[full].astype(np.float64).sum(axis=0)
        found[0] = volume[full].astype(np.float64).sum() - found[0]
        self.crushed = self.crushed + found
        bare = inner.ravel() & (room > 0.0) & (volume <= kernels.NO_AIR * room)
        self.let_in += float(room[bare].astype(np.float64).sum()) * self.expands
