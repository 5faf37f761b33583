"""The protocol that every solver implements, and what is done to a run from outside.

How solvers push one another is `coupling.py`: impulses at every sub-step, by the bodies' state of `boundaries.py`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from ..worlds.cache import CacheIndex

__all__ = ["SHORTEST", "Intervention", "Solver", "Within", "repeated", "stepping"]

SHORTEST = 1e-9
"""[s] Times this close are equal."""


@dataclass(frozen=True)
class Intervention:
    """A change to a run from outside, so that something in it does not happen (Pearl's do operator).

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
    """Progress text for a frame that advances in steps of so many seconds."""
    return f"in steps of {1e3 * seconds:.3g} ms"


def repeated(level: int, most: int, seconds: float) -> str:
    """Progress text for a frame retried with a smaller rigid step [s], the `level`-th of at most `most` times."""
    return f"made again with rigid steps of {1e3 * seconds:.3g} ms ({level} of at most {most} times)"


class Solver(Protocol):
    """One running engine. States are opaque bytes; equal bytes and settings continue equally."""

    settled: bytes | None
    """State at rest from which it starts, as `end_of_settling` of another one gave it; None: from what is declared."""

    def stop(self) -> None:
        """Take all speeds away."""

    def end_of_settling(self) -> bytes:
        """The present state as one at rest, for a solver of the same members, whatever drivers it has.

        Raises:
            EngineError: a member broke or tore.
        """

    def prepare(self, *, resumed: bool = False) -> None:
        """Build the engine's model and the state at frame 0; `resumed` leaves out what a checkpoint restored next replaces."""

    def advance(self, frame: int, *, tell: Within | None = None) -> None:
        """Advance from frame - 1 to `frame` by the instance's own sub-steps; `tell` takes how far it is."""

    def checkpoint(self) -> bytes:
        """The full state; also makes the running solver continue from exactly these bytes."""

    def restore(self, state: bytes, frame: int) -> None:
        """Continue from a checkpoint taken at `frame`.

        Raises:
            EngineError: the bytes are damaged, of another solver or instance, or of another frame.
        """

    def index(self) -> CacheIndex:
        """Names of the rows of the channels."""

    def frame_data(self) -> Mapping[str, Any]:
        """Arrays of the present frame by channel; which ones, `worlds/channels.py` declares."""
