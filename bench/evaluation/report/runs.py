"""A run as plain data: what was asked, of whom, and every score of every sample; the JSON file of its report is nothing else."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any, NamedTuple

from ....worlds.errors import InputError
from ....worlds.folder import write_atomically

__all__ = ["METRICS", "Metric", "Run", "SampleScores", "read_run", "write_run"]

FORMAT = 1


class Metric(NamedTuple):
    """A column of the paper's table."""

    name: str
    title: str
    group: str
    higher: bool
    """Higher is better."""


METRICS = (
    Metric("pen", "Pen", "Physical Plausibility", higher=False),
    Metric("caus", "Caus", "Physical Plausibility", higher=True),
    Metric("qual", "Qual", "Shot Planning", higher=True),
    Metric("comp", "Comp", "Content Alignment", higher=True),
    Metric("align", "Align", "Content Alignment", higher=True),
    Metric("imag", "Imag", "Aesthetics", higher=True),
    Metric("prod", "Prod", "Aesthetics", higher=True),
    Metric("accepted", "Accepted", "Server", higher=True),
)
"""In the paper's order; the server's own acceptance beside them."""


@dataclass(frozen=True)
class SampleScores:
    """One task of one repeat."""

    task: str
    repeat: int
    outcome: str
    """Its ending: accepted, refused, limit, error; or `film` of methods that make nothing else."""
    scores: Mapping[str, float | None]
    """By metric; None where it could not be scored."""
    reasons: Mapping[str, str] = field(default_factory=dict)
    """By metric, why there is none."""
    figures: Mapping[str, Any] = field(default_factory=dict)
    """The server's own and what was spent."""
    details: Mapping[str, Any] = field(default_factory=dict)
    """By metric, all that it rests on: judge, digests, choices."""
    sheet: str = ""
    """Contact sheet of the film: a file beside the report; empty without one."""


@dataclass(frozen=True)
class Run:
    """One method on one set of prompts."""

    method: str
    model: str
    prompts: Mapping[str, str]
    """Name, version and digest of the set."""
    versions: Mapping[str, str]
    """Versions of the programs that ran and scored it."""
    samples: tuple[SampleScores, ...]
    created: str = ""
    """ISO date."""
    notes: tuple[str, ...] = ()
    """Sentences that whoever reads the scores has to know, such as an ablation."""

    @property
    def tasks(self) -> tuple[str, ...]:
        """Tasks in the order in which they stand first."""
        return tuple(dict.fromkeys(s.task for s in self.samples))

    def of_task(self, task: str) -> tuple[SampleScores, ...]:
        """Its samples, by repeat."""
        return tuple(sorted((s for s in self.samples if s.task == task), key=lambda s: s.repeat))


def write_run(run: Run, path: Path) -> None:
    """Write a run as JSON, sorted and without numbers that are none."""
    write_atomically(path, json.dumps({"format": FORMAT, **asdict(run)}, sort_keys=True, indent=1, allow_nan=False).encode())


def read_run(path: Path) -> Run:
    """Read what `write_run` wrote.

    Raises:
        InputError: there is no such file, or it is no run.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        if data.pop("format") != FORMAT:
            raise ValueError("of another format")
        samples = tuple(_sample(s) for s in data.pop("samples"))
        return Run(**{**data, "samples": samples, "notes": tuple(data["notes"])})
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{str(path)!r} is no run of the benchmark ({error}); give the JSON file of a report") from error


def _sample(data: Mapping[str, Any]) -> SampleScores:
    known = {f.name for f in fields(SampleScores)}
    strange = set(data) - known
    if strange:
        raise ValueError(f"unknown fields {sorted(strange)}")
    made = SampleScores(**data)
    for name, value in made.scores.items():
        if value is not None and (isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value)):
            raise ValueError(f"score {name!r} of {made.task!r} is {value!r}")
    return made
