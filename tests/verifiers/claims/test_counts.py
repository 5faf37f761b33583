"""Claims of a count: exactly so many separate bodies, and exactly so many that do it; one less and one more are found where they are the truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.worlds.small_worlds import box, entity, ground, pose, world
from worldagent.tests.verifiers.claims.claimed import claimed, rows
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.spec import Box, Fastened, Part, RigidSettings, WeldJoint, WorldSpec

HIGH, LOW = 0.6, 0.101


def blocks(*heights: float, size: float = 0.2, **more: Any) -> WorldSpec:
    """Blocks in a row at some heights: those that are high fall."""
    row = {f"b{k + 1}": box(size, size, size, motion="dynamic", at=(0.5 * k, 0, z)) for k, z in enumerate(heights)}
    return world({"floor": ground(20.0), **row}, frames=16, settings=RigidSettings(step=1e-3), **more)


def ids(*numbers: int) -> list[str]:
    return [f"/entities/b{n}" for n in numbers]


def falls(*numbers: int) -> dict[str, Any]:
    return {f"f{n}": (f"b{n}", {"kind": "falls", "entity": f"b{n}"}) for n in numbers}


def three(numbers: tuple[int, ...] = (1, 2, 3), things: tuple[int, ...] = (1, 2, 3), told: tuple[int, ...] = (1, 2, 3)) -> dict[str, Any]:  # fmt: skip
    return {
        "three": {"quote": "three", "type": "count", "by": ids(*numbers)},
        "blocks": {"quote": "blocks", "type": "thing", "by": ids(*things)},
        "fall": {"quote": "fall", "type": "event", "by": [f"/story/beats/f{n}" for n in told]},
    }


COUNTING = {
    "kind": "count",
    "entities": ["b1", "b2", "b3", "b4"],
    "predicate": {"kind": "falls", "entity": "each"},
    "min": 3,
}


def row(folder: Path, spec: WorldSpec, claims: dict[str, Any], **more: Any) -> Any:
    return rows(folder, spec, claims, **more)["three"]


def test_three_blocks_that_fall_are_three(tmp_path: Path) -> None:
    found = row(tmp_path, blocks(HIGH, HIGH, HIGH), three(), beats=falls(1, 2, 3))
    assert (found.status, found.measured, found.bound) == ("pass", 3.0, 3.0), found.evidence


def test_a_fourth_that_falls_voids_three_of_four(tmp_path: Path) -> None:
    claims = {**three(things=(1, 2, 3, 4)), "four": {"quote": "four", "type": "count", "by": ids(1, 2, 3, 4)}}
    honest = row(tmp_path / "rests", blocks(HIGH, HIGH, HIGH, LOW), claims, beats=falls(1, 2, 3))
    assert honest.status == "pass", honest.evidence
    found = row(tmp_path / "falls", blocks(HIGH, HIGH, HIGH, HIGH), claims, beats=falls(1, 2, 3))
    assert (found.status, found.measured) == ("fail", 4.0)
    assert "of b4 as well" in found.evidence["explanation"]
    # Unless its own event says that it falls too.
    claims["too"] = {"quote": "too", "type": "event", "by": ["/story/beats/f4"]}
    assert row(tmp_path / "told", blocks(HIGH, HIGH, HIGH, HIGH), claims, beats=falls(1, 2, 3, 4)).status == "pass"


@pytest.mark.parametrize(("heights", "number"), [((HIGH, HIGH, HIGH, LOW), 3), ((HIGH,) * 4, 4), ((HIGH, HIGH, LOW, LOW), 2)])
def test_a_beat_that_counts_is_held_to_its_number(heights: Any, number: int, tmp_path: Path) -> None:
    claims = three(things=(1, 2, 3, 4), told=())
    claims["three"]["by"], claims["fall"]["by"] = ["/story/beats/f"], ["/story/beats/f"]
    found = row(tmp_path, blocks(*heights), claims, beats={"f": ("b1", COUNTING)})
    assert (found.status, found.measured) == ("pass" if number == 3 else "fail", float(number)), found.evidence


def test_an_event_of_some_of_them_is_one_of_fewer(tmp_path: Path) -> None:
    either = {"kind": "or", "of": [{"kind": "falls", "entity": f"b{n}"} for n in (1, 2, 3)]}
    claims = three(told=())
    claims["fall"]["by"] = ["/story/beats/f"]
    found = row(tmp_path, blocks(HIGH, HIGH, LOW), claims, beats={"f": ("b1", either)})
    assert (found.status, found.measured) == ("fail", 2.0)
    assert "not of b3" in found.evidence["explanation"]


WELD = {"weld": WeldJoint(parent="b1", child="b2", anchor=(0.25, 0, HIGH))}
GLUED = {"glue": Fastened(a="b1", b="b2", max_depth=0.01, reason="they are glued")}


@pytest.mark.parametrize("more", [{"joints": WELD}, {"relations": GLUED}], ids=["welded", "fastened"])
def test_bodies_in_one_lump_are_one(more: Any, tmp_path: Path) -> None:
    found = row(tmp_path, blocks(HIGH, HIGH, HIGH, **more), three(), beats=falls(1, 2, 3))
    assert (found.status, found.measured) == ("fail", 2.0)
    assert "to each other" in found.evidence["explanation"]


def test_bodies_in_one_another_are_one(tmp_path: Path) -> None:
    spec = blocks(HIGH, HIGH, HIGH)
    fixed = {
        n: spec.entities[n].model_copy(update={"pose": pose((x, 0, HIGH)), "motion": "static"})
        for n, x in (("b1", 0), ("b2", 0.05))
    }
    spec = spec.model_copy(update={"entities": {**spec.entities, **fixed}})
    claims = {k: v for k, v in three().items() if k != "fall"}
    found = row(tmp_path, spec, claims)
    assert (found.status, found.measured) == ("fail", 2.0)
    assert "overlap by" in found.evidence["explanation"]


def test_one_that_looks_the_same_and_that_nobody_speaks_of_is_one_more(tmp_path: Path) -> None:
    spec = blocks(LOW, LOW, LOW)
    for size, status in ((0.205, "fail"), (0.3, "pass")):
        fourth = box(size, size, size, motion="dynamic", at=(3, 0, size / 2 + 0.001))
        plan = spec.simulation
        solver = plan.solvers["rigid"].model_copy(update={"members": [*plan.solvers["rigid"].members, "other"]})
        more = spec.model_copy(update={
            "entities": {**spec.entities, "other": fourth}, "simulation": plan.model_copy(update={"solvers": {"rigid": solver}}),
        })  # fmt: skip
        found = row(tmp_path / status, more, {k: v for k, v in three().items() if k != "fall"})
        assert found.status == status, found.evidence
    assert not [p for p in claim_problems(claimed(more, three(), beats=falls(1, 2, 3))) if "same shape" in p.text]


def table(*at: tuple[float, float, float]) -> WorldSpec:
    legs = [Part(shape=Box(size=(0.05, 0.05, 0.4)), pose=pose(place)) for place in at]
    top = entity(Part(shape=Box(size=(1.0, 1.0, 0.05)), pose=pose((0, 0, 0.225))), *legs, motion="dynamic", at=(0, 0, 0.201))
    return world({"floor": ground(20.0), "b1": top}, frames=4)


def test_parts_are_counted_where_they_are_meant(tmp_path: Path) -> None:
    legs = [f"/entities/b1/parts/p{k}" for k in (1, 2, 3)]
    claims = {
        "three": {"quote": "three", "type": "count", "by": legs},
        "legs": {"quote": "legs", "type": "thing", "by": legs},
    }
    honest = table((0.4, 0.4, 0), (-0.4, 0.4, 0), (0, -0.4, 0))
    assert row(tmp_path / "apart", honest, claims).status == "pass"
    found = row(tmp_path / "one", table((0.4, 0.4, 0), (0.4, 0.4, 0), (0, -0.4, 0)), claims)
    assert (found.status, found.measured) == ("fail", 2.0)
    assert not [p for p in claim_problems(claimed(honest, claims)) if p.pointer == "/claims/three/by"]
    claims["legs"]["by"] = ["/entities/b1"]
    assert any("a part of one body" in p.text for p in claim_problems(claimed(honest, claims)))


def problems(claims: dict[str, Any], spec: WorldSpec, **more: Any) -> list[str]:
    return [p.text for p in claim_problems(claimed(spec, claims, **more))]


def test_the_audit_lets_three_of_five_through_and_no_thing_that_is_more_than_its_count() -> None:
    spec = blocks(HIGH, HIGH, HIGH, LOW, LOW)
    claims = {**three(things=(1, 2, 3, 4, 5)), "five": {"quote": "five", "type": "count", "by": ids(1, 2, 3, 4, 5)}}
    assert not [t for t in problems(claims, spec, beats=falls(1, 2, 3)) if "three" in t or "five" in t or "fall" in t]
    del claims["five"], claims["fall"]
    assert any("name the same, or claim what the 3 do" in t for t in problems(claims, spec))


@pytest.mark.parametrize(
    ("predicate", "said"),
    [({**COUNTING, "min": 2}, "asks for at least 2"), ({"kind": "falls", "entity": "b1"}, "counts nobody"), (COUNTING, "")],
)
def test_a_beat_that_a_count_names_counts_as_many(predicate: Any, said: str) -> None:
    claims = three(things=(1, 2, 3, 4), told=())
    claims["three"]["by"], claims["fall"]["by"] = ["/story/beats/f"], ["/story/beats/f"]
    found = problems(claims, blocks(HIGH, HIGH, HIGH, LOW), beats={"f": ("b1", predicate)})
    assert any(said in t for t in found) if said else not [t for t in found if "three" in t or "'f'" in t]


def test_a_length_that_happens_to_be_three_counts_nothing() -> None:
    spec = blocks(LOW, LOW, LOW, size=0.2)
    claims = three()
    claims["three"]["by"] = ["/entities/b1/pose/position/2"]
    high = spec.entities["b1"].model_copy(update={"pose": pose((0, 0, 3.0))})
    spec = spec.model_copy(update={"entities": {**spec.entities, "b1": high}})
    assert any("by names 0" in t for t in problems(claims, spec, beats=falls(1, 2, 3)))


def sided(*sides: float, step: float = 0.5) -> WorldSpec:
    """Blocks along a way, each at a distance to its side."""
    row = {f"b{k + 1}": box(0.2, 0.2, 0.2, motion="dynamic", at=(step * (k // 2), y, LOW)) for k, y in enumerate(sides)}
    return world({"floor": ground(20.0), **row}, frames=2, settings=RigidSettings(step=1e-3))


TWO_EACH = {
    "two": {"quote": "Two", "type": "count", "by": ids(1, 2, 3, 4)},
    "blocks": {"quote": "blocks", "type": "thing", "by": ids(1, 2, 3, 4)},
}
EACH_SIDE = "Two blocks stand on each side of the way."


def test_a_number_on_each_side_is_twice_as_many(tmp_path: Path) -> None:
    found = rows(tmp_path, sided(1, -1, 1, -1), TWO_EACH, prompt=EACH_SIDE)["two"]
    assert (found.status, found.measured, found.bound) == ("pass", 4.0, 4.0), found.evidence
    assert "2 stand on each side" in found.evidence["explanation"]


@pytest.mark.parametrize("sides", [(1, 1, 1, -1), (0, 0, 0, 0)], ids=["three and one", "in one row"])
def test_a_number_on_each_side_is_held_to_the_sides(sides: tuple[float, ...], tmp_path: Path) -> None:
    spec = sided(*sides) if any(sides) else sided(*(0.4 * k for k in range(4)), step=0.0)
    found = rows(tmp_path, spec, TWO_EACH, prompt=EACH_SIDE)["two"]
    assert found.status == "fail"
    assert "on each of two sides" in found.evidence["explanation"]


def test_the_audit_counts_both_sides_and_without_them_one() -> None:
    def said(prompt: str, counted: tuple[int, ...]) -> list[str]:
        claims = {**TWO_EACH, "two": {"quote": "Two", "type": "count", "by": ids(*counted)}}
        return [p.text for p in claim_problems(claimed(sided(1, -1, 1, -1), claims, prompt=prompt)) if "counts" in p.text]

    assert said(EACH_SIDE, (1, 2, 3, 4)) == []
    assert "(2 on each of 2 sides)" in said(EACH_SIDE, (1, 2))[0]
    assert said("Two blocks stand on the far side of the way.", (1, 2, 3, 4)) != []
    assert said("Two blocks stand there, and a wall on each side.", (1, 2, 3, 4)) != [], "those words are of another clause"
