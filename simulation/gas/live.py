"""A gas as what it carries meets it while both are simulated: as `worlds.categories.gas.medium.GasMedium` tells it of a cache, and giving way."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ...physics.drag import Medium
from ...physics.substances import air_density, air_viscosity
from ...worlds.arrays import F64
from ...worlds.categories.gas.medium import FADES
from ...worlds.fields import Dragged
from .reaction import YieldingGas

if TYPE_CHECKING:
    from ...worlds.fields import Answer
    from .reaction import Felt

__all__ = ["LiveGas"]

MOST = 4
"""Own choice: points across what is wider than a cell, at most."""


class Held(Protocol):
    """Solver of a gas."""

    name: str
    instance: Any
    grid: Any
    engine: Any
    """It is there once it is set up."""


class _Answer:
    """Answer of a gas to things, each of which stands at some points."""

    def __init__(self, felt: Felt, owner: np.ndarray, part: F64, count: int) -> None:
        self._felt, self._owner, self._part, self.stopping = felt, owner, part, felt.stopping
        self.change: F64 = np.zeros((count, 3))
        # A point that lies beyond the box meets the air there by the rest, and that does not give way.
        np.add.at(self.change, owner, part[:, None] * felt.change)

    def take(self, impulse: F64, *, back: bool = False) -> None:
        """Take from the gas what things got of it [N s], shape (n, 3), or give that `back`."""
        self._felt.take(self._part[:, None] * impulse[self._owner], back=back)


class LiveGas:
    """The medium of a gas at present.

    Args:
        gas: its solver, set up when it is asked.
    """

    def __init__(self, gas: Held) -> None:
        self._gas = gas
        settings = gas.instance.settings
        self._coefficient = float(settings.coefficient)
        ambient = settings.ambient_temperature
        self.ambient = (air_density(ambient), float(air_viscosity(np.array(ambient))))

    @property
    def _engine(self) -> YieldingGas:
        engine = self._gas.engine
        if not isinstance(engine, YieldingGas):
            raise TypeError(f"the gas of {self._gas.name!r} feels nothing; no coupling of it is two_way")
        return engine

    def open(self, time: float, seconds: float) -> None:
        """Begin a span at a time [s] in which it is asked and told; the step of the gas at its end is as long."""
        self._engine.open(seconds, time)

    def _within(self, points: F64) -> tuple[F64, F64]:
        """Points [cells], and their share in what is there: 1 in the box."""
        grid = self._gas.grid
        place = (points - grid.corner) / grid.cell
        beyond = np.maximum(np.maximum(-place, place - np.array(grid.shape)), 0.0).max(axis=1, initial=0.0)
        return place, np.clip(1.0 - beyond / FADES, 0.0, 1.0)

    def at(self, points: F64, time: float) -> tuple[Medium, F64]:
        """The medium at points [m], shape (n, 3), and its share in what is there, shape (n,)."""
        place, share = self._within(points)
        if not len(points):
            return Medium(np.zeros((0, 3)), *np.zeros((3, 0))), share
        velocity, held = self._engine.look(place, max(time - self._engine.opened, 0.0))
        temperature, soot = np.maximum(held[:, 0], 1.0), np.maximum(held[:, 1], 0.0)
        density = air_density(1.0) / temperature + soot
        return Medium(velocity, density, air_viscosity(temperature), np.full(len(points), self._coefficient)), share

    def answer(self, points: F64, time: float, dragged: Dragged) -> Answer:
        """Its way of giving way to what is at points [m], shape (n, 3), from a time [s] on."""
        grid = self._gas.grid
        place, share = self._within(points)
        owner, offset = _points(None if dragged.reach is None else dragged.reach / grid.cell, len(points))
        part = (share / np.bincount(owner, minlength=len(points)))[owner]
        each = Dragged(
            dragged.velocity[owner], part * dragged.mass[owner], dragged.share[owner], dragged.rate[owner], dragged.seconds
        )
        felt = self._engine.ask(place[owner] + offset, each, max(time - self._engine.opened, 0.0))
        return _Answer(felt, owner, part, len(points))


def _points(reach: F64 | None, count: int) -> tuple[np.ndarray, F64]:
    """Points that stand for things half as wide as `reach` [cells], (n,): whose each is, and how far it lies from the middle [cells]."""
    if reach is None or not (reach > 0.5).any():
        return np.arange(count), np.zeros((count, 3))
    owner, offset = [], []
    for row, wide in enumerate(reach.tolist()):
        many = min(MOST, max(1, int(np.ceil(2.0 * wide))))
        steps = ((np.arange(many) + 0.5) / many * 2.0 - 1.0) * wide
        ball = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
        ball = ball[np.linalg.norm(ball, axis=1) <= wide] if many > 2 else ball if many > 1 else np.zeros((1, 3))
        owner.append(np.full(len(ball), row))
        offset.append(ball)
    return np.concatenate(owner), np.concatenate(offset)
