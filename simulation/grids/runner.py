"""Passes of grid engines on one device (`simulation/passes.py`), and arrays that are kept from step to step.

A GPU is waited for only where numbers are read.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import warp
from ..passes import Pass

__all__ = ["BEFORE", "Runner"]

GRAIN = 4096
"""Cells of the smallest slice worth a thread. Own choice: some 50 microseconds of work, against 20 for a launch."""
SLICES = 4
"""Slices per core of long launches, so that a core that others use holds nobody up."""
BLOCK = 1024
"""Rows summed by one thread in a reduction on the CPU."""
BLOCK_GPU = 32


BEFORE = 8
"""Elements kept free on both sides of a field: a row's first cell has an element below it."""
KEPT = 512
"""Own choice: launches that are kept; an engine of fixed cells has some hundred."""


class Runner:
    """Launches and arrays on one device.

    Args:
        device: `cpu`, `cuda`, ...
        keeps: keep launches for the next call with the same kernel, arrays and count, as an engine makes whose fields stay; only their
            numbers may differ.
    """

    def __init__(self, device: str, *, keeps: bool = False) -> None:
        self.device, self.keeps = device, keeps
        self._views: dict[str, tuple[Any, Any]] = {}
        self._kept: dict[tuple[Any, ...], tuple[Pass, list[Any]]] = {}
        self.block = BLOCK if device == "cpu" else BLOCK_GPU
        self._arrays: dict[str, Any] = {}

    def __call__(self, kernel: Any, count: int, inputs: Sequence[Any], *, grain: int = GRAIN) -> None:
        """Run a kernel over `count` elements; in slices of at least `grain` on the CPU."""
        self._ready(kernel, count, inputs, grain, 1)()

    def together(self, calls: Sequence[tuple[Any, Sequence[Any]]], count: int, *, grain: int, align: int) -> None:
        """Run kernels, with their parameters, one after the other over the same elements; slices, which begin at whole multiples of `align`,
        are independent of each other in all of them."""
        Pass.together([self._ready(kernel, count, inputs, grain, align) for kernel, inputs in calls])

    def rows(self, box: Any, shape: tuple[int, int, int], calls: Sequence[tuple[Any, Sequence[Any]]], *, grain: int) -> None:
        """Run kernels one after the other over the rows along z of fields with (nx + 1)(ny + 1)(nz + 1) elements, in slices of whole layers.

        Args:
            box: the first parameter of the kernels; the second is how many elements of a row a thread takes.
            shape: cells.
            calls: kernels, with their other parameters; in a slice, none reads what another slice writes.
            grain: rows of the smallest slice worth a thread.
        """
        span = self.span(shape[2] + 1)
        pieces = -(-(shape[2] + 1) // span)
        layer = (shape[1] + 1) * pieces
        made = [(kernel, [box, span, *more]) for kernel, more in calls]
        self.together(made, (shape[0] + 1) * layer, grain=grain if span > 1 else 1, align=layer)

    def _ready(self, kernel: Any, count: int, inputs: Sequence[Any], grain: int, align: int) -> Pass:
        """A launch, perhaps a kept one."""
        if not self.keeps:
            return self.prepare(kernel, count, inputs, grain=grain, align=align)
        key = (kernel, count, grain, align, *(None if isinstance(one, int | float) else id(one) for one in inputs))
        if key not in self._kept:
            if len(self._kept) >= KEPT:
                self._kept.clear()
            # The pass holds what it was made of, so that no other array takes its place in memory.
            self._kept[key] = self.prepare(kernel, count, inputs, grain=grain, align=align), list(inputs)
        one, before = self._kept[key]
        one.change({k + 1: new for k, (new, old) in enumerate(zip(inputs, before, strict=True)) if new is not old and new != old})
        before[:] = inputs
        return one

    def prepare(self, kernel: Any, count: int, inputs: Sequence[Any], *, grain: int = GRAIN, align: int = 1) -> Pass:
        """The launch of `__call__`, to be made many times."""
        return Pass(kernel, max(0, count), inputs, self.device, smallest=grain, slices=SLICES, align=align)

    def span(self, many: int) -> int:
        """Elements of one thread of a kernel that loops over runs of up to `many`: all on the CPU, one on a GPU."""
        return many if self.device == "cpu" else 1

    def array(self, name: str, count: int, dtype: Any) -> Any:
        """An array of at least `count` elements that is kept under a name; its content is what was last written there."""
        found = self._arrays.get(name)
        if found is None or found.size < count or found.dtype != dtype:
            found = warp().zeros(max(16, count + count // 4), dtype=dtype, device=self.device)
            self._arrays[name] = found
        return found

    def field(self, name: str, count: int) -> Any:
        """As `array`, of float32, with some elements before the first one and after the last; the same view at each call."""
        base = self.array(name, count + 2 * BEFORE, warp().float32)
        known = self._views.get(name)
        if known is None or known[0] is not base or known[1].size != count:
            known = self._views[name] = base, base[BEFORE : BEFORE + count]
        return known[1]

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
