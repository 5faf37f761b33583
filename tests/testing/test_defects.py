"""Every check finds its seeded defects and lets sound worlds pass (detection 100 %, false alarms 0 %)."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from worldagent.bench.machine import run_benchmark
from worldagent.server.bench_commands import BENCHMARKS
from worldagent.testing.defects import CHECKS, Mechanism, judge_one, suite_of
from worldagent.testing.defects.judge import interval

EACH_KIND = 12
MECHANISMS = 6


def _first(check: str) -> list[Mechanism]:
    """The first broken and the first sound mechanism; those of liquid_soft take minutes, and `test_liquid_soft.py` has one of each kind."""
    return [] if check == "liquid_soft" else [suite_of(check).of(broken=broken)[0] for broken in (True, False)]


# `make golden` judges this very world of every mechanism in each run of CI.
CASES = [
    pytest.param(check, m, id=f"{check}-{m.name}", marks=[] if m in _first(check) else [pytest.mark.slow])
    for check in CHECKS
    for m in suite_of(check).mechanisms
]


@pytest.mark.parametrize("check", CHECKS)
def test_a_suite_has_enough_distinct_worlds_of_each_kind(check: str) -> None:
    for broken in (True, False):
        chosen = suite_of(check).of(broken=broken)
        assert len(chosen) >= MECHANISMS
        assert sum(len(m.hand_picked) for m in chosen) >= EACH_KIND


@pytest.mark.parametrize(("check", "mechanism"), CASES)
def test_a_hand_picked_world_of_every_mechanism_is_judged_rightly(check: str, mechanism: Mechanism) -> None:
    """The least magnitude is the hardest: just over the bound, or as near to it as a sound world goes."""
    verdict = judge_one(suite_of(check).check, mechanism, mechanism.hand_picked[0], seed=1)
    text = [(r.id, r.status, r.evidence) for r in verdict.rows if r.status not in ("pass", "not_applicable")]
    assert verdict.detected if mechanism.broken else not verdict.alarm, text


@pytest.mark.slow
@pytest.mark.parametrize("check", CHECKS)
def test_a_hundred_generated_worlds_of_each_kind_are_judged_rightly(check: str) -> None:
    """Where the environment names a folder, what was measured is kept there for `docs/generate_accuracy.py --add`."""
    found = run_benchmark("defects", BENCHMARKS["defects"], checks=(check,), accepted=False, jobs=1, seed=11)
    if folder := os.environ.get("WORLDAGENT_FIGURES"):
        Path(folder, f"{check}.json").write_text(json.dumps(found))
    figures = found["checks"][check]
    assert (figures["broken"] >= 102, figures["clean"] >= 102) == (True, True)
    assert figures["missed"] == []


def test_confidence_intervals_are_those_of_clopper_and_pearson() -> None:
    """Published: 0 of 100 gives an upper limit of 3.62 %, 10 of 100 gives 4.90 to 17.62 %."""
    assert interval(0, 100) == pytest.approx((0.0, 0.0362), abs=5e-5)
    assert interval(10, 100) == pytest.approx((0.0490, 0.1762), abs=5e-5)
