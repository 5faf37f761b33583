"""The rigid solver refuses bad input, and the text says what to do."""

import pytest
from worldagent.tests.physics.rigid_world import ball, box, entity, solver, world
from worldagent.worlds.errors import InputError

HINGE = {"kind": "hinge", "anchor": (0, 0, 0), "axis": (0, 0, 1)}
ROPE = {"kind": "rope", "points": [(0, 0, 1), (1, 0, 1)], "radius": 0.01}
THREE = {"a": box(0.1, 0.1, 0.1), "b": box(0.1, 0.1, 0.1, at=(1, 0, 0)), "c": box(0.1, 0.1, 0.1, at=(2, 0, 0))}
STILL = {"wall": box(1, 1, 1, at=(0, 5, 0), motion="static")}


def _path(name, *times):
    return {"kind": "path", "entity": name, "keys": {f"k{i}": {"time": t, "pose": {}} for i, t in enumerate(times)}}


CASES = {
    "two joints on one child": (
        {"joints": {"j": {**HINGE, "child": "a"}, "k": {**HINGE, "child": "a", "parent": "b"}}},
        "hangs on one joint",
    ),
    "a loop of joints": (
        {"joints": {"j": {**HINGE, "child": "a", "parent": "b"}, "k": {**HINGE, "child": "b", "parent": "a"}}},
        "loop",
    ),
    "a static child": ({"joints": {"j": {**HINGE, "child": "wall", "parent": "a"}}}, "swap parent and child"),
    "a parent outside": ({"joints": {"j": {**HINGE, "child": "a", "parent": "stranger"}}}, "not a member"),
    "a spring to outside": (
        {"joints": {"j": {"kind": "spring", "child": "a", "parent": "stranger", "parent_point": (0, 0, 0), "child_point": (0, 0, 0), "stiffness": 1}}},
        "not a member",
    ),
    "a joint without axis": ({"joints": {"j": {**HINGE, "child": "a", "axis": (0, 0, 0)}}}, "axis must not be zero"),
    "a range upside down": ({"joints": {"j": {**HINGE, "child": "a", "range": (1, -1)}}}, "first < second"),
    "a path for a dynamic body": ({"drivers": {"d": _path("a", 0, 1)}}, "motion 'kinematic'"),
    "a force on a static body": ({"drivers": {"d": {"kind": "force", "entity": "wall", "force": (1, 0, 0), "end": 1}}}, "motion 'dynamic'"),
    "a release of a static body": ({"drivers": {"d": {"kind": "release", "entity": "wall", "time": 1}}}, "motion 'dynamic'"),
    "a motor on a ball joint": (
        {
            "joints": {"j": {"kind": "ball", "child": "a", "anchor": (0, 0, 0)}},
            "drivers": {"d": {"kind": "motor", "joint": "j", "velocity": 1, "max_effort": 1, "end": 1}},
        },
        "hinge or slide",
    ),
    "a hinge that is detached": (
        {"joints": {"j": {**HINGE, "child": "a"}}, "drivers": {"d": {"kind": "detach", "joint": "j", "time": 1}}},
        "only a weld or a spring",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_impossible_plans_are_refused(name):
    plan, words = CASES[name]
    with pytest.raises(InputError, match=words):
        solver(world(THREE | STILL, **plan))


def test_a_path_needs_increasing_times():
    moving = THREE | {"a": box(0.1, 0.1, 0.1, motion="kinematic")}
    with pytest.raises(InputError, match="times must differ"):
        solver(world(moving, drivers={"d": _path("a", 1, 1)}))
    with pytest.raises(InputError, match="two paths"):
        solver(world(moving, drivers={"d": _path("a", 0, 1), "e": _path("a", 0, 1)}))


def test_a_body_on_a_joint_cannot_start_with_a_velocity_that_the_joint_does_not_allow():
    with pytest.raises(InputError, match="by a motor or a force"):
        solver(world({"a": box(0.1, 0.1, 0.1, v=(1, 0, 0))}, joints={"j": {**HINGE, "child": "a"}}))


def test_a_height_field_cannot_move():
    with pytest.raises(InputError, match="cannot move"):
        solver(world({"g": entity({"kind": "heightfield", "size": (1, 1), "heights": [[0, 0], [0, 1]]})}))


@pytest.mark.parametrize(
    ("rope", "words"),
    [({"attach_start": "stranger"}, "no body of the same"), ({"attach_end": "other"}, "no body of the same")],
)
def test_a_rope_hangs_on_bodies_only(rope, words):
    entities = {"r": entity(generator={**ROPE, **rope}), "other": entity(generator=ROPE, at=(0, 1, 0)), "b": ball(0.1)}
    with pytest.raises(InputError, match=words):
        solver(world(entities))


def test_a_rope_is_dynamic_and_no_child():
    with pytest.raises(InputError, match="must have motion 'dynamic'"):
        solver(world({"r": entity(generator=ROPE, motion="static")}))
    with pytest.raises(InputError, match="cannot be a child"):
        solver(world({"r": entity(generator=ROPE)}, joints={"j": {**HINGE, "child": "r"}}))


def test_drag_is_for_free_bodies():
    with pytest.raises(InputError, match="free bodies only"):
        solver(world({"a": box(0.1, 0.1, 0.1, drag=1.0)}, joints={"j": {**HINGE, "child": "a"}}))


def test_a_special_pair_of_very_many_pieces_is_refused():
    ring = [(0.2, 0.0), (0.3, 0.0), (0.3, 0.1), (0.2, 0.1)]
    wheel = {"kind": "revolution", "profile": ring, "segments": 64}
    with pytest.raises(InputError, match="fewer parts"):
        solver(
            world({"a": entity(wheel), "b": entity(wheel, at=(0, 0, 1))}, contacts={"c": {"a": "a", "b": "b", "friction": 0.1}})
        )
