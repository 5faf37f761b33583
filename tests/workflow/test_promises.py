"""A bake owes its probe the same beats at the same frames, or after a coarser probe about then and in the same order."""

from __future__ import annotations

import pytest
from worldagent.workflow.promises import broken_promises

PROMISED = {"lifts": 10, "bursts": 14, "floods": 40, "dries": None}


@pytest.mark.parametrize(
    ("change", "exact", "coarse"),
    [
        ({}, [], []),
        ({"bursts": 15}, ["bursts"], []),
        ({"floods": 46}, ["floods"], []),
        ({"floods": 47}, ["floods"], ["floods"]),
        ({"bursts": None}, ["bursts"], ["bursts"]),
        ({"dries": 50}, ["dries"], ["dries"]),
        ({"lifts": 12, "bursts": 12}, ["bursts", "lifts"], []),
        ({"lifts": 12, "bursts": 11}, ["bursts", "lifts"], ["bursts", "lifts"]),
    ],
)
def test_promises_are_kept_to_the_frame_or_about_and_in_order(
    change: dict[str, int | None], exact: list[str], coarse: list[str]
) -> None:
    found = {**PROMISED, **change}
    assert broken_promises(PROMISED, found, coarse=False) == exact
    assert broken_promises(PROMISED, found, coarse=True) == coarse


def test_a_beat_that_the_bake_lacks_is_a_broken_promise() -> None:
    assert broken_promises({"lifts": 10}, {}, coarse=True) == ["lifts"]
