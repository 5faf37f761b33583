"""Sketches: a part of the motion, coarse and quick, that tests a hypothesis and freezes nothing."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..execution import JobContext, Part
from ..worlds.errors import InputError
from ..worlds.hints import did_you_mean
from .arguments import Sketch
from .joint_repairs import said_by
from .live_judge import DECISIVE
from .pictures import motion_sheet
from .rows import summary
from .running import Running
from .work import Work, first_true_frames, open_work

if TYPE_CHECKING:
    from ..worlds.requirements import Row
    from ..worlds.spec import WorldSpec

__all__ = ["end_of", "not_in_matrix", "owed_to_step", "sketch", "unjudged"]

STEP_TRAVEL = "numerical:step_travel"
SIMULATING = 0.8
"""Part of a sketch that its frames take, for progress alone."""


def end_of(spec: WorldSpec, asked: Sketch) -> int:
    """Last frame of a sketch.

    Raises:
        InputError: there is no such frame, beat or instance.
    """
    beats, last = spec.story.beats, spec.simulation.frames - 1
    if unknown := [n for n in asked.only or () if n not in spec.simulation.solvers]:
        hint = did_you_mean(unknown[0], spec.simulation.solvers) or ";"
        raise InputError(f"sketch.only names {unknown[0]!r}{hint} the world has {sorted(spec.simulation.solvers)}")
    if isinstance(asked.until, str):
        if asked.until not in beats:
            hint = did_you_mean(asked.until, beats) or ";"
            raise InputError(f"sketch.until is {asked.until!r}{hint} allowed: a frame, 1 to {last}, or a beat of {sorted(beats)}")
        return beats[asked.until].frames[1]
    if not 1 <= asked.until <= last:
        raise InputError(f"sketch.until is {asked.until}; allowed: a frame, 1 to {last}, or a beat of {sorted(beats)}")
    return asked.until


def sketch(payload: dict[str, Any], context: JobContext) -> dict[str, Any]:
    """Simulate a sketch, judge its frames by the checks that decide, and count it as the test of what was changed."""
    from ..simulation.schedule import run_groups
    from ..worlds.bake_plan import groups_of
    from ..worlds.coarsening import Factors, sketched, write_factors

    context.progress(0.0, 1.0, "opening the world and its geometry")
    work = open_work(payload)
    session, freeze = work.session, work.freeze
    asked = Sketch.model_validate(payload["sketch"])
    spec, coarsened = sketched(session.spec, asked.coarser, asked.steps)
    end, began = end_of(spec, asked), time.monotonic()
    root = session.folder.candidate(freeze) / "sketch"
    shutil.rmtree(root, ignore_errors=True)
    factors = Factors(asked.coarser, asked.steps, judged=False)
    write_factors(root, factors)
    told, groups = Part(context.progress, 0.0, SIMULATING), len(groups_of(spec))
    running = Running(work, "sketch")
    with running.until_cancelled():
        run_groups(
            spec, work.built, root, frames=end + 1, check=running.noting(context.check), reuse=False,
            only=None if asked.only is None else frozenset(asked.only), tell=partial(_tell, told, groups),
        )  # fmt: skip
    simulated = time.monotonic() - began
    told_of = _judged(work, spec, root, Part(context.progress, SIMULATING, 1.0))
    running.judged()
    write_factors(root, factors._replace(judged=True))
    spent = {"simulated": round(simulated, 1), "judged": round(time.monotonic() - began - simulated, 1)}
    return {"frames_sketched": end + 1, "seconds": spent, "left_coarser": coarsened, **told_of}


def _judged(work: Work, spec: WorldSpec, root: Path, progress: Part) -> dict[str, Any]:
    """Judge the frames of a sketch and record the test that they are; the part of the reply about them."""
    from ..verifiers.checks import run_checks
    from ..verifiers.story.questions import PHASES_SHOWN
    from ..worlds.begun import begun_in

    session, freeze = work.session, work.freeze
    candidate, unmoved = begun_in(session.folder, root, spec, work.built)
    found = run_checks(candidate, only=DECISIVE, reruns=False, plates=False, progress=progress)
    rows = [r for r in found if not unmoved & {*r.entities} and r.question != PHASES_SHOWN.id]  # a sketch is no whole run
    rows = [owed_to_step(r, session.spec, spec) for r in rows]
    failing = [r.id for r in rows if r.mandatory and r.status == "fail"]
    test = f"sketch {freeze[:9]}"
    with session.ledger.together():
        session.ledger.close_iterations(test, failing, rows, revision=session.revision)
        if failing:  # known before any probe says so: the next edit answers it
            session.ledger.add_look(freeze, "sketch", session.revision, candidate.last_frame)
        rows = [not_in_matrix(r) for r in session.cited(rows)]
    picture = motion_sheet(candidate, session.folder, f"sketch_{freeze[:8]}.jpg")
    owed = [r.id for r in rows if "owed_to_step" in r.evidence]
    silent = unjudged(rows, session.spec, candidate.last_frame)
    return {
        **({"fail_by_the_step_of_the_sketch_alone": owed} if owed else {}),
        **({"cannot_be_judged": silent} if silent else {}),
        "left_out": sorted(unmoved),
        "beats_true_from": {
            n: f for n, f in first_true_frames(candidate).items() if not unmoved & {session.spec.story.beats[n].subject}
        },
        **said_by(session.ledger, test),
        **summary([r for r in rows if r.status != "unverified"]),
        "picture": picture,
    }


def not_in_matrix(row: Row) -> Row:
    """The row without advice to look it up: the matrix has no rows of sketches."""
    told = row.evidence.get("diagnosis")
    if not told or "cheapest_probe" not in told:
        return row
    kept = [p for p in told["cheapest_probe"] if dict(p.get("arguments") or {}).get("part") != "row"]
    return row.model_copy(update={"evidence": {**row.evidence, "diagnosis": {**told, "cheapest_probe": kept}}})


def unjudged(rows: Iterable[Row], spec: WorldSpec, last: int) -> dict[str, str]:
    """Beats that lie within a sketch of frames 0 to `last` and whose rows lack evidence all the same, with the reason: a probe lacks it too."""
    within = {name for name, beat in spec.story.beats.items() if beat.frames[1] <= last}
    return {
        r.id: str(r.evidence.get("explanation", ""))
        for r in rows
        if r.check == "beat" and r.status == "unverified" and set(r.subject) & within
    }


def owed_to_step(row: Row, production: WorldSpec, sketched: WorldSpec) -> Row:
    """The row, which says so where it fails by the longer step of the sketch alone: travel per step goes with the step.

    Args:
        row: of a sketch.
        production: the specification.
        sketched: what the sketch ran.
    """
    if row.status != "fail" or row.question != STEP_TRAVEL or row.measured is None or row.bound is None:
        return row
    used, own = (s.simulation.rigid[row.subject[0]].settings.step for s in (sketched, production))
    at_own = row.measured * own / used
    if used <= own or at_own > row.bound:
        return row
    said = (
        f"{row.evidence.get('explanation', '')}; by the step of this sketch alone, {used:g} s: at production's {own:g} s it is about {at_own:.3g} m, "
        f"within {row.bound:.3g} m"
    )
    return row.model_copy(update={"evidence": {**row.evidence, "explanation": said, "owed_to_step": at_own}})


def _tell(told: Part, groups: int, rank: int, done: float, total: int, message: str) -> None:
    told(rank * total + done, groups * total, message)
