"""Entries that the tests run in workers. Tests put this folder on PYTHONPATH and name it in WORLDAGENT_TEST_ENTRIES."""

import os
import signal
import time
from pathlib import Path

from worldagent.worlds.errors import SpecError


def _wait_for(path):
    deadline = time.monotonic() + 300
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


def stepped(payload, context):
    """Take each step when the test opens its gate."""
    for k in range(payload["steps"] + 1):
        context.progress(k, payload["steps"], f"step {k}")
        _wait_for(f"{payload['gates']}{k}")
    return {}


def counting(payload, context):
    for k in range(payload["steps"]):
        context.progress(k + 1, payload["steps"], f"step {k + 1}")
        if "gates" in payload:
            _wait_for(f"{payload['gates']}{k + 1}")
    context.progress(0, payload["steps"], "a step back")
    if "gates" in payload:
        _wait_for(f"{payload['gates']}{payload['steps'] + 1}")
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
    _wait_for(payload["gate"])
    time.sleep(0.05)
    inside.unlink()
    return {"left": time.time()}


WARM = ("fractions",)
"""Modules that a nursery of these entries has loaded."""


def surroundings(payload, context):
    """Facts that an entry sees of the process it runs in."""
    import sys

    return {
        "nursery": sys.modules["__main__"].__spec__.name == "worldagent.execution.nursery",
        "device": os.environ.get("WORLDAGENT_DEVICE"),
        "cwd": str(Path.cwd()),
        "open": sorted(entry.name for entry in Path("/proc/self/fd").iterdir()),
        "threads": len(list(Path("/proc/self/task").iterdir())),
    }


def leaves_children(payload, context):
    """A child that ignores SIGTERM, a grandchild in a session of its own, both in native loops."""
    import subprocess
    import sys

    loop = "import signal, os, sys; signal.signal(signal.SIGTERM, signal.SIG_IGN); open(sys.argv[1], 'w').write(str(os.getpid())); sum(range(10**13))"
    with_child = (
        f"import subprocess, sys; subprocess.Popen([sys.executable, '-c', {loop!r}, sys.argv[2]], start_new_session=True); {loop}"
    )
    subprocess.Popen([sys.executable, "-c", with_child, payload["child"], payload["grandchild"]])
    _wait_for(payload["child"])
    _wait_for(payload["grandchild"])
    context.progress(1)
    if payload.get("returns"):
        return {}
    return {"sum": sum(range(10**13))}


def chatty(payload, context):
    """Print more than a log may hold."""
    line = "x" * 999 + "\n"
    for k in range(payload["lines"]):
        os.write(1, f"{k} {line}".encode())
    os.write(1, b"the last word\n")
    return {}
