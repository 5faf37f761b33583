"""The gas of an instance as a medium that drags other matter along: read from its cache at any place and time (R66)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....physics.drag import Medium
from ....physics.substances import air_density, air_viscosity
from ...arrays import F64

if TYPE_CHECKING:
    from ...fields import Frames
    from ...spec import WorldSpec

__all__ = ["GasMedium", "gas_medium"]

FADES = 4.0
"""[cells] Own choice: beyond its box the gas gives way to the air about it within this distance."""
CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


class _Frame(NamedTuple):
    """Values of the cells at a frame."""

    corner: F64
    values: NDArray[np.float32]
    """Velocity [m/s], temperature [K], soot [kg/m^3] of each cell, shape (nx, ny, nz, 5)."""


class GasMedium:
    """Velocity, density and viscosity of a gas: straight between the middles of cells and between frames; before frame 0 as it is then.

    Its density is that of air of its temperature and of its soot. Beyond its box it gives way to the air about it, as it is at the border.

    Args:
        cache: of its instance.
        cell: [m]
        fps: of the cache.
        coefficient: drag coefficient of rigid bodies in it.
        ambient: temperature of the air about it [K].
    """

    def __init__(self, cache: Frames, cell: float, fps: float, coefficient: float, ambient: float) -> None:
        self._cache, self._cell, self._fps, self._coefficient = cache, cell, fps, coefficient
        self.ambient = (air_density(ambient), float(air_viscosity(np.array(ambient))))
        self._kept: dict[int, _Frame] = {}

    def at(self, points: F64, time: float) -> tuple[Medium, F64]:
        """The medium at points [m], shape (n, 3), and a time [s], and its share in what is there, shape (n,)."""
        last = self._cache.index.frames - 1
        when = min(max(time * self._fps, 0.0), float(last))
        first = min(int(when), max(last - 1, 0))
        share = when - first
        values, weight = self._values(first, points)
        if share > 0.0:
            then, later = self._values(first + 1, points)
            values, weight = values + share * (then - values), weight + share * (later - weight)
        temperature, soot = np.maximum(values[:, 3], 1.0), np.maximum(values[:, 4], 0.0)
        density = air_density(1.0) / temperature + soot
        found = Medium(values[:, :3], density, air_viscosity(temperature), np.full(len(points), self._coefficient))
        return found, weight

    def _values(self, frame: int, points: F64) -> tuple[F64, F64]:
        """Values at points at a frame, shape (n, 5), and their shares in what is there, shape (n,)."""
        now = self._frame(frame)
        shape = np.array(now.values.shape[:3])
        place = (points - now.corner) / self._cell
        beyond = np.maximum(np.maximum(-place, place - shape), 0.0).max(axis=1, initial=0.0)
        middle = np.clip(place - 0.5, 0.0, shape - 1.0)
        first = np.minimum(middle.astype(np.int64), np.maximum(shape - 2, 0))
        beside = middle - first
        found: F64 = np.zeros((len(points), now.values.shape[3]))
        for corner in CORNERS:
            at = np.minimum(first + corner, shape - 1)
            weight = np.where(corner == 1, beside, 1.0 - beside).prod(axis=1)
            found += weight[:, None] * now.values[at[:, 0], at[:, 1], at[:, 2]]
        return found, np.clip(1.0 - beyond / FADES, 0.0, 1.0)

    def _frame(self, frame: int) -> _Frame:
        if frame not in self._kept:
            data = self._cache.read(frame, ("gas_corner", "gas_velocity", "gas_temperature", "gas_soot"))
            values = np.concatenate(
                [data["gas_velocity"], data["gas_temperature"][..., None], data["gas_soot"][..., None]], axis=3
            )
            for old in [k for k in self._kept if abs(k - frame) > 1]:
                del self._kept[old]
            self._kept[frame] = _Frame(np.asarray(data["gas_corner"], dtype=np.float64), values)
        return self._kept[frame]


def gas_medium(spec: WorldSpec, name: str, cache: Frames) -> GasMedium:
    """The gas of an instance as its cache holds it."""
    instance = spec.simulation.gas[name]
    physics = spec.entities[instance.members[0]].physics
    return GasMedium(
        cache, physics.flow_cell, spec.simulation.fps, instance.settings.coefficient, instance.settings.ambient_temperature
    )
