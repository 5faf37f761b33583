"""The world folder: where everything of one world lives, and how paths are kept inside it.

world.json             current specification
ledger.sqlite          revisions, matrix, iterations, freezes, acceptances
assets/                mesh files that the specification names
built/                 one file per built entity and recipe
candidates/<id>/       candidate.json, probe/<solver>/, bake/<solver>/, plates/, final/
acceptance/            <id>.zip: bundle of a judged candidate; <id>.html: its matrix report
pictures/              previews, contact sheets, plots
"""

from __future__ import annotations

import json
import os
import re
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .errors import EvidenceError, InputError
from .foreign import refuse_foreign
from .hints import did_you_mean

__all__ = ["WorldFolder", "safe_join", "temporary_name", "world_ids", "worlds_told", "write_atomically"]

_NAMED = 20
"""Worlds that a refusal names."""
WORLD_ID = re.compile(r"^[a-z0-9][a-z0-9_-]{0,63}$")


def safe_join(base: Path, relative: str) -> Path:
    """`base / relative`, resolved, guaranteed to stay inside `base` (symlinks included).

    Raises:
        InputError: the path is absolute, climbs out, or leads out through a link.
    """
    root = base.resolve()
    try:
        joined = (root / relative).resolve()
    except (ValueError, OSError, RuntimeError) as error:  # NUL, too long, links in a circle
        raise InputError(f"path {relative[:200]!r} is none: {error}; give a relative path inside {base.name!r}") from error
    if Path(relative).is_absolute() or (joined != root and root not in joined.parents):
        raise InputError(f"path {relative[:200]!r} leads out of {base.name!r}; give a relative path inside it")
    return joined


def temporary_name(path: Path) -> Path:
    """Where to write what is renamed to `path` afterwards; no other thread or process writes there."""
    return path.with_name(f".{path.name}.{os.getpid()}.{threading.get_ident()}.tmp")


def write_atomically(path: Path, data: bytes) -> None:
    """Write to a temporary name beside `path`, then rename."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = temporary_name(path)
    try:
        temporary.write_bytes(data)
        temporary.replace(path)
    except OSError:  # half a file would keep the space that a full disk lacks
        temporary.unlink(missing_ok=True)
        raise


def world_ids(workspace: Path) -> list[str]:
    """Ids of the worlds in a workspace, sorted."""
    if not workspace.is_dir():
        return []
    return sorted(p.name for p in workspace.iterdir() if WORLD_ID.fullmatch(p.name) and (p / "world.json").is_file())


def worlds_told(known: list[str]) -> str:
    """The worlds of a workspace in a line: the first twenty, and how many more there are."""
    if len(known) <= _NAMED:
        return f"known worlds: {known}"
    return f"known worlds: {known[:_NAMED]} and {len(known) - _NAMED} more (inspect_world(part='worlds') lists all)"


@dataclass(frozen=True)
class WorldFolder:
    """Paths of one world."""

    root: Path

    @classmethod
    def of(cls, workspace: Path, world: str, *, create: bool = False) -> WorldFolder:
        """The folder of world `world` in `workspace`.

        Raises:
            InputError: the id is malformed, or there is no such world.
            EvidenceError: the folder holds links out of it, pipes or devices.
        """
        if not WORLD_ID.fullmatch(world):
            raise InputError(f"world id {world[:100]!r} must match {WORLD_ID.pattern}, e.g. {_as_id(world)!r}")
        root = safe_join(workspace, world)
        if not create and not (root / "world.json").is_file():
            if (root / "ledger.sqlite").is_file():
                raise InputError(
                    f"world.json of {world!r} is missing, its ledger is there (a write was cut short, or the file was deleted); "
                    "edit_spec with on_hand_edit='restore' writes it again"
                )
            known = world_ids(workspace)
            hint = did_you_mean(world, known)
            raise InputError(f"there is no world {world!r}{hint or ';'} {worlds_told(known)}. Create one with edit_spec")
        refuse_foreign(root)
        return cls(root)

    @classmethod
    def at(cls, root: Path) -> WorldFolder:
        """A world folder anywhere, perhaps from a stranger.

        Raises:
            EvidenceError: it holds links out of it, pipes or devices.
        """
        refuse_foreign(root)
        return cls(root.resolve())

    @property
    def id(self) -> str:
        """The world's id: its folder name."""
        return self.root.name

    @property
    def spec_path(self) -> Path:
        """`world.json`."""
        return self.root / "world.json"

    @property
    def ledger_path(self) -> Path:
        """`ledger.sqlite`."""
        return self.root / "ledger.sqlite"

    @property
    def assets(self) -> Path:
        """Folder of mesh files."""
        return self.root / "assets"

    @property
    def pictures(self) -> Path:
        """Folder of pictures."""
        return self.root / "pictures"

    @property
    def acceptance(self) -> Path:
        """Folder of acceptance bundles and matrix reports."""
        return self.root / "acceptance"

    def built(self, entity: str, recipe: str) -> Path:
        """File of a built entity."""
        return self.root / "built" / f"{entity}.{recipe[:16]}.zip"

    def candidate(self, freeze: str) -> Path:
        """Folder of a candidate."""
        return self.root / "candidates" / freeze[:16]

    def relative(self, path: Path) -> str:
        """Path inside the world folder, with forward slashes."""
        return path.resolve().relative_to(self.root.resolve()).as_posix()

    def read_json(self, path: Path) -> Any:
        """Parse a JSON file of this world.

        Raises:
            EvidenceError: missing or damaged.
        """
        try:
            return json.loads(path.read_text())
        except (OSError, ValueError, RecursionError) as error:
            raise EvidenceError(f"{self.relative(path)} is missing or damaged: {error}") from error


def _as_id(world: str) -> str:
    """An id that comes near to a malformed one."""
    near = re.sub(r"[^a-z0-9_-]+", "_", str(world)[:64].lower()).strip("_-")
    return near if WORLD_ID.fullmatch(near) else "domino_run"
