"""Likeness of two prompts: the share of words that is the same where both ask for the same, however they are written.

Two prompts ask for the same where one stands in the other, sentence by sentence, or where at least `ALIKE` of their words agree and what
differs is no noun, verb, number or negation: these say what is there, what happens, how many and how far. A sentence pattern that two
prompts share says nothing of that, and letters that look alike, slips of the pen and other words for the same event change none of it.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher
from typing import NamedTuple

from .prompts.languages import function_words, language_of
from .prompts.numbers import number_in
from .prompts.odd import LIKE_LATIN
from .prompts.parts import words_of
from .prompts.wordnet import known, lemmas, verb_kinds

__all__ = ["ALIKE", "likeness"]

ALIKE = 0.8
"""Own choice: least share of equal words of prompts that ask for the same; one word of five changed."""
SLIP = 0.75
"""Own choice: least share of equal letters of a word that no dictionary knows and of the one that was meant."""
SLIP_LETTERS = 4
"""Own choice: letters of a word in which a slip can be told."""
HELD_SHARE = 0.5
"""Own choice: least share of a sentence that the words of another must be, in order, where others stand among them."""
HELD_RUN = 5
"""Own choice: words one behind the other by which a sentence is known whatever stands around it."""
MAX_WORDS = 2000
"""Words that are compared; the sequence matcher takes time of their square at worst."""
MAX_LETTERS = 20_000
"""Letters of a prompt whose words are told apart by what they are."""
_UNSEEN = re.compile("[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2800\u3164\uffa0\ufe00-\ufe0f\U000e0100-\U000e01ef]")
"""Letters and marks that show nothing, beside format characters (Unicode, Default_Ignorable_Code_Point; U+2800 is blank)."""
_WORDS = re.compile(r"[぀-ヿ㐀-䶿一-鿿가-힯฀-๿]|[^\W_]+")
"""A word, or one letter of a script that writes none between spaces."""
_SENTENCES = re.compile(r"[.!?;:\n。！？；：]+(?=\D|$)")
_DRAWN_ALIKE = str.maketrans({k: v for letters in LIKE_LATIN.values() for k, v in letters.items()})


class _Said(NamedTuple):
    """A word that says what is there, what happens, or how many."""

    text: str
    counts: bool
    """True for numbers and negations."""


def likeness(a: str, b: str) -> float:
    """Share of two prompts that is the same, 1 for prompts that differ in case, blanks, punctuation or invisible letters alone.

    Returns: the share of equal words in order; 0 where they ask for different things. Below `ALIKE` the one stands in the other.
    """
    first, second = _plain(a), _plain(b)
    one, other = _words(first), _words(second)
    if one == other:
        return 1.0
    shared = SequenceMatcher(None, one, other, autojunk=False)
    # No more words can agree than the shorter has; most pairs end here.
    alike = shared.ratio() if shared.real_quick_ratio() >= ALIKE and shared.quick_ratio() >= ALIKE else 0.0
    if alike >= ALIKE and not _ask_otherwise((first, one), (second, other), shared):
        return alike
    short, long = sorted((_sentences(first), _sentences(second)), key=lambda found: sum(map(len, found)))
    return shared.ratio() if _stands_in(short, long) else 0.0


def _plain(prompt: str) -> str:
    """A prompt without case, invisible letters, forms of compatibility (NFKC) and letters of other scripts that look like Latin ones.

    Words of another script stay as they are: only among Latin letters is one of them a look-alike.
    """
    text = unicodedata.normalize("NFKC", _UNSEEN.sub("", prompt))
    text = "".join(c for c in text if unicodedata.category(c) != "Cf")
    return re.sub(r"[^\W\d_]+", lambda found: _latin(found.group()), text).casefold()


def _latin(word: str) -> str:
    return word.translate(_DRAWN_ALIKE) if any("a" <= c.lower() <= "z" for c in word) else word


def _words(plain: str) -> list[str]:
    return _WORDS.findall(plain)[:MAX_WORDS]


def _sentences(plain: str) -> list[list[str]]:
    """Words of each sentence, up to `MAX_WORDS` of the prompt."""
    found, left = [], MAX_WORDS
    for sentence in _SENTENCES.split(plain):
        words = _WORDS.findall(sentence)[:left]
        left -= len(words)
        if words:
            found.append(words)
    return found


# ---------------------------------------------------------------- one prompt within another


def _stands_in(short: Sequence[list[str]], long: Sequence[list[str]]) -> bool:
    """True if each sentence of one prompt stands in one of the other, in order."""
    at = 0
    for sentence in short:
        while at < len(long) and not _holds(long[at], sentence):
            at += 1
        if at == len(long):
            return False
        at += 1
    return bool(short)


def _holds(sentence: Sequence[str], words: Sequence[str]) -> bool:
    """True if words stand in a sentence: one behind the other, or in order where they are most of it."""
    if len(words) > len(sentence):
        return False
    if len(words) >= HELD_RUN and any(sentence[k : k + len(words)] == words for k in range(len(sentence) - len(words) + 1)):
        return True
    rest = iter(sentence)
    return len(words) >= HELD_SHARE * len(sentence) and all(word in rest for word in words)


# ---------------------------------------------------------------- what differs


def _ask_otherwise(one: tuple[str, list[str]], other: tuple[str, list[str]], shared: SequenceMatcher[str]) -> bool:
    """True if of the words that differ some say something else: a noun or verb in the place of another, a number or a negation."""
    gone: list[str] = []
    come: list[str] = []
    for kind, i, j, k, m in shared.get_opcodes():
        if kind != "equal":
            gone += one[1][i:j]
            come += other[1][k:m]
    if all(len(word) == 1 and not word.isascii() for word in (*gone, *come)):
        return False  # of scripts without blanks letters are compared, which are no words
    left, new = list(_said(one[0], gone)), list(_said(other[0], come))
    for word in list(left):
        twin = next((w for w in new if _same(word, w)), None)
        if twin is not None:
            left.remove(word)
            new.remove(twin)
    return bool(left and new) or any(word.counts for word in (*left, *new))


def _said(plain: str, words: Sequence[str]) -> Iterator[_Said]:
    """Those of some words of a prompt that say something: in English by what they are there, else all but function words."""
    language = language_of(plain)
    if language == "en":
        read = {w.text: w for w in words_of(plain[:MAX_LETTERS])}
        for word in words:
            found = read.get(word)
            if found is None:
                yield _Said(word, word.isdigit())
            elif found.label in ("count", "quantity", "negation"):
                yield _Said(word, True)
            elif found.part in ("n", "v", "u") or (found.part == "m" and found.of("n") > found.of("a")):
                yield _Said(word, False)
        return
    closed = frozenset[str]() if language is None else function_words(language)
    yield from (_Said(word, any(map(str.isdigit, word))) for word in words if word not in closed)


def _same(one: _Said, other: _Said) -> bool:
    """True for forms of one word, numbers of one value, words for one kind of event, and a slip of the pen."""
    a, b = one.text, other.text
    if one.counts or other.counts:
        number = number_in(a, "en")
        return a == b or (one.counts and other.counts and number is not None and number == number_in(b, "en"))
    if a == b or {a, *lemmas(a)} & {b, *lemmas(b)} or (verb_kinds(a) or frozenset()) & (verb_kinds(b) or frozenset()):
        return True
    unknown = not (known(a) and known(b)) and min(len(a), len(b)) >= SLIP_LETTERS
    return unknown and SequenceMatcher(None, a, b, autojunk=False).ratio() >= SLIP
