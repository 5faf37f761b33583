"""Benchmark `contact-scale`: the full contact check of 1,000 bodies that stay in touch range of four neighbours each.

What counts is the check of a candidate with its caches: reading the motion, building trees, the coarse search, all
clearances, the rows. Making the world is not counted, nor is the compilation of kernels, which happens once per
installation (`compile_s`). Exponents come from smaller worlds of the same kind: log-log slopes of time over bodies and
over frames.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.launch import chosen_device, cores, load
from ..testing.worlds import small_worlds as small
from ..verifiers.contact.check import check
from ..verifiers.scene.surfaces import surfaces_of
from ..worlds.arrays import RigidPose
from ..worlds.built import BuiltBody, BuiltEntity, BuiltPart
from ..worlds.cache import Cache
from ..worlds.candidate import Candidate
from .contact_shapes import lattice

__all__ = ["run"]

BODIES = (250, 500, 1000)
FRAMES = (60, 120, 240)
FPS = 24
MOST_SECONDS = 60.0
"""[s] What the largest world may take on two cores."""


def _candidate(folder: Path, bodies: int, frames: int, seed: int) -> Candidate:
    """A world of hand-made motion: its caches are written, nothing is simulated."""
    made = lattice(bodies, frames, FPS, seed)
    names = [f"b{k:04d}" for k in range(bodies)]
    low_high = [(m.vertices.min(axis=0), m.vertices.max(axis=0)) for m in made.meshes]
    entities = {
        name: small.box(*(high - low), motion="dynamic", at=tuple(made.position[k, 0]))
        for k, (name, (low, high)) in enumerate(zip(names, low_high, strict=True))
    }
    spec = small.world(entities, frames=frames, fps=FPS)
    built = {}
    for k, name in enumerate(names):
        body = BuiltBody("body", RigidPose(np.zeros(3), np.array(small.IDENTITY)), 1.0, np.zeros(3), np.eye(3) * 1e-3, 1e-3)
        part = BuiltPart("p0", "body", "wood", made.meshes[k], (), True, (0.0, 0.0), False)
        built[name] = BuiltEntity(name, (body,), (part,), "bench")
    tracks = {name: (made.position[k], made.quaternion[k]) for k, name in enumerate(names)}
    written = small.make_candidate(folder, spec, tracks=tracks, built=built)
    # The check reads the caches from their files, as it does on a candidate that was just opened.
    opened = {name: Cache(folder / "cache" / name) for name in written.caches}
    return Candidate(folder, spec, built, "full", opened, written.artifact, written.digest)


def _measure(bodies: int, frames: int, seed: int) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        candidate = _candidate(Path(folder), bodies, frames, seed)
        wall, cpu = time.perf_counter(), time.process_time()
        rows = check(candidate)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        near = surfaces_of(candidate).moving
    states = {r.status for r in rows}
    if states != {"pass"}:
        raise RuntimeError(f"the lattice of {bodies} bodies must pass; rows say {sorted(states)}")
    within = sum(int((s <= surfaces_of(candidate).reach).sum()) for s in near.values())
    print(
        f"{bodies} bodies, {frames} frames: {wall:.1f} s ({cpu:.1f} s of processor time), {len(near)} near pairs", file=sys.stderr
    )
    return {"bodies": bodies, "frames": frames, "seconds": wall, "cpu_s": cpu, "near_pairs": len(near), "near_queries": within}


def _slope(x: list[float], y: list[float]) -> float:
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def run(*, seed: int = 1) -> dict[str, Any]:
    """Measure; progress goes to stderr."""
    device = chosen_device()
    start = time.perf_counter()
    from ..geometry.clearance_kernels import nearest

    load(nearest, device, report=lambda text: print(text, file=sys.stderr))
    compiling = time.perf_counter() - start
    by_bodies = [_measure(n, max(FRAMES), seed) for n in BODIES]
    by_frames = [_measure(max(BODIES), n, seed) for n in FRAMES[:-1]] + [by_bodies[-1]]
    largest = by_bodies[-1]
    return {
        **{k: largest[k] for k in ("bodies", "frames", "seconds", "cpu_s", "near_pairs", "near_queries")},
        "within_budget": largest["seconds"] <= MOST_SECONDS,
        "microseconds_per_near_query": 1e6 * largest["seconds"] / largest["near_queries"],
        "exponent_bodies": _slope([m["bodies"] for m in by_bodies], [m["cpu_s"] for m in by_bodies]),
        "exponent_frames": _slope([m["frames"] for m in by_frames], [m["cpu_s"] for m in by_frames]),
        "exponents_of": "processor time, which other processes do not change",
        "compile_s": compiling,
        "device": device,
        "threads": cores() if device == "cpu" else 1,
        "runs": [*by_bodies, *by_frames[:-1]],
    }
