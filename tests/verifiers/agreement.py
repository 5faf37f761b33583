"""Judges predicates as the verifiers do, and holds that the numbers of every outcome say what its status says."""

from __future__ import annotations

from typing import Any

from worldagent.verifiers.predicates import evaluators
from worldagent.verifiers.predicates.outcome import Outcome

__all__ = ["agrees", "evaluate"]


def agrees(outcome: Outcome) -> None:
    """Measured, comparison, bound and margin of an outcome do not contradict its status."""
    if outcome.status == "unverified" or outcome.value is None or outcome.bound is None:
        return
    assert outcome.comparison in (">=", "<="), outcome
    held = outcome.value >= outcome.bound if outcome.comparison == ">=" else outcome.value <= outcome.bound
    assert held == (outcome.status == "pass"), outcome
    assert outcome.margin is None or (outcome.margin >= 0) == held, outcome


def evaluate(*args: Any, **more: Any) -> Outcome:
    """As `verifiers.predicates.evaluators.evaluate`, looked at."""
    outcome = evaluators.evaluate(*args, **more)
    agrees(outcome)
    return outcome
