"""A world as it is opened: its folder, its ledger, the specification of its latest revision."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

from ..worlds.ablation import ENV_ABLATION, ablation, ablation_words
from ..worlds.documents import text_of
from ..worlds.errors import EngineError, EvidenceError, InputError, RefusedError
from ..worlds.folder import WorldFolder, temporary_name, write_atomically
from ..worlds.ledger import Ledger
from ..worlds.patch import parse_spec
from ..worlds.spec import WorldSpec
from .known_specs import KnownSpecs

__all__ = ["OpenedWorld", "no_revision"]

_known = KnownSpecs()


@dataclass
class OpenedWorld:
    """Folder, ledger and specification of one world at one revision."""

    folder: WorldFolder
    ledger: Ledger
    spec: WorldSpec
    revision: int

    @classmethod
    def open(cls, workspace: Path, world: str) -> Self:
        """Open a world.

        Raises:
            InputError: there is no such world.
            RefusedError: `world.json` was edited by hand since the last revision; or an evaluation without some checks made the world.
        """
        return cls.at(WorldFolder.of(workspace, world))

    @classmethod
    def at(cls, folder: WorldFolder) -> Self:
        """Open the world of a folder; errors as `open`."""
        ledger = Ledger(folder.ledger_path)
        _require_same_checks(folder, ledger)
        spec, revision, damage = _latest(folder, ledger)
        if spec is None:
            # Another client may stand between its world.json and its ledger entry; whoever holds the ledger meets none there.
            with suppress(EngineError), ledger.together():  # where nothing can be written, nobody stands there either
                spec, revision, damage = _latest(folder, ledger)
        if spec is not None:
            return cls(folder, ledger, spec, revision)
        raise RefusedError(
            f"world.json of {folder.id!r} was edited outside the server since revision {revision}, or its writing was cut short. "
            f"Call edit_spec with on_hand_edit='adopt' to take it as a new revision, or 'restore' to undo it.{damage}"
        )

    def write_spec(self) -> None:
        """Write `world.json`."""
        text = text_of(self.spec, indent=1)
        write_atomically(self.folder.spec_path, text)
        _known.put(text, text_of(self.spec).decode(), self.spec)

    @contextmanager
    def step(self) -> Iterator[None]:
        """One step of ledger and `world.json`: no other client stands between the two, and a failure undoes both."""
        path = self.folder.spec_path
        kept = temporary_name(path.with_name(f"{path.name}.kept"))
        new = False

        def undo() -> None:
            if kept.exists():
                kept.replace(path)
            elif new:
                path.unlink(missing_ok=True)

        try:
            with self.ledger.together(undo):
                new = not path.exists()
                with suppress(OSError):  # a second name takes no room: a full disk is left as it was
                    os.link(path, kept)
                yield
        finally:
            kept.unlink(missing_ok=True)

    def freeze(self) -> str:
        """Freeze hash of the present specification; geometry that is missing is built."""
        from ..construction import build_world
        from ..simulation.freeze import freeze_hash

        built, _ = build_world(self.folder, self.spec)
        return freeze_hash(self.spec, built)

    def stamp(self) -> str:
        """Identifies this revision of this very world: when it was made."""
        later = max(0, self.ledger.revision() - self.revision)
        return repr(next((r["created"] for r in self.ledger.revisions(1, later)), None))

    def as_asked(self, revision: int | None, stamp: str | None) -> Self:
        """This world at the revision for which a job was asked, from its ledger; without one, as it is.

        Args:
            revision: its number.
            stamp: tells it from the same number of a world that was made anew under this name; none is not compared.

        Raises:
            RefusedError: it is not there any more.
        """
        if revision is None:
            return self
        recorded = None if revision > self.revision else self.ledger.revision_spec(revision)
        found = None if recorded is None else self
        if recorded is not None and revision != self.revision:
            found = replace(self, spec=parse_spec(json.loads(recorded[0])), revision=revision)
        if found is None or stamp not in (None, found.stamp()):
            raise RefusedError(
                f"revision {revision} of world {self.folder.id!r}, for which this was asked, is not there any more: the world was made anew, "
                f"or its ledger was put back, and is at revision {self.revision}. Repeat the call"
            )
        return found


def no_revision(folder: WorldFolder) -> str:
    """Error text for a world whose ledger holds no revision."""
    return (
        f"the ledger of world {folder.id!r} holds no revision (ledger.sqlite is empty, cut off, or new): put back a copy of it, or "
        f"create another world with edit_spec from what the resource worldagent://worlds/{folder.id}/spec holds"
    )


def _require_same_checks(folder: WorldFolder, ledger: Ledger) -> None:
    """A world that was judged with checks switched off is no world of a whole server, nor the other way round."""
    made, here = ledger.ablation(), ablation()
    if made != here and ledger.revision():
        what = f"is {ablation_words(made)}" if made else "was judged by every check"
        raise RefusedError(
            f"world {folder.id!r} {what}, and this server has {ENV_ABLATION}={here!r}; create another world with edit_spec"
        )


def _latest(folder: WorldFolder, ledger: Ledger) -> tuple[WorldSpec | None, int, str]:
    """The specification of the latest revision if `world.json` holds it; that revision; what is wrong with the file."""
    revision = ledger.revision()
    recorded = ledger.revision_spec(revision)
    if recorded is None:
        raise EvidenceError(no_revision(folder))
    spec, damage = _current(folder, recorded[0])
    return spec, revision, damage


def _current(folder: WorldFolder, recorded: str) -> tuple[WorldSpec | None, str]:
    """The specification of `world.json` if it is the recorded one; else None, and what is wrong with the file."""
    try:
        text = folder.spec_path.read_bytes()
    except OSError:
        text = b""
    spec = _known.get(text, recorded)
    if spec is not None:
        return spec, ""
    try:
        spec = parse_spec(folder.read_json(folder.spec_path))
    except (EvidenceError, InputError) as error:
        return None, f" It cannot be read: {error}"
    if not _same(spec, recorded):
        return None, ""
    _known.put(text, recorded, spec)
    return spec, ""


def _same(spec: WorldSpec, recorded: str) -> bool:
    """True if a specification is the recorded one, which an earlier version may have written without newer fields."""
    return spec.model_dump_json(exclude_none=True) == recorded or spec == WorldSpec.model_validate_json(recorded)
