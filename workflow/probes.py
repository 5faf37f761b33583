"""Probes as jobs: simulated and judged at once, stopped where the motion is known to be wrong, recorded however they end."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..execution import Cancelled, JobContext, Part
from ..worlds.begun import open_begun
from ..worlds.cache import Cache
from ..worlds.candidate import Candidate
from ..worlds.errors import EngineError, EvidenceError
from ..worlds.gave_up import GaveUp, forget, note
from .estimates import Pace, probe_took, usual_seconds
from .gates import stored_rows
from .joint_repairs import said_by
from .live_judge import DECISIVE, LiveJudge, judge_begun
from .pictures import motion_sheet
from .rows import summary
from .running import Running
from .work import Work, first_true_frames, open_work, with_variants

if TYPE_CHECKING:
    from ..worlds.requirements import Row

__all__ = ["judge_probe", "not_carried_over", "probe", "probe_candidate", "taken_frames"]

WORTH_STOPPING_S = 10.0
"""A run that will end sooner goes on, so that all its rows are known at once [s]. Own choice."""
LAST_LOOK_S = 0.6
"""Own choice: time in which a cancelled run judges its frames yet [s]; a cancel is obeyed within 2 s whatever happens."""
NAMED = 3
"""Failing rows that progress names."""
SPACED = ("spacings", "cells")
"""Units of rows that say what a spacing resolves."""
LEAST_FRAMES = 3
"""Own choice: simulated frames from which on a run tells the pace of the world's next one."""
_KEPT = ("simulated_s", "judged_s")
"""Durations in the record of a probe that stay true where its frames were there before."""


class _StoppedError(Exception):
    """The run was ended since a row fails that more frames cannot mend."""


class _EnoughError(Exception):
    """The time for a last look at the frames of a cancelled run is over."""


class _Attended:
    """A run that is judged while it goes on: passes its progress on, records what fails, and stops it.

    Args:
        context: of the job.
        work: its world.
        judge: looks at the frames.
        stop: whether the first failure ends the run.
        judged: last frame of this motion of which an earlier run has its verdict; 0 where none has.
    """

    def __init__(self, context: JobContext, work: Work, judge: LiveJudge, *, stop: bool, judged: int) -> None:
        self._context, self._work, self._judge, self._stop = context, work, judge, stop
        self._running = Running(work, "probe", judged)
        self.failing: dict[str, Row] = {}
        self._began: tuple[float, float] | None = None
        self._watched = False
        self._left = 0.0

    def progress(self, report: Pace, done: float, total: int, message: str) -> None:
        """Pass on how far the run is, and what fails so far."""
        now = time.monotonic()
        if done > 0 and not self._watched:  # not before: frames of a probe with other settings may have stood there
            self._judge.watch(self._work.freeze)
            self._watched = True
        self._running.note()
        if self._began is None or (
            done <= self._began[0] and self._left <= 0.0
        ):  # the preroll says nothing of the pace of the frames
            self._began = (done, now)
        first, since = self._began
        pace = (now - since) / (done - first) if done > first else 0.0
        self._left = (total - done) * pace
        more = f" and {len(self.failing) - NAMED} more" if len(self.failing) > NAMED else ""
        told = f"; fails already: {', '.join(list(self.failing)[:NAMED])}{more}" if self.failing else ""
        report(done, total, f"{message}{told}")

    def check(self) -> None:
        """Take in what the judge has found, and end the run where it should end.

        Raises:
            Cancelled: the caller wants it to end.
            _StoppedError: a row fails, and the run would take long yet.
        """
        self._context.check()
        self._take()
        if self._stop and self.failing and self._left > WORTH_STOPPING_S:
            raise _StoppedError

    def _take(self) -> None:
        """Record the rows that the judge has found to fail."""
        self._record(self._judge.news())

    def _record(self, rows: Sequence[Row]) -> None:
        fresh = [row for row in rows if row.id not in self.failing]
        if fresh:
            self.failing |= {row.id: row for row in fresh}
            self._work.session.record(fresh, stage="probe")  # so that a kill leaves it on record

    def settle(self) -> None:
        """Close the test of the changes that this run was for with what its frames say, where it is ended from outside.

        What the checks that decide find within `LAST_LOOK_S` counts as rows do; beyond that the frames stay on record as a motion that
        ran unjudged.
        """
        if self._began is None:
            return
        self._running.note(now=True)
        self._take()
        if not self.failing:
            with suppress(EvidenceError, _EnoughError):  # no frame yet; no time left
                spec, built = self._work.session.spec, self._work.built
                begun = open_begun(self._work.session.folder, self._work.freeze, "probe", (spec, built))
                judge_begun(begun.candidate, begun.unmoved, self._heard(time.monotonic() + LAST_LOOK_S))
        if self.failing:
            rows = list(self.failing.values())
            session = self._work.session
            session.ledger.close_iterations(self._work.freeze[:16], list(self.failing), rows, revision=session.revision)

    def _heard(self, until: float) -> Callable[[Sequence[Row]], None]:
        """Takes the rows of one check after the other, up to a moment."""

        def say(rows: Sequence[Row]) -> None:
            self._record(rows)
            if time.monotonic() > until:
                raise _EnoughError

        return say


def probe(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Probe the present settings; a pass freezes them."""
    from ..simulation.probe import run_probe
    from ..simulation.schedule import stretch_count
    from ..verifiers.checks import judging_share
    from ..worlds.bake_plan import groups_of
    from ..worlds.coarsening import overrides_for
    from ..worlds.probe_length import probe_frames

    judge = LiveJudge(Path(payload["folder"]))
    context.progress(0.0, 1.0, "opening the world and its geometry")
    work = open_work(payload)
    session, freeze, built = work
    total = probe_frames(session.spec)
    split, stretches = 1.0 - judging_share(session.spec, "probe"), stretch_count(session.spec)
    coarser = float(payload.get("coarser") or 1.0)
    overrides = overrides_for(session.spec, coarser)
    known = session.ledger.freeze(freeze)
    same = known is not None and known["detail"].get("overrides", {}) == overrides
    judged = int(known["detail"].get("rows", {}).get("last", 0)) if known is not None and same else 0
    attended = _Attended(context, work, judge, stop=payload.get("stop_at") != "never", judged=judged)
    pace = Pace(Part(context.progress, 0.0, split, alike=stretches))
    started, stopped = time.monotonic(), False
    seconds: dict[str, float] = {}
    forget(session.folder.candidate(freeze) / "probe")
    try:
        candidate = run_probe(
            session.folder, freeze, built=built, overrides=overrides, check=attended.check,
            progress=lambda done, whole, text: attended.progress(pace, done, whole, text),
        )  # fmt: skip
        if pace.reports >= total * len(groups_of(session.spec)):
            seconds["simulated"] = time.monotonic() - started
    except _StoppedError:
        candidate, stopped = probe_candidate(work), True
    except EngineError as error:
        raise _failed(work, error, context) from error
    except Cancelled:
        attended.settle()
        raise
    finally:
        judge.close()
        _note_pace(work, pace, time.monotonic() - started, overrides)
    told = Part(context.progress, split, 1.0)
    settings = {"coarser": coarser, "overrides": overrides} if overrides else {}
    return judge_probe(
        work, candidate, told, seconds=seconds, settings=settings, stopped=list(attended.failing) if stopped else None
    )


def probe_candidate(work: Work) -> Candidate:
    """The probe of the present settings, or as much of it as there is.

    Raises:
        EvidenceError: it has no frame yet.
    """
    try:
        return work.candidate("probe")
    except EvidenceError:
        return open_begun(work.session.folder, work.freeze, "probe", (work.session.spec, work.built)).candidate


def judge_probe(
    work: Work,
    candidate: Candidate,
    progress: Part,
    *,
    seconds: dict[str, float],
    settings: Mapping[str, Any],
    stopped: Sequence[str] | None = None,
) -> dict[str, Any]:
    """Judge a probe and record it, by all checks, where a row has stopped it by those that decide; only a complete one freezes its settings.

    Args:
        work: its world.
        candidate: its frames, or those that there are.
        progress: told of the checks.
        seconds: what simulating took, if it was measured.
        settings: those that differ from production's.
        stopped: ids of the rows that ended the run early.
    """
    from ..verifiers.checks import names_of, run_checks
    from ..verifiers.stored import open_in_probe
    from ..worlds.begun import unfinished
    from ..worlds.probe_length import probe_frames

    session, freeze = work.session, work.freeze
    early = bool(unfinished(candidate)) or stopped is not None
    known = session.ledger.freeze(freeze)
    kept = {} if known is None else {k: v for k, v in known["detail"].items() if k in _KEPT and not early}
    judged = with_variants(candidate, session.folder, freeze)
    checks = names_of("probe") if stopped is None else DECISIVE
    rows = run_checks(judged, only=checks, progress=progress, seconds=seconds, reruns=not early)
    open_rows = [r.id for r in open_in_probe(rows, candidate.last_frame)]
    with session.ledger.together():  # a kill leaves the change untested, or all of its test
        session.ledger.close_iterations(freeze[:16], open_rows, rows, revision=session.revision)
        rows = session.cited(rows)
        changed = session.record(rows, stage="probe", checks=checks)
    passed, stops = not open_rows and not early, list(stopped or ())
    taken = taken_frames(session.folder.candidate(freeze) / "probe", probe_frames(session.spec))
    spent = {**kept, **{f"{name}_s": round(value, 2) for name, value in seconds.items()}}
    detail = {**_record(candidate, rows, open_rows), **spent, **settings, **taken, **({"stopped": stops} if early else {})}
    session.ledger.put_freeze(freeze, session.revision, passed=passed, detail=detail)
    picture = motion_sheet(candidate, session.folder, f"probe_{freeze[:8]}.jpg")
    ended = {"stopped_at": candidate.last_frame, "of_frames": probe_frames(session.spec), "stopped_by": stops}
    return {
        "passed": passed,
        "freeze": freeze[:16],
        "frames_probed": candidate.frame_count,
        **taken,
        **(ended if early else {}),
        "phases": _phases(candidate),
        **({"overrides": settings["overrides"], "not_carried_over": not_carried_over(rows)} if settings.get("overrides") else {}),
        "changed_rows": len(changed),
        **said_by(session.ledger, freeze[:16]),
        **summary(rows),
        "picture": picture,
    }


def not_carried_over(rows: Sequence[Row]) -> dict[str, Any]:
    """Rows of a coarser probe whose numbers are those of its spacing alone, and what that means for the bake."""
    ids = sorted(r.id for r in rows if r.unit in SPACED and r.status != "not_applicable" and "ran_at_m" not in r.evidence)
    told = "measured in the coarser spacing of this probe: no promise for production, where the bake judges them anew"
    return {"rows": ids, "because": told}


def _note_pace(work: Work, pace: Pace, seconds: float, overrides: Mapping[str, Any]) -> None:
    """Keep how long the simulation of a probe took, however it ended, over what is usual for as many of its frames."""
    from ..worlds.bake_plan import groups_of
    from ..worlds.coarsening import coarsened
    from ..worlds.probe_length import probe_frames

    spec = work.session.spec
    total = probe_frames(spec)
    usual = usual_seconds(coarsened(spec, overrides), total).simulation
    if pace.reports >= LEAST_FRAMES and usual > 0.0:
        probe_took(work.session.folder, seconds, usual * min(1.0, pace.reports / (total * len(groups_of(spec)))))


def taken_frames(run: Path, count: int) -> dict[str, list[str]]:
    """Text about the frames that a run of so many frames, in its folder, took over from earlier runs, where there are any."""
    from ..simulation.origins import taken_in

    groups: dict[tuple[str, int], list[str]] = {}
    for name, taken in sorted(taken_in(run).items()):
        groups.setdefault((taken.origin, taken.frames), []).append(name)
    told = [
        f"frames 0..{frames - 1} of {', '.join(names)} taken from {origin}{f', simulated from {frames}' if frames < count else ''}"
        for (origin, frames), names in groups.items()
    ]
    return {"taken": told} if told else {}


def _record(candidate: Candidate, rows: Sequence[Row], open_rows: list[str]) -> dict[str, Any]:
    """Part of a probe's record that its frames decide."""
    return {
        "frames": candidate.frame_count,
        "failing": open_rows,
        "digest": candidate.digest,
        "events": first_true_frames(candidate),
        "rows": stored_rows(rows, candidate.last_frame),
    }


def _phases(candidate: Candidate) -> dict[str, Any]:
    """Frames of the phases that are found."""
    from ..verifiers.story.phases import find_phases

    try:
        return {k: v for k, v in vars(find_phases(candidate)).items() if isinstance(v, (int, float, type(None)))}
    except EvidenceError as error:  # what moves without end has no phases; the rows say so
        return {"none": str(error)}


def _failed(work: Work, error: EngineError, context: JobContext) -> EngineError:
    """The error of an engine, after what it left was judged: with the frames that there are, and the rows that fail there.

    One of them is about the failure itself, so that an edit can name it.
    """
    from ..verifiers.categories.container import given_up
    from ..verifiers.categories.questions import FRAMES
    from ..verifiers.rows.instance_rows import instance_answer

    run, known = work.session.folder.candidate(work.freeze) / "probe", error.where
    candidate: Candidate | None
    try:
        candidate = probe_candidate(work)
        reached = candidate.last_frame
    except EvidenceError:
        candidate, reached = None, -1
    solver = known.get("solver") or _behind(work, run)
    ended = GaveUp(solver, int(known.get("frame", reached + 1)), str(error), tuple(known.get("entities", ())), known.get("place"))
    note(run, ended)
    if candidate is None:
        still = Candidate(work.session.folder.root, work.session.spec, work.built, "static")
        row = instance_answer(still, FRAMES, solver, given_up(still, ended))
        with work.session.ledger.together():
            work.session.ledger.close_iterations(work.freeze[:16], [row.id], [row], revision=work.session.revision)
            work.session.record(work.session.cited([row]), stage="probe")
        return EngineError(f"{error}. It wrote no frame; row {row.id} fails, which an edit's repairs can name")
    found = judge_probe(work, candidate, Part(context.progress, 0.9, 1.0), seconds={}, settings={}, stopped=[])
    failing = [r["id"] for r in found["open_rows"] if r.get("status") == "fail"]
    rows = f"; failing there: {', '.join(failing[:NAMED])}" if failing else ""
    return EngineError(
        f"{error}. Frames 0..{candidate.last_frame} are whole and judged{rows}: look at them with render_shot and inspect_world(part='state')"
    )


def _behind(work: Work, run: Path) -> str:
    """The instance that has written the fewest frames: where an error names none, it is its engine's."""
    plan = work.session.spec.simulation

    def count(name: str) -> int:
        try:
            return len(Cache(run / name).digests())
        except EvidenceError:
            return 0

    return min(plan.solvers, key=count)
