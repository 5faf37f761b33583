"""Key under which a run of all tests keeps the slow ones that it collected."""

from __future__ import annotations

import pytest

__all__ = ["SLOW"]

SLOW = pytest.StashKey[tuple[list[str], list[str]]]()
"""Where all tests are collected: ids of the slow ones, and folders that were left out."""
