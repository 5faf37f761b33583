"""Every field of the schema says whether more of it makes requirements harder, easier, or neither (R157)."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError
from worldagent.worlds import directions
from worldagent.worlds.categories.registry import PARAMETERS
from worldagent.worlds.directions import field_of, way_of
from worldagent.worlds.groups import GROUPS, group_of
from worldagent.worlds.predicates.registry import PREDICATES
from worldagent.worlds.spec import Material, WorldSpec
from worldagent.worlds.vocabulary import SpecModel
from worldagent.worlds.weakened import directed_weakenings


def _walk(node: dict[str, Any], place: str, known: dict[str, Any], found: set[str]) -> None:
    """Pointers of all fields of a schema and of what holds them, with `x` for ids; those of predicates once, below `/predicate`."""
    if place.endswith("/predicate") and place.count("/") > 4:
        return
    if "$ref" in node:
        _walk(known[node["$ref"].rpartition("/")[2]], place, known, found)
    for kind in ("anyOf", "oneOf", "allOf"):
        for option in node.get(kind, ()):
            _walk(option, place, known, found)
    for key, value in node.get("properties", {}).items():
        if not (place.endswith("/predicate") and key in ("of", "hold", "goal")):
            _walk(value, f"{place}/{key}", known, found)
    for member in node.get("patternProperties", {}).values():
        found.add(place)
        _walk(member, f"{place}/x", known, found)
    items = node.get("items")
    if isinstance(items, dict):
        _walk(items, place, known, found)
    if place and (node.get("type") not in (None, "null") or "const" in node or "enum" in node):
        found.add(place)


def _fields(schema: dict[str, Any]) -> set[str]:
    found = set[str]()
    _walk(schema, "", schema["$defs"], found)
    return found


SCHEMA = WorldSpec.model_json_schema()
FIELDS = _fields(SCHEMA)


def _silent(fields: set[str]) -> list[str]:
    return sorted(f for f in fields if way_of(f) is None)


def test_no_field_of_the_schema_is_silent_about_its_direction() -> None:
    assert len(FIELDS) > 500
    assert {"/story/beats/x/predicate/min_cycles", "/entities/x/parts/x/shape/radius", "/terrains/x/layers/x/octaves"} <= FIELDS
    assert _silent(FIELDS) == [], "say in worlds/directions.py, or in the category's parameters, which way these are easier"


@pytest.mark.parametrize("holder", ["Limits", "Box", "Noise", "Topples", "HingeJoint", "Look", "LiquidPhysics", "PathKey"])
def test_a_new_field_that_says_nothing_is_found_by_name(holder: str) -> None:
    schema = copy.deepcopy(SCHEMA)
    schema["$defs"][holder]["properties"]["luck"] = {"type": "number"}
    found = set(_silent(_fields(schema))) - set(_silent(FIELDS))
    assert found
    assert {f.rpartition("/")[2] for f in found} == {"luck"}


def test_every_declaration_is_of_a_field_and_gives_a_known_group_and_a_reason() -> None:
    declared = [*directions.FIELDS, *PARAMETERS.values()]
    assert len(declared) > 400
    for parameter in declared:
        place = parameter.pointer.replace("*", "x")
        assert place in FIELDS, place
        assert parameter.group in GROUPS, place
        assert parameter.way.why, place
        assert field_of(place) is parameter, place


def test_a_field_is_declared_once() -> None:
    told = [p.pointer for p in directions.FIELDS]
    assert len(told) == len(set(told))
    assert set(told) & set(PARAMETERS) == set()


def test_bounds_of_predicates_are_harder_where_their_kind_says_so() -> None:
    declared = [
        (name, up) for info in PREDICATES.values() for name, up in info.tightens.items() if name != "frames" and up != "none"
    ]
    assert len(declared) > 50
    for name, up in declared:
        way = way_of(f"/story/beats/x/predicate/of/3/hold/{name}")
        assert way is not None, name
        assert way.direction == {"up": "harder_up", "down": "harder_down"}[up], name


def test_a_place_in_a_list_is_declared_with_the_list() -> None:
    assert field_of("/entities/x/pose/position/2") is field_of("/entities/x/pose/position")
    assert field_of("/entities/x/physics/currents/reach/speeds/3") is field_of("/entities/x/physics/currents/x/speeds")


def test_an_unknown_field_has_no_direction_and_belongs_to_what_holds_it() -> None:
    for place in ("/simulation/luck", "/entities/x/physics/luck", "/simulation/limits/luck", "/entities/x/breakable/bond/luck"):
        assert way_of(place) is None
        assert group_of(place) == group_of(place.rpartition("/")[0])
    assert group_of("/luck").name == "text"


@pytest.mark.parametrize(
    ("place", "direction"),
    [
        ("/simulation/fps", "harder_up"),
        ("/entities/x/breakable/bond/crumble", "harder_down"),
        ("/graph/relations/x/width", "harder_up"),
        ("/graph/relations/x/max_step", "harder_down"),
        ("/materials/x/substance", "repair"),
        ("/story/beats/x/mandatory", "either"),
        ("/simulation/gravity", "repair"),
        ("/entities/x/breakable/bond/tension", "repair"),
        ("/entities/x/pose/position", "repair"),
        ("/look/exposure", "none"),
    ],
)
def test_directions_are_as_physics_has_them(place: str, direction: str) -> None:
    way = way_of(place)
    assert way is not None
    assert way.direction == direction
    assert way.why


def test_quantities_of_nature_are_physical_and_forms_and_settings_are_not() -> None:
    """A part that is re-shaped is judged as it then is, whoever speaks of it."""
    nature = (
        "/materials/x/friction",
        "/entities/x/physics/mass",
        "/simulation/gravity",
        "/entities/x/dimensions/size",
        "/entities/x/material",
    )
    others = (
        "/entities/x/parts/x/shape/size",
        "/entities/x/pose/position",
        "/simulation/solvers/x/settings/step",
        "/simulation/limits/max_speed",
    )
    assert [f for f in nature if not (field := field_of(f)) or not field.physical] == []
    assert [f for f in others if not (field := field_of(f)) or field.physical] == []
    assert [p.pointer for p in (*directions.FIELDS, *PARAMETERS.values()) if p.physical and p.way.direction != "repair"] == []


def test_every_upper_bound_that_a_field_declares_holds() -> None:
    """The smaller of a type's bound and a field's holds, in the schema that agents read and in what is accepted."""
    least = {"friction": 4, "rolling_friction": 0.1}
    for field, bound in least.items():
        assert Material(density=1.0, **{field: bound})
        with pytest.raises(ValidationError, match="less than or equal"):
            Material(density=1.0, **{field: bound * 1.01})
    for name, model in sorted(_models().items()):
        known = SCHEMA["$defs"].get(name, {}).get("properties", {})
        for field, info in model.model_fields.items():
            declared = [m.le for m in info.metadata if isinstance(getattr(m, "le", None), int | float)]
            node = known.get(field, {})
            if declared and node.get("type") in ("number", "integer"):
                assert node["maximum"] == min(declared), (name, field)


def _models() -> dict[str, type[BaseModel]]:
    found: dict[str, type[BaseModel]] = {}
    todo: list[type[BaseModel]] = [SpecModel]
    while todo:
        for model in todo.pop().__subclasses__():
            if model.__name__ not in found:
                found[model.__name__] = model
                todo.append(model)
    return found


SIDED = {
    p.pointer.replace("*", "x"): p.way.direction
    for p in (*directions.FIELDS, *PARAMETERS.values())
    if p.way.direction in ("harder_up", "harder_down")
}


@pytest.mark.parametrize("place", SIDED)
def test_a_field_with_a_harder_side_is_a_weakening_the_other_way_alone(place: str) -> None:
    def holding(value: float) -> dict[str, Any]:
        found: Any = value
        for token in reversed(place.split("/")[1:]):
            found = {token: found}
        return dict(found)

    low, high = holding(1.0), holding(2.0)
    harder, easier = (high, low) if SIDED[place] == "harder_up" else (low, high)
    (line,) = directed_weakenings(harder, easier, [place])
    assert line.startswith(f"{place} ")
    assert list(directed_weakenings(easier, harder, [place])) == []
    assert list(directed_weakenings(holding(1.0), {}, [place])) == []
