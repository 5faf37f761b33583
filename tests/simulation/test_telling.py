"""Progress while a frame is under way: how far it is, in what steps, and that it is made again."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation import schedule
from worldagent.simulation.rigid import SolverRigid
from worldagent.simulation.runs import make_run
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.worlds.bake_plan import groups_of
from worldagent.worlds.built import BuiltEntity
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.spec import WorldSpec

FRAMES = 3


def tank(**options: Any) -> tuple[WorldSpec, dict[str, BuiltEntity]]:
    """A crate in a small tank."""
    spec = parse_spec({**tank_spec(spacing=0.05, frames=FRAMES, **options), "prompt": PROMPT})
    return spec, {n: build_entity(spec, n, Path()) for n in spec.entities}


@pytest.fixture
def overlapping(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bodies overlap at the end of every frame that is made for the first time."""
    ends = SolverRigid.end_attempt

    def end_attempt(self: SolverRigid) -> bool:
        return ends(self) and self.refined > 0

    monkeypatch.setattr(SolverRigid, "end_attempt", end_attempt)


def rising(shares: list[float]) -> bool:
    return all(a < b for a, b in itertools.pairwise(shares))


@pytest.mark.usefixtures("overlapping")
@pytest.mark.parametrize("coupled", [True, False], ids=["coupled", "alone"])
def test_a_frame_that_is_made_again_says_so(coupled: bool) -> None:
    spec, built = tank(coupled=coupled)
    settings = spec.simulation.rigid["rigid"].settings
    names = next(group for group in groups_of(spec) if "rigid" in group)
    run = make_run(spec, built, names)
    run.prepare()
    told: list[tuple[float, str]] = []
    run.advance(1, tell=lambda share, doing: told.append((share, doing)))
    words = f"made again with rigid steps of {500 * settings.step:.3g} ms (1 of at most {settings.refine} times)"
    first, again = ([share for share, doing in told if (words in doing) == repeat] for repeat in (False, True))
    assert again
    assert rising(first)
    assert rising(again)
    assert not coupled or first[-1] == again[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("coupled", [True, False], ids=["coupled", "one-way"])
def test_a_slow_frame_tells_how_far_it_is_and_can_be_stopped(
    coupled: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(schedule, "SLOW_FRAME_SECONDS", 0.0)
    spec, built = tank(coupled=coupled)
    told: list[tuple[float, str]] = []
    looks: list[int] = []

    def progress(done: float, total: float, text: str) -> None:
        told.append((done / total, text))

    schedule.run_frames(spec, built, tmp_path, frames=FRAMES, progress=progress, check=lambda: looks.append(len(told)))
    who = "rigid and water" if coupled else "water"
    within = [
        (share, text) for share, text in told if text.startswith(f"{who}: ") and f"of frame 2 of {FRAMES}, in steps of" in text
    ]
    assert len(within) > 2
    assert rising([share for share, _ in within])
    reached = {text: share for share, text in told}
    assert within[0][0] > reached[f"{who}: frame 1 of {FRAMES}"]
    assert within[-1][0] == pytest.approx(reached[f"{who}: frame 2 of {FRAMES}"])
    assert set(range(1, len(told))) <= set(looks)
