"""Parts of speech of an English prompt, from WordNet's counts and rules about short sentences: which word is a verb, a noun, a modifier."""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass, field

from . import english
from .languages import held_words
from .units import folded, units_of
from .wordnet import irregular, particle_verb, votes

__all__ = ["Word", "words_of"]

LEAST_VERB = 3
"""Fifteenths of a word's meanings that must be verbs for a rescue: own choice; below it are names that are verbs in jest (to barrel, to ladder)."""
LONGEST_PHRASE = 5
"""Words."""
_BREAK = re.compile(r"[,.;:!?()\n—–…]|\s-\s")
_NUMBER = re.compile(r"[~≈±]?\d[\d.,:–/-]*$")
_ORDINAL = re.compile(r"\d+(?:st|nd|rd|th)$")


@dataclass
class Word:
    """A unit of the prompt with what it is taken for."""

    start: int
    end: int
    text: str
    """Folded."""
    fresh: bool
    """True where a clause begins with it."""
    joined: bool
    """True where a hyphen binds it to the word before."""
    slashed: bool
    """True where a slash does."""
    weights: dict[str, int] = field(default_factory=dict)
    """Fifteenths of its meanings by part of speech."""
    part: str = ""
    """`n` head noun, `m` modifier, `v` verb, `a` adjective, `r` adverb, `p` particle, `c` closed class, `u` unknown, empty until it is decided."""
    label: str = ""
    """Type of a closed class: count, quantity, order, negation, time, weather, look, place, property, filler."""
    run: int = 0
    """Number of its run: words of one run make one claim."""

    def of(self, part: str) -> int:
        """Fifteenths of its meanings that are one part of speech."""
        return self.weights.get(part, 0)

    def close(self, label: str, run: int) -> None:
        """Make it a word of a closed class."""
        self.part, self.label, self.run = "c", label, run

    @property
    def ends_as_verb(self) -> str:
        """The ending of a verb's form: `s`, `ing`, `ed` (irregular ones too), or nothing."""
        if not self.of("v"):
            return ""
        if irregular(self.text, "v"):
            return "ing" if self.text.endswith("ing") else "ed"
        for ending in ("ing", "ed", "s"):
            if self.text.endswith(ending) and not self.text.endswith("ss"):
                return ending
        return ""


def words_of(text: str) -> list[Word]:
    """The words of a prompt, each with its part of speech or closed class."""
    words = _units(text)
    _hold(words, text)
    _close(words)
    told = False
    for first, end in _clauses(words):
        told = _decide(words[first:end], told)
        _rescue(words[first:end])
    _particles(words)
    return words


def _units(text: str) -> list[Word]:
    made: list[Word] = []
    last = 0
    for unit in units_of(text):
        gap = text[last : unit.start]
        word = Word(
            unit.start,
            unit.end,
            folded(unit.text).replace("’", "'"),
            not made or bool(_BREAK.search(gap)),
            gap in ("-", "‑"),
            gap == "/",
        )
        word.weights = {part: round(sum(votes(word.text, part).values())) for part in ("n", "v", "a", "r")}
        word.run = len(made)
        made.append(word)
        last = unit.end
    return made


def _hold(words: list[Word], text: str) -> None:
    """Close negations and words of order."""
    held = [word for word in held_words(text, "en") if word.kind != "number"]
    for k, word in enumerate(words):
        for span in held:
            if span.start <= word.start < span.end:
                word.close(span.kind, next(n for n in range(k + 1) if words[n].start >= span.start))


def _close(words: list[Word]) -> None:
    """Find expressions, numbers and words of closed classes."""
    texts = [word.text for word in words]
    k = 0
    while k < len(words):
        for count in range(min(LONGEST_PHRASE, len(words) - k), 1, -1):
            found = english.PHRASES.get(" ".join(texts[k : k + count]))
            if found is not None and not any(word.part for word in words[k : k + count]):
                for word in words[k : k + count]:
                    word.close(found, k)
                k += count
                break
        else:
            k += 1 if words[k].part else _number(words, k) or _closed_class(words[k], k)


def _is_number(word: Word) -> bool:
    return bool(_NUMBER.match(word.text)) or word.text in english.NUMBERS


def _number(words: list[Word], k: int) -> int:
    """Type a number with the unit behind it; how many words it has, none where there is no number."""
    end = k
    while end < len(words) and _is_number(words[end]) and (end == k or not words[end].fresh):
        end += 1
    if end == k:
        return 0
    if (
        words[end - 1].text == "half"
        and end + 1 < len(words)
        and words[end].text == "a"
        and words[end + 1].text in english.UNITS_OF_MEASURE
    ):
        end += 1
    after = words[end].text if end < len(words) and not words[end].fresh else ""
    kind = "count"
    if after in ("times", "time"):
        end += 1
    elif after in ("a.m", "p.m", "am", "pm"):
        kind, end = "time", end + 1
    elif after in english.UNITS_OF_MEASURE:
        kind, end = "quantity", _after_unit(words, end + 1)
    elif (
        words[k].text == "one"
        and end == k + 1
        and ((k and words[k - 1].part in ("", "c") and words[k - 1].text in english.DETERMINERS) or not after)
    ):
        kind = "filler"
    for word in words[k:end]:
        word.close(kind, k)
    return end - k


def _after_unit(words: list[Word], end: int) -> int:
    """Where a unit of several words ends: m/s²."""
    while (
        end < len(words)
        and (words[end].text in ("²", "³", "2", "3") or words[end].slashed)
        and words[end].start - words[end - 1].end < 2
    ):
        end += 1
    return end


def _closed_class(word: Word, k: int) -> int:
    for label, members in english.CLASSES:
        if word.text in members:
            word.close(label, k)
            break
    else:
        if _ORDINAL.match(word.text):
            word.close("property", k)
        elif not any(map(str.isalpha, word.text)):
            word.close("filler", k)
    return 1


def _clauses(words: list[Word]) -> list[tuple[int, int]]:
    """Where punctuation or a conjunction begins another clause."""
    starts = [k for k, word in enumerate(words) if k == 0 or word.fresh or word.text in english.CONJUNCTIONS]
    return list(itertools.pairwise([*starts, len(words)]))


def _decide(clause: list[Word], told: bool) -> bool:
    """Go through a clause from left to right and decide every open word; true where it has a verb, or one stood before it (`told`)."""
    seen_verb = False
    for k, word in enumerate(clause):
        if word.part:
            continue
        before = clause[k - 1] if k else None
        after = clause[k + 1] if k + 1 < len(clause) else None
        following = after if after is not None and not after.part else None
        closed = after is None or after.text in english.PREPOSITIONS | english.DETERMINERS
        word.part = _part(word, before, following, seen_verb if k > 1 else told and closed)
        seen_verb = seen_verb or word.part == "v"
    return told or seen_verb


def _part(word: Word, before: Word | None, following: Word | None, seen_verb: bool) -> str:
    if not any(word.weights.values()):
        verbal = (
            word.text.endswith(("ing", "ed")) and before is not None and (before.part in ("n", "u") or before.text in english.BE)
        )
        return "v" if verbal else "r" if word.text.endswith("ly") else "u"
    if before is not None and before.part == "r" and word.of("a") >= max(word.of("n"), word.of("v")):
        return "a"
    if following is not None and following.joined:
        return "m"
    nominal = following is not None and (following.of("n") or following.of("a") or not any(following.weights.values())) > 0
    if before is None or before.part == "c":
        place = _place_of(before)
        if (
            place == "verb"
            and word.of("v")
            and word.ends_as_verb in ("", "s")
            and (word.of("v") >= word.of("n") or before is None or before.text != "that")
        ):
            return "v"
        if place == "be":
            return _after_be(word, nominal)
        if before is not None and before.text in english.GERUNDS and word.ends_as_verb == "ing" and not nominal:
            return "v"
        if place == "noun":
            return _in_phrase(word, following, bool(nominal))
        return _at_start(word, following, bool(nominal), seen_verb)
    if before.part in ("m", "a"):
        return _in_phrase(word, following, bool(nominal))
    if before.part in ("n", "u"):
        return _after_noun(word, following, seen_verb)
    return _after_verb(word, following, bool(nominal))


def _place_of(before: Word | None) -> str:
    """The part of speech to expect after a closed word, or where a clause begins."""
    if before is None:
        return "start"
    if before.text in english.BE:
        return "be"
    if (
        before.text in english.AUXILIARIES
        or before.text in english.SUBJECTS
        or (before.label == "negation" and before.text not in ("no", "without"))
    ):
        return "verb"
    if (
        before.label in ("count", "quantity", "property", "weather", "time", "negation")
        or before.text in english.DETERMINERS | english.PREPOSITIONS
    ):
        return "noun"
    return "start"


def _after_be(word: Word, nominal: bool) -> str:
    if word.ends_as_verb in ("ing", "ed") and word.of("v") >= LEAST_VERB:
        return "m" if nominal and word.of("a") > word.of("v") else "v"
    if word.of("a") or word.of("r"):
        return "a" if word.of("a") >= word.of("r") else "r"
    return "n" if word.of("n") else "v"


def _in_phrase(word: Word, following: Word | None, nominal: bool) -> str:
    """After a determiner, a number, a preposition or a modifier: a modifier or the head of a noun phrase."""
    if word.of("r") > max(word.of("n"), word.of("a"), word.of("v")):
        return "r"
    if nominal and following is not None:
        verbal = following.ends_as_verb in ("s", "ed") and following.of("v") >= following.of("n")
        if word.ends_as_verb in ("ing", "ed") and word.of("v") + word.of("a") > word.of("n"):
            return "m"
        if word.of("a") > word.of("n"):
            return "m"
        if not verbal and following.of("n") > following.of("v") and not word.ends_as_verb:
            return "m"
        if not verbal and following.of("n") and word.of("n") and word.text[-1:] != "s":
            return "m"
    if word.of("n"):
        return "n" if word.of("n") * 3 >= word.of("a") else "a"
    if word.of("a"):
        return "a"
    return "v"


def _after_noun(word: Word, following: Word | None, seen_verb: bool) -> str:
    """After a head noun: most often its verb, else another noun of a compound, or an adjective."""
    ending = word.ends_as_verb
    if ending == "ing":
        return "v" if word.of("v") >= word.of("n") else "n"
    if ending == "ed":
        return "v"
    if ending == "s" and (word.of("v") >= word.of("n") or (not seen_verb and following is None and word.of("v") >= LEAST_VERB)):
        return "v"
    if not ending and word.of("v") > word.of("n") and not seen_verb:
        return "v"
    best = max(("n", "a", "r"), key=word.of)
    if not word.of(best):
        return "v"
    return best


def _at_start(word: Word, following: Word | None, nominal: bool, seen_verb: bool) -> str:
    """At the beginning of a clause, or after a conjunction: a request, a form of a verb whose subject stands earlier, or a noun phrase."""
    ending = word.ends_as_verb
    if ending in ("s", "ing") and word.of("v") > word.of("n") + word.of("a"):
        return "v"
    if ending == "s" and word.of("v") >= LEAST_VERB and following is None and seen_verb:
        return "v"
    if ending == "ed" and not nominal:
        return "v"
    if (
        not ending
        and word.of("v") > word.of("n") + word.of("a")
        and not (following is not None and following.ends_as_verb in ("s", "ing"))
    ):
        return "v"
    return _in_phrase(word, following, nominal)


def _after_verb(word: Word, following: Word | None, nominal: bool) -> str:
    if word.of("r") >= max(word.of("n"), word.of("a")) > 0 and not nominal:
        return "r"
    if word.ends_as_verb == "ing" and word.of("v") > word.of("n"):
        return "v"
    return _in_phrase(word, following, nominal)


def _rescue(clause: list[Word]) -> None:
    """A clause without a verb gets the likeliest word after a noun that has the form of one: of several that `and` joins, its bare form before a preposition."""
    if len(clause) < 2 or any(word.part == "v" for word in clause):
        return
    several = clause[0].text == "and" and not clause[0].fresh
    found = [
        word
        for before, word, after in zip(clause, clause[1:], [*clause[2:], None], strict=False)
        if word.part in ("n", "m", "a")
        and not word.joined
        and word.of("v") >= LEAST_VERB
        and before.part in ("n", "m", "u")
        and (
            word.ends_as_verb
            or before.text.endswith("s")
            or (several and after is not None and after.text in english.PREPOSITIONS - {"of"})
        )
    ]
    if found:
        best = max(found, key=lambda word: word.of("v"))
        best.part = "v"
        for before, word in itertools.pairwise(clause):
            if word is best and before.part == "m":
                before.part = "n"


def _particles(words: list[Word]) -> None:
    """A preposition that makes one verb of two words joins its verb."""
    for before, word, after in zip(words, words[1:], [*words[2:], None], strict=False):
        if before.part == "v" and word.text in english.PARTICLES and not word.fresh:
            alone = after is None or after.fresh or after.text in english.CONJUNCTIONS
            if particle_verb(before.text, word.text) or alone or word.text in english.ALWAYS_PARTICLES:
                word.part, word.run = "p", before.run
