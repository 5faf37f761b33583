"""A run in which something is prevented, and how much was simulated for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...simulation.variants import simulated

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["Rerun"]


@dataclass(frozen=True)
class Rerun:
    """A run in which something is prevented."""

    candidate: Candidate
    start: int
    """Frame up to which it is the candidate's own."""
    frames: int
    """That are simulated for it."""

    def cost(self) -> dict[str, Any]:
        """How much was simulated by now; steps are, unlike seconds, equal on every machine."""
        rigid, instances = self.candidate.rigid_caches, simulated(self.candidate)
        return {
            "frames_rerun": self.frames if instances else 0,
            "steps_rerun": int(sum(rigid[n].series("record/steps")[self.start + 1 :].sum() for n in instances if n in rigid)),
            "instances_rerun": list(instances),
        }
