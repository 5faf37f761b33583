"""Surroundings of all tests."""

import gc
import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from worldagent.tests.collected import SLOW

# A process that waits with all engines loaded, for the workspace of every test, would fill the machine; tests of such
# processes switch them on.
os.environ.setdefault("WORLDAGENT_WARM", "0")
# Tests wait for the result of a call where a client would come back for it.
os.environ.setdefault("WORLDAGENT_WAIT_MAX_S", "240")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keep the ids of slow tests before `-m` takes them out."""
    if [Path(a).resolve() for a in config.args] == [Path(__file__).parent]:
        left_out = [os.path.relpath(p, config.rootpath) for p in config.getoption("ignore") or ()]
        config.stash[SLOW] = [i.nodeid for i in items if i.get_closest_marker("slow")], left_out


@pytest.fixture(scope="module", autouse=True)
def leftovers_collected(request: pytest.FixtureRequest) -> Iterator[None]:
    """Collect what a module lets its libraries leave open while its own filter holds; a later test would be blamed for it."""
    yield
    if any("ResourceWarning" in str(kept) for mark in request.node.iter_markers("filterwarnings") for kept in mark.args):
        gc.collect()
