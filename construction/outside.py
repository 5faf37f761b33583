"""Files from outside (meshes, height maps), opened with care and parsed in a process of their own.

A hostile file may take the memory and time of `file_worker`, or crash it, and costs no more than an error here.
"""

from __future__ import annotations

import hashlib
import io
import os
import stat
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ..worlds.errors import InputError
from ..worlds.folder import safe_join
from ..worlds.limits import check_cap
from .file_worker import CPU_SECONDS, MEMORY_BYTES, REFUSED

__all__ = ["arrays_of", "decomposed", "file_digest"]

PATIENCE = 3
"""A reader gets this many times its processor time [s] of the clock, since the machine may be busy."""


@contextmanager
def _opened(assets: Path, name: str, cap: str) -> Iterator[io.BufferedReader]:
    """A plain file of the assets folder, for reading.

    Raises:
        InputError: it is missing, no plain file, or leads out of the assets folder.
        LimitError: it has more bytes than the cap.
    """
    path = safe_join(assets, name)
    try:
        # Without blocking: a pipe would wait for a writer for ever.
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOFOLLOW", 0))
    except OSError as error:
        known = sorted(p.name for p in assets.glob("*"))[:20] if assets.is_dir() else []
        raise InputError(
            f"there is no file {name!r} in the world's assets/ folder, which holds {known}; put it there first"
        ) from error
    status = os.fstat(descriptor)
    if not stat.S_ISREG(status.st_mode):
        os.close(descriptor)
        raise InputError(f"{name!r} is no plain file; put the file itself into the world's assets/ folder")
    with os.fdopen(descriptor, "rb") as stream:
        check_cap(cap, status.st_size, what=f"the file {name!r}")
        yield stream


def file_digest(assets: Path, name: str, cap: str) -> str:
    """SHA-256 of a file, hex; `missing` where there is none to read."""
    try:
        with _opened(assets, name, cap) as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except InputError:
        return "missing"


def arrays_of(kind: str, assets: Path, name: str, cap: str) -> dict[str, Any]:
    """Arrays that a file of `kind` (`mesh` or `dem`) holds, checked for shape and finite where they must be.

    Raises:
        InputError: the file is missing or at fault, or takes more than its reader may.
        LimitError: it has more bytes than the cap.
    """
    with _opened(assets, name, cap) as stream:
        return _work([kind, name.rpartition(".")[2]], stream, f"reading {name!r}")


def decomposed(mesh: Mapping[str, Any]) -> list[Any]:
    """Points of convex pieces of a closed mesh.

    Raises:
        InputError: the decomposition fails or takes too long.
    """
    with tempfile.TemporaryFile() as stream:
        np.savez(stream, **mesh)
        stream.seek(0)
        found = _work(["decompose", "npz"], stream, "the convex decomposition of the mesh")
    return [found[name] for name in sorted(found)]


def _work(command: list[str], stream: Any, what: str) -> dict[str, Any]:
    # -P: no folder that a file may lie in becomes a place to import from.
    patience = PATIENCE * CPU_SECONDS[command[0]]
    arguments = [sys.executable, "-P", "-B", "-m", f"{__package__}.file_worker", *command]
    try:
        child = subprocess.run(arguments, stdin=stream, capture_output=True, timeout=patience, check=False)
    except subprocess.TimeoutExpired as error:
        raise InputError(f"{what} took more than {patience} s; simplify or crop it") from error
    if child.returncode == REFUSED:
        told = child.stderr.decode(errors="replace").strip().splitlines()[-1:]
        raise InputError(f"{what} failed: {(told or ['no reason given'])[0][:400]!r}; export it anew")
    if child.returncode != 0:
        raise InputError(
            f"{what} ended with code {child.returncode}: it takes more than {CPU_SECONDS[command[0]]} s or "
            f"{MEMORY_BYTES // 1024**2} MB of memory, or crashes the reader; simplify or crop it"
        )
    with np.load(io.BytesIO(child.stdout), allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}
