"""Line plots of a candidate's recorded quantities over time, drawn with OpenCV."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...worlds.arrays import F64, U8
from ...worlds.cache import Cache
from ...worlds.candidate import Candidate
from ...worlds.channels import QUANTITIES, RECORD
from ...worlds.errors import EvidenceError, InputError
from ..drawing import Color, distinct_color, line, text, text_size

__all__ = ["DEFAULT_QUANTITIES", "DERIVED", "GRID", "INK", "Panel", "Series", "ledger_series", "plot_ledger", "ticks"]

DERIVED = {"total_energy": "J", "min_gap": "m", "contacts": "1"}
"""Quantities computed here, with units: kinetic + potential energy, least gap of touching pairs, touching pairs."""
DEFAULT_QUANTITIES = (
    "kinetic_energy",
    "potential_energy",
    "total_energy",
    "momentum_x",
    "momentum_y",
    "momentum_z",
    "min_gap",
    "contacts",
)
_SMALL = {"m": (1e3, "mm"), "s": (1e3, "ms"), "J": (1e3, "mJ")}
INK: Color = (40, 40, 40)
GRID: Color = (225, 225, 225)


@dataclass(frozen=True)
class Series:
    """One quantity over all frames; NaN where it has no value."""

    name: str
    unit: str
    values: F64


def _record(caches: Sequence[Cache], name: str, count: int) -> F64:
    """One quantity of all solver instances: their sum, or the extreme of them."""
    return np.asarray(QUANTITIES[name].combined([c.series(RECORD + name)[:count].reshape(count) for c in caches]))


def ledger_series(candidate: Candidate, quantity: str) -> Series:
    """One recorded or derived quantity of all solver instances over the frames.

    Raises:
        EvidenceError: nothing is baked, or the caches lack the quantity.
        InputError: no such quantity.
    """
    if quantity not in QUANTITIES and quantity not in DERIVED:
        raise InputError(f"no quantity {quantity!r}; known are {sorted([*QUANTITIES, *DERIVED])}")
    caches, count = list(candidate.caches.values()), candidate.frame_count
    if not caches:
        raise EvidenceError("nothing is simulated yet, so there is nothing to plot; call probe_sim")
    rigid = list(candidate.rigid_caches.values())
    if quantity == "total_energy":
        values = _record(caches, "kinetic_energy", count) + _record(caches, "potential_energy", count)
    elif quantity in ("min_gap", "contacts"):
        channel = "contact/min_gap"
        frames = [[np.asarray(f[channel]) for f in c.ragged(channel)[:count]] for c in rigid]
        per_frame = [np.concatenate([f[k] for f in frames] or [np.zeros(0)]) for k in range(count)]
        if quantity == "contacts":
            values = np.array([len(f) for f in per_frame], dtype=np.float64)
        else:
            values = np.array([f.min() if len(f) else math.nan for f in per_frame], dtype=np.float64)
    else:
        writers = candidate.written_by(QUANTITIES[quantity])
        if not writers:
            raise EvidenceError(f"no solver instance of this world records {quantity!r}")
        values = _record(writers, quantity, count)
    unit = DERIVED.get(quantity) or QUANTITIES[quantity].unit
    return Series(quantity, unit, values)


def ticks(low: float, high: float, most: int) -> list[float]:
    """Round numbers (1, 2, 5 times a power of ten) within [low, high]."""
    raw = max(high - low, 1e-300) / max(most, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(m * power for m in (1, 2, 5, 10) if m * power >= raw * 0.999)
    return [k * step for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


@dataclass(frozen=True)
class Panel:
    """One set of axes: pixel box and value range."""

    left: int
    top: int
    right: int
    bottom: int
    low: float
    high: float
    seconds: float

    def x(self, time: float) -> float:
        """Column [px] of a time [s]."""
        return self.left + (self.right - self.left) * time / self.seconds

    def y(self, value: float) -> float:
        """Row [px] of a value."""
        return self.bottom - (self.bottom - self.top) * (value - self.low) / (self.high - self.low)


def _panel(members: Sequence[Series], box: tuple[int, int, int, int], seconds: float) -> Panel:
    values = np.concatenate([s.values[np.isfinite(s.values)] for s in members])
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    if low > 0 and low < 0.5 * high:
        low = 0.0
    margin = 0.06 * (high - low) if high > low else max(abs(high), 1.0) * 0.5
    return Panel(*box, low if low == 0.0 and high > 0 else low - margin, high + margin, seconds)


def _axes(image: U8, panel: Panel, unit: str, *, last: bool) -> None:
    for value in ticks(panel.low, panel.high, max(2, (panel.bottom - panel.top) // 34)):
        y = panel.y(value)
        line(image, [(panel.left, y), (panel.right, y)], GRID)
        words = f"{value:.4g}" if abs(value) > 1e-12 else "0"
        text(image, words, (panel.left - 6 - text_size(words, 9)[0], y + 4), height=9, color=INK)
    for time in ticks(0.0, panel.seconds, 10):
        x = panel.x(time)
        line(image, [(x, panel.top), (x, panel.bottom)], GRID)
        if last:
            words = f"{time:.4g}"
            text(image, words, (x - text_size(words, 9)[0] / 2, panel.bottom + 16), height=9, color=INK)
    corners = [(panel.left, panel.top), (panel.right, panel.top), (panel.right, panel.bottom), (panel.left, panel.bottom)]
    line(image, corners, (120, 120, 120), closed=True)
    text(image, f"[{unit}]", (8, panel.top + 10), height=10, color=INK)
    if last:
        text(image, "time [s]", ((panel.left + panel.right) / 2 - 24, panel.bottom + 34), height=10, color=INK)


def _curve(image: U8, panel: Panel, series: Series, fps: float, color: Color) -> None:
    """Polyline, broken where values are missing; lone values become dots."""
    import cv2

    finite = np.isfinite(series.values)
    points = [(panel.x(k / fps), panel.y(v)) for k, v in enumerate(series.values)]
    start = 0
    while start < len(points):
        if not finite[start]:
            start += 1
            continue
        stop = start
        while stop < len(points) and finite[stop]:
            stop += 1
        if stop - start == 1:
            cv2.circle(image, (round(points[start][0]), round(points[start][1])), 2, color, -1, cv2.LINE_AA)
        else:
            line(image, points[start:stop], color, thickness=2)
        start = stop


def _shade_beats(image: U8, candidate: Candidate, panels: Sequence[Panel], fps: float) -> None:
    """Tint each beat's interval in every panel; names above the first one, in two rows."""
    row_end = [-1.0, -1.0]
    beats = sorted(candidate.spec.story.beats.items(), key=lambda b: b[1].frames)
    for k, (name, beat) in enumerate(beats):
        tint = np.array(distinct_color(k), dtype=np.float64)
        for panel in panels:
            left = round(max(panel.x(beat.frames[0] / fps), panel.left))
            right = round(min(max(panel.x(beat.frames[1] / fps), left + 2), panel.right))
            if left < panel.right:
                spot = image[panel.top : panel.bottom, left:right]
                spot[:] = (0.86 * spot + 0.14 * tint).astype(np.uint8)
        at = max(panels[0].x(beat.frames[0] / fps), panels[0].left)
        row = 0 if at >= row_end[0] else 1
        if at >= row_end[row] and at < panels[0].right - 10:
            ink = tuple(round(c * 0.6) for c in distinct_color(k))
            text(image, name, (at, 36 + 13 * row), height=9, color=(ink[0], ink[1], ink[2]))
            row_end[row] = at + text_size(name, 9)[0] + 8


def plot_ledger(
    candidate: Candidate,
    quantities: Sequence[str] | None = None,
    *,
    width: int = 1000,
    height: int = 600,
    title: str | None = None,
) -> U8:
    """Plot quantities over time, one panel per unit, with the beats' intervals shaded.

    Args:
        candidate: a probed or baked candidate.
        quantities: names of `worlds/channels.py` or of `DERIVED`; default energies, momentum, gap and contacts, as
            far as recorded.
        width: pixels.
        height: pixels.
        title: default the world's title.

    Raises:
        EvidenceError: nothing is simulated, or a quantity asked for is not recorded.
        InputError: no such quantity.
    """
    if quantities is None:
        found = []
        for name in DEFAULT_QUANTITIES:
            try:
                found.append(ledger_series(candidate, name))
            except EvidenceError:
                continue
        if not found:
            raise EvidenceError("no recorded quantities to plot; call probe_sim or bake_sim")
    else:
        found = [ledger_series(candidate, name) for name in quantities]
    fps = float(candidate.spec.simulation.fps)
    seconds = max(candidate.last_frame, 1) / fps
    groups: dict[str, list[Series]] = {}
    for series in found:
        groups.setdefault(series.unit, []).append(series)
    image = np.full((height, width, 3), 255, dtype=np.uint8)
    text(
        image,
        f"{title or candidate.spec.title} - {candidate.stage}, {candidate.frame_count} frames",
        (8, 18),
        height=12,
        color=INK,
    )
    top, bottom, left, right = 58, height - 44, 78, width - 178
    share = (bottom - top) / len(groups)
    panels, labelled = [], []
    for k, (unit, raw) in enumerate(groups.items()):
        greatest = max((float(np.nanmax(np.abs(s.values))) for s in raw if np.isfinite(s.values).any()), default=0.0)
        factor, shown = _SMALL[unit] if unit in _SMALL and 0 < greatest < 0.1 else (1.0, "count" if unit == "1" else unit)
        members = [Series(s.name, shown, s.values * factor) for s in raw]
        box = (left, round(top + k * share), right, round(top + (k + 1) * share) - 12)
        panels.append(_panel(members, box, seconds))
        labelled.append((members, shown))
    _shade_beats(image, candidate, panels, fps)
    index = 0
    for panel, (members, unit) in zip(panels, labelled, strict=True):
        _axes(image, panel, unit, last=panel is panels[-1])
        for row, series in enumerate(members):
            color = distinct_color(index)
            index += 1
            _curve(image, panel, series, fps, color)
            y = panel.top + 12 + 16 * row
            line(image, [(right + 10, y - 4), (right + 28, y - 4)], color, thickness=3)
            text(image, series.name, (right + 33, y), height=9, color=INK)
    return image
