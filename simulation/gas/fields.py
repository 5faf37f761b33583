"""Fields of a gas, read and written as arrays of the box."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import warp
from ...physics.substances import SEA_LEVEL
from ...worlds.arrays import F64
from .solids import Solids

if TYPE_CHECKING:
    from ..grids.runner import Runner
    from .border import Border
    from .regions import Regions
    from .settings import GasSettings
    from .transport import Transport

__all__ = ["FUEL", "LIGHTNESS", "MOTION", "PACKED", "PRODUCT", "SOOT", "GasFields"]

LIGHTNESS, SOOT, FUEL, PRODUCT = range(4)
"""Quantities of a cell, in this order."""
MOTION = ("velocity", "velocity/before")
OF_SOLIDS = ("room", "opening", "velocity")
PACKED = (*MOTION, "state", "clock", "ratio", *(f"solids/{name}" for name in OF_SOLIDS))
"""Names of what `GasFields.pack` returns."""


class GasFields(ABC):
    """Velocities, amounts, temperatures and pressures of a gas in its box."""

    run: Runner
    shape: tuple[int, int, int]
    elements: int
    settings: GasSettings
    regions: Regions
    transport: Transport
    border: Border
    pressing: tuple[Callable[[Any, str], None], ...] = ()
    """Pushes at open sides, given this gas and the name of its velocity that is about to be projected; without any the ambient pressure does."""
    packed = PACKED
    """Names of what `pack` returns."""
    steps: int
    _at: Solids
    _last: float
    _moves: bool
    _turned = False

    @abstractmethod
    def _stand(self, solids: Solids) -> None:
        """Take the open shares of solids."""

    def take(self) -> F64:
        """(5,) four amounts and the volume that have left through open sides since the last call, less what came in [cells]."""
        return self.border.take()

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
        self.transport.carry(full)

    def _padded(self, name: str, dtype: Any, width: int) -> NDArray[np.float32]:
        found = self.run.read(self.run.array(name, self.elements, dtype), self.elements)
        return found.reshape(*(n + 1 for n in self.shape), width)

    @property
    def room(self) -> NDArray[np.float32]:
        """(nx, ny, nz) open share of cells."""
        return self._at.room[tuple(slice(0, n) for n in self.shape)]

    @property
    def pressure(self) -> F64:
        """(nx, ny, nz) pressure that a region's gas has everywhere [Pa]; the ambient one where there is none."""
        number = self.regions.number.reshape(self._at.room.shape)[tuple(slice(0, n) for n in self.shape)]
        return np.where(number >= 0, self.regions.ratio[number], 1.0) * SEA_LEVEL

    @property
    def temperature(self) -> F64:
        """(nx, ny, nz) [K]."""
        ambient, light = self.settings.ambient_temperature, self.state[..., LIGHTNESS].astype(np.float64)
        return ambient * self.pressure / SEA_LEVEL / (1.0 - light) if self.settings.expands else ambient * (1.0 + light)

    @property
    def power(self) -> NDArray[np.float32]:
        """(nx, ny, nz, 2) heat that fire released, and what was radiated, per volume in the last step [W/m^3]."""
        return self._padded("gas/power", warp().vec2, 2)[tuple(slice(0, n) for n in self.shape)]

    def pack(self) -> dict[str, Any]:
        """Everything that the next step depends on but sources and the air beyond open sides; of solids, those that move."""
        if self._turned:
            self._stand(self._at)
        none = np.zeros(0, np.float32)
        return {
            **{name: self._padded(name, warp().vec3, 3) for name in MOTION},
            "state": self.state,
            "clock": np.array([self.steps, self._last]),
            "ratio": self.regions.ratio,
            **{f"solids/{name}": getattr(self._at, name) if self._moves else none for name in OF_SOLIDS},
        }

    def unpack(self, found: Mapping[str, Any]) -> None:
        """Continue from such a state; raises ValueError where it has another shape."""
        if found["state"].shape != (*self.shape, 4):
            raise ValueError(f"it has {found['state'].shape[:3]} cells, not {self.shape}")
        if self._moves:
            self._stand(Solids(*(found[f"solids/{name}"] for name in OF_SOLIDS)))
        self.regions.set(self.run, found["ratio"])
        for name in MOTION:
            self.run.upload(name, found[name].reshape(-1, 3), warp().vec3)
        self.state = found["state"]
        self.steps, self._last = int(found["clock"][0]), float(found["clock"][1])

    def _scalar(self, values: F64) -> NDArray[np.float32]:
        full = np.zeros(tuple(n + 1 for n in self.shape), np.float32)
        full[tuple(slice(0, n) for n in self.shape)] = values
        return full.ravel()
