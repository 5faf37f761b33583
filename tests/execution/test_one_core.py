"""Libraries of linear algebra use one thread within, and as many as before after."""

from __future__ import annotations

import numpy as np
import pytest
from threadpoolctl import threadpool_info
from worldagent.execution import one_core


def _threads() -> list[int]:
    assert np.dot(np.eye(2), np.eye(2)).sum() == 2.0  # the library is loaded
    return [entry["num_threads"] for entry in threadpool_info() if entry["user_api"] == "blas"]


def test_threads_are_put_back_by_the_last_who_leaves_also_after_an_error() -> None:
    """Own choice: nested and left early, nothing stays behind."""
    before = _threads()
    assert before
    with one_core():
        assert set(_threads()) == {1}
        with pytest.raises(ValueError, match="left early"), one_core():
            raise ValueError("left early")
        assert set(_threads()) == {1}
    assert _threads() == before


def test_it_is_a_decorator() -> None:
    before = _threads()

    @one_core()
    def asked() -> list[int]:
        return _threads()

    assert set(asked()) == {1}
    assert _threads() == before
