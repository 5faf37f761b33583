"""Words of liquids and of land in a thing claim against what it names (R66, R131, R155): painted water is no evidence.

Reviewed words in English, German, French, Spanish, Italian, Portuguese and Dutch, as in `properties.py`; the head of the claimed words counts,
so that a water tower is a tower. A word that is not here asks for nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..problems import Problem
from ..prompts.languages import function_words, language_of
from ..prompts.units import folded, units_of
from ..spec import LiquidPhysics, WorldSpec

__all__ = ["MATTER_WORDS", "matter_problems"]

_NAMES: Mapping[str, Mapping[str, str]] = {
    "lake": {
        "en": "lake lakes pond ponds", "de": "see seen teich teiche weiher", "fr": "lac lacs étang étangs", "es": "lago lagos estanque laguna",
        "it": "lago laghi stagno", "pt": "lago lagos lagoa", "nl": "meer meren vijver",
    },
    "river": {
        "en": "river rivers", "de": "fluss flüsse strom", "fr": "rivière rivières fleuve", "es": "río ríos", "it": "fiume fiumi", "pt": "rio rios",
        "nl": "rivier rivieren",
    },
    "stream": {
        "en": "stream streams brook creek", "de": "bach bäche", "fr": "ruisseau ruisseaux", "es": "arroyo arroyos", "it": "ruscello ruscelli",
        "pt": "riacho ribeiro", "nl": "beek beken",
    },
    "sea": {"en": "sea seas ocean", "de": "meer meere ozean", "fr": "mer mers océan", "es": "mar océano", "it": "mare oceano", "pt": "mar oceano", "nl": "zee oceaan"},
    "fluid": {
        "en": "water seawater milk juice wine beer honey syrup oil petrol lava magma", "de": "wasser meerwasser milch saft wein bier honig sirup öl benzin lava",
        "fr": "eau lait jus vin bière miel sirop huile essence lave", "es": "agua leche zumo vino cerveza miel aceite gasolina lava",
        "it": "acqua latte succo vino birra miele sciroppo olio benzina lava", "pt": "água leite sumo vinho cerveja mel óleo gasolina lava",
        "nl": "water melk sap wijn bier honing siroop olie benzine lava",
    },
    "trees": {
        "en": "trees forest woods woodland", "de": "bäume wald wälder", "fr": "arbres forêt forêts", "es": "árboles bosque", "it": "alberi bosco foresta",
        "pt": "árvores floresta bosque", "nl": "bomen bos",
    },
}  # fmt: skip
MATTER_WORDS: Mapping[str, Mapping[str, str]] = {
    language: {word: kind for kind, names in _NAMES.items() for word in names[language].split()} for language in _NAMES["lake"]
}
"""Matter that a word asks for, by language: loose matter for a fluid, trees, or a kind of water that the hydrology of a landscape requires."""
_THIN = {
    "en": "water seawater milk juice wine beer petrol", "de": "wasser meerwasser milch saft wein bier benzin", "fr": "eau lait jus vin bière essence",
    "es": "agua leche zumo vino cerveza gasolina", "it": "acqua latte succo vino birra benzina", "pt": "água leite sumo vinho cerveja gasolina",
    "nl": "water melk sap wijn bier benzine",
}  # fmt: skip
"""Fluids by language that run like water: the thickest of the table of materials, milk, has 2.1 mPa s."""
THIN = 0.05
"""[Pa s] Own choice: more than this is no water, milk or wine; cream has some 0.02, muddy water less, oil and syrup more."""
_HEAD_FIRST = frozenset({"fr", "es", "it", "pt"})


def matter_problems(spec: WorldSpec, name: str) -> Iterator[Problem]:
    """A thing claim of a liquid that is geometry, or of water or trees that its landscape does not have."""
    claim, language = spec.claims[name], language_of(spec.prompt)
    head = _head(claim.quote, language)
    kind = MATTER_WORDS.get(language or "", {}).get(head)
    entities = [spec.entities[n] for p in claim.by if p.startswith("/entities/") and (n := p.split("/")[2]) in spec.entities]
    lands = [spec.terrains[n] for p in claim.by if p.startswith("/terrains/") and (n := p.split("/")[2]) in spec.terrains]
    place = f"/claims/{name}/by"
    if kind is None or not (entities or lands):
        return
    if head in _THIN.get(language or "", "").split():
        yield from _too_thick(spec, name)
    if kind == "fluid":
        if not any(e.physics.shape == "loose" for e in entities) and not any(t.hydrology.required for t in lands):
            text = f"{claim.quote!r} is a liquid, and what the claim names is none: geometry shows no liquid; name an entity of physics category liquid in "
            yield Problem(place, f"{text}a dfsph or flip instance, or a terrain with required water")
    elif entities:
        return
    elif kind == "trees":
        if not any(t.vegetation is not None and "tree" in t.vegetation.grown() for t in lands):
            yield Problem(place, f"{claim.quote!r} names trees and the landscape grows none: give it /terrains/<id>/vegetation")
    elif not any({kind, "river" if kind == "stream" else kind} & set(t.hydrology.required) for t in lands):
        text = (
            f"{claim.quote!r} names water that the landscape need not have: put {kind!r} into /terrains/<id>/hydrology/required"
        )
        yield Problem(place, text)


def _too_thick(spec: WorldSpec, name: str) -> Iterator[Problem]:
    """Water that flows like honey or stands like clay."""
    for pointer in spec.claims[name].by:
        keys = pointer.strip("/").split("/")
        physics = spec.entities[keys[1]].physics if keys[0] == "entities" and keys[1] in spec.entities else None
        if isinstance(physics, LiquidPhysics) and physics.viscosity > THIN:
            text = (
                f"{spec.claims[name].quote!r} runs like water, and {keys[1]!r} has a viscosity of {physics.viscosity:g} Pa s; at most {THIN:g} Pa s "
                "is allowed (water has 0.001, milk 0.0021): lower it, or claim the words of what it is"
            )
            place = f"/entities/{keys[1]}/physics/viscosity"
            yield Problem(place, text, {"op": "replace", "path": place, "value": 0.001})


def _head(quote: str, language: str | None) -> str:
    """The noun that the others of a claim describe: the first or the last word, before what binds others to it."""
    words, bind = [folded(u.text) for u in units_of(quote)], function_words(language or "")
    content: list[str] = []
    for word in words:
        if word not in bind:
            content.append(word)
        elif content:
            break
    if not content:
        return ""
    return content[0] if language in _HEAD_FIRST else content[-1]
