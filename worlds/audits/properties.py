"""Words of material in a property claim against the substance of what it names (R131, R154).

A word that is in no list of the prompt's language is printed as the agent's reading. The density of a material is compared with the range of
its substance by an audit of its own.
"""

from __future__ import annotations

from collections.abc import Iterator

from ..problems import Problem
from ..prompts.descriptions import meanings
from ..prompts.languages import REVIEWED, language_of
from ..spec import WorldSpec

__all__ = ["allowed_substances", "substance_problems"]


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
    made = {n: spec.materials[n].substance for p in claim.by for n in _materials(spec, p) if n in spec.materials}
    for word, allowed in allowed_substances(claim.quote, language_of(spec.prompt)):
        if made and not set(made.values()) & set(allowed):
            have = ", ".join(f"{n!r} is {s}" for n, s in list(made.items())[:3])
            text = f"{word!r} asks for {' or '.join(allowed)}; what the claim names is not: {have}"
            yield Problem(f"/claims/{name}/by", text)


def _materials(spec: WorldSpec, pointer: str) -> list[str]:
    """Materials that a pointer leads to: its own, or those of an entity or part."""
    keys = pointer.strip("/").split("/")
    if keys[0] == "materials" and len(keys) > 1:
        return [keys[1]]
    entity = spec.entities.get(keys[1]) if keys[0] == "entities" and len(keys) > 1 else None
    if entity is None:
        return []
    if len(keys) > 3 and keys[2] == "parts" and keys[3] in entity.parts:
        return [entity.parts[keys[3]].material or entity.material]
    return [entity.material, *(p.material for p in entity.parts.values() if p.material)]
