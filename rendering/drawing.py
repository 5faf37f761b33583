"""Text, lines and colours on 8-bit pictures, by OpenCV."""

from __future__ import annotations

import colorsys
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..worlds.arrays import U8

__all__ = ["Color", "caption", "distinct_color", "label_regions", "line", "polygon", "region_edges", "text", "text_size"]

Color = tuple[int, int, int]
"""8-bit RGB."""
LABELLED_PIXELS = 60
"""Regions smaller than this get no label."""


def distinct_color(index: int) -> Color:
    """A colour that differs well from those of nearby indices (hues by the golden ratio)."""
    hue = (0.08 + index * 0.61803399) % 1.0
    saturation, value = (0.65, 0.95) if index % 2 == 0 else (0.85, 0.72)
    red, green, blue = colorsys.hsv_to_rgb(hue, saturation, value)
    return round(red * 255), round(green * 255), round(blue * 255)


def text_size(words: str, height: float) -> tuple[int, int]:
    """Width and height [pixels] of words whose capitals are `height` pixels high."""
    import cv2

    (width, tall), _ = cv2.getTextSize(words, cv2.FONT_HERSHEY_SIMPLEX, height / 21.0, 1)
    return int(width), int(tall)


def text(
    image: U8, words: str, at: tuple[float, float], *, height: float = 11.0, color: Color = (20, 20, 20), box: Color | None = None
) -> None:
    """Write words with their lower left corner at pixel `at`, on a half-transparent `box`; non-ASCII becomes `?`."""
    import cv2

    plain = words.encode("ascii", "replace").decode()
    left, base = round(at[0]), round(at[1])
    if box is not None:
        wide, tall = text_size(plain, height)
        spot = image[max(0, base - tall - 2) : base + 3, max(0, left - 2) : left + wide + 2]
        spot[:] = (0.3 * spot + 0.7 * np.array(box)).astype(np.uint8)
    cv2.putText(
        image, plain, (left, base), cv2.FONT_HERSHEY_SIMPLEX, height / 21.0, color, max(1, round(height / 11.0)), cv2.LINE_AA
    )


def label_regions(image: U8, regions: NDArray[np.integer[Any]], names: Sequence[str]) -> None:
    """Write each name on the pixels that carry its index; small regions and those whose place is taken stay bare.

    Args:
        image: picture (height, width, 3).
        regions: index into `names` per pixel, -1 for none.
        names: one per index.
    """
    size = 9.0
    height, width = regions.shape
    taken = np.zeros(regions.shape, dtype=bool)
    areas = np.bincount(regions[regions >= 0].ravel(), minlength=len(names))
    for k in np.argsort(-areas):
        if areas[k] < LABELLED_PIXELS:
            break
        rows, columns = np.nonzero(regions == k)
        wide, tall = text_size(names[k], size)
        middle = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
        left = int(np.clip(columns[middle] - wide // 2, 2, max(2, width - wide - 2)))
        beside = int(np.ptp(rows)) // 2 + tall
        for shift in (0, -13, 13) if areas[k] > 1.5 * wide * tall else (-beside, beside, -beside - 13, beside + 13):
            base = int(np.clip(rows[middle] + tall // 2 + shift, tall + 2, height - 4))
            spot = (slice(base - tall - 2, base + 3), slice(left - 2, left + wide + 2))
            if not taken[spot].any():
                taken[spot] = True
                text(image, names[k], (left, base), height=size, box=(250, 250, 250))
                break


def region_edges(ids: NDArray[np.integer[Any]]) -> NDArray[np.bool_]:
    """Pixels whose left or upper neighbour carries another id."""
    edge = np.zeros(ids.shape, dtype=bool)
    edge[:, 1:] |= ids[:, 1:] != ids[:, :-1]
    edge[1:] |= ids[1:] != ids[:-1]
    return edge


def caption(image: U8, words: str) -> None:
    """Write words on a dark strip in the lower left corner."""
    height = max(9.0, image.shape[0] / 32.0)
    wide, tall = text_size(words, height)
    top, right = image.shape[0] - tall - round(height), min(image.shape[1], wide + round(1.4 * height))
    image[top:, :right] = (image[top:, :right] * 0.35).astype(np.uint8)
    text(image, words, (0.6 * height, image.shape[0] - 0.5 * height), height=height, color=(255, 255, 255))


def line(image: U8, points: ArrayLike, color: Color, *, thickness: int = 1, closed: bool = False) -> None:
    """Draw a polyline through pixels, shape (n, 2), with sub-pixel accuracy."""
    import cv2

    fixed = np.round(np.asarray(points, dtype=np.float64) * 16).astype(np.int32)
    cv2.polylines(image, [fixed.reshape(-1, 1, 2)], closed, color, thickness, cv2.LINE_AA, 4)


def polygon(image: U8, points: ArrayLike, color: Color) -> None:
    """Fill a polygon of pixels, shape (n, 2)."""
    import cv2

    fixed = np.round(np.asarray(points, dtype=np.float64) * 16).astype(np.int32)
    cv2.fillPoly(image, [fixed.reshape(-1, 1, 2)], color, cv2.LINE_AA, 4)
