"""`worldagent eval skills`: the short set against two states of the skill and tool texts, and what moved between them.

Each state serves from its own tree; both are judged by this installation's `verify`, so that no state judges itself.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...worlds.errors import InputError, RefusedError
from .compare import differences, told_difference
from .figures import run_figures
from .results import counts_of
from .runs import run_name
from .serving import ENV_SERVER

if TYPE_CHECKING:
    from inspect_ai.log import EvalLog

__all__ = ["WATCHED", "compare_states", "differing_texts", "server_of_tree", "this_server", "tree_of"]

WATCHED = ("accepted", "calls", "refused_calls")
"""Figures of which it is said whether they moved."""
HERE = Path(__file__).resolve().parents[2]
TEXTS = ("skills", "tools")
"""Folders whose files an agent reads: skills, and tools with their descriptions."""
PACKAGE = ".types"
"""Folder of a tree in which the package has its name (a link), to be put on the path of modules."""


@contextmanager
def tree_of(against: str) -> Iterator[Path]:
    """The tree of another state: a folder, or a git revision of this one, unpacked for as long as it is needed.

    Raises:
        InputError: it is neither.
    """
    folder = Path(against)
    if folder.is_dir():
        _need_tree(folder)
        yield folder.resolve()
        return
    packed = subprocess.run(
        ["git", "archive", "--format=tar", "--end-of-options", against], cwd=HERE, capture_output=True, check=False
    )
    if packed.returncode:
        said = packed.stderr.decode(errors="replace").strip().splitlines()
        raise InputError(
            f"--against {against!r} is neither a folder nor a revision of {str(HERE)!r}: {said[-1] if said else 'git failed'}"
        )
    with tempfile.TemporaryDirectory(prefix="worldagent-state-") as place:
        with tarfile.open(fileobj=BytesIO(packed.stdout)) as archive:
            archive.extractall(place, filter="data")
        _need_tree(Path(place))
        yield Path(place)


def _need_tree(folder: Path) -> None:
    if not (folder / PACKAGE / "worldagent" / "server").is_dir():
        raise InputError(f"{str(folder)!r} is no tree of worldagent: it lacks {PACKAGE}/worldagent/server")


def this_server() -> str:
    """Server of this installation as the environment names one (`serving.ENV_SERVER`)."""
    return os.pathsep.join([sys.executable, "-P", "-m", "worldagent.server", "serve", "--workspace", "{workspace}"])


def server_of_tree(tree: Path) -> str:
    """Server of another tree: its modules come before what is installed, in its workers too."""
    return os.pathsep.join(["env", f"PYTHONPATH={tree / PACKAGE}", this_server()])


def differing_texts(other: Path, this: Path = HERE) -> dict[str, list[str]]:
    """Files that differ, by relative path: `texts` of skills and tools, and whatever `else` of the product may have moved figures as well."""
    found: dict[str, list[str]] = {"texts": [], "else": []}
    before, after = _digests(other), _digests(this)
    for name in sorted(before.keys() | after.keys()):
        if before.get(name) != after.get(name):
            found["texts" if name.partition("/")[0] in TEXTS else "else"].append(name)
    return found


def _digests(tree: Path) -> dict[str, str]:
    kinds = (".py", ".md", ".json", ".txt")
    places = [p for p in tree.iterdir() if p.is_dir() and not p.name.startswith(".") and p.name not in ("tests", "docs")]
    files = [f for p in places for f in p.rglob("*") if f.suffix in kinds and f.is_file() and "__pycache__" not in f.parts]
    return {f.relative_to(tree).as_posix(): hashlib.sha256(f.read_bytes()).hexdigest() for f in files}


@contextmanager
def _served_by(server: str) -> Iterator[None]:
    """Make this the server of every sample, for a while."""
    before = os.environ.get(ENV_SERVER)
    os.environ[ENV_SERVER] = server
    try:
        yield
    finally:
        if before is None:
            del os.environ[ENV_SERVER]
        else:
            os.environ[ENV_SERVER] = before


def compare_states(states: Mapping[str, str], run: Callable[[str], EvalLog], *, seed: int = 1) -> dict[str, Any]:
    """Run a task once per state, and say what moved from the first to the second.

    Args:
        states: name and server of two states, the earlier one first.
        run: runs the task with any agent, and returns its log; it gets the name of the state.
        seed: of the draws.

    Raises:
        RefusedError: no prompt has values in both runs, since samples of one were errors.
    """
    logs: dict[str, EvalLog] = {}
    for name, server in states.items():
        with _served_by(server):
            logs[name] = run(name)
    figures = {name: run_figures(log) for name, log in logs.items()}
    before, after = figures.values()
    moved = differences(before, after, WATCHED, seed=seed)
    if len(moved) < len(WATCHED):
        reasons = {name: [f"{r.id}: {r.reason}" for r in f.results if r.outcome == "error"][:3] for name, f in figures.items()}
        raise RefusedError(
            f"nothing can be compared: no prompt has {', '.join(w for w in WATCHED if w not in moved)} in both runs; errors: {reasons}"
        )
    return {
        "states": {
            n: {
                "run": run_name(log),
                "log": log.location,
                "outcomes": counts_of(list(figures[n].results)),
                "tools_sha256": _tools(log),
            }
            for n, log in logs.items()
        },
        "figures": moved,
        "moved": [name for name in WATCHED if moved[name]["moved"]],
        "says": verdict_lines(moved),
    }


def verdict_lines(moved: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """One line per figure."""
    return [told_difference(name, dict(moved[name])) for name in WATCHED]


def _tools(log: EvalLog) -> Sequence[str]:
    return sorted({str(s.metadata["preflight"]["tools_digest"]) for s in log.samples or () if s.metadata.get("preflight")})
