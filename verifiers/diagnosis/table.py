"""Form of the diagnosis tables of the skills: what an entry may say, checked when the table is read.

A table is data, `skills/<name>/diagnosis.json`: a list of entries. An entry names rows by a pattern (and by what they
measured), ranked causes with the one parameter group that cures each, and the cheapest calls that tell them apart. A
new category of physics brings a table in its own skill; nothing here knows what a rigid body is.
"""

from __future__ import annotations

import json
import re
from functools import lru_cache
from importlib.resources import files
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from ...worlds.requirements import Check, RowClass

__all__ = ["TABLES", "Cause", "Condition", "Entry", "PatchRule", "Probe", "entries", "table_schema"]

TABLES = (
    "elastic-bodies",
    "cloth",
    "fracture",
    "particles",
    "gas",
    "liquids",
    "coupled-systems",
    "rigid-bodies",
    "outdoor-terrain",
)
"""Skills whose diagnosis applies in this build."""


class _Data(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)


class Condition(_Data):
    """A comparison with one number or word of the row. Unknown where the row has no such key."""

    key: str = Field(description="field of a row, e.g. 'measured' or 'first_failing_frame', or 'evidence.<key>[.<key>]'")
    compare: Literal["==", "!=", "<", "<=", ">", ">=", "present", "absent"] = Field(alias="is")
    value: float | int | bool | str | None = Field(default=None, description="what it is compared with")
    than: str | None = Field(default=None, description="another key of the row to compare with, instead of a value")
    times: float = Field(default=1.0, description="factor on the other key")


class PatchRule(_Data):
    """One operation of a suggested patch, from the value in `world.json` and numbers of the row.

    Give one of `value`, `scale`, `ratio`, `plus`, `toward`.
    """

    pointer: str = Field(description="JSON pointer, with placeholders such as <entity> and <solver>")
    value: float | int | bool | str | None = Field(default=None, description="the new value")
    scale: float | None = Field(default=None, description="factor on the present value")
    ratio: tuple[str, str] | None = Field(
        default=None, description="keys (a, b): factor (a / b) ** power * margin on the present value"
    )
    power: float = 1.0
    margin: float = 1.0
    plus: str | None = Field(default=None, description="key: the present value plus `times` that number")
    times: float = 1.0
    toward: str | None = Field(
        default=None, description="entity (a placeholder) to which a position is moved, level, so that ..."
    )
    reach: float | None = Field(
        default=None, description="... the two are this share of that entity's height apart, never nearer than in touch"
    )
    low: float | None = Field(default=None, description="least value; none is suggested that the present one has passed")
    high: float | None = None


class Cause(_Data):
    """One possible cause."""

    cause: str
    edit_class: RowClass
    group: str = Field(description="the one causal parameter group to change (worlds/groups.py)")
    action: str
    pointers: tuple[str, ...] = ()
    when: tuple[Condition, ...] = Field(
        default=(), description="where all hold, the evidence speaks for the cause: it goes first"
    )
    unless: tuple[Condition, ...] = Field(default=(), description="where one holds, the evidence speaks against it: it goes last")
    needs: tuple[str, ...] = Field(default=(), description="placeholders without which the cause is left out, e.g. 'driver'")
    patch: tuple[PatchRule, ...] = Field(default=(), description="used where the check itself suggests no patch of this group")
    weakens: bool = Field(
        default=False, description="the edit makes the specification easier: it ranks below what mends the world"
    )


class Probe(_Data):
    """A call that tells, without `world`."""

    tool: str
    arguments: dict[str, Any] = {}
    look_at: str


class Entry(_Data):
    """One possible meaning of a row."""

    id: str
    checks: tuple[Check, ...]
    symptom: str
    row_pattern: str
    statuses: tuple[Literal["fail", "unverified"], ...] = ("fail",)
    when: tuple[Condition, ...] = Field(default=(), description="all must hold for the entry to speak")
    evidence: tuple[str, ...]
    causes: tuple[Cause, ...]
    cheapest_probe: tuple[Probe, ...]


_TABLE: TypeAdapter[tuple[Entry, ...]] = TypeAdapter(tuple[Entry, ...])


def table_schema() -> dict[str, Any]:
    """JSON Schema of a table."""
    return _TABLE.json_schema(by_alias=True)


@lru_cache(maxsize=1)
def entries() -> tuple[tuple[str, re.Pattern[str], Entry], ...]:
    """(source, compiled pattern, entry) of all tables, in order: the first that matches speaks."""
    found = []
    for skill in TABLES:
        text = files("worldagent.skills").joinpath(skill, "diagnosis.json").read_text(encoding="utf-8")
        for entry in _TABLE.validate_python(json.loads(text)):
            found.append((f"skill://{skill}/diagnosis.json", re.compile(entry.row_pattern), entry))
    return tuple(found)
