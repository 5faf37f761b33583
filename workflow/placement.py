"""Entities put in their places: one, a group or many, in one revision."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from ..worlds.errors import InputError, RefusedError
from .places_asked import Asked, check_asked, number_of
from .places_found import places_of
from .session import Session

if TYPE_CHECKING:
    from ..construction.overlaps import Overlap
    from ..construction.scatters import Place
    from ..construction.scenes import Body, Scene
    from ..worlds.arrays import RigidPose
    from ..worlds.assemblies import Edit
    from ..worlds.spec import WorldSpec

__all__ = ["place", "place_many"]

MOST_EDITS = 1000
"""Edits in which an earlier placement is looked for."""
SHOWN = 20
"""Placed entities and overlaps that a reply names."""


class _Put(NamedTuple):
    """A specification with entities put in their places."""

    spec: WorldSpec
    patch: list[dict[str, Any]]
    follows: set[str]
    """Pointers of what goes along with the change."""
    told: dict[str, Any]


def place(session: Session, asked: Asked, *, hypothesis: str, weakening_reason: str = "") -> dict[str, Any]:
    """Put entities where they are asked for, as one revision; returns poses, what was left behind and overlaps for the reply.

    Raises:
        InputError: an argument is wrong, or there is no such place.
        RefusedError: something would overlap and `strict` is set, or the rules of repair refuse the edit.
    """
    put = _put(session, session.spec, asked)
    if asked.on is not None and not hypothesis.strip() and asked.copy is None and asked.array is None:
        hypothesis = _first_placement(session, asked)
    return _committed(session, put, hypothesis, weakening_reason)


def place_many(session: Session, things: Sequence[Asked], *, hypothesis: str, weakening_reason: str = "") -> dict[str, Any]:
    """Put things in their places one after the other, as one revision; those for which there is no place are told, the others stand.

    Raises:
        InputError: there is a place for none.
        RefusedError: the rules of repair refuse the edit.
    """
    spec, patch, follows = session.spec, [], set[str]()
    placed: list[dict[str, Any]] = []
    refused: list[dict[str, str]] = []
    told: dict[str, Any] = {"still_moving": []}
    for number, asked in enumerate(things):
        try:
            put = _put(session, spec, asked)
        except (InputError, RefusedError) as error:
            refused.append({"thing": f"things[{number}]: {asked.entity}", "why": str(error)})
            continue
        spec, follows = put.spec, follows | put.follows
        patch += put.patch
        placed.append({"id": asked.entity, **_short(put.told["pose"])})
        told["still_moving"] += [put.told["still_moving"]] if "still_moving" in put.told else []
    if not placed:
        why = "; ".join(f"{r['thing']}: {r['why']}" for r in refused[:SHOWN])
        raise InputError(f"none of the {len(things)} things has a place, nothing was changed: {why}")
    told |= {"placed_total": len(placed), "placed": placed}
    if refused:
        told |= {"not_placed": refused}
    return _committed(session, _Put(spec, patch, follows, {k: v for k, v in told.items() if v}), hypothesis, weakening_reason)


def _committed(session: Session, put: _Put, hypothesis: str, weakening_reason: str) -> dict[str, Any]:
    from ..worlds.limits import check_limits

    check_limits(put.spec)
    if put.spec == session.spec:
        return {"moved": False, **put.told}
    outcome = session.commit(
        put.spec, patch=put.patch, hypothesis=hypothesis, weakening_reason=weakening_reason, follows=put.follows
    )
    return {"moved": True, **put.told, **outcome}


def _put(session: Session, before: WorldSpec, asked: Asked) -> _Put:
    """Find the places in a specification that is not committed yet.

    Raises:
        InputError: an argument is wrong, or there is no such place.
        RefusedError: something would overlap and `strict` is set.
    """
    from ..construction.scenes import Scene
    from ..worlds.arrays import compose
    from ..worlds.assemblies import Edit, add_copy, add_move
    from ..worlds.patch import apply_patch
    from .generated import supports_operations

    told: dict[str, Any] = {}
    spec, made = before, _generated(before, asked, told)
    if made:
        spec = apply_patch(spec, made)
        more = [] if asked.on is None else supports_operations(spec, asked.on, asked.entity)
        spec, made = apply_patch(spec, more) if more else spec, made + more
    asked = _with_bodies(spec, asked)
    check_asked(spec, asked)
    names = asked.names
    scene = Scene(session.folder, spec)
    body, old = scene.joined(names), scene.pose(asked.entity)
    places = list(places_of(session, asked, scene, body, told))
    edit, back = Edit(), old.inverse()
    stands: dict[str, tuple[Body, RigidPose]] = {}
    kin: list[Sequence[str]] = []
    _stand(stands, kin, scene, {n: n for n in names}, compose(places[0].pose, back) if asked.copy is None else None, 1.0)
    if asked.copy is None:
        if asked.group is not None:
            add_move(edit, spec, names, compose(places[0].pose, back), cameras=asked.cameras)
        else:
            _only_pose(edit, asked.entity, places[0].pose)
    for suffix, copy in _copies(asked, places):
        motion = compose(copy.pose, back)
        documents = _scaled(spec, asked, copy.size)
        ids = add_copy(edit, spec, names, motion, suffix, on=asked.on, documents=documents)
        _stand(stands, kin, scene, ids, motion, copy.size)
    found = _overlaps(scene, asked, stands, kin)
    after = apply_patch(spec, edit.operations)
    follows = set(edit.follows)
    if any(n not in before.entities or before.entities[n].parts != after.entities[n].parts for n in edit.poses):
        # Entities are made, or made anew: where they and the first of them stand goes along.
        follows |= {f"/entities/{n}/pose" for n in edit.poses}
    if made:  # materials of the table, joints, membership and what carries it come with a thing that is made
        follows |= {str(o["path"]).removesuffix("/-") for o in made if not str(o["path"]).startswith("/entities/")}
        follows |= {f"/materials/{m}" for m in after.materials if m not in before.materials}
    return _Put(after, [*made, *edit.operations], follows, told | _reply(asked, edit, found, places))


def _generated(spec: WorldSpec, asked: Asked, told: dict[str, Any]) -> list[dict[str, Any]]:
    """Operations that make the asset that is asked for."""
    from .generated import asset_operations

    if asked.asset is None:
        return []
    made, said = asset_operations(spec, asked.entity, asked.asset)
    told |= said
    return made


def _with_bodies(spec: WorldSpec, asked: Asked) -> Asked:
    """The same with all bodies of a generated entity going along, where no group is named."""
    entity = spec.entities.get(asked.entity)
    if asked.group is not None or entity is None or entity.asset is None or not entity.asset.bodies:
        return asked
    return replace(asked, group=tuple(entity.asset.bodies))


def _copies(asked: Asked, places: Sequence[Place]) -> Iterator[tuple[str, Place]]:
    if asked.copy is not None:
        yield asked.copy, places[0]
    else:
        yield from ((number_of(k), p) for k, p in enumerate(places) if k)


def _only_pose(edit: Edit, entity: str, pose: RigidPose) -> None:
    from ..worlds.assemblies import pose_json

    edit.poses[entity] = pose_json(pose)
    edit.put(f"/entities/{entity}/pose", edit.poses[entity], follows=False)


def _scaled(spec: WorldSpec, asked: Asked, size: float) -> dict[str, Mapping[str, Any]] | None:
    from ..worlds.scaled import scaled_entity

    return None if size == 1.0 else {asked.entity: scaled_entity(spec, asked.entity, size)}


def _stand(
    stands: dict[str, tuple[Body, RigidPose]],
    kin: list[Sequence[str]],
    scene: Scene,
    ids: Mapping[str, str],
    motion: RigidPose | None,
    size: float,
) -> None:
    """Note where entities or their copies, by new id, will stand; nothing of what does not move."""
    from ..worlds.arrays import compose

    if motion is None:
        return
    for name, new in ids.items():
        body = scene.body(name)
        stands[new] = (body.scaled(size) if size != 1.0 else body, compose(motion, scene.pose(name)))
    kin.append(list(ids.values()))


GRAZES = 0.02
"""[m] Own choice: an overlap up to this is told how far to move, larger ones are of a place that is taken."""
CLEAR = 2e-4
"""[m] Own choice: room beyond what overlaps, less than what counts as contact."""


def _overlaps(
    scene: Scene, asked: Asked, stands: Mapping[str, tuple[Body, RigidPose]], kin: Sequence[Sequence[str]]
) -> list[Overlap]:
    """Overlaps of what was placed, the deepest first.

    Raises:
        RefusedError: there are some, and `strict` is set.
    """
    from ..construction.overlaps import overlaps

    if asked.array is not None and asked.array.kind == "scatter" and asked.strict:
        return []  # outlines apart, and every place asked for what else stands there
    bodies, poses = ({n: s[k] for n, s in stands.items()} for k in (0, 1))
    found = sorted(overlaps(scene, bodies, poses, kin), key=lambda o: -o.depth)  # type: ignore[arg-type]
    if found and asked.strict:
        more = f" ({len(found)} pairs in all)" if len(found) > 1 else ""
        way = f"{found[0].depth + CLEAR:.4f} m away from it is enough" if found[0].depth <= GRAZES else "choose another place"
        raise RefusedError(
            f"{found[0].a!r} would overlap {found[0].b!r} by {found[0].depth:.4g} m there{more}; {way}, "
            "or strict=false to place it anyway (the interpenetration check will fail)"
        )
    return found


def _first_placement(session: Session, asked: Asked) -> str:
    """The hypothesis that the first placement of an entity is by itself, where nothing but support at frame 0 fails; else empty."""
    stages = session.ledger.stages()
    failing = [r for r in session.ledger.rows() if r.status == "fail" and r.mandatory]
    if any(r.check not in ("support", "audit", "shots") or stages.get(r.id) != "static" for r in failing):
        return ""
    path = f"/entities/{asked.entity}/pose"
    if any(o.get("path", "").startswith(path) for edit in session.ledger.revisions(limit=MOST_EDITS) for o in edit["patch"]):
        return ""
    return f"{asked.entity} was never put onto {asked.on}: where it was specified is a guess"


def _reply(asked: Asked, edit: Edit, found: Sequence[Overlap], places: Sequence[Place]) -> dict[str, Any]:
    poses = list(edit.poses.items())
    told: dict[str, Any] = {"pose": edit.poses.get(asked.entity, poses[0][1])}
    if len(poses) > 1 or asked.copy is not None:
        told["placed_total"] = len(poses)
        told["placed"] = [{"id": n, **_short(p)} for n, p in poses[:SHOWN]]
        if len(places) == len(poses):
            for line, there in zip(told["placed"], places, strict=False):
                line |= {"size": round(there.size, 3)} if there.size != 1.0 else {}
        if len(poses) > SHOWN:
            told["placed_more"] = (
                f"{poses[SHOWN][0]} to {poses[-1][0]}: inspect_world(part='spec', pointer='/entities/<id>/pose')"
            )
    if edit.left:
        told["left_behind"] = list(dict.fromkeys(edit.left))[:SHOWN]
    if found:
        told["overlaps"] = [{"a": o.a, "b": o.b, "depth": float(f"{o.depth:.4g}")} for o in found[:SHOWN]]
    return told


def _short(pose: Mapping[str, Any]) -> dict[str, Any]:
    return {k: [round(v, 4) for v in values] for k, values in pose.items()}
