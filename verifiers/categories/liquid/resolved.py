"""Judges whether the spacing of a liquid resolves where it comes in and goes out, what stands in it and the ways it takes (R58).

- `openings`: those of inflows and outflows are wide enough.
- `obstacles`: fixed solids are thick enough wherever they are wet (`categories/liquid/obstacles.py`).
- `passages`: no way between fixed solids that liquid gets to is narrower than what is resolved, where no wider one is beside it.

Built surfaces, drivers and the places where particles were are all that is asked. How passages are found: `categories/liquid/throats.py`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.liquid.facts import LEAST_MOUTH
from ...rows.findings import Finding
from .barriers import still_barrier
from .bounds import LEAST_OPENING
from .corrections import let_pass, refine, widen_opening
from .declared import Declared
from .obstacles import obstacles_finding
from .questions import RESOLVED
from .rows import place
from .solids import pieces_of
from .throats import Visited, narrow_ways

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Liquid, Step

__all__ = ["Resolved"]


class Resolved:
    """Openings, obstacles and passages against the spacing."""

    questions: ClassVar[Mapping[str, Question]] = RESOLVED

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.visited = Visited.of(liquid)

    def see(self, step: Step) -> None:
        """Note where particles are."""
        if self.visited is not None:
            self.visited.add(step.now.position)

    def findings(self) -> dict[str, Finding]:
        """Findings on the three questions by name."""
        return {
            "openings": self._openings(),
            "obstacles": obstacles_finding(Declared(self.liquid.candidate, self.liquid.solver), self.visited),
            "passages": self._passages(),
        }

    def _openings(self) -> Finding:
        liquid, s = self.liquid, self.liquid.spacing
        widths = {n: float(min(d.size)) for n, d in liquid.inflows.items()}
        # Liquid comes into a box through its faces: the two longer edges are those of the widest.
        widths |= {n: float(sorted(d.size)[1]) for n, d in liquid.outflows.items()}
        if not widths:
            return Finding("not_applicable", "the plan has neither inflow nor outflow")
        least = {n: LEAST_MOUTH[liquid.plan.engine] if n in liquid.inflows else LEAST_OPENING for n in widths}
        name = min(widths, key=lambda n: widths[n] / least[n])
        value, bound = widths[name] / s, least[name]
        text = f"the narrowest of {len(widths)} openings, {name}, is {widths[name]:.3g} m wide, {value:.3g} spacings of {s:g} m"
        if value >= bound * (1.0 - 1e-9):
            return Finding("pass", text, value, bound, "spacings", comparison=">=")
        driver = liquid.inflows.get(name) or liquid.outflows[name]
        hints = (
            refine(liquid, "the spacing does not resolve the opening", 0.28 * widths[name]),
            widen_opening(name, bound * s),
        )
        evidence = {"place": place(np.array(driver.pose.position)), "driver": name, "width_m": widths[name]}
        return Finding("fail", text, value, bound, "spacings", driver.entity, 0, hints, evidence, ">=")

    # ---------------------------------------------------------------- passages

    def _passages(self) -> Finding:
        liquid, s = self.liquid, self.liquid.spacing
        still = tuple(p for p in pieces_of(liquid.candidate) if p.still)
        if self.visited is None or still_barrier(liquid) is None:
            return Finding("not_applicable", "no fixed solid reaches to where the liquid is")
        ways = narrow_ways(self.visited, still, LEAST_OPENING * s)
        if ways is None:
            return Finding("unverified", f"the space of the liquid is too large to look for passages at {s:g} m")
        shut = f"; gaps below {2.0 * self.visited.cube:.2g} m may count as closed"
        if not ways:
            return Finding("pass", f"no way that liquid gets to is narrower than {LEAST_OPENING:g} spacings of {s:g} m{shut}")
        way = min(ways, key=lambda w: w.width)
        names = " and ".join(f"{p.entity}/{p.part}" for p in way.between)
        where, value = place(way.middle), way.width / s
        text = f"the way at {where} between {names} is {way.width:.3g} m wide, {value:.3g} spacings of {s:g} m; {len(ways)} such ways that liquid gets to{shut}"
        entity = way.between[0].entity
        hints = (
            refine(liquid, "the spacing does not resolve the way", 0.28 * way.width),
            let_pass((p.entity for p in way.between), "the way is too narrow", where, LEAST_OPENING * s),
        )
        evidence = {
            "place": where,
            "width_m": way.width,
            "ways": len(ways),
            "between": [f"{p.entity}/{p.part}" for p in way.between],
        }
        return Finding("fail", text, value, LEAST_OPENING, "spacings", entity, self._first(way.middle), hints, evidence, ">=")

    def _first(self, middle: F64) -> int:
        """First frame at which a particle is within two spacings of a place."""
        for index in range(self.liquid.frames):
            held = self.liquid.cache.read(index, ("origin", "particle/position"))
            offset = held["particle/position"] - (middle - held["origin"])
            if len(offset) and bool((np.einsum("ij,ij->i", offset, offset) <= (2.0 * self.liquid.spacing) ** 2).any()):
                return index
        return 0
