"""Rest by contact forces within friction: piles, counterweights, slopes, ladders, grips; what joints and ropes bear (R92, S3)."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import IDENTITY, ball, box, entity, ground, make_candidate, pose, world
from worldagent.verifiers.scene.surfaces import surfaces_of
from worldagent.verifiers.support import check as support
from worldagent.verifiers.support.equilibrium import solve
from worldagent.verifiers.support.graph import SupportGraph, group_of
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import (
    BallJoint,
    Box,
    Capsule,
    ContactPair,
    HingeJoint,
    Material,
    Mesh,
    MotorDriver,
    Part,
    SlideJoint,
    Sphere,
    SpringJoint,
    Supports,
)

FRAMES = 24
TIME = np.arange(FRAMES) / 24


def rows_of(tmp_path: Path, entities: dict[str, Any], tracks: Any = None, **more: Any) -> dict[str, Row]:
    spec = world(entities, frames=FRAMES, **more)
    return {r.id: r for r in support.check(make_candidate(tmp_path, spec, tracks=tracks))}


def carried(*pairs: tuple[str, str]) -> dict[str, Supports]:
    return {f"r{k}": Supports(a=a, b=b) for k, (a, b) in enumerate(pairs)}


def wood(friction: float) -> dict[str, Material]:
    return {"wood": Material(density=600.0, friction=friction, substance="wood")}


def block(x: float, z: float, **more: Any) -> Any:
    return box(0.4, 0.2, 0.1, motion="dynamic", at=(x, 0, z), **more)


@pytest.mark.parametrize(("step", "status"), [(0.099, "pass"), (0.104, "fail")])
def test_a_pile_tips_as_a_whole_though_every_block_is_above_the_next(tmp_path: Path, step: float, status: str) -> None:
    """Three blocks on a base, each moved by d: their common centre lies 2 d from the base's, which is 0.2 m from its edge."""
    things = {"floor": ground(), "base": box(0.4, 0.2, 0.1, at=(0, 0, 0.05))}
    things |= {f"b{k}": block(k * step, 0.05 + 0.1 * k) for k in (1, 2, 3)}
    rows = rows_of(tmp_path, things, relations=carried(("base", "b1"), ("b1", "b2"), ("b2", "b3")))
    shifts = [rows[f"support:balance:b{k}"].measured for k in (1, 2, 3)]
    # The lowest move of all centres together: three times what the common centre lies outside.
    assert sum(s for s in shifts if s is not None) == pytest.approx(3 * max(0.0, 2 * step - 0.2), abs=2e-4)
    assert rows["support:scene"].status == status


@pytest.mark.parametrize(("weight", "status"), [(0.35, "pass"), (0.2, "fail")])
def test_a_counterweight_holds_a_plank_over_the_edge(tmp_path: Path, weight: float, status: str) -> None:
    things = {
        "table": box(2, 1, 0.7, at=(-1, 0, 0.35)),
        "plank": box(1.5, 0.3, 0.04, motion="dynamic", at=(0.1, 0, 0.72)),
        "weight": box(weight, 0.2, 0.2, motion="dynamic", at=(-0.4, 0, 0.84)),
    }
    assert 1.5 * 0.3 * 0.04 * 0.1 < 0.35 * 0.2 * 0.2 * 0.4
    if status == "fail":
        things["weight"] = box(weight, 0.05, 0.05, motion="dynamic", at=(-0.4, 0, 0.765))
    rows = rows_of(tmp_path, things, relations=carried(("table", "plank"), ("plank", "weight")))
    assert rows["support:scene"].status == status
    assert rows["support:grip:plank"].status == "pass"


@pytest.mark.parametrize("excess", [-0.2, -0.01, 0.05, 0.3])
def test_a_block_on_a_slope_lacks_the_sine_of_what_exceeds_the_friction_angle(tmp_path: Path, excess: float) -> None:
    friction = 0.4
    angle = math.atan(friction) + excess
    normal = np.array([math.sin(angle), 0, math.cos(angle)])
    things = {
        "slope": box(3, 1, 0.2, at=(0, 0, 2), euler=(0, angle, 0)),
        "block": box(0.3, 0.2, 0.1, motion="dynamic", at=np.array([0, 0, 2]) + 0.1501 * normal, euler=(0, angle, 0)),
    }
    rows = rows_of(tmp_path, things, relations=carried(("slope", "block")), materials=wood(friction))
    row = rows["support:grip:block"]
    assert row.status == ("fail" if excess > 0 else "pass")
    assert row.measured == pytest.approx(max(0.0, math.sin(excess)), rel=0.12, abs=1e-6)
    assert rows["support:balance:block"].status == "pass"


@pytest.mark.parametrize(("share", "status"), [(0.6, "pass"), (1.4, "fail")])
def test_what_rests_is_held_by_static_friction(tmp_path: Path, share: float, status: str) -> None:
    """Between the angle of motion, at which it would slide, and beyond that of rest."""
    angle = math.atan(0.3 * (1 + 0.5 * share))
    normal = np.array([math.sin(angle), 0, math.cos(angle)])
    things = {
        "slope": box(3, 1, 0.2, at=(0, 0, 2), euler=(0, angle, 0)),
        "block": box(0.3, 0.2, 0.1, motion="dynamic", at=np.array([0, 0, 2]) + 0.1501 * normal, euler=(0, angle, 0)),
    }
    rough = {n: m.model_copy(update={"static_friction": 0.45}) for n, m in wood(0.3).items()}
    rows = rows_of(tmp_path, things, relations=carried(("slope", "block")), materials=rough)
    assert rows["support:grip:block"].status == status
    smooth = rows_of(tmp_path, things, relations=carried(("slope", "block")), materials=wood(0.3))
    assert smooth["support:grip:block"].status == "fail"


def test_a_pair_s_own_friction_counts(tmp_path: Path) -> None:
    angle = 0.5
    normal = np.array([math.sin(angle), 0, math.cos(angle)])
    things = {
        "slope": box(3, 1, 0.2, at=(0, 0, 2), euler=(0, angle, 0)),
        "block": box(0.3, 0.2, 0.1, motion="dynamic", at=np.array([0, 0, 2]) + 0.1501 * normal, euler=(0, angle, 0)),
    }
    spec = world(things, frames=FRAMES, relations=carried(("slope", "block")), materials=wood(0.2))
    for friction, status in ((0.1, "fail"), (0.7, "pass")):
        pairs = {"p": ContactPair(a="block", b="slope", friction=friction)}
        own = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"contacts": pairs})})
        rows = {r.id: r for r in support.check(make_candidate(tmp_path, own))}
        assert rows["support:grip:block"].status == status


def ladder(lean: float, length: float = 3.0, thick: float = 0.02) -> dict[str, Any]:
    """A thin ladder that leans by `lean` rad from the vertical against a wall."""
    top = length * math.sin(lean) / 2 + thick * math.cos(lean) / 2
    middle = (length * math.cos(lean) + thick * math.sin(lean)) / 2
    return {
        "floor": ground(),
        "ladder": box(thick, 0.4, length, motion="dynamic", at=(0, 0, middle + 1e-5), euler=(0, lean, 0)),
        "wall": box(0.2, 2, 5, at=(top + 0.1 + 1e-5, 0, 2.501)),
    }


@pytest.mark.parametrize(("share", "status"), [(1.05, "pass"), (0.9, "fail")])
def test_a_ladder_needs_friction_at_both_ends(tmp_path: Path, share: float, status: str) -> None:
    """Thin ladder, equal friction m at floor and wall: it stands while tan(lean) <= 2 m / (1 - m^2)."""
    lean = 0.6
    need = math.tan(lean / 2)
    relations = carried(("floor", "ladder"), ("wall", "ladder"))
    rows = rows_of(tmp_path, ladder(lean), relations=relations, materials=wood(share * need))
    assert rows["support:grip:ladder"].status == status
    assert rows["support:r0:ladder"].status == "pass"
    # The wall is not beneath the ladder, but without it the ladder falls.
    assert rows["support:r1:ladder"].status == status


def test_a_wall_beside_a_standing_crate_carries_nothing(tmp_path: Path) -> None:
    things = {
        "floor": ground(),
        "wall": box(0.1, 1, 1, at=(0.1501, 0, 0.501)),
        "crate": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1)),
    }
    rows = rows_of(tmp_path, things, relations=carried(("wall", "crate"), ("floor", "crate")))
    assert (rows["support:r0:crate"].status, rows["support:r1:crate"].status) == ("fail", "pass")


def books(count: int, *, end: str = "static") -> dict[str, Any]:
    things = {"left": box(0.2, 2, 4, at=(-0.1, 0, 1))}
    things |= {f"b{k}": box(0.05, 0.2, 0.3, motion="dynamic", at=(0.025 + 0.05 * k, 0, 1)) for k in range(count)}
    size = (0.2, 2, 4) if end == "static" else (0.2, 0.2, 0.3)
    things["right"] = box(*size, motion=end, at=(0.05 * count + 0.1, 0, 1))
    return things


@pytest.mark.parametrize("count", [1, 3])
def test_books_between_walls_are_held_by_friction(tmp_path: Path, count: int) -> None:
    names = ["left", *(f"b{k}" for k in range(count))]
    relations = carried(*pairwise(names))
    rows = rows_of(tmp_path, books(count), {}, relations=relations)
    assert {r.status for r in rows.values()} == {"pass"}
    assert rows["support:r0:b0"].evidence["chain"][0] == "b0"
    rows = rows_of(tmp_path, books(count, end="dynamic"), {}, relations=relations)
    assert rows["support:scene"].status == "fail"
    assert rows["support:derived:right"].status == "fail"


@pytest.mark.parametrize(("gap", "status"), [(4e-5, "pass"), (6e-5, "fail"), (2e-4, "fail"), (9.9e-4, "fail")])
def test_collision_skins_clamp_nothing_beside_drawn_air(tmp_path: Path, gap: float, status: str) -> None:
    """A book between walls that friction could hold if something pressed it: nothing does but the skins, 0.5 mm each."""
    things = {
        "floor": ground(),
        "left": box(0.2, 2, 2, at=(-0.1 - gap, 0, 1)),
        "b0": box(0.05, 0.2, 0.3, motion="dynamic", at=(0.025, 0, 1)),
        "right": box(0.2, 2, 2, at=(0.15 + gap, 0, 1)),
    }
    text = f"'b0' is drawn {gap * 1e3:.4g} mm from 'left', and their collision skins of 1 mm overlap by {1 - gap * 1e3:.4g} mm"
    static, run = (
        rows_of(tmp_path / name, things, tracks)["support:derived:b0"] for name, tracks in (("static", None), ("run", {}))
    )
    assert (static.status, run.status) == (status, status)
    assert [text in row.evidence["explanation"] for row in (static, run)] == [status == "fail"] * 2


@pytest.mark.parametrize(
    ("gap", "beside", "status"),
    [(4e-5, 0.0, "pass"), (2e-4, 0.0, "fail"), (9.9e-4, 0.0, "fail"), (9.9e-4, 5e-4, "fail"), (9.9e-4, 1.0, "fail")],
)
def test_what_stands_beside_a_clamped_body_presses_nothing(tmp_path: Path, gap: float, beside: float, status: str) -> None:
    """A column that stands on the floor touches the book from the side, or is drawn `beside` it [m]."""
    things = {
        "floor": ground(),
        "left": box(0.2, 2, 2, at=(-0.1 - gap, 0, 1)),
        "b0": box(0.05, 0.2, 0.3, motion="dynamic", at=(0.025, 0, 1)),
        "right": box(0.2, 2, 2, at=(0.15 + gap, 0, 1)),
        "column": box(0.04, 0.2, 1.5, motion="dynamic", at=(0.025, 0.2 + beside, 0.75)),
    }
    for name, tracks in (("static", None), ("run", {})):
        rows = rows_of(tmp_path / name, things, tracks)
        assert (rows["support:derived:b0"].status, rows["support:derived:column"].status) == (status, "pass")


def test_what_leans_on_a_body_presses_it(tmp_path: Path) -> None:
    """A plank that leans on the book and would fall without it presses it against the wall, two skins away."""
    angle = 0.3
    length, thick = 1.2, 0.02
    foot = np.array([0.051 + 1.0 * np.tan(angle), 0.0, 0.0])
    along = np.array([-np.sin(angle), 0, np.cos(angle)])
    across = np.array([np.cos(angle), 0, np.sin(angle)])
    at = foot + along * length / 2 + across * thick / 2 + [0, 0, 1e-4]
    things = {
        "floor": ground(),
        "wall": box(0.2, 2, 4, at=(-0.101, 0, 2)),
        "b0": box(0.05, 0.2, 0.3, motion="dynamic", at=(0.025, 0, 1)),
        "plank": box(thick, 0.2, length, motion="dynamic", at=tuple(at), euler=(0, -angle, 0)),
    }
    surfaces = surfaces_of(make_candidate(tmp_path, world(things, frames=4)))
    graph = SupportGraph(surfaces, until=1)
    assert graph.squeezed("b0", 0) == []
    without = {n: e for n, e in things.items() if n != "plank"}
    alone = SupportGraph(surfaces_of(make_candidate(tmp_path / "alone", world(without, frames=4))), until=1)
    assert [s.wall for s in alone.squeezed("b0", 0)] == ["wall"]


@pytest.mark.parametrize(("motion", "status"), [("dynamic", "pass"), ("static", "fail")])
def test_a_jaw_on_a_hinge_presses_and_a_wall_does_not(tmp_path: Path, motion: str, status: str) -> None:
    """Both are drawn two skins from the book, as bodies that touch are."""
    things = {
        "floor": ground(),
        "wall": box(0.2, 2, 2, at=(-0.101, 0, 1)),
        "b0": box(0.05, 0.2, 0.3, motion="dynamic", at=(0.025, 0, 1)),
        "jaw": box(0.1, 0.2, 0.5, motion=motion, at=(0.101, 0, 1)),
        "post": box(0.1, 0.2, 2, at=(0.2, 0, 1)),
    }
    hinge = {"h": HingeJoint(parent="post", child="jaw", anchor=(0.15, 0, 0.8), axis=(0, 1, 0))} if motion == "dynamic" else {}
    assert rows_of(tmp_path, things, joints=hinge)["support:derived:b0"].status == status


def test_a_body_between_walls_that_falls_was_not_held(tmp_path: Path) -> None:
    """Rest was possible, but nothing presses the walls together: the simulation decides."""
    path = np.column_stack([0 * TIME + 0.025, 0 * TIME, 1 - 4.905 * TIME**2])
    rows = rows_of(tmp_path, books(1), {"b0": (path, IDENTITY)})
    assert rows["support:derived:b0"].status == "fail"
    assert rows_of(tmp_path / "still", books(1), {})["support:derived:b0"].status == "pass"


def test_an_inside_out_table_carries(tmp_path: Path) -> None:
    made = box(1, 1, 0.5).parts["p0"].shape
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.25, 0.25)]
    faces = [
        (0, 2, 1),
        (1, 2, 3),
        (4, 5, 6),
        (5, 7, 6),
        (0, 1, 4),
        (1, 5, 4),
        (2, 6, 3),
        (3, 6, 7),
        (0, 4, 2),
        (2, 4, 6),
        (1, 3, 5),
        (3, 7, 5),
    ]
    assert isinstance(made, Box)
    for turned in (faces, [f[::-1] for f in faces]):
        table = entity(Mesh(vertices=corners, faces=turned), at=(0, 0, 0.25))
        things = {"table": table, "crate": box(0.2, 0.2, 0.2, motion="dynamic", at=(0.3, 0, 0.6001))}
        rows = rows_of(tmp_path, things, relations=carried(("table", "crate")))
        assert {r.status for r in rows.values()} == {"pass"}


def test_a_group_is_balanced_by_the_forces_of_statics(tmp_path: Path) -> None:
    """A beam on two piers, one of which is taken away, needs the distance from its centre to the other pier's edge."""
    things = {
        "p": box(0.2, 0.2, 1, at=(-1, 0, 0.5)),
        "q": box(0.2, 0.2, 1, at=(1, 0, 0.5)),
        "beam": box(2.4, 0.2, 0.1, motion="dynamic", at=(0, 0, 1.05)),
    }
    candidate = make_candidate(tmp_path, world(things, frames=FRAMES))
    group = group_of(SupportGraph(surfaces_of(candidate), until=1), "beam", 0)
    assert group is not None
    assert solve(group)["beam"].shift == pytest.approx(0.0, abs=1e-9)
    alone = solve(group.without("q", "beam"))["beam"]
    assert alone.shift == pytest.approx(0.9, abs=1e-6)
    np.testing.assert_allclose(alone.way, [-0.9, 0, 0], atol=1e-6)


# ---------------------------------------------------------------- joints and ropes


def hung(size: float = 0.2) -> dict[str, Any]:
    return {"beam": box(1, 0.1, 0.1, at=(0, 0, 3.05)), "lamp": ball(size / 2, motion="dynamic", at=(0, 0, 2))}


@pytest.mark.parametrize(("slack", "status"), [(0.0, "pass"), (0.002, "pass"), (0.0032, "fail"), (0.5, "fail")])
def test_a_slack_rope_holds_nothing(tmp_path: Path, slack: float, status: str) -> None:
    rope = SpringJoint(
        parent="beam",
        child="lamp",
        parent_point=(0, 0, 3),
        child_point=(0, 0, 2.1),
        stiffness=1e4,
        rest_length=0.9 + slack,
        rope=True,
    )
    assert rows_of(tmp_path, hung(), joints={"rope": rope})["support:derived:lamp"].status == status


def test_a_swinging_lamp_does_not_creep(tmp_path: Path) -> None:
    angle = 0.8 * np.sin(6 * TIME)
    path = np.column_stack([-np.sin(angle), 0 * TIME, 2.997 - np.cos(angle)])
    turns = np.column_stack([np.cos(angle / 2), 0 * TIME, np.sin(angle / 2), 0 * TIME])
    joint = {"j": BallJoint(parent="beam", child="lamp", anchor=(0, 0, 2.997))}
    rod = Part(shape=Capsule(radius=0.0025, length=1.0), pose=pose((0, 0, 0.5)))
    things = hung() | {"lamp": entity(Sphere(radius=0.1), rod, motion="dynamic", at=(0, 0, 1.997))}
    rows = rows_of(tmp_path, things, {"lamp": (path, turns)}, relations=carried(("beam", "lamp")), joints=joint)
    assert {r.status for r in rows.values()} == {"pass"}


WEIGHT = 600.0 * 0.2**3 * 9.81
HOLDS: dict[str, tuple[dict[str, Any], dict[str, Any], str]] = {
    "nothing": ({}, {}, "fail"),
    "level": ({"axis": (1, 0, 0)}, {}, "pass"),
    "spring": ({"stiffness": 100.0}, {}, "pass"),
    "brake": ({"friction": 1.01 * WEIGHT}, {}, "pass"),
    "weak brake": ({"friction": 0.99 * WEIGHT}, {}, "fail"),
    "stop": ({"range": (0.0, 1.0)}, {}, "pass"),
    "far stop": ({"range": (-1.0, 1.0)}, {}, "fail"),
    "motor": ({}, {"velocity": 0.0, "max_effort": 1.01 * WEIGHT, "end": 9.0}, "pass"),
    "weak motor": ({}, {"velocity": 0.0, "max_effort": 0.99 * WEIGHT, "end": 9.0}, "fail"),
    "late motor": ({}, {"velocity": 0.0, "max_effort": 2 * WEIGHT, "start": 0.5, "end": 9.0}, "fail"),
}


@pytest.mark.parametrize("name", HOLDS)
def test_an_upright_slide_bears_only_what_something_stops(tmp_path: Path, name: str) -> None:
    joint, motor, status = HOLDS[name]
    things = {"rail": box(0.1, 0.1, 3, at=(0, 0, 1.5)), "cabin": box(0.2, 0.2, 0.2, motion="dynamic", at=(0.3, 0, 1.5))}
    made = SlideJoint(**{"parent": "rail", "child": "cabin", "anchor": (0, 0, 1.5), "axis": (0, 0, 1), **joint})
    drivers = {"m": MotorDriver(joint="j", **motor)} if motor else {}
    row = rows_of(tmp_path, things, joints={"j": made}, drivers=drivers)["support:derived:cabin"]
    assert row.status == status
