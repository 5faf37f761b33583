"""Names that replace the placeholders of the diagnosis tables in a row: who fails, when, what drives it, what set it going."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...worlds.predicates import entities_of
from ..story.bounds import BEHIND

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ...worlds.spec import FieldDriver, WorldSpec

__all__ = ["names_of"]

AROUND = 3
"""Frames before and after a failure that the suggested probes look at."""
AIRS = ("wind", "turbulence", "vortex")
"""Kinds of fields that make air move."""
COMING = 0.1
"""Own choice: what comes in a quarter of a second, over what is lacking; where it is more, grains still run."""
STEADY = 0.3
"""Own choice: gusts below this share of the wind's speed are weak."""


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
        _names_of_entity(found, entity, row, spec)


def _names_of_entity(found: dict[str, Any], entity: str, row: Row, spec: WorldSpec) -> None:
    """Names that its category of matter asks for: who slides, which wind blows a sheet, which emitter lets particles out."""
    contract, drivers = spec.entities[entity], spec.simulation.drivers
    found["material"] = contract.material
    if contract.physics.category in ("rigid", "elastic"):
        found["slides"] = entity
    elif contract.physics.category == "cloth":
        airs = {n: d for n, d in drivers.items() if d.kind == "field" and d.field.kind in AIRS and _acts(d, entity)}
        winds = {n: d.field for n, d in airs.items() if d.field.kind == "wind"}
        found["wind"] = max(winds, key=lambda n: sum(v * v for v in winds[n].velocity), default=None)
        found["steady"] = found["wind"] if winds and max(w.gust for w in winds.values()) < STEADY else None
        found["becalmed"] = entity if not airs else None
    elif contract.physics.category == "particles":
        emitters = [n for n, d in drivers.items() if d.kind == "emitter" and d.entity == entity]
        found["emitter"] = emitters[0] if len(emitters) == 1 else None
        found["grains"] = entity if contract.physics.law == "granular" else None
        found["flying"] = entity if contract.physics.law == "ballistic" else None
        found["jammed"] = found["grains"] if _stay_behind(row) else None


def _stay_behind(row: Row) -> bool:
    """Whether grains that are lacking in a region lie above what is in it, and hardly any come; so it may be where the row does not tell."""
    above, gained = row.evidence.get("above"), row.evidence.get("gained")
    if above is None or gained is None or row.bound is None or row.measured is None:
        return True
    lacking = row.bound - row.measured
    return bool(above >= BEHIND * lacking and gained <= COMING * lacking)


def _acts(driver: FieldDriver, entity: str) -> bool:
    return driver.entities is None or entity in driver.entities


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
