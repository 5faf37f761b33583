"""Characters that make a prompt say something else to a machine than to a person: unseen ones, and letters that look like others.

Judged per word, since honest prompts mix languages. Not told: Kana and Han characters that look alike, styled and full-width letters
(they fold to plain ones), and words of scripts other than those of `LIKE_LATIN` and `RARE`.

References:
    Unicode Technical Standard 39, Unicode Security Mechanisms. Its table of confusables is reduced here to letters of the alphabets
    of Cyrillic, Greek and Armenian that are drawn as a Latin letter in common typefaces: reviewed by hand, own choice of the few.
"""

from __future__ import annotations

import itertools
import unicodedata
from dataclasses import dataclass
from typing import NamedTuple

import regex

__all__ = ["LIKE_LATIN", "Odd", "odd_characters"]

LIKE_LATIN: dict[str, dict[str, str]] = {
    "Cyrillic": dict(zip("асеорхуіјѕһԁԛԝӏАВСЕНІЈКМОРЅТХУԌԚԜ", "aceopxyijshdqwlABCEHIJKMOPSTXYGQW", strict=True)),
    "Greek": dict(zip("ανιορυγκΑΒΕΖΗΙΚΜΝΟΡΤΥΧϹϲϳ", "aviopuykABEZHIKMNOPTYXCcj", strict=True)),
    "Armenian": dict(zip("օհոսցյզՕՏՍԼ", "ohnugjqOSUL", strict=True)),
    "Latin": dict(zip("ɑɡıɩᴀᴄᴅᴇᴊᴋᴍɴᴏᴘʀꜱᴛᴜᴠᴡʏᴢ", "agiiacdejkmnoprstuvwyz", strict=True)),
}
"""Letters that are drawn as a plain Latin letter, by their script; the last are phonetic letters of Latin itself."""
LIKE_CYRILLIC = frozenset("aceopxy")
"""Small Latin letters that are drawn as letters of the Russian alphabet."""
ALPHABETS = (
    "Latin", "Cyrillic", "Greek", "Armenian", "Georgian", "Coptic", "Cherokee", "Lisu", "Deseret", "Glagolitic", "Gothic", "Runic",
    "Old_Italic", "Osage", "Tifinagh", "Canadian_Aboriginal", "Elbasan", "Vai",
)  # fmt: skip
"""Scripts of letters that no honest word mixes; a word of Hangul, Han, Thai or Devanagari may hold Latin ones (LED등, Tシャツ)."""
RARE = ("Cherokee", "Coptic", "Lisu", "Deseret", "Gothic", "Old_Italic", "Osage")
"""Alphabets most of whose letters are drawn as Latin ones: their words are told among Latin ones, whatever their letters."""
SYMBOL_LENGTH = 3
"""Letters up to which Greek beside Latin is a symbol or unit (μm, kΩ, Δt), unless the Greek looks Latin; own choice."""
NEIGHBOURS = 8
"""Characters looked back for the letter that an unseen one belongs to; own choice: a syllable of an Indian script has fewer."""

_WORD = regex.compile(r"(?V1)[\p{L}\p{N}][\p{L}\p{M}\p{N}\p{Cf}]*")
_SCRIPTS = {name: regex.compile(rf"(?V1)\p{{Script={name}}}") for name in ALPHABETS}
_STRUCK = regex.compile(r"(?V1)\p{L}\p{M}*?[\u0334-\u0338\u20d2\u20d3\u20d8-\u20da\u20e5-\u20eb]")
"""A letter with a line or ring drawn through it."""
_UNSEEN = regex.compile(
    r"(?V1)[\p{Cf}\p{Cc}\p{Co}\p{Variation_Selector}\u034f\u115f\u1160\u17b4\u17b5\u2800\u3164\uffa0--[\t\n\r]]"
)
_BIDI = regex.compile(r"[\u202a-\u202e\u2066-\u2069]")
_DIRECTION_MARKS = "\u200e\u200f\u061c"
_RIGHT_TO_LEFT = regex.compile(r"(?V1)[\p{Script=Arabic}\p{Script=Hebrew}\p{Script=Syriac}\p{Script=Thaana}\p{Script=Nko}]")
_JOINING = regex.compile(
    r"(?V1)[\p{Arabic}\p{Syriac}\p{Devanagari}\p{Bengali}\p{Gurmukhi}\p{Gujarati}\p{Oriya}\p{Tamil}\p{Telugu}\p{Kannada}\p{Malayalam}"
    r"\p{Sinhala}\p{Khmer}\p{Myanmar}\p{Mongolian}\p{Tibetan}\p{Nko}]"
)
_SPACED_BY_ZERO_WIDTH = regex.compile(r"(?V1)[\p{Thai}\p{Lao}\p{Khmer}\p{Myanmar}\p{Tibetan}]")
_SEEN_FORMATS = regex.compile(r"[\u0600-\u0605\u06dd\u070f\u0890\u0891\u08e2]")
"""Signs that Unicode files with the format characters and that are drawn."""
_PICTURE = regex.compile(r"(?V1)[\p{Emoji}\p{Extended_Pictographic}\p{So}\p{Sm}]")
_HAN = regex.compile(r"(?V1)[\p{Han}\p{Mongolian}\p{Phags_Pa}\p{Myanmar}]")
_FLAG = regex.compile("\U0001f3f4[\U000e0020-\U000e007e]+\U000e007f")


@dataclass(frozen=True, slots=True)
class Odd:
    """A span that a person may read differently than a machine does, and why."""

    start: int
    end: int
    text: str
    why: str


class _Word(NamedTuple):
    """A run of letters; `script` is the only alphabet of it, `clear` true where one of its letters looks like no other's."""

    start: int
    end: int
    text: str
    scripts: tuple[str, ...]
    clear: bool


def odd_characters(text: str) -> tuple[Odd, ...]:
    """Unseen characters, words of mixed scripts and words that look like another script's, in order."""
    words = [_word(match.start(), match.group()) for match in _WORD.finditer(text)]
    struck = [
        Odd(*match.span(), match.group(), f"{_name(match.group()[-1])} is drawn over a letter: leave it out")
        for match in _STRUCK.finditer(text)
    ]
    found = [*_unseen(text), *struck, *(odd for word in words if (odd := _mixed(word))), *_look_alikes(words)]
    return tuple(sorted(found, key=lambda odd: (odd.start, odd.end)))


def _name(character: str) -> str:
    return f"U+{ord(character):04X} {unicodedata.name(character, 'without a name')}"


def _unseen(text: str) -> list[Odd]:
    flags = {at for match in _FLAG.finditer(text) for at in range(*match.span())}
    found = []
    for match in _UNSEEN.finditer(text):
        at, character = match.start(), match.group()
        if at in flags or _SEEN_FORMATS.match(character) or _belongs(text, at, character):
            continue
        kind = "turns the order of letters round" if _BIDI.match(character) or character in _DIRECTION_MARKS else "is not seen"
        if unicodedata.category(character) == "Co":
            kind = "has no meaning of its own"
        found.append(Odd(at, at + 1, character, f"{_name(character)} {kind}: leave it out"))
    return found


def _belongs(text: str, at: int, character: str) -> bool:
    """True where the spelling of a script or of a picture needs this unseen character."""
    earlier = text[max(0, at - NEIGHBOURS) : at]
    before, after = earlier.rstrip("\u200c\u200d\ufe0f")[-1:], text[at + 1 : at + 2]
    if unicodedata.category(before or " ")[0] == "M":
        before = next((c for c in reversed(earlier) if unicodedata.category(c)[0] not in "MC"), "")
    if character in "\u200c\u200d" and _JOINING.match(before):
        return True
    if character == "\u200d":
        return bool(_PICTURE.match(before) and _PICTURE.match(after)) or "\U0001f3fb" <= before <= "\U0001f3ff"
    if character == "\u200b":
        return bool(_SPACED_BY_ZERO_WIDTH.match(before) or _SPACED_BY_ZERO_WIDTH.match(after))
    if character in _DIRECTION_MARKS:
        within = _letter(text[at - 1 : at]) and _letter(after)
        return bool(_RIGHT_TO_LEFT.search(text)) and not within
    if regex.match(r"\p{Variation_Selector}", character):
        return bool(before and (_PICTURE.match(before) or _HAN.match(before)))
    return False


def _letter(character: str) -> bool:
    return character.isalnum()


def _word(start: int, text: str) -> _Word:
    letters = [c for c in unicodedata.normalize("NFD", text) if unicodedata.category(c)[0] == "L"]
    scripts = tuple(name for name, pattern in _SCRIPTS.items() if any(map(pattern.match, letters)))
    alike = {c for name in scripts for c in LIKE_LATIN.get(name, ())} if scripts != ("Latin",) else set(LIKE_CYRILLIC)
    clear = any(c not in alike for c in letters)
    return _Word(start, start + len(text), text, scripts, clear)


def _mixed(word: _Word) -> Odd | None:
    """A word of more than one alphabet, or with a phonetic letter among plain ones."""
    plain = unicodedata.normalize("NFD", word.text)
    foreign = [c for c in plain if not _SCRIPTS["Latin"].match(c) and any(_SCRIPTS[name].match(c) for name in word.scripts)]
    phonetic = [c for c in plain if c in LIKE_LATIN["Latin"] and c != "ı"]
    if word.scripts == ("Latin",) and phonetic and any(c.isascii() and c.isalpha() for c in plain):
        return Odd(
            word.start, word.end, word.text, f"{_name(phonetic[0])} looks like {LIKE_LATIN['Latin'][phonetic[0]]!r}: write that"
        )
    if len(word.scripts) < 2:
        return None
    symbol = set(word.scripts) == {"Latin", "Greek"} and sum(map(_letter, plain)) <= SYMBOL_LENGTH
    if symbol and not any(c in LIKE_LATIN["Greek"] for c in foreign):
        return None
    why = f"one word of {' and '.join(word.scripts)} letters ({_name(foreign[0])}): write it in one alphabet"
    return Odd(word.start, word.end, word.text, why)


def _look_alikes(words: list[_Word]) -> list[Odd]:
    """Words wholly of letters that look like another alphabet's, among words of that alphabet."""
    spelled = [word for word in words if word.scripts]
    clear = {word.scripts[0] for word in spelled if len(word.scripts) == 1 and word.clear}
    clear |= {"Latin" for word in spelled if word.scripts == ("Latin",)}
    found = []
    for first, last in _runs(spelled):
        script, run = spelled[first].scripts[0], spelled[first:last]
        other = "Cyrillic" if script == "Latin" else "Latin"
        known = script in LIKE_LATIN and not any(word.clear for word in run)
        if other not in clear or not (known or script in RARE):
            continue
        found += [
            Odd(
                word.start, word.end, word.text, f"{script} letters ({_name(word.text[0])}) that look {other}: write {other} ones"
            )
            for word in run
            if not _symbol(word)
        ]
    return found


def _runs(words: list[_Word]) -> list[tuple[int, int]]:
    """Stretches of neighbouring words of one alphabet alone, as indices."""
    edges = [k for k in range(len(words) + 1) if k in (0, len(words)) or words[k].scripts != words[k - 1].scripts]
    return [(first, last) for first, last in itertools.pairwise(edges) if len(words[first].scripts) == 1]


def _symbol(word: _Word) -> bool:
    """True of letters that stand for a quantity or substance: x, CO, ρ."""
    letters = [c for c in word.text if _letter(c) and not c.isdigit()]
    if word.scripts == ("Latin",):
        return len(letters) < 2 or not any(c.islower() for c in letters)
    return word.scripts == ("Greek",) and len(letters) == 1 and letters[0].islower() and letters[0] != "ο"
