"""Words of the prompt that name a row of the table of materials, `a gold block`, against what it is made of (R131, R154).

A word that is a substance as well, `steel`, is held to the range of that by audits of their own; here are the others, of which a specification
could say `other` and any density. A material of the row's substance is held to the row, or says in `departs` what makes it another.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

from .claim_targets import Span, targets_of
from .made_of import made_of, noun_beside
from .materials import DENSITY_RANGES, MaterialRow, material_table
from .prompts.units import folded, units_of

if TYPE_CHECKING:
    from .spec import Material, WorldSpec

__all__ = ["FRICTION_FACTOR", "RESTITUTION_ROOM", "WORD_ROOM", "Misnamed", "beyond_row", "misnamed_rows"]

WORD_ROOM = 0.15
"""[1] Own choice: share by which what a word names may leave the row's range of density: a person's `slate` is no handbook's."""
FRICTION_FACTOR = 2.0
"""[1] Own choice: measured coefficients of one material scatter by so much, as those of a pair do."""
RESTITUTION_ROOM = 0.2
"""[1] Own choice, likewise; only upwards, since a restitution that is left out is 0."""
_GROUPS = frozenset(("stone", "masonry", "wood", "metal", "ceramic", "plastic", "rubber", "fabric", "foam"))
"""Groups of solids: liquids, grain and plants are things, which `matter_words.py` holds."""
_SURE = frozenset(
    """granite basalt gneiss limestone sandstone slate marble beech maple mahogany teak spruce larch cedar balsa bamboo chipboard mdf
    cork""".split()  # noqa: SIM905
)
"""Rows whose names say nothing but the material: something of another substance is none. The others are colours, covers,
mounts and more too: gold, leather, brass, lead."""
_OTHERS: Mapping[str, Mapping[str, str]] = {
    "gold": {"de": "gold goldene goldener goldenes goldenen", "fr": "or", "es": "oro", "it": "oro", "pt": "ouro", "nl": "goud gouden", "ru": "золотой золотая золотое золота"},
    "lead": {"de": "blei", "fr": "plomb", "es": "plomo", "it": "piombo", "pt": "chumbo", "nl": "lood loden", "ru": "свинцовый свинцовая свинца"},
    "copper": {"de": "kupfer", "fr": "cuivre", "es": "cobre", "it": "rame", "pt": "cobre", "nl": "koper koperen", "ru": "медный медная меди"},
    "silver": {"de": "silber", "fr": "argent", "es": "plata", "it": "argento", "pt": "prata", "nl": "zilver zilveren", "ru": "серебряный серебряная"},
    "brass": {"de": "messing", "fr": "laiton", "es": "latón", "it": "ottone", "pt": "latão", "nl": "messing", "ru": "латунный латунная латуни"},
    "bronze": {"de": "bronze", "fr": "bronze", "es": "bronce", "it": "bronzo", "pt": "bronze", "nl": "brons bronzen", "ru": "бронзовый бронзовая бронзы"},
    "zinc": {"de": "zink", "fr": "zinc", "es": "zinc", "it": "zinco", "pt": "zinco", "nl": "zink zinken", "ru": "цинковый цинковая цинка"},
    "titanium": {"de": "titan", "fr": "titane", "es": "titanio", "it": "titanio", "pt": "titânio", "nl": "titanium", "ru": "титановый титановая титана"},
    "cork": {"de": "kork", "fr": "liège", "es": "corcho", "it": "sughero", "pt": "cortiça", "nl": "kurk kurken", "ru": "пробковый пробковая пробки"},
    "granite": {"de": "granit", "fr": "granit", "es": "granito", "it": "granito", "pt": "granito", "nl": "graniet granieten", "ru": "гранитный гранитная гранита"},
    "marble": {"de": "marmor", "fr": "marbre", "es": "mármol", "it": "marmo", "pt": "mármore", "nl": "marmer marmeren", "ru": "мраморный мраморная мрамора"},
    "oak": {"de": "eiche eichenholz", "fr": "chêne", "es": "roble", "it": "quercia rovere", "pt": "carvalho", "nl": "eiken eikenhout", "ru": "дубовый дубовая дуба"},
}  # fmt: skip
"""Names of rows in other languages, where they are sure. Reviewed by hand; Chinese and Japanese have none."""


class Misnamed(NamedTuple):
    """A word that names a row, and something said to be it that is not."""

    claim: str
    text: str
    sure: bool
    """False where the word may be a colour or a cover: the verdict warns."""
    material: str
    """Material that is not what the word says."""


@cache
def _names(language: str | None) -> Mapping[tuple[str, ...], str]:
    """Rows by the words that name them, folded; English names are read in every language that is not known."""
    found: dict[tuple[str, ...], str] = {}
    if language in ("en", None):
        for name, row in material_table().materials.items():
            for called in (name, *row.also) if row.group in _GROUPS else ():
                if called not in DENSITY_RANGES:
                    found[tuple(called.split("_"))] = name
    for row_name, words in _OTHERS.items():
        for one, forms in words.items():
            found |= {(folded(w),): row_name for w in forms.split() if language in (one, None)}
    return found


def _rows_in(text: str, language: str | None) -> Iterator[tuple[str, str]]:
    """Words of a text that name rows, the longest first, with the row's name."""
    names, units = _names(language), units_of(text)
    words, at = [folded(u.text) for u in units], 0
    longest = max(map(len, names), default=0)
    while at < len(words):
        size = next((n for n in range(min(longest, len(words) - at), 0, -1) if tuple(words[at : at + n]) in names), 0)
        if size:
            yield text[units[at].start : units[at + size - 1].end], names[tuple(words[at : at + size])]
        at += max(1, size)


def misnamed_rows(spec: WorldSpec, spans: Sequence[Span], language: str | None) -> Iterator[Misnamed]:
    """Property claims of a row's name of which what they name, or the noun beside them, is not made."""
    for index, span in enumerate(spans):
        if span.claim is None or span.type != "property" or spec.claims[span.claim].waived is not None:
            continue
        said = list(_rows_in(span.text, language))
        noun = noun_beside(spans, index) if said else None
        pointers = [*spec.claims[span.claim].by, *(() if noun is None else targets_of(spec.claims, noun))]
        made = dict.fromkeys(n for p in pointers for n in made_of(spec, p))
        for word, row in said:
            for name in made:
                found = _against(spec, name, word, row)
                if found is not None:
                    yield Misnamed(span.claim, *found, name)


def _against(spec: WorldSpec, name: str, word: str, row_name: str) -> tuple[str, bool] | None:
    """Why a material is not the row that a word names, and whether that is sure; None where it is, or says what makes it another."""
    material, row = spec.materials[name], material_table().materials[row_name]
    if material.departs is not None or row_name in (material.of or "").split("_") or material.of == row_name:
        return None
    if material.substance != row.substance:
        if row_name in _SURE:
            return (
                f"{word!r} asks for {row_name}, of substance {row.substance}; what the claim names is not: {name!r} is {material.substance}",
                True,
            )
        return (
            f"{word!r} is the name of a material, and {name!r} is of {material.substance}: it is read as a colour or a cover",
            False,
        )
    for field, value, low, high in beyond_row(material, row, WORD_ROOM):
        text = f"{word!r} asks for {row_name}, with a {field} of {low:g} to {high:g}, and {name!r} has {value:g}: give it what {row_name} has "
        return (
            f'{text}("of": {row_name!r}), or say in its `departs` what makes it another (hollow, wet, sprayed): it is printed',
            True,
        )
    return None


def beyond_row(material: Material, row: MaterialRow, room: float) -> Iterator[tuple[str, float, float, float]]:
    """Fields of a material that are far from a row: field, value, least and greatest of the row."""
    for field in ("density", "friction", "restitution"):
        figure = row.figures.get(field)
        if figure is None:
            continue
        value, (low, _, high) = getattr(material, field), figure.range
        grain = row.figures.get("grain_density") if field == "density" else None
        if field == "density":
            out = not (1.0 - room) * low <= value <= (1.0 + room) * high and (grain is None or not grain.holds(value))
        elif field == "friction":
            out = not low / FRICTION_FACTOR <= value <= high * FRICTION_FACTOR
        else:
            out = value > high + RESTITUTION_ROOM
        if out:
            yield field, value, low, high
