"""Python's collector walks seldom while a large world is built or judged, and as before after it."""

from __future__ import annotations

import gc

import pytest
from worldagent.execution import seldom_collected


def test_the_collector_is_put_back_by_the_last_who_leaves_even_by_an_error():
    """Choice: what several do at once, and what fails, leaves nothing behind."""
    before = gc.get_threshold()
    with seldom_collected():
        within = gc.get_threshold()
        assert within > before
        with pytest.raises(ValueError, match="left early"), seldom_collected():
            raise ValueError("left early")
        assert gc.get_threshold() == within
    assert gc.get_threshold() == before


def test_it_decorates_what_is_called_again_and_again():
    """Choice: each call is within."""
    before = gc.get_threshold()

    @seldom_collected()
    def asked() -> tuple[int, int, int]:
        return gc.get_threshold()

    assert asked() == asked() > before
    assert gc.get_threshold() == before
