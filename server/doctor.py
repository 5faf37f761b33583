"""`worldagent doctor` and `worldagent warm`: what of this installation works, shown and not assumed."""

from __future__ import annotations

import json
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path
from typing import Any

from .. import __version__
from .capabilities import PACKAGES, package_version

__all__ = ["examine", "table", "warm"]

PROOF_SECONDS = 240
LEAST_FREE_BYTES = 2_000_000_000
OPTIONAL = ("libllvm",)
"""Proofs whose failure costs speed and nothing else."""
_AT_A_TIME = 2
_PROOF_NAMES = ("mujoco", "python-fcl", "mitsuba", "libllvm", "oidn", "video", "warp")


def examine(workspace: Path) -> dict[str, Any]:
    """All checks: `ok` is whether every required one passed."""
    checks = [_python(), *(_package(name) for name in PACKAGES), *_prove(_PROOF_NAMES), _ffmpeg(), *_disk(workspace)]
    return {
        "ok": all(check["ok"] or not check["required"] for check in checks),
        "worldagent": __version__,
        "platform": f"{platform.system()} {platform.machine()}",
        "workspace": str(workspace),
        "checks": checks,
    }


def table(report: dict[str, Any]) -> str:
    """The report for people."""
    width = max(len(check["name"]) for check in report["checks"])
    lines = [f"worldagent {report['worldagent']} on {report['platform']}, workspace {report['workspace']}"]
    for check in report["checks"]:
        word = "ok" if check["ok"] else ("FAIL" if check["required"] else "missing")
        lines.append(f"{word:<8}{check['name']:<{width}}  {check['detail']}")
    return "\n".join([*lines, "everything required works" if report["ok"] else "something required does not work, see FAIL"])


def warm(say: Callable[[str], None]) -> list[dict[str, Any]]:
    """Compile kernels and prove the renderer's variant, so that first use does not wait for it."""
    steps = []
    for name in ("mitsuba", "warp"):
        say(f"warming {name} ...")
        (step,) = _prove([name])
        say(f"{'ok' if step['ok'] else 'FAIL'}: {step['detail']}")
        steps.append(step)
    return steps


def _check(name: str, ok: bool, detail: str, *, required: bool = True) -> dict[str, Any]:
    return {"name": name, "ok": ok, "required": required, "detail": detail}


def _python() -> dict[str, Any]:
    return _check("python", sys.version_info >= (3, 11), f"{platform.python_version()} at {sys.executable} (3.11 or newer)")


def _package(name: str) -> dict[str, Any]:
    found = package_version(name)
    return _check(name, found is not None, f"{found}, {_licence(name)}" if found else f"not installed; pip install {name}")


def _licence(name: str) -> str:
    """Licence as the distribution's metadata state it, in a few words."""
    try:
        facts = metadata(name)
    except PackageNotFoundError:
        return "unknown licence"
    classifiers = [line for line in facts.get_all("Classifier") or [] if line.startswith("License :: ")]
    stated = [*(facts.get_all("License-Expression") or []), *(line.rsplit(" :: ", 1)[-1] for line in classifiers)]
    first = next(iter([*stated, *(facts.get_all("License") or []), "unknown licence"])).strip().splitlines()[0]
    return re.sub(r"\s+", " ", first)[:60]


def _prove(names: Iterable[str]) -> list[dict[str, Any]]:
    with ThreadPoolExecutor(max_workers=_AT_A_TIME) as pool:
        return list(pool.map(_proof, names))


def _proof(name: str) -> dict[str, Any]:
    """Outcome of one proof in a process of its own."""
    required = name not in OPTIONAL
    label = f"{name} works"
    try:
        child = subprocess.run(
            [sys.executable, "-P", "-m", f"{__package__}.health", name],
            capture_output=True,
            text=True,
            timeout=PROOF_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return _check(label, False, f"no answer within {PROOF_SECONDS} s", required=required)
    try:
        answer = json.loads(child.stdout.splitlines()[-1])
    except (IndexError, ValueError):
        last = (child.stderr.strip().splitlines() or ["no output"])[-1]
        return _check(label, False, f"the proof ended with code {child.returncode}: {last[:200]}", required=required)
    return _check(label, bool(answer["ok"]), str(answer["detail"]), required=required)


def _ffmpeg() -> dict[str, Any]:
    path = shutil.which("ffmpeg")
    return _check("ffmpeg", path is not None, path or "not found: video is VP9 only, no H.264", required=False)


def _disk(workspace: Path) -> list[dict[str, Any]]:
    """Whether the workspace can be written and has room; it is not created by looking."""
    there = workspace
    while not there.exists():
        there = there.parent
    try:
        with tempfile.TemporaryFile(dir=there):
            pass
        writable, detail = there.is_dir(), f"{workspace} can be {'written' if there == workspace else 'created'}"
    except OSError as error:
        writable, detail = False, f"{there}: {error.strerror}"
    free = shutil.disk_usage(there).free
    return [
        _check("workspace", writable, detail),
        _check("free disk", free >= LEAST_FREE_BYTES, f"{free / 1e9:.1f} GB free ({LEAST_FREE_BYTES / 1e9:.0f} GB or more)"),
    ]
