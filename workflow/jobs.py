"""Entries of the worker processes: each is one job, from reading the world to writing its ledger."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from ..execution import JobContext, Part
from ..worlds.canonical import spec_digest
from ..worlds.errors import EvidenceError, LimitError, RefusedError
from ..worlds.verdicts import prompt_told, unusual_told, verdict_words
from .estimates import Pace, spared_seconds
from .gates import require_acceptance, require_probe, require_true_geometry
from .interiors import interior
from .landscapes import terrain
from .pictures import film_sheet, motion_sheet
from .placing import placing
from .probes import judge_probe, probe, probe_candidate, taken_frames
from .rows import summary
from .running import Running
from .session import Session
from .sketches import sketch
from .taken_pictures import picture
from .work import Work, first_true_frames, open_work, with_variants

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate
    from ..worlds.requirements import Row

__all__ = ["accept", "bake", "check", "final", "interior", "picture", "placing", "probe", "review", "sketch", "terrain"]

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


def _same_probe(work: Work, detail: Mapping[str, Any]) -> Candidate | None:
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

    context.progress(0.0, 1.0, "opening the world and its geometry")
    work = open_work(payload)
    session, freeze, built = work
    record = require_probe(session, freeze)
    total = session.spec.simulation.frames
    forged = refuted(session, freeze)
    if forged:  # a forged frame and its forged digest agree: nothing of that bake is trusted
        shutil.rmtree(session.folder.candidate(freeze) / "bake", ignore_errors=True)
    split = 1.0 - judging_share(session.spec, "full")
    part = Part(context.progress, 0.0, split, alike=stretch_count(session.spec))
    running = Running(work, "full", judged=int(record["detail"]["rows"]["last"]))
    probe, began = None if forged else _same_probe(work, record["detail"]), time.monotonic()
    with running.until_cancelled():
        candidate = run_bake(
            session.folder, freeze, built=built, progress=part, check=running.noting(context.check), reuse=not forged, probe=probe
        )
    taken = session.folder.candidate(freeze) / "bake"
    seconds = round(time.monotonic() - began + spared_seconds(taken, record["detail"]), 2)
    rows = run_checks(candidate, plates=False, progress=Part(context.progress, split, 1.0))
    promised, found = record["detail"]["events"], first_true_frames(candidate)
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
        **taken_frames(taken, total),
        "cache_digest": candidate.digest[:16],
        "changed_rows": len(changed),
        **summary(rows),
        "picture": picture,
    }


def check(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Run the checks of one scope again on what is there, of a probe also where it was stopped or still goes on."""
    from ..verifiers.checks import names_of, plate_ids, rerun_ids, run_checks
    from ..verifiers.delivery.binding import cache_row
    from ..worlds.baked import bake_record

    work = open_work(payload)
    session, freeze = work.session, work.freeze
    stage, only = payload["scope"], payload.get("only")
    if stage == "probe" and only is None:
        # The same motion, judged completely again (after an edit of the story or the shots): as good as a new probe.
        known = session.ledger.freeze(freeze)
        settings = {} if known is None else {k: v for k, v in known["detail"].items() if k in ("coarser", "overrides")}
        found = judge_probe(work, probe_candidate(work), Part(context.progress), seconds={}, settings=settings)
        return {
            "scope": stage,
            **{k: v for k, v in found.items() if k not in ("passed", "freeze", "phases", "overrides", "picture")},
        }
    candidate = work.candidate("full") if stage == "full" else with_variants(probe_candidate(work), session.folder, freeze)
    done = names_of(stage) if only is None else only
    wanted = any(i.partition(":")[0] in done for i in plate_ids(session.spec))
    looking = LOOKING if stage == "full" and wanted else 0.0
    if looking:
        plates_of(work, context)
    rows = run_checks(candidate, only=only, plates=bool(looking), progress=Part(context.progress, looking, 1.0))
    if stage == "full" and "delivery" in done:
        rows.append(cache_row(candidate, bake_record(session.folder.ledger_path, freeze)))
    with session.ledger.together():  # as in a probe
        rows = session.cited(rows)
        changed = session.record(rows, stage=stage, checks=done, keep=() if stage == "probe" else rerun_ids(session.spec))
    return {"scope": stage, "changed_rows": len(changed), **summary(rows)}


def review(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Have the bake read by the model that the server's owner named; without one, write what a reader needs."""
    from .review.conduct import read_world

    work = open_work(payload, present="the review")
    if payload.get("ask", True):
        plates_of(work, context)
    context.progress(LOOKING, 1, "account, pictures, and the reader's answers")
    return read_world(work.session, work.candidate("full"), context.check, ask=payload.get("ask", True))


def plates_of(work: Work, context: JobContext, *, distrust: bool = False) -> None:
    """Render the plates of a bake that are missing or stale; `distrust` as in `make_plates`, for an acceptance, which may take longer."""
    from .plates import AT_ACCEPTANCE, allowed_seconds, make_plates

    candidate, seconds = work.candidate("full"), allowed_seconds(work.session.ledger.bake(work.freeze))
    seconds *= AT_ACCEPTANCE if distrust else 1.0
    told = Part(context.progress, 0.0, LOOKING)
    make_plates(candidate, seconds=seconds, progress=told, check=context.check, distrust=distrust)


def accept(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Have a fresh process judge the present candidate; record its verdict."""
    import secrets

    from ..rendering import report_sheet
    from ..verifiers.acceptance import WaitingJudge, judge_fresh
    from .bundles import remember_refuted
    from .review.verdict import reviewed
    from .siblings import easier_beside

    work = open_work(payload, present="the acceptance")
    session, freeze, built = work
    if session.ledger.bake(freeze) is None:
        raise RefusedError("acceptance needs a complete bake of these exact settings; call bake_sim first")
    _require_whole_history(session)
    with WaitingJudge() as waiting, ThreadPoolExecutor(1) as second:  # it loads its modules meanwhile
        require_true_geometry(session, built)
        plates_of(work, context, distrust=True)
        sheet = second.submit(lambda: report_sheet(work.candidate("full")))  # drawn while the judge works
        context.progress(LOOKING, 1, "a fresh process judges the candidate")
        progress = Part(context.progress, LOOKING, JUDGED)
        record = judge_fresh(session.folder.root, seed=secrets.randbelow(2**31), progress=progress, waiting=waiting)
    if record["spec_digest"] != spec_digest(session.spec):
        raise RefusedError(
            f"revision {session.revision} of the world was edited before it was judged; call run_checks(scope='acceptance') again"
        )
    rows = reviewed(session, built, freeze, record)
    weakenings = [w for w in session.ledger.weakenings() if w["revision"] <= session.revision]
    beside = easier_beside(session.folder.root.parent, session.folder.id, session.spec)
    record |= {"weakenings": weakenings, "easier_beside": beside, "stage": "full"}
    with session.ledger.together():
        remember_refuted(session.ledger, record)
        session.record(rows, stage="full")
        record |= {"not_counted": _beside(session, rows)}
    # The ledger keeps verdicts; contact events are in the caches.
    kept = {k: v for k, v in record.items() if k != "events"}
    session.ledger.add_acceptance(freeze, session.revision, record["subject"], record["verdict"], kept)
    context.progress(JUDGED, 1, "writing the report")
    proof = _proof(session, record, sheet.result)
    context.progress(1, 1, record["verdict"])
    return {
        "verdict": record["verdict"],
        "says": verdict_words(record),
        **unusual_told(record),
        "freeze": freeze[:16],
        **summary(rows),
        "not_counted": record["not_counted"],
        "replayed": next((r.evidence["intervals"] for r in rows if r.id == "delivery:replay"), []),
        **prompt_told(record),
        "read_by": record["read_by"],
        **({"earlier_contradictions": n} if (n := record["earlier_contradictions"]) else {}),
        "weakenings": record["weakenings"],
        **({"easier_beside": beside} if beside else {}),
        "approximations": record["approximations"][:20],
        **proof,
    }


def _require_whole_history(session: Session) -> None:
    """Refuse a ledger whose revisions do not tell how the specification became what it is.

    Raises:
        RefusedError: one is missing or was changed, or hides that it made the specification easier.
    """
    from ..verifiers.delivery.bundle import compare_history
    from .bundles import history_of

    told = compare_history(history_of(session.ledger, session.revision), spec_digest(session.spec))
    if told:
        raise RefusedError(
            f"the history of {session.folder.id!r} does not agree with itself: {told[0]}. Its ledger was changed outside the server; "
            "make the world anew with edit_spec and its specification"
        )


def _beside(session: Session, rows: Sequence[Row]) -> list[str]:
    """Rows of the matrix that an acceptance does not judge, as ids.

    What compares the bake with its probe (`promises.py`) is one: a fresh process reads no probe. It opens or closes gates all the same.
    """
    judged = {r.id for r in rows}
    return [r.id for r in session.ledger.rows() if r.id not in judged]


def _proof(session: Session, record: dict[str, Any], sheet: Callable[[], bytes]) -> dict[str, Any]:
    """Writes the matrix report of a verdict, and the bundle of an accepted one; where they are, in the world folder.

    Args:
        session: of the world.
        record: of the judgement.
        sheet: gives the report's contact sheet.
    """
    from .bundles import make_bundle
    from .matrix_report import write_report

    folder = session.folder
    page = folder.acceptance / f"{record['freeze'][:16]}.html"
    write_report(page, folder, record, spec=session.spec, sheet=sheet)
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

    work = open_work(payload, present="the film")
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
