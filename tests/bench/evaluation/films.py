"""Small films for metrics: every frame has a colour of its own."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

__all__ = ["film_file"]


def film_file(path: Path, count: int, *, size: tuple[int, int] = (48, 64), fps: float = 24.0) -> Path:
    """A Motion JPEG film of `count` frames of (height, width), growing brighter."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), fps, (size[1], size[0]))
    for k in range(count):
        writer.write(np.full((*size, 3), (10 + 200 * k // max(1, count - 1), 40, 90), dtype=np.uint8))
    writer.release()
    return path
