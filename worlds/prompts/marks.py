r"""Marked text: a prompt with the meaning of its words written beside them.

    A [steel](property ball) [ball](thing ball) [rolls off](event roll) the [table](thing /entities/table).

A mark is `[quote](type target ... key=value)`. Values and targets with blanks stand in double quotes, where `\"` is a quote and `\\` a
backslash. `[`, `]`, `(`, `)` and the backslash of the prompt itself may be written `\[`, `\]`, `\(`, `\)`, `\\`; brackets and
backslashes must be. Without its marks the text equals the prompt; offsets are those of the prompt.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Literal, NamedTuple, get_args

import regex

from ..errors import InputError
from .quotes import Alignment, cut_word, first_difference, nth_of, occurrence
from .units import letters

__all__ = ["OPTIONS", "TYPES", "Mark", "MarkType", "marked_text", "occurrence", "parse_marks"]

MarkType = Literal[
    "thing", "count", "quantity", "property", "event", "order", "negation", "place", "time", "weather", "look", "route", "waived"
]
TYPES: tuple[MarkType, ...] = get_args(MarkType)
OPTIONS = ("same_as", "because")
"""Keys of a mark: the claim that speaks of the same thing; why nothing judges a waived span."""
SHOWN = 5
"""Faults named in one error; own choice: more would not be read."""

_ESCAPABLE = "[]()\\"
_BARE = regex.compile(r'[^\s()"=\[\]\\]+')
_PIECE = regex.compile(r'\s*(?:(?P<key>[^\s()"=]+)=)?(?:"(?P<quoted>(?:[^"\\]|\\.)*)"|(?P<bare>[^\s()"=]+))', regex.DOTALL)
_CLOSE = regex.compile(r"\s*\)")


@dataclass(frozen=True)
class Mark:
    """The meaning of a span of the prompt: `prompt[start:end] == quote`, the `nth` such text of the prompt, from 1."""

    start: int
    end: int
    quote: str
    type: MarkType
    targets: tuple[str, ...] = ()
    options: Mapping[str, str] = field(default_factory=dict)
    nth: int = 1


class _Raw(NamedTuple):
    """A mark as it is written; offsets are those of the text without marks."""

    start: int
    end: int
    words: tuple[str, ...]
    options: dict[str, str]


def parse_marks(marked: str, prompt: str) -> tuple[Mark, ...]:
    """The marks of a marked text, in order.

    Raises:
        InputError: the text cannot be read, differs from the prompt without its marks, or a mark is not one of whole words.
    """
    plain, raw = _read(marked)
    given, wanted = Alignment(plain), Alignment(prompt)
    if given.normal != wanted.normal:
        raise InputError(
            f"the marked text without its marks is not the prompt: {first_difference(plain, prompt)}. "
            r"Copy the prompt letter by letter and write its own brackets as \[ and \]"
        )
    marks: list[Mark] = []
    problems: list[str] = []
    for item in raw:
        faults = _faults(item, plain[item.start : item.end])
        start, end = (_carried(offset, plain, prompt, given, wanted) for offset in (item.start, item.end))
        word = cut_word(plain, item.start, item.end)
        if word is not None or start is None or end is None:
            word = word or plain[item.start : item.end]
            faults.append(f"[{plain[item.start : item.end]}] cuts {word!r} in two: mark whole words")
        elif not faults:
            kind = next(name for name in TYPES if name == item.words[0])
            marks.append(Mark(start, end, prompt[start:end], kind, item.words[1:], item.options, nth_of(prompt, start, end)))
        problems += faults
    if problems:
        more = f"; and {len(problems) - SHOWN} more" if len(problems) > SHOWN else ""
        raise InputError("; ".join(problems[:SHOWN]) + more)
    return tuple(marks)


def _carried(offset: int, plain: str, prompt: str, given: Alignment, wanted: Alignment) -> int | None:
    if plain == prompt:
        return offset
    normal = given.to_normal(offset)
    return None if normal is None else wanted.to_text(normal)


def _faults(item: _Raw, quote: str) -> list[str]:
    """Sentences on a mark that say what is wrong with it and what to write."""
    shown, found = f"[{quote}]", []
    if not letters(quote):
        found.append(f"{shown} holds no word: mark words of the prompt")
    elif quote != quote.strip():
        found.append(f"{shown} begins or ends with a blank: write the blank outside, [{quote.strip()}]")
    if not item.words:
        return [*found, f"{shown}() has no type: write one of {', '.join(TYPES)} first"]
    kind, targets = item.words[0], item.words[1:]
    if kind not in TYPES:
        near = get_close_matches(kind, TYPES, 1)
        known = f"{near[0]!r}" if near else f"one of {', '.join(TYPES)}; what says nothing of the world stays without a mark"
        found.append(f"{shown} has the type {kind!r}: write {known}")
    unknown = [key for key in item.options if key not in OPTIONS]
    if unknown:
        found.append(f"{shown} has the key {unknown[0]!r}: the keys are {', '.join(OPTIONS)}")
    if kind == "waived" and (targets or not item.options.get("because", "").strip()):
        found.append(f'{shown} is waived: name no target, and say why nothing can judge it, (waived because="...")')
    if kind != "waived" and "because" in item.options:
        found.append(f"{shown} gives a reason, which only a waived span has: drop `because`")
    return found


def _read(marked: str) -> tuple[str, list[_Raw]]:
    """The text without its marks, and the marks."""
    plain: list[str] = []
    raw: list[_Raw] = []
    length, at, opened, opened_at = 0, 0, -1, 0
    while at < len(marked):
        character = marked[at]
        if character == "\\" and marked[at + 1 : at + 2] in tuple(_ESCAPABLE):
            at, character = at + 1, marked[at + 1]
        elif character == "[":
            if opened >= 0:
                raise InputError(
                    rf"the mark {_excerpt(marked, opened_at)} holds another '[': marks do not nest; a bracket of the prompt is written \["
                )
            opened, opened_at, at = length, at, at + 1
            continue
        elif character == "]":
            if opened < 0:
                raise InputError(rf"']' without '[' at {_excerpt(marked, at)}: a bracket of the prompt is written \]")
            words, options, at = _meaning(marked, at + 1, opened_at)
            raw.append(_Raw(opened, length, words, options))
            opened = -1
            continue
        plain.append(character)
        length, at = length + 1, at + 1
    if opened >= 0:
        raise InputError(rf"the mark {_excerpt(marked, opened_at)} has no ']': close it; a bracket of the prompt is written \[")
    return "".join(plain), raw


def _meaning(marked: str, at: int, opened_at: int) -> tuple[tuple[str, ...], dict[str, str], int]:
    """Words and options of the round brackets that begin here, and the offset behind them."""
    shown = _excerpt(marked, opened_at)
    if marked[at : at + 1] != "(":
        raise InputError(
            rf"the mark {shown} has no '(type ...)' right behind ']': add it; brackets of the prompt are written \[ and \]"
        )
    words: list[str] = []
    options: dict[str, str] = {}
    at += 1
    while not (closed := _CLOSE.match(marked, at)):
        piece = _PIECE.match(marked, at)
        if piece is None:
            raise InputError(
                f"""the mark {shown} has no ')', or a stray '"' or '=': write (type target key=value key="two words")"""
            )
        quoted, bare, key = piece.group("quoted", "bare", "key")
        value = bare if quoted is None else regex.sub(r"(?s)\\(.)", r"\1", quoted)
        if key is None:
            words.append(value)
        elif key in options:
            raise InputError(f"the mark {shown} has the key {key!r} twice: keep one")
        else:
            options[key] = value
        at = piece.end()
    return tuple(words), options, closed.end()


def _excerpt(marked: str, at: int) -> str:
    return repr(marked[at : at + 30] + ("…" if len(marked) > at + 30 else ""))


def marked_text(prompt: str, marks: Iterable[Mark]) -> str:
    """The prompt with its marks, as `parse_marks` reads it.

    Raises:
        InputError: a mark is not of this prompt, or two overlap.
    """
    pieces, at = [], 0
    for mark in sorted(marks, key=lambda mark: (mark.start, mark.end)):
        if mark.start < at:
            raise InputError(f"[{mark.quote}] at {mark.start} overlaps the mark that ends at {at}: marks lie side by side")
        if unicodedata.normalize("NFC", prompt[mark.start : mark.end]) != unicodedata.normalize("NFC", mark.quote):
            raise InputError(
                f"the prompt says {prompt[mark.start : mark.end]!r} at {mark.start}, not {mark.quote!r}: mark it anew"
            )
        words = [mark.type, *map(_written, mark.targets), *(f"{key}={_written(value)}" for key, value in mark.options.items())]
        pieces += [_escaped(prompt[at : mark.start]), "[", _escaped(prompt[mark.start : mark.end]), "](", " ".join(words), ")"]
        at = mark.end
    return "".join([*pieces, _escaped(prompt[at:])])


def _escaped(text: str) -> str:
    return regex.sub(r"([\[\]\\])", r"\\\1", text)


def _written(value: str) -> str:
    if _BARE.fullmatch(value):
        return value
    return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
