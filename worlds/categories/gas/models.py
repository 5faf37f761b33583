"""Gas in specifications: the source that an entity is, the engine that moves it, what lets it out, raises or lights it (R60, R61)."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from ...matter import Instance, Matter, MatterShape, TimedDriver
from ...vocabulary import EntityRef, NonNegative, Positive, SpecModel, Vec3
from ..domains import SidedDomain

__all__ = [
    "DustDriver",
    "EmissionDriver",
    "Flammable",
    "GasInstance",
    "GasPhysics",
    "GasSettings",
    "IgnitionDriver",
    "SteamDriver",
]

Burns = Literal["methane", "propane", "methanol", "heptane", "wood"]


class Flammable(SpecModel):
    """How a solid or cloth burns in a gas with the same fuel: its surface heats, and from `ignition` on heat makes gas of it. Defaults: wood."""

    # 1.8 MJ/kg: Douglas fir (Tewarson 2002); 623 K: 250 to 365 degrees C with a pilot (Babrauskas 2003).
    fuel: Burns = Field(default="wood", description="what it gives off")
    ignition: float = Field(default=623.0, ge=400, le=1200, description="temperature of its surface [K]")
    gasification: float = Field(default=1.8e6, ge=1e5, le=1e7, description="heat that makes a kg of gas [J/kg]")
    char: float = Field(default=0.2, ge=0, lt=1, description="share of its mass that stays")
    conductivity: float = Field(default=0.12, ge=0.01, le=5, description="[W/(m K)]")
    heat_capacity: float = Field(default=1600.0, ge=300, le=5000, description="[J/(kg K)]")


class GasPhysics(Matter):
    """Smoke, steam, hot air or what burns; the entity's parts are the room in which an emission makes it, no body.

    Its material tells how it looks; its density is that of air at its temperature, and of its soot.
    """

    shape: ClassVar[MatterShape] = "loose"
    feels_fields: ClassVar[bool] = True
    category: Literal["gas"] = "gas"
    temperature: float = Field(default=400.0, ge=150, le=3000, description="of the gas at its source [K]")
    # Own choice: half of the light is lost in 8 cm, at 8.7 m^2/g (Mulholland and Croarkin 2000, Fire and Materials 24, 227).
    soot_density: NonNegative = Field(
        default=1e-3, le=1.0, description="soot, droplets or dust in the gas at its source [kg/m^3]; 0: clear"
    )
    fuel: Burns | None = Field(
        default=None,
        description="what burns of it in the air that it mixes with, once an ignition lights it or it is hot enough; wood: what hot wood gives off",
    )
    fuel_share: float = Field(
        default=1.0, gt=0, le=1, description="mass of the fuel in a mass of the gas at its source; used with fuel"
    )
    resolution: Positive = Field(description="cell size [m]")

    @property
    def flow_cell(self) -> float:
        """Cell or particle spacing [m]."""
        return self.resolution


class GasSettings(SpecModel):
    """Settings of a gas on a grid. Beyond open sides there is air of the ambient temperature, moved by the fields that act on the gas."""

    domain: SidedDomain
    scheme: Literal["reflection", "maccormack"] = Field(
        default="reflection", description="how velocities are carried; maccormack takes half the time and loses eddies sooner"
    )
    max_step: float = Field(default=0.02, ge=1e-5, le=0.1, description="longest step [s]")
    courant: float = Field(default=2.0, ge=0.1, le=4.0, description="largest travel per step in cells")
    expands: bool = Field(
        default=True,
        description="true: hot gas is light as it truly is; false: its density differs in buoyancy alone (Boussinesq), which holds for "
        "temperatures near the ambient one",
    )
    viscosity: NonNegative = Field(
        default=0.0, le=100.0, description="kinematic [m^2/s]; 0 leaves what the scheme has, air 1.5e-5"
    )
    diffusivity: NonNegative = Field(default=0.0, le=100.0, description="thermal [m^2/s]; 0: heat is carried, not conducted")
    confinement: float = Field(
        default=0.0, ge=0, le=1.0, description="strength of vorticity confinement; above 0 it puts energy in, and is registered"
    )
    ambient_temperature: float = Field(default=293.15, ge=150, le=1000, description="of the air around [K]")
    follows: bool = Field(
        default=False,
        description="true: solved in a part of the domain alone that follows the gas and grows with it, still air beyond; for a plume in a tall domain without wind",
    )
    iterations: int = Field(default=60, ge=2, le=1000, description="most iterations of a pressure solve")
    coefficient: NonNegative = Field(
        default=1.0,
        le=5,
        description="drag coefficient of rigid bodies that a coupling lets it carry, by the area that their hull shows to the flow: "
        "sphere 0.47, cube 1.05",
    )
    device: Literal["cpu", "cuda"] = "cpu"


class GasInstance(Instance):
    """A running gas and its one entity. Rigid bodies that reach into the domain are its obstacles; it does not push them.

    A one_way coupling from it to an instance of bodies, cloth or particles drags these along, with variables ["wrench"]: it is baked first, its velocity
    and density act on them as those of a wind do, and bodies that it carries do not stand in its way. With a two_way one it feels them: they are
    simulated together, and what drag gives to them is taken from it. A one_way coupling from an instance of cloth lets that cloth burn in it, where
    its material may.
    """

    moves: ClassVar[tuple[str, ...]] = ("gas",)
    meets: ClassVar[tuple[str, ...]] = ("cloth",)
    carries: ClassVar[bool] = True
    engine: Literal["gas"] = "gas"
    members: Annotated[list[EntityRef], Field(min_length=1, max_length=16)] = Field(description="one gas")
    settings: GasSettings


class EmissionDriver(TimedDriver):
    """Makes gas in the parts of a gas entity during [start, end) seconds; without one it makes none."""

    later: ClassVar[frozenset[str]] = frozenset({"start", "end"})  # its rate bounds every step
    kind: Literal["emission"] = "emission"
    entity: EntityRef = Field(description="the gas")
    rate: Positive = Field(description="of gas at its source's temperature [m^3/s]")
    start: NonNegative = 0.0
    end: Positive | None = Field(default=None, description="[s]; default: to the end")


class IgnitionDriver(TimedDriver):
    """A spark or pilot flame: in a ball a gas with fuel burns whatever its temperature, during [start, end) seconds. It gives no heat itself."""

    later: ClassVar[frozenset[str]] = frozenset({"center", "radius", "start", "end"})
    kind: Literal["ignition"] = "ignition"
    entity: EntityRef = Field(description="the gas, which has a fuel")
    center: Vec3 = Field(description="of the ball [m]")
    radius: Positive = Field(le=10.0, description="of the ball [m]; the nearest cell counts in any case")
    start: NonNegative = 0.0
    end: Positive | None = Field(default=None, description="[s]; default: to the end")


class DustDriver(TimedDriver):
    """Dust that bodies raise where they hit something during [start, end) seconds: its mass goes with the energy of each impact (half its
    impulse times its closing speed). It comes within a ball about the place, from the impact on for the time of a frame.

    Impacts count in the box around the parts of the gas entity, widened by a cell: the room in which dust lies.
    """

    later: ClassVar[frozenset[str]] = frozenset({"per_energy", "radius", "start", "end"})
    kind: Literal["dust"] = "dust"
    entity: EntityRef = Field(description="the gas, which has a soot_density and no fuel")
    bodies: Annotated[list[EntityRef], Field(min_length=1, max_length=32)] = Field(
        description="rigid entities; what one of them hits counts, pieces of breakable ones too"
    )
    per_energy: float = Field(gt=0, le=1e-2, description="dust per energy [kg/J]: 1e-5 makes 10 g of a kilojoule")
    radius: Positive = Field(le=10.0, description="of the ball [m]; it widens until it has room for the dust")
    start: NonNegative = 0.0
    end: Positive | None = Field(default=None, description="[s]; default: to the end")


class SteamDriver(TimedDriver):
    """Steam where hot matter touches water during [start, end) seconds, by the heat flux of boiling water over the area of contact, which the
    motion of both tells frame by frame. It comes in balls that stand on the water over the contact. The hot matter cools as a whole.
    """

    later: ClassVar[frozenset[str]] = frozenset({"temperature", "heat_capacity", "radius", "start", "end"})
    kind: Literal["steam"] = "steam"
    entity: EntityRef = Field(description="the gas: temperature 373.15, a soot_density for its drops, no fuel")
    hot: Annotated[list[EntityRef], Field(min_length=1, max_length=16)] = Field(
        description="rigid entities in one piece, or liquids of the water's instance, which have temperature and heat_capacity themselves"
    )
    water: Annotated[list[EntityRef], Field(min_length=1, max_length=8)] = Field(description="liquids of substance water")
    temperature: float | None = Field(
        default=None, ge=380, le=3000, description="of rigid hot entities at `start` [K]; it is not seen"
    )
    heat_capacity: float = Field(
        default=800.0, ge=100, le=5000, description="of rigid hot entities [J/(kg K)]: stone 800, iron 450"
    )
    radius: Positive = Field(
        le=10.0, description="of the balls [m], two cells at least; also half the width of what one ball gathers"
    )
    start: NonNegative = 0.0
    end: Positive | None = Field(default=None, description="[s]; default: to the end")

    @property
    def watched(self) -> tuple[str, ...]:
        """Hot matter and the water."""
        return (*self.hot, *self.water)
