"""Protocol of the watches of particles, and corrections that several of them name."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Protocol

from ....worlds.requirements import Correction
from ...rows.corrections import correction
from ...rows.findings import Finding

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Swarm, SwarmFrame

__all__ = ["SwarmWatch", "emitted_slower", "stiffer"]


class SwarmWatch(Protocol):
    """One family of questions about particles: it sees all frames in order, then says what it found."""

    questions: ClassVar[Mapping[str, Question]]
    """Questions by name; a name is the second last part of a row's id."""

    def __init__(self, swarm: Swarm) -> None: ...

    def see(self, now: SwarmFrame, before: SwarmFrame | None) -> None:
        """Take in the next frame.

        Raises:
            EvidenceError: a channel that the questions need is missing.
        """

    def findings(self) -> dict[str, Finding]:
        """Finding on every question by name, after the last frame.

        Raises:
            EvidenceError: there is nothing to judge them by.
        """


def emitted_slower(swarm: Swarm) -> tuple[Correction, ...]:
    """Let them out more slowly; nothing where no emitter does."""
    drivers = swarm.candidate.spec.simulation.drivers
    taps = [n for n, d in drivers.items() if d.kind == "emitter" and d.entity in swarm.members]
    if not taps:
        return ()
    pointers = tuple(f"/simulation/drivers/{n}/speed" for n in taps)
    return (
        correction("an emitter lets them out too fast", "drivers", f"lower the speed of {', '.join(taps)}", pointers=pointers),
    )


def stiffer(swarm: Swarm, cause: str, factor: float) -> Correction:
    """Take stiffer grains."""
    pointers = tuple(f"/entities/{m}/physics/young_modulus" for m in swarm.members)
    patch = tuple(
        {"op": "add", "path": p, "value": float(f"{min(1e11, swarm.physics(k).young_modulus * factor):.3g}")}
        for k, p in enumerate(pointers)
    )
    return correction(
        cause, "mass", f"raise young_modulus {factor:.3g} times; steps get shorter by its root", pointers=pointers, patch=patch
    )
