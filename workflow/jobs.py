"""Entries of the worker processes: each is one job, from reading the world to writing its ledger."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from ..execution import JobContext, Part
from ..worlds.canonical import spec_digest
from ..worlds.errors import EvidenceError, LimitError, RefusedError
from ..worlds.folder import WorldFolder
from ..worlds.verdicts import prompt_told, unusual_told, verdict_words
from .estimates import Pace
from .gates import require_acceptance, require_probe, require_true_geometry, stored_rows
from .landscapes import terrain
from .pictures import film_sheet, motion_sheet
from .rows import summary
from .session import Session

if TYPE_CHECKING:
    from ..worlds.built import BuiltEntity
    from ..worlds.candidate import Candidate

__all__ = ["accept", "bake", "check", "final", "probe", "review", "terrain"]

WARM = (
    "cv2",
    "fcl",
    "mujoco",
    "scipy.interpolate",
    "scipy.ndimage",
    "scipy.optimize",
    "scipy.sparse.csgraph",
    "scipy.spatial.transform",
    "scipy.stats",
    "warp",
    "worldagent.construction",
    "worldagent.geometry.batch",
    "worldagent.rendering",
    "worldagent.simulation.bake",
    "worldagent.simulation.probe",
    "worldagent.simulation.rigid.solver",
    "worldagent.tools",
    "worldagent.workflow.measurements",
    "worldagent.verifiers.acceptance",
    "worldagent.verifiers.checks",
    "worldagent.verifiers.story.phases",
    "worldagent.worlds.candidate",
)
"""Modules that a process that waits for these jobs has imported. Nothing that starts a thread or takes a device while it loads:
no Mitsuba (Dr.Jit starts a thread)."""
ASKED = 0.1
"""Own choice: share of a film's work before its first frame, in which plates are looked at."""
LOOKING = 0.2
"""Part of a judgement that its plates take, for progress alone."""
JUDGED = 1.0 - 1e-9
"""Part of an acceptance that is the judgement; the report takes a moment."""


class _Work(NamedTuple):
    """The world of a job; its geometry is read or built once, here."""

    session: Session
    freeze: str
    """Of its present specification, written to its candidate folder."""
    built: dict[str, BuiltEntity]

    def candidate(self, stage: Literal["probe", "full"]) -> Candidate:
        """The caches of the freeze; errors as `open_candidate`."""
        from ..worlds.candidate import open_candidate

        return open_candidate(self.session.folder, self.freeze, stage, self.built)


def _work(payload: dict[str, Any]) -> _Work:
    """Open the world of a job."""
    from ..construction import build_world, built_paths
    from ..simulation.freeze import open_freeze

    session = Session.at(WorldFolder.at(Path(payload["folder"])))
    built, _ = build_world(session.folder, session.spec)
    files = built_paths(session.folder, session.spec)
    return _Work(session, open_freeze(session.folder, session.spec, built, files, session.revision), built)


def probe(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Probe the present settings; a pass freezes them."""
    from ..simulation.probe import probe_frames, run_probe
    from ..simulation.schedule import stretch_count
    from ..verifiers.checks import judging_share, names_of, run_checks
    from ..verifiers.stored import open_in_probe
    from ..verifiers.story.phases import find_phases
    from ..worlds.bake_plan import groups_of
    from ..worlds.coarsening import overrides_for

    session, freeze, built = _work(payload)
    total, known = probe_frames(session.spec), session.ledger.freeze(freeze)
    split, stretches = 1.0 - judging_share(session.spec, "probe"), stretch_count(session.spec)
    pace = Pace(Part(context.progress, 0.0, split, alike=stretches))
    coarser = float(payload.get("coarser") or 1.0)
    overrides = overrides_for(session.spec, coarser)
    started, seconds = time.monotonic(), {}
    candidate = run_probe(session.folder, freeze, built=built, overrides=overrides, progress=pace, check=context.check)
    if pace.reports >= total * len(groups_of(session.spec)):
        seconds["simulated"] = time.monotonic() - started
    candidate = _keeping(candidate, session.folder, freeze)
    rows = run_checks(candidate, progress=Part(context.progress, split, 1.0), seconds=seconds)
    open_rows = [r.id for r in open_in_probe(rows, candidate.last_frame)]
    with session.ledger.together():  # a kill leaves the change untested, or all of its test
        session.ledger.close_iterations(freeze[:16], open_rows, rows, revision=session.revision)
        rows = session.cited(rows)
        changed = session.record(rows, stage="probe", checks=names_of("probe"))
    try:
        phases: dict[str, Any] = {
            k: v for k, v in vars(find_phases(candidate)).items() if isinstance(v, (int, float, type(None)))
        }
    except EvidenceError as error:  # what moves without end has no phases; the rows say so
        phases = {"none": str(error)}
    session.ledger.put_freeze(
        freeze,
        session.revision,
        passed=not open_rows,
        detail={
            "frames": total,
            "failing": open_rows,
            "digest": candidate.digest,
            "events": _events(candidate),
            "rows": stored_rows(rows, candidate.last_frame),
            **_spent(seconds, known),
            **({"coarser": coarser, "overrides": overrides} if overrides else {}),
        },
    )
    picture = motion_sheet(candidate, session.folder, f"probe_{freeze[:8]}.jpg")
    return {
        "passed": not open_rows,
        "freeze": freeze[:16],
        "frames_probed": total,
        "phases": phases,
        **({"overrides": overrides} if overrides else {}),
        "changed_rows": len(changed),
        **summary(rows),
        "picture": picture,
    }


def _keeping(candidate: Candidate, folder: WorldFolder, freeze: str) -> Candidate:
    """The candidate, with a place for the runs without its causes. Acceptance has none: it simulates for itself."""
    return dataclasses.replace(candidate, variants=folder.candidate(freeze) / "variants")


def _spent(seconds: Mapping[str, float], known: dict[str, Any] | None) -> dict[str, float]:
    """Seconds that the frames and their judgement took; of frames that were there before, as they were measured then."""
    before = {} if known is None else {k: v for k, v in known["detail"].items() if k in ("simulated_s", "judged_s")}
    return before | {f"{name}_s": round(value, 2) for name, value in seconds.items()}


def _events(candidate: Any) -> dict[str, int | None]:
    """First true frame of every beat: what the probe promises about the bake."""
    from ..verifiers.predicates.evaluators import evaluate

    return {n: evaluate(candidate, b.predicate, b.frames).first_true_frame for n, b in candidate.spec.story.beats.items()}


def _same_probe(work: _Work, detail: Mapping[str, Any]) -> Candidate | None:
    """The probe of the freeze, if it ran at production settings and its digest is the one on record; else None."""
    if detail.get("overrides"):
        return None
    try:
        found = work.candidate("probe")
    except EvidenceError:
        return None
    return found if found.digest == detail.get("digest") else None


def bake(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Bake the frozen candidate and check the full sequence."""
    import shutil

    from ..simulation.bake import run_bake
    from ..simulation.schedule import stretch_count
    from ..verifiers.checks import judging_share, names_of, plate_ids, rerun_ids, run_checks
    from ..verifiers.stored import open_in_probe
    from ..worlds.baked import frame_digests
    from .measurements import refuted
    from .promises import promise_row

    work = _work(payload)
    session, freeze, built = work
    record = require_probe(session, freeze)
    total = session.spec.simulation.frames
    forged = refuted(session, freeze)
    if forged:  # a forged frame and its forged digest agree: nothing of that bake is trusted
        shutil.rmtree(session.folder.candidate(freeze) / "bake", ignore_errors=True)
    split = 1.0 - judging_share(session.spec, "full")
    part = Part(context.progress, 0.0, split, alike=stretch_count(session.spec))
    probe, began = None if forged else _same_probe(work, record["detail"]), time.monotonic()
    candidate = run_bake(session.folder, freeze, built=built, progress=part, check=context.check, reuse=not forged, probe=probe)
    seconds = round(time.monotonic() - began, 2)
    rows = run_checks(candidate, plates=False, progress=Part(context.progress, split, 1.0))
    promised, found = record["detail"]["events"], _events(candidate)
    rows.append(promise_row(candidate, promised, found, record["detail"].get("overrides", {})))
    rows = session.cited(rows)
    changed = session.record(rows, stage="full", checks=names_of("full"), keep=rerun_ids(session.spec) | plate_ids(session.spec))
    open_rows = [r.id for r in open_in_probe(rows, candidate.last_frame)]
    content = {"frames": total, "failing": open_rows, "frame_digests": frame_digests(candidate.caches), "seconds": seconds}
    session.ledger.put_bake(freeze, session.revision, candidate.digest, content)
    picture = motion_sheet(candidate, session.folder, f"bake_{freeze[:8]}.jpg")
    return {
        "complete": True,
        "passed": not open_rows,
        "freeze": freeze[:16],
        "frames": total,
        "cache_digest": candidate.digest[:16],
        "changed_rows": len(changed),
        **summary(rows),
        "picture": picture,
    }


def check(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Run the checks of one scope again on what is there."""
    from ..verifiers.checks import names_of, plate_ids, rerun_ids, run_checks
    from ..verifiers.delivery.binding import cache_row
    from ..verifiers.stored import open_in_probe
    from ..worlds.baked import bake_record

    work = _work(payload)
    session, freeze = work.session, work.freeze
    stage = payload["scope"]
    candidate = work.candidate(stage)
    if stage == "probe":
        candidate = _keeping(candidate, session.folder, freeze)
    done = names_of(stage) if payload.get("only") is None else payload["only"]
    wanted = any(i.partition(":")[0] in done for i in plate_ids(session.spec))
    looking = LOOKING if stage == "full" and wanted else 0.0
    if looking:
        plates_of(work, context)
    rows = run_checks(candidate, only=payload.get("only"), plates=bool(looking), progress=Part(context.progress, looking, 1.0))
    if stage == "full" and "delivery" in done:
        rows.append(cache_row(candidate, bake_record(session.folder.ledger_path, freeze)))
    whole = stage == "probe" and payload.get("only") is None
    open_rows = [r.id for r in open_in_probe(rows, candidate.last_frame)]
    with session.ledger.together():  # as in a probe
        if whole:
            session.ledger.close_iterations(freeze[:16], open_rows, rows, revision=session.revision)
        rows = session.cited(rows)
        changed = session.record(rows, stage=stage, checks=done, keep=() if stage == "probe" else rerun_ids(session.spec))
    if whole:
        # The same motion, judged completely again (after an edit of the story or the shots): as good as a new probe.
        known = session.ledger.freeze(freeze)
        kept = ("simulated_s", "judged_s", "coarser", "overrides")
        spent = {} if known is None else {k: v for k, v in known["detail"].items() if k in kept}
        detail = {"frames": candidate.frame_count, "failing": open_rows, "digest": candidate.digest, "events": _events(candidate)}
        detail |= {"rows": stored_rows(rows, candidate.last_frame), **spent}
        session.ledger.put_freeze(freeze, session.revision, passed=not open_rows, detail=detail)
    return {"scope": stage, "changed_rows": len(changed), **summary(rows)}


def review(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Have the bake read by the model that the server's owner named; without one, write what a reader needs."""
    from .review.conduct import read_world

    work = _work(payload)
    if payload.get("ask", True):
        plates_of(work, context)
    context.progress(LOOKING, 1, "account, pictures, and the reader's answers")
    return read_world(work.session, work.candidate("full"), context.check, ask=payload.get("ask", True))


def plates_of(work: _Work, context: JobContext, *, distrust: bool = False) -> None:
    """Render the plates of a bake that are missing or stale; `distrust` as in `make_plates`."""
    from .plates import allowed_seconds, make_plates

    candidate, seconds = work.candidate("full"), allowed_seconds(work.session.ledger.bake(work.freeze))
    told = Part(context.progress, 0.0, LOOKING)
    make_plates(candidate, seconds=seconds, progress=told, check=context.check, distrust=distrust)


def accept(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Have a fresh process judge the present candidate; record its verdict."""
    import secrets

    from ..verifiers.acceptance import judge_fresh
    from .bundles import remember_refuted
    from .review.verdict import reviewed
    from .siblings import easier_beside

    work = _work(payload)
    session, freeze, built = work
    if session.ledger.bake(freeze) is None:
        raise RefusedError("acceptance needs a complete bake of these exact settings; call bake_sim first")
    require_true_geometry(session, built)
    plates_of(work, context, distrust=True)
    context.progress(LOOKING, 1, "a fresh process judges the candidate")
    record = judge_fresh(session.folder.root, seed=secrets.randbelow(2**31), progress=Part(context.progress, LOOKING, JUDGED))
    if record["spec_digest"] != spec_digest(session.spec):
        raise RefusedError("the world was edited before it was judged; call run_checks(scope='acceptance') again")
    rows = reviewed(session, built, freeze, record)
    weakenings = [w for w in session.ledger.weakenings() if w["revision"] <= session.revision]
    beside = easier_beside(session.folder.root.parent, session.folder.id, session.spec)
    record |= {"weakenings": weakenings, "easier_beside": beside, "stage": "full"}
    with session.ledger.together():
        remember_refuted(session.ledger, record)
        session.record(rows, stage="full")
    # The ledger keeps verdicts; contact events are in the caches.
    kept = {k: v for k, v in record.items() if k != "events"}
    session.ledger.add_acceptance(freeze, session.revision, record["subject"], record["verdict"], kept)
    context.progress(JUDGED, 1, "writing the report")
    proof = _proof(session, record)
    context.progress(1, 1, record["verdict"])
    return {
        "verdict": record["verdict"],
        "says": verdict_words(record),
        **unusual_told(record),
        "freeze": freeze[:16],
        **summary(rows),
        "replayed": next((r.evidence["intervals"] for r in rows if r.id == "delivery:replay"), []),
        **prompt_told(record),
        "read_by": record["read_by"],
        **({"earlier_contradictions": n} if (n := record["earlier_contradictions"]) else {}),
        "weakenings": record["weakenings"],
        **({"easier_beside": beside} if beside else {}),
        "approximations": record["approximations"][:20],
        **proof,
    }


def _proof(session: Session, record: dict[str, Any]) -> dict[str, Any]:
    """Writes the matrix report of a verdict, and the bundle of an accepted one; where they are, in the world folder."""
    from .bundles import make_bundle
    from .matrix_report import write_report

    folder = session.folder
    page = folder.acceptance / f"{record['freeze'][:16]}.html"
    write_report(page, folder, record, spec=session.spec)
    found = {"report": folder.relative(page)}
    if record["verdict"] != "accepted":
        return found
    try:
        written = make_bundle(folder, session.ledger, record)
    except LimitError as error:  # the verdict stands without it
        return {**found, "bundle_note": str(error)}
    return {**found, "bundle": folder.relative(written.path), "bundle_digest": written.digest}


def final(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Render the final sequence of an accepted candidate to frames and a video."""
    from ..rendering import render_sequence, write_video
    from .plates import require_seen

    work = _work(payload)
    session, freeze = work.session, work.freeze
    accepted = require_acceptance(session, freeze)
    candidate = work.candidate("full")
    for cache in candidate.caches.values():
        digests = cache.digests()
        altered = next((k for k in range(cache.index.frames) if cache.frame_digest(k) != digests[k]), None)
        if altered is not None:
            raise EvidenceError(
                f"frame {altered} was altered since acceptance; call bake_sim, then run_checks(scope='acceptance')"
            )
    # A stretch of its own: its pace says nothing of how long a frame takes.
    context.progress(0, 1, "are the subjects seen in this light?", ASKED)
    require_seen(session, freeze, candidate, context.check)
    root = session.folder.candidate(freeze) / "final"
    width, height, samples = (payload.get(k) for k in ("width", "height", "samples"))
    pace = Pace(Part(context.progress, ASKED, 1.0))
    frames = render_sequence(
        candidate,
        root / "frames",
        width=width,
        height=height,
        samples=samples,
        progress=pace,
        cancelled=context.cancelled,
    )
    context.check()
    video = write_video(frames, root / "final.webm", session.spec.simulation.fps)
    return {
        "says": verdict_words(accepted["record"]),
        "picture": film_sheet(session.folder, frames, f"final_{freeze[:8]}.jpg", session.spec.simulation.fps),
        "video": session.folder.relative(video.path),
        "codec": video.codec,
        "frames": video.frames,
        "width": video.width,
        "height": video.height,
        "note": video.note,
        "samples": samples or session.spec.look.samples,
        "seconds_per_frame": pace.seconds_per_step and round(pace.seconds_per_step, 4),
        "bytes": video.path.stat().st_size,
        "duration_s": round(video.frames / session.spec.simulation.fps, 3),
        "folder": session.folder.relative(root),
    }
