"""Floor 3: specification to scene."""

from .build import build_entity, entity_recipe
from .store import build_world, built_paths

__all__ = ["build_entity", "build_world", "built_paths", "entity_recipe"]
