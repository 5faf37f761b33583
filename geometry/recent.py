"""Values used lately, kept up to a weight: each is weighed once, so that a thousand kept ones cost no more than ten."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

__all__ = ["Recent"]

Value = TypeVar("Value")


class Recent(Generic[Value]):
    """Values by key, the one used last at the end; threads may share it."""

    def __init__(self, most: float) -> None:
        self.most = most
        """Weight that is kept at most."""
        self.weight = 0.0
        """Weight that is kept."""
        self._kept: dict[object, tuple[Value, float]] = {}
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return len(self._kept)

    def of(self, key: object, make: Callable[[], Value], weigh: Callable[[Value], float]) -> Value:
        """The value of a key, made where none is kept; the ones used longest ago give way, and one heavier than all is not kept."""
        with self._lock:
            found = self._kept.pop(key, None)
            if found is not None:
                self._kept[key] = found
                return found[0]
        value = make()  # unlocked: others go on meanwhile, and two that make the same both have it
        weight = weigh(value)
        with self._lock:
            self._drop(key)
            if weight <= self.most:
                self._kept[key] = (value, weight)
                self.weight += weight
            while self.weight > self.most:
                self._drop(next(iter(self._kept)))
        return value

    def _drop(self, key: object) -> None:
        if key in self._kept:
            self.weight -= self._kept.pop(key)[1]
