"""Pixels of an entity in the shots of a candidate, and which of them nothing stands in front of (R98, S9).

Only what can be in front of the entity is cast, and only where the entity is in the picture: about 2 ms per look in a
world of 200 boxes (2 cores, 2026-11). Small entities are cast again with finer pixels. Glass hides nothing, and a surface
that shares its plane with another shows no more than that other.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import Camera, IdCaster, camera_at, contains
from ...worlds.arrays import F64, RigidPose, rotation_matrix
from ...worlds.built import TriangleMesh
from ...worlds.categories.registry import shape_of
from ...worlds.errors import EvidenceError, InputError
from ..categories.judge import joined
from ..categories.registry import JUDGES, judge_of
from ..scene.surfaces import surfaces_of
from .lattice import lattice, upright

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import CameraKey, Shot

__all__ = ["PIXELS_HIGH", "Mask", "Seen", "Sight", "sight_of"]

PIXELS_HIGH = 108
"""Own choice: pictures are cast at 192 x 108, where a subject of the default 0.0004 of the picture has 8 pixels."""
FINE_BELOW = 600
"""Own choice: an entity of fewer pixels is looked at again with finer ones, so that its share is known within 2 %."""
FINE_PIXELS = 5000
"""Pixels that it then fills, about."""
FINE, FINEST = 8, 32
"""Factors by which pictures are finer, per side, where no pixel centre hit it, and at most; of particles, whose many small errors level out, no finer than the first."""
DOUBT = 0.15
"""The same for one whose unoccluded share is within this of the bound."""
GLASS = 0.5
"""Own choice: a part of a material with at least this transmission hides nothing."""
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=bool)
COPLANAR = 2e-6
"""Surfaces whose depths differ by less than this share of it are in one place: single precision of the renderer."""


@dataclass(frozen=True)
class Seen:
    """Appearance of one entity in one picture."""

    frame: int
    shot: str
    share: float
    """Share of the picture that shows the entity."""
    unoccluded: float
    """Pixels seen / pixels seen if nothing else were there; 0 where it is out of the picture."""
    hidden_by: str | None
    """Entity in front of most of the hidden pixels."""
    in_picture: bool
    """True if any pixel would show it if nothing else were there."""


class Mask(NamedTuple):
    """Pixels of one entity in one picture, each array of shape (height, width)."""

    own: NDArray[np.bool_]
    """That would show it if nothing else were there."""
    visible: NDArray[np.bool_]
    """That show it."""
    hidden_by: str | None
    """Entity in front of most of the others."""


class _Cast(NamedTuple):
    """One entity in a window of a picture: pixels that would show it, those that do, and instances in front of it."""

    window: tuple[int, int, int, int]
    hit: NDArray[np.bool_]
    visible: NDArray[np.bool_]
    front: NDArray[np.int32]


BEHIND = 1e-3
"""Share of an entity's depth: a surface farther behind it than this hides none of it, however depths are rounded."""
STILL = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
"""Pose of loose matter, whose meshes are in the world."""
HELD_SHAPES = 16
"""Frames whose deformed solids are kept."""
HELD_FACES = 4_000_000
"""Frames whose loose matter has so many faces together are kept."""


class _Scene:
    """Shapes that are cast at one frame: instances, one per entity, body and whether it is of glass."""

    def __init__(self, instances: list[tuple[str, str]], meshes: list[TriangleMesh], glass: list[bool]) -> None:
        self.instances, self.meshes = instances, meshes
        self.caster = IdCaster(meshes)
        self.glass = np.array(glass, dtype=bool)
        self.owner = np.array([name for name, _ in instances])
        # The eight corners of every instance's box in its body's frame, shape (instances, 8, 3).
        low, high = (np.array([f(m.vertices, axis=0) for m in meshes]).reshape(-1, 1, 3) for f in (np.min, np.max))
        self.corners = np.where(CORNERS, high, low)

    def joined(self, instances: list[tuple[str, str]], meshes: list[TriangleMesh], glass: list[bool]) -> _Scene:
        """This and more."""
        return _Scene(self.instances + instances, self.meshes + meshes, [*self.glass.tolist(), *glass])


class Sight:
    """Casts pictures of a candidate and remembers them."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate
        look = candidate.spec.look
        self.height = PIXELS_HIGH
        self.width = max(16, round(PIXELS_HIGH * look.width / look.height))
        instances: list[tuple[str, str]] = []
        meshes, glass = [], []
        self._soft: dict[int, tuple[str, ...]] = {}
        self._shaped: dict[int, _Scene] = {}
        for name in candidate.solids:
            built = candidate.entity(name)
            for body in built.bodies:
                for clear in (False, True):
                    parts = [p for p in built.parts_of(body.name) if self._clear(p.material) == clear]
                    if parts:
                        instances.append((name, body.name))
                        meshes.append(joined([p.render for p in parts]))
                        if name in candidate.deforming:
                            self._soft[len(meshes) - 1] = tuple(p.part for p in parts)
                        glass.append(clear)
        self._solid = _Scene(instances, meshes, glass)
        self._scenes: dict[int, _Scene] = {}
        self._seen: dict[tuple[str, str, int], Seen] = {}
        self._views: dict[tuple[str, bytes], Seen] = {}

    def _clear(self, material: str) -> bool:
        found = self.candidate.spec.materials.get(material)
        return found is not None and found.appearance.transmission >= GLASS

    @cached_property
    def _loose(self) -> tuple[str, ...]:
        """Entities without a surface of their own, which have another shape at every frame; without those that no engine moves."""
        entities = self.candidate.spec.entities
        return tuple(n for n, e in entities.items() if shape_of(e) == "loose" and e.physics.category in JUDGES)

    @cached_property
    def _veils(self) -> bool:
        """True if any liquid can hide what is behind it."""
        return any(not self._clear(self.candidate.spec.entities[n].material) for n in self._loose)

    def _flows(self, entity: str) -> bool:
        """True if pictures of an entity depend on where liquids are: it is one, or one can hide it."""
        return entity in self._loose or self._veils

    def _scene(self, frame: int, entity: str) -> _Scene:
        """Shapes of a frame, liquids included where pictures of the entity depend on them.

        Raises:
            EvidenceError: a liquid has no readable shape.
        """
        liquids = self._loose
        at = min(frame, self.candidate.last_frame)
        if not self._flows(entity):
            return self._at(at)
        if at not in self._scenes:
            meshes = {n: judge_of(self.candidate.spec, n).outline(self.candidate, n, at) for n in liquids}
            there = [n for n in liquids if len(meshes[n].faces)]
            clear = [self._clear(self.candidate.spec.entities[n].material) for n in there]
            while self._scenes and sum(len(m.faces) for s in self._scenes.values() for m in s.meshes) > HELD_FACES:
                self._scenes.pop(next(iter(self._scenes)))
            self._scenes[at] = self._at(at).joined([(n, "") for n in there], [meshes[n] for n in there], clear)
        return self._scenes[at]

    def _at(self, frame: int) -> _Scene:
        """The solids at a frame: deforming ones have another shape at every one."""
        if not self._soft:
            return self._solid
        if frame not in self._shaped:
            while len(self._shaped) >= HELD_SHAPES:
                self._shaped.pop(next(iter(self._shaped)))
            meshes = list(self._solid.meshes)
            for k, parts in self._soft.items():
                entity = self._solid.instances[k][0]
                shapes = [self.candidate.shape(entity, part, frame) for part in parts]
                meshes[k] = TriangleMesh(np.concatenate(shapes), meshes[k].faces)
            self._shaped[frame] = _Scene(self._solid.instances, meshes, self._solid.glass.tolist())
        return self._shaped[frame]

    def camera(self, shot_id: str, frame: int, *, shot: Shot | None = None) -> Camera:
        """Camera of a shot at a frame; the target moves with the followed entity's centre of mass.

        Raises:
            EvidenceError: the shot's camera cannot be placed.
        """
        plan = self.candidate.aimed(shot or self.candidate.spec.shots[shot_id])
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

    def poses(self, frame: int, entity: str) -> list[RigidPose]:
        """Pose of every instance of the scene in which an entity is looked at.

        Raises:
            EvidenceError: one is not finite.
        """
        at = min(frame, self.candidate.last_frame)
        instances = self._scene(frame, entity).instances
        found = [self.candidate.pose(entity, at, body) if body else STILL for entity, body in instances]
        for (entity, _), pose in zip(instances, found, strict=True):
            if not (np.isfinite(pose.position).all() and np.isfinite(pose.quaternion).all()):
                raise EvidenceError(f"{entity!r} has no finite pose at frame {at}")
        return found

    def seen(self, entity: str, shot_id: str, frame: int) -> Seen:
        """Appearance of `entity` in the shot at the frame."""
        key = (entity, shot_id, frame)
        if key not in self._seen:
            camera, poses = self.camera(shot_id, frame), self.poses(frame, entity)
            # Where nothing moves, one look does for many frames.
            changing = self._flows(entity) or bool(self._soft)
            flowing = [float(min(frame, self.candidate.last_frame))] if changing else []
            view = np.concatenate(
                [flowing, camera.position, camera.target, [camera.fov_deg], *(np.concatenate(p) for p in poses)]
            )
            same = (entity, view.tobytes())
            if same not in self._views:
                self._views[same] = self._look(entity, shot_id, frame, camera)
            self._seen[key] = replace(self._views[same], frame=frame, shot=shot_id)
        return self._seen[key]

    def try_camera(self, entity: str, key: CameraKey, frame: int) -> Seen:
        """Appearance of `entity` at a frame from another camera."""
        camera = Camera(np.array(key.position), np.array(key.target, dtype=np.float64), key.fov_deg, self.width, self.height)
        return self._look(entity, "", frame, camera)

    def _look(self, entity: str, shot_id: str, frame: int, camera: Camera) -> Seen:
        scene, poses = self._scene(frame, entity), self.poses(frame, entity)
        own = scene.owner == entity
        if not own.any():
            if entity in self._loose:  # all of it is gone, or none has come yet
                return Seen(frame, shot_id, 0.0, 0.0, None, in_picture=False)
            raise EvidenceError(f"entity {entity!r} has no visible geometry")
        found = self._compare(scene, camera, poses, own)
        share = 0.0 if found[0] == 0 else found[1] / found[0]
        bound = self.candidate.spec.simulation.limits.visible_share
        if found[0] < FINE_BELOW or abs(share - bound) <= DOUBT * bound:
            finest = FINE if judge_of(self.candidate.spec, entity).grainy else FINEST
            finer = FINE if found[0] == 0 else min(finest, math.ceil(math.sqrt(FINE_PIXELS / found[0])))
            size = (finer * camera.width, finer * camera.height)
            found = self._compare(scene, lattice(camera, size), poses, own, size)
            camera = replace(camera, width=size[0], height=size[1])
        expected, shown, hider = found
        return Seen(
            frame, shot_id, shown / (camera.width * camera.height), shown / expected if expected else 0.0, hider, expected > 0
        )

    def _compare(
        self,
        scene: _Scene,
        camera: Camera,
        poses: list[RigidPose],
        own: NDArray[np.bool_],
        size: tuple[int, int] | None = None,
    ) -> tuple[int, int, str | None]:
        """Pixels that the own instances would fill alone, those they do fill, and who hides most of the others.

        Args:
            scene: what is there.
            camera: a view.
            poses: of every instance.
            own: which instances are looked for.
            size: what of a turned view counts: width and height of the upright picture in its middle [pixels].
        """
        found = self._cast(scene, camera, poses, own, size)
        if found is None:
            return 0, 0, None
        return int(found.hit.sum()), int(found.visible.sum()), _hider(scene, found)

    def mask(self, entity: str, shot_id: str, frame: int, size: tuple[int, int]) -> Mask:
        """Pixels of `entity` in the shot's picture of a size (width, height) at a frame.

        Raises:
            EvidenceError: it has no visible geometry, or no finite place.
        """
        camera = replace(self.camera(shot_id, frame), width=size[0], height=size[1])
        scene = self._scene(frame, entity)
        own = scene.owner == entity
        if not own.any() and entity not in self._loose:
            raise EvidenceError(f"entity {entity!r} has no visible geometry")
        alone, visible = np.zeros((2, size[1], size[0]), dtype=bool)
        found = self._cast(scene, camera, self.poses(frame, entity), own) if own.any() else None
        if found is None:
            return Mask(alone, visible, None)
        left, right, top, bottom = found.window
        alone[top:bottom, left:right] = found.hit
        visible[top:bottom, left:right] = found.visible
        return Mask(alone, visible, _hider(scene, found))

    def _cast(
        self,
        scene: _Scene,
        camera: Camera,
        poses: list[RigidPose],
        own: NDArray[np.bool_],
        size: tuple[int, int] | None = None,
    ) -> _Cast | None:
        """The own instances in a picture, None where no pixel would show them; arguments as `_compare`."""
        rectangle, nearest = _bounds(scene, camera, poses)
        ends = np.array([camera.width, camera.height, camera.width, camera.height])
        limits = np.clip([*np.floor(rectangle[own, :2].min(axis=0)), *np.ceil(rectangle[own, 2:].max(axis=0))], 0, ends)
        left, top, right, bottom = (int(v) for v in limits)
        if left >= right or top >= bottom:
            return None
        window = (left, right, top, bottom)
        alone = scene.caster.cast(camera, poses, only=np.flatnonzero(own).tolist(), window=window, normals=False)
        hit = alone.ids >= 0
        if size is not None:
            hit &= upright(camera, size, window)
        if not hit.any():
            return None
        farthest = float(alone.depth[hit].max())
        meets = (rectangle[:, 0] < right) & (rectangle[:, 2] > left) & (rectangle[:, 1] < bottom) & (rectangle[:, 3] > top)
        before = meets & ~own & ~scene.glass & (nearest <= farthest * (1.0 + COPLANAR))
        front = scene.caster.cast(
            camera, poses, only=np.flatnonzero(before).tolist(), window=window, until=farthest * (1.0 + BEHIND), normals=False
        )
        visible = hit & (alone.depth.astype(np.float64) * (1.0 + COPLANAR) < front.depth)
        return _Cast(window, hit, visible, front.ids)

    def depth(self, camera: Camera, frame: int, *, without: Collection[str] = ()) -> NDArray[np.float32]:
        """Depth of the nearest opaque solid but some along the viewing axis [m], shape (height, width); inf where there is none."""
        at = min(frame, self.candidate.last_frame)
        scene = self._at(at)
        poses = [self.candidate.pose(entity, at, body) for entity, body in scene.instances]
        only = np.flatnonzero(~scene.glass & ~np.isin(scene.owner, list(without)))
        return scene.caster.cast(camera, poses, only=only.tolist(), normals=False).depth

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


def sight_of(candidate: Candidate) -> Sight:
    """The pictures of a candidate that all its judges share."""
    return candidate.memo(("sight",), lambda: Sight(candidate))


def _hider(scene: _Scene, found: _Cast) -> str | None:
    """Entity in front of most of the pixels that do not show what they would."""
    hidden = found.front[found.hit & ~found.visible]
    return str(scene.owner[int(np.bincount(hidden).argmax())]) if len(hidden) else None


def _bounds(scene: _Scene, camera: Camera, poses: list[RigidPose]) -> tuple[F64, F64]:
    """Pixels around every instance (x0, y0, x1, y1), shape (instances, 4), and its least depth [m], shape (instances,)."""
    turns = rotation_matrix(np.array([p.quaternion for p in poses]))
    places = np.array([p.position for p in poses]) - camera.position
    world = np.einsum("nij,nkj->nki", turns, scene.corners) + places[:, None]
    local = world @ camera.axes.T
    depth = -local[..., 2]
    ahead = depth > 0.0
    scale = camera.focal / np.where(ahead, depth, np.nan)
    pixels = np.stack([0.5 * camera.width + local[..., 0] * scale, 0.5 * camera.height - local[..., 1] * scale], axis=-1)
    rectangle = np.concatenate([pixels.min(axis=1), pixels.max(axis=1)], axis=1)
    # What reaches through the eye plane may be anywhere; what lies behind it is nowhere.
    rectangle[~ahead.all(axis=1)] = (-np.inf, -np.inf, np.inf, np.inf)
    rectangle[~ahead.any(axis=1)] = (np.inf, np.inf, -np.inf, -np.inf)
    return rectangle, np.maximum(depth.min(axis=1), 0.0)
