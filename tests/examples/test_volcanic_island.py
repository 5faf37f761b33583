"""The island's agent finds that its river is too narrow, mends it from the row, and gets the world accepted."""

from __future__ import annotations

import argparse
from pathlib import Path

import pytest
from worldagent.examples.volcanic_island import run


def _run(cells: int, folder: Path, *, render: bool) -> dict[str, object]:
    return run(argparse.Namespace(out=str(folder), cells=cells, samples=8, no_render=not render))


@pytest.mark.slow
def test_the_island_is_mended_and_accepted(tmp_path: Path) -> None:
    found = _run(144, tmp_path, render=False)
    assert found["accepted"], found
    assert found["repairs"], "the biome's own rain makes no river of that width"
    assert len(found["pictures"]) == 3  # type: ignore[arg-type]


@pytest.mark.slow
def test_a_finer_island_is_accepted_and_filmed(tmp_path: Path) -> None:
    found = _run(384, tmp_path, render=True)
    assert found["accepted"], found
    assert found["final"]["frames"] == 2  # type: ignore[index]
