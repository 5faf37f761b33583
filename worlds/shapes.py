"""Shapes of parts. All lengths in metres, in the part's own right-handed Z-up frame."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints, model_validator

from .vocabulary import Finite, NonNegative, Positive, SpecModel, Vec2, Vec3

__all__ = [
    "Box",
    "Capsule",
    "Cylinder",
    "Extrusion",
    "HeightField",
    "Hull",
    "Mesh",
    "Pose",
    "Revolution",
    "Shape",
    "Sheet",
    "Sphere",
    "StemField",
    "Sweep",
    "Wedge",
]

MESH_VERTICES, MESH_FACES = 20_000, 40_000
"""Corners and triangles of a mesh that is written inline, at most; files may have more."""


class Pose(SpecModel):
    """A rigid placement: position [m] and orientation.

    Give either `quaternion` (w, x, y, z; normalised by the server) or `euler` (rotations in rad about the
    fixed x, then y, then z axis). Neither means no rotation.
    """

    position: Vec3 = (0.0, 0.0, 0.0)
    quaternion: tuple[Finite, Finite, Finite, Finite] | None = None
    euler: Vec3 | None = Field(default=None, description="[rx, ry, rz] in rad about fixed x, then y, then z")

    @model_validator(mode="after")
    def _one_rotation(self) -> Pose:
        if self.quaternion is not None and self.euler is not None:
            raise ValueError("give quaternion or euler, not both")
        if self.quaternion is not None and sum(c * c for c in self.quaternion) < 1e-12:
            raise ValueError("quaternion must not be zero")
        return self


class Box(SpecModel):
    """Axis-aligned box centred at the origin."""

    kind: Literal["box"] = "box"
    size: tuple[Positive, Positive, Positive] = Field(description="full extents x, y, z [m]")


class Sphere(SpecModel):
    """Sphere centred at the origin."""

    kind: Literal["sphere"] = "sphere"
    radius: Positive


class Cylinder(SpecModel):
    """Solid cylinder about the z axis, centred at the origin."""

    kind: Literal["cylinder"] = "cylinder"
    radius: Positive
    height: Positive


class Capsule(SpecModel):
    """Capsule about the z axis, centred at the origin."""

    kind: Literal["capsule"] = "capsule"
    radius: Positive
    length: Positive = Field(description="distance between the two cap centres [m]")


class Wedge(SpecModel):
    """Ramp: right-triangular prism centred in its bounding box.

    Its top falls from full height at -x to zero height at +x; the base is the rectangle at -z.
    """

    kind: Literal["wedge"] = "wedge"
    size: tuple[Positive, Positive, Positive] = Field(description="full extents x, y, z [m]")


class Extrusion(SpecModel):
    """Simple polygon (counter-clockwise, may be concave) in the xy plane, extruded along z, centred in z."""

    kind: Literal["extrusion"] = "extrusion"
    polygon: Annotated[list[Vec2], Field(min_length=3, max_length=256)]
    height: Positive


class Revolution(SpecModel):
    """Closed polygon of (r, z) points, r >= 0, revolved about the z axis: bowls, cups, rings, vases, cones.

    The profile is walked so that the material lies to its left or right consistently; the server orients it.
    """

    kind: Literal["revolution"] = "revolution"
    profile: Annotated[list[tuple[NonNegative, Finite]], Field(min_length=3, max_length=64)]
    segments: int = Field(default=32, ge=6, le=128, description="segments around the axis")


class Hull(SpecModel):
    """Convex hull of points: tapered legs, keystones, hipped roofs, faceted stones."""

    kind: Literal["hull"] = "hull"
    points: Annotated[list[Vec3], Field(min_length=4, max_length=256)]


class Sweep(SpecModel):
    """Profile carried along a path, mitred where it bends: handles, taps, pipes, rails, rims; with `scales` tapered legs and spouts.

    The profile stands upright on the path: its v axis points as far up (+z) as it can on the first segment, along +y where that is
    upright, and is turned no more than the path turns.
    """

    kind: Literal["sweep"] = "sweep"
    path: Annotated[list[Vec3], Field(min_length=2, max_length=128)]
    profile: Annotated[list[Vec2], Field(min_length=3, max_length=64)] = Field(
        description="simple polygon (u, v) about the path [m]; seen along the path u is to the right, v up"
    )
    scales: Annotated[list[Positive], Field(min_length=2, max_length=128)] | None = Field(
        default=None, description="size of the profile at each point of the path; default 1"
    )
    closed: bool = Field(default=False, description="the last point leads back to the first")

    @model_validator(mode="after")
    def _one_scale_each(self) -> Sweep:
        if self.scales is not None and len(self.scales) != len(self.path):
            raise ValueError(f"{len(self.scales)} scales for {len(self.path)} points of the path; give one each")
        if self.closed and len(self.path) < 3:
            raise ValueError("a closed path has at least 3 points")
        return self


class Mesh(SpecModel):
    """Closed triangle mesh, from a file in the world's `assets/` folder or written inline."""

    kind: Literal["mesh"] = "mesh"
    file: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_./-]{1,200}\.(obj|stl|ply|glb)$")] | None = None
    vertices: Annotated[list[Vec3], Field(max_length=MESH_VERTICES)] | None = None
    faces: (
        Annotated[
            list[tuple[Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)]]],
            Field(max_length=MESH_FACES),
        ]
        | None
    ) = None
    scale: Positive = 1.0
    collision: Literal["hull", "decompose"] = Field(
        default="decompose", description="hull: one convex hull; decompose: convex decomposition (CoACD)"
    )

    @model_validator(mode="after")
    def _one_source(self) -> Mesh:
        inline = self.vertices is not None and self.faces is not None
        if inline == (self.file is not None):
            raise ValueError("give either file or both vertices and faces")
        return self


class Sheet(SpecModel):
    """Rectangle in the xy plane, centred at the origin: only for cloth. The warp runs along x."""

    kind: Literal["sheet"] = "sheet"
    size: tuple[Positive, Positive] = Field(description="extent x, y [m]")
    resolution: Positive = Field(description="length of the edges of its triangles, at most [m]")


class HeightField(SpecModel):
    """Regular grid of heights over a rectangle centred at the origin; row 0 is south (-y), column 0 west (-x).

    The heights stand here, or in a file of the world's `assets/` folder that build_terrain writes; then `digest` is the
    SHA-256 of that file, and another file of the same name is refused.
    """

    kind: Literal["heightfield"] = "heightfield"
    size: tuple[Positive, Positive] = Field(description="extent x, y [m]")
    heights: (
        Annotated[list[Annotated[list[Finite], Field(min_length=2, max_length=512)]], Field(min_length=2, max_length=512)] | None
    ) = None
    file: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_./-]{1,200}\.npy$")] | None = None
    digest: Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")] | None = None
    base: Positive = Field(default=0.1, description="thickness below the lowest height [m]")

    @model_validator(mode="after")
    def _one_source(self) -> HeightField:
        if (self.heights is None) == (self.file is None) or (self.file is None) != (self.digest is None):
            raise ValueError("give either heights, or file and digest")
        if self.heights is not None and len({len(row) for row in self.heights}) != 1:
            raise ValueError("all rows of heights must have the same length")
        return self


class StemField(SpecModel):
    """Trunks and boulders of a landscape on the ground cut from it: upright cylinders and hulls, only for static ground.

    build_terrain(stems=true) writes the part and its file in the world's `assets/` folder; another file of the same name is refused.
    """

    kind: Literal["stems"] = "stems"
    file: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_./-]{1,200}\.npy$")]
    digest: Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")] = Field(description="SHA-256 of the file")
    count: int = Field(ge=1, description="trunks and boulders in the file")


Shape = Annotated[
    Box | Sphere | Cylinder | Capsule | Wedge | Extrusion | Revolution | Hull | Sweep | Mesh | Sheet | HeightField | StemField,
    Field(discriminator="kind"),
]
