"""Measured state of a world for `inspect_world`."""

from __future__ import annotations

from typing import Any, Literal

from ..worlds.candidate import Candidate, open_candidate
from ..worlds.errors import EvidenceError, InputError, RefusedError
from ..worlds.records import QUANTITIES
from .session import Session

__all__ = ["is_whole", "latest_candidate", "measured", "refuted"]


def latest_candidate(session: Session, stage: str = "best") -> Candidate:
    """The bake of the present settings, else their probe, else the static scene (for `static` or `best`).

    Raises:
        RefusedError: the asked stage is not there.
    """
    from ..construction import build_world
    from ..simulation.freeze import freeze_hash

    built, _ = build_world(session.folder, session.spec)
    static = Candidate(session.folder.root, session.spec, built, "static")
    if stage == "static":
        return static
    freeze = freeze_hash(session.spec, built)
    for wanted in ("full", "probe") if stage == "best" else (stage,):
        try:
            found = open_candidate(session.folder, freeze, wanted)
        except EvidenceError:
            continue
        # The record may hold an older story or shot plan over the same motion.
        return Candidate(found.folder, session.spec, found.built, found.stage, found.caches, found.artifact, found.digest)
    if stage == "best":
        return static
    raise RefusedError(
        f"there is no {stage} of the present settings; call {'bake_sim' if stage == 'full' else 'probe_sim'} first"
    )


def is_whole(session: Session, freeze: str, stage: Literal["probe", "full"]) -> bool:
    """Whether the caches of a freeze are complete, unaltered, and not found wanting by the last acceptance."""
    try:
        candidate = open_candidate(session.folder, freeze, stage)
        for cache in candidate.caches.values():
            digests = cache.digests()
            if any(cache.frame_digest(k) != digests[k] for k in range(cache.index.frames)):
                return False
    except EvidenceError:
        return False
    return stage == "probe" or not refuted(session, freeze)


def refuted(session: Session, freeze: str) -> bool:
    """Whether the last acceptance found the bake of this freeze altered."""
    latest = session.ledger.acceptance()
    rows = latest["record"]["rows"] if latest is not None and latest["freeze"] == freeze else []
    return any(r["status"] == "fail" and r["id"].startswith(("delivery:replay", "delivery:digests")) for r in rows)


def _rounded(values: Any, digits: int = 5) -> list[float]:
    return [round(float(v), digits) for v in values]


def measured(
    session: Session,
    part: str,
    *,
    entities: list[str] | None,
    frames: tuple[int, int] | None,
    limit: int,
    offset: int,
) -> dict[str, Any]:
    """State, events or records over frames.

    Raises:
        InputError: unknown entities or frames out of range.
        RefusedError: nothing is simulated yet.
    """
    candidate = latest_candidate(session)
    if candidate.stage == "static" and part != "state":
        raise RefusedError(f"{part} need a probe or bake of the present settings; call probe_sim first")
    unknown = [e for e in entities or [] if e not in session.spec.entities]
    if unknown:
        raise InputError(f"unknown entities {unknown}; the world has {sorted(session.spec.entities)[:30]}")
    first, last = frames or (0, candidate.last_frame)
    if not 0 <= first <= last <= candidate.last_frame:
        raise InputError(f"frames [{first}, {last}] are out of range; allowed 0..{candidate.last_frame}")
    head = {"source": candidate.artifact, "stage": candidate.stage}
    if part == "state":
        return {
            **head,
            "frame": first,
            "entities": _state(candidate, entities or list(session.spec.entities), first, limit, offset),
        }
    if part == "events":
        found = _events(candidate, set(entities or ()), first, last)
        return {**head, "total": len(found), "events": found[offset : offset + limit]}
    step = max(1, (last - first + 1) // limit)
    chosen = list(range(first, last + 1, step))
    series = {}
    for name, quantity in QUANTITIES.items():
        total = [sum(float(c.series(f"record/{name}")[k]) for c in candidate.caches.values()) for k in chosen]
        series[name] = {"unit": quantity.unit, "values": _rounded(total, 6)}
    return {**head, "frames": chosen, "records": series}


def _state(candidate: Candidate, names: list[str], frame: int, limit: int, offset: int) -> dict[str, Any]:
    found = {}
    for name in names[offset : offset + limit]:
        pose = candidate.pose(name, frame, candidate.entity(name).bodies[0].name)
        vertices = candidate.vertices(name, frame)
        found[name] = {
            "position": _rounded(pose.position),
            "quaternion": _rounded(pose.quaternion),
            "box_min": _rounded(vertices.min(0)),
            "box_max": _rounded(vertices.max(0)),
        }
        place = candidate.cache_row(name, candidate.entity(name).bodies[0].name)
        if place is not None:
            found[name]["velocity"] = _rounded(place[0].series("velocity")[frame, place[1]])
    return found


def _events(candidate: Candidate, names: set[str], first: int, last: int) -> list[dict[str, Any]]:
    found = []
    for cache in candidate.caches.values():
        colliders = cache.index.colliders
        for frame in range(first, last + 1):
            data = cache.read(frame, ("event/time", "event/pair", "event/point", "event/speed", "event/impulse"))
            for k in range(len(data["event/time"])):
                a, b = (colliders[i] for i in data["event/pair"][k])
                if names and not names & {a, b}:
                    continue
                found.append(
                    {
                        "frame": frame,
                        "time": round(float(data["event/time"][k]), 5),
                        "a": a,
                        "b": b,
                        "point": _rounded(data["event/point"][k], 4),
                        "speed": round(float(data["event/speed"][k]), 4),
                        "impulse": round(float(data["event/impulse"][k]), 7),
                    }
                )
    return found
