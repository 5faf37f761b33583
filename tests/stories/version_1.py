"""A world of version 1, whose prompt was judged by clauses, as an earlier version of the program stored it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from worldagent.worlds.canonical import spec_digest
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.patch import parse_spec

__all__ = ["old_spec", "store_old"]

FILE = Path(__file__).with_name("version_1.json")


def old_spec() -> dict[str, Any]:
    """The three blocks of `small_run`, with clauses and their prompt."""
    found: dict[str, Any] = json.loads(FILE.read_text())
    return found


def store_old(workspace: Path, world: str = "w", *, document: dict[str, Any] | None = None) -> Path:
    """Folder of the world, or of another document of version 1, as it lies in a workspace after its creation."""
    spec = parse_spec(document or old_spec())
    folder = WorldFolder.of(workspace, world, create=True)
    folder.root.mkdir(parents=True, exist_ok=True)
    folder.assets.mkdir(exist_ok=True)
    number = Ledger(folder.ledger_path).add_revision(
        spec.model_dump_json(exclude_none=True), spec_digest(spec), expected=0, hypothesis="created"
    )
    assert number == 1
    folder.spec_path.write_text(spec.model_dump_json(exclude_none=True, indent=2))
    return folder.root
