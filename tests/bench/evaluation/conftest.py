"""A fake server in the place of the real one, and documents that a scripted agent plays to it."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from worldagent.bench.evaluation.serving import ENV_SERVER

FAKE = Path(__file__).with_name("fake_server.py")


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Make the fake server the one of every sample, in a mode."""

    def use(mode: str = "") -> None:
        monkeypatch.setenv(ENV_SERVER, os.pathsep.join([sys.executable, str(FAKE), mode]))

    use()
    return use


@pytest.fixture
def documents(tmp_path: Path) -> Callable[..., Path]:
    """A folder of documents: by sample, the calls that it makes."""

    def write(**calls: Sequence[dict[str, Any]]) -> Path:
        folder = tmp_path / "documents"
        folder.mkdir(exist_ok=True)
        for name, made in calls.items():
            told = [{"tool": "inspect_world", "arguments": arguments} for arguments in made]
            (folder / f"{name}.json").write_text(json.dumps({"calls": told}))
        return folder

    return write
