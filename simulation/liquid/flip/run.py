"""Launch gathering kernels on one device without waiting between them, and keep their arrays from step to step.

As `geometry.launch.launch`, with the same first parameter of kernels, but for many small launches in a row: the threads stay, take slices
as they come free, and launches that repeat are prepared once. A GPU is waited for only where numbers are read.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cache
from itertools import count as numbers
from queue import SimpleQueue
from threading import Thread
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....geometry.launch import cores, load, warp

__all__ = ["Prepared", "Runner"]

GRAIN = 4096
"""Cells of the smallest slice worth a thread. Own choice: some 50 microseconds of work, against 20 for a launch."""
SLICES = 4
"""Slices per core of long launches, so that a core that others use holds nobody up."""
BLOCK = 1024
"""Rows summed by one thread in a reduction on the CPU."""
BLOCK_GPU = 32


class _Team:
    """Threads that help the caller with a list of calls, each taking the next one."""

    def __init__(self, helpers: int) -> None:
        self._doors: list[SimpleQueue[Any]] = [SimpleQueue() for _ in range(helpers)]
        for number, door in enumerate(self._doors):
            Thread(target=self._help, args=(door,), daemon=True, name=f"flip-{number}").start()

    @staticmethod
    def _help(door: SimpleQueue[Any]) -> None:
        while True:
            calls, following, ended = door.get()
            for n in following:
                if n >= len(calls):
                    break
                try:
                    calls[n]()
                except BaseException as error:
                    ended.put(error)
                else:
                    ended.put(None)

    def __call__(self, calls: Sequence[Callable[[], None]]) -> None:
        """Make all calls, in any order, and wait for the last."""
        following = numbers()
        ended: SimpleQueue[BaseException | None] = SimpleQueue()
        for door in self._doors[: len(calls) - 1]:
            door.put((calls, following, ended))
        mine = 0
        for n in following:
            if n >= len(calls):
                break
            calls[n]()
            mine += 1
        errors = [ended.get() for _ in range(len(calls) - mine)]
        for error in errors:
            if error is not None:
                raise error


@cache
def _team(process: int, helpers: int) -> _Team:
    """One team for each process: threads do not survive a fork."""
    return _Team(helpers)


class Prepared:
    """A launch that repeats with the same arrays."""

    def __init__(self, launches: list[Any], team: _Team | None) -> None:
        self._launches, self._team = launches, team
        self._calls = [launch.launch for launch in launches]

    def __call__(self, changed: dict[int, float] | None = None) -> None:
        """Launch; `changed` gives new values of scalar parameters by their place in the kernel."""
        for place, value in (changed or {}).items():
            for launch in self._launches:
                launch.set_param_at_index(place, value)
        if self._team is not None and len(self._calls) > 1:
            self._team(self._calls)
            return
        for call in self._calls:
            call()


class Runner:
    """Launches and arrays on one device."""

    def __init__(self, device: str) -> None:
        self.device = device
        self.block = BLOCK if device == "cpu" else BLOCK_GPU
        self._arrays: dict[str, Any] = {}
        self._cores = cores()

    def _slices(self, count: int, grain: int) -> list[tuple[int, int]]:
        """First element and number of elements of each slice."""
        if self.device != "cpu" or count <= 2 * grain or self._cores == 1:
            return [(0, count)]
        size = max(grain, -(-count // (SLICES * self._cores)))
        return [(first, min(size, count - first)) for first in range(0, count, size)]

    def _helpers(self) -> _Team:
        return _team(os.getpid(), self._cores - 1)

    def __call__(self, kernel: Any, count: int, inputs: Sequence[Any], *, grain: int = GRAIN) -> None:
        """Run a kernel over `count` elements; in slices of at least `grain` on the CPU."""
        if count <= 0:
            return
        wp = warp()
        load(kernel, self.device)
        slices = self._slices(count, grain)
        if len(slices) == 1:
            wp.launch(kernel, dim=count, inputs=[0, *inputs], device=self.device)
            return

        def call(first: int, size: int) -> Callable[[], None]:
            return lambda: wp.launch(kernel, dim=size, inputs=[first, *inputs], device="cpu")

        self._helpers()([call(*part) for part in slices])

    def prepare(self, kernel: Any, count: int, inputs: Sequence[Any], *, grain: int = GRAIN) -> Prepared:
        """The launch of `__call__`, to be made many times."""
        if count <= 0:
            return Prepared([], None)
        load(kernel, self.device)
        slices = self._slices(count, grain)
        launches = [
            warp().launch(kernel, dim=size, inputs=[first, *inputs], device=self.device, record_cmd=True)
            for first, size in slices
        ]
        return Prepared(launches, self._helpers() if len(slices) > 1 else None)

    def array(self, name: str, count: int, dtype: Any) -> Any:
        """An array of at least `count` elements that is kept under a name; its content is what was last written there."""
        found = self._arrays.get(name)
        if found is None or found.size < count or found.dtype != dtype:
            found = warp().zeros(max(16, count + count // 4), dtype=dtype, device=self.device)
            self._arrays[name] = found
        return found

    def swap(self, a: str, b: str) -> None:
        """Exchange two kept arrays; one that is not there yet is made at its next use."""
        self._arrays[a], self._arrays[b] = self._arrays.get(b), self._arrays.get(a)

    def scan(self, source: Any, target: Any, count: int) -> int:
        """Exclusive prefix sum of int32 over `count` elements; returns the last one."""
        wp = warp()
        wp.utils.array_scan(source[:count], target[:count], inclusive=False)
        return int(self.read(target[count - 1 : count], 1)[0])

    def read(self, array: Any, count: int) -> NDArray[Any]:
        """The first `count` elements on the host; a copy."""
        return np.array(array[:count].numpy())

    def upload(self, name: str, values: NDArray[Any], dtype: Any) -> Any:
        """Write host values into a kept array."""
        wp = warp()
        target = self.array(name, len(values), dtype)
        if len(values):
            source = wp.array(np.ascontiguousarray(values), dtype=dtype, device=self.device)
            wp.copy(target, source, count=len(values))
        return target
