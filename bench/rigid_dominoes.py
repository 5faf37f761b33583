"""Benchmark `rigid-dominoes`: a falling row, its speed against plain MuJoCo, and what the visible surfaces do.

Our time is that of `SolverRigid.advance`: restitution, friction without lift, events, impulses, records and the check
of visible surfaces included. Plain MuJoCo steps the same compiled model from the same state by the same number of
steps, in the same run, alternating second by second. Its motion differs (its contacts lift what slides), its work
is that of the same model. Both run in one thread, so times are processor times: other processes do not count.
"""

from __future__ import annotations

import json
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..construction import build_entity
from ..simulation.rigid import SolverRigid
from ..worlds.cache import Cache, write_container
from ..worlds.candidate import Candidate
from ..worlds.spec import WorldSpec

__all__ = ["run"]

DOMINOES = 200
FEW = 20
SECONDS = 10
FPS = 24
SIZE = (0.02, 0.1, 0.2)
PITCH = 0.08
"""Distance of neighbours [m]."""
NEIGHBOURS = 4
"""Dominoes further along the row cannot touch: a fallen one reaches 0.2 m."""


def _world(count: int) -> WorldSpec:
    def entity(
        motion: str, material: str, shape: dict[str, Any], at: tuple[float, float, float], **physics: Any
    ) -> dict[str, Any]:
        return {
            "role": "domino row",
            "motion": motion,
            "material": material,
            "dimensions": {"size": shape.get("size") or (2 * shape["radius"],) * 3},
            "physics": {"category": "rigid", **physics},
            "pose": {"position": at},
            "parts": {"p": {"shape": shape}},
        }

    length = count * PITCH
    row = {
        f"d{k:03d}": entity("dynamic", "wood", {"kind": "box", "size": SIZE}, (PITCH * k, 0.0, SIZE[2] / 2)) for k in range(count)
    }
    ball = entity(
        "dynamic", "steel", {"kind": "sphere", "radius": 0.05}, (-0.2, 0.0, 0.05), linear_velocity=(1.0, 0, 0), mass=0.5
    )
    table = entity("static", "wood", {"kind": "box", "size": (length + 4, 2, 0.2)}, (length / 2, 0.0, -0.1))
    entities = {"table": table, "ball": ball, **row}
    return WorldSpec.model_validate(
        {
            "title": "dominoes",
            "prompt": "a row of dominoes",
            "materials": {
                "wood": {"density": 600.0, "friction": 0.4, "restitution": 0.1, "substance": "wood"},
                "steel": {"density": 7800.0, "friction": 0.3, "restitution": 0.3, "substance": "steel"},
            },
            "entities": entities,
            "simulation": {
                "fps": FPS,
                "frames": SECONDS * FPS + 1,
                "solvers": {"row": {"engine": "mujoco", "members": list(entities)}},
            },
        }
    )


def _prepared(spec: WorldSpec) -> SolverRigid:
    solver = SolverRigid(spec, {n: build_entity(spec, n, Path()) for n in spec.entities}, "row")
    solver.prepare()
    return solver


def _bake(spec: WorldSpec, folder: Path) -> tuple[Candidate, float, list[float]]:
    """Frames in `folder`; seconds of stepping, and the ratio to plain MuJoCo in each second of the sequence."""
    import mujoco

    solver = _prepared(spec)
    cache = Cache(folder)
    cache.write_index(solver.index())
    write_container(cache.path(0), solver.frame_data())
    other = mujoco.MjData(solver.model)
    ours, ratios = 0.0, []
    for second in range(SECONDS):
        mujoco.mj_copyData(other, solver.model, solver.data)
        taken, steps, frames = 0.0, 0, []
        for frame in range(second * FPS + 1, (second + 1) * FPS + 1):
            begin = time.process_time()
            solver.advance(frame)
            frames.append((frame, solver.frame_data()))
            taken += time.process_time() - begin
            steps += round(1 / FPS / solver.settings.step)
        begin = time.process_time()
        for _ in range(steps):
            mujoco.mj_step(solver.model, other)
        plain = time.process_time() - begin
        ours += taken
        ratios.append(taken / plain)
        for frame, data in frames:
            write_container(cache.path(frame), data)
        print(f"second {second + 1}: {taken:.2f} s, plain {plain:.2f} s", file=sys.stderr)
    return Candidate(folder, spec, solver.built, "full", {"row": cache}, digest="bench"), ours, ratios


def _worst_clearance(candidate: Candidate) -> float:
    """Smallest clearance of visible surfaces over all written frames [m]."""
    from ..geometry import Solid, clearance_series

    names = [n for n in candidate.spec.entities if n != "table"]
    solids = {n: Solid.from_mesh(candidate.entity(n).parts[0].render, closed=True) for n in candidate.spec.entities}
    tracks = {n: candidate.track(n) for n in candidate.spec.entities}
    pairs = [(n, "table") for n in names]
    pairs += [(a, b) for i, a in enumerate(names) for b in names[i + 1 : i + 1 + NEIGHBOURS]]
    return min(float(clearance_series(solids[a], tracks[a], solids[b], tracks[b], skip_above=2e-3).min()) for a, b in pairs)


def _verify_over_bake(candidate: Candidate, bake: float) -> tuple[float, str | None]:
    """Every check that judges a full bake; `delivery` needs a world folder and is left out."""
    from ..verifiers.checks import names_of, run_checks

    begin = time.process_time()
    rows = run_checks(candidate, only=[n for n in names_of("full") if n != "delivery"])
    seconds = time.process_time() - begin
    bad = sorted(r.id for r in rows if r.mandatory and r.status not in ("pass", "not_applicable"))
    return round(seconds / bake, 3), f"rows that do not pass: {bad[:8]}" if bad else None


def run() -> dict[str, Any]:
    """Measure; progress goes to stderr."""
    with tempfile.TemporaryDirectory() as folder:
        spec = _world(DOMINOES)
        candidate, seconds, ratios = _bake(spec, Path(folder))
        worst = _worst_clearance(candidate)
        share, reason = _verify_over_bake(candidate, seconds)
        tilt = np.abs(candidate.caches["row"].series("quaternion")[-1, 1:, 2])
    few = _prepared(_world(FEW))
    begin = time.process_time()
    for frame in range(1, SECONDS * FPS + 1):
        few.advance(frame)
    few_seconds = time.process_time() - begin
    settings = spec.simulation.rigid["row"].settings
    return {
        "name": "rigid-dominoes",
        "dominoes": DOMINOES,
        "fallen": int((tilt > 0.3).sum()),
        "spacing_m": PITCH,
        "step_s": settings.step,
        "skin_m": settings.skin,
        "realtime_factor": round(SECONDS / seconds, 3),
        "realtime_factor_20": round(SECONDS / few_seconds, 3),
        "ratio_vs_plain_mujoco": round(statistics.median(ratios), 3),
        "ratio_per_second": [round(r, 3) for r in ratios],
        "contact_error_m": max(0.0, -worst),
        "least_clearance_m": worst,
        "verify_over_bake": share,
        "verify_note": reason,
    }


if __name__ == "__main__":
    print(json.dumps(run()))
