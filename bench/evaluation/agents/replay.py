"""An agent that makes the calls of a recorded run again, for its verdicts to be compared bit for bit."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from inspect_ai.model import ModelOutput
from inspect_ai.solver import Generate, Solver, TaskState, solver

from ....worlds.errors import InputError
from ..attempts import Attempt, conduct
from ..records import Call, Record

__all__ = ["Step", "recording_of", "replay", "steps_of", "verdict_in"]

WAIT_S = 25.0
RUNNING = ("queued", "running")
_VERDICT = ("verdict", "says", "passed", "static_passed", "complete", "freeze", "cache_digest", "counts", "frames")
"""Members of a reply that are a verdict or follow from one."""


@dataclass(frozen=True)
class Step:
    """One call of a recording, with what came of it in the end: where it started a job, the job's result."""

    tool: str
    arguments: Mapping[str, Any]
    error: bool
    outcome: Mapping[str, Any]
    """Its verdicts."""


def verdict_in(data: Any) -> dict[str, Any]:
    """The verdicts of a reply: its own, those of its audit, and the ids and statuses of its open rows."""
    if not isinstance(data, Mapping):
        return {}
    found = {k: data[k] for k in _VERDICT if k in data}
    if isinstance(data.get("audit"), Mapping):
        found["audit"] = verdict_in(data["audit"])
    if isinstance(data.get("open_rows"), Sequence):
        found["open_rows"] = [[r.get("id"), r.get("status")] for r in data["open_rows"] if isinstance(r, Mapping)]
    return found


def steps_of(calls: Sequence[Call]) -> list[Step]:
    """Steps of a recording, calls that only waited for a job left out: how often one waits is a matter of the machine."""
    results = dict(_results(calls))
    found = []
    for call in sorted(calls, key=lambda c: c.n):
        data = call.data if isinstance(call.data, Mapping) else {}
        if call.ended != "answered" or (
            call.tool == "job" and not call.error and call.arguments.get("action") in ("wait", "status")
        ):
            continue
        if data.get("state") in RUNNING and data.get("job_id") in results:
            data = results[data["job_id"]]
        found.append(Step(call.tool, call.arguments, call.error, verdict_in(data)))
    return found


def _results(calls: Sequence[Call]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    for call in calls:
        data = call.data
        if (
            call.tool == "job"
            and isinstance(data, Mapping)
            and data.get("state") == "done"
            and isinstance(data.get("result"), Mapping)
        ):
            yield str(data.get("job_id") or call.arguments.get("job_id")), data["result"]


def recording_of(run: Path, sample: str) -> Record:
    """The record of a sample in the folder of a run; the latest attempt.

    Raises:
        InputError: the run holds none.
    """
    found = []
    for folder in sorted((run / "records").glob("*")):
        start = Record(folder).read("start.json")
        if start is not None and start["sample"] == sample and (folder / "calls.jsonl").is_file():
            found.append(folder)
    if not found:
        raise InputError(
            f"{str(run)!r} holds no record of the sample {sample!r}; give the folder of a run, with outputs/ and records/"
        )
    return Record(max(found, key=lambda f: (f / "calls.jsonl").stat().st_mtime))


@solver
def replay(recording: str) -> Solver:
    """Makes the calls of a recorded run again; it needs no model.

    Args:
        recording: folder of that run, with `outputs/` and `records/`.
    """
    run = Path(recording).absolute()

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        record = recording_of(run, str(state.sample_id))
        steps, differences = steps_of(record.calls()), list[str]()
        state.metadata["recorded_matrix"] = _renamed(record, state)

        async def work(attempt: Attempt) -> None:
            old, new = record.folder.name, attempt.example
            async with attempt.client() as client:
                for number, step in enumerate(steps, start=1):
                    arguments = json.loads(json.dumps(dict(step.arguments)).replace(f'"{old}"', f'"{new}"'))
                    data, error = await _called(client, step.tool, arguments)
                    outcome = verdict_in(data)
                    if (error, outcome) != (step.error, dict(step.outcome)):
                        differences.append(
                            f"step {number}, {step.tool}: was {step.error, dict(step.outcome)}, is {error, outcome}"
                        )
            state.metadata["replay"] = {"steps": len(steps), "differences": differences}
            state.output = ModelOutput.from_content(
                "replay", "\n".join(differences) or f"{len(steps)} steps, each with the same verdict"
            )

        return await conduct(state, work)

    return solve


def _renamed(record: Record, state: TaskState) -> dict[str, Any]:
    """The recorded matrices, with the world that is named after its sample's folder under its present name."""
    known, new = record.read("matrix.json") or {}, str(state.metadata["attempt"]["example"])
    return {new if name == record.folder.name else name: matrix for name, matrix in known.items()}


async def _called(client: Any, tool: str, arguments: dict[str, Any]) -> tuple[Any, bool]:
    """Data of a call, of its job where it started one, and whether it was refused."""
    result = await client.call_tool(tool, arguments)
    data = _data(result)
    while not result.is_error and isinstance(data, Mapping) and data.get("state") in RUNNING and tool != "job":
        waited = await client.call_tool("job", {"action": "wait", "job_id": data["job_id"], "wait_s": WAIT_S})
        answer = _data(waited)
        if waited.is_error or answer["state"] not in (*RUNNING, "done"):
            return answer, True
        data = answer["result"] if answer["state"] == "done" else answer
    return data, bool(result.is_error)


def _data(result: Any) -> Any:
    if result.structured_content is not None:
        return result.structured_content
    text = next((b.text for b in result.content if b.type == "text"), "")
    try:
        return json.loads(text)
    except ValueError:
        return text
