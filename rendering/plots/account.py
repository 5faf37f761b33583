"""Picture of an account: energies and momenta per entity, sources and sinks, what has no source, and the contacts that begin."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...worlds.accounts import Account
from ...worlds.arrays import F64, U8
from ...worlds.candidate import Candidate
from ..drawing import Color, distinct_color, line, text, text_size
from .axes import FLOOR, INK, Panel, draw_axes, ticks, value_range

__all__ = ["plot_account"]

MOST = 5
"""Entities with a curve of their own per panel; the others are summed."""
MARK: Color = (150, 90, 200)
BOUND: Color = (200, 30, 30)
NOTHING: Color = (120, 120, 120)
LABEL = 10.0
"""Height of capitals [pixels]."""
_LEFT, _RIGHT, _HEAD, _FOOT, _GAP = 92, 236, 82, 46, 30


@dataclass(frozen=True)
class _Curve:
    name: str
    values: F64
    color: Color
    steps: bool = False
    """Belongs to intervals: drawn as steps."""
    thickness: int = 2


@dataclass(frozen=True)
class _Chart:
    title: str
    unit: str
    curves: tuple[_Curve, ...]
    log: bool = False
    bound: float | None = None


def _ranked(names: Sequence[str], values: F64) -> list[_Curve]:
    """Curves of the entities with the largest range, each in its own colour, and the sum of the others; values (n, E)."""
    span = np.ptp(values, axis=0)
    order = np.argsort(-span, kind="stable")
    chosen = order[: MOST if len(order) > MOST + 1 else MOST + 1]
    curves = [_Curve(names[i], values[:, i], distinct_color(int(i))) for i in chosen]
    others = order[len(chosen) :]
    if len(others):
        curves.append(_Curve(f"{len(others)} others", values[:, others].sum(axis=1), NOTHING))
    return curves


def _charts(account: Account) -> list[_Chart]:
    energy = account.kinetic + account.potential
    potential = account.potential.sum(axis=1)
    potential = potential - potential.min()
    kinetic = account.kinetic.sum(axis=1)
    totals = [
        _Curve("kinetic", kinetic, distinct_color(0)),
        _Curve("potential", potential, distinct_color(1)),
        _Curve("total", kinetic + potential + account.elastic, (40, 40, 40)),
    ]
    if np.ptp(account.elastic) > 0 or account.elastic.any():
        totals.append(_Curve("elastic", account.elastic, distinct_color(2)))
    if account.work.any():
        totals.append(_Curve("driver work", account.work, distinct_color(5)))
        totals.append(_Curve("total - work", kinetic + potential + account.elastic - account.work, distinct_color(3)))
    names = account.entities
    speed = np.linalg.norm(account.momentum, axis=2)
    spin = np.linalg.norm(account.angular_momentum, axis=2)
    causes = [
        _Curve(name, np.linalg.norm(given, axis=2).sum(axis=1), distinct_color(k), steps=True)
        for k, (name, given) in enumerate(account.sources.items())
        if given.any()
    ]
    causes.append(_Curve("logged contacts", account.contact.sum(axis=1), (40, 40, 40), steps=True, thickness=1))
    known = account.unexplained[:, np.isfinite(account.unexplained).any(axis=0)]
    worst = np.full(len(account.unexplained), np.nan)
    if known.size:
        some = np.isfinite(known).any(axis=1)
        worst[some] = np.nanmax(known[some], axis=1)
    charts = [
        _Chart("energy, all entities", "J", tuple(totals)),
        _Chart("energy per entity (from its least)", "J", tuple(_ranked(names, energy - energy.min(axis=0)))),
        _Chart("momentum per entity", "kg m/s", tuple(_ranked(names, speed))),
    ]
    if spin.max(initial=0.0) > 1e-12:
        charts.append(_Chart("angular momentum per entity", "kg m2/s", tuple(_ranked(names, spin))))
    charts.append(_Chart("impulse per frame by source", "N s", tuple(causes)))
    over = np.nanmax(worst, initial=0.0) > account.bound
    whose = (
        names[int(np.argmax(np.nan_to_num(account.unexplained, nan=-1.0).max(axis=0, initial=-1.0)))]
        if over
        else "largest of all"
    )
    residual = _Curve(whose, np.maximum(worst, FLOOR), BOUND if over else INK, steps=True)
    charts.append(_Chart("velocity change without a source", "m/s", (residual,), log=True, bound=account.bound))
    return charts


def _panel_of(chart: _Chart, box: tuple[int, int, int, int], seconds: float) -> Panel:
    values = np.concatenate([c.values[np.isfinite(c.values)] for c in chart.curves] + [np.zeros(0)])
    if chart.log:
        top = max(float(values.max(initial=FLOOR)), (chart.bound or FLOOR) * 10)
        return Panel(*box, math.log10(FLOOR), math.ceil(math.log10(top)), seconds, log=True)
    return Panel(*box, *value_range(values, 1e-9), seconds)


def _levels(panel: Panel) -> list[tuple[float, str]]:
    """Values of the horizontal lines, with their words."""
    tall = panel.bottom - panel.top
    if panel.log:
        every = max(1, math.ceil(12 * 28 / tall / 3))
        powers = [v for v in range(math.ceil(panel.low), math.floor(panel.high) + 1) if v % every == 0]
        return [(10.0**v, f"1e{v:g}") for v in powers]
    least = 1e-12 * max(abs(panel.low), abs(panel.high))
    return [(v, f"{v:.4g}" if abs(v) > least else "0") for v in ticks(panel.low, panel.high, max(2, tall // 28))]


def _frame(image: U8, panel: Panel, chart: _Chart, *, last: bool) -> None:
    draw_axes(image, panel, _levels(panel), height=LABEL, gap=8, last=last)
    text(image, f"{chart.title} [{chart.unit}]", (panel.left, panel.top - 7), height=LABEL, color=INK)
    if last:
        words = "time [s]"
        text(
            image,
            words,
            ((panel.left + panel.right - text_size(words, LABEL)[0]) / 2, panel.bottom + 36),
            height=LABEL,
            color=INK,
        )


def _draw(image: U8, axes: Panel, curve: _Curve, duration: float) -> None:
    """Polyline over frames, or steps over intervals; broken where values are missing."""
    run: list[tuple[float, float]] = []
    for k, value in enumerate([*curve.values.tolist(), math.nan]):
        if not math.isfinite(value):
            if len(run) > 1:
                line(image, run, curve.color, thickness=curve.thickness)
            run = []
            continue
        y = axes.y(value)
        run += [(axes.x(k * duration), y), (axes.x((k + 1) * duration), y)] if curve.steps else [(axes.x(k * duration), y)]


def _fit(words: str, wide: float) -> str:
    """Shortened with `..` to fit a width in pixels."""
    shown = words
    while shown and text_size(shown, LABEL)[0] > wide:
        shown = shown[:-1]
    return words if shown == words else shown[:-2] + ".."


def _legend(image: U8, axes: Panel, chart: _Chart) -> None:
    rows = max(1, (axes.bottom - axes.top) // 16)
    wide = image.shape[1] - axes.right - 50
    for row, curve in enumerate(chart.curves[:rows]):
        y = axes.top + 11 + 16 * row
        finite = curve.values[np.isfinite(curve.values)]
        peak = "  not decidable"
        if len(finite):
            peak = f"  max below {FLOOR:g}" if chart.log and finite.max() <= FLOOR else f"  max {finite.max():.3g}"
        line(image, [(axes.right + 12, y - 4), (axes.right + 30, y - 4)], curve.color, thickness=3)
        text(image, _fit(curve.name, wide - text_size(peak, LABEL)[0]) + peak, (axes.right + 36, y), height=LABEL, color=INK)
    if chart.bound is not None:
        y = axes.top + 11 + 16 * len(chart.curves)
        line(image, [(axes.right + 12, y - 4), (axes.right + 30, y - 4)], BOUND, thickness=2)
        text(image, f"bound {chart.bound:g}", (axes.right + 36, y), height=LABEL, color=INK)


def _mark_events(image: U8, account: Account, panels: Sequence[Panel]) -> None:
    """A thin line per contact that begins; names above the first panel, as far as there is room for them."""
    ends = [-1.0, -1.0]
    for mark in account.events:
        if mark.time > panels[0].seconds:
            continue
        x = panels[0].x(mark.time)
        for axes in panels:
            line(image, [(x, axes.top), (x, axes.bottom)], MARK)
        wide = text_size(mark.name, LABEL)[0]
        row = next((r for r, end in enumerate(ends) if x > end), None)
        if row is not None and x + wide < image.shape[1] - 8:
            text(image, mark.name, (x, 36 + 14 * row), height=LABEL, color=MARK)
            ends[row] = x + wide + 10


def plot_account(
    candidate: Candidate, account: Account, *, width: int = 1200, height: int = 1000, title: str | None = None
) -> U8:
    """Plot an account: one panel per quantity, contacts that begin as vertical lines.

    Args:
        candidate: whose account it is.
        account: from the verifiers.
        width: pixels, at least 700.
        height: pixels, at least 600.
        title: default the world's title.
    """
    width, height = max(width, 700), max(height, 600)
    image = np.full((height, width, 3), 255, dtype=np.uint8)
    head = f"{title or candidate.spec.title} - {candidate.stage}, {len(account.times)} frames, {len(account.entities)} moving entities, "
    text(image, _fit(head + f"{account.mass.sum():.4g} kg", width - 16), (8, 18), height=12, color=INK)
    charts = _charts(account)
    seconds = max(float(account.times[-1]), 1e-9)
    duration = float(account.times[1] - account.times[0]) if len(account.times) > 1 else 1.0
    share = (height - _HEAD - _FOOT + _GAP - 12) / len(charts)
    panels = []
    for k, chart in enumerate(charts):
        top = round(_HEAD + k * share)
        panels.append(_panel_of(chart, (_LEFT, top, width - _RIGHT, round(top + share - _GAP)), seconds))
    for axes, chart in zip(panels, charts, strict=True):
        _frame(image, axes, chart, last=axes is panels[-1])
    _mark_events(image, account, panels)
    for axes, chart in zip(panels, charts, strict=True):
        if chart.bound is not None:
            line(image, [(axes.left, axes.y(chart.bound)), (axes.right, axes.y(chart.bound))], BOUND, thickness=2)
        for curve in chart.curves:
            _draw(image, axes, curve, duration)
        _legend(image, axes, chart)
    return image
