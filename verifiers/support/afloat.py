"""Bodies that liquids carry: at rest in the declared volume at frame 0, pushed up by the liquid later (R66, R92)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...geometry import Solid, signed_clearance
from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ..ledgers import motion
from ..ledgers.exchanged import CHANNEL
from .bounds import HELPS

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["afloat", "carriers", "lift"]


def carriers(candidate: Candidate, entity: str) -> dict[str, str]:
    """Liquid entities that act on the entity and are acted on by it, and their solver instances."""
    plan = candidate.spec.simulation
    own = {n for n, s in plan.solvers.items() if entity in s.members}
    found: dict[str, str] = {}
    for coupling in plan.couplings.values():
        ends = {coupling.source, coupling.target}
        if coupling.direction == "two_way" and ends & own:
            for other in ends - own:
                members = plan.solvers[other].members if other in plan.solvers else []
                found |= {m: other for m in members if m in candidate.liquids}
    return found


def lift(candidate: Candidate, entity: str, solver: str) -> F64:
    """Impulse against gravity that a liquid instance gave the entity over each frame, as share of its weight, shape (frames,).

    Nothing is given at frame 0, which ends no interval: it takes the value of frame 1.

    Raises:
        EvidenceError: the instance has no cache or no record of it.
    """
    gravity = np.array(candidate.spec.simulation.gravity)
    weight = motion.entity_mass(candidate, entity) * gravity
    cache = candidate.caches.get(solver)
    if cache is None:
        raise EvidenceError(f"instance {solver!r} has no cache yet; probe or bake it")
    rows = [i for i, name in enumerate(cache.index.colliders) if name.split("/", 1)[0] == entity]
    if not rows or not np.any(weight):
        return np.zeros(candidate.frame_count)
    given: F64 = np.asarray(cache.series(CHANNEL), dtype=np.float64)[: candidate.frame_count, rows, :3].sum(axis=1)
    share = -(given @ weight) / (weight @ weight) * candidate.spec.simulation.fps
    if len(share) > 1:
        share[0] = share[1]
    return np.asarray(share)


def _lies_in(candidate: Candidate, entity: str, liquid: str) -> bool:
    """True if the entity touches the liquid's initial volume, or comes within its resolution of it."""
    spacing = candidate.spec.entities[liquid].physics.flow_cell
    for part in candidate.entity(liquid).parts:
        volume, at = Solid.from_mesh(part.render, closed=part.closed), candidate.pose(liquid, 0, part.body)
        for own in candidate.entity(entity).parts:
            solid = Solid.from_mesh(own.render, closed=own.closed)
            if signed_clearance(solid, candidate.pose(entity, 0, own.body), volume, at).distance <= spacing:
                return True
    return False


def afloat(candidate: Candidate, entity: str) -> dict[str, NDArray[np.bool_]]:
    """At which frames each liquid helps to carry the entity, shape (frames,); before simulation, whether it lies in it."""
    found: dict[str, NDArray[np.bool_]] = {}
    for liquid, solver in carriers(candidate, entity).items():
        if candidate.stage == "static":
            found[liquid] = np.array([_lies_in(candidate, entity, liquid)])
        elif solver in candidate.caches:
            found[liquid] = lift(candidate, entity, solver) >= HELPS
    return {n: frames for n, frames in found.items() if frames.any()}
