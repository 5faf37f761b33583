"""Which of two predicates asks for more: members that come and go at any place, and what turns the direction (R157)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.patch import apply_patch, parse_spec, weakenings
from worldagent.worlds.spec import WorldSpec

FALL = "/story/beats/fall"
TOLD = [f"{FALL}/predicate loosened or replaced"]


def changed(pointer: str, value: Any) -> WorldSpec:
    return apply_patch(parse_spec({**small_spec(), "prompt": PROMPT}), [{"op": "add", "path": pointer, "value": value}])


def with_predicate(predicate: dict[str, Any]) -> WorldSpec:
    return changed(f"{FALL}/predicate", predicate)


def band(kind: str, **bounds: Any) -> dict[str, Any]:
    return {"kind": kind, "entity": "b3", **bounds}


def both(*members: dict[str, Any]) -> dict[str, Any]:
    return {"kind": "and", "of": [*members]}


def either(*members: dict[str, Any]) -> dict[str, Any]:
    return {"kind": "or", "of": [*members]}


SPEED = band("speed", min=0.5)
TILTS = band("tilts", min=1)
DENIED = {"kind": "not", "predicate": {"kind": "topples", "entity": "b2"}}

# (harder, easier): going from left to right weakens, going from right to left does not
PREDICATES: list[tuple[dict[str, Any], dict[str, Any]]] = [
    (both(TILTS, SPEED), both(SPEED)),
    (both(TILTS, SPEED), SPEED),
    (both(band("speed", min=0.6), TILTS, band("speed", max=2)), both(band("speed", max=3), SPEED)),
    (either(TILTS), either(SPEED, TILTS)),
    (SPEED, either(TILTS, SPEED)),
    (either(SPEED, DENIED), either(TILTS, DENIED, SPEED)),
    ({"kind": "not", "predicate": SPEED}, {"kind": "not", "predicate": both(TILTS, SPEED)}),
    ({"kind": "not", "predicate": either(TILTS, SPEED)}, {"kind": "not", "predicate": SPEED}),
    (both(DENIED, {"kind": "not", "predicate": SPEED}), {"kind": "not", "predicate": SPEED}),
    (both(both(TILTS, DENIED), SPEED), both(SPEED, TILTS)),
    (both(TILTS, SPEED), either(DENIED, both(SPEED, TILTS))),
    (both(SPEED, TILTS), either(SPEED, TILTS)),
    ({"kind": "always", "predicate": both(TILTS, SPEED)}, {"kind": "always", "predicate": SPEED}),
    ({"kind": "until", "hold": both(TILTS, SPEED), "goal": DENIED}, {"kind": "until", "hold": SPEED, "goal": DENIED}),
    ({"kind": "until", "hold": SPEED, "goal": both(TILTS, SPEED)}, {"kind": "until", "hold": SPEED, "goal": SPEED}),
    ({"kind": "count", "entities": ["b1", "b2"], "min": 1, "predicate": both({**TILTS, "entity": "each"}, {**SPEED, "entity": "each"})},
     {"kind": "count", "entities": ["b1", "b2"], "min": 1, "predicate": {**SPEED, "entity": "each"}}),
]  # fmt: skip

# neither direction is harmless
EITHER_WAY: list[tuple[dict[str, Any], dict[str, Any]]] = [
    (both(SPEED, TILTS), both(SPEED, DENIED)),
    (both(TILTS, SPEED), {"kind": "not", "predicate": SPEED}),
    ({"kind": "after", "beat": "strike", "predicate": SPEED}, {"kind": "after", "beat": "strike", "predicate": both(TILTS, SPEED)}),
    ({"kind": "count", "entities": ["b1", "b2"], "max": 1, "predicate": SPEED},
     {"kind": "count", "entities": ["b1", "b2"], "max": 1, "predicate": both(TILTS, SPEED)}),
    ({"kind": "until", "hold": TILTS, "goal": SPEED}, {"kind": "until", "hold": TILTS, "goal": either(DENIED, SPEED)}),
]  # fmt: skip

# both ask for the same
ALIKE: list[tuple[dict[str, Any], dict[str, Any]]] = [
    (both(SPEED, TILTS), both(TILTS, SPEED)),
    (either(SPEED, TILTS), either(TILTS, SPEED, SPEED)),
    (both(SPEED), SPEED),
    (both(both(SPEED, TILTS), DENIED), both(TILTS, both(DENIED, SPEED))),
]


@pytest.mark.parametrize(("hard", "easy"), PREDICATES)
def test_more_members_of_an_and_and_fewer_of_an_or_ask_for_more(hard: dict[str, Any], easy: dict[str, Any]) -> None:
    strict, loose = with_predicate(hard), with_predicate(easy)
    assert weakenings(strict, loose) == TOLD
    assert weakenings(loose, strict) == []


@pytest.mark.parametrize(("one", "other"), EITHER_WAY)
def test_what_cannot_be_told_counts_as_replaced(one: dict[str, Any], other: dict[str, Any]) -> None:
    assert weakenings(with_predicate(one), with_predicate(other)) == TOLD
    assert weakenings(with_predicate(other), with_predicate(one)) == TOLD


@pytest.mark.parametrize(("one", "other"), ALIKE)
def test_the_same_in_another_order_asks_for_as_much(one: dict[str, Any], other: dict[str, Any]) -> None:
    assert weakenings(with_predicate(one), with_predicate(other)) == []
    assert weakenings(with_predicate(other), with_predicate(one)) == []


@pytest.mark.parametrize("never", [False, True])
def test_what_must_never_be_is_denied_more_with_fewer_members(never: bool) -> None:
    def asked(predicate: dict[str, Any]) -> WorldSpec:
        return changed("/story/requirements/still", {"text": "t", "predicate": predicate, "never": never})

    alone, more = asked(SPEED), asked(both(TILTS, SPEED))
    told = ["/story/requirements/still/predicate loosened or replaced"]
    assert weakenings(alone, more) == (told if never else [])
    assert weakenings(more, alone) == ([] if never else told)


def test_what_would_take_long_to_compare_counts_as_replaced() -> None:
    """64 times 64 predicates in another order: the rest of each pair is looked at before it is known to be another."""
    few, many = (
        [either(*(band("speed", min=m + k / 100 + 0.1, max=m + k / 100 + 0.1) for k in range(n))) for m in range(n)]
        for n in (8, 64)
    )
    for members, told in ((few, []), (many, TOLD)):
        turned = both(*(either(*reversed(m["of"])) for m in reversed(members)))
        assert weakenings(with_predicate(both(*members)), with_predicate(turned)) == told
