"""Bodies stay near the scene, unless the story sends them away."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.predicates import Crosses, Displacement, Reaches, StaysIn, entities_of
from ....worlds.spec import BoxRegion, CylinderRegion, SphereRegion
from ...ledgers import motion
from ...rows.corrections import correction, halve_step, separate
from ...rows.findings import Finding
from .bounds import ESCAPE
from .links import owners

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate

__all__ = ["escape"]


def escape(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Distance of every body from the middle of the scene, along each axis."""
    low, high = motion.scene_box(candidate)
    middle, extent = (low + high) / 2, float((high - low).max())
    bound = ESCAPE * extent / 2
    sent = _sent_away(candidate, middle, bound)
    worst, culprit, at, checked = 0.0, None, None, []
    for name in dict.fromkeys(owners(cache)):
        if name in sent:
            continue
        checked.append(name)
        away = np.abs(motion.centers(candidate, name) - middle).max(axis=1)
        outside = ~(away <= bound)
        if outside.any() and (at is None or int(np.argmax(outside)) < at):
            culprit, at = name, int(np.argmax(outside))
        worst = max(worst, float(np.nanmax(away, initial=0.0)))
    text = f"bodies stay within {worst:.3g} m of the middle of the scene ({extent:.3g} m large)"
    if culprit is not None:
        text = f"{culprit} is more than {bound:.3g} m from the middle of the scene from frame {at} on (at most {worst:.3g} m)"
    evidence = {"middle": middle, "extent": extent, "sent_away": sorted(sent)}
    found = Finding("pass", text, worst, bound, "m", entities=tuple(checked), evidence=evidence)
    if culprit is None:
        return found
    hints = (
        separate(culprit),
        halve_step(candidate, solver, "contacts are resolved too late"),
        correction("nothing holds it", "placement", f"put a support under {culprit}", pointers=(f"/entities/{culprit}/pose",)),
    )
    return replace(found, status="fail", entity=culprit, frame=at, hints=hints)


def _sent_away(candidate: Candidate, middle: F64, bound: float) -> set[str]:
    """Entities that a predicate of the story sends beyond the box: a far region or plane, a large displacement."""
    story, regions = candidate.spec.story, candidate.spec.graph.regions
    predicates = [b.predicate for b in story.beats.values()] + [r.predicate for r in story.requirements.values()]
    found: set[str] = set()
    for predicate in predicates:
        goal: F64 | None = None
        if isinstance(predicate, Reaches | StaysIn):
            region = regions.get(predicate.region)
            if isinstance(region, BoxRegion) and region.relative_to is None:
                goal = (np.array(region.min) + np.array(region.max)) / 2
            elif isinstance(region, CylinderRegion | SphereRegion) and region.relative_to is None:
                goal = np.array(region.center)
        elif isinstance(predicate, Crosses):
            goal = np.array(predicate.point)
        far = goal is not None and bool((np.abs(goal - middle) > bound).any())
        if isinstance(predicate, Displacement):
            far = predicate.min is not None and predicate.min > bound
        if far:
            found |= set(entities_of(predicate))
    return found
