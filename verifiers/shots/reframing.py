"""Better views for a shot plan: a camera that sees a subject clearly, found by trying."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import CameraKey
from ..rows.corrections import correction, set_value
from .bounds import FILL

if TYPE_CHECKING:
    from ...worlds.requirements import Correction
    from .sight import Seen, Sight

__all__ = ["reframe"]

TURNS = (0, 30, -30, 60, -60, 90, -90, 135, -135, 180)
"""[degrees] from the present direction at which a clear view is looked for."""
LIFTS = (0.0, 25.0, 55.0)
"""[degrees] above it."""
WIDE = 2.0
"""[m] Own choice: radius of a subject from which a camera need not have all of it in the picture."""
LOW = 30.0
"""[degrees] Own choice: such a one is not looked at more steeply than this, or than now."""


def reframe(sight: Sight, subject: str, seen: Seen, frames: tuple[int, int], *, leaves: bool = False) -> list[Correction]:
    """Ranked edits of the shot plan that show the subject, the nearest clear view computed and tried.

    Args:
        sight: pictures of the candidate.
        subject: entity to show.
        seen: how it appears now.
        frames: when it should be seen; the suggestion is made for the middle.
        leaves: whether it is in view only part of the time.
    """
    candidate = sight.candidate
    shot = candidate.aimed(candidate.spec.shots[seen.shot])
    hints = []
    if leaves and shot.follow is None:
        pointer = f"/shots/{seen.shot}/follow"
        hints.append(
            correction(
                f"{subject} leaves the picture",
                "shots",
                f"let shot {seen.shot} follow {subject}, or widen it",
                pointers=(pointer,),
                patch=set_value(pointer, subject),
            )
        )
    middle = min((frames[0] + frames[1]) // 2, candidate.last_frame)
    key_id = min(shot.keys, key=lambda k: abs(shot.keys[k].frame - middle))
    key = _better(sight, subject, shot.keys[key_id], middle)
    if key is not None and shot.follow is not None:
        moved = sight.offset(shot, middle)
        aim = np.array(key.target, dtype=np.float64) - moved
        key = key.model_copy(update={"target": tuple(round(float(c), 4) for c in aim)})
    pointer = f"/shots/{seen.shot}/keys/{key_id}"
    cause = (
        f"{seen.hidden_by} stands in the way"
        if seen.hidden_by and seen.unoccluded < candidate.spec.simulation.limits.visible_share
        else f"{subject} is out of the picture"
        if not seen.in_picture
        else f"{subject} is too small in the picture"
    )
    if key is None:
        hints.append(correction(cause, "shots", f"no clear view of {subject} found around it: uncover it", pointers=(pointer,)))
        return hints
    where = ", ".join(f"{c:.2f}" for c in key.position)
    action = f"put the camera at ({where}) m and aim at {subject}, which then fills about {FILL:.0%} of the height"
    if key.position == shot.keys[key_id].position:
        action = f"aim the camera at {subject} from where it is"
    patch = ({"op": "replace", "path": pointer, "value": key.model_dump(mode="json", exclude_none=True)},)
    return [correction(cause, "shots", action, pointers=(pointer,), patch=patch), *hints]


def _better(sight: Sight, subject: str, old: CameraKey, frame: int) -> CameraKey | None:
    """A key that sees the subject at `frame`: from where the camera is if that is clear, else from its direction, else the nearest that is."""
    candidate, limits = sight.candidate, sight.candidate.spec.simulation.limits
    center = candidate.center(subject, frame)
    radius = float(np.linalg.norm(candidate.vertices(subject, frame) - center, axis=1).max())
    distance = radius / (FILL * math.tan(math.radians(old.fov_deg) / 2))
    away = np.array(old.position) - center
    flat = float(np.hypot(away[0], away[1]))
    azimuth, elevation = math.atan2(away[1], away[0]), math.atan2(away[2], flat) if flat > 0 else math.radians(30)
    highest = math.radians(80)
    if radius > WIDE:  # water or land is looked over from where the camera is, and not from far above
        distance, highest = min(distance, float(np.linalg.norm(away))), max(elevation, math.radians(LOW))
    found: tuple[float, CameraKey] | None = None
    aimed = old.model_copy(update={"target": tuple(round(float(c), 4) for c in center)})
    seen = sight.try_camera(subject, aimed, frame)
    if seen.unoccluded >= 0.9 and seen.share >= limits.visible_pixels and sight.inside(np.array(old.position), frame) is None:
        return aimed
    for lift in LIFTS:
        for turn in TURNS:
            up = min(max(elevation + math.radians(lift), math.radians(5)), highest)
            around = azimuth + math.radians(turn)
            direction: F64 = np.array([math.cos(up) * math.cos(around), math.cos(up) * math.sin(around), math.sin(up)])
            position = center + distance * direction
            if sight.inside(position, frame) is not None:
                continue
            key = old.model_copy(
                update={
                    "position": tuple(round(float(c), 4) for c in position),
                    "target": tuple(round(float(c), 4) for c in center),
                }
            )
            seen = sight.try_camera(subject, key, frame)
            if seen.unoccluded >= 0.9 and seen.share >= limits.visible_pixels:
                return key
            if seen.share >= limits.visible_pixels and (found is None or seen.unoccluded > found[0]):
                found = (seen.unoccluded, key)
    return found[1] if found is not None and found[0] >= limits.visible_share else None
