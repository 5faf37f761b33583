"""Delivery rows (R84, R118, R126): complete sequence, untouched caches, an independent folder."""

from __future__ import annotations

from pathlib import Path

from ...worlds.cache import Cache
from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ...worlds.requirements import Row
from ..categories.container import digest_of
from ..rows.answers import row_of
from ..rows.corrections import bake_again, correction, resume
from ..rows.findings import Finding
from .questions import COMPLETE, DIGESTS, INDEPENDENT

__all__ = ["check"]


def _first_altered(candidate: Candidate, cache: Cache) -> tuple[int | None, str]:
    """First frame whose bytes do not give the recorded digest, and why."""
    digests = cache.digests()
    for frame in range(cache.index.frames):
        if frame >= len(digests):
            return frame, "no digest recorded"
        try:
            if digest_of(candidate, cache, frame) != digests[frame]:
                return frame, "content differs from the recorded digest"
        except EvidenceError as error:
            return frame, str(error)
    return None, ""


def _complete(candidate: Candidate, cache: Cache) -> Finding:
    wanted, have = candidate.spec.simulation.frames, cache.index.frames
    return Finding(
        "pass" if have == wanted else "fail",
        f"{have} of {wanted} frames are there",
        float(have),
        float(wanted),
        frame=have,
        hints=(resume(),),
        frames=(0, wanted - 1),
    )


def _untouched(candidate: Candidate, cache: Cache) -> Finding:
    bad, why = _first_altered(candidate, cache)
    told = f"{cache.index.frames} frames are as baked" if bad is None else f"frame {bad}: {why}"
    return Finding(
        "pass" if bad is None else "fail",
        told,
        0.0 if bad is None else 1.0,
        0.0,
        frame=bad,
        hints=(bake_again(told),),
        evidence={} if bad is None else {"reason": why},
        frames=(0, cache.index.frames - 1),
    )


def _independent(candidate: Candidate) -> Finding:
    """Judge whether nothing in the world folder leads out of it."""
    root = candidate.folder.resolve()
    outside = sorted(
        str(p.relative_to(root)) for p in Path(root).rglob("*") if p.is_symlink() and root not in p.resolve().parents
    )
    return Finding(
        "fail" if outside else "pass",
        f"{len(outside)} links lead out of the folder",
        float(len(outside)),
        0.0,
        hints=tuple(
            correction(f"{n!r} is a link out of the folder", "shape", "put the file itself into assets/") for n in outside[:1]
        ),
        evidence={"links": outside[:10]} if outside else {},
    )


def check(candidate: Candidate) -> list[Row]:
    """Rows `delivery:*` of a complete bake."""
    rows = [row_of(candidate, INDEPENDENT, (), _independent(candidate), artifact="world.json")]
    for name, cache in candidate.caches.items():
        artifact = f"{candidate.artifact}/{name}"
        rows.append(row_of(candidate, COMPLETE, (name,), _complete(candidate, cache), artifact=artifact))
        rows.append(row_of(candidate, DIGESTS, (name,), _untouched(candidate, cache), artifact=artifact))
    return rows
