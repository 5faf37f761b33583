"""Benchmark `server-load`: eight clients on one HTTP server, 200 mixed calls each, while four bakes run.

The clients are those of the SDK, half of them in each protocol era, in two processes apart from the server. The calls are the cheap ones of an agent at work: reading worlds, small edits of its own world, audits,
jobs, resources, completions, lists. The bakes run in worker processes, as a client starts them. Three rounds: in the
first two the clients call without a pause, eight calls always under way, which shows errors and growing memory, and how many calls
the machine takes; there the clients' own processor time (three times the server's) makes most of the delay. In the third every
client pauses between calls as an agent does that at least reads the answer (`PAUSE_S`): its delays are the figures.

Targets: no error, 95 % of the calls within 200 ms, memory that does not grow with calls.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import random
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any

__all__ = ["BAKES", "CALLS", "CLIENTS", "run"]

CLIENTS = 8
CALLS = 200
BAKES = 4
PROCESSES = 2
PAUSES_S = (0.0, 0.0, 0.8)
"""Mean pause of a client between two calls, per round [s]; own choice: no model answers faster."""
WAIT_S = 240.0
BAKE_FRAMES = 18_000
"""More than the load lasts."""
RISING_MB = 8.0
"""Growth of the second round [MB] above which it is reported as growing: own choice, some 5 kB a call."""
MIX: tuple[tuple[int, str], ...] = (
    (12, "overview"),
    (10, "spec"),
    (10, "matrix"),
    (4, "revisions"),
    (14, "edit"),
    (8, "audit"),
    (8, "job list"),
    (10, "job status"),
    (8, "read spec"),
    (4, "read report"),
    (4, "read worlds"),
    (6, "tools/list"),
    (2, "completion"),
)
"""Weights of the calls."""


def run() -> dict[str, Any]:
    """Figures of both rounds; the second one counts."""
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        workspace = Path(folder)
        jobs = _prepare(workspace)
        stack.callback(_stop, workspace)
        url, server = stack.enter_context(_served(workspace))
        _start_bakes(workspace)
        watched = stack.enter_context(_watched(server.pid))
        rounds = []
        for number, pause in enumerate(PAUSES_S):
            begin, spent = len(watched), _cpu_seconds(server.pid)
            samples, errors, seconds = _round(url, jobs, seed=number, pause=pause)
            figures = _figures(samples, errors, seconds, watched[begin:])
            figures["server_cpu_ms_per_call"] = round((_cpu_seconds(server.pid) - spent) / len(samples) * 1e3, 1)
            rounds.append(figures | {"bakes_at_end": _baking(workspace)})
            print(f"round {number}: {json.dumps(rounds[-1])}", file=sys.stderr)
        last = rounds[-1]
        if last["bakes_at_end"] < BAKES:
            print(f"only {last['bakes_at_end']} of {BAKES} bakes lasted: raise BAKE_FRAMES", file=sys.stderr)
        return {
            **last,
            "peak_mb": max(watched),
            "pause_s": PAUSES_S[-1],
            "without_pause": [
                {k: r[k] for k in ("median_ms", "p95_ms", "calls_per_s", "errors", "grown_mb")} for r in rounds[:-1]
            ],
            "all_errors": sum(r["errors"] for r in rounds),
            "grows": last["grown_mb"] > RISING_MB,
            "clients": CLIENTS,
            "bakes": BAKES,
        }


def _specification() -> tuple[str, dict[str, Any]]:
    """Prompt and specification of an accepted world of six entities."""
    spec = json.loads((files("worldagent.testing.defects") / "accepted" / "three_blocks.json").read_text())
    return spec.pop("prompt"), spec


def _prepare(workspace: Path) -> list[str]:
    """One probed world per bake, one world per client; ids of the probe's job."""
    prompt, spec = _specification()
    long = json.loads(json.dumps(spec))
    long["simulation"]["frames"] = BAKE_FRAMES
    (shot,) = long["shots"].values()
    shot["frames"] = [0, BAKE_FRAMES - 1]
    for solver in long["simulation"]["solvers"].values():
        solver["settings"]["sleep"] = False

    async def make() -> list[str]:
        from mcp import Client

        from ..server.app import create_server

        async with Client(create_server(workspace)) as client:

            async def call(tool: str, **arguments: Any) -> dict[str, Any]:
                answer = await client.call_tool(tool, arguments)
                if answer.is_error:
                    raise RuntimeError(f"{tool}: {answer.content}")
                found: dict[str, Any] = json.loads(answer.content[0].text)  # type: ignore[union-attr]
                return found

            for k in range(CLIENTS):
                await call("edit_spec", world=f"own{k}", prompt=prompt, spec=spec)
            await call("edit_spec", world="bake0", prompt=prompt, spec=long)
            probe = await call("probe_sim", world="bake0", wait_s=0)
            deadline = time.monotonic() + WAIT_S
            while (await call("job", action="wait", job_id=probe["job_id"], wait_s=20))["state"] in ("queued", "running"):
                if time.monotonic() > deadline:
                    raise RuntimeError("the probe does not end")
            return [str(probe["job_id"])]

    jobs = asyncio.run(make())
    for k in range(1, BAKES):
        shutil.copytree(workspace / "bake0", workspace / f"bake{k}")
    return jobs


def _start_bakes(workspace: Path) -> None:
    """Start all bakes at once, whatever the number of cores is, and wait until each has written frames."""
    from ..execution import JobStore, Terms

    store = JobStore(workspace, slots=BAKES)
    for k in range(BAKES):
        folder = workspace / f"bake{k}"
        store.submit(
            "bake", folder.name, {"folder": str(folder)}, entry="worldagent.workflow.jobs:bake", terms=Terms(exclusive=True)
        )
    deadline = time.monotonic() + WAIT_S
    while any(not list((workspace / f"bake{k}").glob("candidates/*/bake/*/frame_000010.npz")) for k in range(BAKES)):
        if time.monotonic() > deadline:
            raise RuntimeError(f"the bakes do not start: {[(j.state, j.error) for j in store.list()]}")
        time.sleep(0.2)


def _baking(workspace: Path) -> int:
    from ..execution import JobStore

    return len([j for j in JobStore(workspace, slots=BAKES).list(state="running") if j.kind == "bake"])


def _stop(workspace: Path) -> None:
    from ..execution import JobStore

    store = JobStore(workspace, slots=BAKES)
    for job in store.list(state="running"):
        store.request_cancel(job.id)
    for job in store.list(state="running"):
        store.wait(job.id, 5.0)


@contextlib.contextmanager
def _served(workspace: Path) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    command = [sys.executable, "-P", "-m", "worldagent.server", "serve", "--transport", "http", "--port", "0"]
    with subprocess.Popen([*command, "--workspace", str(workspace)], stderr=subprocess.PIPE, text=True) as child:
        assert child.stderr is not None
        line = ""
        while "http://" not in line:
            line = child.stderr.readline()
            if not line:
                raise RuntimeError("the server did not start")
        threading.Thread(target=lambda: [sys.stderr.write(text) for text in child.stderr or ()], daemon=True).start()
        try:
            yield line[line.index("http://") :].split()[0], child
        finally:
            child.terminate()
            child.wait(timeout=30)


def _cpu_seconds(pid: int) -> float:
    """Processor time of a process [s], which other load of the machine hardly changes."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@contextlib.contextmanager
def _watched(pid: int) -> Iterator[list[float]]:
    """Resident memory of a process [MB], twice a second."""
    found: list[float] = []
    ended = threading.Event()

    def watch() -> None:
        while not ended.wait(0.5):
            pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
            found.append(round(pages * os.sysconf("SC_PAGE_SIZE") / 1e6, 1))

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield found
    finally:
        ended.set()
        thread.join()


def _round(url: str, jobs: list[str], *, seed: int, pause: float) -> tuple[list[tuple[str, float]], list[str], float]:
    """(call, seconds) of every call of all clients, errors, and how long it took."""
    begin = time.monotonic()
    each = CLIENTS // PROCESSES
    command = [sys.executable, "-P", "-m", __name__, url]
    children = [
        subprocess.Popen([*command, str(p * each), str(each), str(seed), str(pause), *jobs], stdout=subprocess.PIPE, text=True)
        for p in range(PROCESSES)
    ]
    samples: list[tuple[str, float]] = []
    errors: list[str] = []
    for child in children:
        answer = json.loads(child.communicate()[0])
        samples += [(name, seconds) for name, seconds in answer["samples"]]
        errors += answer["errors"]
    return samples, errors, time.monotonic() - begin


def _figures(samples: list[tuple[str, float]], errors: list[str], seconds: float, memory: list[float]) -> dict[str, Any]:
    taken = [s for _, s in samples]
    by_call = {name: [s for n, s in samples if n == name] for _, name in MIX}
    third = max(1, len(memory) // 3)
    return {
        "calls": len(samples),
        "errors": len(errors),
        "error_texts": sorted(set(errors))[:5],
        "median_ms": round(statistics.median(taken) * 1e3, 1),
        "p95_ms": _p95(taken),
        "slowest_ms": round(max(taken) * 1e3, 1),
        "calls_per_s": round(len(samples) / seconds, 1),
        "p95_ms_by_call": {name: _p95(found) for name, found in by_call.items() if found},
        "grown_mb": round(statistics.median(memory[-third:]) - statistics.median(memory[:third]), 1) if memory else 0.0,
        "load_average": [round(value, 1) for value in os.getloadavg()],
    }


def _p95(taken: list[float]) -> float:
    return round(sorted(taken)[max(0, round(0.95 * len(taken)) - 1)] * 1e3, 1)


async def _client(url: str, number: int, seed: int, pause: float, jobs: list[str], samples: list[Any], errors: list[str]) -> None:
    from mcp import Client

    rng = random.Random(f"{seed}/{number}")
    own = f"own{number}"
    async with Client(url, mode="auto" if number % 2 else "legacy") as client:
        for k in range(CALLS):
            (name,) = rng.choices([n for _, n in MIX], [w for w, _ in MIX])
            await asyncio.sleep(rng.uniform(0, 2 * pause))
            begin = time.perf_counter()
            try:
                answer = await _call(client, name, own, jobs, rng.random())
            except Exception as error:
                errors.append(f"{name}: {error!r}"[:300])
                answer = None
            samples.append((name, time.perf_counter() - begin))
            if getattr(answer, "is_error", False):
                errors.append(f"{name}: {answer.content[0].text}"[:300])
            del k


async def _call(client: Any, name: str, own: str, jobs: list[str], drawn: float) -> Any:
    world = own if drawn < 0.5 else f"bake{int(drawn * 100) % BAKES}"
    if name in ("overview", "matrix", "revisions"):
        return await client.call_tool("inspect_world", {"world": world, "part": name})
    if name == "spec":
        return await client.call_tool("inspect_world", {"world": world, "part": "spec", "pointer": "/entities/ball"})
    if name == "edit":
        patch = [{"op": "add", "path": "/title", "value": f"Three blocks {drawn:.6f}"}]
        return await client.call_tool("edit_spec", {"world": own, "patch": patch})
    if name == "audit":
        return await client.call_tool("run_checks", {"world": own, "scope": "audit"})
    if name == "job list":
        return await client.call_tool("job", {"action": "list"})
    if name == "job status":
        return await client.call_tool("job", {"action": "status", "job_id": jobs[0]})
    if name == "tools/list":
        return await client.list_tools(cache_mode="bypass")
    if name == "completion":
        from mcp.types import ResourceTemplateReference

        template = ResourceTemplateReference(type="ref/resource", uri="worldagent://worlds/{world}/spec")
        return await client.complete(template, {"name": "world", "value": "b"})
    uri = {"read worlds": "worldagent://worlds"}.get(name, f"worldagent://worlds/{world}/{name.removeprefix('read ')}")
    return await client.read_resource(uri, cache_mode="bypass")


async def _clients(url: str, first: int, count: int, seed: int, pause: float, jobs: list[str]) -> None:
    samples: list[Any] = []
    errors: list[str] = []
    await asyncio.gather(*(_client(url, first + k, seed, pause, jobs, samples, errors) for k in range(count)))
    print(json.dumps({"samples": samples, "errors": errors}))


if __name__ == "__main__":
    address, begin_at, clients, chosen, mean, *known = sys.argv[1:]
    asyncio.run(_clients(address, int(begin_at), int(clients), int(chosen), float(mean), known))
