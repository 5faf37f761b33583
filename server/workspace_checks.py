"""Requirements on the workspace: writable, on a disk of this machine with room, without remains of processes that died."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import sqlite3
import stat
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

from ..execution import JobStore
from ..execution.damage import set_aside
from ..execution.table import FOLDER
from .check import Check

__all__ = ["WORKSPACE_CHECKS", "disk", "file_system", "jobs", "leftovers", "private_files", "writable"]

LEAST_FREE_BYTES = 2_000_000_000
STALE_S = 60.0
"""A worker says every second that it lives; one that has not for so long is gone [s]."""
OLD_S = 3600.0
"""A temporary file of a process that is gone is removed at this age [s]."""
LOOKS = 200_000
"""Directory entries looked at in search of remains."""
_FOREIGN = ("nfs", "cifs", "smb", "9p", "drvfs", "fuse.sshfs", "vboxsf", "virtiofs", "afpfs", "webdav")
_TEMPORARY = re.compile(r"^\..+\.(\d+)\.\d+\.tmp$")
_PRIVATE = ("tokens.json", "token_uses.json")


def writable(workspace: Path) -> list[Check]:
    """Check whether the workspace can be written; it is not created by looking."""
    there = _existing(workspace)
    problem = ""
    if not there.is_dir():
        problem = f"{there} is a file"
    else:
        try:
            with tempfile.TemporaryFile(dir=there):
                pass
        except OSError as error:
            problem = f"{there}: {error.strerror}"
    own = hasattr(os, "geteuid") and there.is_dir() and there.stat().st_uid == os.geteuid() and not os.access(there, os.W_OK)
    return [
        Check(
            "workspace",
            not problem,
            problem or f"{workspace} can be {'written' if there == workspace else 'created'}",
            cost="no world can be made or changed",
            remedy="give another folder with --workspace"
            if not there.is_dir()
            else f"sudo chown -R $(id -un) {there} && chmod u+rwx {there}",
            mend=(lambda: _open_to_owner(there)) if own else None,
        )
    ]


def _open_to_owner(folder: Path) -> str:
    folder.chmod(stat.S_IMODE(folder.stat().st_mode) | 0o700)
    return f"gave the owner of {folder} the right to write"


def disk(workspace: Path) -> list[Check]:
    """Free room where the workspace lies."""
    free = shutil.disk_usage(_existing(workspace)).free
    return [
        Check(
            "free disk",
            free >= LEAST_FREE_BYTES,
            f"{free / 1e9:.1f} GB free ({LEAST_FREE_BYTES / 1e9:.0f} GB or more)",
            cost="bakes and renders stop in the middle; nothing written before is lost",
            remedy=f"delete old worlds or candidates below {workspace}, or give another folder with --workspace",
        )
    ]


def file_system(workspace: Path) -> list[Check]:
    """Check whether the workspace lies on a disk of this machine. Linux only: elsewhere nothing tells without asking other programs."""
    kind = _kind_of_mount(_existing(workspace).resolve())
    if kind is None:
        return []
    return [
        Check(
            "file system",
            not kind.startswith(_FOREIGN),
            f"{kind}{', shared over a network or with Windows' if kind.startswith(_FOREIGN) else ''}",
            required=False,
            cost="locks may not hold there, so that two servers can spoil the list of jobs, and files are slow",
            remedy="keep the workspace on this machine's own disk: --workspace ~/worldagent",
        )
    ]


def _kind_of_mount(path: Path) -> str | None:
    try:
        lines = Path("/proc/mounts").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return None
    best: tuple[int, str] | None = None
    for line in lines:
        fields = line.split()
        if len(fields) < 3:
            continue
        place = Path(re.sub(r"\\([0-7]{3})", lambda m: chr(int(m.group(1), 8)), fields[1]))
        if path.is_relative_to(place) and (best is None or len(place.parts) >= best[0]):
            best = (len(place.parts), fields[2])
    return best[1] if best is not None else None


def jobs(workspace: Path) -> list[Check]:
    """The list of jobs: whole, and without running jobs whose worker is gone."""
    path = workspace / FOLDER / "jobs.db"
    if not path.is_file():
        return []
    try:
        with contextlib.closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True, timeout=5.0)) as connection:
            whole = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
            states = dict(connection.execute("SELECT state, COUNT(*) FROM jobs GROUP BY state").fetchall())
            silent = connection.execute(
                "SELECT id FROM jobs WHERE state = 'running' AND COALESCE(heartbeat, started, created) < ?",
                (time.time() - STALE_S,),
            ).fetchall()
            ahead = connection.execute("SELECT MAX(created) FROM jobs").fetchone()[0] or 0.0
    except sqlite3.OperationalError as error:
        return [_unfinished(workspace, str(error))]
    except sqlite3.DatabaseError as error:
        return [_damaged(path, str(error))]
    if whole != "ok":
        return [_damaged(path, str(whole).splitlines()[0])]
    counted = ", ".join(f"{count} {state}" for state, count in sorted(states.items())) or "none yet"
    found = [
        Check(
            "jobs",
            not silent,
            f"{counted}; no sign of life from {', '.join(row[0] for row in silent[:3])}" if silent else counted,
            required=False,
            cost="the job is shown as running and holds a place until a server looks at it",
            remedy=f"worldagent doctor --repair --workspace {workspace}",
            mend=lambda: _settle(workspace),
        )
    ]
    if ahead > time.time() + STALE_S:
        found.append(
            Check(
                "clock of the jobs",
                False,
                f"the newest job was made {ahead - time.time():.0f} s in the future",
                required=False,
                cost="ages and estimates of jobs are wrong until the clock has caught up",
                remedy="set the clock: sudo timedatectl set-ntp true",
            )
        )
    return found


def _settle(workspace: Path) -> str:
    started = JobStore(workspace).pump()
    return f"marked jobs of workers that are gone as lost{f', started {started} that waited' if started else ''}"


def _unfinished(workspace: Path, why: str) -> Check:
    return Check(
        "jobs",
        False,
        f"the list of jobs can't be read without changing it: {why}",
        required=False,
        cost="a process died while it wrote; the next server rolls that back by itself",
        remedy=f"worldagent doctor --repair --workspace {workspace}",
        mend=lambda: _settle(workspace),
    )


def _damaged(path: Path, why: str) -> Check:
    return Check(
        "jobs",
        False,
        f"{path} is damaged: {why}",
        cost="no long work can start; worlds and their results are not in this file and stay as they are",
        remedy=f"stop all servers of this workspace, then mv {path} {path}.damaged",
        mend=lambda: str(set_aside(path, sqlite3.DatabaseError(why))),
    )


def leftovers(workspace: Path) -> list[Check]:
    """Temporary files of processes that died while they wrote."""
    if not workspace.is_dir():
        return []
    found = [path for path in _files(workspace) if _is_left_over(path)]
    size = sum(path.stat().st_size for path in found)

    def remove() -> str:
        for path in found:
            path.unlink(missing_ok=True)
        return f"removed {len(found)} temporary files"

    return [
        Check(
            "remains",
            not found,
            f"{len(found)} temporary files of processes that died, {size / 1e6:.1f} MB"
            if found
            else "no temporary files of processes that died",
            required=False,
            cost="disk space, nothing else",
            remedy=f"worldagent doctor --repair --workspace {workspace}",
            mend=remove,
        )
    ]


def _files(workspace: Path) -> Iterable[Path]:
    looks = 0
    for folder, _, names in os.walk(workspace):
        looks += len(names)
        if looks > LOOKS:
            return
        yield from (Path(folder) / name for name in names if name.startswith("."))


def _is_left_over(path: Path) -> bool:
    match = _TEMPORARY.match(path.name)
    if match is None or path.is_symlink():
        return False
    try:
        return time.time() - path.stat().st_mtime > OLD_S and not Path(f"/proc/{match.group(1)}").exists()
    except OSError:
        return False


def private_files(workspace: Path) -> list[Check]:
    """Files about tokens must be closed to other users."""
    if os.name == "nt":
        return []
    there = [workspace / FOLDER / name for name in _PRIVATE]
    present = [path for path in there if path.is_file() and not path.is_symlink()]
    wide = [path for path in present if stat.S_IMODE(path.stat().st_mode) & 0o077]
    if not present:
        return []

    def close() -> str:
        for path in wide:
            path.chmod(0o600)
        return f"closed {', '.join(path.name for path in wide)} to other users"

    return [
        Check(
            "files of tokens",
            not wide,
            f"others may read {', '.join(str(path) for path in wide)}" if wide else "closed to other users",
            cost="the HTTP server refuses every request until they are closed",
            remedy="; ".join(f"chmod 600 {path}" for path in wide),
            mend=close,
        )
    ]


def _existing(path: Path) -> Path:
    while not path.exists():
        path = path.parent
    return path


WORKSPACE_CHECKS = (writable, disk, file_system, jobs, leftovers, private_files)
"""In the order of the report."""
