"""What one numerical claim about a solver instance came to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..worlds.requirements import Correction, Status
from .verdicts import correction

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate
    from .predicates.outcome import Comparison

__all__ = ["Finding", "again", "halve", "separate"]


@dataclass(frozen=True)
class Finding:
    """Status, sentence, numbers and corrections of one claim."""

    status: Status
    text: str
    measured: float | None = None
    bound: float | None = None
    unit: str = ""
    entity: str | None = None
    frame: int | None = None
    hints: tuple[Correction, ...] = ()
    evidence: dict[str, Any] | None = None
    comparison: Comparison = "<="


def halve(candidate: Candidate, solver: str, cause: str) -> Correction:
    """Halve the step."""
    step = candidate.spec.simulation.rigid[solver].settings.step
    pointer = f"/simulation/solvers/{solver}/settings/step"
    patch = ({"op": "add", "path": pointer, "value": round(max(2e-5, step / 2), 9)},)
    return correction(cause, "step", f"halve the step from {step:g} s", pointers=(pointer,), patch=patch)


def separate(entity: str | None) -> Correction:
    """Take bodies apart that overlap at the start."""
    return correction(
        "colliders overlap at the start and push each other apart",
        "placement",
        f"separate {entity or 'the bodies'} from its neighbours at frame 0",
        pointers=(f"/entities/{entity}/pose",) if entity else (),
    )


def again(cause: str) -> Correction:
    """Bake again."""
    return correction(cause, "interval", "bake again", pointers=("/simulation/frames",))
