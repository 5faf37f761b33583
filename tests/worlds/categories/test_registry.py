"""Every entry of the registry of categories: what it declares is known, and the audit refuses nonsense of it."""

from __future__ import annotations

import math
from functools import cache
from typing import Any, get_args

import pytest
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.categories.caps import CATEGORY_CAPS
from worldagent.worlds.categories.category import CategorySpec, declares
from worldagent.worlds.categories.registry import CATEGORIES, PARAMETERS, shape_of
from worldagent.worlds.groups import GROUPS, group_of
from worldagent.worlds.limits import CAPS, estimate_counts
from worldagent.worlds.predicates.models import ATOMS
from worldagent.worlds.predicates.registry import PREDICATES
from worldagent.worlds.spec import MOVED, Entity, ReleaseDriver, RigidInstance, WorldSpec
from worldagent.worlds.spec.entities import Physics
from worldagent.worlds.spec.fields import FieldDriver
from worldagent.worlds.spec.simulation import Driver, SolverInstance

CONTRACTS = {"breakable": {"pattern": {"kind": "voronoi", "pieces": 4}, "bond": {"tension": 1e6, "shear": 1e6}}}
"""The least that a contract of an entity needs."""
GENERAL = {ReleaseDriver, FieldDriver}
"""Drivers that act on matter of several categories."""

every_category = pytest.mark.parametrize("category", CATEGORIES.values(), ids=CATEGORIES)


def members(union: Any) -> set[type]:
    return set(get_args(get_args(union)[0]))


def entity_of(category: CategorySpec, **changes: Any) -> dict[str, Any]:
    """The least entity of a category, by the fields that its physics requires."""
    entity = {
        "role": "thing",
        "motion": "dynamic",
        "dimensions": {"size": [1, 1, 1]},
        "material": "stuff",
        "parts": {"body": {"shape": {"kind": "box", "size": [1, 1, 1]}}},
    }
    if category.physics is None:
        return {**entity, category.contract: CONTRACTS[category.contract], **changes}
    required = {n: 0.5 for n, f in category.physics.model_fields.items() if f.is_required()}
    return {**entity, "physics": {"category": category.name, **required}, **changes}


def world_of(category: CategorySpec, **changes: Any) -> WorldSpec:
    """A world of one entity of a category and, where it has one, an instance that moves it."""
    settings = {"domain": {"center": [0, 0, 0], "size": [2, 2, 2]}}
    solvers: dict[str, Any] = {"rigid": {"engine": "mujoco", "members": ["thing"]}}
    for model in category.instances[:1]:
        engine = get_args(model.model_fields["engine"].annotation)[0]
        needs = model.model_fields["settings"].is_required()
        solvers = {"own": {"engine": engine, "members": ["thing"], **({"settings": settings} if needs else {})}}
    document = {
        "title": "t",
        "prompt": "A thing.",
        "materials": {"stuff": {"density": 1000.0}},
        "entities": {"thing": entity_of(category, **changes)},
        "simulation": {"frames": 2, "solvers": solvers},
    }
    return WorldSpec.model_validate(document)


def test_every_member_of_the_unions_belongs_to_a_category() -> None:
    """A model that no category declares would be read by the schema and known to nothing else."""
    categories = CATEGORIES.values()
    assert members(Physics) == {c.physics for c in categories if c.physics is not None}
    assert members(SolverInstance) == {i for c in categories for i in c.instances}
    assert members(Driver) == {d for c in categories for d in c.drivers} | GENERAL
    kinds = {kind for model in ATOMS for kind in get_args(model.model_fields["kind"].annotation)}
    assert {p.kind for c in categories for p in c.predicates} <= kinds
    assert kinds <= set(PREDICATES)


@every_category
def test_an_entry_stands_under_its_name_and_has_the_shape_of_its_matter(category: CategorySpec) -> None:
    entity = Entity.model_validate(entity_of(category))
    assert CATEGORIES[category.name] is category
    assert declares(category, entity)
    assert shape_of(entity) == category.shape
    assert (category.physics is None) == bool(category.contract)


@every_category
def test_the_audit_refuses_nonsense_of_it(category: CategorySpec) -> None:
    """A rope that never moves is matter of no category but rigid."""
    rope = {"kind": "rope", "points": [[0, 0, 0], [0, 0, 1]], "radius": 0.01}
    spec = world_of(category, motion="static", parts={}, generator=rope)
    rows = {row.id: row.status for row in audit(spec).rows}
    if category.audit is not None:
        assert rows[f"audit:{category.audit.row}"] == "fail"
    else:
        heavy = world_of(category, physics={"category": category.name, "mass": 1e9})
        assert {row.id: row.status for row in audit(heavy).rows}["audit:masses"] == "fail"


@every_category
def test_its_row_is_asked_for_where_it_is_and_nowhere_else(category: CategorySpec) -> None:
    own = {c.audit.row for c in CATEGORIES.values() if c.audit is not None}
    asked = own & {row.id.removeprefix("audit:") for row in audit(world_of(category)).rows}
    assert asked == ({category.audit.row} if category.audit is not None else set())


@every_category
def test_every_knob_is_a_length_in_the_physics_of_an_engine_of_it(category: CategorySpec) -> None:
    engines = {get_args(i.model_fields["engine"].annotation)[0] for i in category.instances}
    assert set(category.knobs) <= engines
    for knob in (k for knobs in category.knobs.values() for k in knobs):
        assert category.physics is not None
        assert category.physics.model_fields[knob].annotation is float
        assert "[m]" in (category.physics.model_fields[knob].description or "")


@every_category
def test_every_field_of_it_is_in_the_schema_and_in_a_known_group(category: CategorySpec) -> None:
    wrong = [
        parameter.pointer
        for parameter in category.parameters
        if parameter.group not in GROUPS
        or group_of(parameter.pointer.replace("*", "x")).name != parameter.group
        or not stands(parameter.pointer.replace("*", "x"))
        or not set(parameter.eases) <= set(PREDICATES)
    ]
    assert wrong == []


@cache
def _schema() -> dict[str, Any]:
    return WorldSpec.model_json_schema()


def stands(pointer: str) -> bool:
    """True if a schema has something at a pointer, in any member of a union."""
    schema = _schema()
    nodes = [schema]
    for token in pointer.split("/")[1:]:
        below: list[dict[str, Any]] = []
        todo = nodes
        while todo:
            node = todo.pop()
            todo += [schema["$defs"][node["$ref"].rpartition("/")[2]]] if "$ref" in node else []
            todo += [option for kind in ("anyOf", "oneOf", "allOf") for option in node.get(kind, ())]
            below += [node["properties"][token]] if token in node.get("properties", {}) else []
            below += node.get("patternProperties", {}).values()
        nodes = below
    return bool(nodes)


def test_a_field_of_several_categories_is_alike_in_all() -> None:
    """A pointer does not tell the category, so that its group and direction cannot depend on it."""
    declared = [parameter for category in CATEGORIES.values() for parameter in category.parameters]
    assert declared
    other = [
        p.pointer
        for p, at in ((p, PARAMETERS[p.pointer]) for p in declared)
        if (p.group, p.way.direction, p.physical) != (at.group, at.way.direction, at.physical)
    ]
    assert other == []


@every_category
def test_its_estimate_is_finite_and_counts_towards_known_caps(category: CategorySpec) -> None:
    spec = world_of(category)
    found = category.estimate(spec)
    assert set(found) <= set(CAPS)
    assert all(math.isfinite(v) and v >= 0 for v in found.values())
    assert all(estimate_counts(spec)[name] >= amount for name, amount in found.items())
    assert all(CAPS[cap.name] is cap for cap in category.caps)


@every_category
def test_loose_matter_says_what_can_be_asked_of_it(category: CategorySpec) -> None:
    moved = any(category.name in i.moves for i in category.instances)
    assert bool(category.asked) == (category.shape == "loose" and moved)


@every_category
def test_an_engine_moves_it_and_clients_are_told_so(category: CategorySpec) -> None:
    assert category.physics is None or category.name in MOVED
    assert bool(category.covers) == (category.physics is not None)


@every_category
def test_bodies_are_what_rigid_instances_move_and_fluids_are_loose(category: CategorySpec) -> None:
    physics = Entity.model_validate(entity_of(category)).physics
    assert physics.body == (physics.category in RigidInstance.moves)
    assert physics.shape == "loose" or not (physics.flow_cell or physics.levels)
    assert physics.shape == "deforming" or not physics.sheet_thickness


def test_the_caps_of_all_categories_are_those_that_they_declare() -> None:
    """`limits.py` reads them from the plain list, so that listing caps loads no category."""
    declared = {cap.name: cap for category in CATEGORIES.values() for cap in category.caps}
    assert declared == {cap.name: cap for cap in CATEGORY_CAPS}
    assert declared.items() <= CAPS.items()
