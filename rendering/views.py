"""Which camera looks at a frame, and what of a candidate is worth framing."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..geometry.camera import Camera, camera_at
from ..worlds.arrays import F64, RigidPose, compose, pose_of, rotation_matrix
from ..worlds.built import BuiltPart
from ..worlds.candidate import Candidate
from ..worlds.errors import InputError
from ..worlds.spec import Shot
from .categories.registry import layers_of

if TYPE_CHECKING:
    from ..worlds.spec import WorldSpec

__all__ = ["Bounds", "active", "automatic_camera", "camera_for", "focus_bounds", "shot_of"]

BACKDROP_RATIO = 4.0
"""A static entity more than this many times larger than all the others together is a backdrop; own choice."""
PATH_RATIO = 3.0
"""Most by which paths widen the view, in diagonals; own choice."""
AUTOMATIC_FOV = 32.0
"""Vertical field of view of the automatic camera [deg]."""


class Bounds(NamedTuple):
    """Axis-aligned box [m]; each corner has shape (3,)."""

    low: F64
    high: F64

    @property
    def center(self) -> F64:
        """Middle of the box, shape (3,)."""
        return 0.5 * (self.low + self.high)

    @property
    def diagonal(self) -> float:
        """Length of the diagonal [m]."""
        return float(np.linalg.norm(self.high - self.low))

    def corners(self) -> F64:
        """The eight corners, shape (8, 3)."""
        pick = np.array([[(k >> a) & 1 for a in range(3)] for k in range(8)], dtype=bool)
        return np.where(pick, self.high, self.low)


def active(candidate: Candidate, entity: str, frame: int) -> bool:
    """True if the entity exists at `frame`."""
    interval = candidate.spec.entities[entity].active
    return interval is None or interval[0] <= frame <= interval[1]


def _bounds(candidate: Candidate, entity: str, frame: int) -> Bounds:
    vertices = candidate.vertices(entity, frame)
    return Bounds(vertices.min(0), vertices.max(0))


def _union(boxes: list[Bounds]) -> Bounds:
    return Bounds(np.min([b.low for b in boxes], axis=0), np.max([b.high for b in boxes], axis=0))


def focus_bounds(candidate: Candidate) -> Bounds:
    """Box around what matters: everything but backdrops, the paths that its bodies take, and gas where it is seen.

    Paths count within `PATH_RATIO` diagonals of the box at frame 0 and never downwards, so that a body that falls
    out of the world does not shrink the rest to a dot.
    """
    if not candidate.built:
        raise InputError("nothing is built, so there is nothing to look at; call place_object or build_terrain")
    boxes = {name: _bounds(candidate, name, 0) for name in candidate.built}
    static = [n for n in boxes if candidate.spec.entities[n].motion == "static"]
    for name in sorted(static, key=lambda n: -boxes[n].diagonal):
        rest = [b for n, b in boxes.items() if n != name]
        if not rest or boxes[name].diagonal <= BACKDROP_RATIO * _union(rest).diagonal:
            break
        del boxes[name]
    start = _union(list(boxes.values()))
    reach = Bounds(start.low - PATH_RATIO * start.diagonal, start.high + PATH_RATIO * start.diagonal)
    boxes_all = [start]
    for name in boxes:
        if not candidate.moves(name) or candidate.frame_count == 1:
            continue
        own = candidate.vertices(name, 0)
        radius = 0.5 * float(np.linalg.norm(np.ptp(own, axis=0)))
        for body in candidate.entity(name).bodies:
            places = candidate.track(name, body.name)[0]
            boxes_all.append(
                Bounds(
                    np.clip(places.min(0) - radius, reach.low, reach.high), np.clip(places.max(0) + radius, reach.low, reach.high)
                )
            )
    boxes_all += [Bounds(low, high) for layer in layers_of(candidate).loose for low, high in layer.extents()]
    low = _union(boxes_all).low
    low[2] = max(low[2], start.low[2])
    return Bounds(low, _union(boxes_all).high)


def automatic_camera(candidate: Candidate, width: int, height: int) -> Camera:
    """Three-quarter view that frames all entities but backdrops; the same for every frame."""
    box = focus_bounds(candidate)
    extent = box.high - box.low
    azimuth = math.radians(-62.0 if extent[0] >= extent[1] else -28.0)
    elevation = math.radians(26.0)
    towards = np.array([math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)])
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)
    half_y = math.tan(math.radians(AUTOMATIC_FOV) / 2) * 0.92
    half_x = half_y * width / height
    corners = box.corners() - box.center
    depth = corners @ towards
    distance = float(
        np.max(np.concatenate([np.abs(corners @ right) / half_x, np.abs(corners @ up) / half_y]) + np.tile(depth, 2))
    )
    distance = max(distance, 1e-3)
    position = box.center + distance * towards
    return Camera(position, box.center, AUTOMATIC_FOV, width, height)


def shot_of(spec: WorldSpec, frame: int) -> str | None:
    """Id of the shot that covers `frame`, or None."""
    return next((name for name, shot in spec.shots.items() if shot.frames[0] <= frame <= shot.frames[1]), None)


def _follow_offset(candidate: Candidate, shot: Shot, frame: int) -> F64:
    """Motion of the followed entity's centre of mass since the shot's first key [m], shape (3,)."""
    if shot.follow is None:
        return np.zeros(3)
    first = min(key.frame for key in shot.keys.values())
    last = candidate.last_frame
    return candidate.center(shot.follow, min(frame, last)) - candidate.center(shot.follow, min(first, last))


def camera_for(candidate: Candidate, frame: int, *, shot: str | None = None, width: int, height: int) -> Camera:
    """Camera of `shot`, or of the shot that covers `frame`, or the automatic view.

    Raises:
        InputError: there is no such shot.
    """
    spec = candidate.spec
    if shot is not None and shot not in spec.shots:
        raise InputError(f"no shot {shot!r}; shots are {sorted(spec.shots)}; add /shots/{shot} with edit_spec")
    name = shot if shot is not None else shot_of(spec, frame)
    if name is None:
        return automatic_camera(candidate, width, height)
    plan = candidate.aimed(spec.shots[name])
    return camera_at(plan, frame, width, height, _follow_offset(candidate, plan, frame))


def pattern_frame(candidate: Candidate, entity: str, part: BuiltPart) -> RigidPose:
    """The frame in its body's frame in which a part's pattern lies: its own one, or the body's for generated parts.

    Tiles of what never moves lie in the world's, where its faces are square to that: they go on from one part and entity to the next.
    """
    declared = candidate.spec.entities[entity].parts.get(part.part)
    own = RigidPose(np.zeros(3), np.array([1.0, 0, 0, 0])) if declared is None else pose_of(declared.pose)
    if (
        candidate.spec.materials[part.material].appearance.pattern not in ("tiles", "bricks")
        or candidate.spec.entities[entity].motion != "static"
    ):
        return own
    body = candidate.pose(entity, 0, part.body)
    turn = np.abs(rotation_matrix(compose(body, own).quaternion))
    return body.inverse() if np.isclose(turn, np.round(turn), atol=1e-6).all() else own
