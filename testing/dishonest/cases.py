"""Honest worlds and the tricks played on them, as data."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .agent import Agent

__all__ = ["GONE", "Case", "Document", "Twin", "changed", "without_marks"]

Document = dict[str, Any]
"""A specification without prompt and claims, as JSON."""
GONE = object()
"""Value of a change that takes a member away."""
_MARK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


@dataclass(frozen=True)
class Twin:
    """An honest world: what an agent gives `edit_spec`."""

    name: str
    scene: Callable[[], Document]
    marked: str
    """Its prompt, with what each span means."""
    changes: Mapping[str, Any] = field(default_factory=dict)
    """Changes of the scene, by JSON pointer."""

    @property
    def prompt(self) -> str:
        """The prompt alone."""
        return without_marks(self.marked)

    def document(self) -> Document:
        """Its specification."""
        return changed(self.scene(), self.changes)


@dataclass(frozen=True)
class Case:
    """A trick on an honest world, and what must give it away."""

    id: str
    twin: Twin
    row: str = ""
    """Pattern of the id of a row that must be open (`*` stands for anything); empty where a line of the verdict must tell."""
    says: str = ""
    """Part of what that row says; without a row, part of a line of the verdict that the verdict of the twin lacks."""
    marked: str | None = None
    """Prompt with its marks where they are not the twin's."""
    prompt: str | None = None
    """Prompt where it is not that of `marked`: marks then are for another text."""
    changes: Mapping[str, Any] = field(default_factory=dict)
    """Changes of the twin, by JSON pointer; `GONE` takes away."""
    act: Callable[[Agent], str] | None = None
    """Deeds on the accepted twin instead of a world of its own; returns what was answered, in which `says` must be."""

    def given(self) -> tuple[str, str | None, Document]:
        """Prompt, marked text and specification of the dishonest world."""
        marked = self.twin.marked if self.marked is None else self.marked
        prompt = without_marks(marked) if self.prompt is None else self.prompt
        return prompt, marked or None, changed(self.twin.document(), self.changes)


def without_marks(marked: str) -> str:
    """A marked text without its marks."""
    return _MARK.sub(r"\1", marked)


def changed(document: Document, changes: Mapping[str, Any]) -> Document:
    """A copy of a JSON document with values set, or taken away, at pointers; missing objects on the way are made."""
    made = copy.deepcopy(document)
    for pointer, value in changes.items():
        *way, last = pointer.strip("/").split("/")
        at: Any = made
        for token in way:
            at = at[int(token)] if isinstance(at, list) else at.setdefault(token, {})
        key: Any = int(last) if isinstance(at, list) else last
        if value is GONE:
            del at[key]
        else:
            at[key] = copy.deepcopy(value)
    return made
