"""Parts of the files of skills: entries of tables, as rows cite them (`skill://rigid-bodies/diagnosis.json#creeps`), sections of texts."""

from __future__ import annotations

import difflib
import json

from ..worlds.errors import InputError

__all__ = ["entry_of", "sections_of"]


def entry_of(text: str, entry: str) -> str:
    """The part of a text that `#` names: an entry of a table (a JSON list of objects with `id`), or a section of a text by its heading.

    The whole text where `entry` is empty.

    Raises:
        InputError: there is no such entry or section.
    """
    if not entry:
        return text
    sections = sections_of(text)
    if sections:
        found = next((heading for heading in sections if heading.lower() == entry.replace("-", " ").lower()), None)
        if found is not None:
            return sections[found]
        raise InputError(
            f"there is no section {entry!r} in it; it has {', '.join(map(repr, sections))}. Leave out '#{entry}' to read the whole file"
        )
    try:
        table = {item["id"]: item for item in json.loads(text)}
    except (ValueError, TypeError, KeyError):
        table = {}
    if entry not in table:
        close = difflib.get_close_matches(entry, table, n=1)
        hint = f"; did you mean {close[0]!r}?" if close else ""
        raise InputError(f"there is no entry {entry!r} in it{hint} Leave out '#{entry}' to read the whole file")
    return json.dumps(table[entry], indent=1, ensure_ascii=False)


def sections_of(text: str) -> dict[str, str]:
    """Sections of a Markdown text by their headings of the second level; none for other files."""
    if not text.startswith(("---\n", "# ")):
        return {}
    found = {}
    for part in f"\n{text}".split("\n## ")[1:]:
        heading, _, body = part.partition("\n")
        found[heading.strip()] = f"## {heading}\n{body.rstrip()}\n"
    return found
