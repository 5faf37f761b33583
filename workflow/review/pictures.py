"""Pictures that a reader gets: at most six, of the moments at which the world's events come true and most moves.

Those of the plates where there are any, in the light of the film; else previews.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.errors import EvidenceError
from ...worlds.plates import plate_pictures

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["MOST_PICTURES", "ReviewPicture", "frames_to_show", "pictures_of"]

MOST_PICTURES = 6
"""Own choice: what a reader takes in at once, at the price of some thousand tokens."""
SIZE = (640, 360)
MOST_BYTES = 150_000
"""Largest file of one picture [bytes]."""


class ReviewPicture(NamedTuple):
    """An encoded picture of a frame."""

    frame: int
    data: bytes
    format: str
    """`png` or `jpeg`."""


def frames_to_show(candidate: Candidate, plated: Collection[int] = ()) -> list[int]:
    """First and last frame, those of plates, those at which events of the story come true, that of most motion; else evenly between.

    Args:
        candidate: a complete bake.
        plated: frames of plates.
    """
    from ...verifiers.predicates.evaluators import evaluate

    last = candidate.last_frame
    chosen = [0, last, *plated]
    for beat in () if len(plated) > MOST_PICTURES else candidate.spec.story.beats.values():
        try:
            found = evaluate(candidate, beat.predicate, beat.frames).first_true_frame
        except EvidenceError:
            found = None
        chosen.append(beat.frames[1] if found is None else found)
    chosen.append(_liveliest(candidate))
    chosen += [round(last * share) for share in (0.5, 0.25, 0.75)]
    kept: list[int] = []
    apart = last // (3 * MOST_PICTURES)
    for frame in (min(max(0, f), last) for f in chosen):
        if len(kept) < MOST_PICTURES and all(abs(frame - other) > apart for other in kept):
            kept.append(frame)
    return sorted(kept)


def _liveliest(candidate: Candidate) -> int:
    """Frame at which the sum of the speeds of all things is greatest."""
    from ...verifiers.categories.registry import judged

    total = np.zeros(candidate.frame_count)
    for entity, judge in judged(candidate.spec).items():
        if judge.known(candidate, entity):
            total += np.nan_to_num(np.linalg.norm(judge.velocities(candidate, entity), axis=1))
    return int(np.argmax(total))


def pictures_of(candidate: Candidate) -> list[ReviewPicture]:
    """Pictures in order of time, as the film's cameras see them, without a name in them."""
    from ...rendering import PreviewRenderer, encode, preview

    plates, renderer = {view.frame: image for view, image in reversed(plate_pictures(candidate).items())}, None
    found = []
    for frame in frames_to_show(candidate, [*reversed(plates)]):
        image = plates.get(frame)
        if image is None:
            renderer = renderer or PreviewRenderer(candidate)
            image = preview(candidate, frame, width=SIZE[0], height=SIZE[1], renderer=renderer)
        made = encode(image, MOST_BYTES)
        found.append(ReviewPicture(frame, made.data, made.format))
    return found
