"""The gas of an instance as a medium that drags other matter along: read from its cache at any place and time (R66)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....physics.drag import Medium
from ....physics.substances import air_density, air_viscosity
from ...arrays import F64

if TYPE_CHECKING:
    from ...cache import Cache
    from ...spec import WorldSpec

__all__ = ["GasMedium", "gas_medium"]

CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


class _Frame(NamedTuple):
    """Values of the cells at a frame."""

    corner: F64
    values: NDArray[np.float32]
    """Velocity [m/s], temperature [K], soot [kg/m^3] of each cell, shape (nx, ny, nz, 5)."""


class GasMedium:
    """Velocity, density and viscosity of a gas: straight between the middles of cells and between frames; before frame 0 as it is then.

    Its density is that of air of its temperature and of its soot. Beyond its box there is none.

    Args:
        cache: of its instance.
        cell: [m]
        fps: of the cache.
        coefficient: drag coefficient of rigid bodies in it.
    """

    def __init__(self, cache: Cache, cell: float, fps: float, coefficient: float) -> None:
        self._cache, self._cell, self._fps, self._coefficient = cache, cell, fps, coefficient
        self._kept: dict[int, _Frame] = {}

    def at(self, points: F64, time: float) -> Medium:
        """The medium at points [m], shape (n, 3), and a time [s]; its density is 0 where it is not."""
        last = self._cache.index.frames - 1
        when = min(max(time * self._fps, 0.0), float(last))
        first = min(int(when), max(last - 1, 0))
        share = when - first
        values, inside = self._values(first, points)
        if share > 0.0:
            then, also = self._values(first + 1, points)
            values, inside = values + share * (then - values), inside & also
        velocity, temperature, soot = values[:, :3], np.maximum(values[:, 3], 1.0), values[:, 4]
        count = len(points)
        return Medium(
            np.where(inside[:, None], velocity, 0.0),
            np.where(inside, air_density(1.0) / temperature + np.maximum(soot, 0.0), 0.0),
            np.where(inside, air_viscosity(temperature), 0.0),
            np.full(count, self._coefficient),
        )

    def _values(self, frame: int, points: F64) -> tuple[F64, NDArray[np.bool_]]:
        """Values at points at a frame, shape (n, 5), and which of these are in the box, shape (n,)."""
        now = self._frame(frame)
        shape = np.array(now.values.shape[:3])
        place = (points - now.corner) / self._cell
        inside = ((place >= 0.0) & (place <= shape)).all(axis=1)
        middle = np.clip(place - 0.5, 0.0, shape - 1.0)
        first = np.minimum(middle.astype(np.int64), np.maximum(shape - 2, 0))
        beside = middle - first
        found: F64 = np.zeros((len(points), now.values.shape[3]))
        for corner in CORNERS:
            at = np.minimum(first + corner, shape - 1)
            weight = np.where(corner == 1, beside, 1.0 - beside).prod(axis=1)
            found += weight[:, None] * now.values[at[:, 0], at[:, 1], at[:, 2]]
        return found, inside

    def _frame(self, frame: int) -> _Frame:
        if frame not in self._kept:
            data = self._cache.read(frame, ("gas_corner", "gas_velocity", "gas_temperature", "gas_soot"))
            values = np.concatenate([data["gas_velocity"], data["gas_temperature"][..., None], data["gas_soot"][..., None]], axis=3)
            for old in [k for k in self._kept if abs(k - frame) > 1]:
                del self._kept[old]
            self._kept[frame] = _Frame(np.asarray(data["gas_corner"], dtype=np.float64), values)
        return self._kept[frame]


def gas_medium(spec: WorldSpec, name: str, cache: Cache) -> GasMedium:
    """The gas of an instance as its cache holds it."""
    instance = spec.simulation.gas[name]
    physics = spec.entities[instance.members[0]].physics
    return GasMedium(cache, physics.flow_cell, spec.simulation.fps, instance.settings.coefficient)
