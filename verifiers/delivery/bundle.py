"""Comparison of a bundled verdict with this installation's own verdict, the events in its caches, and its own history."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ...worlds.cache import Cache
from ...worlds.candidate import Candidate
from ...worlds.canonical import spec_digest
from ...worlds.errors import EvidenceError, SpecError
from ...worlds.patch import parse_spec, weakenings
from ...worlds.weakened import told_by_motion
from ..predicates.evaluators import evaluate
from .bounds import NOISE, OTHER_MACHINE

__all__ = ["compare_history", "compare_rows", "event_list", "unequal"]

TEXT_KEYS = ("evidence", "corrections", "recipe", "artifact", "entities", "frames", "first_failing_entity", "first_failing_frame")
"""Fields that name files, seeds, frames or words: compared from equal bytes only."""


def event_list(candidate: Candidate) -> dict[str, Any]:
    """Contact beginnings of all caches in order of time, and the first true frame of every beat; None for what is missing."""
    contacts: list[dict[str, Any]] = []
    missing = []
    for name, cache in sorted(candidate.rigid_caches.items()):
        try:
            contacts += _contacts(name, cache)
        except EvidenceError as error:
            missing.append(str(error))
    beats = {n: evaluate(candidate, b.predicate, b.frames).first_true_frame for n, b in candidate.spec.story.beats.items()}
    return {"contacts": contacts, "beats": beats, **({"missing": missing} if missing else {})}


def _contacts(name: str, cache: Cache) -> list[dict[str, Any]]:
    channels = ("event/time", "event/pair", "event/point", "event/speed", "event/impulse")
    found = []
    for frame, data in enumerate(cache.ragged(*channels)):
        for time, pair, point, speed, impulse in zip(*(data[c].tolist() for c in channels), strict=True):
            # Indices and numbers that make no sense have rows of their own (`numerical`); here they are only listed.
            names = [cache.index.colliders[k] if 0 <= k < len(cache.index.colliders) else str(k) for k in pair]
            found.append(
                {
                    "solver": name,
                    "frame": frame,
                    "time": _number(time),
                    "pair": names,
                    "point": [_number(x) for x in point],
                    "speed": _number(speed),
                    "impulse": _number(impulse),
                }
            )
    return found


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def unequal(a: Any, b: Any, *, relative: float, place: str = "") -> str | None:
    """Where two JSON values differ beyond noise, as a pointer; None where they agree."""
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        for key in sorted({*map(str, a), *map(str, b)}):
            if key not in a or key not in b:
                return f"{place}/{key}"
            if (found := unequal(a[key], b[key], relative=relative, place=f"{place}/{key}")) is not None:
                return found
        return None
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        if len(a) != len(b):
            return place or "/"
        places = (unequal(x, y, relative=relative, place=f"{place}/{k}") for k, (x, y) in enumerate(zip(a, b, strict=True)))
        return next((p for p in places if p is not None), None)
    numbers = all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in (a, b))
    same = math.isclose(a, b, rel_tol=relative, abs_tol=relative * 1e-3) if numbers else type(a) is type(b) and a == b
    return None if same else place or "/"


def compare_rows(bundled: Sequence[Any], own: Sequence[Mapping[str, Any]], *, exact: bool) -> list[dict[str, Any]]:
    """Rows that the bundle and this installation do not agree on, in words and numbers.

    Args:
        bundled: rows of the bundle, as written there by whomever.
        own: rows that this installation judged.
        exact: both judged the same bytes, so that evidence and corrections must agree as well.
    """
    theirs: dict[str, Any] = {}
    found: list[dict[str, Any]] = []
    for item in bundled:
        if not isinstance(item, Mapping):
            found.append({"row": repr(item)[:80], "differs": "is no row"})
            continue
        name = str(item.get("id"))
        if name in theirs:
            found.append({"row": name, "differs": "stands twice in the bundle"})
        theirs[name] = item
    ours = {str(r["id"]): r for r in own}
    for name in sorted({*theirs, *ours}):
        if name not in theirs:
            found.append({"row": name, "differs": "missing from the bundle", "here": ours[name]["status"]})
        elif name not in ours:
            found.append({"row": name, "differs": "not a row of this installation", "bundled": theirs[name].get("status")})
        else:
            found += _row_differences(name, theirs[name], ours[name], exact=exact)
    return found


def _row_differences(name: str, theirs: Mapping[str, Any], ours: Mapping[str, Any], *, exact: bool) -> Iterator[dict[str, Any]]:
    # A row that drew a sample says its seed; another seed measures other samples. Our own row says so, not the bundle's.
    sampled = "seed" in ours.get("evidence", {})
    skipped = {"evidence"} if sampled else set()
    if not exact:
        skipped |= set(TEXT_KEYS)
    if sampled and not exact:
        skipped.add("measured")
    for key in sorted({*theirs, *ours} - skipped):
        if key not in theirs or key not in ours:
            yield {"row": name, "differs": key, "bundled": theirs.get(key), "here": ours.get(key)}
        elif (place := unequal(theirs[key], ours[key], relative=NOISE if exact else OTHER_MACHINE)) is not None:
            where = key if place == "/" else f"{key}{place}"
            short = isinstance(ours[key], (str, int, float, type(None)))
            yield {"row": name, "differs": where, **({"bundled": theirs[key], "here": ours[key]} if short else {})}


def compare_history(history: Mapping[str, Any], digest: str) -> list[str]:
    """Faults of a list of revisions: digests, the last one, and weakenings that are not owned up to (R157).

    Args:
        history: `history.json` of a bundle.
        digest: of the specification that the verdict is about.
    """
    problems: list[str] = []
    before, last = None, None
    revisions = history["revisions"]
    for place, revision in enumerate(revisions):
        number = revision["n"]
        if number != place + 1:
            problems.append(f"history: revision {place + 1} is missing")
            break
        try:
            after = parse_spec(revision["spec"])
        except SpecError as error:
            problems.append(f"history: the specification of revision {number} does not validate: {str(error)[:200]}")
            break
        last = spec_digest(after)
        if last != revision["digest"]:
            problems.append(f"history: the specification of revision {number} does not give its digest")
        owed: list[str] = [] if before is None else weakenings(before, after)
        hidden = sorted(set(owed) - set(revision["weakenings"]) - set(_early(history, revision)))
        if hidden:
            problems.append(f"history: revision {number} hides weakenings: {'; '.join(hidden[:4])}")
        before = after
    if last != digest:
        problems.append("history: the last revision is not the specification of the verdict")
    return problems


def _early(history: Mapping[str, Any], revision: Mapping[str, Any]) -> list[str]:
    """Lines that made a specification easier before there was evidence that could count against them."""
    lines, number = list(revision.get("early", ())), revision["n"]
    judged, failed = history.get("judged_since"), history.get("motion_failed_since")
    if judged is None or number <= judged:
        return lines
    return [line for line in lines if told_by_motion(line)] if failed is None or number <= failed else []
