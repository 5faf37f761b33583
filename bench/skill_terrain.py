"""Do the landforms of `outdoor-terrain` help? Prompts that need water and relief, from the skill's landforms and from plain noise.

Cases are data in `skills/outdoor-terrain/evals/cases.json`. With: the landform whose words the prompt shares most, on a drawn
seed. Without: the same extent and cell, one layer of noise with the relief that the prompt asks for, default erosion. Counted:
needs that the built landscape meets, out of all that the case lists.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..construction.terrain.landscape import Landscape, build_landscape
from ..worlds.errors import WorldAgentError
from ..worlds.spec.terrain import Terrain

__all__ = ["cases", "chosen_landform", "measure", "met"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "outdoor-terrain"
COARSE = 120
"""Cells along a side in the evals: enough for water to find its way, quick to build."""


def cases() -> dict[str, Any]:
    """The cases of the eval."""
    found: dict[str, Any] = json.loads((SKILL / "evals" / "cases.json").read_text())
    return found


def chosen_landform(prompt: str) -> dict[str, Any]:
    """Terrain of the landform whose description shares most words with a prompt."""
    landforms = json.loads((SKILL / "landforms.json").read_text())
    words = set(prompt.split())
    best = max(sorted(landforms), key=lambda name: len(words & set(landforms[name]["says"].split())))
    return dict(landforms[best]["terrain"])


def _plain(prompt: str, needs: Mapping[str, Any]) -> dict[str, Any]:
    """Landscape declared without the skill: noise of the asked relief over the same ground."""
    like = chosen_landform(prompt)
    relief = math.sqrt(needs["relief"][0] * needs["relief"][1])
    layer = {"kind": "noise", "amplitude": relief / 2, "wavelength": like["extent"][0] / 2}
    return {
        "extent": like["extent"],
        "cell": like["cell"],
        "layers": {"hills": layer},
        "sea_level": 0 if needs.get("sea") else None,
    }


def met(land: Landscape, needs: Mapping[str, Any]) -> dict[str, bool]:
    """Which needs a landscape meets: each is one measurement against the case's number."""
    return {name: bool(_NEEDS[name](land, wanted)) for name, wanted in needs.items()}


def _relief(land: Landscape, wanted: Sequence[float]) -> bool:
    height = land.fields["height"]
    return bool(wanted[0] <= np.nanmax(height) - np.nanmin(height) <= wanted[1])


def _sea_all_round(land: Landscape, wanted: bool) -> bool:
    sea = land.water.sea
    return bool(np.concatenate([sea[0], sea[-1], sea[:, 0], sea[:, -1]]).all()) and bool((~sea).any())


def _high_lake(land: Landscape, wanted: float) -> bool:
    """A lake more than a metre deep in the upper part of the land above the sea."""
    top = float(np.nanmax(land.fields["height"]))
    return any(lake.depth > 1.0 and lake.level > wanted * top for lake in land.water.lakes)


def _river_length(land: Landscape, wanted: float) -> bool:
    """Rivers that join reach over this share of the extent."""
    spans = []
    for start in (r for r in land.water.rivers if r.kind == "river"):
        cell, far = int(start.cells[0]), np.array(land.grid.place(int(start.cells[0])))
        receiver = land.drainage.receiver.ravel()
        while receiver[cell] != cell and not land.water.sea.flat[cell]:
            cell = int(receiver[cell])
        spans.append(float(np.hypot(*(np.array(land.grid.place(cell)) - far))))
    return max(spans, default=0.0) >= wanted * max(land.grid.extent)


def _walls(land: Landscape, wanted: float) -> bool:
    """The river's banks rise steeply within 150 m of it."""
    near = (land.fields["water_distance"] > 0) & (land.fields["water_distance"] < 150) & ~land.wet
    return bool(near.any() and np.percentile(land.fields["slope"][near], 75) >= wanted)


def _crests(land: Landscape, wanted: int) -> bool:
    """Rows of dunes met on the way across the land: local maxima of a smoothed profile."""
    from scipy.signal import find_peaks

    height = np.where(land.water.sea, np.nan, land.fields["height"])
    counts = [len(find_peaks(np.nan_to_num(row, nan=-99.0), prominence=3.0)[0]) for row in height[:: max(1, len(height) // 20)]]
    return bool(np.median(counts) >= wanted)


_NEEDS: Mapping[str, Callable[[Landscape, Any], bool]] = {
    "relief": _relief,
    "sea_all_round": _sea_all_round,
    "sea_share": lambda land, wanted: bool(wanted[0] <= land.water.sea.mean() <= wanted[1]),
    "high_lake": _high_lake,
    "lake_share": lambda land, wanted: bool((land.water.lake > 0).mean() >= wanted),
    "river": lambda land, wanted: any(r.kind == "river" for r in land.water.rivers),
    "stream": lambda land, wanted: any(r.kind == "stream" for r in land.water.rivers),
    "river_length": _river_length,
    "slope_below": lambda land, wanted: bool(np.median(land.fields["slope"]) < wanted),
    "walls": _walls,
    "crests": _crests,
}


def measure(seeds: Sequence[int]) -> dict[str, Any]:
    """Needs met per arm over all cases and seeds."""
    totals = {arm: {"needs": 0, "met": 0, "missed": {}} for arm in ("with", "without")}
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            for name, case in cases().items():
                for arm, given in (("with", chosen_landform(case["prompt"])), ("without", _plain(case["prompt"], case["needs"]))):
                    found = _tried({**given, "seed": seed}, case["needs"], Path(folder))
                    total: Any = totals[arm]
                    total["needs"] += len(found)
                    total["met"] += sum(found.values())
                    total["missed"] |= (
                        {f"{name} {seed}": [k for k, good in found.items() if not good]} if not all(found.values()) else {}
                    )
                    print(f"{name} {arm} {seed}: {found}", file=sys.stderr, flush=True)
    return totals


def _tried(given: dict[str, Any], needs: Mapping[str, Any], folder: Path) -> dict[str, bool]:
    plain = {**given, "cell": max(given["cell"], max(given["extent"]) / COARSE), "vegetation": None}
    plain["hydrology"] = {k: v for k, v in plain.get("hydrology", {}).items() if k != "required"}
    try:
        return met(build_landscape(Terrain.model_validate(plain), folder), needs)
    except WorldAgentError:
        return dict.fromkeys(needs, False)
