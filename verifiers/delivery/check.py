"""Delivery rows (R84, R118, R126): complete sequence, untouched caches, an independent folder."""

from __future__ import annotations

from pathlib import Path

from ...worlds.cache import Cache
from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ...worlds.requirements import Row, RowId
from ..rows.instance_rows import baked_again
from ..rows.verdicts import correction, make_row

__all__ = ["check"]


def _first_altered(cache: Cache) -> tuple[int | None, str]:
    """First frame whose bytes do not give the recorded digest, and why."""
    digests = cache.digests()
    for frame in range(cache.index.frames):
        if frame >= len(digests):
            return frame, "no digest recorded"
        try:
            if cache.frame_digest(frame) != digests[frame]:
                return frame, "content differs from the recorded digest"
        except EvidenceError as error:
            return frame, str(error)
    return None, ""


def _complete(candidate: Candidate, name: str, cache: Cache) -> Row:
    wanted = candidate.spec.simulation.frames
    have = cache.index.frames
    return make_row(
        candidate,
        RowId("delivery:complete", name),
        predicate=f"the cache of {name!r} holds all {wanted} requested frames",
        status="pass" if have == wanted else "fail",
        explanation=f"{have} of {wanted} frames are there",
        artifact=f"{candidate.artifact}/{name}",
        frames=(0, wanted - 1),
        measured=float(have),
        bound=float(wanted),
        comparison="==",
        unit="frame",
        first_failing_frame=have,
        corrections=(correction("the bake stopped early", "interval", "call bake_sim to resume it"),),
    )


def _untouched(candidate: Candidate, name: str, cache: Cache) -> Row:
    bad, why = _first_altered(cache)
    return make_row(
        candidate,
        RowId("delivery:digests", name),
        predicate=f"every frame of {name!r} has the content recorded when it was baked",
        status="pass" if bad is None else "fail",
        explanation=f"{cache.index.frames} frames are as baked" if bad is None else f"frame {bad}: {why}",
        artifact=f"{candidate.artifact}/{name}",
        frames=(0, cache.index.frames - 1),
        measured=0.0 if bad is None else 1.0,
        bound=0.0,
        comparison="<=",
        unit="1",
        first_failing_frame=bad,
        evidence={} if bad is None else {"reason": why},
        corrections=(baked_again(f"frame {bad}: {why}"),),
    )


def _independent(candidate: Candidate) -> Row:
    """Nothing in the world folder leads out of it."""
    root = candidate.folder.resolve()
    outside = sorted(
        str(p.relative_to(root)) for p in Path(root).rglob("*") if p.is_symlink() and root not in p.resolve().parents
    )
    return make_row(
        candidate,
        RowId("delivery:independent"),
        predicate="the world folder holds everything it refers to",
        status="fail" if outside else "pass",
        explanation=f"{len(outside)} links lead out of the folder",
        artifact="world.json",
        measured=float(len(outside)),
        bound=0.0,
        comparison="<=",
        unit="1",
        evidence={"links": outside[:10]} if outside else {},
        corrections=[
            correction(f"{n!r} is a link out of the folder", "shape", "put the file itself into assets/") for n in outside[:1]
        ],
    )


def check(candidate: Candidate) -> list[Row]:
    """Rows `delivery:*` of a complete bake."""
    rows = [_independent(candidate)]
    for name, cache in candidate.caches.items():
        rows += [_complete(candidate, name, cache), _untouched(candidate, name, cache)]
    return rows
