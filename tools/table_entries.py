"""Entries of the tables of skills, as rows cite them: `skill://rigid-bodies/diagnosis.json#creeps`."""

from __future__ import annotations

import difflib
import json

from ..worlds.errors import InputError

__all__ = ["entry_of"]


def entry_of(text: str, entry: str) -> str:
    """One entry of a table (a JSON list of objects with `id`), as rows cite it behind `#`; the whole text without one.

    Raises:
        InputError: the table has no such entry.
    """
    if not entry:
        return text
    try:
        table = {item["id"]: item for item in json.loads(text)}
    except (ValueError, TypeError, KeyError):
        table = {}
    if entry not in table:
        close = difflib.get_close_matches(entry, table, n=1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        raise InputError(f"there is no entry {entry!r} in it{hint} Leave out '#{entry}' to read the whole file")
    return json.dumps(table[entry], indent=1, ensure_ascii=False)
