"""Progress before the first frame: engines that are set up, and the preroll."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_groups
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.workflow.estimates import Pace
from worldagent.worlds.patch import parse_spec


@pytest.mark.parametrize("coupled", [True, False])
def test_setting_up_and_the_preroll_are_told_before_the_first_frame(tmp_path: Path, coupled: bool) -> None:
    """A probe stood at `starting` for a minute without a word."""
    document = tank_spec(spacing=0.05, frames=2, coupled=coupled)
    document["simulation"]["preroll"] = 0.05
    spec = parse_spec({**document, "prompt": PROMPT})
    built = {name: build_entity(spec, name, tmp_path) for name in spec.entities}
    told: list[tuple[float, str]] = []
    run_groups(spec, built, tmp_path, frames=2, tell=lambda rank, done, total, text: told.append((done, text)))
    first = next(k for k, (_, text) in enumerate(told) if "water" in text and "frame 1 of 2" in text)
    before = [text for done, text in told[:first] if done == 0.0 and "water" in text]
    assert any(text.endswith("setting up the engines") for text in before)
    shares = [int(found[1]) for text in before if (found := re.search(r": (\d+)% of the preroll, in steps of ", text))]
    assert shares == sorted(shares)
    assert shares[-1] == 100


def test_what_comes_before_the_frames_is_no_part_of_their_pace(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([0.0, 100.0, 101.0, 102.0])
    monkeypatch.setattr("worldagent.workflow.estimates.time.monotonic", lambda: next(clock))
    pace = Pace(lambda *report: None)
    for done, text in ((0.0, "setting up"), (0.0, "preroll"), (1.0, "frame 1"), (2.0, "frame 2")):
        pace(done, 10.0, text)
    assert pace.seconds_per_step == pytest.approx(1.0)
    assert pace.reports == 2
