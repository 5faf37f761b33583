"""Volumes of OpenVDB. Its module comes with no wheel, so that another Python may write them (Debian package python3-openvdb)."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..worlds.arrays import F32, F64
from ..worlds.errors import InputError

__all__ = ["ENV_PYTHON", "Volume", "python_with_openvdb", "write_volumes"]

ENV_PYTHON = "WORLDAGENT_OPENVDB_PYTHON"
"""Environment variable: a Python with the module openvdb or pyopenvdb, where this one has none; default the system's."""
SYSTEM = "/usr/bin/python3"
MODULES = ("openvdb", "pyopenvdb")
"""Names of the module, newer ones first."""
FIND = f"import importlib.util as u; raise SystemExit(not any(map(u.find_spec, {MODULES!r})))"
WRITE = f"""
import importlib, importlib.util, json, sys
import numpy as np
vdb = importlib.import_module(next(filter(importlib.util.find_spec, {MODULES!r})))
for one in json.load(sys.stdin):
    grids, held, cell = [], np.load(one["arrays"]), one["cell"]
    for name in held.files:
        values = held[name]
        kind = vdb.FloatGrid if values.ndim == 3 else vdb.Vec3SGrid
        grid = kind(float(values.min())) if values.ndim == 3 else kind()
        grid.copyFromArray(values)
        grid.name = name
        grid.transform = vdb.createLinearTransform([[cell, 0, 0, 0], [0, cell, 0, 0], [0, 0, cell, 0], [*one["middle"], 1]])
        grids.append(grid)
    vdb.write(one["path"], grids=grids)
"""
"""Script for that Python: reads a list of {{arrays, path, cell, middle}}, writes the files; what is no more than the least value is left out."""


class Volume(NamedTuple):
    """A file, its named grids and where they lie."""

    path: Path
    grids: Mapping[str, F32]
    """By name, shapes (nx, ny, nz) or (nx, ny, nz, 3)."""
    middle: F64
    """Middle of the first cell [m]."""
    cell: float
    """[m]"""


def python_with_openvdb() -> str:
    """A Python that has the module: this one, or the one that is named, or the system's.

    Raises:
        InputError: there is none.
    """
    if any(importlib.util.find_spec(name) for name in MODULES):
        return sys.executable
    other = os.environ.get(ENV_PYTHON, SYSTEM)
    if not Path(other).is_file() or subprocess.run([other, "-c", FIND], check=False).returncode:
        raise InputError(
            f"neither this Python nor {other} has a module {' or '.join(MODULES)}, which .vdb needs; install one (Debian: "
            f"python3-openvdb), name a Python that has one in ${ENV_PYTHON}, or ask for nvdb"
        )
    return other


def write_volumes(volumes: Sequence[Volume]) -> None:
    """Write files of named grids.

    Raises:
        InputError: no Python has the module, or it could not write.
    """
    python = python_with_openvdb()
    with tempfile.TemporaryDirectory() as folder:
        asked = []
        for number, one in enumerate(volumes):
            arrays = Path(folder) / f"{number}.npz"
            held: dict[str, Any] = dict(one.grids)
            np.savez(arrays, **held)
            asked.append({"arrays": str(arrays), "path": str(one.path), "cell": one.cell, "middle": list(map(float, one.middle))})
        ended = subprocess.run([python, "-c", WRITE], input=json.dumps(asked), capture_output=True, text=True, check=False)
    if ended.returncode:
        raise InputError(f"{python} could not write {[str(v.path) for v in volumes]}: {ended.stderr.strip()[-300:]}")
