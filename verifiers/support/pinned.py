"""Rows about pins of cloth and of elastic bodies: they reach the visible surfaces of the bodies that carry them (R92, R154)."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, pose_of
from ...worlds.categories.cloth.facts import grids_of, held_by
from ...worlds.spec import ClothPhysics, ElasticPhysics
from ..rows.answers import row_of
from ..rows.corrections import correction, move_by, pointer
from ..rows.findings import Finding
from .joined import way_to
from .questions import PIN

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ...worlds.spec import Entity
    from ..scene.surfaces import Surfaces

__all__ = ["pin_bound", "pinned_points", "pinned_rows", "pinned_vertices"]


def pinned_rows(surfaces: Surfaces) -> list[Row]:
    """Rows `support:pin:<entity>:<pin>` of every pin that a body carries."""
    candidate, found = surfaces.candidate, []
    for name, entity in candidate.spec.entities.items():
        if not isinstance(entity.physics, ClothPhysics | ElasticPhysics):
            continue
        for key, pin in entity.physics.pins.items():
            if pin.to is not None and pin.to in candidate.solids:
                judge = partial(_pin, surfaces, name, key, pin.to)
                found.append(row_of(candidate, PIN, (name, key), judge, entities=(name, pin.to)))
    return found


def pinned_points(entity: Entity, key: str, rest: F64) -> F64:
    """Vertices that a pin holds, of all of them in the entity's frame [m]: shape (n, 3) -> (k, 3)."""
    return rest[pinned_vertices(entity, key, rest)]


def pinned_vertices(entity: Entity, key: str, rest: F64) -> NDArray[np.intp]:
    """Rows of the vertices that a pin holds, of all of them in the entity's frame [m]: shape (n, 3) -> (k,)."""
    physics = entity.physics
    if isinstance(physics, ClothPhysics):
        return np.asarray(held_by(physics.pins[key], rest), dtype=np.intp)
    assert isinstance(physics, ElasticPhysics)
    pin = physics.pins[key]
    inside: NDArray[np.bool_] = (np.abs(rest - np.array(pin.center)) <= 0.5 * np.array(pin.size) * (1 + 1e-9)).all(axis=1)
    return np.flatnonzero(inside)


def pin_bound(surfaces: Surfaces, name: str, carrier: str) -> float:
    """Largest distance of held vertices from their carrier [m]: the contact tolerance (S3), collision skins, an edge of a sheet's triangles."""
    entity = surfaces.candidate.spec.entities[name]
    edges = [edge for _, edge in grids_of(entity)] if isinstance(entity.physics, ClothPhysics) else []
    skins = [s.settings.skin for s in surfaces.candidate.spec.simulation.rigid.values() if carrier in s.members]
    return max(surfaces.contact_gap(name, carrier) + 2.0 * max(skins, default=0.0), min(edges, default=0.0))


def _pin(surfaces: Surfaces, name: str, key: str, carrier: str) -> Finding:
    candidate = surfaces.candidate
    entity = candidate.spec.entities[name]
    surfaces.require(name, carrier)
    rest = [p.simulation.vertices for p in candidate.entity(name).parts if p.simulation is not None]
    held = pose_of(entity.pose).apply(pinned_points(entity, key, np.concatenate(rest)))
    distance, point, nearest = way_to(surfaces, carrier, held)
    way = nearest - point
    bound = pin_bound(surfaces, name, carrier)
    common: dict[str, Any] = {"frames": (0, 0), "predicate": f"what pin {key} of {name} holds is at {carrier}"}
    if distance <= bound:
        text = f"what pin {key!r} of {name!r} holds is {distance:.3g} m from {carrier!r}"
        return Finding("pass", text, distance, bound, **common)
    move = ", ".join(f"{c:+.4g}" for c in way)
    place = pointer("entities", name, "physics", "pins", key)
    return Finding(
        "fail",
        f"pin {key!r} holds {name!r} to {carrier!r} over {distance:.4g} m of nothing",
        distance,
        bound,
        hints=(
            move_by(
                candidate,
                name,
                way,
                f"{name!r} is placed away from what carries it",
                f"Move it by ({move}) m, to {carrier!r}.",
            ),
            correction(
                "the pin holds another place than the one that touches its carrier, or what joins them is not drawn",
                "joints",
                f"Let it hold what is at {carrier!r}, or give {carrier!r} a part (a ring, hook or rail) that reaches it.",
                pointers=(place, pointer("entities", carrier, "parts")),
            ),
        ),
        **common,
    )
