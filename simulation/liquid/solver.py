"""A liquid instance as a `Solver`: what its engine, of particles or of a grid, is given, and what its frames hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.categories.liquid.facts import declares_heat, spacing_of
from ...worlds.errors import EngineError
from ..boundaries import BodyState, Surround
from ..coupled_solver import CoupledSolver, motion_records
from ..protocol import SHORTEST
from ..recipes import reader_recipe
from ..sealed import from_bytes, to_bytes
from .engine import Engine, LiquidReport, LiquidSetup
from .scene import MARGIN, LiquidScene, build_scene

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.cache import Cache
    from ...worlds.spec import LiquidInstance, WorldSpec

__all__ = ["SolverLiquid", "make_engine"]

ENGINES = {"dfsph": ("dfsph", "Dfsph"), "flip": ("flip", "Flip")}
"""Folder and class of each engine; its settings are the class's name with `Settings`. Loaded when needed: they compile kernels."""
DOMAIN = "domain"
"""Name under which engines report what left through open sides."""
DRIVEN = ("driver_impulse_x", "driver_impulse_y", "driver_impulse_z", "driver_work")
BLOWN = ("field_impulse_x", "field_impulse_y", "field_impulse_z", "field_work")
"""Records of what zones of waves gave."""

SQUEEZE = {"dfsph": 0.006}
"""[1] Mean compression by a wall that moves before the engine knows, by engine; a grid corrects the volume of its cells."""
SPEEDS = ("v", "velocity", "affine")
"""Arrays of the engines' states that hold how fast particles are."""
CLOCKS = ("time", "speed", "steps", "layers", "travel", "inflows", "stage")
"""Those that count since the start, or tell of inflows."""


def make_engine(instance: LiquidInstance, setup: LiquidSetup) -> Engine:
    """The engine that an instance asks for."""
    from importlib import import_module

    folder, name = ENGINES[instance.engine]
    engine = getattr(import_module(f".{folder}.engine", __package__), name)
    settings = getattr(import_module(f".{folder}.settings", __package__), f"{name}Settings")
    known = {f.name: getattr(instance.settings, f.name) for f in fields(settings) if hasattr(instance.settings, f.name)}
    made: Engine = engine(setup, settings(**known))
    return made


class SolverLiquid(CoupledSolver):
    """One liquid instance."""

    KIND = "liquid"
    REMEDY = "shorten max_step or cfl"

    @staticmethod
    def recipe_alone(spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, caches: Mapping[str, Cache]) -> str:
        """Recipe of a liquid that reads the bodies' motion: only what reaches its domain."""
        return reader_recipe(spec, built, name, caches, margin=MARGIN * spacing_of(spec, name), rough=False)

    def set_up(self) -> None:
        """Fill the volume and make the engine."""
        self.scene: LiquidScene = build_scene(self.spec, self.built, self.name, without=self._done.without)
        setup = self.scene.setup
        self.engine = make_engine(self.instance, setup)
        self.drivers = tuple(
            k for k, d in self.spec.simulation.drivers.items() if d.kind in ("inflow", "outflow") and d.entity in self.members
        )
        self._row = {name: k for k, name in enumerate(self.drivers)}
        self._density = np.array([f.density for f in setup.fluids])
        self._heat = declares_heat(self.spec, self.name)
        self.origin = 0.5 * (setup.lower + setup.upper)

    @property
    def surround(self) -> Surround:
        """The bodies that it meets."""
        return self.scene.surround

    def open_ledger(self) -> dict[str, Any]:
        """Sums since frame 0."""
        count, p = len(self.drivers), self.engine.particles()
        mass = float((p.volume * self._density[p.fluid]).sum())
        return {"in": [0.0] * count, "out": [0.0] * count, DOMAIN: 0.0, "mass": mass, "driven": [0.0] * 4, "blown": [0.0] * 4}

    def open_tally(self) -> dict[str, Any]:
        """Sums of a frame."""
        count = len(self.surround.boundaries)
        zero = {"steps": 0, "time": 0.0, "pressure": 0, "divergence": 0, "capped": 0, "mean": 0.0, "max": 0.0}
        return {**zero, "impulse": np.zeros((count, 6)), "reaction": np.zeros((count, 6))}

    def max_stable_dt(self) -> float:
        """Largest stable step of the engine [s]."""
        return min(self.engine.stable_dt(), float(self.instance.settings.max_step))

    def squeeze(self) -> float:
        """Mean compression that a wall which was struck may leave [1]."""
        return SQUEEZE.get(self.instance.engine, np.inf)

    # ------------------------------------------------------------------ stepping

    def next_span(self, left: float) -> float:
        """Length [s] of the next exchange: all that is left, of which the engine makes one of equal steps."""
        return left

    def step(self, limit: float, bodies: BodyState, time: float) -> LiquidReport:
        """One step of at most `limit` seconds from `time`, counted into the frame."""
        report = LiquidReport.still(limit, self.surround) if self.held(time) else self.engine.step(limit, bodies)
        if not SHORTEST * 1e-3 < report.dt <= limit * (1 + 1e-6):
            raise EngineError(
                f"engine {self.instance.engine!r} made a step of {report.dt!r} s where at most {limit:g} s was asked"
            )
        self._count(report)
        return report

    def _count(self, report: LiquidReport) -> None:
        tally, ledger = self._tally, self._ledger
        tally["steps"] += report.steps
        tally["time"] += report.dt
        tally["impulse"] += report.impulse
        tally["reaction"] += report.reaction
        tally["pressure"] = max(tally["pressure"], report.iterations[0])
        tally["divergence"] = max(tally["divergence"], report.iterations[1])
        tally["capped"] += int(report.capped > 0)
        tally["mean"] = max(tally["mean"], report.density_error[0])
        tally["max"] = max(tally["max"], report.density_error[1])
        for name, given in (("driven", report.driven), ("blown", report.blown)):
            ledger[name] = [a + float(b) for a, b in zip(ledger[name], given, strict=True)]
        for name, mass in report.added.items():
            ledger["in"][self._row[name]] += mass
        for name, mass in report.removed.items():
            if name == DOMAIN:
                ledger[DOMAIN] += mass
            else:
                ledger["out"][self._row[name]] += mass

    # ------------------------------------------------------------------ state

    def pack(self) -> bytes:
        """State of the engine."""
        return self.engine.checkpoint()

    def rested(self, state: bytes) -> bytes:
        """A state with the liquid where it is, at rest, and with the clock and the inflows of this engine."""
        own, found = from_bytes(self.engine.checkpoint()), from_bytes(state)
        still = {name: np.zeros_like(found[name]) for name in SPEEDS if name in found}
        fresh = {name: own[name] for name in CLOCKS if name in own}
        if "clock" in own:  # time, speed and volume of a liquid on a grid
            fresh["clock"] = np.array([*own["clock"][:2], found["clock"][2]])
        return to_bytes({**found, **still, **fresh})

    def unpack(self, state: bytes) -> None:
        """Continue from such a state."""
        self.engine.restore(state)

    # ------------------------------------------------------------------ output

    def coordinates(self) -> tuple[F64, F64]:
        """Positions [m] and velocities [m/s] of the particles, shape (n, 3) each."""
        p = self.engine.particles()
        return p.position, p.velocity

    def measured(self) -> dict[str, Any]:
        """Channels and records of the frame that ends."""
        p, tally, ledger = self.engine.particles(), self._tally, self._ledger
        mass = p.volume * self._density[p.fluid]
        moved = motion_records(mass, p.position, p.velocity, self.scene.setup.gravity)
        total = moved["mass"]
        flows = sum(ledger["in"]) - sum(ledger["out"]) - ledger[DOMAIN]
        missing = ledger["mass"] + flows - total
        one = total / len(mass) if len(mass) else float(self._density[0]) * self.scene.setup.spacing**3
        records = {
            **moved,
            "volume": float(p.volume.sum()),
            "particles": len(mass),
            "density_error_mean": tally["mean"],
            "density_error_max": tally["max"],
            "iterations_pressure": tally["pressure"],
            "iterations_divergence": tally["divergence"],
            "iterations_capped": tally["capped"],
            "steps": tally["steps"],
            "step": tally["time"] / max(tally["steps"], 1),
            "lost": max(0, round(missing / one)),
            "inflow_mass": sum(ledger["in"]),
            "outflow_mass": sum(ledger["out"]),
            "domain_outflow": ledger[DOMAIN],
            **dict(zip(DRIVEN, ledger["driven"], strict=True)),
            **dict(zip(BLOWN, ledger["blown"], strict=True)),
        }
        return {
            "origin": self.origin,
            "particle/position": (p.position - self.origin).astype(np.float32),
            "particle/velocity": p.velocity.astype(np.float32),
            "particle/id": p.identity.astype(np.int32),
            "particle/fluid": p.fluid.astype(np.int32),
            "particle/volume": p.volume.astype(np.float32),
            "particle/density": p.density.astype(np.float32),
            "particle/pressure": p.pressure.astype(np.float32),
            **({"particle/temperature": p.temperature.astype(np.float32)} if self._heat else {}),
            "exchange/impulse": tally["impulse"].copy(),
            "exchange/reaction": tally["reaction"].copy(),
            "inflow/mass": np.array(ledger["in"], dtype=np.float64),
            "outflow/mass": np.array(ledger["out"], dtype=np.float64),
            **{f"record/{name}": np.float64(value) for name, value in records.items()},
        }

    def driver_names(self) -> tuple[str, ...]:
        """Drivers that channels of flows have a column of."""
        return self.drivers
