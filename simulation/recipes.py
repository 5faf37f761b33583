"""Hash of everything that decides an instance's motion, so that its cache outlives edits that do not reach it (R115, R116)."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..worlds.canonical import digest_of
from ..worlds.categories.loose import domain_box, loose_slice
from ..worlds.instances import soft_met
from ..worlds.slices import motion_slice

if TYPE_CHECKING:
    from ..worlds.built import BuiltEntity
    from ..worlds.cache import Cache
    from ..worlds.spec import WorldSpec

__all__ = ["coupled_recipe", "reader_recipe", "recipe_of"]


def coupled_recipe(spec: WorldSpec, built: Mapping[str, BuiltEntity]) -> str:
    """Recipe of instances that step with bodies: everything that decides any motion."""
    return recipe_of(motion_slice(spec), built)


def recipe_of(settings: Any, built: Mapping[str, BuiltEntity]) -> str:
    """Hash of settings, the content of the geometry, and the present engines."""
    from .freeze import engine_versions, solver_source

    return digest_of(settings, {n: b.digest() for n, b in built.items()}, solver_source(), engine_versions())


def reader_recipe(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, caches: Mapping[str, Cache], *, margin: float, rough: bool
) -> str:
    """Recipe of loose matter that reads the bodies' motion: itself, the solids that meet its domain, and the paths of moving ones.

    Args:
        spec: the specification.
        built: its geometry.
        name: the instance.
        caches: of the instances that it reads.
        margin: how far outside its domain solids count [m].
        rough: whether the materials of solids decide too.
    """
    from .boundaries import meets_domain

    if soft_met(spec, name):
        return coupled_recipe(spec, built)
    instance: Any = spec.simulation.solvers[name]
    solids = [n for n, e in spec.entities.items() if e.physics.shape == "solid"]
    meeting = sorted(n for n in solids if meets_domain(spec.entities[n], built[n], domain_box(instance), margin))
    settings = [loose_slice(spec, name, meeting, rough=rough), _paths(spec, meeting, caches)]
    return recipe_of(settings, {n: built[n] for n in (*instance.members, *meeting)})


def _paths(spec: WorldSpec, meeting: list[str], caches: Mapping[str, Cache]) -> dict[str, str]:
    """Hash of the motion of every moving body among them."""
    found = {}
    moving = {n for n in meeting if spec.entities[n].motion != "static"}
    for cache in caches.values():
        rows = [(k, b) for k, b in enumerate(cache.index.bodies) if b.split("/", 1)[0] in moving]
        if rows:
            position, quaternion = cache.series("position"), cache.series("quaternion")
            for row, body in rows:
                held = np.concatenate([position[:, row], quaternion[:, row]], axis=1)
                found[body] = hashlib.sha256(np.ascontiguousarray(held).tobytes()).hexdigest()
    return found
