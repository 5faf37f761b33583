"""State of a resource, cheaply: a value that changes when what the resource says changes."""

from __future__ import annotations

import re
from collections.abc import Hashable
from pathlib import Path

from ..worlds.errors import InputError
from ..worlds.folder import WORLD_ID, WorldFolder, world_ids
from ..worlds.ledger_file import change_count
from .workspace_jobs import WorkspaceJobs

__all__ = ["ResourceStates"]

_WORLD = re.compile(r"worldagent://worlds/([^/]+)/(.+)")
_JOB = re.compile(r"worldagent://jobs/([^/]+)")
_FILES = {
    "spec": ("spec_path",),
    "matrix": ("ledger_path",),
    "revisions": ("ledger_path",),
    "report": ("spec_path", "ledger_path"),
}
"""Parts of a world by the files that they are read from."""


class ResourceStates:
    """States of the resources of one workspace."""

    def __init__(self, workspace: Path, jobs: WorkspaceJobs) -> None:
        self._workspace = workspace
        self._jobs = jobs

    def __call__(self, uri: str) -> Hashable:
        """State of a resource; None for what is not there or never changes."""
        if uri == "worldagent://worlds":
            return tuple(world_ids(self._workspace))
        if uri == "worldagent://jobs":
            return self._of_jobs(None)
        if found := _JOB.fullmatch(uri):
            return self._of_job(found[1])
        found = _WORLD.fullmatch(uri)
        if found is None or not WORLD_ID.fullmatch(found[1]):
            return None
        world, part = found[1], found[2]
        if part == "jobs":
            return self._of_jobs(world)
        folder = WorldFolder(self._workspace / world)
        names = ("spec_path",) if part.startswith("entities/") else _FILES.get(part, ())
        return tuple(_stamp(getattr(folder, name)) for name in names)

    def _of_jobs(self, world: str | None) -> Hashable:
        store = self._jobs.present()
        if store is None:
            return ()
        return tuple((job.id, job.state, job.progress_done, job.message) for job in store.list(world, limit=50))

    def _of_job(self, job_id: str) -> Hashable:
        store = self._jobs.present()
        if store is None:
            return None
        try:
            job = store.get(job_id)
        except InputError:
            return None
        return (job.state, job.progress_done, job.message)


def _stamp(path: Path) -> tuple[int, ...] | None:
    """Two changes may come within one tick of the file system's clock: a replaced file tells by its number, a ledger by its count."""
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    return (found.st_mtime_ns, found.st_size, found.st_ino, change_count(path) if path.suffix == ".sqlite" else 0)
