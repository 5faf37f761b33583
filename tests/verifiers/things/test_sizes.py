"""Sizes of things against the bounds of their kind, measured on what is built."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.assets.registry import GENERATORS
from worldagent.testing.assets import sampled
from worldagent.testing.defects._rooms import GAP, Room, room
from worldagent.testing.worlds.small_worlds import entity, make_candidate, pose, world
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.verifiers.register.assemble import approximations
from worldagent.verifiers.support.check import check as support_rows
from worldagent.verifiers.things import sizes
from worldagent.verifiers.things.kinds import KINDS, MEASURES, VARIANTS, Kind, head_noun, variant_of
from worldagent.verifiers.things.measures import measured, thing_of
from worldagent.worlds.errors import InputError
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Box, Part, Supports

SEEDS = 4
FURNITURE = (
    "wardrobe",
    "cupboard",
    "desk",
    "filing_cabinet",
    "kitchen_base",
    "fridge",
    "double_door",
    "window",
    "chest_of_drawers",
)
BY_GENERATOR = {g: k for k in KINDS.values() for g in k.generators}


def empty_room(rng: np.random.Generator) -> Room:
    """A floor."""
    found = Room(rng, 0.3, np.zeros(3))
    found.blocks("floor", "floor", {"slab": ((-4.0, -4.0, -0.2), (4.0, 4.0, 0.0))}, material="concrete_c30")
    return found


def _chair(tmp_path: Path, seat: float, role: str = "chair", *, scale: float = 1.0) -> Row | None:
    """The row of a chair of boxes whose seat is at a height [m], all times `scale`."""

    def block(size: tuple[float, ...], at: tuple[float, ...]) -> Part:
        return Part(shape=Box(size=tuple(scale * s for s in size)), pose=pose([scale * c for c in at]))

    parts = [block((0.42, 0.42, 0.04), (0, 0, seat - 0.02)), block((0.42, 0.04, 0.45), (0, 0.19, seat + 0.225))]
    parts += [block((0.04, 0.04, seat - 0.04), (x, y, seat / 2 - 0.02)) for x in (-0.19, 0.19) for y in (-0.19, 0.19)]
    made = entity(*parts, motion="dynamic").model_copy(update={"role": role})
    rows = sizes.check(make_candidate(tmp_path, world({"chair": made})))
    return rows[0] if rows else None


@pytest.mark.parametrize(("seat", "status"), [(0.351, "pass"), (0.349, "fail"), (0.549, "pass"), (0.551, "fail")])
def test_the_seat_of_a_chair_is_measured_on_its_surfaces(tmp_path: Path, seat: float, status: str) -> None:
    row = _chair(tmp_path, seat)
    assert row is not None
    assert row.status == status
    assert row.evidence["measures_m"]["level"] == pytest.approx(seat, abs=1e-6)
    if status == "fail":
        assert (row.bound, row.comparison) == ((0.35, ">=") if seat < 0.4 else (0.55, "<="))
        assert "EN 1729-1" in row.evidence["source"]


def test_a_bench_as_high_as_a_workbench_is_told_to_say_that_it_is_one(tmp_path: Path) -> None:
    high, low = (_chair(tmp_path / str(seat), seat, "long bench") for seat in (0.9, 0.6))
    assert high is not None
    assert low is not None
    told = [c.action for c in high.corrections]
    assert any("'workbench' as its last word" in action for action in told)
    assert not any("workbench" in c.action for c in low.corrections)  # a workbench is 0.62 m high at least
    as_one = _chair(tmp_path / "one", 0.9, "long workbench")
    assert as_one is not None
    assert as_one.status == "pass"


@pytest.mark.parametrize("role", ["chair", "oak chair with arms", "the kitchen chair, painted", "a chair for the guest"])
def test_the_last_word_of_a_role_tells_the_kind(tmp_path: Path, role: str) -> None:
    row = _chair(tmp_path, 0.2, role)
    assert row is not None
    assert row.status == "fail"


@pytest.mark.parametrize(
    "role",
    ["chair lift", "cushion of a chair", "block", "box that falls onto the chair", "flower bed", "bed of a river", "truck bed"],
)
def test_things_of_other_names_are_not_asked(tmp_path: Path, role: str) -> None:
    assert _chair(tmp_path, 0.2, role) is None


@pytest.mark.parametrize(("role", "scale", "status"), [
    ("toy chair", 0.1, "pass"), ("chair of a doll's house", 1 / 12, "pass"), ("child's chair", 0.6, "pass"), ("giant chair", 8.0, "pass"),
    ("child's chair", 0.1, "fail"), ("toy chair", 2.0, "fail"), ("giant chair", 0.5, "fail"),
])  # fmt: skip
def test_a_role_makes_another_kind_of_it(tmp_path: Path, role: str, scale: float, status: str) -> None:
    row = _chair(tmp_path, 0.45, role, scale=scale)
    assert row is not None
    assert row.status == status


def test_what_is_measured_as_a_toy_stands_in_the_register(tmp_path: Path) -> None:
    found = room(np.random.default_rng(0))
    found.put("chair", "chair", (1.2, 0.0, GAP))
    found.documents["chair"]["role"] = "toy chair"
    found.resized("chair", 0.1)
    lines = approximations(found.world(tmp_path).candidate)
    assert [line for line in lines if "measured as a toy chair" in line["what"]]


def test_the_first_correction_mends_the_size(tmp_path: Path) -> None:
    row = _chair(tmp_path, 0.45, scale=0.1)
    assert row is not None
    first, second = row.corrections[:2]
    assert first.edit_class == "scene"
    assert "toy" in second.action
    parts = [Part(shape=Box(size=(0.042, 0.042, 0.09)))]
    made = entity(*parts, motion="dynamic").model_copy(update={"role": "chair"})
    candidate = make_candidate(tmp_path, world({"chair": made}))
    (bad,) = sizes.check(candidate)
    after = apply_patch(candidate.spec, bad.corrections[0].patch)
    (good,) = sizes.check(make_candidate(tmp_path, after))
    assert good.evidence["measures_m"]["level"] >= 0.35


def test_a_slab_on_a_base_is_not_only_told_to_grow(tmp_path: Path) -> None:
    """A worktop of 4 cm on its base units was told to be 22 times as large."""
    slab = entity(Part(shape=Box(size=(2.0, 0.6, 0.04))), at=(0, 0, 0.88)).model_copy(update={"role": "oak worktop"})
    base = entity(Part(shape=Box(size=(2.0, 0.6, 0.86))), at=(0, 0, 0.43)).model_copy(update={"role": "base unit"})
    on = {"on": Supports(a="base", b="top")}
    (row,) = (
        r
        for r in sizes.check(make_candidate(tmp_path, world({"base": base, "top": slab}, relations=on)))
        if r.subject == ("top",)
    )
    assert row.status == "fail"
    assert "'base' its base" in row.corrections[0].action
    called = slab.model_copy(update={"role": "oak slab"})
    assert not sizes.check(make_candidate(tmp_path / "slab", world({"base": base, "top": called}, relations=on)))
    alone = sizes.check(make_candidate(tmp_path / "alone", world({"top": slab})))[0]
    assert "its base" not in alone.corrections[0].action


def _stairs(tmp_path: Path, **more: Any) -> tuple[Row, Any]:
    found = room(np.random.default_rng(1))
    found.put("stairs", "stairs", (-1.6, 0.0, GAP), **{"rise": 1.2, "width": 0.9, "riser": 0.175, "railing": "none", **more})
    return _row(tmp_path, found), found


def _row(tmp_path: Path, found: Any) -> Row:
    return next(r for r in sizes.check(found.world(tmp_path).candidate) if r.subject == ("stairs",))


def test_steps_are_measured_and_one_that_differs_is_found(tmp_path: Path) -> None:
    row, found = _stairs(tmp_path)
    assert row.status == "pass"
    rise = row.evidence["measures_m"]["rise"]
    assert rise == pytest.approx(1.2 / round(1.2 / rise), abs=1e-6)
    found.documents["stairs"]["parts"]["tread_3"]["pose"]["position"][2] -= 0.005
    bad = _row(tmp_path, found)
    assert (bad.status, bad.bound) == ("fail", 0.0095)
    assert bad.measured == pytest.approx(0.01, abs=1e-6)


@pytest.mark.parametrize("build", ["closed", "open", "stone"])
def test_steps_are_found_in_every_build(tmp_path: Path, build: str) -> None:
    if build not in str(GENERATORS["stairs"].model.model_json_schema()["properties"]["build"]):
        pytest.skip("no such build")
    row, _ = _stairs(tmp_path, build=build)
    assert row.status == "pass", row.evidence


@pytest.mark.parametrize("name", sorted(BY_GENERATOR))
def test_generators_make_things_of_their_kind(tmp_path: Path, name: str) -> None:
    """At the defaults and at random parameters; the numbers come from the surfaces, not from the parameters."""
    kind, judged = BY_GENERATOR[name], 0
    for seed in range(SEEDS):
        parameters = {} if seed == 0 else sampled(GENERATORS[name], np.random.default_rng(seed))
        found = Room(np.random.default_rng(seed), 0.3 * seed, np.zeros(3))
        try:
            found.put("thing", name, (1.2, 0.0, GAP), **{k: v for k, v in parameters.items() if k != "breakable"})
        except InputError:
            continue  # no room for a part at these parameters
        row = next(r for r in sizes.check(found.world(tmp_path).candidate) if r.subject == ("thing",))
        assert row.status == "pass", (parameters, row.evidence)
        assert set(row.evidence["measures_m"]) == {limit.measure for limit in kind.limits}
        judged += 1
    assert judged


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda k: k.name)
def test_bounds_of_a_kind_are_in_order_and_have_sources(kind: Kind) -> None:
    assert kind.limits
    assert set(kind.generators) <= set(GENERATORS)
    for limit in kind.limits:
        assert limit.measure in MEASURES
        assert limit.low is not None or limit.high is not None
        assert (limit.low or 0.0) < (limit.high or 1e9)
        assert len(limit.source) > 8


def test_a_generator_and_a_noun_have_one_kind() -> None:
    for words in ([g for k in KINDS.values() for g in k.generators], [n for k in KINDS.values() for n in k.nouns]):
        assert len(words) == len(set(words))
    assert all(0 < v.least <= v.most for v in VARIANTS)


def test_roles_are_read() -> None:
    assert head_noun("drawer of the desk") == "drawer"
    assert head_noun("Door leaf, left") == "leaf"
    assert head_noun("") == ""
    assert variant_of("chair of a doll's house") is VARIANTS[0]
    assert variant_of("chair") is None


def test_a_record_tells_no_size(tmp_path: Path) -> None:
    """Parts that were changed after they were made are measured as they are."""
    found = room(np.random.default_rng(2))
    found.put("table", "table", (1.2, 0.0, GAP), height=0.74)
    top = found.documents["table"]["parts"]["top"]
    top["pose"]["position"][2] += 0.5
    row = next(r for r in sizes.check(found.world(tmp_path).candidate) if r.subject == ("table",))
    assert row.status == "fail"
    assert row.evidence["measures_m"]["level"] == pytest.approx(1.24, abs=1e-3)


def test_leaves_are_measured_in_their_own_frame(tmp_path: Path) -> None:
    found = room(np.random.default_rng(4), ajar=1.0)
    thing = thing_of(found.world(tmp_path).candidate, "door")
    assert measured(thing, "leaf_height") == pytest.approx(2.006, abs=1e-3)
    assert measured(thing, "leaf_width") == pytest.approx(0.857, abs=2e-3)


@pytest.mark.parametrize("ajar", [0.0, 1.0])
def test_a_door_that_is_fixed_is_measured_by_its_leaf_and_held(tmp_path: Path, ajar: float) -> None:
    found = empty_room(np.random.default_rng(4))
    positions = {"leaf": ajar} if ajar else None
    found.put("door", "door", (0.0, 0.0, GAP), positions=positions, fixed=True)
    candidate = found.world(tmp_path).candidate
    assert candidate.spec.simulation.joints == {}
    assert candidate.spec.entities["door_leaf"].motion == "static"
    row = next(r for r in sizes.check(candidate) if r.subject == ("door",))
    assert row.status == "pass"
    assert row.evidence["measures_m"]["leaf_width"] == pytest.approx(0.857, abs=2e-3)
    rows = {r.id: r for r in support_rows(candidate)}
    assert rows["support:fastened:door_leaf_fixed"].status == "pass"
    # Ajar, a frame that nothing holds tips over; shut, it stands.
    assert rows["support:scene"].status == ("fail" if ajar else "pass")


def test_the_leaf_of_a_fixed_door_that_is_too_small_is_found(tmp_path: Path) -> None:
    found = empty_room(np.random.default_rng(4))
    found.put("door", "door", (0.0, 0.0, GAP), fixed=True)
    found.resized("door_leaf", 0.5)
    row = next(r for r in sizes.check(found.world(tmp_path).candidate) if r.subject == ("door",))
    assert (row.status, row.evidence["kind"]) == ("fail", "door")


def test_a_fixed_door_whose_leaf_is_gone_is_unmeasured_and_told_how_to_make_it_again(tmp_path: Path) -> None:
    found = empty_room(np.random.default_rng(4))
    found.put("door", "door", (0.0, 0.0, GAP), fixed=True)
    found.documents["door"]["asset"]["bodies"] = []
    candidate = found.world(tmp_path).candidate
    row = diagnose(next(r for r in sizes.check(candidate) if r.subject == ("door",)), candidate.spec)
    assert row.status == "unverified"
    assert "width of the leaf" in row.evidence["explanation"]
    assert "fixed: true" in row.corrections[0].action
    assert "files" not in row.corrections[0].action


@pytest.mark.parametrize("kind", FURNITURE)
def test_whatever_has_leaves_or_drawers_may_be_fixed_and_is_held(tmp_path: Path, kind: str) -> None:
    found = empty_room(np.random.default_rng(0))
    found.put("thing", kind, (0.0, 0.0, GAP), motion="static", fixed=True)
    candidate = found.world(tmp_path).candidate
    assert {e.motion for e in candidate.spec.entities.values()} == {"static"}
    failed = [r.id for r in support_rows(candidate) if r.status not in ("pass", "not_applicable")]
    assert failed == []
