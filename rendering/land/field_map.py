"""A field of a landscape as a picture: colours over hillshade, with legend, scale bar and north."""

from __future__ import annotations

import numpy as np

from ...worlds.arrays import F64, U8
from ...worlds.errors import InputError
from ...worlds.landscape import FIELDS, SavedLandscape
from ..drawing import distinct_color, line, text, text_size

__all__ = ["field_map", "hillshade"]

MARGIN = 12
LEGEND = 150
"""Width of the legend [pixels]."""
SHOWN_CLASSES = 14
CONTOURED = ("height", "hillshade", "ground")
"""Maps with lines of equal height."""
CONTOURS = 25
"""About so many lines from the lowest to the highest place."""
WATER_COLOR = (64, 120, 178)
SUN = (np.radians(315.0), np.radians(45.0))
"""Azimuth clockwise from north and elevation of the light: the cartographers' north-west."""
_STOPS: dict[str, tuple[tuple[int, int, int], ...]] = {
    "terrain": ((58, 105, 75), (120, 150, 90), (190, 180, 120), (160, 125, 90), (140, 120, 115), (235, 235, 240)),
    "water": ((245, 245, 240), (150, 195, 220), (60, 120, 185), (20, 45, 110)),
    "wet": ((196, 160, 110), (225, 215, 165), (130, 180, 130), (40, 110, 130), (25, 55, 110)),
    "heat": ((250, 245, 225), (245, 200, 120), (225, 125, 65), (150, 45, 55), (60, 20, 50)),
    "slope": ((250, 250, 245), (225, 210, 160), (200, 130, 80), (120, 40, 50)),
    "diverging": ((40, 80, 150), (150, 185, 215), (245, 245, 240), (225, 160, 130), (150, 50, 45)),
    "aspect": ((200, 90, 80), (210, 190, 90), (90, 160, 110), (80, 110, 180), (200, 90, 80)),
    "viridis": ((68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37)),
}


def hillshade(height: F64, cell: float) -> F64:
    """Brightness of the ground under a low light, 0 to 1; row 0 south.

    Relief is raised where it is faint, so that a plain shows its form as a mountain does.
    """
    north, east = np.gradient(np.nan_to_num(height, nan=float(np.nanmin(height))), cell)
    spread = float(np.percentile(np.hypot(east, north), 90))
    raised = 0.7 / spread if 0 < spread < 0.7 else 1.0
    east, north = east * raised, north * raised
    azimuth, elevation = SUN
    lit = np.sin(elevation) - np.cos(elevation) * (east * np.sin(azimuth) + north * np.cos(azimuth))
    return np.asarray(np.clip(lit / np.sqrt(1 + east**2 + north**2), 0.0, 1.0))


def field_map(land: SavedLandscape, name: str, *, width: int = 900, height: int = 700) -> U8:
    """Picture of a field, north up.

    Args:
        land: the landscape.
        name: a field of `worlds.landscape.FIELDS`, or `hillshade`.
        width: of the picture [pixels].
        height: of the picture [pixels].

    Raises:
        InputError: there is no such field.
    """
    import cv2

    known = [*(n for n in FIELDS if n in land.names), "hillshade"]
    if name not in known:
        raise InputError(f"the landscape has no field {name!r}; it has {', '.join(known)}")
    rows, cols = land.shape
    wide, tall = width - LEGEND - 3 * MARGIN, height - 2 * MARGIN
    scale = min(wide / cols, tall / rows)
    size = max(1, round(cols * scale)), max(1, round(rows * scale))
    shade = hillshade(land.field("height"), land.cell)
    canvas = np.full((height, width, 3), 252, dtype=np.uint8)
    if name == "hillshade":
        colors = np.full((rows, cols, 3), 235.0)
        _draw_water(land, colors)
        legend: list[tuple[str, tuple[int, int, int]]] = [("water", WATER_COLOR)]
        span = None
    elif FIELDS[name].palette == "classes":
        colors, legend = _classes(land, name)
        span = None
    else:
        colors, span = _graded(land.field(name), FIELDS[name].palette, log=FIELDS[name].log)
        legend = []
    lit = colors * (0.45 + 0.65 * shade)[..., None]
    image = np.flipud(np.clip(lit, 0, 255).astype(np.uint8))
    shrinks = size[0] < cols
    image = cv2.resize(image, size, interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_NEAREST)
    interval = _contours(image, cv2.resize(np.flipud(land.field("height")), size)) if name in CONTOURED else 0.0
    canvas[MARGIN : MARGIN + size[1], MARGIN : MARGIN + size[0]] = image
    _scale_bar(canvas, size, cols * land.cell, scale / land.cell)
    left = MARGIN * 2 + size[0]
    _title(canvas, left, name)
    if span is not None:
        _bar(canvas, left, FIELDS[name].palette, span, FIELDS[name].unit, log=FIELDS[name].log)
    for k, (words, color) in enumerate(legend):
        top = 78 + 20 * k
        canvas[top : top + 13, left : left + 18] = color
        text(canvas, words, (left + 24, top + 12), height=10)
    if interval:
        text(canvas, f"contours every {interval:g} m", (left, canvas.shape[0] - 40), height=9, color=(90, 90, 90))
    return canvas


def _contours(image: U8, height: F64) -> float:
    """Draw lines of equal height, every fifth one darker, with heights on the way east from the top; their interval [m].

    Args:
        image: changed in place, row 0 north.
        height: of the same shape [m].
    """
    known = np.isfinite(height)
    relief = float(np.ptp(height[known])) if known.any() else 0.0
    if relief <= 0:
        return 0.0
    rough = relief / CONTOURS
    power = 10.0 ** np.floor(np.log10(rough))
    interval = float(power * next(f for f in (1, 2, 5, 10) if f * power >= rough))
    step = np.floor(np.where(known, height, np.nan) / interval)
    highest = np.full(step.shape, -np.inf)
    crossed = np.zeros(step.shape, dtype=bool)
    for axis in (0, 1):
        here, there = (step[:-1], step[1:]) if axis == 0 else (step[:, :-1], step[:, 1:])
        part = np.isfinite(here) & np.isfinite(there) & (here != there)
        spot = (slice(None, -1), slice(None)) if axis == 0 else (slice(None), slice(None, -1))
        crossed[spot] |= part
        highest[spot] = np.where(part, np.maximum(highest[spot], np.maximum(here, there)), highest[spot])
    main = crossed & (np.where(crossed, highest, 1.0) % 5 == 0)
    image[crossed] = (image[crossed] * 0.78).astype(np.uint8)
    image[main] = (image[main] * 0.6).astype(np.uint8)
    row, col = np.unravel_index(int(np.nanargmax(np.where(known, height, -np.inf))), height.shape)
    told: set[float] = set()
    for x in range(int(col), height.shape[1] - 30):
        level = float(highest[row, x])
        if main[row, x] and level not in told and x > col + 34 * len(told):
            told.add(level)
            text(image, f"{level * interval:g}", (x + 2, float(row) + 4), height=8, box=(250, 250, 250))
    return interval


def _palette(name: str, share: F64) -> F64:
    stops = np.array(_STOPS[name], dtype=np.float64)
    at = np.linspace(0.0, 1.0, len(stops))
    return np.stack([np.interp(share, at, stops[:, k]) for k in range(3)], axis=-1)


def _graded(values: F64, palette: str, *, log: bool) -> tuple[F64, tuple[float, float]]:
    """Colours of a continuous field and the values at both ends of its scale; what is missing stays grey."""
    known = np.isfinite(values) & ((values > 0) | (not log))
    if not known.any():
        return np.full((*values.shape, 3), 205.0), (0.0, 0.0)
    low, high = (float(v) for v in np.percentile(values[known], (0.5, 99.5)))
    if palette == "diverging":
        low, high = -max(abs(low), abs(high)), max(abs(low), abs(high))
    if high <= low:
        low, high = float(values[known].min()), float(values[known].max())
    safe = np.where(known, values, low)
    share = np.log(safe / low) / np.log(high / low) if log and high > low > 0 else (safe - low) / max(high - low, 1e-30)
    return np.where(known[..., None], _palette(palette, np.clip(share, 0, 1)), 205.0), (low, high)


def _classes(land: SavedLandscape, name: str) -> tuple[F64, list[tuple[str, tuple[int, int, int]]]]:
    values = land.raw(name)
    found, counts = np.unique(values, return_counts=True)
    order = found[np.argsort(-counts, kind="stable")]
    names = land.about["cover"] if name == "cover" else None
    colors = np.full((*values.shape, 3), 235.0)
    legend: list[tuple[str, tuple[int, int, int]]] = []
    for k, value in enumerate(order.tolist()):
        if name in ("lake", "basin", "peak") and value == 0:
            continue
        color = distinct_color(int(value))
        colors[values == value] = color
        if len(legend) < SHOWN_CLASSES:
            share = counts[found == value][0] / values.size
            legend.append((f"{names[value] if names else value}  {share:.1%}", color))
        elif k == len(order) - 1:
            legend.append((f"and {len(order) - SHOWN_CLASSES} more", (235, 235, 235)))
    return colors, legend


def _draw_water(land: SavedLandscape, colors: F64) -> None:
    colors[land.raw("wet").astype(bool)] = WATER_COLOR


def _title(canvas: U8, left: int, name: str) -> None:
    text(canvas, name.replace("_", " "), (left, 30), height=14)
    if name in FIELDS:
        words = FIELDS[name].meaning
        while len(words) > 8 and text_size(words, 8)[0] > canvas.shape[1] - left - 4:
            words = words[:-4] + "..."
        text(canvas, words, (left, 50), height=8, color=(90, 90, 90))


def _bar(canvas: U8, left: int, palette: str, span: tuple[float, float], unit: str, *, log: bool) -> None:
    top, tall = 80, min(260, canvas.shape[0] - 140)
    share = np.linspace(1.0, 0.0, tall)[:, None]
    canvas[top : top + tall, left : left + 20] = _palette(palette, np.broadcast_to(share, (tall, 20))).astype(np.uint8)
    low, high = span
    for k in range(5):
        part = k / 4
        value = low * (high / low) ** part if log and high > low > 0 else low + (high - low) * part
        text(canvas, f"{value:.4g}", (left + 26, top + tall - part * (tall - 8)), height=10)
    text(canvas, f"[{unit}]" + (" log" if log else ""), (left, top + tall + 22), height=10)


def _scale_bar(canvas: U8, size: tuple[int, int], extent: float, pixels_per_metre: float) -> None:
    length = 10.0 ** np.floor(np.log10(extent / 3))
    length *= next(f for f in (5, 2, 1) if f * length <= extent / 3)
    wide = round(length * pixels_per_metre)
    x, y = MARGIN + 14, MARGIN + size[1] - 16
    canvas[y - 18 : y + 8, x - 6 : x + wide + 6] = (0.35 * canvas[y - 18 : y + 8, x - 6 : x + wide + 6] + 0.65 * 255).astype(
        np.uint8
    )
    line(canvas, [(x, y), (x + wide, y)], (20, 20, 20), thickness=2)
    text(canvas, f"{length:g} m" if length < 1000 else f"{length / 1000:g} km", (x, y - 5), height=10)
    north = (MARGIN + size[0] - 18, MARGIN + 34)
    line(canvas, [north, (north[0], north[1] - 20)], (20, 20, 20), thickness=2)
    text(canvas, "N", (north[0] - 4, north[1] - 23), height=10)
