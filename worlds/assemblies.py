"""Entities that move, turn and are copied as one, with what belongs to them in world coordinates, as operations of a patch.

Along go joints and springs, paths and other drivers of them, velocities, and, of copies, relations, contact pairs and membership.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .arrays import RigidPose, compose, pose_of, rotation_matrix
from .documents import kept_of_latest
from .errors import InputError
from .references import references
from .shapes import Pose
from .spec import SpecModel, WorldSpec
from .vocabulary import ID_PATTERN

__all__ = ["Edit", "add_copy", "add_move", "bodies_with", "pose_json"]

POINTS = ("anchor", "parent_point", "child_point", "center")
DIRECTIONS = ("axis", "force", "torque", "linear_velocity", "angular_velocity")
CARRIERS = ("supports", "contains")
"""Relations of a copied entity to what stays that its copy has, too: what carries or holds it."""


@dataclass
class Edit:
    """Operations of one edit."""

    operations: list[dict[str, Any]] = field(default_factory=list)
    follows: set[str] = field(default_factory=set)
    """JSON pointers that change only because entities are moved or copied."""
    left: list[str] = field(default_factory=list)
    """Sentences about what did not come along."""
    poses: dict[str, dict[str, Any]] = field(default_factory=dict)
    """New pose of each entity, as in the specification."""

    def put(self, pointer: str, value: Any, *, follows: bool = True) -> None:
        """Add or replace a member."""
        self.operations.append({"op": "add", "path": pointer, "value": value})
        if follows:
            self.follows.add(pointer)


def pose_json(pose: RigidPose) -> dict[str, Any]:
    """A pose as the specification writes it."""
    value: dict[str, Any] = {"position": _numbers(pose.position)}
    if abs(float(pose.quaternion[0])) < 1 - 1e-15:
        sign = -1.0 if pose.quaternion[0] < 0 else 1.0
        value["quaternion"] = [round(sign * float(v), 12) + 0.0 for v in pose.quaternion]
    return value


def bodies_with(spec: WorldSpec, name: str) -> list[str]:
    """Entities of the generated thing that an entity is or belongs to, its main one first; the entity alone where it is none."""
    main = _mains(spec).get(name)
    asset = None if main is None else spec.entities[main].asset
    return [name] if main is None or asset is None else [main, *(b for b in asset.bodies if b in spec.entities)]


@kept_of_latest
def _mains(spec: WorldSpec) -> dict[str, str]:
    """By entity: the main one of the generated thing that it is or belongs to, the first in the order of the specification."""
    found: dict[str, str] = {}
    for main, entity in spec.entities.items():
        for name in () if entity.asset is None else (main, *entity.asset.bodies):
            found.setdefault(name, main)
    return found


def add_move(edit: Edit, spec: WorldSpec, names: Sequence[str], motion: RigidPose, *, cameras: bool = False) -> None:
    """Move entities by one rigid motion of the world, with all that belongs to them."""
    members = set(names)
    for name in names:
        entity = spec.entities[name]
        edit.poses[name] = pose_json(compose(motion, pose_of(entity.pose)))
        edit.put(f"/entities/{name}/pose", edit.poses[name], follows=False)
        physics = _json(entity.physics)
        for key, value in _carried({k: physics[k] for k in DIRECTIONS if k in physics}, motion).items():
            if value != physics[key]:
                edit.put(f"/entities/{name}/physics/{key}", value)
        ends = entity.generator and (entity.generator.attach_start, entity.generator.attach_end)
        edit.left += [f"{name} is tied to {e}, which stays" for e in ends or () if e not in (None, *members)]
    for key, joint in spec.simulation.joints.items():
        ties = {joint.child, joint.parent} - {None}
        if ties & members:
            stays = ties - members
            edit.put(
                f"/simulation/joints/{key}",
                _tied(_json(joint), motion, joint.child in members, joint.parent in members, bool(stays)),
            )
            if stays:
                edit.left.append(
                    f"joint {key} ties to {', '.join(map(str, stays))}, which stays: name it in group or mend the joint"
                )
    for key, driver in spec.simulation.drivers.items():
        acted = {v for _, target, v in references(driver, "") if target == "entity"}
        if not acted & members:
            continue
        if acted <= members:
            edit.put(f"/simulation/drivers/{key}", _carried(_json(driver), motion))
        elif getattr(driver, "region", None) is not None:
            edit.left.append(f"driver {key} acts on others, too: its region stays")
    _domains(edit, spec, members, motion)
    if cameras:
        _cameras(edit, spec, members, motion)


def _json(model: SpecModel) -> dict[str, Any]:
    document: dict[str, Any] = model.model_dump(mode="json", exclude_none=True)
    return document


def _tied(joint: dict[str, Any], motion: RigidPose, child: bool, parent: bool, stays: bool) -> dict[str, Any]:
    """A joint after one or both of its bodies moved; an anchor between a body that moved and one that stays is left alone."""
    if not stays:
        return _carried(joint, motion)
    own = {k: joint[k] for k, moves in (("child_point", child), ("parent_point", parent)) if moves and k in joint}
    return joint | _carried(own, motion)


def _carried(document: Mapping[str, Any], motion: RigidPose) -> dict[str, Any]:
    """Fields of a joint, driver or physics in world coordinates, moved."""
    found = dict(copy.deepcopy(document))
    turn = rotation_matrix(motion.quaternion)
    for key, value in document.items():
        if key in POINTS:
            found[key] = _numbers(motion.apply(np.array([value], dtype=np.float64))[0])
        elif key in DIRECTIONS:
            found[key] = _numbers(turn @ np.array(value, dtype=np.float64))
        elif key == "line":
            found[key] = [_numbers(p) for p in motion.apply(np.array(value, dtype=np.float64))]
        elif key == "pose":
            found[key] = pose_json(compose(motion, pose_of(Pose.model_validate(value))))
        elif key == "region" and isinstance(value, dict):
            found[key] = _carried(value, motion)
        elif key == "keys":
            found[key] = {k: _carried(v, motion) for k, v in value.items()}
    return found


def _numbers(values: Iterable[float]) -> list[float]:
    return [round(float(v), 9) + 0.0 for v in values]


def _domains(edit: Edit, spec: WorldSpec, members: set[str], motion: RigidPose) -> None:
    """Boxes in which loose matter is simulated go along where all of it does and nothing is turned."""
    for key, solver in spec.simulation.solvers.items():
        domain = getattr(solver.settings, "domain", None)
        if domain is None or not members & set(solver.members):
            continue
        if set(solver.members) <= members and abs(motion.quaternion[0]) > 1 - 1e-12:
            edit.put(f"/simulation/solvers/{key}/settings/domain/center", _numbers(motion.apply(np.array([domain.center]))[0]))
        else:
            edit.left.append(f"the domain of solver {key} stays: its box is not turned, and others may be in it")


def _cameras(edit: Edit, spec: WorldSpec, members: set[str], motion: RigidPose) -> None:
    for key, shot in spec.shots.items():
        if not members & {*shot.subjects, shot.follow, *(k.look_at for k in shot.keys.values())}:
            continue
        for name, camera in shot.keys.items():
            place = f"/shots/{key}/keys/{name}"
            edit.put(f"{place}/position", _numbers(motion.apply(np.array([camera.position]))[0]))
            if camera.target is not None:
                edit.put(f"{place}/target", _numbers(motion.apply(np.array([camera.target]))[0]))


def add_copy(
    edit: Edit,
    spec: WorldSpec,
    names: Sequence[str],
    motion: RigidPose,
    suffix: str,
    *,
    on: str | None = None,
    documents: Mapping[str, Mapping[str, Any]] | None = None,
) -> dict[str, str]:
    """Copy entities by one rigid motion, with joints, drivers, relations and contact pairs between them; returns the new ids.

    Copies that were made before under these ids are made anew.

    Args:
        edit: where the operations go.
        spec: the specification.
        names: the entities.
        motion: from the originals to the copies.
        suffix: of all new ids.
        on: what carries the copies instead of what carries the originals.
        documents: entities as JSON where they differ from the originals.

    Raises:
        InputError: a new id is no id, or belongs to something else.
    """
    ids = {name: f"{name}{suffix}" for name in names}
    for name, new in ids.items():
        _free(spec, name, new)
        entity = spec.entities[name]
        document = copy.deepcopy(dict((documents or {}).get(name) or _json(entity)))
        _rename(document, references(entity, ""), ids)
        edit.poses[new] = document["pose"] = pose_json(compose(motion, pose_of(entity.pose)))
        physics = document["physics"]
        physics |= _carried({k: physics[k] for k in DIRECTIONS if k in physics}, motion)
        edit.put(f"/entities/{new}", document, follows=False)
        for key, solver in spec.simulation.solvers.items():
            if name in solver.members and new not in solver.members:
                edit.operations.append({"op": "add", "path": f"/simulation/solvers/{key}/members/-", "value": new})
    joints = dict(_copied_joints(edit, spec, ids, motion, suffix))
    _copy_drivers(edit, spec, ids, joints, motion, suffix)
    _copy_pairs(edit, spec, ids, suffix, on)
    return ids


def _free(spec: WorldSpec, name: str, new: str) -> None:
    if not re.fullmatch(ID_PATTERN, new):
        raise InputError(f"{new!r} is no id: letters, digits, _ and -, at most 64; give another copy suffix, e.g. '_b'")
    known = spec.entities.get(new)
    if new in spec.graph.regions or (known is not None and known.role != spec.entities[name].role):
        raise InputError(f"{new!r} is there already and is no copy of {name!r}; give another copy suffix")


def _rename(
    document: dict[str, Any],
    places: Iterable[tuple[str, str, str]],
    ids: Mapping[str, str],
    joints: Mapping[str, str] | None = None,
) -> None:
    """Point references of a document to the copies of entities and joints; a material or beat may have the same id."""
    for pointer, target, value in list(places):
        copies = {"entity": ids, "node": ids, "joint": joints or {}}.get(target, {})
        if value not in copies:
            continue
        *way, last = pointer.split("/")[1:]
        at: Any = document
        for token in way:
            at = at[int(token)] if isinstance(at, list) else at[token]
        at[int(last) if isinstance(at, list) else last] = copies[value]


def _copied_joints(
    edit: Edit, spec: WorldSpec, ids: Mapping[str, str], motion: RigidPose, suffix: str
) -> Iterator[tuple[str, str]]:
    for key, joint in spec.simulation.joints.items():
        ties = {joint.child, joint.parent} - {None}
        if not ties & set(ids):
            continue
        if not ties <= set(ids):
            edit.left.append(
                f"joint {key} ties to {', '.join(sorted(map(str, ties - set(ids))))}, which is not copied: the copy has none"
            )
            continue
        document = _carried(_json(joint), motion)
        _rename(document, references(joint, ""), ids)
        edit.put(f"/simulation/joints/{key}{suffix}", document)
        yield key, f"{key}{suffix}"


def _copy_drivers(
    edit: Edit, spec: WorldSpec, ids: Mapping[str, str], joints: Mapping[str, str], motion: RigidPose, suffix: str
) -> None:
    for key, driver in spec.simulation.drivers.items():
        found = list(references(driver, ""))
        acted = {v for _, target, v in found if target in ("entity", "joint")}
        listed = getattr(driver, "entities", None)
        if listed:  # a field on chosen entities acts on their copies, too
            for name in sorted(set(listed) & set(ids)):
                if ids[name] not in listed:
                    edit.operations.append({"op": "add", "path": f"/simulation/drivers/{key}/entities/-", "value": ids[name]})
                    edit.follows.add(f"/simulation/drivers/{key}/entities")
        elif acted and acted <= {*ids, *joints}:
            document = _carried(_json(driver), motion)
            _rename(document, found, ids, joints)
            edit.put(f"/simulation/drivers/{key}{suffix}", document)
        elif acted & set(ids):
            edit.left.append(f"driver {key} acts on others, too: the copy has none")


def _copy_pairs(edit: Edit, spec: WorldSpec, ids: Mapping[str, str], suffix: str, on: str | None) -> None:
    """Contact pairs with whatever it is, relations among the copies, and what carries or holds them."""
    for key, pair in spec.simulation.contacts.items():
        if {pair.a, pair.b} & set(ids):
            document = _json(pair) | {"a": ids.get(pair.a, pair.a), "b": ids.get(pair.b, pair.b)}
            edit.put(f"/simulation/contacts/{key}{suffix}", document)
    for key, relation in spec.graph.relations.items():
        inside = {relation.a, relation.b} & set(ids)
        whole = {relation.a, relation.b} <= set(ids)
        if not whole and not (relation.kind in CARRIERS and relation.b in ids and relation.a in spec.entities):
            edit.left += [f"relation {key} ({relation.kind}) is not copied"] if inside else []
            continue
        holder = on if on is not None and relation.kind == "supports" and relation.a not in ids else relation.a
        document = _json(relation) | {"a": ids.get(holder, holder), "b": ids[relation.b]}
        edit.put(f"/graph/relations/{key}{suffix}", document)
