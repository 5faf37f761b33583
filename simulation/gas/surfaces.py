"""Surfaces of solids in a gas that take heat from it and from its flames, and give off gas that burns (R100).

A surface is cut into pieces no wider than a cell. Each has layers below it (`physics/pyrolysis.py`), gets heat from the gas of the cell before it
and from the light of all flames, and gives its gas to that cell.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...physics.pyrolysis import EMISSIVITY, STEFAN_BOLTZMANN, Slab, Solid, convection
from ...physics.substances import air_density
from ...worlds.arrays import F64

if TYPE_CHECKING:
    from ...worlds.built import TriangleMesh
    from ...worlds.categories.gas.facts import Grid
    from ...worlds.categories.gas.models import Flammable

__all__ = ["Given", "Pieces", "Surfaces", "cut_into_pieces"]

MOST_PIECES = 20_000
"""Own choice: of all surfaces; more are cut coarser."""
COARSER = 1.3
BEFORE = (0.5, 1.0, 1.5)
"""[cells] How far before a piece its gas is looked for: the first cell that is open enough."""
LEAST_ROOM = 0.25
"""Own choice: open share of the cell that a piece meets."""
BLOCK = 4
"""[cells] Side of the blocks whose light comes from one place."""
DARK = 1e-4
"""Own choice: of the power of the brightest block, below which its light counts for nothing."""


@dataclass(frozen=True)
class Pieces:
    """Pieces of surface of solids that may burn."""

    part: NDArray[np.int32]
    """Number of the part of each, shape (n,)."""
    point: F64
    """Middle [m], shape (n, 3)."""
    normal: F64
    """Outward, shape (n, 3)."""
    area: F64
    """[m^2], shape (n,)."""
    depth: F64
    """Material below it [m], shape (n,): volume over area of its part."""
    density: F64
    """[kg/m^3], shape (n,)."""
    kind: tuple[Flammable, ...]
    """Flammability of each part."""

    def of(self, name: str) -> F64:
        """Burning of each piece: a field of `Flammable`, shape (n,)."""
        return np.array([getattr(k, name) for k in self.kind], dtype=np.float64)[self.part]


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


def cut_into_pieces(mesh: TriangleMesh, widest: float) -> tuple[F64, F64, F64]:
    """Middles (n, 3), outward normals (n, 3) and areas (n,) of the triangles of a surface, halved until no edge is longer than `widest` [m]."""
    corner = np.asarray(mesh.vertices, dtype=np.float64)[mesh.faces]
    done: list[F64] = []
    while len(corner):
        edge = np.linalg.norm(np.roll(corner, -1, axis=1) - corner, axis=2)
        longest = edge.argmax(axis=1)
        fine = edge.max(axis=1) <= widest
        done.append(corner[fine])
        some, k = corner[~fine], longest[~fine]
        row = np.arange(len(some))
        a, b, c = some[row, k], some[row, (k + 1) % 3], some[row, (k + 2) % 3]
        middle = 0.5 * (a + b)
        corner = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    corner = np.concatenate(done)
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    size = np.linalg.norm(across, axis=1)
    kept = size > 0.0
    return corner[kept].mean(axis=1), across[kept] / size[kept, None], 0.5 * size[kept]


class Surfaces:
    """Surfaces of solids that may burn, in the box of a gas.

    Args:
        pieces: of them.
        grid: the box.
        room: (nx, ny, nz) open share of its cells.
        ambient: temperature of the air [K], at which they start.
    """

    def __init__(self, pieces: Pieces, grid: Grid, room: NDArray[np.floating[Any]], ambient: float) -> None:
        self.pieces, self.grid, self.room, self.ambient = pieces, grid, np.asarray(room, dtype=np.float64), ambient
        self.cell = _cells_before(pieces, grid, self.room)
        """Flat number of the cell that each meets; -1 of one that meets none, shape (n,)."""
        self.met = self.cell >= 0
        solid = Solid(
            pieces.depth, pieces.density, pieces.of("conductivity"), pieces.of("heat_capacity"), pieces.of("ignition"),
            pieces.of("gasification"), pieces.of("char"),
        )  # fmt: skip
        self.slab, self._fuel = Slab(solid, ambient), solid.fuel
        self.light = np.zeros(len(pieces.area))
        """Light of the flames on each piece [W/m^2], shape (n,)."""
        self._gas = np.array([air_density(t) for t in pieces.of("ignition")])
        """Density of what each gives off [kg/m^3]."""
        self._upright = np.hypot(pieces.normal[:, 0], pieces.normal[:, 1])

    @property
    def heat(self) -> float:
        """In all of them above that at the start [J]."""
        return float(self.slab.heat @ self.pieces.area)

    @property
    def gasification_heat(self) -> float:
        """Heat that has made gas of them so far [J]."""
        return float(((self._fuel - self.slab.left) * self.slab.gasification) @ self.pieces.area)

    def shine(self, power: F64) -> None:
        """Take the light of flames from the power that each cell radiates [W], (nx, ny, nz): blocks of cells are points that shine evenly all
        around, through everything; together they light no more than they give."""
        place, strength = _lamps(power, self.grid)
        self.light = np.zeros(len(self.pieces.area))
        near = 0.5 * BLOCK * self.grid.cell
        for at, watts in zip(place, strength, strict=True):
            way = at - self.pieces.point
            square = np.maximum(np.sum(way * way, axis=1), near * near)
            facing = np.sum(way * self.pieces.normal, axis=1) / np.sqrt(square)
            self.light += watts * np.maximum(facing, 0.0) / (4.0 * np.pi * square)
        self.light *= self.met
        taken, given = EMISSIVITY * float(self.light @ self.pieces.area), float(strength.sum())
        if taken > given:
            self.light *= given / taken

    def step(self, seconds: float, temperature: F64) -> Given:
        """Heat up for a time and give off gas.

        Args:
            seconds: how long.
            temperature: of the gas [K], (nx, ny, nz).
        """
        pieces, slab, count = self.pieces, self.slab, self.room.size
        met, cell, surface = self.met, np.maximum(self.cell, 0), slab.surface
        gas = temperature.reshape(-1)[cell]
        by_gas = np.where(met, convection(gas, surface, self._upright), 0.0)
        own = STEFAN_BOLTZMANN * (surface**4 - self.ambient**4)
        by_light = np.where(met, EMISSIVITY * (self.light - own), 0.0)
        made = slab.step(seconds, by_gas + by_light) * pieces.area
        taken = seconds * by_gas * pieces.area

        def per_cell(values: F64) -> F64:
            return np.asarray(np.bincount(cell, values, minlength=count).reshape(self.room.shape), dtype=np.float64)

        light = seconds * float(by_light @ pieces.area)
        return Given(per_cell(made), per_cell(made / self._gas), per_cell(taken), float(made.sum()), float(taken.sum()), light)

    def pack(self) -> dict[str, F64]:
        """State that the next step depends on."""
        return {"surfaces/temperature": self.slab.temperature, "surfaces/left": self.slab.left, "surfaces/light": self.light}

    def unpack(self, found: dict[str, Any]) -> None:
        """Continue from such a state."""
        self.slab.temperature = np.array(found["surfaces/temperature"], dtype=np.float64)
        self.slab.left = np.array(found["surfaces/left"], dtype=np.float64)
        self.light = np.array(found["surfaces/light"], dtype=np.float64)


def _cells_before(pieces: Pieces, grid: Grid, room: F64) -> NDArray[np.int64]:
    """Flat number of the first open cell before each piece; -1 where there is none."""
    found = np.full(len(pieces.area), -1, dtype=np.int64)
    for far in BEFORE:
        at = np.floor((pieces.point + far * grid.cell * pieces.normal - grid.corner) / grid.cell).astype(np.int64)
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
