"""Standing of a world and what of that still holds, read from its ledger alone: nothing is built, run or judged."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

from ..worlds.canonical import spec_digest
from ..worlds.folder import WorldFolder
from ..worlds.ledger import Ledger
from ..worlds.provenance import recipes
from ..worlds.requirements import Row
from ..worlds.spec import WorldSpec

__all__ = ["STAGES", "Standing", "Step", "film_of", "is_about_present", "standing"]

StageName = Literal["specified", "audited", "probed", "frozen", "baked", "accepted", "rendered"]
State = Literal["done", "failed", "stale", "missing"]

STAGES: tuple[StageName, ...] = ("specified", "audited", "probed", "frozen", "baked", "accepted", "rendered")


@dataclass(frozen=True)
class Step:
    """One stage of a world."""

    name: StageName
    state: State
    """`done` and `failed` are about the present specification; `stale` was done for an earlier one; `missing` never was."""
    revision: int | None = None
    at: float | None = None
    """When [UNIX s]."""
    note: str = ""


@dataclass(frozen=True)
class Standing:
    """All stages of a world, in order."""

    steps: tuple[Step, ...]

    @property
    def reached(self) -> StageName | None:
        """The last stage up to which every one is done; None where not even the specification holds."""
        found: StageName | None = None
        for step in self.steps:
            if step.state != "done":
                break
            found = step.name
        return found

    def step(self, name: StageName) -> Step:
        """The step of a stage."""
        return self.steps[STAGES.index(name)]

    def as_data(self) -> dict[str, Any]:
        """As plain data, empty fields left out."""
        return {
            "reached": self.reached,
            "stages": [{k: v for k, v in asdict(s).items() if v not in (None, "")} for s in self.steps],
        }


def standing(folder: WorldFolder, ledger: Ledger, rows: Sequence[Row] | None = None) -> Standing:
    """Where a world stands.

    Args:
        folder: the world.
        ledger: of it.
        rows: its matrix, if it has been read already.
    """
    revision = ledger.revision()
    recorded = ledger.revision_spec(revision)
    if recorded is None:
        return Standing(tuple(Step(name, "missing") for name in STAGES))
    same = _Sameness(ledger, recorded[0])
    specified = Step("specified", "done", revision, ledger.revisions(1)[0]["created"])
    if not _unedited(folder, recorded[0]):
        specified = Step("specified", "stale", revision, specified.at, "world.json was edited outside the server")
    audited = _audited([r for r in (ledger.rows() if rows is None else rows) if r.check == "audit"], revision)
    probed, frozen, freeze = _probed(folder, ledger, same)
    baked = _baked(folder, ledger, freeze, frozen.note)
    accepted, judged = _accepted(ledger, same, baked)
    return Standing((specified, audited, probed, frozen, baked, accepted, _rendered(folder, ledger, same, accepted, judged)))


def is_about_present(ledger: Ledger, accepted: Mapping[str, Any], revision: int | None = None) -> bool:
    """True if an acceptance is about a revision, by default the present one.

    This is the one question that the film's gate, the standing of a world and `inspect_world` ask of its last acceptance: it judged what
    the revision that it names says, and that one says the same of all that an acceptance is about.
    """
    now = ledger.revision_spec(ledger.revision() if revision is None else revision)
    return now is not None and _is_about(ledger, accepted, _Sameness(ledger, now[0]))


def _is_about(ledger: Ledger, accepted: Mapping[str, Any], same: Callable[[str, int], bool]) -> bool:
    judged, told = ledger.revision_spec(accepted["revision"]), accepted["record"].get("spec_digest")
    if judged is None or (told != judged[1] and told != spec_digest(WorldSpec.model_validate_json(judged[0]))):
        return False  # its record is about another specification than the revision it is filed under
    return same("acceptance", accepted["revision"])


def film_of(folder: WorldFolder) -> Path | None:
    """The newest film of a world."""
    films = sorted(folder.root.glob("candidates/*/final/final.*"), key=lambda p: p.stat().st_mtime)
    return films[-1] if films else None


class _Sameness:
    """Comparison of artifacts of earlier revisions with what the present specification would give."""

    def __init__(self, ledger: Ledger, text: str) -> None:
        self._ledger, self._now = ledger, text

    def __call__(self, artifact: str, revision: int) -> bool:
        then = self._ledger.revision_spec(revision)
        if then is None:
            return False
        return then[0] == self._now or _recipes(then[0]).get(artifact) == _recipes(self._now).get(artifact)


@lru_cache(maxsize=32)
def _recipes(text: str) -> Mapping[str, str]:
    return recipes(WorldSpec.model_validate_json(text))


def _unedited(folder: WorldFolder, recorded: str) -> bool:
    """True if `world.json` is the recorded specification; an earlier version may have written it without newer fields."""
    try:
        text = folder.spec_path.read_text()
        if json.loads(text) == json.loads(recorded):
            return True
        return WorldSpec.model_validate_json(text) == WorldSpec.model_validate_json(recorded)
    except (OSError, ValueError):
        return False


def _audited(rows: Sequence[Row], revision: int) -> Step:
    if not rows:
        return Step("audited", "missing")
    if any(r.evidence.get("stale") for r in rows):
        return Step("audited", "stale")
    unmet = [r.id for r in rows if r.mandatory and r.status in ("fail", "unverified")]
    return Step("audited", "failed" if unmet else "done", revision, note=_some(unmet, "open"))


def _probed(folder: WorldFolder, ledger: Ledger, same: Callable[[str, int], bool]) -> tuple[Step, Step, str | None]:
    """The probe, the freeze that a passed one gives, and its hash."""
    found = ledger.freezes()
    if not found:
        return Step("probed", "missing"), Step("frozen", "missing"), None
    present = [f for f in found if same("motion", f["revision"]) and not _outdated(folder, f["freeze"])]
    if not present:
        last = found[0]
        note = _outdated(folder, last["freeze"]) if same("motion", last["revision"]) else "the motion was changed since"
        frozen = Step("frozen", "stale", note=note) if any(f["passed"] for f in found) else Step("frozen", "missing")
        return Step("probed", "stale", last["revision"], last["at"], note), frozen, None
    last = present[0]
    note = _some(last["detail"].get("failing", []), "open")
    probed = Step("probed", "done" if last["passed"] else "failed", last["revision"], last["at"], note)
    frozen = Step("frozen", "done" if last["passed"] else "missing", last["revision"] if last["passed"] else None)
    return probed, frozen, last["freeze"] if last["passed"] else None


def _outdated(folder: WorldFolder, freeze: str) -> str:
    """Why a freeze cannot be baked here any more although the specification gives the same motion, or nothing."""
    from ..simulation.freeze import engine_versions, solver_source

    try:
        record = json.loads((folder.candidate(freeze) / "candidate.json").read_text())
        made_with = record["versions"], record["source"]
    except (OSError, ValueError, KeyError, TypeError):
        return "its candidate record is missing or damaged"
    return "" if made_with == (engine_versions(), solver_source()) else "made by another version of the engines"


def _baked(folder: WorldFolder, ledger: Ledger, freeze: str | None, why: str) -> Step:
    record = None if freeze is None else ledger.bake(freeze)
    if record is None:
        older = next((b for f in ledger.freezes() if (b := ledger.bake(f["freeze"])) is not None), None)
        if older is None:
            return Step("baked", "missing")
        return Step("baked", "stale", older["revision"], older["at"], why or "the settings were changed since")
    if not (folder.candidate(record["freeze"]) / "bake").is_dir():
        return Step("baked", "stale", record["revision"], record["at"], "its caches are missing")
    unmet = record["detail"].get("failing", [])
    return Step("baked", "failed" if unmet else "done", record["revision"], record["at"], _some(unmet, "open"))


def _accepted(ledger: Ledger, same: Callable[[str, int], bool], baked: Step) -> tuple[Step, dict[str, Any] | None]:
    latest = ledger.acceptance()
    if latest is None:
        return Step("accepted", "missing"), None
    when = latest["revision"], latest["at"]
    if not _is_about(ledger, latest, same):
        return Step("accepted", "stale", *when, "the specification was changed since"), latest
    if baked.state in ("stale", "missing"):
        return Step("accepted", "stale", *when, baked.note or "there is no bake of the present settings"), latest
    bake = ledger.bake(latest["freeze"])
    if bake is None or bake["digest"] != latest["record"].get("cache_digest"):
        return Step("accepted", "stale", *when, "the bake it judged is not the present one"), latest
    unmet = [str(r["id"]) for r in latest["record"].get("rows", []) if r["mandatory"] and r["status"] in ("fail", "unverified")]
    if unmet or latest["verdict"] != "accepted":
        return Step("accepted", "failed", *when, _some(unmet, "open") or str(latest["verdict"])), latest
    return Step("accepted", "done", *when), latest


def _rendered(
    folder: WorldFolder,
    ledger: Ledger,
    same: Callable[[str, int], bool],
    accepted: Step,
    judged: Mapping[str, Any] | None,
) -> Step:
    film = film_of(folder)
    if film is None:
        return Step("rendered", "missing")
    # Rendering begins with frame 0, from the revision of that moment.
    frames = sorted((film.parent / "frames").glob("*"))[:1]
    begun = min(p.stat().st_mtime for p in (*frames, film))
    revision = next((r["n"] for r in ledger.revisions(limit=10_000) if r["created"] <= begun), None)
    when = revision, film.stat().st_mtime
    if accepted.state != "done" or judged is None:
        return Step("rendered", "stale", *when, "the candidate it shows is not accepted now")
    if film.parent.parent.name != str(judged["freeze"])[:16] or revision is None or not same("final", revision):
        return Step("rendered", "stale", *when, "it shows an earlier candidate or look")
    return Step("rendered", "done", *when)


def _some(ids: Sequence[str], word: str) -> str:
    if not ids:
        return ""
    return f"{len(ids)} {word}: {', '.join(ids[:3])}" + (" ..." if len(ids) > 3 else "")
