"""Recorded quantities of a world over its frames, thinned for drawing: the page's ledger plots."""

from __future__ import annotations

import json
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

from ...worlds.cache import Cache
from ...worlds.channels import QUANTITIES
from ...worlds.errors import EvidenceError
from ...worlds.folder import WorldFolder, safe_join
from ...worlds.ledger import Ledger

__all__ = ["ledger_charts"]

CHARTS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("Energy", ("kinetic_energy", "potential_energy", "driver_work")),
    ("Momentum", ("momentum_x", "momentum_y", "momentum_z")),
    ("Fastest body", ("max_speed",)),
    ("Contacts", ("contacts_max",)),
    ("Joint gap", ("joint_error",)),
)
MOST_FRAMES = 240


def ledger_charts(folder: WorldFolder, ledger: Ledger) -> dict[str, Any]:
    """Series of the newest bake, else of the newest probe.

    Raises:
        EvidenceError: nothing was simulated, or its caches cannot be read.
    """
    for stage in ("bake", "probe"):
        for record in ledger.freezes():
            root = folder.candidate(record["freeze"])
            if stage == "bake" and ledger.bake(record["freeze"]) is None:
                continue
            if (root / stage).is_dir():
                stamp = (root / stage).stat().st_mtime_ns
                return {
                    "stage": stage,
                    "freeze": root.name,
                    "revision": record["revision"],
                    **_series(safe_join(folder.root, folder.relative(root)), stage, stamp),
                }
    raise EvidenceError("nothing is simulated yet: probe_sim and bake_sim record energy, momentum and contacts")


@lru_cache(maxsize=16)
def _series(root: Path, stage: Literal["bake", "probe"], stamp: int) -> dict[str, Any]:
    """Frames and charts of the caches under a candidate; `stamp` tells one writing of them from the next."""
    try:
        solvers = sorted(json.loads((root / "candidate.json").read_text())["spec"]["simulation"]["solvers"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise EvidenceError(f"candidate.json of {root.name!r} is missing or damaged: {error}") from error
    caches = [Cache(safe_join(root, f"{stage}/{name}")) for name in solvers]
    count = min((c.index.frames for c in caches), default=0)
    frames = _thinned(count)
    names = [n for _, group in CHARTS for n in group]
    values: dict[str, list[float | None]] = {n: [] for n in names}
    for k in frames:
        read = [_records(c, k, names) for c in caches]
        for name in names:
            found = [r[name] for r in read if name in r]
            values[name].append(float(QUANTITIES[name].combined(found)) if found else None)
    charts = [
        {
            "title": title,
            "unit": QUANTITIES[group[0]].unit,
            "lines": [{"name": n, "meaning": QUANTITIES[n].meaning, "values": values[n]} for n in group],
        }
        for title, group in CHARTS
        if any(v for n in group for v in values[n])
    ]
    return {"fps": caches[0].index.fps if caches else 0, "frames": frames, "frame_count": count, "charts": charts}


def _records(cache: Cache, frame: int, names: Iterable[str]) -> dict[str, float]:
    read = cache.read(frame)
    return {n: float(read[f"record/{n}"]) for n in names if f"record/{n}" in read}


def _thinned(count: int) -> list[int]:
    """At most `MOST_FRAMES` frames, evenly spread, the last one included."""
    if count <= MOST_FRAMES:
        return list(range(count))
    return sorted({round(k * (count - 1) / (MOST_FRAMES - 1)) for k in range(MOST_FRAMES)})
