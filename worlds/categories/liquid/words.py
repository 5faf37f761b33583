"""Words of a clause that tell of a liquid, and whether the specification simulates one for them (R66, R155).

Water that is only painted geometry is no evidence: what pours, floods, splashes or floats is a liquid entity with an engine. Water
that nothing moves in may be a landscape's. English word lists that err towards asking; `static_because` is the way out.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from ...audits.scenery_words import names_scenery
from ...predicate_base import entities_of

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["missing_liquid"]

_LIQUIDS = (
    r"water|seawater|lava|magma|oil|petrol|milk|juice|coffee|tea|wine|beer|honey|syrup|liquids?|puddles?|fountains?|waterfalls?"
)
_NAMED = re.compile(
    rf"\b(?:{_LIQUIDS})\b(?![ -](?:wheels?|mills?|towers?|tanks?|bottles?|pipes?|colou?rs?|cans?|cups?|lamps?))", re.IGNORECASE
)
"""Liquids; not the first half of a thing's name (an oil lamp, a coffee cup)."""
_MOVES = re.compile(
    r"\b(?:pour(?:s|ed|ing)?|spill(?:s|ed|ing)?|spilt|splash(?:es|ed|ing)?|slosh(?:es|ed|ing)?|flood(?:s|ed|ing)?|overflow(?:s|ed|ing)?"
    r"|gush(?:es|ed|ing)?|drip(?:s|ped|ping)?|leak(?:s|ed|ing)?|flow(?:s|ed|ing)?|float(?:s|ed|ing)?|afloat|adrift|drown(?:s|ed|ing)?"
    r"|waves(?!\s+(?:at|to|its?|his|her|their)\b)|ripples)\b",
    re.IGNORECASE,
)
_BODY = r"(?:waters?|streams?|rivers?|brooks?|creeks?|currents?|torrents?|tides?|floods?|surf|lakes?|ponds?|sea)"
_TAKES = r"(?:carr(?:y|ies|ied|ying)|sweep(?:s|ing)?|swept|wash(?:es|ed|ing)?|drag(?:s|ged|ging)?|bear(?:s|ing)?|bore|borne)"
_CARRIES = re.compile(
    rf"\b{_BODY}\s+(?:\w+ly\s+)?{_TAKES}\b|\b(?:{_TAKES}|drift(?:s|ed|ing)?)\s(?:[\w-]+\s){{0,4}}(?:by|down|along|on|in)\s(?:the\s|a\s)?(?:[\w-]+\s)?{_BODY}\b",
    re.IGNORECASE,
)
"""Water that takes things along, and things that it takes along."""
_DRY = re.compile(r"\b(?:sand|gravel|grain|rice|smoke|air|space|mid-?air|clouds?|light|traffic|crowds?|people)\b", re.IGNORECASE)
"""With these in the clause, such a verb tells of something else."""
_RUNS = re.compile(r"\b(?:flow(?:s|ed|ing)?|waves|ripples)\b", re.IGNORECASE)
"""Motion of a landscape's water, in which nothing is carried."""


def missing_liquid(spec: WorldSpec, text: str, met_by: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Words of a clause that tell of a liquid which nothing simulates: (word, what to do).

    Args:
        spec: the specification.
        text: the clause.
        met_by: pointers that it is met by.
    """
    moves, named = _MOVES.search(text) or _CARRIES.search(text), _NAMED.search(text)
    if moves is None and named is None:
        return
    simulated = _simulated(spec)
    if moves is not None and (named is not None or not _DRY.search(text)):
        scenic = (
            _RUNS.fullmatch(moves.group())
            and names_scenery(text)
            and not any(e.motion == "dynamic" for e in spec.entities.values())
        )
        if not scenic and not any(_tells(spec, pointer, simulated) for pointer in met_by):
            painted = [
                n for n, e in spec.entities.items() if n not in simulated and _NAMED.search(f"{n.replace('_', ' ')} {e.role}")
            ]
            solid = f" ({', '.join(painted[:3])} is geometry, which shows no liquid)" if painted else ""
            yield (
                moves.group(),
                "name in met_by a liquid entity that a dfsph or flip instance moves, or a beat about one or about a body that is coupled "
                f"two_way with one{solid}",
            )
    elif named is not None and not simulated and not any(t.hydrology.required for t in spec.terrains.values()):
        yield (
            named.group(),
            "declare it as an entity with physics category liquid in a dfsph or flip instance, or as required water of a terrain",
        )


def _simulated(spec: WorldSpec) -> set[str]:
    """Liquids that an engine moves."""
    members = {m for s in spec.simulation.liquid.values() for m in s.members}
    return {n for n in members if n in spec.entities and spec.entities[n].physics.category == "liquid"}


def _tells(spec: WorldSpec, pointer: str, simulated: set[str]) -> bool:
    """Whether a pointer leads to a simulated liquid, or to what is judged about one or about a body that one carries."""
    parts = pointer.strip("/").split("/")
    if parts[0] == "entities" and len(parts) > 1:
        return parts[1] in simulated
    carried: set[str] = set()
    for coupling in spec.simulation.couplings.values():
        ends = {coupling.source, coupling.target}
        if coupling.direction == "two_way" and ends & set(spec.simulation.liquid):
            carried |= {m for r in ends & set(spec.simulation.rigid) for m in spec.simulation.rigid[r].members}
    if parts[:2] == ["story", "beats"] and len(parts) > 2 and parts[2] in spec.story.beats:
        beat = spec.story.beats[parts[2]]
        return bool({beat.subject, *entities_of(beat.predicate)} & (simulated | carried))
    if parts[:2] == ["story", "requirements"] and len(parts) > 2 and parts[2] in spec.story.requirements:
        return bool(set(entities_of(spec.story.requirements[parts[2]].predicate)) & (simulated | carried))
    return False
