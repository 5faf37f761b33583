"""Entities that move and are copied as one: what belongs to them comes along, and what does not is said."""

import numpy as np
import pytest
from worldagent.tests.stories.yard import CART, PROMPT, yard_spec
from worldagent.worlds.arrays import RigidPose, euler_to_quaternion, pose_of
from worldagent.worlds.assemblies import Edit, add_copy, add_move
from worldagent.worlds.errors import InputError
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.scaled import scaled_entity

TURN = RigidPose(np.array([3.0, -1.0, 0.2]), euler_to_quaternion((0.0, 0.0, 0.8)))
DRIVERS = {
    "push": {"kind": "force", "entity": "body", "force": [10, 0, 0], "end": 1},
    "spin": {"kind": "motor", "joint": "axle_fl", "velocity": 3, "max_effort": 1, "end": 1},
    "way": {
        "kind": "path",
        "entity": "table",
        "keys": {"a": {"time": 0, "pose": {"position": [3, 3, 0.4]}}, "b": {"time": 1, "pose": {"position": [4, 3, 0.4]}}},
    },
    "wind": {"kind": "field", "field": {"kind": "wind", "velocity": [5, 0, 0]}, "entities": ["body", "stone"], "end": 1},
}


@pytest.fixture
def spec():
    document = {**yard_spec(), "prompt": PROMPT}
    document["simulation"]["drivers"] = DRIVERS
    document["entities"]["body"]["physics"] = {"category": "rigid", "linear_velocity": [0.8, 0, 0]}
    document["simulation"]["contacts"] = {"grip": {"a": "wheel_fl", "b": "ground", "friction": 0.9}}
    return parse_spec(document)


def moved(spec, names, **more):
    edit = Edit()
    add_move(edit, spec, names, TURN, **more)
    return edit, apply_patch(spec, edit.operations)


def copied(spec, names, suffix="_b", **more):
    edit = Edit()
    add_copy(edit, spec, names, TURN, suffix, **more)
    return edit, apply_patch(spec, edit.operations)


def local(spec, entity, point):
    return pose_of(spec.entities[entity].pose).inverse().apply(np.array([point], dtype=float))[0]


def test_joints_paths_forces_and_velocities_turn_with_what_they_belong_to(spec):
    _, after = moved(spec, [*CART, "table"])
    for key, joint in spec.simulation.joints.items():
        now = after.simulation.joints[key]
        for body in (joint.parent, joint.child):
            assert local(after, body, now.anchor) == pytest.approx(local(spec, body, joint.anchor), abs=1e-8)
        assert now.axis == pytest.approx((-np.sin(0.8), np.cos(0.8), 0), abs=1e-8)
    assert after.simulation.drivers["push"].force == pytest.approx((10 * np.cos(0.8), 10 * np.sin(0.8), 0))
    assert after.entities["body"].physics.linear_velocity == pytest.approx((0.8 * np.cos(0.8), 0.8 * np.sin(0.8), 0))
    key = after.simulation.drivers["way"].keys["b"].pose
    assert pose_of(key).position == pytest.approx(TURN.apply(np.array([[4, 3, 0.4]]))[0])
    assert pose_of(key).quaternion == pytest.approx(TURN.quaternion)
    assert after.shots == spec.shots
    assert after.simulation.drivers["wind"] == spec.simulation.drivers["wind"]
    assert after.simulation.drivers["spin"] == spec.simulation.drivers["spin"]


def test_cameras_come_along_only_when_asked(spec):
    _, after = moved(spec, list(CART), cameras=True)
    before, now = spec.shots["all"].keys["a"], after.shots["all"].keys["a"]
    assert now.position == pytest.approx(TURN.apply(np.array([before.position]))[0])
    assert now.target == pytest.approx(TURN.apply(np.array([before.target]))[0])
    _, other = moved(spec, ["stone"], cameras=True)
    assert other.shots == spec.shots


def test_a_joint_to_what_stays_is_left_alone_and_said(spec):
    edit, after = moved(spec, ["wheel_fl"])
    assert after.simulation.joints == spec.simulation.joints
    assert edit.left == ["joint axle_fl ties to body, which stays: name it in group or mend the joint"]


def test_only_the_own_end_of_a_spring_moves(spec):
    spring = {
        "kind": "spring",
        "parent": "table",
        "child": "stone",
        "parent_point": [3, 3, 0.7],
        "child_point": [-4, -4, 0.2],
        "stiffness": 9,
    }
    spec = apply_patch(spec, [{"op": "add", "path": "/simulation/joints/tow", "value": spring}])
    _, after = moved(spec, ["stone"])
    tow = after.simulation.joints["tow"]
    assert tow.parent_point == (3, 3, 0.7)
    assert tow.child_point == pytest.approx(TURN.apply(np.array([[-4, -4, 0.2]]))[0])
    _, both = moved(spec, ["stone", "table"])
    assert both.simulation.joints["tow"].parent_point == pytest.approx(TURN.apply(np.array([[3, 3, 0.7]]))[0])


def test_a_copy_has_joints_drivers_pairs_and_membership_of_its_own(spec):
    edit, after = copied(spec, list(CART))
    assert {n for n in after.entities if n not in spec.entities} == {f"{n}_b" for n in CART}
    assert all(f"{n}_b" in after.simulation.solvers["rigid"].members for n in CART)
    joints, drivers = after.simulation.joints, after.simulation.drivers
    assert (joints["axle_fl_b"].parent, joints["axle_fl_b"].child) == ("body_b", "wheel_fl_b")
    assert local(after, "body_b", joints["axle_fl_b"].anchor) == pytest.approx(
        local(spec, "body", joints["axle_fl"].anchor), abs=1e-8
    )
    assert (drivers["push_b"].entity, drivers["spin_b"].joint) == ("body_b", "axle_fl_b")
    assert drivers["wind"].entities == ["body", "stone", "body_b"]
    assert (after.simulation.contacts["grip_b"].a, after.simulation.contacts["grip_b"].b) == ("wheel_fl_b", "ground")
    assert {n: e for n, e in after.entities.items() if n in spec.entities} == spec.entities
    assert edit.left == []
    _, again = copied(after, list(CART))
    assert again == after, "made anew, not twice"


def test_what_carries_the_original_carries_its_copy_or_another_does(spec):
    _, after = copied(spec, ["stone"])
    assert after.graph.relations["carries_b"].a == "ground"
    _, other = copied(spec, ["stone"], on="table")
    assert (other.graph.relations["carries_b"].a, other.graph.relations["carries_b"].b) == ("table", "stone_b")


def test_a_copy_of_a_part_of_an_assembly_says_what_it_lacks(spec):
    edit, after = copied(spec, ["wheel_fl"])
    assert "axle_fl_b" not in after.simulation.joints
    assert edit.left == ["joint axle_fl ties to body, which is not copied: the copy has none"]


def test_a_copy_keeps_a_material_that_has_the_id_of_the_entity(spec):
    document = spec.model_dump(mode="json", exclude_none=True)
    document["materials"]["stone"] = document["materials"][document["entities"]["stone"]["material"]]
    document["entities"]["stone"]["material"] = "stone"
    _, after = copied(parse_spec(document), ["stone"])
    assert after.entities["stone_b"].material == "stone"


@pytest.mark.parametrize("suffix", [" b", "x" * 64, "/"])
def test_ids_that_are_none_are_refused(spec, suffix):
    with pytest.raises(InputError, match="no id"):
        copied(spec, ["stone"], suffix)


def test_no_other_entity_is_overwritten(spec):
    table = spec.entities["table"].model_dump(mode="json", exclude_none=True)
    spec = apply_patch(spec, [{"op": "add", "path": "/entities/stone_b", "value": table}])
    with pytest.raises(InputError, match="no copy of 'stone'"):
        copied(spec, ["stone"])


def test_a_scaled_entity_has_the_size_and_mass_of_its_cube(spec):
    spec = apply_patch(spec, [{"op": "add", "path": "/entities/body/physics/mass", "value": 100.0}])
    found = scaled_entity(spec, "body", 2.0)
    assert found["dimensions"]["size"] == pytest.approx([3.2, 1.836, 0.65])
    assert found["physics"]["mass"] == pytest.approx(800.0)
    assert found["parts"]["front"]["pose"]["position"] == pytest.approx([1.0, 0, -0.3])
    assert scaled_entity(spec, "stone", 2.0)["parts"]["body"]["shape"]["scale"] == 2.0
    assert scaled_entity(spec, "stone", 1.0) == spec.entities["stone"].model_dump(mode="json", exclude_none=True)
    ground = spec.entities["stone"].model_dump(mode="json", exclude_none=True)
    ground["parts"]["body"]["shape"] = {"kind": "heightfield", "size": [2, 2], "heights": [[0, 0], [0, 1]]}
    spec = apply_patch(spec, [{"op": "add", "path": "/entities/hill", "value": ground}])
    with pytest.raises(InputError, match="leave size out"):
        scaled_entity(spec, "hill", 2.0)
