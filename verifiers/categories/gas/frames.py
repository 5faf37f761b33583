"""A gas on its cells as its cache holds it, checked as it is read (R60)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....physics.gases import mass_extinction
from ....physics.substances import AIR_HEAT_CAPACITY, air_density
from ....worlds.arrays import F64
from ....worlds.categories.gas.carrying import unmet
from ....worlds.categories.gas.facts import fuel_of, grid_of
from ....worlds.errors import EvidenceError, NotFiniteError
from ....worlds.instances import felt_by
from ...rows.findings import cache_of
from .bodies import Bodies
from .boils import Boils, boils_of
from .bounds import EVEN
from .cells import Fields, FireCells, GasFrame, Grid
from .combustion import Combustion
from .kindled import KindledSurfaces, surfaces_of_box
from .sources import Source, sources_of

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate

__all__ = ["GasBox", "box_of"]

FIRE = {"gas_fuel": 0, "gas_product": 0, "gas_released": 0, "gas_radiated": 0}
CHANNELS = {"gas_soot": 0, "gas_temperature": 0, "gas_room": 0, "gas_velocity": 3}
"""Fields, and the components of each value; 0: a number."""
KEPT_CELLS = 8_000_000
"""Cells of frames that are kept, since predicates ask again."""


class GasBox:
    """The cells of an instance over the frames.

    Raises:
        EvidenceError: the cache is of another plan.
    """

    def __init__(self, candidate: Candidate, solver: str, cache: Cache) -> None:
        self.candidate, self.solver, self.cache = candidate, solver, cache
        plan: Any = candidate.spec.simulation.solvers[solver]
        self.settings: Any = plan.settings
        self.members: list[str] = list(plan.members)
        self.frames = candidate.frame_count
        self.duration = 1.0 / candidate.spec.simulation.fps
        self.follows = bool(self.settings.follows)
        """True where only a part of its box that follows it was solved."""
        self.gravity: F64 = np.array(candidate.spec.simulation.gravity, dtype=np.float64)
        self.sides: tuple[str, ...] = tuple(self.settings.domain.sides)
        self.cell = float(self.physics(self.members[0]).resolution)
        grid = grid_of(plan, self.cell)
        self.shape = grid.shape
        self.size: F64 = self.cell * np.array(grid.shape)
        """Size of the cells' box [m]."""
        self.ambient = float(self.settings.ambient_temperature)
        material = candidate.spec.materials[candidate.spec.entities[self.members[0]].material]
        self.extinction = mass_extinction(material.substance)
        """Light that what it carries takes out of a ray, per mass [m^2/kg]."""
        self.expands = bool(self.settings.expands)
        self.air = air_density(self.ambient)
        """Density of the ambient air [kg/m^3]."""
        own = self.physics(self.members[0])
        fuel = fuel_of(own)
        self.combustion = None if fuel is None else Combustion(fuel, own.fuel_share, own.temperature, self.ambient, self.air)
        """Fuel that the gas may burn, with its source and air; None where nothing burns."""
        self.last_reach: Any = None
        """Reach of cells between the last two frames asked for."""
        self.fields = Fields()
        self._grid: Grid | None = None
        """Places of the cells of the last frame that was read."""
        self._kept: dict[int, GasFrame] = {}
        self._room = KEPT_CELLS

    def physics(self, member: str) -> Any:
        """Physics of a member."""
        return self.candidate.spec.entities[member].physics

    @cached_property
    def sources(self) -> tuple[Source, ...]:
        """Shapes and drivers that let gas out."""
        return sources_of(self.candidate, self.members)

    @cached_property
    def surfaces(self) -> KindledSurfaces | None:
        """Surfaces of solids that may burn; None where there are none."""
        return surfaces_of_box(self.candidate, self.solver, self.cache, self.frames)

    @property
    def boils(self) -> Boils | None:
        """Steam that is made in it where hot matter meets water; None where nothing does."""
        return boils_of(self.candidate, self.solver)

    @cached_property
    def bodies(self) -> Bodies:
        """The bodies among the cells, but for those that it carries."""
        corners = np.array([self.read(k).corner for k in range(self.frames)])
        return Bodies(
            self.candidate,
            self.frames,
            corners.min(axis=0) - self.cell,
            corners.max(axis=0) + self.size + self.cell,
            unmet(self.candidate.spec, self.solver),
        )

    @property
    def carries(self) -> str:
        """Word for `tracer`."""
        return "soot" if self.combustion is None else "fuel, burnt or not,"

    @property
    def volume(self) -> float:
        """Volume of a cell [m^3]."""
        return float(self.cell**3)

    @property
    def joule(self) -> float:
        """Heat of a cubic metre of lightness 1 [J/m^3]: density, heat capacity and temperature of the ambient air."""
        return self.air * AIR_HEAT_CAPACITY * self.ambient

    @property
    def heats(self) -> bool:
        """True where gas comes warmer or colder than the air about, or burns; else its heat is rounding."""
        return self.combustion is not None or any(self.physics(m).temperature != self.ambient for m in self.members)

    @property
    def even_heat(self) -> float:
        """Heat that warms all its air by `EVEN` [J]: the scale of heat where nothing comes warm or cold."""
        return EVEN * self.joule / self.ambient * float(np.prod(self.size))

    @property
    def up(self) -> F64:
        """Unit vector against gravity; +z where there is none."""
        size = float(np.linalg.norm(self.gravity))
        return -self.gravity / size if size > 1e-9 else np.array([0.0, 0.0, 1.0])

    def lightness_at(self, temperature: Any) -> Any:
        """Lightness of gas at a temperature [1]: share of the ambient density that it lacks, or its excess temperature over the ambient one."""
        return 1.0 - self.ambient / temperature if self.expands else temperature / self.ambient - 1.0

    def lightness(self, frame: GasFrame) -> F64:
        """Values of all cells, in double precision; 0 where a cell has no room."""
        return self.fields.of(frame, "lightness", lambda: self._lightness(frame))

    def _lightness(self, frame: GasFrame) -> F64:
        # As frames hold it, or its rounding would count as heat in every cell.
        ambient, known = float(np.float32(self.ambient)), np.maximum(frame.temperature.astype(np.float64), 1e-3)
        return np.where(frame.open, 1.0 - ambient / known if self.expands else known / ambient - 1.0, 0.0)

    def soot_mass(self, frame: GasFrame) -> float:
        """Soot in the box [kg]."""
        return self.volume * float(np.sum(frame.soot * frame.room, dtype=np.float64))

    def heat(self, frame: GasFrame) -> float:
        """Enthalpy above that of ambient air in the box [J]."""
        return self.joule * self.volume * float(np.sum(self.lightness(frame) * frame.room))

    def tracer(self, frame: GasFrame) -> F64:
        """Amount that flow alone moves [kg/m^3]: soot, or fuel burnt or not."""
        return self.fields.of(frame, "tracer", lambda: self._tracer(frame))

    def _tracer(self, frame: GasFrame) -> F64:
        if self.combustion is None or frame.fire is None:
            return frame.soot.astype(np.float64)
        return self.combustion.atoms(frame.fire)

    def concentration(self, frame: GasFrame) -> F64:
        """Amount that neither flow nor burning raises: soot [kg/m^3], or the mass of fuel, burnt or not, in a mass of gas."""
        if self.combustion is None:
            return self.tracer(frame)
        return self.fields.of(frame, "concentration", lambda: np.where(frame.open, self.tracer(frame) / self.density(frame), 0.0))

    def source_tracer(self, member: str) -> float:
        """`tracer` of what a source lets out [kg/m^3]."""
        physics = self.physics(member)
        if self.combustion is None:
            return float(physics.soot_density)
        return self.combustion.share * self.air * (1.0 - float(self.lightness_at(physics.temperature)))

    def source_concentration(self, member: str) -> float:
        """`concentration` of what a source lets out."""
        return float(self.physics(member).soot_density) if self.combustion is None else self.combustion.share

    def dark(self, member: str) -> float:
        """Soot of a source [kg/m^3], and of a fire what burning adds at most."""
        return float(self.physics(member).soot_density) + (0.0 if self.combustion is None else self.combustion.sootiest)

    def heating(self, frame: GasFrame) -> F64:
        """Heat that fire gives to the gas, less what is radiated [W/m^3]."""
        fire = frame.fire
        if fire is None:
            return np.zeros(self.shape)
        return self.fields.of(frame, "heating", lambda: fire.released.astype(np.float64) - fire.radiated.astype(np.float64))

    def burnt(self, name: str) -> F64:
        """Record of a fire over the frames, shape (frames,); 0 of a gas without fuel."""
        return np.zeros(self.frames) if self.combustion is None else self.record(name)

    def escaped_tracer(self) -> F64:
        """`tracer` that is recorded to have left through open sides since frame 0 [kg], shape (frames,)."""
        if self.combustion is None:
            return self.record("escaped_soot")
        return self.record("escaped_fuel") + self.record("escaped_product") / self.combustion.product

    def density(self, frame: GasFrame) -> F64:
        """Density of the gas that moves [kg/m^3]."""
        if not self.expands:
            return np.full(frame.soot.shape, self.air)
        return self.fields.of(frame, "density", lambda: self.air * (1.0 - self.lightness(frame)))

    def velocity(self, frame: GasFrame) -> F64:
        """At the middles of cells, in double precision [m/s], shape (nx, ny, nz, 3)."""
        return self.fields.of(frame, "velocity", lambda: frame.velocity.astype(np.float64))

    def read(self, index: int) -> GasFrame:
        """One frame.

        Raises:
            EvidenceError: it is missing or damaged, or its channels do not belong together.
        """
        if index not in self._kept:
            frame = self._read(index)
            self._room -= frame.soot.size
            if self._room < 0:
                return frame
            self._kept[index] = frame
        return self._kept[index]

    def _read(self, index: int) -> GasFrame:
        fields = CHANNELS if self.combustion is None else {**CHANNELS, **FIRE}
        data = self.cache.seen(index, ("gas_corner", *(("gas_active",) if self.follows else ()), *fields))
        for name, width in fields.items():
            wanted = (*self.shape, width) if width else self.shape
            if data[name].shape != wanted:
                raise EvidenceError(
                    f"{name} of frame {index} of {self.solver!r} has shape {data[name].shape}, planned {wanted}; bake again"
                )
            if not np.isfinite(data[name]).all():
                raise NotFiniteError(f"{name} is not finite at frame {index}; see numerical:finite")
        fire = None if self.combustion is None else FireCells(*(data[n] for n in FIRE))
        corner = np.asarray(data["gas_corner"], dtype=np.float64)
        soot, temperature, velocity, room = (data[n] for n in ("gas_soot", "gas_temperature", "gas_velocity", "gas_room"))
        part = self._part(index, data)
        return GasFrame(
            index, self.cell, corner, soot, temperature, velocity, room, fire, part, self._places(corner), self.fields
        )

    def _places(self, corner: F64) -> Grid:
        """Places of the cells of a box at a corner."""
        if self._grid is None or not bool((self._grid.corner == corner).all()):
            self._grid = Grid(corner, self.cell, self.shape)
        return self._grid

    def _part(self, index: int, data: Mapping[str, Any]) -> NDArray[np.int32] | None:
        """The part of the box that a frame tells was solved; None of all of it."""
        if not self.follows:
            return None
        part = np.asarray(data["gas_active"])
        if not ((part[0] >= 0) & (part[0] < part[1]) & (part[1] <= np.array(self.shape))).all():
            raise EvidenceError(
                f"gas_active of frame {index} of {self.solver!r} is {part.tolist()}, planned is a part of 0 to {list(self.shape)}; bake again"
            )
        return part

    def steps(self) -> Iterator[tuple[GasFrame, GasFrame | None]]:
        """All frames in order, each with the one before."""
        before: GasFrame | None = None
        for index in range(self.frames):
            now = self.read(index)
            yield now, before
            before = now

    def returned(self, index: int) -> F64 | None:
        """Momentum that each cell took over the interval before a frame from what it carries and feels [N s], (nx, ny, nz, 3); None of a gas
        that feels nothing.

        Raises:
            EvidenceError: it is missing, or has another shape.
        """
        if not felt_by(self.candidate.spec, self.solver):
            return None
        found = np.asarray(self.cache.seen(index, ("gas_returned",))["gas_returned"], dtype=np.float64)
        if found.shape != (*self.shape, 3):
            raise EvidenceError(
                f"gas_returned of frame {index} of {self.solver!r} has shape {found.shape}, planned {(*self.shape, 3)}; bake again"
            )
        return found * self.volume

    def record(self, name: str) -> F64:
        """A record over the frames, shape (frames,).

        Raises:
            EvidenceError: it is missing, or not finite.
        """
        found = np.asarray(self.cache.series(f"record/{name}"), dtype=np.float64)[: self.frames]
        if not np.isfinite(found).all():
            raise NotFiniteError(
                f"record/{name} is not finite at frame {int(np.argmin(np.isfinite(found)))}; see numerical:finite"
            )
        return found


def box_of(candidate: Candidate, solver: str) -> GasBox:
    """The cells of an instance, made once per candidate.

    Raises:
        EvidenceError: it has no cache, or one of another specification.
    """
    return candidate.memo(("gas", solver), lambda: GasBox(candidate, solver, cache_of(candidate, solver)))
