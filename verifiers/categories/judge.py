"""Judge of one category of matter: its rows, and how whole entities of it move, push, look and end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.built import TriangleMesh
from ...worlds.categories.registry import CATEGORIES
from ...worlds.errors import EvidenceError
from ..ledgers import motion
from ..ledgers.origins import Given, Origin, origins_of, with_works

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row
    from ...worlds.spec import SolverInstance, WorldSpec
    from ..predicates.outcome import Outcome
    from ..rows.questions import Question
    from .stretch import Stretch

__all__ = ["STILL_SPEED", "STILL_SPIN", "Flags", "Judge", "Push", "Rupture", "Tie", "Touch", "joined", "record_of", "stored"]

Flags = NDArray[np.bool_]

STILL_SPEED = 5e-4
"""[m/s] A body slower than this (and `STILL_SPIN`) is still. Own choice: far above the residual speed of resting bodies (they
fall asleep below 25 um/s) and far below anything that is seen to creep."""
STILL_SPIN = 5e-3
"""[rad/s]"""
TOLD = 0.05
"""Own choice: share of the kinetic energy at the end from which on an entity is named."""


class Push(NamedTuple):
    """Two entities push each other within one frame, or one heats the other."""

    a: str
    b: str
    begin: float
    end: float
    """[s] Between these times; a contact that is new and has ended by the next frame carries at `begin` alone."""
    impulse: float
    """[N s]; infinite of heat."""
    heat: bool = False
    """True where `a` heats `b`, which need not move by it."""


Tie = tuple[str | None, str | None, float]
"""Two entities that something holds together, None for the world, and until when [s]."""


class Touch(NamedTuple):
    """Matter against a body, or against solids that no record tells apart."""

    matter: frozenset[str]
    body: str | None
    pressed: Flags
    """True where they pressed each other over a frame, shape (frames,)."""


def record_of(cache: Cache, name: str, frames: int) -> F64 | None:
    """A record over the frames, shape (frames,); None where the cache has none."""
    try:
        return np.asarray(cache.series(f"record/{name}"), dtype=np.float64)[:frames]
    except EvidenceError:
        return None


class Rupture(NamedTuple):
    """An entity broke or tore."""

    entity: str
    first: float
    last: float
    """[s] First and last bond or thread that gave way."""
    cause: str | None
    """Entity that loaded it most often; None where only gravity, air or its own motion did."""
    text: str
    """`breaks into 7 pieces (34 of 120 bonds)`."""


class Judge:
    """One category of matter. Questions that it does not answer itself are answered here as for a body of a rigid instance."""

    name: ClassVar[str]
    """`physics.category` of its entities; `fracture` for breakable rigid ones."""
    moved_as: ClassVar[str] = ""
    """Category whose instances move it; empty for its own."""
    meets: ClassVar[bool] = False
    """True if `touches` tells whom its entities meet, so that it can be the first contact of a run."""
    bears: ClassVar[bool] = False
    """True if bodies can float in it."""
    flat: ClassVar[bool] = False
    """True if its surface is a sheet that encloses no volume."""
    grainy: ClassVar[bool] = False
    """True if it is seen as many small things, the errors of whose pixels level out."""
    declared: ClassVar[tuple[Question, ...]] = ()
    """Questions that `declared_rows` answers."""
    noun: ClassVar[str] = ""
    """Word for matter of it; empty where its form gives the word."""
    goes_on: ClassVar[str] = "moves on"
    """Words for its motion where a run ends before it rests."""
    in_fields: ClassVar[tuple[str, str] | None] = None
    """Simplification where the medium of a force field, {0}, acts on it, and its effect; None where no field does."""

    @property
    def body(self) -> bool:
        """True if its entities are bodies that rigid instances move and whose contacts they log."""
        physics = CATEGORIES[self.moved_as or self.name].physics
        return physics is not None and physics.body

    # ---------------------------------------------------------------- which instances

    def instances(self, spec: WorldSpec) -> dict[str, SolverInstance]:
        """Instances that move it, by name."""
        category = self.moved_as or self.name
        return {name: instance for name, instance in spec.simulation.solvers.items() if category in instance.moves}

    def caches(self, candidate: Candidate) -> dict[str, Cache]:
        """Caches of those instances, by name."""
        return {name: candidate.caches[name] for name in self.instances(candidate.spec) if name in candidate.caches}

    # ---------------------------------------------------------------- rows

    def category_rows(self, candidate: Candidate, solver: str) -> Iterable[Row]:
        """Rows of the category check of one instance."""
        return ()

    def declared_rows(self, candidate: Candidate, solver: str) -> Iterable[Row]:
        """Those of them that what is declared decides at frame 0, before anything is simulated."""
        return ()

    def numerical_rows(self, candidate: Candidate, solver: str) -> Iterable[Row]:
        """Rows of the numerical check of one instance."""
        return ()

    # ---------------------------------------------------------------- motion of an entity, over the frames

    def known(self, candidate: Candidate, entity: str) -> bool:
        """True if caches tell of its motion; what they do not tell of counts as still in chains of pushes."""
        return candidate.moves(entity)

    def centers(self, candidate: Candidate, entity: str) -> F64:
        """Centre of mass [m], shape (frames, 3); NaN where nothing of it is there."""
        return motion.centers(candidate, entity)

    def mass(self, candidate: Candidate, entity: str) -> F64:
        """Mass of what is there [kg], shape (frames,)."""
        return np.full(candidate.frame_count, motion.entity_mass(candidate, entity))

    def velocities(self, candidate: Candidate, entity: str) -> F64:
        """Velocity of the centre of mass [m/s], shape (frames, 3)."""
        return motion.velocities(candidate, entity)

    def momentum(self, candidate: Candidate, entity: str) -> F64:
        """Momentum [N s], shape (frames, 3)."""
        return self.mass(candidate, entity)[:, None] * self.velocities(candidate, entity)

    def origins(self, candidate: Candidate, entity: str) -> dict[Origin, Given]:
        """Momentum that the entity got over each interval between frames, and the work on its centre of mass, by origin.

        The impulses add up to the change of its momentum: `unlisted` is what no record tells of.

        Raises:
            EvidenceError: no cache holds it, or a channel is missing or damaged.
        """
        found = origins_of(candidate, entity) if self.body else {}
        if found:
            return found
        momentum, mass = self.momentum(candidate, entity), self.mass(candidate, entity)
        step, pull = 1.0 / candidate.spec.simulation.fps, np.array(candidate.spec.simulation.gravity)
        given = {Origin("gravity", ""): 0.5 * step * (mass[:-1] + mass[1:])[:, None] * pull, **self.givers(candidate, entity)}
        given = {origin: impulse for origin, impulse in given.items() if impulse.any()}
        return with_works(np.diff(momentum, axis=0), self.velocities(candidate, entity), given)

    def givers(self, candidate: Candidate, entity: str) -> dict[Origin, F64]:
        """Impulses on the entity that its records tell apart, beside gravity [N s], each shape (frames - 1, 3)."""
        return {}

    def fastest(self, candidate: Candidate, entity: str) -> F64:
        """Speed of its fastest point, or the fastest of its instance [m/s], shape (frames,)."""
        for name, instance in self.instances(candidate.spec).items():
            if not self.body and entity in instance.members and name in candidate.caches:
                return np.asarray(candidate.caches[name].series("record/max_speed"))[: candidate.frame_count]
        return motion.fastest_points(candidate, entity)[: candidate.frame_count]

    def moving(self, candidate: Candidate, entity: str) -> Flags:
        """True where it is not still, shape (frames,)."""
        speed = np.linalg.norm(self.velocities(candidate, entity), axis=1)
        return np.asarray(~((speed <= STILL_SPEED) & (motion.spins(candidate, entity) <= STILL_SPIN)))

    # ---------------------------------------------------------------- who pushes whom

    def pushes(self, candidate: Candidate) -> list[list[Push]]:
        """Pushes between it and others, per frame."""
        return [[] for _ in range(candidate.frame_count)]

    def ties(self, spec: WorldSpec) -> list[Tie]:
        """Pairs of entities that something holds together, whatever pushes them."""
        return []

    def unfelt(self, spec: WorldSpec) -> set[tuple[str, str]]:
        """Its entities, and bodies that they do not push although these push them."""
        return set()

    def pressed(self, candidate: Candidate, entity: str, other: str) -> F64 | None:
        """Size of the impulse between an entity and another over each frame [N s], shape (frames,); None where logs of contacts tell.

        Raises:
            EvidenceError: neither logs nor records tell.
        """
        return None

    def stretch(self, candidate: Candidate, entity: str, frame: int) -> Stretch | None:
        """Stretch of a sheet at a frame, by place; None of what is no sheet.

        Raises:
            EvidenceError: no cache holds it, or a channel is missing or damaged.
        """
        return None

    def touches(self, candidate: Candidate) -> Iterator[Touch]:
        """Whom it pressed when, apart from what logs of contacts tell."""
        yield from ()

    def ruptures(self, candidate: Candidate) -> Iterator[Rupture]:
        """Entities that broke or tore.

        Raises:
            EvidenceError: a channel is missing or damaged.
        """
        yield from ()

    # ---------------------------------------------------------------- how it looks

    def amount(self, candidate: Candidate, entity: str) -> str:
        """Words for its amount; empty for a body, whose form and mass tell.

        Raises:
            EvidenceError: no cache holds it.
        """
        return ""

    def glows(self, spec: WorldSpec, entity: str) -> bool:
        """True if it is seen by light of its own, which other light drowns."""
        return False

    def outline(self, candidate: Candidate, entity: str, frame: int) -> TriangleMesh:
        """Surface in the world as cameras see it at a frame.

        Raises:
            EvidenceError: no cache holds it, or what is there is damaged.
        """
        parts = candidate.entity(entity).parts
        return joined([TriangleMesh(candidate.surface(entity, p.part, frame), p.render.faces) for p in parts])

    # ---------------------------------------------------------------- how a run ends

    def mechanical_energy(self, candidate: Candidate, solver: str) -> F64 | None:
        """Energy of an instance, stored in springs or deformation included, less the work of drivers [J], shape (frames,).

        None where a record is missing.
        """
        cache, frames = candidate.caches[solver], candidate.frame_count
        kinetic, potential = (record_of(cache, f"{n}_energy", frames) for n in ("kinetic", "potential"))
        return None if kinetic is None or potential is None else stored(cache, frames, kinetic + potential)

    def endings(self, candidate: Candidate, solver: str, span: int, kinetic: float) -> Iterator[tuple[str, str]]:
        """Entities of an instance that still move at the last frame, and how they go on.

        Args:
            candidate: what was run.
            solver: the instance.
            span: frames at the end in which contacts count.
            kinetic: kinetic energy of all at the last frame [J].
        """
        value = record_of(candidate.caches[solver], "kinetic_energy", candidate.frame_count)
        if value is not None and value[candidate.last_frame] > TOLD * kinetic:
            yield from ((member, self.goes_on) for member in candidate.spec.simulation.solvers[solver].members)

    # ---------------------------------------------------------------- approximations and corrections

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        return []

    def beat_corrections(
        self, candidate: Candidate, entity: str, outcome: Outcome, details: Mapping[str, object]
    ) -> list[Correction]:
        """Corrections for a beat or requirement about an entity that fails, from what was measured, that such matter alone has."""
        return []

    def placeholders(self, spec: WorldSpec, entity: str, row: Row) -> dict[str, Any]:
        """Names by placeholder of the diagnosis tables that its entities fill in where a row about one does not pass; None: not filled."""
        return {"slides": entity} if self.body else {}

    def domain(self, instance: SolverInstance) -> tuple[F64, F64] | None:
        """Least and greatest corner of the domain of an instance [m]; None where `lines` tell themselves whom it does not meet."""
        return None


def joined(meshes: list[TriangleMesh]) -> TriangleMesh:
    """Several meshes as one."""
    starts = np.concatenate([[0], np.cumsum([len(m.vertices) for m in meshes])])
    faces = np.concatenate([np.asarray(m.faces, dtype=np.int64) + s for m, s in zip(meshes, starts, strict=False)])
    return TriangleMesh(np.concatenate([m.vertices for m in meshes]), faces.astype(np.int32))


def stored(cache: Cache, frames: int, energy: F64) -> F64:
    """An energy [J], shape (frames,), with what is recorded as stored in sheets, less the recorded work of drivers."""
    for name, sign in (("stretch_energy", 1.0), ("bending_energy", 1.0), ("driver_work", -1.0)):
        value = record_of(cache, name, frames)
        energy = energy if value is None else energy + sign * value
    return energy
