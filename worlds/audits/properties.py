"""Words of material in a property claim against the substance of what it names (R131, R154).

A body is of the substance of which most of its volume is, and what a word of material stands beside is of that too: a badge of steel makes no
steel plate of a wooden one. A word that is in no list of the prompt's language is printed as the agent's reading. The density of a material is compared with the range of
its substance by an audit of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..claim_targets import Span, targets_of
from ..claims import Reading
from ..extents import shape_volume
from ..problems import Problem
from ..prompts.descriptions import meanings
from ..prompts.languages import REVIEWED, language_of
from ..roles import words_in
from ..spec import Claim, Entity, WorldSpec

__all__ = ["allowed_substances", "described_problems", "substance_problems"]

OF = frozenset(["of", "made", "out", "aus", "von", "de", "d", "d'", "en", "di", "van", "uit", "из"])
"""Words between a thing and its material: `box of wood`, `Kiste aus Holz`. Reviewed by hand."""


def allowed_substances(quote: str, language: str | None) -> list[tuple[str, tuple[str, ...]]]:
    """Words of materials in a quote, each with the substances that it allows; of any language with lists where the prompt's is not known."""
    found: dict[str, dict[str, None]] = {}
    for one in (language,) if language in REVIEWED else REVIEWED:
        for term, word in meanings(quote, one, "material"):
            found.setdefault(word, {}).update(dict.fromkeys(s for s in term.split("|") if s != "-"))
    return [(word, tuple(substances)) for word, substances in found.items() if substances]


def substance_problems(spec: WorldSpec, name: str) -> Iterator[Problem]:
    """A property claim that names a material which nothing in its `by` is made of."""
    claim = spec.claims[name]
    made = {n: substance for p in claim.by for n, substance in _made_of(spec, p).items()}
    for word, allowed in allowed_substances(claim.quote, language_of(spec.prompt)):
        if made and not set(made.values()) & set(allowed):
            have = ", ".join(f"{n!r} is {s}" for n, s in list(made.items())[:3])
            text = f"{word!r} asks for {' or '.join(allowed)}; what the claim names is not: {have}"
            yield Problem(f"/claims/{name}/by", text)


def described_problems(spec: WorldSpec, reading: Reading) -> Iterator[Problem]:
    """Property claims of a material beside a noun whose things are not made of it, whatever the claims name."""
    for index, span in enumerate(reading.spans):
        if span.claim is None or span.type != "property" or spec.claims[span.claim].waived is not None:
            continue
        noun = _noun(reading.spans, index)
        if noun is None or spec.claims[noun].waived is not None or any(substance_problems(spec, span.claim)):
            continue
        for word, allowed in allowed_substances(span.text, reading.language):
            other = next((p for p in targets_of(spec.claims, noun) if not _is_of(spec, p, allowed)), None)
            if other is not None:
                have = " and ".join(dict.fromkeys(_made_of(spec, other).values()))
                text = f"{word!r} asks for {' or '.join(allowed)}, and {other} of {spec.claims[noun].quote!r} beside it is of {have}: "
                yield Problem(f"/claims/{span.claim}/by", text + "make it of that, or claim the part of it as a thing")


def _noun(spans: Sequence[Span], index: int) -> str | None:
    """The claim of a thing right behind a property, or right before it, as of `box of wood`; None where words stand between."""
    behind = next((s for s in spans[index + 1 :] if s.type != "property" and not s.text.isspace()), None)
    if behind is not None and behind.type == "thing":
        return behind.claim
    before = list(reversed([s for s in spans[:index] if not s.text.isspace()]))[:2]
    if before and before[0].claim is None and words_in(before[0].text) and set(words_in(before[0].text)) <= OF:
        before = before[1:]
    return before[0].claim if before and before[0].type == "thing" else None


def _is_of(spec: WorldSpec, pointer: str, allowed: Sequence[str]) -> bool:
    made = _made_of(spec, pointer)
    return not made or bool(set(made.values()) & set(allowed))


def _made_of(spec: WorldSpec, pointer: str) -> dict[str, str]:
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
