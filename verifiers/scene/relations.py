"""Relations between vertices of the scene graph that geometry can prove: containment and adjacency (R20, R22)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ...worlds.extents import initial_box
from ...worlds.predicates import Reaches
from ...worlds.requirements import Row
from ...worlds.spec import Adjacent, Contains
from ..predicates.evaluators import evaluate
from ..rows.answers import row_of
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from .questions import RELATION
from .surfaces import surfaces_of

__all__ = ["check"]


def check(candidate: Candidate) -> list[Row]:
    """Rows `relations:<id>` of every `contains` and `adjacent` relation, over the frames that can be inspected."""
    rows: list[Row] = []
    for name, relation in candidate.spec.graph.relations.items():
        judge: Callable[[], Finding]
        if isinstance(relation, Contains) and (relation.frames or (0, 0))[0] <= candidate.last_frame:
            judge = partial(_contains, candidate, name, relation)
        elif isinstance(relation, Adjacent) and {relation.a, relation.b} <= set(candidate.spec.entities):
            judge = partial(_adjacent, candidate, relation)
        else:
            continue
        rows.append(row_of(candidate, RELATION, (name,), judge, entities=(relation.b,)))
    return rows


def _contains(candidate: Candidate, name: str, relation: Contains) -> Finding:
    first, last = relation.frames or (0, candidate.spec.simulation.frames - 1)
    seen = (first, min(last, candidate.last_frame))
    if relation.a in candidate.spec.graph.regions:
        outcome = evaluate(candidate, Reaches(entity=relation.b, region=relation.a, when="always"), seen)
        worst = float(outcome.value or 0.0)
        when = outcome.first_failing_frame
    else:
        gaps = np.array([_outside(candidate, relation.a, relation.b, k) for k in range(seen[0], seen[1] + 1)])
        worst = float(gaps.max())
        when = seen[0] + int(np.argmax(gaps > 0.0)) if worst > 0.0 else None
    hint = correction(
        f"{relation.b!r} is not in {relation.a!r}",
        "placement",
        f"put {relation.b!r} inside {relation.a!r}",
        pointers=(pointer("graph", "relations", name), pointer("entities", relation.b, "pose")),
    )
    return Finding(
        "pass" if when is None else "fail",
        f"{relation.b!r} is {max(worst, 0.0):.4g} m outside {relation.a!r} at worst",
        max(worst, 0.0),
        0.0,
        frame=when,
        hints=(hint,),
        frames=seen,
        # A probe speaks of the frames that it has; a bake of all that the relation asks for.
        needed=(first, last) if candidate.stage == "full" else None,
        predicate=f"the centre of {relation.b!r} stays inside {relation.a!r}",
        extra=relation.model_dump(mode="json"),
    )


def _outside(candidate: Candidate, holder: str, held: str, frame: int) -> float:
    """Distance by which the centre of `held` lies outside the bounding box of `holder`, in the holder's frame [m]; <= 0 inside."""
    body = candidate.entity(holder).bodies[0].name
    to_holder = candidate.pose(holder, frame, body).inverse()
    box = to_holder.apply(candidate.vertices(holder, frame))
    center = to_holder.apply(candidate.center(held, frame)[None])[0]
    return float(np.maximum(box.min(0) - center, center - box.max(0)).max())


def _between_boxes(candidate: Candidate, relation: Adjacent) -> float:
    """Distance of the boxes of two entities of which one has no surface of its own, such as the source of a gas [m].

    Raises:
        EvidenceError: one of them has no shape.
    """
    boxes = [initial_box(candidate.spec.entities[n]) for n in (relation.a, relation.b)]
    if boxes[0] is None or boxes[1] is None:
        raise EvidenceError(f"{relation.a!r} or {relation.b!r} has no shape of its own; relate what it rests on or in")
    apart = np.maximum(np.maximum(boxes[0][0] - boxes[1][1], boxes[1][0] - boxes[0][1]), 0.0)
    return float(np.linalg.norm(apart))


def _adjacent(candidate: Candidate, relation: Adjacent) -> Finding:
    surfaces = surfaces_of(candidate)
    bodies = all(surfaces.parts_of.get(n) for n in (relation.a, relation.b))
    distance = surfaces.gap(relation.a, relation.b, 0).distance if bodies else _between_boxes(candidate, relation)
    ok = distance <= relation.gap
    move = f"bring them {distance - relation.gap:.4g} m closer"
    return Finding(
        "pass" if ok else "fail",
        f"their {'visible surfaces' if bodies else 'declared boxes'} are {distance:.4g} m apart",
        distance,
        relation.gap,
        hints=(correction("they stand too far apart", "placement", move, pointers=(f"/entities/{relation.b}/pose",)),),
        entities=(relation.b, relation.a),
        frames=(0, 0),
        predicate=f"{relation.a!r} and {relation.b!r} stand at most {relation.gap:g} m apart at frame 0",
        extra=relation.model_dump(mode="json"),
    )
