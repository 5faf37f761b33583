"""A preview that shows one or two entities among the rest, even where other bodies hide them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..geometry.camera import Camera
from ..worlds.arrays import U8
from ..worlds.candidate import Candidate
from .drawing import region_edges, text
from .preview import PreviewRenderer
from .views import camera_for

__all__ = ["highlight"]

MARK = np.array([235.0, 60.0, 30.0])
"""Colour of what is shown."""
SMALL = 0.004
"""Share of the picture below which the shot's camera does not show an entity, so that one of its own is used."""
NEAR = 2.6
"""Distance of the entity's own camera, in diagonals of what it frames."""
TOGETHER = 8.0
"""Entities are framed together while the box around them is at most this many diagonals of the first."""


def _near_camera(candidate: Candidate, frame: int, entities: Sequence[str], width: int, height: int) -> Camera:
    """A three-quarter view from above of the first entity, and of the others where they are near."""
    points = candidate.vertices(entities[0], frame)
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    for name in entities[1:]:
        both = np.concatenate([points, candidate.vertices(name, frame)])
        if np.linalg.norm(np.ptp(both, axis=0)) <= TOGETHER * size:
            points = both
    low, high = points.min(0), points.max(0)
    center, reach = 0.5 * (low + high), NEAR * max(float(np.linalg.norm(high - low)), 1e-3)
    towards = np.array([0.5, -0.78, 0.42])
    return Camera(center + reach * towards / np.linalg.norm(towards), center, 40.0, width, height)


def highlight(
    candidate: Candidate,
    frame: int,
    entities: Sequence[str],
    *,
    renderer: PreviewRenderer | None = None,
    width: int = 560,
    height: int = 315,
) -> U8:
    """Preview at a frame with the entities tinted and outlined, through whatever stands before them.

    The shot's camera is used where it shows the first entity large enough, else a camera near it.

    Args:
        candidate: what to show.
        frame: frame index.
        entities: ids, the first one decides the view; unknown ones are left out.
        renderer: reuse this one over many pictures of the same candidate.
        width: pixels.
        height: pixels.
    """
    drawn = renderer or PreviewRenderer(candidate)
    known = [name for name in entities if name in candidate.built]
    camera = camera_for(candidate, frame, width=width, height=height)
    if known and drawn.mask(frame, camera, known[0]).mean() < SMALL:
        camera = _near_camera(candidate, frame, known, width, height)
    picture = drawn.preview(frame, camera)
    for name in known:
        inside = drawn.mask(frame, camera, name)
        picture[inside] = (0.62 * picture[inside] + 0.38 * MARK).astype(np.uint8)
        edges = region_edges(inside.astype(np.int32))
        edges[:-1] |= edges[1:]
        edges[:, :-1] |= edges[:, 1:]
        picture[edges] = MARK.astype(np.uint8)
        rows, columns = np.nonzero(inside)
        if len(rows):
            top = max(14, int(rows.min()) - 4)
            text(picture, name, (int(np.clip(columns.mean() - 20, 2, width - 60)), top), height=10, box=(250, 250, 250))
    return picture
