"""Measured state of a world for `inspect_world`."""

from __future__ import annotations

import dataclasses
from typing import Any, Literal

from ..worlds.begun import begun_in, open_begun, unfinished
from ..worlds.candidate import Candidate, open_candidate
from ..worlds.channels import QUANTITIES
from ..worlds.coarsening import coarsened, read_factors, read_overrides, sketched
from ..worlds.errors import EvidenceError, InputError, RefusedError
from ..worlds.hints import did_you_mean
from .answers import answer, call, paged
from .earlier import latest_probe
from .matter_states import rounded
from .session import Session
from .states import MAX_SAMPLES, motion_over, state_at

__all__ = ["is_whole", "latest_candidate", "measured", "refuted", "run_of", "seen_candidate"]

SKETCH = "sketch"
"""Folder of a sketch beside the probe and bake of the same settings."""
DISTRUSTED = ("delivery:replay", "delivery:digests", "delivery:cache")
"""Rows of an acceptance that say of a bake that it is not what was simulated."""


def latest_candidate(session: Session, stage: str = "best") -> Candidate:
    """The bake of the present settings, else their probe, else as much of one as is written, else the static scene (for `static` or `best`).

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
        spec = session.spec
        if wanted == "probe":
            spec = coarsened(spec, read_overrides(session.folder.candidate(freeze) / "probe"))
        return Candidate(found.folder, spec, found.built, found.stage, found.caches, found.artifact, found.digest)
    begun = None if stage == "full" else _begun(session, freeze, ("full", "probe") if stage == "best" else ("probe",))
    if begun is not None or stage == "best":
        return begun or static
    raise RefusedError(
        f"there is no {'bake' if stage == 'full' else stage} of the present settings; call {'bake_sim' if stage == 'full' else 'probe_sim'} "
        f"first{_left(session) if stage == 'probe' else ''}"
    )


def seen_candidate(session: Session, stage: str = "best") -> Candidate:
    """A candidate to look at: as `latest_candidate`, or the frames of a sketch of the present settings, where `sketch` is asked or no other motion is there.

    Raises:
        RefusedError: the asked stage is not there.
    """
    found = latest_candidate(session, "static" if stage == "sketch" else stage)
    if stage not in ("best", "sketch") or found.stage != "static":
        return found
    freeze = session.freeze()
    root = session.folder.candidate(freeze) / SKETCH
    try:
        factors = read_factors(root)
        spec, _ = sketched(session.spec, factors.coarser, factors.steps)
        return begun_in(session.folder, root, spec, found.built).candidate
    except EvidenceError:
        if stage == "best":
            return found
        raise RefusedError("there is no sketch of the present settings; call probe_sim(sketch={'until': ...}) first") from None


def run_of(candidate: Candidate) -> str:
    """Word for the run that a candidate's motion is of: static, sketch, probe or full."""
    return SKETCH if candidate.artifact.rpartition("/")[2] == SKETCH else candidate.stage


def _begun(session: Session, freeze: str, stages: tuple[Literal["probe", "full"], ...]) -> Candidate | None:
    """The frames so far of a bake or probe that goes on, was stopped or failed; None where there are none."""
    for stage in stages:
        try:
            found = open_begun(session.folder, freeze, stage).candidate
        except EvidenceError:
            continue
        spec = session.spec
        if stage == "probe":
            spec = coarsened(spec, read_overrides(session.folder.candidate(freeze) / "probe"))
        return dataclasses.replace(found, spec=spec)
    return None


def _left(session: Session) -> str:
    """Advice about the newest probe of other settings, which can still be seen."""
    earlier = latest_probe(session)
    if earlier is None:
        return ""
    name = f"probe_{earlier.freeze[:8]}.jpg"
    seen = (
        f" its contact sheet is worldagent://worlds/{session.folder.id}/pictures/{name}, and"
        if (session.folder.pictures / name).is_file()
        else ""
    )
    return (
        f". The probe {earlier.freeze[:16]} of revision {earlier.revision} is of other settings and is not drawn under these:{seen} "
        "an edit back to its settings shows it again"
    )


def is_whole(session: Session, freeze: str, stage: Literal["probe", "full"]) -> bool:
    """True if the caches of a freeze are complete, unaltered, and not found wanting by the last acceptance."""
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
    """True if the bake of this freeze is not to be trusted: a replay or the last acceptance found it altered, or the ledger names another."""
    baked = session.ledger.bake(freeze)
    if session.ledger.refuted(freeze):
        return True
    if baked is not None:
        try:
            if open_candidate(session.folder, freeze, "full").digest != baked["digest"]:
                return True
        except EvidenceError:
            pass  # frames are missing or unreadable: the bake resumes and finds which
    latest = session.ledger.acceptance()
    rows = latest["record"]["rows"] if latest is not None and latest["freeze"] == freeze else []
    return any(r["status"] == "fail" and r["id"].startswith(DISTRUSTED) for r in rows)


def _span(candidate: Candidate, frames: tuple[int, int] | None) -> tuple[int, int]:
    """First and last frame that are asked for, all by default; those that are there, where the range ends beyond a motion.

    Raises:
        InputError: none of them is there, or nothing moves yet.
    """
    first, last = frames or (0, candidate.last_frame)
    if 0 <= first <= last <= candidate.last_frame or (candidate.stage != "static" and 0 <= first <= candidate.last_frame < last):
        return first, min(last, candidate.last_frame)
    if first > last:
        raise InputError(f"frames [{first}, {last}] run backwards; give the first frame before the last: [{last}, {first}]")
    more = "; probe_sim gives motion" if candidate.stage == "static" else f" ({left})" if (left := unfinished(candidate)) else ""
    raise InputError(
        f"frames [{first}, {last}] are out of range; allowed 0..{candidate.last_frame} in the {run_of(candidate)} run{more}"
    )


def _head(session: Session, candidate: Candidate, frames: tuple[int, int] | None, last: int) -> dict[str, Any]:
    """Beginning of an answer: which run it tells of, whether that was judged, and that frames beyond it were asked for."""
    unjudged = session.shown(candidate, last)
    head: dict[str, Any] = {
        "source": candidate.artifact,
        "stage": run_of(candidate),
        **({"unjudged": unjudged} if unjudged else {}),
    }
    head |= {"run": left} if (left := unfinished(candidate)) else {}
    if frames is not None and frames[1] > last:
        head |= {"warnings": [f"the {run_of(candidate)} run has frames 0..{last}: told is up to there"]}
    return head


def measured(
    session: Session,
    part: str,
    *,
    entities: list[str] | None,
    frames: tuple[int, int] | None,
    limit: int,
    offset: int,
) -> dict[str, Any]:
    """State, events or records over frames, as an answer.

    Raises:
        InputError: unknown entities or frames out of range.
        RefusedError: nothing is simulated yet.
    """
    candidate = seen_candidate(session)
    world = session.folder.id
    if candidate.stage == "static" and part not in ("state", "account"):
        raise RefusedError(f"{part} need a probe or bake of the present settings; call probe_sim first")
    owners = [e.partition("/")[0] if part == "state" else e for e in entities or []]
    unknown = [e for e, owner in zip(entities or [], owners, strict=True) if owner not in session.spec.entities]
    if unknown:
        hint = did_you_mean(unknown[0], session.spec.entities) or ";"
        raise InputError(f"unknown entities {unknown}{hint} the world has {sorted(session.spec.entities)[:30]}")
    first, last = _span(candidate, frames)
    head = _head(session, candidate, frames, last)
    same = {"entities": entities, "frames": None if frames is None else [first, last]}
    if part == "state":
        names = entities or list(session.spec.entities)
        over = frames is not None and last > first
        found, place = (motion_over if over else state_at)(candidate, names, first, last, limit, offset)
        text = f"{len(found['entities'])} of {len(names)} entities at frame {first}" + (f" to {last}" if over else "")
        then = call("inspect_world", world=world, part="state", **same, offset=place.get("next_offset"))
        return answer(
            {**head, **found, **place}, f"{text} of the {run_of(candidate)} run", then if "next_offset" in place else ""
        )
    if part == "events":
        events = _events(candidate, set(entities or ()), first, last)
        page, place = paged(events, offset, limit)
        then = call("inspect_world", world=world, part="events", **same, offset=place.get("next_offset"))
        text = f"{len(page)} of {len(events)} contact begins in frames {first} to {last}, earliest first"
        return answer({**head, "events": page, **place}, text, then if "next_offset" in place else "")
    if part == "account":
        from ..verifiers.account.text import account_of

        told = account_of(candidate)
        text = f"{len(told.text)} characters on the {run_of(candidate)} run, without ids and texts of the specification"
        return answer({**head, "account": told.text, "left_out": told.left_out}, text, "")
    if part == "wet":
        from .wetness import wetness

        return wetness(candidate, world, entities, last, limit=limit, offset=offset)
    return _records(candidate, first, last, limit, head)


def _records(candidate: Candidate, first: int, last: int, limit: int, head: dict[str, Any]) -> dict[str, Any]:
    """Quantities of all solvers together at evenly chosen frames."""
    step = max(1, -(-(last - first + 1) // min(limit, MAX_SAMPLES)))
    chosen = list(range(first, last + 1, step))
    series, missing = {}, []
    for name, quantity in QUANTITIES.items():
        writers = candidate.written_by(quantity)
        if not writers:
            continue
        try:
            columns = [c.series(quantity.name) for c in writers]
        except EvidenceError:
            missing.append(name)  # an older run does not hold it; what it holds is told all the same
            continue
        total = quantity.combined([[c[k] for k in chosen] for c in columns])
        series[name] = {"unit": quantity.unit, "values": [float(f"{v:.6g}") for v in total]}
    text = f"{len(series)} quantities at {len(chosen)} of the frames {first} to {last}"
    then = f"frames=[{first}, {min(last, first + MAX_SAMPLES - 1)}] shows every frame" if step > 1 else ""
    if missing:
        text += f"; this run holds no {', '.join(missing)}: probe_sim writes them anew"
    return answer({**head, "frames": chosen, "step": step, "records": series}, text, then)


def _events(candidate: Candidate, names: set[str], first: int, last: int) -> list[dict[str, Any]]:
    found = []
    for cache in candidate.rigid_caches.values():
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
                        "point": rounded(data["event/point"][k], 4),
                        "speed": round(float(data["event/speed"][k]), 4),
                        "impulse": round(float(data["event/impulse"][k]), 7),
                    }
                )
    return found
