"""Impulses of force fields on a liquid, compared with those of the declared fields (R18, R63).

- `fields`: the fields are asked again at the particles of every two frames, with the surface that a medium blows against found
  from the particles and the visible solids. Between the frames the mean of both ends holds; how far they differ is left open.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh
from ....worlds.liquid_air import LEE, Matter, pushed, surface_points
from ...rows.corrections import bake_again
from ...rows.findings import Finding
from .bounds import ATTRACTION, MEDIUM
from .energy import blown
from .questions import BLOWN
from .rows import first_over
from .solids import pieces_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Frame, Liquid, Step

__all__ = ["Blown"]


class Blown:
    """Impulses of fields on one instance."""

    questions: ClassVar[Mapping[str, Question]] = BLOWN

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.off: list[F64] = []
        self.doubt: list[F64] = []
        self.size: list[tuple[float, float]] = []
        self._pieces = pieces_of(liquid.candidate) if any(f.has_medium for f in liquid.fields) else ()
        self._points: dict[int, F64] = {}
        self._last: tuple[int, F64, F64] | None = None

    def see(self, step: Step) -> None:
        """Compare one frame."""
        if not self.liquid.fields:
            return
        h, before = step.duration, step.before
        now = self._forces(step.now, step.now.index * h - 1e-9)
        if before is None:
            self._last = (step.now.index, *now)
            self.off.append(np.zeros(3))
            self.doubt.append(np.zeros(3))
            self.size.append((0.0, 0.0))
            return
        then = self._last[1:] if self._last and self._last[0] == before.index else self._forces(before, before.index * h)
        wanted = 0.5 * h * (now[0] + then[0] + now[1] + then[1])
        ends = 0.5 * h * np.abs(now[0] + now[1] - then[0] - then[1])
        self.off.append(np.abs(blown(step)[:3] - wanted))
        self.doubt.append(np.full(3, np.inf) if self.liquid.switches(step.now.index) else ends)
        sizes = (max(float(np.linalg.norm(a)), float(np.linalg.norm(b))) * h for a, b in zip(now, then, strict=True))
        self.size.append((next(sizes), next(sizes)))
        self._last = (step.now.index, *self._forces(step.now, step.now.index * h))

    def _forces(self, frame: Frame, time: float) -> tuple[F64, F64]:
        """Sums over the particles: of attraction, and of media [N], each shape (3,)."""
        liquid = self.liquid
        if not frame.count:
            return np.zeros(3), np.zeros(3)
        matter = Matter(frame.position, frame.velocity, frame.mass, frame.volume, frame.fluid)
        gain, push = pushed(liquid.fields, matter, max(time, 0.0), liquid.spacing, self._solids(frame.index))
        return frame.mass @ gain, push.force.sum(axis=0)

    def _solids(self, index: int) -> F64:
        """Points on all visible solids that may shield liquid."""
        s = self.liquid.spacing
        low, high = self.liquid.lower - LEE * s, self.liquid.upper + LEE * s
        found = [np.zeros((0, 3))]
        for k, piece in enumerate(self._pieces):
            if k not in self._points:
                own = piece.solid.vertices
                mesh = TriangleMesh(piece.world(own, 0) if piece.still else own, piece.solid.faces)
                self._points[k] = surface_points(mesh, s, *((low, high) if piece.still else (None, None)))
            found.append(self._points[k] if piece.still else piece.world(self._points[k], index))
        return np.concatenate(found)

    def findings(self) -> dict[str, Finding]:
        """The largest difference."""
        if not self.liquid.fields:
            return {"fields": Finding("not_applicable", "no force field acts on this liquid")}
        pulled, blew = (max(s[k] for s in self.size) for k in (0, 1))
        allowed = ATTRACTION * pulled + MEDIUM * blew
        if allowed <= 0:
            allowed = 1e-12
        excess = np.linalg.norm([np.maximum(o - d, 0.0) for o, d in zip(self.off, self.doubt, strict=True)], axis=1) / allowed
        found = first_over(
            excess, 1.0, "1", "difference of recorded impulses from the declared fields', over what is allowed,",
            (bake_again("the cache is of a run with other fields"),),
        )  # fmt: skip
        evidence: dict[str, object] = {"attraction_N_s": pulled, "medium_N_s": blew}
        return {"fields": Finding(found.status, found.text, found.measured, 1.0, "1", None, found.frame, found.hints, evidence)}
