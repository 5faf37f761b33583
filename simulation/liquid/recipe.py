"""Hash of everything that decides the motion of a liquid that no body feels, so that its cache outlives edits that do not reach it (R115)."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.canonical import digest_of
from ...worlds.categories.liquid.facts import spacing_of
from ...worlds.categories.liquid.recipe import liquid_slice
from ...worlds.categories.loose import domain_box
from ...worlds.instances import soft_met
from ..boundaries import meets_domain
from ..freeze import engine_versions, solver_source
from ..recipes import coupled_recipe
from .scene import MARGIN

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.cache import Cache
    from ...worlds.spec import WorldSpec

__all__ = ["liquid_recipe"]


def liquid_recipe(spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, caches: Mapping[str, Cache]) -> str:
    """Recipe of a liquid that reads the bodies' motion: itself, the solids that meet its domain, and the paths of moving ones."""
    if soft_met(spec, name):
        return coupled_recipe(spec, built)
    instance = spec.simulation.liquid[name]
    box, margin = domain_box(instance), MARGIN * spacing_of(spec, name)
    solids = [n for n, e in spec.entities.items() if e.physics.shape == "solid"]
    meeting = sorted(n for n in solids if meets_domain(spec.entities[n], built[n], box, margin))
    content = {n: built[n].digest() for n in (*instance.members, *meeting)}
    return digest_of(
        liquid_slice(spec, name, meeting), content, _paths(spec, meeting, caches), solver_source(), engine_versions()
    )


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
