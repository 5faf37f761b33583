"""Cloth in the simulation plan and what holds it (R63, R64)."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from ...matter import Instance, Matter, MatterShape
from ...vocabulary import EntityRef, Id, NonNegative, Positive, SpecModel, Vec3

__all__ = ["ClothInstance", "ClothPhysics", "ClothPin", "ClothSettings", "ClothTear"]


class ClothPin(SpecModel):
    """Vertices of a sheet that are held: where they are at frame 0, or by a body that takes them along.

    Give `edge`, or `center` with `radius`.
    """

    edge: Literal["-x", "+x", "-y", "+y", "-z", "+z"] | None = Field(
        default=None, description="all vertices on this side of the sheet's bounding box, in the entity's frame"
    )
    center: Vec3 | None = Field(default=None, description="all vertices within `radius` of this point of the entity's frame [m]")
    radius: NonNegative = Field(default=0.0, description="[m]; 0: the nearest vertex alone")
    to: EntityRef | None = Field(
        default=None, description="rigid entity of one body that takes them along; default: they stay in space"
    )

    @model_validator(mode="after")
    def _one_place(self) -> ClothPin:
        if (self.edge is None) == (self.center is None):
            raise ValueError("give either edge or center")
        return self


class ClothTear(SpecModel):
    """The sheet tears where it is pulled too hard: edges of its triangles open, across the pull.

    Each corner of each triangle is then a vertex of its own, which moves with its neighbours' until they part.
    """

    strength: Positive = Field(
        description="largest force per length across any line that it bears [N/m], as a mean over the triangles around a vertex; "
        "it stretches there by strength / stretch_stiffness, which max_stretch has to allow"
    )


class ClothSettings(SpecModel):
    """Settings of sheets. Stretch is the declared stiffness's and nothing else's, whichever the steps."""

    integrator: Literal["implicit", "explicit"] = Field(
        default="implicit",
        description="implicit: steps of max_step where the cloth meets nothing or lies nearly still, short ones elsewhere; explicit: those alone",
    )
    max_step: float = Field(
        default=1 / 240,
        ge=1e-6,
        le=1e-2,
        description="longest step [s]; explicit ones are as short as the sheets' stiffness asks for",
    )
    exchange: float | None = Field(
        default=None,
        ge=1e-5,
        le=1e-2,
        description="time between two looks at the bodies' motion [s]; default: max_step, at most 1 ms where the cloth pushes them or tears",
    )
    margin: NonNegative | None = Field(
        default=None,
        le=0.05,
        description="distance at which layers touch [m], at least the thickness; default: the thickness or 0.15 of the shortest edge",
    )
    iterations: int = Field(default=2, ge=1, le=20, description="rounds of contact impulses in a step")
    device: Literal["cpu", "cuda"] = "cpu"


class ClothInstance(Instance):
    """Running cloth. All rigid entities are what it meets; with a two_way coupling it pushes them."""

    moves: ClassVar[tuple[str, ...]] = ("cloth",)
    meets: ClassVar[tuple[str, ...]] = ("elastic",)
    engine: Literal["shell"] = "shell"
    members: Annotated[list[EntityRef], Field(min_length=1, max_length=64)]
    settings: ClothSettings = ClothSettings()


class ClothPhysics(Matter):
    """Cloth: its parts are sheets or meshes, which need not be closed; every triangle of them is one of the simulation.

    Stiffnesses are those of the sheet: Young's or shear modulus times thickness. Fabrics: stretch 500 to 5000 N/m, shear a tenth of
    that, bend 1e-6 (silk) to 1e-4 N m (canvas); the step falls with the edge length and the root of the stretch stiffness.
    """

    shape: ClassVar[MatterShape] = "deforming"
    feels_fields: ClassVar[bool] = True
    category: Literal["cloth"] = "cloth"
    area_density: Positive = Field(description="[kg/m^2]")
    thickness: Positive = Field(description="[m]")
    stretch_stiffness: Positive = Field(description="along the warp, the sheet's x [N/m]")
    weft_stiffness: Positive | None = Field(default=None, description="across the warp [N/m]; default: as along it")
    shear_stiffness: Positive | None = Field(default=None, description="[N/m]; default: a tenth of the stretch stiffness")
    bend_stiffness: NonNegative = Field(default=0.0, description="[N m]")
    damping: NonNegative = Field(
        default=0.0, le=0.1, description="stress by strain rate over stress by strain [s]; above 1e-5 it shortens the step"
    )
    self_collision: bool = True
    drag: NonNegative = Field(default=1.2, le=5, description="coefficient of the air that meets the sheet's faces")
    skin_drag: NonNegative = Field(default=0.03, le=1, description="coefficient of the air that sweeps along them")
    flat: bool = Field(default=False, description="true: it wants to be flat; default: it wants the shape in which it is built")
    linear_velocity: Vec3 = Field(default=(0, 0, 0), description="at frame 0 [m/s]")
    pins: Annotated[dict[Id, ClothPin], Field(max_length=64)] = {}
    ignores: Annotated[list[EntityRef], Field(max_length=64)] = Field(
        default=[], description="rigid entities that it passes through; listed as an approximation"
    )
    tear: ClothTear | None = Field(default=None, description="what tears it; default: it never tears")
    max_stretch: Positive = Field(default=0.05, le=1, description="largest allowed extension of an edge / its length at rest")

    def geometry(self) -> dict[str, Any]:
        """Weight and thickness, and whether the sheet can tear."""
        sheet = {"sheet": [self.area_density, self.thickness]}
        return sheet if self.tear is None else {**sheet, "tears": True}

    @property
    def sheet_thickness(self) -> float:
        """Thickness [m]."""
        return self.thickness
