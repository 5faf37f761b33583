"""Words of a clause that name what only a landscape has, and whether the specification has it (R155)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from ..spec import WorldSpec

__all__ = ["missing_scenery", "names_scenery"]

_WORDS: Mapping[str, re.Pattern[str]] = {
    kind: re.compile(rf"\b(?:{words})\b", re.IGNORECASE)
    for kind, words in {
        "lake": "lakes?|ponds?|lakeside|lakeshore",
        "river": "rivers?|riverbanks?",
        "stream": "streams?|brooks?|creeks?",
        "sea": "sea|seas|ocean|coasts?|beach|beaches|island|islands",
        "trees": "trees|forests?|woods|woodland",
    }.items()
}

_OPEN_SEA = ("sea", "seas", "ocean")
"""Without a shore."""


def names_scenery(text: str) -> bool:
    """Whether a clause names water of a landscape."""
    return any(pattern.search(text) for kind, pattern in _WORDS.items() if kind != "trees")


def missing_scenery(spec: WorldSpec, text: str) -> Iterator[tuple[str, str, str]]:
    """Scenery that a clause names and nothing holds: (word, kind, what to declare).

    A landscape holds water that its hydrology requires, and trees where its vegetation has the form; a static entity that is
    called so holds it, too (a toy lake, a painted forest). A sea is also the liquid in which a driver makes waves.
    """
    waves = any(d.kind == "waves" for d in spec.simulation.drivers.values())
    for kind, pattern in _WORDS.items():
        found = pattern.search(text)
        if found is None or any(
            e.motion == "static" and pattern.search(f"{name.replace('_', ' ').replace('-', ' ')} {e.role}")
            for name, e in spec.entities.items()
        ):
            continue
        if kind == "sea" and waves and all(m.group().lower() in _OPEN_SEA for m in pattern.finditer(text)):
            continue
        if kind == "trees":
            if not any(t.vegetation is not None and "tree" in t.vegetation.grown() for t in spec.terrains.values()):
                yield found.group(), kind, "a terrain with /terrains/<id>/vegetation"
        elif not any(
            kind in t.hydrology.required or ("river" in t.hydrology.required and kind == "stream") for t in spec.terrains.values()
        ):
            yield found.group(), kind, f"a terrain with {kind!r} in /terrains/<id>/hydrology/required"
