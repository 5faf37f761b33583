"""Frames, ledgers and checkpoints of every solver but the rigid one, around an engine that steps alone or coupled with bodies.

A subclass says how its engine is set up, how it steps and what a frame holds; `coupling.CoupledRun` drives it with bodies.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..worlds.arrays import F64
from ..worlds.cache import CacheIndex
from ..worlds.errors import EngineError, InputError
from .bodies import CacheMotion, resting
from .boundaries import BodyState, Surround
from .protocol import SHORTEST, Intervention, Within, stepping
from .recipes import coupled_recipe
from .sealed import Stamp, seal, unseal

if TYPE_CHECKING:
    from ..worlds.built import BuiltEntity
    from ..worlds.cache import Cache
    from ..worlds.fields import Carrier
    from ..worlds.spec import WorldSpec
    from .step_reports import StepReport

__all__ = ["CoupledSolver", "motion_records"]

Books = dict[str, Any]
"""Sums by name."""


class CoupledSolver(ABC):
    """One instance that meets bodies.

    Args:
        spec: the specification.
        built: its geometry.
        name: the instance.
        caches: of the rigid instances that move what it meets; None: a coupling gives their states.
        intervention: drivers taken away, members held where they are, entities that they pass through.
        recipe: hash of everything that decides its motion, for the cache's index.
        media: of instances that drag its members along.
    """

    KIND = ""
    """Kind of the instance, for messages."""
    REMEDY = ""
    """Advice where its state is no longer finite."""
    PASSES = False
    """True if an intervention may let it through solids."""

    @staticmethod
    def recipe_alone(spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, caches: Mapping[str, Cache]) -> str:
        """Recipe of an instance that reads the bodies' motion from their caches: everything that decides any motion."""
        return coupled_recipe(spec, built)

    def __init__(
        self,
        spec: WorldSpec,
        built: Mapping[str, BuiltEntity],
        name: str,
        *,
        caches: Mapping[str, Cache] | None = None,
        intervention: Intervention | None = None,
        recipe: str = "",
        media: Mapping[str, Carrier] | None = None,
    ) -> None:
        self.spec, self.built, self.name, self.recipe = spec, built, name, recipe
        self.media = media or {}
        self.instance: Any = spec.simulation.solvers[name]
        self.members: tuple[str, ...] = tuple(self.instance.members)
        self._caches = caches
        self.settled: bytes | None = None
        """State at rest from which it starts; None: from what is declared."""
        self.motion: CacheMotion | None = None
        self.frame = 0
        self._done = intervention or Intervention()
        if not self.PASSES and any(set(pair) & set(self.members) for pair in self._done.apart):
            raise InputError(f"{self.KIND} cannot be let through solids in this build ({sorted(self._done.apart)[:2]})")
        self._frame_time = 1.0 / spec.simulation.fps

    # ------------------------------------------------------------------ what engines do

    @property
    @abstractmethod
    def surround(self) -> Surround:
        """The bodies that it meets."""

    @abstractmethod
    def set_up(self) -> None:
        """Make the engine, at the start of the preroll."""

    @abstractmethod
    def max_stable_dt(self) -> float:
        """Longest exchange in the present state [s]."""

    def squeeze(self) -> float:
        """Share of a vessel's width by which a wall may come in before the engine knows of it; infinite where that presses nothing together."""
        return math.inf

    @abstractmethod
    def step(self, limit: float, bodies: BodyState, time: float) -> StepReport:
        """One exchange of at most `limit` seconds from `time`, counted into the frame."""

    @abstractmethod
    def open_ledger(self) -> Books:
        """Sums since frame 0, as they start."""

    @abstractmethod
    def open_tally(self) -> Books:
        """Sums of a frame, as they start."""

    @abstractmethod
    def coordinates(self) -> tuple[F64, F64]:
        """Positions and velocities (n, 3) in the present state [m, m/s]."""

    @abstractmethod
    def measured(self) -> Mapping[str, Any]:
        """Channels and records (`record/*`) of the frame that ends."""

    @abstractmethod
    def pack(self) -> bytes:
        """State of the engine."""

    @abstractmethod
    def unpack(self, state: bytes) -> None:
        """Continue from such a state."""

    def rested(self, state: bytes) -> bytes:
        """A state of the engine without speeds, and with this one's clock and drivers."""
        raise InputError(f"{self.KIND} cannot settle in this build; leave {sorted(self.members)} out of simulation.settle")

    def stop(self) -> None:
        """Take all speeds away."""
        self.unpack(self.rested(self.pack()))

    def end_of_settling(self) -> bytes:
        """The present state, for a solver of the same members.

        Raises:
            EngineError: a member tore.
        """
        return self.pack()

    # ------------------------------------------------------------------ runs

    def prepare(self, *, resumed: bool = False, tell: Within | None = None) -> None:
        """Set up, and let it settle during the preroll around bodies at their places; `tell` takes how far that is.

        Raises:
            InputError: the instance cannot be set up.
        """
        self.begin_run()
        if not resumed:
            seconds, still = self.spec.simulation.preroll, self.still()
            done = 0.0
            while done < seconds - SHORTEST:
                taken = self.step(seconds - done, still, done - seconds).dt
                done += taken
                if tell is not None:
                    tell(done / seconds, stepping(taken))
        self.start_frames()

    def begin_run(self) -> None:
        """Set the engine up, at the start of the preroll."""
        self.set_up()
        self.motion = CacheMotion(self.surround, self._caches, self.spec.simulation.fps) if self._caches else None
        if self.settled is not None:
            with self._stamp(0).fits():
                self.unpack(self.rested(self.settled))
        self._ledger, self._tally = self.open_ledger(), self.open_tally()

    def start_frames(self) -> None:
        """The present state is frame 0: ledgers start here."""
        self._ledger = self.open_ledger()
        self.restore(self._bytes(), 0)
        self._tally = self.open_tally()
        self._finish_frame()

    def still(self) -> BodyState:
        """All bodies at rest at their places of frame 0."""
        return resting(self.surround)

    def held(self, time: float) -> bool:
        """True if an intervention keeps it where it is at `time` [s]."""
        return bool(self._done.held & set(self.members)) and time >= self._done.since - SHORTEST

    def begin_frame(self, frame: int) -> None:
        """Start the next frame.

        Raises:
            InputError: not the next frame.
        """
        if frame != self.frame + 1:
            raise InputError(f"advance({frame}) after frame {self.frame}; the next frame is {self.frame + 1}")
        self._tally = self.open_tally()

    def end_frame(self) -> None:
        """The frame that was begun is reached."""
        self.frame += 1
        self._finish_frame()

    def advance(self, frame: int, *, tell: Within | None = None) -> None:
        """Advance from frame - 1 to `frame`, the bodies on their recorded paths; `tell` takes how far that is.

        Raises:
            InputError: not the next frame.
            EngineError: the state is not finite.
        """
        self.begin_frame(frame)
        start, end = (frame - 1) * self._frame_time, frame * self._frame_time
        time, still = start, self.still()
        while time < end - SHORTEST:
            seconds = self.next_span(end - time)
            bodies = still if self.motion is None else self.motion.state(time, time + seconds)
            taken = self.step(seconds, bodies, time).dt
            time += taken
            if tell is not None:
                tell((time - start) / self._frame_time, stepping(taken))
        self.end_frame()

    def next_span(self, left: float) -> float:
        """Length [s] of the next exchange, `left` [s] before the end of the frame: all that are left are equal."""
        return left / max(1, math.ceil(left / self.max_stable_dt() - 1e-6))

    def _finish_frame(self) -> None:
        if not all(np.isfinite(values).all() for values in self.coordinates()):
            raise EngineError(f"coordinates of {self.name!r} are not finite at frame {self.frame}; {self.REMEDY}")
        self._data = self.measured()

    # ------------------------------------------------------------------ state

    def _bytes(self) -> bytes:
        return seal(self._stamp(self.frame), self._ledger, self.pack())

    def _stamp(self, frame: int) -> Stamp:
        return Stamp(self.instance.engine, self.name, frame)

    def checkpoint(self) -> bytes:
        """The full state; the solver itself continues from exactly these bytes."""
        state = self._bytes()
        self.restore(state, self.frame)
        return state

    def restore(self, state: bytes, frame: int) -> None:
        """Continue from a checkpoint taken at `frame`.

        Raises:
            EngineError: the bytes are damaged, or not a checkpoint of this instance at this frame.
        """
        ledger, held = unseal(self._stamp(frame), state)
        with self._stamp(frame).fits():
            if _form(ledger) != _form(self._ledger):
                raise ValueError(f"it has sums {_form(ledger)}, not {_form(self._ledger)}")
            self.unpack(held)
        self._ledger, self.frame = ledger, frame

    # ------------------------------------------------------------------ output

    def frame_data(self) -> Mapping[str, Any]:
        """Channels and records of the present frame."""
        return self._data

    def index(self) -> CacheIndex:
        """Names behind the channels' rows."""
        from importlib.metadata import version

        return CacheIndex(
            solver=self.name,
            engine=self.instance.engine,
            fps=self.spec.simulation.fps,
            frames=self.spec.simulation.frames,
            bodies=self.members,
            colliders=tuple(b.name for b in self.surround.boundaries),
            joints=(),
            drivers=self.driver_names(),
            settings=self.recipe,
            versions={"numpy": np.__version__, "warp-lang": version("warp-lang")},
        )

    def driver_names(self) -> tuple[str, ...]:
        """Drivers that channels have rows of."""
        return ()


def _form(books: Books) -> dict[str, int]:
    """Names of sums and how many values each has."""
    return {name: len(held) if isinstance(held, list) else 1 for name, held in books.items()}


def motion_records(mass: F64, position: F64, velocity: F64, gravity: F64) -> dict[str, float]:
    """Mass, momentum, kinetic and potential energy of points, and how fast the fastest is; shapes (n,), (n, 3), (n, 3), (3,)."""
    momentum = mass @ velocity if len(mass) else np.zeros(3)
    squared = (velocity**2).sum(axis=1)
    return {
        "mass": float(mass.sum()),
        **{f"momentum_{axis}": float(momentum[k]) for k, axis in enumerate("xyz")},
        "kinetic_energy": 0.5 * float(mass @ squared),
        "potential_energy": -float(mass @ (position @ gravity)),
        "max_speed": float(np.sqrt(squared.max(initial=0.0))),
    }
