"""Entities that a generator makes, as operations of a patch: made, and made anew with what was changed by hand kept."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..worlds.errors import InputError
from .arrangements import AssetAsk
from .lamps import lamp_operations

if TYPE_CHECKING:
    from ..construction.assets.documents import AssetDocuments
    from ..construction.assets.made import Made
    from ..worlds.arrays import RigidPose
    from ..worlds.spec import Asset, Entity, WorldSpec

__all__ = ["asset_operations", "made_of", "place_of", "supports_operations"]

SHOWN = 12
"""Places and kept parts that a reply names."""


def asset_operations(spec: WorldSpec, name: str, asked: AssetAsk) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Operations that put a generated thing into a specification under an id, and what the reply says of it.

    An entity that a generator made before is made anew at its pose; parts that were changed by hand stay as they are.

    Raises:
        InputError: there is no such generator, a parameter is wrong, or the id belongs to something else.
    """
    from ..construction.assets.posing import posed
    from ..construction.assets.registry import generator

    before = spec.entities.get(name)
    if before is not None and before.asset is None:
        raise InputError(f"{name!r} was made by no generator; choose another id, or remove /entities/{name} first")
    made = posed(generator(asked.generator).make(asked.parameters, asked.seed), asked.positions)
    record = {
        "generator": asked.generator,
        "parameters": dict(asked.parameters),
        "seed": asked.seed,
        "positions": asked.positions,
        "fixed": _fixed(asked, before, made),
    }
    motion = asked.motion or (before.motion if before is not None else generator(asked.generator).motion)
    documents = _documents(name, record, made, _pose(before), motion)
    taken = [k for k in documents.entities if k in spec.entities and not _belongs(spec, name, k)]
    if taken:
        raise InputError(f"{taken[0]!r} would be a body of {name!r} and is an entity already; choose another id")
    told = _told(made, documents) | _still_moving(asked, documents)
    if before is not None:
        told |= _kept(spec, name, before, documents)
    return _operations(spec, name, before, documents), told


def _documents(name: str, record: dict[str, Any], made: Made, pose: RigidPose, motion: str) -> AssetDocuments:
    """Documents of a thing; of one that is asked for as static and is not so by itself, stones and blocks that stand beside its main body are static too."""
    from ..construction.assets.documents import asset_documents, body_id
    from ..construction.assets.registry import generator

    documents = asset_documents(name, record, made, pose, motion=motion)
    if motion == "static" != generator(record["generator"]).motion:
        moving = {*(j.child for j in made.joints.values()), *(b for _, b in made.carries)}
        for key, body in made.bodies.items():
            if key not in moving and body.motion is None and body.physics is None:
                documents.entities[body_id(name, key)]["motion"] = "static"
    return documents


def _fixed(asked: AssetAsk, before: Entity | None, made: Made) -> bool:
    """True if the leaves of a thing are to stay where they are made: as asked, else as before. A static thing without leaves is fixed as it is.

    Raises:
        InputError: it has none, and is not static.
    """
    several = len(made.bodies) > 1
    if asked.fixed and not several:
        if asked.motion == "static":
            return False
        raise InputError(
            f"a {asked.generator} has no leaves, drawers or lids that `fixed` could hold; leave it out, or ask for motion 'static'"
        )
    if asked.fixed is None:
        return before is not None and before.asset is not None and before.asset.fixed and several
    return asked.fixed


def _still_moving(asked: AssetAsk, documents: AssetDocuments) -> dict[str, Any]:
    """Note on bodies that move on their joints, or lie loosely, although the thing is asked for as static."""
    hung = [j["child"] for j in documents.joints.values()]
    loose = [n for n, e in documents.entities.items() if e["motion"] == "dynamic" and n not in hung]
    if asked.motion != "static" or not (hung or loose):
        return {}
    moving = [*hung, *loose]
    more = f" and {len(moving) - SHOWN} more" if len(moving) > SHOWN else ""
    how = (
        "turn or slide on joints"
        if hung and not loose
        else "lie loosely"
        if loose and not hung
        else "hang on joints or lie loosely"
    )
    return {"still_moving": f"{', '.join(moving[:SHOWN])}{more} {how}; asset {{fixed: true}} makes them static too"}


def made_of(asset: Asset) -> Made:
    """Bodies that a generator makes for the record of an entity."""
    from ..construction.assets.posing import posed
    from ..construction.assets.registry import make

    return posed(make(asset.generator, asset.parameters, asset.seed), asset.positions)


def _pose(entity: Entity | None) -> RigidPose:
    import numpy as np

    from ..worlds.arrays import RigidPose, pose_of

    return RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])) if entity is None else pose_of(entity.pose)


def _belongs(spec: WorldSpec, name: str, body: str) -> bool:
    asset = spec.entities[name].asset if name in spec.entities else None
    return body == name or (asset is not None and body in asset.bodies)


def _told(made: Made, documents: AssetDocuments) -> dict[str, Any]:
    """Bodies, sizes and places of a thing for the reply."""
    bodies = list(documents.entities)
    size = documents.entities[bodies[0]]["dimensions"]["size"]
    told: dict[str, Any] = {"size": [round(v, 4) for v in size], "parts": len(made.main.parts)}
    if len(bodies) > 1:
        told["bodies"] = bodies[:SHOWN] + ([f"and {len(bodies) - SHOWN} more"] if len(bodies) > SHOWN else [])
    if made.places:
        told["surfaces"] = {
            k: {"height": round(float(p.center[2]), 4), "size": [round(v, 3) for v in p.size]}
            | ({"clearance": round(p.clearance, 3)} if p.clearance < 1e6 else {})
            for k, p in list(made.places.items())[:SHOWN]
        }
    return {"asset": told}


def _kept(spec: WorldSpec, name: str, before: Entity, documents: AssetDocuments) -> dict[str, Any]:
    """Carry parts that differ from what their generator made over to the new ones; names them for the reply."""
    from ..worlds.spec import Part

    assert before.asset is not None
    asset = before.asset
    record = asset.model_dump(mode="json", exclude={"bodies"})
    old = _documents(name, record, made_of(asset), _pose(before), before.motion)
    kept = []
    for key, document in documents.entities.items():
        if key not in spec.entities or key not in old.entities:
            continue
        made = {k: Part.model_validate(p) for k, p in old.entities[key]["parts"].items()}
        now = spec.entities[key].parts
        changed = {k: p for k, p in now.items() if made.get(k) != p}
        document["parts"] |= {k: p.model_dump(mode="json", exclude_none=True) for k, p in changed.items()}
        for gone in set(made) - set(now):
            document["parts"].pop(gone, None)
        kept += [f"{key}/{k}" for k in (*changed, *sorted(set(made) - set(now)))]
    return {"kept_as_changed_by_hand": kept[:SHOWN]} if kept else {}


def _operations(spec: WorldSpec, name: str, before: Entity | None, documents: AssetDocuments) -> list[dict[str, Any]]:
    edits: list[dict[str, Any]] = []

    def put(pointer: str, value: Any) -> None:
        edits.append({"op": "add", "path": pointer, "value": value})

    gone = [] if before is None or before.asset is None else [b for b in before.asset.bodies if b not in documents.entities]
    old = set(gone) | {name, *([] if before is None or before.asset is None else before.asset.bodies)}
    for key, joint in spec.simulation.joints.items():
        if joint.child in old and key not in documents.joints and key.startswith(f"{name}_"):
            edits.append({"op": "remove", "path": f"/simulation/joints/{key}"})
    for key, relation in spec.graph.relations.items():
        if key not in documents.relations and relation.kind == "fastened" and key == f"{relation.b}_fixed" and relation.b in old:
            edits.append({"op": "remove", "path": f"/graph/relations/{key}"})
    for body in gone:
        edits.append({"op": "remove", "path": f"/entities/{body}"})
        edits += _left(spec, body)
    for collection, members in (("/entities", documents.entities), ("/simulation/joints", documents.joints)):
        for key, document in members.items():
            put(f"{collection}/{key}", document)
    for key, document in documents.relations.items():
        put(f"/graph/relations/{key}", document)
    return edits + _memberships(spec, list(documents.entities)) + lamp_operations(spec, documents.entities, old)


def _left(spec: WorldSpec, body: str) -> list[dict[str, Any]]:
    """Operations that take a body that is no more out of solver instances and relations."""
    edits = [
        {"op": "replace", "path": f"/simulation/solvers/{k}/members", "value": [m for m in s.members if m != body]}
        for k, s in spec.simulation.solvers.items()
        if body in s.members
    ]
    return edits + [
        {"op": "remove", "path": f"/graph/relations/{k}"} for k, r in spec.graph.relations.items() if body in (r.a, r.b)
    ]


def _memberships(spec: WorldSpec, bodies: list[str]) -> list[dict[str, Any]]:
    """Operations that make bodies members of the rigid instance that is first by name; of a new one where there is none."""
    rigid = spec.simulation.rigid
    if not rigid:
        return [{"op": "add", "path": "/simulation/solvers/rigid", "value": {"engine": "mujoco", "members": bodies}}]
    first = min(rigid)
    there = set(rigid[first].members)
    return [{"op": "add", "path": f"/simulation/solvers/{first}/members/-", "value": b} for b in bodies if b not in there]


def supports_operations(spec: WorldSpec, on: str, name: str) -> list[dict[str, Any]]:
    """Relations that an entity carries a generated one by its feet, where none says yet what carries them."""
    from ..construction.assets.documents import body_id, feet
    from ..construction.assets.registry import generator

    asset = spec.entities[name].asset
    standing = [name]
    if asset is not None:
        own = feet(made_of(asset), stands=generator(asset.generator).stands)
        standing = [body_id(name, foot) for foot in own]
    carried = {r.b for r in spec.graph.relations.values() if r.kind == "supports"}
    return [
        {"op": "add", "path": f"/graph/relations/{foot}_stands", "value": {"kind": "supports", "a": on, "b": foot}}
        for foot in standing
        if foot not in carried
    ]


def place_of(spec: WorldSpec, on: str, surface: str) -> tuple[Mapping[str, Any], str]:
    """Middle, size and clearance of a named surface of a generated entity, and the entity of the body that has it.

    Raises:
        InputError: the entity was not generated, or has no such surface.
    """
    from ..construction.assets.documents import body_id

    asset = spec.entities[on].asset
    if asset is None:
        raise InputError(f"{on!r} was made by no generator and names no surfaces; leave surface out and give at in the world")
    places = made_of(asset).places
    if surface not in places:
        raise InputError(f"{on!r} has no surface {surface[:60]!r}; a {asset.generator} has {sorted(places)}")
    place = places[surface]
    return {"center": place.center, "size": place.size, "clearance": place.clearance}, body_id(on, place.body)
