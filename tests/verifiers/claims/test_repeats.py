"""Counts of how often something happens: one bounce less and one more are found where they are the truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.verifiers.claims.claimed import rows

BOUNCE = {"kind": "bounces", "entity": "ball", "other": "floor"}


def row(folder: Path, words: str, *frames: tuple[int, int]) -> Any:
    beats = {f"b{k}": {"subject": "ball", "frames": list(f), "predicate": BOUNCE} for k, f in enumerate(frames)}
    pointers = [f"/story/beats/{b}" for b in beats]
    claims = {
        "ball": {"quote": "ball", "type": "thing", "by": ["/entities/ball"]},
        "bounces": {"quote": "bounces", "type": "event", "by": pointers},
        "times": {"quote": words, "type": "count", "by": pointers},
    }
    return rows(folder, "bounce", claims, beats=beats, prompt=f"The ball bounces {words} off the floor.")["times"]


@pytest.mark.parametrize(
    ("words", "frames", "status", "measured", "said"),
    [
        ("twice", [(0, 19), (20, 35)], "pass", 2.0, "b0 at frame 12, b1 at frame 28 came true"),
        ("twice", [(0, 19), (20, 26)], "fail", 1.0, "b1 did not"),
        ("three times", [(0, 14), (16, 30), (31, 35)], "fail", 2.0, "b2 did not"),
        ("one time", [(0, 19)], "fail", 2.0, "once more in frames 20..35"),
    ],
)
def test_it_happens_neither_less_nor_more_often(
    words: str, frames: list[tuple[int, int]], status: str, measured: float, said: str, tmp_path: Path
) -> None:
    """The ball bounces at frames 12 and 28."""
    found = row(tmp_path, words, *frames)
    assert (found.status, found.measured) == (status, measured)
    assert said in str(found.evidence["explanation"])
