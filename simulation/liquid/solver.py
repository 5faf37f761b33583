"""A liquid instance as a `Solver`: frames, ledgers and checkpoints around an engine of particles or of a grid."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ...worlds.arrays import F64
from ...worlds.cache import CacheIndex
from ...worlds.errors import EngineError, InputError
from ...worlds.liquids import declares_heat
from ..boundaries import BodyState, Surround
from ..protocol import SHORTEST, Channel, Intervention, Port
from ..sealed import seal, unseal
from .engine import Engine, LiquidSetup, StepReport
from .scene import LiquidScene, build_scene

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.cache import Cache
    from ...worlds.spec import LiquidInstance, WorldSpec

__all__ = ["BodyMotion", "SolverLiquid", "make_engine"]

MAGIC = b"WALQ1"
CHANNELS = (
    Channel("origin", "f8", "m", ("3",), "frame"),
    Channel("particle/position", "f4", "m", ("particles", "3"), "particle"),
    Channel("particle/velocity", "f4", "m/s", ("particles", "3"), "particle"),
    Channel("particle/id", "i4", "1", ("particles",), "particle"),
    Channel("particle/fluid", "i4", "1", ("particles",), "particle"),
    Channel("particle/volume", "f4", "m^3", ("particles",), "particle"),
    Channel("particle/density", "f4", "kg/m^3", ("particles",), "particle"),
    Channel("particle/pressure", "f4", "Pa", ("particles",), "particle"),
    Channel("exchange/impulse", "f8", "N s, N m s", ("boundaries", "6"), "body"),
    Channel("exchange/reaction", "f8", "N s, N m s", ("boundaries", "6"), "body"),
    Channel("inflow/mass", "f8", "kg", ("drivers",), "frame"),
    Channel("outflow/mass", "f8", "kg", ("drivers",), "frame"),
)
HEAT = Channel("particle/temperature", "f4", "K", ("particles",), "particle")
ENGINES = {"dfsph": ("dfsph", "Dfsph"), "flip": ("flip", "Flip")}
"""Folder and class of each engine; its settings are the class's name with `Settings`. Loaded when needed: they compile kernels."""
DOMAIN = "domain"
"""Name under which engines report what left through open sides."""
DRIVEN = ("driver_impulse_x", "driver_impulse_y", "driver_impulse_z", "driver_work")
"""Records of what zones of waves gave."""


class BodyMotion(Protocol):
    """Where a liquid's boundaries are at any time."""

    def state(self, start: float, end: float) -> BodyState:
        """Boundaries' bodies at `start` [s], moving so that they arrive where they are at `end`."""


def make_engine(instance: LiquidInstance, setup: LiquidSetup) -> Engine:
    """The engine that an instance asks for."""
    from importlib import import_module

    folder, name = ENGINES[instance.engine]
    engine = getattr(import_module(f".{folder}.engine", __package__), name)
    settings = getattr(import_module(f".{folder}.settings", __package__), f"{name}Settings")
    known = {f.name: getattr(instance.settings, f.name) for f in fields(settings) if hasattr(instance.settings, f.name)}
    made: Engine = engine(setup, settings(**known))
    return made


class SolverLiquid:
    """One liquid instance.

    Args:
        spec: the specification.
        built: its geometry.
        name: the instance.
        caches: of the rigid instances that move its boundaries; None: a coupling gives their states.
        intervention: inflows and waves taken away; liquids that are held neither move nor act from then on.
        recipe: hash of everything that decides this liquid's motion, for the cache's index.
    """

    def __init__(
        self,
        spec: WorldSpec,
        built: Mapping[str, BuiltEntity],
        name: str,
        *,
        caches: Mapping[str, Cache] | None = None,
        intervention: Intervention | None = None,
        recipe: str = "",
    ) -> None:
        self.spec, self.built, self.name, self.recipe = spec, built, name, recipe
        self.instance = spec.simulation.liquid[name]
        self._caches = caches
        self.motion: BodyMotion | None = None
        self.frame = 0
        self._done = intervention or Intervention()
        if any(set(pair) & set(self.instance.members) for pair in self._done.apart):
            raise InputError(f"a liquid cannot be let through solids in this build ({sorted(self._done.apart)[:2]})")
        self._frame_time = 1.0 / spec.simulation.fps

    def prepare(self, *, resumed: bool = False) -> None:
        """Fill the volume, make the engine, let the liquid settle around bodies at their places during the preroll.

        Raises:
            InputError: the liquid cannot be set up.
        """
        self.begin_run()
        if not resumed:
            self._settle()
        self.start_frames()

    def begin_run(self) -> None:
        """Set the engine up, at the start of the preroll."""
        self.scene: LiquidScene = build_scene(self.spec, self.built, self.name, without=self._done.without)
        setup = self.scene.setup
        self.engine = make_engine(self.instance, setup)
        self.drivers = tuple(
            k
            for k, d in self.spec.simulation.drivers.items()
            if d.kind in ("inflow", "outflow") and d.entity in self.instance.members
        )
        self._row = {name: k for k, name in enumerate(self.drivers)}
        self._density = np.array([f.density for f in setup.fluids])
        self._heat = declares_heat(self.spec, self.name)
        self.origin = 0.5 * (setup.lower + setup.upper)
        if self._caches:
            from ..bodies import CacheMotion

            self.motion = CacheMotion(self.surround, self._caches, self.spec.simulation.fps)
        self._start_ledger()
        self._begin_tally()

    @property
    def surround(self) -> Surround:
        """The bodies that it meets."""
        return self.scene.surround

    def start_frames(self) -> None:
        """The present state is frame 0: ledgers of flows start here."""
        self._start_ledger()
        particles = self.engine.particles()
        self._ledger["mass"] = float((particles.volume * self._density[particles.fluid]).sum())
        self.restore(self._bytes(), 0)
        self._begin_tally()
        self._finish_frame()

    def _settle(self) -> None:
        seconds, still = self.spec.simulation.preroll, self.still()
        done = 0.0
        while done < seconds - SHORTEST:
            done += self.step(seconds - done, still, done - seconds).dt

    def _start_ledger(self) -> None:
        count = len(self.drivers)
        self._ledger: dict[str, Any] = {"in": [0.0] * count, "out": [0.0] * count, DOMAIN: 0.0, "mass": 0.0, "driven": [0.0] * 4}

    def max_stable_dt(self) -> float:
        """Largest stable step of the engine [s]."""
        return min(self.engine.stable_dt(), self.instance.settings.max_step)

    # ------------------------------------------------------------------ stepping

    def still(self) -> BodyState:
        """All boundaries at rest at their places of frame 0."""
        from ..bodies import resting

        return resting(self.surround)

    def held(self, time: float) -> bool:
        """Whether an intervention keeps this liquid where it is at `time` [s]."""
        return bool(self._done.held & set(self.instance.members)) and time >= self._done.since - SHORTEST

    def step(self, limit: float, bodies: BodyState, time: float) -> StepReport:
        """One step of at most `limit` seconds from `time`, counted into the frame."""
        if self.held(time):
            none = np.zeros((len(self.scene.setup.boundaries), 6))
            report = StepReport(limit, none, none, {}, {}, (0, 0), 0, (0.0, 0.0))
        else:
            allowed = self.max_stable_dt()
            parts = max(1, math.ceil(limit / allowed - 1e-6))
            report = self.engine.step(limit / parts, bodies)
        if not SHORTEST * 1e-3 < report.dt <= limit * (1 + 1e-6):
            raise EngineError(
                f"engine {self.instance.engine!r} made a step of {report.dt!r} s where at most {limit:g} s was asked"
            )
        self._count(report)
        return report

    def _count(self, report: StepReport) -> None:
        tally, ledger = self._tally, self._ledger
        tally["steps"] += 1
        tally["time"] += report.dt
        tally["impulse"] += report.impulse
        tally["reaction"] += report.reaction
        tally["pressure"] = max(tally["pressure"], report.iterations[0])
        tally["divergence"] = max(tally["divergence"], report.iterations[1])
        tally["capped"] += int(report.capped > 0)
        tally["mean"] = max(tally["mean"], report.density_error[0])
        tally["max"] = max(tally["max"], report.density_error[1])
        ledger["driven"] = [a + float(b) for a, b in zip(ledger["driven"], report.driven, strict=True)]
        for name, mass in report.added.items():
            ledger["in"][self._row[name]] += mass
        for name, mass in report.removed.items():
            if name == DOMAIN:
                ledger[DOMAIN] += mass
            else:
                ledger["out"][self._row[name]] += mass

    def begin_frame(self, frame: int) -> None:
        """Start the next frame.

        Raises:
            InputError: not the next frame.
        """
        if frame != self.frame + 1:
            raise InputError(f"advance({frame}) after frame {self.frame}; the next frame is {self.frame + 1}")
        self._begin_tally()

    def _begin_tally(self) -> None:
        count = len(self.scene.setup.boundaries)
        zero = {"steps": 0, "time": 0.0, "pressure": 0, "divergence": 0, "capped": 0, "mean": 0.0, "max": 0.0}
        self._tally: dict[str, Any] = {**zero, "impulse": np.zeros((count, 6)), "reaction": np.zeros((count, 6))}

    def end_frame(self) -> None:
        """The frame that was begun is reached."""
        self.frame += 1
        self._finish_frame()

    def advance(self, frame: int) -> None:
        """Advance from frame - 1 to `frame`, the boundaries on their recorded paths.

        Raises:
            InputError: not the next frame.
            EngineError: the liquid's state is not finite.
        """
        self.begin_frame(frame)
        start, end = (frame - 1) * self._frame_time, frame * self._frame_time
        time = start
        while time < end - SHORTEST:
            limit = min(self.max_stable_dt(), end - time)
            bodies = self.still() if self.motion is None else self.motion.state(time, time + limit)
            time += self.step(end - time if self.motion is None else limit, bodies, time).dt
        self.end_frame()

    # ------------------------------------------------------------------ state

    def _bytes(self) -> bytes:
        return seal(MAGIC, self._ledger, self.engine.checkpoint())

    def checkpoint(self) -> bytes:
        """The full state; the solver itself continues from exactly these bytes."""
        state = self._bytes()
        self.restore(state, self.frame)
        return state

    def restore(self, state: bytes, frame: int) -> None:
        """Continue from a checkpoint taken at `frame`.

        Raises:
            EngineError: the bytes are damaged, or not a checkpoint of this liquid.
        """
        ledger, held = unseal(MAGIC, state, frame, "liquid")
        if len(ledger["in"]) != len(self.drivers):
            raise EngineError("checkpoint belongs to another liquid; delete the candidate's checkpoints and bake again")
        self.engine.restore(held)
        self._ledger, self.frame = ledger, frame

    # ------------------------------------------------------------------ output

    def _finish_frame(self) -> None:
        p, tally, ledger = self.engine.particles(), self._tally, self._ledger
        if not (np.isfinite(p.position).all() and np.isfinite(p.velocity).all()):
            raise EngineError(f"coordinates of {self.name!r} are not finite at frame {self.frame}; shorten max_step or cfl")
        mass = p.volume * self._density[p.fluid]
        total = float(mass.sum())
        momentum = mass @ p.velocity if len(mass) else np.zeros(3)
        squared = np.einsum("ij,ij->i", p.velocity, p.velocity)
        flows = sum(ledger["in"]) - sum(ledger["out"]) - ledger[DOMAIN]
        missing = ledger["mass"] + flows - total
        one = total / len(mass) if len(mass) else float(self._density[0]) * self.scene.setup.spacing**3
        gravity = self.scene.setup.gravity
        records = {
            "mass": total,
            "volume": float(p.volume.sum()),
            "particles": len(mass),
            "momentum_x": momentum[0],
            "momentum_y": momentum[1],
            "momentum_z": momentum[2],
            "kinetic_energy": 0.5 * float(mass @ squared),
            "potential_energy": -float(mass @ (p.position @ gravity)),
            "max_speed": float(np.sqrt(squared.max(initial=0.0))),
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
        }
        self._data: dict[str, Any] = {
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

    def frame_data(self) -> Mapping[str, Any]:
        """Channels and records of the present frame."""
        return self._data

    def channels(self) -> tuple[Channel, ...]:
        """What `frame_data` holds, records apart."""
        return (*CHANNELS, HEAT) if declares_heat(self.spec, self.name) else CHANNELS

    def index(self) -> CacheIndex:
        """Names behind the channels' rows."""
        from importlib.metadata import version

        return CacheIndex(
            solver=self.name,
            engine=self.instance.engine,
            fps=self.spec.simulation.fps,
            frames=self.spec.simulation.frames,
            bodies=tuple(self.instance.members),
            colliders=tuple(b.name for b in self.scene.setup.boundaries),
            joints=(),
            drivers=self.drivers,
            settings=self.recipe,
            versions={"numpy": np.__version__, "warp-lang": version("warp-lang")},
        )

    def ports(self) -> tuple[Port, ...]:
        """Every boundary gives motion and takes a wrench."""
        names = [b.name.split("/", 1) for b in self.scene.setup.boundaries]
        return tuple(Port(entity, body, "wrench", "out") for entity, body in names)

    def respond(self, port: Port, wrench: F64) -> F64:
        """Boundaries are moved by others: no velocity change (6,)."""
        del port, wrench
        return np.zeros(6)
