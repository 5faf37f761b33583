"""Material below pieces of surface: layers of solids, and thin sheets that are consumed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...physics.pyrolysis import Film, Slab, Solid
from ...worlds.arrays import F64

if TYPE_CHECKING:
    from .pieces import Pieces

__all__ = ["Stock"]


class Stock:
    """Material below all pieces.

    Args:
        pieces: of surface.
        ambient: temperature at which they start [K].
    """

    def __init__(self, pieces: Pieces, ambient: float) -> None:
        fields = (
            pieces.depth, pieces.density, pieces.of("conductivity"), pieces.of("heat_capacity"), pieces.of("ignition"),
            pieces.of("gasification"), pieces.of("char"),
        )  # fmt: skip
        self.thin = pieces.thin
        self.slab = Slab(Solid(*(f[~self.thin] for f in fields)), ambient)
        self.film = Film(Solid(*(f[self.thin] for f in fields)), ambient)
        self._first, self._cost = self.left, pieces.of("gasification")

    def _all(self, thick: F64, thin: F64) -> F64:
        found = np.empty(len(self.thin))
        found[~self.thin], found[self.thin] = thick, thin
        return found

    @property
    def surface(self) -> F64:
        """Temperature of each surface [K], shape (n,)."""
        return self._all(self.slab.surface, self.film.temperature)

    @property
    def left(self) -> F64:
        """Mass that can still become gas [kg/m^2], shape (n,)."""
        return self._all(self.slab.left, self.film.left)

    @property
    def heat(self) -> F64:
        """Heat below each above that at the start [J/m^2], shape (n,)."""
        return self._all(self.slab.heat, self.film.heat)

    @property
    def gasification(self) -> F64:
        """Heat that has made gas of each so far [J/m^2], shape (n,)."""
        return np.asarray((self._first - self.left) * self._cost)

    @property
    def consumed(self) -> Any:
        """True of sheets of which no more than char is left, shape (n,)."""
        return self.thin & (self.left <= 0.0)

    def step(self, seconds: float, flux: F64) -> F64:
        """Take up heat for a time [W/m^2] (n,); the gas that each gives off [kg/m^2], shape (n,)."""
        return self._all(self.slab.step(seconds, flux[~self.thin]), self.film.step(seconds, flux[self.thin]))

    def pack(self) -> dict[str, F64]:
        """State that the next step depends on."""
        film = {"surfaces/film": self.film.temperature, "surfaces/film_left": self.film.left} if self.thin.any() else {}
        return {"surfaces/temperature": self.slab.temperature, "surfaces/left": self.slab.left, **film}

    def unpack(self, found: dict[str, Any]) -> None:
        """Continue from such a state."""
        self.slab.temperature = np.array(found["surfaces/temperature"], dtype=np.float64)
        self.slab.left = np.array(found["surfaces/left"], dtype=np.float64)
        if self.thin.any():
            self.film.temperature = np.array(found["surfaces/film"], dtype=np.float64)
            self.film.left = np.array(found["surfaces/film_left"], dtype=np.float64)
