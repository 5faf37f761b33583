"""Bodies that pass through static surfaces between two frames, where no inspected frame shows an overlap (R108)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry import distance_to_surface
from ..worlds.arrays import F64, rotation_matrix
from ..worlds.errors import EvidenceError

if TYPE_CHECKING:
    from ..geometry import Solid
    from .surfaces import Surfaces, Track

__all__ = ["Passage", "Passages", "find_passages"]

BENDS = 8
"""Segments that a curved path is drawn with."""
PAIRS = 500_000
"""Segment-triangle pairs tested at once."""


class Passage(NamedTuple):
    """An entity went through a static one between `frame - 1` and `frame`."""

    entity: str
    through: str
    frame: int
    point: F64
    """Where the straight path enters [m], shape (3,)."""
    travel: float
    """[m] in that frame."""


class Passages(NamedTuple):
    """What was found, and how many frame-to-frame paths were fast enough to need the test."""

    found: list[Passage]
    inspected: int


class _Probe(NamedTuple):
    """A point of a body that lies within its material."""

    track: F64
    """World [m], shape (frames, 3)."""
    velocity: F64 | None
    """[m/s], shape (frames, 3)."""
    depth: float
    """[m] of material around it."""


def find_passages(surfaces: Surfaces) -> Passages:
    """Test the path of a point inside every moving body against the static surfaces, frame to frame.

    A path shorter than the material around the point cannot skip a surface without an overlap at one of its ends, so
    only longer ones are tested. The path between two frames is unknown; a passage is reported when the chord, the cubic
    through both velocities, and the bounce (straight in, straight out) all enter the same static entity.
    """
    statics = [n for n in surfaces.entities if surfaces.is_static(n)]
    found: list[Passage] = []
    inspected = 0
    step = 1.0 / surfaces.candidate.spec.simulation.fps
    for entity in surfaces.entities:
        if surfaces.is_static(entity):
            continue
        for body in surfaces.candidate.entity(entity).bodies:
            probe = _probe(surfaces, entity, body.name)
            if probe is None:
                continue
            with np.errstate(invalid="ignore", over="ignore"):
                travel = np.linalg.norm(np.diff(probe.track, axis=0), axis=1)
            fast = np.flatnonzero(travel[: max(0, surfaces.broken.get(entity, surfaces.frames) - 1)] > probe.depth)
            inspected += len(fast)
            if len(fast) == 0:
                continue
            for other in statics:
                entered, point = _enters(surfaces, other, _chords(probe, fast))
                if probe.velocity is not None:
                    for path in (_cubics(probe, fast, step), _bounces(probe, fast, step)):
                        entered &= _enters(surfaces, other, path)[0]
                if entered.any():
                    k = int(np.argmax(entered))
                    found.append(Passage(entity, other, int(fast[k]) + 1, point[k], float(travel[fast[k]])))
    return Passages(found, inspected)


def _probe(surfaces: Surfaces, entity: str, body: str) -> _Probe | None:
    """The interior point of the body's largest closed part, with its motion; None where nothing is closed."""
    parts = [surfaces.parts[i] for i in surfaces.parts_of[entity] if surfaces.parts[i].body == body]
    closed = [p for p in parts if p.solid.closed]
    if not closed:
        return None
    solid = max((p.solid for p in closed), key=lambda s: abs(s.volume))
    point = solid.interior_point
    if point is None:
        return None
    depth = float(distance_to_surface(solid, point[None]).distance[0])
    motion: Track = surfaces.track(entity, body)
    with np.errstate(invalid="ignore", over="ignore"):
        turn = rotation_matrix(motion.quaternion)
        track = turn @ point + motion.position
        place = surfaces.candidate.cache_row(entity, body)
        velocity = None
        if place is not None:
            cache, row = place
            try:
                linear, angular = cache.series("velocity")[:, row], cache.series("angular_velocity")[:, row]
            except EvidenceError:
                return _Probe(track, None, depth)
            arm = turn @ (point - surfaces.candidate.body(entity, body).center)
            velocity = (linear[: surfaces.frames] + np.cross(angular[: surfaces.frames], arm)).astype(np.float64)
    return _Probe(track, velocity, depth)


def _chords(probe: _Probe, fast: NDArray[np.intp]) -> F64:
    """Straight paths, shape (n, 2, 3)."""
    return np.stack([probe.track[fast], probe.track[fast + 1]], axis=1)


def _cubics(probe: _Probe, fast: NDArray[np.intp], step: float) -> F64:
    """Cubic Hermite paths through both velocities, shape (n, BENDS + 1, 3)."""
    assert probe.velocity is not None
    t = np.linspace(0.0, 1.0, BENDS + 1)[None, :, None]
    p0, p1 = probe.track[fast][:, None], probe.track[fast + 1][:, None]
    v0, v1 = step * probe.velocity[fast][:, None], step * probe.velocity[fast + 1][:, None]
    return np.asarray(
        (2 * t**3 - 3 * t**2 + 1) * p0 + (t**3 - 2 * t**2 + t) * v0 + (3 * t**2 - 2 * t**3) * p1 + (t**3 - t**2) * v1
    )


def _bounces(probe: _Probe, fast: NDArray[np.intp], step: float) -> F64:
    """Straight in with the first velocity, straight out with the second, meeting where the two come nearest."""
    assert probe.velocity is not None
    p0, p1 = probe.track[fast], probe.track[fast + 1]
    v0, v1 = probe.velocity[fast], probe.velocity[fast + 1]
    offset, relative = p0 - (p1 - step * v1), v0 - v1
    square = np.maximum(np.einsum("ni,ni->n", relative, relative), 1e-12)
    time = np.clip(-np.einsum("ni,ni->n", offset, relative) / square, 0.0, step)[:, None]
    turn = 0.5 * (p0 + time * v0 + p1 - (step - time) * v1)
    return np.stack([p0, turn, p1], axis=1)


def _enters(surfaces: Surfaces, static: str, paths: F64) -> tuple[NDArray[np.bool_], F64]:
    """Which polylines, shape (n, k, 3), cross a surface of the static entity from outside, and where."""
    count, points = paths.shape[0], paths.shape[1]
    entered, where = np.zeros(count, dtype=bool), np.full((count, 3), np.nan)
    for i in surfaces.parts_of[static]:
        part = surfaces.parts[i]
        pose = surfaces.track(static, part.body).at(0)
        local = pose.inverse().apply(paths.reshape(-1, 3)).reshape(count, points, 3)
        low, high = local.min(axis=1), local.max(axis=1)
        near = np.flatnonzero(((low <= part.solid.upper) & (high >= part.solid.lower)).all(axis=1))
        if len(near) == 0:
            continue
        segments = np.stack([local[near, :-1], local[near, 1:]], axis=2).reshape(-1, 2, 3)
        hit, point = _first_entry(part.solid, segments)
        hit, point = hit.reshape(len(near), -1), point.reshape(len(near), -1, 3)
        first = hit.argmax(axis=1)
        any_hit = hit.any(axis=1)
        entered[near[any_hit]] = True
        where[near[any_hit]] = pose.apply(point[np.arange(len(near)), first][any_hit])
    return entered, where


def _first_entry(solid: Solid, segments: F64) -> tuple[NDArray[np.bool_], F64]:
    """Whether each segment, shape (n, 2, 3), enters the solid (crosses an open sheet), and where first.

    Intersection by Moeller and Trumbore (1997), doi:10.1080/10867651.1997.10487468.
    """
    triangles, normals = solid.triangles, solid.face_normals
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    hit, point = np.zeros(len(segments), dtype=bool), np.full((len(segments), 3), np.nan)
    step = max(1, PAIRS // len(triangles))
    for start in range(0, len(segments), step):
        block = segments[start : start + step]
        least, most = block.min(axis=1)[:, None], block.max(axis=1)[:, None]
        rows, faces = np.nonzero(((least <= high) & (most >= low)).all(axis=2))
        origin, along = block[rows, 0], block[rows, 1] - block[rows, 0]
        a = triangles[faces, 0]
        e1, e2 = triangles[faces, 1] - a, triangles[faces, 2] - a
        p = np.cross(along, e2)
        determinant = np.einsum("ni,ni->n", e1, p)
        usable = determinant != 0.0
        if solid.closed:
            usable &= np.einsum("ni,ni->n", along, normals[faces]) < 0.0
        inverse = 1.0 / np.where(usable, determinant, 1.0)
        s = origin - a
        u = np.einsum("ni,ni->n", s, p) * inverse
        q = np.cross(s, e1)
        v = np.einsum("ni,ni->n", along, q) * inverse
        t = np.einsum("ni,ni->n", e2, q) * inverse
        crosses = usable & (u >= -1e-12) & (v >= -1e-12) & (u + v <= 1.0 + 1e-12) & (t > 0.0) & (t < 1.0)
        order = np.argsort(-t[crosses], kind="stable")
        mine = rows[crosses][order] + start
        hit[mine] = True
        point[mine] = (origin + t[:, None] * along)[crosses][order]
    return hit, point
