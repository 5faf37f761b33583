"""The job behind build_interior: rooms planned, walled and furnished, as one revision, and checked."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..execution import JobContext
from ..worlds.folder import WorldFolder
from ..worlds.limits import check_limits
from ..worlds.patch import apply_patch
from .rows import news, open_rows
from .session import Session

if TYPE_CHECKING:
    from ..construction.interiors.build import BuiltInterior
    from ..worlds.spec import Interior, WorldSpec

__all__ = ["interior"]

SHOWN = 20
"""Things without a place that a reply names."""


def interior(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Build an interior of the specification, make it the next revision, and run the static checks."""
    from ..construction.interiors.build import build_interior
    from ..worlds.spec import Interior

    session = Session.at(WorldFolder.at(Path(payload["folder"])))
    name, asked = payload["interior"], Interior.model_validate(payload["asked"])
    before = {row.id: row for row in session.ledger.rows()}
    context.progress(0.05, 1.0, "planning and furnishing")
    made = build_interior(name, asked, gap=_gap(session.spec))
    context.check()
    operations = interior_operations(session.spec, name, asked, made)
    after = apply_patch(session.spec, operations)
    check_limits(after)
    follows = {p for o in operations if not (p := str(o["path"])).startswith(("/entities/", "/interiors/"))}
    follows |= {f"/materials/{m}" for m in after.materials if m not in session.spec.materials}
    follows |= {f"/entities/{e}/pose" for e in made.entities}
    data: dict[str, Any] = {"plan": [made.plan.width, made.plan.depth], "rooms": made.rooms, "entities": len(made.entities)}
    if made.lacking:
        data["not_placed"] = made.lacking[:SHOWN]
        data["not_placed_total"] = len(made.lacking)
    outcome = session.commit(after, patch=operations, hypothesis=payload.get("hypothesis", ""), follows=follows)
    data |= {k: v for k, v in outcome.items() if k not in ("changed", "stale")}
    report = session.audit()
    if session.buildable(report):
        context.progress(0.5, 1.0, "building and checking")
        rows, changed, _ = session.check_static()
        data |= {"changed_rows": len(changed), **news(rows, before, static=True)}
        data["static_open"] = [r.id for r in open_rows(rows, static=True) if r.mandatory]
    else:
        data["audit"] = {"passed": False, **news(report.rows, before)}
    return data


def _gap(spec: WorldSpec) -> float:
    """Two collision skins of the rigid instance that things become members of [m]; those of a new one where there is none."""
    from ..worlds.spec import RigidSettings

    rigid = spec.simulation.rigid
    return 2 * (rigid[min(rigid)].settings.skin if rigid else RigidSettings().skin)


def interior_operations(spec: WorldSpec, name: str, asked: Interior, made: BuiltInterior) -> list[dict[str, Any]]:
    """Operations that put an interior into a specification, in place of what was made of it before."""
    old = set(spec.interiors[name].entities) & set(spec.entities) if name in spec.interiors else set()
    edits = _cleared(spec, name, old)
    record = asked.model_dump(mode="json", exclude_none=True, exclude={"entities"}) | {"entities": list(made.entities)}
    whole = {"path": f"/interiors/{name}", "value": record} if spec.interiors else {"path": "/interiors", "value": {name: record}}
    edits.append({"op": "add", **whole})
    for collection, members in (
        ("/entities", made.entities),
        ("/simulation/joints", made.joints),
        ("/graph/regions", made.regions),
        ("/graph/relations", made.relations),
    ):
        edits += [{"op": "add", "path": f"{collection}/{k}", "value": v} for k, v in members.items()]
    rigid = spec.simulation.rigid
    if rigid:
        there = min(rigid)
        others = [m for m in rigid[there].members if m not in old]
        edits.append({"op": "add", "path": f"/simulation/solvers/{there}/members", "value": [*others, *made.entities]})
    else:
        edits.append(
            {"op": "add", "path": "/simulation/solvers/rigid", "value": {"engine": "mujoco", "members": list(made.entities)}}
        )
    return edits


def _cleared(spec: WorldSpec, name: str, old: set[str]) -> list[dict[str, Any]]:
    """Operations that take away what was made before, with the joints, relations and regions that only it has."""
    edits = [{"op": "remove", "path": f"/entities/{k}"} for k in sorted(old)]
    for collection, members in (("/simulation/joints", spec.simulation.joints), ("/graph/relations", spec.graph.relations)):
        for key, member in members.items():
            ends = {getattr(member, k, None) for k in ("parent", "child", "a", "b")}
            if ends & old or (key.startswith(f"{name}_") and ends & set(spec.graph.regions)):
                edits.append({"op": "remove", "path": f"{collection}/{key}"})
    if name in spec.interiors:
        rooms = {f"{name}_{room}" for room in spec.interiors[name].rooms}
        edits += [{"op": "remove", "path": f"/graph/regions/{k}"} for k in sorted(rooms & set(spec.graph.regions))]
    return edits
