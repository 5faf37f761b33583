"""Path payloads in every string field and every key: nothing outside the workspace is read or written."""

from __future__ import annotations

import hashlib
import json
import os
import random
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.hostile.specs import PATHS, full_spec, leaves, rewritten
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tools import TOOLS

SECRET = "canary-51c9"
HERE = Path(__file__).resolve().parents[2]
SCRIPT = """
import asyncio, json, sys
from pathlib import Path
from worldagent.tests.hostile.watch import watched_calls
asyncio.run(watched_calls(Path(sys.argv[1]), Path(sys.argv[2])))
"""


def tree(root: Path) -> dict[str, str]:
    """Digest of every file outside the workspace."""
    found = {}
    for path in sorted(root.rglob("*")):
        if "workspace" in path.relative_to(root).parts[:1]:
            continue
        found[str(path)] = hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "folder"
    return found


@pytest.fixture
def yard(tmp_path: Path) -> Path:
    """A workspace with canaries around it, and links to them within it."""
    root = tmp_path / "yard"
    root.mkdir()
    for name in ("canary.txt", "canary.obj", "canary.json", "world.json"):
        (root / name).write_text(f"{SECRET}\nv 0 0 0\n")
    outside = root / "outside"
    outside.mkdir()
    (outside / "world.json").write_text(json.dumps({"prompt": SECRET}))
    (outside / "canary.obj").write_text(SECRET)
    (outside / "ledger.sqlite").write_text(SECRET)
    workspace = root / "workspace"
    (workspace / "linked").parent.mkdir()
    (workspace / "linked").symlink_to(outside)
    return root


def arguments_of(tool: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every string argument of a tool, and good values of the others that it needs."""
    from worldagent.server.arguments import Arguments

    properties = Arguments(tool).schema["properties"]
    good: dict[str, Any] = {"world": "w"} if "world" in properties else {}
    if tool.name == "job":
        good = {"action": "status"}
    for name, described in properties.items():
        kinds = [described, *described.get("anyOf", ())]
        if any(kind.get("type") in ("string", "array", "object") or "enum" in kind for kind in kinds):
            yield name, good


def tool_calls() -> Iterator[tuple[str, dict[str, Any]]]:
    """A call for every string argument with every payload."""
    for tool in TOOLS:
        for name, good in arguments_of(tool):
            for payload in PATHS:
                yield tool.name, {**good, name: payload}
                if name in ("spec", "patch"):
                    yield tool.name, {**good, name: [payload] if name == "patch" else {payload: payload}}


def spec_patches(draw: random.Random) -> Iterator[tuple[str, dict[str, Any]]]:
    """Edits that put a payload into every string of the specification, and beside every key of it."""
    for pointer, value in leaves(full_spec()):
        if isinstance(value, str) and pointer != "/prompt":
            for payload in draw.sample(PATHS, 3):
                yield "edit_spec", {"world": "w", "patch": [{"op": "replace", "path": pointer, "value": payload}]}
        if isinstance(value, dict):
            payload = draw.choice(PATHS)
            token = payload.replace("~", "~0").replace("/", "~1")
            yield (
                "edit_spec",
                {"world": "w", "patch": [{"op": "add", "path": f"{pointer}/{token}", "value": next(iter(value.values()), {})}]},
            )
    mesh = {"kind": "mesh", "collision": "hull"}
    for payload in PATHS:
        shape = {**mesh, "file": payload}
        yield (
            "edit_spec",
            {
                "world": "w",
                "patch": [{"op": "replace", "path": "/entities/b1/parts/body/shape", "value": shape}],
                "hypothesis": "another mesh file will do",
            },
        )
        yield (
            "edit_spec",
            {"world": "w2", "prompt": payload or "p", "spec": rewritten(small_spec(), "/entities/b1/parts/body/shape", shape)},
        )
        yield "edit_spec", {"world": payload, "prompt": PROMPT, "spec": small_spec()}


def resources() -> Iterator[str]:
    """Addresses with payloads in every variable of every template, plain and percent-encoded."""
    from urllib.parse import quote

    for payload in [*PATHS, "linked", "w/../../outside", "%2e%2e/%2e%2e/canary.txt"]:
        for text in dict.fromkeys((payload, quote(payload, safe=""))):
            for part in ("spec", "matrix", "revisions", "report", "film", f"pictures/{text}", f"acceptance/{text}"):
                yield f"worldagent://worlds/{text}/{part}"
            for folder in ("pictures", "acceptance"):
                yield f"worldagent://worlds/w/{folder}/{text}"
            yield f"skill://{text}/SKILL.md"
            yield f"skill://world-building/{text}"
            yield text


def test_no_string_leads_out_of_the_workspace(yard: Path, tmp_path: Path) -> None:
    before = tree(yard)
    calls = [*tool_calls(), *spec_patches(random.Random(5))]
    work = {
        "calls": calls,
        "resources": list(resources()),
        "payloads": PATHS,
        "create": {"world": "w", "prompt": PROMPT, "spec": small_spec()},
    }
    plan, report = tmp_path / "plan.json", tmp_path / "report.json"
    plan.write_text(json.dumps(work))
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    child = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(plan), str(report)], cwd=yard / "workspace", env=environment, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert child.returncode == 0, child.stderr[-3000:]
    found = json.loads(report.read_text())
    assert found["answers"] > 1500
    assert found["internal"] == []
    assert found["opened"] == []
    assert found["told"] == []
    assert found["slow"] == []
    assert tree(yard) == before


def test_the_watch_sees_what_it_must(yard: Path, tmp_path: Path) -> None:
    """The hook notices a file that is read outside: without this, the test above could not fail."""
    code = (
        "from pathlib import Path\n"
        "from worldagent.tests.hostile.watch import Watch\n"
        f"watch = Watch(Path({str(yard / 'workspace')!r}))\n"
        f"Path({str(yard / 'canary.txt')!r}).read_text()\n"
        f"Path({str(yard / 'workspace' / 'linked' / 'canary.obj')!r}).read_text()\n"
        "Path('/etc/hostname').exists() and open('/etc/passwd').close()\n"
        f"Path({str(yard / 'new.txt')!r}).write_text('x')\n"
        "print(len(watch.outside))\n"
    )
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert child.stdout.strip() in ("3", "4"), child.stderr
