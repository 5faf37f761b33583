"""Entities that would stand in each other, by exact clearance."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..geometry import query_noise
from ..worlds.arrays import F64, RigidPose
from .scenes import Body, Scene, clearance

__all__ = ["Obstacles", "Overlap", "overlaps"]


class Overlap(NamedTuple):
    """Two entities that stand in each other, and how deep [m]."""

    a: str
    b: str
    depth: float


class Obstacles:
    """Entities that others may not stand in, with their boxes.

    Args:
        scene: the world.
        names: ids of them; liquids among them give way, for their volume is what solids leave of it.
    """

    def __init__(self, scene: Scene, names: Iterable[str]) -> None:
        self._scene = scene
        self.names = [n for n in names if not scene.spec.entities[n].physics.levels]
        boxes = [scene.body(n).box(scene.pose(n)) for n in self.names]
        self._low, self._high = (np.array([b[k] for b in boxes]).reshape(-1, 3) for k in (0, 1))

    def met(self, body: Body, pose: RigidPose) -> Iterator[tuple[str, float]]:
        """Entities that a body would stand in, each with how deep [m]."""
        low, high = body.box(pose)
        for i in np.flatnonzero(~((low > self._high).any(1) | (high < self._low).any(1))):
            name = self.names[int(i)]
            distance = clearance(body, pose, self._scene.body(name), self._scene.pose(name))
            if distance < -_noise(low, high, self._low[i], self._high[i]):
                yield name, -distance


def overlaps(
    scene: Scene, bodies: Mapping[str, Body], places: Mapping[str, RigidPose], kin: Sequence[Collection[str]]
) -> Iterator[Overlap]:
    """Pairs that overlap when entities stand at these places, with at least one of them, those declared fastened left out.

    Args:
        scene: the world; what has no place here stands where it is.
        bodies: surfaces of those that have one.
        places: where they stand.
        kin: sets of them that keep their places to each other, which are not asked again.
    """
    spec = scene.spec
    meant = {frozenset((r.a, r.b)) for r in spec.graph.relations.values() if r.kind == "fastened"}
    solid = [n for n in places if n not in spec.entities or not spec.entities[n].physics.levels]
    others = Obstacles(scene, (n for n in spec.entities if n not in places))
    boxes = {n: bodies[n].box(places[n]) for n in solid}
    family = {n: k for k, names in enumerate(kin) for n in names}
    for i, a in enumerate(solid):
        for other, depth in others.met(bodies[a], places[a]):
            if frozenset((a, other)) not in meant:
                yield Overlap(a, other, depth)
        low, high = boxes[a]
        for b in solid[i + 1 :]:
            if family.get(a, -1) == family.get(b, -2) or frozenset((a, b)) in meant:
                continue
            if (low > boxes[b][1]).any() or (high < boxes[b][0]).any():
                continue
            distance = clearance(bodies[a], places[a], bodies[b], places[b])
            if distance < -_noise(low, high, *boxes[b]):
                yield Overlap(a, b, -distance)


def _noise(low: F64, high: F64, other_low: F64, other_high: F64) -> float:
    return query_noise(float(max(np.linalg.norm(high - low), np.linalg.norm(other_high - other_low))))
