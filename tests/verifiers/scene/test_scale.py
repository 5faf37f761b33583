"""Scale: constructed sizes against contracts, related sizes against each other (R87, R88)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import (
    ball,
    box,
    build,
    build_all,
    entity,
    ground,
    make_candidate,
    mesh_of,
    pose,
    world,
)
from worldagent.verifiers.scene import bounds, ratios, scale
from worldagent.verifiers.scene.extents import specified_extent
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import (
    Adjacent,
    Box,
    BoxRegion,
    Capsule,
    Connects,
    Contains,
    Cylinder,
    HeightField,
    Interacts,
    Limits,
    Mesh,
    Part,
    Revolution,
    Rope,
    Sphere,
    Supports,
    Wedge,
)


def rows_of(tmp_path, entities, **more) -> dict[str, Row]:
    return {r.id: r for r in scale.check(make_candidate(tmp_path, world(entities, **more)))}


def test_constructed_size_equals_the_contract(tmp_path):
    rows = rows_of(tmp_path, {"crate": box(0.4, 0.3, 0.2, at=(5, 5, 5), euler=(0.3, 0.2, 0.1))})
    assert rows["scale:crate"].status == rows["scale:scene"].status == "pass"
    assert rows["scale:crate"].measured == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("height", "status"), [(0.2019, "pass"), (0.2021, "fail"), (0.02, "fail"), (20.0, "fail")])
def test_a_deviation_just_over_the_tolerance_fails(tmp_path, height, status):
    rows = rows_of(tmp_path, {"crate": box(0.4, 0.3, height, size=(0.4, 0.3, 0.2))})
    row = rows["scale:crate"]
    assert row.status == status
    assert row.measured == pytest.approx(abs(height - 0.2) / 0.2)
    assert row.bound == 0.01
    if status == "fail":
        assert row.first_failing_entity == "crate"
        assert row.evidence["axis"] == "z"
        assert row.corrections[0].patch[0]["value"] == [0.4, 0.3, 0.2]
        assert row.corrections[0].group == "shape"


def test_all_parts_are_measured_in_the_entity_frame(tmp_path):
    shapes = (Part(shape=Box(size=(1, 1, 0.1))), Part(shape=Box(size=(0.1, 0.1, 1)), pose=pose((0, 0, -0.5))))
    assert rows_of(tmp_path, {"table": entity(*shapes, size=(1, 1, 1.05))})["scale:table"].status == "pass"
    assert rows_of(tmp_path, {"table": entity(*shapes, size=(1, 1, 1.0))})["scale:table"].status == "fail"


def test_exchanged_axes_and_wrong_units_are_named(tmp_path):
    rows = rows_of(tmp_path, {"a": box(0.4, 0.2, 0.3, size=(0.4, 0.3, 0.2)), "b": box(40, 30, 20, size=(0.4, 0.3, 0.2))})
    assert "exchanged" in rows["scale:a"].corrections[0].cause
    assert "another unit" in rows["scale:b"].corrections[0].cause


def test_a_world_in_centimetres_fails_against_nominal_diagonals(tmp_path):
    rows = rows_of(tmp_path, {"domino": box(4.8, 2.4, 0.75, nominal_diagonal=0.054)})
    assert rows["scale:domino"].status == "pass"
    row = rows["scale:nominal:domino"]
    assert row.status == "fail"
    assert row.measured == pytest.approx(5.4187 / 0.054, rel=1e-3)
    assert "another unit" in row.corrections[0].cause


@pytest.mark.parametrize(("factor", "status"), [(2.9, "pass"), (3.1, "fail"), (1 / 2.9, "pass"), (1 / 3.1, "fail")])
def test_nominal_diagonal_is_a_factor_of_three(tmp_path, factor, status):
    side = factor * 0.1
    rows = rows_of(tmp_path, {"die": box(side, side, side, nominal_diagonal=0.1 * 3**0.5)})
    assert rows["scale:nominal:die"].status == status


@pytest.mark.parametrize("side", [2e-5, 2e4])
def test_absurd_sizes_fail_without_any_relation(tmp_path, side):
    rows = rows_of(tmp_path, {"crate": box(1, 1, 1), "thing": box(side, side, side)})
    assert rows["scale:scene"].status == "fail"
    assert rows["scale:scene"].first_failing_entity == "thing"
    assert rows["scale:scene"].measured == pytest.approx(side * 3**0.5)


def test_ratio_of_related_entities_is_bounded_by_the_relation(tmp_path):
    things = {"floor": ground(), "shelf": box(1, 0.3, 0.02, motion="dynamic"), "cup": ball(0.04, motion="dynamic")}
    relations = {
        "on": Supports(a="shelf", b="cup", ratio=(5.0, 10.0)),
        "far": Adjacent(a="shelf", b="cup"),
        "ground": Supports(a="floor", b="cup"),
    }
    rows = rows_of(tmp_path, things, relations=relations)
    ratio = (1 + 0.09 + 0.0004) ** 0.5 / (0.08 * 3**0.5)
    assert rows["scale:relation:on"].measured == pytest.approx(ratio)
    assert {r.status for r in rows.values()} == {"pass"}
    relations["on"] = Supports(a="shelf", b="cup", ratio=(8.0, 10.0))
    row = rows_of(tmp_path, things, relations=relations)["scale:relation:on"]
    assert row.status == "fail"
    assert (row.bound, row.comparison) == (8.0, ">=")
    assert row.recipe != rows["scale:relation:on"].recipe


def test_a_cup_that_holds_a_house_fails_by_default(tmp_path):
    things = {"cup": box(0.1, 0.1, 0.1), "house": box(10, 10, 10, motion="dynamic")}
    rows = rows_of(tmp_path, things, relations={"in": Contains(a="cup", b="house"), "on": Supports(a="cup", b="house")})
    assert rows["scale:relation:in"].status == rows["scale:relation:on"].status == "fail"


def test_missing_geometry_is_unverified(tmp_path):
    spec = world({"crate": box(1, 1, 1), "ball": ball(0.1)})
    candidate = make_candidate(tmp_path, spec)
    built = build_all(spec)
    del built["ball"]
    object.__setattr__(candidate, "built", built)
    rows = {r.id: r for r in scale.check(candidate)}
    assert rows["scale:crate"].status == "pass"
    assert rows["scale:ball"].status == rows["scale:scene"].status == "unverified"


def test_a_rope_is_measured_over_all_its_segments(tmp_path):
    rope = Rope(points=[(0, 0, 0), (0, 0, -1)], radius=0.01, segments=8)
    rows = rows_of(tmp_path, {"rope": entity(rope=rope, motion="dynamic", size=(0.02, 0.02, 1.02), tolerance=0.02)})
    assert rows["scale:rope"].status == "pass"


CROOKED = pose((0.3, -0.2, 0.1), euler=(0.4, -0.7, 1.1))


@pytest.mark.parametrize(
    "shape",
    [
        Box(size=(0.4, 0.3, 0.2)),
        Sphere(radius=0.2),
        Cylinder(radius=0.1, height=0.5),
        Capsule(radius=0.1, length=0.3),
        Wedge(size=(0.4, 0.3, 0.2)),
        HeightField(size=(1.0, 0.5), heights=[[0.0, 0.1, 0.2], [0.3, 0.1, 0.0]]),
    ],
)
def test_extents_from_the_numbers_of_a_shape_equal_those_of_its_mesh(shape):
    part = Part(shape=shape, pose=CROOKED)
    found = build(world({"thing": entity(part)}), "thing").parts[0].render.vertices
    wanted = specified_extent(part)
    assert wanted is not None
    np.testing.assert_allclose(wanted.low, found.min(axis=0), atol=0.005)  # facets of round shapes
    np.testing.assert_allclose(wanted.high, found.max(axis=0), atol=0.005)


def test_extents_of_a_revolution_follow_its_profile_and_imported_files_have_none():
    cone = Revolution(profile=[(0, 0), (0.3, 0), (0, 0.8)])
    extent = specified_extent(Part(shape=cone))
    assert extent is not None
    np.testing.assert_allclose(extent.size, (0.6, 0.6, 0.8))
    assert specified_extent(Part(shape=Mesh(file="chair.obj"))) is None


@pytest.mark.parametrize("dust", ["vertex", "sliver", "speck"])
def test_dust_gives_a_small_thing_no_size(tmp_path, dust):
    mesh = mesh_of(Box(size=(0.4, 0.3, 0.1)))
    n, corner = len(mesh.vertices), np.array([0.2, 0.15, 0.15])
    extra = {"vertex": [corner], "sliver": [corner, corner], "speck": [corner, corner - [1e-5, 0, 0], corner - [0, 1e-5, 0]]}[
        dust
    ]
    face = {"vertex": np.zeros((0, 3)), "sliver": [[0, n, n + 1]], "speck": [[n, n + 1, n + 2]]}[dust]
    vertices, faces = np.vstack([mesh.vertices, extra]), np.vstack([mesh.faces, face]).astype(int)
    shape = Mesh(vertices=vertices.tolist(), faces=faces.tolist())
    row = rows_of(tmp_path, {"thing": entity(shape, size=(0.4, 0.3, 0.2))})["scale:thing"]
    assert (row.status, row.evidence["axis"]) == ("fail", "z")
    assert row.measured == pytest.approx(0.5)
    assert rows_of(tmp_path, {"thing": entity(shape, size=(0.4, 0.3, 0.1))})["scale:thing"].status == "pass"


def test_parts_inside_the_box_are_compared_with_their_shapes(tmp_path):
    table = entity(Part(shape=Box(size=(1, 1, 1))), Part(shape=Box(size=(0.1, 0.1, 0.1)), pose=pose((0.2, 0, 0))))
    spec = world({"table": table})
    whole = build(spec, "table")

    def judged(*parts) -> Row:
        made = replace(whole, parts=tuple(parts))
        return {r.id: r for r in scale.check(make_candidate(tmp_path, spec, built={"table": made}))}["scale:table"]

    board, inner = whole.parts
    assert judged(board, inner).status == "pass"
    missing = judged(board)
    assert missing.status == "fail"
    assert missing.evidence["part"] == "p1"
    moved = replace(inner, render=TriangleMesh(inner.render.vertices + np.array([0.0, 0.003, 0.0]), inner.render.faces))
    row = judged(board, moved)
    assert (row.status, row.evidence["part"], row.evidence["axis"], row.bound) == ("fail", "p1", "y", bounds.FACETS)
    assert row.measured == pytest.approx(0.03)


def test_every_kind_of_relation_has_documented_bounds_and_regions_are_measured(tmp_path):
    assert set(ratios.RATIOS) == {"supports", "contains", "adjacent", "connects", "interacts", "fastened"}
    assert all(r.reason for r in ratios.RATIOS.values())
    regions = {"hall": BoxRegion(min=(0, 0, 0), max=(100, 100, 100)), "mat": BoxRegion(min=(0, 0, 0), max=(0.1, 0.1, 0.1))}
    relations = {
        "way": Connects(a="hall", b="mat"),
        "told": Connects(a="hall", b="mat", ratio=(900, 1100)),
        "in": Contains(a="hall", b="die"),
        "spot": Contains(a="mat", b="die"),
    }
    things = {"die": box(0.2, 0.2, 0.2, motion="dynamic")}
    rows = rows_of(tmp_path, things, relations=relations, regions=regions)
    row = rows["scale:relation:way"]
    assert row.status == "fail"
    assert (row.measured, row.bound) == (pytest.approx(1000.0), 500.0)
    assert [rows[f"scale:relation:{n}"].status for n in ("told", "in", "spot")] == ["pass"] * 3


def test_limits_of_the_world_move_the_defaults(tmp_path):
    things = {"a": box(1, 1, 1, motion="dynamic"), "b": box(0.001, 0.001, 0.001, motion="dynamic")}
    relations = {"hit": Interacts(a="a", b="b")}
    assert rows_of(tmp_path, things, relations=relations)["scale:relation:hit"].status == "fail"
    wide = Limits(scale_ratio=(1e-4, 1e4))
    assert rows_of(tmp_path, things, relations=relations, limits=wide)["scale:relation:hit"].status == "pass"
