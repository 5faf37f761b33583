"""The solver protocol and the coupling interfaces that every engine implements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from ..worlds.arrays import F64
from ..worlds.cache import CacheIndex

__all__ = ["SHORTEST", "Channel", "Exchange", "Intervention", "Port", "Solver", "Within", "repeated", "stepping"]

SHORTEST = 1e-9
"""[s] Times this close are equal."""

PortKind = Literal["motion", "wrench", "pressure", "heat", "mass"]


@dataclass(frozen=True)
class Channel:
    """What a solver writes per frame."""

    name: str
    dtype: str
    unit: str
    shape: tuple[str, ...]
    """Symbolic, e.g. `("bodies", "3")`."""
    where: Literal["body", "joint", "pair", "event", "frame", "vertex", "cell", "particle", "bond", "break", "case", "load"]


@dataclass(frozen=True)
class Port:
    """A place where two solver instances exchange state."""

    entity: str
    part: str
    kind: PortKind
    direction: Literal["in", "out", "both"]


@dataclass(frozen=True)
class Exchange:
    """What passed through a port during [t0, t1], each side computed by itself."""

    port: Port
    t0: float
    t1: float
    given: F64
    received: F64

    @property
    def residual(self) -> F64:
        """`given + received`; zero when action equals reaction."""
        return self.given + self.received


@dataclass(frozen=True)
class Intervention:
    """What is done to a run from outside, so that something in it does not happen (Pearl's do operator).

    It changes no degree of freedom of the model: a checkpoint of the untouched run continues under it.
    """

    without: frozenset[str] = frozenset()
    """Drivers taken away from the start: a hold never lets go, a path stays where it was, forces and motors do nothing."""
    held: frozenset[str] = frozenset()
    """Entities kept at rest from `since` on, at the pose (jointed ones: at the joint coordinate) that they have then."""
    since: float = 0.0
    """[s]"""
    apart: frozenset[tuple[str, str]] = frozenset()
    """Pairs of entities that pass through each other."""


class Within(Protocol):
    """Takes how far a frame is that is under way."""

    def __call__(self, share: float, doing: str) -> None:
        """`share`: of the frame's time, in [0, 1]; `doing`: in what steps, for whoever waits."""


def stepping(seconds: float) -> str:
    """What is told of a frame that goes on in steps of so many seconds."""
    return f"in steps of {1e3 * seconds:.3g} ms"


def repeated(level: int, most: int, seconds: float) -> str:
    """What is told of a frame that is made again, the `level`-th of at most `most` times, with rigid steps of so many seconds."""
    return f"made again with rigid steps of {1e3 * seconds:.3g} ms ({level} of at most {most} times)"


class Solver(Protocol):
    """One running engine. States are opaque bytes; equal bytes and settings continue equally."""

    def prepare(self, *, resumed: bool = False) -> None:
        """Build the engine's model and the state at frame 0; `resumed` leaves out what a checkpoint restored next replaces."""

    def max_stable_dt(self) -> float:
        """Largest stable time step in the present state [s]."""

    def advance(self, frame: int, *, tell: Within | None = None) -> None:
        """Advance from frame - 1 to `frame` by the instance's own sub-steps; `tell` takes how far it is."""

    def checkpoint(self) -> bytes:
        """The full state; also makes the running solver continue from exactly these bytes."""

    def restore(self, state: bytes, frame: int) -> None:
        """Continue from a checkpoint taken at `frame`."""

    def index(self) -> CacheIndex:
        """What the channels' rows stand for."""

    def channels(self) -> tuple[Channel, ...]:
        """What `frame_data` holds."""

    def frame_data(self) -> Mapping[str, Any]:
        """Channels and records of the present frame, by name."""

    def ports(self) -> tuple[Port, ...]:
        """Where other instances can act on this one."""

    def respond(self, port: Port, wrench: F64) -> F64:
        """Velocity change (6,) [linear, angular] of the port's body per unit time under a wrench (6,) at its centre of mass."""
