"""Tears: edges that open and part are a tear; a cloth that is drawn out, or whose open edges lie together, does not tear."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_cloth import PULLED_PROMPT, pulled_spec
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.categories.cloth.events import TearEvent
from worldagent.worlds.patch import parse_spec

FRAMES = 10
Frame = dict[str, Any]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A notched strip that is drawn out until it tears."""
    spec = pulled_spec(stretch=0.018, strength=20.0, frames=FRAMES, notch=True)
    return simulate(tmp_path_factory.mktemp("torn"), parse_spec({**spec, "prompt": PULLED_PROMPT}))


def judged(candidate: Candidate, **more: Any) -> Outcome:
    return evaluate(candidate, TearEvent.model_validate({"kind": "tears", "entity": "strip", **more}), (0, FRAMES - 1))


def test_a_strip_whose_edges_open_and_part_tears(run: Candidate) -> None:
    found = judged(run)
    first = next(k for k in range(FRAMES) if run.caches["cloth"].read(k)["edge/open"].any())
    assert found.status == "pass", found.explanation
    assert found.first_true_frame is not None
    assert first <= found.first_true_frame
    assert found.value == pytest.approx(found.details["torn_m"] / found.details["side_m"])
    assert judged(run, min=50.0).status == "fail"


def test_a_strip_whose_open_edges_lie_together_looks_whole(run: Candidate, tmp_path: Path) -> None:
    rest = run.caches["cloth"].read(0)["vertex/position"]

    def closed(k: int, data: Frame) -> None:
        data["vertex/position"] = rest.copy()

    found = judged(edited(run, tmp_path, "cloth", closed))
    assert (found.status, found.value) == ("fail", pytest.approx(0.0, abs=1e-9))


def test_a_strip_that_is_drawn_out_without_opening_does_not_tear(run: Candidate, tmp_path: Path) -> None:
    def held(k: int, data: Frame) -> None:
        data["edge/open"][:] = 0

    assert judged(edited(run, tmp_path, "cloth", held)).status == "fail"


def test_a_strip_that_nobody_named_tore_is_not_torn_by_another(run: Candidate) -> None:
    """Its pins draw it out; the log names no cause."""
    found = judged(run, other="post")
    assert (found.status, found.value) == ("fail", 0.0)


def test_a_strip_at_rest_throughout_does_not_tear(run: Candidate, tmp_path: Path) -> None:
    rest = run.caches["cloth"].read(0)

    def still(k: int, data: Frame) -> None:
        data.update({n: np.array(v) for n, v in rest.items()})

    assert judged(edited(run, tmp_path, "cloth", still)).status == "fail"
