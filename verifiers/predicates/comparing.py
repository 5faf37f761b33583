"""Evaluator of comparisons between two measurements of entities at one frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ..categories.registry import judge_of
from ..ledgers import motion
from .outcome import Outcome, Series, band, judge

if TYPE_CHECKING:
    from ...worlds.predicates import Compares
    from .scope import Scope

__all__ = ["UNITS", "compares"]

UNITS = {"height": "m", "speed": "m/s", "tilt": "rad", "size": "m", "mass": "kg", "distance_to": "m"}
"""Unit of each quantity."""


def compares(scope: Scope, p: Compares) -> Outcome:
    """Measured: the quantity of `a` less that of `b`."""
    if p.a == p.b:
        raise EvidenceError(f"{p.a!r} cannot be compared with itself")
    one, two = (_quantity(scope, name, p.quantity, p.target)[scope.window] for name in (p.a, p.b))
    value = one - two
    low, high = {"more": (p.margin, None), "less": (None, -p.margin), "same": (-p.margin, p.margin)}[p.relation]
    margin, side = band(value, low, high)
    unit, what = UNITS[p.quantity], f"distance to {p.target}" if p.quantity == "distance_to" else p.quantity

    def tell(i: int) -> str:
        frame = scope.frames[0] + i
        return f"{what} of {p.a} is {one[i]:.4g} {unit} and of {p.b} {two[i]:.4g} {unit} at frame {frame}, a difference of {value[i]:.3g}"

    return judge(Series(scope.frames, value, margin, unit, p.a, side, tell), p.when)


def _quantity(scope: Scope, entity: str, quantity: str, of: str | None) -> F64:
    """A quantity of an entity over all frames, shape (frames,).

    Raises:
        EvidenceError: nothing tells it.
    """
    candidate = scope.candidate
    judge_, contract = judge_of(candidate.spec, entity), motion.require_motion(candidate, entity)
    if quantity == "height":
        gravity = np.array(candidate.spec.simulation.gravity, dtype=np.float64)
        strength = float(np.linalg.norm(gravity))
        up = -gravity / strength if strength > 0.0 else np.array([0.0, 0.0, 1.0])
        return np.asarray(judge_.centers(candidate, entity) @ up)
    if quantity == "speed":
        return np.asarray(np.linalg.norm(judge_.velocities(candidate, entity), axis=1))
    if quantity == "tilt":
        return motion.angles(candidate, entity, np.array([0.0, 0.0, 1.0]))
    if quantity == "mass":
        return judge_.mass(candidate, entity)
    if quantity == "size":
        return np.full(candidate.frame_count, max(contract.dimensions.size))
    other = judge_of(candidate.spec, str(of)).centers(candidate, str(of))
    return np.asarray(np.linalg.norm(judge_.centers(candidate, entity) - other, axis=1))
