"""The first revision of a world, and what follows an edit of world.json outside the server."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..worlds.canonical import spec_digest
from ..worlds.claim_marks import claim_operations
from ..worlds.documents import bare_document
from ..worlds.errors import EvidenceError, InputError, RefusedError
from ..worlds.folder import WorldFolder, world_ids
from ..worlds.ledger import Ledger
from ..worlds.limits import check_cap, check_limits, check_workspace
from ..worlds.patch import apply_patch, parse_edit, parse_spec, weakenings
from .opened import no_revision
from .session import Session
from .siblings import started_anew

__all__ = ["copy", "create", "mend_hand_edit"]

NO_CLAUSES = (
    "clauses are of spec_version '1', of which no world is made any more: leave them and spec_version out, and mark what the words of the prompt mean: "
    "edit_spec(world, prompt, spec, claims='A [ball](thing ball) [rolls off](event roll) the [table](thing table).'); without claims the reply proposes spans"
)

ANEW = "a new world for a prompt whose earlier world has failed rows"
"""Reason of a first revision beside failed worlds of its prompt; without them it needs none."""


def create(
    workspace: Path, world: str, prompt: str, spec: dict[str, Any], claims: str | None = None, *, weaker: Sequence[str] = ()
) -> tuple[Session, dict[str, Any]]:
    """Make a world from a prompt and a part of its specification; the world, and its revision for the reply.

    Args:
        workspace: where worlds are.
        world: its id.
        prompt: of the user.
        spec: the specification without it, or a part.
        claims: the prompt, marked.
        weaker: what it asks less than the world that it is a copy of, a line each.

    Raises:
        RefusedError: there is such a world already.
        InputError: the specification does not validate, is of version 1, or holds another prompt.
    """
    folder = WorldFolder.of(workspace, world, create=True)
    if folder.spec_path.exists():
        raise RefusedError(f"world {world!r} exists already; edit it with patch, or choose another id for another prompt")
    if "prompt" in spec and spec["prompt"] != prompt:
        raise InputError("spec.prompt differs from prompt; leave it out of spec")
    if spec.get("clauses") or spec.get("spec_version", "2") == "1":
        raise InputError(NO_CLAUSES)
    document = {"spec_version": "2", "title": world.replace("_", " "), "simulation": {"frames": 96}, **spec, "prompt": prompt}
    parsed = parse_edit(document)
    if claims is not None:
        parsed = apply_patch(parsed, claim_operations(claims, parsed))
    check_limits(parsed)
    check_cap("worlds", len(world_ids(workspace)) + 1, what="this workspace")
    check_workspace(workspace, len(parsed.model_dump_json()))
    folder.root.mkdir(parents=True, exist_ok=True)
    folder.assets.mkdir(exist_ok=True)
    siblings = [*started_anew(workspace, world, prompt), *weaker]
    session = Session(folder, Ledger(folder.ledger_path), parsed, 1)
    with session.step():
        number = session.ledger.add_revision(
            parsed.model_dump_json(exclude_none=True),
            spec_digest(parsed),
            expected=0,
            hypothesis="created",
            weakenings=siblings,
            reason=ANEW if siblings else "",
        )
        if number is None:
            if not folder.spec_path.exists():
                raise RefusedError(
                    f"world {world!r} has a ledger but no world.json (its creation was cut short, or the file was deleted); "
                    "call edit_spec with on_hand_edit='restore', then edit it with patch"
                )
            raise RefusedError(f"world {world!r} was created by another client meanwhile; choose another id")
        session.write_spec()
    beside = {"weakenings_recorded": siblings} if siblings else {}
    return session, {"revision": session.revision, "created": True, **beside}


def copy(
    workspace: Path, world: str, source: str, prompt: str | None, patch: list[dict[str, Any]], claims: str | None
) -> tuple[Session, dict[str, Any]]:
    """Make a world that begins with the present specification of another one, changed by a patch, and with its assets.

    Its history is its own: what failed in the other stays on record by the prompt (`started_anew`), and what the patch asks less after
    evidence is a weakening here too. Claims quote the prompt, so that they come along only where it is the same.

    Raises:
        RefusedError: there is such a world already, or the other is of version 1.
        InputError: there is no world `source`, or the changed specification does not validate.
    """
    other = Session.open(workspace, source)
    after = apply_patch(other.spec, patch) if patch else other.spec
    document = dict(bare_document(after))
    said = document.pop("prompt")
    if other.spec.spec_version == "1":
        raise RefusedError(f"world {source!r} is of version 1, of which no world is made any more; mark its claims there")
    same = prompt is None or prompt == said
    if not same:
        document.pop("claims", None)
    kept = [p for p in other.folder.assets.rglob("*") if p.is_file()] if other.folder.assets.is_dir() else []
    check_workspace(workspace, sum(p.stat().st_size for p in kept))
    tried = other.ledger.ever_failed() or other.ledger.looks()
    weaker = [f"copied from {source} with {line}" for line in weakenings(other.spec, after)] if same and tried else []
    session, told = create(workspace, world, said if prompt is None else prompt, document, claims, weaker=weaker)
    for path in kept:
        to = session.folder.assets / path.relative_to(other.folder.assets)
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, to)
    left = {} if same else {"left_out": "claims, which quote the other prompt"}
    return session, {**told, "copied": f"revision {other.revision} of {source}", **left}


def mend_hand_edit(workspace: Path, world: str, action: str, *, hypothesis: str, reason: str) -> tuple[Session, dict[str, Any]]:
    """Adopt or restore a `world.json` that was edited outside the server; the world, and its revision for the reply.

    Raises:
        EvidenceError: the ledger holds no revision.
        RefusedError: the file holds another prompt, or another client changed the world meanwhile.
    """
    # world.json itself may be what was deleted.
    folder = WorldFolder.of(workspace, world, create=True)
    if not folder.ledger_path.is_file():
        folder = WorldFolder.of(workspace, world)
    ledger = Ledger(folder.ledger_path)
    revision = ledger.revision()
    recorded = ledger.revision_spec(revision)
    if recorded is None:
        raise EvidenceError(no_revision(folder))
    before = parse_spec(json.loads(recorded[0]))
    session = Session(folder, ledger, before, revision)
    if action == "restore":
        with session.step():
            if ledger.revision() != revision:
                raise RefusedError(f"another client changed {world!r} meanwhile; read it again with inspect_world")
            session.write_spec()
        return session, {"revision": session.revision, "restored": True}
    now = parse_edit(folder.read_json(folder.spec_path))
    if now.prompt != before.prompt:
        raise RefusedError("world.json holds another prompt; the prompt is immutable. Use on_hand_edit='restore'")
    check_limits(now)
    if spec_digest(now) == recorded[1]:
        return session, {"revision": session.revision, "unchanged": True}
    outcome = session.commit(now, patch=[{"op": "adopt"}], hypothesis=hypothesis, weakening_reason=reason)
    return session, outcome
