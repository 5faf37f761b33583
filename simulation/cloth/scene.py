"""Specification and built entities -> what the cloth engine is given (R63, R64)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, I32, pose_of
from ...worlds.built import TriangleMesh
from ...worlds.categories.cloth.facts import THIN, exchange_of, held_by, touching_distance
from ...worlds.errors import InputError
from ...worlds.fields import Carrier, Fields, fields_of
from ...worlds.instances import soft_met
from ..boundaries import Boundary, Surround, surround_of
from .pieces import Piece, piece_of
from .setup import Air, ClothSetup, Hold
from .wake import Breeze

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.spec import ClothPhysics, Entity, WorldSpec

__all__ = ["ClothScene", "build_scene"]

EVERYWHERE = (np.full(3, -np.inf), np.full(3, np.inf))


@dataclass(frozen=True)
class ClothScene:
    """Set-up cloth and the names behind its rows."""

    setup: ClothSetup
    surround: Surround
    pieces: tuple[Piece, ...]
    deformables: tuple[str, ...]
    """`entity/part` in the order of their vertices."""
    counts: tuple[int, ...]
    """Written vertices of each."""
    weld: I32
    """Vertex of the sheets at each written vertex."""
    holds: tuple[Hold, ...]
    """Holds of written vertices."""
    drawn: Drawn | None

    def laid(self, position: F64 | None = None, velocity: F64 | None = None) -> ClothScene:
        """The same with its sheets as far as they are whole now, with the written vertices (c, 3) where they are [m], [m/s]."""
        welds = [p.weld() for p in self.pieces]
        sheets = [p.sheet(w) for p, w in zip(self.pieces, welds, strict=True)]
        starts = np.cumsum([0, *(len(s.mass) for s in sheets)])
        weld = np.concatenate([w + o for w, o in zip(welds, starts, strict=False)]).astype(np.int32)
        first = np.unique(weld, return_index=True)[1]
        if position is not None:
            place = position[first]
            sheets = [replace(s, position=place[o : o + len(s.mass)]) for s, o in zip(sheets, starts, strict=False)]
        holds = []
        for hold in self.holds:
            vertices, one = np.unique(weld[hold.vertices], return_index=True)
            holds.append(Hold(vertices.astype(np.int32), hold.boundary, hold.place[one]))
        setup = replace(
            self.setup,
            sheets=tuple(sheets),
            holds=tuple(holds),
            velocity=None if velocity is None else velocity[first],
            acceleration=None
            if self.drawn is None
            else self.drawn.at(np.repeat([p.member for p in self.pieces], self.counts)[first]),
        )
        return replace(self, setup=setup, weld=weld)


def build_scene(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    name: str,
    *,
    without: frozenset[str] = frozenset(),
    apart: frozenset[tuple[str, str]] = frozenset(),
    media: Mapping[str, Carrier] | None = None,
) -> ClothScene:
    """Sheets, what holds them and what they meet; `without` some fields, `apart` from some entities, in `media` of instances that carry them.

    Raises:
        InputError: layers would touch where they are flat, a pin holds nothing, or a mesh cannot tear and has to.
    """
    instance, settings = spec.simulation.cloth[name], spec.simulation.cloth[name].settings
    members = list(instance.members)
    parts = [(m, p) for m in members for p in built[m].parts]
    pieces = tuple(piece_of(m, spec.entities[m], _physics(spec.entities[m]), p) for m, p in parts)
    laws = [_physics(spec.entities[p.member]) for p in pieces]
    surround = _surround(spec, built, name, members, apart)
    counts = [len(p.rest) for p in pieces]
    offsets = dict(zip([f"{m}/{p.part}" for m, p in parts], np.cumsum([0, *counts[:-1]]), strict=True))
    fields = {m: fields_of(spec, m, without, media) for m in members}
    faces = np.concatenate([np.full(len(p.faces), members.index(p.member)) for p in pieces])
    blown = any(f and f.has_medium for f in fields.values())
    drawn = any(d.field.kind == "attraction" for f in fields.values() for d in f.drivers)
    setup = ClothSetup(
        sheets=(),
        shell=tuple(_shell(piece, physics, settings.margin) for piece, physics in zip(pieces, laws, strict=True)),
        drag=tuple((physics.drag, physics.skin_drag) if blown else (0.0, 0.0) for physics in laws),
        friction=_friction(spec, members, surround),
        gravity=np.array(spec.simulation.gravity, dtype=np.float64),
        boundaries=surround.boundaries,
        air=Breeze(fields, members, faces),
        self_collision=any(_physics(spec.entities[m]).self_collision for m in members),
        integrator=settings.integrator,
        max_step=settings.max_step,
        exchange=exchange_of(spec, name),
        iterations=settings.iterations,
        device=settings.device,
    )
    holds = tuple(_holds(spec, built, members, offsets, surround))
    scene = ClothScene(
        setup,
        surround,
        pieces,
        tuple(offsets),
        tuple(counts),
        np.empty(0, dtype=np.int32),
        holds,
        Drawn(fields) if drawn else None,
    )
    start = [np.tile(np.asarray(k.linear_velocity, dtype=np.float64), (n, 1)) for k, n in zip(laws, counts, strict=True)]
    return scene.laid(velocity=np.concatenate(start))


def _shell(piece: Piece, physics: ClothPhysics, margin: float | None) -> float:
    """Half the distance at which layers touch [m].

    Raises:
        InputError: layers would touch where they are flat.
    """
    corner = piece.rest[piece.faces]
    shortest = float(np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).min())
    apart_by = touching_distance(physics.thickness, shortest, margin)
    if apart_by > THIN * shortest:
        raise InputError(
            f"layers of {piece.member!r} touch at {apart_by:g} m, more than {THIN:g} of its shortest edge {shortest:.4g} m; use longer edges"
        )
    return 0.5 * apart_by


def _physics(entity: Entity) -> ClothPhysics:
    assert entity.physics.category == "cloth"
    return entity.physics


def _surround(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, members: list[str], apart: frozenset[tuple[str, str]]
) -> Surround:
    """All rigid and elastic bodies; those that the cloth passes through have no surface."""
    through = {e for m in members for e in _physics(spec.entities[m]).ignores}
    through |= {b if a in members else a for a, b in apart if {a, b} & set(members)}
    soft = tuple(n for n in soft_met(spec, name) if n not in through)
    found = surround_of(spec, built, EVERYWHERE, 0.0, soft=soft)
    none = TriangleMesh(np.empty((0, 3)), np.empty((0, 3), dtype=np.int32))
    kept = tuple(replace(b, mesh=none) if b.name.split("/")[0] in through else b for b in found.boundaries)
    return replace(found, boundaries=kept)


def _friction(spec: WorldSpec, members: list[str], surround: Surround) -> tuple[float, ...]:
    own = max(spec.materials[spec.entities[m].material].friction for m in members)
    declared = {frozenset((c.a, c.b)): c.friction for c in spec.simulation.contacts.values() if c.friction is not None}

    def against(boundary: Boundary) -> float:
        entity = boundary.name.split("/", 1)[0]
        known = [declared[frozenset((m, entity))] for m in members if frozenset((m, entity)) in declared]
        return max(known) if known else max(own, boundary.friction)

    among = [declared[frozenset((m,))] for m in members if frozenset((m,)) in declared]
    return (max(among) if among else own, *(against(b) for b in surround.boundaries))


def _holds(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], members: list[str], offsets: Mapping[str, int], surround: Surround
) -> list[Hold]:
    found = []
    for member in members:
        pose = pose_of(spec.entities[member].pose)
        pieces = [(offsets[f"{member}/{p.part}"], p.simulation) for p in built[member].parts if p.simulation is not None]
        local = np.concatenate([mesh.vertices for _, mesh in pieces])
        rows = np.concatenate([start + np.arange(len(mesh.vertices)) for start, mesh in pieces])
        for key, pin in sorted(_physics(spec.entities[member]).pins.items()):
            held = held_by(pin, local)
            if len(held) == 0:
                raise InputError(f"pin {key!r} of {member!r} holds no vertex; widen its radius")
            world = pose.apply(local[held])
            row = -1 if pin.to is None else _holder(surround, pin.to, world, key)
            place = world if row < 0 else surround.start[row].inverse().apply(world)
            found.append(Hold(rows[held].astype(np.int32), row, place))
    return found


def _holder(surround: Surround, entity: str, points: F64, key: str) -> int:
    """Row of the body of an entity that is nearest to points."""
    rows = [k for k, b in enumerate(surround.boundaries) if b.name.split("/", 1)[0] == entity]
    if not rows:
        raise InputError(f"pin {key!r} is held by {entity!r}, no part of which collides; let a part of it collide")
    centers = [surround.start[k].apply(surround.bodies[k].center[None])[0] for k in rows]
    return rows[int(np.argmin([np.linalg.norm(points.mean(0) - c) for c in centers]))]


@dataclass(frozen=True)
class Drawn:
    """Accelerations of fields by member."""

    fields: Mapping[str, Fields]

    def at(self, owner: NDArray[np.str_]) -> Air:
        """Acceleration of the fields at vertices with these owners, as a function of points [m] and time [s]."""

        def pull(points: F64, time: float) -> F64:
            result = np.zeros((len(points), 3))
            for member, found in self.fields.items():
                own = owner == member
                if found and own.any():
                    result[own] = found.acceleration(points[own], time)
            return result

        return pull
