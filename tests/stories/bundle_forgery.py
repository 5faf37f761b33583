"""Bundles as a forger makes them: members changed, and the manifest made to agree again."""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

__all__ = ["Forgery", "forged"]


class Forgery:
    """The members of a bundle, to be changed at will."""

    def __init__(self, source: Path) -> None:
        with zipfile.ZipFile(source) as archive:
            self.members = {n: archive.read(n) for n in archive.namelist()}
        self.manifest: dict[str, Any] = json.loads(self.members.pop("manifest.json"))
        self.extra: list[tuple[zipfile.ZipInfo | str, bytes]] = []

    def edit(self, name: str, change: Callable[[Any], None]) -> None:
        """Change a JSON member in place."""
        data = json.loads(self.members[name])
        change(data)
        self.members[name] = json.dumps(data).encode()

    def row(self, row_id: str) -> Callable[[Callable[[dict[str, Any]], None]], None]:
        """Change one row of the verdict."""

        def apply(change: Callable[[dict[str, Any]], None]) -> None:
            self.edit("verdict.json", lambda v: change(next(r for r in v["rows"] if r["id"] == row_id)))

        return apply

    def name(self, ending: str) -> str:
        """The one member whose name ends so."""
        (found,) = [n for n in self.members if n.endswith(ending)]
        return found

    def write(self, path: Path, *, sealed: bool = True) -> Path:
        """Write the zip; `sealed` with a manifest that lists what is in it now."""
        if sealed:
            self.manifest["members"] = {
                n: {"bytes": len(d), "sha256": hashlib.sha256(d).hexdigest()} for n, d in self.members.items()
            }
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("manifest.json", json.dumps(self.manifest))
            for name, data in [*self.members.items(), *self.extra]:
                archive.writestr(name, data)
        return path


def forged(source: Path, into: Path, change: Callable[[Forgery], None], *, sealed: bool = True) -> Path:
    """A forged copy of a bundle."""
    forgery = Forgery(source)
    change(forgery)
    return forgery.write(into, sealed=sealed)
