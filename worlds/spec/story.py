"""World story, scene graph and shot plan (R14-R16, R20-R24)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from ..predicates.models import Not, Predicate
from ..vocabulary import (
    BeatRef,
    EntityRef,
    FrameInterval,
    Id,
    NodeRef,
    NonNegative,
    OwnerRef,
    Positive,
    RegionRef,
    SpecModel,
    Text,
    Vec2,
    Vec3,
)

__all__ = [
    "Adjacent",
    "Beat",
    "BoxRegion",
    "CameraKey",
    "CausalMargin",
    "Connects",
    "Contains",
    "CylinderRegion",
    "Fastened",
    "Interacts",
    "Perturbed",
    "Refined",
    "Region",
    "Relation",
    "Requirement",
    "Robustness",
    "SceneGraph",
    "Shot",
    "SphereRegion",
    "Story",
    "Supports",
]


class CausalMargin(SpecModel):
    """How much a cause must matter to an effect that comes without it too. Give one of the two."""

    frames: int | None = Field(default=None, ge=1, description="without the cause it comes at least so many frames later")
    value: Positive | None = Field(
        default=None, description="without the cause its measured value, at the frame where it came true, differs by this"
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> CausalMargin:
        if (self.frames is None) == (self.value is None):
            raise ValueError("give frames or value, one of the two")
        return self


class Beat(SpecModel):
    """One event of the world story."""

    text: Text = Field(description="the event in words")
    owner: OwnerRef = Field(description="solver instance or authored driver responsible for it")
    subject: EntityRef = Field(description="the entity it happens to")
    frames: FrameInterval
    predicate: Predicate
    causes: list[BeatRef] = Field(default=[], description="beats that must happen before and bring this one about")
    margins: dict[BeatRef, CausalMargin] = Field(
        default={}, description="per cause: by how much its absence must change this beat; default: it must not happen at all"
    )
    mandatory: bool = True
    observe: bool = Field(
        default=True,
        description="must be visible in the shots that cover it; one mandatory beat at least, and those that are not are printed",
    )


class Requirement(SpecModel):
    """A further requirement of the prompt that is no event."""

    text: Text
    predicate: Predicate
    frames: FrameInterval | None = Field(default=None, description="default: the whole sequence")
    mandatory: bool = True
    never: bool = Field(
        default=False, description="the predicate must not come true; give what must not happen, the server negates it"
    )

    @property
    def asked(self) -> Predicate:
        """The predicate that must hold: negated where it must never come true."""
        return Not(predicate=self.predicate) if self.never else self.predicate

    @model_serializer(mode="wrap")
    def _as_before(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # Left out where it is not set: digests of earlier worlds stay as they were.
        document: dict[str, Any] = handler(self)
        if not self.never:
            document.pop("never", None)
        return document


class Perturbed(SpecModel):
    """Beats must come true in most of some runs whose start differs a little, evenly within the amounts."""

    kind: Literal["perturbed"] = "perturbed"
    beats: Annotated[list[BeatRef], Field(min_length=1, max_length=50)]
    samples: int = Field(default=16, ge=4, le=64)
    min_fraction: float = Field(gt=0, le=1, description="least share of the runs in which each beat comes true")
    seed: int = Field(default=0, ge=0, lt=2**31)
    entities: list[EntityRef] = Field(default=[], description="which are varied; default every dynamic one")
    position: float = Field(default=0.0, ge=0, le=0.1, description="farthest shift, level [m]; not of what joints or ropes hold")
    angle: float = Field(default=0.0, ge=0, le=0.5, description="largest turn about the vertical [rad]; as for position")
    speed: float = Field(default=0.0, ge=0, le=0.5, description="largest relative change of start velocities")
    friction: float = Field(default=0.0, ge=0, le=0.9, description="largest relative change of each material and contact pair")
    restitution: float = Field(default=0.0, ge=0, le=0.5, description="largest change of each material and contact pair")
    density: float = Field(default=0.0, ge=0, le=0.9, description="largest relative change of an entity's mass")

    @model_validator(mode="after")
    def _varies(self) -> Perturbed:
        if not any((self.position, self.angle, self.speed, self.friction, self.restitution, self.density)):
            raise ValueError("give at least one amount > 0: position, angle, speed, friction, restitution or density")
        return self


class Refined(SpecModel):
    """Beats must come true with a finer time step too, at nearly the same frame."""

    kind: Literal["refined"] = "refined"
    beats: Annotated[list[BeatRef], Field(min_length=1, max_length=50)]
    factor: Literal[2, 4] = Field(default=2, description="by what the step of every solver is divided")
    frames: int = Field(default=1, ge=0, le=1000, description="largest shift of the first true frame")


Robustness = Annotated[Perturbed | Refined, Field(discriminator="kind")]


class Story(SpecModel):
    """Global scene semantics and events."""

    semantics: Text = ""
    beats: Annotated[dict[Id, Beat], Field(max_length=200)] = {}
    requirements: Annotated[dict[Id, Requirement], Field(max_length=200)] = {}
    robustness: Annotated[dict[Id, Robustness], Field(max_length=20)] = Field(
        default={}, description="what must also hold when the start is a little different, or the step finer"
    )


class _Region(SpecModel):
    role: Text = ""
    relative_to: EntityRef | None = Field(default=None, description="entity whose frame the region moves with; default the world")


class BoxRegion(_Region):
    """Axis-aligned box."""

    kind: Literal["box"] = "box"
    min: Vec3
    max: Vec3

    @model_validator(mode="after")
    def _not_empty(self) -> BoxRegion:
        if any(a >= b for a, b in zip(self.min, self.max, strict=True)):
            raise ValueError("min must be < max in every component")
        return self


class CylinderRegion(_Region):
    """Upright cylinder."""

    kind: Literal["cylinder"] = "cylinder"
    center: Vec3
    radius: Positive
    height: Positive


class SphereRegion(_Region):
    """Ball."""

    kind: Literal["sphere"] = "sphere"
    center: Vec3
    radius: Positive


Region = Annotated[BoxRegion | CylinderRegion | SphereRegion, Field(discriminator="kind")]


class _Edge(SpecModel):
    a: NodeRef
    b: NodeRef
    text: Text = ""
    ratio: tuple[Positive, Positive] | None = Field(
        default=None, description="allowed [min, max] of bounding-box diagonal a / b; default by kind of relation"
    )


class Supports(_Edge):
    """`a` carries `b` over `frames`."""

    kind: Literal["supports"] = "supports"
    a: EntityRef
    b: EntityRef
    frames: FrameInterval | None = Field(
        default=None, description="default: until a declared beat moves b or what it hangs on, else all frames"
    )


class Contains(_Edge):
    """`a` (entity or region) holds `b` inside it over `frames`."""

    kind: Literal["contains"] = "contains"
    b: EntityRef
    frames: FrameInterval | None = None


class Adjacent(_Edge):
    """`a` and `b` stand next to each other, at most `gap` apart at frame 0."""

    kind: Literal["adjacent"] = "adjacent"
    gap: NonNegative = 0.5


class Connects(_Edge):
    """A route leads from region `a` to region `b` for `carrier` (R21, R94); for a fluid an opening of diameter `width`.

    A walker is a person: at least 0.51 m wide and 1.88 m high, steps of at most 0.22 m, slopes of at most 0.6 rad. Give anything
    else as `object`; it is named with its measures and is no way for people.
    """

    kind: Literal["connects"] = "connects"
    a: RegionRef
    b: RegionRef
    carrier: Literal["walker", "object", "fluid"] = "walker"
    width: Positive = Field(default=0.8, description="clear width [m]")
    headroom: Positive = Field(default=2.0, description="clear height [m]")
    max_slope: Positive = Field(default=0.6, lt=1.57, description="[rad]")
    max_step: Positive = Field(default=0.2, description="[m]")
    waypoints: list[Vec2] = Field(default=[], description="points the route passes, in order")
    frames: FrameInterval | None = Field(default=None, description="the way is there at every one of these; default frame 0")


class Interacts(_Edge):
    """`a` and `b` are meant to touch or act on each other: makes them a contact pair to watch."""

    kind: Literal["interacts"] = "interacts"
    a: EntityRef
    b: EntityRef


class Fastened(_Edge):
    """`a` and `b` are meant to touch or overlap (embedded, glued): allowed down to `max_depth`. What moves of them needs a weld."""

    kind: Literal["fastened"] = "fastened"
    a: EntityRef
    b: EntityRef
    max_depth: Positive
    reason: Annotated[str, Field(min_length=10, max_length=300)]


Relation = Annotated[Supports | Contains | Adjacent | Connects | Interacts | Fastened, Field(discriminator="kind")]


class SceneGraph(SpecModel):
    """Vertices are entities and regions; edges are relations."""

    regions: Annotated[dict[Id, Region], Field(max_length=500)] = {}
    relations: Annotated[dict[Id, Relation], Field(max_length=5000)] = {}


class CameraKey(SpecModel):
    """Camera at one frame: where it stands and what it looks at. Angles of shot plans are in degrees."""

    frame: Annotated[int, Field(ge=0)]
    position: Vec3 = Field(description="of the eye [m]")
    target: Vec3 | None = Field(default=None, description="point in the middle of the picture [m]; or give look_at")
    look_at: EntityRef | None = Field(
        default=None, description="instead of target: this entity's centre at the key's frame; follow keeps it there later"
    )
    fov_deg: float = Field(default=40.0, gt=5, lt=120, description="vertical field of view")

    @model_validator(mode="after")
    def _one_aim(self) -> CameraKey:
        if (self.target is None) == (self.look_at is None):
            raise ValueError("give target (a point [x, y, z]) or look_at (an entity id), one of the two")
        return self


class Shot(SpecModel):
    """One camera move over a range of frames; shots follow each other without gap or overlap."""

    frames: FrameInterval
    keys: Annotated[dict[Id, CameraKey], Field(min_length=1, max_length=32)]
    follow: EntityRef | None = Field(default=None, description="target is offset by this entity's motion since the first key")
    covers: list[BeatRef] = []
    subjects: list[EntityRef] = Field(default=[], description="entities that must be framed; default the beats' subjects")
    transition: Literal["cut", "continue"] = "cut"
    intent: Text = ""
