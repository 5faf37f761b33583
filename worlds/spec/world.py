"""The whole specification (R13): `world.json`."""

from __future__ import annotations

import hashlib
from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, StringConstraints, model_serializer, model_validator

from ..vocabulary import EntityRef, Id, NonNegative, Positive, SpecModel, Text, Vec3
from .claims import Claim
from .entities import Entity, Material
from .interiors import Interior
from .simulation import SimulationPlan
from .story import SceneGraph, Shot, Story
from .terrain import Terrain

__all__ = ["AreaLight", "Clause", "Lamp", "Look", "WorldSpec", "prompt_digest"]


class Clause(SpecModel):
    """How one clause of the prompt is met (R155): pointers into the specification, or why it is not."""

    met_by: list[Annotated[str, StringConstraints(pattern=r"^/(entities|terrains|graph|story|shots|simulation|look)/.+")]] = []
    unmet: Text | None = None
    static_because: Annotated[str, StringConstraints(min_length=10, max_length=300)] | None = Field(
        default=None, description="why words that sound like an event or a way ask for none; printed with the acceptance"
    )


class AreaLight(SpecModel):
    """Square light facing `target`."""

    position: Vec3
    target: Vec3
    size: Positive = 1.0
    power: Positive = Field(default=200.0, description="radiant flux [W]")
    color: tuple[NonNegative, NonNegative, NonNegative] = (1.0, 1.0, 1.0)


class Lamp(SpecModel):
    """A part that shines, and moves with its body."""

    entity: EntityRef
    part: Id
    lumens: Positive = Field(default=806.0, le=1e6, description="luminous flux [lm]; 806 is a bulb of 60 W")
    kelvin: float = Field(default=2700.0, ge=1000.0, le=20000.0, description="colour temperature [K]")


class Look(SpecModel):
    """Light and picture format; no influence on physics."""

    width: int = Field(default=640, ge=64, le=1920)
    height: int = Field(default=360, ge=64, le=1080)
    samples: int = Field(default=16, ge=1, le=1024, description="samples per pixel of the final sequence")
    sky: Literal["sunsky", "overcast", "night", "studio"] = "sunsky"
    sun_elevation_deg: float = Field(default=40.0, ge=2, le=90)
    sun_azimuth_deg: float = Field(default=-60.0, ge=-360, le=360, description="from +x towards +y")
    exposure: float = Field(default=0.0, ge=-10, le=10, description="stops")
    lights: Annotated[dict[Id, AreaLight], Field(max_length=16)] = {}
    lamps: Annotated[dict[Id, Lamp], Field(max_length=200)] = {}


class WorldSpec(SpecModel):
    """A world: prompt, claims, story, contracts, scene graph, shot plan, simulation plan."""

    spec_version: Literal["1", "2"] = Field(
        default="1", description="2: claims over spans of the prompt; 1: clauses, as earlier worlds have"
    )
    title: Annotated[str, StringConstraints(min_length=1, max_length=200)]
    prompt: Annotated[str, StringConstraints(min_length=1, max_length=20000)] = Field(description="immutable after creation")
    clauses: Annotated[dict[Id, Clause], Field(max_length=500)] = Field(default={}, description="of version 1 alone")
    claims: Annotated[dict[Id, Claim], Field(max_length=1000)] = Field(
        default={}, description="spans of the prompt and what is judged for each; of version 2 alone"
    )
    story: Story = Story()
    materials: Annotated[dict[Id, Material], Field(max_length=500)] = {}
    entities: Annotated[dict[Id, Entity], Field(max_length=20000)] = {}
    terrains: Annotated[dict[Id, Terrain], Field(max_length=4)] = {}
    interiors: Annotated[dict[Id, Interior], Field(max_length=4)] = {}
    graph: SceneGraph = SceneGraph()
    shots: Annotated[dict[Id, Shot], Field(max_length=200)] = {}
    simulation: SimulationPlan
    look: Look = Look()

    @model_validator(mode="after")
    def _of_one_version(self) -> WorldSpec:
        if self.spec_version == "1" and self.claims:
            raise ValueError("claims are of spec_version '2'; set it and leave clauses out")
        if self.spec_version == "2" and self.clauses:
            raise ValueError("clauses are of spec_version '1'; a world of version 2 has claims instead")
        return self

    @model_serializer(mode="wrap")
    def _of_its_version(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # Bytes and digests of worlds of version 1 stay as they were.
        document: dict[str, Any] = handler(self)
        document.pop("claims" if self.spec_version == "1" else "clauses", None)
        if not self.interiors:  # digests of worlds without any stay as they always were
            document.pop("interiors", None)
        return document


def prompt_digest(prompt: str) -> str:
    """SHA-256 of the prompt's UTF-8 bytes, hex."""
    return hashlib.sha256(prompt.encode()).hexdigest()
