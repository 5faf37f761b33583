"""Independent pieces of work (frames, seeds, parameter sets) spread over processes.

`Executor` is all that the code above knows. `ExecutorLocal` spawns processes of this machine; one over a cluster
joins by the same method. Pieces and results are plain JSON data; arrays go through files.
"""

from __future__ import annotations

import json
import os
import selectors
import signal
import subprocess
import sys
from collections import deque
from collections.abc import Sequence
from typing import Any, Protocol

from ..worlds.errors import EngineError, InputError
from .context import JobContext
from .entries import as_json, check_entry
from .job import as_exception
from .processes import core_count

__all__ = ["Executor", "ExecutorLocal"]

_TICK_S = 0.05


class Executor(Protocol):
    """Somewhere to run many independent pieces."""

    def map(self, fn_path: str, items: Sequence[dict[str, Any]], context: JobContext) -> list[dict[str, Any]]:
        """Results of `fn(item) -> dict` for every item, in the order of the items.

        `fn_path` is `worldagent.module:function`. Progress is the number of pieces done. The first piece that fails
        ends the others.

        Raises:
            Cancelled: The context said so; no piece runs any more.
            WorldAgentError: What a piece raised; EngineError for any other exception and for a process that died.
        """
        ...


class ExecutorLocal:
    """Processes of this machine, spawned per call, each doing one piece after another."""

    def __init__(self, workers: int | None = None) -> None:
        if workers is not None and workers < 1:
            raise InputError(f"workers {workers} must be >= 1")
        self.workers = core_count() if workers is None else workers

    def map(self, fn_path: str, items: Sequence[dict[str, Any]], context: JobContext) -> list[dict[str, Any]]:
        """See `Executor.map`."""
        check_entry(fn_path)
        lines = [as_json(item, f"item {index}").encode() + b"\n" for index, item in enumerate(items)]
        results: list[dict[str, Any]] = [{} for _ in lines]
        waiting = deque(range(len(lines)))
        workers: list[_Worker] = []
        done = 0
        with selectors.DefaultSelector() as selector:
            try:
                for _ in range(min(self.workers, len(lines))):
                    worker = _Worker(fn_path)
                    workers.append(worker)
                    selector.register(worker.reading, selectors.EVENT_READ, worker)
                    worker.give(waiting.popleft(), lines)
                while done < len(lines):
                    context.check()
                    for key, _ in selector.select(_TICK_S):
                        worker = key.data
                        result = worker.take()
                        if result is None:
                            continue
                        results[worker.index] = result
                        done += 1
                        context.progress(done, len(lines), f"{done} of {len(lines)} pieces")
                        if waiting:
                            worker.give(waiting.popleft(), lines)
            finally:
                for worker in workers:
                    worker.process.kill()
                for worker in workers:
                    worker.close()
        return results


class _Worker:
    """One spawned process with a pipe each way."""

    def __init__(self, fn_path: str) -> None:
        their_reading, self._writing = os.pipe()
        self.reading, their_writing = os.pipe()
        self.index = -1
        self._output = b""
        command = [sys.executable, "-P", "-m", f"{__package__}.piece"]
        command += [fn_path, str(their_reading), str(their_writing), str(os.getpid())]
        try:
            # Standard output stays the caller's log: native libraries print there.
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, pass_fds=(their_reading, their_writing))
        except OSError:
            os.close(self._writing)
            os.close(self.reading)
            raise
        finally:
            os.close(their_reading)
            os.close(their_writing)

    def give(self, index: int, lines: list[bytes]) -> None:
        """Hand over the next piece."""
        self.index = index
        rest = memoryview(lines[index])
        try:
            while rest:
                rest = rest[os.write(self._writing, rest) :]
        except BrokenPipeError:
            raise self._died() from None

    def take(self) -> dict[str, Any] | None:
        """Result of the piece if it is complete."""
        data = os.read(self.reading, 1 << 16)
        if not data:
            raise self._died()
        self._output += data
        if not data.endswith(b"\n"):
            return None
        answer, self._output = json.loads(self._output), b""
        if "error" in answer:
            raise as_exception(answer["error"])
        result: dict[str, Any] = answer["result"]
        return result

    def close(self) -> None:
        """Collect the process, which was killed, and close the pipes."""
        self.process.wait()
        os.close(self._writing)
        os.close(self.reading)

    def _died(self) -> EngineError:
        code = self.process.wait()
        how = f"killed by {signal.Signals(-code).name}" if code < 0 else f"ended with exit status {code}"
        return EngineError(f"the process of piece {self.index} was {how}; its output is in the log of the job")
