"""What holds an entity up at every frame: contacts, joints, drivers, and the chain of them down to something static.

Contacts are read from geometry, never from contact logs: a sleeping body has none (R92).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64
from ..worlds.spec import DetachDriver, ReleaseDriver, Rope

if TYPE_CHECKING:
    from .surfaces import Surfaces

__all__ = ["Link", "SupportGraph", "balance", "drop", "gravity_direction"]

EDGE_SLACK = 5e-4
"""[m] Own choice: points this much farther than the nearest belong to one flat contact."""
DROP_STEPS = 200
NEAR = 1e-5
"""[m] Conservative advancement stops at this clearance."""


class Link(NamedTuple):
    """A joint, spring or rope end between two entities (None: the world), and when it holds, shape (frames,)."""

    name: str
    a: str | None
    b: str
    holds: NDArray[np.bool_]


def gravity_direction(surfaces: Surfaces) -> F64 | None:
    """Unit vector along gravity, shape (3,); None without gravity."""
    gravity = np.array(surfaces.candidate.spec.simulation.gravity, dtype=np.float64)
    strength = float(np.linalg.norm(gravity))
    return gravity / strength if strength > 1e-12 else None


class SupportGraph:
    """Who is held up by whom over the inspected frames, or over the first `until` of them."""

    def __init__(self, surfaces: Surfaces, *, until: int | None = None) -> None:
        self.surfaces = surfaces
        self.until = until
        self._grounded: dict[str, NDArray[np.bool_]] = {}

    @cached_property
    def links(self) -> tuple[Link, ...]:
        """Joints and rope ends; a `detach` driver ends one after its time."""
        spec = self.surfaces.candidate.spec
        frames = np.arange(self.surfaces.frames) / spec.simulation.fps
        opened = {d.joint: d.time for d in spec.simulation.drivers.values() if isinstance(d, DetachDriver)}
        found = [
            Link(name, joint.parent, joint.child, frames <= opened.get(name, math.inf))
            for name, joint in spec.simulation.joints.items()
        ]
        always = np.ones(self.surfaces.frames, dtype=bool)
        for name, entity in spec.entities.items():
            if isinstance(entity.generator, Rope):
                for end in (entity.generator.attach_start, entity.generator.attach_end):
                    if end is not None:
                        found.append(Link(name, None if end == "world" else end, name, always))
        return tuple(found)

    def linked(self, a: str, b: str) -> NDArray[np.bool_]:
        """At which frames a joint or rope end holds the two together, shape (frames,)."""
        holds = np.zeros(self.surfaces.frames, dtype=bool)
        for link in self.links:
            if {link.a, link.b} == {a, b}:
                holds |= link.holds
        return holds

    def jointed(self, entity: str) -> bool:
        """Whether any joint or rope end is attached to the entity at frame 0."""
        return any(entity in (link.a, link.b) and bool(link.holds[0]) for link in self.links)

    def held(self, entity: str) -> NDArray[np.bool_]:
        """At which frames the entity needs nothing beneath it: static, authored, not yet released, or fixed to the world."""
        spec = self.surfaces.candidate.spec
        if spec.entities[entity].motion != "dynamic":
            return np.ones(self.surfaces.frames, dtype=bool)
        time = np.arange(self.surfaces.frames) / spec.simulation.fps
        holds = np.zeros(self.surfaces.frames, dtype=bool)
        for driver in spec.simulation.drivers.values():
            if isinstance(driver, ReleaseDriver) and driver.entity == entity:
                holds |= time <= driver.time
        for link in self.links:
            if link.a is None and link.b == entity:
                holds |= link.holds
        return holds

    def _holders(self, entity: str) -> Iterator[tuple[str, NDArray[np.bool_]]]:
        """What holds the entity, directly, and when."""
        for other in self.surfaces.neighbours.get(entity, ()):
            if self.linked(other, entity).all():
                continue
            carried = self.surfaces.carries(other, entity, until=self.until)
            if carried.any():
                yield other, carried
        for link in self.links:
            if link.a is not None and entity in (link.a, link.b) and link.a != link.b:
                yield (link.b if entity == link.a else link.a), link.holds

    def grounded(self, entity: str) -> NDArray[np.bool_]:
        """At which frames a continuous chain of holders leads from the entity to something held, shape (frames,)."""
        if entity not in self._grounded:
            holders: dict[str, list[tuple[str, NDArray[np.bool_]]]] = {}
            waiting = [entity]
            while waiting:
                name = waiting.pop()
                if name in holders:
                    continue
                holds = self.held(name)
                holders[name] = [] if holds.all() or name in self._grounded else list(self._holders(name))
                waiting += [other for other, _ in holders[name]]
            state = {name: self._grounded.get(name, self.held(name)).copy() for name in holders}
            changed = True
            while changed:
                changed = False
                for name, edges in holders.items():
                    before = int(state[name].sum())
                    for other, holds in edges:
                        state[name] |= holds & state[other]
                    changed |= int(state[name].sum()) > before
            self._grounded |= state
        return self._grounded[entity]

    def chain(self, entity: str, frame: int) -> list[str]:
        """Shortest chain of holders from the entity to something held at a frame; empty where there is none."""
        paths: list[list[str]] = [[entity]]
        seen = {entity}
        while paths:
            path = paths.pop(0)
            if self.held(path[-1])[frame]:
                return path
            for other, holds in self._holders(path[-1]):
                if holds[frame] and other not in seen:
                    seen.add(other)
                    paths.append([*path, other])
        return []


def drop(surfaces: Surfaces, entity: str, frame: int) -> tuple[float, str] | None:
    """How far the entity falls along gravity until it meets something [m], and what; None where nothing lies beneath.

    Conservative advancement: it moves by the clearance, which no obstacle can be nearer than.
    """
    direction = gravity_direction(surfaces)
    if direction is None:
        return None
    low, high = surfaces.boxes(np.array([frame]))
    own = list(surfaces.parts_of[entity])
    reach = float(np.linalg.norm(high[:, 0].max(axis=0) - low[:, 0].min(axis=0)))
    start, stop = low[own, 0].min(axis=0), high[own, 0].max(axis=0)
    start, stop = np.minimum(start, start + reach * direction), np.maximum(stop, stop + reach * direction)
    meets = ((low[:, 0] <= stop) & (high[:, 0] >= start)).all(axis=1)
    others = {surfaces.parts[i].entity for i in np.flatnonzero(meets)} - {entity}
    best: tuple[float, str] | None = None
    for other in sorted(others):
        fallen = 0.0
        for _ in range(DROP_STEPS):
            clearance = surfaces.gap(entity, other, frame, offset=fallen * direction).distance
            if clearance <= NEAR or (best is not None and fallen >= best[0]) or fallen > reach:
                break
            fallen += clearance
        if fallen <= reach and clearance <= NEAR and (best is None or fallen < best[0]):
            best = (fallen, other)
    return best


def balance(surfaces: Surfaces, entity: str, carriers: list[str], frame: int) -> tuple[float, F64] | None:
    """How far the centre of mass lies outside the polygon of contact points, seen along gravity [m]; negative inside.

    Also returns the horizontal way back to the polygon's middle, shape (3,). Contact points are the corners of the
    overlap of the touching faces: vertices of either near the other, and crossings of edges. None without contact.
    """
    direction = gravity_direction(surfaces)
    if direction is None:
        return None
    found = [p for other in carriers for p in _contact_points(surfaces, entity, other, frame)]
    if not found:
        return None
    points = np.array(found)
    center = surfaces.candidate.center(entity, frame)
    side = np.linalg.svd(direction[None])[2][1:]
    flat, middle = (points - center) @ side.T, np.zeros(2)
    distance = _outside(flat, middle)
    return distance, np.asarray((flat.mean(axis=0)) @ side)


def _outside(points: F64, query: F64) -> float:
    """Signed distance of a point in the plane outside the convex hull of others; negative inside."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):
        spread = points - points.mean(axis=0)
        axis = np.linalg.svd(spread)[2][0] if len(points) > 1 else np.array([1.0, 0.0])
        along = spread @ axis
        start, end = points[along.argmin()], points[along.argmax()]
        length = float((end - start) @ (end - start))
        t = float(np.clip((query - start) @ (end - start) / length, 0.0, 1.0)) if length > 0.0 else 0.0
        return float(np.linalg.norm(start + t * (end - start) - query))
    planes = hull.equations[:, :2] @ query + hull.equations[:, 2]
    if planes.max() <= 0.0:
        return float(planes.max())
    corners = points[hull.simplices]
    along = corners[:, 1] - corners[:, 0]
    t = np.clip(np.einsum("ni,ni->n", query - corners[:, 0], along) / np.einsum("ni,ni->n", along, along), 0.0, 1.0)
    return float(np.linalg.norm(corners[:, 0] + t[:, None] * along - query, axis=1).min())


def _contact_points(surfaces: Surfaces, a: str, b: str, frame: int) -> list[F64]:
    from ..geometry import distance_to_surface
    from ..geometry.triangles import segment_points

    nearest = surfaces.gap(a, b, frame)
    if nearest.distance > surfaces.contact_gap(a, b):
        return []
    found = [0.5 * (nearest.point_a + nearest.point_b)]
    for i in surfaces.parts_of[a]:
        for j in surfaces.parts_of[b]:
            one, two = surfaces.parts[i], surfaces.parts[j]
            slack = max(nearest.distance, 0.0) + EDGE_SLACK + one.deviation + two.deviation
            pose_a, pose_b = surfaces.track(a, one.body).at(frame), surfaces.track(b, two.body).at(frame)
            here, there = pose_a.apply(one.solid.vertices), pose_b.apply(two.solid.vertices)
            low = np.maximum(here.min(axis=0), there.min(axis=0)) - slack
            high = np.minimum(here.max(axis=0), there.max(axis=0)) + slack
            if (low > high).any():
                continue
            for points, solid, pose in ((here, two.solid, pose_b), (there, one.solid, pose_a)):
                inside = points[((points >= low) & (points <= high)).all(axis=1)]
                if len(inside):
                    distance = distance_to_surface(solid, pose.inverse().apply(inside)).distance
                    found += list(inside[distance <= slack])
            edges = [_near_edges(p, s.edges, low, high) for p, s in ((here, one.solid), (there, two.solid))]
            (p, q), (r, s) = (edges[0][:, 0], edges[0][:, 1]), (edges[1][:, 0], edges[1][:, 1])
            if 0 < len(p) * len(r) <= 1_000_000:
                u, v = (q - p)[:, None], (s - r)[None]
                t, w = segment_points(p[:, None], u, r[None], v)
                first, second = p[:, None] + t[..., None] * u, r[None] + w[..., None] * v
                close = np.linalg.norm(first - second, axis=-1) <= slack
                found += list(first[close])
    return found


def _near_edges(points: F64, edges: NDArray[np.int32], low: F64, high: F64) -> F64:
    """Edges whose boxes meet a box, shape (n, 2, 3)."""
    ends = points[edges]
    meets = ((ends.min(axis=1) <= high) & (ends.max(axis=1) >= low)).all(axis=1)
    return np.asarray(ends[meets])
