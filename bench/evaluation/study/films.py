"""The films of a study: every method's film of every task, alike in form, so that nothing but the pictures tells them apart."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ....worlds.errors import InputError

__all__ = ["KINDS", "StudyFilms", "read_films"]

KINDS = {".webm": "video/webm", ".mp4": "video/mp4"}
"""Files that browsers play, and their media types."""


@dataclass(frozen=True)
class StudyFilms:
    """Films by method and task."""

    methods: tuple[str, ...]
    tasks: Mapping[str, str]
    """Prompt by task."""
    paths: Mapping[tuple[str, str], Path]
    """By method and task."""
    media_type: str
    digest: str
    """SHA-256 over names and contents."""


def read_films(folder: Path, prompts: Mapping[str, str]) -> StudyFilms:
    """Read `METHOD/TASK.webm` (or `.mp4`).

    Args:
        folder: of the films.
        prompts: text by task.

    Raises:
        InputError: a method lacks a task, a task has no prompt, or films differ in kind, size or rate.
    """
    if not folder.is_dir():
        raise InputError(f"no folder of films {str(folder)!r}; it holds a folder per method, and in each TASK.webm or TASK.mp4")
    found = {(p.parent.name, p.stem): p for p in sorted(folder.glob("*/*")) if p.suffix.lower() in KINDS}
    methods, tasks = tuple(sorted({m for m, _ in found})), sorted({t for _, t in found})
    if len(methods) < 2:
        raise InputError(
            f"{str(folder)!r} has films of {len(methods)} methods; a comparison needs at least two folders METHOD with TASK.webm or TASK.mp4"
        )
    lacking = [f"{m}/{t}" for m in methods for t in tasks if (m, t) not in found]
    if lacking:
        raise InputError(
            f"every rater sees all methods of a task; missing are {', '.join(lacking[:6])}{' ...' if len(lacking) > 6 else ''}"
        )
    strange = [t for t in tasks if t not in prompts]
    if strange:
        raise InputError(
            f"tasks {', '.join(strange[:6])} have no prompt; name the set with --prompts, or the films after its ids"
        )
    forms = {_form(p) for p in found.values()}
    if len(forms) > 1:
        told = "; ".join(f"{kind} {width} x {height} at {rate:g} frames/s" for kind, width, height, rate in sorted(forms))
        raise InputError(
            f"films must share one format, or it gives their methods away; there are {told}. Encode them alike (ffmpeg -s, -r)"
        )
    state = hashlib.sha256()
    for (method, task), path in sorted(found.items()):
        with path.open("rb") as stream:
            state.update(f"{method}/{task}:{hashlib.file_digest(stream, 'sha256').hexdigest()};".encode())
    return StudyFilms(methods, {t: prompts[t] for t in tasks}, found, KINDS[next(iter(forms))[0]], state.hexdigest())


def _form(path: Path) -> tuple[str, int, int, float]:
    """Kind, width and height [pixels] and frames per second of a film."""
    import cv2

    video = cv2.VideoCapture(str(path))
    try:
        good, picture = video.read()
        if not good:
            raise InputError(f"film {str(path)!r} holds no frame that can be decoded; encode it again")
        return path.suffix.lower(), picture.shape[1], picture.shape[0], round(float(video.get(cv2.CAP_PROP_FPS)), 2)
    finally:
        video.release()
