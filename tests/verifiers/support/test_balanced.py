"""Things that never move stand as bodies at rest would: their centre of mass is over what they stand on (R92, R154)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.worlds.small_worlds import box, entity, ground, make_candidate, pose, world
from worldagent.verifiers.support import check as support
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Box, Fastened, Part


def rows_of(tmp_path: Path, things: dict[str, Any], **more: Any) -> dict[str, Row]:
    return {r.id: r for r in support.check(make_candidate(tmp_path, world(things, **more)))}


def on_a_post(x: float, **more: Any) -> dict[str, Any]:
    """A slab of 2 m whose centre is x beside the middle of a post of 0.2 m."""
    return {"floor": ground(), "post": box(0.2, 0.2, 1, at=(0, 0, 0.5)), "slab": box(2, 1, 0.1, at=(x, 0, 1.05), **more)}


@pytest.mark.parametrize(("x", "status"), [(0.0, "pass"), (0.1, "pass"), (0.1021, "fail"), (0.9, "fail")])
def test_a_slab_tips_where_its_centre_is_beside_its_post(tmp_path: Path, x: float, status: str) -> None:
    rows = rows_of(tmp_path, on_a_post(x))
    row = rows["support:balance:slab"]
    assert (row.status, rows["support:scene"].status, row.bound) == (status, status, 0.002)
    assert rows["support:derived:slab"].status == "pass", "they touch"
    if status == "fail":
        assert row.measured == pytest.approx(x - 0.1, abs=1e-3)
        assert row.entities[:2] == ("slab", "post")
        assert [c.group for c in row.corrections] == ["placement", "relations"]
        moved = row.corrections[0].patch[0]["value"]["position"][0]
        assert rows_of(tmp_path / "again", on_a_post(moved))["support:balance:slab"].status == "pass"


def test_a_counterweight_on_its_other_end_holds_a_slab(tmp_path: Path) -> None:
    """Moments about the edge of the post: 0.2 m^3 at 0.2 m beyond it, and 0.125 m^3 at 0.45 m within, of one substance."""
    things = on_a_post(0.3) | {"weight": box(0.5, 0.5, 0.5, at=(-0.35, 0, 1.35))}
    assert rows_of(tmp_path / "a", things)["support:balance:slab"].status == "pass"
    things["weight"] = box(0.2, 0.2, 0.2, at=(-0.35, 0, 1.2))
    assert rows_of(tmp_path / "b", things)["support:scene"].status == "fail"


def test_what_is_fastened_or_said_to_float_is_not_asked(tmp_path: Path) -> None:
    glue = {"glue": Fastened(a="post", b="slab", max_depth=0.001, reason="the slab is cast onto the post")}
    rows = rows_of(tmp_path / "a", on_a_post(0.9), relations=glue)
    assert "support:balance:slab" not in rows
    rows = rows_of(tmp_path / "b", on_a_post(0.9, afloat="a slab that a spell keeps level"))
    assert "support:balance:slab" not in rows


def test_walls_shelves_and_beams_that_touch_from_the_side_are_one_piece(tmp_path: Path) -> None:
    """A shelf far out of a thin wall, a beam between posts, a lamp under a beam: built into each other."""
    things = {
        "floor": ground(),
        "wall": box(0.05, 4, 3, at=(-2, 0, 1.5)),
        "shelf": box(0.8, 3, 0.1, at=(-1.575, 0, 1.2)),
        "post0": box(0.2, 0.2, 2, at=(-1, 3, 1)),
        "post1": box(0.2, 0.2, 2, at=(1, 3, 1)),
        "beam": box(1.8, 0.1, 0.1, at=(0, 3, 1.7)),
        "lamp": box(0.1, 0.1, 0.2, at=(0.7, 3, 1.55)),
    }
    footing = {"footing": Fastened(a="floor", b="wall", max_depth=0.001, reason="the wall is built on a footing")}
    rows = rows_of(tmp_path, things, relations=footing)
    assert {r.status for r in rows.values()} == {"pass"}
    pieces = {n.rsplit(":", 1)[1] for n in rows if n.startswith("support:balance:")}
    assert len(pieces) == 1, "posts, beam and lamp stand as one"
    assert {n for n in rows if n.startswith("support:hung:")} == {"support:hung:shelf", "support:hung:beam"}
    rows = rows_of(tmp_path / "loose", things)
    assert [r.id for r in rows.values() if r.status == "fail"] == ["support:scene", "support:balance:shelf"]


def beside_a_pole(air: float, **more: Any) -> dict[str, Any]:
    """A slab of 30 kg whose edge meets a pole of 2 cm, which is set into the floor."""
    slab = box(1, 1, 0.05, at=(0.51 + air, 0, 1.5), **more)
    return {"floor": ground(), "pole": box(0.02, 0.02, 3, at=(0, 0, 1.5)), "slab": slab}


SET = {"set": Fastened(a="floor", b="pole", max_depth=0.001, reason="the pole is set into the floor")}


@pytest.mark.parametrize("air", [0.0, 1e-4, 1.5e-4])
def test_a_slab_that_meets_a_thin_pole_from_the_side_is_held_by_nothing(tmp_path: Path, air: float) -> None:
    rows = rows_of(tmp_path / "loose", beside_a_pole(air))
    assert rows["support:balance:pole"].status == "fail", "pole and slab tip together"
    rows = rows_of(tmp_path / "set", beside_a_pole(air), relations=SET)
    row = rows["support:hung:slab"]
    assert (row.status, rows["support:scene"].status, row.bound) == ("fail", "fail", 1.0)
    assert row.measured is not None
    assert 0.0 < row.measured < 0.6
    assert row.entities[:2] == ("slab", "pole")


def test_what_bears_a_slab_beside_a_pole_is_a_bolt_a_post_a_larger_seat_or_a_word(tmp_path: Path) -> None:
    bolts = {**SET, "bolts": Fastened(a="pole", b="slab", max_depth=0.001, reason="the slab is welded to the pole")}
    under = {"under": box(0.1, 0.1, 1.475, at=(0.9, 0, 0.7375))}
    wall = {"pole": box(0.2, 1, 3, at=(-0.09, 0, 1.5))}
    honest: tuple[tuple[dict[str, Any], dict[str, Any]], ...] = (
        (beside_a_pole(0.0), bolts),
        (beside_a_pole(0.0) | wall, SET),
        (beside_a_pole(0.0, afloat="a slab that a spell keeps level"), SET),
        (beside_a_pole(0.0) | {"brace": box(0.02, 0.02, 3, at=(1.02, 0, 1.5))}, SET),
    )
    for k, (things, relations) in enumerate(honest):
        assert rows_of(tmp_path / str(k), things, relations=relations)["support:scene"].status == "pass", k
    rows = rows_of(tmp_path / "under", beside_a_pole(0.0) | under, relations=SET)
    assert "support:hung:slab" not in rows, "it stands on the post"


def test_a_load_on_a_bracket_is_borne_by_what_holds_the_bracket(tmp_path: Path) -> None:
    things = {"floor": ground(), "wall": box(0.2, 4, 3, at=(-0.1, 0, 1.5)), "bracket": box(0.1, 0.02, 0.02, at=(0.05, 0, 1.0))}
    assert rows_of(tmp_path / "a", things)["support:hung:bracket"].status == "pass"
    loaded = things | {"load": box(0.09, 0.4, 0.4, at=(0.05, 0, 1.21))}
    row = rows_of(tmp_path / "b", loaded)["support:hung:bracket"]
    assert row.measured is not None
    assert row.measured < rows_of(tmp_path / "c", things)["support:hung:bracket"].measured
    heavy = loaded | {"more": box(0.09, 2.0, 1.0, at=(0.05, 0, 1.91))}
    assert rows_of(tmp_path / "d", heavy)["support:hung:bracket"].status == "fail"


def test_a_vase_on_the_edge_of_its_shelf_tips_whatever_holds_the_shelf(tmp_path: Path) -> None:
    def room(x: float) -> dict[str, Any]:
        shelf = {"wall": box(0.2, 4, 3, at=(-2, 0, 1.5)), "shelf": box(0.3, 1, 0.05, at=(-1.75, 0, 1.2))}
        return {"floor": ground(), **shelf, "vase": box(0.1, 0.1, 0.3, at=(x, 0, 1.375))}

    assert rows_of(tmp_path / "a", room(-1.61))["support:balance:vase"].status == "pass"
    row = rows_of(tmp_path / "b", room(-1.58))["support:balance:vase"]
    assert (row.status, row.measured) == ("fail", pytest.approx(0.02, abs=1e-3))


def test_a_lamp_post_whose_arm_leans_out_needs_to_be_fastened_to_its_floor(tmp_path: Path) -> None:
    arm = Part(shape=Box(size=(2, 0.1, 0.1)), pose=pose((1.0, 0, 2.95)))
    things = {"floor": ground(), "lamp": entity(Part(shape=Box(size=(0.1, 0.1, 2.9)), pose=pose((0, 0, 1.45))), arm)}
    assert rows_of(tmp_path / "a", things)["support:balance:lamp"].status == "fail"
    bolts = {"bolts": Fastened(a="floor", b="lamp", max_depth=0.001, reason="the lamp is bolted to its foundation")}
    assert {r.status for r in rows_of(tmp_path / "b", things, relations=bolts).values()} == {"pass"}


def test_nothing_tips_without_gravity(tmp_path: Path) -> None:
    assert not any(r.startswith("support:balance") for r in rows_of(tmp_path, on_a_post(0.9), gravity=(0, 0, 0)))
