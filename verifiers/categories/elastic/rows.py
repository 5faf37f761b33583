"""Elastic members of an instance, and what their findings and corrections have in common."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....worlds.spec import ElasticPhysics
from ...rows.corrections import correction, pointer
from ...rows.findings import Finding

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction, Status

__all__ = ["change_physics", "elastic_members", "judge_frames", "physics_of"]


def physics_of(candidate: Candidate, entity: str) -> ElasticPhysics:
    """The contract's physics."""
    physics = candidate.spec.entities[entity].physics
    assert isinstance(physics, ElasticPhysics)
    return physics


def elastic_members(candidate: Candidate, solver: str) -> tuple[str, ...]:
    """Names of the elastic entities that an instance moves."""
    entities = candidate.spec.entities
    members = candidate.spec.simulation.solvers[solver].members
    return tuple(m for m in members if m in entities and isinstance(entities[m].physics, ElasticPhysics))


def judge_frames(
    wrong: NDArray[np.bool_],
    text: str,
    measured: float | None,
    bound: float,
    *hints: Correction,
    entity: str | None = None,
    evidence: dict[str, Any] | None = None,
) -> Finding:
    """The finding about something that must hold at every frame: it fails at the first where `wrong`, shape (F,), is true."""
    frame = int(np.argmax(wrong)) if wrong.any() else None
    status: Status = "pass" if frame is None else "fail"
    return Finding(status, text, measured, bound, entity=entity, frame=frame, hints=hints, evidence=evidence)


def change_physics(entities: Iterable[str], name: str, cause: str, group: str, action: str) -> Correction:
    """A correction of one field of the physics of some entities."""
    return correction(cause, group, action, pointers=tuple(pointer("entities", n, "physics", name) for n in entities))
