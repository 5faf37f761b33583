"""All generators by name, from an explicit list, and how they are found by words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...worlds.errors import InputError
from ...worlds.hints import did_you_mean
from . import (
    appliances,
    basins,
    bathrooms,
    bedroom,
    benches,
    boats,
    books,
    candles,
    cannons,
    carts,
    castles,
    catapults,
    chairs,
    containers,
    cookware,
    cordage,
    fences,
    food,
    frames,
    garden_tools,
    halls,
    hand_tools,
    kitchens,
    lamps,
    luggage,
    machines,
    masonry,
    mills,
    music,
    openings,
    paving,
    playthings,
    railings,
    rocks,
    roofs,
    sofas,
    stairs,
    stairwells,
    storage,
    streets,
    swinging,
    tables,
    tableware,
    textiles,
    timber,
    towers,
    toys,
    umbrellas,
    vessels,
    wall_hung,
    wells,
    worktops,
)
from .generator import Generator
from .made import Made

__all__ = ["GENERATORS", "found", "generator", "make"]

MODULES = (
    appliances,
    basins,
    bathrooms,
    bedroom,
    benches,
    boats,
    books,
    candles,
    carts,
    castles,
    cannons,
    catapults,
    chairs,
    containers,
    cookware,
    cordage,
    fences,
    food,
    frames,
    garden_tools,
    halls,
    hand_tools,
    kitchens,
    lamps,
    luggage,
    machines,
    masonry,
    mills,
    music,
    openings,
    paving,
    playthings,
    railings,
    rocks,
    roofs,
    sofas,
    stairs,
    stairwells,
    storage,
    streets,
    swinging,
    tables,
    tableware,
    textiles,
    timber,
    towers,
    toys,
    umbrellas,
    vessels,
    wall_hung,
    wells,
    worktops,
)
"""Modules that each list their generators in `GENERATORS`."""
GENERATORS: Mapping[str, Generator] = {g.name: g for module in MODULES for g in module.GENERATORS}


def generator(name: str) -> Generator:
    """The generator of a name.

    Raises:
        InputError: there is none.
    """
    if name not in GENERATORS:
        by_words = found(name)[:3]
        hint = f"; its words find {', '.join(by_words)};" if by_words else did_you_mean(name, GENERATORS) or ";"
        raise InputError(f"there is no generator {name[:60]!r}{hint} inspect_world(part='assets', query=...) finds them by words")
    return GENERATORS[name]


def make(name: str, parameters: Mapping[str, Any], seed: int) -> Made:
    """Bodies of one such thing, see `Generator.make`."""
    return generator(name).make(parameters, seed)


def found(query: str) -> list[str]:
    """Names of generators that a query means: those that are called so first, then those that have more of its words."""
    words = [w for w in query.lower().replace("-", " ").replace("_", " ").replace(",", " ").split() if w]

    def score(entry: Generator) -> float:
        named = set(entry.name.split("_"))
        own = named | set(entry.tags) | set(entry.summary.lower().replace(",", " ").split())
        whole = entry.name.replace("_", "")  # `flowerpot` means the flower_pot
        return sum(
            3.0 * (w in named or w.rstrip("s") in named or whole in (w, w.rstrip("s"))) + (w in own or w.rstrip("s") in own)
            for w in words
        )

    ranked = sorted(((score(g), n) for n, g in GENERATORS.items()), key=lambda s: (-s[0], s[1]))
    return [n for s, n in ranked if s > 0]
