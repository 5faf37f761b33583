"""The verdict of the server about what a sample left, by `worldagent verify` in a fresh process; a folder alone proves nothing."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import anyio
from inspect_ai.scorer import Score, Scorer, Target, mean, scorer
from inspect_ai.solver import TaskState

from ...worlds.errors import WorldAgentError
from ...worlds.folder import WorldFolder, world_ids
from ...worlds.ledger import Ledger
from .attempts import Attempt, attempt_of, device_seconds, settle
from .matrices import matrix_differences
from .serving import server_environment

__all__ = ["judged_worlds", "verified", "verify"]

VERIFY_S = 3600.0
"""Longest judgement of one world [s]."""
MOST_WORLDS = 4
"""Worlds of a sample that are judged, the latest first."""
STATUSES = ("pass", "fail", "unverified", "not_applicable")


async def verify(folder: Path, *, replay: bool, seed: int = 1) -> dict[str, Any]:
    """Answer of `worldagent verify FOLDER` in a fresh process with every check; `refused` where it judges nothing.

    Args:
        folder: of a world.
        replay: simulate intervals again.
        seed: chooses those.
    """
    command = [sys.executable, "-P", "-m", "worldagent.server", "verify", str(folder), "--seed", str(seed)]
    environment = {**_inherited(), **server_environment()}
    try:
        with anyio.fail_after(VERIFY_S):
            done = await anyio.run_process([*command, *(["--replay"] if replay else [])], check=False, env=environment)
    except TimeoutError:
        return {"verdict": "refused", "says": f"the judgement took more than {VERIFY_S:g} s"}
    try:
        found: dict[str, Any] = json.loads(done.stdout)
    except ValueError:
        said = done.stderr.decode(errors="replace").strip().removeprefix("worldagent: ")
        return {"verdict": "refused", "says": said[-800:] or f"verify ended with code {done.returncode}"}
    # Its exit code and its words must agree: 0 only when accepted.
    if (done.returncode == 0) != (found.get("verdict") == "accepted"):
        return {**found, "verdict": "refused", "says": f"verify says {found.get('verdict')!r} and ended with {done.returncode}"}
    return found


def _inherited() -> dict[str, str]:
    import os

    return {k: v for k, v in os.environ.items() if k in ("HOME", "PATH", "USER", "LOGNAME", "SHELL", "TERM")}


async def judged_worlds(attempt: Attempt, *, replay: bool) -> dict[str, dict[str, Any]]:
    """Verdict of every world of a sample that is about its prompt, the latest first, until one is accepted.

    A world of another prompt is none of the sample's: the server keeps a prompt as it was given.
    """
    workspace, found = Path(attempt.workspace), dict[str, dict[str, Any]]()
    names = sorted(world_ids(workspace), key=lambda n: (workspace / n / "world.json").stat().st_mtime, reverse=True)
    for name in names[:MOST_WORLDS]:
        told = _prompt_of(workspace / name)
        if told != attempt.prompt:
            found[name] = {"verdict": "refused", "says": "its prompt is not the sample's, letter by letter"}
            continue
        found[name] = await verify(workspace / name, replay=replay)
        if found[name]["verdict"] == "accepted":
            break
    return found


def _prompt_of(folder: Path) -> str | None:
    try:
        found = json.loads((folder / "world.json").read_text()).get("prompt")
    except (OSError, ValueError, AttributeError):
        return None
    return found if isinstance(found, str) else None


@scorer(metrics={"*": [mean()]})
def verified(replay: bool = True) -> Scorer:
    """One value per figure of a sample: accepted, calls, seconds, rows by status, and what speaks against its isolation."""

    async def score(state: TaskState, target: Target) -> Score:
        await settle(state)
        attempt = attempt_of(state)
        judged = await judged_worlds(attempt, replay=replay)
        best = next((n for n, v in judged.items() if v["verdict"] == "accepted"), next(iter(judged), None))
        nothing: dict[str, Any] = {"verdict": "refused", "says": "no world was made"}
        verdict = nothing if best is None else judged[best]
        calls = attempt.folder.record.calls()
        marks = attempt.folder.record.read("isolation.json")
        known = state.metadata.get("recorded_matrix")
        again = {} if known is None else {"differences": matrix_differences(known, attempt.folder.record.read("matrix.json"))}
        rows: dict[str, int] = verdict.get("rows") or {}
        accepted = verdict["verdict"] == "accepted" and not marks
        return Score(
            value={
                "accepted": float(accepted),
                "calls": float(len(calls)),
                "device_s": round(device_seconds(Path(attempt.workspace)), 3),
                "isolated": float(not marks),
                **{f"rows_{status}": float(rows.get(status, 0)) for status in STATUSES},
            },
            answer=best,
            explanation=str(verdict["says"]),
            metadata={
                "verdict": verdict,
                "worlds": {name: {k: v.get(k) for k in ("verdict", "says")} for name, v in judged.items()},
                "server_verdict": _of_ledger(attempt, best),
                "isolation": marks,
                "refused_calls": sum(c.error for c in calls),
                "silent_calls": sum(c.ended == "silent" for c in calls),
                **again,
            },
        )

    return score


def _of_ledger(attempt: Attempt, world: str | None) -> dict[str, Any]:
    """Last word of the sample's own server, and the weakenings on the way there; for reports, it decides nothing."""
    if world is None:
        return {}
    try:
        ledger = Ledger(WorldFolder.of(Path(attempt.workspace), world).ledger_path)
        latest = ledger.acceptance()
        return {
            "verdict": None if latest is None else latest["verdict"],
            "weakenings": ledger.weakenings(),
            "revisions": ledger.revision(),
            "ablation": ledger.ablation(),
        }
    except WorldAgentError as error:
        return {"damaged": str(error)}
