"""Bases of the models of a category: the physics that an entity declares, and the instance that moves it."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from .vocabulary import SpecModel

__all__ = ["Instance", "Matter", "MatterShape"]

MatterShape = Literal["solid", "deforming", "loose"]
"""`solid`: surfaces that keep their form; `deforming`: surfaces that bend; `loose`: matter without a surface of its own."""


class Matter(SpecModel):
    """Physics of an entity of one category, a member of the union `Physics`."""

    shape: ClassVar[MatterShape]
    feels_fields: ClassVar[bool] = False
    """Whether force fields act on it."""

    def geometry(self) -> dict[str, Any]:
        """Fields on which the geometry and mass of the entity depend, for recipes."""
        return {}


class Instance(SpecModel):
    """A running engine with the entities that it moves, a member of the union `SolverInstance`."""

    moves: ClassVar[tuple[str, ...]]
    """Categories of the members that it moves."""
    meets: ClassVar[tuple[str, ...]] = ()
    """Deforming categories whose surfaces its matter meets: elastic bodies always, cloth where a coupling joins them."""
