"""One world as tools work on it: open, commit a revision, run static checks, answer with rows."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..worlds.audits.audit import AuditReport, audit
from ..worlds.canonical import spec_digest
from ..worlds.errors import EngineError, EvidenceError, InputError, RefusedError
from ..worlds.folder import WorldFolder, temporary_name, write_atomically
from ..worlds.groups import group_of
from ..worlds.ledger import Ledger
from ..worlds.limits import check_cap
from ..worlds.patch import differences, parse_spec, weakenings
from ..worlds.provenance import stale_artifacts, stale_rows
from ..worlds.requirements import Row
from ..worlds.spec import WorldSpec
from .earlier import has_motion
from .known_specs import KnownSpecs
from .repair_rules import CAUSAL_CLASSES, UNDONE, causal_groups, cut_grounds, failed, judged_on, same_causes

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate

__all__ = ["Session", "no_revision"]

MAX_CHANGES = 8
MAX_LENGTH = 4
"""An iteration keeps this many changed places, with lists up to this length: enough for a pose or a velocity."""
_known = KnownSpecs()


@dataclass
class Session:
    """An opened world."""

    folder: WorldFolder
    ledger: Ledger
    spec: WorldSpec
    revision: int

    @classmethod
    def open(cls, workspace: Path, world: str) -> Session:
        """Open a world.

        Raises:
            InputError: there is no such world.
            RefusedError: `world.json` was edited by hand since the last revision.
        """
        return cls.at(WorldFolder.of(workspace, world))

    @classmethod
    def at(cls, folder: WorldFolder) -> Session:
        """Open the world of a folder; errors as `open`."""
        ledger = Ledger(folder.ledger_path)
        spec, revision, damage = _latest(folder, ledger)
        if spec is None:
            # Another client may stand between its world.json and its ledger entry; whoever holds the ledger meets none there.
            with suppress(EngineError), ledger.together():  # where nothing can be written, nobody stands there either
                spec, revision, damage = _latest(folder, ledger)
        if spec is not None:
            return cls(folder, ledger, spec, revision)
        raise RefusedError(
            f"world.json of {folder.id!r} was edited outside the server since revision {revision}, or its writing was cut short. "
            f"Call edit_spec with on_hand_edit='adopt' to take it as a new revision, or 'restore' to undo it.{damage}"
        )

    def write_spec(self) -> None:
        """Write `world.json`."""
        text = self.spec.model_dump_json(indent=1, exclude_none=True).encode()
        write_atomically(self.folder.spec_path, text)
        _known.put(text, self.spec.model_dump_json(exclude_none=True), self.spec)

    @contextmanager
    def step(self) -> Iterator[None]:
        """One step of ledger and `world.json`: no other client stands between the two, and a failure undoes both."""
        path = self.folder.spec_path
        kept = temporary_name(path.with_name(f"{path.name}.kept"))
        new = False

        def undo() -> None:
            if kept.exists():
                kept.replace(path)
            elif new:
                path.unlink(missing_ok=True)

        try:
            with self.ledger.together(undo):
                new = not path.exists()
                with suppress(OSError):  # a second name takes no room: a full disk is left as it was
                    os.link(path, kept)
                yield
        finally:
            kept.unlink(missing_ok=True)

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

    def stamp(self) -> str:
        """Identifies this revision of this very world: when it was made."""
        return repr(self.ledger.revisions(1)[0]["created"])

    # ---------------------------------------------------------------- edits

    def commit(
        self,
        after: WorldSpec,
        *,
        patch: Sequence[Mapping[str, Any]],
        hypothesis: str = "",
        weakening_reason: str = "",
        derived: bool = False,
    ) -> dict[str, Any]:
        """Make `after` the next revision, if the rules of repair allow it; returns what changed and what is stale.

        `derived` says that the change only follows from an edit that was made already, and is no edit of its own.

        Raises:
            RefusedError: the edit breaks R111-R113 or R157, or another revision came first.
        """
        check_cap("text_characters", max(len(hypothesis), len(weakening_reason)), what="hypothesis or weakening_reason")
        before = self.spec
        documents = before.model_dump(mode="json"), after.model_dump(mode="json")
        places = list(differences(*documents))
        groups = {group_of(p) for p in places}
        causal = [] if derived else causal_groups(places, cut_grounds(before, after))
        stale = stale_artifacts(before, after)
        with self.step():
            undone = self._undone(after) if causal else []
            failing = [r for r in self.ledger.rows() if failed(r) and r.mandatory and r.check != "audit"]
            weaker = weakenings(before, after, judged_on(failing))
            self._rules(failing, groups, [] if undone else causal, weaker, hypothesis, weakening_reason)
            number = self.ledger.add_revision(
                after.model_dump_json(exclude_none=True),
                spec_digest(after),
                expected=self.revision,
                patch=[dict(o) for o in patch],
                hypothesis=hypothesis,
                groups=[g.name for g in groups],
                weakenings=weaker,
                reason=weakening_reason,
            )
            if number is None:
                raise RefusedError(
                    f"another client changed {self.folder.id!r} meanwhile (revision {self.ledger.revision()}, you had {self.revision}); "
                    "read it again with inspect_world and repeat the edit"
                )
            lost = stale_rows(self.ledger.rows(), self.ledger.stages(), stale)
            self.ledger.mark_stale({k: f"{v} changed in revision {number}" for k, v in lost.items()}, number)
            if undone:
                still = {r.id for r in failing}.union(*(json.loads(str(i["failing_before"])) for i in undone))
                self.ledger.close_iterations(UNDONE, sorted(still), revision=number)
            elif failing and causal:
                changed = [p for p in places if group_of(p).edit_class in CAUSAL_CLASSES]
                values = [(p, _value(documents[0], p), _value(documents[1], p)) for p in changed[:MAX_CHANGES]]
                self.ledger.add_iteration(number, hypothesis, causal[0], failing, values)
            self.spec, self.revision = after, number
            self.write_spec()
        return {
            "revision": number,
            "changed": places[:20] + ([f"and {len(places) - 20} more"] if len(places) > 20 else []),
            "groups": sorted(g.name for g in groups),
            "stale": _shorten(stale),
            "rows_now_stale": len(lost),
            **({"undoes_revisions": [i["revision"] for i in undone]} if undone else {}),
            **({"weakenings_recorded": weaker} if weaker and (self.ledger.ever_failed() or self.ledger.looks()) else {}),
        }

    def _undone(self, after: WorldSpec) -> list[dict[str, Any]]:
        """The untested changes that `after` takes back, all of them; none unless its causes are those last tested."""
        untested = self.ledger.open_iterations()
        recorded = self.ledger.revision_spec(int(untested[0]["revision"]) - 1) if untested else None
        if recorded is None:
            return []
        return untested if same_causes(WorldSpec.model_validate_json(recorded[0]), after) else []

    def shown(self, candidate: Candidate, last: int) -> str:
        """Record that frames up to `last` of a motion are shown; one without a verdict counts as evidence all the same.

        Returns what to tell of it: nothing, where the motion was judged. Who watches the frames of a probe or a bake and cancels it before its rows are written knows what they would say.
        """
        if candidate.stage == "static":
            return ""
        root = (self.folder.root / candidate.artifact).parent
        freeze = str(self.folder.read_json(root / "candidate.json")["freeze"])
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

    def _unjudged(self, *, untested: bool = False) -> str:
        """What to tell of motions that were looked at and never judged; empty where there are none."""
        looks = self.ledger.looks(untested=untested)
        if not looks:
            return ""
        latest = looks[-1]
        run = {"full": "bake"}.get(latest["stage"], latest["stage"])
        return (
            f"frames 0..{latest['last']} of the {run} {latest['freeze'][:16]} (revision {latest['revision']}) were looked at, and it was "
            "never judged, so that they count as evidence"
        )

    def _rules(
        self, failing: list[Row], groups: set[Any], causal: list[str], weaker: list[str], hypothesis: str, reason: str
    ) -> None:
        told: list[str] = []
        unjudged = self._unjudged()
        if weaker and (unjudged or self.ledger.ever_failed()) and len(reason.strip()) < 15:
            told.append(
                (f"{unjudged}: " if unjudged else "")
                + "this edit makes the specification easier to satisfy after evidence against it: "
                + "; ".join(weaker[:6])
                + ". Repair the scene or the solver instead; to ask for more, add a beat or requirement beside what is there; or give weakening_reason (>= 15 characters); it is printed with the acceptance."
            )
        if causal:
            told += self._causal_rules(failing, groups, causal, hypothesis)
        if told:
            raise RefusedError("\n".join(told))

    def _causal_rules(self, failing: list[Row], groups: set[Any], causal: list[str], hypothesis: str) -> list[str]:
        """What stands against an edit of the scene or the solver (R111-R113), all of it."""
        told: list[str] = []
        # Rows that failed turn stale with the edit that answers them: the open iteration outlives them.
        untested = self.ledger.open_iterations()
        if untested:
            rows = ", ".join(json.loads(str(untested[-1]["failing_before"]))[:3])
            again = " (or a whole run_checks(scope='probe'): there is motion of these settings)" if has_motion(self) else ""
            test = "place_object" if self._static_only(untested[-1]) else f"probe_sim{again}"
            told.append(
                f"the change of revision {untested[-1]['revision']} ({untested[-1]['grp']}) is not tested yet: it answered {rows}. "
                f"Call {test} before the next change; or take it back: setting everything causal to what it was in revision "
                f"{untested[0]['revision'] - 1} is allowed at once"
            )
        unjudged = "" if failing else self._unjudged(untested=True)
        if not failing and not unjudged:
            return told
        if unjudged:
            unjudged += " (while the settings are still these, run_checks(scope='probe') judges them)"
        if len(hypothesis.strip()) < 10:
            why = unjudged or f"{len(failing)} rows fail ({', '.join(r.id for r in failing[:5])})"
            told.append(
                f"{why}; an edit must now name its hypothesis: "
                "what you believe causes the failure and why this change cures it (>= 10 characters)"
            )
        if len(causal) > 1:
            told.append(
                f"this edit changes {len(causal)} causal parameter groups at once ({', '.join(causal)}); after a failure change one, "
                "test it with place_object / run_checks / probe_sim, then the next"
            )
        if not failing:
            return told
        wanted = {e for r in failing for e in r.evidence.get("edit_classes") or {c.edit_class for c in r.corrections}}
        edit = next(g.edit_class for g in groups if g.edit_class in CAUSAL_CLASSES)
        if wanted & set(CAUSAL_CLASSES) and edit not in wanted:
            names = sorted({c.group for r in failing for c in r.corrections if c.edit_class in CAUSAL_CLASSES})
            told.append(
                f"the failing rows ask for a {'/'.join(sorted(wanted & set(CAUSAL_CLASSES)))} edit (groups {', '.join(names)}), "
                f"not a {edit} edit of {causal[0]!r}"
            )
        return told

    # ---------------------------------------------------------------- checks

    def audit(self) -> AuditReport:
        """Audit the present revision and record its rows."""
        report = audit(self.spec)
        self.record(report.rows, stage="audit", checks=("audit",))
        if not report.passed:  # no other test can run on this change: the audit has been its test
            failing = [r.id for r in report.rows if r.status == "fail" and r.mandatory]
            self.ledger.close_iterations("audit", failing, report.rows, revision=self.revision)
        return report

    def require_audit(self, purpose: str) -> AuditReport:
        """The audit, if it passes.

        Raises:
            RefusedError: it does not.
        """
        report = self.audit()
        if not report.passed:
            bad = [r for r in report.rows if r.mandatory and r.status != "pass"]
            lines = [f"  {r.id}: {p}" for r in bad for p in r.evidence.get("problems", [])[:4]]
            raise RefusedError(f"{purpose} needs a passing audit; mend with edit_spec:\n" + "\n".join(lines[:12]))
        return report

    def check_static(self) -> tuple[list[Row], list[Row], list[str]]:
        """Build what is missing and run the static checks; returns (rows, changed rows, entities newly built)."""
        from ..construction import build_world
        from ..construction.crowding import check_crowding
        from ..verifiers.checks import names_of, run_checks
        from ..worlds.candidate import Candidate

        built, fresh = build_world(self.folder, self.spec)
        check_crowding(self.spec, built)
        rows = run_checks(Candidate(self.folder.root, self.spec, built, "static"))
        with self.ledger.together():  # a probe may end this very moment
            stages = self.ledger.stages()
            # A verdict over motion outranks the same row judged at frame 0 only, while it is not stale.
            judged = {r.id for r in self.ledger.rows() if stages.get(r.id) in ("probe", "full") and not r.evidence.get("stale")}
            static_only = [c for c in names_of("static") if c not in ("support", "navigability", "relations", "shots")]
            fresh_rows = [r for r in rows if r.id not in judged or r.check in static_only]
            changed = self.record(fresh_rows, stage="static", checks=static_only)
            failing = [r.id for r in rows if r.status == "fail" and r.mandatory]
            # A change that leaves the geometry failing has been tested: no probe would run on it.
            blocked = any(r.check != "shots" for r in rows if r.mandatory and r.status in ("fail", "unverified"))
            if blocked or any(self._static_only(i) for i in self.ledger.open_iterations()):
                self.ledger.close_iterations("static", failing, rows, revision=self.revision)
            rows, judged_now = self.cited(rows), {r.id for r in fresh_rows}
            self.record([r for r in rows if r.id in judged_now], stage="static")
        return rows, changed, fresh

    def cited(self, rows: Sequence[Row]) -> list[Row]:
        """Rows with what past edits of this world did to them; call it after the iterations that they test are closed."""
        from ..verifiers.diagnosis.cite import cite

        attempts = self.ledger.attempts()
        return [cite(r, attempts.get(r.id, ())) for r in rows]

    def _static_only(self, iteration: Mapping[str, Any]) -> bool:
        stages = self.ledger.stages()
        return all(stages.get(r, "static") in ("static", "audit", "stale") for r in json.loads(str(iteration["failing_before"])))


def no_revision(folder: WorldFolder) -> str:
    """What to tell of a world whose ledger holds nothing."""
    return (
        f"the ledger of world {folder.id!r} holds no revision (ledger.sqlite is empty, cut off, or new): put back a copy of it, or "
        f"create another world with edit_spec from what the resource worldagent://worlds/{folder.id}/spec holds"
    )


def _value(document: Any, pointer: str) -> Any:
    """What a document holds at a pointer, where it is a number, a word or a short list of them; else None."""
    at = document
    for token in pointer.split("/")[1:]:
        if not isinstance(at, dict) or token not in at:
            return None
        at = at[token]
    flat = at if isinstance(at, list) and len(at) <= MAX_LENGTH else [at]
    return at if all(v is None or isinstance(v, bool | int | float | str) for v in flat) else None


def _latest(folder: WorldFolder, ledger: Ledger) -> tuple[WorldSpec | None, int, str]:
    """The specification of the latest revision if `world.json` holds it; that revision; what is wrong with the file."""
    revision = ledger.revision()
    recorded = ledger.revision_spec(revision)
    if recorded is None:
        raise EvidenceError(no_revision(folder))
    spec, damage = _current(folder, recorded[0])
    return spec, revision, damage


def _current(folder: WorldFolder, recorded: str) -> tuple[WorldSpec | None, str]:
    """The specification of `world.json` if it is the recorded one; else None, and what is wrong with the file."""
    try:
        text = folder.spec_path.read_bytes()
    except OSError:
        text = b""
    spec = _known.get(text, recorded)
    if spec is not None:
        return spec, ""
    try:
        spec = parse_spec(folder.read_json(folder.spec_path))
    except (EvidenceError, InputError) as error:
        return None, f" It cannot be read: {error}"
    if not _same(spec, recorded):
        return None, ""
    _known.put(text, recorded, spec)
    return spec, ""


def _same(spec: WorldSpec, recorded: str) -> bool:
    """Whether a specification is the recorded one, which an earlier version may have written without newer fields."""
    return spec.model_dump_json(exclude_none=True) == recorded or spec == WorldSpec.model_validate_json(recorded)


def _shorten(names: list[str]) -> list[str]:
    """`static:a`, `static:b`, ... of many entities as one line."""
    kinds: dict[str, list[str]] = {}
    for name in names:
        kinds.setdefault(name.split(":", 1)[0], []).append(name)
    return [
        n
        for group in kinds.values()
        for n in (group if len(group) <= 6 else [*group[:3], f"and {len(group) - 3} more {group[0].split(':')[0]}"])
    ]
