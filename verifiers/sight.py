"""What the shots of a candidate see: entity ids per pixel, cast once per shot and frame (R98, S9)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..geometry import Camera, IdCaster, IdImage, camera_at, contains
from ..worlds.arrays import F64, RigidPose
from ..worlds.built import TriangleMesh
from ..worlds.errors import EvidenceError, InputError
from .surfaces import surfaces_of

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate
    from ..worlds.spec import CameraKey, Shot

__all__ = ["PIXELS_HIGH", "Seen", "Sight"]

PIXELS_HIGH = 108
"""Own choice: a subject of the default 0.0004 of the picture has 8 pixels at 192 x 108, enough to be judged."""


@dataclass(frozen=True)
class Seen:
    """How one entity appears in one picture."""

    frame: int
    shot: str
    share: float
    """Of the picture that shows the entity."""
    unoccluded: float
    """Pixels seen / pixels seen if nothing else were there; 0 where it is out of the picture."""
    hidden_by: str | None
    """Entity in front of most of the hidden pixels."""
    in_picture: bool
    """Whether any pixel would show it if nothing else were there."""


class Sight:
    """Casts pictures of a candidate and remembers them."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate
        look = candidate.spec.look
        self.height = PIXELS_HIGH
        self.width = max(16, round(PIXELS_HIGH * look.width / look.height))
        self._instances: list[tuple[str, str]] = []
        meshes = []
        for name in candidate.spec.entities:
            built = candidate.entity(name)
            for body in built.bodies:
                parts = built.parts_of(body.name)
                if parts:
                    self._instances.append((name, body.name))
                    meshes.append(_joined([p.render for p in parts]))
        self._caster = IdCaster(meshes)
        self._full: dict[tuple[str, int], IdImage] = {}

    def camera(self, shot_id: str, frame: int, *, shot: Shot | None = None) -> Camera:
        """Camera of a shot at a frame; the target moves with the followed entity's centre of mass.

        Raises:
            EvidenceError: the shot's camera cannot be placed.
        """
        plan = shot or self.candidate.spec.shots[shot_id]
        offset = None if plan.follow is None else self.offset(plan, frame)
        try:
            return camera_at(plan, frame, self.width, self.height, offset)
        except InputError as error:
            raise EvidenceError(f"shot {shot_id!r} at frame {frame}: {error}") from error

    def offset(self, shot: Shot, frame: int) -> F64:
        """Motion of the followed entity's centre of mass since the shot's first key [m], shape (3,).

        Raises:
            EvidenceError: it is not finite.
        """
        if shot.follow is None:
            return np.zeros(3)
        last, first = self.candidate.last_frame, min(k.frame for k in shot.keys.values())
        moved: F64 = self.candidate.center(shot.follow, min(frame, last)) - self.candidate.center(shot.follow, min(first, last))
        if not np.isfinite(moved).all():
            raise EvidenceError(f"followed entity {shot.follow!r} has no finite position at frame {frame}")
        return moved

    def poses(self, frame: int) -> list[RigidPose]:
        """Pose of every instance.

        Raises:
            EvidenceError: one is not finite.
        """
        at = min(frame, self.candidate.last_frame)
        found = [self.candidate.pose(entity, at, body) for entity, body in self._instances]
        for (entity, _), pose in zip(self._instances, found, strict=True):
            if not (np.isfinite(pose.position).all() and np.isfinite(pose.quaternion).all()):
                raise EvidenceError(f"{entity!r} has no finite pose at frame {at}")
        return found

    def seen(self, entity: str, shot_id: str, frame: int) -> Seen:
        """How `entity` appears in the shot at the frame."""
        camera = self.camera(shot_id, frame)
        key = (shot_id, frame)
        if key not in self._full:
            self._full[key] = self._caster.cast(camera, self.poses(frame))
        return self._compare(entity, shot_id, frame, camera, self._full[key])

    def try_camera(self, entity: str, key: CameraKey, frame: int) -> Seen:
        """How `entity` would appear at a frame from another camera."""
        camera = Camera(np.array(key.position), np.array(key.target), key.fov_deg, self.width // 2, self.height // 2)
        return self._compare(entity, "", frame, camera, self._caster.cast(camera, self.poses(frame)))

    def _compare(self, entity: str, shot_id: str, frame: int, camera: Camera, image: IdImage) -> Seen:
        own = [i for i, (name, _) in enumerate(self._instances) if name == entity]
        if not own:
            raise EvidenceError(f"entity {entity!r} has no visible geometry")
        alone = np.isin(self._caster.cast(camera, self.poses(frame), only=own).ids, own)
        visible = np.isin(image.ids, own)
        expected, shown = int(alone.sum()), int((visible & alone).sum())
        hidden = image.ids[alone & ~visible]
        hider = None
        if len(hidden):
            counts = np.bincount(hidden[hidden >= 0], minlength=1)
            hider = self._instances[int(np.argmax(counts))][0] if counts.sum() else None
        unoccluded = shown / expected if expected else 0.0
        return Seen(frame, shot_id, int(visible.sum()) / visible.size, unoccluded, hider, expected > 0)

    def inside(self, point: F64, frame: int) -> str | None:
        """Entity inside whose solid a point lies at a frame; None in the open."""
        surfaces = surfaces_of(self.candidate)
        at = min(frame, self.candidate.last_frame)
        for part in surfaces.parts:
            if not part.solid.closed:
                continue
            local = surfaces.track(part.entity, part.body).at(at).inverse().apply(point[None])
            if ((local > part.solid.lower) & (local < part.solid.upper)).all() and contains(part.solid, local)[0]:
                return part.entity
        return None


def _joined(meshes: list[TriangleMesh]) -> TriangleMesh:
    starts = np.concatenate([[0], np.cumsum([len(m.vertices) for m in meshes])])
    faces = np.concatenate([np.asarray(m.faces, dtype=np.int64) + s for m, s in zip(meshes, starts, strict=False)])
    return TriangleMesh(np.concatenate([m.vertices for m in meshes]), faces.astype(np.int32))
