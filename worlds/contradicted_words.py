"""Words of a property that something simple contradicts: `burning` where nothing burns, `broken` of one whole piece (R2, R131).

No rule measures them, so the verdict prints them as the agent's reading. Here stand those of which the specification alone shows that they are
not so: what burns in a world without fire is refused, the others warn, since a word may be of the picture or of what lies broken already.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .claim_targets import Span, named_in, targets_of
from .made_of import noun_beside
from .prompts.units import APOSTROPHES, folded, units_of

if TYPE_CHECKING:
    from .spec import Entity, WorldSpec

__all__ = ["Contradicted", "contradicted_words"]

_WORDS: Mapping[str, Mapping[str, str]] = {
    "fire": {
        "en": "burning, blazing, flaming, ablaze, on fire, in flames", "de": "brennend*, flammend*, in flammen", "fr": "brûlant*, en feu, en flammes, enflammé*",
        "es": "ardiente, ardiendo, en llamas", "it": "ardente, in fiamme, infuocat*", "pt": "ardente, em chamas", "nl": "brandend*, in brand", "ru": "горящ*, пылающ*",
    },
    "broken": {
        "en": "broken, shattered, smashed, cracked, split, splintered", "de": "zerbrochen*, zerschmettert*, gesprungen*, kaputt*", "fr": "cassé*, brisé*, fêlé*",
        "es": "rot*, quebrad*", "it": "rott*, spezzat*, frantumat*", "pt": "quebrad*, partid*", "nl": "gebroken, kapotte, verbrijzeld*", "ru": "разбит*, сломанн*, треснувш*",
    },
    "unseen": {
        "en": "invisible, unseen", "de": "unsichtbar*", "fr": "invisible*", "es": "invisible*", "it": "invisibil*", "pt": "invisíve*", "nl": "onzichtbar*, onzichtbaar", "ru": "невидим*",
    },
    "weightless": {
        "en": "weightless, massless", "de": "schwerelos*, gewichtslos*", "fr": "sans poids, en apesanteur", "es": "ingrávid*", "it": "senza peso", "pt": "sem peso", "nl": "gewichtloze, gewichtloos",
        "ru": "невесом*",
    },
    "light": {"en": "feather-light, featherlight, light as a feather", "de": "federleicht*"},
}  # fmt: skip
"""By what contradicts them; a star stands for any ending. Reviewed by hand."""
FEATHER = 0.05
"""[kg] Own choice: what weighs more is felt in the hand as a weight."""
CLEAR = 0.9
"""[1] Own choice: transmission below which a body is plainly seen."""


class Contradicted(NamedTuple):
    """A word of a property, and what shows that it is not so."""

    claim: str
    text: str
    sure: bool


def contradicted_words(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[Contradicted]:
    """Property claims with a word that the specification contradicts, sure or to be warned of."""
    for index, span in enumerate(spans):
        if span.claim is None or span.type != "property" or spec.claims[span.claim].waived is not None:
            continue
        kinds = {kind: word for kind, words in _WORDS.items() if (word := _word_in(span.text, words.get(language or "", "")))}
        if not kinds:
            continue
        noun = noun_beside(spans, index)
        named = dict.fromkeys(named_in(spec, span.claim, "entities"))
        if noun is not None:
            named |= dict.fromkeys(p.split("/")[2] for p in targets_of(spec.claims, noun) if p.startswith("/entities/"))
        for kind, word in kinds.items():
            for name in named:
                why = _against(spec, name, kind) if name in spec.entities else None
                if why is not None:
                    text = f"{word!r} is said of {name!r}, and {why}"
                    yield Contradicted(span.claim, text, kind == "fire" and not _can_burn(spec))
                    break


def _word_in(text: str, listed: str) -> str | None:
    """The first word or phrase of a list in a text."""
    words = [folded(u.text.translate(APOSTROPHES)) for u in units_of(text)]
    for phrase in filter(None, (p.strip() for p in listed.split(","))):
        parts = [folded(u.text) for u in units_of(phrase.rstrip("*"))]
        for at in range(len(words) - len(parts) + 1):
            *first, last = words[at : at + len(parts)]
            if first == parts[:-1] and (last.startswith(parts[-1]) if phrase.endswith("*") else last == parts[-1]):
                return " ".join(words[at : at + len(parts)])
    return None


def _can_burn(spec: WorldSpec) -> bool:
    """True of a world with a fire of gases, or with a light of flames that is a thing of its own."""
    return any(d.kind == "ignition" for d in spec.simulation.drivers.values()) or bool(spec.simulation.gas)


def _against(spec: WorldSpec, name: str, kind: str) -> str | None:
    """Why a word of a kind is not so of an entity; None where nothing simple shows it."""
    entity = spec.entities[name]
    if kind == "fire":
        burns = entity.physics.shape == "loose" or any(spec.materials[m].flammable for m in _materials(spec, entity))
        return (
            None
            if burns and _can_burn(spec)
            else "nothing of it burns: give it a fire of engine gas (skill gas), or a flammable material in the box of one"
        )
    if kind == "broken":
        whole = (
            entity.physics.shape == "solid" and entity.breakable is None and entity.generator is None and len(entity.parts) == 1
        )
        shape = next(iter(entity.parts.values())).shape.kind if entity.parts else ""
        return "it is one whole piece: give it `breakable`, or parts that lie apart" if whole and shape != "mesh" else None
    if kind == "unseen":
        seen = any(spec.materials[m].appearance.transmission < CLEAR for m in _materials(spec, entity))
        return "every picture shows it" if seen else None
    if kind == "weightless":
        pulled = float(np.linalg.norm(np.array(spec.simulation.gravity))) > 0.0 and entity.motion == "dynamic"
        return "gravity pulls it as all else" if pulled else None
    mass = getattr(entity.physics, "mass", None)
    return f"it weighs {mass:g} kg" if mass is not None and mass > FEATHER else _heavy(spec, entity)


def _heavy(spec: WorldSpec, entity: Entity) -> str | None:
    """Words on the density of what is said to be light as a feather."""
    dense = max((spec.materials[m].density for m in _materials(spec, entity)), default=0.0)
    size = float(np.prod(entity.dimensions.size)) if entity.dimensions is not None else 0.0
    return (
        f"{dense:g} kg/m^3 in a box of {size:.2g} m^3 weigh more"
        if dense * size > 10.0 * FEATHER and entity.motion != "static"
        else None
    )


def _materials(spec: WorldSpec, entity: Entity) -> set[str]:
    return ({p.material or entity.material for p in entity.parts.values()} or {entity.material}) & set(spec.materials)
