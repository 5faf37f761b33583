"""The layers of pictures by category of matter. A new category is a module or a folder beside these and a line here."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from ...worlds.built import BuiltPart
from ...worlds.candidate import Candidate
from ...worlds.categories.category import declares
from ...worlds.categories.registry import CATEGORIES
from ...worlds.errors import InputError
from ...worlds.spec import Entity
from .breakable import BreakableLayer
from .deforming import DeformingLayer
from .gas.layer import GasLayer
from .layer import Layer, LooseLayer, PartsLayer
from .liquid.layer import LiquidLayer
from .particles.layer import GrainLayer

__all__ = ["LAYERS", "Layers", "layers_of"]

LAYERS: dict[str, type[Layer]] = {
    "rigid": PartsLayer,
    "fracture": BreakableLayer,
    "elastic": DeformingLayer,
    "cloth": DeformingLayer,
    "liquid": LiquidLayer,
    "particles": GrainLayer,
    "gas": GasLayer,
}
"""By name of the category in `worlds/categories/registry.py`."""


def category_of(entity: Entity) -> str:
    """Name of the category that an entity is drawn as: that of its physics, or what it declares beside it."""
    return [name for name, category in CATEGORIES.items() if declares(category, entity)][-1]


@dataclass(frozen=True)
class Layers:
    """All layers of one candidate."""

    layers: tuple[Layer, ...]
    of: dict[str, Layer]
    """Layer by entity, of all that is built or in a cache."""
    undrawn: dict[str, str]
    """Built entities of a category without a layer, with that category."""

    @cached_property
    def parts(self) -> list[tuple[PartsLayer, str, BuiltPart]]:
        """Layer, entity and part of all bodies, by entity id."""
        found = [
            (layer, entity, part)
            for layer in self.layers
            if isinstance(layer, PartsLayer)
            for entity in layer.entities
            for part in layer.candidate.built[entity].parts
        ]
        return sorted(found, key=lambda one: one[1])

    @cached_property
    def loose(self) -> tuple[LooseLayer, ...]:
        """Layers of loose matter that there is."""
        return tuple(layer for layer in self.layers if isinstance(layer, LooseLayer) and layer.entities)

    @property
    def note(self) -> str:
        """Words for a picture that leaves something out; empty where it shows everything."""
        return "  not drawn: " + ", ".join(f"{n} ({c})" for n, c in self.undrawn.items()) if self.undrawn else ""

    def refuse_undrawn(self) -> None:
        """Refuse to draw only a part of the candidate.

        Raises:
            InputError: an entity is of a category without a layer.
        """
        for entity, category in self.undrawn.items():
            raise InputError(
                f"entity {entity!r} is of category {category!r}, which pictures do not draw; drawn are {', '.join(LAYERS)}; "
                "leave it out, or look at a preview, which says what it leaves out"
            )


def layers_of(candidate: Candidate) -> Layers:
    """The layers that draw a candidate."""
    members: dict[str, list[str]] = {}
    for entity in sorted(candidate.built):
        members.setdefault(category_of(candidate.spec.entities[entity]), []).append(entity)
    made = {name: layer(candidate, members.get(name, ())) for name, layer in LAYERS.items()}
    of = {entity: layer for name, layer in made.items() for entity in (*members.get(name, ()), *layer.entities)}
    return Layers(tuple(made.values()), of, {n: c for c, names in members.items() if c not in LAYERS for n in names})
