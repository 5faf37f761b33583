"""`worldagent doctor` and `worldagent warm`: what of this installation works, shown and not assumed, and what mends it."""

from __future__ import annotations

import json
import platform
import subprocess
import sys
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from .. import __version__
from ..worlds.errors import WorldAgentError
from .check import Check, reinstall
from .client_checks import CLIENT_CHECKS
from .machine_checks import MACHINE_CHECKS
from .workspace_checks import WORKSPACE_CHECKS

__all__ = ["examine", "repair", "table", "warm"]

PROOF_SECONDS = 240
OPTIONAL = ("libllvm",)
"""Proofs whose failure costs speed and nothing else."""
_AT_A_TIME = 2
_PROOF_NAMES = ("mujoco", "python-fcl", "mitsuba", "libllvm", "oidn", "video", "warp")
_COSTS = {
    "mujoco": "nothing can be simulated",
    "python-fcl": "distances between shapes can't be measured, so nothing can be checked",
    "mitsuba": "no pictures and no film; everything up to acceptance works",
    "libllvm": "pictures take 2-3 times as long",
    "oidn": "pictures can't be denoised",
    "video": "no film can be written",
    "warp": "batched clearances and kernels do not run",
}
_LLVM = {
    "linux": "sudo apt-get install libllvm19 (or dnf install llvm-libs), then worldagent warm",
    "darwin": "brew install llvm, then worldagent warm",
}


def examine(workspace: Path) -> dict[str, Any]:
    """All checks: `ok` is whether every required one passed."""
    return _report(workspace, _checks(workspace))


def repair(workspace: Path, say: Callable[[str], None]) -> dict[str, Any]:
    """All checks after what can be mended safely was mended; `repaired` tells what was done.

    Kernels are compiled and the renderer is chosen by the checks themselves. No package is installed and no system
    setting is touched: that is left to the commands in the report.
    """
    checks = _checks(workspace)
    done: list[dict[str, Any]] = []
    for check in checks:
        if check.ok or check.mend is None:
            continue
        try:
            done.append({"name": check.name, "ok": True, "detail": check.mend()})
        except (OSError, WorldAgentError) as error:
            done.append({"name": check.name, "ok": False, "detail": str(error)})
        say(f"{'mended' if done[-1]['ok'] else 'not mended'}: {check.name}: {done[-1]['detail']}")
    again = _checks(workspace, proofs=[c for c in checks if c.name.endswith(" works")]) if done else checks
    return _report(workspace, again) | {"repaired": done}


def table(report: dict[str, Any]) -> str:
    """The report for people."""
    width = max(len(check["name"]) for check in report["checks"])
    lines = [f"worldagent {report['worldagent']} on {report['platform']}, workspace {report['workspace']}"]
    for check in report["checks"]:
        word = "ok" if check["ok"] else ("FAIL" if check["required"] else "warn")
        lines.append(f"{word:<6}{check['name']:<{width}}  {check['detail']}")
        if not check["ok"]:
            lines.append(f"{'':<6}{'':<{width}}    costs: {check['cost']}")
            lines.append(f"{'':<6}{'':<{width}}    mend:  {check['remedy']}")
    if any(check.get("repairable") for check in report["checks"]):
        lines.append("`worldagent doctor --repair` mends what is safe to mend unasked")
    return "\n".join([*lines, "everything required works" if report["ok"] else "something required does not work, see FAIL"])


def warm(say: Callable[[str], None]) -> list[dict[str, Any]]:
    """Compile kernels and prove the renderer's variant, so that first use does not wait for it."""
    steps = []
    for name in ("mitsuba", "warp"):
        say(f"warming {name} ...")
        (step,) = _prove([name])
        say(f"{'ok' if step.ok else 'FAIL'}: {step.detail}")
        steps.append(step.as_json())
    return steps


def _checks(workspace: Path, *, proofs: list[Check] | None = None) -> list[Check]:
    machine = [check for look in MACHINE_CHECKS for check in look()]
    shown = _prove(_PROOF_NAMES) if proofs is None else proofs
    return [
        *machine,
        *shown,
        *(check for look in WORKSPACE_CHECKS for check in look(workspace)),
        *(check for look in CLIENT_CHECKS for check in look()),
    ]


def _report(workspace: Path, checks: list[Check]) -> dict[str, Any]:
    return {
        "ok": all(check.ok or not check.required for check in checks),
        "worldagent": __version__,
        "platform": f"{platform.system()} {platform.machine()}",
        "workspace": str(workspace),
        "checks": [check.as_json() for check in checks],
    }


def _prove(names: Iterable[str]) -> list[Check]:
    with ThreadPoolExecutor(max_workers=_AT_A_TIME) as pool:
        return list(pool.map(_proof, names))


def _proof(name: str) -> Check:
    """Outcome of one proof in a process of its own."""
    ok, detail = _outcome(name)
    remedy = _LLVM.get(sys.platform, "install LLVM 16 or newer") if name == "libllvm" else reinstall()
    return Check(f"{name} works", ok, detail, name not in OPTIONAL, _COSTS[name], remedy)


def _outcome(name: str) -> tuple[bool, str]:
    try:
        child = subprocess.run(
            [sys.executable, "-P", "-m", f"{__package__}.health", name],
            capture_output=True,
            text=True,
            timeout=PROOF_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return False, f"no answer within {PROOF_SECONDS} s"
    try:
        answer = json.loads(child.stdout.splitlines()[-1])
    except (IndexError, ValueError):
        last = (child.stderr.strip().splitlines() or ["no output"])[-1]
        return False, f"the proof ended with code {child.returncode}: {last[:200]}"
    return bool(answer["ok"]), str(answer["detail"])
