"""Built entities of a world on disk: built once per recipe, kept, reused."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from ..worlds.built import BuiltEntity, load_built, save_built
from ..worlds.errors import EvidenceError
from ..worlds.folder import WorldFolder
from ..worlds.spec import WorldSpec
from .build import build_entity, entity_recipe

__all__ = ["build_world", "built_paths"]


def build_world(
    folder: WorldFolder, spec: WorldSpec, only: Iterable[str] | None = None
) -> tuple[dict[str, BuiltEntity], list[str]]:
    """Build the entities whose recipe has no file yet; returns all (or `only`) and the names newly built.

    Raises:
        InputError: an entity cannot be built.
    """
    built: dict[str, BuiltEntity] = {}
    fresh: list[str] = []
    made: dict[str, BuiltEntity] = {}
    kept: dict[bytes, Any] = {}
    for name in spec.entities if only is None else only:
        recipe = entity_recipe(spec, name, folder.assets)
        path = folder.built(name, recipe)
        try:
            built[name] = load_built(path, kept=kept)
            continue
        except EvidenceError:
            # Twenty plates are one: entities of one recipe differ in their name alone.
            built[name] = replace(made[recipe], entity=name) if recipe in made else build_entity(spec, name, folder.assets)
            made[recipe] = built[name]
        save_built(built[name], path)
        fresh.append(name)
    return built, fresh


def built_paths(folder: WorldFolder, spec: WorldSpec) -> dict[str, str]:
    """Relative file of every built entity under its present recipe."""
    return {n: folder.relative(folder.built(n, entity_recipe(spec, n, folder.assets))) for n in spec.entities}
