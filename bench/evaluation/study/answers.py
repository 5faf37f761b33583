"""Answers of a study in one file: JSON lines, only ever appended, each on disk before the next page is shown. No names, no addresses, no times."""

from __future__ import annotations

import hmac
import json
import os
import secrets
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ....worlds.errors import InputError
from .design import Step, Study

__all__ = ["CRITERIA", "AnswerFile", "Rater"]

CRITERIA: Mapping[str, tuple[str, str]] = {
    "physical": ("Physical Plausibility", "motion, contact, deformation, and how materials respond"),
    "shots": ("Shot Planning Quality", "purposeful variety of viewpoints, natural transitions, smooth speed and acceleration"),
    "content": ("Content Alignment", "scene and simulation are what the prompt asks for"),
    "aesthetics": ("Aesthetics", "overall visual quality"),
}
"""The paper's four criteria with its words for what they cover (R153)."""
CHOICES = ("first", "second", "equal")
"""Answers about a pair."""


@dataclass(frozen=True)
class Rater:
    """One participant: a random word in place of a name."""

    id: str
    number: int
    """Order of consent, from 0."""


class AnswerFile:
    """The file, and what it says so far.

    Args:
        path: of the file; it is made if it is not there.
        study: whose answers it holds.
        films: digest of the films.

    Raises:
        InputError: the file holds answers to another study, or lines that are no answers.
    """

    def __init__(self, path: Path, study: Study, films: str) -> None:
        self.path, self.study = path, study
        self._lock = threading.Lock()
        self._raters: dict[str, Rater] = {}
        self.answered: dict[tuple[str, int], dict[str, Any]] = {}
        """Answer by rater and number of the page."""
        lines = read_lines(path)
        told = {"kind": "study", "version": 1, "films_sha256": films, **study.told()}
        if not lines:
            self._secret = secrets.token_hex(16)
            self._append({**told, "secret": self._secret})
        elif (known := {k: v for k, v in lines[0].items() if k != "secret"}) != told:
            apart = sorted(k for k in told.keys() | known.keys() if told.get(k) != known.get(k))
            raise InputError(
                f"{str(path)!r} holds answers to another study: {', '.join(apart)} differ; give --answers another file, or the films and options of before"
            )
        else:
            self._secret = str(lines[0]["secret"])
        for line in lines[1:]:
            self._take(line)

    def _take(self, line: Mapping[str, Any]) -> None:
        if line["kind"] == "rater":
            self._raters[str(line["rater"])] = Rater(str(line["rater"]), int(line["number"]))
        else:
            self.answered[(str(line["rater"]), int(line["step"]))] = dict(line)

    def _append(self, line: Mapping[str, Any]) -> None:
        """Write a line, after mending the end of the last one if a crash cut it."""
        with self.path.open("ab+") as stream:
            if stream.tell():
                stream.seek(-1, os.SEEK_END)
                if stream.read(1) != b"\n":
                    stream.write(b"\n")
            stream.write(json.dumps(line, sort_keys=True).encode() + b"\n")
            stream.flush()
            os.fsync(stream.fileno())

    def enrol(self) -> Rater:
        """A new rater, who has consented."""
        with self._lock:
            rater = Rater(secrets.token_urlsafe(9), len(self._raters))
            self._append({"kind": "rater", "rater": rater.id, "number": rater.number, "consent": True})
            self._raters[rater.id] = rater
            return rater

    def rater(self, name: str) -> Rater | None:
        """A rater by the word in place of a name."""
        return self._raters.get(name)

    def next_step(self, rater: Rater) -> tuple[int, Step] | None:
        """The first page without an answer and its number; None where all are answered."""
        return next(((k, s) for k, s in enumerate(self.study.steps(rater.number)) if (rater.id, k) not in self.answered), None)

    def keep(self, rater: Rater, number: int, answer: Mapping[str, Any]) -> bool:
        """Keep the answer to a page; False where there is one already, which stays.

        Args:
            rater: who answers.
            number: of the page.
            answer: `scores` by place and criterion, or `choice`.
        """
        with self._lock:
            if (rater.id, number) in self.answered:
                return False
            step = self.study.steps(rater.number)[number]
            line = {
                "kind": step.kind,
                "rater": rater.id,
                "step": number,
                "task": step.task,
                "methods": list(step.methods),
                **answer,
            }
            self._append(line)
            self.answered[(rater.id, number)] = line
            return True

    def token(self, rater: Rater, number: int, place: int) -> str:
        """Name of a film on a page: it tells nothing, and is another one on every page and for every rater."""
        return hmac.new(self._secret.encode(), f"{rater.id}/{number}/{place}".encode(), "sha256").hexdigest()[:24]


def read_lines(path: Path) -> list[dict[str, Any]]:
    """Lines of an answer file; a last one that a crash cut is left out.

    Raises:
        InputError: a line is no answer, or the first is no study.
    """
    if not path.is_file():
        return []
    lines = path.read_bytes().split(b"\n")
    found: list[dict[str, Any]] = []
    for k, line in enumerate(lines):
        if not line.strip():
            continue
        try:
            told = json.loads(line)
            known = told["kind"] in ("study", "rater", "rate", "pair")
        except (ValueError, KeyError, TypeError):
            known = False
        if known:
            found.append(told)
        elif not _cut(lines, k):
            raise InputError(f"line {k + 1} of {str(path)!r} is no answer of a study; mend it, or give --answers another file")
    if found and found[0]["kind"] != "study":
        raise InputError(f"{str(path)!r} does not begin with a study; give --answers another file")
    return found


def _cut(lines: list[bytes], k: int) -> bool:
    """True for what a crash can leave: the beginning of an answer without its end."""
    return lines[k].startswith(b"{") and not lines[k].endswith(b"}")
