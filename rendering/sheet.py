"""Contact sheets and pictures that fit a size limit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from ..worlds.arrays import U8
from ..worlds.errors import EngineError, InputError
from .drawing import text, text_size

__all__ = ["Encoded", "contact_sheet", "encode"]

MAX_BYTES = 700_000
"""Size of a picture that today's MCP clients take without trouble [bytes]."""
MAX_EDGE = 1568
"""Longest side of a picture for a model [pixels]: larger ones are shrunk by its client anyway."""
GAP = 6


class Encoded(NamedTuple):
    """A picture file in memory."""

    data: bytes
    format: Literal["png", "jpeg"]


def _jpeg(image: U8, quality: int) -> bytes:
    import cv2

    good, data = cv2.imencode(".jpg", image[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not good:
        raise EngineError(f"OpenCV could not encode a picture of shape {image.shape} as JPEG")
    return bytes(data.tobytes())


def _shrunk(image: U8, edge: int) -> U8:
    """The picture with its longer side at most `edge` pixels."""
    import cv2

    height, width = image.shape[:2]
    scale = edge / max(height, width)
    if scale >= 1:
        return image
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _fit_jpeg(image: U8, max_bytes: int) -> bytes:
    """Lower the quality first, then the size, until the file fits."""
    if max_bytes < 2000:
        raise InputError(f"max_bytes is {max_bytes}; it must be >= 2000 for a picture to show anything")
    current = _shrunk(image, MAX_EDGE)
    while True:
        for quality in (92, 85, 75, 60):
            data = _jpeg(current, quality)
            if len(data) <= max_bytes:
                return data
        height, width = current.shape[:2]
        if min(height, width) < 16:
            raise InputError(f"a picture of shape {image.shape} does not fit in {max_bytes} bytes; allow more bytes")
        current = _shrunk(current, round(0.8 * max(height, width)))


def encode(image: U8, max_bytes: int = MAX_BYTES) -> Encoded:
    """PNG where it fits in `max_bytes`, else JPEG of falling quality and size; at most `MAX_EDGE` pixels along a side.

    Raises:
        InputError: `max_bytes` is below 2000.
    """
    import cv2

    image = _shrunk(image, MAX_EDGE)
    good, data = cv2.imencode(".png", image[..., ::-1])
    if good and len(data) <= max_bytes:
        return Encoded(bytes(data.tobytes()), "png")
    return Encoded(_fit_jpeg(image, max_bytes), "jpeg")


def contact_sheet(
    images: Sequence[U8], labels: Sequence[str], *, columns: int | None = None, max_bytes: int = MAX_BYTES
) -> bytes:
    """Pictures in a grid with a label under each, as JPEG.

    Args:
        images: pictures (height, width, 3); the first one's size decides the cells.
        labels: one per picture.
        columns: pictures per row; default about square.
        max_bytes: upper limit of the file.

    Raises:
        InputError: no pictures, or another number of labels.
    """
    import cv2

    if not images or len(images) != len(labels):
        raise InputError(f"{len(images)} pictures and {len(labels)} labels; give at least one picture and a label for each")
    across = columns or max(1, math.ceil(math.sqrt(len(images))))
    down = math.ceil(len(images) / across)
    full_height, full_width = images[0].shape[:2]
    scale = min(1.0, MAX_EDGE / (across * full_width))
    width, height = max(1, round(full_width * scale)), max(1, round(full_height * scale))
    strip = 20
    sheet = np.full((down * (height + strip + GAP) + GAP, across * (width + GAP) + GAP, 3), 250, dtype=np.uint8)
    for k, (image, label) in enumerate(zip(images, labels, strict=True)):
        top, left = GAP + (k // across) * (height + strip + GAP), GAP + (k % across) * (width + GAP)
        sheet[top : top + height, left : left + width] = cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)
        words = label
        while len(words) > 4 and text_size(words, 10)[0] > width - 4:
            words = words[:-4] + "..."
        text(sheet, words, (left + 2, top + height + 15), height=10)
    return _fit_jpeg(sheet, max_bytes)
