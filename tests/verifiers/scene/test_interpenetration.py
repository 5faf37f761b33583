"""Interpenetration at frame 0: exact clearance of visible surfaces, no allowance (R89-R91)."""

from __future__ import annotations

import math

import jsonpatch
import numpy as np
import pytest
import trimesh
from worldagent import geometry
from worldagent.construction.build import build_entity
from worldagent.testing.worlds.small_worlds import ball, box, build_all, entity, ground, make_candidate, pose, world
from worldagent.verifiers.scene import interpenetration, self_crossing
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import (
    Box,
    ClothPhysics,
    ClothPin,
    Dimensions,
    Entity,
    Extrusion,
    Fastened,
    Limits,
    LiquidPhysics,
    Mesh,
    Part,
    Rope,
    Sheet,
    Wedge,
    WorldSpec,
)


def rows_of(tmp_path, entities, **more) -> dict[str, Row]:
    return {r.id: r for r in interpenetration.check(make_candidate(tmp_path, world(entities, **more)))}


def failing(rows: dict[str, Row]) -> set[str]:
    return {i for i, r in rows.items() if r.status != "pass"}


def table(**more):
    legs = [Part(shape=Box(size=(0.05, 0.05, 0.7)), pose=pose((x, y, 0.35))) for x in (-0.45, 0.45) for y in (-0.25, 0.25)]
    return entity(Part(shape=Box(size=(1, 0.6, 0.04)), pose=pose((0, 0, 0.72))), *legs, **more)


CLEAN = {
    "exactly touching": {"b": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1))},
    "resting with 0.3 mm gap": {"b": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1003))},
    "tight fit between walls": {
        "w": box(0.1, 1, 1, at=(-0.15, 0, 0.5)),
        "v": box(0.1, 1, 1, at=(0.15 + 1e-6, 0, 0.5)),
        "b": box(0.2, 0.2, 0.2, motion="dynamic", at=(5e-7, 0, 0.1)),
    },
    "stool under a table": {"t": table(), "s": box(0.3, 0.3, 0.4, motion="dynamic", at=(0, 0, 0.2001))},
    "wedge and block on its slope": {
        "r": entity(Wedge(size=(1, 0.5, 0.5)), at=(0, 0, 0.25)),
        "b": box(0.1, 0.1, 0.1, motion="dynamic", at=(0.3, 0, 0.3), euler=(0, math.atan(0.5), 0)),
    },
    "inside the corner of an L": {
        "l": entity(Extrusion(polygon=[(0, 0), (1, 0), (1, 0.2), (0.2, 0.2), (0.2, 1), (0, 1)], height=0.5), at=(0, 0, 0.25)),
        "b": box(0.3, 0.3, 0.3, motion="dynamic", at=(0.3501, 0.3501, 0.15)),
    },
}


@pytest.mark.parametrize("name", CLEAN)
def test_touching_and_close_worlds_pass(tmp_path, name):
    rows = rows_of(tmp_path, {"floor": ground(), **CLEAN[name]})
    assert failing(rows) == set()
    assert len(rows) >= 2


@pytest.mark.parametrize("depth", [1e-6, 1e-4, 0.01, 0.1])
def test_a_sunk_box_fails_by_its_depth(tmp_path, depth):
    rows = rows_of(tmp_path, {"floor": ground(), "b": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1 - depth))})
    row = rows["interpenetration:floor:b"]
    assert row.status == "fail"
    assert row.measured == pytest.approx(-depth, rel=1e-6)
    assert row.bound == pytest.approx(0.0, abs=1e-7)
    assert row.first_failing_entity == "b"
    assert row.first_failing_frame == 0
    assert rows["interpenetration:scene"].status == "fail"
    assert row.corrections[0].edit_class == "scene"


@pytest.mark.parametrize(("share", "status"), [(0.5, "pass"), (2.0, "fail")])
def test_no_more_than_the_noise_of_the_query_is_allowed(tmp_path, share, status):
    """R90: eps is rounding, below a thousandth of a millimetre here, and no tolerance of the world changes it."""
    spec = world({"floor": ground(), "b": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1 - 1e-3))})
    eps = -next(
        r.bound for r in interpenetration.check(make_candidate(tmp_path / "a", spec)) if r.id == "interpenetration:floor:b"
    )
    assert 0 < eps < 1e-6
    rows = rows_of(tmp_path / "b", {"floor": ground(), "b": box(0.2, 0.2, 0.2, motion="dynamic", at=(0, 0, 0.1 - share * eps))})
    assert rows["interpenetration:floor:b"].status == status
    lax = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"limits": Limits(contact_gap=0.01)})})
    again = next(r for r in interpenetration.check(make_candidate(tmp_path / "c", lax)) if r.id == "interpenetration:floor:b")
    assert (again.status, again.bound) == ("fail", -eps)


def test_the_suggested_patch_clears_the_pair(tmp_path):
    things = {
        "floor": ground(),
        "r": entity(Wedge(size=(1, 0.5, 0.5)), at=(0, 0, 0.25)),
        "b": ball(0.1, motion="dynamic", at=(0.1, 0, 0.25)),
    }
    spec = world(things)
    row = next(r for r in interpenetration.check(make_candidate(tmp_path, spec)) if r.id == "interpenetration:r:b")
    assert row.status == "fail"
    assert len(row.corrections) >= 2
    for correction in row.corrections[:2]:
        data = jsonpatch.apply_patch(spec.model_dump(mode="json"), list(correction.patch))
        mended = make_candidate(tmp_path, WorldSpec.model_validate(data))
        again = next((r for r in interpenetration.check(mended) if r.id == "interpenetration:r:b"), None)
        assert again is None or again.status == "pass"


def test_a_sheet_in_its_bar_is_sent_the_least_way_out(tmp_path):
    """A banner stands with its top edge 15 mm deep in a bar of 12 mm: 6 mm sideways or 15 mm down come first, not up through all."""
    size, shape = (0.6, 0.3), Sheet(size=(0.6, 0.3), resolution=0.05)
    pins = {"top": ClothPin(edge="+y", to="bar")}
    physics = ClothPhysics(area_density=0.15, thickness=4e-4, stretch_stiffness=800.0, bend_stiffness=1e-5, pins=pins)
    things = {
        "bar": box(1.0, 0.012, 0.02, at=(0, -1e-4, 1.7)),
        "banner": Entity(
            role="banner",
            motion="dynamic",
            physics=physics,
            dimensions=Dimensions(size=(*size, 4e-4)),
            pose=pose((0, 0, 1.555), euler=(math.pi / 2, 0, 0)),
            material="wood",
            parts={"sheet": Part(shape=shape)},
        ),
    }
    spec = world(things)

    def judged(spec: WorldSpec) -> dict[str, Row]:
        built = {name: build_entity(spec, name, tmp_path) for name in spec.entities}
        return {r.id: r for r in interpenetration.check(make_candidate(tmp_path, spec, built=built))}

    row = judged(spec)["interpenetration:bar:banner"]
    assert row.status == "fail"
    moves = [c for c in row.corrections if c.group == "placement"]
    aside, down = (np.array(c.patch[0]["value"]["position"]) - (0, 0, 1.555) for c in moves[:2])
    assert np.abs(aside) == pytest.approx((0.0, 0.006, 0.0), abs=2e-4)
    assert down == pytest.approx((0.0, 0.0, -0.0151), abs=2e-4)
    assert all("either may move, 'bar' the opposite way" in c.action for c in moves)
    for correction in moves:
        moved = WorldSpec.model_validate(jsonpatch.apply_patch(spec.model_dump(mode="json"), list(correction.patch)))
        assert "interpenetration:bar:banner" not in failing(judged(moved))


def test_static_pairs_and_hidden_overlaps_fail(tmp_path):
    things = {"floor": ground(), "wall": box(1, 0.2, 2, at=(0, 0, 1.0)), "pipe": box(0.05, 0.05, 0.5, at=(0, 0, 1.0))}
    rows = rows_of(tmp_path, things)
    row = rows["interpenetration:wall:pipe"]
    assert row.status == "fail"
    assert row.measured == pytest.approx(-(0.1 + 0.0), abs=0.026)
    assert "interpenetration:wall:pipe" in rows["interpenetration:scene"].evidence["overlapping"]


def test_a_ball_inside_a_box_without_touching_its_walls_fails(tmp_path):
    rows = rows_of(tmp_path, {"box": box(1, 1, 1), "b": ball(0.05, motion="dynamic")})
    assert rows["interpenetration:box:b"].status == "fail"


def test_the_same_body_twice_fails(tmp_path):
    rows = rows_of(tmp_path, {"a": box(0.1, 0.2, 0.3), "b": box(0.1, 0.2, 0.3)})
    assert rows["interpenetration:a:b"].status == "fail"


def test_only_one_part_of_a_table_overlapping_is_named(tmp_path):
    rows = rows_of(tmp_path, {"t": table(), "s": box(0.3, 0.3, 0.71, motion="dynamic", at=(0, 0, 0.355))})
    row = rows["interpenetration:t:s"]
    assert row.status == "fail"
    assert row.measured == pytest.approx(-0.01)
    assert row.evidence["part_a"] == "p0"
    assert row.corrections[0].patch[0]["path"] == "/entities/s/pose"


def test_declared_overlap_passes_down_to_its_depth(tmp_path):
    things = {"floor": ground(), "post": box(0.1, 0.1, 1, at=(0, 0, 0.4))}
    relation = Fastened(a="post", b="floor", max_depth=0.11, reason="the post is set into the ground")
    row = rows_of(tmp_path, things, relations={"set": relation})["interpenetration:floor:post"]
    assert row.status == "pass"
    assert row.measured == pytest.approx(-0.1)
    assert row.bound == pytest.approx(-0.11)
    shallow = relation.model_copy(update={"max_depth": 0.0999})
    row = rows_of(tmp_path, things, relations={"set": shallow})["interpenetration:floor:post"]
    assert row.status == "fail"


def test_a_rope_may_sink_into_its_anchor_by_its_radius_but_not_into_others(tmp_path):
    rope = Rope(points=[(0, 0, 0), (0, 0, -0.5)], radius=0.01, segments=5, attach_start="beam")
    things = {
        "beam": box(0.2, 0.2, 0.1, at=(0, 0, 0.05)),
        "rope": entity(rope=rope, motion="dynamic"),
    }
    assert failing(rows_of(tmp_path, things)) == set()
    things["bar"] = box(0.2, 0.01, 0.01, at=(0, 0, -0.25))
    assert "interpenetration:rope:bar" in failing(rows_of(tmp_path, things))


def test_far_pairs_have_no_row_and_an_empty_scene_does_not_pass(tmp_path):
    rows = rows_of(tmp_path, {"a": box(1, 1, 1), "b": box(1, 1, 1, at=(1.0061, 0, 0))})
    assert set(rows) == {"interpenetration:scene"}
    assert rows["interpenetration:scene"].status == "pass"
    assert rows_of(tmp_path, {})["interpenetration:scene"].status == "unverified"


def test_liquids_alone_cannot_overlap(tmp_path):
    water = box(1, 1, 1, at=(0, 0, 0.5)).model_copy(update={"physics": LiquidPhysics(resolution=0.1)})
    assert rows_of(tmp_path, {"water": water})["interpenetration:scene"].status == "not_applicable"


def test_missing_geometry_leaves_the_scene_unverified_but_finds_the_rest(tmp_path):
    spec = world({"floor": ground(), "a": box(0.2, 0.2, 0.2, at=(0, 0, 0.05)), "b": ball(0.1)})
    candidate = make_candidate(tmp_path, spec)
    built = build_all(spec)
    del built["b"]
    object.__setattr__(candidate, "built", built)
    rows = {r.id: r for r in interpenetration.check(candidate)}
    assert rows["interpenetration:floor:a"].status == "fail"
    del built["a"]
    fresh = make_candidate(tmp_path, spec)
    object.__setattr__(fresh, "built", built)
    assert interpenetration.check(fresh)[0].status == "unverified"


def test_large_scenes_stay_fast_and_find_the_one_overlap(tmp_path):
    rng = np.random.default_rng(1)
    things = {"floor": ground(40)}
    for i in range(300):
        x, y = divmod(i, 20)
        things[f"c{i}"] = box(0.5, 0.5, 0.5, at=(x - 8.0, y - 10.0, 0.25), euler=(0, 0, float(rng.uniform(0, 3))))
    things["c7"] = things["c7"].model_copy(update={"pose": pose((-8.0, -3.0, 0.2499))})
    rows = rows_of(tmp_path, things)
    assert failing(rows) == {"interpenetration:scene", "interpenetration:floor:c7"}


def crossing_boxes(*, inverted: bool):
    one, two = trimesh.creation.box((1, 1, 1)), trimesh.creation.box((0.5, 0.6, 0.7))
    if inverted:
        two.invert()
    two.apply_translation([0.6, 0.01, 0.02])
    mesh = trimesh.util.concatenate([one, two])
    return entity(Mesh(vertices=[tuple(v) for v in mesh.vertices], faces=[tuple(f) for f in mesh.faces]))


def test_surfaces_searched_together_have_the_rows_of_those_searched_alone(tmp_path, monkeypatch):
    """Choice: many small surfaces are searched at once; those that cross are told of as before, the others not."""
    whole = trimesh.creation.annulus(0.2, 0.4, 0.3, sections=9)
    ring = entity(Mesh(vertices=[tuple(v) for v in whole.vertices], faces=[tuple(f) for f in whole.faces]))
    things = {"ring": ring, "a": crossing_boxes(inverted=False), "b": crossing_boxes(inverted=True)}
    things = {name: made.model_copy(update={"pose": pose((3.0 * k, 0, 0))}) for k, (name, made) in enumerate(things.items())}
    alone = rows_of(tmp_path, things)
    assert "interpenetration:self:ring" not in alone
    asked = []
    search = geometry.self_crossings
    monkeypatch.setattr(self_crossing, "_known", {})
    monkeypatch.setattr(self_crossing, "TOGETHER", 1)
    monkeypatch.setattr(self_crossing, "self_crossings", lambda solid, **k: asked.append(len(solid.faces)) or search(solid, **k))
    assert {i: (r.status, r.measured, r.evidence) for i, r in rows_of(tmp_path, things).items()} == {
        i: (r.status, r.measured, r.evidence) for i, r in alone.items()
    }
    assert asked[0] == sum(asked[1:]) + len(whole.faces)  # all at once, then the two that cross


def test_a_surface_that_crosses_itself_passes_as_a_union_and_fails_with_a_lobe_inside_out(tmp_path):
    row = rows_of(tmp_path, {"a": crossing_boxes(inverted=False)})["interpenetration:self:a"]
    assert row.status == "pass"
    assert row.evidence["crossing_pairs"] > 0
    rows = rows_of(tmp_path, {"a": crossing_boxes(inverted=True)})
    assert failing(rows) == {"interpenetration:self:a", "interpenetration:scene"}
    assert rows["interpenetration:self:a"].measured == pytest.approx(-1.0, abs=1e-6)
