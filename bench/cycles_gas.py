"""Gases of a frame as volumes of OpenVDB, which Blender reads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..rendering.categories.gas.boxes import gases_of
from ..rendering.categories.gas.look import ASYMMETRY
from ..rendering.categories.gas.shading import emitted
from ..workflow.openvdb import Volume, write_volumes
from ..worlds.arrays import F32
from ..worlds.candidate import Candidate

__all__ = ["export_gases"]


def export_gases(candidate: Candidate, frame: int, folder: Path) -> list[dict[str, Any]]:
    """Write a volume for each gas that is seen at a frame; path, albedo, asymmetry, cell and whether it glows.

    Its grid "density" is the extinction [1/m], "glow" the light that it gives per length [W/(m^3 sr)], at the middle of cells.

    Raises:
        InputError: no Python has the module openvdb.
    """
    volumes, told = [], []
    for gas in gases_of(candidate):
        box = gas.at(frame)
        if box is None:
            continue
        grids: dict[str, F32] = {"density": box.sigma}
        if box.hot:
            grids["glow"] = (box.sigma[..., None] * emitted(box)).astype(np.float32)
        one = Volume(folder / f"{gas.entity}.vdb", grids, box.low + 0.5 * box.cell, box.cell)
        volumes.append(one)
        told.append(
            {
                "path": str(one.path),
                "albedo": box.look.albedo.tolist(),
                "asymmetry": ASYMMETRY,
                "glows": box.hot,
                "cell": box.cell,
            }
        )
    if volumes:
        write_volumes(volumes)
    return told
