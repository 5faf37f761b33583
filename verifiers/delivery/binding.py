"""Rows that bind a judgement to what was baked: the cache the ledger names, and the one that the settings give again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ...execution import Tell
from ...worlds.baked import BakeRecord
from ...worlds.cache import Cache
from ...worlds.candidate import Candidate, cache_digest
from ...worlds.errors import EvidenceError
from ...worlds.requirements import Correction, Row, Status
from ..rows.answers import row_of
from ..rows.corrections import bake_again, correction
from ..rows.findings import Finding
from .questions import CACHE, REPLAY

__all__ = ["ALL_INTERVALS", "cache_row", "replay_row", "standing"]

ALL_INTERVALS = 10**9
"""More intervals than any cache has: all of them are simulated again."""
SHOWN = 16
"""Digits of a digest that a row quotes."""


def standing(candidate: Candidate, record: BakeRecord | None) -> list[dict[str, Any]]:
    """Failed replays of exactly this cache since its bake: they count until it is baked again."""
    if record is None:
        return []
    return [{k: v for k, v in r.items() if k != "digest"} for r in record.refuted if r["digest"] == candidate.digest]


def cache_row(candidate: Candidate, record: BakeRecord | None, *, replayed: bool | None = None, missing: str = "") -> Row:
    """`delivery:cache`: the frames on disk are those that the record of the bake names.

    Args:
        candidate: a complete bake.
        record: what the ledger (of a bundle, its verdict) says of it; None where nothing does.
        replayed: whether every interval was simulated again and gave the cached bytes, which needs no word of a ledger.
        missing: why the record cannot be read.
    """
    found, problem = _content(candidate.caches)
    frame, solver = None, ""
    if record is not None:
        frame, solver = _first_difference(found, record.frames)
    whole = None if problem else cache_digest(candidate.caches, found)
    status: Status = "pass"
    evidence: dict[str, Any] = {}
    if record is not None and whole != record.digest:
        status, evidence = "fail", _told(record, whole, solver, frame, problem)
    elif (record is None or not record.sealed) and not replayed:
        why = missing or (
            "the folder has no record of this bake (it was copied without its ledger, or never baked here)"
            if record is None
            else "the record of this bake lacks the seals that it was written with"
        )
        status, evidence = "unverified", {"explanation": f"{why}, so that nothing says which frames were baked"}
    measured = {"pass": 0.0, "fail": 1.0}.get(status)
    told = str(evidence.get("explanation", f"{candidate.frame_count} frames are those of the record"))
    hints = _corrections(status)
    return row_of(candidate, CACHE, (), Finding(status, told, measured, 0.0, frame=frame, hints=hints, evidence=evidence))


def _content(caches: Mapping[str, Cache]) -> tuple[dict[str, list[str]], str]:
    """Digests of the arrays of every frame as they are now, by instance; and what is wrong where they cannot be read."""
    found: dict[str, list[str]] = {}
    problem = ""
    for name, cache in sorted(caches.items()):
        found[name] = []
        try:
            for frame in range(cache.index.frames):
                found[name].append(cache.frame_digest(frame))
        except EvidenceError as error:
            problem = problem or str(error)
    return found, problem


def _first_difference(found: Mapping[str, Sequence[str]], recorded: Mapping[str, Sequence[str]]) -> tuple[int | None, str]:
    """The first frame whose digest is not the recorded one, and its instance."""
    bad: list[tuple[int, str]] = []
    for name, told in recorded.items():
        here = found.get(name, ())
        same = min(len(here), len(told))
        first = next((k for k in range(same) if here[k] != told[k]), same)
        if first < max(len(here), len(told)):
            bad.append((first, name))
    return min(bad, default=(None, ""))


def _told(record: BakeRecord, whole: str | None, solver: str, frame: int | None, problem: str) -> dict[str, Any]:
    here = whole[:SHOWN] if whole is not None else "unreadable"
    where = "" if frame is None else f"; the first frame that differs is {frame} of {solver!r}"
    if frame is None and record.frames and not problem:
        where = "; every frame is as recorded: what differs is the index beside them, or a liquid's surface or wet map"
    text = f"the ledger names the cache {record.digest[:SHOWN]}, the arrays on disk give {here}{where}"
    shown = {"recorded": record.digest, "present": whole, "solver": solver or None, "reason": problem or None}
    return {"explanation": text} | {k: v for k, v in shown.items() if v is not None}


def _corrections(status: Status) -> tuple[Correction, ...]:
    if status == "pass":
        return ()
    if status == "fail":
        return (bake_again("the cache is not the one that was baked"),)
    cause = "nothing that can be trusted says which frames were baked"
    action = (
        "call bake_sim; or, without a server, worldagent recompute FOLDER, or worldagent verify FOLDER --replay --intervals all"
    )
    return (correction(cause, "interval", action),)


def replay_row(
    candidate: Candidate, seed: int, intervals: int, earlier: Sequence[Mapping[str, Any]], progress: Tell | None
) -> tuple[Row, bool]:
    """`delivery:replay`, and whether every interval was simulated again and gave the cached bytes.

    Args:
        candidate: a complete bake.
        seed: chooses the intervals.
        intervals: how many of each solver instance; more than there are means all.
        earlier: failed replays of this very cache; their intervals are simulated again whatever the seed, and they count.
        progress: told of the frames; None simulates nothing, and tells of `earlier` alone.
    """
    from ...simulation.probe import replay

    results: list[dict[str, Any]] = []
    if progress is not None:
        also = frozenset(int(r["frames"][0]) for r in earlier)
        results = replay(candidate, intervals=intervals, seed=seed, also=also, progress=progress)
    bad = [r for r in results if not r["identical"]]
    counted = bad or [dict(r) for r in earlier]
    cause = "the cache is not what these settings give"
    if not bad:
        cause = "an earlier replay of this very cache did not give its bytes, which counts until it is baked again"
    found = Finding(
        "fail" if counted or not results else "pass",
        f"{len(results) - len(bad)} of {len(results)} intervals gave the cached bytes",
        float(len(counted)),
        0.0,
        frame=min((int(str(r["first_different_frame"])) for r in counted), default=None),
        hints=(bake_again(cause),) if counted else (),
        evidence={"intervals": results, "seed": seed, **({"earlier": [dict(r) for r in earlier]} if earlier else {})},
    )
    return row_of(candidate, REPLAY, (), found), bool(results) and not counted and intervals >= ALL_INTERVALS
