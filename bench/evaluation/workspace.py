"""Isolation: every sample has a folder of its own that nobody used before, and that nobody else touches (R125, R126, R129, R135).

The layout is the paper's: `outputs/example_k/`. A folder that exists is never used again: another epoch or attempt gets another
name. At the end each file is compared with the start of the sample, with the calls that made its world, and with what links to it;
after the run, with what the sample left.
"""

from __future__ import annotations

import os
import secrets
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .records import Record

__all__ = ["SampleFolder", "marks_after", "new_run", "take_folder"]

CLOCK_S = 2.0
"""Coarseness of a file system's times [s]."""


@dataclass(frozen=True)
class SampleFolder:
    """Workspace and record of one attempt at one sample."""

    workspace: Path
    record: Record
    began: float
    """UNIX time [s]."""

    @property
    def name(self) -> str:
        """`example_3`, `example_3_e2_a1`."""
        return self.workspace.name

    def close(self) -> list[str]:
        """Write what the sample leaves, and return what speaks against its isolation, a line each."""
        files = _files(self.workspace)
        self.record.write("manifest.json", {"closed": time.time(), "files": files})
        marks = self._marks(files)
        self.record.write("isolation.json", marks)
        return marks

    def _marks(self, files: dict[str, list[Any]]) -> list[str]:
        found = []
        early = sorted(name for name, (_, _, changed) in files.items() if changed < self.began - CLOCK_S)
        if early:
            found.append(f"{len(early)} files are from before the sample: {', '.join(early[:3])}")
        called = {str(c.arguments.get("world")) for c in self.record.calls()}
        worlds = {p.name for p in self.workspace.iterdir() if p.is_dir() and not p.name.startswith(".")}
        if strange := sorted(worlds - called):
            found.append(f"no call of this sample made {', '.join(strange[:3])}")
        # A hard link within the folder is the world's own; one more name than the folder holds leads out of it.
        inodes: dict[int, int] = {}
        for name in files:
            inodes[(self.workspace / name).lstat().st_ino] = inodes.get((self.workspace / name).lstat().st_ino, 0) + 1
        for name in files:
            path = self.workspace / name
            if path.is_symlink() and not path.resolve().is_relative_to(self.workspace.resolve()):
                found.append(f"{name} leads out of the folder, to {path.resolve()}")
            elif path.lstat().st_nlink > inodes[path.lstat().st_ino]:
                found.append(f"{name} has another name outside the folder")
        return found


def new_run(root: Path) -> Path:
    """A new folder for one run, with `outputs/` and `records/`."""
    run = root.absolute() / f"{time.strftime('%Y%m%d-%H%M%S')}-{secrets.token_hex(3)}"
    (run / "outputs").mkdir(parents=True)
    (run / "records").mkdir()
    return run


def take_folder(run: Path, example: int, *, epoch: int = 1) -> SampleFolder:
    """A folder for one attempt at a sample: `example_k`, or with a number behind where that was used already.

    Args:
        run: of `new_run`.
        example: number of the sample in its data set, from 1.
        epoch: from 1.
    """
    first = f"example_{example}" + (f"_e{epoch}" if epoch > 1 else "")
    attempt = 0
    while True:
        name = first + (f"_a{attempt}" if attempt else "")
        record = run / "records" / name
        try:
            record.mkdir(parents=True)  # whoever makes it has it
            workspace = run / "outputs" / name
            workspace.mkdir(parents=True)
        except FileExistsError:
            attempt += 1
            continue
        return SampleFolder(workspace, Record(record), time.time())


def marks_after(record: Record, workspace: Path) -> list[str]:
    """Lines about what changed in a sample's folder after the sample had ended: another one, or a hand, was there."""
    known = record.read("manifest.json")
    if known is None:
        return ["the sample left no manifest"]
    before, now = known["files"], _files(workspace)
    gone, new = sorted(before.keys() - now.keys()), sorted(now.keys() - before.keys())
    changed = sorted(name for name in before.keys() & now.keys() if list(before[name]) != list(now[name]))
    told = (("gone", gone), ("new", new), ("changed", changed))
    return [f"{len(names)} files are {what} since the sample ended: {', '.join(names[:3])}" for what, names in told if names]


def _files(folder: Path) -> dict[str, list[Any]]:
    """Size, time of content and time of change [s] of every file of the worlds, by relative path.

    The server's own files of jobs are left out: a helper of theirs ends minutes after the last one.
    """
    found: dict[str, list[Any]] = {}
    for root, folders, names in os.walk(folder):
        folders[:] = [f for f in folders if f != ".worldagent"]
        for name in names:
            path = Path(root) / name
            state = path.lstat()
            found[path.relative_to(folder).as_posix()] = [state.st_size, state.st_mtime, state.st_ctime]
    return found
