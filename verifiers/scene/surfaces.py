"""Visible surfaces of a candidate and the clearances between them, computed once and shared by the spatial checks.

A coarse search over axis-aligned boxes finds the pairs of entities that come within reach of each other; the signed
clearance of their visible surfaces decides. Pairs inside one entity are not inspected.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import (
    Meetings,
    Solid,
    aabb_of,
    clearance_batch,
    kept_solid,
    meetings,
    query_noise,
    signed_clearance,
    turned_boxes,
)
from ...worlds.arrays import F64, RigidPose
from ...worlds.built import TriangleMesh
from ...worlds.categories.fracture.pieces import piece_overlap
from ...worlds.errors import EvidenceError, InputError
from ...worlds.spec import Fastened, Rope
from .bounds import GAP_CAP, MOVED_SHARE, SUPPORT_SLOPE, UNIT_QUATERNION
from .shapes import Shapes

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["Gap", "PartSurface", "Surfaces", "Track", "surfaces_of"]

NOWHERE = 1e300
"""[m] Corner of the empty box that stands for a broken pose."""

QUERIES = 500_000
"""Clearances measured in one batch: about 150 MB."""

Pair = tuple[str, str]


class Track(NamedTuple):
    """Motion of one body frame: positions [m], shape (frames, 3), and quaternions, shape (frames, 4)."""

    position: F64
    quaternion: F64

    def at(self, frame: int) -> RigidPose:
        """Pose at one frame."""
        return RigidPose(self.position[frame], self.quaternion[frame])

    def take(self, frames: NDArray[np.intp]) -> Track:
        """Motion at some frames."""
        return Track(self.position[frames], self.quaternion[frames])


@dataclass(frozen=True)
class PartSurface:
    """Visible surface of one part."""

    entity: str
    part: str
    body: str
    solid: Solid
    deviation: float
    """[m] how far the collision surface may stand outside the visible one."""


class Gap(NamedTuple):
    """Signed clearance of two entities at one frame."""

    distance: float
    """[m]"""
    point_a: F64
    """World [m], shape (3,)."""
    point_b: F64
    part_a: str
    part_b: str


class Surfaces:
    """Geometry and motion of one candidate; obtain it with `surfaces_of`."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate
        self.frames = candidate.frame_count
        self._tracks: dict[tuple[str, str], Track] = {}
        self._solids: dict[bytes, Solid] = {}
        self._near: dict[Pair, set[tuple[int, int]]] = {}
        self._support: dict[tuple[str, str, int], NDArray[np.bool_]] = {}
        self.at_start: dict[tuple[int, int], float] = {}
        """Clearance [m] at frame 0 of parts (i < j) of different entities within `reach`; there once `first` was asked."""

    @cached_property
    def parts(self) -> tuple[PartSurface, ...]:
        """Every visible surface that can be inspected, in the order of the specification; see `missing`."""
        return self._collected[0]

    @cached_property
    def missing(self) -> dict[str, str]:
        """Entities that cannot be inspected, and why: not built, no usable surface, or no cache of their motion."""
        return self._collected[1]

    @cached_property
    def _collected(self) -> tuple[tuple[PartSurface, ...], dict[str, str]]:
        found: list[PartSurface] = []
        missing: dict[str, str] = {}
        for entity in self.candidate.solids:
            try:
                found += self._entity_parts(entity)
            except EvidenceError as error:
                missing[entity] = str(error)
        return tuple(found), missing

    def _entity_parts(self, entity: str) -> list[PartSurface]:
        built = self.candidate.entity(entity)
        if not built.parts:
            raise EvidenceError(f"entity {entity!r} has no visible geometry; call place_object")
        for body in built.bodies:
            self.track(entity, body.name)
        found = []
        for part in built.parts:
            try:
                soft = entity in self.candidate.deforming
                shape = TriangleMesh(self.candidate.shape(entity, part.part, 0), part.render.faces) if soft else part.render
                solid = self._solid(shape, closed=part.closed)
            except InputError as error:
                raise EvidenceError(f"surface of {entity}/{part.part} cannot be inspected: {error}") from error
            found.append(PartSurface(entity, part.part, part.body, solid, float(part.deviation[0])))
        return found

    def _solid(self, mesh: TriangleMesh, *, closed: bool) -> Solid:
        """The mesh ready for queries; equal meshes share one, with all that is derived from it."""
        key = hashlib.sha256(repr((mesh.vertices.shape, mesh.vertices.dtype, mesh.faces.dtype, closed)).encode())
        key.update(mesh.vertices.tobytes())
        key.update(mesh.faces.tobytes())
        if key.digest() not in self._solids:
            self._solids[key.digest()] = kept_solid(mesh, closed=closed)
        return self._solids[key.digest()]

    @cached_property
    def entities(self) -> tuple[str, ...]:
        """Entities that can be inspected."""
        return tuple(n for n in self.candidate.solids if n not in self.missing)

    def require(self, *entities: str) -> None:
        """Make sure that entities can be inspected.

        Raises:
            EvidenceError: one cannot; the text says why.
        """
        for entity in entities:
            if entity in self.missing:
                raise EvidenceError(self.missing[entity])
            if entity not in self.candidate.solids:
                category = self.candidate.spec.entities[entity].physics.category
                raise EvidenceError(f"{entity!r} is {category} and has no fixed surface; rows of its solver judge it")

    @cached_property
    def parts_of(self) -> Mapping[str, tuple[int, ...]]:
        """Indices of the parts of every entity."""
        found: dict[str, list[int]] = {name: [] for name in self.candidate.spec.entities}
        for i, part in enumerate(self.parts):
            found[part.entity].append(i)
        return {name: tuple(rows) for name, rows in found.items()}

    def track(self, entity: str, body: str) -> Track:
        """Motion of a body over the inspected frames.

        Raises:
            EvidenceError: the entity moves and no cache holds it, although there are caches.
        """
        key = (entity, body)
        if key not in self._tracks:
            held = self.candidate.cache_row(entity, body) is not None or entity in self.candidate.deforming
            if not held and self.candidate.stage != "static" and not self.is_static(entity):
                raise EvidenceError(
                    f"no cache holds the motion of {entity}/{body}; list {entity!r} as a member of a solver and bake"
                )
            self._tracks[key] = Track(*self.candidate.track(entity, body))
        return self._tracks[key]

    def is_static(self, entity: str) -> bool:
        """Whether the contract says that it never moves."""
        return self.candidate.spec.entities[entity].motion == "static"

    @cached_property
    def broken(self) -> dict[str, int]:
        """Entities with a pose that is not finite or no rotation, and the first frame of it."""
        found: dict[str, int] = {}
        for entity in self.entities:
            for body in self.candidate.entity(entity).bodies:
                position, quaternion = self.track(entity, body.name)
                with np.errstate(invalid="ignore", over="ignore"):
                    good = np.isfinite(position).all(axis=1) & (
                        np.abs(np.linalg.norm(quaternion, axis=1) - 1.0) <= UNIT_QUATERNION
                    )
                if not good.all():
                    frame = int(np.argmin(good))
                    found[entity] = min(frame, found.get(entity, frame))
        return found

    def size(self, entity: str) -> float:
        """Largest diagonal among its parts [m]."""
        return max(self.parts[i].solid.size for i in self.parts_of[entity])

    def thickness(self, entity: str) -> float:
        """Smallest extent of the local boxes of its parts [m]."""
        return min(float((s.upper - s.lower).min()) for s in (self.parts[i].solid for i in self.parts_of[entity]))

    def noise(self, a: str, b: str) -> float:
        """eps of the penetration checks for a pair [m] (S1): query noise and the rounding of the poses, no allowance."""
        size = self.size(a) + self.size(b)
        offset = max(float(np.abs(p).max(initial=0.0)) for p in (self._start(a), self._start(b)))
        return query_noise(size) + 8.0 * float(np.finfo(np.float64).eps) * offset

    def _start(self, entity: str) -> F64:
        position = self.track(entity, self.parts[self.parts_of[entity][0]].body).position
        return np.where(np.isfinite(position), position, 0.0)

    def skins(self, a: str, b: str) -> float:
        """Sum of the two collision skins [m] in the solver instance that both belong to."""
        return 2.0 * max((skin for members, skin in self._members if a in members and b in members), default=0.0)

    @cached_property
    def _members(self) -> list[tuple[frozenset[str], float]]:
        return [(frozenset(s.members), s.settings.skin) for s in self.candidate.spec.simulation.rigid.values()]

    def contact_gap(self, a: str, b: str) -> float:
        """Largest gap that counts as actual contact [m] (S3): declared limit, or skins and facet error if larger."""
        facets = sum(max(self.parts[i].deviation for i in self.parts_of[n]) for n in (a, b))
        skins = self.skins(a, b)
        covered = min(skins + facets, max(GAP_CAP, skins))
        return max(self.candidate.spec.simulation.limits.contact_gap, covered)

    @cached_property
    def reach(self) -> float:
        """Clearance up to which pairs are inspected [m]: twice the largest contact tolerance."""
        plan = self.candidate.spec.simulation
        skins = max((2.0 * s.settings.skin for s in plan.rigid.values()), default=0.0)
        facets = 2.0 * max((p.deviation for p in self.parts), default=0.0)
        return 2.0 * max(plan.limits.contact_gap, min(skins + facets, max(GAP_CAP, skins)))

    def allowed_depth(self, a: str, b: str) -> float:
        """Overlap that the specification declares intended for the pair [m] (R91); 0 where it declares none.

        A `fastened` relation allows its depth; the end of a rope may sink into what it is attached to by its radius.
        """
        return max(self._fastened.get((a, b), 0.0), self._fastened.get((b, a), 0.0))

    @cached_property
    def _fastened(self) -> dict[Pair, float]:
        found: dict[Pair, float] = {}
        for relation in self.candidate.spec.graph.relations.values():
            if isinstance(relation, Fastened):
                found[relation.a, relation.b] = max(relation.max_depth, found.get((relation.a, relation.b), 0.0))
        for name, entity in self.candidate.spec.entities.items():
            if entity.breakable is not None and name in self.candidate.built:
                found[name, name] = piece_overlap(entity.breakable, self.candidate.built[name])
            if isinstance(entity.generator, Rope):
                for end in (entity.generator.attach_start, entity.generator.attach_end):
                    if end is not None and end != "world":
                        found[name, end] = max(entity.generator.radius, found.get((name, end), 0.0))
        return found

    def scan(self, frames: NDArray[np.intp], *, static: bool) -> dict[Pair, F64]:
        """Signed clearance of every pair of entities that comes within `reach`, per frame [m], shape (frames,).

        Where a pair is farther apart than `reach` the value is some larger lower bound, or infinite.

        Args:
            frames: frames to inspect.
            static: whether to inspect pairs of static entities too.
        """
        met = self._meetings(frames, static=static)
        cut = np.flatnonzero(np.diff(met.first) | np.diff(met.second)) + 1
        starts = np.concatenate([[0], cut])[: len(met.first)]
        stops = np.concatenate([cut, [len(met.first)]])
        found: dict[Pair, F64] = {}
        group: list[tuple[int, int, NDArray[np.int32]]] = []
        held = 0
        for start, stop in zip(starts, stops, strict=False):
            group.append((int(met.first[start]), int(met.second[start]), met.frame[start:stop]))
            held += stop - start
            if held >= QUERIES or stop == len(met.first):
                self._measure(group, frames, found)
                group, held = [], 0
        return {pair: series for pair, series in found.items() if series.min() <= self.reach}

    @cached_property
    def shapes(self) -> Shapes:
        """Shapes of the parts at the frames: those of deforming ones change."""
        return Shapes(self.candidate, self.parts)

    def _clearances(
        self, asked: list[tuple[int, int, NDArray[np.intp]]], *, shift: F64 | None = None, tolerance: float = 0.0
    ) -> F64:
        """Clearance of pairs of parts (i, j, frames), one after the other [m], the first of each moved by `shift` [m]."""
        sides = [[(i, frames) for i, _, frames in asked], [(j, frames) for _, j, frames in asked]]
        forest, places = self.shapes.forest([*sides[0], *sides[1]])
        poses = []
        for side, move in zip(sides, (shift, None), strict=True):
            tracks = [self._track_of(part).take(frames) for part, frames in side]
            position = np.concatenate([t.position for t in tracks])
            poses.append((position if move is None else position + move, np.concatenate([t.quaternion for t in tracks])))
        pairs = places.reshape(2, -1).T
        return clearance_batch(forest, pairs, *poses, skip_above=self.reach, tolerance=tolerance).distance

    def boxes(self, frames: NDArray[np.intp]) -> tuple[F64, F64]:
        """World boxes that hold all parts [m], shapes (parts, frames, 3); empty from the first broken pose of an entity on."""
        parts = self.parts
        center, half = (np.stack([0.5 * (p.solid.upper + g * p.solid.lower) for p in parts]) for g in (1.0, -1.0))
        radius = np.array([p.solid.sphere_radius for p in parts])
        tracks = [self._track_of(i) for i in range(len(parts))]
        positions, quaternions = (np.stack([t[k][frames] for t in tracks]) for k in (0, 1))
        lost = frames[None] >= np.array([self.broken.get(p.entity, self.frames) for p in parts])[:, None]
        positions[lost], quaternions[lost] = 0.0, (1.0, 0.0, 0.0, 0.0)
        low, high = turned_boxes(center, half, radius, positions, quaternions)
        for i in self.shapes.soft:
            some = turned_boxes(*self.shapes.boxes(i, frames), positions[i][:, None], quaternions[i][:, None])
            low[i], high[i] = some[0][:, 0], some[1][:, 0]
        low[lost], high[lost] = NOWHERE, -NOWHERE
        return low, high

    def _meetings(self, frames: NDArray[np.intp], *, static: bool) -> Meetings:
        """Parts of different entities whose boxes come within `reach`, and at which places in `frames`."""
        if len(self.parts) < 2:
            return Meetings(*np.empty((3, 0), dtype=np.int32))
        still = None if static else np.array([self.is_static(p.entity) for p in self.parts])
        met = meetings(lambda part: self.boxes(frames[part]), len(frames), self.reach, still=still)
        owner = np.unique([p.entity for p in self.parts], return_inverse=True)[1]
        keep = owner[met.first] != owner[met.second]
        return Meetings(met.first[keep], met.second[keep], met.frame[keep])

    def _measure(
        self,
        group: list[tuple[int, int, NDArray[np.int32]]],
        frames: NDArray[np.intp],
        found: dict[Pair, F64],
    ) -> None:
        """Measure pairs of parts (i, j, places in `frames`) and enter the least of each pair of entities into `found`."""
        values = self._clearances([(i, j, frames[near]) for i, j, near in group])
        start = 0
        for i, j, near in group:
            pair = (self.parts[i].entity, self.parts[j].entity)
            self._near.setdefault(pair, set()).add((i, j))
            series = found.setdefault(pair, np.full(len(frames), np.inf))
            series[near] = np.minimum(series[near], values[start : start + len(near)])
            start += len(near)
            if len(frames) == 1 and frames[0] == 0:
                self.at_start[min(i, j), max(i, j)] = float(values[start - 1])

    def _track_of(self, part: int) -> Track:
        return self.track(self.parts[part].entity, self.parts[part].body)

    @cached_property
    def first(self) -> dict[Pair, float]:
        """Clearance [m] at frame 0 of every pair within `reach`, static pairs included."""
        return {pair: float(series[0]) for pair, series in self.scan(np.zeros(1, dtype=np.intp), static=True).items()}

    @cached_property
    def moving(self) -> dict[Pair, F64]:
        """Clearance [m] over all frames of every pair that comes within `reach` and of which one moves."""
        return self.scan(np.arange(self.frames), static=False)

    def series(self, a: str, b: str) -> F64:
        """Clearance of two entities over all frames [m]; infinite where they are farther apart than `reach`."""
        found = self.moving.get((a, b), self.moving.get((b, a)))
        if found is not None:
            return found
        if self.is_static(a) and self.is_static(b):
            return np.full(self.frames, self.first.get((a, b), self.first.get((b, a), math.inf)))
        return np.full(self.frames, math.inf)

    def gap(self, a: str, b: str, frame: int, *, offset: F64 | None = None) -> Gap:
        """Exact clearance of two entities at one frame, with its points.

        Args:
            a: one entity.
            b: the other.
            frame: the frame.
            offset: moves `a` by this [m], shape (3,), before measuring.
        """
        shift = np.zeros(3) if offset is None else offset
        placed = []
        for rows, move in ((self.parts_of[a], shift), (self.parts_of[b], np.zeros(3))):
            poses = [self.track(self.parts[i].entity, self.parts[i].body).at(frame) for i in rows]
            poses = [RigidPose(p.position + move, p.quaternion) for p in poses]
            shapes = [self.shapes.solid(i, frame).vertices for i in rows]
            boxes = [aabb_of(v, p.position[None], p.quaternion[None]) for v, p in zip(shapes, poses, strict=True)]
            placed.append((rows, poses, np.concatenate([x[0] for x in boxes]), np.concatenate([x[1] for x in boxes])))
        (rows_a, poses_a, low_a, high_a), (rows_b, poses_b, low_b, high_b) = placed
        apart = np.maximum(np.maximum(low_a[:, None] - high_b, low_b - high_a[:, None]), 0.0)
        bound = np.linalg.norm(apart, axis=2)
        best: Gap | None = None
        for k in np.argsort(bound, axis=None, kind="stable"):
            i, j = divmod(int(k), len(rows_b))
            if best is not None and bound[i, j] > max(best.distance, 0.0):
                break
            one, two = self.parts[rows_a[i]], self.parts[rows_b[j]]
            solids = self.shapes.solid(rows_a[i], frame), self.shapes.solid(rows_b[j], frame)
            found = signed_clearance(solids[0], poses_a[i], solids[1], poses_b[j])
            if best is None or found.distance < best.distance:
                best = Gap(found.distance, found.point_a, found.point_b, one.part, two.part)
        assert best is not None
        return best

    def carries(self, below: str, above: str, *, until: int | None = None) -> NDArray[np.bool_]:
        """At which frames `below` touches `above` and stands in the way of its falling, shape (frames,).

        Clearance is measured again with `above` moved against gravity by the contact tolerance: it must grow by at
        least `SUPPORT_SLOPE` of that move, which is the rise of the contact normal. Where it does not, as between a
        drawer and its chest, it must shrink by as much when `above` moves along gravity.

        Args:
            below: the entity that may carry.
            above: the entity that may be carried.
            until: judge only this many first frames; later ones are then False.
        """
        key = (below, above, self.frames if until is None else until)
        if key not in self._support:
            self._support[key] = self._carries(*key)
        return self._support[key]

    def _carries(self, below: str, above: str, until: int) -> NDArray[np.bool_]:
        distance = self.series(below, above)
        gap = self.contact_gap(below, above)
        touching = np.flatnonzero(distance[:until] <= gap)
        result = np.zeros(self.frames, dtype=bool)
        if len(touching) == 0 or {(below, above), (above, below)} & self.candidate.apart:
            return result
        gravity = np.array(self.candidate.spec.simulation.gravity)
        strength = float(np.linalg.norm(gravity))
        if strength < 1e-12:
            result[touching] = True
            return result
        fall = gap * gravity / strength
        raised = self._moved(below, above, touching, -fall)
        result[touching] = raised >= distance[touching] + SUPPORT_SLOPE * gap
        unsure = touching[~result[touching]]
        if len(unsure):
            lowered = self._moved(below, above, unsure, fall)
            result[unsure] = lowered <= distance[unsure] - SUPPORT_SLOPE * gap
        return result

    def _moved(self, below: str, above: str, frames: NDArray[np.intp], offset: F64) -> F64:
        """Clearance at some frames with `above` moved by `offset` [m], shape (frames,)."""
        pairs = self._near.get((below, above), set()) | {(j, i) for i, j in self._near.get((above, below), set())}
        if not pairs:
            return np.full(len(frames), np.inf)
        tolerance = MOVED_SHARE * SUPPORT_SLOPE * self.contact_gap(below, above)
        values = self._clearances([(j, i, frames) for i, j in sorted(pairs)], shift=offset, tolerance=tolerance)
        return np.asarray(values.reshape(len(pairs), len(frames)).min(axis=0))

    @cached_property
    def neighbours(self) -> Mapping[str, tuple[str, ...]]:
        """Entities that come within `reach` of each entity at some frame."""
        found: dict[str, list[str]] = {name: [] for name in self.entities}
        for a, b in self.moving:
            found[a].append(b)
            found[b].append(a)
        return {name: tuple(others) for name, others in found.items()}


_recent: list[Surfaces] = []


def surfaces_of(candidate: Candidate) -> Surfaces:
    """Surfaces of a candidate; the last two candidates are remembered."""
    for known in _recent:
        if known.candidate is candidate:
            return known
    made = Surfaces(candidate)
    _recent.insert(0, made)
    del _recent[2:]
    return made
