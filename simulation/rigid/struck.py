"""Vessels of liquid that something may strike: how long an exchange may be, so that a wall moves little before its liquid knows.

A coupled liquid steps first, around bodies as they move at the start of the exchange; what strikes a body within it is seen at the next.
By then a wall that was struck has come up to `c dt` into its liquid, where c is how fast the two closed, and in a vessel of width L
that presses it together by `c dt / L` on average. What an engine may leave of that (`CoupledSolver.SQUEEZE`) gives the step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .records import velocities

if TYPE_CHECKING:
    from ..coupled_solver import CoupledSolver
    from .solver import SolverRigid

__all__ = ["Struck"]

HELD = 0.2
"""[1] Own choice: share of an instance's particles within the box about a body from which on that body is their vessel."""
CLOSER = 0.9
"""[1] Own choice: share of the way to what comes near that an exchange may take before it is shortened."""


class _Vessel(NamedTuple):
    """A body that holds liquid at the start."""

    row: int
    """Row among the moving bodies."""
    width: float
    """Least extent of what it holds, along its own axes [m]."""
    squeeze: float
    """Mean compression that the engine of what it holds may leave [1]."""


class _Box(NamedTuple):
    """Boxes along the world's axes, of collision shapes."""

    center: F64
    half: F64

    def gaps(self, other: _Box) -> F64:
        """Distances between all of these and all of those [m], at most 0 where they overlap, shape (n, m)."""
        apart = np.abs(self.center[:, None] - other.center[None]) - self.half[:, None] - other.half[None]
        return np.asarray(apart.max(axis=2))


class Struck:
    """Looks, before every exchange, whether a vessel may be struck within it.

    Args:
        rigid: the running rigid instance, compiled.
        others: what is coupled with it, at the start.
    """

    def __init__(self, rigid: SolverRigid, others: Sequence[CoupledSolver]) -> None:
        self._rigid = rigid
        self._model: Any = None
        self._vessels: list[_Vessel] = []
        for other in others:
            if math.isfinite(other.squeeze()):
                self._vessels += self._holding(other.coordinates()[0], other.squeeze())

    def span(self, left: float, usual: float) -> float:
        """Longest next exchange [s], `left` [s] before the end of the frame, where `usual` [s] is what it would be: equal parts of what is left."""
        longest = min((self._longest(v, min(left, usual)) for v in self._vessels), default=math.inf)
        return left / max(1, math.ceil(left / longest - 1e-6)) if longest < left else left

    def _holding(self, particles: F64, squeeze: float) -> list[_Vessel]:
        """The bodies free to move in whose boxes, along their own axes, enough of the particles lie."""
        self._look()
        model, data, rigid = self._model, self._rigid.data, self._rigid.rigid
        found = []
        for row, body in enumerate(rigid.body_ids):
            own = self._geoms(int(body))
            if model.body_dofnum[body] == 0 or not len(own) or not len(particles):
                continue
            turn = data.xmat[body].reshape(3, 3)
            box = self._boxes(own, turn)
            place = (particles - data.xpos[body]) @ turn
            low, high = (box.center - box.half).min(axis=0), (box.center + box.half).max(axis=0)
            inside = ((place > low) & (place < high)).all(axis=1)
            if inside.mean() >= HELD:
                found.append(_Vessel(row, float(np.ptp(place[inside], axis=0).min()), squeeze))
        return found

    def _longest(self, vessel: _Vessel, usual: float) -> float:
        """Longest exchange for one vessel [s]: by the fastest of what may reach it within `usual` [s]."""
        self._look()
        model, data = self._model, self._rigid.data
        body = int(self._rigid.rigid.body_ids[vessel.row])
        own, rest = self._geoms(body), np.flatnonzero(self._solid & (model.geom_bodyid != body))
        if not len(own) or not len(rest):
            return math.inf
        linear, angular = velocities(model, data)
        turning = np.linalg.norm(angular, axis=1) * self._arm
        owner = model.geom_bodyid[rest]
        speed = np.linalg.norm(linear[owner] - linear[body], axis=1) + turning[owner] + turning[body]
        gap = np.maximum(self._boxes(own).gaps(self._boxes(rest)).min(axis=0), 0.0)
        near = (gap < speed * usual) & (speed > 0)
        if not near.any():
            return math.inf
        return float((np.maximum(vessel.squeeze * vessel.width, CLOSER * gap[near]) / speed[near]).min())

    def _look(self) -> None:
        """Read what does not change from the model, which a body that breaks has anew."""
        model = self._rigid.model
        if model is self._model:
            return
        import mujoco

        self._model = model
        self._solid: NDArray[np.bool_] = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
        self._aabb: F64 = model.geom_aabb.copy()
        self._aabb[model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE, 3:] = 1e6
        reach, inner = np.zeros(model.nbody), np.full(model.nbody, np.inf)
        away = np.linalg.norm(model.geom_pos - model.body_ipos[model.geom_bodyid], axis=1)
        np.maximum.at(reach, model.geom_bodyid, model.geom_rbound + away)
        np.minimum.at(inner, model.geom_bodyid, np.maximum(self._aabb[:, 3:].min(axis=1) - away, 0.0))
        # By turning, a face moves along its normal no faster than its points lie off the foot of the centre on it: a ball's not at all.
        self._arm = np.sqrt(np.maximum(reach**2 - np.minimum(inner, reach) ** 2, 0.0))

    def _geoms(self, body: int) -> NDArray[np.intp]:
        return np.flatnonzero(self._solid & (self._model.geom_bodyid == body))

    def _boxes(self, geoms: NDArray[np.intp], turn: F64 | None = None) -> _Box:
        """Boxes about shapes along the world's axes; with `turn`, along those and from the origin of the body that they belong to."""
        data = self._rigid.data
        axes, place = data.geom_xmat[geoms].reshape(-1, 3, 3), data.geom_xpos[geoms]
        if turn is not None:
            body = self._model.geom_bodyid[geoms]
            axes, place = turn.T @ axes, (place - data.xpos[body]) @ turn
        middle, half = self._aabb[geoms, :3], self._aabb[geoms, 3:]
        return _Box(place + np.einsum("nij,nj->ni", axes, middle), np.einsum("nij,nj->ni", np.abs(axes), half))
