"""Entries that the tests run in workers. Tests put this folder on PYTHONPATH and name it in WORLDAGENT_TEST_ENTRIES."""

import os
import signal
import time
from pathlib import Path

from worldagent.execution import ExecutorLocal
from worldagent.worlds.errors import SpecError


def _wait_for(path):
    deadline = time.monotonic() + 20
    while not Path(path).exists():
        assert time.monotonic() < deadline, f"{path} never came"
        time.sleep(0.01)


def echo(payload, context):
    return {"payload": payload, "pid": os.getpid(), "job": context.job_id, "workspace": context.workspace}


def gated(payload, context):
    """Run until the test opens the gate."""
    context.progress(1, 2, "at the gate")
    _wait_for(payload["gate"])
    context.progress(2, 2, "through")
    return {"through": True}


def counting(payload, context):
    for k in range(payload["steps"]):
        context.progress(k + 1, payload["steps"], f"step {k + 1}")
        time.sleep(payload["pause_s"])
    context.progress(0, payload["steps"], "a step back")
    return {}


def cooperative(payload, context):
    context.progress(1)
    try:
        while True:
            context.check()
            time.sleep(0.01)
    finally:
        Path(payload["tidied"]).touch()


def native_loop(payload, context):
    """One C call that holds the interpreter lock for days."""
    context.progress(1)
    if payload.get("deaf"):
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
    context.progress(2)
    return {"sum": sum(range(10**13))}


def raises(payload, context):
    if payload["what"] == "spec":
        raise SpecError("mass -1 kg must be > 0; set it in /entities/a", (("/entities/a", "mass"),))
    if payload["what"] == "nan":
        return {"speed": float("nan")}
    if payload["what"] == "exit":
        raise SystemExit("enough")
    return {"quotient": 1 / 0}


def dies(payload, context):
    os.kill(os.getpid(), getattr(signal, payload["signal"]))
    time.sleep(20)


def hungry(payload, context):
    """Hold memory that is really used, until somebody ends it."""
    held = b"x" * payload["bytes"]
    while not context.cancelled():
        time.sleep(0.01)
    return {"bytes": len(held)}


def alone(payload, context):
    """Fail if another job of the same world is inside at the same time."""
    inside = Path(payload["inside"])
    with inside.open("x"):
        pass
    time.sleep(0.05)
    inside.unlink()
    return {"left": time.time()}


def mapped(payload, context):
    results = ExecutorLocal(payload["workers"]).map(payload["fn"], payload["items"], context)
    return {"results": results}


def square(item):
    if item["x"] < 0:
        raise SpecError(f"x {item['x']} must be >= 0")
    return {"square": item["x"] ** 2, "pid": os.getpid()}


def mark_and_hang(item):
    Path(item["mark"]).write_text(str(os.getpid()))
    return {"sum": sum(range(10**13))}


def crash(item):
    os.kill(os.getpid(), signal.SIGSEGV)


def reflect(item):
    return item
