"""Hash of everything that decides an instance's motion, so that its cache outlives edits that do not reach it (R115, R116)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..worlds.canonical import digest_of
from ..worlds.slices import motion_slice

if TYPE_CHECKING:
    from ..worlds.built import BuiltEntity
    from ..worlds.spec import WorldSpec

__all__ = ["coupled_recipe", "recipe_of"]


def coupled_recipe(spec: WorldSpec, built: Mapping[str, BuiltEntity]) -> str:
    """Recipe of instances that step with bodies: everything that decides any motion."""
    return recipe_of(motion_slice(spec), built)


def recipe_of(settings: Any, built: Mapping[str, BuiltEntity]) -> str:
    """Hash of settings, the content of the geometry, and the present engines."""
    from .freeze import engine_versions, solver_source

    return digest_of(settings, {n: b.digest() for n, b in built.items()}, solver_source(), engine_versions())
