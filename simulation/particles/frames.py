"""What instances of particles share: frames, ledgers and checkpoints around an engine."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.cache import CacheIndex
from ...worlds.errors import EngineError, InputError
from ...worlds.fields import Fields, fields_of
from ..boundaries import BodyState, Surround
from ..protocol import SHORTEST, Channel, Intervention, Port
from ..sealed import seal, unseal

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.cache import Cache
    from ...worlds.spec import ParticlePhysics, WorldSpec
    from ..bodies import CacheMotion

__all__ = ["FramedParticles", "Taken"]

CHANNELS = (
    Channel("origin", "f8", "m", ("3",), "frame"),
    Channel("particle/position", "f4", "m", ("particles", "3"), "particle"),
    Channel("particle/velocity", "f4", "m/s", ("particles", "3"), "particle"),
    Channel("particle/spin", "f4", "rad/s", ("particles", "3"), "particle"),
    Channel("particle/id", "i4", "1", ("particles",), "particle"),
    Channel("particle/member", "i4", "1", ("particles",), "particle"),
    Channel("particle/radius", "f4", "m", ("particles",), "particle"),
    Channel("exchange/impulse", "f8", "N s, N m s", ("boundaries", "6"), "body"),
    Channel("exchange/reaction", "f8", "N s, N m s", ("boundaries", "6"), "body"),
    Channel("field/impulse", "f8", "N s", ("members", "3"), "frame"),
    Channel("outflow/momentum", "f8", "N s", ("3",), "frame"),
)
LEDGER = (
    "inflow_mass",
    "inflow_count",
    "died_mass",
    "died_count",
    "domain_outflow",
    "outflow_count",
    "driver_work",
    "start_mass",
)
"""Sums since frame 0."""


class Taken(NamedTuple):
    """What one exchange did; see `coupling.Stepped`."""

    dt: float
    impulse: F64
    reaction: F64
    steps: int
    speed: float
    blown: F64
    """Impulse of fields per member (m, 3) [N s]."""
    work: float
    """Of fields [J]."""
    left: F64
    """What left the domain: number, mass, momentum (5,)."""
    came: tuple[int, float] = (0, 0.0)
    """Number and mass of what was let in."""
    died: tuple[int, float] = (0, 0.0)


class FramedParticles(ABC):
    """One instance of particles.

    Args:
        spec: the specification.
        built: its geometry.
        name: the instance.
        caches: of the rigid instances that move its walls; None: a coupling gives their states.
        intervention: fields and emitters taken away; members that are held neither move nor act from then on.
        recipe: hash of everything that decides this motion, for the cache's index.
    """

    MAGIC = b""

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
        self.instance = spec.simulation.particles[name]
        self.members = tuple(self.instance.members)
        self._caches = caches
        self.motion: CacheMotion | None = None
        self.frame = 0
        self._done = intervention or Intervention()
        if any(set(pair) & set(self.members) for pair in self._done.apart):
            raise InputError(f"particles cannot be let through solids in this build ({sorted(self._done.apart)[:2]})")
        self._frame_time = 1.0 / spec.simulation.fps
        self.fields: list[Fields] = [fields_of(spec, m, self._done.without) for m in self.members]
        self.density = np.array([spec.materials[spec.entities[m].material].density for m in self.members])
        self.origin: F64 = np.array(self.instance.settings.domain.center, dtype=np.float64)

    # ------------------------------------------------------------------ what engines do

    @property
    @abstractmethod
    def surround(self) -> Surround:
        """The bodies that it meets."""

    @abstractmethod
    def set_up(self) -> None:
        """Make the engine, at the start of the preroll."""

    @abstractmethod
    def begin_motion(self) -> None:
        """Give the declared velocities, at frame 0."""

    @abstractmethod
    def exchange(self, seconds: float, bodies: BodyState, time: float) -> Taken:
        """Go on by `seconds` from `time`, with bodies as they are at its start."""

    @abstractmethod
    def longest(self) -> float:
        """Longest exchange in the present state [s]."""

    @abstractmethod
    def columns(self) -> dict[str, Any]:
        """The present state: position, velocity, spin, radius, kind, identity, mass."""

    @abstractmethod
    def pack(self) -> bytes:
        """State of the engine."""

    @abstractmethod
    def unpack(self, state: bytes) -> None:
        """Continue from such a state."""

    def physics(self, row: int) -> ParticlePhysics:
        """Physics of a member."""
        found: ParticlePhysics = self.spec.entities[self.members[row]].physics  # type: ignore[assignment]
        return found

    # ------------------------------------------------------------------ runs

    def prepare(self, *, resumed: bool = False) -> None:
        """Fill the volume, make the engine, let the particles settle during the preroll with bodies at their places.

        Raises:
            InputError: the particles cannot be set up.
        """
        self.begin_run()
        if not resumed:
            self._settle()
        self.start_frames()

    def begin_run(self) -> None:
        """Set the engine up, at the start of the preroll."""
        self.set_up()
        if self._caches:
            from ..bodies import CacheMotion

            self.motion = CacheMotion(self.surround, self._caches, self.spec.simulation.fps)
        self._ledger = dict.fromkeys(LEDGER, 0.0)
        self._begin_tally()

    def start_frames(self) -> None:
        """The present state is frame 0: ledgers start here."""
        self.begin_motion()
        self._ledger = dict.fromkeys(LEDGER, 0.0)
        self._ledger["start_mass"] = float(self.columns()["mass"].sum())
        self.restore(self._bytes(), 0)
        self._begin_tally()
        self._finish_frame()

    def _settle(self) -> None:
        seconds, still = self.spec.simulation.preroll, self._still()
        done = 0.0
        while done < seconds - SHORTEST:
            done += self.step(seconds - done, still, done - seconds).dt

    def _still(self) -> BodyState:
        from ..bodies import resting

        return resting(self.surround)

    def max_stable_dt(self) -> float:
        """Longest exchange [s]."""
        return self.longest()

    def held(self, time: float) -> bool:
        """Whether an intervention keeps these particles where they are at `time` [s]."""
        return bool(self._done.held & set(self.members)) and time >= self._done.since - SHORTEST

    def step(self, limit: float, bodies: BodyState, time: float) -> Taken:
        """One exchange of at most `limit` seconds from `time`, counted into the frame."""
        parts = max(1, int(np.ceil(limit / self.longest() - 1e-6)))
        seconds = limit / parts
        if self.held(time):
            none = np.zeros((len(self.surround.boundaries), 6))
            taken = Taken(limit, none, none, 0, 0.0, np.zeros((len(self.members), 3)), 0.0, np.zeros(5))
        else:
            taken = self.exchange(seconds, bodies, time)
        self._count(taken)
        return taken

    def _count(self, taken: Taken) -> None:
        tally, ledger = self._tally, self._ledger
        tally["steps"] += taken.steps
        tally["exchanges"] += 1
        tally["time"] += taken.dt
        tally["speed"] = max(tally["speed"], taken.speed)
        tally["impulse"] += taken.impulse
        tally["reaction"] += taken.reaction
        tally["blown"] += taken.blown
        tally["left"] += taken.left[2:]
        ledger["outflow_count"] += float(taken.left[0])
        ledger["domain_outflow"] += float(taken.left[1])
        ledger["driver_work"] += taken.work
        ledger["inflow_count"] += taken.came[0]
        ledger["inflow_mass"] += taken.came[1]
        ledger["died_count"] += taken.died[0]
        ledger["died_mass"] += taken.died[1]

    def begin_frame(self, frame: int) -> None:
        """Start the next frame.

        Raises:
            InputError: not the next frame.
        """
        if frame != self.frame + 1:
            raise InputError(f"advance({frame}) after frame {self.frame}; the next frame is {self.frame + 1}")
        self._begin_tally()

    def _begin_tally(self) -> None:
        count = len(self.surround.boundaries)
        self._tally: dict[str, Any] = {
            "steps": 0, "exchanges": 0, "time": 0.0, "speed": 0.0, "impulse": np.zeros((count, 6)), "reaction": np.zeros((count, 6)),
            "blown": np.zeros((len(self.members), 3)), "left": np.zeros(3),
        }  # fmt: skip

    def end_frame(self) -> None:
        """The frame that was begun is reached."""
        self.frame += 1
        self._finish_frame()

    def advance(self, frame: int) -> None:
        """Advance from frame - 1 to `frame`, the walls on their recorded paths.

        Raises:
            InputError: not the next frame.
            EngineError: the state is not finite.
        """
        self.begin_frame(frame)
        start, end = (frame - 1) * self._frame_time, frame * self._frame_time
        time = start
        still = self._still()
        while time < end - SHORTEST:
            parts = max(1, int(np.ceil((end - time) / self.longest() - 1e-6)))
            seconds = (end - time) / parts
            bodies = still if self.motion is None else self.motion.state(time, time + seconds)
            time += self.step(seconds, bodies, time).dt
        self.end_frame()

    # ------------------------------------------------------------------ state

    def _bytes(self) -> bytes:
        return seal(self.MAGIC, self._ledger, self.pack())

    def checkpoint(self) -> bytes:
        """The full state; the solver itself continues from exactly these bytes."""
        state = self._bytes()
        self.restore(state, self.frame)
        return state

    def restore(self, state: bytes, frame: int) -> None:
        """Continue from a checkpoint taken at `frame`.

        Raises:
            EngineError: the bytes are damaged, or not a checkpoint of these particles.
        """
        ledger, held = unseal(self.MAGIC, state, frame, "particle")
        if set(ledger) != set(LEDGER):
            raise EngineError("checkpoint belongs to other particles; delete the candidate's checkpoints and bake again")
        self.unpack(held)
        self._ledger, self.frame = ledger, frame

    # ------------------------------------------------------------------ output

    def _finish_frame(self) -> None:
        c, tally, ledger = self.columns(), self._tally, self._ledger
        order = np.argsort(c["identity"], kind="stable")
        c = {k: v[order] for k, v in c.items()}
        if not (np.isfinite(c["position"]).all() and np.isfinite(c["velocity"]).all()):
            raise EngineError(f"coordinates of {self.name!r} are not finite at frame {self.frame}; lower its step")
        mass, squared = c["mass"], (c["velocity"] ** 2).sum(axis=1)
        total = float(mass.sum())
        momentum = mass @ c["velocity"] if len(mass) else np.zeros(3)
        expected = ledger["start_mass"] + ledger["inflow_mass"] - ledger["died_mass"] - ledger["domain_outflow"]
        one = total / len(mass) if len(mass) else float("inf")
        gravity = np.array(self.spec.simulation.gravity)
        turning = 0.2 * mass * c["radius"] ** 2 @ (c["spin"] ** 2).sum(axis=1)
        records = {
            "mass": total,
            "volume": float((4.0 / 3.0 * np.pi * c["radius"] ** 3).sum()),
            "particles": len(mass),
            "momentum_x": momentum[0],
            "momentum_y": momentum[1],
            "momentum_z": momentum[2],
            "kinetic_energy": 0.5 * float(mass @ squared),
            "rotation_energy": float(turning),
            "potential_energy": -float(mass @ (c["position"] @ gravity)),
            "max_speed": max(tally["speed"], float(np.sqrt(squared.max(initial=0.0)))),
            "mean_speed": float(np.sqrt(squared).mean()) if len(mass) else 0.0,
            "steps": tally["steps"],
            "exchanges": tally["exchanges"],
            "step": tally["time"] / max(tally["steps"], 1),
            "lost": max(0, round((expected - total) / one)) if len(mass) else 0,
            **{k: v for k, v in ledger.items() if k != "start_mass"},
        }
        self._data: dict[str, Any] = {
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

    def frame_data(self) -> Mapping[str, Any]:
        """Channels and records of the present frame."""
        return self._data

    def channels(self) -> tuple[Channel, ...]:
        """What `frame_data` holds, records apart."""
        return CHANNELS

    def index(self) -> CacheIndex:
        """Names behind the channels' rows."""
        from importlib.metadata import version

        return CacheIndex(
            solver=self.name,
            engine=self.instance.engine,
            fps=self.spec.simulation.fps,
            frames=self.spec.simulation.frames,
            bodies=self.members,
            colliders=tuple(b.name for b in self.surround.boundaries),
            joints=(),
            drivers=tuple(dict.fromkeys(n for f in self.fields for n in f.names)),
            settings=self.recipe,
            versions={"numpy": np.__version__, "warp-lang": version("warp-lang")},
        )

    def ports(self) -> tuple[Port, ...]:
        """Every wall gets wrenches and gives motion."""
        names = [b.name.split("/", 1) for b in self.surround.boundaries]
        return tuple(Port(entity, body, "wrench", "both") for entity, body in names)

    def respond(self, port: Port, wrench: F64) -> F64:
        """Particles give way to nobody as a whole.

        Raises:
            InputError: always.
        """
        raise InputError(f"port {port.entity}/{port.part} belongs to particles, which give no response as a whole")
