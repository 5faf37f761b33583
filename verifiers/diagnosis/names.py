"""Names that replace the placeholders of the diagnosis tables in a row: who fails, when, what drives it, what set it going."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import pose_of, rotation_matrix
from ...worlds.predicates import atoms_of, entities_of
from ...worlds.spec import Capsule, Cylinder, Sphere
from ..categories.registry import JUDGES

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ...worlds.spec import Entity, WorldSpec

__all__ = ["names_of"]

AROUND = 3
"""Frames before and after a failure that the suggested probes look at."""
NEAR_END = 6
"""Frames before the end of what was judged in which something may still be under way."""
LEVEL = 0.3
"""[1] Own choice: sine of the slope of an axis about which something still rolls, 17 degrees."""
SLENDER = 1.5
"""Height over least level width from which a body stands upright and may be knocked over, as dominoes do."""
BREAKS = frozenset({"broken", "breach", "debris", "breaks", "cracks"})
"""Kinds of predicates that friction has no part in."""


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
    begun, ended = (row.evidence.get(n) for n in ("onset", "until"))
    if isinstance(begun, int) and isinstance(
        ended, int
    ):  # a row that fails at the end of its interval may tell when it came nearest
        found |= {"first": max(0, begun - AROUND), "last": ended + AROUND}
    if _under_way(row):
        found["ends"] = row.frames[1] if row.frames else frame
    if spec is not None:
        _names_of_spec(found, row, spec)
    found["collides"] = row.id if spec is None or _collide(row, spec) else None
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
    found["tip"] = tip if tip in spec.entities and tip not in thrown and "stands" in _bearing(spec, tip) else None
    if found["shot"] not in spec.shots:
        found["shot"] = next((n for n, s in spec.shots.items() if found["shot"] in s.covers), None)
    if entity in spec.entities:
        judge = JUDGES.get(spec.entities[entity].physics.category)
        found |= {"material": spec.entities[entity].material, **({} if judge is None else judge.placeholders(spec, entity, row))}
        found |= _bearing(spec, entity)
        found["alone"] = None if "stands" in found and found["tip"] else entity
        if found.pop("slides", None) and _slides(row, spec, entity, found["beat"]):
            found["rubs"] = _rubs(spec, entity)


def _collide(row: Row, spec: WorldSpec) -> bool:
    """True if the engine keeps the parts apart that a row names: none of them is one that does not collide."""
    named = {row.evidence.get("part_a"), row.evidence.get("part_b")}
    parts = (p for n in row.entities[:2] if n in spec.entities for k, p in spec.entities[n].parts.items() if k in named)
    return all(p.collides for p in parts)


def _under_way(row: Row) -> bool:
    """True if what fails was nearest at the end of what was judged: more frames may bring it, and bring nothing to what failed before."""
    last = row.frames[1] if row.frames else row.first_failing_frame
    nearest = row.evidence.get("largest_frame", row.evidence.get("frame", row.first_failing_frame))
    return last is not None and isinstance(nearest, int) and nearest >= last - NEAR_END


def _bearing(spec: WorldSpec, entity: str) -> dict[str, Any]:
    """Who stands, so that it may be knocked over; who lies, or floats, and rolls there or rests; the waves that move it."""
    liquids = _liquids_around(spec, entity)
    stands = not liquids and _upright(spec.entities[entity]) and not _starts(spec.entities[entity])
    rolls = not stands and not liquids and _rounded(spec.entities[entity])
    waves = [
        n
        for n, d in spec.simulation.drivers.items()
        if d.kind == "waves" and any(d.entity in spec.simulation.solvers[s].members for s in liquids)
    ]
    found = {"stands" if stands else "lies": entity, "waves": waves[0] if len(waves) == 1 else None}
    return found if stands else found | {"rolls" if rolls else "rests": entity}


def _upright(entity: Entity) -> bool:
    """True of a body that is slender along the vertical as it is placed, not only as it is drawn."""
    # The edge of its box that is nearest to the vertical is its height; the others are its widths, however it is turned.
    height = int(np.argmax(np.abs(rotation_matrix(pose_of(entity.pose).quaternion)[2])))
    widths = [float(s) for k, s in enumerate(entity.dimensions.size) if k != height]
    return float(entity.dimensions.size[height]) >= SLENDER * min(widths)


def _starts(entity: Entity) -> bool:
    """True of a body that moves at frame 0: it is no domino that waits for a blow."""
    return any(any(getattr(entity.physics, n, None) or ()) for n in ("linear_velocity", "angular_velocity"))


def _rounded(entity: Entity) -> bool:
    """True of a body that can roll as it is placed: a ball, or something round about a level axis, by its greatest part."""
    turn = rotation_matrix(pose_of(entity.pose).quaternion)
    for part in entity.parts.values():
        if isinstance(part.shape, Sphere):
            return True
        if isinstance(part.shape, Cylinder | Capsule):
            axis = turn @ rotation_matrix(pose_of(part.pose).quaternion)[:, 2]
            if abs(float(axis[2])) < LEVEL:
                return True
    return False


def _slides(row: Row, spec: WorldSpec, entity: str, beat: str | None) -> bool:
    """True if friction may have a part in what a body is to do: it is not to break, and does not float."""
    kinds = {getattr(a, "kind", "") for a in atoms_of(spec.story.beats[beat].predicate)} if beat in spec.story.beats else set()
    if kinds & BREAKS or row.evidence.get("asks") in BREAKS:
        return False
    return not _liquids_around(spec, entity)


def _rubs(spec: WorldSpec, entity: str) -> str | None:
    """The material that alone decides how a body and what carries it rub, the rougher of the two; None where both are as rough."""
    carriers = [r.a for r in spec.graph.relations.values() if r.kind == "supports" and r.b == entity and r.a in spec.entities]
    under = carriers or [n for n, e in spec.entities.items() if e.motion == "static"]
    names = {spec.entities[n].material for n in (entity, *under)} & set(spec.materials)
    rough = sorted(((spec.materials[n].friction, n) for n in names), reverse=True)
    return rough[0][1] if rough and (len(rough) == 1 or rough[0][0] > rough[1][0]) else None


def _liquids_around(spec: WorldSpec, entity: str) -> set[str]:
    """Instances of liquids that are coupled with the one of an entity."""
    own = {s for s, p in spec.simulation.solvers.items() if entity in p.members}
    met = {s for c in spec.simulation.couplings.values() for s in (c.source, c.target) if own & {c.source, c.target}}
    return met & set(spec.simulation.liquid)


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
