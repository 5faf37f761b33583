"""The job behind build_interior: rooms planned, walled and furnished, as one revision, and checked."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..execution import JobContext
from ..worlds.documents import document_of
from ..worlds.errors import InputError
from ..worlds.folder import WorldFolder
from ..worlds.limits import check_limits
from ..worlds.patch import apply_patch
from .lamps import lamp_operations
from .rows import news, open_rows
from .session import Session

if TYPE_CHECKING:
    from ..construction.interiors.build import BuiltInterior
    from ..worlds.arrays import F64
    from ..worlds.spec import Interior, WorldSpec

__all__ = ["interior", "unlisted"]

SHOWN = 20
"""Things without a place that a reply names."""
ENDS = ("", "_upper", "_wing", "_outside", *(f"_{storey}" for storey in range(1, 6)))
"""Ends of the ids of regions that a room has: of itself, of its part above steps, of its wing, of the ground before its door, on upper storeys."""

TOLERANCE = 1e-12
"""[1] Of the rigid instance that is made for a room. The engine ends its search for forces by the mean inertia of all bodies times their
number (MuJoCo, `mjOption.tolerance`): at 1e-8, among cupboards, a lid of 4 g was left with forces that turned it by 3 degrees in 5 s and
kept the room from sleeping; at 1e-12 it stays, and since rooms fall asleep 5 s of two furnished shelves take a tenth of the time."""


def interior(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Build an interior of the specification, make it the next revision, and run the static checks."""
    from ..construction.interiors.build import build_interior
    from ..construction.interiors.plans import CELL
    from ..worlds.spec import Interior

    session = Session.at(WorldFolder.at(Path(payload["folder"])))
    name, asked = payload["interior"], Interior.model_validate(payload["asked"])
    before = {row.id: row for row in session.ledger.rows()}
    context.progress(0.05, 1.0, "planning and furnishing")
    made = build_interior(name, asked, gap=_gap(session.spec), ground=_ground(session, asked))
    context.check()
    operations = interior_operations(session.spec, name, asked, made)
    after = apply_patch(session.spec, operations)
    check_limits(after)
    follows = {
        f"{collection}/{key}"
        for collection in ("/simulation/joints", "/graph/regions", "/graph/relations")
        for document in (session.spec, after)
        for key in _members(document, collection)
    }
    follows |= {str(o["path"]) for o in operations if str(o["path"]).startswith("/simulation/solvers")}
    follows |= {f"/materials/{m}" for m in after.materials if m not in session.spec.materials}
    follows |= {f"/entities/{e}/pose" for e in made.entities}
    data: dict[str, Any] = {"plan": [made.plan.width, made.plan.depth], "rooms": made.rooms, "entities": len(made.entities)}
    if asked.size is not None and list(asked.size) != data["plan"]:
        data["size_rounded"] = f"asked {list(asked.size)} m; outer walls stand on a grid of {CELL:g} m"
    if made.site:
        data["ground"] = made.site
    if made.lacking:
        data["not_placed"] = made.lacking[:SHOWN]
        data["not_placed_total"] = len(made.lacking)
    if made.left_out:
        data["left_out"] = made.left_out[:SHOWN]
        data["left_out_total"] = len(made.left_out)
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


def unlisted(before: WorldSpec, after: WorldSpec) -> dict[str, list[str]]:
    """Entities that an edit removed and that interiors therefore list no more, by interior."""
    gone = before.entities.keys() - after.entities.keys()
    found = {k: [e for e in i.entities if e in gone][:SHOWN] for k, i in before.interiors.items() if k in after.interiors}
    return {k: names for k, names in found.items() if names}


def _ground(session: Session, asked: Interior) -> Callable[[F64], F64] | None:
    """Height of the ground that an interior stands on, by points of the world; None where it stands on none."""
    from ..construction.scenes import Scene, upper_heights

    if asked.on is None:
        return None
    if asked.on not in session.spec.entities:
        raise InputError(
            f"on {asked.on!r} is no entity; the world has {sorted(session.spec.entities)[:20]}. Of a landscape, build_terrain(size=...) "
            "cuts a ground"
        )
    scene = Scene(session.folder, session.spec)
    body, pose = scene.body(asked.on), scene.pose(asked.on)
    return lambda points: upper_heights(body, pose, points)


def _gap(spec: WorldSpec) -> float:
    """Two collision skins of the rigid instance that things become members of [m]; those of a new one where there is none."""
    from ..worlds.spec import RigidSettings

    rigid = spec.simulation.rigid
    return 2 * (rigid[min(rigid)].settings.skin if rigid else RigidSettings().skin)


def _members(spec: WorldSpec, collection: str) -> Collection[str]:
    """Ids in one of the collections that an interior writes whole."""
    joints, regions, relations = spec.simulation.joints, spec.graph.regions, spec.graph.relations
    found: dict[str, Collection[str]] = {"/simulation/joints": joints, "/graph/regions": regions, "/graph/relations": relations}
    return found[collection]


def interior_operations(spec: WorldSpec, name: str, asked: Interior, made: BuiltInterior) -> list[dict[str, Any]]:
    """Operations that put an interior into a specification, in place of what was made of it before.

    Joints, relations and regions are written collection by collection: a flat has hundreds.
    """
    old = set(spec.interiors[name].entities) & set(spec.entities) if name in spec.interiors else set()
    edits: list[dict[str, Any]] = [{"op": "remove", "path": f"/entities/{k}"} for k in sorted(old)]
    record = asked.model_dump(mode="json", exclude_none=True, exclude={"entities"}) | {"entities": list(made.entities)}
    whole = {"path": f"/interiors/{name}", "value": record} if spec.interiors else {"path": "/interiors", "value": {name: record}}
    edits.append({"op": "add", **whole})
    edits += [{"op": "add", "path": f"/entities/{k}", "value": v} for k, v in made.entities.items()]
    rooms = {f"{name}_{room}{end}" for room in spec.interiors[name].rooms for end in ENDS} if name in spec.interiors else set()
    document = document_of(spec)
    for path, members in (
        ("/simulation/joints", made.joints),
        ("/graph/regions", made.regions),
        ("/graph/relations", made.relations),
    ):
        _, outer, inner = path.split("/")
        kept = {k: v for k, v in document[outer][inner].items() if k not in rooms and not {*_ends(v)} & (old | rooms)}
        edits.append({"op": "add", "path": path, "value": _bare({**kept, **members})})
    return edits + _membership(spec, old, list(made.entities)) + lamp_operations(spec, made.entities, old)


def _ends(member: Mapping[str, Any]) -> Iterator[str]:
    """Entities and regions that a joint or relation ties."""
    return (str(member[k]) for k in ("parent", "child", "a", "b") if member.get(k) is not None)


def _bare(value: Any) -> Any:
    """JSON without nulls, which the specification reads as absent."""
    if isinstance(value, dict):
        return {k: _bare(v) for k, v in value.items() if v is not None}
    return value


def _membership(spec: WorldSpec, old: set[str], bodies: list[str]) -> list[dict[str, Any]]:
    rigid = spec.simulation.rigid
    if not rigid:
        made = {"engine": "mujoco", "members": bodies, "settings": {"tolerance": TOLERANCE}}
        return [{"op": "add", "path": "/simulation/solvers/rigid", "value": made}]
    first = min(rigid)
    others = [m for m in rigid[first].members if m not in old and m not in bodies]
    return [{"op": "add", "path": f"/simulation/solvers/{first}/members", "value": [*others, *bodies]}]
