"""The predicate grammar (R15, R28; silent point S7).

An *atom* has a truth value at every written frame. `when` says how that becomes one verdict over the beat's
frames: `eventually` (true at some frame), `always` (true at every frame), `end` (true at the last frame).
Combinators nest atoms. `each` inside `count` stands for each listed entity in turn.
"""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field

from ..categories.cloth.events import TearEvent
from ..categories.cloth.predicates import Drape, Flutters, Pinned, Torn
from ..categories.elastic.events import DeformEvent
from ..categories.elastic.predicates import Deflection, Strain
from ..categories.event import FlowEvent, SpreadEvent, VesselEvent
from ..categories.fracture.events import FractureEvent
from ..categories.fracture.predicates import Breach, Broken, Debris
from ..categories.gas.predicates import (
    BurntShare,
    FireEvent,
    GasArrives,
    GasClears,
    GasDensityIn,
    GasTemperatureIn,
    HeatRelease,
    LightThrough,
    PlumeHeight,
)
from ..categories.liquid.events import FloatEvent, SinkEvent, SplashEvent
from ..categories.liquid.predicates import (
    LiquidArrives,
    LiquidFluxThrough,
    LiquidLevelAt,
    LiquidSpeed,
    LiquidTemperature,
    LiquidVolumeIn,
    SplashHeight,
    SubmergedFraction,
    WetArea,
)
from ..categories.particles.events import BuryEvent
from ..categories.particles.predicates import ParticleCountIn, ParticlesSettled, ParticleVolumeIn, PileHeight, RunOut
from ..predicate_base import Band, Subject, When
from ..vocabulary import (
    BeatRef,
    EntityRef,
    FrameInterval,
    JointRef,
    NonNegative,
    Positive,
    RegionRef,
    SpecModel,
    Vec3,
)
from .event_models import BodyEvent, Compares, PairEvent, TouchEvent
from .landscape import LandscapeField, LandscapeWater

__all__ = [
    "ATOMS",
    "After",
    "Always",
    "And",
    "Before",
    "BodyEvent",
    "Breach",
    "Broken",
    "Compares",
    "Contact",
    "Count",
    "Crosses",
    "Debris",
    "Displacement",
    "Eventually",
    "JointAngle",
    "LiquidArrives",
    "LiquidFluxThrough",
    "LiquidLevelAt",
    "LiquidSpeed",
    "LiquidTemperature",
    "LiquidVolumeIn",
    "NoContact",
    "Not",
    "Or",
    "PairEvent",
    "ParticleCountIn",
    "ParticleVolumeIn",
    "ParticlesSettled",
    "PileHeight",
    "Predicate",
    "Reaches",
    "RestsOn",
    "RunOut",
    "Separation",
    "Speed",
    "SplashHeight",
    "StaysIn",
    "SubmergedFraction",
    "Supported",
    "Tilts",
    "Topples",
    "TouchEvent",
    "Until",
    "WetArea",
    "Within",
]


class Reaches(SpecModel):
    """The entity's centre of mass (or all of its surface) is inside the region."""

    kind: Literal["reaches"] = "reaches"
    entity: Subject
    region: RegionRef
    measure: Literal["center", "surface"] = "center"
    when: When = "eventually"


class StaysIn(SpecModel):
    """The entity is inside the region at every frame of the interval."""

    kind: Literal["stays_in"] = "stays_in"
    entity: Subject
    region: RegionRef
    measure: Literal["center", "surface"] = "center"
    when: When = "always"


class Crosses(SpecModel):
    """The entity's centre of mass passes the plane from its back side to its front side (along `normal`)."""

    kind: Literal["crosses"] = "crosses"
    entity: Subject
    point: Vec3
    normal: Vec3


class Contact(SpecModel):
    """The two entities touch, with at least `min_impulse` summed over the interval."""

    kind: Literal["contact"] = "contact"
    a: Subject
    b: Subject
    min_impulse: NonNegative = Field(default=0.0, description="[N s]")


class NoContact(SpecModel):
    """The two entities never touch in the interval."""

    kind: Literal["no_contact"] = "no_contact"
    a: Subject
    b: Subject


class RestsOn(SpecModel):
    """The entity touches `on`, is above it at the contact, and moves slower than `max_speed`."""

    kind: Literal["rests_on"] = "rests_on"
    entity: Subject
    on: Subject
    max_speed: Positive = Field(default=0.02, description="[m/s], fastest point of the entity")
    when: When = "end"


class Supported(SpecModel):
    """A chain of touching bodies leads from the entity down to a static one."""

    kind: Literal["supported"] = "supported"
    entity: Subject
    when: When = "always"


class Tilts(Band):
    """Angle [rad] between the entity's own `axis` and the same axis at frame 0."""

    kind: Literal["tilts"] = "tilts"
    entity: Subject
    axis: Vec3 = (0.0, 0.0, 1.0)
    when: When = "eventually"


class Topples(SpecModel):
    """The entity's own z axis ends at least `min_angle` from where it was at frame 0, and did not start there."""

    kind: Literal["topples"] = "topples"
    entity: Subject
    min_angle: Positive = Field(default=0.6, le=3.1415, description="[rad]")


class Speed(Band):
    """Speed of the centre of mass [m/s]."""

    kind: Literal["speed"] = "speed"
    entity: Subject
    when: When = "eventually"


class Displacement(Band):
    """Distance of the centre of mass from where it was at frame 0 [m], or its component along `axis`."""

    kind: Literal["displacement"] = "displacement"
    entity: Subject
    axis: Vec3 | None = None
    when: When = "eventually"


class Separation(Band):
    """Signed clearance between the visible surfaces of two entities [m]."""

    kind: Literal["separation"] = "separation"
    a: Subject
    b: Subject
    when: When = "always"


class JointAngle(Band):
    """Coordinate of a hinge [rad] or slide [m], relative to frame 0's reference."""

    kind: Literal["joint_angle"] = "joint_angle"
    joint: JointRef
    when: When = "eventually"


class Count(Band):
    """How many of the entities satisfy `predicate`, in which `each` stands for the entity."""

    kind: Literal["count"] = "count"
    entities: Annotated[list[EntityRef], Field(min_length=1, max_length=2000)]
    predicate: Predicate


class Always(SpecModel):
    """`predicate` holds at every frame of `frames` (default: the beat's)."""

    kind: Literal["always"] = "always"
    predicate: Predicate
    frames: FrameInterval | None = None


class Eventually(SpecModel):
    """`predicate` holds at some frame of `frames` (default: the beat's)."""

    kind: Literal["eventually"] = "eventually"
    predicate: Predicate
    frames: FrameInterval | None = None


class Until(SpecModel):
    """`hold` is true at every frame before the first at which `goal` is true, and `goal` comes true."""

    kind: Literal["until"] = "until"
    hold: Predicate
    goal: Predicate


class Before(SpecModel):
    """This beat's first true frame comes before that of `beat`."""

    kind: Literal["before"] = "before"
    beat: BeatRef
    predicate: Predicate


class After(SpecModel):
    """This beat's first true frame comes after that of `beat`."""

    kind: Literal["after"] = "after"
    beat: BeatRef
    predicate: Predicate


class Within(SpecModel):
    """`predicate` first comes true within `frames` frames after `beat` does."""

    kind: Literal["within"] = "within"
    beat: BeatRef
    frames: Annotated[int, Field(ge=0)]
    predicate: Predicate


class And(SpecModel):
    """All hold."""

    kind: Literal["and"] = "and"
    of: Annotated[list[Predicate], Field(min_length=1, max_length=64)]


class Or(SpecModel):
    """At least one holds."""

    kind: Literal["or"] = "or"
    of: Annotated[list[Predicate], Field(min_length=1, max_length=64)]


class Not(SpecModel):
    """`predicate` does not hold (as one verdict over the interval)."""

    kind: Literal["not"] = "not"
    predicate: Predicate


Atom = (
    Reaches
    | StaysIn
    | Crosses
    | Contact
    | NoContact
    | RestsOn
    | Supported
    | Tilts
    | Topples
    | Speed
    | Displacement
    | Separation
    | JointAngle
    | BodyEvent
    | TouchEvent
    | PairEvent
    | Compares
    | Deflection
    | Strain
    | DeformEvent
    | LandscapeWater
    | LandscapeField
    | LiquidVolumeIn
    | LiquidLevelAt
    | LiquidFluxThrough
    | LiquidArrives
    | SubmergedFraction
    | WetArea
    | SplashHeight
    | LiquidSpeed
    | LiquidTemperature
    | FloatEvent
    | SinkEvent
    | VesselEvent
    | SplashEvent
    | FlowEvent
    | SpreadEvent
    | ParticleCountIn
    | ParticleVolumeIn
    | ParticlesSettled
    | PileHeight
    | RunOut
    | BuryEvent
    | GasDensityIn
    | GasTemperatureIn
    | PlumeHeight
    | GasArrives
    | LightThrough
    | GasClears
    | HeatRelease
    | BurntShare
    | FireEvent
    | Broken
    | Breach
    | Debris
    | FractureEvent
    | Drape
    | Flutters
    | Torn
    | Pinned
    | TearEvent
)
Combinator = Count | Always | Eventually | Until | Before | After | Within | And | Or | Not
Predicate = Annotated[Atom | Combinator, Field(discriminator="kind")]

for _model in get_args(Combinator):
    _model.model_rebuild()

ATOMS: tuple[type[SpecModel], ...] = get_args(Atom)
