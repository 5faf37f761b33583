"""JSON Patch on specifications, differences, and which changes count as weakening (R157), in both directions."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.errors import LimitError, SpecError
from worldagent.worlds.patch import apply_patch, differences, parse_spec, weakenings
from worldagent.worlds.spec import WorldSpec

FALL = "/story/beats/fall"
SPEED = {"kind": "speed", "entity": "b3", "min": 0.5}
ROBUST = {"kind": "perturbed", "beats": ["fall"], "samples": 16, "min_fraction": 0.9, "speed": 0.1}
FINER = {"kind": "refined", "beats": ["fall"], "factor": 2, "frames": 1}
BLOCKS = {"quote": "blocks", "type": "thing", "by": ["/entities/b1", "/entities/b2", "/entities/b3"]}
REGION = {"kind": "sphere", "center": [0, 0, 0], "radius": 0.1}


def base() -> WorldSpec:
    """The small world without its claims, with a way, a rock and a block that can break."""
    spec = small_spec(claims={})
    spec["graph"]["regions"] = {"here": REGION, "there": REGION}
    spec["graph"]["relations"]["way"] = {"kind": "connects", "a": "here", "b": "there"}
    spec["materials"]["rock"] = {"density": 2200}
    spec["entities"]["b2"]["breakable"] = {
        "pattern": {"kind": "voronoi", "pieces": 4}, "bond": {"tension": 2e5, "shear": 2e5, "crumble": 0.0001}
    }  # fmt: skip
    return parse_spec({**spec, "prompt": PROMPT})


def changed(spec: WorldSpec, pointer: str, value: Any) -> WorldSpec:
    return apply_patch(spec, [{"op": "add", "path": pointer, "value": value}])


def with_predicate(predicate: dict[str, Any]) -> WorldSpec:
    return changed(base(), f"{FALL}/predicate", predicate)


def band(kind: str, **bounds: Any) -> dict[str, Any]:
    return {"kind": kind, "entity": "b3", **bounds}


# (harder, easier): going from left to right weakens, going from right to left does not
PREDICATES: list[tuple[dict[str, Any], dict[str, Any]]] = [
    (band("speed", min=0.5), band("speed", min=0.4)),
    (band("speed", max=0.5), band("speed", max=0.6)),
    (band("speed", min=0.1, max=0.5), band("speed", min=0.1)),
    ({"kind": "contact", "a": "ball", "b": "b3", "min_impulse": 0.2}, {"kind": "contact", "a": "ball", "b": "b3"}),
    ({"kind": "topples", "entity": "b3", "min_angle": 1.0}, {"kind": "topples", "entity": "b3", "min_angle": 0.5}),
    ({"kind": "rests_on", "entity": "b3", "on": "floor", "max_speed": 0.01},
     {"kind": "rests_on", "entity": "b3", "on": "floor", "max_speed": 0.1}),
    ({"kind": "not", "predicate": band("speed", min=0.4)}, {"kind": "not", "predicate": band("speed", min=0.5)}),
    ({"kind": "and", "of": [SPEED, band("tilts", min=1)]}, {"kind": "and", "of": [SPEED]}),
    ({"kind": "and", "of": [SPEED, band("tilts", min=1)]}, {"kind": "and", "of": [SPEED, band("tilts", min=0.5)]}),
    ({"kind": "or", "of": [SPEED]}, {"kind": "or", "of": [SPEED, band("tilts", min=1)]}),
    ({"kind": "eventually", "predicate": band("speed", min=0.5)}, {"kind": "eventually", "predicate": band("speed", min=0.4)}),
    ({"kind": "within", "beat": "strike", "frames": 3, "predicate": SPEED}, {"kind": "within", "beat": "strike", "frames": 5, "predicate": SPEED}),
    ({"kind": "count", "entities": ["b1", "b2"], "min": 2, "predicate": SPEED}, {"kind": "count", "entities": ["b1", "b2"], "min": 1, "predicate": SPEED}),
]  # fmt: skip

# neither direction is harmless
PREDICATES_EITHER: list[tuple[dict[str, Any], dict[str, Any]]] = [
    (band("speed", min=0.5), band("tilts", min=0.5)),
    (band("speed", min=0.5), {"kind": "speed", "entity": "b2", "min": 0.5}),
    (band("speed", min=0.5, when="eventually"), band("speed", min=0.5, when="end")),
    ({"kind": "after", "beat": "strike", "predicate": band("speed", min=0.5)}, {"kind": "after", "beat": "strike", "predicate": band("speed", min=0.6)}),
    ({"kind": "count", "entities": ["b1", "b2"], "max": 1, "predicate": band("speed", min=0.5)},
     {"kind": "count", "entities": ["b1", "b2"], "max": 1, "predicate": band("speed", min=0.6)}),
]  # fmt: skip

LIMITS = {
    "scale_ratio": ([0.01, 100], [0.001, 100]),
    "contact_gap": (0.002, 0.003),
    "max_speed": (10, 20),
    "energy_growth": (0.01, 0.02),
    "support_drift": (0.001, 0.002),
    "visible_pixels": (0.001, 0.0005),
    "visible_share": (0.5, 0.2),
    "beat_seen_frames": (0.5, 0.2),
}


@pytest.mark.parametrize(("hard", "easy"), PREDICATES)
def test_loosening_a_predicate_is_a_weakening_and_tightening_is_not(hard: dict[str, Any], easy: dict[str, Any]) -> None:
    strict, loose = with_predicate(hard), with_predicate(easy)
    assert weakenings(strict, loose) == [f"{FALL}/predicate loosened or replaced"]
    assert weakenings(loose, strict) == []
    assert weakenings(strict, strict) == []


@pytest.mark.parametrize(("one", "other"), PREDICATES_EITHER)
def test_a_change_that_may_help_counts_as_weakening_both_ways(one: dict[str, Any], other: dict[str, Any]) -> None:
    assert weakenings(with_predicate(one), with_predicate(other))
    assert weakenings(with_predicate(other), with_predicate(one))


@pytest.mark.parametrize("name", LIMITS)
def test_limits_weaken_in_one_direction_only(name: str) -> None:
    hard, easy = (changed(base(), f"/simulation/limits/{name}", v) for v in LIMITS[name])
    assert len(weakenings(hard, easy)) == 1
    assert f"/simulation/limits/{name}" in weakenings(hard, easy)[0]
    assert weakenings(easy, hard) == []


def test_every_limit_has_a_direction_that_weakens() -> None:
    assert set(LIMITS) == set(type(base().simulation.limits).model_fields)


@pytest.mark.parametrize(
    ("pointer", "hard", "easy"),
    [
        (f"{FALL}/mandatory", True, False),
        (f"{FALL}/observe", True, False),
        (f"{FALL}/causes", ["strike", "roll"], ["strike"]),
        (f"{FALL}/margins", {}, {"strike": {"frames": 3}}),
        (f"{FALL}/margins", {"strike": {"frames": 3}}, {"strike": {"frames": 2}}),
        (f"{FALL}/margins", {"strike": {"value": 0.3}}, {"strike": {"value": 0.2}}),
        ("/story/robustness", {"r": ROBUST}, {}),
        ("/story/robustness/r", ROBUST, {**ROBUST, "samples": 8}),
        ("/story/robustness/r", ROBUST, {**ROBUST, "min_fraction": 0.8}),
        ("/story/robustness/r", {**ROBUST, "position": 0.002}, {**ROBUST, "position": 0.001}),
        ("/story/robustness/r", {**ROBUST, "beats": ["fall", "strike"]}, ROBUST),
        ("/story/robustness/r", {**FINER, "factor": 4}, FINER),
        ("/story/robustness/r", FINER, {**FINER, "frames": 2}),
        ("/entities/b1/dimensions/tolerance", 0.01, 0.05),
        ("/simulation/frames", 36, 30),
        ("/claims/blocks", BLOCKS, {"quote": "blocks", "type": "thing", "waived": "too hard to show here"}),
        ("/claims/blocks", BLOCKS, {**BLOCKS, "by": ["/entities/b1", "/entities/b2"]}),
        ("/shots/only/covers", ["roll", "strike", "fall"], ["roll", "strike"]),
        ("/shots/only/subjects", ["ball", "b3"], ["b3"]),
        ("/entities/b1/motion", "dynamic", "static"),
        ("/graph/relations/way/width", 0.8, 0.1),
        ("/graph/relations/way/headroom", 2.0, 0.5),
        ("/graph/relations/way/max_step", 0.2, 5.0),
        ("/graph/relations/way/max_slope", 0.6, 1.5),
        ("/entities/b1/physics", {"category": "rigid"}, {"category": "rigid", "mass": 0.05}),
        ("/entities/b1/active", [0, 35], [0, 20]),
        ("/entities/b1/physics/hollow", False, True),
        ("/entities/b2/breakable/bond/crumble", 0.0001, 0.001),
        ("/entities/b1/afloat", None, "a magic domino that hovers"),
    ],
)
def test_one_way_changes(pointer: str, hard: Any, easy: Any) -> None:
    strict, loose = changed(base(), pointer, hard), changed(base(), pointer, easy)
    assert len(weakenings(strict, loose)) == 1
    assert weakenings(loose, strict) == []


@pytest.mark.parametrize(
    ("pointer", "one", "other"),
    [
        (f"{FALL}/margins", {"strike": {"value": 0.3}}, {"strike": {"frames": 3}}),
        ("/story/robustness/r", ROBUST, FINER),
        ("/story/robustness/r", ROBUST, {**ROBUST, "seed": 1}),
        ("/story/robustness/r", ROBUST, {**ROBUST, "entities": ["ball"]}),
        ("/claims/blocks", {**BLOCKS, "type": "count"}, BLOCKS),
        (f"{FALL}/subject", "b3", "b2"),
        ("/graph/relations/on_shelf_b1/frames", [0, 0], [0, 3]),
        ("/graph/relations/hits/ratio", [0.1, 10], [0.01, 100]),
        ("/graph/regions/goal", REGION, {**REGION, "radius": 0.2}),
        ("/materials/steel/substance", "steel", "other"),
        ("/entities/b1/nominal_diagonal", 0.08, 0.2),
        ("/simulation/gravity", [0, 0, -1.62], [0, 1, -9.7]),
        ("/simulation/fps", 24, 12),
        ("/materials/wood/density", 500, 700),
        ("/graph/relations/way/carrier", "walker", "object"),
        ("/entities/b1/physics", {"category": "rigid", "mass": 0.05}, {"category": "rigid", "mass": 0.06}),
    ],
)
def test_changes_that_may_help_either_way(pointer: str, one: Any, other: Any) -> None:
    first, second = changed(base(), pointer, one), changed(base(), pointer, other)
    assert weakenings(first, second)
    assert weakenings(second, first)


def test_repairs_of_the_scene_or_the_solver_are_no_weakening() -> None:
    for pointer, value in (
        ("/entities/ball/pose/position", [-0.1, 0, 0.321]),
        ("/entities/ball/physics/linear_damping", 0.1),
        ("/materials/rock/density", 2500),
        ("/simulation/solvers/rigid/settings/skin", 0.0004),
        ("/entities/b2/breakable/bond/tension", 1e5),
        ("/entities/b1/parts/body/collides", False),
        ("/entities/b1/parts/ear", {"shape": {"kind": "box", "size": [0.01, 0.01, 0.01]}, "collides": False}),
        ("/entities/b1/parts", {"trunk": base().model_dump(mode="json")["entities"]["b1"]["parts"]["body"]}),
        ("/entities/b1/parts/body/shape", {"kind": "sphere", "radius": 0.02}),
        ("/simulation/solvers/rigid/settings/step", 0.0002),
        ("/materials/steel/friction", 0.5),
        ("/shots/only/intent", "another"),
        ("/graph/relations/on_shelf_b1/text", "words"),
        ("/look/samples", 4),
        ("/simulation/frames", 40),
        ("/story/beats/more", base().story.beats["fall"].model_dump(mode="json")),
        ("/story/beats/more", {**base().story.beats["fall"].model_dump(mode="json"), "margins": {"strike": {"frames": 1}}}),
        ("/story/robustness/r", ROBUST),
    ):
        assert weakenings(base(), changed(base(), pointer, value)) == [], pointer


def test_removed_requirements_and_relations_are_named() -> None:
    spec = changed(base(), "/story/requirements/still", {"text": "t", "predicate": SPEED})
    glued = {"kind": "fastened", "a": "b1", "b": "b2", "max_depth": 0.1, "reason": "glued fast"}
    spec = changed(spec, "/graph/relations/glue", glued)
    assert weakenings(base(), spec) == ["/graph/relations/glue: overlap of b1 and b2 declared intended"]
    assert weakenings(spec, base()) == ["/story/requirements/still removed"]
    # Of what is new with it nothing was asked before: a house and its foundation, a bracket and what it is bolted to.
    bracket = base().entities["b1"].model_dump(mode="json")
    added = apply_patch(
        base(),
        [
            {"op": "add", "path": "/entities/bracket", "value": bracket},
            {"op": "add", "path": "/graph/relations/bolted", "value": glued | {"b": "bracket"}},
        ],
    )
    assert weakenings(base(), added) == []
    deeper = changed(added, "/graph/relations/bolted/max_depth", 0.2)
    assert weakenings(added, deeper) == ["/graph/relations/bolted/max_depth 0.1 -> 0.2"]
    gone = apply_patch(spec, [{"op": "remove", "path": "/graph/relations/hits"}])
    assert weakenings(spec, gone) == ["/graph/relations/hits (interacts) removed"]


# ---------------------------------------------------------------- patches


@pytest.mark.parametrize(
    "operation",
    [
        {"op": "replace", "path": "/nowhere/at/all", "value": 1},
        {"op": "add", "path": "no slash", "value": 1},
        {"op": "remove", "path": "/entities/ghost"},
        {"op": "test", "path": "/title", "value": "other"},
        {"op": "explode", "path": "/title"},
        {"op": "add", "path": "/title"},
        {"path": "/title", "value": "x"},
        {"op": "copy", "from": "/ghost", "path": "/title"},
        {"op": "move", "from": "/entities", "path": "/entities/ball"},
        {"op": "add", "path": "/simulation/solvers/rigid/members/99", "value": "ball"},
        {"op": "add", "path": "/simulation/solvers/rigid/members/x", "value": "ball"},
        {"op": "add", "path": 5, "value": 1},
        {"op": 5, "path": "/title", "value": 1},
        {"op": "add", "path": None, "value": 1},
        {"op": "replace", "path": "", "value": []},
        {"op": "replace", "path": "", "value": None},
        {"op": "add", "path": "/title/x", "value": 1},
    ],
)
def test_a_patch_that_does_not_apply_is_a_spec_error(operation: dict[str, Any]) -> None:
    spec = base()
    before = copy.deepcopy(spec.model_dump(mode="json"))
    with pytest.raises(SpecError):
        apply_patch(spec, [operation])
    assert spec.model_dump(mode="json") == before


def test_a_patch_is_all_or_nothing() -> None:
    with pytest.raises(SpecError, match="nothing was changed"):
        apply_patch(base(), [{"op": "replace", "path": "/title", "value": "x"}, {"op": "remove", "path": "/ghost"}])


def test_what_an_interior_lists_follows_an_entity_that_is_taken_out() -> None:
    """The list is a record of the server's own: nobody has to know of it."""
    rooms = {"hall": {"kind": "hall"}}
    spec = changed(base(), "/interiors", {"house": {"rooms": rooms, "entities": ["shelf", "b1", "b2"]}, "hut": {"rooms": rooms}})
    out = {"op": "remove", "path": "/entities/b1"}
    after = apply_patch(spec, [out])
    assert after.interiors["house"].entities == ["shelf", "b2"]
    assert after.interiors["hut"] == spec.interiors["hut"]
    assert spec.interiors["house"].entities == ["shelf", "b1", "b2"]
    assert apply_patch(spec, [out, {"op": "remove", "path": "/interiors/house/entities/1"}]) == after
    assert apply_patch(spec, [out, {"op": "remove", "path": "/interiors"}]).interiors == {}
    with pytest.raises(SpecError, match="/interiors/house/entities"):
        apply_patch(spec, [out, {"op": "add", "path": "/interiors/house/entities/-", "value": ["b3"]}])
    # An entity that never was is a mistake of its own, and stays for the audit to tell.
    assert changed(spec, "/interiors/house/entities/-", "b9").interiors["house"].entities[-1] == "b9"


def test_too_many_operations_are_refused() -> None:
    with pytest.raises(LimitError, match=r"2,001 operations .*cap 2,000.*split the patch"):
        apply_patch(base(), [{"op": "test", "path": "/title", "value": "Three blocks"}] * 2001)


def test_problems_carry_pointers_and_values() -> None:
    with pytest.raises(SpecError) as found:
        apply_patch(base(), [{"op": "replace", "path": "/simulation/fps", "value": 0}])
    ((pointer, message),) = found.value.problems
    assert pointer == "/simulation/fps"
    assert "got 0" in message


def test_differences_are_pointers_of_leaves_and_whole_subtrees() -> None:
    old = {"a": {"b": 1, "c": [1, 2]}, "d": 1}
    new = {"a": {"b": 2, "c": [1, 3]}, "e": {"f": 1}}
    assert list(differences(old, new)) == ["/a/b", "/a/c", "/d", "/e"]
    assert list(differences(old, old)) == []


# ---------------------------------------------------------------- intervals

HAPPENS = [SPEED, {"kind": "eventually", "predicate": SPEED}, {"kind": "crosses", "entity": "b3", "point": [0, 0, 0], "normal": [1, 0, 0]},
           {"kind": "or", "of": [SPEED, SPEED]}, {"kind": "not", "predicate": {**SPEED, "when": "always"}}]  # fmt: skip
LASTS = [{**SPEED, "when": "always"}, {"kind": "supported", "entity": "b3"}, {"kind": "always", "predicate": SPEED},
         {"kind": "no_contact", "a": "ball", "b": "b3"}, {"kind": "not", "predicate": SPEED}]  # fmt: skip
UNTOLD = [{"kind": "topples", "entity": "b3"}, {"kind": "before", "beat": "strike", "predicate": SPEED},
          {"kind": "and", "of": [SPEED, {**SPEED, "when": "always"}]}]  # fmt: skip


def _over(predicate: dict[str, Any], frames: list[int], causes: list[str]) -> WorldSpec:
    spec = changed(with_predicate(predicate), f"{FALL}/frames", frames)
    return changed(spec, f"{FALL}/causes", causes)


@pytest.mark.parametrize("predicate", HAPPENS)
def test_what_must_happen_sooner_asks_for_more(predicate: dict[str, Any]) -> None:
    wide = _over(predicate, [4, 30], [])
    for narrow in ([4, 24], [6, 30], [6, 24]):
        assert weakenings(wide, _over(predicate, narrow, [])) == []
        assert weakenings(_over(predicate, narrow, []), wide) == [f"{FALL}/frames {narrow} -> [4, 30]"]


@pytest.mark.parametrize("predicate", LASTS)
def test_what_must_last_asks_for_less_in_fewer_frames(predicate: dict[str, Any]) -> None:
    wide, narrow = _over(predicate, [4, 30], []), _over(predicate, [4, 24], [])
    assert weakenings(narrow, wide) == []
    assert weakenings(wide, narrow) == [f"{FALL}/frames [4, 30] -> [4, 24]"]


@pytest.mark.parametrize("predicate", UNTOLD)
def test_where_it_cannot_be_told_other_frames_may_ask_for_less(predicate: dict[str, Any]) -> None:
    wide, narrow = _over(predicate, [4, 30], []), _over(predicate, [4, 24], [])
    assert weakenings(narrow, wide)
    assert weakenings(wide, narrow)


def test_what_must_be_so_at_the_end_may_be_looked_for_sooner_and_no_later() -> None:
    """Only its last frame decides, and vacuity asks that it be looked for from where it came true."""
    late, sooner = (_over({**SPEED, "when": "end"}, [first, 24], []) for first in (6, 3))
    assert weakenings(late, sooner) == []
    assert weakenings(sooner, late) == [f"{FALL}/frames [3, 24] -> [6, 24]"]
    assert weakenings(late, _over({**SPEED, "when": "end"}, [6, 30], []))
    assert weakenings(late, _over({**SPEED, "when": "end"}, [6, 20], []))


def test_an_effect_looked_for_later_may_hide_that_it_came_before_its_cause() -> None:
    early, late = _over(SPEED, [4, 24], ["strike"]), _over(SPEED, [6, 24], ["strike"])
    assert weakenings(early, late)
    assert weakenings(_over(SPEED, [4, 24], ["strike"]), _over(SPEED, [4, 20], ["strike"])) == []


def test_a_requirement_without_frames_asks_over_all_of_them() -> None:
    def asked(when: str, frames: list[int] | None) -> WorldSpec:
        own = {} if frames is None else {"frames": frames}
        return changed(base(), "/story/requirements/still", {"text": "t", "predicate": {**SPEED, "when": when}, **own})

    assert weakenings(asked("always", None), asked("always", [0, 10])) != []
    assert weakenings(asked("always", [0, 10]), asked("always", None)) == []
    assert weakenings(asked("eventually", None), asked("eventually", [0, 10])) == []
    assert weakenings(asked("eventually", [0, 10]), asked("eventually", None)) != []


# ---------------------------------------------------------------- quantities of nature, surfaces

SOFT = {"kind": "broken", "entity": "b2", "min": 0.1}


@pytest.mark.parametrize("field", ["tension", "shear", "toughness", "friction"])
def test_strength_is_a_weakening_where_a_beat_asks_to_break_or_to_hold(field: str) -> None:
    place = f"/entities/b2/breakable/bond/{field}"

    def strong(predicate: dict[str, Any], value: float) -> WorldSpec:
        return changed(with_predicate(predicate), place, value)

    holds = {"kind": "not", "predicate": SOFT}
    for asked, hard, easy in ((SOFT, 1.0, 0.5), (holds, 0.5, 1.0), ({"kind": "broken", "entity": "b2", "max": 0.2}, 0.5, 1.0)):
        (told,) = weakenings(strong(asked, hard), strong(asked, easy))
        assert told == f"{place} {hard:g} -> {easy:g}, by which fall is easier to meet"
        assert weakenings(strong(asked, easy), strong(asked, hard)) == []
    other = {**SOFT, "entity": "b3"}
    assert weakenings(strong(other, 1.0), strong(other, 0.5)) == []


def test_back_to_the_gravity_of_the_earth_and_to_density_times_volume_is_no_weakening() -> None:
    assert weakenings(changed(base(), "/simulation/gravity", [0, 0, -1.62]), base()) == []
    assert weakenings(base(), changed(base(), "/simulation/gravity", [0, 0, -1.62])) == [
        "/simulation/gravity [0.0, 0.0, -9.81] -> [0.0, 0.0, -1.62], which leaves its default"
    ]
    heavy = changed(base(), "/entities/b1/physics/mass", 0.05)
    assert weakenings(heavy, apply_patch(heavy, [{"op": "remove", "path": "/entities/b1/physics/mass"}])) == []


def test_more_frames_per_second_that_end_sooner_ask_for_less() -> None:
    (told,) = weakenings(base(), changed(base(), "/simulation/fps", 96))
    assert "the sequence lasts" in told
    longer = apply_patch(base(), [{"op": "replace", "path": "/simulation/fps", "value": 48}, {"op": "replace", "path": "/simulation/frames", "value": 99}])  # fmt: skip
    assert weakenings(base(), longer) == []


def test_a_surface_on_which_a_failing_row_was_judged_may_not_go() -> None:
    drawn = changed(base(), "/entities/b1/parts/body/collides", False)
    assert weakenings(base(), drawn, {"b1"}) == ["/entities/b1/parts/body collides no more, on which a failing row was judged"]
    assert weakenings(base(), drawn, {"b3"}) == []
    ear = {"shape": {"kind": "box", "size": [0.01, 0.01, 0.01]}}
    two = changed(base(), "/entities/b1/parts/ear", ear)
    assert weakenings(base(), two, {"b1"}) == []
    assert weakenings(two, base(), {"b1"}) == ["/entities/b1/parts/ear removed, on which a failing row was judged"]
    body = base().model_dump(mode="json")["entities"]["b1"]["parts"]["body"]
    other = changed(base(), "/entities/b1/parts", {"trunk": {**body, "shape": {"kind": "sphere", "radius": 0.02}}})
    assert weakenings(base(), other, {"b1"}) == []


def test_a_coupling_without_its_way_back_is_a_weakening() -> None:
    both = {"source": "rigid", "target": "rigid", "direction": "two_way", "variables": ["motion"]}
    two = changed(base(), "/simulation/couplings/c", both)
    assert weakenings(two, changed(base(), "/simulation/couplings/c", {**both, "direction": "one_way"})) == [
        "/simulation/couplings/c two_way -> one_way: no reaction any more"
    ]
    assert weakenings(two, base()) != []
    assert weakenings(base(), two) == []
