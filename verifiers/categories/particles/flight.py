"""Particles that fly alone: between hits their way is that of gravity, drag and fields (R65).

A particle is judged over a frame in which its whole way stays clear of the boxes of all solids: nothing can have hit it. From its
place and velocity at one frame, its equation of motion is solved anew (fourth-order Runge-Kutta) up to the next.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....physics.drag import sphere_drag_rate
from ....worlds.arrays import F64
from ...ledgers.fields import fields_in
from ...rows.corrections import bake_again, halve_step
from ...rows.findings import Finding
from ..liquid.solids import pieces_of
from .bounds import FLIGHT, MOST
from .frames import matched
from .questions import FLIGHT_FREE

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Swarm, SwarmFrame

__all__ = ["Flight"]

STEPS = 8
"""Steps of the integration in a frame."""


class Flight:
    """The law of flight, and speed."""

    questions: ClassVar[Mapping[str, Question]] = FLIGHT_FREE

    def __init__(self, swarm: Swarm) -> None:
        self.swarm = swarm
        self.fields = [fields_in(swarm.candidate, m) for m in swarm.members]
        self.pieces = pieces_of(swarm.candidate)
        self.judged = 0
        self.worst, self.at = 0.0, 0
        self.first: tuple[int, int, float] | None = None

    def see(self, now: SwarmFrame, before: SwarmFrame | None) -> None:
        """Compare one frame with the one before."""
        if self.swarm.granular or before is None:
            return
        here, there = matched(now, before)
        here, there = here[: 4 * MOST], there[: 4 * MOST]
        path = self._flown(before, there)
        free = self._clear(np.concatenate([path, now.position[here][None]]), now.index)
        here, there, place = here[free], there[free], path[-1][free]
        if not len(here):
            return
        way = np.linalg.norm(now.position[here] - before.position[there], axis=1)
        reach = np.maximum(way, np.linalg.norm(before.velocity[there], axis=1) * self.swarm.duration)
        off = (np.linalg.norm(now.position[here] - place, axis=1) - now.radius[here]) / np.maximum(reach, 1e-6)
        self.judged += len(off)
        if float(off.max()) > self.worst:
            self.worst, self.at = float(off.max()), now.index
        if (off > FLIGHT).any() and self.first is None:
            self.first = (now.index, int((off > FLIGHT).sum()), float(off.max()))

    def _clear(self, path: F64, index: int) -> NDArray[np.bool_]:
        """True where ways (k, n, 3) stay clear of the boxes of all solids at both frames."""
        margin = 4.0 * self.swarm.radius
        low, high = path.min(axis=0) - margin, path.max(axis=0) + margin
        clear = np.ones(path.shape[1], dtype=bool)
        for piece in self.pieces:
            for frame in {index - 1, index} if not piece.still else {index}:
                a, b = piece.box(frame)
                clear &= np.asarray((high < a).any(axis=1) | (low > b).any(axis=1), dtype=bool)
        return clear

    def _flown(self, frame: SwarmFrame, rows: Any) -> F64:
        """Places over the next frame, shape (steps + 1, n, 3)."""
        x, v = frame.position[rows].copy(), frame.velocity[rows].copy()
        h, time = self.swarm.duration / STEPS, frame.index * self.swarm.duration
        path = [x]
        for k in range(STEPS):
            t = time + k * h
            k1, a1 = v, self._pull(frame, rows, x, v, t)
            k2 = v + 0.5 * h * a1
            a2 = self._pull(frame, rows, x + 0.5 * h * k1, k2, t + 0.5 * h)
            k3 = v + 0.5 * h * a2
            a3 = self._pull(frame, rows, x + 0.5 * h * k2, k3, t + 0.5 * h)
            k4 = v + h * a3
            a4 = self._pull(frame, rows, x + h * k3, k4, t + h * (1 - 1e-6))
            x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
            path.append(x)
        return np.array(path)

    def _pull(self, frame: SwarmFrame, rows: Any, x: F64, v: F64, time: float) -> F64:
        """Acceleration [m/s^2]."""
        a: F64 = np.tile(self.swarm.gravity, (len(x), 1))
        for k, fields in enumerate(self.fields):
            own = np.flatnonzero(frame.member[rows] == k)
            if not fields or not len(own):
                continue
            a[own] += fields.acceleration(x[own], time)
            medium = fields.medium(x[own], time)
            rate = sphere_drag_rate(medium, frame.radius[rows][own], frame.mass[rows][own], v[own])
            a[own] += rate[:, None] * (medium.velocity - v[own])
        return a

    def findings(self) -> dict[str, Finding]:
        """Finding on the question by name."""
        if self.swarm.granular:
            return {"flight": Finding("not_applicable", "grains touch each other; their momentum and energy are judged")}
        if not self.judged:
            return {
                "flight": Finding(
                    "unverified",
                    "no particle flies clear of all solids from one frame to the next, so the law of flight cannot be judged",
                )
            }
        if self.first is None:
            text = f"{self.judged} free ways are those of gravity, drag and fields to {self.worst:.2%} (frame {self.at})"
            return {"flight": Finding("pass", text, self.worst, FLIGHT, "1")}
        frame, count, off = self.first
        text = f"{count} particles are {off:.1%} of their way off the law of flight at frame {frame}"
        hints = (halve_step(self.swarm.candidate, self.swarm.solver, "drag or fields change much within a step"), bake_again())
        return {"flight": Finding("fail", text, self.worst, FLIGHT, "1", frame=frame, hints=hints)}
