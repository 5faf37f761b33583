"""The schema in short lines: every part can be asked for, and none is long."""

from __future__ import annotations

import json

import pytest
from worldagent.worlds.errors import InputError
from worldagent.worlds.schema_words import described, known_parts
from worldagent.worlds.spec import WorldSpec


def test_every_part_is_described_in_a_few_kilobytes() -> None:
    assert known_parts()
    for part in known_parts():
        assert len(json.dumps(described(part))) < 8000, part


def test_the_index_names_every_field_of_a_world() -> None:
    assert set(described("World")["fields"]) == set(WorldSpec.model_fields)
    assert described("") == described("/") == described("World")


def test_every_name_in_capitals_can_be_asked_for() -> None:
    known = set(known_parts())
    assert {"World", "Shape", "Predicate"} <= known
    for part in known:
        text = json.dumps(described(part))
        for word in ("Shape", "Predicate", "Pose", "Dimensions", "RigidSettings", "Limits"):
            assert word not in text or word in known


@pytest.mark.parametrize(
    ("pointer", "name"),
    [
        ("/entities", "Entity"),
        ("/entities/ball/parts/body", "Part"),
        ("/simulation/solvers/rigid/settings", "RigidSettings"),
        ("/story/beats/hit", "Beat"),
        ("/look", "Look"),
    ],
)
def test_a_pointer_leads_to_its_part(pointer: str, name: str) -> None:
    assert described(pointer)["type"] == name


def test_a_union_lists_its_options_with_ranges() -> None:
    shapes = described("/entities/ball/parts/body/shape")
    assert shapes["union"] == "Shape"
    assert shapes["options"]["sphere"]["fields"]["radius"].startswith("number > 0; required")
    assert set(described("Predicate")["options"]) >= {"contact", "rests_on", "until"}


def test_long_members_of_a_union_are_parts_of_their_own() -> None:
    options = described("Predicate")["options"]
    named = {kind: o["part"] for kind, o in options.items() if "part" in o}
    assert named["landscape_water"] == "LandscapeWater"
    assert "ends_in" in described(named["landscape_water"])["fields"]
    assert any("fields" in o for o in options.values())


def test_a_member_of_several_kinds_is_found_by_each_of_them() -> None:
    assert described("falls")["type"] == described("rises")["type"] == "BodyEvent"
    assert any("falls, rises" in kind for kind in described("Predicate")["options"])


def test_ranges_and_defaults_are_told() -> None:
    fields = described("SimulationPlan")["fields"]
    assert fields["fps"].startswith("integer >= 1 and <= 240; default 24")
    assert fields["solvers"] == "{id: SolverInstance, <= 16}"
    assert "required" in fields["frames"]


@pytest.mark.parametrize("part", ["Boxx", "/entities/a/b", "nothing"])
def test_what_is_no_part_is_refused_with_what_there_is(part: str) -> None:
    with pytest.raises(InputError, match="schema has no"):
        described(part)


@pytest.mark.parametrize(
    ("word", "told"),
    [
        ("Landscapes", ["LandscapeWater (one of Predicate)"]),
        ("Solver", ["SolverInstance (in SimulationPlan)"]),
        ("Spheres", ["did you mean Sphere (one of Shape)"]),
        ("Boxx", ["did you mean Box"]),
        ("Simulation", ["did you mean SimulationPlan (in World)"]),
        ("Gravity", ["gravity of SimulationPlan"]),
        ("Friction", ["friction of ContactPair", "Material (in World)"]),
        ("Sun", ["sun_azimuth_deg of Look"]),
        ("Grains", ["(one of SolverInstance)"]),
    ],
)
def test_a_word_that_is_no_part_leads_to_the_parts_it_means(word: str, told: list[str]) -> None:
    with pytest.raises(InputError) as refused:
        described(word)
    assert all(t in str(refused.value) for t in told), refused.value


@pytest.mark.parametrize(
    ("word", "part", "others"),
    [
        ("submerged_fraction", "SubmergedFraction", []),
        ("liquid_arrives", "LiquidArrives", []),
        ("release", "ReleaseDriver", []),
        ("emitter", "EmitterDriver", []),
        ("mujoco", "RigidInstance", []),
        ("dfsph", "DfsphInstance", ["DfsphSettings (in DfsphInstance)"]),
        ("shell", "ClothInstance", []),
        ("dem", "DemInstance", ["Dem (one of Layer)"]),
        ("Dem", "Dem", ["DemInstance (one of SolverInstance)"]),
        ("inflow", "InflowDriver", ["Inflow"]),
        ("Inflow", "Inflow", ["InflowDriver (one of Driver)"]),
        ("box", "Box", ["BoxRegion (one of Region)", "FieldBox"]),
        ("Cloth", "ClothPhysics", ["ClothInstance (one of SolverInstance)", "ClothPin (in ClothPhysics)"]),
        ("wind", "WindField", []),
        ("field", "FieldDriver", []),
        ("particles", "ParticlePhysics", []),
        ("contact", "Contact", []),
    ],
)
def test_what_a_specification_calls_a_part_leads_to_it_and_names_the_others(word: str, part: str, others: list[str]) -> None:
    found = described(word)
    assert found["type"] == part
    told = found.get("see_also", [])
    assert all(any(t.startswith(o) for t in told) for o in others), told
    assert part not in [t.split(" ")[0] for t in told]
    assert ("stands" in found) is bool(told)
