"""Rows about pins of cloth and of elastic bodies: they reach the visible surfaces of the bodies that carry them (R92, R154)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, pose_of
from ...worlds.categories.cloth.facts import grids_of, held_by
from ...worlds.requirements import Correction, RowId
from ...worlds.spec import ClothPhysics, ElasticPhysics
from ..rows.guards import guarded_rows, pointer, translation_patch
from ..rows.verdicts import make_row
from .joined import way_to

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ...worlds.spec import Entity
    from ..scene.surfaces import Surfaces

__all__ = ["pinned_rows"]


def pinned_rows(surfaces: Surfaces) -> list[Row]:
    """Rows `support:pin:<entity>:<pin>` of every pin that a body carries."""
    candidate, found = surfaces.candidate, []
    for name, entity in candidate.spec.entities.items():
        if not isinstance(entity.physics, ClothPhysics | ElasticPhysics):
            continue
        for key, pin in entity.physics.pins.items():
            if pin.to is not None and pin.to in candidate.solids:
                found += guarded_rows(
                    candidate,
                    lambda n=name, k=key, c=pin.to: [_row(surfaces, n, k, c)],  # type: ignore[misc]
                    row_id=RowId("support:pin", name, key),
                    predicate=_predicate(name, key, pin.to),
                    entities=(name, pin.to),
                )
    return found


def _predicate(name: str, key: str, carrier: str) -> str:
    return f"what pin {key} of {name} holds is at {carrier}"


def _held(entity: Entity, key: str, rest: F64) -> F64:
    """Vertices that a pin holds, of all of them in the entity's frame [m]: shape (n, 3) -> (k, 3)."""
    physics = entity.physics
    if isinstance(physics, ClothPhysics):
        return rest[held_by(physics.pins[key], rest)]
    assert isinstance(physics, ElasticPhysics)
    pin = physics.pins[key]
    inside: NDArray[np.bool_] = (np.abs(rest - np.array(pin.center)) <= 0.5 * np.array(pin.size) * (1 + 1e-9)).all(axis=1)
    return rest[inside]


def _bound(surfaces: Surfaces, name: str, carrier: str) -> float:
    """How far what is held may be from its carrier [m]: the contact tolerance (S3), collision skins, an edge of a sheet's triangles."""
    entity = surfaces.candidate.spec.entities[name]
    edges = [edge for _, edge in grids_of(entity)] if isinstance(entity.physics, ClothPhysics) else []
    skins = [s.settings.skin for s in surfaces.candidate.spec.simulation.rigid.values() if carrier in s.members]
    return max(surfaces.contact_gap(name, carrier) + 2.0 * max(skins, default=0.0), min(edges, default=0.0))


def _row(surfaces: Surfaces, name: str, key: str, carrier: str) -> Row:
    candidate = surfaces.candidate
    entity = candidate.spec.entities[name]
    surfaces.require(name, carrier)
    rest = [p.simulation.vertices for p in candidate.entity(name).parts if p.simulation is not None]
    held = pose_of(entity.pose).apply(_held(entity, key, np.concatenate(rest)))
    common: dict[str, Any] = {
        "row_id": RowId("support:pin", name, key),
        "predicate": _predicate(name, key, carrier),
        "frames": (0, 0),
        "entities": (name, carrier),
    }
    distance, point, nearest = way_to(surfaces, carrier, held)
    way = nearest - point
    bound = _bound(surfaces, name, carrier)
    if distance <= bound:
        text = f"what pin {key!r} of {name!r} holds is {distance:.3g} m from {carrier!r}"
        return make_row(
            candidate, status="pass", explanation=text, measured=distance, bound=bound, comparison="<=", unit="m", **common
        )
    move = ", ".join(f"{c:+.4g}" for c in way)
    place = pointer("entities", name, "physics", "pins", key)
    return make_row(
        candidate,
        status="fail",
        explanation=f"pin {key!r} holds {name!r} to {carrier!r} over {distance:.4g} m of nothing",
        measured=distance,
        bound=bound,
        comparison="<=",
        unit="m",
        first_failing_frame=0,
        corrections=[
            Correction(
                cause=f"{name!r} is placed away from what carries it",
                edit_class="scene",
                group="placement",
                action=f"Move it by ({move}) m, to {carrier!r}.",
                pointers=(pointer("entities", name, "pose"),),
                patch=translation_patch(candidate, name, way),
            ),
            Correction(
                cause="the pin holds another place than the one that touches its carrier, or what joins them is not drawn",
                edit_class="scene",
                group="joints",
                action=f"Let it hold what is at {carrier!r}, or give {carrier!r} a part (a ring, hook or rail) that reaches it.",
                pointers=(place, pointer("entities", carrier, "parts")),
            ),
        ],
        **common,
    )
