"""Holders of the pins of deforming bodies: entities that are one rigid body."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .fracture.facts import piece_count

if TYPE_CHECKING:
    from ..spec import Entity

__all__ = ["cannot_hold"]


def cannot_hold(entity: Entity) -> str | None:
    """Why nothing can be pinned to an entity ("which is ..."); None where it can hold: it is rigid, and one body."""
    if entity.physics.shape != "solid":
        return f"which is {entity.physics.category}; only rigid ones hold"
    if entity.generator is not None:
        bodies = f"a {entity.generator.kind} of {entity.generator.segments} bodies"
    elif entity.breakable is not None:
        bodies = f"breakable, of about {piece_count(entity)} bodies"
    else:
        return None
    return (
        f"which is {bodies}; a pin needs a holder of one body. Pin it to a rigid entity made of parts that does not break, "
        "for example a thin static or kinematic cylinder as a rod"
    )
