"""Counts and frames of instances of particles, whatever their engine."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.fields import Fields, fields_of
from ...worlds.instances import carriers_of
from ..boundaries import BodyState
from ..coupled_solver import CoupledSolver, motion_records
from ..recipes import coupled_recipe, reader_recipe
from .energy import Elastic
from .scene import reach_of
from .setup import GrainReport

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...worlds.built import BuiltEntity
    from ...worlds.cache import Cache
    from ...worlds.spec import ParticlePhysics, WorldSpec

__all__ = ["FramedParticles"]

LEDGER = (
    "inflow_mass",
    "inflow_count",
    "died_mass",
    "died_count",
    "domain_outflow",
    "outflow_count",
    "driver_work",
    "wall_work",
    "start_mass",
)
"""Sums since frame 0."""


class FramedParticles(CoupledSolver):
    """One instance of particles."""

    KIND = "particles"
    REMEDY = "lower its step"

    @staticmethod
    def recipe_alone(spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, caches: Mapping[str, Cache]) -> str:
        """Recipe of particles that read the bodies' motion: only what reaches their domain, unless a medium carries them."""
        if carriers_of(spec, name):
            return coupled_recipe(spec, built)
        return reader_recipe(spec, built, name, caches, margin=reach_of(spec, name), rough=True)

    def __init__(self, *given: Any, **named: Any) -> None:
        super().__init__(*given, **named)
        self.fields: list[Fields] = [fields_of(self.spec, m, self._done.without, self.media) for m in self.members]
        self.density = np.array([self.spec.materials[self.spec.entities[m].material].density for m in self.members])
        self.origin: F64 = np.array(self.instance.settings.domain.center, dtype=np.float64)

    # ------------------------------------------------------------------ what engines do

    @abstractmethod
    def begin_motion(self) -> None:
        """Give the declared velocities, at frame 0."""

    @abstractmethod
    def exchange(self, seconds: float, bodies: BodyState, time: float) -> GrainReport:
        """Go on by `seconds` from `time`, with bodies as they are at its start."""

    @abstractmethod
    def columns(self) -> dict[str, Any]:
        """The present state: position, velocity, spin, radius, kind, identity, mass."""

    def physics(self, row: int) -> ParticlePhysics:
        """Physics of a member."""
        found: ParticlePhysics = self.spec.entities[self.members[row]].physics  # type: ignore[assignment]
        return found

    def elastic(self) -> Elastic:
        """Elastic energy of contacts in the present state: zero where particles do not meet."""
        return Elastic(0.0, 0.0)

    # ------------------------------------------------------------------ runs

    def start_frames(self) -> None:
        """The present state, with the declared velocities, is frame 0."""
        self.begin_motion()
        super().start_frames()

    def open_ledger(self) -> dict[str, Any]:
        """Sums since frame 0."""
        held = {"contact_energy": 0.0, "spring_energy": 0.0}
        return {**dict.fromkeys(LEDGER, 0.0), **held, "start_mass": float(self.columns()["mass"].sum())}

    def open_tally(self) -> dict[str, Any]:
        """Sums of a frame."""
        count = len(self.surround.boundaries)
        return {
            "steps": 0, "exchanges": 0, "time": 0.0, "speed": 0.0, "impulse": np.zeros((count, 6)), "reaction": np.zeros((count, 6)),
            "blown": np.zeros((len(self.members), 3)), "left": np.zeros(3),
        }  # fmt: skip

    def step(self, limit: float, bodies: BodyState, time: float) -> GrainReport:
        """One exchange of at most `limit` seconds from `time`, counted into the frame."""
        parts = max(1, int(np.ceil(limit / self.max_stable_dt() - 1e-6)))
        held = self.held(time)
        report = GrainReport.still(limit, self.surround, steps=0) if held else self.exchange(limit / parts, bodies, time)
        self._count(report)
        return report

    def _count(self, report: GrainReport) -> None:
        tally, ledger = self._tally, self._ledger
        tally["steps"] += report.steps
        tally["exchanges"] += 1
        tally["time"] += report.dt
        tally["speed"] = max(tally["speed"], report.fastest)
        tally["impulse"] += report.impulse
        tally["reaction"] += report.reaction
        tally["blown"] += report.blown
        tally["left"] += report.left[2:]
        ledger["outflow_count"] += float(report.left[0])
        ledger["domain_outflow"] += float(report.left[1])
        ledger["driver_work"] += report.work
        ledger["wall_work"] += report.wall_work
        ledger["inflow_count"] += report.came[0]
        ledger["inflow_mass"] += report.came[1]
        ledger["died_count"] += report.died[0]
        ledger["died_mass"] += report.died[1]

    # ------------------------------------------------------------------ output

    def coordinates(self) -> tuple[F64, F64]:
        """Positions [m] and velocities [m/s] of the particles, shape (n, 3) each."""
        c = self.columns()
        return c["position"], c["velocity"]

    def measured(self) -> dict[str, Any]:
        """Channels and records of the frame that ends."""
        c, tally, ledger = self.columns(), self._tally, self._ledger
        if tally["steps"] or self.frame == 0:
            # Without a step, contacts hold what they held: a resumed run knows it by the ledger.
            ledger["contact_energy"], ledger["spring_energy"] = self.elastic()
        order = np.argsort(c["identity"], kind="stable")
        c = {k: v[order] for k, v in c.items()}
        mass, squared = c["mass"], (c["velocity"] ** 2).sum(axis=1)
        moved = motion_records(mass, c["position"], c["velocity"], np.array(self.spec.simulation.gravity))
        total = moved["mass"]
        expected = ledger["start_mass"] + ledger["inflow_mass"] - ledger["died_mass"] - ledger["domain_outflow"]
        one = total / len(mass) if len(mass) else float("inf")
        turning = 0.2 * mass * c["radius"] ** 2 @ (c["spin"] ** 2).sum(axis=1)
        records = {
            **moved,
            "volume": float((4.0 / 3.0 * np.pi * c["radius"] ** 3).sum()),
            "particles": len(mass),
            "rotation_energy": float(turning),
            "max_speed": max(tally["speed"], moved["max_speed"]),
            "mean_speed": float(np.sqrt(squared).mean()) if len(mass) else 0.0,
            "steps": tally["steps"],
            "exchanges": tally["exchanges"],
            "step": tally["time"] / max(tally["steps"], 1),
            "lost": max(0, round((expected - total) / one)) if len(mass) else 0,
            **{k: v for k, v in ledger.items() if k != "start_mass"},
        }
        return {
            "origin": self.origin,
            "particle/position": (c["position"] - self.origin).astype(np.float32),
            "particle/velocity": c["velocity"].astype(np.float32),
            "particle/spin": c["spin"].astype(np.float32),
            "particle/id": c["identity"].astype(np.int32),
            "particle/member": c["kind"].astype(np.int32),
            "particle/radius": c["radius"].astype(np.float32),
            "exchange/impulse": tally["impulse"].copy(),
            "exchange/reaction": tally["reaction"].copy(),
            "field/impulse": tally["blown"].copy(),
            "outflow/momentum": tally["left"].copy(),
            **{f"record/{k}": np.float64(v) for k, v in records.items()},
        }

    def driver_names(self) -> tuple[str, ...]:
        """Fields that act on its members."""
        return tuple(dict.fromkeys(n for f in self.fields for n in f.names if n not in f.carriers))
