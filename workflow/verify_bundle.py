"""`worldagent verify` of an acceptance bundle: open it anywhere, judge it anew, and compare with what it claims.

On the machine class and versions that made it, everything is compared to the byte: geometry is built again, and the start
and randomly chosen intervals of the motion (all of it where the frames are held by digest) are simulated again. Elsewhere
bytes differ by nature: the whole world is built and simulated by this installation, that motion is judged, and the bundled
one may depart from it by `REPLAY_TOLERANCE` within a replayed interval.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..worlds.audits.audit import audit
from ..worlds.bundle import Bundle, open_bundle
from ..worlds.candidate import open_candidate, recorded_inputs
from ..worlds.canonical import spec_digest
from ..worlds.environment import environment
from ..worlds.errors import EngineError, EvidenceError, WorldAgentError
from ..worlds.folder import WorldFolder
from ..worlds.limits import check_limits
from ..worlds.patch import parse_spec
from ..worlds.plates import Plates, plates_folder
from ..worlds.spec import WorldSpec
from ..worlds.verdicts import prompt_told, unusual_told, verdict_words
from .bundles import HEAD, candidate_members
from .plates import depart, plates_anywhere

__all__ = ["REPLAY_TOLERANCE", "Verification", "untrue_geometry", "verify_bundle"]

REPLAY_TOLERANCE = 1e-3
"""Largest departure of positions within one replayed interval on another machine class or version [m]; own choice (S14).
An interval of 0.5 s lets rounding grow through some tens of contacts; a motion made up departs by more."""
EXACT = ("verdict", "freeze", "subject", "cache_digest", "spec_digest", "prompt_digest", "clauses", "approximations", "versions")
"""Fields of the verdict that equal bytes must give again."""
RETIRED = frozenset({"audit:clauses"})
"""Rows of bundles of version 1 that nothing asks any more."""
ELSEWHERE = ("verdict", "spec_digest", "prompt_digest", "clauses")
"""Fields that must agree even where bytes cannot."""


@dataclass
class Verification:
    """Problems and findings of a verification."""

    bundle: Bundle
    record: dict[str, Any]
    problems: list[str] = field(default_factory=list)
    """Why the bundle is not what it says, or not proven."""
    differences: list[dict[str, Any]] = field(default_factory=list)
    """Rows and fields on which the bundle and this installation do not agree."""
    other: list[str] = field(default_factory=list)
    """Differences of the maker's environment from this one."""
    own: dict[str, Any] | None = None
    """This installation's own judgement."""

    @property
    def verdict(self) -> str:
        """`accepted` only if this installation accepts, the bundle claims it, and nothing at all is amiss."""
        if self.problems:
            return "refused"
        accepted = self.own is not None and self.own["verdict"] == "accepted" == self.record.get("verdict")
        return "accepted" if accepted and not self.differences else "incomplete"


def verify_bundle(path: Path, *, seed: int, intervals: int, report: Path | None = None) -> dict[str, Any]:
    """Check a bundle; returns what to print.

    Args:
        path: the bundle.
        seed: chooses the replayed intervals.
        intervals: how many of each solver instance; more than there are means all.
        report: where to write the matrix report of this judgement, as HTML.

    Raises:
        InputError: the path is no bundle at all.
    """
    from .matrix_report import write_report

    try:
        bundle = open_bundle(path)
        found = Verification(bundle, _mapping(bundle.json("verdict.json"), "verdict.json"))
    except EvidenceError as error:
        return {"verdict": "refused", "says": "refused", "bundle": path.name, "problems": [str(error)], "seed": seed}
    with tempfile.TemporaryDirectory(prefix="worldagent-") as temporary:
        try:
            root = bundle.extract(Path(temporary))
            _check(found, root, seed=seed, intervals=intervals)
            if report is not None and found.own is not None:
                told: dict[str, Any] = {k: found.record[k] for k in ("weakenings", "easier_beside") if k in found.record}
                shown = {**found.own, "verdict": found.verdict, **told}
                amiss = [*found.problems, *(json.dumps(d, default=str) for d in found.differences)]
                write_report(report, WorldFolder(root), shown, problems=amiss)
        except (WorldAgentError, KeyError, IndexError, TypeError, ValueError, AttributeError) as error:
            # Written by a stranger: whatever shape it has instead of the right one, it is not accepted.
            found.problems.append(f"cannot be checked: {type(error).__name__}: {error}")
    return _report(found, seed)


def _mapping(value: Any, name: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise EvidenceError(f"member {name!r} is no record")
    return value


def _report(found: Verification, seed: int) -> dict[str, Any]:
    own = found.own or {}
    rows = own.get("rows", [])
    return {
        "verdict": found.verdict,
        "bundle": found.bundle.path.name,
        "digest": found.bundle.digest,
        "bundled_verdict": found.record.get("verdict"),
        "own_verdict": own.get("verdict"),
        "problems": found.problems,
        "differences": found.differences[:50],
        "other_environment": found.other,
        "rows": {s: sum(r["status"] == s for r in rows) for s in ("pass", "fail", "unverified", "not_applicable")},
        "failing": [r["id"] for r in rows if r["mandatory"] and r["status"] in ("fail", "unverified")],
        "bundled_failing": [r.get("id") for r in _open_rows(found.record)],
        "says": verdict_words({**own, "verdict": found.verdict}),
        **unusual_told(own),
        **prompt_told(own),
        "weakenings": found.record.get("weakenings", []),
        "easier_beside": found.record.get("easier_beside", []),
        "approximations": own.get("approximations", []),
        "reviews": found.record.get("reviews", []),
        "replayed": next((r["evidence"].get("intervals") for r in rows if r["id"] == "delivery:replay"), []),
        "seed": seed,
    }


def _replayed(record: Mapping[str, Any], key: str) -> Any:
    """Field of a record without who read the prompt: that cannot be replayed."""
    value = record.get(key)
    return {k: v for k, v in value.items() if k != "read_by"} if key == "prompt" and isinstance(value, Mapping) else value


def _open_rows(record: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Rows that the bundle itself calls open: what is left to do about an incomplete candidate."""
    rows = [r for r in record.get("rows") or () if isinstance(r, dict)]
    return [r for r in rows if r.get("mandatory") and r.get("status") in ("fail", "unverified")]


def _check(found: Verification, root: Path, *, seed: int, intervals: int) -> None:
    from ..verifiers.acceptance import judge_fresh

    folder = WorldFolder(root)
    record = found.record
    spec = parse_spec(folder.read_json(folder.spec_path))
    check_limits(spec)
    if not audit(spec).passed:
        found.problems.append("the specification does not pass the audit")
        return
    known = _check_inside(found, folder, spec)
    if record["stage"] != "full" or known is None:
        found.differences.append({"field": "stage", "bundled": record["stage"], "differs": "no complete bake: nothing to judge"})
        return
    same = _compare_environment(found, known)
    if found.problems:
        return
    if same:
        for name in untrue_geometry(folder, spec, known):
            found.problems.append(f"the built geometry of {name!r} is not what the specification gives")
        if found.bundle.manifest["caches"] == "by digest":
            _bake_again(found, folder, str(record["freeze"]))
        _look_again(found, folder, str(record["freeze"]), seed)
    else:
        if found.bundle.manifest["caches"] == "included":
            _replay_elsewhere(found, folder, str(record["freeze"]), seed, intervals)
        _make_anew(folder, spec)
    # What was made here is what it is about; else the bundle's own word, which every replayed interval is held against.
    about = str(record["cache_digest"]) if same else open_candidate(folder, _freeze_here(folder, spec), "full").digest
    found.own = judge_fresh(root, seed=seed, intervals=intervals, recorded=about)
    _compare_verdicts(found, exact=same)


def _check_inside(found: Verification, folder: WorldFolder, spec: WorldSpec) -> dict[str, Any] | None:
    """Check that the bundle agrees with itself; returns the candidate's record."""
    from ..simulation.freeze import freeze_hash
    from ..verifiers.delivery.bundle import compare_history

    record, manifest, say = found.record, found.bundle.manifest, found.problems.append
    for key in HEAD:
        if manifest.get(key) != record.get(key):
            say(f"manifest and verdict differ in {key}")
    if manifest.get("says", verdict_words(record)) != verdict_words(record):
        say("the manifest says another verdict in words than the record")
    if (
        hashlib.sha256(folder.spec_path.read_bytes()).hexdigest() != record["spec_digest"]
        or spec_digest(spec) != record["spec_digest"]
    ):
        say("world.json is not the specification of the verdict")
    history = found.bundle.json("history.json")
    found.problems += compare_history(history, record["spec_digest"])
    told = [
        {"revision": r["n"], "weakenings": r["weakenings"], "reason": r["reason"]}
        for r in history["revisions"]
        if r["weakenings"]
    ]
    if told != record["weakenings"]:
        say("the weakenings of the verdict are not those of the history")
    freeze = str(record["freeze"])
    known = _mapping(folder.read_json(folder.candidate(freeze) / "candidate.json"), "candidate.json") if freeze else None
    caches = manifest["caches"] == "included"
    wanted = candidate_members(folder.root, spec, freeze, record["stage"], known, with_caches=caches)
    extra = sorted(n for n in manifest["members"] if n.startswith("world/") and n not in {*wanted, "world/world.json"})
    missing = sorted(set(wanted) - set(manifest["members"]))
    if extra or missing:
        say(f"the candidate has other members: missing {missing[:5]}, extra {extra[:5]}")
    if known is None or found.problems:
        return known
    if known["freeze"] != freeze or spec_digest(parse_spec(known["spec"])) != record["spec_digest"]:
        say("candidate.json is of another candidate")
    if known["versions"] != record["versions"]:
        say("candidate.json and the verdict name other engine versions")
    built = open_candidate(folder, freeze, record["stage"]).built if record["stage"] != "static" else {}
    if freeze_hash(spec, built, source=str(known["source"]), versions=dict(known["versions"])) != freeze:
        say("specification, geometry, solver source and engine versions do not hash to the freeze")
    return known


def _compare_environment(found: Verification, known: Mapping[str, Any]) -> bool:
    """True if equal bytes are to be expected here; notes every difference."""
    from ..simulation.freeze import engine_versions, solver_source

    here: dict[str, Any] = {**environment(), **engine_versions(), "solver source": solver_source()[:16]}
    there: dict[str, Any] = {**found.record["environment"], **known["versions"], "solver source": str(known["source"])[:16]}
    found.other = [
        f"{k}: {there.get(k)} there, {here.get(k)} here" for k in sorted({*here, *there}) if here.get(k) != there.get(k)
    ]
    deciding = {"device", "solver source", *engine_versions(), *known["versions"]}
    return all(here.get(k) == there.get(k) for k in deciding)


def untrue_geometry(folder: WorldFolder, spec: WorldSpec, known: Mapping[str, Any]) -> list[str]:
    """Entities whose recorded geometry is not what this installation builds from the specification."""
    from ..construction import build_entity

    recorded = {name: str(digest) for name, (_, digest) in known["built"].items()}
    wrong = [n for n in spec.entities if n in recorded and build_entity(spec, n, folder.assets).digest() != recorded[n]]
    return wrong + sorted(set(recorded) ^ set(spec.entities))


def _bake_again(found: Verification, folder: WorldFolder, freeze: str) -> None:
    """Simulate the whole motion, whose frames the bundle holds by digest only, and compare with its digests."""
    from ..simulation.schedule import run_frames
    from ..worlds.cache import Cache

    spec, built = recorded_inputs(folder, freeze)
    bake = folder.candidate(freeze) / "bake"
    kept = bake.with_name("bundled")
    bake.rename(kept)
    run_frames(spec, built, bake, frames=spec.simulation.frames, reuse=False)
    for name in spec.simulation.solvers:
        there, here = Cache(kept / name), Cache(bake / name)
        pairs = enumerate(zip(there.digests(), here.digests(), strict=False))
        frame = next((k for k, (a, b) in pairs if a != b), None)
        if there.index != here.index or len(there.digests()) != len(here.digests()):
            found.problems.append(f"the cache of {name!r} has another index or length than this simulation gives")
        if frame is not None:
            found.problems.append(f"frame {frame} of {name!r}, simulated again, does not give the bundled digest")
        for path in sorted((kept / name / "checkpoints").iterdir()):
            if path.read_bytes() != (bake / name / "checkpoints" / path.name).read_bytes():
                found.problems.append(f"checkpoint {path.stem} of {name!r}, simulated again, is another")
    shutil.rmtree(kept)


def _replay_elsewhere(found: Verification, folder: WorldFolder, freeze: str, seed: int, intervals: int) -> None:
    """Hold the bundled motion against intervals simulated here from its own checkpoints, within a tolerance."""
    from ..simulation.probe import replay

    for item in replay(open_candidate(folder, freeze, "full"), intervals=intervals, seed=seed):
        apart = item["largest_difference_m"]
        if not item.get("alike", True) or not isinstance(apart, float) or apart > REPLAY_TOLERANCE:
            found.problems.append(
                f"frames {item['frames']} of {item['solver']!r}, simulated here, depart by {apart} m; "
                f"at most {REPLAY_TOLERANCE} m are rounding"
            )


def _make_anew(folder: WorldFolder, spec: WorldSpec) -> None:
    """Replace geometry, candidate and motion by what this installation makes of the specification."""
    from ..construction import build_world, built_paths
    from ..simulation.freeze import open_freeze
    from ..simulation.schedule import run_frames

    for name in ("candidates", "built"):
        shutil.rmtree(folder.root / name)
    built, _ = build_world(folder, spec)
    freeze = open_freeze(folder, spec, built, built_paths(folder, spec), revision=0)
    run_frames(spec, built, folder.candidate(freeze) / "bake", frames=spec.simulation.frames, reuse=False)
    plates_anywhere(folder.root)


def _look_again(found: Verification, folder: WorldFolder, freeze: str, seed: int) -> None:
    """Render one of the bundled plates here: a painted picture has a right digest too."""
    import numpy as np

    candidate = open_candidate(folder, freeze, "full")
    plates = Plates.open(plates_folder(candidate))
    if plates is None or not plates.views or plates.cache != candidate.digest:  # the rows say so
        return
    view = plates.views[int(np.random.default_rng(seed).integers(len(plates.views)))]
    try:
        if depart(candidate, plates, view):
            found.problems.append(f"the plate of {view.subject!r} at frame {view.frame}, rendered here, is another picture")
    except EngineError as error:
        found.problems.append(f"no plate can be rendered here, so that none is proven: {error}")


def _freeze_here(folder: WorldFolder, spec: WorldSpec) -> str:
    from ..verifiers.acceptance import find_candidate

    return find_candidate(folder, spec)


def _compare_verdicts(found: Verification, *, exact: bool) -> None:
    from ..verifiers.delivery.bounds import NOISE, OTHER_MACHINE
    from ..verifiers.delivery.bundle import compare_rows, unequal
    from .review.verdict import not_of_reviews

    record, own = found.record, found.own or {}
    retired = () if "prompt" in own else RETIRED
    rows = [r for r in not_of_reviews(record["rows"]) if not (isinstance(r, Mapping) and r.get("id") in retired)]
    found.differences += compare_rows(rows, own["rows"], exact=exact)
    for key in (*(EXACT if exact else ELSEWHERE), "prompt"):
        theirs, ours = (_replayed(r, key) for r in (record, own))
        if unequal(theirs, ours, relative=NOISE) is not None:
            found.differences.append({"field": key, "bundled": str(record.get(key))[:200], "here": str(own.get(key))[:200]})
    events = found.bundle.json("events.json")
    theirs, ours = (events, own["events"]) if exact else (events["beats"], own["events"]["beats"])
    place = unequal(theirs, ours, relative=NOISE if exact else OTHER_MACHINE)
    if place is not None:
        found.differences.append({"field": "events", "differs": place})
