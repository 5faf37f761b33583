"""Every rule of the audit: a specification broken in one way fails one row, with pointer and hint (R25-R31, R154-R156)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.worlds.small_grains import sand_spec
from worldagent.testing.worlds.small_liquids import tank_spec
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.bake_plan import groups_of
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec

ROPE = {"kind": "rope", "points": [[0, 0, 1], [0, 0, 0.6]], "radius": 0.005}
HINGE = {"kind": "hinge", "child": "b1", "anchor": [0, 0, 0], "axis": [0, 0, 1]}
LAST = 35


def base() -> WorldSpec:
    return parse_spec({**small_spec(), "prompt": PROMPT})


def broken(*operations: tuple[str, Any]) -> WorldSpec:
    patch = [{"op": "remove", "path": p} if v is None else {"op": "add", "path": p, "value": v} for p, v in operations]
    return apply_patch(base(), patch)


BROKEN: dict[str, tuple[list[tuple[str, Any]], str, str]] = {
    "an unknown material": ([("/entities/ball/material", "stele")], "references", "did you mean 'steel'"),
    "an unknown part material": ([("/entities/ball/parts/body/material", "unobtainium")], "references", "/parts/body/material"),
    "an unknown support": ([("/graph/relations/on_shelf_b1/a", "table")], "references", "unknown entity 'table'"),
    "a lamp in no part": ([("/look/lamps", {"l": {"entity": "ball", "part": "bodi"}})], "references", "did you mean 'body'"),
    "a lamp of nobody": ([("/look/lamps", {"l": {"entity": "bal", "part": "body"}})], "references", "did you mean 'ball'"),
    "an unknown region end": ([("/graph/relations/way", {"kind": "connects", "a": "r1", "b": "r2"})], "references", "unknown region 'r1'"),
    "an unknown owner": ([("/story/beats/roll/owner", "fluid")], "references", "unknown owner 'fluid'"),
    "an unknown cause": ([("/story/beats/fall/causes", ["bang"])], "references", "unknown beat 'bang'"),
    "a release that no beat tells": (
        [("/simulation/drivers/go", {"kind": "release", "entity": "b3", "time": 0.1})], "story", "release go lets b3 go at 0.1 s, before fall can"),
    "an effect that starts by itself": (
        [("/entities/b3/physics/linear_velocity", [1.6, 0, 0])], "story", "b3 starts with 1.6 m/s and 0 rad/s of its own"),
    "a material called steel that is other": (
        [("/materials/steel/substance", "other"), ("/materials/steel/density", 90)], "masses", "called steel and weighs 90 kg/m^3, steel 7700 to 8100"),
    "a margin of no cause": ([("/story/beats/fall/margins", {"roll": {"frames": 2}})], "story", "the margin names 'roll'"),
    "an unknown beat of a robustness item": (
        [("/story/robustness", {"r": {"kind": "refined", "beats": ["bang"]}})], "references", "unknown beat 'bang'"),
    "an unknown entity of a robustness item": (
        [("/story/robustness", {"r": {"kind": "perturbed", "beats": ["fall"], "min_fraction": 1, "speed": 0.1, "entities": ["ghost"]}})],
        "references", "ghost"),
    "an unknown entity in a nested predicate": (
        [("/story/beats/fall/predicate", {"kind": "and", "of": [{"kind": "speed", "entity": "b3", "min": 1}, {"kind": "speed", "entity": "b9", "min": 1}]})],
        "references", "/of/1/entity"),
    "an unknown entity in a count": (
        [("/story/beats/fall/predicate", {"kind": "count", "entities": ["b3", "b9"], "min": 1, "predicate": {"kind": "speed", "entity": "each", "min": 1}})],
        "references", "b9"),
    "an unknown member": ([("/simulation/solvers/rigid/members/0", "ghost")], "references", "ghost"),
    "an unknown joint": ([("/simulation/drivers/m", {"kind": "motor", "joint": "axle", "velocity": 1, "max_effort": 1, "end": 1})], "references", "axle"),
    "an unknown subject of a shot": ([("/shots/only/subjects", ["ghost"])], "references", "ghost"),
    "an unknown beat of a shot": ([("/shots/only/covers", ["roll", "strike", "fall", "ghost"])], "references", "ghost"),
    "a body in no solver": ([("/simulation/solvers/rigid/members", ["floor", "shelf", "ball", "b1", "b2"])], "ownership", "'b3' (dynamic) is in no solver"),
    "a body in two solvers": ([("/simulation/solvers/more", {"engine": "mujoco", "members": ["b3"]})], "ownership", "moved by ['rigid', 'more']"),
    "a kinematic body without a path": ([("/entities/b1/motion", "kinematic")], "ownership", "no path driver"),
    "a static body on a path": (
        [("/simulation/drivers/p", {"kind": "path", "entity": "shelf", "keys": {"a": {"time": 0, "pose": {}}, "b": {"time": 1, "pose": {}}}})],
        "ownership", "is static but a path driver moves it"),
    "a force on what cannot move": ([("/simulation/drivers/f", {"kind": "force", "entity": "shelf", "end": 1})], "ownership", "not dynamic"),
    "a hinge detached": ([("/simulation/joints/h", HINGE), ("/simulation/drivers/d", {"kind": "detach", "joint": "h", "time": 1})], "ownership", "only welds"),
    "a motor on a weld": (
        [("/simulation/joints/w", {"kind": "weld", "child": "b1", "anchor": [0, 0, 0]}),
         ("/simulation/drivers/m", {"kind": "motor", "joint": "w", "velocity": 1, "max_effort": 1, "end": 1})], "ownership", "only hinges"),
    "a beat beyond the end": ([("/story/beats/fall/frames", [4, 40])], "story", f"end after the last frame {LAST}"),
    "an owner that does not move the subject": ([("/story/beats/fall/subject", "b3"), ("/simulation/solvers/rigid/members", ["floor", "shelf", "ball", "b1", "b2"])],
                                                "story", "does not move 'b3'"),
    "a driver of something else": (
        [("/simulation/drivers/f", {"kind": "force", "entity": "b1", "end": 1}), ("/story/beats/roll/owner", "f")], "story", "does not act on 'ball'"),
    "a cause that begins too late": ([("/story/beats/roll/frames", [11, 12])], "story", "after this beat ends"),
    "causes in a circle": ([("/story/beats/roll/causes", ["fall"])], "story", "causes form a cycle"),
    "a predicate about something else": ([("/story/beats/fall/predicate/entity", "b2")], "story", "says nothing about the subject 'b3'"),
    "no mandatory beat": ([(f"/story/beats/{b}/mandatory", False) for b in ("roll", "strike", "fall")], "story", "nothing would prove the prompt"),
    "support of itself": ([("/graph/relations/x", {"kind": "supports", "a": "b1", "b": "b1"})], "graph", "related to itself"),
    "support in a circle": ([("/graph/relations/x", {"kind": "supports", "a": "b3", "b": "shelf"})], "graph", "runs in a circle"),
    "a relation beyond the end": ([("/graph/relations/on_shelf_b1/frames", [0, 50])], "graph", "end after the last frame"),
    "a density that is no wood": ([("/materials/wood/density", 5000)], "density:wood", "allowed 120 to 1200"),
    "skins beyond the contact tolerance": ([("/simulation/solvers/rigid/settings/skin", 0.01)], "bounds", "use a skin of at most"),
    "a skin that is more than half of a part": (
        [("/entities/b3/parts/body/shape/size", [0.05, 0.0008, 0.15])], "bounds",
        "skin 0.0005 m of 'rigid' is more than half of the 0.0008 m that 'b3/body' is thick: allowed is 0 to 0.0004 m"),
    "two contacts of one pair": (
        [("/simulation/contacts/one", {"a": "ball", "b": "b1", "friction": 0.3}), ("/simulation/contacts/two", {"a": "b1", "b": "ball", "friction": 0})],
        "bounds", "'two' (friction 0) is about 'b1' and 'ball', and so is 'one' (friction 0.3): one entry per pair"),
    "a hinge without a direction": (
        [("/simulation/joints/h", HINGE | {"axis": [0, 0, 0]})], "reach", "axis [0.0, 0.0, 0.0] of hinge 'h' has length 0, at least 1e-06"),
    "a range upside down": ([("/simulation/joints/h", HINGE | {"range": [1, -0.5]})], "reach", "is upside down, first < second is allowed: give [-0.5, 1.0]"),
    "a range that leaves out the start": (
        [("/simulation/joints/h", HINGE | {"kind": "slide", "range": [0.1, 0.4]})], "reach",
        "range [0.1, 0.4] m of slide 'h' leaves out 0 m, which is where 'b1' starts"),
    "a range of nothing": ([("/simulation/joints/h", HINGE | {"range": [0, 0]})], "reach", "leaves no way to go"),
    "a dynamic body that is said to hang in the air": (
        [("/entities/b3/afloat", "a magic block that hovers")], "ownership", "'b3' is dynamic, and afloat ('a magic block that hovers') is allowed for static"),
    "a number that no claim takes up": ([("/claims/three", None)], "claims", "is a number word and no claim takes it up"),
    "a claim judged by nothing": ([("/claims/falls_off/by", ["/story/beats/ghost"])], "claims", "leads nowhere"),
    "a claim of words that the prompt does not have": (
        [("/claims/cat", {"quote": "a cat", "type": "thing", "by": ["/entities/b1"]})], "claims", "/claims/cat/quote: "),
    "a beat of what no engine in use writes": (
        [("/story/beats/fall/predicate", {"kind": "broken", "entity": "b3", "min": 0.1})], "evidence", "no engine in use writes ['bond/broken'"),
    "a requirement of what no engine in use writes": (
        [("/story/requirements/whole", {"text": "it stays whole", "predicate": {"kind": "broken", "entity": "b3", "max": 0.0}})],
        "evidence", "/story/requirements/whole/predicate: no engine in use writes"),
    "a shot beyond the end": ([("/shots/only/frames", [0, 50])], "shots", "end after the last frame"),
    "a key outside its shot": ([("/shots/only/keys/a/frame", 36)], "shots", "lies outside the shot"),
    "a shot of nothing": ([("/shots/more", {"frames": [0, 1], "keys": {"a": {"frame": 0, "position": [0, 0, 0], "target": [1, 0, 0]}}})], "shots", "covers no beat"),
    "a beat that no shot covers": ([("/shots/only/covers", ["roll", "strike"])], "shots", "beat 'fall' (frames [4, 24]) is covered by no shot"),
}  # fmt: skip


def test_the_small_world_passes() -> None:
    report = audit(base())
    assert report.passed
    assert all(r.check == "audit" and r.artifact == "world.json" and r.mandatory for r in report.rows)


def test_no_member_of_a_list_is_proposed_in_place_of_another_that_is_gone() -> None:
    """The list would name it twice."""
    spec = broken(("/simulation/solvers/rigid/members/-", "ball2"), ("/simulation/solvers/rigid/members/-", "shelf2"))
    row = next(r for r in audit(spec).rows if r.id == "audit:references")
    first, second = (f"/simulation/solvers/rigid/members/{k}" for k in (6, 7))
    assert row.evidence["problems"] == [
        f"{second}: unknown entity 'shelf2'; take {second} out, or declare it",
        f"{first}: unknown entity 'ball2'; take {first} out, or declare it",
    ]
    patch = [operation for c in row.corrections for operation in c.patch]
    assert apply_patch(spec, patch).simulation.rigid["rigid"].members == base().simulation.rigid["rigid"].members


@pytest.mark.parametrize("name", BROKEN)
def test_each_fault_fails_its_row_with_a_pointer_and_a_hint(name: str) -> None:
    operations, row_id, words = BROKEN[name]
    report = audit(broken(*operations))
    assert not report.passed
    found = next(r for r in report.rows if r.id == f"audit:{row_id}")
    assert found.status in ("fail", "unverified")
    assert any(words in p for p in found.evidence["problems"]), found.evidence["problems"]
    assert all(c.pointers and c.pointers[0].startswith("/") and c.action for c in found.corrections)


def test_suggested_patches_mend_what_they_are_for() -> None:
    mended = 0
    for name, (operations, row_id, _) in BROKEN.items():
        spec = broken(*operations)
        found = next(r for r in audit(spec).rows if r.id == f"audit:{row_id}")
        for correction in found.corrections:
            if correction.patch:
                before = len(found.evidence["problems"])
                after = audit(apply_patch(spec, list(correction.patch)))
                left = next(r for r in after.rows if r.id == f"audit:{row_id}").evidence.get("problems", [])
                assert len(left) < before, name
                mended += 1
    assert mended >= 5


def _problems(row: str, *operations: tuple[str, Any]) -> list[str]:
    return list(next(r for r in audit(broken(*operations)).rows if r.id == f"audit:{row}").evidence.get("problems", []))


@pytest.mark.parametrize("span", [[-0.5, 1], [0, 1.57], [-1.57, 0], None])
def test_a_range_that_a_joint_can_start_in_is_no_fault(span: list[float] | None) -> None:
    """Own choice: the ends of a range belong to it, so that a door may start shut."""
    assert [p for p in _problems("reach", ("/simulation/joints/h", HINGE | {"range": span})) if "/range" in p] == []


def test_a_short_axis_tells_a_direction_as_well_as_a_long_one() -> None:
    assert [p for p in _problems("reach", ("/simulation/joints/h", HINGE | {"axis": [0, 0, 1e-3]})) if "/axis" in p] == []


def test_a_skin_may_take_half_of_a_part_and_is_not_asked_of_parts_that_are_only_drawn() -> None:
    size, thin = "/entities/b3/parts/body/shape/size", [0.05, 0.0008, 0.15]
    assert [p for p in _problems("bounds", (size, [0.05, 0.001, 0.15])) if "skin" in p] == []
    assert [p for p in _problems("bounds", (size, thin), ("/entities/b3/parts/body/collides", False)) if "skin" in p] == []
    thinner = ("/simulation/solvers/rigid/settings/skin", 0.0004)
    assert [p for p in _problems("bounds", (size, thin), thinner) if "skin" in p] == []


def test_contacts_of_different_pairs_and_afloat_of_what_is_static_are_no_fault() -> None:
    pairs = [("/simulation/contacts/one", {"a": "ball", "b": "b1"}), ("/simulation/contacts/two", {"a": "ball", "b": "b2"})]
    assert [p for p in _problems("bounds", *pairs) if "/contacts/" in p] == []
    assert [p for p in _problems("ownership", ("/entities/shelf/afloat", "a shelf of a dream")) if "afloat" in p] == []
    hung = ("/simulation/joints/h", {"kind": "weld", "child": "b3", "anchor": [0, 0, 9]})
    assert [p for p in _problems("ownership", hung, ("/entities/b3/afloat", "a block of a dream")) if "afloat" in p] == []


def test_drivers_that_a_beat_tells_or_that_come_too_late_to_be_certain_are_no_fault() -> None:
    go = {"kind": "release", "entity": "b3", "time": 0.1}
    late = ("/simulation/drivers/go", {**go, "time": 0.5})
    told = ("/story/beats/strike", {**base().story.beats["strike"].model_dump(mode="json"), "owner": "go", "subject": "b3"})
    optional = ("/story/beats/fall/mandatory", False)
    for changes in ([late], [("/simulation/drivers/go", go), told], [("/simulation/drivers/go", go), optional]):
        row = next(r for r in audit(broken(*changes)).rows if r.id == "audit:story")
        assert not any("before fall" in p for p in row.evidence.get("problems", [])), changes


def test_a_driver_that_no_beat_tells_is_offered_the_beat_that_it_could_own() -> None:
    """The ball is let go and the first beat of it is the solver's: naming the release as its owner is all that is missing."""
    go = {"kind": "release", "entity": "ball", "time": 0.02}
    hit = base().story.beats["strike"].model_dump(mode="json") | {"subject": "ball", "frames": [3, 10]}
    changes = [("/simulation/drivers/go", go), ("/story/beats/strike", hit)]

    def said(*more: tuple[str, Any]) -> list[str]:
        row = next(r for r in audit(broken(*changes, *more)).rows if r.id == "audit:story")
        return [p for p in row.evidence.get("problems", []) if "before strike" in p]

    assert "let go own beat roll (/story/beats/roll/owner)" in said()[0]
    assert said(("/story/beats/roll/owner", "go")) == []


def test_a_story_without_causes_is_told_what_its_acceptance_will_ask_for() -> None:
    assert audit(base()).lacking == ()
    without = broken(("/story/beats/fall/causes", []), ("/story/beats/strike/causes", []))
    (said,) = audit(without).lacking
    assert '"causes": ["roll"] in /story/beats/fall' in said
    assert audit(without).passed


def test_a_claim_that_is_waived_with_a_reason_passes() -> None:
    waived = {"quote": "falls off", "type": "event", "waived": "not wanted any more"}
    assert audit(broken(("/claims/falls_off", waived))).passed


def test_what_follows_from_the_specification() -> None:
    report = audit(base())
    assert report.bake_order == ("rigid",)
    assert ("b1", "ball") in report.contact_pairs
    assert ("b1", "shelf") in report.contact_pairs
    assert report.coverage == {"roll": ("only",), "strike": ("only",), "fall": ("only",)}


def test_the_bake_order_is_declared_or_follows_from_one_way_couplings() -> None:
    one = {"engine": "mujoco", "members": ["floor"]}
    coupling = {"source": "b_late", "target": "a_early", "direction": "one_way", "variables": ["motion"]}
    spec = broken(
        ("/simulation/solvers/a_early", one), ("/simulation/solvers/b_late", one), ("/simulation/couplings/c", coupling)
    )
    order = audit(spec).bake_order
    assert order.index("b_late") < order.index("a_early")
    declared = apply_patch(spec, [{"op": "add", "path": "/simulation/order", "value": ["a_early", "b_late"]}])
    assert audit(declared).bake_order == ("a_early", "b_late", "rigid")
    assert groups_of(declared) == [("a_early",), ("b_late",), ("rigid",)], "and the bake keeps it"
    assert groups_of(spec).index(("b_late",)) < groups_of(spec).index(("a_early",))


@pytest.mark.parametrize(
    ("made", "matter", "said"), [(sand_spec(), "sand", "pile_height"), (tank_spec(), "water", "liquid_arrives")]
)
def test_what_only_bodies_have_is_not_asked_of_grains_and_liquids(made: dict[str, Any], matter: str, said: str) -> None:
    spec = parse_spec({"prompt": "A ball falls into it.", **made})
    others = [n for n, e in spec.entities.items() if e.motion == "dynamic" and n != matter]
    beat = {"text": "they meet", "owner": next(iter(spec.simulation.rigid)), "subject": others[0], "frames": [0, 5],
            "predicate": {"kind": "contact", "a": others[0], "b": matter}}  # fmt: skip
    report = audit(apply_patch(spec, [{"op": "add", "path": "/story/beats/meets", "value": beat}]))
    problems = [p for r in report.rows if r.status != "pass" for p in r.evidence.get("problems", [])]
    assert any(f"contact asks for a body, and {matter!r} is" in p and said in p for p in problems), problems
    before = [p for r in audit(spec).rows for p in r.evidence.get("problems", [])]
    assert not any("asks for a body" in p for p in before)


@pytest.mark.parametrize(
    ("made", "body", "predicate"),
    [
        (tank_spec(), "crate", {"kind": "floats", "entity": "crate", "other": "water"}),
        (tank_spec(), "crate", {"kind": "sinks", "entity": "crate", "other": "water"}),
        (sand_spec(), "ball", {"kind": "buries", "entity": "sand", "other": "ball"}),
    ],
)
def test_events_of_a_body_and_loose_matter_are_asked_of_these_two(
    made: dict[str, Any], body: str, predicate: dict[str, Any]
) -> None:
    spec = parse_spec({"prompt": "A body falls into it.", **made})
    matter = next(v for k, v in predicate.items() if k != "kind" and v != body)

    def told(asked: dict[str, Any]) -> list[str]:
        beat = {
            "text": "it happens",
            "owner": next(iter(spec.simulation.rigid)),
            "subject": body,
            "frames": [0, 5],
            "predicate": asked,
        }
        report = audit(apply_patch(spec, [{"op": "add", "path": "/story/beats/event", "value": beat}]))
        return [p for r in report.rows for p in r.evidence.get("problems", []) if "asks for a body" in p]

    assert told(predicate) == []
    swapped = {k: {body: matter, matter: body}.get(v, v) for k, v in predicate.items()}
    assert any(repr(matter) in p for p in told(swapped))
