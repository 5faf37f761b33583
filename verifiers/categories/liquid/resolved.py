"""Judges whether the spacing of a liquid resolves where it comes in and goes out, what stands in it and the ways it takes (R58).

- `openings`: those of inflows and outflows are wide enough.
- `obstacles`: fixed solids are thick enough wherever they are wet.
- `passages`: no way between fixed solids that liquid gets to is narrower than what is resolved, where no wider one is beside it.

Built surfaces, drivers and the places where particles were are all that is asked. How passages are found: `categories/liquid/throats.py`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.categories.liquid.facts import LEAST_MOUTH
from ...rows.corrections import thicken
from ...rows.findings import Finding
from .barriers import still_barrier
from .bounds import EDGES, FACETS, LEAST_OPENING, LEAST_WALL, WIDE_BODY
from .corrections import let_pass, refine, widen_opening
from .questions import RESOLVED
from .rows import place
from .samples import scattered
from .solids import Piece, deepest, pieces_of
from .throats import Visited, narrow_ways

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Liquid, Step

__all__ = ["Resolved"]

SOME = 1000
"""Places of a part at which its thickness is measured."""
LEVELS = 16
"""Depths at which it is asked whether a place is still inside, up to twice what is needed."""
POSES = 6
"""Frames between the poses at which a moving solid is looked at."""


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
        return {"openings": self._openings(), "obstacles": self._obstacles(), "passages": self._passages()}

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

    # ---------------------------------------------------------------- obstacles

    def _obstacles(self) -> Finding:
        bound = LEAST_WALL[self.liquid.plan.engine]
        found = [(piece, *thin) for piece in pieces_of(self.liquid.candidate) if (thin := self._thin(piece)) is not None]
        if not found:
            return Finding("not_applicable", "no fixed solid is wet")
        piece, value, where, frame, wet = min(found, key=lambda f: f[1])
        name = f"{piece.entity}/{piece.part}"
        s = self.liquid.spacing
        most = "or more " if value >= 2.0 * bound else ""
        text = f"the thinnest of {len(found)} wet parts, {name}, is {value * s:.3g} m {most}thick about {where}, {value:.3g} spacings of {s:g} m"
        evidence = {"place": where, "part": piece.part, "parts": len(found), "wet_places": wet}
        if value >= bound * (1.0 - FACETS):
            return Finding("pass", text, value, bound, "spacings", comparison=">=", evidence=evidence)
        hints = (
            thicken(piece.entity, "the solid is thinner than the liquid resolves", f"{bound * s:.3g} m about {where}"),
            refine(self.liquid, "the spacing does not resolve the solid", value * s / bound),
        )
        return Finding("fail", text, value, bound, "spacings", piece.entity, frame, hints, evidence, ">=")

    def _thin(self, piece: Piece) -> tuple[float, list[float], int, int] | None:
        """Thickness that all but EDGES of a part's wet surface reach [spacings], the thinnest place, its frame, wet places."""
        liquid, visited = self.liquid, self.visited
        loose = liquid.candidate.spec.entities[piece.entity].motion == "dynamic"
        if (
            visited is None
            or not piece.solid_through
            or (loose and sorted(piece.solid.upper - piece.solid.lower)[1] < WIDE_BODY * liquid.spacing)
        ):
            return None
        for frame in (0,) if piece.still else range(0, liquid.frames, POSES):
            low, high = piece.box(frame)
            if (low > visited.high).any() or (high < visited.low).any():
                continue
            corner = np.array([[(visited.low, visited.high)[k >> a & 1][a] for a in range(3)] for k in range(8)])
            near = piece.local(corner, frame)
            points, normals = scattered(piece.solid, liquid.spacing, near.min(axis=0), near.max(axis=0))
            points, normals = piece.world(points, frame), normals @ piece.turn[frame].T
            wet = np.flatnonzero(
                visited.at(points + 0.5 * liquid.spacing * normals) | visited.at(points + liquid.spacing * normals)
            )
            if len(wet):
                wet = wet[np.unique(np.linspace(0, len(wet) - 1, SOME).astype(np.intp))]
                thick = self._thickness(points[wet], normals[wet], frame)
                value = float(np.quantile(thick, EDGES, method="lower"))
                at = wet[int(np.argmin(np.abs(thick - value)))]
                return value, place(points[at]), frame, len(wet)
        return None

    def _thickness(self, points: F64, inward: F64, frame: int) -> F64:
        """Distance that solids reach behind places of a surface [spacings], at most twice what is needed, shape (n,)."""
        s, bound = self.liquid.spacing, LEAST_WALL[self.liquid.plan.engine]
        reach = np.zeros(len(points))
        going = np.arange(len(points))
        for depth in np.linspace(0.0, 2.0 * bound, LEVELS + 1)[1:]:
            # Just within: a wall of exactly this depth reaches it.
            asked = points[going] - (depth * (1.0 - 0.5 * FACETS)) * s * inward[going]
            inside = np.zeros(len(going), dtype=bool)
            for found in deepest(pieces_of(self.liquid.candidate), asked, frame, -1e-3 * s):
                inside[found.rows] = True
            going = going[inside]
            reach[going] = depth
            if not len(going):
                break
        return reach

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
