"""Type of the channels of caches: named arrays of every frame, which each category declares (`channels.py` joins them)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

__all__ = ["RECORD", "Channel", "quantity", "vector"]

RECORD = "record/"
"""Prefix of the channels that hold one number per frame."""


@dataclass(frozen=True)
class Channel:
    """One named array of every frame."""

    name: str
    dtype: str
    """Code of numpy, as in `f8`."""
    shape: tuple[str | int, ...]
    """Sizes, or names of `DIMENSIONS`; the first one says where the values live. Empty: one number per frame."""
    unit: str
    meaning: str
    total: Literal["sum", "max", "min", ""] = ""
    """Operation that makes one value of those of several instances, and of several rows; empty where there is none."""
    sign: Literal["+", ""] = ""
    """`+`: no value is negative."""
    conserved: bool = False
    """True if physics keeps the total."""
    of: tuple[str, ...] = ()
    """Kinds of writer, which the registry fills in from the declarations of the categories."""
    finite: bool = False
    """The writer promises finite numbers; elsewhere those that are not are evidence of a fault, which checks judge."""

    @cached_property
    def type(self) -> np.dtype[Any]:
        """The numpy type."""
        return np.dtype(self.dtype)

    def combined(self, columns: Sequence[Any]) -> Any:
        """Values of several instances as one; each of any shape, all alike."""
        stack = np.stack([np.asarray(column, dtype=np.float64) for column in columns])
        return {"max": stack.max, "min": stack.min}.get(self.total, stack.sum)(axis=0)


def quantity(name: str, unit: str, meaning: str, *, total: Literal["sum", "max", "min"] = "sum", **more: Any) -> Channel:
    """A quantity of one number per frame; values of several instances add up unless told."""
    return Channel(RECORD + name, "f8", (), unit, meaning, total, **more)


def vector(name: str, unit: str, meaning: str) -> tuple[Channel, ...]:
    """The three components of a recorded vector."""
    return tuple(quantity(f"{name}_{axis}", unit, meaning) for axis in "xyz")
