"""Kernels prepared once and launched often: slices over threads on a CPU, plain launches or one graph on a GPU.

`geometry/launch.py` launches single kernels; a step of a solver launches a hundred small ones over the same arrays, so their
arguments are packed once here and only replayed. Kernels take the index of their first element first, as there.

Sums keep one order on a device, however many threads share the work. A kernel that folds many elements into few takes
(first, span, width, total, ...): the `width` threads of a block take `span` elements each, side by side, and store what they have
together at t / width:

    t = first + wp.tid()
    start = (t / width) * span * width + t % width
    s = wp.float64(0.0)
    for i in range(start, wp.min(start + span * width, total), width):
        s += wp.float64(values[i])
    wp.tile_store(partial, wp.tile_sum(wp.tile(s)), offset=t / width)

A second kernel of `width` threads closes it over the `Passes.parts(total)` partial results (`sum_kernels.py` has both for sums).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import cache, partial
from itertools import pairwise
from operator import is_
from typing import Any

from ..geometry.launch import cores, load, warp
from .team import team

__all__ = ["ALONE", "FEW", "Chain", "Pass", "Passes", "Waves"]

SMALLEST = 256
"""Elements below which a slice is not worth a thread; also what one thread of a CPU folds."""
FEW = 32
"""Threads of a block for kernels in which most threads have nothing to do and some much: a block waits for its slowest thread."""
ALONE = 1 << 60
"""For kernels with tiles: on a CPU all threads share Warp's one pointer to the memory of tiles (1.19, x86-64), so these run in one."""
SLICES = 2
"""Slices of one thread: others take the rest where it is held up."""
BLOCK, FOLDED = 256, 8
"""Threads of a block on a GPU (Warp's default), and what one of them folds."""


@cache
def _packs() -> bool:
    """True if launches on a CPU are what `Packed` knows: a private part of Warp, which another version may change."""
    return str(warp().__version__).startswith("1.19.")


class Packed:
    """A launch whose arguments on a CPU are packed once; Warp packs them anew each time (3 to 5 microseconds, where the call takes 1).

    Args:
        launch: as Warp recorded it.
    """

    def __init__(self, launch: Any) -> None:
        self.launch = launch
        self.call: Callable[[], None] = launch.launch
        self._args: Any = None
        if launch.device.is_cpu and launch.block_dim <= 1 and _packs():
            values = launch.params[1:]
            fields = [(f"at_{n}", type(value)) for n, value in enumerate(values)]
            self._args = type("Arguments", (ctypes.Structure,), {"_fields_": fields})(*values)
            self.call = partial(launch.hooks.forward, ctypes.byref(launch.params[0]), ctypes.byref(self._args))

    def change(self, place: int, value: Any) -> None:
        """Take over a new value of a number, by its place among the kernel's parameters."""
        self.launch.set_param_at_index(place, value)
        if self._args is not None:
            setattr(self._args, f"at_{place}", self.launch.params[place + 1])


class Pass:
    """One kernel with its arguments over `count` elements; call it to run it.

    Args:
        kernel: a kernel whose first parameter is the index of its first element.
        count: elements.
        inputs: its other parameters.
        device: where they are.
        smallest: elements below which a slice is not worth a thread.
        slices: of each core.
        align: slices begin at whole multiples of so many elements.
        block: threads of a block on a GPU.
    """

    def __init__(
        self,
        kernel: Any,
        count: int,
        inputs: Sequence[Any],
        device: str,
        *,
        smallest: int = SMALLEST,
        slices: int = SLICES,
        align: int = 1,
        block: int = BLOCK,
    ) -> None:
        self._block: dict[str, Any] = {} if device == "cpu" else {"block_dim": block}
        load(kernel, device, **self._block)
        self.kernel, self.device, self.smallest, self.slices, self.align = kernel, device, smallest, slices, align
        self.name = str(kernel.key)
        self.changes = 0
        """Number of times that its numbers have changed."""
        self._prepare(count, inputs)

    def _prepare(self, count: int, inputs: Sequence[Any]) -> None:
        self.count, self.inputs = count, tuple(inputs)
        parts = self._parts(count)
        cuts = [count * k // parts // self.align * self.align for k in range(parts)] + [count]
        self.launches = [self.part(first, end) for first, end in pairwise(cuts) if end > first]
        self._calls = [one.call for one in self.launches]

    def part(self, first: int, end: int) -> Packed:
        """A launch over some of the elements, as they are now."""
        inputs, dim = [first, *self.inputs], end - first
        return Packed(warp().launch(self.kernel, dim=dim, inputs=inputs, device=self.device, record_cmd=True, **self._block))

    def _parts(self, count: int) -> int:
        shared = self.device == "cpu" and cores() > 1
        return max(1, min(self.slices * cores(), count // self.smallest)) if shared else 1

    def takes(self, count: int, inputs: Sequence[Any]) -> bool:
        """True if all but its whole numbers are just these; it then takes those, and `count`, from now on."""
        if len(inputs) != len(self.inputs):
            return False
        pairs = list(zip(inputs, self.inputs, strict=True))
        if not all(a is b or (isinstance(a, float) and a == b) or isinstance(a, int) for a, b in pairs):
            return False
        others = [k for k, (a, b) in enumerate(pairs) if isinstance(a, int) and a != b]
        if count == self.count and not others:
            return True
        self.changes += 1
        if len(self.launches) != 1 or self._parts(count) != 1 or count == 0:
            self._prepare(count, inputs)
            return True
        self.count, self.inputs = count, tuple(inputs)
        launch = self.launches[0].launch
        launch.set_dim(count)
        for k in others:
            launch.set_param_at_index(k + 1, inputs[k])
        self.launches = [Packed(launch)]
        self._calls = [self.launches[0].call]
        return True

    def __call__(self, changed: dict[int, float] | None = None) -> None:
        """Run over all elements; on a CPU it has ended when this returns, on a GPU it is queued.

        Args:
            changed: new values of numbers, by their place among the kernel's parameters.
        """
        self.change(changed or {})
        if len(self.launches) > 1:
            team(cores() - 1)(self._calls)
            return
        for call in self._calls:
            call()

    def change(self, changed: dict[int, float]) -> None:
        """Take over new values of numbers, by their place among the kernel's parameters."""
        for place, value in changed.items():
            for one in self.launches:
                one.change(place, value)

    @staticmethod
    def together(passes: Sequence[Pass]) -> None:
        """Run passes of one count and alignment one after the other, each slice through all of them while its fields are at hand: what a
        slice reads, no other one writes."""
        if passes[0].device != "cpu" or len({len(one.launches) for one in passes}) > 1 or len(passes[0].launches) == 1:
            for one in passes:
                one()
            return

        def follow(calls: tuple[Callable[[], None], ...]) -> None:
            for call in calls:
                call()

        slices = zip(*(one._calls for one in passes), strict=True)
        team(cores() - 1)([partial(follow, calls) for calls in slices])


class Waves:
    """Passes over the same layers, made one after the other, each of which may read what the ones before wrote one layer beyond its own.

    On a CPU a slice of layers goes through all of them while its fields are at hand: each takes a layer less at both ends than the one
    before, and when all slices have come so far, what is left around their ends. The result is that of whole passes, bit for bit.

    Args:
        passes: of one count; the first reads no other layer. One that others follow changes nothing that these read of the layer beside
            (such as cells of one colour of two).
        layer: elements of one layer.
    """

    def __init__(self, passes: Sequence[Pass], layer: int) -> None:
        self.passes = list(passes)
        layers, reach = passes[0].count // layer, len(passes) - 1
        parts = min(SLICES * cores(), layers // max(1, 2 * reach + 1)) if passes[0].device == "cpu" else 1
        cuts = [layers * k // max(1, parts) for k in range(max(1, parts) + 1)]
        self._stages: list[list[Callable[[], None]]] = []
        if parts > 1:
            last = len(cuts) - 2
            slices = [
                [(lo + n * (k > 0), hi - n * (k < last)) for n in range(reach + 1)] for k, (lo, hi) in enumerate(pairwise(cuts))
            ]
            borders = [[(cut - n, cut + n) for n in range(reach + 1)] for cut in cuts[1:-1]]
            self._stages = [[self._follow(ranges, layer) for ranges in stage] for stage in (slices, borders)]

    @property
    def sliced(self) -> bool:
        """True where slices go through all passes."""
        return bool(self._stages)

    def _follow(self, ranges: Sequence[tuple[int, int]], layer: int) -> Callable[[], None]:
        parts = zip(self.passes, ranges, strict=True)
        launches = [one.part(lo * layer, hi * layer) for one, (lo, hi) in parts if hi > lo]

        def follow() -> None:
            for one in launches:
                one.call()

        return follow

    def __call__(self) -> None:
        """Run all passes over all layers."""
        for stage in self._stages:
            if cores() > 1:
                team(cores() - 1)(stage)
            else:
                for call in stage:
                    call()
        if not self._stages:
            for one in self.passes:
                one()


class Passes:
    """Prepared passes by name; of each the two last ones are kept, since a step reads what the next one writes and back.

    A name and its arrays stand for one pass: when it is asked for with another count or other whole numbers (particles come and
    go), it goes on with those. What is to be held with several numbers at once needs several names.
    """

    def __init__(self, device: str) -> None:
        self.device = device
        self.graphs = device != "cpu"
        """True if chains run as graphs."""
        self.span, self.width = (SMALLEST, 1) if device == "cpu" else (FOLDED, BLOCK)
        """Elements of a thread, and threads of a block, where a kernel folds many elements into few."""
        self._chains: dict[str, list[Chain]] = {}
        self._known: dict[str, list[Pass]] = {}

    def __call__(
        self, name: str, kernel: Any, count: int, inputs: Sequence[Any], *, smallest: int = SMALLEST, block: int = BLOCK
    ) -> Pass:
        """The pass of this name with these arguments."""
        known = self._known.setdefault(name, [])
        for one in known:
            if one.kernel is kernel and one.takes(count, inputs):
                return one
        made = Pass(kernel, count, inputs, self.device, smallest=smallest, block=block)
        self._known[name] = [*known[-1:], made]
        return made

    def parts(self, total: int) -> int:
        """Partial results that a fold of `total` elements leaves."""
        return -(-total // (self.span * self.width))

    def fold(self, name: str, kernel: Any, total: int, inputs: Sequence[Any]) -> Pass:
        """A pass that folds `total` elements into `parts(total)` (see the module's text)."""
        threads = self.parts(total) * self.width
        return self(name, kernel, threads, [self.span, self.width, total, *inputs], smallest=ALONE)

    def close(self, name: str, kernel: Any, total: int, inputs: Sequence[Any]) -> Pass:
        """A pass of one block over the partial results of `total` elements; its kernel takes (first, width, parts, ...)."""
        return self(name, kernel, self.width, [self.width, self.parts(total), *inputs], smallest=self.width)

    def sum(self, name: str, values: Any, total: int, partial: Any, result: Any) -> list[Pass]:
        """Passes that sum the first `total` values of an array in an order that is always the same.

        Args:
            name: of the passes.
            values: float32 (n, columns).
            total: rows to sum.
            partial: float64 (columns, >= parts(total)): room.
            result: float64 (columns,): stays on the device.
        """
        from . import sum_kernels as kernels

        return [
            self.fold(name, kernels.fold, total, [values, partial]),
            self.close(name + "_close", kernels.close, total, [partial, result]),
        ]

    def greatest(self, name: str, counts: Any, total: int, partial: Any, result: Any) -> int:
        """The greatest of the first `total` counts; see `seek_greatest`."""
        for one in self.seek_greatest(name, counts, total, partial, result):
            one()
        return int(result.numpy()[0])

    def seek_greatest(self, name: str, counts: Any, total: int, partial: Any, result: Any) -> list[Pass]:
        """Passes that find the greatest of the first `total` counts.

        Args:
            name: of the passes.
            counts: int32 (n,).
            total: counts to look at.
            partial: int32 (>= parts(total),): room.
            result: int32 (>= 1,): its first place takes it.
        """
        from . import sum_kernels as kernels

        return [
            self.fold(name, kernels.greatest, total, [counts, partial]),
            self.close(name + "_close", kernels.close_greatest, total, [partial, result]),
        ]

    def chain(self, name: str, passes: Sequence[Callable[[], None]], *, going: Any = None) -> Chain:
        """Passes to run after each other; the graph of the same ones is used again.

        Args:
            name: of the chain.
            passes: what to run.
            going: int32 (1,) on the device that the passes write: they run again and again until it is 0. Without, once.
        """
        known = self._chains.setdefault(name, [])
        for one in known:
            if one.fits(passes, going, graph=self.graphs):
                return one
        made = Chain(passes, self.device, going=going, graph=self.graphs)
        self._chains[name] = [*known[-1:], made]
        return made


class Chain:
    """Passes that always run after each other, once or until they end it themselves: one graph on a GPU."""

    def __init__(self, passes: Sequence[Callable[[], None]], device: str, *, going: Any, graph: bool) -> None:
        self.passes = list(passes)
        self.device, self.going, self.graph = device, going, graph
        self._graph: Any = None
        self._changes: list[int] = []

    def fits(self, passes: Sequence[Callable[[], None]], going: Any, *, graph: bool) -> bool:
        """True if it was made of just these."""
        same = len(self.passes) == len(passes) and all(map(is_, self.passes, passes))
        return same and going is self.going and graph == self.graph

    def __call__(self) -> None:
        """Run all passes in order."""
        wp = warp()
        if not self.graph or (self.going is not None and not wp.is_conditional_graph_supported()):
            self._run()
            return
        changes = [getattr(one, "changes", 0) for one in self.passes]
        if self._graph is None or changes != self._changes:
            self._changes = changes
            with wp.ScopedCapture(device=self.device, force_module_load=False) as capture:
                self._run()
            self._graph = capture.graph
        wp.capture_launch(self._graph)

    def _run(self) -> None:
        if self.going is None:
            self._once()
        else:
            warp().capture_while(self.going, self._once)

    def _once(self) -> None:
        for one in self.passes:
            one()
