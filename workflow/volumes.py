"""Gas of a baked world as files of sparse volumes, for other renderers: NanoVDB, and OpenVDB where a Python has its module."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..worlds.errors import EvidenceError, InputError
from ..worlds.folder import WorldFolder
from ..worlds.patch import parse_spec
from .openvdb import Volume, python_with_openvdb, write_volumes

if TYPE_CHECKING:
    from ..worlds.arrays import F32, F64
    from ..worlds.candidate import Candidate

__all__ = ["FIELDS", "export_volumes", "volume_files"]

FIELDS = {"soot": "gas_soot", "temperature": "gas_temperature"}
"""Fields that are written, soot [kg/m^3] and temperature [K], by the channels that hold them."""
Suffix = Literal["nvdb", "vdb"]


def export_volumes(root: Path, out: Path, *, frames: tuple[int, int] | None = None, suffix: Suffix = "nvdb") -> dict[str, Any]:
    """Write the gas of a world's complete bake: `worldagent volumes`.

    Args:
        root: the world folder.
        out: folder of the files.
        frames: first and last; default all.
        suffix: of the files.

    Raises:
        RefusedError: there is no complete bake.
        InputError: it has no gas or no such frames, or OpenVDB's module is missing.
    """
    from ..verifiers.acceptance import find_candidate
    from ..worlds.candidate import open_candidate

    folder = WorldFolder.at(root)
    candidate = open_candidate(folder, find_candidate(folder, parse_spec(folder.read_json(folder.spec_path))), "full")
    first, last = (0, candidate.last_frame) if frames is None else frames
    if not 0 <= first <= last <= candidate.last_frame:
        raise InputError(f"frames {first}..{last} are not in 0..{candidate.last_frame}; choose some of these")
    written = volume_files(candidate, out, range(first, last + 1), suffix)
    return {"files": len(written), "bytes": sum(p.stat().st_size for p in written), "folder": str(out), "fields": sorted(FIELDS)}


def volume_files(candidate: Candidate, out: Path, frames: Sequence[int], suffix: Suffix = "nvdb") -> list[Path]:
    """Files written, `<entity>_<field>_<frame>.<suffix>`: one field of one gas at one frame each, samples at the middle of cells.

    Args:
        candidate: with caches.
        out: folder of the files.
        frames: frame indices.
        suffix: of the files.

    Raises:
        InputError: there is no gas, or OpenVDB's module is missing.
        EvidenceError: a cache is damaged or holds what is no gas.
    """
    if suffix == "vdb":
        python_with_openvdb()
    if not candidate.gas_caches:
        raise InputError("no gas is simulated in this world; volumes are made of gas")
    out.mkdir(parents=True, exist_ok=True)
    write = _write_nanovdb if suffix == "nvdb" else _write_openvdb
    written = []
    for cache in candidate.gas_caches.values():
        for entity in cache.index.bodies:
            if entity not in candidate.spec.entities:
                raise EvidenceError(f"the cache holds gas {entity!r} that the specification does not have; bake again")
            cell = candidate.spec.entities[entity].physics.flow_cell
            for frame in frames:
                found = cache.read(frame, (*FIELDS.values(), "gas_corner"))
                middle = np.asarray(found["gas_corner"], dtype=np.float64) + 0.5 * cell
                for name, channel in FIELDS.items():
                    path = out / f"{entity}_{name}_{frame:06d}.{suffix}"
                    write(path, found[channel].astype(np.float32), middle, cell, name)
                    written.append(path)
    return written


def _write_nanovdb(path: Path, values: F32, middle: F64, cell: float, name: str) -> None:
    """Write values (nx, ny, nz) whose first lies at `middle` [m], `cell` [m] apart; Warp leaves grids unnamed."""
    import warp

    volume = warp.Volume.load_from_numpy(
        values, min_world=tuple(middle.tolist()), voxel_size=cell, bg_value=float(values.min()), device="cpu"
    )
    volume.save_to_nvdb(str(path))


def _write_openvdb(path: Path, values: F32, middle: F64, cell: float, name: str) -> None:
    """Write the same as a named grid."""
    write_volumes([Volume(path, {name: values}, middle, cell)])
