"""The tables in `data/`: spelled-out numbers and names of units from ICU (`packaging/number_words.py`), places of colours, descriptive words."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import Any

__all__ = ["NUMBER_LANGUAGES", "table"]

NUMBER_LANGUAGES = ("en", "de", "fr", "es", "it", "pt", "nl", "ru", "zh", "ja", "ar", "hi")
"""Languages whose spelled-out numbers and units are read."""


@cache
def table(name: str) -> dict[str, Any]:
    """`numbers`, `units`, `colours` or `descriptions`, as they stand in `data/`."""
    found: dict[str, Any] = json.loads((files(__package__) / "data" / f"{name}.json").read_text(encoding="utf-8"))
    return found
