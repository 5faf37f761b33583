"""The dam break of `liquid_dambreak.py` as a world: baked, meshed and judged as any other, for what only a world can tell."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..simulation.schedule import run_frames
from ..testing.worlds.small_worlds import build_all
from ..verifiers.checks import run_checks
from ..worlds.candidate import Candidate, cache_digest
from ..worlds.categories.liquid.surface import LiquidSurface
from ..worlds.spec import WorldSpec

__all__ = ["dambreak_figures", "dambreak_spec"]

FPS = 24
"""As most worlds have it; judging costs by the frame, the bake by the second."""


def dambreak_spec(water: Sequence[float], tank: Sequence[float], spacing: float, seconds: float) -> WorldSpec:
    """Water in the corner of a tank whose walls are the closed sides of its domain, sizes in metres."""
    size = [round(v / spacing) * spacing for v in water]
    frames = round(seconds * FPS) + 1
    column = {"shape": {"kind": "box", "size": size}}
    return WorldSpec.model_validate(
        {
            "prompt": "A column of water collapses in a tank.",
            "title": "Dam break",
            "materials": {"water": {"density": 1000, "substance": "water", "appearance": {"transmission": 1}}},
            "entities": {
                "water": {
                    "role": "column of water", "motion": "dynamic", "material": "water", "dimensions": {"size": size},
                    "pose": {"position": [0.5 * v for v in size]}, "parts": {"body": column},
                    "physics": {"category": "liquid", "resolution": spacing, "viscosity": 0.0},
                },
            },
            "story": {"beats": {"falls": {
                "text": "the column collapses", "owner": "water", "subject": "water", "frames": [0, frames - 1],
                "predicate": {"kind": "liquid_speed", "entity": "water", "measure": "largest", "min": 1.0},
            }}},
            "shots": {"wide": {"frames": [0, frames - 1], "covers": ["falls"], "subjects": ["water"], "keys": {
                "k": {"frame": 0, "position": [2.2, -2.0, 1.4], "target": [0.6, 0.5, 0.2]}}}},
            "simulation": {
                "fps": FPS, "frames": frames,
                "solvers": {"water": {"engine": "dfsph", "members": ["water"], "settings": {
                    "domain": {"center": [0.5 * v for v in tank], "size": list(tank), "sides": ["closed"] * 6}}}},
            },
        }
    )  # fmt: skip


def dambreak_figures(spec: WorldSpec) -> dict[str, Any]:
    """Bake and judge the world.

    Returns `volume_drift`, the largest relative change since frame 0 of the volume that surface and spray show; `verify_over_bake`, processor time of
    all checks over that of the bake with its surfaces; and which mandatory rows are open.
    """
    built = build_all(spec)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        begin = time.process_time()
        caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
        bake = time.process_time() - begin
        begin = time.process_time()
        rows = run_checks(Candidate(folder, spec, built, "full", caches, "run", cache_digest(caches)))
        verify = time.process_time() - begin
        surface = LiquidSurface(caches["water"])
        names = ("record/surface_volume", "record/spray_volume")
        volume = np.array([sum(float(surface.files.read(k, (n,))[n]) for n in names) for k in range(surface.count())])
    open_rows = sorted(r.id for r in rows if r.mandatory and r.status not in ("pass", "not_applicable"))
    return {
        "volume_drift": round(float(np.abs(volume / volume[0] - 1.0).max()), 5),
        "volume_drift_end": round(float(volume[-1] / volume[0] - 1.0), 5),
        "verify_over_bake": round(verify / bake, 3),
        "world": {"frames": spec.simulation.frames, "bake_cpu_s": round(bake, 2), "verify_cpu_s": round(verify, 2), "rows": len(rows), "open_rows": open_rows[:8]},
    }  # fmt: skip
