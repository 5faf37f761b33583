"""Warp in a server whose tools run in threads."""

from __future__ import annotations

import threading

import pytest
import warp as wp
from worldagent.geometry import launch


def test_calls_that_come_at_once_start_warp_one_after_another(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its start makes a runtime and devices, unless there are some: two at once make two."""
    together = threading.Barrier(2)
    met: list[bool] = []

    def start() -> None:
        try:
            together.wait(0.5)
        except threading.BrokenBarrierError:
            met.append(False)
        else:
            met.append(True)

    monkeypatch.setattr(wp, "init", start)
    launch.warp.cache_clear()
    threads = [threading.Thread(target=launch.warp) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    launch.warp.cache_clear()
    assert not any(met)
