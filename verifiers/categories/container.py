"""Questions about the cache of any instance, whatever it moves: are its frames there, and undamaged (R105)?"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from ...worlds.errors import EvidenceError
from ...worlds.gave_up import GaveUp, noted
from ..rows.corrections import bake_again, halve_step, resume, thicken
from ..rows.findings import Finding, cache_of, judged
from ..rows.instance_rows import instance_answer
from .questions import DIGEST, FRAMES

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ..rows.questions import Question

__all__ = ["FUNCTIONS", "Function", "answers", "digest_of", "rows_about"]

Function = Callable[["Candidate", str, "Cache"], Finding]


def rows_about(candidate: Candidate, solver: str, started: Mapping[Question, Function]) -> list[Row]:
    """Rows about frame 0 and the cache of an instance, by the functions that answer the questions about frame 0."""
    return answers(candidate, solver, {**started, **FUNCTIONS})


def answers(candidate: Candidate, solver: str, asked: Mapping[Question, Function]) -> list[Row]:
    """Rows of an instance by questions about its cache; `unverified` where it has none."""

    def ask(function: Function) -> Finding:
        return function(candidate, solver, cache_of(candidate, solver))

    return [instance_answer(candidate, q, solver, judged(ask, function)) for q, function in asked.items()]


def frames(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Finding on the frames that are missing and on the index against the plan; of a run that its engine ended, on that."""
    if (ended := noted(cache.folder.parent, solver, candidate.last_frame)) is not None:
        return given_up(candidate, ended)
    index, plan = cache.index, candidate.spec.simulation
    absent = [k for k in range(index.frames) if not cache.path(k).exists()]
    wrong = []
    if index.fps != plan.fps:
        wrong.append(f"written at {index.fps} fps, planned {plan.fps}")
    if candidate.stage == "full" and index.frames != plan.frames:
        wrong.append(f"holds {index.frames} frames, planned {plan.frames}")
    if index.frames > plan.frames:
        wrong.append(f"holds {index.frames} frames, more than the {plan.frames} planned")
    if index.solver != solver:
        wrong.append(f"written for instance {index.solver!r}, not {solver!r}")
    if index.engine != plan.solvers[solver].engine:
        wrong.append(f"written by engine {index.engine!r}, planned {plan.solvers[solver].engine!r}")
    if beyond := cache.beyond():
        wrong.append(f"{len(beyond)} frames lie beyond the last one of the index, first {beyond[0]}")
    if absent:
        wrong.append(f"{len(absent)} of {index.frames} frames are missing, first frame {absent[0]}")
    return Finding(
        "fail" if wrong else "pass",
        "; ".join(dict.fromkeys(wrong)) or f"{index.frames} frames at {index.fps} fps",
        float(len(absent)),
        0.0,
        "frames",
        frame=absent[0] if absent else None,
        hints=(resume(),),
        evidence={"held": index.frames, "planned": plan.frames, "missing": absent[:100]},
    )


def given_up(candidate: Candidate, ended: GaveUp) -> Finding:
    """Finding on a run that its engine gave up: whose motion it was, where, and when."""
    solver = ended.solver
    members = [m for m in candidate.spec.simulation.solvers[solver].members if candidate.spec.entities[m].motion != "static"]
    known = [e for e in ended.entities if e in candidate.spec.entities]
    first = known[0] if known else None
    hints = (
        halve_step(candidate, solver, "a motion ran away within a step"),
        *((thicken(first, "it is too thin or too light for what pinches it"),) if first else ()),
    )
    return Finding(
        "fail",
        ended.text,
        float(max(candidate.spec.simulation.frames - ended.frame, 1)),
        0.0,
        "frames",
        first,
        ended.frame,
        hints,
        {"gave_up_at_frame": ended.frame, "bodies": known, "place": ended.place},
        # Where nobody knows whose motion it was, it may have been any.
        entities=tuple(known or members),
    )


def digest(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Finding on the first frame that cannot be read or whose content has another digest than was recorded."""
    state = hashlib.sha256()
    count, recorded = cache.index.frames, cache.digests()  # what the bake wrote down, frame by frame
    if len(recorded) < count:
        raise EvidenceError(f"digests of {len(recorded)} of {count} frames are recorded; bake again")
    for k in range(count):
        try:
            digest = digest_of(candidate, cache, k)
            state.update(digest.encode())
            if recorded[k] != digest:
                raise EvidenceError(f"content does not match the digest recorded when it was written ({recorded[k][:12]})")
        except EvidenceError as error:
            return Finding("fail", f"frame {k}: {error}", frame=k, hints=(bake_again("a cache file is damaged or gone"),))
    evidence = {"sha256": state.hexdigest(), "compared": count}
    return Finding("pass", f"{count} frames read", 0.0, 0.0, "frames", evidence=evidence)


def digest_of(candidate: Candidate, cache: Cache, frame: int) -> str:
    """Digest of one frame as it was first read of this candidate: reading all frames takes long, and several rows ask.

    Raises:
        EvidenceError: it is missing or damaged.
    """
    return candidate.memo(("digest", cache.folder, frame), lambda: cache.seen_digest(frame))


FUNCTIONS: Mapping[Question, Function] = {FRAMES: frames, DIGEST: digest}
