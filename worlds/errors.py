"""Errors of worldagent.

WorldAgentError
├── InputError            the caller can mend it: value, allowed range, next step
│   ├── SpecError         the specification or a patch does not validate
│   └── LimitError        a declared cap would be exceeded; carries the estimate
├── RefusedError          a gate of the server holds; names the missing evidence
├── EvidenceError         an artifact is missing, damaged or does not match its digest
│   └── NotFiniteError    it holds numbers that are none
└── EngineError           a simulator, renderer or worker process failed
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = [
    "EngineError",
    "EvidenceError",
    "InputError",
    "LimitError",
    "NotFiniteError",
    "RefusedError",
    "SpecError",
    "WorldAgentError",
]


class WorldAgentError(Exception):
    """Base of all errors whose text is written for the caller."""


class InputError(WorldAgentError):
    """An argument is out of its allowed range; the text names value, range and next step."""


class SpecError(InputError):
    """A specification or patch does not validate; `problems` holds (pointer, message)."""

    def __init__(self, message: str, problems: tuple[tuple[str, str], ...] = ()) -> None:
        super().__init__(message)
        self.problems = problems


class LimitError(InputError):
    """A declared cap would be exceeded; the text names cap, estimate and the knob to turn."""


class RefusedError(WorldAgentError):
    """A gate held by the server; the text names what evidence is missing and the next call."""


class EvidenceError(WorldAgentError):
    """An artifact is missing, damaged, stale or altered."""


class NotFiniteError(EvidenceError):
    """A channel holds a number that is not finite: evidence of a fault, not a lack of evidence."""


class EngineError(WorldAgentError):
    """A simulator, renderer or worker process failed; the candidate stays as it was.

    `where` tells of a simulator's failure, as far as it is known: `solver`, `frame`, `entities` and `place` [m].
    """

    def __init__(self, *args: object, where: Mapping[str, Any] | None = None) -> None:
        super().__init__(*args)
        self.where = dict(where or {})
