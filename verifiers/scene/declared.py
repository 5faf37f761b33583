"""Contacts of entities at their declared places, before any preroll: they tell a tower that was built from a heap that was dropped."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry import Solid, apart
from ...worlds.arrays import F64, RigidPose, compose, pose_of

if TYPE_CHECKING:
    from ...worlds.built import TriangleMesh
    from ...worlds.candidate import Candidate

__all__ = ["Declared"]


class _Part(NamedTuple):
    mesh: TriangleMesh
    closed: bool
    pose: RigidPose
    low: F64
    """Corner of its box [m], shape (3,)."""
    high: F64

    def solid(self) -> Solid:
        return Solid.from_mesh(self.mesh, closed=self.closed)


class Declared:
    """Entities with a surface of their own at their declared poses."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate

    @cached_property
    def _parts(self) -> dict[str, list[_Part]]:
        candidate, found = self.candidate, {}
        for name in candidate.solids:
            if name in candidate.deforming:
                continue
            at, own = pose_of(candidate.spec.entities[name].pose), []
            for part in candidate.entity(name).parts:
                pose = compose(at, candidate.body(name, part.body).pose)
                points = pose.apply(part.render.vertices)
                own.append(_Part(part.render, part.closed, pose, points.min(axis=0), points.max(axis=0)))
            if own:
                found[name] = own
        return found

    def _middle(self, name: str) -> F64:
        low, high = (np.array([getattr(p, side) for p in self._parts[name]]) for side in ("low", "high"))
        return np.asarray(0.5 * (low.min(axis=0) + high.max(axis=0)))

    def stands(self, name: str) -> bool:
        """True where an entity, as declared, touches another one whose middle lies lower."""
        plan = self.candidate.spec.simulation
        gravity, gap = np.array(plan.gravity), plan.limits.contact_gap
        if name not in self._parts or not gravity.any():
            return False
        middle = self._middle(name)
        lower = [n for n in self._parts if n != name and gravity @ (self._middle(n) - middle) > 0.0]
        return any(self._touch(a, b, gap) for n in lower for a in self._parts[name] for b in self._parts[n])

    def _touch(self, a: _Part, b: _Part, gap: float) -> bool:
        if (a.low > b.high + gap).any() or (b.low > a.high + gap).any():
            return False
        return not apart(a.solid(), a.pose, b.solid(), b.pose, gap=gap)
