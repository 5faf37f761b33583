"""Words of material in a property claim against the substance of what it names (R131, R154).

Reviewed words in English, German, French, Spanish, Italian, Portuguese and Dutch, without inflection of other kinds than those listed; a word
that is not here is printed as the agent's reading.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..problems import Problem
from ..prompts.units import folded, units_of
from ..spec import WorldSpec

__all__ = ["SUBSTANCE_WORDS", "allowed_substances", "substance_problems"]

_METALS = ("steel", "iron", "aluminium")
SUBSTANCE_WORDS: Mapping[str, tuple[str, ...]] = {
    word: substances
    for substances, words in {
        (
            "wood",
        ): "wood wooden timber oak pine birch plywood holz hölzern hölzerne hölzerner hölzernes hölzernen bois madera legno di-legno madeira hout houten",
        ("steel",): "steel stahl stählern stählerne acier acero acciaio aço staal stalen",
        ("iron", "steel"): "iron eisen eisern eiserne eiserner eisernes fer hierro ferro ijzer ijzeren",
        ("aluminium",): "aluminium aluminum aluminio alluminio alumínio",
        _METALS: "metal metallic metall metallen metallene métal metálico metallo metallico metaal metalen",
        (
            "stone",
            "concrete",
            "brick",
        ): "stone rock granite marble slate stein steinern steinerne pierre piedra pietra pedra steen stenen",
        ("concrete",): "concrete beton béton hormigón calcestruzzo cemento betão concreto betonnen",
        ("brick",): "brick ziegel backstein brique ladrillo mattone mattoni tijolo baksteen bakstenen",
        ("glass",): "glass glas gläsern gläserne verre vidrio cristal vetro vidro glazen",
        ("plastic",): "plastic kunststoff plastik plastique plástico plastica",
        ("rubber",): "rubber gummi caoutchouc goma gomma borracha rubberen",
        (
            "ceramic",
        ): "ceramic porcelain clay terracotta keramik porzellan ton céramique porcelaine cerámica porcelana ceramica cerâmica keramiek porselein",
        ("ice",): "ice eis glace hielo ghiaccio gelo ijs",
        ("paper",): "paper cardboard papier pappe carton papel cartón carta cartone papelão karton",
        ("foam",): "foam styrofoam schaumstoff styropor mousse espuma schiuma schuim",
    }.items()
    for word in words.split()
}
"""Substances that each word of a material allows."""


def allowed_substances(quote: str) -> list[tuple[str, tuple[str, ...]]]:
    """Words of materials in a quote, each with the substances that it allows."""
    return [(u.text, SUBSTANCE_WORDS[folded(u.text)]) for u in units_of(quote) if folded(u.text) in SUBSTANCE_WORDS]


def substance_problems(spec: WorldSpec, name: str) -> Iterator[Problem]:
    """A property claim that names a material which nothing in its `by` is made of."""
    claim = spec.claims[name]
    asked = allowed_substances(claim.quote)
    made = {n: spec.materials[n].substance for p in claim.by for n in _materials(spec, p) if n in spec.materials}
    for word, allowed in asked:
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
