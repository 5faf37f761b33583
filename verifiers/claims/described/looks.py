"""Words of film against the shots (`claim:look:<claim>`): one shot that the claim names, or any where it names none, is taken so.

- *close*, *wide*: how much of the picture's height or width a subject fills, after the scale of shots of Salt, B. (1983), Film Style and Technology:
  a close shot shows half of a picture of it at least, a wide one the whole subject with room around it.
- *aerial*, *low*: how far the camera looks down, and whether it stands above or below its subjects.
- *telephoto*, *wide_angle*: field of view of lenses of 85 and 35 mm on film of 36 x 24 mm.
- *static*, *push_in*, *follow*: what the camera does between its keys.
- *slow_motion*: the film runs at its own rate, so that none is slow; such a claim fails until it is waived.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.claim_targets import named_in
from ...rows.findings import Finding
from ...shots.plan import subjects_of
from ...shots.sight import sight_of
from ...shots.views import samples
from .answers import Answer, finding_of
from .bounds import CLOSE, DOWN, NEARER, WIDE

if TYPE_CHECKING:
    from collections.abc import Callable

    from ....geometry import Camera
    from ....worlds.candidate import Candidate
    from ....worlds.described import Word
    from ....worlds.spec import Shot

__all__ = ["judge"]

FRAME_HEIGHT_MM = 24.0
LONG_LENS_MM, WIDE_LENS_MM = 85.0, 35.0
"""Lenses of 36 x 24 mm from which on, and up to which, one speaks of a long and a wide one."""
STILL = 1e-6
"""[m], [deg] What counts as no move of the camera."""
LOOKS = 5
"""Own choice: frames of a shot that are looked at."""
SIZE = (192, 108)
"""[pixels] Of the pictures in which a subject is measured; own choice."""


class _View(NamedTuple):
    """A shot at its frames."""

    candidate: Candidate
    name: str
    shot: Shot
    frames: list[int]
    cameras: list[Camera]


def judge(candidate: Candidate, name: str, words: list[Word]) -> Finding:
    """The finding on whether a shot is taken as the words say."""
    spec, quote = candidate.spec, candidate.spec.claims[name].quote
    named = [n for n in named_in(spec, name, "shots") if n in spec.shots] or list(spec.shots)
    views = [v for v in (_view(candidate, n) for n in named) if v.frames]
    if not views:
        return Finding("unverified", f"{quote!r}: none of its shots runs within the frames that there are")
    answers = []
    for word in words:
        if word.term == "slow_motion":
            text = "the film runs at the rate of the motion: no time is stretched; waive the word with this reason"
            answers.append(Answer(word.text, False, text))
            continue
        found = [_TESTS[word.term](word, view) for view in views]
        answers.append(next((a for a in found if a.ok), found[0]))
    action = "take one shot so: its keys, field of view or follow"
    return finding_of(quote, answers, group="shots", action=action, pointers=[f"/shots/{n}" for n in named[:4]])


def _view(candidate: Candidate, name: str) -> _View:
    shot = candidate.spec.shots[name]
    last = min(shot.frames[1], candidate.last_frame)
    frames = samples((shot.frames[0], last), LOOKS) if last >= shot.frames[0] else []
    return _View(candidate, name, shot, frames, [sight_of(candidate).camera(name, k) for k in frames])


# ---------------------------------------------------------------- words


def _filled(view: _View) -> dict[str, list[float]]:
    """By subject and frame, the greater share of the picture's height or width that it would fill with nothing before it."""
    sight, found = sight_of(view.candidate), dict[str, list[float]]()
    for subject in subjects_of(view.candidate, view.shot):
        for frame in view.frames:
            rows, cols = np.nonzero(sight.mask(subject, view.name, frame, SIZE).own)
            if len(rows):
                share = max((int(np.ptp(rows)) + 1) / SIZE[1], (int(np.ptp(cols)) + 1) / SIZE[0])
                found.setdefault(subject, []).append(share)
    return found


def _close(word: Word, view: _View) -> Answer:
    best = max((max(v) for v in _filled(view).values()), default=0.0)
    return Answer(
        word.text,
        best >= CLOSE,
        f"in shot {view.name!r} a subject fills {best:.0%} of the picture's height or width",
        best,
        CLOSE,
    )


def _wide(word: Word, view: _View) -> Answer:
    least = max((min(v) for v in _filled(view).values()), default=0.0)
    return Answer(
        word.text,
        least <= WIDE,
        f"in shot {view.name!r} the largest subject fills {least:.0%} of the picture's height or width",
        least,
        WIDE,
        "<=",
    )


def _pitch(camera: Camera) -> float:
    """Angle of the view below the level [deg]."""
    return math.degrees(math.asin(float(np.clip(camera.axes[2, 2], -1.0, 1.0))))


def _heights(view: _View) -> list[float]:
    """Height of the camera above the middle of its subjects, at each frame [m]."""
    found = []
    for frame, camera in zip(view.frames, view.cameras, strict=True):
        solid = [s for s in subjects_of(view.candidate, view.shot) if s in view.candidate.solids]
        middle = [view.candidate.vertices(s, frame)[:, 2].mean() for s in solid] or [float(camera.target[2])]
        found.append(float(camera.position[2] - np.mean(middle)))
    return found


def _aerial(word: Word, view: _View) -> Answer:
    best = max((p if h > 0 else -90.0) for p, h in zip(map(_pitch, view.cameras), _heights(view), strict=True))
    return Answer(word.text, best >= DOWN, f"shot {view.name!r} looks down by {best:.0f} deg", best, DOWN, ">=", "deg")


def _low(word: Word, view: _View) -> Answer:
    least = min(_heights(view))
    return Answer(
        word.text,
        least <= 0.0,
        f"in shot {view.name!r} the camera stands {least:.3g} m above the middle of its subjects",
        least,
        0.0,
        "<=",
        "m",
    )


def _moved(view: _View) -> tuple[float, float, float]:
    """Greatest change of the camera's place [m], of its target [m] and of its field of view [deg] over a shot."""
    first = view.cameras[0]
    place = max(float(np.linalg.norm(c.position - first.position)) for c in view.cameras)
    target = max(float(np.linalg.norm(c.target - first.target)) for c in view.cameras)
    return place, target, max(abs(c.fov_deg - first.fov_deg) for c in view.cameras)


def _static(word: Word, view: _View) -> Answer:
    moved = max(_moved(view))
    return Answer(
        word.text,
        moved <= STILL,
        f"in shot {view.name!r} camera, target or field of view change by {moved:.3g}",
        moved,
        STILL,
        "<=",
        "m",
    )


def _push_in(word: Word, view: _View) -> Answer:
    first, last = view.cameras[0], view.cameras[-1]
    far = [float(np.linalg.norm(c.target - c.position)) for c in (first, last)]
    wide = [math.tan(math.radians(c.fov_deg) / 2.0) for c in (first, last)]
    ratios = (far[1] / max(far[0], 1e-9), wide[1] / wide[0])
    ratio = min(ratios)
    return Answer(
        word.text,
        ratio <= NEARER,
        f"in shot {view.name!r} distance or field of view end at {ratio:.2f} of the start",
        ratio,
        NEARER,
        "<=",
    )


def _follow(word: Word, view: _View) -> Answer:
    moved = max(_moved(view)[:2])
    ok = moved > STILL and (view.shot.follow is not None or len(view.shot.keys) > 1)
    return Answer(word.text, ok, f"in shot {view.name!r} the camera goes or turns by {moved:.3g} m", moved, STILL, ">=", "m")


def _lens(millimetres: float) -> float:
    """Vertical field of view of a lens [deg]."""
    return 2.0 * math.degrees(math.atan(0.5 * FRAME_HEIGHT_MM / millimetres))


def _telephoto(word: Word, view: _View) -> Answer:
    least, bound = min(c.fov_deg for c in view.cameras), _lens(LONG_LENS_MM)
    return Answer(
        word.text, least <= bound, f"shot {view.name!r} has a field of view of {least:.1f} deg", least, bound, "<=", "deg"
    )


def _wide_angle(word: Word, view: _View) -> Answer:
    most, bound = max(c.fov_deg for c in view.cameras), _lens(WIDE_LENS_MM)
    return Answer(word.text, most >= bound, f"shot {view.name!r} has a field of view of {most:.1f} deg", most, bound, ">=", "deg")


_TESTS: dict[str, Callable[[Word, _View], Answer]] = {
    "close": _close,
    "wide": _wide,
    "aerial": _aerial,
    "low": _low,
    "static": _static,
    "push_in": _push_in,
    "follow": _follow,
    "telephoto": _telephoto,
    "wide_angle": _wide_angle,
}
