"""Shapes of parts. All lengths in metres, in the part's own right-handed Z-up frame."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints, model_validator

from .vocabulary import Finite, InAssets, NonNegative, Positive, SpecModel, Vec2, Vec3

__all__ = [
    "Boolean",
    "Box",
    "Capsule",
    "Cylinder",
    "Extrusion",
    "HeightField",
    "Hull",
    "Loft",
    "Member",
    "Mesh",
    "Pose",
    "Repeat",
    "Revolution",
    "Section",
    "Shape",
    "Sheet",
    "Sphere",
    "StemField",
    "Sweep",
    "Text",
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


class Section(SpecModel):
    """One cross-section of a loft: a simple polygon in the xy plane of its pose, counter-clockwise."""

    polygon: Annotated[list[Vec2], Field(min_length=3, max_length=64)]
    pose: Pose = Pose()


class Loft(SpecModel):
    """Solid over cross-sections, the convex hull from each to the next: hulls of boats, blades, handles, bonnets, bottles that are not round.

    Sections may differ in their number of corners while they are convex; concave ones have equally many, in the same order.
    """

    kind: Literal["loft"] = "loft"
    sections: Annotated[list[Section], Field(min_length=2, max_length=64)]

    @model_validator(mode="after")
    def _equal_corners(self) -> Loft:
        counts = {len(s.polygon) for s in self.sections}
        if len(counts) > 1 and not all(_convex(s.polygon) for s in self.sections):
            raise ValueError(
                f"concave sections of a loft have equally many corners, these have {sorted(counts)}; add corners, or give convex ones"
            )
        return self


def _convex(polygon: list[Vec2]) -> bool:
    """True if every corner of a polygon turns to the same side or goes straight on."""
    turns = []
    for k, (x, y) in enumerate(polygon):
        (px, py), (nx, ny) = polygon[k - 1], polygon[(k + 1) % len(polygon)]
        turns.append((x - px) * (ny - y) - (y - py) * (nx - x))
    return all(t >= -1e-12 for t in turns) or all(t <= 1e-12 for t in turns)


LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZÄÖÜ0123456789.,:-!?'&/+ "
"""Characters that a text may hold; small letters are drawn as capitals."""


class Text(SpecModel):
    """Letters as solids, reading along +x, up along +y, centred at the origin: raised as a part of a sign, cut in as a member of a boolean."""

    kind: Literal["text"] = "text"
    text: Annotated[str, StringConstraints(min_length=1, max_length=32)] = Field(
        description="letters A-Z, Ä, Ö, Ü, digits, . , : - ! ? ' & / + and spaces"
    )
    height: Positive = Field(description="height of a capital [m]")
    depth: Positive = Field(description="extent along z [m]")
    stroke: Annotated[float, Field(ge=0.04, le=0.25)] = Field(default=0.12, description="width of a stroke / height")

    @model_validator(mode="after")
    def _letters_known(self) -> Text:
        unknown = sorted(set(self.text.upper()) - set(LETTERS))
        if unknown or not self.text.strip():
            raise ValueError(f"no letter for {', '.join(map(repr, unknown)) or 'blanks alone'}; there are {LETTERS.strip()}")
        return self


class Repeat(SpecModel):
    """Copies in a row, a ring or a helix: each is turned about the z axis of the whole, then moved, from the one before."""

    count: int = Field(ge=2, le=64, description="copies, the first included")
    move: Vec3 = Field(default=(0.0, 0.0, 0.0), description="from one to the next [m]")
    turn: Finite = Field(default=0.0, description="about z, from one to the next [rad]")


class Member(SpecModel):
    """One solid of a boolean, in its place, with its copies."""

    shape: Annotated[
        Box | Sphere | Cylinder | Capsule | Wedge | Extrusion | Revolution | Hull | Sweep | Loft | Text,
        Field(discriminator="kind"),
    ]
    pose: Pose = Pose()
    repeat: Repeat | None = None
    mirror: Literal["x", "y", "z"] | None = Field(
        default=None, description="adds the image of all copies across the plane x = 0, y = 0 or z = 0 of the whole"
    )


class Boolean(SpecModel):
    """Union, difference or intersection of solids: drilled plates, notches, mortises, engraved text, gears, gratings, domes.

    `difference` takes all later members away from the first. Round members have 32 sides, spheres 320 faces. Collision pieces are the
    exact convex parts, at most 512; a hollow round thing has fewer as a `revolution`.
    """

    kind: Literal["boolean"] = "boolean"
    operation: Literal["union", "difference", "intersection"]
    of: Annotated[list[Member], Field(min_length=1, max_length=16)]

    @model_validator(mode="after")
    def _members_enough(self) -> Boolean:
        first = self.of[0]
        if len(self.of) < 2 and (self.operation != "union" or (first.repeat is None and first.mirror is None)):
            raise ValueError(
                f"a {self.operation} has at least 2 members; a union of one has copies (repeat) or an image (mirror)"
            )
        return self


class Mesh(SpecModel):
    """Closed triangle mesh, from a file in the world's `assets/` folder or written inline."""

    kind: Literal["mesh"] = "mesh"
    file: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_./-]{1,200}\.(obj|stl|ply|glb)$"), InAssets] | None = None
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
    file: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_./-]{1,200}\.npy$"), InAssets] | None = None
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
    file: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_./-]{1,200}\.npy$"), InAssets]
    digest: Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")] = Field(description="SHA-256 of the file")
    count: int = Field(ge=1, description="trunks and boulders in the file")


Shape = Annotated[
    Box
    | Sphere
    | Cylinder
    | Capsule
    | Wedge
    | Extrusion
    | Revolution
    | Hull
    | Sweep
    | Loft
    | Text
    | Boolean
    | Mesh
    | Sheet
    | HeightField
    | StemField,
    Field(discriminator="kind"),
]
