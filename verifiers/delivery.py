"""Delivery rows (R84, R118, R126): complete sequence, untouched caches, an independent folder."""

from __future__ import annotations

from pathlib import Path

from ..worlds.cache import Cache
from ..worlds.candidate import Candidate
from ..worlds.errors import EvidenceError
from ..worlds.requirements import Correction, Row

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
    return Row(
        id=f"delivery:complete:{name}",
        check="delivery",
        group="delivery",
        predicate=f"the cache of {name!r} holds all {wanted} requested frames",
        status="pass" if have == wanted else "fail",
        artifact=f"{candidate.artifact}/{name}",
        frames=(0, wanted - 1),
        measured=float(have),
        bound=float(wanted),
        comparison="==",
        unit="frame",
        first_failing_frame=None if have == wanted else have,
        corrections=()
        if have == wanted
        else (
            Correction(
                cause="the bake stopped early", edit_class="solver", group="interval", action="call bake_sim to resume it"
            ),
        ),
        recipe=candidate.recipe("delivery", extra=name),
    )


def _untouched(candidate: Candidate, name: str, cache: Cache) -> Row:
    bad, why = _first_altered(cache)
    return Row(
        id=f"delivery:digests:{name}",
        check="delivery",
        group="delivery",
        predicate=f"every frame of {name!r} has the content recorded when it was baked",
        status="pass" if bad is None else "fail",
        artifact=f"{candidate.artifact}/{name}",
        frames=(0, cache.index.frames - 1),
        measured=0.0 if bad is None else 1.0,
        bound=0.0,
        comparison="<=",
        unit="1",
        first_failing_frame=bad,
        evidence={} if bad is None else {"reason": why},
        corrections=()
        if bad is None
        else (
            Correction(
                cause=f"frame {bad}: {why}", edit_class="solver", group="interval", action="bake again; never edit cache files"
            ),
        ),
        recipe=candidate.recipe("delivery", extra=name),
    )


def _independent(candidate: Candidate) -> Row:
    """Nothing in the world folder leads out of it."""
    root = candidate.folder.resolve()
    outside = sorted(
        str(p.relative_to(root)) for p in Path(root).rglob("*") if p.is_symlink() and root not in p.resolve().parents
    )
    return Row(
        id="delivery:independent",
        check="delivery",
        group="delivery",
        predicate="the world folder holds everything it refers to",
        status="fail" if outside else "pass",
        artifact="world.json",
        measured=float(len(outside)),
        bound=0.0,
        comparison="<=",
        unit="1",
        evidence={"links": outside[:10]} if outside else {},
        corrections=(
            Correction(
                cause=f"{outside[0]!r} is a link out of the folder",
                edit_class="scene",
                group="shape",
                action="put the file itself into assets/",
            ),
        )
        if outside
        else (),
        recipe=candidate.recipe("delivery", extra="independent"),
    )


def check(candidate: Candidate) -> list[Row]:
    """Rows `delivery:*` of a complete bake."""
    rows = [_independent(candidate)]
    for name, cache in candidate.caches.items():
        rows += [_complete(candidate, name, cache), _untouched(candidate, name, cache)]
    return rows
