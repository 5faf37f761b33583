"""Every field of the schema says whether more of it makes requirements harder, easier, or neither (R157)."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import BaseModel, ValidationError
from worldagent.worlds import directions
from worldagent.worlds.directions import way_of
from worldagent.worlds.spec import Material, WorldSpec
from worldagent.worlds.vocabulary import SpecModel


def _walk(node: dict[str, Any], place: str, known: dict[str, Any], found: set[str]) -> None:
    """Pointers of all leaves of a schema, with `x` for keys; predicates and shapes hold many alike and count as one."""
    if place.endswith(("/predicate", "/shape")):
        found.add(place)
        return
    if "$ref" in node:
        _walk(known[node["$ref"].rpartition("/")[2]], place, known, found)
    for kind in ("anyOf", "oneOf", "allOf"):
        for option in node.get(kind, ()):
            _walk(option, place, known, found)
    for key, value in node.get("properties", {}).items():
        _walk(value, f"{place}/{key}", known, found)
    members = [node["additionalProperties"]] if isinstance(node.get("additionalProperties"), dict) else []
    for member in [*members, *node.get("patternProperties", {}).values()]:
        found.add(place)
        found.add(f"{place}/x")
        _walk(member, f"{place}/x", known, found)
    if node.get("type") not in (None, "object", "null"):
        found.add(place)


def _fields() -> set[str]:
    schema, found = WorldSpec.model_json_schema(), set[str]()
    _walk(schema, "", schema["$defs"], found)
    return found


FIELDS = _fields()


def test_no_field_of_the_schema_is_silent_about_its_direction() -> None:
    assert len(FIELDS) > 300
    assert sorted(f for f in FIELDS if way_of(f) is None) == []


def test_every_line_of_the_table_speaks_of_a_field() -> None:
    places = FIELDS | {f.rsplit("/", k)[0] for f in FIELDS for k in range(1, f.count("/"))}
    silent = []
    for pattern, way in directions._COMPILED:
        if not any(pattern.fullmatch(f) and way_of(f) is way for f in places):
            silent.append(pattern.pattern)
    assert silent == []


def test_an_unknown_field_has_no_direction() -> None:
    for place in ("/simulation/luck", "/entities/x/physics/luck", "/simulation/limits/luck", "/entities/x/breakable/bond/luck"):
        assert way_of(place) is None


@pytest.mark.parametrize(
    ("place", "direction"),
    [
        ("/simulation/fps", "harder_up"),
        ("/entities/x/breakable/bond/crumble", "harder_down"),
        ("/graph/relations/x/width", "harder_up"),
        ("/graph/relations/x/max_step", "harder_down"),
        ("/materials/x/substance", "either"),
        ("/simulation/gravity", "either"),
        ("/entities/x/breakable/bond/tension", "bound"),
        ("/entities/x/pose/position", "repair"),
        ("/look/exposure", "none"),
    ],
)
def test_directions_are_as_physics_has_them(place: str, direction: str) -> None:
    way = way_of(place)
    assert way is not None
    assert way.direction == direction
    assert way.why


def test_every_upper_bound_that_a_field_declares_holds() -> None:
    """Of a type's bound and a field's the smaller one holds, in the schema that agents read and in what is accepted."""
    least = {"friction": 4, "rolling_friction": 0.1}
    for field, bound in least.items():
        assert Material(density=1.0, **{field: bound})
        with pytest.raises(ValidationError, match="less than or equal"):
            Material(density=1.0, **{field: bound * 1.01})
    for name, model in sorted(_models().items()):
        known = WorldSpec.model_json_schema()["$defs"].get(name, {}).get("properties", {})
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
