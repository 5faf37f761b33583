"""Axes of plots over time: a box in pixels with a range of values, its grid and its numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ...worlds.arrays import F64, U8
from ..drawing import Color, line, text, text_size

__all__ = ["FLOOR", "GRID", "INK", "Panel", "draw_axes", "ticks", "value_range"]

INK: Color = (40, 40, 40)
GRID: Color = (225, 225, 225)
FLOOR = 1e-9
"""Least value on a logarithmic axis: below it everything is rounding."""


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
    log: bool = False
    """Values are drawn by their logarithm to base 10, and so is the range given."""

    def x(self, time: float) -> float:
        """Column [px] of a time [s]."""
        return self.left + (self.right - self.left) * time / self.seconds

    def y(self, value: float) -> float:
        """Row [px] of a value."""
        level = math.log10(max(value, FLOOR)) if self.log else value
        return self.bottom - (self.bottom - self.top) * (level - self.low) / (self.high - self.low)


def ticks(low: float, high: float, most: int) -> list[float]:
    """Round numbers (1, 2, 5 times a power of ten) within [low, high]."""
    raw = max(high - low, 1e-300) / max(most, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(m * power for m in (1, 2, 5, 10) if m * power >= raw * 0.999)
    return [k * step for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def value_range(values: F64, least: float) -> tuple[float, float]:
    """Least and greatest value of axes that show finite values (n,) with a margin; a constant counts as at least `least` high."""
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    if 0 < low < 0.5 * high:
        low = 0.0
    margin = 0.06 * (high - low) if high > low else max(abs(high), least) * 0.5
    return low if low == 0.0 and high > 0 else low - margin, high + margin


def draw_axes(image: U8, panel: Panel, levels: Iterable[tuple[float, str]], *, height: float, gap: int, last: bool) -> None:
    """Draw the grid, the border, the words of levels and, for the `last` panel, the seconds below it.

    Args:
        image: changed in place.
        panel: the axes.
        levels: value and words of each horizontal line.
        height: of capitals [px].
        gap: between the words and the axes [px].
        last: no panel follows below.
    """
    for value, words in levels:
        y = panel.y(value)
        line(image, [(panel.left, y), (panel.right, y)], GRID)
        text(image, words, (panel.left - gap - text_size(words, height)[0], y + 4), height=height, color=INK)
    for time in ticks(0.0, panel.seconds, 10):
        x = panel.x(time)
        line(image, [(x, panel.top), (x, panel.bottom)], GRID)
        if last:
            words = f"{time:.4g}"
            text(image, words, (x - text_size(words, height)[0] / 2, panel.bottom + 16), height=height, color=INK)
    corners = np.array(
        [[panel.left, panel.top], [panel.right, panel.top], [panel.right, panel.bottom], [panel.left, panel.bottom]]
    )
    line(image, corners, (120, 120, 120), closed=True)
