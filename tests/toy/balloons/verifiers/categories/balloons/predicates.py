"""Evaluator of the predicate about balloons."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...predicates.outcome import Outcome, Series, band, judge
from ..registry import judge_of

if TYPE_CHECKING:
    from ....worlds.categories.balloons.models import Ascends
    from ...predicates.scope import Scope

__all__ = ["ascends"]


def ascends(scope: Scope, predicate: Ascends) -> Outcome:
    """Measured: mean height gained since frame 0."""
    name = predicate.entity
    height = judge_of(scope.candidate.spec, name).centers(scope.candidate, name)[:, 2]
    value = (height - height[0])[scope.window]
    margin, side = band(value, predicate.min, predicate.max)

    def tell(i: int) -> str:
        return f"{name} has risen by {value[i]:.4g} m at frame {scope.frames[0] + i}"

    return judge(Series(scope.frames, value, margin, "m", name, side, tell), predicate.when)
