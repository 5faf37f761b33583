"""Circumstances that every benchmark reports: machine, versions, commit, date."""

from __future__ import annotations

import importlib
import os
import platform
import subprocess
import sys
import time
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

__all__ = ["machine", "run_benchmark"]

_PACKAGES = (
    "mcp",
    "mcp-types",
    "pydantic",
    "numpy",
    "scipy",
    "mujoco",
    "warp-lang",
    "trimesh",
    "python-fcl",
    "coal",
    "mitsuba",
    "drjit",
    "pyoidn",
)


def run_benchmark(name: str, entry: str, **options: Any) -> dict[str, Any]:
    """Run `module:function(**options)` and join its figures with what they were measured on.

    The figures may carry `versions` of further packages; they are joined too.
    """
    module, function = entry.split(":")
    started = time.perf_counter()
    figures: dict[str, Any] = getattr(importlib.import_module(module), function)(**options)
    return {
        **figures,
        "name": name,
        "machine": machine(),
        "versions": {**_versions(), **figures.get("versions", {})},
        "commit": _commit(),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "wall_s": round(time.perf_counter() - started, 2),
    }


def machine() -> dict[str, Any]:
    """Processor, cores this process may use, memory, system, accelerator."""
    return {
        "processor": _processor(),
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "memory_gb": _memory_gb(),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "gpu": _gpu(),
        "load_before": [round(value, 2) for value in os.getloadavg()] if hasattr(os, "getloadavg") else None,
    }


def _versions() -> dict[str, str]:
    found = {"python": platform.python_version()}
    for name in _PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or "unknown"


def _memory_gb() -> float | None:
    try:
        return round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1)
    except (AttributeError, OSError, ValueError):
        return None


def _output(command: list[str]) -> str | None:
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False, cwd=Path(__file__).parent)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() if done.returncode == 0 and done.stdout.strip() else None


def _gpu() -> str | None:
    return _output(["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"])


def _commit() -> str | None:
    """Commit of the working tree, marked where tracked files differ from it."""
    commit = _output(["git", "rev-parse", "--short=12", "HEAD"])
    if commit is None:
        print("no git here: the commit is unknown", file=sys.stderr)
        return None
    return commit + ("+changes" if _output(["git", "status", "--porcelain", "--untracked-files=no"]) else "")
