"""Breakable bodies: the pieces a body is cut into beforehand, and the bonds that hold them together (R61, R133)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from ...vocabulary import NonNegative, Positive, SpecModel, Vec3

__all__ = ["Bond", "Breakable", "BrickPattern", "GlassPattern", "VoronoiPattern", "WoodPattern"]

Side = Literal["x-", "x+", "y-", "y+", "z-", "z+"]
Seed = Annotated[int, Field(ge=0, lt=2**31)]
Count = Annotated[int, Field(ge=2, le=2000)]


class VoronoiPattern(SpecModel):
    """Cells around random points: concrete, stone, plaster, ceramics."""

    kind: Literal["voronoi"] = "voronoi"
    pieces: Count = Field(description="points; concave bodies may give a few pieces more")
    seed: Seed = 0
    around: Vec3 | None = Field(default=None, description="point in the entity's frame near which pieces are smaller [m]")
    clustering: float = Field(default=0.0, ge=0, le=1, description="0: equal pieces; 1: most of them near `around`")

    @model_validator(mode="after")
    def _point_of_clusters(self) -> VoronoiPattern:
        if self.clustering > 0 and self.around is None:
            raise ValueError("clustering needs the point `around` which pieces gather")
        return self


class BrickPattern(SpecModel):
    """Courses of bricks along z; each piece is a brick with its half of the joints around it."""

    kind: Literal["bricks"] = "bricks"
    size: tuple[Positive, Positive, Positive] = Field(description="brick: along the wall, through it, height [m]")
    joint: NonNegative = Field(default=0.01, description="thickness of the mortar [m]")
    along: Literal["x", "y"] = Field(default="x", description="direction of the wall in the entity's frame")
    offset: float = Field(default=0.5, ge=0, lt=1, description="shift of every other course, in bricks; 0: stack bond")


class WoodPattern(SpecModel):
    """Splinters along the grain."""

    kind: Literal["wood"] = "wood"
    pieces: Count
    seed: Seed = 0
    grain: Vec3 = Field(default=(1.0, 0.0, 0.0), description="direction of the grain in the entity's frame")
    slenderness: float = Field(default=6.0, ge=1, le=40, description="length over width of a splinter")
    along_grain: float = Field(default=10.0, ge=1, le=100, description="strength of cut fibres over that between fibres")

    @model_validator(mode="after")
    def _grain_has_length(self) -> WoodPattern:
        if sum(c * c for c in self.grain) < 1e-12:
            raise ValueError("grain must not be the zero vector")
        return self


class GlassPattern(SpecModel):
    """Radial and concentric cracks around one point of a plate; the cells go through its thinnest direction."""

    kind: Literal["glass"] = "glass"
    point: Vec3 = Field(description="where the cracks start, in the entity's frame [m]")
    radial: int = Field(default=12, ge=4, le=64, description="cracks that run outwards")
    rings: int = Field(default=5, ge=1, le=32, description="cracks that run around")
    seed: Seed = 0
    irregularity: float = Field(default=0.4, ge=0, le=0.9, description="0: regular; scatter of cracks in parts of their distance")


Pattern = Annotated[VoronoiPattern | BrickPattern | WoodPattern | GlassPattern, Field(discriminator="kind")]


class Bond(SpecModel):
    """What holds two pieces together over the face they share. It breaks where its stress exceeds its strength."""

    tension: Positive = Field(description="tensile strength, bending included [Pa]; lime mortar 0.1e6, concrete 2e6, glass 40e6")
    shear: Positive = Field(description="shear strength without pressure [Pa]")
    friction: NonNegative = Field(default=0.6, le=2, description="shear strength gained per pressure on the face")
    toughness: NonNegative = Field(
        default=0.0, description="energy that a face takes to break [J/m^2]; 0: stress alone decides; mortar 10, concrete 100"
    )
    young_modulus: float = Field(default=1e10, gt=0, le=1e13, description="of the pieces [Pa]; distributes the load among bonds")
    poisson_ratio: float = Field(default=0.2, ge=0, lt=0.5)
    contact_time: float = Field(
        default=1e-3, ge=1e-5, le=0.1, description="time over which an impact's impulse loads the bonds [s]; hard bodies 1e-3"
    )
    crumble: NonNegative | None = Field(
        default=None,
        le=0.1,
        description="how far pieces may close over a broken face, where mortar or splinters crumble [m]; default: half the joint of "
        "bricks, else 0.01 of a piece's size",
    )


class Breakable(SpecModel):
    """The entity is built of pieces held together by bonds. It moves as one body until bonds break."""

    pattern: Pattern
    bond: Bond
    fixed: Annotated[list[Side], Field(max_length=6)] = Field(
        default=[],
        description="sides of the entity's box that are bonded to the world: z- for a wall on its foundation; none for a thrown pot",
    )
