"""Surfaces among the walls of grains whose vertices move by themselves: elastic bodies and cloth. On a CPU."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import F64, I32
from ..boundaries import BodyState
from ..passes import ALONE, Passes

if TYPE_CHECKING:
    from .lists import Buffer
    from .setup import GrainSetup
    from .walls import Walls

__all__ = ["SoftWalls"]


class SoftWalls:
    """Deforming rows of the walls.

    Args:
        walls: all of them; their vertices stand one after the other, behind a first that is nobody's.
        setup: of the grains.
    """

    def __init__(self, walls: Walls, setup: GrainSetup) -> None:
        wp = warp()
        self._walls = walls
        ends = np.cumsum([1, *(len(b.mesh.vertices) for b in setup.boundaries)])
        self.rows = {k: slice(int(ends[k]), int(ends[k + 1])) for k, b in enumerate(setup.boundaries) if b.deforming}
        own = [np.arange(s.start, s.stop) for s in self.rows.values()]
        place = np.concatenate(own) if own else np.zeros(0, dtype=int)
        self._place = np.full(int(ends[-1]), -1, dtype=np.int64)
        self._place[place] = np.arange(len(place))
        self.count = len(place)
        self._own = wp.array(place.astype(np.int32), dtype=wp.int32, device="cpu")
        self._row = wp.array(np.array([*self.rows], dtype=np.int32), dtype=wp.int32, device="cpu")
        bounds = np.cumsum([0, *(len(o) for o in own)]).astype(np.int32)
        self._bounds = wp.array(bounds, dtype=wp.int32, device="cpu")
        self._impulse = wp.zeros(max(self.count, 1), dtype=wp.vec3d, device="cpu")
        self.forget()

    def forget(self) -> None:
        """No pair is near."""
        self._list(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))

    def begin(self, state: BodyState) -> float:
        """Take vertices as they are at the start of an exchange; the greatest speed [m/s]."""
        walls, fastest = self._walls, 0.0
        vertex, speed, made = walls.vertex.numpy(), walls.bodies.speed.numpy(), walls.bodies
        drift, reach = made.drift.numpy(), made.reach.numpy()
        yields = made.yields.numpy()
        for row, own in self.rows.items():
            places, speeds = state.vertices[row]
            drift[row] += float(np.linalg.norm(vertex[own] - places, axis=1).max())
            vertex[own], speed[own] = places, speeds
            reach[row] = float(np.linalg.norm(places - state.center[row], axis=1).max())
            yields[own] = state.vertex_lightness.get(row, 0.0)
            fastest = max(fastest, float(np.linalg.norm(speeds, axis=1).max()))
        made.drift.assign(drift)
        made.reach.assign(reach)
        self._impulse.zero_()
        return fastest

    def refit(self) -> None:
        """Let the trees over triangles hold them where they are now."""
        vertex = self._walls.vertex.numpy()
        for row, own in self.rows.items():
            mesh = self._walls.meshes[row]
            mesh.points.assign(vertex[own].astype(np.float32))
            mesh.refit()

    def list_near(self, pairs: Any, total: int) -> None:
        """List, for every vertex, the pairs that may meet one of its triangles."""
        body = pairs.body.numpy()[:total]
        which = np.flatnonzero(np.isin(body, list(self.rows)))
        count = pairs.count.numpy()[which]
        slots = np.arange(pairs.triangle.shape[1]) < count[:, None]
        first = self._walls.bodies.offset.numpy()[body[which]]
        faces = (pairs.triangle.numpy()[which] + first[:, None])[slots]
        corners = self._walls.corner.numpy().reshape(-1, 3)[faces]
        pair = np.repeat(which, count)
        both = np.unique(np.stack([self._place[corners].ravel(), np.repeat(pair, 3)], axis=1), axis=0)
        self._list(both[:, 0], both[:, 1])

    def _list(self, vertex: Any, pair: Any) -> None:
        wp = warp()
        start: I32 = np.concatenate([[0], np.cumsum(np.bincount(vertex, minlength=self.count))]).astype(np.int32)
        self._start = wp.array(start, dtype=wp.int32, device="cpu")
        held = pair.astype(np.int32) if len(pair) else np.zeros(1, dtype=np.int32)
        self._near = wp.array(held, dtype=wp.int32, device="cpu")

    def passes(self, run: Passes, now: Buffer, dt: Any, clock: Any) -> list[Any]:
        """Motion of the vertices over one step."""
        from . import soft_kernels as kernels

        if not self.count:
            return []
        walls = self._walls
        inputs = [
            self._own, self._start, self._near, now.pairs, walls.corner, walls.bodies, walls.vertex,
            self._impulse, dt, clock,
        ]  # fmt: skip
        drift = [self._row, self._bounds, self._own, walls.bodies, dt, clock]
        return [
            run("give_way", kernels.give_way, self.count, inputs),
            run("drift_soft", kernels.drift_soft, len(self.rows), drift, smallest=ALONE),
        ]

    def given(self) -> dict[int, F64]:
        """Impulses at the vertices since the exchange began, per row (v, 3) [N s]."""
        found = self._impulse.numpy()
        return {row: found[self._place[own]].copy() for row, own in self.rows.items()}
