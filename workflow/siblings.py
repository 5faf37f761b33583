"""Other worlds of a prompt whose rows failed: starting anew beside them is told like any other way around them (R157)."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from ..worlds.by_claim import easier_by_claim
from ..worlds.errors import EvidenceError, WorldAgentError
from ..worlds.folder import WorldFolder, world_ids
from ..worlds.kinds_said import said_of
from ..worlds.ledger import Ledger
from ..worlds.likeness import ALIKE, likeness
from ..worlds.patch import parse_spec
from ..worlds.spec import WorldSpec
from .repair_rules import failed

__all__ = ["easier_beside", "started_anew"]

MAX_NAMED = 5
MOST_COMPARED = 10
"""Own choice: failed worlds with which a world is compared, those first that changed last."""
MOST_LINES = 8
"""Lines about one of them; the rest is counted."""


class _Sibling(NamedTuple):
    world: str
    alike: float
    """Share of its prompt that is the same, see `likeness`."""
    ledger: Ledger | None
    """None where it is damaged."""
    changed: float
    """When its ledger was written last [s since 1970]."""
    judged: bool = True
    """False if no row of it failed, and its frames were looked at and never judged."""


def _with_evidence(workspace: Path, world: str, prompt: str) -> Iterator[_Sibling]:
    """Other worlds of nearly the same prompt in which a row failed, or whose frames were looked at and never judged."""
    for other in world_ids(workspace):
        try:
            folder = WorldFolder.of(workspace, other)
            if other == world or not folder.ledger_path.exists():
                continue
            alike = likeness(prompt, str(json.loads(folder.spec_path.read_text()).get("prompt", "")))
            changed = folder.ledger_path.stat().st_mtime
        except (OSError, ValueError, RecursionError, AttributeError, WorldAgentError):
            continue
        if not alike:
            continue
        try:
            ledger = Ledger(folder.ledger_path)
            fails = ledger.ever_failed()
            if fails or ledger.looks():
                yield _Sibling(other, alike, ledger, changed, fails)
        except EvidenceError:
            yield _Sibling(other, alike, None, changed)


def started_anew(workspace: Path, world: str, prompt: str) -> list[str]:
    """A line about the worlds of nearly the same prompt that hold evidence against it; none where there are none."""
    siblings = list(_with_evidence(workspace, world, prompt))
    failed = {s.world if s.ledger is not None else f"{s.world} (its ledger is damaged)": s.alike for s in siblings}
    exact = all(alike == 1.0 for alike in failed.values())
    least = min(failed.values(), default=0.0)
    near = (
        f"a prompt that is at least {100 * least:.0f} % the same"
        if least >= ALIKE
        else "a prompt that stands in this one, or holds it"
    )
    prompt_text = "this prompt" if exact else near
    seen = "frames were seen without a verdict"
    if len(failed) <= 1:
        what = "rows failed" if all(s.judged for s in siblings) else seen
        return [f"started anew beside world {other}, in which {what} for {prompt_text}" for other in failed]
    what = "rows failed" if all(s.judged for s in siblings) else f"rows failed or {seen}"
    names = ", ".join(list(failed)[:MAX_NAMED]) + (", ..." if len(failed) > MAX_NAMED else "")
    return [f"started anew beside {len(failed)} worlds in which {what} for {prompt_text}: {names}"]


def easier_beside(workspace: Path, world: str, spec: WorldSpec) -> list[str]:
    """Where a world asks less than those of nearly the same prompt that failed, or were looked at and never judged, by claim.

    A line each, that names the other world.
    """
    siblings = sorted(_with_evidence(workspace, world, spec.prompt), key=lambda s: -s.changed)
    found = []
    for sibling in siblings[:MOST_COMPARED]:
        try:
            revision, before = _as_it_failed(sibling.ledger)
            lines = easier_by_claim(before, spec, _said_of(sibling.ledger))
        except (WorldAgentError, ValueError):  # what cannot be read as a world either
            found.append(f"not compared with world {sibling.world}: its ledger is damaged")
            continue
        why = "whose rows failed" if sibling.judged else "of which frames were seen without a verdict"
        told = f"easier than revision {revision} of world {sibling.world}, {why}: "
        found += [told + line for line in lines[:MOST_LINES]]
        if len(lines) > MOST_LINES:
            found.append(f"{told}and {len(lines) - MOST_LINES} more")
    if len(siblings) > MOST_COMPARED:
        found.append(f"not compared with {len(siblings) - MOST_COMPARED} further worlds of this prompt")
    return found


def _said_of(ledger: Ledger | None) -> set[str]:
    """Entities of a world on which a row failed, as it was judged last, that their roles ask."""
    return set() if ledger is None else said_of(r for r in ledger.rows() if r.mandatory and failed(r))


def _as_it_failed(ledger: Ledger | None) -> tuple[int, WorldSpec]:
    """The first revision at which a row failed, or was looked at, and that has claims, else the first of these; and its specification.

    A later one may have been made easier already; a row may fail before the prompt is claimed.
    """
    if ledger is None:
        raise EvidenceError("it is damaged")
    latest = ledger.revision()
    revisions = ledger.failed_revisions() or [int(look["revision"]) for look in ledger.looks()] or [latest]
    texts = ((n, ledger.revision_spec(n)) for n in dict.fromkeys((*revisions, latest)))
    known = [(n, text[0]) for n, text in texts if text is not None]
    if not known:
        raise EvidenceError("it holds no revision")
    number, text = next(((n, t) for n, t in known if json.loads(t).get("claims")), known[0])
    return number, parse_spec(json.loads(text))
