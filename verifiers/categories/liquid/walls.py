"""Liquid and what must hold it: no particle inside solids, none beyond closed sides, no source inside a wall (R99, R106).

- `inside`: no particle lies deeper than half a spacing in a solid, one that deforms included, at any frame.
- `domain`: none is outside the domain.
- `source`: the opening of every inflow is free of solids while it is open, and inside the domain.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ...rows.corrections import bake_again, move_by, out_of_solids
from ...rows.findings import Finding
from ..soft_solids import soft_depths
from .bounds import BEYOND, DEPTH_SHARE
from .corrections import move_opening, refine, shorter_step
from .questions import WALLS
from .rows import place
from .solids import deepest, pieces_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.requirements import Correction
    from ...rows.questions import Question
    from .frames import Frame, Liquid, Step

__all__ = ["Walls", "opening_points"]

ROUNDING = 1e-6
"""[m] Own choice: openings that end in a side of the domain end there within rounding."""


class Walls:
    """Particles against solids and the domain."""

    questions: ClassVar[Mapping[str, Question]] = WALLS

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.pieces = pieces_of(liquid.candidate)
        self.depth = 0.0
        self.first: tuple[int, str, str, int, float, list[float]] | None = None
        self.total = self.worst_frame = 0
        self.beyond = 0.0
        self.escaped: tuple[int, int, list[float]] | None = None
        self.blocked: tuple[int, str, str, float, list[float]] | None = None
        self.openings = {n: opening_points(liquid, n) for n in liquid.inflows}

    def see(self, step: Step) -> None:
        """Look at one frame."""
        frame, liquid = step.now, self.liquid
        # What is no deeper than the deepest so far, and counts as no fault, changes nothing.
        least = min(self.depth, DEPTH_SHARE * liquid.spacing)
        for found in deepest(self.pieces, frame.position, frame.index, least):
            deep = found.value > DEPTH_SHARE * liquid.spacing
            if float(found.value.max()) > self.depth:
                self.depth, self.worst_frame = float(found.value.max()), frame.index
            self.total += int(deep.sum())
            if deep.any() and self.first is None:
                where = place(frame.position[found.rows[int(np.argmax(found.value))]])
                self.first = (frame.index, found.piece.entity, found.piece.part, int(deep.sum()), float(found.value.max()), where)
        self._soft(frame)
        out = np.maximum(liquid.lower - frame.position, frame.position - liquid.upper).max(axis=1, initial=-np.inf)
        if frame.count:
            self.beyond = max(self.beyond, float(out.max()))
            far = out > BEYOND * liquid.spacing
            if far.any() and self.escaped is None:
                self.escaped = (frame.index, int(far.sum()), place(frame.position[int(np.argmax(out))]))
        if self.blocked is None:
            self._sources(frame.index)

    def _soft(self, frame: Frame) -> None:
        """Look into the bodies that deform."""
        for found in soft_depths(self.liquid.candidate, self.liquid.solver, frame.position, frame.index):
            deep = found.value > DEPTH_SHARE * self.liquid.spacing
            if float(found.value.max()) > self.depth:
                self.depth, self.worst_frame = float(found.value.max()), frame.index
            self.total += int(deep.sum())
            if deep.any() and self.first is None:
                where = place(frame.position[found.rows[int(np.argmax(found.value))]])
                self.first = (frame.index, found.entity, found.part, int(deep.sum()), float(found.value.max()), where)

    def _sources(self, index: int) -> None:
        for name, points in self.openings.items():
            if not self.liquid.active(name, max(index, 1)):
                continue
            hits = deepest(self.pieces, points, index, 1e-3 * self.liquid.spacing)
            outside = np.maximum(self.liquid.lower - points, points - self.liquid.upper).max(axis=1)
            if hits:
                worst = max(hits, key=lambda h: float(h.value.max()))
                self.blocked = (
                    index,
                    name,
                    worst.piece.entity,
                    float(worst.value.max()),
                    place(points[worst.rows[int(np.argmax(worst.value))]]),
                )
            elif (outside > ROUNDING).any():
                self.blocked = (index, name, "", float(outside.max()), place(points[int(np.argmax(outside))]))

    def findings(self) -> dict[str, Finding]:
        """Findings on the three questions by name."""
        return {"inside": self._inside(), "domain": self._domain(), "source": self._source()}

    def _inside(self) -> Finding:
        bound = DEPTH_SHARE * self.liquid.spacing
        if self.first is None:
            text = f"no particle is deeper than {self.depth:.3g} m in a solid (allowed {bound:.3g} m)"
            return Finding("pass", text, self.depth, bound, "m")
        index, entity, part, count, depth, where = self.first
        text = (
            f"{count} particles are inside {entity}/{part} at frame {index}, {depth:.3g} m deep at {where}; "
            f"{self.total} such cases in all frames, deepest {self.depth:.3g} m"
        )
        hints: tuple[Correction, ...] = (shorter_step(self.liquid, "particles run through the wall in a step"),)
        if index == 0:
            hints = (out_of_solids(self.liquid.members, "the initial volume overlaps a solid", entity),)
        hints += (refine(self.liquid, f"{entity} is thinner than the liquid resolves"),)
        evidence = {"place": where, "part": part, "particles": count, "cases": self.total, "worst_frame": self.worst_frame}
        return Finding("fail", text, self.depth, bound, "m", entity, index, hints, evidence)

    def _domain(self) -> Finding:
        bound = BEYOND * self.liquid.spacing
        beyond = max(self.beyond, 0.0)
        if self.escaped is None:
            return Finding("pass", f"no particle is beyond the domain by more than {beyond:.3g} m", beyond, bound, "m")
        index, count, where = self.escaped
        text = f"{count} particles are beyond the domain at frame {index}, e.g. at {where}, up to {beyond:.3g} m"
        return Finding(
            "fail",
            text,
            beyond,
            bound,
            "m",
            None,
            index,
            (bake_again(), shorter_step(self.liquid, "particles run through a closed side")),
            {"place": where},
        )

    def _source(self) -> Finding:
        if not self.openings:
            return Finding("not_applicable", "the plan has no inflow")
        if self.blocked is None:
            return Finding("pass", f"{len(self.openings)} openings are free at every frame", 0.0, 0.0, "m")
        index, name, entity, depth, where = self.blocked
        what = f"inside {entity}" if entity else "outside the domain"
        text = f"the opening of {name} is {depth:.3g} m {what} at frame {index}, at {where}"
        hints = [move_opening(name, depth, entity)]
        if entity:
            hints.append(move_by(self.liquid.candidate, entity, None, "the solid stands in the source's way"))
        evidence = {"place": where, "driver": name}
        return Finding("fail", text, depth, 0.0, "m", entity or self.liquid.inflows[name].entity, index, tuple(hints), evidence)


def opening_points(liquid: Liquid, name: str) -> F64:
    """Points all over the opening of an inflow, at most half a spacing apart, shape (n, 3)."""
    driver = liquid.inflows[name]
    at, turn = liquid.inflow_frame(name)
    counts = [int(np.clip(np.ceil(2.0 * s / liquid.spacing), 2, 60)) + 1 for s in driver.size]
    x, y = np.meshgrid(*(np.linspace(-0.5 * s, 0.5 * s, n) for s, n in zip(driver.size, counts, strict=True)))
    flat = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    if driver.round:
        flat = flat[((flat[:, :2] / (0.5 * np.array(driver.size))) ** 2).sum(axis=1) <= 1.0 + 1e-9]
    return np.asarray(flat @ turn.T + at)
