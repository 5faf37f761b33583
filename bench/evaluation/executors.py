"""Where samples run: processes of this machine, or a Ray cluster over a shared file system; nothing else knows which."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from importlib.util import find_spec
from typing import Any, NamedTuple, Protocol

from ...worlds.errors import EngineError, InputError

__all__ = ["EXECUTORS", "Done", "Executor", "LocalExecutor", "RayExecutor", "executor_of", "run_process"]

REPLACED = 3
"""Times that a worker is replaced which died over one piece of work; after that the work itself is to blame."""


class Done(NamedTuple):
    """One piece of work that came to an end."""

    number: int
    """Place among the payloads."""
    result: dict[str, Any]
    deaths: int
    """Workers that died over it before."""


class Executor(Protocol):
    """Runs pieces of work in processes, each until it gave its result once."""

    def map(self, module: str, payloads: Sequence[Mapping[str, Any]]) -> Iterator[Done]:
        """Results as they come; `python -m MODULE` reads a payload from standard input and prints its result as the last line.

        Raises:
            EngineError: a piece of work failed, or killed every worker that took it.
        """
        ...


def run_process(module: str, payload: Mapping[str, Any]) -> tuple[dict[str, Any], int]:
    """Run one piece of work in a process that dies with this one; its result, and how many processes were killed over it.

    Raises:
        EngineError: it failed, or was killed too often.
    """
    told = json.dumps({**payload, "parent": os.getpid()})
    for deaths in range(REPLACED + 1):
        done = subprocess.run([sys.executable, "-P", "-m", module], input=told, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            result: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
            return result, deaths
        if done.returncode > 0:  # it ended by itself
            raise EngineError(f"a piece of work failed: {done.stderr.strip()[-800:]}")
    raise EngineError(f"{REPLACED + 1} processes were killed over one piece of work, the last with signal {-done.returncode}")


class LocalExecutor:
    """Processes of this machine, `workers` at a time."""

    def __init__(self, workers: int) -> None:
        if workers < 1:
            raise InputError(f"workers {workers} must be at least 1")
        self.workers = workers

    def map(self, module: str, payloads: Sequence[Mapping[str, Any]]) -> Iterator[Done]:
        """See `Executor`."""
        with ThreadPoolExecutor(self.workers) as pool:
            waiting = {pool.submit(run_process, module, payload): k for k, payload in enumerate(payloads)}
            for future in as_completed(waiting):
                yield Done(waiting[future], *future.result())


class RayExecutor:
    """Tasks of a Ray cluster, each with one core; a worker that dies is replaced by Ray, and its process dies with it.

    Args:
        address: of the cluster; `local` starts one here with `workers` cores.
        workers: tasks at a time.
    """

    def __init__(self, workers: int, address: str = "local") -> None:
        if find_spec("ray") is None:
            raise EngineError("a cluster needs Ray, which is not installed: pip install 'worldagent[cluster]'")
        self.workers, self.address = workers, address

    def map(self, module: str, payloads: Sequence[Mapping[str, Any]]) -> Iterator[Done]:
        """See `Executor`."""
        import importlib

        ray: Any = importlib.import_module("ray")
        local = {"num_cpus": self.workers, "include_dashboard": False} if self.address == "local" else {}
        with ray.init(address=self.address, log_to_driver=False, **local):
            remote = ray.remote(num_cpus=1, max_retries=REPLACED)(run_process)
            waiting = {remote.remote(module, dict(payload)): k for k, payload in enumerate(payloads)}
            left = list(waiting)
            while left:
                (ready,), left = ray.wait(left, num_returns=1)
                try:
                    result, deaths = ray.get(ready)
                except ray.exceptions.RayError as error:
                    raise EngineError(f"a piece of work failed on the cluster: {str(error)[-800:]}") from error
                yield Done(waiting[ready], result, deaths)


EXECUTORS = ("local", "ray")


def executor_of(name: str, workers: int, address: str = "local") -> Executor:
    """An executor by name.

    Raises:
        InputError: there is none of that name.
        EngineError: Ray is not installed.
    """
    if name not in EXECUTORS:
        raise InputError(f"executor {name!r} must be one of {', '.join(EXECUTORS)}")
    return LocalExecutor(workers) if name == "local" else RayExecutor(workers, address)
