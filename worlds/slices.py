"""Slices of a specification from which geometry and motion follow (R115)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from .documents import document_of
from .spec import Fastened

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["MOTION_VERSION", "fastened_pairs", "geometry_slice", "motion_slice", "physical_materials"]

MOTION_VERSION = "1"
"""Version of what decides geometry and motion, in their digests: that of the specification is no part of them."""


def physical_materials(materials: Mapping[str, Any]) -> dict[str, Any]:
    """Materials as JSON without their looks; those that cannot burn say nothing of it."""
    return {
        k: m.model_dump(mode="json", exclude={"appearance", "of", "departs", *(["flammable"] if m.flammable is None else [])})
        for k, m in materials.items()
    }


def geometry_slice(spec: WorldSpec, name: str) -> dict[str, Any]:
    """Everything that decides the geometry and mass of one entity."""
    entity, document = spec.entities[name], document_of(spec)["entities"][name]
    names = {entity.material, *(p.material for p in entity.parts.values() if p.material)}
    return {
        **({} if entity.breakable is None else {"breakable": entity.breakable.model_dump(mode="json", exclude={"bond"})}),
        "parts": {k: p.model_dump(mode="json", exclude_defaults=True) for k, p in entity.parts.items()},
        "generator": document["generator"],
        "material": entity.material,
        "densities": {n: spec.materials[n].density for n in sorted(names) if n in spec.materials},
        "mass": None,
        **entity.physics.geometry(),
    }


def fastened_pairs(spec: WorldSpec) -> list[list[str]]:
    """Pairs of entities that are declared to overlap and of which one moves, sorted: the rigid engine opens no skins between them."""
    moving = {n for n, e in spec.entities.items() if e.motion != "static"}
    pairs = {frozenset((r.a, r.b)) for r in spec.graph.relations.values() if isinstance(r, Fastened)}
    return sorted(sorted(p) for p in pairs if p & moving)


def motion_slice(spec: WorldSpec, geometries: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Everything that decides the motion: entities' physics and places, materials, the plan without its limits.

    Args:
        spec: the specification.
        geometries: slices of the geometry of its entities, where the caller has them.
    """
    document = document_of(spec)
    entities = document["entities"]
    used = {e.material for e in spec.entities.values()} | {
        p.material for e in spec.entities.values() for p in e.parts.values() if p.material
    }
    fastened = fastened_pairs(spec)
    return {
        "spec_version": MOTION_VERSION,
        **({"fastened": fastened} if fastened else {}),
        "entities": {
            k: {
                "geometry": geometry_slice(spec, k) if geometries is None else geometries[k],
                "pose": entities[k]["pose"],
                "motion": e.motion,
                "physics": {n: v for n, v in entities[k]["physics"].items() if (n, v) != ("lift", False)},
                "active": e.active,
                **({} if e.breakable is None else {"bond": entities[k]["breakable"]["bond"]}),
            }
            for k, e in spec.entities.items()
        },
        "materials": physical_materials({k: spec.materials[k] for k in sorted(used) if k in spec.materials}),
        "plan": {k: v for k, v in document["simulation"].items() if k != "limits" and (k, v) != ("settle", None)},
    }
