"""Texts that a watch writes of a task that says nothing for long."""

from __future__ import annotations

import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from worldagent.execution.context import Board
from worldagent.execution.job import Progress
from worldagent.execution.watch import Watch


class Table:
    """Keeps what is written of a job."""

    def __init__(self, folder: Path) -> None:
        self.told: list[str] = []
        self._folder = folder

    def latest_pace(self, job: Any) -> None:
        """No run like it was made before."""

    def log_path(self, job: Any) -> Path:
        """There is no log."""
        return self._folder / "log"

    def beat(self, job: str, worker: int, progress: Progress | None, **more: Any) -> bool:
        """Take the news."""
        if progress is not None:
            self.told.append(progress.message)
        return True


def test_what_is_left_of_a_part_grows_while_no_news_comes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten of twenty frames in ten seconds, then none for a minute and a half: ten more take longer than ten seconds."""
    now = 1000.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    table, board = Table(tmp_path), Board()
    job: Any = SimpleNamespace(id="one")
    watch = Watch(table, job, board, -1, 0)  # type: ignore[arg-type]
    for frame in range(1, 11):
        now += 1.0
        board.write(Progress(float(frame), 60.0, f"frame {frame} of 20", 20.0))
        watch._write()
    assert table.told[-1] == "frame 10 of 20 (this part: about 10 s more)"
    for _ in range(90):
        now += 1.0
        watch._write()
    assert table.told[-1] == "frame 10 of 20 (this part: about 2 min more)"
