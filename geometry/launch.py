"""Run Warp kernels on every core or on a GPU: where to run, slices over threads, compilation that is reported.

Warp runs a launch on the CPU in one thread, but lets go of Python's lock meanwhile. A kernel that only gathers (thread
i writes nothing that another thread reads or writes) is therefore cut into slices that several Python threads launch
side by side; the result is the same bit for bit however it is cut. Such a kernel takes the index of its first element
as its first parameter:

    @wp.kernel
    def double(first: wp.int32, values: wp.array(dtype=wp.float64)):
        i = first + wp.tid()
        values[i] = values[i] + values[i]

    launch(double, count, [values], device="cpu")

On CUDA it is one plain launch with `first` = 0. Warp is imported on first use only.
"""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

from ..worlds.errors import InputError

__all__ = ["ENV_DEVICE", "chosen_device", "cores", "launch", "load", "warp"]

ENV_DEVICE = "WORLDAGENT_DEVICE"
"""Environment variable that names the device of batched queries: `cpu` (default) or `cuda`, `cuda:1`, ..."""
SLICE = 512
"""Elements of one slice on the CPU. Own choice: some milliseconds of work, against 30 microseconds for a launch."""

_log = logging.getLogger(__name__)
_loaded: set[tuple[str, str, int | None]] = set()
_starting, _loading = threading.Lock(), threading.Lock()


@cache
def warp() -> Any:
    """The `warp` module, initialised without its banner."""
    with _starting:  # tools run in threads, and two starts at once make two runtimes
        import warp as wp

        wp.config.log_level = wp.LOG_WARNING
        wp.init()
    return wp


def chosen_device(device: str | None = None) -> str:
    """The device to run on: `device`, or the one that `$WORLDAGENT_DEVICE` names, or the CPU.

    Raises:
        InputError: there is no such device here.
    """
    name = device or os.environ.get(ENV_DEVICE) or "cpu"
    if name != "cpu":
        wp = warp()
        known = [d.alias for d in wp.get_devices()]
        if name not in known and not (name == "cuda" and wp.is_cuda_available()):
            raise InputError(f"device {name!r} is not here; use one of {', '.join(known)} ({ENV_DEVICE} names the default)")
    return name


def cores() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def load(kernel: Any, device: str, *, report: Callable[[str], None] | None = None, block_dim: int | None = None) -> None:
    """Compile the module of a kernel for a device, or load it from Warp's cache folder, which survives the process.

    Args:
        kernel: any kernel of the module.
        device: where it will run.
        report: hears of it before a compilation that may take half a minute; the log does in any case.
        block_dim: threads of a block, where they are not Warp's default; each number is a compilation of its own.
    """
    key = (kernel.module.name, device, block_dim)
    if key in _loaded:
        return
    with _loading:
        if key in _loaded:
            return
        wp = warp()
        text = f"preparing {kernel.module.name.rsplit('.', 1)[-1]} for {device} (compiled at first use, then kept)"
        _log.info(text)
        if report is not None:
            report(text)
        start = time.perf_counter()
        kernel.module.load(wp.get_device(device), block_dim)
        _log.info("prepared %s for %s in %.1f s", kernel.module.name, device, time.perf_counter() - start)
        _loaded.add(key)


def launch(kernel: Any, count: int, inputs: Sequence[Any], *, device: str, slice_size: int | None = None) -> None:
    """Run a gathering kernel over `count` elements and wait for it.

    Args:
        kernel: its first parameter is the index of the first element of a slice (see the module's text).
        count: number of elements.
        inputs: the other parameters.
        device: where to run; arrays among `inputs` live there.
        slice_size: elements per slice on the CPU; the result does not depend on it.
    """
    if count <= 0:
        return
    wp = warp()
    load(kernel, device)
    if device != "cpu":
        wp.launch(kernel, dim=count, inputs=[0, *inputs], device=device)
        wp.synchronize_device(device)
        return
    size = slice_size or SLICE

    def run(first: int) -> None:
        wp.launch(kernel, dim=min(size, count - first), inputs=[first, *inputs], device="cpu")

    threads = min(cores(), -(-count // size))
    if threads == 1:
        for first in range(0, count, size):
            run(first)
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(run, range(0, count, size)))
