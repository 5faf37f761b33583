"""Failing rows cite the diagnosis tables of the skills: further causes, what to look at, the cheapest probe (R69-R75).

The tables are data in `skills/<name>/diagnosis.json`; the first entry whose `row_pattern` matches a row's id speaks.
"""

from __future__ import annotations

import json
import re
from functools import lru_cache
from importlib.resources import files
from typing import Any

from ..worlds.requirements import Correction, Row

__all__ = ["TABLES", "diagnose"]

TABLES = ("rigid-bodies",)
"""Skills whose diagnosis applies in this build."""


@lru_cache(maxsize=1)
def _entries() -> tuple[tuple[str, re.Pattern[str], dict[str, Any]], ...]:
    found = []
    for skill in TABLES:
        text = files("worldagent.skills").joinpath(skill, "diagnosis.json").read_text(encoding="utf-8")
        for entry in json.loads(text):
            found.append((f"skill://{skill}/diagnosis.json", re.compile(entry["row_pattern"]), entry))
    return tuple(found)


def diagnose(row: Row) -> Row:
    """A row that does not pass, with the causes its diagnosis adds after the measured ones; others unchanged."""
    if row.status not in ("fail", "unverified"):
        return row
    found = next(((source, entry) for source, pattern, entry in _entries() if pattern.match(row.id)), None)
    if found is None:
        return row
    source, entry = found
    cited = f"{source}#{entry['id']}"
    measured = [c if c.skill else c.model_copy(update={"skill": cited}) for c in row.corrections]
    known = {c.group for c in measured}
    added = [
        Correction(
            cause=cause["cause"],
            edit_class=cause["edit_class"],
            group=cause["group"],
            action=cause["action"],
            pointers=tuple(cause.get("pointers", ())),
            skill=cited,
        )
        for cause in entry["causes"]
        if cause["group"] not in known
    ]
    # The rule of repair goes by what the check itself measured; the table only adds ideas.
    classes = sorted({c.edit_class for c in row.corrections})
    evidence = {
        **row.evidence,
        **({"edit_classes": classes} if classes else {}),
        "diagnosis": {"symptom": entry["symptom"], "cheapest_probe": entry["cheapest_probe"]},
    }
    return row.model_copy(update={"corrections": (*measured, *added), "evidence": evidence})
