"""Floor 3: specification to scene."""

from .build import build_entity, entity_recipe

__all__ = ["build_entity", "entity_recipe"]
