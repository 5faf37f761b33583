"""Visible surfaces of a candidate and the clearances between them, computed once and shared by the spatial checks.

A coarse search over axis-aligned boxes finds the pairs of entities that come within reach of each other; the signed
clearance of their visible surfaces decides. Pairs inside one entity are not inspected.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...geometry import Care, Meetings, aabb_of, clearance_batch, meetings, signed_clearance, turned_boxes
from ...worlds.arrays import F64, RigidPose, rotation_matrix
from ..rows.telling import tell
from .at_start import Gap, measured_together, nearest_parts, own_distances
from .bounds import MOVED_SHARE, ROUNDING, SUPPORT_SLOPE
from .parts import Pair, Parts
from .shifted import Shifted, Start, shifted

if TYPE_CHECKING:
    from ...geometry import Clearance
    from ...worlds.candidate import Candidate

__all__ = ["MANY_PARTS", "NOWHERE", "Gap", "Surfaces", "surfaces_of"]

NOWHERE = 1e300
"""[m] Corner of the empty box that stands for a broken pose."""

FEW_VERTICES = 1000
"""Own choice: parts of more vertices are put in their places one by one."""
MANY_PARTS = 1000
"""Own choice: parts of a world from which on all its pairs are measured together at frame 0, and loading compiled loops, half a second, is worth while."""
QUERIES = 500_000
"""Clearances measured in one batch: about 150 MB."""


class Surfaces(Parts):
    """Clearances between the parts of one candidate; obtain it with `surfaces_of`."""

    def __init__(self, candidate: Candidate) -> None:
        super().__init__(candidate)
        self._near: dict[Pair, set[tuple[int, int]]] = {}
        self._support: dict[tuple[str, str, int], NDArray[np.bool_]] = {}
        self._boxes: dict[int, tuple[F64, F64]] = {}
        self._gaps: dict[Pair, Gap] = {}
        self._measured: dict[tuple[int, int], Clearance] = {}
        self._near_at_start: dict[Pair, set[tuple[int, int]]] = {}
        self._tight: tuple[int, dict[int, tuple[F64, F64]]] = (0, {})
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
        for number, (start, stop) in enumerate(zip(starts, stops, strict=False), 1):
            tell("distances of parts: pair", number, len(starts))
            group.append((int(met.first[start]), int(met.second[start]), met.frame[start:stop]))
            held += stop - start
            if held >= QUERIES or stop == len(met.first):
                self._measure(group, frames, found)
                group, held = [], 0
        return {pair: series for pair, series in found.items() if series.min() <= self.reach}

    def _clearances(
        self,
        asked: list[tuple[int, int, NDArray[np.intp]]],
        *,
        shift: F64 | None = None,
        tolerance: float = 0.0,
        enough: float | F64 = np.inf,
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
        return clearance_batch(forest, pairs, *poses, skip_above=self.reach, care=Care(tolerance, enough)).distance

    def boxes(self, frames: NDArray[np.intp]) -> tuple[F64, F64]:
        """World boxes that hold all parts [m], shapes (parts, frames, 3); empty from the first broken pose of an entity on."""
        if len(frames) != 1:
            return self._boxes_at(frames)
        if int(frames[0]) not in self._boxes:  # asked again and again, for one frame
            self._boxes = {int(frames[0]): self._boxes_at(frames)}
        return self._boxes[int(frames[0])]

    def _boxes_at(self, frames: NDArray[np.intp]) -> tuple[F64, F64]:
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

    def tight_boxes(self, entity: str, frame: int) -> tuple[F64, F64]:
        """World boxes around the vertices of each part of an entity at a frame [m], shapes (parts, 3); see `boxes`."""
        rows = self.parts_of[entity]
        if frame == 0:
            return self.boxes_at_start[0][list(rows)], self.boxes_at_start[1][list(rows)]
        if self._tight[0] != frame:
            self._tight = (frame, {})
        known = self._tight[1]
        for i in rows:
            if i not in known:
                known[i] = self._tight_box(i, frame)
        return np.array([known[i][0] for i in rows]), np.array([known[i][1] for i in rows])

    def _tight_box(self, part: int, frame: int) -> tuple[F64, F64]:
        pose = self.track_of(part).at(frame)
        low, high = aabb_of(self.shapes.solid(part, frame).vertices, pose.position[None], pose.quaternion[None])
        return low[0], high[0]

    @cached_property
    def boxes_at_start(self) -> tuple[F64, F64]:
        """Boxes around the vertices of all parts at frame 0 [m], shapes (parts, 3); those of many vertices one by one."""
        solids = [self.shapes.solid(i, 0) for i in range(len(self.parts))]
        poses = [self.track_of(i).at(0) for i in range(len(self.parts))]
        low, high = np.empty((2, len(self.parts), 3))
        few = [i for i, s in enumerate(solids) if len(s.vertices) <= FEW_VERTICES]
        for rows in (few[k : k + 1000] for k in range(0, len(few), 1000)):
            count = np.array([len(solids[i].vertices) for i in rows])
            turn = np.repeat(rotation_matrix(np.array([poses[i].quaternion for i in rows])), count, axis=0)
            moved = np.einsum("nij,nj->ni", turn, np.concatenate([solids[i].vertices for i in rows]))
            position, starts = np.array([poses[i].position for i in rows]), np.cumsum(count) - count
            low[rows], high[rows] = (f.reduceat(moved, starts) + position for f in (np.minimum, np.maximum))
        for i in {*range(len(solids))} - {*few}:
            low[i], high[i] = self._tight_box(i, 0)
        return low, high

    @cached_property
    def own(self) -> dict[tuple[int, int], float]:
        """Clearance [m] at frame 0 of parts (i < j) of one entity, as far as it was cheap to ask for all at once; above `reach` a bound."""
        low, high = self.boxes(np.zeros(1, dtype=np.intp))
        return own_distances(self, (low[:, 0], high[:, 0]))

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
                self._near_at_start.setdefault(pair, set()).add((i, j))

    @cached_property
    def first(self) -> dict[Pair, float]:
        """Clearance [m] at frame 0 of every pair within `reach`, static pairs included."""
        return {pair: float(series[0]) for pair, series in self.scan(np.zeros(1, dtype=np.intp), static=True).items()}

    @cached_property
    def moving(self) -> dict[Pair, F64]:
        """Clearance [m] over all frames of every pair that comes within `reach` and of which one moves."""
        if self.frames == 1:
            still = frozenset(n for n in self.entities if self.is_static(n))
            return {pair: np.array([found]) for pair, found in self.first.items() if not still.issuperset(pair)}
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
        if frame > 0 or offset is not None:
            return self._gap(a, b, frame, offset)
        if self._near_at_start and not self._gaps:
            for pair, found in nearest_parts(self, self._near_at_start, self.at_start, partial(self.tight_boxes, frame=0)):
                self._gaps |= {pair: found, pair[::-1]: found.turned()}
            if len(self.parts) >= MANY_PARTS:
                left = [self._near_at_start[pair] for pair in self.first if pair not in self._gaps]
                self._measured = measured_together(self, left, self.at_start)
        if (a, b) not in self._gaps:  # the checks of overlap and of support both ask where things touch at the start
            self._gaps[a, b] = self._gap(a, b, 0, None)
        return self._gaps[a, b]

    def _gap(self, a: str, b: str, frame: int, offset: F64 | None) -> Gap:
        shift = np.zeros(3) if offset is None else offset
        placed = []
        for name, move in ((a, shift), (b, np.zeros(3))):
            rows = self.parts_of[name]
            poses = [self.track(self.parts[i].entity, self.parts[i].body).at(frame) for i in rows]
            poses = [RigidPose(p.position + move, p.quaternion) for p in poses]
            low, high = self.tight_boxes(name, frame)
            placed.append((rows, poses, low + move, high + move))
        (rows_a, poses_a, low_a, high_a), (rows_b, poses_b, low_b, high_b) = placed
        apart = np.maximum(np.maximum(low_a[:, None] - high_b, low_b - high_a[:, None]), 0.0)
        bound = np.linalg.norm(apart, axis=2)
        best: Gap | None = None
        least = self._at_start(rows_a, rows_b) if frame == 0 and offset is None else np.full(bound.shape, -math.inf)
        # Above `reach` they are lower bounds.
        exact = least[(least > -math.inf) & (least <= self.reach)]
        beyond = least > max(float(exact.min(initial=math.inf)), 0.0) + ROUNDING
        for k in np.argsort(bound, axis=None, kind="stable"):
            i, j = divmod(int(k), len(rows_b))
            if best is not None and bound[i, j] > max(best.distance, 0.0):
                break
            if beyond[i, j]:
                continue
            one, two = self.parts[rows_a[i]], self.parts[rows_b[j]]
            known = self._measured.get((rows_a[i], rows_b[j])) if frame == 0 and offset is None else None
            if known is None:
                solids = self.shapes.solid(rows_a[i], frame), self.shapes.solid(rows_b[j], frame)
                known = signed_clearance(solids[0], poses_a[i], solids[1], poses_b[j])
            found = known
            if best is None or found.distance < best.distance:
                best = Gap(found.distance, found.point_a, found.point_b, one.part, two.part)
        assert best is not None
        return best

    def _at_start(self, first: Sequence[int], second: Sequence[int]) -> F64:
        """Clearance at frame 0 of every pair of two lists of parts as far as `at_start` has it, else -inf [m], shape (first, second)."""
        known = [[self.at_start.get((min(i, j), max(i, j)), -math.inf) for j in second] for i in first]
        return np.array(known, dtype=np.float64)

    def farther(self, i: int, j: int, frame: int, distance: float) -> bool:
        """True if two parts are known to be farther apart at a frame than `distance` [m]; nothing is measured."""
        return frame == 0 and self.at_start.get((min(i, j), max(i, j)), -math.inf) > distance + ROUNDING

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
        last = self.frames if until is None else min(until, self.frames)
        key = (below, above, last)
        if key not in self._support:
            asked = {(below, above)}
            if last == 1:  # one frame: all that touch are asked about sooner or later, and together they cost little
                still = {n for n in self.entities if self.is_static(n)}
                ways = (way for a, b in {*self.first, *self.moving} for way in ((a, b), (b, a)))
                asked |= {(a, b) for a, b in ways if b not in still or a in still}
            for gap in sorted({self.contact_gap(*pair) for pair in asked}):
                same = sorted(p for p in asked if self.contact_gap(*p) == gap and (*p, last) not in self._support)
                self._support |= {(*pair, last): found for pair, found in self._carried(same, last, gap).items()}
        return self._support[key]

    def _carried(self, pairs: Sequence[Pair], until: int, gap: float) -> dict[Pair, NDArray[np.bool_]]:
        """For pairs (below, above) of one contact tolerance `gap` [m], at which frames below `until` the first carries the second."""
        found = {pair: np.zeros(self.frames, dtype=bool) for pair in pairs}
        distance = {pair: self.series(*pair) for pair in pairs}
        touching = {p: np.flatnonzero(d[:until] <= gap) for p, d in distance.items() if not {p, p[::-1]} & self.candidate.apart}
        touching = {pair: frames for pair, frames in touching.items() if len(frames)}
        gravity = np.array(self.candidate.spec.simulation.gravity)
        strength = float(np.linalg.norm(gravity))
        if strength < 1e-12:
            for pair, frames in touching.items():
                found[pair][frames] = True
            return found
        fall = gap * gravity / strength
        least = {pair: distance[pair][frames] + SUPPORT_SLOPE * gap for pair, frames in touching.items()}
        for pair, raised in self._moved(least, touching, -fall, gap).items():
            found[pair][touching[pair]] = raised >= least[pair]
        unsure = {pair: frames[~found[pair][frames]] for pair, frames in touching.items()}
        unsure = {pair: frames for pair, frames in unsure.items() if len(frames)}
        most = {pair: distance[pair][frames] - SUPPORT_SLOPE * gap for pair, frames in unsure.items()}
        for pair, lowered in self._moved(most, unsure, fall, gap).items():
            found[pair][unsure[pair]] = lowered <= most[pair]
        return found

    def _moved(
        self, bound: Mapping[Pair, F64], asked: Mapping[Pair, NDArray[np.intp]], offset: F64, gap: float
    ) -> dict[Pair, F64]:
        """Clearance of pairs (below, above) at some frames with `above` moved by `offset` [m], shape (frames,) each.

        It is compared with a bound [m]: what is far beyond it may be any such value.
        """
        found = {pair: np.full(len(frames), np.inf) for pair, frames in asked.items()}
        parts = {pair: self._near_parts(*pair) for pair in asked}
        if all(frames.tolist() == [0] for frames in asked.values()):
            known, parts = self._settled(parts, bound, offset)
            found |= {pair: np.array([value]) for pair, value in known.items()}
        queries: list[tuple[int, int, NDArray[np.intp]]] = []
        owner: list[Pair] = []
        enough: list[F64] = []
        for pair, some in parts.items():
            queries += [(above, below, asked[pair]) for above, below in some]
            owner += [pair] * len(some)
            enough += [np.maximum(-bound[pair], 0.0) + gap * SUPPORT_SLOPE] * len(some)
        if queries:
            tolerance = MOVED_SHARE * SUPPORT_SLOPE * gap
            values = self._clearances(queries, shift=offset, tolerance=tolerance, enough=np.concatenate(enough))
            ends = np.cumsum([len(frames) for *_, frames in queries])
            for pair, own in zip(owner, np.split(values, ends[:-1]), strict=True):
                found[pair] = np.minimum(found[pair], own)
        return found

    def _near_parts(self, below: str, above: str) -> list[tuple[int, int]]:
        """Parts (above, below) of two entities that come near each other at some frame."""
        return sorted({(j, i) for i, j in self._near.get((below, above), ())} | self._near.get((above, below), set()))

    def _settled(self, parts: Mapping[Pair, Sequence[tuple[int, int]]], bound: Mapping[Pair, F64], offset: F64) -> Shifted:
        """Answers of bounds about pairs at frame 0."""
        start = Start(self.at_start, self.boxes_at_start, self.known_gap)
        return shifted(self, start, parts, {pair: float(bound[pair][0]) for pair in parts}, offset)

    def known_gap(self, a: str, b: str) -> Gap | None:
        """The gap of two entities at frame 0 as far as it was measured before."""
        turned = self._gaps.get((b, a))
        return self._gaps.get((a, b), None if turned is None else turned.turned())

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
