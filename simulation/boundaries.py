"""The bodies that liquid, cloth or grains meet: their surfaces, and what is exchanged about them at every step."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple

import numpy as np

from ..geometry.heightfields import ground_solid
from ..worlds.arrays import F64, RigidPose, compose, pose_of
from ..worlds.built import BuiltBody, BuiltEntity, BuiltPart, TriangleMesh

if TYPE_CHECKING:
    from ..worlds.spec import Entity, WorldSpec

__all__ = ["BodyState", "Boundary", "MovingSurface", "SoftBoundary", "Surround", "meets_domain", "surround_of"]

HERE = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


@dataclass(frozen=True)
class Boundary:
    """The surface of one body (or of fixed ground) that matter of another instance can meet."""

    name: str
    """`entity/body`; its place in `Surround.boundaries` is its row in `BodyState` and in wrenches."""
    mesh: TriangleMesh
    """Outward faces; in the body's frame, of static and deforming ones in the world's at frame 0: the pose of those is the identity,
    always. A height field comes as its closed solid."""
    motion: Literal["static", "kinematic", "dynamic"]
    closed: bool = True
    """False: a sheet, met from both sides."""
    friction: float = 0.0
    """Liquids: viscosity felt at the wall in units of the liquid's, 0 free slip, 1 no slip. Cloth and grains: Coulomb coefficient."""
    deforming: bool = False
    """Its vertices move by themselves (cloth, elastic bodies); rows of `BodyState.vertices` replace the mesh's."""


@dataclass(frozen=True)
class SoftBoundary:
    """The entity behind a deforming boundary."""

    entity: str
    parts: tuple[str, ...]
    """Their simulation vertices stand one after the other."""
    mass: F64
    """That belongs to each vertex (v,) [kg]; the boundary's centre of mass is theirs."""


class MovingSurface(NamedTuple):
    """The vertices of a deforming entity at one time."""

    places: F64
    """(v, 3) [m]"""
    speeds: F64
    """(v, 3) [m/s]"""
    lightness: F64
    """Speed that each vertex alone gains per impulse on it (v,) [1/kg]; 0 where it is held."""
    give: F64
    """The same where all get impulses at once: what they truly answer is never more (v,) [1/kg]."""
    pace: float = np.inf
    """Time in which its fastest swing turns by less than two radians [s]; infinite where steps damp those that are faster."""


@dataclass
class BodyState:
    """State of the boundaries' bodies at one time, one row per boundary."""

    position: F64
    """Frame origin (b, 3) [m]."""
    rotation: F64
    """(b, 3, 3), body to world."""
    center: F64
    """Centre of mass, world (b, 3): wrenches and velocities refer to it."""
    velocity: F64
    """Velocity of the centre of mass (b, 3) [m/s]."""
    angular_velocity: F64
    """World axes (b, 3) [rad/s]."""
    inverse_mass: F64
    """(b,) [1/kg]; 0 where the body does not react."""
    inverse_inertia: F64
    """(b, 3, 3) world axes [1/(kg m^2)]; 0 where it does not react."""
    acceleration: F64
    """Linear acceleration (b, 3) from everything but the coupled solver that meets it (gravity, contacts, drivers) [m/s^2]."""
    mobility: F64 | None = None
    """Velocity that the centre of mass gains per impulse there, (b, 3, 3) [1/kg], what else holds the body included; None: `inverse_mass`."""
    turning: F64 | None = None
    """Angular velocity per angular impulse likewise, (b, 3, 3) [1/(kg m^2)]; None: `inverse_inertia`."""
    vertices: dict[int, tuple[F64, F64]] = field(default_factory=dict)
    """Deforming boundaries: row -> (vertices (v, 3), their velocities (v, 3)), world."""
    vertex_lightness: dict[int, F64] = field(default_factory=dict)
    """Deforming boundaries that react: row -> speed that each vertex alone gains per impulse on it (v,) [1/kg]."""
    vertex_give: dict[int, F64] = field(default_factory=dict)
    """Those whose vertices share what they carry: row -> a bound of the same where all get impulses at once (v,) [1/kg]."""
    vertex_pace: dict[int, float] = field(default_factory=dict)
    """Those that swing undamped: row -> longest step in which a solver may take their velocities for steady [s]."""

    ROWS: ClassVar[tuple[str, ...]] = (
        *("position", "rotation", "center", "velocity", "angular_velocity"),
        *("inverse_mass", "inverse_inertia", "acceleration"),
    )
    """Fields with one row per body."""

    def copied_rows(self) -> BodyState:
        """A copy in which nothing deforms."""
        return BodyState(*(getattr(self, name).copy() for name in self.ROWS), *(m.copy() for m in self.mobilities()))

    def mobilities(self) -> tuple[F64, F64]:
        """`mobility` and `turning`, where nothing else is known those of the bodies alone; each (b, 3, 3)."""
        alone = self.inverse_mass[:, None, None] * np.eye(3)
        return alone if self.mobility is None else self.mobility, self.inverse_inertia if self.turning is None else self.turning

    def write(self, rows: list[int], other: BodyState, theirs: list[int]) -> None:
        """Take over rows of another state."""
        for name in self.ROWS:
            getattr(self, name)[rows] = getattr(other, name)[theirs]
        self.mobility, self.turning = (m.copy() for m in self.mobilities())
        for own, others in zip((self.mobility, self.turning), other.mobilities(), strict=True):
            own[rows] = others[theirs]


@dataclass(frozen=True)
class Surround:
    """The bodies that an instance meets, and their places at frame 0; one row each in all that is exchanged."""

    boundaries: tuple[Boundary, ...]
    bodies: tuple[BuiltBody, ...]
    """Mass properties per boundary; of static ones in the world's frame."""
    start: tuple[RigidPose, ...]
    """Pose of each boundary's body at frame 0; the identity of static ones."""
    parts: tuple[tuple[int, TriangleMesh], ...] = ()
    """Single surfaces that the rigid boundaries are made of: (row, mesh in the frame of the boundary's)."""
    soft: Mapping[int, SoftBoundary] = field(default_factory=dict)
    """Deforming boundaries by row."""


def meets_domain(entity: Entity, built: BuiltEntity, box: tuple[F64, F64], margin: float) -> bool:
    """True if a solid at its place at frame 0 reaches into a domain; what moves may always come there."""
    if entity.motion != "static":
        return True
    base = pose_of(entity.pose)
    for part in built.parts:
        pose = compose(base, next(b.pose for b in built.bodies if b.name == part.body))
        points = pose.apply(part.render.vertices)
        if (points.max(axis=0) >= box[0] - margin).all() and (points.min(axis=0) <= box[1] + margin).all():
            return True
    return False


def surround_of(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    box: tuple[F64, F64],
    margin: float,
    *,
    friction: float | None = None,
    soft: tuple[str, ...] = (),
) -> Surround:
    """Rigid bodies and ground that reach into a box; what moves may always come there. Deforming entities come last.

    Args:
        spec: the specification.
        built: its geometry.
        box: least and greatest corner (3,) [m]; may be infinite.
        margin: how far outside the box they still count [m].
        friction: of every boundary; None takes the largest Coulomb coefficient of its parts' materials.
        soft: deforming entities that are met too.
    """
    from .soft_surfaces import soft_boundaries

    boundaries: list[Boundary] = []
    bodies: list[BuiltBody] = []
    start: list[RigidPose] = []
    surfaces: list[tuple[int, TriangleMesh]] = []
    for entity in sorted(n for n, e in spec.entities.items() if e.physics.shape == "solid"):
        contract = spec.entities[entity]
        if not meets_domain(contract, built[entity], box, margin):
            continue
        for body in built[entity].bodies:
            pose = compose(pose_of(contract.pose), body.pose)
            parts = [p for p in built[entity].parts_of(body.name) if p.collision]
            near = [_near(p, pose, box, margin) for p in parts] if contract.motion == "static" else [p.render for p in parts]
            meshes = [m for m in near if m is not None]
            if not meshes:
                continue
            if contract.motion == "static":
                meshes = [TriangleMesh(pose.apply(m.vertices), m.faces) for m in meshes]
                body, pose = replace(body, center=pose.apply(body.center[None])[0]), HERE
            rough = max(spec.materials[p.material].friction for p in parts) if friction is None else friction
            closed = all(p.closed for p in parts)
            surfaces += [(len(boundaries), m) for m in meshes]
            boundaries.append(Boundary(f"{entity}/{body.name}", _joined(meshes), contract.motion, closed, rough))
            bodies.append(body)
            start.append(pose)
    deforming = {}
    for made in soft_boundaries(spec, built, soft, friction=friction):
        deforming[len(boundaries)] = made.soft
        boundaries.append(made.boundary)
        bodies.append(made.body)
        start.append(HERE)
    return Surround(tuple(boundaries), tuple(bodies), tuple(start), tuple(surfaces), deforming)


def _joined(meshes: list[TriangleMesh]) -> TriangleMesh:
    offsets = np.cumsum([0, *(len(m.vertices) for m in meshes)])
    faces = [m.faces + offset for m, offset in zip(meshes, offsets, strict=False)]
    return TriangleMesh(np.concatenate([m.vertices for m in meshes]), np.concatenate(faces).astype(np.int32))


def _near(part: BuiltPart, pose: RigidPose, box: tuple[F64, F64], margin: float) -> TriangleMesh | None:
    """The part of a static surface that a domain can feel: None beyond it; of a height field, the ground around it."""
    points = pose.apply(part.render.vertices)
    if (points.max(axis=0) < box[0] - margin).any() or (points.min(axis=0) > box[1] + margin).any():
        return None
    piece = part.collision[0]
    if piece.kind != "heightfield" or len(part.collision) != 1:
        return part.render
    box = (np.maximum(box[0], points.min(axis=0)), np.minimum(box[1], points.max(axis=0)))
    rows, cols = piece.points.shape
    half_x, half_y, base = piece.params
    corners = np.array(
        [[x, y, z] for x in (box[0][0], box[1][0]) for y in (box[0][1], box[1][1]) for z in (box[0][2], box[1][2])]
    )
    local = compose(pose, piece.pose).inverse().apply(corners)
    pad = margin * math.sqrt(2.0)
    columns = _span(local[:, 0], half_x, cols, pad)
    lines = _span(local[:, 1], half_y, rows, pad)
    x, y = np.linspace(-half_x, half_x, cols)[columns], np.linspace(-half_y, half_y, rows)[lines]
    heights = piece.points[lines, columns]
    ground = ground_solid(heights, (float(np.ptp(x)), float(np.ptp(y))), base)
    shifted = ground.vertices + np.array([x.mean(), y.mean(), 0.0])
    return TriangleMesh(piece.pose.apply(shifted), ground.faces)


def _span(values: F64, half: float, count: int, pad: float) -> slice:
    """Samples of an axis of a height field that cover values, at least two."""
    scale = (count - 1) / (2 * half)
    first = int(np.clip(math.floor((float(values.min()) - pad + half) * scale), 0, count - 2))
    last = int(np.clip(math.ceil((float(values.max()) + pad + half) * scale), first + 1, count - 1))
    return slice(first, last + 1)
