"""Particles and bodies: none inside solids, and what each gave the other (R66, R67, R101, R102)."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ...ledgers.exchanged import partners
from ...rows.corrections import bake_again, couple_both_ways, halve_step, out_of_solids, thicken
from ...rows.findings import Finding
from ..cloth.sides import PassedSheets
from ..liquid.solids import deepest, pieces_of
from ..soft_solids import soft_depths
from .bounds import FELT, REACTION, SUNK
from .frames import matched
from .questions import WALLS
from .rows import stiffer

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.requirements import Correction
    from ...rows.questions import Question
    from .frames import Swarm, SwarmFrame

__all__ = ["Walls"]


class Walls:
    """Particles against solids."""

    questions: ClassVar[Mapping[str, Question]] = WALLS

    def __init__(self, swarm: Swarm) -> None:
        self.swarm = swarm
        self.pieces = pieces_of(swarm.candidate)
        self.sides: PassedSheets | None = None
        self.depth, self.total = 0.0, 0
        self.first: tuple[int, str, str, int, float, list[float]] | None = None
        self.impulse: list[F64] = []
        self.reaction: list[F64] = []

    def see(self, now: SwarmFrame, before: SwarmFrame | None) -> None:
        """Look at one frame."""
        for found in deepest(self.pieces, now.position, now.index, 0.0):
            bound = (0.0 if self.swarm.granular else SUNK) * now.radius[found.rows]
            deep = found.value > bound
            self.total += int(deep.sum())
            self.depth = max(self.depth, float(found.value.max()))
            if deep.any() and self.first is None:
                worst = int(np.argmax(found.value))
                where = [round(float(c), 4) for c in now.position[found.rows[worst]]]
                self.first = (now.index, found.piece.entity, found.piece.part, int(deep.sum()), float(found.value.max()), where)
        if self.swarm.granular:
            found_soft = soft_depths(self.swarm.candidate, self.swarm.solver, now.position, now.index)
            if before is not None:
                here, there = matched(now, before)
                places = (before.position[there], before.index), (now.position[here], now.index)
                self.sides = self.sides or PassedSheets(self.swarm.candidate, self.swarm.solver)
                through = self.sides.see(now.identity[here], *places, now.radius[here])
                found_soft += [s._replace(rows=here[s.rows]) for s in through]
            for soft in found_soft:
                self.total += len(soft.rows)
                self.depth = max(self.depth, float(soft.value.max()))
                if self.first is None:
                    worst = int(np.argmax(soft.value))
                    where = [round(float(c), 4) for c in now.position[soft.rows[worst]]]
                    self.first = (now.index, soft.entity, soft.part, len(soft.rows), float(soft.value.max()), where)
        data = self.swarm.exchange(now.index)
        self.impulse.append(data["exchange/impulse"])
        self.reaction.append(data["exchange/reaction"])

    def findings(self) -> dict[str, Finding]:
        """Findings on the four questions by name."""
        none = Finding("not_applicable", "flying particles push nothing: declared in the approximation register")
        if not self.swarm.cache.index.colliders:
            none = Finding("not_applicable", "no body is met")
        if not self.swarm.granular or not self.swarm.cache.index.colliders:
            return {"inside": self._inside(), "exchange": none, "received": none, "declared": none}
        return {
            "inside": self._inside(),
            "exchange": self._exchange(),
            "received": self._received(),
            "declared": self._declared(),
        }

    def _inside(self) -> Finding:
        bound = 0.0 if self.swarm.granular else SUNK * self.swarm.radius
        if self.first is None:
            return Finding("pass", f"no particle's middle is inside a solid (deepest {self.depth:.2g} m)", self.depth, bound, "m")
        frame, entity, part, count, depth, where = self.first
        text = f"{count} particles are inside {entity}/{part} at frame {frame}, {depth:.3g} m deep at {where}; {self.total} such cases in all frames"
        hints: tuple[Correction, ...] = (
            halve_step(self.swarm.candidate, self.swarm.solver, "particles run through the wall in a step"),
            stiffer(self.swarm, "grains are pressed through the wall", 4.0),
            thicken(entity, "the wall is thinner than a grain"),
        )
        if frame == 0:
            hints = (out_of_solids(self.swarm.members, "the initial volume overlaps a solid", entity), *hints)
        return Finding("fail", text, self.depth, bound, "m", frame=frame, hints=hints, evidence={"solid": entity, "at": where})

    def _compare(self, own: F64, other: F64, what: str) -> Finding:
        """Largest difference relative to each wall's largest impulse; linear and angular apart."""
        worst, at = 0.0, (0, 0)
        for part in (slice(0, 3), slice(3, 6)):
            size = np.linalg.norm(other[:, :, part], axis=2)
            apart = np.linalg.norm((own - other)[:, :, part], axis=2)
            known = ~np.isnan(apart)
            if not known.any():
                continue
            ratio = np.where(known, apart, 0.0) / np.maximum(size.max(axis=0), 1e-9)
            if float(ratio.max()) > worst:
                worst, at = float(ratio.max()), divmod(int(np.argmax(ratio)), ratio.shape[1])
        names = self.swarm.cache.index.colliders
        if worst > REACTION:
            text = f"{what} {names[at[1]]} differs by {worst:.3g} of its largest at frame {at[0]}"
            return Finding("fail", text, worst, REACTION, "1", names[at[1]].split("/", 1)[0], at[0], (bake_again(),))
        return Finding("pass", f"{what} bodies is the same to {worst:.2g}", worst, REACTION, "1")

    def _exchange(self) -> Finding:
        return self._compare(-np.array(self.reaction), np.array(self.impulse), "what was given to and taken from")

    def _received(self) -> Finding:
        given = np.array(self.impulse)
        own = np.full(given.shape, np.nan)
        candidate, judged = self.swarm.candidate, 0
        for row, name in enumerate(self.swarm.cache.index.colliders):
            held = candidate.cache_row(*name.split("/", 1))
            if held is None or candidate.spec.entities[name.split("/", 1)[0]].motion != "dynamic":
                continue
            cache, body = held
            if (
                self.swarm.solver not in partners(candidate.spec, cache.index.solver)
                or len(partners(candidate.spec, cache.index.solver)) > 1
            ):
                continue
            series = np.asarray(cache.series("exchange/impulse"), dtype=np.float64)
            own[:, row] = series[: len(given), body]
            judged += 1
        if not judged:
            return Finding("not_applicable", "no body is coupled with these grains alone, both ways")
        return self._compare(own, given, "what was received by")

    def _declared(self) -> Finding:
        candidate, plan = self.swarm.candidate, self.swarm.candidate.spec.simulation
        gravity = float(np.linalg.norm(plan.gravity))
        given = np.array(self.impulse)
        for row, name in enumerate(self.swarm.cache.index.colliders):
            entity, body = name.split("/", 1)
            if candidate.spec.entities[entity].motion != "dynamic":
                continue
            owners = {n for n, s in plan.solvers.items() if entity in s.members}
            if any(self.swarm.solver in (c.source, c.target) and owners & {c.source, c.target} for c in plan.couplings.values()):
                continue
            push = np.linalg.norm(given[:, row, :3], axis=1)
            weight = candidate.body(entity, body).mass * max(gravity, 1.0) * self.swarm.duration
            if float(push.max(initial=0.0)) > FELT * weight:
                frame = int(np.argmax(push > FELT * weight))
                owner = next(iter(sorted(owners)), "")
                felt, also = "grains push it, and it does not feel them", ", or declare the coupling one_way"
                hint = couple_both_ways(self.swarm.solver, owner, felt, also)
                return Finding(
                    "fail",
                    f"grains push {entity} from frame {frame} on, and no coupling is declared",
                    float(push.max()),
                    FELT * weight,
                    "N s",
                    entity,
                    frame,
                    (hint,),
                )
        return Finding("pass", "every body that grains push feels them, or the omission is declared")
