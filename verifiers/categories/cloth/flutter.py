"""Evaluator of `flutters`: how far, how often and how fast the points of a sheet go to and fro, and how much of it does so."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ....worlds.predicates import Flutters
from ...predicates.outcome import Comparison, Outcome, vector
from .bounds import FLUTTER_NOISE, FLUTTER_ROUNDING, FLUTTER_SHARE
from .predicates import instance_run

if TYPE_CHECKING:
    from ....worlds.spec import SpecModel
    from ...predicates.scope import Scope
    from .frames import ClothRun

__all__ = ["flutters"]


@dataclass(frozen=True)
class _Points:
    """Points of a sheet and how each goes to and fro along its own main direction."""

    rows: NDArray[np.intp]
    """Rows of the channels `vertex/*`."""
    rest: F64
    """In the entity's frame (n, 3) [m]."""
    area: F64
    """That each stands for [m^2]."""
    signal: F64
    """Along its main direction about its mean (frames, n) [m]."""
    amplitude: F64
    """Half the width of its motion (n,) [m]."""
    cycles: F64
    rate: F64
    """[Hz]."""


@dataclass(frozen=True)
class _Demand:
    """One thing that is asked of a point."""

    found: F64
    """By point."""
    bound: float
    comparison: Comparison
    unit: str
    what: str

    def reached(self, among: NDArray[np.bool_], area: F64, least: float) -> float:
        """Value that the farthest, oftenest or fastest of some points reach, which stand for `least` [m^2] together."""
        places = np.flatnonzero(among)
        order = places[np.argsort(-self.found[places], kind="stable")]
        index = int(np.searchsorted(np.cumsum(area[order]), least * (1.0 - FLUTTER_ROUNDING)))
        return float(self.found[order[min(index, len(order) - 1)]])

    def kept_by(self, value: float) -> bool:
        """True if a number is as asked."""
        return value >= self.bound if self.comparison == ">=" else value <= self.bound


def _cycles(signal: F64, noise: F64) -> F64:
    """Number of times that signals (frames, n) go to and fro: half their changes of side, those within the noise (n,) left out."""
    sides = np.where(np.abs(signal) > noise, np.sign(signal), 0.0)
    last, changes = np.zeros(signal.shape[1]), np.zeros(signal.shape[1])
    for side in sides:
        changes += (side != 0.0) & (last != 0.0) & (side != last)
        last = np.where(side != 0.0, side, last)
    return 0.5 * changes


def _points(scope: Scope, run: ClothRun, p: Flutters) -> _Points:
    """The point that is asked about, or all of the sheet that nothing holds."""
    own = [piece for piece in run.pieces if piece.entity == p.entity]
    rows = np.concatenate([np.arange(piece.rows.start, piece.rows.stop) for piece in own])
    rest = np.concatenate([piece.vertices for piece in own])
    spread = np.zeros(len(run.mass))
    for piece in own:
        np.add.at(spread, piece.faces.ravel(), np.repeat(piece.area / 3.0, 3))
    if p.point is not None:
        chosen = np.array([np.linalg.norm(rest - np.array(p.point), axis=1).argmin()])
    else:
        held = np.concatenate([np.empty(0, dtype=np.int32), *(h.rows for h in run.held)])
        chosen = np.flatnonzero(~np.isin(rows, held) & (spread[rows] > 0.0))
        if not len(chosen):
            raise EvidenceError(f"pins hold every vertex of {p.entity!r}: nothing of it can flutter")
    area = spread[rows[chosen]] if p.point is None else np.ones(1)
    rows, (first, last) = rows[chosen], scope.frames
    places = np.array([run.frame(k)[0][rows] for k in range(first, last + 1)])
    away = places - places.mean(axis=0)
    main = np.linalg.eigh(np.einsum("fni,fnj->nij", away, away))[1][:, :, -1]
    signal = np.einsum("fni,ni->fn", away, main)
    amplitude = 0.5 * np.ptp(signal, axis=0)
    cycles = _cycles(signal - 0.5 * (signal.max(axis=0) + signal.min(axis=0)), FLUTTER_NOISE * amplitude)
    rate = cycles * scope.candidate.spec.simulation.fps / max(last - first, 1)
    return _Points(rows, rest[chosen], area, signal, amplitude, cycles, rate)


def _demands(points: _Points, p: Flutters) -> list[_Demand]:
    swing, rate = "{:.3g} m to and fro", "{:.3g} Hz"
    asked: tuple[tuple[F64, float | None, Comparison, str, str], ...] = (
        (points.amplitude, p.min_amplitude, ">=", "m", swing),
        (points.amplitude, p.max_amplitude, "<=", "m", swing),
        (points.cycles, p.min_cycles, ">=", "cycles", "{:g} cycles"),
        (points.rate, p.min_frequency or None, ">=", "Hz", rate),
        (points.rate, p.max_frequency, "<=", "Hz", rate),
    )
    return [_Demand(found, bound, how, unit, words) for found, bound, how, unit, words in asked if bound is not None]


def flutters(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: what a tenth of the free area reaches, or the point that is asked about; of several demands the first that is missed.

    A demand is judged among the points that reach the least of those before it, in the order amplitude, cycles, frequency: so each
    number says how far the same part of the sheet is from what is asked. Most demands are missed where a tenth goes beyond. Where all
    are met it is the amplitude.
    """
    assert isinstance(predicate, Flutters)
    p, run = predicate, instance_run(scope.candidate, predicate.entity)
    points, (first, last) = _points(scope, run, p), scope.frames
    asked, among = _demands(points, p), np.ones(len(points.rows), dtype=bool)
    least = FLUTTER_SHARE * float(points.area.sum())
    value, missed = 0.0, None
    for demand in asked:
        value = demand.reached(among, points.area, least)
        if not demand.kept_by(value):
            missed = demand
            break
        if demand.comparison == ">=":
            among = among & (demand.found >= demand.bound)
    shown = missed or asked[0]
    if missed is None:
        value = shown.reached(among, points.area, least)
    so = np.logical_and.reduce([d.found >= d.bound for d in asked if d.comparison == ">="])
    share = float(points.area[so].sum() / points.area.sum())
    best = int(np.argmax(np.where(among, shown.found, -np.inf)))
    text = _told(p, asked, f"reached {shown.what.format(value)}", share) + (
        f" at {vector(points.rest[best])} m: {points.amplitude[best]:.3g} m, {points.cycles[best]:g} times, {points.rate[best]:.3g} Hz"
    )
    moved = np.abs(points.signal[:, best] - points.signal[0, best]) >= 0.5 * points.amplitude[best]
    return Outcome(
        "pass" if missed is None else "fail",
        scope.frames,
        shown.unit,
        text,
        value=value,
        bound=shown.bound,
        comparison=shown.comparison,
        margin=value - shown.bound if shown.comparison == ">=" else shown.bound - value,
        first_true_frame=first + int(np.argmax(moved)) if missed is None else None,
        first_failing_entity=None if missed is None else p.entity,
        first_failing_frame=None if missed is None else last,
        failing=() if missed is None else (p.entity,),
        details={
            "amplitude_m": float(points.amplitude[best]),
            "cycles": float(points.cycles[best]),
            "frequency_hz": float(points.rate[best]),
            "vertex": int(points.rows[best]),
            "point": points.rest[best].tolist(),
            "share": share,
        },
    )


def _told(p: Flutters, asked: list[_Demand], found: str, share: float) -> str:
    """Sentence on the demands and the value found, up to the point that goes farthest."""
    wanted = ", ".join(f"{'at least' if d.comparison == '>=' else 'at most'} {d.what.format(d.bound)}" for d in asked)
    if p.point is not None:
        return f"a point of {p.entity} {found}; asked: {wanted};"
    return f"a tenth of what is free of {p.entity} {found}; asked: {wanted}; {share:.1%} of it moved at least so, most"
