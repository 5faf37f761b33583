"""Texts from strangers made safe to show: names, prompts, hypotheses, messages that came with a file or from another agent.

Whoever reads a result - a model, a terminal, a browser - must see every character that is there, and must be able to tell
text that is quoted from text that the server says. Characters that act on a terminal, reorder what stands beside them, or
cannot be seen at all (among them the tag characters and variation selectors in which instructions can be hidden from people
and still be read by a model) are spelled out, and what is very long is cut.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import Any

__all__ = ["SHOWN_CHARACTERS", "json_visible", "listed", "markdown_inline", "quoted", "shown", "visible"]

SHOWN_CHARACTERS = 20_000
"""Longest single text in a reply: as long as a prompt may be."""
_RANGES = (
    "\x00-\x08\x0b-\x1f\x7f-\x9f"  # controls but tab and line feed
    "\xad\u034f\u061c\u070f\u115f\u1160\u17b4\u17b5\u180b-\u180f"  # invisible hyphens, joiners, fillers
    "\u200b-\u200f\u2028-\u202e\u2060-\u206f"  # zero width, line separators, bidirectional overrides and isolates
    "\u2800\u3164\ufe00-\ufe0e\ufeff\uffa0\ufff0-\uffff"  # blanks that count as letters, selectors, specials
    "\ud800-\udfff\ue000-\uf8ff"  # surrogates, private use
    "\U0001bca0-\U0001bca3\U0001d173-\U0001d17a\U000e0000-\U0010ffff"  # shorthand and music format, tags, private use
)
_HIDDEN = re.compile(f"[{_RANGES}]")
_HIDDEN_OR_BREAK = re.compile(f"[\t\n{_RANGES}]")
_MARKDOWN = re.compile(r"([\\`*_{}\[\]<>()#|~!&])")
_SPELLED = {"\t": "\\t", "\n": "\\n", "\r": "\\r"}


def visible(text: str) -> str:
    """Text whose every character can be seen; line feeds and tabs stay."""
    return _HIDDEN.sub(_spell, text)


def quoted(text: object, *, most: int = 120) -> str:
    """A stranger's text inside a sentence: one line, in quotes, nothing hidden, at most `most` characters of it."""
    full = str(text)
    cut = full[:most].replace("\\", "\\\\").replace("'", "\\'")
    left = len(full) - most
    return f"'{_HIDDEN_OR_BREAK.sub(_spell, cut)}'" + (f" ... ({left} more characters)" if left > 0 else "")


def markdown_inline(text: object, *, most: int = 300) -> str:
    """A stranger's text inside a line of Markdown: it can neither begin a heading or link nor end the line."""
    full = str(text)
    left = len(full) - most
    safe = _HIDDEN_OR_BREAK.sub(_spell_for_markdown, _MARKDOWN.sub(r"\\\1", full[:most]))
    return safe + (f" ... ({left} more characters)" if left > 0 else "")


def shown(value: Any) -> Any:
    """A reply's data with every text in it made visible and cut, keys included; numbers and structure stay."""
    if isinstance(value, str):
        left = len(value) - SHOWN_CHARACTERS
        return visible(value[:SHOWN_CHARACTERS]) + (f" ... ({left} more characters)" if left > 0 else "")
    if isinstance(value, dict):
        return {shown(key) if isinstance(key, str) else key: shown(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [shown(item) for item in value]
    return value


def listed(names: Sequence[str], most: int) -> str:
    """At most so many names in a line, and how many more there are."""
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def json_visible(document: str) -> str:
    """The same JSON document with hidden characters of its strings as JSON escapes: it parses to what it did before."""
    return _HIDDEN.sub(lambda found: json.dumps(found[0])[1:-1], document)


def _spell(found: re.Match[str]) -> str:
    character = found[0]
    code = ord(character)
    return _SPELLED.get(character) or (f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}" if code < 65536 else f"\\U{code:08x}")


def _spell_for_markdown(found: re.Match[str]) -> str:
    return " " if found[0] in "\t\n" else "\\" + _spell(found)
