"""A world as tools work on it: commit a revision, run static checks, record rows."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..execution import one_core, seldom_collected
from ..worlds.audits.audit import AuditReport, audit
from ..worlds.canonical import spec_digest
from ..worlds.coarsening import read_factors
from ..worlds.documents import text_of
from ..worlds.errors import RefusedError
from ..worlds.limits import check_cap
from ..worlds.provenance import stale_artifacts, stale_rows
from ..worlds.requirements import Row
from ..worlds.spec import WorldSpec
from .changes import Change, is_static
from .joint_repairs import Joint
from .opened import OpenedWorld
from .repair_rules import UNDONE

if TYPE_CHECKING:
    from ..execution import Tell
    from ..worlds.candidate import Candidate

__all__ = ["Session"]

NAMED = 8
"""Stale rows that the reply to an edit names."""


class Session(OpenedWorld):
    """An opened world that is edited and judged."""

    def record(self, rows: Sequence[Row], *, stage: str, checks: Iterable[str] = (), keep: Iterable[str] = ()) -> list[Row]:
        """Write rows judged on this session's revision, see `Ledger.put_rows`; returns those that changed.

        What an edit changed meanwhile is no evidence for the world as it is now: those rows are stale from the start, and
        replace no verdict about a later revision.
        """
        with self.ledger.together():
            latest = self.ledger.revision()
            recorded = self.ledger.revision_spec(latest)
            if latest == self.revision or recorded is None:
                return self.ledger.put_rows(rows, revision=self.revision, stage=stage, checks=checks, keep=keep)
            stale = stale_artifacts(self.spec, WorldSpec.model_validate_json(recorded[0]))
            lost = {r.id: "world.json" for r in rows if r.check == "audit"}
            lost |= stale_rows(list(rows), {r.id: stage for r in rows}, stale)
            judged = self.ledger.judged_at()
            known = [r for r in rows if r.id not in lost or judged.get(r.id, 0) <= self.revision]
            keep = {*keep, *(r.id for r in rows)}
            changed = self.ledger.put_rows(known, revision=self.revision, stage=stage, checks=checks, keep=keep)
            told = {r.id: f"{lost[r.id]} changed in revision {latest}" for r in known if r.id in lost}
            self.ledger.mark_stale(told, latest)
            return changed

    # ---------------------------------------------------------------- edits

    @seldom_collected()
    def commit(
        self,
        after: WorldSpec,
        *,
        patch: Sequence[Mapping[str, Any]],
        hypothesis: str = "",
        weakening_reason: str = "",
        derived: bool = False,
        follows: Collection[str] = (),
        joint: Joint | None = None,
    ) -> dict[str, Any]:
        """Make `after` the next revision, if the rules of repair allow it; returns the changed places and the stale artifacts.

        `derived` says that the change only follows from an edit that was made already, and is no edit of its own. `follows` are pointers
        of what changes only because an entity moves or is copied: its joints, its paths. `joint` says of several parameter groups which
        failing row each answers.

        Raises:
            RefusedError: the edit breaks R111-R113 or R157, or another revision came first.
        """
        check_cap("text_characters", max(len(hypothesis), len(weakening_reason)), what="hypothesis or weakening_reason")
        change = Change(
            self, after, hypothesis=hypothesis, reason=weakening_reason, derived=derived, follows=follows, joint=joint
        )
        if change.causal and not derived and not change.takes_back():
            self._test_static()
        with self.step():
            objections = change.objections()
            if objections:
                raise RefusedError("\n".join(objections))
            number = self._add(change, patch)
            lost = stale_rows(self.ledger.rows(), self.ledger.stages(), change.stale)
            self.ledger.mark_stale({k: f"{v} changed in revision {number}" for k, v in lost.items()}, number)
            if change.undone:
                still = {r.id for r in change.failing}.union(*(json.loads(str(i["failing_before"])) for i in change.undone))
                self.ledger.close_iterations(UNDONE, sorted(still), revision=number)
            elif change.failing and change.causal:
                for attempt in change.attempts():
                    self.ledger.add_iteration(number, *attempt[:4], expect=attempt.expect)
            self.spec, self.revision = after, number
            self.write_spec()
        weakened = {"weakenings_recorded": change.weaker} if change.weaker else {}
        return {
            "revision": number,
            **change.told(),
            "rows_now_stale": len(lost),
            **({"stale_rows": sorted(lost)[:NAMED]} if lost else {}),
            **weakened,
        }

    def _test_static(self) -> None:
        """Test the last change by the static checks where they are all that it waits for: a call of `place_object` that the next edit would ask for."""
        untested = self.ledger.open_iterations()
        if untested and all(is_static(self.ledger, i) for i in untested) and self.buildable(self.audit()):
            self.check_static()

    def _add(self, change: Change, patch: Sequence[Mapping[str, Any]]) -> int:
        """Number of the revision that the ledger makes of a change."""
        number = self.ledger.add_revision(
            text_of(change.after).decode(),
            spec_digest(change.after),
            expected=self.revision,
            patch=[dict(o) for o in patch],
            hypothesis=change.hypothesis,
            groups=[g.name for g in change.groups],
            weakenings=change.weaker,
            reason=change.reason,
        )
        if number is None:
            raise RefusedError(
                f"another client changed {self.folder.id!r} meanwhile (revision {self.ledger.revision()}, you had {self.revision}); "
                "read it again with inspect_world and repeat the edit"
            )
        if change.early:
            self.ledger.add_early(number, change.early)
        return number

    def shown(self, candidate: Candidate, last: int) -> str:
        """Record that frames up to `last` of a motion are shown; one without a verdict counts as evidence all the same.

        Returns a warning about it; empty where the motion was judged. Who watches the frames of a probe or a bake and cancels it before its rows are written knows what they would say.
        """
        if candidate.stage == "static":
            return ""
        root = (self.folder.root / candidate.artifact).parent
        freeze = str(self.folder.read_json(root / "candidate.json")["freeze"])
        if candidate.artifact.endswith("/sketch"):
            if not read_factors(self.folder.root / candidate.artifact).judged:
                self.ledger.add_look(freeze, "sketch", self.revision, last)
            return "frames of a sketch, coarse and without a verdict: no row of the matrix is from it"
        if candidate.stage == "full":
            known = self.ledger.bake(freeze)
            judged = None if known is None else known["digest"]
        else:
            known = self.ledger.freeze(freeze)
            judged = None if known is None else known["detail"].get("digest", candidate.digest)
        if judged == candidate.digest:
            return ""
        self.ledger.add_look(freeze, candidate.stage, self.revision, last)
        return "no check has judged this motion yet; it was looked at, so that it counts as evidence like a probe's rows, cancelled or not"

    # ---------------------------------------------------------------- checks

    def audit(self) -> AuditReport:
        """Audit the present revision and record its rows."""
        report = audit(self.spec)
        self.record(report.rows, stage="audit", checks=("audit",))
        if not report.passed:  # no other test can run on this change: the audit has been its test
            failing = [r.id for r in report.rows if r.status == "fail" and r.mandatory]
            self.ledger.close_iterations("audit", failing, report.rows, revision=self.revision)
        return report

    def require_audit(self, purpose: str, *, still: bool = False) -> AuditReport:
        """The audit, if it passes; for what only looks at things that stand still, beats and claims may be missing.

        Raises:
            RefusedError: it does not.
        """
        report = self.audit()
        if not (self.buildable(report) if still else report.passed):
            bad = [r for r in report.rows if r.mandatory and r.status != "pass"]
            lines = [f"  {r.id}: {p}" for r in bad for p in r.evidence.get("problems", [])[:4]]
            raise RefusedError(f"{purpose} needs a passing audit; mend with edit_spec:\n" + "\n".join(lines[:12]))
        return report

    def buildable(self, report: AuditReport) -> bool:
        """True if geometry can be built, judged and drawn: the audit asks for nothing but beats and claims, of which there are none yet."""
        story = self.spec.story
        later = {"audit:story": not (story.beats or story.requirements), "audit:claims": not self.spec.claims}
        return all(r.status in ("pass", "not_applicable") or later.get(r.id, False) for r in report.rows if r.mandatory)

    @seldom_collected()
    @one_core()
    def check_static(self, progress: Tell | None = None) -> tuple[list[Row], list[Row], list[str]]:
        """Build what is missing and run the static checks; returns (rows, changed rows, entities newly built).

        Shots are not asked while the prompt has no beats or claims yet: what they shall show is not known. `progress` is told before and within each check.
        """
        from ..construction import build_world
        from ..construction.crowding import check_crowding
        from ..verifiers.checks import names_of, run_checks, second_ahead
        from ..worlds.candidate import Candidate

        if progress is not None:
            progress(0.0, 1.0, "building shapes")
        with second_ahead(self.spec) as second:
            built, fresh = build_world(self.folder, self.spec)
            check_crowding(self.spec, built)
            asked = None if self.audit().passed else [n for n in names_of("static") if n != "shots"]
            candidate = Candidate(self.folder.root, self.spec, built, "static")
            rows = run_checks(candidate, only=asked, progress=progress, second=second)
        with self.ledger.together():  # a probe may end this very moment
            stages = self.ledger.stages()
            # A verdict over motion outranks the same row judged at frame 0 only, while it is not stale.
            judged = {r.id for r in self.ledger.rows() if stages.get(r.id) in ("probe", "full") and not r.evidence.get("stale")}
            static_only = [
                c for c in names_of("static") if c not in ("support", "navigability", "relations", "category", "shots")
            ]
            fresh_rows = [r for r in rows if r.id not in judged or r.check in static_only]
            changed = self.record(fresh_rows, stage="static", checks=static_only)
            failing = [r.id for r in rows if r.status == "fail" and r.mandatory]
            # A change that leaves the geometry failing has been tested: no probe would run on it.
            blocked = any(r.check != "shots" for r in rows if r.mandatory and r.status in ("fail", "unverified"))
            if blocked or any(is_static(self.ledger, i) for i in self.ledger.open_iterations()):
                self.ledger.close_iterations("static", failing, rows, revision=self.revision)
            rows, judged_now = self.cited(rows), {r.id for r in fresh_rows}
            self.record([r for r in rows if r.id in judged_now], stage="static")
        return rows, changed, fresh

    def cited(self, rows: Sequence[Row]) -> list[Row]:
        """Rows with what past edits of this world did to them; call it after the iterations that they test are closed."""
        from ..verifiers.diagnosis.cite import cite

        attempts = self.ledger.attempts()
        return [cite(r, attempts.get(r.id, ())) for r in rows]
