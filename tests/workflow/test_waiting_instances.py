"""A run whose instances take turns: what a later one will move is not judged while it has written no frame."""

from __future__ import annotations

from pathlib import Path

import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.simulated_worlds import simulate
from worldagent.testing.worlds.small_liquids import PROMPT, tank_spec
from worldagent.verifiers.story.phases import check
from worldagent.workflow.live_judge import judge_begun
from worldagent.worlds.begun import Begun, begun_in, unfinished
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.requirements import Row


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> Begun:
    """A tank that stands has all its frames, and the water in it, which is to collapse, has none."""
    given = tank_spec(frames=2, spacing=0.05, crate_at=None, coupled=False)
    spreads = {"kind": "spreads", "entity": "water"}
    given["story"] = {
        "beats": {"runs": {"text": "it runs", "owner": "water", "subject": "water", "frames": [0, 1], "predicate": spreads}}
    }
    spec = parse_spec({**given, "prompt": PROMPT})
    folder = WorldFolder.of(tmp_path_factory.mktemp("turns"), "tank", create=True)
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    where = folder.root / "run"
    run_frames(spec, built, where, frames=2)
    liquid = next(n for n, s in spec.simulation.solvers.items() if "water" in s.members)
    (where / liquid).rename(folder.root / "later")
    return begun_in(folder, where, spec, built)


def test_a_run_whose_liquid_waits_for_its_turn_is_not_at_its_end(begun: Begun) -> None:
    assert begun.unmoved == {"water"}
    assert unfinished(begun.candidate).endswith("wrote no frame yet: this run goes on, or ended before its first one")
    (row,) = check(begun.candidate)
    assert row.status == "unverified", "the water may still move"


def test_the_judge_of_a_running_probe_does_not_end_it_for_what_has_not_begun(begun: Begun) -> None:
    found: list[Row] = []
    judge_begun(begun.candidate, begun.unmoved, found.extend)
    assert "probe:phases" not in {row.id for row in found}


@pytest.mark.parametrize("declared", [True, False])
def test_a_body_afloat_does_not_end_its_probe_at_frame_0(tmp_path: Path, declared: bool) -> None:
    """The lift is read from the interval that ends at frame 1: at frame 0 alone the water bears nothing."""
    document = tank_spec(frames=3, spacing=0.05, crate_at=0.2)
    if declared:
        document["graph"]["relations"]["bears"] = {"kind": "supports", "a": "water", "b": "crate", "frames": [0, 2]}
    whole = simulate(tmp_path, parse_spec({**document, "prompt": PROMPT}))
    found: list[Row] = []
    for end in range(3):
        judge_begun(whole.until(end), frozenset(), found.extend)
    assert [row.id for row in found if row.check == "support"] == []
