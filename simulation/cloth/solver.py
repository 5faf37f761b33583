"""A cloth instance as a solver: frames, ledgers and checkpoints around the engine; it steps alone or with rigid bodies."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.cache import CacheIndex
from ...worlds.cloth import release_time
from ...worlds.errors import EngineError, InputError
from ..bodies import CacheMotion, resting
from ..boundaries import BodyState, Surround
from ..protocol import SHORTEST, Channel, Intervention, Port
from ..sealed import seal, unseal
from .energy import bending_energy, edge_ratios, membrane_energy
from .engine import Cloth
from .scene import build_scene
from .setup import ClothReport

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.cache import Cache
    from ...worlds.spec import WorldSpec

__all__ = ["SolverCloth"]

MAGIC = b"WACL1"
CHANNELS = (
    Channel("vertex/position", "f8", "m", ("vertices", "3"), "vertex"),
    Channel("vertex/velocity", "f4", "m/s", ("vertices", "3"), "vertex"),
    Channel("exchange/impulse", "f8", "N s, N m s", ("boundaries", "6"), "body"),
)
SUMS = ("air", "hold", "cut", "solid")
"""What gives momentum to cloth, summed since frame 0."""


class SolverCloth:
    """One cloth instance (a `coupling.Partner`).

    Args:
        spec: the specification.
        built: its geometry.
        name: the instance.
        caches: of the rigid instances that move what it meets; None: a coupling gives their states.
        intervention: fields taken away, cloth held where it is, entities that it passes through.
        recipe: hash of everything that decides its motion, for the cache's index.
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
        self.instance = spec.simulation.cloth[name]
        self._caches = caches
        self._done = intervention or Intervention()
        self._frame_time = 1.0 / spec.simulation.fps
        self.frame = 0

    # ------------------------------------------------------------------ set up

    def prepare(self, *, resumed: bool = False) -> None:
        """Set up, and let the cloth settle around bodies at their places during the preroll."""
        self.begin_run()
        if not resumed:
            seconds, still = self.spec.simulation.preroll, self.still()
            done = 0.0
            while done < seconds - SHORTEST:
                done += self.step(seconds - done, still, done - seconds).dt
        self.start_frames()

    def begin_run(self) -> None:
        """Set the engine up, at the start of the preroll."""
        self.scene = build_scene(self.spec, self.built, self.name, without=self._done.without, apart=frozenset(self._done.apart))
        self.engine = Cloth(self.scene.setup)
        self._let_go = release_time(self.spec, self.name, self._done.without)
        self.motion = CacheMotion(self.surround, self._caches, self.spec.simulation.fps) if self._caches else None
        self._begin_ledger()
        self._begin_tally()

    @property
    def surround(self) -> Surround:
        """The bodies that it meets."""
        return self.scene.surround

    def start_frames(self) -> None:
        """The present state is frame 0: ledgers start here."""
        self._begin_ledger()
        self.restore(self._bytes(), 0)
        self._begin_tally()
        self._finish_frame()

    def _begin_ledger(self) -> None:
        self._ledger: dict[str, Any] = {name: [0.0] * 4 for name in SUMS}

    def max_stable_dt(self) -> float:
        """Longest time of one exchange [s]; the engine's own steps are shorter."""
        return self.engine.stable_dt()

    def still(self) -> BodyState:
        """All bodies at rest at their places of frame 0."""
        return resting(self.surround)

    # ------------------------------------------------------------------ stepping

    def held(self, time: float) -> bool:
        """Whether a release driver or an intervention keeps this cloth where it is at `time` [s]."""
        kept = bool(self._done.held & set(self.instance.members)) and time >= self._done.since - SHORTEST
        return kept or time < self._let_go - SHORTEST

    def step(self, limit: float, bodies: BodyState, time: float) -> ClothReport:
        """One exchange of at most `limit` seconds from `time`, counted into the frame."""
        if self.held(time):
            none = np.zeros((len(self.surround.boundaries), 6))
            left = self._let_go - time
            return ClothReport(min(limit, left) if left > SHORTEST else limit, none, none, 0)
        report = self.engine.step(limit, bodies, time)
        tally, ledger = self._tally, self._ledger
        tally["steps"] += report.steps
        tally["exchanges"] += 1
        tally["time"] += report.dt
        tally["impulse"] += report.impulse
        tally["contacts"] = max(tally["contacts"], report.contacts)
        tally["fastest"] = max(tally["fastest"], report.fastest)
        tally["cut"] += int(report.cut[3])
        solid = np.array([*(-report.contact[:, :3].sum(0)), report.work])
        for name, given in zip(SUMS, (report.air, report.held, np.array([*report.cut[:3], 0.0]), solid), strict=True):
            ledger[name] = [a + float(b) for a, b in zip(ledger[name], given, strict=True)]
        return report

    def begin_frame(self, frame: int) -> None:
        """Start the next frame.

        Raises:
            InputError: not the next frame.
        """
        if frame != self.frame + 1:
            raise InputError(f"advance({frame}) after frame {self.frame}; the next frame is {self.frame + 1}")
        self._begin_tally()

    def _begin_tally(self) -> None:
        self._tally: dict[str, Any] = {
            "steps": 0, "exchanges": 0, "time": 0.0, "contacts": 0, "cut": 0, "fastest": 0.0,
            "impulse": np.zeros((len(self.surround.boundaries), 6)),
        }  # fmt: skip

    def end_frame(self) -> None:
        """The frame that was begun is reached."""
        self.frame += 1
        self._finish_frame()

    def advance(self, frame: int) -> None:
        """Advance from frame - 1 to `frame`, the bodies on their recorded paths.

        Raises:
            InputError: not the next frame.
            EngineError: the cloth's state is not finite.
        """
        self.begin_frame(frame)
        start, end = (frame - 1) * self._frame_time, frame * self._frame_time
        time = start
        while time < end - SHORTEST:
            left = end - time
            count = max(1, int(np.ceil(left / self.max_stable_dt() - 1e-6)))
            bodies = self.still() if self.motion is None else self.motion.state(time, time + left / count)
            time += self.step(left / count, bodies, time).dt
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
            EngineError: the bytes are damaged, or not a checkpoint of this cloth.
        """
        ledger, held = unseal(MAGIC, state, frame, "cloth")
        self.engine.restore(held)
        self._ledger, self.frame = ledger, frame

    # ------------------------------------------------------------------ output

    def _finish_frame(self) -> None:
        x, v = self.engine.vertices()
        if not (np.isfinite(x).all() and np.isfinite(v).all()):
            raise EngineError(f"coordinates of {self.name!r} are not finite at frame {self.frame}; shorten max_step")
        setup, tally, mass = self.scene.setup, self._tally, self.engine.mass
        place = np.cumsum([0, *self.scene.counts])
        own = [x[a:b] for a, b in pairwise(place)]
        ratios = np.concatenate([edge_ratios(s, p) for s, p in zip(setup.sheets, own, strict=True)])
        momentum = mass @ v
        records = {
            "mass": float(mass.sum()),
            "kinetic_energy": 0.5 * float(mass @ (v**2).sum(1)),
            "potential_energy": -float(mass @ (x @ setup.gravity)),
            "stretch_energy": sum(membrane_energy(s, p) for s, p in zip(setup.sheets, own, strict=True)),
            "bending_energy": sum(bending_energy(s, p) for s, p in zip(setup.sheets, own, strict=True)),
            **{f"momentum_{axis}": momentum[k] for k, axis in enumerate("xyz")},
            "max_speed": max(tally["fastest"], float(np.sqrt((v**2).sum(1).max()))),
            "stretch_max": float(ratios.max()) - 1.0,
            "stretch_min": float(ratios.min()) - 1.0,
            "steps": tally["steps"],
            "exchanges": tally["exchanges"],
            "step": tally["time"] / max(tally["steps"], 1),
            "contacts_max": tally["contacts"],
            "cut_vertices": tally["cut"],
        }
        for name in SUMS:
            given = self._ledger[name]
            records |= {f"{name}_impulse_{axis}": given[k] for k, axis in enumerate("xyz")}
            if name != "cut":
                records[f"{name}_work"] = given[3]
        self._data: dict[str, Any] = {
            "vertex/position": x,
            "vertex/velocity": v.astype(np.float32),
            "exchange/impulse": tally["impulse"].copy(),
            **{f"record/{name}": np.float64(value) for name, value in records.items()},
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
            bodies=tuple(self.instance.members),
            colliders=tuple(b.name for b in self.surround.boundaries),
            joints=(),
            drivers=(),
            settings=self.recipe,
            versions={"numpy": np.__version__, "warp-lang": version("warp-lang")},
            deformables=self.scene.deformables,
            vertices=self.scene.counts,
        )

    def ports(self) -> tuple[Port, ...]:
        """Every body gives motion and takes a wrench."""
        names = [b.name.split("/", 1) for b in self.surround.boundaries]
        return tuple(Port(entity, body, "wrench", "out") for entity, body in names)

    def respond(self, port: Port, wrench: F64) -> F64:
        """Bodies are moved by others: no velocity change (6,)."""
        del port, wrench
        return np.zeros(6)
