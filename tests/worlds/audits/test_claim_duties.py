"""Duties of claims about causes, of optional beats, of parts that are counted, of liquids and of land (R28, R66, R155)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.worlds.small_liquids import tank_spec
from worldagent.tests.stories.small_run import MARKED, PROMPT, small_spec
from worldagent.worlds.audits.claims import claim_problems
from worldagent.worlds.claim_marks import claim_operations
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec

Spec = dict[str, Any]
LAND = {"extent": [50, 50], "cell": 1, "layers": {"r": {"kind": "ramp", "rise": 1}}}
STANDS = {"text": "it stands", "predicate": {"kind": "tilts", "entity": "shelf", "max": 0.1, "when": "always"}}


def problems(spec: Spec, marked: str) -> str:
    """Problems of the claims of marked text in a world; its prompt is that text without its marks."""
    import re

    prompt = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", marked)
    made = parse_spec({**spec, "clauses": {}, "claims": {}, "spec_version": "2", "prompt": prompt})
    return "\n".join(f"{p.pointer}: {p.text}" for p in claim_problems(_claimed(made, marked)))


def _claimed(spec: WorldSpec, marked: str) -> WorldSpec:
    return apply_patch(spec, claim_operations(marked, spec))


def test_the_small_world_lacks_nothing() -> None:
    assert problems(small_spec(), MARKED) == ""


# ---------------------------------------------------------------- causes

KNOCKS = "A [ball](thing ball) [rolls off](event roll) a [shelf](thing shelf) and [knocks over](event fall) [three](count b1 b2 b3) [blocks](thing b1 b2 b3)."


def _told(**change: Any) -> Spec:
    spec = small_spec()
    each = {"kind": "falls", "entity": "each"}
    spec["story"]["beats"]["fall"] |= {
        "predicate": {"kind": "count", "entities": ["b1", "b2", "b3"], "min": 3, "predicate": each}
    }
    spec["story"]["beats"]["fall"] |= change
    return spec


def test_what_is_acted_on_has_causes() -> None:
    """Bottles that are thrown, or each tipped by a force of its own, in place of a ball that knocks them over."""
    assert problems(_told(), KNOCKS) == ""
    assert "/story/beats/fall/causes: 'knocks over' is told of 'b3', which stands behind it: ball does it" in problems(
        _told(causes=[]), KNOCKS
    )
    hits = {"kind": "hits", "entity": "ball", "other": "b3"}
    assert "/causes" not in problems(_told(causes=[], predicate=hits), KNOCKS), "the kind of event says who does it"


@pytest.mark.parametrize(
    "marked",
    [
        "A [ball](thing ball) [rolls](event roll), and from the [shelf](thing shelf) [falls](event fall) a [block](thing b3).",
        "From the [shelf](thing shelf) [falls](event fall) a [block](thing b3).",
        "The [block](thing b3) beside the [ball](thing ball) [falls](event fall).",
        "[Three](count b1 b2 b3) [blocks](thing b1 b2 b3) [fall](event fall).",
    ],
)
def test_what_a_clause_names_before_its_event_needs_no_cause(marked: str) -> None:
    spec = small_spec()
    spec["story"]["beats"]["fall"]["causes"] = []
    assert "/causes" not in problems(spec, marked)


# ---------------------------------------------------------------- optional beats

STAYS = "A [ball](thing ball) [rolls](event roll) and the [shelf](thing shelf) [stays upright]({type} {by})."


@pytest.mark.parametrize("kind", ["property", "place", "time"])
def test_words_are_not_judged_by_what_is_optional(kind: str) -> None:
    spec = small_spec()
    marked = STAYS.format(type=kind, by="/story/requirements/up")
    spec["story"]["requirements"] = {"up": {**STANDS, "mandatory": False}}
    assert "'stays upright' is judged by what is optional alone (up)" in problems(spec, marked)
    spec["story"]["requirements"] = {"up": STANDS}
    assert problems(spec, marked) == ""


def test_a_quantity_is_not_bound_in_an_optional_beat() -> None:
    spec = small_spec()
    marked = (
        "A [ball](thing ball) [rolls](event roll). A [block](thing b3) falls [15 cm](quantity /story/beats/fall/predicate/min)."
    )
    assert "optional" not in problems(spec, marked)
    spec["story"]["beats"]["fall"]["mandatory"] = False
    assert "'15 cm' is judged by what is optional alone (fall)" in problems(spec, marked)


# ---------------------------------------------------------------- parts


def _table() -> Spec:
    spec = small_spec()
    leg = {"shape": {"kind": "box", "size": [0.02, 0.02, 0.2]}}
    spec["entities"]["shelf"]["parts"] |= {f"leg{k}": {**leg, "pose": {"position": [0.1 * k, 0, 0]}} for k in range(4)}
    return spec


@pytest.mark.parametrize(
    ("words", "named", "said"),
    [
        ("four", (0, 1, 2, 3), ""),
        ("three", (0, 1, 2, 3), "'three' counts 3, by names 4 (shelf/parts/leg0, shelf/parts/leg1"),
        ("four", (0, 1, 2), "'four' counts 4, by names 3"),
    ],
)
def test_parts_of_a_body_are_counted(words: str, named: tuple[int, ...], said: str) -> None:
    by = " ".join(f"/entities/shelf/parts/leg{k}" for k in named)
    found = problems(
        _table(),
        f"A [ball](thing ball) [rolls](event roll) on a [shelf](thing shelf) with [{words}]({'count'} {by}) [legs](thing {by}).",
    )
    assert said in found
    assert bool(found) is bool(said)


STANDING = "A [ball](thing ball) [rolls](event roll) past [three](count b1 b2 b3) [blocks](thing b1 b2 b3){where}."


@pytest.mark.parametrize("where", [" [on a](place on_shelf_b1) [shelf](thing shelf)", ", which [stay](property up)"])
def test_of_what_is_counted_something_is_claimed(where: str) -> None:
    spec = small_spec()
    still = {"text": "they stand", "predicate": {"kind": "tilts", "entity": "b2", "max": 0.1, "when": "always"}}
    spec["story"]["requirements"] = {"up": still}
    assert problems(spec, STANDING.format(where=where)) == ""
    assert "nothing that is claimed says what becomes of 'three' (b1, b2, b3)" in problems(spec, STANDING.format(where=""))


# ---------------------------------------------------------------- liquids and land


@pytest.mark.parametrize(
    "marked",
    [
        "A [ball](thing ball) [rolls](event roll) into [water](thing shelf).",
        "Eine [Kugel](thing ball) [rollt](event roll) ins kalte [Wasser](thing shelf).",
        "Une [bille](thing ball) [roule](event roll) dans l'[eau froide](thing shelf).",
    ],
)
def test_painted_water_is_no_liquid(marked: str) -> None:
    assert "geometry shows no liquid" in problems(small_spec(), marked)


@pytest.mark.parametrize("words", ["water tower", "glass of milk", "oil drum", "shelf"])
def test_a_thing_that_is_only_called_after_a_liquid_is_none(words: str) -> None:
    assert problems(small_spec(), f"A [ball](thing ball) [rolls](event roll) beside a [{words}](thing shelf).") == ""


def test_a_liquid_that_an_engine_moves_is_water() -> None:
    spec = tank_spec()
    assert "geometry" not in problems(spec, "A [tank](thing tank) of [water](thing water).")
    assert "geometry" in problems(spec, "A [tank](thing water) of [water](thing tank).")


@pytest.mark.parametrize(
    ("words", "land"),
    [
        ("lake", {"hydrology": {"required": ["lake"]}}),
        ("mountain lake", {"hydrology": {"required": ["lake"]}}),
        ("river", {"hydrology": {"required": ["river"]}}),
        ("brook", {"hydrology": {"required": ["river"]}}),
        ("ocean", {"hydrology": {"required": ["sea"]}}),
        ("water", {"hydrology": {"required": ["lake"]}}),
        ("trees", {"vegetation": {}}),
    ],
)
def test_land_has_what_its_words_say(words: str, land: dict[str, Any]) -> None:
    marked = f"A [ball](thing ball) [rolls](event roll) beside the [{words}](thing land)."
    assert f"/claims/{words.replace(' ', '_')}/by: {words!r} " in problems({**small_spec(), "terrains": {"land": LAND}}, marked)
    assert problems({**small_spec(), "terrains": {"land": {**LAND, **land}}}, marked) == ""


def test_a_toy_of_a_lake_is_an_entity() -> None:
    assert problems(small_spec(), "A [ball](thing ball) [rolls](event roll) beside the [lake](thing shelf).") == ""


def test_the_prompt_of_the_small_world_is_the_one_that_is_marked() -> None:
    assert _claimed(parse_spec({**small_spec(), "prompt": PROMPT}), MARKED).prompt == PROMPT
