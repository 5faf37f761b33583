"""Checks of a large world at the static stage that a second process judges, beside those of this one.

What they read was built before and lies in the world's folder; they share no work with the others. The rows are those that this process
would make. A process that dies or does not end is an error that says so, no missing row; and it ends where nobody waits for it any more.
"""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import nullcontext, suppress
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from ..execution import ONE_THREAD, seldom_collected
from ..worlds.built import load_built
from ..worlds.candidate import Candidate
from ..worlds.errors import EngineError, EvidenceError, InputError, RefusedError, WorldAgentError
from ..worlds.folder import WorldFolder
from ..worlds.requirements import Row
from ..worlds.spec import WorldSpec

__all__ = ["Beside", "ahead", "main", "worth_while"]

LARGE = 1500
"""[1] Own choice: parts from which on judging takes longer than starting a process."""
MANY = 200
"""[1] Own choice: entities from which on a world may have so many parts: furniture and clutter have 8 each."""
LONGEST = 1800.0
"""[s] Own choice: a process that has not ended by then after the others were judged is taken for hung."""
LOOK = 2.0
"""[s] Time between two looks whether somebody still waits."""
ERRORS: dict[str, type[WorldAgentError]] = {e.__name__: e for e in (EvidenceError, InputError, RefusedError)}


def worth_while(candidate: Candidate) -> bool:
    """True if a second process may judge some checks: of a large world that was built into its folder, where a core is free for it."""
    if candidate.stage != "static" or sum(len(b.parts) for b in candidate.built.values()) < LARGE:
        return False
    return _a_core_is_free() and all(p.is_file() for p in _files(candidate).values())


def ahead(entities: int, modules: Iterable[str]) -> Beside | nullcontext[None]:
    """A process that loads modules of checks while a world of many entities is still built, where a core is free for it."""
    return Beside(modules) if entities >= MANY and _a_core_is_free() else nullcontext()


def _a_core_is_free() -> bool:
    return (len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1) > 1


def _files(candidate: Candidate) -> dict[str, Path]:
    folder = WorldFolder(candidate.folder)
    return {name: folder.built(name, built.recipe) for name, built in candidate.built.items()}


class Beside:
    """A process that loads modules of checks, then judges some checks of a candidate if asked; ended where it is left early."""

    def __init__(self, modules: Iterable[str] = ()) -> None:
        self.checks: tuple[int, ...] = ()
        """Places in the list of checks of those that it was asked for."""
        self._files = [tempfile.TemporaryFile() for _ in range(2)]  # noqa: SIM115 - closed as this is left
        self._request: Path | None = None
        command = [sys.executable, "-P", "-m", "worldagent.verifiers.beside", str(os.getpid()), *sorted(set(modules))]
        said, errors = self._files
        place = {**ONE_THREAD, **os.environ}
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=said, stderr=errors, env=place)

    def ask(self, candidate: Candidate, checks: Mapping[int, Callable[..., list[Row]]]) -> Beside:
        """Let it judge checks, given by their places in the list of checks; returns itself."""
        self.checks = tuple(checks)
        request = {
            "folder": str(candidate.folder),
            "spec": candidate.spec.model_dump_json(exclude_none=True),
            "files": {name: (str(path), candidate.built[name].digest()) for name, path in _files(candidate).items()},
            "checks": [(f.__module__, f.__name__) for f in checks.values()],
        }
        with tempfile.NamedTemporaryFile("w", suffix=".json", encoding="utf-8", delete=False) as file:
            json.dump(request, file)
        self._request, pipe = Path(file.name), self._process.stdin
        assert pipe is not None
        with suppress(BrokenPipeError), pipe:  # `rows` tells of its death
            pipe.write(f"{self._request}\n".encode())  # so short that a process that hangs holds nobody up
        return self

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        if self._process.stdin is not None:
            with suppress(BrokenPipeError):
                self._process.stdin.close()
        for file in self._files:
            file.close()
        if self._request is not None:
            self._request.unlink(missing_ok=True)

    @cached_property
    def rows(self) -> dict[int, list[Row]]:
        """Rows of each check, by its place in the list.

        Raises:
            WorldAgentError: as a check raised it.
            EngineError: the process died or did not end.
        """
        try:
            code: int | None = self._process.wait(LONGEST)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
            code = None
        answer = _last(self._read(0))
        if code is None or answer is None:
            how = f"was ended after {LONGEST:g} s" if code is None else f"ended with code {code}"
            raise EngineError(f"the process that judges {len(self.checks)} of the checks {how}: {self._read(1)[-800:]}")
        if "error" in answer:
            raise ERRORS.get(answer["error"]["type"], EngineError)(answer["error"]["message"])
        return {k: [Row.model_validate_json(r) for r in rows] for k, rows in zip(self.checks, answer["rows"], strict=True)}

    def _read(self, which: int) -> str:
        self._files[which].seek(0)
        return self._files[which].read().decode("utf-8", "replace")


def _last(text: str) -> dict[str, Any] | None:
    """The JSON object of the last line; what engines print before is no answer."""
    try:
        found = json.loads(text.rstrip().rsplit("\n", 1)[-1])
    except ValueError:
        return None
    return found if isinstance(found, dict) else None


def _end_with(parent: int) -> None:
    """End this process when its parent has."""
    while os.getppid() == parent:
        time.sleep(LOOK)
    os._exit(1)


@seldom_collected()
def main() -> None:
    """Load the modules named, then judge what the request asks for whose path comes on the standard input, and print the rows as JSON."""
    parent, *modules = sys.argv[1:]
    threading.Thread(target=_end_with, args=(int(parent),), daemon=True).start()
    for module in modules:
        importlib.import_module(module)
    path = sys.stdin.readline().rstrip("\n")
    if not path:
        return
    request = json.loads(Path(path).read_text(encoding="utf-8"))
    try:
        kept: dict[bytes, Any] = {}
        built = {n: load_built(Path(path), kept=kept, digest=digest) for n, (path, digest) in request["files"].items()}
        candidate = Candidate(Path(request["folder"]), WorldSpec.model_validate_json(request["spec"]), built, "static")
        judges = [getattr(importlib.import_module(module), name) for module, name in request["checks"]]
        rows = [[r.model_dump_json() for r in judge(candidate)] for judge in judges]
        answer: dict[str, Any] = {"rows": rows}
    except WorldAgentError as error:
        answer = {"error": {"type": type(error).__name__, "message": str(error)}}
    sys.stdout.write("\n" + json.dumps(answer) + "\n")


if __name__ == "__main__":
    main()
