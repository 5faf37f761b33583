"""Materials that pointers of claims lead to, and the noun that a word of material stands beside (R131, R154)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .claim_targets import Span
from .extents import shape_volume
from .roles import words_in
from .spec import Claim, Entity, WorldSpec

__all__ = ["made_of", "noun_beside"]

OF = frozenset(["of", "made", "out", "aus", "von", "de", "d", "d'", "en", "di", "van", "uit", "из"])
"""Words between a thing and its material: `box of wood`, `Kiste aus Holz`. Reviewed by hand."""


def noun_beside(spans: Sequence[Span], index: int) -> str | None:
    """The claim of a thing right behind a property, or right before it, as of `box of wood`; None where words stand between."""
    behind = next((s for s in spans[index + 1 :] if s.type != "property" and not s.text.isspace()), None)
    if behind is not None and behind.type == "thing":
        return behind.claim
    before = list(reversed([s for s in spans[:index] if not s.text.isspace()]))[:2]
    if before and before[0].claim is None and words_in(before[0].text) and set(words_in(before[0].text)) <= OF:
        before = before[1:]
    return before[0].claim if before and before[0].type == "thing" else None


def made_of(spec: WorldSpec, pointer: str) -> dict[str, str]:
    """Materials that a pointer leads to, with their substances: a material itself, or what most of a part or of an entity is made of.

    A part that no claim names as a thing stands for the whole. Where volumes are not known, all materials of an entity count.
    """
    keys = pointer.strip("/").split("/")
    if keys[0] == "materials" and len(keys) > 1:
        return {n: m.substance for n, m in spec.materials.items() if n == keys[1]}
    entity = spec.entities.get(keys[1]) if keys[0] == "entities" and len(keys) > 1 else None
    if entity is None:
        return {}
    own = "/".join(["", *keys[:4]])
    if len(keys) > 3 and keys[2] == "parts" and keys[3] in entity.parts and any(own in c.by for c in _things(spec)):
        names = [entity.parts[keys[3]].material or entity.material]
    else:
        names = _most(spec, entity)
    return {n: spec.materials[n].substance for n in names if n in spec.materials}


def _most(spec: WorldSpec, entity: Entity) -> list[str]:
    """Materials of the substance of which most of an entity's volume is."""
    volumes: dict[str, float] = {}
    names: dict[str, list[str]] = {}
    for part in entity.parts.values():
        name, volume = part.material or entity.material, shape_volume(part.shape)
        if volume is None or name not in spec.materials:
            return [entity.material, *(p.material for p in entity.parts.values() if p.material)]
        substance = spec.materials[name].substance
        volumes[substance] = volumes.get(substance, 0.0) + volume
        names.setdefault(substance, []).append(name)
    return names[max(volumes, key=lambda s: volumes[s])] if volumes else [entity.material]


def _things(spec: WorldSpec) -> Iterator[Claim]:
    return (c for c in spec.claims.values() if c.type == "thing" and c.waived is None)
