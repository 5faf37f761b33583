"""How a check of particles states its verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Protocol

from ..worlds.requirements import Check, Correction, Row
from .findings import Finding
from .verdicts import correction, make_row

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..worlds.candidate import Candidate
    from .particle_frames import Swarm, SwarmFrame

__all__ = ["SwarmWatch", "baked_again", "finer_step", "particle_row", "stiffer"]


class SwarmWatch(Protocol):
    """One family of claims about particles: it sees all frames in order, then says what it found."""

    claims: ClassVar[Mapping[str, str]]
    """Predicate by name; a name is the second last part of a row's id."""

    def __init__(self, swarm: Swarm) -> None: ...

    def see(self, now: SwarmFrame, before: SwarmFrame | None) -> None:
        """Take in the next frame.

        Raises:
            EvidenceError: a channel that the claims need is missing.
        """

    def findings(self) -> dict[str, Finding]:
        """The verdict of every claim, after the last frame.

        Raises:
            EvidenceError: there is nothing to judge them by.
        """


def particle_row(
    candidate: Candidate,
    solver: str,
    name: str,
    predicate: str,
    found: Finding,
    *,
    check: Check = "category",
    family: str = "particles:",
) -> Row:
    """The row of one claim about an instance."""
    failed = found.status == "fail"
    members = tuple(candidate.spec.simulation.particles[solver].members)
    named = tuple(dict.fromkeys(n for n in (found.entity, *members) if n))
    return make_row(
        candidate,
        f"{check}:{family}{name}:{solver}",
        check=check,
        group="physical",
        predicate=predicate,
        status=found.status,
        explanation=found.text,
        frames=(0, candidate.last_frame),
        measured=found.measured,
        bound=found.bound,
        comparison=found.comparison if found.measured is not None and found.bound is not None else "",
        unit=found.unit,
        entities=named,
        first_failing_entity=(found.entity or named[0]) if failed else None,
        first_failing_frame=(0 if found.frame is None else found.frame) if failed else None,
        corrections=found.hints,
        evidence={"solver": solver, "category": "particles", **(found.evidence or {})},
        extra=candidate.spec.simulation.limits.model_dump(mode="json"),
    )


def baked_again(cause: str = "the cache was edited or is of another run") -> Correction:
    """Bake again."""
    return correction(cause, "interval", "bake again; never edit cache files", pointers=("/simulation/frames",))


def finer_step(swarm: Swarm, cause: str) -> Correction:
    """Shorten the step."""
    name = "step_share" if swarm.granular else "max_step"
    pointer = f"/simulation/solvers/{swarm.solver}/settings/{name}"
    value = float(getattr(swarm.plan.settings, name))
    patch = ({"op": "add", "path": pointer, "value": float(f"{max(0.02 if swarm.granular else 1e-5, value / 2):.6g}")},)
    return correction(cause, "step", f"halve {name} from {value:g}", pointers=(pointer,), patch=patch)


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
