"""A candidate: one frozen specification with its built entities and caches, as verifiers and renderers read it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Literal, TypeVar, cast

import numpy as np

from .arrays import F64, RigidPose, compose, pose_of
from .built import BuiltBody, BuiltEntity, load_built
from .cache import Cache
from .canonical import digest_of, spec_digest
from .categories.deforming import Deforming, deforming_of
from .categories.derived import DERIVED
from .channels import Channel
from .coarsening import coarsened, read_overrides
from .derived import Derived
from .errors import EvidenceError, SpecError
from .folder import WorldFolder, safe_join
from .patch import parse_spec
from .spec import LiquidPhysics, Shot, WorldSpec
from .writers import writers_of

__all__ = ["Candidate", "Stage", "cache_digest", "open_candidate", "recorded_inputs"]

Stage = Literal["static", "probe", "full"]
T = TypeVar("T")


@dataclass(frozen=True)
class Candidate:
    """A specification with its built entities and caches, as checks, renderers and exporters read it.

    `stage` is `static` before any simulation (only frame 0, from the specification), `probe` for a probe's
    caches, `full` for a complete bake.
    """

    folder: Path
    """The world folder."""
    spec: WorldSpec
    built: Mapping[str, BuiltEntity]
    stage: Stage
    caches: Mapping[str, Cache] = field(default_factory=dict)
    """Per solver instance."""
    artifact: str = "world.json"
    """Relative path of what is inspected, for the `artifact` column of rows."""
    digest: str = ""
    """Content digest of the inspected caches; empty at the static stage."""
    apart: frozenset[tuple[str, str]] = frozenset()
    """Pairs of entities that this run lets pass through each other (a counterfactual one): neither carries the other."""
    variants: Path | None = None
    """Where simulated variants of it are kept and taken from; None writes nothing, and trusts nothing that was written."""
    _memory: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def memo(self, key: Hashable, make: Callable[[], T]) -> T:
        """The value kept under a key, made at the first call: whatever is worked out once per candidate."""
        if key not in self._memory:
            self._memory[key] = make()
        return cast("T", self._memory[key])

    def until(self, frame: int) -> Candidate:
        """This candidate as it stands when the run has come to a frame, for verdicts frame by frame and while a run goes on.

        Rows that need later frames are `unverified`; what has failed by then stays failed.

        Raises:
            EvidenceError: there is no such frame.
        """
        if not 0 <= frame <= self.last_frame:
            raise EvidenceError(f"no frame {frame}: frames 0..{self.last_frame} can be inspected")
        if frame == self.last_frame:
            return self
        caches = {name: cache.until(frame) for name, cache in self.caches.items()}
        return replace(self, stage="probe", caches=caches, digest=cache_digest(caches), variants=None)

    @cached_property
    def rigid_caches(self) -> dict[str, Cache]:
        """Caches of rigid instances: those with poses, contacts and joints."""
        return {n: c for n, c in self.caches.items() if n in self.spec.simulation.rigid}

    @cached_property
    def liquid_caches(self) -> dict[str, Cache]:
        """Caches of liquid instances: those with particles."""
        return {n: c for n, c in self.caches.items() if n in self.spec.simulation.liquid}

    @cached_property
    def cloth_caches(self) -> dict[str, Cache]:
        """Caches of cloth instances: those with vertices of sheets."""
        return {n: c for n, c in self.caches.items() if n in self.spec.simulation.cloth}

    @cached_property
    def gas_caches(self) -> dict[str, Cache]:
        """Caches of gas instances: those with fields on cells."""
        return {n: c for n, c in self.caches.items() if n in self.spec.simulation.gas}

    @cached_property
    def particle_caches(self) -> dict[str, Cache]:
        """Caches of instances of grains and of flying particles."""
        return {n: c for n, c in self.caches.items() if n in self.spec.simulation.particles}

    def written_by(self, quantity: Channel) -> list[Cache]:
        """Caches of the instances that record a quantity."""
        made = [m for c in self.caches.values() for m in _made_of(c) if m.writes in quantity.of]
        return [m.files for m in made] or [c for n, c in self.caches.items() if writers_of(self.spec, n) & set(quantity.of)]

    @cached_property
    def deforming(self) -> dict[str, Deforming]:
        """Entities whose deformation a cache holds; empty at the static stage, where they have their rest shape.

        Raises:
            EvidenceError: a cache does not belong to what is built.
        """
        return deforming_of(
            self.built, {n: c for n, c in self.caches.items() if n not in (*self.liquid_caches, *self.particle_caches)}
        )

    @cached_property
    def deformables(self) -> tuple[str, ...]:
        """Entities that are meant to deform."""
        return tuple(n for n, e in self.spec.entities.items() if e.physics.shape == "deforming")

    @cached_property
    def frame_count(self) -> int:
        """Frames that can be inspected: 1 at the static stage."""
        return min((c.index.frames for c in self.caches.values()), default=1)

    @cached_property
    def solids(self) -> tuple[str, ...]:
        """Entities with a surface of their own, which may deform. Liquids, gases and grains have none."""
        return tuple(n for n, e in self.spec.entities.items() if e.physics.shape != "loose")

    @cached_property
    def liquids(self) -> tuple[str, ...]:
        """Entities that are liquids."""
        return tuple(n for n, e in self.spec.entities.items() if isinstance(e.physics, LiquidPhysics))

    @property
    def last_frame(self) -> int:
        """Index of the last frame that can be inspected."""
        return self.frame_count - 1

    @cached_property
    def _rows(self) -> dict[tuple[str, str], tuple[Cache, int]]:
        found: dict[tuple[str, str], tuple[Cache, int]] = {}
        for cache in self.rigid_caches.values():
            for row, name in enumerate(cache.index.bodies):
                entity, body = name.split("/", 1)
                found[entity, body] = (cache, row)
        return found

    def cache_row(self, entity: str, body: str = "body") -> tuple[Cache, int] | None:
        """Cache and row that hold a body's motion; None when nothing moves it (static, or static stage)."""
        return self._rows.get((entity, body))

    def body(self, entity: str, body: str = "body") -> BuiltBody:
        """Mass properties of a body.

        Raises:
            EvidenceError: the entity is not built.
        """
        for candidate in self.entity(entity).bodies:
            if candidate.name == body:
                return candidate
        raise EvidenceError(f"entity {entity!r} has no body {body!r}")

    def entity(self, entity: str) -> BuiltEntity:
        """Geometry of an entity.

        Raises:
            EvidenceError: the entity is not built.
        """
        try:
            return self.built[entity]
        except KeyError:
            raise EvidenceError(f"entity {entity!r} is not built; call place_object") from None

    def pose(self, entity: str, frame: int, body: str = "body") -> RigidPose:
        """Pose of a body frame in the world at `frame`; of a deforming body, the best rigid fit."""
        if entity in self.deforming:
            return self.deforming[entity].pose(frame)
        place = self.cache_row(entity, body)
        if place is not None:
            return place[0].pose(place[1], frame)
        return compose(pose_of(self.spec.entities[entity].pose), self.body(entity, body).pose)

    def track(self, entity: str, body: str = "body") -> tuple[F64, F64]:
        """Positions (frames, 3) and quaternions (frames, 4) of a body frame over all frames; see `pose`."""
        if entity in self.deforming:
            fits = [self.deforming[entity].pose(k) for k in range(self.frame_count)]
            return np.stack([p.position for p in fits]), np.stack([p.quaternion for p in fits])
        place = self.cache_row(entity, body)
        if place is not None:
            cache, row = place
            return cache.series("position")[: self.frame_count, row], cache.series("quaternion")[: self.frame_count, row]
        pose = self.pose(entity, 0, body)
        return np.repeat(pose.position[None], self.frame_count, 0), np.repeat(pose.quaternion[None], self.frame_count, 0)

    def center(self, entity: str, frame: int) -> F64:
        """Centre of mass of the whole entity in the world, shape (3,)."""
        bodies = self.entity(entity).bodies
        total = sum(b.mass for b in bodies)
        weighted = sum((b.mass * self.pose(entity, frame, b.name).apply(b.center[None])[0] for b in bodies), start=np.zeros(3))
        return weighted / total

    def aimed(self, shot: Shot) -> Shot:
        """A shot whose keys all have a target: of those that look at an entity, its centre at their frame.

        Raises:
            EvidenceError: such an entity is not built.
        """
        if all(key.look_at is None for key in shot.keys.values()):
            return shot
        keys = {
            name: key
            if key.look_at is None
            else key.model_copy(
                update={"target": tuple(map(float, self.center(key.look_at, min(key.frame, self.last_frame)))), "look_at": None}
            )
            for name, key in shot.keys.items()
        }
        return shot.model_copy(update={"keys": keys})

    def moves(self, entity: str) -> bool:
        """True if any body of the entity is in a cache."""
        return entity in self.deforming or any((entity, b.name) in self._rows for b in self.entity(entity).bodies)

    def surface(self, entity: str, part: str, frame: int) -> F64:
        """Visible vertices of a part in the world, shape (r, 3): moved with its body, or bound to its simulation mesh.

        Raises:
            EvidenceError: the entity is not built, or has no such part.
        """
        for own in self.entity(entity).parts:
            if own.part == part:
                if entity in self.deforming:
                    return self.deforming[entity].surface(own, frame)
                return self.pose(entity, frame, own.body).apply(own.render.vertices)
        raise EvidenceError(f"entity {entity!r} has no part {part!r}")

    def shape(self, entity: str, part: str, frame: int) -> F64:
        """Visible vertices of a part in its body's frame, shape (r, 3); `pose` puts them where `surface` has them."""
        own = next(p for p in self.entity(entity).parts if p.part == part)
        if entity not in self.deforming:
            return own.render.vertices
        return self.pose(entity, frame, own.body).inverse().apply(self.surface(entity, part, frame))

    def vertices(self, entity: str, frame: int) -> F64:
        """Visible vertices of all parts in the world, shape (n, 3)."""
        return np.concatenate([self.surface(entity, p.part, frame) for p in self.entity(entity).parts])

    def recipe(self, check: str, entities: Iterable[str] = (), extra: Any = None) -> str:
        """Hash of what a row is derived from, for `Row.recipe`.

        At the static stage that is the pose and geometry of `entities`; later the caches' digest. `extra` is
        any JSON-able slice of the specification the verdict also depends on (a predicate, a bound).
        """
        names = sorted(set(entities))
        source: dict[str, Any] = {"check": check, "stage": self.stage, "extra": extra, "entities": names}
        if self.stage == "static":
            source["inputs"] = [self.memo(("recipe", n), partial(self._placed, n)) for n in names if n in self.spec.entities]
        else:
            source["inputs"] = self.digest
        return hashlib.sha256(json.dumps(source, sort_keys=True, default=str).encode()).hexdigest()[:32]

    def _placed(self, entity: str) -> tuple[str, str | None, Any]:
        """Geometry and pose of an entity, as `recipe` takes them."""
        built = self.built.get(entity)
        return entity, built.digest() if built else None, self.spec.entities[entity].pose.model_dump(mode="json")


def _made_of(cache: Cache) -> list[Derived]:
    """Products that cover all frames of a cache, in the order of their registry."""
    return [m for m in (kind(cache) for kind in DERIVED) if m.count() >= cache.index.frames > 0]


def cache_digest(caches: Mapping[str, Cache], frames: Mapping[str, Sequence[str]] | None = None) -> str:
    """SHA-256 over the indices and the digests of all frames, surfaces and wet maps, hex.

    Args:
        caches: by solver instance.
        frames: digests of their frames, instead of those recorded beside them.

    Raises:
        EvidenceError: a cache has no digests or lacks frames.
    """
    state = hashlib.sha256()
    for name in sorted(caches):
        digests = caches[name].digests() if frames is None else frames[name]
        if len(digests) < caches[name].index.frames:
            raise EvidenceError(
                f"cache {name!r} holds {len(digests)} of {caches[name].index.frames} frames; bake again to resume"
            )
        state.update(name.encode())
        state.update(json.dumps(asdict(caches[name].index), sort_keys=True).encode())
        for digest in [*digests[: caches[name].index.frames], *(made.digest() for made in _made_of(caches[name]))]:
            state.update(digest.encode())
    return state.hexdigest()


def recorded_inputs(
    folder: WorldFolder, freeze: str, built: Mapping[str, BuiltEntity] | None = None
) -> tuple[WorldSpec, dict[str, BuiltEntity]]:
    """Specification and geometry that a freeze recorded.

    Args:
        folder: the world.
        freeze: which.
        built: entities at hand: one whose content is the recorded one is not read again.

    Raises:
        EvidenceError: something recorded is missing, damaged or altered.
    """
    root = folder.candidate(freeze)
    record = folder.read_json(root / "candidate.json")
    try:
        spec, files = parse_spec(record["spec"]), {k: (str(f), str(d)) for k, (f, d) in record["built"].items()}
    except (SpecError, KeyError, TypeError, ValueError, AttributeError) as error:
        raise EvidenceError(f"candidate.json of {root.name!r} is damaged ({error}); call probe_sim again") from error
    # Of the document as it stands: what later versions add with defaults is no damage.
    sealed = "document_digest" in record
    told = record["document_digest"] if sealed else record.get("spec_digest", spec_digest(spec))
    if told != (digest_of(record["spec"]) if sealed else spec_digest(spec)):
        raise EvidenceError(f"the specification in candidate.json of {root.name!r} is damaged; call probe_sim again")
    if not files.keys() <= spec.entities.keys():
        raise EvidenceError(f"candidate.json of {root.name!r} is damaged: it names what is no entity; call probe_sim again")
    found = {}
    for entity, (file, digest) in files.items():
        at_hand = (built or {}).get(entity)
        path = safe_join(folder.root, file)
        found[entity] = at_hand if at_hand is not None and at_hand.digest() == digest else load_built(path)
        if found[entity].digest() != digest:
            raise EvidenceError(f"built entity {entity!r} was altered since the freeze; call place_object, then probe again")
    return spec, found


def open_candidate(
    folder: WorldFolder, freeze: str, stage: Literal["probe", "full"], built: Mapping[str, BuiltEntity] | None = None
) -> Candidate:
    """Open the caches of a freeze from its own record, without building anything; errors and `built` as `recorded_inputs`."""
    spec, found = recorded_inputs(folder, freeze, built)
    where = folder.candidate(freeze) / ("probe" if stage == "probe" else "bake")
    if stage == "probe":
        spec = coarsened(spec, read_overrides(where))
    caches = {name: Cache(where / name) for name in spec.simulation.solvers}
    return Candidate(
        folder=folder.root,
        spec=spec,
        built=found,
        stage=stage,
        caches=caches,
        artifact=folder.relative(where),
        digest=cache_digest(caches),
    )
