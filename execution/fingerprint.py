"""Fingerprints that tell whether a process that loaded its libraries earlier is as good as one that is started now.

Two parts. The surroundings of a process that libraries read while they load or that the kernel hands on: they must be
equal in the process that asks for a job and in the one that would do it. And the source on disk: it must be what was
loaded.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import sys
from collections.abc import Mapping
from pathlib import Path

__all__ = ["source_stamp", "surroundings"]

_READ_WHILE_LOADING = re.compile(
    r"""PYTHON | LD_ | DYLD_ | GLIBC_ | MALLOC_ | OMP_ | KMP_ | GOMP_ | OPENBLAS_ | GOTO_ | MKL_ | BLIS_ | ATLAS_ | NPY_ | NUMPY_
    | SCIPY_ | NUMBA_ | CUDA | NVIDIA_ | WARP_ | MUJOCO_ | MITSUBA_ | MI_ | DRJIT_ | OIDN_ | EMBREE_ | OPENCV_ | OPENEXR_ | TBB_
    | EGL_ | MESA_ | PYOPENGL_ | LIBGL_ | GALLIUM_ | VK_ | LC_ | LANG | TZ$ | HOME$ | PATH$ | TMPDIR$ | XDG_CACHE_HOME$ | VIRTUAL_ENV$""",
    re.VERBOSE,
)
"""Environment variables that an engine or the interpreter may read while it loads. All others are handed over."""
_KERNEL_FACTS = ("Umask", "Cpus_allowed_list", "Mems_allowed_list", "Uid", "Gid", "Groups", "Seccomp", "CapEff", "NoNewPrivs")


def _text(path: str) -> str:
    try:
        return Path(path).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def surroundings(environment: Mapping[str, str] | None = None) -> str:
    """Digest of what this process would hand to a child that it starts. Linux."""
    import resource

    environment = os.environ if environment is None else environment
    rows = (line.partition(":") for line in _text("/proc/self/status").splitlines())
    facts = {
        "python": [sys.executable, sys.version, str(Path(__file__).parent.parent)],
        "environment": sorted((k, v) for k, v in environment.items() if _READ_WHILE_LOADING.match(k)),
        "kernel": [(name, value.strip()) for name, _, value in rows if name in _KERNEL_FACTS],
        "limits": [resource.getrlimit(kind) for name, kind in sorted(vars(resource).items()) if name.startswith("RLIMIT_")],
        "nice": os.getpriority(os.PRIO_PROCESS, 0),
        "cgroup": _text("/proc/self/cgroup"),
    }
    return hashlib.sha256(json.dumps(facts).encode()).hexdigest()


def source_stamp() -> str:
    """Digest of names, sizes and times of this package's source, and of the folders that packages are installed in."""
    root = Path(__file__).parent.parent
    digest = hashlib.sha256()
    folders = [root]
    while folders:
        for entry in sorted(os.scandir(folders.pop()), key=lambda e: e.name):
            if entry.is_dir(follow_symlinks=False):
                if not entry.name.startswith((".", "__")) and entry.name not in ("build", "dist", "tests", "docs"):
                    folders.append(Path(entry.path))
            elif entry.name.endswith(".py"):
                stat = entry.stat()
                digest.update(f"{entry.path} {stat.st_size} {stat.st_mtime_ns}\n".encode())
    for name in sys.path:
        if name.endswith(("site-packages", "dist-packages")) and Path(name).is_dir():
            digest.update(f"{name} {Path(name).stat().st_mtime_ns}\n".encode())
    return digest.hexdigest()
