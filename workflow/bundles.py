"""Acceptance bundles of worlds: what goes into one, and how a candidate is judged for it (R120, R121, R123)."""

from __future__ import annotations

import json
import secrets
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..worlds.audits.clauses import clauses_of
from ..worlds.bundle import WrittenBundle, json_bytes, write_bundle
from ..worlds.cache import Cache
from ..worlds.candidate import open_candidate
from ..worlds.canonical import canonical_json, spec_digest
from ..worlds.categories.derived import DERIVED
from ..worlds.claims import prompt_record
from ..worlds.environment import environment
from ..worlds.errors import EvidenceError, RefusedError
from ..worlds.folder import WorldFolder, safe_join
from ..worlds.ledger import Ledger
from ..worlds.patch import parse_spec
from ..worlds.plates import files_of
from ..worlds.spec import WorldSpec, prompt_digest
from ..worlds.verdicts import verdict_words

__all__ = ["HEAD", "bundle_world", "candidate_members", "history_of", "judged", "make_bundle", "remember_refuted"]

ABOUT = "Everything that a verdict about one simulated world rests on. Check it anywhere: worldagent verify FILE"
HEAD = ("verdict", "stage", "freeze", "spec_digest", "prompt_digest", "cache_digest", "environment", "versions")
"""Fields of the verdict that the manifest repeats."""
INLINE_BYTES = 200_000_000
"""Caches up to this size travel in the bundle unless told otherwise; larger ones by digest [bytes]."""


def judged(folder: WorldFolder, ledger: Ledger, *, seed: int | None = None) -> dict[str, Any]:
    """The record of a fresh judgement; what the matrix knows where there is no complete bake to judge (R121).

    Raises:
        EvidenceError: `world.json` itself cannot be read.
    """
    from ..verifiers.acceptance import judge_fresh
    from .plates import plates_anywhere

    plates_anywhere(folder.root)
    try:
        record = judge_fresh(folder.root, seed=secrets.randbelow(2**31) if seed is None else seed)
        record["stage"] = "full"
        remember_refuted(ledger, record)
    except (RefusedError, EvidenceError) as error:
        record = _open_record(folder, ledger, str(error).replace(f"{folder.root}/", ""))
    record["weakenings"] = ledger.weakenings()
    return record


def remember_refuted(ledger: Ledger, record: Mapping[str, Any]) -> None:
    """Keep what a replay found wrong: later judgements of the same cache draw other intervals, and it must not pass by that."""
    replayed: dict[str, Any] = next((r["evidence"] for r in record["rows"] if r["id"] == "delivery:replay"), {})
    known = replayed.get("earlier", [])
    bad = [i for i in replayed.get("intervals", []) if not i["identical"]]
    fresh = [i for i in bad if not any(k["solver"] == i["solver"] and k["frames"] == i["frames"] for k in known)]
    if fresh:
        ledger.add_refuted(str(record["freeze"]), str(record["cache_digest"]), fresh)


def _open_record(folder: WorldFolder, ledger: Ledger, reason: str) -> dict[str, Any]:
    from ..simulation.freeze import engine_versions
    from ..verifiers.acceptance import find_candidate
    from ..verifiers.delivery.bundle import event_list

    spec = parse_spec(folder.read_json(folder.spec_path))
    stage, freeze, digest, events = "static", "", "", None
    try:
        freeze = find_candidate(folder, spec)
        probed = open_candidate(folder, freeze, "probe")
        digest, stage, events = probed.digest, "probe", event_list(probed)
    except (RefusedError, EvidenceError):
        pass
    return {
        "verdict": "incomplete",
        "stage": stage,
        "reason": reason,
        "freeze": freeze,
        "cache_digest": digest,
        "spec_digest": spec_digest(spec),
        "prompt_digest": prompt_digest(spec.prompt),
        "rows": [r.model_dump(mode="json") for r in ledger.rows()],
        "clauses": {
            k: {"text": t, "unmet": spec.clauses[k].unmet if k in spec.clauses else None}
            for k, t in (clauses_of(spec.prompt) if spec.spec_version == "1" else {}).items()
        },
        **({"prompt": {**prompt_record(spec), "read_by": "nobody"}} if spec.spec_version == "2" else {}),
        "approximations": [],
        "versions": engine_versions(),
        "environment": environment(),
        "replayed": False,
        "seed": None,
        "events": events,
    }


def history_of(ledger: Ledger, last: int) -> dict[str, Any]:
    """Every revision up to `last` with its specification, oldest first, the iterations of repair, and since when there is evidence."""
    revisions = []
    for item in (r for r in reversed(ledger.revisions(limit=ledger.revision())) if r["n"] <= last):
        found = ledger.revision_spec(item["n"])
        if found is None:
            raise EvidenceError(f"revision {item['n']} is missing from the ledger; its history cannot be told")
        revisions.append({**item, "spec": json.loads(found[0])})
    iterations = [i for i in reversed(ledger.iterations(limit=10**6)) if i["revision"] <= last]
    return {"revisions": revisions, "iterations": iterations, **ledger.judged_since()}


def _judged_revision(folder: WorldFolder, ledger: Ledger, record: Mapping[str, Any]) -> tuple[WorldSpec, int]:
    """The specification that a verdict is about, and its revision: the world may have been edited since.

    Raises:
        EvidenceError: there is none.
    """
    for item in ledger.revisions(limit=max(1, ledger.revision())):
        found = ledger.revision_spec(item["n"]) if item["digest"] == record["spec_digest"] else None
        if found is not None:
            return parse_spec(json.loads(found[0])), int(item["n"])
    spec = parse_spec(folder.read_json(folder.spec_path))
    if spec_digest(spec) != record["spec_digest"]:
        raise EvidenceError("world.json changed while it was judged, and no revision holds what was; repeat the call")
    return spec, ledger.revision()


def candidate_members(
    root: Path, spec: WorldSpec, freeze: str, stage: str, record: Mapping[str, Any] | None, *, with_caches: bool
) -> dict[str, Path]:
    """Files of a world folder that a bundle of this candidate holds, by member name: exactly these and no others.

    Args:
        root: the world folder.
        spec: its specification.
        freeze: of the candidate; empty where nothing was simulated.
        stage: `static`, `probe` or `full`.
        record: the candidate's `candidate.json`; None where nothing was simulated.
        with_caches: whether the frames are among them.
    """
    from ..simulation.origins import checkpoint_path
    from ..worlds.bake_plan import checkpoint_frames
    from ..worlds.coarsening import OVERRIDES, read_overrides
    from ..worlds.probe_length import probe_frames

    files = {s.shape.file for e in spec.entities.values() for s in e.parts.values() if s.shape.kind == "mesh" and s.shape.file}
    chosen = [p for p in (safe_join(root / "assets", file) for file in sorted(files)) if p.is_file()]
    if record is not None:
        folder = WorldFolder(root).candidate(freeze)
        chosen += [folder / "candidate.json", *(safe_join(root, str(file)) for file, _ in record["built"].values())]
        frames = {"full": spec.simulation.frames, "probe": probe_frames(spec), "static": 0}[stage]
        for name in spec.simulation.solvers if frames else ():
            cache = Cache(folder / ("bake" if stage == "full" else "probe") / name)
            if stage == "probe" and read_overrides(folder / "probe"):
                chosen.append(folder / "probe" / OVERRIDES)
            chosen += [cache.folder / "index.json", cache.folder / "digests.txt"]
            chosen += [checkpoint_path(cache.folder, k) for k in checkpoint_frames(spec, frames)]
            chosen += [cache.path(k) for k in range(frames)] if with_caches else []
            chosen += [path for made in DERIVED for path in made(cache).present()] if with_caches else []
        chosen += files_of(folder / "plates") if stage == "full" else []
    return {f"world/{p.resolve().relative_to(root.resolve()).as_posix()}": p for p in chosen}


def make_bundle(
    folder: WorldFolder, ledger: Ledger, record: Mapping[str, Any], *, with_caches: bool | None = None, out: Path | None = None
) -> WrittenBundle:
    """Write the bundle of a judged candidate.

    Args:
        folder: the world.
        ledger: its ledger, for the history.
        record: what `judged` returned, or acceptance.
        with_caches: whether the frames travel along; default if they are not too large.
        out: the file; default `acceptance/<freeze>.zip` of the world.

    Raises:
        EvidenceError: something that the verdict rests on is missing.
        LimitError: the bundle would be too large.
    """
    spec, last = _judged_revision(folder, ledger, record)
    freeze, stage = str(record["freeze"]), str(record.get("stage", "full"))
    known = folder.read_json(folder.candidate(freeze) / "candidate.json") if freeze else None
    files = candidate_members(folder.root, spec, freeze, stage, known, with_caches=True)
    missing = [name for name, path in files.items() if not path.is_file()]
    if missing:
        raise EvidenceError(f"{missing[:5]} are missing from the world folder; call bake_sim, then judge again")
    frames = {n: p for n, p in files.items() if p.suffix == ".npz" and p.parent.name != "plates"}
    caches = sum(p.stat().st_size for p in frames.values()) <= INLINE_BYTES if with_caches is None else with_caches
    verdict = {**record, "stage": stage, "weakenings": [w for w in ledger.weakenings() if w["revision"] <= last]}
    events = verdict.pop("events", None)
    members: dict[str, bytes | Path] = {
        "verdict.json": json_bytes(verdict),
        "history.json": json_bytes(history_of(ledger, last)),
        "events.json": json_bytes(events),
        "world/world.json": canonical_json(spec),
        **{n: p for n, p in files.items() if caches or n not in frames},
    }
    head = {"about": ABOUT, "says": verdict_words(verdict), "caches": "included" if caches else "by digest"}
    head |= {k: verdict[k] for k in HEAD}
    name = f"{freeze[:16] or 'unsimulated'}.zip"
    return write_bundle(out or folder.acceptance / name, head, members)


def bundle_world(
    root: Path, *, out: Path | None = None, with_caches: bool | None = None, seed: int | None = None
) -> dict[str, Any]:
    """Judge a world folder now and write its bundle: `worldagent bundle`. Incomplete candidates are marked as such.

    Raises:
        EvidenceError: there is no ledger, so that no history can be told.
    """
    folder = WorldFolder.at(root)
    if not folder.ledger_path.is_file():
        raise EvidenceError(f"{folder.id!r} has no ledger.sqlite; a bundle tells the history of a world")
    ledger = Ledger(folder.ledger_path)
    record = judged(folder, ledger, seed=seed)
    written = make_bundle(folder, ledger, record, with_caches=with_caches, out=out)
    return {
        "verdict": record["verdict"],
        "says": verdict_words(record),
        **({"reason": record["reason"]} if "reason" in record else {}),
        "bundle": str(written.path),
        "digest": written.digest,
        "bytes": written.size,
        "next": "worldagent verify BUNDLE, on any machine",
    }
