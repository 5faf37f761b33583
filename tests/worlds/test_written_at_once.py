"""Files that two write at once, or that change while they are read: each is whole, or told."""

from __future__ import annotations

import zipfile
from pathlib import Path
from threading import Thread, current_thread
from typing import Any

import numpy as np
import pytest
import worldagent.worlds.bundle as bundle_module
from worldagent.worlds.bundle import open_bundle, write_bundle
from worldagent.worlds.errors import EvidenceError
from worldagent.worlds.landscape import SavedLandscape, save_landscape

MEMBERS: dict[str, bytes | Path] = {
    "verdict.json": b"{}",
    "history.json": b"{}",
    "events.json": b"null",
    "world/world.json": b"{}",
}


class Second(Thread):
    """Another process that writes the same file while this one stands amid its own writing."""

    def __init__(self, work: Any) -> None:
        super().__init__(daemon=True)
        self._work = work
        self.error: BaseException | None = None

    def run(self) -> None:
        try:
            self._work()
        except BaseException as error:
            self.error = error

    def amid(self, write: Any) -> Any:
        """`write`, with the other's whole work before its end."""

        def paused(*arguments: Any, **more: Any) -> Any:
            found = write(*arguments, **more)
            if current_thread() is not self and self.ident is None:
                self.start()
                self.join(20)
            return found

        return paused


def test_two_that_save_one_landscape_at_once_leave_it_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "terrain" / "isle.npz"
    values = {"height": np.arange(6.0).reshape(2, 3)}

    def save() -> None:
        save_landscape(path, values, {"rows": 2, "cols": 3})

    second = Second(save)
    monkeypatch.setattr(np, "savez", second.amid(np.savez))
    save()
    assert second.error is None
    assert SavedLandscape(path).field("height").tolist() == values["height"].tolist()
    assert [p.name for p in path.parent.iterdir()] == [path.name]


def test_two_that_write_one_bundle_at_once_leave_it_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.zip"
    second = Second(lambda: write_bundle(path, {}, MEMBERS))
    monkeypatch.setattr(zipfile.ZipFile, "writestr", second.amid(zipfile.ZipFile.writestr))
    written = write_bundle(path, {}, MEMBERS)
    assert second.error is None
    assert open_bundle(path).digest == written.digest
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_a_file_that_changes_while_it_is_bundled_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A bake of the same world that began meanwhile; the bundle would be refused by everybody."""
    mesh = tmp_path / "mesh"
    mesh.write_bytes(b"o box")
    listing = bundle_module._listing

    def listed_then_changed(source: bytes | Path) -> dict[str, Any]:
        found = listing(source)
        if isinstance(source, Path):
            mesh.write_bytes(b"o ball")
        return found

    monkeypatch.setattr(bundle_module, "_listing", listed_then_changed)
    with pytest.raises(EvidenceError, match=r"'world/assets/box.obj' changed while it was bundled"):
        write_bundle(tmp_path / "a.zip", {}, {**MEMBERS, "world/assets/box.obj": mesh})
    assert [p.name for p in tmp_path.iterdir()] == [mesh.name]
