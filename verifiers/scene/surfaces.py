"""Visible surfaces of a candidate and the clearances between them, computed once and shared by the spatial checks.

A coarse search over axis-aligned boxes finds the pairs of entities that come within reach of each other; the signed
clearance of their visible surfaces decides. Pairs inside one entity are not inspected.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import Meetings, aabb_of, clearance_batch, meetings, signed_clearance, turned_boxes
from ...worlds.arrays import F64, RigidPose
from .bounds import MOVED_SHARE, SUPPORT_SLOPE
from .parts import Pair, Parts

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["NOWHERE", "Gap", "Surfaces", "surfaces_of"]

NOWHERE = 1e300
"""[m] Corner of the empty box that stands for a broken pose."""

QUERIES = 500_000
"""Clearances measured in one batch: about 150 MB."""


class Gap(NamedTuple):
    """Signed clearance of two entities at one frame."""

    distance: float
    """[m]"""
    point_a: F64
    """World [m], shape (3,)."""
    point_b: F64
    part_a: str
    part_b: str


class Surfaces(Parts):
    """Clearances between the parts of one candidate; obtain it with `surfaces_of`."""

    def __init__(self, candidate: Candidate) -> None:
        super().__init__(candidate)
        self._near: dict[Pair, set[tuple[int, int]]] = {}
        self._support: dict[tuple[str, str, int], NDArray[np.bool_]] = {}
        self.at_start: dict[tuple[int, int], float] = {}
        """Clearance [m] at frame 0 of parts (i < j) of different entities within `reach`; there once `first` was asked."""

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

    def _clearances(
        self, asked: list[tuple[int, int, NDArray[np.intp]]], *, shift: F64 | None = None, tolerance: float = 0.0
    ) -> F64:
        """Clearance of pairs of parts (i, j, frames), one after the other [m], the first of each moved by `shift` [m]."""
        sides = [[(i, frames) for i, _, frames in asked], [(j, frames) for _, j, frames in asked]]
        forest, places = self.shapes.forest([*sides[0], *sides[1]])
        poses = []
        for side, move in zip(sides, (shift, None), strict=True):
            tracks = [self.track_of(part).take(frames) for part, frames in side]
            position = np.concatenate([t.position for t in tracks])
            poses.append((position if move is None else position + move, np.concatenate([t.quaternion for t in tracks])))
        pairs = places.reshape(2, -1).T
        return clearance_batch(forest, pairs, *poses, skip_above=self.reach, tolerance=tolerance).distance

    def boxes(self, frames: NDArray[np.intp]) -> tuple[F64, F64]:
        """World boxes that hold all parts [m], shapes (parts, frames, 3); empty from the first broken pose of an entity on."""
        parts = self.parts
        center, half = (np.stack([0.5 * (p.solid.upper + g * p.solid.lower) for p in parts]) for g in (1.0, -1.0))
        radius = np.array([p.solid.sphere_radius for p in parts])
        tracks = [self.track_of(i) for i in range(len(parts))]
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


def surfaces_of(candidate: Candidate) -> Surfaces:
    """Surfaces of a candidate, made once."""
    return candidate.memo(Surfaces, lambda: Surfaces(candidate))
