"""Liquid that got to the other side of a surface although no way leads there that it could take (R73, R99).

Space around each barrier (all solids that stand still together, and every moving body in its own frame) is cut into cubes of
half a spacing. Cubes that a surface passes through are closed, and with them every gap narrower than a cube: liquid of this
spacing is not resolved there. A particle whose straight way since it was last in an open cube leads through closed ones has
leaked where no open cubes connect both ends nearby, within the length of that way and a few spacings around it. Where none has, but a slot too narrow for the spacing leads out of the wet, nothing is known: `categories/liquid/slots.py`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ....geometry.launch import warp
from ....worlds.arrays import F64
from ....worlds.categories.liquid.facts import LEAST_SPACINGS
from ...rows.findings import Finding
from ..cloth.sides import PassedSheets
from ..soft_solids import soft_walls
from .barriers import Barrier, barriers_of, still_barrier
from .bounds import LEAKED
from .corrections import let_pass, refine, shorter_step
from .declared import production_spacing
from .questions import LEAKS
from .rows import place
from .slots import slots, touching
from .throats import Visited

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Frame, Liquid, Step
    from .solids import Piece

__all__ = ["Leaks"]

SLACK = 6
"""[cubes] How far around a particle's way another one is searched, at least."""
RIM = 1.0
"""[spacings] Own choice: so near to the rim of a sheet, and by half of their way more, particles may have gone around it between two frames."""
PATIENCE = 6
"""Frames after which particles that stay next to a surface are asked on which side they are."""
SOME = 2000
"""Most ways searched per barrier and frame; further ones count like these in proportion."""


@dataclass
class _Waiting:
    """Particles in closed cubes, and where they were last in an open one, or the one next to where they began (barrier's frame)."""

    identity: NDArray[np.int64]
    position: F64


class Leaks:
    """Ways of particles through surfaces."""

    questions: ClassVar[Mapping[str, Question]] = LEAKS

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.barriers: list[Barrier] | None = None
        self.sides: PassedSheets | None = None
        self.waiting: dict[int, _Waiting] = {}
        self.known: dict[tuple[int, ...], bool] = {}
        self.leaks: list[tuple[int, int, Barrier, F64, NDArray[np.int64]]] = []
        self.particles = 0
        self.leaked: set[int] = set()
        self.crossed: list[tuple[int, str, str, F64, NDArray[np.int64]]] = []
        self.rims: dict[tuple[str, str], NDArray[np.intp]] = {}
        self.visited = Visited.of(liquid)

    def see(self, step: Step) -> None:
        """Follow every particle by one frame."""
        if self.barriers is None:
            self.barriers = barriers_of(self.liquid)
        frame = step.now
        if self.visited is not None:
            self.visited.add(frame.position)
        self.particles = max(self.particles, frame.count)
        if step.before is not None and frame.count:
            self._sheets(step, step.before)
        before = np.full((frame.count, 3), np.nan)
        if step.before is not None:
            before[step.here] = step.before.position[step.there]
        longest = float(np.sqrt(np.nanmax(((frame.position - before) ** 2).sum(axis=1), initial=0.0)))
        for number, barrier in enumerate(self.barriers if frame.count else ()):
            self._follow(number, barrier, frame, before, longest)

    def _sheets(self, step: Step, before: Frame) -> None:
        """Particles that have changed the side of a sheet that moves by itself, away from its rim."""
        candidate, frame, s = self.liquid.candidate, step.now, self.liquid.spacing
        places = (before.position[step.there], before.index), (frame.position[step.here], frame.index)
        self.sides = self.sides or PassedSheets(candidate, self.liquid.solver)
        for found in self.sides.see(frame.identity[step.here], *places, np.full(len(step.here), 0.5 * s)):
            part = next(p for p in candidate.entity(found.entity).parts if p.part == found.part)
            rim = self.rims.setdefault((found.entity, found.part), _rim(part.render.faces))
            away = np.full(len(found.rows), np.inf)
            for points, index in places if len(rim) else ():
                edge = cKDTree(candidate.surface(found.entity, found.part, index)[rim])
                away = np.minimum(away, edge.query(points[found.rows])[0])
            way = step.duration * np.maximum(frame.speed[step.here], before.speed[step.there])[found.rows]
            rows = step.here[found.rows[away > RIM * s + 0.5 * way]]
            fresh = rows[[int(k) not in self.leaked for k in frame.identity[rows]]] if len(rows) else rows
            if len(fresh):
                self.leaked |= set(frame.identity[fresh].tolist())
                self.crossed.append((frame.index, found.entity, found.part, frame.position[fresh], frame.identity[fresh]))

    def _follow(self, number: int, barrier: Barrier, frame: Frame, before: F64, longest: float) -> None:
        waiting = np.full((frame.count, 3), np.nan)
        held = self.waiting.get(number)
        if held is not None and len(held.identity):
            where = np.minimum(np.searchsorted(frame.identity, held.identity), frame.count - 1)
            found = frame.identity[where] == held.identity
            waiting[where[found]] = held.position[found]
        met = np.flatnonzero(barrier.met(frame.position, before, longest, frame.index) | ~np.isnan(waiting[:, 0]))
        identity, wp = frame.identity[met], warp()
        now, then = (wp.array(np.ascontiguousarray(x[met]), dtype=wp.vec3d, device="cpu") for x in (frame.position, before))
        here, start, shut, through = barrier.follow(now, then, waiting=waiting[met], frame=frame.index)
        keep = np.flatnonzero(shut & ~np.isnan(start[:, 0]))
        self.waiting[number] = _Waiting(identity[keep], start[keep])
        rows = np.flatnonzero(through)
        self._judge(number, barrier, frame.index, start[rows], here[rows], identity[rows])
        if len(keep) and (frame.index % PATIENCE == 0 or frame.index == self.liquid.frames - 1):
            # What stays in closed cubes is where the nearest open one is.
            ends = barrier.beside(here[keep])
            known = ~np.isnan(ends[:, 0])
            rows, ends = keep[known], ends[known]
            led = barrier.blocked(start[rows], ends)
            # Beside a sloping bed that cube may lie in the solid; what is outside of it, or at its surface, has not gone there.
            led[led] = ~barrier.deeper(here[rows[led]], ends[led])
            self._judge(number, barrier, frame.index, start[rows[led]], ends[led], identity[rows[led]])

    def _judge(self, number: int, barrier: Barrier, index: int, start: F64, end: F64, identity: NDArray[np.int64]) -> None:
        """Look for other ways of particles whose straight ones lead through closed cubes."""
        rows = np.arange(len(start))
        if len(rows) > SOME:
            rows = rows[np.linspace(0, len(rows) - 1, SOME).astype(np.intp)]
        bad = [r for r in rows if int(identity[r]) not in self.leaked and not self._connected(number, barrier, start[r], end[r])]
        if bad:
            self.leaked |= set(identity[bad].tolist())
            middle = np.array([_middle(barrier, start[r], end[r]) for r in bad])
            self.leaks.append((index, len(bad), barrier, middle, identity[bad]))

    def _connected(self, number: int, barrier: Barrier, a: F64, b: F64) -> bool:
        """True if open cubes lead from one point to the other nearby; ways between the same cubes are searched once."""
        ends, _ = barrier.cells(np.stack([a, b]))
        key = (number, *ends.ravel().tolist())
        if key not in self.known:
            self.known[key] = _joined(barrier, ends, SLACK) or _joined(
                barrier, ends, SLACK + int(np.abs(ends[1] - ends[0]).max())
            )
        return self.known[key]

    def findings(self) -> dict[str, Finding]:
        """Findings on the number of particles that leaked, and where most did."""
        if not self.barriers and not soft_walls(self.liquid.candidate, self.liquid.solver):
            return {"leak": Finding("not_applicable", "no solid reaches to where the liquid is")}
        bound = max(1.0, np.floor(LEAKED * self.particles))
        count = float(len(self.leaked))
        if count <= bound:
            text = f"{count:.0f} of {self.particles} particles passed a surface (allowed {bound:.0f})"
            return {"leak": self._slot(text) or Finding("pass", text, count, bound, "1")}
        if sum(len(c[4]) for c in self.crossed) > sum(len(e[4]) for e in self.leaks):
            return {"leak": self._through(count, bound)}
        index, gap, piece, sizes = self._gap()
        where = place(gap)
        name = f"{piece.entity}/{piece.part}"
        text = (
            f"{count:.0f} of {self.particles} particles passed through {name} where no way of a spacing ({self.liquid.spacing:g} m) leads, "
            f"first at frame {index}, most about {where}"
        )
        hints = (
            let_pass((piece.entity,), f"{name} has a gap or a hole there", where, LEAST_SPACINGS * self.liquid.spacing),
            shorter_step(self.liquid, "particles run through the wall in a step"),
            refine(self.liquid, "the wall is thinner than the liquid resolves"),
        )  # fmt: skip
        evidence: dict[str, Any] = {"place": where, "collider": piece.entity, "part": piece.part, "gap_extent": sizes,
                                    "per_frame": [[i, n] for i, n, *_ in self.leaks[:20]], "share": count / max(self.particles, 1)}  # fmt: skip
        return {"leak": Finding("fail", text, count, bound, "1", piece.entity, index, hints, evidence)}

    def _slot(self, text: str) -> Finding | None:
        """A slot that the spacing does not resolve: that nothing came through it says nothing about the liquid."""
        still = still_barrier(self.liquid)
        if still is None or self.visited is None or still not in (self.barriers or ()):
            return None
        number, least = (self.barriers or []).index(still), touching(self.liquid.candidate.spec)
        near = slots(self.visited, still, self.liquid.spacing, least, lambda a, b: self._connected(number, still, a, b))
        s = production_spacing(self.liquid.candidate, self.liquid.solver)
        found = [x for x in near if x.width < s]
        if not found:
            return None
        slot, where = found[0], place(found[0].place)
        names = " and ".join(dict.fromkeys(f"{p.entity}/{p.part}" for p in slot.between))
        entity, wanted = slot.between[0].entity, slot.width / LEAST_SPACINGS
        told = (
            f"{text}; but a slot {slot.width:.3g} m wide at {where} between {names} leads out of the wet, {slot.width / s:.2g} spacings "
            f"of {s:g} m: nothing can pass it here whatever liquid would do; refine to {wanted:.3g} m, or close the gap"
        )
        hints = (
            let_pass((entity,), "a slot narrower than the spacing is closed for its particles", where, LEAST_SPACINGS * s),
            refine(self.liquid, "the spacing does not resolve the slot", wanted),
        )
        evidence = {
            "place": where,
            "gap_m": slot.width,
            "spacing_m": s,
            "between": [f"{p.entity}/{p.part}" for p in slot.between],
            "slots": len(found),
        }
        return Finding("unverified", told, slot.width / s, LEAST_SPACINGS, "spacings", entity, None, hints, evidence, ">=")

    def _through(self, count: float, bound: float) -> Finding:
        """Failing finding on particles that passed through a sheet, at the part that most of them passed."""
        _, entity, part, points, _ = max(self.crossed, key=lambda c: len(c[4]))
        where = place(np.median(points, axis=0))
        text = (
            f"{count:.0f} of {self.particles} particles passed through the sheet {entity}/{part}, first at frame "
            f"{self.crossed[0][0]}, most about {where}"
        )
        hints = (shorter_step(self.liquid, "particles and the sheet run through each other in a step"),)
        evidence = {"place": where, "collider": entity, "part": part, "share": count / max(self.particles, 1)}
        return Finding("fail", text, count, bound, "1", entity, self.crossed[0][0], hints, evidence)

    def _gap(self) -> tuple[int, F64, Piece, list[float]]:
        """First frame, place of the densest cluster of crossings in the world, the piece there and the cluster's extent."""
        index, _, barrier, _, _ = max(self.leaks, key=lambda e: e[1])
        mine = [(i, m) for i, _, b, m, _ in self.leaks if b is barrier]
        points = np.concatenate([m for _, m in mine])
        cell = np.floor(points / (4.0 * barrier.cube))
        _, which, count = np.unique(cell, axis=0, return_inverse=True, return_counts=True)
        middle = np.median(points[which.reshape(-1) == int(np.argmax(count))], axis=0)
        near = points[(np.abs(points - middle) <= 8.0 * barrier.cube).all(axis=1)]
        world = middle if barrier.world else barrier.pieces[0].world(middle[None], index)[0]
        return self.leaks[0][0], world, barrier.nearest(middle), place(np.ptp(near, axis=0))


def _rim(faces: NDArray[Any]) -> NDArray[np.intp]:
    """Vertices of edges that one triangle alone has."""
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    return np.unique(unique[count == 1]).astype(np.intp)


def _middle(barrier: Barrier, start: F64, end: F64) -> F64:
    """Middle of the closed cubes on a way."""
    count = int(np.ceil(np.linalg.norm(end - start) / (0.25 * barrier.cube))) + 2
    way = start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)
    cell, inside = barrier.cells(way)
    way, cell = way[inside], cell[inside]
    return np.asarray(way[barrier.closed[tuple(cell.T)]].mean(axis=0))


def _joined(barrier: Barrier, ends: NDArray[np.intp], slack: int) -> bool:
    from scipy.ndimage import label

    low = np.maximum(ends.min(axis=0) - slack, 0)
    high = np.minimum(ends.max(axis=0) + slack + 1, barrier.shape)
    outside = (ends < 0) | (ends >= barrier.shape)
    if outside.any(axis=1).any():
        return True
    marks, _ = label(~barrier.closed[tuple(slice(a, b) for a, b in zip(low, high, strict=True))])
    a, b = (marks[tuple(e - low)] for e in ends)
    return bool(a == b and a > 0)
