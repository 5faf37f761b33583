"""Films as metrics read them: decoded once by OpenCV, every frame counted as it comes out of the decoder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from ....worlds.arrays import U8
from ....worlds.errors import EvidenceError, InputError

__all__ = ["Film", "encoded_frame"]

JUDGE_EDGE = 512
"""Own choice: longest side of a frame that a judge gets [pixels]; the paper's judge itself sees 384 x 384."""
QUALITY = 90
"""Quality of the JPEG files that a judge gets."""


@dataclass(frozen=True)
class Film:
    """A video file, of which nothing but its pictures and its rate is told to anyone."""

    path: Path

    def __post_init__(self) -> None:
        if not self.path.is_file():
            raise InputError(f"there is no film {str(self.path)!r}; render_shot(kind='final') makes one of an accepted world")

    def frames(self) -> Iterator[U8]:
        """All decoded frames in order, RGB, shape (height, width, 3).

        Raises:
            EvidenceError: the file holds no frame that can be decoded.
        """
        import cv2

        video = cv2.VideoCapture(str(self.path))
        try:
            found = 0
            while True:
                good, picture = video.read()
                if not good:
                    break
                found += 1
                yield picture[..., ::-1]
            if not found:
                raise EvidenceError(f"film {self.path.name!r} holds no frame that can be decoded; render it again")
        finally:
            video.release()

    @cached_property
    def _told(self) -> tuple[int, int, int]:
        """Number of decoded frames, height and width; what the container says of its length is not asked."""
        count, shape = 0, (0, 0)
        for picture in self.frames():
            count, shape = count + 1, picture.shape[:2]
        return count, int(shape[0]), int(shape[1])

    @property
    def count(self) -> int:
        """Number of frames that can be decoded."""
        return self._told[0]

    @property
    def size(self) -> tuple[int, int]:
        """Height and width [pixels]."""
        return self._told[1:]

    @cached_property
    def fps(self) -> float:
        """Frames per second that the container names; 24 where it names none."""
        import cv2

        video = cv2.VideoCapture(str(self.path))
        rate = float(video.get(cv2.CAP_PROP_FPS))
        video.release()
        return rate if 0.0 < rate < 1000.0 else 24.0

    def jpegs(self, wanted: Sequence[int]) -> dict[int, bytes]:
        """Frames as small JPEG files without any metadata, by index; each is decoded once.

        Raises:
            EvidenceError: the film ends before one of them.
        """
        left, found = set(wanted), dict[int, bytes]()
        for index, picture in enumerate(self.frames()):
            if index in left:
                found[index] = encoded_frame(picture)
                left.discard(index)
            if not left:
                return found
        raise EvidenceError(f"film {self.path.name!r} ends before frame {min(left)}; it has {self.count} frames")


def encoded_frame(picture: U8) -> bytes:
    """A frame as a JPEG of at most `JUDGE_EDGE` pixels a side."""
    import cv2

    height, width = picture.shape[:2]
    scale = min(1.0, JUDGE_EDGE / max(height, width))
    bgr: Any = picture[..., ::-1]
    if scale < 1.0:
        size = (max(1, round(width * scale)), max(1, round(height * scale)))
        bgr = cv2.resize(bgr, size, interpolation=cv2.INTER_AREA)
    good, data = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    if not good:
        raise EvidenceError(f"OpenCV could not encode a frame of {width} x {height} pixels")
    return bytes(data.tobytes())
