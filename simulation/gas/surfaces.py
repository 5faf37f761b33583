"""Surfaces of solids in a gas that take heat from it and from its flames, and give off gas that burns (R100).

A surface is cut into pieces no wider than a cell. Each has layers below it (`physics/pyrolysis.py`), gets heat from the gas of the cell before it
and from the light of all flames, and gives its gas to that cell. Pieces of cloth have two faces, one temperature, and are consumed. Pieces
go along with the bodies and the cloth that carry them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...physics.pyrolysis import EMISSIVITY, STEFAN_BOLTZMANN, convection
from ...physics.substances import air_density
from ...worlds.arrays import F64
from .places import Places
from .stock import Stock

if TYPE_CHECKING:
    from ...worlds.categories.gas.facts import Grid
    from ..boundaries import BodyState
    from .pieces import Pieces

__all__ = ["SURFACE_SUMS", "Given", "Surfaces"]

SURFACE_SUMS = ("gasified_fuel", "taken_heat", "taken_light")
"""Sums of surfaces that may burn."""
BEFORE = (0.5, 1.0, 1.5)
"""[cells] How far before a piece its gas is looked for: the first cell that is open enough."""
LEAST_ROOM = 0.25
"""Own choice: open share of the cell that a piece meets."""
BLOCK = 4
"""[cells] Side of the blocks whose light comes from one place."""
DARK = 1e-4
"""Own choice: of the power of the brightest block, below which its light counts for nothing."""


@dataclass(frozen=True)
class Given:
    """Gas and heat that pass between surfaces and gas in a step."""

    gas: F64
    """Mass of gas that each cell gets [kg], shape of the box."""
    volume: F64
    """Volume of that gas at the temperature of the surface that gives it off [m^3], the same shape."""
    taken: F64
    """Heat out of the gas of each cell [J], the same shape."""
    mass: float
    """Mass of all the gas [kg]."""
    heat: float
    """Out of all gas [J]."""
    light: float
    """Taken of the flames' light, less what the surfaces radiate beyond their surroundings [J]."""


class Surfaces:
    """Surfaces of solids and cloth that may burn, in the box of a gas.

    Args:
        pieces: of them.
        grid: the box.
        room: (nx, ny, nz) open share of its cells.
        ambient: temperature of the air [K], at which they start.
    """

    def __init__(self, pieces: Pieces, grid: Grid, room: NDArray[np.floating[Any]], ambient: float) -> None:
        self.pieces, self.grid, self.ambient = pieces, grid, ambient
        self.places, self.stock = Places(pieces), Stock(pieces, ambient)
        self._backs = np.flatnonzero(pieces.thin)
        self._face = np.concatenate([np.arange(len(pieces.area)), self._backs])
        """Piece of each face: the fronts of all, and the backs of cloth."""
        self._area = pieces.area[self._face]
        self._gas = np.array([air_density(t) for t in pieces.of("ignition")])[self._face]
        """Density of what each face gives off [kg/m^3]."""
        self.light = np.zeros(len(self._face))
        """Light of the flames on each face [W/m^2], shape (f,)."""
        self._look(room)

    def place(self, bodies: BodyState, ahead: float, room: NDArray[np.floating[Any]]) -> None:
        """Go to where they are some seconds after a state of the bodies that carry them, among the open shares of cells there."""
        if self.places.move:
            self.places.take(bodies, ahead)
            self._look(room)

    def _look(self, room: NDArray[np.floating[Any]]) -> None:
        """Find the cell that each face meets."""
        sign = np.ones(len(self._face))
        sign[len(self.pieces.area) :] = -1.0
        self.room = np.asarray(room, dtype=np.float64)
        self.point, self.normal = self.places.point[self._face], sign[:, None] * self.places.normal[self._face]
        self.cell = _cells_before(self.point, self.normal, self.grid, self.room)
        """Flat number of the cell that each meets; -1 of one that meets none, shape (f,)."""
        self._upright = np.hypot(self.normal[:, 0], self.normal[:, 1])

    @property
    def _met(self) -> NDArray[np.bool_]:
        """Faces that meet gas: of what is consumed none does."""
        return np.asarray((self.cell >= 0) & ~self.stock.consumed[self._face])

    @property
    def heat(self) -> float:
        """In all of them above that at the start [J]."""
        return float(self.stock.heat @ self.pieces.area)

    @property
    def gasification_heat(self) -> float:
        """Heat that has made gas of them so far [J]."""
        return float(self.stock.gasification @ self.pieces.area)

    def shine(self, power: F64) -> None:
        """Take the light of flames from the power that each cell radiates [W], (nx, ny, nz): blocks of cells are points that shine evenly all
        around, through everything; together they light no more than they give."""
        place, strength = _lamps(power, self.grid)
        self.light = np.zeros(len(self._face))
        near = 0.5 * BLOCK * self.grid.cell
        for at, watts in zip(place, strength, strict=True):
            way = at - self.point
            square = np.maximum(np.sum(way * way, axis=1), near * near)
            facing = np.sum(way * self.normal, axis=1) / np.sqrt(square)
            self.light += watts * np.maximum(facing, 0.0) / (4.0 * np.pi * square)
        self.light *= self._met
        taken, given = EMISSIVITY * float(self.light @ self._area), float(strength.sum())
        if taken > given:
            self.light *= given / taken

    def step(self, seconds: float, temperature: F64) -> Given:
        """Heat up for a time and give off gas.

        Args:
            seconds: how long.
            temperature: of the gas [K], (nx, ny, nz).
        """
        stock, count, met = self.stock, self.room.size, self._met
        cell, surface = np.maximum(self.cell, 0), stock.surface[self._face]
        gas = temperature.reshape(-1)[cell]
        by_gas = np.where(met, convection(gas, surface, self._upright), 0.0)
        own = STEFAN_BOLTZMANN * (surface**4 - self.ambient**4)
        by_light = np.where(met, EMISSIVITY * (self.light - own), 0.0)
        made = stock.step(seconds, self._per_piece(by_gas + by_light))[self._face] * self._sides(met) * self._area
        taken = seconds * by_gas * self._area

        def per_cell(values: F64) -> F64:
            return np.asarray(np.bincount(cell, values, minlength=count).reshape(self.room.shape), dtype=np.float64)

        light = seconds * float(by_light @ self._area)
        return Given(per_cell(made), per_cell(made / self._gas), per_cell(taken), float(made.sum()), float(taken.sum()), light)

    def _per_piece(self, values: F64) -> F64:
        """Sums over the faces of each piece (f,) -> (n,)."""
        found = values[: len(self.pieces.area)].copy()
        found[self._backs] += values[len(found) :]
        return found

    def _sides(self, met: NDArray[np.bool_]) -> F64:
        """Share of a piece's gas that leaves by each face, (f,): by those that meet gas alike."""
        share, count = np.ones(len(self._face)), len(self.pieces.area)
        front, back = met[:count][self._backs], met[count:]
        both = front.astype(np.float64) + back
        share[self._backs] = np.where(both > 0.0, front / np.maximum(both, 1.0), 1.0)
        share[count:] = 1.0 - share[self._backs]
        return share

    def pack(self) -> dict[str, F64]:
        """State that the next step depends on."""
        return {**self.stock.pack(), "surfaces/light": self.light}

    def unpack(self, found: dict[str, Any]) -> None:
        """Continue from such a state."""
        self.stock.unpack(found)
        self.light = np.array(found["surfaces/light"], dtype=np.float64)

    def measured(self) -> dict[str, Any]:
        """Channels and records of the present state."""
        return {
            "burning_part": self.pieces.part,
            "burning_point": self.places.point.copy(),
            "burning_area": self.pieces.area,
            "burning_left": self.stock.left,
            "burning_temperature": self.stock.surface.copy(),
            "burning_heat": self.stock.heat,
            "record/surface_heat": np.float64(self.heat),
            "record/gasification_heat": np.float64(self.gasification_heat),
        }


def _cells_before(point: F64, normal: F64, grid: Grid, room: F64) -> NDArray[np.int64]:
    """Flat number of the first open cell before each piece, (n, 3) and (n, 3) -> (n,); -1 where there is none."""
    found = np.full(len(point), -1, dtype=np.int64)
    for far in BEFORE:
        at = np.floor((point + far * grid.cell * normal - grid.corner) / grid.cell).astype(np.int64)
        inside = ((at >= 0) & (at < np.array(grid.shape))).all(axis=1)
        at = np.clip(at, 0, np.array(grid.shape) - 1)
        fits = inside & (room[tuple(at.T)] >= LEAST_ROOM) & (found < 0)
        found[fits] = np.ravel_multi_index(tuple(at[fits].T), grid.shape)
    return found


def _lamps(power: F64, grid: Grid) -> tuple[F64, F64]:
    """Places (m, 3) [m] and powers (m,) [W] of the blocks of cells that shine."""
    at = np.argwhere(power > 0.0)
    if len(at) == 0:
        return np.zeros((0, 3)), np.zeros(0)
    watts = power[tuple(at.T)].astype(np.float64)
    blocks = tuple(-(-n // BLOCK) for n in grid.shape)
    number = np.ravel_multi_index(tuple((at // BLOCK).T), blocks)
    _, member = np.unique(number, return_inverse=True)
    total = np.bincount(member, watts)
    middle = grid.corner + grid.cell * (at + 0.5)
    place = np.stack([np.bincount(member, watts * middle[:, a]) for a in range(3)], axis=1) / total[:, None]
    bright = total >= DARK * total.max()
    return place[bright], total[bright]
