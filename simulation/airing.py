"""Two-way coupling of a gas with what it carries: they go through the same frame, in spans as long as a step of the gas (R66, R67).

In a span the bodies, sheets and particles make their own steps in the gas as it stands at its start, and are told how it gives way to them; what
they say that they got is taken from it, and it steps on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from .coupled_solver import CoupledSolver
from .protocol import SHORTEST, Within, stepping

__all__ = ["Aired", "Airing", "Yields"]


class Yields(Protocol):
    """The medium of a coupled solver, which feels what it carries."""

    def open(self, time: float, seconds: float) -> None:
        """Begin a span at a time [s]: what is asked and told until its step is of so many seconds."""


class Airing:
    """A gas whose steps set the spans in which others go on.

    Args:
        gas: its solver.
        medium: as others meet it.
    """

    def __init__(self, gas: CoupledSolver, medium: Yields) -> None:
        self.gas, self._medium = gas, medium

    def through(self, start: float, end: float, others: Callable[[float, float], None]) -> None:
        """Step from `start` to `end` [s]; `others` takes times from which and to which it steps what is carried."""
        gas, time = self.gas, start
        while time < end - SHORTEST:
            seconds = gas.next_span(end - time)
            until = end if end - time - seconds < SHORTEST else time + seconds
            self._medium.open(time, until - time)
            others(time, until)
            bodies = gas.still() if gas.motion is None or time < -SHORTEST else gas.motion.state(time, until)
            gas.step(until - time, bodies, time)
            time = until


class Aired:
    """A gas and particles or sheets that it carries, all of which read bodies from caches.

    Args:
        airing: the gas.
        others: what it carries.
    """

    def __init__(self, airing: Airing, others: Sequence[CoupledSolver]) -> None:
        self._airing, self._others = airing, tuple(others)
        self._all = (airing.gas, *self._others)
        self.frame = 0

    def prepare(self, *, resumed: bool = False, tell: Within | None = None) -> None:
        """Set all up and run the preroll together: the state at frame 0. `tell` takes how far the preroll is."""
        for one in self._all:
            one.begin_run()
        preroll = self._airing.gas.spec.simulation.preroll
        if preroll > 0 and not resumed:
            self._go(-preroll, 0.0, tell)
        for one in self._all:
            one.start_frames()
        self.frame = 0

    def advance(self, frame: int, *, tell: Within | None = None) -> None:
        """Advance all from frame - 1 to `frame`; `tell` takes how far that is.

        Raises:
            InputError: not the next frame.
            EngineError: a state is not finite.
        """
        length = 1.0 / self._airing.gas.spec.simulation.fps
        for one in self._all:
            one.begin_frame(frame)
        self._go((frame - 1) * length, frame * length, tell)
        for one in self._all:
            one.end_frame()
        self.frame = frame

    def _go(self, start: float, end: float, tell: Within | None) -> None:
        def others(begin: float, until: float) -> None:
            for other in self._others:
                time = begin
                while time < until - SHORTEST:
                    seconds = other.next_span(until - time)
                    moves = other.motion is not None and time >= -SHORTEST
                    bodies = other.motion.state(time, time + seconds) if moves and other.motion is not None else other.still()
                    time += other.step(seconds, bodies, time).dt
            if tell is not None:
                tell((begin - start) / (end - start), stepping(until - begin))

        self._airing.through(start, end, others)
