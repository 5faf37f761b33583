"""Evaluators of events that happen to bodies, by kind."""

from __future__ import annotations

from collections.abc import Mapping

from ..scope import Evaluator
from . import bouncing, carrying, drifting, ending, falling, hanging, pushing, turning

__all__ = ["EVENTS"]

EVENTS: Mapping[str, Evaluator] = {
    "falls": falling.falls,
    "rises": falling.rises,
    "spins": turning.spins,
    "stops": ending.stops,
    "slows": ending.slows,
    "swings": hanging.swings,
    "jumps": bouncing.jumps,
    "drifts": drifting.drifts,
    "rolls": turning.rolls,
    "slides": turning.slides,
    "tips": turning.tips,
    "lands": falling.lands,
    "bounces": bouncing.bounces,
    "goes_uphill": falling.goes_uphill,
    "comes_loose": hanging.comes_loose,
    "opens": hanging.opens,
    "closes": hanging.closes,
    "hits": pushing.hits,
    "pushes": pushing.pushes,
    "pulls": carrying.pulls,
    "lifts": carrying.lifts,
    "lowers": carrying.lowers,
    "throws": carrying.throws,
    "rests_against": ending.rests_against,
    "jams": ending.jams,
}
