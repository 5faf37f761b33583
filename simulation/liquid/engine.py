"""Input, step report and particles of a liquid engine: plain arrays, so that engines know nothing of worlds.

World coordinates, SI units, float64 here; an engine may hold float32 relative to an origin of its own. The particle
engine (DFSPH) and the grid engine (FLIP) keep this interface; `solver.py` turns either into a `Solver`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

import numpy as np

from ...physics.waves import Sea
from ...worlds.arrays import F64, I32
from ...worlds.fields import Fields
from ..boundaries import BodyState, Boundary
from ..step_reports import StepReport

__all__ = [
    "Engine",
    "Fluid",
    "Inflow",
    "LiquidReport",
    "LiquidSetup",
    "Outflow",
    "Particles",
    "Stage",
    "WaveZones",
    "by_inflow",
]

SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")
"""Order of the sides of a domain."""


@dataclass(frozen=True)
class Fluid:
    """Properties of one liquid."""

    name: str
    """Entity id."""
    density: float
    """At rest [kg/m^3]."""
    viscosity: float
    """Dynamic, at `temperature` [Pa s]."""
    surface_tension: float = 0.0
    """[N/m]"""
    temperature: float = 293.15
    """Initial [K]."""
    conductivity: float = 0.0
    """Thermal [W/(m K)]; 0: temperature is carried, not conducted."""
    heat_capacity: float = 4186.0
    """[J/(kg K)]"""
    activation: float = 0.0
    """Activation of the viscosity, E/R [K]: viscosity(T) = viscosity exp(activation (1/T - 1/temperature)) (Arrhenius)."""


@dataclass(frozen=True)
class Stage:
    """A level that an inflow or outflow holds, and where it is read [m]."""

    x: float
    y: float
    level: float


@dataclass(frozen=True)
class Inflow:
    """A disc or rectangle that gives liquid along its normal (local +z) during [start, end) seconds."""

    name: str
    fluid: int
    center: F64
    rotation: F64
    """(3, 3), columns are the local axes; +z is the direction of flow."""
    half_size: tuple[float, float]
    """Half width along local x and y [m]; of a disc, its radius twice."""
    round: bool
    speed: float
    """[m/s]; the highest of one that holds a level."""
    start: float = 0.0
    end: float = np.inf
    stage: Stage | None = None
    """It gives only while the surface is lower."""


def by_inflow(names: Iterable[str], values: Iterable[Any], inflows: Sequence[Inflow]) -> list[Any]:
    """Values of a checkpoint, one per name of an inflow, for the inflows that there are now.

    Raises:
        ValueError: an inflow is not in the checkpoint.
    """
    found = dict(zip(map(str, names), values, strict=True))
    missing = [i.name for i in inflows if i.name not in found]
    if missing:
        raise ValueError(f"inflows {missing} are not in a state with {sorted(found)}")
    return [found[i.name] for i in inflows]


@dataclass(frozen=True)
class Outflow:
    """A box inside which liquid is taken away and counted."""

    name: str
    center: F64
    rotation: F64
    half_size: tuple[float, float, float]
    """[m]; negative: it takes nothing."""
    stage: Stage | None = None
    """It takes only while the surface is higher."""


@dataclass(frozen=True)
class WaveZones:
    """Zones along sides of the domain that draw the liquid towards a sea, or towards rest (`zones.py` does it)."""

    name: str
    sea: Sea
    """Its `start` counts from the engine's own."""
    width: float
    """Width of every zone [m]."""
    generate: tuple[bool, bool, bool, bool]
    """-x, +x, -y, +y: whether the zone of that side makes the sea."""
    absorb: tuple[bool, bool, bool, bool]


@dataclass(frozen=True)
class LiquidSetup:
    """Everything that does not change during a run."""

    spacing: float
    """Distance of particles at rest (their diameter), or size of a cell [m]."""
    lower: F64
    """Corner of the domain (3,) [m]."""
    upper: F64
    sides: tuple[Literal["open", "closed"], ...]
    """In the order of SIDES. Liquid that leaves through an open side is counted as outflow `domain`; through a closed one
    none may leave."""
    fluids: tuple[Fluid, ...]
    gravity: F64
    position: F64
    """Initial particles (n, 3) at about `spacing`, inside the declared volume; each stands for mass/density = volume."""
    velocity: F64
    fluid: I32
    """Index into fluids (n,)."""
    volume: F64
    """Volume of each particle (n,) [m^3]; sums to the declared volume."""
    boundaries: tuple[Boundary, ...] = ()
    inflows: tuple[Inflow, ...] = ()
    outflows: tuple[Outflow, ...] = ()
    waves: tuple[WaveZones, ...] = ()
    fields: tuple[Fields, ...] = ()
    """Force fields of each fluid, or none at all."""
    preroll: float = 0.0
    """Time of the engine at which that of the fields begins [s]."""
    scattered: bool = False
    """The particles lie off the points of a lattice already: no engine adds offsets of its own."""
    device: str = "cpu"
    seed: int = 0


@dataclass(frozen=True, kw_only=True)
class LiquidReport(StepReport):
    """One step of a liquid; impulses and reactions sum to zero."""

    added: dict[str, float] = field(default_factory=dict)
    """Mass that entered, by inflow [kg]."""
    removed: dict[str, float] = field(default_factory=dict)
    """Mass that left, by outflow, `domain` for open sides [kg]."""
    iterations: tuple[int, int] = (0, 0)
    """Iterations of the constant-density (or pressure) and the divergence-free solve."""
    capped: int = 0
    """Solves that stopped at their cap of iterations."""
    density_error: tuple[float, float] = (0.0, 0.0)
    """Mean and largest relative compression at the end of the step."""
    driven: F64 = field(default_factory=lambda: np.zeros(4))
    """Momentum [N s] and energy [J] that zones of waves gave to the liquid, (4,)."""
    blown: F64 = field(default_factory=lambda: np.zeros(4))
    """The same from force fields, (4,)."""


@dataclass
class Particles:
    """The liquid at one time. Grid engines give their marker particles."""

    position: F64
    """(n, 3) [m]"""
    velocity: F64
    identity: I32
    """Stays with a particle for life; new ones get new numbers."""
    fluid: I32
    volume: F64
    density: F64
    """(n,) [kg/m^3]; grid engines give the rest density corrected by cell fullness."""
    pressure: F64
    """(n,) [Pa]"""
    temperature: F64
    """(n,) [K]"""


class Engine(Protocol):
    """A running liquid. Two engines with equal bytes and setup continue equally on the same kind of device."""

    def stable_dt(self) -> float:
        """Largest stable step in the present state [s]."""

    def step(self, limit: float, bodies: BodyState) -> LiquidReport:
        """One step of at most `limit` seconds, with bodies as they are at its start; the steps to `limit` are about equal."""

    def particles(self) -> Particles:
        """Copies of the present state."""

    def checkpoint(self) -> bytes:
        """The full state; the engine itself continues from exactly these bytes."""

    def restore(self, state: bytes) -> None:
        """Continue from a checkpoint."""
