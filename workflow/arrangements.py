"""Arguments of place_object that say where: beside another entity, along a river, many at once. Plain data, part of its schema."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

__all__ = ["Array", "AssetAsk", "Beside", "Side", "Station", "Thing"]

Side = Literal["+x", "-x", "+y", "-y", "top", "front", "back", "left", "right"]
Metres = Annotated[float, Field(ge=-1e6, le=1e6)]
Factor = Annotated[float, Field(gt=0, le=100)]


class Beside(BaseModel):
    """Beside another entity, the middles of the two in line with the side, at its own height or on what carries it."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    entity: str = Field(description="The other entity")
    side: Side = Field(
        description="Of the world (+x ... -y), top, or of the other entity: front is its own +x, left its own +y, both level; of an asset front is its -y, from where it is used"
    )
    gap: float = Field(default=0.0, ge=0, le=1e6, description="Free distance [m]; at least what collision skins need")
    shift: Metres = Field(default=0.0, description="Along the side, to the left as seen from the other; on top along its x [m]")


class AssetAsk(BaseModel):
    """A thing that a generator makes."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    generator: str = Field(max_length=64, description="inspect_world(part='assets', query='oak chair')")
    parameters: dict[str, Any] = Field(default={}, description="Other than the defaults [m]")
    seed: int = Field(default=0, ge=0, lt=2**32, description="Of its variation")
    positions: dict[str, float] = Field(default={}, description="Of its joints at frame 0, from closed [rad or m]")
    motion: Literal["static", "dynamic"] | None = Field(default=None, description="Default: the generator's")
    fixed: bool | None = Field(default=None, description="Leaves, drawers, lids are static: a door that stays shut")


class Station(BaseModel):
    """A place in a river of a landscape; +x of the entity looks downstream."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    reach: int = Field(ge=0, description="Number of the reach: inspect_world(part='terrain')")
    station: float = Field(ge=0, le=1e6, description="Along its course from its upper end [m]")
    across: Metres = Field(default=0.0, description="From the middle to the left, looking downstream [m]")
    terrain: str | None = Field(default=None, description="Default the only one")


class Array(BaseModel):
    """Many of one entity, which is the first of them; copies get ids <entity>_002, _003 ..."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Literal["grid", "circle", "scatter"]
    counts: Annotated[tuple[int, int], Field(description="grid: columns along x, rows along y; a row is [n, 1]")] = (1, 1)
    spacing: Annotated[tuple[Metres, Metres], Field(description="grid: from origin to origin along x, y [m]")] = (1.0, 1.0)
    count: int = Field(default=2, ge=2, le=500, description="circle, scatter: how many, the entity included")
    center: tuple[Metres, Metres] | None = Field(
        default=None, description="circle: x, y; the radius is how far the entity is away"
    )
    arc_deg: float = Field(default=360.0, ge=-360, le=360, description="circle: from the first to the last")
    polygon: list[tuple[Metres, Metres]] | None = Field(
        default=None, min_length=3, max_length=200, description="scatter: corners x, y [m]; outlines stay inside and apart"
    )
    gap: float = Field(default=0.0, ge=0, le=1000, description="scatter: least distance between outlines [m]")
    size: Annotated[tuple[Factor, Factor], Field(description="Least and greatest size of copies, as factors of the entity's")] = (
        1.0,
        1.0,
    )
    yaw: Literal["same", "along", "random"] | None = Field(
        default=None, description="Default: same in a grid, along a circle (turned with it), random in a scatter"
    )
    seed: int = Field(default=0, ge=0, lt=2**31, description="Equal seeds give equal places")


class Thing(BaseModel):
    """One of many things that a call puts in their places; its fields are those of the call."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    entity: str = Field(description="Entity to move, or with asset to make")
    asset: AssetAsk | None = Field(default=None, description="As in the call")
    on: str | None = Field(default=None, description="Entity it rests on, also one placed before it in this list")
    surface: str | None = Field(default=None, description="A surface of that asset")
    at: tuple[float, float] | None = Field(default=None, description="x, y [m]; with surface from its middle")
    height: float | None = Field(default=None, ge=-1e4, le=1e4, description="Instead of on [m]")
    yaw_deg: float | None = Field(default=None, ge=-360, le=360, description="About z [degrees]")
    tilt: bool = Field(default=False, description="As in the call")
    lay: bool = Field(default=False, description="Onto a side on which it stays")
    afloat: str | None = Field(default=None, description="As in the call")
    beside: Beside | None = Field(default=None, description="Instead of at")
    array: Array | None = Field(default=None, description="Many of it")
