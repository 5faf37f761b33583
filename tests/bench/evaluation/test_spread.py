"""A run spread over workers is the run: nothing lost, nothing twice, whoever dies meanwhile."""

from __future__ import annotations

import json
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from inspect_ai.log import EvalLog, read_eval_log
from worldagent.bench.evaluation.executors import Done, Executor, LocalExecutor, RayExecutor, executor_of
from worldagent.bench.evaluation.results import SampleResult, samples_of
from worldagent.bench.evaluation.shards import merged, run_spread
from worldagent.bench.evaluation.tasks import sample_ids
from worldagent.worlds.errors import EngineError, InputError

pytestmark = pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning", "ignore::DeprecationWarning"
)
ALL = sample_ids("small")
IDS = ALL[:4]


def table(log: EvalLog) -> list[SampleResult]:
    """Results without what differs from run to run: times and folders."""
    found = [replace(r, seconds=0, working_s=0, device_s=0, workspace="", record="", attempts=0) for r in samples_of(log)]
    return sorted(found, key=lambda r: (ALL.index(r.id), r.epoch))


def documents(folder: Path, gate: Path) -> Path:
    """A script for each sample: one or two calls; the third waits for a gate between them."""
    place = folder / "scripts"
    place.mkdir(exist_ok=True)
    for k, name in enumerate(ALL):
        calls = [
            {
                "tool": "inspect_world",
                "arguments": {"world": "w", "do": "wait", "marker": str(gate)} if k == 2 else {"world": "w"},
            }
        ]
        calls += [{"tool": "inspect_world", "arguments": {"world": "w", "do": "refuse"}}] * (k % 2)
        (place / f"{name}.json").write_text(json.dumps({"calls": calls}))
    return place


def spread(root: Path, executor: Executor, gate: Path, ids: Sequence[str], **options: Any) -> EvalLog:
    root.mkdir()
    scripts = documents(root, gate)
    return run_spread(executor, "small", "scripted", ids, root=root, agent_args={"folder": str(scripts)}, **options)


def murder(root: Path, gate: Path, parent: bool, died: list[bool]) -> None:
    """Kill the process of the third sample, or its parent, once it waits in a call; see it die, and open the gate for the next."""

    def started() -> list[dict[str, Any]]:
        found = [json.loads(p.read_text()) for p in root.glob("*/records/*/start.json")]
        return [s for s in found if s["sample"] == IDS[2]]

    while not (gate.with_suffix(".there").exists() and started()):
        time.sleep(0.02)
    pid = int(started()[0]["pid"])
    worker = int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    os.kill(worker if parent else pid, signal.SIGKILL)
    deadline = time.monotonic() + 20
    while not gone(pid) and time.monotonic() < deadline:
        time.sleep(0.02)
    died.append(gone(pid))
    gate.touch()


def gone(pid: int) -> bool:
    """True if a process is dead, waited for or not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


NO_RAY = pytest.mark.skipif(find_spec("ray") is None, reason="no ray: extra [cluster]")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "count", "epochs"),
    [("local", 4, 1), pytest.param("ray", 4, 1, marks=NO_RAY), pytest.param("ray", 20, 2, marks=NO_RAY)],
)
def test_a_worker_killed_in_the_middle_changes_nothing_in_the_table(
    kind: str, count: int, epochs: int, tmp_path: Path, fake: Callable[[str], None]
) -> None:
    """With Ray the worker is a process of Ray, and that of the sample dies with it."""
    gate, ids = tmp_path / "gate", ALL[:count]
    gate.touch()
    plain = spread(tmp_path / "plain", executor_of(kind, 2), gate, ids, epochs=epochs)
    assert [(s.id, s.epoch) for s in plain.samples or ()] == [(name, k + 1) for name in ids for k in range(epochs)]
    assert [r.calls for r in table(plain)] == [1 + k % 2 for k in range(count) for _ in range(epochs)]
    gate.unlink()
    gate.with_suffix(".there").unlink()
    died: list[bool] = []
    killer = threading.Thread(target=murder, args=(tmp_path / "hurt", gate, kind == "ray", died))
    killer.start()
    hurt = spread(tmp_path / "hurt", executor_of(kind, 2), gate, ids, epochs=epochs)
    killer.join()
    assert died == [True]
    assert table(hurt) == table(plain)
    starts = [json.loads(p.read_text())["sample"] for p in (tmp_path / "hurt").glob("*/records/*/start.json")]
    assert sorted(starts) == sorted([*(n for n in ids for _ in range(epochs)), IDS[2]])
    again = read_eval_log(hurt.location)
    assert table(again) == table(plain)
    assert (again.eval.dataset.sample_ids, again.results.total_samples) == (ids, count * epochs)


class Given:
    """An executor whose results are known beforehand, the last one first."""

    def __init__(self, logs: Sequence[str]) -> None:
        self.logs = logs
        self.payloads: list[Mapping[str, Any]] = []

    def map(self, module: str, payloads: Sequence[Mapping[str, Any]]) -> Iterator[Done]:
        self.payloads = list(payloads)
        for k in reversed(range(len(payloads))):
            yield Done(k, {"status": "success", "log": self.logs[k]}, 0)


@pytest.fixture
def parts(tmp_path: Path, fake: Callable[[str], None]) -> list[str]:
    """Logs of two samples, each of a run of its own."""
    from worldagent.bench.evaluation.commands import run_task

    scripts = documents(tmp_path, tmp_path / "gate")
    options: dict[str, Any] = {"root": tmp_path, "agent_args": {"folder": str(scripts)}}
    return [run_task("small", "scripted", sample_id=[name], **options).location for name in IDS[:2]]


def test_logs_are_joined_in_the_order_of_their_samples(parts: list[str], tmp_path: Path) -> None:
    given = Given(parts)
    log = run_spread(given, "small", "scripted", IDS[:2], root=tmp_path / "joined")
    assert [p["sample_id"] for p in given.payloads] == [[name] for name in IDS[:2]]
    assert [s.id for s in log.samples or ()] == IDS[:2]
    (metric,) = [s.metrics["mean"].value for s in log.results.scores if s.name == "calls"]
    assert metric == 1.5


def test_logs_of_different_runs_or_with_a_sample_twice_are_not_joined(parts: list[str]) -> None:
    one, two = (read_eval_log(p) for p in parts)
    with pytest.raises(InputError, match="a sample is there twice"):
        merged([one, one])
    two.eval.model = "other/model"
    with pytest.raises(InputError, match="model is 'none/none' and 'other/model'"):
        merged([one, two])


def test_work_that_fails_by_itself_is_told_and_not_repeated(tmp_path: Path) -> None:
    payload = {"task": "nothing", "agent": "scripted", "root": str(tmp_path), "log_dir": str(tmp_path)}
    with pytest.raises(EngineError, match="task 'nothing' must be one of"):
        list(LocalExecutor(1).map("worldagent.bench.evaluation.shards", [payload]))


def test_an_executor_that_is_not_there_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worldagent.bench.evaluation.executors.find_spec", lambda name: None)
    with pytest.raises(EngineError, match=r"pip install 'worldagent\[cluster\]'"):
        RayExecutor(2)
    with pytest.raises(InputError, match="executor 'mpi' must be one of local, ray"):
        executor_of("mpi", 2)
    with pytest.raises(InputError, match="workers 0 must be at least 1"):
        executor_of("local", 0)
