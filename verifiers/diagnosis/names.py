"""Names that replace the placeholders of the diagnosis tables in a row: who fails, when, what drives it, what set it going."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...worlds.predicates import entities_of
from ..categories.registry import JUDGES

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ...worlds.spec import WorldSpec

__all__ = ["names_of"]

AROUND = 3
"""Frames before and after a failure that the suggested probes look at."""


def names_of(row: Row, spec: WorldSpec | None) -> dict[str, Any]:
    """Names by placeholder for this row; those that it does not tell are left out."""
    named = list(row.entities) or ([row.first_failing_entity] if row.first_failing_entity else [])
    frame = row.first_failing_frame
    tail = row.subject[-1] if row.subject else None
    found: dict[str, Any] = {
        "row": row.id,
        "follows": row.evidence.get("follows"),
        "entity": row.first_failing_entity or next(iter(named), None),
        "other": next((n for n in named if n != (row.first_failing_entity or named[0])), None),
        "frame": frame,
        "first": None if frame is None else max(0, frame - AROUND),
        "last": None if frame is None else frame + AROUND,
        "solver": row.evidence.get("solver") or (tail if row.check in ("numerical", "category") else None),
        "beat": tail if row.check == "beat" else None,
        "shot": tail if row.check == "shots" else None,
    }
    if spec is not None:
        _names_of_spec(found, row, spec)
    return {k: v for k, v in found.items() if v is not None}


def _names_of_spec(found: dict[str, Any], row: Row, spec: WorldSpec) -> None:
    entity, plan = found["entity"], spec.simulation
    if found["last"] is not None:
        found["last"] = max(found["first"], min(found["last"], plan.frames - 1))
    if found["solver"] not in plan.solvers:
        moved = [n for n in (entity, *row.entities) if n in spec.entities and spec.entities[n].motion != "static"]
        found["solver"] = next((s for s, p in plan.solvers.items() for n in moved[:1] if n in p.members), None)
    thrown = [n for n, e in spec.entities.items() if any(getattr(e.physics, "linear_velocity", None) or ())]
    concerned = _concerned(row, spec, found["beat"])
    striking = [n for n in thrown if n in concerned]
    found["striker"] = striking[0] if len(striking) == 1 else None
    if row.check in ("beat", "causal"):
        found["driver"] = _driver(spec, row.subject[0] if row.check == "causal" and row.subject else found["beat"])
    acting = [n for n, d in plan.drivers.items() if getattr(d, "entity", None) in row.entities]
    found["driver"] = found.get("driver") or (acting[0] if len(acting) == 1 else None)
    tip = row.evidence.get("tip")
    # What stands and falls can be set nearer to what follows it; what is thrown starts elsewhere.
    found["tip"] = tip if tip in spec.entities and tip not in thrown else None
    if found["shot"] not in spec.shots:
        found["shot"] = next((n for n, s in spec.shots.items() if found["shot"] in s.covers), None)
    if entity in spec.entities:
        judge = JUDGES.get(spec.entities[entity].physics.category)
        found |= {"material": spec.entities[entity].material, **({} if judge is None else judge.placeholders(spec, entity, row))}


def _upstream(spec: WorldSpec, beats: list[str]) -> list[str]:
    """Beats and all that leads to them, each once."""
    found: dict[str, None] = {}
    todo = [b for b in beats if b in spec.story.beats]
    while todo:
        name = todo.pop(0)
        if name not in found:
            found[name] = None
            todo += [c for c in spec.story.beats[name].causes if c in spec.story.beats]
    return list(found)


def _concerned(row: Row, spec: WorldSpec, beat: str | None) -> set[str]:
    """The row's own entities, and those of the beats that lead to what it judges."""
    beats = spec.story.beats
    own = set(row.entities) | ({row.first_failing_entity} if row.first_failing_entity else set())
    named = [p for p in (beat, *row.subject) if p in beats]
    start = named or [n for n, b in beats.items() if own & {b.subject, *entities_of(b.predicate)}]
    for name in _upstream(spec, start):
        own |= {beats[name].subject, *entities_of(beats[name].predicate)}
        driver = spec.simulation.drivers.get(beats[name].owner)
        own |= {n for n in (getattr(driver, "entity", None),) if n is not None}
    return own


def _driver(spec: WorldSpec, beat: str | None) -> str | None:
    """The driver that starts the chain of causes which ends in a beat."""
    for name in _upstream(spec, [] if beat is None else [beat]):
        if spec.story.beats[name].owner in spec.simulation.drivers:
            return spec.story.beats[name].owner
    return None
