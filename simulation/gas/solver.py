"""A gas instance as a `Solver`: its box among bodies, what its drivers make, and what its frames hold."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...physics.substances import AIR_HEAT_CAPACITY
from ...worlds.arrays import F64
from ...worlds.categories.gas.carrying import carries, without_carried
from ...worlds.categories.gas.facts import (
    SOURCE_SHARE,
    dusts_of,
    emissions_of,
    fuel_of,
    gas_of,
    grid_of,
    ignitions_of,
    lit,
)
from ...worlds.categories.gas.steam_facts import steams_of
from ...worlds.categories.loose import domain_box
from ...worlds.errors import InputError
from ...worlds.fields import fields_of
from ...worlds.instances import felt_by, soft_met
from ..boundaries import BodyState, Surround, surround_of
from ..coupled_solver import CoupledSolver, motion_records
from ..recipes import coupled_recipe, reader_recipe
from ..sealed import from_bytes, to_bytes
from ..step_reports import StepReport
from .active import ActiveGas, gas_in
from .coming import Coming
from .engine import FUEL, LIGHTNESS, PRODUCT, SOOT, Gas
from .kindling import pieces_of
from .live import LiveGas
from .obstacles import Obstacles
from .reaction import YieldingGas
from .settings import GasSettings
from .solids import corners_of
from .source import cover, share_of
from .surfaces import SURFACE_SUMS, Surfaces

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...worlds.built import BuiltEntity
    from ...worlds.cache import Cache
    from ...worlds.spec import EmissionDriver, WorldSpec
    from .solids import Solids

__all__ = ["SolverGas"]

REACH = 2.0
"""Solids up to so many cells outside its box stand in a gas's way."""
VOLUME = 4
"""Place of the volume in what a border counts, after the four amounts."""


FIRE_SUMS = (
    "emitted_fuel",
    "escaped_fuel",
    "escaped_product",
    "burnt_fuel",
    "released_heat",
    "made_soot",
)
"""Sums of a gas that burns."""
FOLLOWING_SUMS = ("slipped_heat", "slipped_soot")
"""Sums of a gas that an active box follows."""


class SolverGas(CoupledSolver):
    """One gas in its box."""

    KIND = "gas"
    REMEDY = "shorten max_step or lower courant"

    @staticmethod
    def recipe_alone(spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, caches: Mapping[str, Cache]) -> str:
        """Recipe of a gas, which reads the bodies' motion: only what reaches its domain, unless it may burn or carries others, or what comes in it goes by other caches."""
        found = gas_of(spec, name)
        if found is None or found[2].fuel is not None or dusts_of(spec, name) or steams_of(spec, name) or carries(spec, name):
            return coupled_recipe(spec, built)
        return reader_recipe(spec, built, name, caches, margin=REACH * found[2].resolution, rough=True)

    @property
    def surround(self) -> Surround:
        """The bodies that stand in its way."""
        return self._surround

    def set_up(self) -> None:
        """Air at rest in the box, and the source."""
        spec, instance = self.spec, self.instance
        found = gas_of(spec, self.name)
        if found is None:
            raise InputError(
                f"{self.members[0]!r} is no gas; make it one, or take it out of /simulation/solvers/{self.name}/members"
            )
        member, entity, self.physics = found
        self.grid = grid_of(instance, self.physics.resolution)
        middles = corners_of(self.grid.shape, self.grid.cell, self.grid.corner)[:-1, :-1, :-1] + 0.5 * self.grid.cell
        self._middles = middles.reshape(-1, 3)
        self._surround = surround_of(
            without_carried(spec, self.name),
            self.built,
            domain_box(instance),
            REACH * self.grid.cell,
            soft=soft_met(spec, self.name),
        )
        self.obstacles = Obstacles(self._surround, self.grid)
        settings = instance.settings
        self.fuel = fuel_of(self.physics)
        known = {n: getattr(settings, n) for n in GasSettings.__dataclass_fields__ if hasattr(settings, n)}
        self._covered = cover(entity, self.built[member], self.grid)
        self.engine = gas_in(
            self.grid.shape, self.grid.cell, settings.domain.sides, GasSettings(**known, fuel=self.fuel), settings.follows,
            self._covered > 0.0, feels=bool(felt_by(spec, self.name)), gravity=spec.simulation.gravity, solids=self.obstacles.start, moves=self.obstacles.moves, device=settings.device,
        )  # fmt: skip
        ambient = settings.ambient_temperature
        light = 1.0 - ambient / self.physics.temperature if settings.expands else self.physics.temperature / ambient - 1.0
        burns = 0.0 if self.fuel is None else self.physics.fuel_share * self.engine.density * (1.0 - light)
        self.content = np.array([light, self.physics.soot_density, burns, 0.0])
        self.unit = np.array([self.engine.density * AIR_HEAT_CAPACITY * ambient, 1.0])
        """Heat of a unit of lightness and soot of a unit of soot, per volume."""
        self.emissions = {k: d for k, d in emissions_of(spec, self.name).items() if k not in self._done.without}
        self.coming = Coming(spec, self.name, self.built, self._caches or {}, self.grid, self._done.without)
        self.ignitions = {k: d for k, d in ignitions_of(spec, self.name).items() if k not in self._done.without}
        self._lit = {k: lit(d, middles) for k, d in self.ignitions.items()}
        self._sparks: tuple[str, ...] = ()
        self.fields = fields_of(spec, member, self._done.without)
        self._last_room = self.obstacles.start.room
        self._outer = self.grid.corner + self.grid.cell * self.engine.outer
        self.wind = 0.0
        """Speed of the fastest air beyond the sides, along an axis [m/s]."""
        if self.fields and "open" in settings.domain.sides and isinstance(self.engine, Gas):
            self._start_wind(self.engine)
        self._fill(self.engine.room)
        pieces = pieces_of(spec, self.name, self.built, self.grid, self._surround)
        self.surfaces = None if pieces is None else Surfaces(pieces, self.grid, self.engine.room, ambient)
        """Surfaces of solids and cloth that may burn."""
        if not self.share.any():
            raise InputError(
                f"the source {member!r} lies in solids, or in no cell of its box; move it with /entities/{member}/pose, or make its parts larger"
            )

    def _blow(self, time: float) -> None:
        """Let the air beyond the sides move as it does at a time; before frame 0, as it does then."""
        speeds = self.fields.medium(self._outer, max(time, 0.0)).velocity
        self.wind = float(np.abs(speeds).max(initial=0.0))
        self.engine.blow(speeds)

    def _start_wind(self, engine: Gas) -> None:
        """Wind that blows at frame 0 flows around the bodies then, as a flow without eddies."""
        self._blow(0.0)
        if self.wind == 0.0:
            return
        lower = corners_of(self.grid.shape, self.grid.cell, self.grid.corner)
        speeds = np.zeros(lower.shape, np.float32)
        for axis in range(3):
            middles = lower + 0.5 * self.grid.cell * (np.arange(3) != axis)
            speeds[..., axis] = self.fields.medium(middles.reshape(-1, 3), 0.0).velocity[:, axis].reshape(lower.shape[:3])
        engine.velocity = speeds
        engine.solve(engine.settings.tolerance * self.wind, engine.settings.iterations)

    # ------------------------------------------------------------------ steps

    def live(self) -> LiveGas:
        """It as what it carries meets it at present."""
        return LiveGas(self)

    def max_stable_dt(self) -> float:
        """Longest step now [s]; an emission that is about to start counts."""
        longest = min(self.engine.longest(), float(self.instance.settings.max_step))
        if self.wind > 0.0:
            longest = min(longest, self.engine.settings.courant * self.grid.cell / self.wind)
        most = sum(d.rate for d in self.emissions.values()) * float(self.share.max())
        most += self.coming.strongest(self.frame + 1, self._making)
        return min(longest, SOURCE_SHARE / most) if most > 0.0 else longest

    def step(self, limit: float, bodies: BodyState, time: float) -> StepReport:
        """One step of `limit` seconds from `time`, counted into the frame."""
        if self.held(time):
            return StepReport.still(limit, self.surround)
        if self.fields:
            self._blow(time + 0.5 * limit)
        self._ignite(time + 0.5 * limit)
        solids = self._move(bodies, limit)
        if self.surfaces is not None:
            self.surfaces.place(bodies, 0.0, self._making)
        made, volume = self._make(time, limit)
        self._feed(made, limit)
        report = self.engine.step(limit, solids)
        if self.surfaces is not None:
            self.surfaces.place(bodies, limit, self.engine.room)
        tally, ledger, cell = self._tally, self._ledger, self.grid.cell**3
        tally["steps"] += 1
        tally["time"] += limit
        tally["iterations"] = max(tally["iterations"], report.iterations)
        tally["divergence"] = max(tally["divergence"], report.divergence)
        tally["capped"] += int(report.capped)
        tally["speed"] = max(tally["speed"], report.courant * self.grid.cell / limit)
        out = self.engine.take() * cell
        ledger["emitted_heat"] += volume * float(self.content[LIGHTNESS]) * float(self.unit[0])
        ledger["emitted_soot"] += volume * float(self.content[SOOT])
        ledger["escaped_heat"] += float(out[LIGHTNESS]) * float(self.unit[0])
        ledger["escaped_soot"] += float(out[SOOT])
        ledger["volume_emitted"] += volume
        ledger["volume_escaped"] += float(out[VOLUME])
        if isinstance(self.engine, ActiveGas):
            slipped = self.engine.slipped() * cell
            ledger["slipped_heat"] += float(slipped[LIGHTNESS]) * float(self.unit[0])
            ledger["slipped_soot"] += float(slipped[SOOT])
        if self.engine.fire is not None and self.fuel is not None:
            released, radiated = self.engine.fire.last
            ledger["emitted_fuel"] += volume * float(self.content[FUEL])
            ledger["escaped_fuel"] += float(out[FUEL])
            ledger["escaped_product"] += float(out[PRODUCT])
            ledger["burnt_fuel"] += released / self.fuel.heat
            ledger["released_heat"] += released
            ledger["made_soot"] += self.fuel.soot * released / self.fuel.heat
            ledger["lost_heat"] += radiated
        return StepReport.still(limit, self.surround)

    def _make(self, time: float, seconds: float) -> tuple[F64, float]:
        """Gas that drivers make per volume and second in a step [1/s], (nx, ny, nz), and their sum over the step [m^3]."""
        end = time + seconds
        volume = sum(_made(d, time, end) for d in self.emissions.values()) if self.share.any() else 0.0
        rate = self.share * (volume / seconds)
        volume += self.coming.add(rate, self.frame + 1, (time, end), self._making)
        return rate, volume

    def _feed(self, made: F64, seconds: float) -> None:
        """Let in what drivers make [1/s] and what surfaces give off in a step, and take the heat that these get."""
        if self.surfaces is None:
            self.engine.emit(made, self.content.tolist())
            return
        given = self.surfaces.step(seconds, self.engine.temperature)
        open_to = np.where(self.engine.room > 0.0, self.engine.room, 1.0) * self.grid.cell**3 * seconds
        rates = (made, given.volume / open_to)
        density = given.gas / np.where(given.volume > 0.0, given.volume, 1.0)
        own = np.zeros((*self.grid.shape, 4))
        own[..., LIGHTNESS], own[..., FUEL] = 1.0 - density / self.engine.density, density
        both = rates[0] + rates[1]
        mixed = (rates[0][..., None] * self.content + rates[1][..., None] * own) / np.where(both > 0.0, both, 1.0)[..., None]
        self.engine.emit(both, mixed)
        self.engine.heat(-given.taken / open_to / float(self.unit[0]))
        ledger, size = self._ledger, float(given.volume.sum())
        ledger["volume_emitted"] += size
        ledger["emitted_heat"] += (size - given.mass / self.engine.density) * float(self.unit[0])
        ledger["emitted_fuel"] += given.mass
        ledger["lost_heat"] += given.heat
        ledger["gasified_fuel"] += given.mass
        ledger["taken_heat"] += given.heat
        ledger["taken_light"] += given.light

    def _ignite(self, time: float) -> None:
        """Light where ignitions do at a time."""
        now = tuple(k for k, d in self.ignitions.items() if d.start <= time and (d.end is None or time < d.end))
        if now != self._sparks:
            self._sparks = now
            self.engine.ignite(np.any([self._lit[k] for k in now], axis=0) if now else np.zeros(self.grid.shape))

    def _move(self, bodies: BodyState, seconds: float) -> Solids | None:
        """Where the bodies are after a step, if any moves; gas is then made in cells alone whose room stays."""
        if not self.obstacles.moves:
            return None
        before = self.engine.room
        if not (bodies.velocity.any() or bodies.angular_velocity.any()):
            self._fill(before)
            return None
        solids = self.obstacles.at(bodies, seconds)
        stays = self._last_room == solids.room
        self._last_room = solids.room
        self._fill(np.where(stays[:-1, :-1, :-1], before, 0.0))
        return solids

    def _fill(self, room: NDArray[np.float32]) -> None:
        """Let gas be made in cells by their open share, (nx, ny, nz)."""
        self._making = room
        self.share = share_of(self._covered, room, self.grid.cell)

    def start_frames(self) -> None:
        """Frame 0, with what burns where its caches have it then."""
        if self.surfaces is not None:
            bodies = self.still() if self.motion is None else self.motion.state(0.0, 0.0)
            self.surfaces.place(bodies, 0.0, self.engine.room)
        super().start_frames()

    def open_ledger(self) -> dict[str, Any]:
        """Sums since frame 0."""
        sums = ("emitted_soot", "escaped_soot", "emitted_heat", "escaped_heat", "lost_heat", "volume_emitted", "volume_escaped")
        fire = FIRE_SUMS if self.fuel is not None else ()
        following = FOLLOWING_SUMS if self.instance.settings.follows else ()
        return dict.fromkeys((*sums, *following, *fire, *(SURFACE_SUMS if self.surfaces is not None else ())), 0.0)

    def open_tally(self) -> dict[str, Any]:
        """Sums of a frame."""
        if isinstance(self.engine, YieldingGas):
            self.engine.begin()
        return {"steps": 0, "time": 0.0, "iterations": 0, "divergence": 0.0, "capped": 0, "speed": 0.0}

    # ------------------------------------------------------------------ state

    def pack(self) -> bytes:
        """State of the engine."""
        own = {"wind": np.float64(self.wind), "last_room": self._last_room}
        surfaces = {} if self.surfaces is None else self.surfaces.pack()
        return to_bytes({**self.engine.pack(), **surfaces, **own})

    def unpack(self, state: bytes) -> None:
        """Continue from such a state."""
        more = () if self.surfaces is None else tuple(self.surfaces.pack())
        found = from_bytes(state, (*self.engine.packed, *more, "wind", "last_room"))
        self.engine.unpack(found)
        if self.surfaces is not None:
            self.surfaces.unpack(found)
        self.wind, self._last_room = float(found["wind"]), found["last_room"]
        self._fill(self.engine.room)

    # ------------------------------------------------------------------ output

    def coordinates(self) -> tuple[F64, F64]:
        """Amounts of cells and speeds of faces."""
        return self.engine.state.astype(np.float64), self.engine.velocity.astype(np.float64)

    def measured(self) -> dict[str, Any]:
        """Channels and records of the frame that ends."""
        engine, tally = self.engine, self._tally
        state, velocity = engine.state, engine.velocity
        light = state[..., LIGHTNESS].astype(np.float64)
        heat, soot = engine.totals()[[LIGHTNESS, SOOT]] * self.unit * self.grid.cell**3
        density = engine.density * (1.0 - light) + state[..., SOOT]
        volume, speed = (engine.room * self.grid.cell**3).astype(np.float64).ravel(), _centred(velocity)
        active: dict[str, Any] = engine.measured() if isinstance(engine, YieldingGas) else {}
        if isinstance(engine, ActiveGas):
            active, speed = {"gas_active": np.array(engine.window, np.int32)}, engine.only(speed)
        gravity = np.array(self.spec.simulation.gravity)
        moved = motion_records(density.ravel() * volume, self._middles, speed.reshape(-1, 3).astype(np.float64), gravity)
        heavier = (density.ravel() - engine.density) * volume
        records = {
            **moved,
            **self._ledger,
            "potential_energy": -float(heavier @ (self._middles @ gravity)),
            "soot_mass": soot,
            "heat": heat,
            "divergence": tally["divergence"],
            "max_speed": tally["speed"],
            "steps": tally["steps"],
            "step": tally["time"] / max(tally["steps"], 1),
            "iterations": tally["iterations"],
            "capped": tally["capped"],
        }
        burning = {} if self.fuel is None else self._burning(state)
        return {
            **active,
            **burning,
            **self.coming.measured(self.frame),
            "gas_corner": self.grid.corner,
            "gas_soot": state[..., SOOT].copy(),
            "gas_temperature": engine.temperature.astype(np.float32),
            "gas_velocity": speed,
            "gas_room": engine.room.copy(),
            **{f"record/{name}": np.float64(value) for name, value in records.items()},
        }

    def _burning(self, state: NDArray[np.float32]) -> dict[str, Any]:
        """Channels and records of the fire at the end of a frame."""
        released, radiated = np.moveaxis(self.engine.power, -1, 0)
        fuel = float(self.engine.totals()[FUEL]) * self.grid.cell**3
        if self.surfaces is not None:
            # For the next frame: checkpoints hold it, and not the power.
            self.surfaces.shine(radiated * self.engine.room * self.grid.cell**3)
        return {
            **({} if self.surfaces is None else self.surfaces.measured()),
            "gas_fuel": state[..., FUEL].copy(),
            "gas_product": state[..., PRODUCT].copy(),
            "gas_released": released.copy(),
            "gas_radiated": radiated.copy(),
            "record/fuel_mass": np.float64(fuel),
        }

    def driver_names(self) -> tuple[str, ...]:
        """Its emissions, ignitions and what raises dust or makes steam."""
        return (*self.emissions, *self.ignitions, *self.coming.drivers)


def _made(driver: EmissionDriver, start: float, end: float) -> float:
    """Volume that an emission makes between two times [m^3]."""
    last = end if driver.end is None else min(end, driver.end)
    return driver.rate * max(0.0, last - max(start, driver.start))


def _centred(velocity: Any) -> Any:
    """Velocities at the middle of cells (nx, ny, nz, 3), from those of faces."""
    inner = velocity[:-1, :-1, :-1]
    ahead = np.stack([velocity[1:, :-1, :-1, 0], velocity[:-1, 1:, :-1, 1], velocity[:-1, :-1, 1:, 2]], axis=-1)
    return (0.5 * (inner + ahead)).astype(np.float32)
