from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

FAKES = Path(__file__).with_name("fakes.py")


def _load() -> ModuleType:
    found = importlib.util.spec_from_file_location("worldagent_test_fakes", FAKES)
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules[found.name] = module
    found.loader.exec_module(module)
    return module


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture(scope="session")
def fakes() -> ModuleType:
    return _load()


@pytest.fixture
def fake_process() -> list[str]:
    """Command of a process that serves the fake tools; append transport, workspace and token."""
    return [sys.executable, str(FAKES)]


@pytest.fixture(params=["auto", "legacy"])
def era(request: pytest.FixtureRequest) -> str:
    """Both protocol eras that the SDK serves: 2026-07-28 and 2025-11-25."""
    return str(request.param)
