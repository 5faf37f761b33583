"""Files that a sample leaves behind beside its worlds: start, calls, ending, matrix and manifest.

`outputs/example_k/` is the workspace of one server and holds nothing else; `records/example_k/` tells what happened there.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

__all__ = ["Call", "Ending", "Record"]

EndKind = Literal["limit", "lost"]


@dataclass(frozen=True)
class Ending:
    """Why a sample was ended from outside its agent."""

    kind: EndKind
    """`limit`: a budget is used up; `lost`: the server is gone or answers no more."""
    type: str
    """`calls`, `device_s`; `died`, `silent`, `flood`, `start`."""
    reason: str
    """One sentence with numbers."""
    value: float = 0.0
    limit: float = 0.0


@dataclass(frozen=True)
class Call:
    """One tool call as it passed between an agent and its server."""

    n: int
    """From 1."""
    tool: str
    arguments: Mapping[str, Any]
    at: float
    """UNIX time of the request [s]."""
    seconds: float
    ended: Literal["answered", "silent", "refused", "lost"]
    """`silent`: no answer within the limit; `refused`: the budget was used up and the server never saw it; `lost`: server or client
    were gone before an answer."""
    error: bool
    data: Any = None
    """Structured content of the answer, or its text."""
    pictures: int = 0


@dataclass
class Record:
    """The record folder of one sample."""

    folder: Path
    _read: tuple[int, list[Call]] = field(default=(0, []), repr=False)

    @property
    def calls_file(self) -> Path:
        """One JSON object per call."""
        return self.folder / "calls.jsonl"

    @property
    def end_file(self) -> Path:
        """The ending; there where something outside the agent ended the sample."""
        return self.folder / "end.json"

    def write(self, name: str, document: Any) -> None:
        """Write a JSON file."""
        path = self.folder / name
        part = path.with_suffix(".part")
        part.write_text(json.dumps(document, indent=1, sort_keys=True, default=str))
        part.replace(path)

    def read(self, name: str) -> Any:
        """A JSON file, or None where there is none."""
        path = self.folder / name
        return json.loads(path.read_text()) if path.is_file() else None

    def end(self, ending: Ending) -> None:
        """Record an ending, unless there is one: the first reason counts."""
        if not self.end_file.exists():
            self.write("end.json", asdict(ending))

    def ending(self) -> Ending | None:
        """The recorded ending."""
        found = self.read("end.json")
        return None if found is None else Ending(**found)

    def calls(self) -> list[Call]:
        """All calls so far, in the order of their answers; what was read before is not parsed again."""
        if not self.calls_file.is_file():
            return []
        place, known = self._read
        with self.calls_file.open("rb") as stream:
            stream.seek(place)
            new = list(_whole_lines(stream.read()))
        self._read = (place + sum(len(line) + 1 for line in new), [*known, *(Call(**json.loads(line)) for line in new)])
        return self._read[1]


def _whole_lines(text: bytes) -> Iterator[bytes]:
    *lines, _ = text.split(b"\n")
    yield from lines
