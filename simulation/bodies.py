"""States of the bodies that an instance meets: at rest, or read from a cache."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..worlds.arrays import F64, RigidPose, rotation_matrix
from ..worlds.cache import Cache
from ..worlds.errors import EvidenceError
from .boundaries import BodyState, SoftBoundary, Surround
from .soft_surfaces import VertexPath

__all__ = ["CacheMotion", "lay_vertices", "resting"]


def resting(surround: Surround) -> BodyState:
    """All boundaries at rest at their places of frame 0, none of them reacting."""
    rotation = np.array([rotation_matrix(p.quaternion) for p in surround.start]).reshape(-1, 3, 3)
    position = np.array([p.position for p in surround.start]).reshape(-1, 3)
    state = _fixed(position, rotation, _centers(surround, position, rotation))
    for row in surround.soft:
        place = surround.boundaries[row].mesh.vertices
        state.vertices[row] = (place, np.zeros_like(place))
    return state


def lay_vertices(state: BodyState, row: int, soft: SoftBoundary, places: F64, speeds: F64) -> None:
    """Write the vertices of a deforming boundary, shape (v, 3) [m] and [m/s], and with them its centre of mass."""
    share = soft.mass / soft.mass.sum()
    state.vertices[row] = (places, speeds)
    state.center[row], state.velocity[row] = share @ places, share @ speeds


def _centers(surround: Surround, position: F64, rotation: F64) -> F64:
    local = np.array([b.center for b in surround.bodies]).reshape(-1, 3)
    return np.asarray(position + np.einsum("nij,nj->ni", rotation, local))


def _fixed(position: F64, rotation: F64, center: F64) -> BodyState:
    count = len(position)
    zero = np.zeros((count, 3))
    return BodyState(position, rotation, center, zero, zero.copy(), np.zeros(count), np.zeros((count, 3, 3)), zero.copy())


class CacheMotion:
    """Bodies on the paths that rigid caches hold: straight and evenly turning between two frames.

    Velocities are those of that path, so that positions and velocities agree; no body reacts (a one-way coupling).

    Args:
        surround: the boundaries that move.
        caches: of rigid instances and of cloth, by id.
        fps: of the caches.

    Raises:
        EvidenceError: a moving boundary is in no cache.
    """

    def __init__(self, surround: Surround, caches: Mapping[str, Cache], fps: int) -> None:
        self._surround, self._fps = surround, fps
        self._resting = resting(surround)
        self._rows: list[tuple[int, Cache, int]] = []
        for row, boundary in enumerate(surround.boundaries):
            if boundary.motion == "static" or boundary.deforming:
                continue
            entity, body = boundary.name.split("/", 1)
            found = [(row, c, at) for c in caches.values() if (at := c.body_row(entity, body)) is not None]
            if not found:
                raise EvidenceError(f"no rigid cache moves {boundary.name!r}; bake its instance first")
            self._rows.append(found[0])
        self._kept: dict[int, dict[int, tuple[F64, F64]]] = {}
        self._paths = {row: VertexPath(soft, caches, fps) for row, soft in surround.soft.items()}

    def _frame(self, frame: int) -> list[RigidPose]:
        """Poses of the moving rows at a frame."""
        poses = []
        for _, cache, at in self._rows:
            kept = self._kept.setdefault(id(cache), {})
            if frame not in kept:
                data = cache.read(frame, ("position", "quaternion"))
                kept[frame] = (data["position"], data["quaternion"])
                for old in [k for k in kept if k < frame - 1]:
                    del kept[old]
            poses.append(RigidPose(kept[frame][0][at], kept[frame][1][at]))
        return poses

    def state(self, start: float, end: float) -> BodyState:
        """Bodies at `start` [s], with the velocity of the frame that the interval lies in."""
        rest = self._resting
        if not self._rows and not self._paths:
            return rest
        from scipy.spatial.transform import Rotation

        frame = int(0.5 * (start + end) * self._fps)
        share = min(max(start * self._fps - frame, 0.0), 1.0)
        position, rotation, center = rest.position.copy(), rest.rotation.copy(), rest.center.copy()
        velocity, spin = rest.velocity.copy(), rest.angular_velocity.copy()
        for (row, _, _), a, b in zip(self._rows, self._frame(frame), self._frame(frame + 1), strict=True):
            first, last = (Rotation.from_quat(p.quaternion[[1, 2, 3, 0]]) for p in (a, b))
            turn = (last * first.inv()).as_rotvec()
            now = Rotation.from_rotvec(share * turn) * first
            local = self._surround.bodies[row].center
            ends = [p.position + r.apply(local) for p, r in ((a, first), (b, last))]
            rotation[row] = now.as_matrix()
            center[row] = ends[0] + share * (ends[1] - ends[0])
            position[row] = center[row] - rotation[row] @ local
            velocity[row], spin[row] = (ends[1] - ends[0]) * self._fps, turn * self._fps
        state = _fixed(position, rotation, center)
        state.velocity, state.angular_velocity = velocity, spin
        for row, path in self._paths.items():
            lay_vertices(state, row, self._surround.soft[row], *path.at(frame, share))
        return state
