"""Tools for tests of the server, and a process that serves them: `python fakes.py stdio|http WORKSPACE [TOKEN]`."""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field
from worldagent.workflow.context import Picture, ToolBinding, ToolContext, ToolReply
from worldagent.worlds.errors import InputError, LimitError, RefusedError, SpecError

PIXEL = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010806000000"
    + "1f15c4890000000d49444154789c6360606060000000050001a5f645400000000049454e44ae426082"
)
STATE: dict[str, Any] = {"cancelled": threading.Event(), "started": threading.Event(), "go": threading.Event()}


def measure(
    context: ToolContext,
    frames: Annotated[int, Field(ge=2, le=240, description="Number of frames")],
    mode: Annotated[Literal["fast", "exact"], Field(description="How to measure")] = "fast",
    patch: Annotated[list[dict[str, Any]] | None, Field(description="Operations")] = None,
) -> ToolReply:
    """Measure something."""
    return ToolReply(
        {"frames": frames, "mode": mode, "patch": patch}, links=(("matrix", "worldagent://worlds", "application/json"),)
    )


def diverge(context: ToolContext) -> ToolReply:
    """Return numbers that JSON does not have."""
    return ToolReply({"energy": float("nan"), "list": [1.0, float("inf")], "nested": {"low": float("-inf")}})


def fail(context: ToolContext, kind: Annotated[str, Field(description="Which error")]) -> ToolReply:
    """Raise an error."""
    raise {
        "refused": RefusedError("no passing probe; call probe_sim"),
        "input": InputError("step 0.1 s must be <= 0.005 s"),
        "limit": LimitError("bodies: estimated 3,000, cap 2,000"),
        "spec": SpecError("2 problems", (("/entities/a", "no parts"), ("/title", "missing"))),
        "crash": KeyError("secret detail"),
        "exit": SystemExit(3),
    }[kind]


def show(context: ToolContext, with_picture: Annotated[bool, Field(description="Whether to show one")] = True) -> ToolReply:
    """Show a picture."""
    return ToolReply({"mean": 0.5}, pictures=(Picture(PIXEL, "png"),) if with_picture else ())


def climb(context: ToolContext) -> ToolReply:
    """Report progress that does not always rise; each report waits until the last one was seen."""
    for done in (1.0, 2.0, 2.0, 1.5, float("nan"), 4.0):
        STATE["go"].clear()
        context.progress(done, 4.0, f"at {done}")
        STATE["go"].wait(60)
    return ToolReply({"ok": True})


def linger(context: ToolContext) -> ToolReply:
    """Run until the client gives up."""
    STATE["started"].set()
    while not context.cancelled():
        time.sleep(0.002)
    STATE["cancelled"].set()
    return ToolReply({})


def stick(context: ToolContext) -> ToolReply:
    """Never end, whatever the client does."""
    context.progress(1, None, "stuck")
    threading.Event().wait()
    return ToolReply({})


def enqueue(context: ToolContext) -> ToolReply:
    """Ask for the jobs of the workspace."""
    return ToolReply({"jobs": len(context.jobs.list()), "workspace": str(context.workspace)})


TOOLS = (
    ToolBinding(measure, "Measure", read_only=True, idempotent=True),
    ToolBinding(diverge, "Diverge", read_only=True),
    ToolBinding(fail, "Fail", read_only=False, destructive=True),
    ToolBinding(show, "Show", read_only=True, pictures=True),
    ToolBinding(climb, "Climb", read_only=True),
    ToolBinding(linger, "Linger", read_only=True),
    ToolBinding(stick, "Stick", read_only=True),
    ToolBinding(enqueue, "Enqueue", read_only=True),
)


def main(transport: str, workspace: str, token: str | None = None) -> None:
    if transport == "http":
        from worldagent.server.http import serve_http

        serve_http(
            Path(workspace),
            host="127.0.0.1",
            port=0,
            token=token,
            tools=TOOLS,
            announce=lambda url: print(url, file=sys.stderr, flush=True),  # noqa: T201
        )
    else:
        from worldagent.server.app import create_server
        from worldagent.server.cli import leave

        create_server(Path(workspace), tools=TOOLS).run("stdio")
        leave(patience_s=0.1)


if __name__ == "__main__":
    main(*sys.argv[1:])
