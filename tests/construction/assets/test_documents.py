"""Assets as they stand in a specification, and with joints at other positions."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from worldagent.construction.assets.documents import asset_documents, asset_size, body_boxes, feet
from worldagent.construction.assets.made import Body, Joint, Made
from worldagent.construction.assets.posing import posed
from worldagent.construction.assets.registry import GENERATORS, found, make
from worldagent.construction.assets.turning import TRIM
from worldagent.construction.primitives import build_shape
from worldagent.geometry import Solid, wall_thickness
from worldagent.testing.assets import faults
from worldagent.verifiers.contact.step_travel import thickness
from worldagent.worlds.arrays import RigidPose, euler_to_quaternion
from worldagent.worlds.errors import InputError
from worldagent.worlds.materials import row_named
from worldagent.worlds.patch import parse_edit
from worldagent.worlds.shapes import Box
from worldagent.worlds.spec import Entity, RigidPhysics

HERE = RigidPose(np.array([1.0, 2.0, 0.5]), euler_to_quaternion((0.0, 0.0, math.pi / 2)))


def _chest() -> Made:
    """A box without front, with a drawer on a slide and a flap on a hinge."""
    made = Made.of(Body("carcass", "oak"))
    made.main.box("back", (-0.5, 0.0, 0.0), (0.5, 0.1, 1.0))
    made.bodies["drawer"] = drawer = Body("drawer", "oak")
    drawer.box("front", (-0.4, -0.3, 0.1), (0.4, -0.002, 0.4))
    made.bodies["knob"] = knob = Body("knob", "oak")
    knob.box("knob", (-0.02, -0.34, 0.2), (0.02, -0.302, 0.24))
    made.joints["slide"] = Joint("drawer", "slide", (0, -0.001, 0.2), axis=(0, -1, 0), range=(0.0, 0.25), friction=4.0)
    made.joints["turn"] = Joint("knob", "hinge", (0, -0.301, 0.22), parent="drawer", axis=(0, -1, 0), range=(0.0, 3.0))
    return made


def test_a_drawer_pulled_out_takes_what_hangs_on_it_along_and_has_less_way_left() -> None:
    moved = posed(_chest(), {"slide": 0.1})
    assert moved.bodies["drawer"].parts["front"].pose.position[1] == pytest.approx(-0.151 - 0.1)
    assert moved.bodies["knob"].parts["knob"].pose.position[1] == pytest.approx(-0.321 - 0.1)
    assert moved.joints["slide"].range == pytest.approx((-0.1, 0.15))
    assert moved.joints["turn"].anchor == pytest.approx((0, -0.401, 0.22))
    assert _chest().bodies["drawer"].parts["front"].pose.position[1] == pytest.approx(-0.151), "the first one is as it was"


@pytest.mark.parametrize(("positions", "said"), [({"slide": 0.3}, "out of its range"), ({"lid": 0.1}, "no hinge or slide 'lid'")])
def test_positions_that_no_joint_has_are_refused(positions: dict[str, float], said: str) -> None:
    with pytest.raises(InputError, match=said):
        posed(_chest(), positions)


def test_documents_are_of_a_valid_specification_and_stand_where_they_are_put() -> None:
    documents = asset_documents("chest", {"generator": "x"}, _chest(), HERE, motion="static")
    assert list(documents.entities) == ["chest", "chest_drawer", "chest_knob"]
    assert [e["motion"] for e in documents.entities.values()] == ["static", "dynamic", "dynamic"]
    assert documents.entities["chest"]["asset"]["bodies"] == ["chest_drawer", "chest_knob"]
    # The asset's -y looks towards the world's +x after a quarter turn.
    assert documents.joints["chest_slide"]["axis"] == pytest.approx([1, 0, 0], abs=1e-9)
    assert documents.joints["chest_slide"]["anchor"] == pytest.approx([1.001, 2.0, 0.7])
    assert documents.joints["chest_turn"]["parent"] == "chest_drawer"
    entity = documents.entities["chest_drawer"]
    assert entity["dimensions"]["size"] == pytest.approx([0.8, 0.298, 0.3])
    assert entity["pose"]["position"] == pytest.approx([1.151, 2.0, 0.6]), "its own frame is in the middle of its foot"
    solvers = {"rigid": {"engine": "mujoco", "members": list(documents.entities)}}
    spec = parse_edit(
        {
            "spec_version": "2",
            "title": "t",
            "prompt": "a chest",
            "entities": documents.entities,
            "simulation": {"frames": 2, "joints": documents.joints, "solvers": solvers},
        }
    )
    assert spec.materials["oak"].of == "oak"
    assert spec.entities["chest"].asset is not None


def test_equal_seeds_make_equal_things_and_others_vary() -> None:
    assert make("bookcase", {}, 3) == make("bookcase", {}, 3)
    assert any(make(name, {}, 1) != make(name, {}, 2) for name in ("chair", "bookcase", "bed"))


@pytest.mark.parametrize(
    ("name", "parameters", "said"),
    [
        ("chairr", {}, "did you mean 'chair'"),
        ("dining_table", {}, "its words find table, bedside_table"),
        ("chair", {"sea": 0.4}, "did you mean 'seat'"),
        ("chair", {"seat": 4.5}, r"'seat' of chair: .* 0.55 \(got 4.5\)"),
    ],
)
def test_wrong_names_and_values_are_told_with_what_is_allowed(name: str, parameters: dict[str, float], said: str) -> None:
    with pytest.raises(InputError, match=said):
        make(name, parameters, 0)


@pytest.mark.parametrize(
    ("query", "name"), [("dining table", "table"), ("wooden chairs", "chair"), ("book", "book"), ("round table", "round_table")]
)
def test_words_find_generators(query: str, name: str) -> None:
    assert found(query)[0] == name
    assert found("xyzzy") == []


@pytest.mark.parametrize(
    ("query", "name"), [("flowerpot", "flower_pot"), ("flowerpots", "flower_pot"), ("clay flowerpot", "flower_pot")]
)
def test_a_name_written_as_one_word_is_found(query: str, name: str) -> None:
    assert found(query)[0] == name


def test_every_generator_says_what_it_is_and_all_its_parameters_have_ranges() -> None:
    assert len(GENERATORS) >= 60
    for name, generator in GENERATORS.items():
        assert generator.summary, name
        assert generator.tags, name
        for field, info in generator.model.model_json_schema()["properties"].items():
            assert info.get("description"), (name, field)
            bounded = {"minimum", "maximum"} <= set(info) or "enum" in info or "choices" in info or info.get("type") == "boolean"
            assert bounded, (name, field, info)
        assert min(asset_size(generator.make({}, 0))) > 1e-3


def test_the_checks_of_assets_see_what_is_broken() -> None:
    sound = _chest()
    assert faults(sound, stands=False) == []
    inside = _chest()
    inside.bodies["drawer"].box("deep", (-0.3, -0.01, 0.15), (0.3, 0.05, 0.3))
    assert any("overlap" in f for f in faults(inside, stands=False))
    loose = _chest()
    loose.main.box("apart", (2.0, 0.0, 0.0), (2.1, 0.1, 0.1))
    assert any("touch none of the rest" in f for f in faults(loose, stands=False))
    twice = _chest()
    twice.main.box("again", (-0.2, 0.05, 0.5), (0.2, 0.2, 0.7))
    assert any("share" in f for f in faults(twice, stands=False))
    stuck = _chest()
    stuck.main.box("stop", (-0.1, -0.5, 0.0), (0.1, -0.4, 0.3))
    stuck.main.box("way", (-0.1, -0.4, 0.0), (0.1, 0.0, 0.05))
    assert any("joint slide at" in f for f in faults(stuck, stands=False))
    far = _chest()
    far.joints["slide"] = Joint("drawer", "slide", (0, 0.4, 0.2), axis=(0, -1, 0), range=(0.0, 0.25))
    assert any("acts more than" in f for f in faults(far, stands=False))
    # Each is reached somewhere on the axis, and at no one point of it.
    wheel = Made.of(Body("post", "oak"))
    wheel.main.box("post", (-0.05, -0.05, 0), (0.05, 0.05, 0.3))
    wheel.bodies["wheel"] = Body("wheel", "oak")
    wheel.bodies["wheel"].cylinder("disc", (0.07, 0, 0.2), (0.1, 0, 0.2), 0.2)
    wheel.joints["wheel"] = Joint("wheel", "hinge", (0.085, 0, 0.2), axis=(1, 0, 0))
    assert any("acts more than" in f for f in faults(wheel))
    wheel.main.cylinder("axle", (0.05, 0, 0.2), (0.067, 0, 0.2), 0.02)
    assert not any("acts more than" in f for f in faults(wheel))
    tipping = Made.of(Body("post", "oak"))
    tipping.main.box("foot", (0, 0, 0), (0.1, 0.1, 0.1))
    tipping.main.box("arm", (0.1, 0, 0.05), (2.0, 0.1, 0.1))
    assert any("tips over" in f for f in faults(tipping))
    unknown = Made.of(Body("post", "unobtainium"))
    unknown.main.box("foot", (0, 0, 0), (0.1, 0.1, 0.1))
    assert any("no row of the table" in f for f in faults(unknown))


def test_what_stands_on_the_ground_is_told_from_what_hangs_on_it() -> None:
    assert feet(make("toy_car", {}, 1)) == [b for b in make("toy_car", {}, 1).bodies if b.startswith("wheel")]
    row = make("row_of_books", {}, 1)
    assert set(feet(row)) == set(row.bodies) - {b for _, b in row.carries}
    assert len(feet(row)) > 3
    assert feet(make("jar", {}, 1)) == [""]
    assert feet(make("door", {}, 1)) == [""]
    hung = make("picture_frame", {}, 1)
    assert feet(hung, stands=False) == [j.parent for j in hung.joints.values()]


def _lowest_between_sides(**parameters: object) -> float:
    """Height of the lowest part of a bookcase that is neither one of its sides nor the strip before one [m]."""
    parts = make("bookcase", {"rise": 0.12, **parameters}, 1).main.parts
    boxes = {
        n: p.pose.position[2] - p.shape.size[2] / 2
        for n, p in parts.items()
        if isinstance(p.shape, Box) and "_left" not in n and "_right" not in n
    }
    assert {"bottom", "shelf_1"} <= boxes.keys()
    return min(boxes.values())


@pytest.mark.parametrize("frame", ["plain", "faced", "cornice"])
def test_small_things_roll_under_a_bookcase_only_where_its_base_is_open(frame: str) -> None:
    assert _lowest_between_sides(frame=frame, base="open") == pytest.approx(0.12)
    assert _lowest_between_sides(frame=frame) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    "parameters", [{}, {"diameter": 0.05, "height": 0.2}, {"diameter": 0.16, "height": 0.04, "label": False}]
)
def test_a_tin_collides_as_one_exact_cylinder(parameters: dict[str, object]) -> None:
    """Rims of 2 mm as pieces of their own asked for steps of 0.1 ms of a tin that falls; facets would brake one that rolls."""
    body = make("tin_can", parameters, 3).bodies[""]
    colliding = {name: build_shape(part.shape, Path()).collision for name, part in body.parts.items() if part.collides}
    assert {name: [piece.kind for piece in pieces] for name, pieces in colliding.items()} == {"can": ["cylinder"]}
    sizes = body_boxes(make("tin_can", parameters, 3))[""]
    radius, half = colliding["can"][0].params
    assert 2 * half == pytest.approx(sizes[1][2] - sizes[0][2])  # nothing stands out at its ends
    assert 0 < sizes[1][0] - radius <= TRIM + 1e-9  # what is drawn around it lies within the skin


@pytest.mark.parametrize("metal", ["tin", "mild_steel", "aluminium_alloy"])
def test_a_tin_weighs_what_its_sheet_and_its_contents_weigh(metal: str) -> None:
    """A can of 0.47 l of water of 1000 kg/m^3, and a sheet of 0.3 mm over 343 cm^2."""
    made = make("tin_can", {"filled": "water", "material": metal}, 3)
    entities = asset_documents("tin", {"generator": "tin_can"}, made, HERE, motion="dynamic").entities
    physics = Entity.model_validate(entities["tin"]).physics
    assert isinstance(physics, RigidPhysics)
    row = row_named(metal)
    assert row is not None
    sheet = row[1].figures["density"].range[1] * 0.0343 * 0.0003
    assert physics.mass == pytest.approx(0.463 + sheet, rel=0.02)


def test_a_tin_of_materials_of_the_world_weighs_what_these_weigh() -> None:
    """Their densities are those of the world, which no generator knows."""
    body = make("tin_can", {"filled": "gold_of_the_world"}, 3).bodies[""]
    assert body.physics is None
    assert body.parts["can"].material == "gold_of_the_world"


@pytest.mark.parametrize(
    ("name", "least"),
    [("tin_can", 0.05), ("jar", 0.0025), ("toy_car", 0.0025), ("toolbox", 0.004), ("marker_cone", 0.0035), ("barrel", 0.01)],
)
def test_what_falls_and_rolls_has_no_thin_trimmings_that_collide(name: str, least: float) -> None:
    """Its thinnest collision piece, or the wall that pieces tile, is no rim, screw, lamp or hoop [m]."""
    thin = {}
    for key, body in make(name, {}, 0).bodies.items():
        for part_name, part in body.parts.items():
            shape = build_shape(part.shape, Path())
            if part.collides:
                thick = min(thickness(piece) for piece in shape.collision)
                wall = wall_thickness(Solid.from_mesh(shape.render, closed=True)) if len(shape.collision) > 1 else 0.0
                thin[f"{key}/{part_name}"] = max(thick, wall)
    assert min(thin.values()) >= least, min(thin.items(), key=lambda item: item[1])
