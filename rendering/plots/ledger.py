"""Line plots of a candidate's recorded quantities over time, drawn with OpenCV."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import count

import numpy as np

from ...worlds.arrays import F64, U8
from ...worlds.cache import Cache
from ...worlds.candidate import Candidate
from ...worlds.channels import QUANTITIES, RECORD
from ...worlds.errors import EvidenceError, InputError
from ..categories.registry import LAYERS
from ..drawing import Color, distinct_color, line, text, text_size
from .axes import INK, Panel, draw_axes, ticks, value_range

__all__ = ["ALWAYS", "DERIVED", "Series", "ledger_series", "plot_ledger"]

DERIVED = {"total_energy": "J", "min_gap": "m", "contacts": "1"}
"""Quantities computed here, with units: kinetic + potential energy, least gap of touching pairs, touching pairs."""
ALWAYS = ("kinetic_energy", "potential_energy", "total_energy", "momentum_x", "momentum_y", "momentum_z")
"""Plotted by default whatever the category; each layer adds its own."""
_SMALL = {"m": (1e3, "mm"), "s": (1e3, "ms"), "J": (1e3, "mJ")}


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


def _panel(members: Sequence[Series], box: tuple[int, int, int, int], seconds: float) -> Panel:
    values = np.concatenate([s.values[np.isfinite(s.values)] for s in members])
    return Panel(*box, *value_range(values, 1.0), seconds)


def _axes(image: U8, panel: Panel, unit: str, *, last: bool) -> None:
    values = ticks(panel.low, panel.high, max(2, (panel.bottom - panel.top) // 34))
    levels = [(value, f"{value:.4g}" if abs(value) > 1e-12 else "0") for value in values]
    draw_axes(image, panel, levels, height=9, gap=6, last=last)
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


def _chosen(candidate: Candidate, quantities: Sequence[str] | None) -> list[Series]:
    """Series of the quantities asked for; by default of those that are recorded."""
    if quantities is not None:
        return [ledger_series(candidate, name) for name in quantities]
    found = []
    for name in dict.fromkeys((*ALWAYS, *(q for layer in LAYERS.values() for q in layer.quantities))):
        with suppress(EvidenceError):
            found.append(ledger_series(candidate, name))
    if not found:
        raise EvidenceError("no recorded quantities to plot; call probe_sim or bake_sim")
    return found


def _scaled(members: Sequence[Series]) -> list[Series]:
    """Series of one unit, in a thousandth of it where all values are small."""
    greatest = max((float(np.nanmax(np.abs(s.values))) for s in members if np.isfinite(s.values).any()), default=0.0)
    unit = members[0].unit
    factor, shown = _SMALL[unit] if unit in _SMALL and 0 < greatest < 0.1 else (1.0, "count" if unit == "1" else unit)
    return [Series(s.name, shown, s.values * factor) for s in members]


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
        quantities: names of `worlds/channels.py` or of `DERIVED`; default energies, momentum, and what the layers of pictures
            add (gap and contacts of bodies), as far as recorded.
        width: pixels.
        height: pixels.
        title: default the world's title.

    Raises:
        EvidenceError: nothing is simulated, or a quantity asked for is not recorded.
        InputError: no such quantity.
    """
    groups: dict[str, list[Series]] = {}
    for series in _chosen(candidate, quantities):
        groups.setdefault(series.unit, []).append(series)
    fps = float(candidate.spec.simulation.fps)
    seconds = max(candidate.last_frame, 1) / fps
    image = np.full((height, width, 3), 255, dtype=np.uint8)
    head = f"{title or candidate.spec.title} - {candidate.stage}, {candidate.frame_count} frames"
    text(image, head, (8, 18), height=12, color=INK)
    top, bottom, left, right = 58, height - 44, 78, width - 178
    share = (bottom - top) / len(groups)
    shown = [_scaled(members) for members in groups.values()]
    boxes = [(left, round(top + k * share), right, round(top + (k + 1) * share) - 12) for k in range(len(shown))]
    panels = [_panel(members, box, seconds) for members, box in zip(shown, boxes, strict=True)]
    _shade_beats(image, candidate, panels, fps)
    colors = (distinct_color(k) for k in count())
    for panel, members in zip(panels, shown, strict=True):
        _axes(image, panel, members[0].unit, last=panel is panels[-1])
        for row, (series, color) in enumerate(zip(members, colors, strict=False)):
            _curve(image, panel, series, fps, color)
            y = panel.top + 12 + 16 * row
            line(image, [(right + 10, y - 4), (right + 28, y - 4)], color, thickness=3)
            text(image, series.name, (right + 33, y), height=9, color=INK)
    return image
