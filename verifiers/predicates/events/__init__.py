"""Evaluators of events that happen to bodies, by kind."""

from __future__ import annotations

from collections.abc import Mapping

from ..scope import Evaluator
from . import ending, falling, pushing, turning

__all__ = ["EVENTS"]

EVENTS: Mapping[str, Evaluator] = {
    "falls": falling.falls,
    "rises": falling.rises,
    "spins": turning.spins,
    "stops": ending.stops,
    "rolls": turning.rolls,
    "slides": turning.slides,
    "tips": turning.tips,
    "lands": falling.lands,
    "hits": pushing.hits,
    "pushes": pushing.pushes,
}
