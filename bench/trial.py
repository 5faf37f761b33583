"""One world in a folder of its own, edited and tested by a script through the rules of repair; no pictures, no server."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ..construction import build_world, built_paths
from ..simulation.freeze import open_freeze
from ..simulation.probe import run_probe
from ..verifiers.checks import CHECKS, names_of
from ..verifiers.diagnosis.cite import cite, diagnose
from ..workflow.session import Session
from ..worlds.candidate import Candidate, Stage
from ..worlds.canonical import spec_digest
from ..worlds.directions import field_of
from ..worlds.errors import WorldAgentError
from ..worlds.folder import WorldFolder
from ..worlds.ledger import Ledger
from ..worlds.patch import apply_patch, parse_spec
from ..worlds.requirements import Row, fail_closed

__all__ = ["Advice", "Judged", "Trial"]

Advice = Literal["table", "checks", "none"]
"""Help that a solver gets beside verdicts and measurements: the skills' tables and the history; suggestions of the checks; none."""
OPEN = ("fail", "unverified")
LEFT_OPEN = "the failing row asks for this quantity, and the prompt leaves it open"
"""Reason that the script gives for edits of quantities of nature, and of nothing else."""


@dataclass(frozen=True)
class Judged:
    """Outcome of one test of a world."""

    stage: str
    passed: bool
    rows: tuple[Row, ...]
    """Mandatory rows that do not pass, failing ones first."""


class Trial:
    """A world from a prompt and a specification."""

    def __init__(self, folder: Path, prompt: str, document: Mapping[str, Any], advice: Advice = "table") -> None:
        self.advice = advice
        spec = parse_spec({**document, "prompt": prompt})
        world = WorldFolder(folder)
        world.root.mkdir(parents=True)
        world.assets.mkdir()
        ledger = Ledger(world.ledger_path)
        number = ledger.add_revision(spec.model_dump_json(exclude_none=True), spec_digest(spec), expected=0, hypothesis="created")
        assert number is not None
        self.session = Session(world, ledger, spec, number)
        self.session.write_spec()

    @property
    def document(self) -> dict[str, Any]:
        """The present specification."""
        return self.session.spec.model_dump(mode="json", exclude_none=True)

    def edit(self, patch: Sequence[Mapping[str, Any]], hypothesis: str) -> str:
        """Make an edit; the reason where it is refused, else nothing."""
        try:
            after = apply_patch(self.session.spec, patch)
            fields = [field_of(str(operation["path"])) for operation in patch]
            reason = LEFT_OPEN if all(f is not None and f.physical for f in fields) else ""
            self.session.commit(after, patch=patch, hypothesis=hypothesis, weakening_reason=reason)
        except WorldAgentError as error:
            return str(error) or type(error).__name__
        return ""

    def judge(self) -> Judged:
        """Audit, static checks, then the probe; stops at the first that leaves something open."""
        report = self.session.audit()
        if not report.passed:
            return self._told("audit", report.rows)
        session = self.session
        built, _ = build_world(session.folder, session.spec)
        still = self._rows(Candidate(session.folder.root, session.spec, built, "static"), "static")
        blocking = [r for r in still if r.mandatory and r.status in OPEN and r.check != "shots"]
        if blocking:
            return self._told("static", still)
        freeze = open_freeze(session.folder, session.spec, built, built_paths(session.folder, session.spec), session.revision)
        candidate = run_probe(session.folder, freeze)
        return self._told("probe", self._rows(candidate, "probe"))

    def _rows(self, candidate: Candidate, stage: Stage) -> list[Row]:
        """Rows as the advice has them, in the ledger; iterations that they test are closed."""
        ledger = self.session.ledger
        rows = [fail_closed(r) for c in CHECKS if stage in c.stages for r in c.function(candidate)]
        failing = [r.id for r in rows if r.mandatory and r.status == "fail"]
        if stage == "probe" or any(r.mandatory and r.status in OPEN and r.check != "shots" for r in rows):
            ledger.close_iterations(stage, failing, rows, revision=self.session.revision)
        if self.advice == "table":
            attempts = ledger.attempts()
            rows = [cite(diagnose(r, candidate.spec), attempts.get(r.id, ())) for r in rows]
        ledger.put_rows(rows, revision=self.session.revision, stage=stage, checks=names_of(stage))
        return rows

    def _told(self, stage: str, rows: Sequence[Row]) -> Judged:
        found = [r for r in rows if r.mandatory and r.status in OPEN]
        if stage == "static":
            found = [r for r in found if r.check != "shots"]
        found.sort(key=lambda r: r.status != "fail")
        if self.advice == "none":
            found = [r.model_copy(update={"corrections": ()}) for r in found]
        return Judged(stage, not found, tuple(found))
