"""Parts of a candidate that can be seen, their motion, and the tolerances that follow from them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import Solid, kept_solid, query_noise
from ...worlds.arrays import F64, RigidPose
from ...worlds.built import TriangleMesh
from ...worlds.categories.fracture.pieces import piece_overlap
from ...worlds.errors import EvidenceError, InputError
from ...worlds.spec import Fastened, Rope
from .bounds import GAP_CAP, UNIT_QUATERNION
from .shapes import PartSurface, Shapes

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["Pair", "Parts", "Track"]

Pair = tuple[str, str]


class Track(NamedTuple):
    """Motion of one body frame: positions [m], shape (frames, 3), and quaternions, shape (frames, 4)."""

    position: F64
    quaternion: F64

    def at(self, frame: int) -> RigidPose:
        """Pose at one frame."""
        return RigidPose(self.position[frame], self.quaternion[frame])

    def take(self, frames: NDArray[np.intp]) -> Track:
        """Motion at some frames."""
        return Track(self.position[frames], self.quaternion[frames])


class Parts:
    """Visible parts of one candidate with their motion."""

    def __init__(self, candidate: Candidate) -> None:
        self.candidate = candidate
        self.frames = candidate.frame_count
        self._tracks: dict[tuple[str, str], Track] = {}
        self._solids: dict[bytes, Solid] = {}
        self._shared: dict[tuple[int, int, bool], tuple[TriangleMesh, Solid]] = {}

    @cached_property
    def parts(self) -> tuple[PartSurface, ...]:
        """Every visible surface that can be inspected, in the order of the specification; see `missing`."""
        return self._collected[0]

    @cached_property
    def missing(self) -> dict[str, str]:
        """Entities that cannot be inspected, and why: not built, no usable surface, or no cache of their motion."""
        return self._collected[1]

    @cached_property
    def _collected(self) -> tuple[tuple[PartSurface, ...], dict[str, str]]:
        found: list[PartSurface] = []
        missing: dict[str, str] = {}
        for entity in self.candidate.solids:
            try:
                found += self._entity_parts(entity)
            except EvidenceError as error:
                missing[entity] = str(error)
        return tuple(found), missing

    def _entity_parts(self, entity: str) -> list[PartSurface]:
        built = self.candidate.entity(entity)
        if not built.parts:
            raise EvidenceError(f"entity {entity!r} has no visible geometry; call place_object")
        for body in built.bodies:
            self.track(entity, body.name)
        found = []
        for part in built.parts:
            try:
                soft = entity in self.candidate.deforming
                shape = TriangleMesh(self.candidate.shape(entity, part.part, 0), part.render.faces) if soft else part.render
                solid = self.solid_of(shape, closed=part.closed)
            except InputError as error:
                raise EvidenceError(f"surface of {entity}/{part.part} cannot be inspected: {error}") from error
            # A hull that fills what is drawn open widens no tolerance: whoever pushes there pushes where nothing is drawn.
            found.append(PartSurface(entity, part.part, part.body, solid, min(float(part.deviation[0]), GAP_CAP)))
        return found

    def solid_of(self, mesh: TriangleMesh, *, closed: bool) -> Solid:
        """The mesh ready for queries; equal meshes share one, with all that is derived from it."""
        own = (
            id(mesh.vertices),
            id(mesh.faces),
            closed,
        )  # entities of one recipe share their arrays; the mesh is kept with its solid
        if own not in self._shared:
            self._shared[own] = mesh, self._by_content(mesh, closed=closed)
        return self._shared[own][1]

    def _by_content(self, mesh: TriangleMesh, *, closed: bool) -> Solid:
        key = hashlib.sha256(repr((mesh.vertices.shape, mesh.vertices.dtype, mesh.faces.dtype, closed)).encode())
        key.update(mesh.vertices.tobytes())
        key.update(mesh.faces.tobytes())
        if key.digest() not in self._solids:
            self._solids[key.digest()] = kept_solid(mesh, closed=closed)
        return self._solids[key.digest()]

    @cached_property
    def entities(self) -> tuple[str, ...]:
        """Entities that can be inspected."""
        return tuple(n for n in self.candidate.solids if n not in self.missing)

    def require(self, *entities: str) -> None:
        """Make sure that entities can be inspected.

        Raises:
            EvidenceError: one cannot; the text says why.
        """
        for entity in entities:
            if entity in self.missing:
                raise EvidenceError(self.missing[entity])
            if entity not in self.candidate.solids:
                category = self.candidate.spec.entities[entity].physics.category
                raise EvidenceError(f"{entity!r} is {category} and has no fixed surface; rows of its solver judge it")

    @cached_property
    def parts_of(self) -> Mapping[str, tuple[int, ...]]:
        """Indices of the parts of every entity."""
        found: dict[str, list[int]] = {name: [] for name in self.candidate.spec.entities}
        for i, part in enumerate(self.parts):
            found[part.entity].append(i)
        return {name: tuple(rows) for name, rows in found.items()}

    def track(self, entity: str, body: str) -> Track:
        """Motion of a body over the inspected frames.

        Raises:
            EvidenceError: the entity moves and no cache holds it, although there are caches.
        """
        key = (entity, body)
        if key not in self._tracks:
            held = self.candidate.cache_row(entity, body) is not None or entity in self.candidate.deforming
            if not held and self.candidate.stage != "static" and not self.is_static(entity):
                raise EvidenceError(
                    f"no cache holds the motion of {entity}/{body}; list {entity!r} as a member of a solver and bake"
                )
            self._tracks[key] = Track(*self.candidate.track(entity, body))
        return self._tracks[key]

    def is_static(self, entity: str) -> bool:
        """True if the contract says that it never moves."""
        return self.candidate.spec.entities[entity].motion == "static"

    @cached_property
    def broken(self) -> dict[str, int]:
        """Entities with a pose that is not finite or no rotation, and the first frame of it."""
        found: dict[str, int] = {}
        for entity in self.entities:
            for body in self.candidate.entity(entity).bodies:
                position, quaternion = self.track(entity, body.name)
                with np.errstate(invalid="ignore", over="ignore"):
                    good = np.isfinite(position).all(axis=1) & (
                        np.abs(np.linalg.norm(quaternion, axis=1) - 1.0) <= UNIT_QUATERNION
                    )
                if not good.all():
                    frame = int(np.argmin(good))
                    found[entity] = min(frame, found.get(entity, frame))
        return found

    def size(self, entity: str) -> float:
        """Largest diagonal among its parts [m]."""
        return self._sizes[entity][0]

    @cached_property
    def _sizes(self) -> dict[str, tuple[float, float]]:
        """Largest diagonal and largest deviation among the parts of each entity [m]."""
        return {
            name: (max(self.parts[i].solid.size for i in rows), max(self.parts[i].deviation for i in rows))
            for name, rows in self.parts_of.items()
            if rows
        }

    def thickness(self, entity: str) -> float:
        """Smallest extent of the local boxes of its parts [m]."""
        return min(float((s.upper - s.lower).min()) for s in (self.parts[i].solid for i in self.parts_of[entity]))

    def noise(self, a: str, b: str) -> float:
        """eps of the penetration checks for a pair [m] (S1): query noise and the rounding of the poses, no allowance."""
        size = self.size(a) + self.size(b)
        offset = max(float(np.abs(p).max(initial=0.0)) for p in (self._start(a), self._start(b)))
        return query_noise(size) + 8.0 * float(np.finfo(np.float64).eps) * offset

    def _start(self, entity: str) -> F64:
        position = self.track(entity, self.parts[self.parts_of[entity][0]].body).position
        return np.where(np.isfinite(position), position, 0.0)

    def skins(self, a: str, b: str) -> float:
        """Sum of the two collision skins [m] in the solver instance that both belong to."""
        return 2.0 * max((skin for members, skin in self._members if a in members and b in members), default=0.0)

    @cached_property
    def _members(self) -> list[tuple[frozenset[str], float]]:
        return [(frozenset(s.members), s.settings.skin) for s in self.candidate.spec.simulation.rigid.values()]

    def contact_gap(self, a: str, b: str) -> float:
        """Largest gap that counts as actual contact [m] (S3): declared limit, or skins and facet error if larger."""
        facets = sum(self._sizes[n][1] for n in (a, b))
        skins = self.skins(a, b)
        covered = min(skins + facets, max(GAP_CAP, skins))
        return max(self.candidate.spec.simulation.limits.contact_gap, covered)

    @cached_property
    def reach(self) -> float:
        """Clearance up to which pairs are inspected [m]: twice the largest contact tolerance."""
        plan = self.candidate.spec.simulation
        skins = max((2.0 * s.settings.skin for s in plan.rigid.values()), default=0.0)
        facets = 2.0 * max((p.deviation for p in self.parts), default=0.0)
        return 2.0 * max(plan.limits.contact_gap, min(skins + facets, max(GAP_CAP, skins)))

    def allowed_depth(self, a: str, b: str) -> float:
        """Overlap that the specification declares intended for the pair [m] (R91); 0 where it declares none.

        A `fastened` relation allows its depth; the end of a rope may sink into what it is attached to by its radius.
        """
        return max(self._fastened.get((a, b), 0.0), self._fastened.get((b, a), 0.0))

    @cached_property
    def _fastened(self) -> dict[Pair, float]:
        found: dict[Pair, float] = {}
        for relation in self.candidate.spec.graph.relations.values():
            if isinstance(relation, Fastened):
                found[relation.a, relation.b] = max(relation.max_depth, found.get((relation.a, relation.b), 0.0))
        for name, entity in self.candidate.spec.entities.items():
            if entity.breakable is not None and name in self.candidate.built:
                found[name, name] = piece_overlap(entity.breakable, self.candidate.built[name])
            if isinstance(entity.generator, Rope):
                for end in (entity.generator.attach_start, entity.generator.attach_end):
                    if end is not None and end != "world":
                        found[name, end] = max(entity.generator.radius, found.get((name, end), 0.0))
        return found

    @cached_property
    def shapes(self) -> Shapes:
        """Shapes of the parts at the frames: those of deforming ones change."""
        return Shapes(self.candidate, self.parts)

    def track_of(self, part: int) -> Track:
        """Motion of the body of a part, by its index."""
        return self.track(self.parts[part].entity, self.parts[part].body)
