"""Pen: normalised maximum penetration depth of an executable world (R141-R144).

At 24 frames over the whole interval every pair of a dynamic object and a collider whose boxes meet is asked for triangles that cross. Of the
corners v of those triangles (at most 128 per direction), with nearest point pi_b(v) and outward normal n_b(v) on the other surface,

    d_ab = max_v [-(v - pi_b(v)) . n_b(v)]_+ ,    score = 100 / L * max over frames, pairs and directions,

at least 1e-4 m where triangles cross at all. Lower is better. It sees only corners of crossing triangles: of finely meshed bodies that are
sunk deep into each other it tells about the length of an edge. That is the paper's definition, kept so that scores compare; the
server's own row `contact` measures the true depth.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....geometry import Solid, mutual_crossings, query_noise
from ....geometry.inside import nearest_faces
from ....geometry.triangles import nearest_on_triangles
from ....worlds.arrays import F64, I32
from ....worlds.built import TriangleMesh

__all__ = [
    "CHOICES",
    "FRAMES",
    "LEAST_DEPTH",
    "VERTICES",
    "Evaluated",
    "Overlap",
    "Penetration",
    "overlaps",
    "penetration",
    "sampled_frames",
]

FRAMES = 24
"""K_p: frames over the complete interval (R141)."""
VERTICES = 128
"""Most corners that are asked per direction (R143)."""
LEAST_DEPTH = 1e-4
"""[m] Depth that a crossing of triangles counts at least (R143)."""
SAME = 1e-9
"""Own choice: points this close, relative to the distance from the query, are one nearest point."""
CHOICES = {
    "frames": "uniform over the interval with both ends, rounded to whole frames; of shorter films every frame",
    "objects": "an entity with all its parts; of a breakable one each piece; parts of one object are not compared with each other",
    "dynamic": "entities of motion `dynamic`; static and kinematic ones are colliders only",
    "matter": "solids that keep or change their form and sheets; liquids, gases and loose grains are no objects",
    "open_surfaces": "have no inside: their vertices are asked, but they are no colliders",
    "crossing": "beyond the noise of queries, 1e-9 of the pair's size; surfaces that only touch do not cross",
    "sample": "evenly spaced in the order of coordinates (x, then y, then z), where there are more than 128",
    "normal": "of the nearest face; of several that share the nearest point, the one that looks most towards or away from the query",
    "scale": "L is the diagonal of the box around all objects at the first frame, so that nothing flung out lowers the score",
    "intended": "overlaps that a specification declares as intended count like all others",
}
"""Choices where the paper leaves something open; it travels with every result."""

Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Evaluated:
    """One object's visible surface at a frame, in the world."""

    name: str
    group: str
    """Objects of one group are not compared: closed and open parts of the same thing."""
    dynamic: bool
    closed: bool
    """It bounds a volume, with outward normals."""
    vertices: F64
    """[m], shape (n, 3)."""
    faces: I32

    @cached_property
    def triangles(self) -> F64:
        """Corners [m], shape (m, 3, 3)."""
        return np.ascontiguousarray(self.vertices[self.faces])

    @cached_property
    def bounds(self) -> tuple[F64, F64]:
        """Box around each triangle [m], shape (m, 3) each."""
        return self.triangles.min(axis=1), self.triangles.max(axis=1)

    @cached_property
    def box(self) -> tuple[F64, F64]:
        """Box around it [m], shape (3,) each."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    def within(self, low: F64, high: F64) -> Ints:
        """Triangles whose boxes meet a box."""
        lower, upper = self.bounds
        return np.flatnonzero(((lower <= high) & (upper >= low)).all(axis=1))


class Overlap(NamedTuple):
    """Two objects whose triangles cross at a frame."""

    frame: int
    first: str
    second: str
    depth: float
    """[m] The larger of the directions asked, at least `LEAST_DEPTH`."""
    forth: float | None
    """[m] Depth of the first's corners in the second; None where that direction is not asked."""
    back: float | None
    """[m] Depth of the second's corners in the first."""
    crossings: int
    """Pairs of triangles that cross."""


@dataclass(frozen=True)
class Penetration:
    """The score of one world with all that it rests on."""

    score: float
    """100 depth / L."""
    depth: float
    """[m]"""
    scale: float
    """[m] L."""
    frames: tuple[int, ...]
    worst: Overlap | None
    """None where nothing crosses."""
    pairs: tuple[Overlap, ...]
    """The deepest moment of each pair that ever crosses, deepest first."""
    objects: int
    compared: int
    """Pairs whose boxes met, over all frames."""
    choices: dict[str, str] = field(default_factory=lambda: dict(CHOICES))

    def as_json(self) -> dict[str, Any]:
        """Plain data for logs and reports."""
        return {
            "score": self.score,
            "depth_m": self.depth,
            "scale_m": self.scale,
            "frames": list(self.frames),
            "worst": None if self.worst is None else self.worst._asdict(),
            "pairs": [o._asdict() for o in self.pairs[:20]],
            "pairs_crossing": len(self.pairs),
            "objects": self.objects,
            "pairs_compared": self.compared,
            "choices": self.choices,
        }


def sampled_frames(count: int, wanted: int = FRAMES) -> tuple[int, ...]:
    """Frames spread evenly over an interval of `count` frames with both ends; all of them where there are no more."""
    if count <= wanted:
        return tuple(range(count))
    return tuple(int(k) for k in np.rint(np.linspace(0, count - 1, wanted)))


def penetration(objects_at: Callable[[int], Sequence[Evaluated]], frames: Sequence[int]) -> Penetration:
    """Score of a world whose evaluated objects are given frame by frame.

    Args:
        objects_at: all objects at a frame.
        frames: that are looked at, as `sampled_frames` gives them.
    """
    deepest: dict[tuple[str, str], Overlap] = {}
    compared, scale, count = 0, 0.0, 0
    for k, frame in enumerate(frames):
        objects = objects_at(frame)
        if k == 0:
            scale, count = _diagonal(objects), len(objects)
        for met in overlaps(objects, frame):
            compared += 1
            if met.crossings and met.depth > (
                deepest[met.first, met.second].depth if (met.first, met.second) in deepest else -1.0
            ):
                deepest[met.first, met.second] = met
    pairs = tuple(sorted(deepest.values(), key=lambda o: (-o.depth, o.first, o.second)))
    depth = pairs[0].depth if pairs else 0.0
    score = 100.0 * depth / scale if scale > 0.0 else math.nan
    return Penetration(score, depth, scale, tuple(frames), pairs[0] if pairs else None, pairs, count, compared)


def _diagonal(objects: Sequence[Evaluated]) -> float:
    if not objects:
        return 0.0
    low, high = (f([o.box[k] for o in objects], axis=0) for k, f in ((0, np.min), (1, np.max)))
    return float(np.linalg.norm(high - low))


def overlaps(objects: Sequence[Evaluated], frame: int) -> Iterator[Overlap]:
    """Every pair of a dynamic object and a collider whose boxes meet, with its depth; `crossings` is 0 where no triangles cross."""
    low, high = (np.array([o.box[k] for o in objects]).reshape(-1, 3) for k in (0, 1))
    for i, one in enumerate(objects):
        meet = ((low[i] <= high[i + 1 :]) & (high[i] >= low[i + 1 :])).all(axis=1)
        for j in np.flatnonzero(meet).tolist():
            two = objects[i + 1 + j]
            forth, back = one.dynamic and two.closed, two.dynamic and one.closed
            if one.group != two.group and (forth or back):
                yield _measured(one, two, frame, forth=forth, back=back)


def _measured(one: Evaluated, two: Evaluated, frame: int, *, forth: bool, back: bool) -> Overlap:
    low, high = np.maximum(one.box[0], two.box[0]), np.minimum(one.box[1], two.box[1])
    i, j = one.within(low, high), two.within(low, high)
    noise = query_noise(max(float(np.linalg.norm(o.box[1] - o.box[0])) for o in (one, two)))
    pairs = (
        mutual_crossings(one.triangles[i], two.triangles[j], noise=noise).pairs
        if len(i) and len(j)
        else np.empty((0, 2), dtype=np.int32)
    )
    if len(pairs) == 0:
        return Overlap(frame, one.name, two.name, 0.0, None, None, 0)
    there = directed_depth(one.triangles[i[np.unique(pairs[:, 0])]], two) if forth else None
    here = directed_depth(two.triangles[j[np.unique(pairs[:, 1])]], one) if back else None
    depth = max(LEAST_DEPTH, there or 0.0, here or 0.0)
    return Overlap(frame, one.name, two.name, depth, there, here, len(pairs))


def directed_depth(crossing: F64, other: Evaluated) -> float:
    """Greatest depth of corners of crossing triangles behind the other surface [m].

    Args:
        crossing: triangles that cross it, shape (k, 3, 3).
        other: the surface, with outward normals.
    """
    corners = np.unique(crossing.reshape(-1, 3), axis=0)
    if len(corners) > VERTICES:
        corners = corners[np.rint(np.linspace(0, len(corners) - 1, VERTICES)).astype(np.intp)]
    # A crossing triangle meets the other surface, so that no corner of it is farther away than its longest side.
    reach = float(np.linalg.norm(crossing - np.roll(crossing, 1, axis=1), axis=2).max())
    near = other.within(corners.min(axis=0) - reach, corners.max(axis=0) + reach)
    solid = Solid.from_mesh(TriangleMesh(other.vertices, other.faces[near]), closed=False)
    distance, point, face = nearest_faces(solid, corners)
    height = np.einsum("ni,ni->n", corners - point, _normals(solid, corners, distance, face))
    return float(np.maximum(-height, 0.0).max())


def _normals(solid: Solid, points: F64, distance: F64, face: Ints) -> F64:
    """Outward normal at the nearest point of each query, shape (n, 3)."""
    order = np.argsort(solid.faces.reshape(-1), kind="stable")
    owner, start = order // 3, np.searchsorted(solid.faces.reshape(-1)[order], np.arange(len(solid.vertices) + 1))
    chosen = solid.face_normals[face].copy()
    for k, (point, best) in enumerate(zip(points, face, strict=True)):
        around = np.unique(np.concatenate([owner[start[v] : start[v + 1]] for v in solid.faces[best]]))
        found, foot = nearest_on_triangles(point[None], solid.triangles[around])
        shared = around[found <= distance[k] + SAME * max(distance[k], solid.size * 1e-6)]
        if len(shared) > 1:
            rise = solid.face_normals[shared] @ (point - foot[found.argmin()])
            chosen[k] = solid.face_normals[shared[np.abs(rise).argmax()]]
    return chosen
