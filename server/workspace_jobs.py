"""The job store of a workspace, opened late."""

from __future__ import annotations

import threading
from pathlib import Path

from ..execution import JobStore
from ..execution.schema import FOLDER

__all__ = ["WorkspaceJobs"]


class WorkspaceJobs:
    """Opens the job store when it is first asked for, since that makes the workspace. Safe from several threads."""

    def __init__(self, workspace: Path, store: JobStore | None = None) -> None:
        self.workspace = workspace
        self._store = store
        self._lock = threading.Lock()

    def __call__(self) -> JobStore:
        """The store."""
        with self._lock:
            if self._store is None:
                self.workspace.mkdir(parents=True, exist_ok=True)
                self._store = JobStore(self.workspace)
            return self._store

    def present(self) -> JobStore | None:
        """The store if the workspace has one already: reading never makes a workspace."""
        known = self._store is not None or (self.workspace / FOLDER / "jobs.db").is_file()
        return self() if known else None
