"""A server in a process whose opened files are watched."""

from __future__ import annotations

import json
import sys
import sysconfig
import time
from pathlib import Path
from typing import Any

__all__ = ["Watch", "watched_calls"]

SECRET = "canary-51c9"
SLOW_SECONDS = 20.0
"""A call that takes longer hangs [s]: they take milliseconds, and the machine may be busy."""
READABLE = ("/proc/self/", "/proc/meminfo", "/proc/cpuinfo", "/sys/", "/dev/null", "/dev/urandom", "/usr/share/zoneinfo", "/etc/mime.types",
            "/etc/httpd/", "/etc/apache", "/etc/nginx/", "/usr/local/etc/", "/etc/localtime", "/usr/share/mime")  # fmt: skip
"""Files that libraries read by themselves."""


class Watch:
    """Notes every path outside the workspace and the installation that this process opens, lists, makes, moves or removes."""

    def __init__(self, workspace: Path) -> None:
        self.outside: list[str] = []
        own = Path(__file__).resolve().parents[2]
        bases = [sys.prefix, sys.base_prefix, sysconfig.get_path("stdlib"), str(own), *filter(None, sys.path)]
        self._allowed = [str(workspace.resolve()), *(str(Path(base).resolve()) for base in bases)]
        self._busy = False
        sys.addaudithook(self._see)

    def _see(self, event: str, arguments: tuple[Any, ...]) -> None:
        if self._busy or event not in (
            "open",
            "os.listdir",
            "os.scandir",
            "os.mkdir",
            "os.rename",
            "os.remove",
            "os.link",
            "os.symlink",
            "socket.connect",
            "sqlite3.connect",
        ):
            return
        self._busy = True
        try:
            if event == "socket.connect":
                self._judge(event, arguments[1])
                return
            for path in arguments[: 2 if event in ("os.rename", "os.link", "os.symlink") else 1]:
                self._judge(event, path)
        finally:
            self._busy = False

    def _judge(self, event: str, path: Any) -> None:
        if isinstance(path, tuple):
            self.outside.append(f"{event} {path}")
        elif isinstance(path, str | bytes | Path):
            text = path.decode(errors="replace") if isinstance(path, bytes) else str(path)
            if "\0" in text:
                return
            whole = str(Path(text).resolve())
            inside = any(whole == base or whole.startswith(f"{base}/") for base in self._allowed)
            if not inside and not text.startswith(READABLE):
                self.outside.append(f"{event} {text}"[:300])


async def watched_calls(plan: Path, report: Path) -> None:
    """Make all calls of a plan in memory, in both eras, and report what was opened and told."""
    from mcp import Client
    from mcp.shared.exceptions import MCPError
    from mcp.types import PromptReference, ResourceTemplateReference
    from worldagent.server.app import create_server

    work = json.loads(plan.read_text())
    workspace = Path.cwd()
    found: dict[str, list[str]] = {"internal": [], "told": [], "slow": []}
    count = 0

    def note(what: str, text: str, start: float) -> None:
        nonlocal count
        count += 1
        if "internal error" in text or "Internal server error" in text:
            found["internal"].append(f"{what[:300]}: {text[:300]}")
        if SECRET in text or "root:x:" in text:
            found["told"].append(f"{what[:300]}: {text[:300]}")
        if time.monotonic() - start > SLOW_SECONDS:
            found["slow"].append(what[:300])

    async def attempt(what: str, call: Any) -> None:
        start = time.monotonic()
        try:
            text = str(await call)
        except MCPError as error:
            text = str(error)
        note(what, text, start)

    async with Client(create_server(workspace)) as client:
        await client.call_tool("edit_spec", work["create"])
        for path in (workspace / "w" / "assets" / "link_out.obj", workspace / "w" / "pictures" / "link_out.obj"):
            path.parent.mkdir(exist_ok=True)
            path.symlink_to(workspace.parent / "canary.obj")
        (workspace / "w" / "assets" / "link_out").symlink_to(workspace.parent)
        await client.call_tool("inspect_world", {"world": "w", "part": "matrix"})
        watch = Watch(workspace)
        for tool, arguments in work["calls"]:
            await attempt(f"{tool} {arguments}", client.call_tool(tool, arguments))
        for uri in work["resources"]:
            await attempt(uri, client.read_resource(uri))
        for payload in work["payloads"]:
            for name in ("make_world", "repair_world", "review_world"):
                await attempt(f"{name} {payload}", client.get_prompt(name, {"world": payload, "prompt": payload}))
            for reference in (
                PromptReference(type="ref/prompt", name="repair_world"),
                ResourceTemplateReference(type="ref/resource", uri="worldagent://worlds/{world}/pictures/{name}"),
                ResourceTemplateReference(type="ref/resource", uri="skill://{name}/{+path}"),
            ):
                for argument in ("world", "name", "path"):
                    given = {"world": payload, "name": payload}
                    await attempt(
                        f"complete {argument} {payload}", client.complete(reference, {"name": argument, "value": payload}, given)
                    )
                    await attempt(
                        f"complete {argument} {payload}", client.complete(reference, {"name": argument, "value": ""}, given)
                    )
        opened = list(dict.fromkeys(watch.outside))
    report.write_text(json.dumps({**found, "opened": opened, "answers": count}))
