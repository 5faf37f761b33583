"""Where cameras are and how they move: never in or through a body, never faster than the eye can follow (R23, S10)."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...geometry import Camera, contains, distance_to_surface
from ...geometry.triangles import ray_hits
from ...worlds.arrays import F64, rotation_matrix
from ..categories.registry import judge_of
from ..rows.corrections import correction
from ..rows.findings import Finding
from ..scene.surfaces import surfaces_of
from .bounds import NEAR_PLANE, SCREEN_STEP
from .plan import subjects_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Shot
    from ..scene.shapes import PartSurface
    from .sight import Sight

__all__ = ["inside", "moves", "stands_in"]

LEVER = 0.02
"""Own choice: turning and zooming are measured this far from the aim, as a share of the picture's width."""


class _Bad(NamedTuple):
    """A frame at which the camera is where it cannot be."""

    frame: int
    entity: str
    text: str


def _cameras(sight: Sight, shot_id: str, shot: Shot, last: int) -> list[tuple[int, Camera]]:
    """The shot's cameras up to a frame, after the last one of the shot that it continues."""
    candidate = sight.candidate
    cameras = [(f, sight.camera(shot_id, f)) for f in range(shot.frames[0], last + 1)]
    if shot.transition == "continue":
        before = [n for n, s in candidate.spec.shots.items() if s.frames[1] == shot.frames[0] - 1]
        if before and shot.frames[0] - 1 <= candidate.last_frame:
            cameras.insert(0, (shot.frames[0] - 1, sight.camera(before[0], shot.frames[0] - 1)))
    return cameras


def inside(sight: Sight, shot_id: str, shot: Shot) -> Finding:
    """Judge whether the camera stays out of every body, at and between all frames, as seen from that body."""
    candidate, frames = sight.candidate, shot.frames
    last = min(frames[1], candidate.last_frame)
    if last >= frames[0]:
        cameras = _cameras(sight, shot_id, shot, last)
        found = [bad for part in surfaces_of(candidate).parts if (bad := _meets(candidate, part, cameras)) is not None]
        if found:
            bad = min(found)
            text, out = f"the camera of shot {shot_id} {bad.text} at frame {bad.frame}", f"move it out of {bad.entity}"
            hint = correction("the camera is in a body", "shots", out, pointers=(f"/shots/{shot_id}/keys",))
            evidence = {"position": sight.camera(shot_id, max(bad.frame, frames[0])).position}
            return Finding("fail", text, entity=bad.entity, frame=bad.frame, hints=(hint,), evidence=evidence, frames=frames)
    if last < frames[1]:
        text = f"outside all solids up to frame {last}; frames up to {frames[1]} are not simulated"
        return Finding("unverified", text, frames=frames)
    return Finding("pass", f"outside all solids at and between frames {frames[0]}..{last}", frames=frames)


def stands_in(candidate: Candidate, camera: Camera, frame: int) -> list[str]:
    """Sentences about the place of one camera at a frame: one for each body that it is in or that its near plane cuts open."""
    surfaces, reach = surfaces_of(candidate), _near_reach(camera)
    if not surfaces.parts:
        return []
    low, high = (v[:, 0] for v in surfaces.boxes(np.array([frame])))
    near = np.flatnonzero(((low - reach <= camera.position) & (camera.position <= high + reach)).all(axis=1))
    met = (_meets(candidate, surfaces.parts[i], [(frame, camera)]) for i in near)
    return list(dict.fromkeys(f"the camera {bad.text}".rstrip(",") for bad in met if bad is not None))


def _meets(candidate: Candidate, part: PartSurface, cameras: list[tuple[int, Camera]]) -> _Bad | None:
    """The first frame at which a camera is in a part, passes through its surface, or is nearer than its near plane."""
    frames = np.minimum([f for f, _ in cameras], candidate.last_frame)
    track = surfaces_of(candidate).track(part.entity, part.body).take(frames)
    eyes = np.array([c.position for _, c in cameras])
    with np.errstate(invalid="ignore", over="ignore"):
        local = np.einsum("fji,fj->fi", rotation_matrix(track.quaternion), eyes - track.position)
    near = np.array([_near_reach(c) for _, c in cameras])
    solid = part.solid
    found: list[_Bad] = []
    _, first = np.unique(np.column_stack([local, near]), axis=0, return_index=True)
    fresh = np.zeros(len(local), dtype=bool)
    fresh[first] = True  # a camera that stands still is looked at once
    close = np.flatnonzero(fresh & ((local > solid.lower - near[:, None]) & (local < solid.upper + near[:, None])).all(axis=1))
    if len(close):
        for k in close[contains(solid, local[close])][:1]:
            found.append(_Bad(cameras[k][0], part.entity, f"is inside {part.entity}"))
        distance = distance_to_surface(solid, local[close]).distance
        for k in close[distance <= near[close]][:1]:
            text = f"is within {near[k] * 1e3:.2g} mm of {part.entity}, which its near plane cuts open,"
            found.append(_Bad(cameras[k][0], part.entity, text))
    low, high = np.minimum(local[:-1], local[1:]), np.maximum(local[:-1], local[1:])
    passing = ((low <= solid.upper) & (high >= solid.lower)).all(axis=1) & (np.abs(high - low) > 0.0).any(axis=1)
    for k in np.flatnonzero(passing):
        if _crosses(local[k], local[k + 1], solid.triangles):
            found.append(_Bad(cameras[k + 1][0], part.entity, f"has passed through {part.entity}"))
            break
    return min(found, default=None)


def _near_reach(camera: Camera) -> float:
    """Distance from the eye to the corners of the near plane [m]."""
    tall = math.tan(math.radians(camera.fov_deg) / 2.0)
    return NEAR_PLANE * math.sqrt(1.0 + tall * tall * (1.0 + (camera.width / camera.height) ** 2))


def _crosses(start: F64, end: F64, triangles: F64) -> bool:
    """True if a segment meets any of the triangles."""
    low, high = np.minimum(start, end), np.maximum(start, end)
    triangles = triangles[((triangles.min(axis=1) <= high) & (triangles.max(axis=1) >= low)).all(axis=1)]
    return bool((ray_hits(triangles, start[None], (end - start)[None]) <= 1.0).any())


class _Step(NamedTuple):
    """Change of a picture in one frame, in widths."""

    share: float
    what: str
    frame: int
    entity: str | None = None
    """The subject that moves on the picture."""


def _steps(frame: int, one: Camera, two: Camera) -> list[_Step]:
    """Change of the picture of camera `one` from the frame before to camera `two`."""
    middle = np.array([two.width / 2, two.height / 2])
    reach = LEVER * one.width / one.focal * float(np.linalg.norm(one.target - one.position))
    marks = np.array([one.target, one.target + reach * one.axes[0], one.target + reach * one.axes[1]])
    pixels, depth = two.project(marks)
    travelled = float(np.linalg.norm(two.position - one.position) / np.linalg.norm(two.target - two.position))
    steps = [_Step(travelled, "the camera travels, of its distance to the target,", frame)]
    if (depth <= 0.0).any():
        return [*steps, _Step(1.0, "the aim moves by", frame)]
    steps.append(_Step(float(np.linalg.norm(pixels[0] - middle)) / two.width, "the aim moves by", frame))
    arm = LEVER * two.width
    turned = max(np.linalg.norm(pixels[1] - pixels[0] - (arm, 0.0)), np.linalg.norm(pixels[2] - pixels[0] - (0.0, -arm)))
    # At the picture's sides, half a width from the aim.
    return [*steps, _Step(float(turned) / arm / 2.0, "the picture's sides turn or zoom by", frame)]


def moves(sight: Sight, shot_id: str, shot: Shot) -> Finding:
    """Judge whether the picture, and the subjects on it, move slowly enough to be followed."""
    candidate, frames = sight.candidate, shot.frames
    last = frames[1] if shot.follow is None else min(frames[1], candidate.last_frame)
    if last < frames[0]:
        return Finding("unverified", f"{shot.follow} is not simulated in its frames", frames=frames)
    cameras = _cameras(sight, shot_id, shot, last)
    steps = [step for (_, one), (frame, two) in pairwise(cameras) for step in _steps(frame, one, two)]
    everything = [*steps, *_subject_steps(candidate, cameras, shot)]
    worst = max(everything, key=lambda s: s.share, default=_Step(0.0, "the camera stands still:", frames[0]))
    at = min((s.frame for s in everything if s.share > SCREEN_STEP), default=None)
    what = "the camera stands still:" if worst.share == 0.0 else worst.what
    text = f"{what} at most {worst.share:.3f} per frame" + (f", too much first at frame {at}" if at is not None else "")
    complete = last == frames[1]
    hint = correction(
        "the camera jumps, or what it shows crosses the picture too fast",
        "shots",
        f"spread the keys of shot {shot_id} over more frames, cut into two shots, or show it from farther away",
        pointers=(f"/shots/{shot_id}/keys", f"/shots/{shot_id}/transition"),
        patch=_steady(candidate, cameras, shot_id, shot),
    )
    return Finding(
        "fail" if at is not None else "pass" if complete else "unverified",
        text if complete else f"{text}; only up to frame {last}",
        worst.share,
        SCREEN_STEP,
        entity=worst.entity if at is not None else None,
        frame=at,
        hints=(hint,),
        entities=tuple(subjects_of(candidate, shot)),
        frames=frames,
    )


def _subject_steps(candidate: Candidate, cameras: list[tuple[int, Camera]], shot: Shot) -> list[_Step]:
    """Moves of the subjects' centres on the picture, while they are in it at both frames and within the simulated ones."""
    found = []
    for name in subjects_of(candidate, shot):
        centers = judge_of(candidate.spec, name).centers(candidate, name)
        for (before, one), (after, two) in pairwise(cameras):
            if after > candidate.last_frame or not np.isfinite(centers[[before, after]]).all():
                continue
            if one.in_frame(centers[before][None])[0] and two.in_frame(centers[after][None])[0]:
                step = two.project(centers[after][None])[0][0] - one.project(centers[before][None])[0][0]
                found.append(_Step(float(np.linalg.norm(step)) / two.width, f"{name} moves on the picture by", after, name))
    return found


def _steady(candidate: Candidate, cameras: list[tuple[int, Camera]], shot_id: str, shot: Shot) -> list[dict[str, Any]]:
    """The edit that keeps one key's aim throughout: the first's, or that of a later key with more of the subjects in its picture."""
    keys, eyes = candidate.aimed(shot).keys, dict(cameras)
    shown = {name: _shown(candidate, shot, key.frame, eyes.get(key.frame)) for name, key in keys.items()}
    kept = keys[max(keys, key=lambda name: (shown[name], -keys[name].frame))]
    edits: list[dict[str, Any]] = []
    for name, key in sorted(keys.items(), key=lambda item: item[1].frame):
        if key.target == kept.target:
            continue
        place = f"/shots/{shot_id}/keys/{name}"
        if shot.keys[name].look_at is not None:
            edits.append({"op": "remove", "path": f"{place}/look_at"})
        edits.append({"op": "add", "path": f"{place}/target", "value": list(kept.target or ())})
    return edits


def _shown(candidate: Candidate, shot: Shot, frame: int, camera: Camera | None) -> int:
    """Number of the shot's subjects whose centre is in the picture at a frame; none where it is not simulated."""
    if camera is None or frame > candidate.last_frame:
        return 0
    centers = [judge_of(candidate.spec, name).centers(candidate, name)[frame] for name in subjects_of(candidate, shot)]
    return sum(bool(np.isfinite(c).all() and camera.in_frame(c[None])[0]) for c in centers)
