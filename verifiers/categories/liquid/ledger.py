"""Ledger of a liquid: mass against what came in and went out, records against the particles, energy against its sources (R99).

- `mass`: particles' mass + outflow - inflow is that of frame 0 at every frame (`LEDGER`, relative).
- `start`: the volume of the particles at frame 0 is that of the members' parts less solids in them (`DRIFT`).
- `records`: every record is what the particles themselves say.
- `identity`: particles appear at inflows only, vanish at outflows and open sides only, and no two share an id. What holds a level lets
  none in while the surface over its gauge is higher, and none out while it is lower (`stages.py`).
- `energy`: kinetic + potential energy, less what inflow brought and bodies did, never grows by more than
  `limits.energy_growth` of the energy in play.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....geometry import Solid, contains
from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ...rows.corrections import EACH_OTHER, bake_again, out_of_solids
from ...rows.findings import Finding
from ..soft_solids import soft_depths
from .bounds import APPEARS, DRIFT, LEDGER, RECORD, SLOW
from .corrections import hold_all, shorter_step
from .questions import BOOKS, IDENTITY
from .rows import first_over, place
from .samples import spread
from .solids import deepest, pieces_of
from .stages import holds_back

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Liquid, Rows, Step

__all__ = ["Books", "Identity", "declared_filling"]

RECORDED = {"mass": "kg", "volume": "m^3", "particles": "1", "momentum_x": "kg m/s", "momentum_y": "kg m/s", "momentum_z": "kg m/s",
            "kinetic_energy": "J", "potential_energy": "J"}  # fmt: skip

OVERLAP_POINTS = 100_000
"""Points in a part's box at which it is asked whether a solid is there too."""


class Books:
    """Sums over the particles of every frame, beside what is recorded."""

    questions: ClassVar[Mapping[str, Question]] = BOOKS

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.own: list[list[float]] = []
        self.recorded: list[list[float]] = []
        self.flows: list[tuple[float, float, float]] = []
        self.fastest: list[tuple[float, float]] = []
        self.speed_scale = 0.0

    def see(self, step: Step) -> None:
        """Sum up one frame."""
        frame, held = step.now, step.now.others
        missing = [
            n for n in (*RECORDED, "max_speed", "domain_outflow", "inflow_mass", "outflow_mass") if f"record/{n}" not in held
        ]
        missing = [f"record/{n}" for n in missing] + [n for n in ("inflow/mass", "outflow/mass") if n not in held]
        if missing:
            raise EvidenceError(f"frame {frame.index} lacks {', '.join(missing[:3])}; bake again")
        momentum = frame.mass @ frame.velocity
        kinetic = 0.5 * float(frame.mass @ frame.squared)
        potential = -float(frame.mass @ (frame.position @ self.liquid.gravity))
        self.own.append(
            [float(frame.mass.sum()), float(frame.volume.sum()), frame.count, *map(float, momentum), kinetic, potential]
        )
        self.recorded.append([float(held[f"record/{n}"]) for n in RECORDED])
        came, went = float(np.sum(held["inflow/mass"])), float(np.sum(held["outflow/mass"]))
        self.flows.append((came, went, float(held["record/domain_outflow"])))
        if not np.isclose(came, float(held["record/inflow_mass"]), rtol=1e-9) or not np.isclose(
            went, float(held["record/outflow_mass"]), rtol=1e-9
        ):
            self.flows[-1] = (np.nan, np.nan, np.nan)
        self.fastest.append((frame.fastest, float(held["record/max_speed"])))
        self.speed_scale = max(self.speed_scale, frame.fastest)

    def findings(self) -> dict[str, Finding]:
        """Mass, start and records."""
        own = np.array(self.own)
        return {"mass": self._mass(own[:, 0]), "start": self._start(own), "records": self._records(own)}

    def _mass(self, mass: F64) -> Finding:
        came, went, left = np.array(self.flows).T
        if np.isnan(came).any():
            frame = int(np.argmax(np.isnan(came)))
            text = f"inflow/mass and outflow/mass do not add up to the records inflow_mass and outflow_mass at frame {frame}"
            return Finding("fail", text, frame=frame, hints=(bake_again(),))
        balance = mass + went + left - came
        error = np.abs(balance - balance[0]) / max(float((mass + went + left).max()), 1e-12)
        hints = (
            bake_again(),
            hold_all(self.liquid),
        )
        found = first_over(error, LEDGER, "1", "relative error of the mass balance", hints)
        evidence = {"mass_start_kg": float(mass[0]), "mass_end_kg": float(mass[-1]), "inflow_kg": float(came[-1]),
                    "outflow_kg": float(went[-1] + left[-1])}  # fmt: skip
        return Finding(found.status, found.text, found.measured, found.bound, "1", None, found.frame, found.hints, evidence)

    def _start(self, own: F64) -> Finding:
        declared = declared_volume(self.liquid)
        liquid, have = self.liquid, float(own[0, 1])
        passes = liquid.inflows or liquid.outflows or not all(liquid.closed)
        if liquid.candidate.spec.simulation.preroll > 0 and passes:
            return Finding("not_applicable", "a preroll lets liquid in or out before frame 0, which nothing counts")
        error = abs(have - declared) / max(declared, 1e-12)
        text = f"particles hold {have:.6g} m^3 at frame 0, the parts {declared:.6g} m^3 ({error:.3%} off)"
        hints = (out_of_solids(self.liquid.members, "its parts overlap solids, the domain's sides or each other", EACH_OTHER),)
        return Finding("pass" if error <= DRIFT else "fail", text, error, DRIFT, "1", self.liquid.members[0], 0, hints)

    def _records(self, own: F64) -> Finding:
        recorded = np.array(self.recorded)
        mass = max(float(np.abs(own[:, 0]).max()), 1e-12)
        speed = max(self.speed_scale, 1e-3)
        height = float(np.ptp(own[:, 7])) + mass * self.liquid.strength * self.liquid.spacing
        scales = [
            mass,
            max(float(own[:, 1].max()), 1e-15),
            0.5 / RECORD,
            *[mass * speed] * 3,
            mass * speed**2,
            max(height, 1e-12),
        ]
        error = np.abs(recorded - own) / np.array(scales)
        top = np.array(self.fastest)
        slow = np.where(top[:, 1] < top[:, 0] * (1 - RECORD) - 1e-6, (top[:, 0] - top[:, 1]) / speed, 0.0)
        error = np.nan_to_num(np.column_stack([error, slow]), nan=np.inf)
        names = [*RECORDED, "max_speed"]
        column = int(np.argmax(error.max(axis=0)))
        found = first_over(
            error.max(axis=1),
            RECORD,
            "1",
            f"error of records, most of {names[column]},",
            (bake_again("records are not those of the particles"),),
        )
        evidence = {n: float(e) if np.isfinite(e) else "not finite" for n, e in zip(names, error.max(axis=0), strict=True)}
        return Finding(found.status, found.text, found.measured, RECORD, "1", None, found.frame, found.hints, evidence)


def declared_volume(liquid: Liquid) -> float:
    """Volume of the members' parts at frame 0, less what solids and the space outside the domain take of it [m^3]."""
    return sum(volume for volume, _ in declared_filling(liquid).values())


def declared_filling(liquid: Liquid) -> dict[str, tuple[float, F64]]:
    """The same of every member, and the middle of what is left, shape (3,) [m]; worked out once."""
    return liquid.candidate.memo(
        ("declared filling", liquid), lambda: {member: _filling(liquid, member) for member in liquid.members}
    )


def _filling(liquid: Liquid, member: str) -> tuple[float, F64]:
    candidate, pieces = liquid.candidate, pieces_of(liquid.candidate)
    total, moment = 0.0, np.zeros(3)
    for part in candidate.entity(member).parts:
        solid = Solid.from_mesh(part.render, closed=part.closed)
        pose = candidate.pose(member, 0, part.body)
        grid = spread(solid.lower, solid.upper, OVERLAP_POINTS)
        points = pose.apply(grid[contains(solid, grid)])
        taken = np.asarray(((points < liquid.lower) | (points > liquid.upper)).any(axis=1))
        for found in deepest(pieces, points, 0, 0.0):
            taken[found.rows] = True
        for soft in soft_depths(candidate, liquid.solver, points, 0):
            taken[soft.rows] = True
        volume = abs(solid.volume) * (1.0 - float(taken.mean()) if len(points) else 1.0)
        middle = points[~taken].mean(axis=0) if len(points) and not taken.all() else pose.apply(solid.center[None])[0]
        total, moment = total + volume, moment + volume * middle
    return total, moment / max(total, 1e-300)


class Identity:
    """Where particles appear and vanish."""

    questions: ClassVar[Mapping[str, Question]] = IDENTITY

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.wrong: list[tuple[int, int, str, list[float]]] = []
        self.seen = -1
        self.births = self.deaths = 0

    def see(self, step: Step) -> None:
        """Look at who is new and who is gone."""
        frame, liquid = step.now, self.liquid
        if frame.repeated:
            self._note(frame.index, frame.repeated, "share their id with another", frame.position[:1])
        if step.before is not None:
            self._births(step)
            self._deaths(step)
        elif liquid.candidate.spec.simulation.preroll == 0 and (frame.identity < 0).any():
            self._note(0, int((frame.identity < 0).sum()), "have a negative id", frame.position[:1])
        self.seen = max(self.seen, int(frame.identity.max(initial=-1)))

    def _births(self, step: Step) -> None:
        frame, liquid = step.now, self.liquid
        self.births += len(step.new)
        again = step.new[frame.identity[step.new] <= self.seen]
        if len(again):
            self._note(frame.index, len(again), "come back after they were gone, or with an old id", frame.position[again[:1]])
        born = np.setdiff1d(step.new, again)
        reach = np.zeros(len(born), dtype=bool)
        for name, driver in liquid.inflows.items():
            if liquid.active(name, frame.index) and not holds_back(step, name):
                speed = np.linalg.norm(frame.velocity[born], axis=1).max(initial=driver.flow_speed)
                travel = APPEARS * liquid.spacing + 2.0 * speed * step.duration + liquid.strength * step.duration**2
                reach |= liquid.near_inflow(name, frame.position[born], travel)
        self._stray(frame.index, born[~reach], frame.position, "appear where no inflow lets them in")

    def _deaths(self, step: Step) -> None:
        assert step.before is not None
        frame, liquid = step.before, self.liquid
        self.deaths += len(step.gone)
        at, speed = frame.position[step.gone], np.linalg.norm(frame.velocity[step.gone], axis=1)
        travel = APPEARS * liquid.spacing + 2.0 * np.maximum(speed, SLOW) * step.duration
        travel = travel + liquid.strength * step.duration**2
        taken = liquid.near_open_side(at, travel)
        for name in liquid.outflows:
            if not holds_back(step, name):
                taken |= liquid.near_outflow(name, at, travel)
        self._stray(step.now.index, step.gone[~taken], frame.position, "vanish where nothing takes them away")

    def _stray(self, index: int, rows: Rows, position: F64, what: str) -> None:
        if len(rows):
            self._note(index, len(rows), what, position[rows].mean(axis=0)[None])

    def _note(self, index: int, count: int, what: str, where: F64) -> None:
        self.wrong.append((index, count, what, place(where[0])))

    def findings(self) -> dict[str, Finding]:
        """The first that is wrong, and how many there are."""
        total = float(sum(count for _, count, _, _ in self.wrong))
        if not self.wrong:
            text = f"{self.births} particles came in at inflows, {self.deaths} left at outflows or open sides"
            return {"identity": Finding("pass", text, 0.0, 0.0, "1", evidence={"births": self.births, "deaths": self.deaths})}
        index, count, what, where = self.wrong[0]
        text = f"{count} particles {what} at frame {index}, about {where} m ({total:.0f} such cases in all)"
        hints = (
            bake_again(),
            shorter_step(self.liquid, "the engine lost particles"),
        )
        evidence = {
            "place": where,
            "cases": [{"frame": f, "particles": n, "what": w, "place": p} for f, n, w, p in self.wrong[:12]],
        }
        return {"identity": Finding("fail", text, total, 0.0, "1", None, index, hints, evidence)}
