"""Liquids in the simulation plan: engines and their settings, the domain, what lets liquid in and out, what makes waves (R57, R58)."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from ...matter import DriverBase, Instance, Matter, MatterShape, TimedDriver
from ...shapes import Pose
from ...vocabulary import EntityRef, Finite, Id, NonNegative, Positive, SpecModel, Vec3
from ..domains import SidedDomain

__all__ = [
    "Current",
    "DfsphInstance",
    "DfsphSettings",
    "FlipInstance",
    "FlipSettings",
    "InflowDriver",
    "LiquidPhysics",
    "OutflowDriver",
    "WaveSide",
    "WavesDriver",
]

WaveSide = Literal["-x", "+x", "-y", "+y"]


class _LiquidSettings(SpecModel):
    domain: SidedDomain
    max_step: float = Field(default=5e-3, ge=1e-5, le=0.05, description="longest step [s]")
    wall_friction: float = Field(
        default=0.0, ge=0, le=1, description="viscosity felt at walls: 0 free slip, 1 that of the liquid"
    )
    iterations: int = Field(default=100, ge=2, le=1000, description="most iterations of a pressure solve")
    device: Literal["cpu", "cuda"] = "cpu"


class DfsphSettings(_LiquidSettings):
    """Settings of a particle liquid (divergence-free smoothed particle hydrodynamics)."""

    cfl: float = Field(default=0.4, ge=0.05, le=1.0, description="largest travel per step in spacings")
    density_error: float = Field(default=1e-4, ge=1e-6, le=0.01, description="mean compression at which the density solve ends")
    divergence_error: float = Field(
        default=1e-3, ge=1e-6, le=0.1, description="mean rate of compression times step at which the divergence solve ends"
    )
    viscosity_error: float = Field(
        default=1e-2, ge=1e-6, le=0.1, description="relative residual at which the implicit viscosity solve ends"
    )


class FlipSettings(_LiquidSettings):
    """Settings of a liquid on a grid with marker particles (FLIP or APIC), for large extents."""

    transfer: Literal["flip", "apic"] = Field(
        default="flip", description="how velocities pass between particles and grid; apic is calmer and keeps angular momentum"
    )
    flip_ratio: float = Field(default=0.97, ge=0, le=1, description="with transfer flip: share of FLIP, the rest is PIC")
    cfl: float = Field(default=3.0, ge=0.1, le=4.0, description="largest travel per step in cells")
    max_step: float = Field(default=1 / 24, ge=1e-5, le=0.1, description="longest step [s]")
    particles_per_cell: Literal[8, 27] = 8
    volume_correction: float = Field(
        default=0.5, ge=0, le=1, description="share of compression that is undone in each step; 0: none"
    )
    pressure_error: float = Field(
        default=1e-3, ge=1e-6, le=0.1, description="largest relative change of volume of a cell that one step may leave"
    )
    roughness: float = Field(
        default=0.0,
        ge=0,
        le=10,
        description="roughness length of beds and walls [m], for friction; 0: they slip freely, 2e-6: smooth",
    )


class DfsphInstance(Instance):
    """A running particle liquid and the liquid entities that it moves.

    Rigid entities of other instances are its boundaries where they reach into the domain.
    """

    moves: ClassVar[tuple[str, ...]] = ("liquid",)
    meets: ClassVar[tuple[str, ...]] = ("elastic", "cloth")
    engine: Literal["dfsph"] = "dfsph"
    members: Annotated[list[EntityRef], Field(min_length=1, max_length=16)]
    settings: DfsphSettings


class FlipInstance(Instance):
    """A running grid liquid and the liquid entities that it moves."""

    moves: ClassVar[tuple[str, ...]] = ("liquid",)
    engine: Literal["flip"] = "flip"
    members: Annotated[list[EntityRef], Field(min_length=1, max_length=16)]
    settings: FlipSettings


class InflowDriver(TimedDriver):
    """Lets liquid in through a disc or rectangle, along its local +z, during [start, end) seconds."""

    later: ClassVar[frozenset[str]] = frozenset({"start", "end"})  # its speed bounds the steps of a grid
    kind: Literal["inflow"] = "inflow"
    entity: EntityRef = Field(description="the liquid")
    pose: Pose = Field(default=Pose(), description="of the opening in the world; liquid leaves along its +z")
    size: tuple[Positive, Positive] = Field(description="full extents of the opening along its x and y [m]")
    round: bool = Field(default=False, description="a disc (an ellipse) of this size")
    speed: Positive | None = Field(default=None, description="[m/s]; give speed or rate. With a level: at most")
    rate: Positive | None = Field(default=None, description="[m^3/s]")
    start: NonNegative = 0.0
    end: Positive | None = Field(default=None, description="[s]; default: to the end")
    level: Finite | None = Field(
        default=None,
        description="world z [m] at which it holds the surface: it gives what that takes, at most speed or rate, and nothing while it is a cell higher; engine flip",
    )
    gauge: tuple[Finite, Finite] | None = Field(
        default=None, description="x, y where the surface is read [m]; default: the middle of the opening"
    )

    @model_validator(mode="after")
    def _one_speed(self) -> InflowDriver:
        if (self.speed is None) == (self.rate is None):
            raise ValueError("give either speed or rate")
        return self

    @property
    def area(self) -> float:
        """Area of the opening [m^2]."""
        return self.size[0] * self.size[1] * (0.7853981633974483 if self.round else 1.0)

    @property
    def flow_speed(self) -> float:
        """Speed through the opening [m/s]; with a level, the highest."""
        return self.speed if self.speed is not None else float(self.rate or 0.0) / self.area


class OutflowDriver(DriverBase):
    """Takes liquid away that comes into a box, and counts it."""

    kind: Literal["outflow"] = "outflow"
    entity: EntityRef = Field(description="the liquid, or any one of its instance")
    pose: Pose = Pose()
    size: tuple[Positive, Positive, Positive] = Field(description="full extents along the box's own axes [m]")
    level: Finite | None = Field(
        default=None,
        description="world z [m] down to which it drains: it takes all that comes while the surface is higher, less within half a spacing of it, nothing below",
    )
    gauge: tuple[Finite, Finite] | None = Field(
        default=None, description="x, y where the surface is read [m]; default: the middle of the box"
    )


class WavesDriver(DriverBase):
    """Makes the waves of a spectrum, and takes in those that arrive, in zones along closed sides of the liquid's domain.

    In a zone of `generate`, liquid is drawn towards the motion of the declared sea; in one of `absorb`, towards rest.
    """

    kind: Literal["waves"] = "waves"
    entity: EntityRef = Field(description="the liquid, or any one of its instance")
    spectrum: Literal["regular", "jonswap", "pierson_moskowitz"] = "regular"
    height: Positive = Field(description="crest to trough of regular waves, significant height of the others [m]")
    period: Positive = Field(description="of regular waves, peak period of the others [s]")
    level: Finite = Field(description="still water, world z [m]")
    depth: Positive = Field(description="of still water [m]")
    direction: float = Field(default=0.0, ge=-360, le=360, description="that waves travel in, from +x towards +y [deg]")
    spreading: float = Field(default=0.0, ge=0, le=40, description="standard deviation of directions [deg]; 0: long crests")
    peakedness: float = Field(default=3.3, ge=1, le=7, description="of jonswap: gamma")
    components: int = Field(default=32, ge=2, le=128, description="waves that a spectrum is made of; regular is 1")
    seed: int = Field(default=0, ge=0, lt=2**31, description="of their phases and directions")
    generate: Annotated[list[WaveSide], Field(min_length=1, max_length=4)] = ["-x"]
    absorb: Annotated[list[WaveSide], Field(max_length=3)] = ["+x"]
    zone: Positive = Field(description="width of each zone [m], at least one peak wavelength")
    start: float = Field(default=0.0, ge=-60, le=1e5, description="[s]; negative: within the preroll")
    rise: Positive | None = Field(default=None, description="seconds to full height; default: two periods")

    @model_validator(mode="after")
    def _own_sides(self) -> WavesDriver:
        both = [*self.generate, *self.absorb]
        if len(set(both)) < len(both):
            raise ValueError("a side stands once, in generate or in absorb")
        return self


class Current(SpecModel):
    """A stream that runs at frame 0: the same velocity all over each of its cross sections."""

    line: Annotated[list[Vec3], Field(min_length=2, max_length=400)] = Field(
        description="its course downstream, in the entity's frame [m]"
    )
    speeds: Annotated[list[NonNegative], Field(min_length=2, max_length=400)] = Field(description="at each of these points [m/s]")
    width: Positive = Field(description="of the stream [m]: liquid within half of it from the course, seen from above, runs")

    @model_validator(mode="after")
    def _one_each(self) -> Current:
        if len(self.line) != len(self.speeds):
            raise ValueError(f"a current has {len(self.line)} points and {len(self.speeds)} speeds; give one speed per point")
        return self


class LiquidPhysics(Matter):
    """Free-surface liquid; the entity's parts are its initial volume."""

    shape: ClassVar[MatterShape] = "loose"
    feels_fields: ClassVar[bool] = True
    levels: ClassVar[bool] = True
    category: Literal["liquid"] = "liquid"
    viscosity: NonNegative = Field(default=1e-3, description="dynamic [Pa s], at `temperature`")
    surface_tension: NonNegative = Field(
        default=0.072,
        description="[N/m]; felt by dfsph below spacings of about three capillary lengths (water 8.6 mm); flip leaves it out",
    )
    resolution: Positive = Field(description="particle spacing or cell size [m]")
    linear_velocity: Vec3 = Field(default=(0, 0, 0), description="at frame 0, or where a preroll begins [m/s]")
    currents: Annotated[dict[Id, Current], Field(max_length=64)] = Field(
        default={}, description="streams that run at frame 0, or where a preroll begins; liquid beside them has linear_velocity"
    )
    temperature: float = Field(default=293.15, gt=0, le=5000, description="at frame 0 [K]")
    conductivity: NonNegative = Field(default=0.0, le=1000, description="thermal [W/(m K)]; 0: heat is carried, not conducted")
    heat_capacity: Positive = Field(default=4186.0, description="[J/(kg K)]")
    activation: NonNegative = Field(
        default=0.0,
        le=1e5,
        description="of viscosity [K]: viscosity(T) = viscosity exp(activation (1/T - 1/temperature)); lava 2e4 or so",
    )

    @property
    def flow_cell(self) -> float:
        """Cell or particle spacing [m]."""
        return self.resolution
