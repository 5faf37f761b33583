"""Runs in which something is prevented, and how much was simulated for each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...simulation.protocol import Intervention
from ...simulation.variants import first_frame, run_variant, simulated

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["Rerun", "rerun", "rerun_without"]

Tell = Callable[[int, int, str], None]
"""Takes (frames done, frames planned, message)."""


@dataclass(frozen=True)
class Rerun:
    """A run in which something is prevented."""

    candidate: Candidate
    start: int
    """Frame up to which it is the candidate's own."""
    frames: int
    """That are simulated for it."""

    def cost(self) -> dict[str, Any]:
        """Amount simulated by now; steps are, unlike seconds, equal on every machine."""
        rigid, instances = self.candidate.rigid_caches, simulated(self.candidate)
        return {
            "frames_rerun": self.frames if instances else 0,
            "steps_rerun": int(sum(rigid[n].series("record/steps")[self.start + 1 :].sum() for n in instances if n in rigid)),
            "instances_rerun": list(instances),
        }


def rerun(candidate: Candidate, done: Intervention, start: int, end: int, tell: Tell) -> Rerun:
    """The candidate as it goes on from frame `start` to `end` under an intervention; simulated when a frame of it is first read.

    Raises:
        EvidenceError: there is no checkpoint to start from.
    """
    made = run_variant(candidate, done, start=start, end=end, progress=tell)
    return Rerun(made, start, end - first_frame(candidate, start))


def rerun_without(candidate: Candidate, drivers: frozenset[str], start: int, end: int, tell: Tell) -> Rerun:
    """The same with drivers taken away: a hold never lets go, a path stays where it was, forces and motors do nothing.

    Raises:
        EvidenceError: there is no checkpoint to start from.
    """
    return rerun(candidate, Intervention(without=drivers), start, end, tell)
