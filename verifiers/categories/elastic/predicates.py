"""Evaluators of predicates about bodies that deform."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.predicates import Deflection, Strain
from ...ledgers.strains import deflections, require_deforming, strains_of
from ...predicates.outcome import Outcome, Series, band, judge

if TYPE_CHECKING:
    from ....worlds.spec import SpecModel
    from ...predicates.scope import Scope

__all__ = ["deflection", "strain"]


def deflection(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: farthest visible point from the best fit of the rest shape."""
    assert isinstance(predicate, Deflection)
    value = deflections(scope.candidate, predicate.entity)[scope.window]
    margin, side = band(value, predicate.min, predicate.max)

    def tell(i: int) -> str:
        return f"{predicate.entity} was {value[i]:.3g} m off its rest shape at frame {scope.frames[0] + i}"

    return judge(Series(scope.frames, value, margin, "m", predicate.entity, side, tell), predicate.when)


def strain(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: largest principal strain of a tetrahedron."""
    assert isinstance(predicate, Strain)
    soft = require_deforming(scope.candidate, predicate.entity)
    value = strains_of(soft, scope.candidate.frame_count).largest[scope.window]
    margin, side = band(value, predicate.min, predicate.max)

    def tell(i: int) -> str:
        return f"{predicate.entity} was strained by {value[i]:.3g} at frame {scope.frames[0] + i}"

    return judge(Series(scope.frames, value, margin, "1", predicate.entity, side, tell), predicate.when)
