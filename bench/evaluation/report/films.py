"""Contact sheets of the films of runs, side by side by prompt."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....rendering.sheet import contact_sheet
from ....worlds.arrays import U8
from ....worlds.errors import WorldAgentError
from ..metrics.film import Film
from ..metrics.sample import sample_output
from ..runs import run_name

if TYPE_CHECKING:
    from inspect_ai.log import EvalLog

__all__ = ["FilmSheet", "film_sheets", "sheet_of"]

SHOWN = 8
"""Frames of a sheet, evenly from the first to the last."""
EDGE, MOST_BYTES = 320, 120_000
"""Longest side of a frame on it [pixels], and its size [bytes]: a page of thirteen prompts stays below ten megabytes."""


class FilmSheet(NamedTuple):
    """The sheet of one film."""

    run: str
    repeat: int
    picture: bytes
    """JPEG."""


def film_sheets(logs: Sequence[EvalLog]) -> dict[str, list[FilmSheet]]:
    """Sheets by prompt, in the order of the first run; prompts without a film are left out."""
    found: dict[str, list[FilmSheet]] = {}
    for log in logs:
        for sample in log.samples or ():
            try:
                film = sample_output(sample.metadata).need_film()
                found.setdefault(str(sample.id), []).append(FilmSheet(run_name(log), sample.epoch, sheet_of(film)))
            except WorldAgentError:
                continue  # the document says which samples have no film
    return found


def sheet_of(film: Film) -> bytes:
    """Frames of a film with their times, as JPEG."""
    import cv2

    wanted = sorted({int(k) for k in np.rint(np.linspace(0, film.count - 1, SHOWN))})
    scale = min(1.0, EDGE / max(film.size))
    size = (max(1, round(film.size[1] * scale)), max(1, round(film.size[0] * scale)))
    shown: list[U8] = [
        np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
        for k, picture in enumerate(film.frames())
        if k in wanted
    ]
    return contact_sheet(shown, [f"{k / film.fps:.2f} s" for k in wanted], columns=4, max_bytes=MOST_BYTES)
