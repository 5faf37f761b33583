"""Free fall of liquid that touches nothing (R99): chunks that hang in the air, drops that turn in flight.

- `flight`: clusters that touch neither other liquid nor solids fall freely.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ...rows.corrections import bake_again
from ...rows.findings import Finding
from ..clumps import clumps_of
from ..soft_solids import soft_boxes
from .bounds import FLIGHT, LEAST_SLIP
from .corrections import ease
from .questions import FLIGHT_FREE
from .rows import first_over, place
from .solids import Piece, pieces_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Frame, Liquid, Step

__all__ = ["Flight"]

APART = 3.0
"""[spacings] Size of the cubes by which clusters are told apart: one empty cube all around."""


class Flight:
    """Clusters of liquid in the air."""

    questions: ClassVar[Mapping[str, Question]] = FLIGHT_FREE

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.pieces = pieces_of(liquid.candidate)
        self.known: dict[int, NDArray[np.intp]] = {}
        self.slip: list[float] = []
        self.judged = 0
        self.first: tuple[int, int, list[float], float] | None = None

    def see(self, step: Step) -> None:
        """Compare free clusters of this frame with the one before."""
        frame, before, liquid = step.now, step.before, self.liquid
        self.slip.append(0.0)
        if before is None or len(step.here) < 2 or len(step.new) + len(step.gone) > 0.05 * frame.count:
            return
        clusters = self._of(frame)
        earlier = self._of(before)
        free = self._free(step, clusters, earlier)
        if not free.any():
            return
        mine = clusters[step.here]
        keep = free[mine]
        mass: F64 = np.bincount(mine[keep], frame.mass[step.here[keep]], len(free)).astype(np.float64)
        change = frame.velocity[step.here[keep]] - before.velocity[step.there[keep]]
        mean: F64 = np.stack(
            [np.bincount(mine[keep], change[:, a] * frame.mass[step.here[keep]], len(free)) for a in range(3)], axis=1
        )
        mean = mean[free] / mass[free, None] - self._attracted(step, mine, keep, mass)[free]
        slip = np.linalg.norm(mean - liquid.gravity * step.duration, axis=1)
        bound = max(FLIGHT * liquid.strength * step.duration, LEAST_SLIP)
        self.judged += len(slip)
        # One in a hundred clusters may have met a drop between the frames and lost it again.
        order = np.argsort(slip)
        high = slip[order[max(0, int(np.ceil(0.99 * len(order))) - 1)]] if len(order) > 100 else slip.max()
        self.slip[-1] = float(high) / bound
        if self.first is None and high > bound:
            worst = int(np.flatnonzero(free)[int(np.argmax(slip))])
            rows = clusters == worst
            self.first = (frame.index, int(rows.sum()), place(frame.position[rows].mean(axis=0)), float(slip.max()))

    def _attracted(self, step: Step, mine: NDArray[np.intp], keep: NDArray[np.bool_], mass: F64) -> F64:
        """Mean change of velocity of every cluster by attracting fields [m/s]; the mean of both frames'."""
        found = np.zeros((len(mass), 3))
        if not self.liquid.attracted or step.before is None:
            return found
        gain = 0.5 * (self.liquid.pull(step.now, ending=True)[step.here] + self.liquid.pull(step.before)[step.there])[keep]
        weight = gain * step.now.mass[step.here[keep], None]
        for axis in range(3):
            found[:, axis] = np.bincount(mine[keep], weight[:, axis], len(mass))
        return np.asarray(step.duration * found / np.maximum(mass, 1e-300)[:, None])

    def _of(self, frame: Frame) -> NDArray[np.intp]:
        """Cluster of every particle of a frame."""
        if frame.index not in self.known:
            self.known = {k: c for k, c in self.known.items() if k == frame.index - 1}
            self.known[frame.index] = clumps_of(frame.position, APART * self.liquid.spacing)
        return self.known[frame.index]

    def _free(self, step: Step, clusters: NDArray[np.intp], earlier: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Clusters with the same particles at both frames that met no solid and no side of the domain between them."""
        frame, before, liquid = step.now, step.before, self.liquid
        assert before is not None
        count, past = int(clusters.max()) + 1, int(earlier.max()) + 1
        size, then = np.bincount(clusters, minlength=count), np.bincount(earlier, minlength=past)
        a, b = clusters[step.here], earlier[step.there]
        low, high = np.full(count, past), np.full(count, -1)
        np.minimum.at(low, a, b)
        np.maximum.at(high, a, b)
        shared = np.bincount(a, minlength=count)
        same = (low == high) & (shared == size) & (then[np.clip(low, 0, past - 1)] == size)
        travel = 2.0 * liquid.spacing + step.duration * frame.speed
        near = np.zeros(frame.count, dtype=bool)
        near[step.new] = True
        if liquid.fields:  # drops that a medium drags are no free fall
            near |= liquid.air(frame)[1] | liquid.switches(frame.index)
        near |= (np.minimum(frame.position - liquid.lower, liquid.upper - frame.position).min(axis=1)) < travel
        rows = np.flatnonzero(same[clusters])
        for name in liquid.inflows:
            near[rows] |= liquid.near_inflow(name, frame.position[rows], float(travel.max()))
        touched = np.bincount(clusters, near, count) > 0
        rows = rows[~touched[clusters[rows]]]
        self._touch(touched, clusters[rows], frame.position[rows], travel[rows], frame.index)
        return np.asarray(same & ~touched)

    def _touch(self, touched: NDArray[np.bool_], clusters: NDArray[np.intp], points: F64, reach: F64, index: int) -> None:
        """Mark clusters of which a point may have come near a solid: within `reach` [m] of its box at both ends of the frame.

        Of a cluster that is marked no other point is looked at: all of a basin is one, and its walls are many.
        """

        def mark(near: NDArray[np.intp]) -> None:
            nonlocal clusters, points, reach
            if len(near):
                touched[clusters[near]] = True
                left = ~touched[clusters]
                clusters, points, reach = clusters[left], points[left], reach[left]

        for low, high in soft_boxes(self.liquid.candidate, self.liquid.solver, index):
            mark(np.flatnonzero(np.maximum(low - points, points - high).max(axis=1) < reach))
        for piece in self.pieces:
            if not len(points):
                return
            boxes = [piece.box(k) for k in (max(index - 1, 0), index)]
            low, high = np.minimum(boxes[0][0], boxes[1][0]), np.maximum(boxes[0][1], boxes[1][1])
            rows = np.flatnonzero(np.maximum(low - points, points - high).max(axis=1) < reach)
            if len(rows) and not piece.solid.convex:
                rows = rows[~_far(piece, points[rows], reach[rows], index)]
            mark(rows)

    def findings(self) -> dict[str, Finding]:
        """Judge whether all of them fell."""
        if not self.judged:
            return {"flight": Finding("not_applicable", "no cluster of liquid flies free of all else")}
        hints = (
            bake_again("the cache was edited"),
            ease(
                self.liquid,
                "forces act on liquid that is in touch with nothing",
                "lower surface_tension, or let the step follow the flow",
                "surface_tension",
            ),
        )
        found = first_over(
            np.array(self.slip),
            1.0,
            "1",
            "change of velocity of free clusters that gravity does not explain, over what is allowed,",
            hints,
        )
        evidence: dict[str, object] = {"clusters": self.judged}
        if self.first is not None:
            evidence |= {"place": self.first[2], "particles": self.first[1], "slip_m_s": self.first[3]}
        return {"flight": Finding(found.status, found.text, found.measured, 1.0, "1", None, found.frame, found.hints, evidence)}


def _far(piece: Piece, points: F64, reach: F64, index: int) -> NDArray[np.bool_]:
    """Which points are farther from a surface than `reach` [m]."""
    from scipy.spatial import cKDTree

    solid = piece.solid
    # Nearest vertex less the longest edge is a lower bound of the distance; good enough for finely meshed grounds and shells.
    tree: cKDTree = solid.vertex_tree
    edge = np.linalg.norm(solid.vertices[solid.edges[:, 0]] - solid.vertices[solid.edges[:, 1]], axis=1).max()
    return np.asarray(tree.query(piece.local(points, index))[0] - edge > reach)
