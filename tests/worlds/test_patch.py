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
REGION = {"kind": "sphere", "center": [0, 0, 0], "radius": 0.1}


def base() -> WorldSpec:
    return parse_spec({**small_spec(), "prompt": PROMPT})


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
        ("/clauses/c1", {"met_by": ["/entities/ball"]}, {"unmet": "too hard"}),
        ("/clauses/c1/met_by", ["/entities/ball", "/story/beats/roll"], ["/entities/ball"]),
        ("/clauses/c1", {"met_by": []}, {"met_by": [], "static_because": "the words name a thing"}),
        ("/shots/only/covers", ["roll", "strike", "fall"], ["roll", "strike"]),
        ("/shots/only/subjects", ["ball", "b3"], ["b3"]),
        ("/entities/b1/motion", "dynamic", "static"),
        ("/entities/b1/parts/body/collides", True, False),
    ],
)
def test_one_way_changes(pointer: str, hard: Any, easy: Any) -> None:
    strict, loose = changed(base(), pointer, hard), changed(base(), pointer, easy)
    assert len(weakenings(strict, loose)) == 1
    assert weakenings(loose, strict) == []


@pytest.mark.parametrize(
    ("pointer", "one", "other"),
    [
        (f"{FALL}/frames", [4, 24], [4, 30]),
        (f"{FALL}/margins", {"strike": {"value": 0.3}}, {"strike": {"frames": 3}}),
        ("/story/robustness/r", ROBUST, FINER),
        ("/story/robustness/r", ROBUST, {**ROBUST, "seed": 1}),
        ("/story/robustness/r", ROBUST, {**ROBUST, "entities": ["ball"]}),
        (f"{FALL}/subject", "b3", "b2"),
        ("/graph/relations/on_shelf_b1/frames", [0, 0], [0, 3]),
        ("/graph/relations/hits/ratio", [0.1, 10], [0.01, 100]),
        ("/graph/regions/goal", REGION, {**REGION, "radius": 0.2}),
        ("/materials/steel/substance", "steel", "other"),
        ("/entities/b1/nominal_diagonal", 0.08, 0.2),
    ],
)
def test_changes_that_may_help_either_way(pointer: str, one: Any, other: Any) -> None:
    first, second = changed(base(), pointer, one), changed(base(), pointer, other)
    assert weakenings(first, second)
    assert weakenings(second, first)


def test_repairs_of_the_scene_or_the_solver_are_no_weakening() -> None:
    for pointer, value in (
        ("/entities/ball/pose/position", [-0.1, 0, 0.321]),
        ("/entities/ball/physics/mass", 0.4),
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
    spec = changed(
        spec, "/graph/relations/glue", {"kind": "fastened", "a": "b1", "b": "b2", "max_depth": 0.1, "reason": "glued fast"}
    )
    assert weakenings(base(), spec) == ["/graph/relations/glue: overlap of b1 and b2 declared intended"]
    assert weakenings(spec, base()) == ["/story/requirements/still removed"]
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
