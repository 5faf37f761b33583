"""Cloth as its checks see it: vertices by frame, edges and triangles at rest, pins, solids around."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64, I32, compose, pose_of
from ....worlds.categories.cloth.facts import exchange_of, held_by, release_time
from ....worlds.errors import EvidenceError
from ....worlds.instances import soft_met
from ...rows.corrections import halve_step
from ...rows.findings import Finding

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction
    from ....worlds.spec import ClothPhysics

__all__ = ["ClothRun", "Held", "Piece", "Solid", "at_most", "cloth_run", "halved"]


@dataclass(frozen=True)
class Piece:
    """One part of one cloth entity, at rest."""

    entity: str
    part: str
    rows: slice
    """Rows of the channels `vertex/*`."""
    vertices: F64
    """In the entity's frame (n, 3) [m]."""
    faces: I32
    """Among all vertices of the instance."""
    edges: I32
    """The same."""
    length: F64
    """Lengths of the edges at rest [m]."""
    area: F64
    """Areas of the triangles at rest [m^2]."""
    physics: ClothPhysics


@dataclass(frozen=True)
class Held:
    """Vertices that a pin holds."""

    entity: str
    pin: str
    rows: I32
    to: str | None
    place: F64
    """(k, 3): in the world at frame 0 [m]."""


@dataclass(frozen=True)
class Solid:
    """Visible surface of a part of a rigid entity that collides, or of an elastic one."""

    entity: str
    part: str
    faces: I32


class ClothRun:
    """One cloth instance of a candidate."""

    def __init__(self, candidate: Candidate, solver: str) -> None:
        self.candidate, self.solver = candidate, solver
        if solver not in candidate.caches:
            raise EvidenceError(f"instance {solver!r} has no cache yet; probe or bake it")
        self.cache: Cache = candidate.caches[solver]
        self.pieces = tuple(self._pieces())

    def _pieces(self) -> Iterator[Piece]:
        start = 0
        for name, count in zip(self.cache.index.deformables, self.cache.index.vertices, strict=True):
            entity, part = name.split("/", 1)
            built = next((p for p in self.candidate.entity(entity).parts if p.part == part), None)
            physics = self.candidate.spec.entities[entity].physics
            if (
                built is None
                or built.simulation is None
                or len(built.simulation.vertices) != count
                or physics.category != "cloth"
            ):
                raise EvidenceError(f"the cache of {name} does not belong to what is built; bake again")
            x, faces = built.simulation.vertices, built.simulation.faces
            edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
            cross = np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]])
            yield Piece(
                entity,
                part,
                slice(start, start + count),
                x,
                (faces + start).astype(np.int32),
                (edges + start).astype(np.int32),
                np.linalg.norm(x[edges[:, 0]] - x[edges[:, 1]], axis=1),
                0.5 * np.linalg.norm(cross, axis=1),
                physics,
            )
            start += count

    @cached_property
    def start(self) -> float:
        """When it is let go [s]."""
        return max(0.0, release_time(self.candidate.spec, self.solver))

    @cached_property
    def mass(self) -> F64:
        """Mass of every vertex [kg], from area and area density."""
        total = np.zeros(sum(self.cache.index.vertices))
        for piece in self.pieces:
            np.add.at(total, piece.faces.ravel(), np.repeat(piece.physics.area_density * piece.area / 3.0, 3))
        return total

    @cached_property
    def kin(self) -> I32 | None:
        """The vertex of the whole sheet that each vertex belongs to; None where nothing can tear. The lips of a tear pass each other."""
        if not any(p.physics.tear for p in self.pieces):
            return None
        found, start = [], 0
        for piece in self.pieces:
            _, own = np.unique(piece.vertices, axis=0, return_inverse=True)
            own = own.ravel() if piece.physics.tear is not None else np.arange(len(piece.vertices))
            found.append(own + start)
            start += len(piece.vertices)
        return np.concatenate(found).astype(np.int32)

    @cached_property
    def held(self) -> tuple[Held, ...]:
        """All pins."""
        found = []
        for entity in dict.fromkeys(p.entity for p in self.pieces):
            own = [p for p in self.pieces if p.entity == entity]
            local = np.concatenate([p.vertices for p in own])
            rows = np.concatenate([np.arange(p.rows.start, p.rows.stop) for p in own])
            pose = pose_of(self.candidate.spec.entities[entity].pose)
            for key, pin in own[0].physics.pins.items():
                which = held_by(pin, local)
                found.append(Held(entity, key, rows[which].astype(np.int32), pin.to, pose.apply(local[which])))
        return tuple(found)

    @cached_property
    def solids(self) -> tuple[Solid, ...]:
        """Surfaces of rigid entities that collide and of elastic ones, but for those that every member passes through."""
        ignored = set.intersection(*(set(p.physics.ignores) for p in self.pieces)) if self.pieces else set()
        spec, found = self.candidate.spec, []
        soft = soft_met(spec, self.solver)
        for name, contract in spec.entities.items():
            if (contract.physics.category != "rigid" and name not in soft) or name in ignored:
                continue
            for part in self.candidate.entity(name).parts:
                if part.collision or name in soft:
                    found.append(Solid(name, part.part, part.render.faces))
        return tuple(found)

    def frame(self, frame: int) -> tuple[F64, F64]:
        """Vertices [m] and their velocities [m/s], (n, 3) each.

        Raises:
            EvidenceError: a channel is missing, has another shape, or is not finite.
        """
        data = self.cache.read(frame, ("vertex/position", "vertex/velocity"))
        x, v = (np.asarray(data[n], dtype=np.float64) for n in ("vertex/position", "vertex/velocity"))
        if x.shape != (len(self.mass), 3) or v.shape != x.shape:
            raise EvidenceError(f"frame {frame} of {self.solver!r} has {x.shape} vertices, not {(len(self.mass), 3)}; bake again")
        if not (np.isfinite(x).all() and np.isfinite(v).all()):
            raise EvidenceError(f"frame {frame} of {self.solver!r} is not finite")
        return x, v

    @cached_property
    def sums(self) -> tuple[F64, F64, F64]:
        """Momentum (F, 3) [N s], kinetic and potential energy (F,) [J] of the vertices."""
        gravity = np.array(self.candidate.spec.simulation.gravity)
        momenta, kinetic, potential = [], [], []
        for k in range(self.candidate.frame_count):
            x, v = self.frame(k)
            momenta.append(self.mass @ v)
            kinetic.append(0.5 * float(self.mass @ (v**2).sum(1)))
            potential.append(-float(self.mass @ (x @ gravity)))
        return np.array(momenta), np.array(kinetic), np.array(potential)

    def record(self, name: str) -> F64:
        """A recorded quantity by frame.

        Raises:
            EvidenceError: it is not there.
        """
        return np.asarray(self.cache.series(f"record/{name}"), dtype=np.float64)[: self.candidate.frame_count]

    def led(self, held: Held, frame: int) -> F64 | None:
        """Where a pin's vertices ought to be at a frame (k, 3) [m]; None where its holder has several bodies."""
        if held.to is None:
            return held.place
        bodies = self.candidate.entity(held.to).bodies
        if len(bodies) != 1:
            return None
        base = compose(pose_of(self.candidate.spec.entities[held.to].pose), bodies[0].pose)
        return self.candidate.pose(held.to, frame, bodies[0].name).apply(base.inverse().apply(held.place))


def at_most(text: str, value: float, bound: float, unit: str, frame: int, *hints: Correction) -> Finding:
    """Finding about the largest value, at a frame, against its bound."""
    return Finding("pass" if value <= bound else "fail", text, value, bound, unit, frame=frame, hints=hints)


def halved(run: ClothRun, cause: str) -> Correction:
    """Halve the step that is in force: cloth looks at bodies that it pushes more often than its longest step says."""
    return halve_step(run.candidate, run.solver, cause, in_force=exchange_of(run.candidate.spec, run.solver))


def cloth_run(candidate: Candidate, solver: str) -> ClothRun:
    """The run of an instance, kept with its candidate."""
    return candidate.memo(("cloth run", solver), lambda: ClothRun(candidate, solver))
