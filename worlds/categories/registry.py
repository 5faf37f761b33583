"""The categories of matter. A new one is a package beside these and a line here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..matter import MatterShape
from ..parameters import Parameter
from .category import CategorySpec
from .cloth.category import CLOTH
from .elastic.category import ELASTIC
from .fracture.category import FRACTURE
from .gas.category import GAS
from .liquid.category import LIQUID
from .particles.category import PARTICLES
from .rigid.category import RIGID

if TYPE_CHECKING:
    from ..spec import Entity

__all__ = ["CATEGORIES", "PARAMETERS", "shape_of"]

CATEGORIES: Mapping[str, CategorySpec] = {
    category.name: category
    for category in (
        RIGID,
        LIQUID,
        ELASTIC,
        CLOTH,
        PARTICLES,
        FRACTURE,
        GAS,
    )
}
"""All categories by name: that of `physics.category`, and `fracture` for rigid bodies that may break."""


def shape_of(entity: Entity) -> MatterShape:
    """`solid`, `deforming` or `loose`, by the category of the entity."""
    return entity.physics.shape


PARAMETERS: Mapping[str, Parameter] = {p.pointer: p for c in CATEGORIES.values() for p in c.parameters}
"""Fields of all categories by pointer; those that several categories have are alike in group and direction."""
