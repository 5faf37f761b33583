"""Grain-steps per second of grains that settle in a box, on the cores of this machine or on a GPU.

The same measurement alone, with numpy, scipy and warp-lang only: `python -m worldagent.bench.grains_gpu --grains 1000000 --device cuda`.
"""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np

from ..geometry.launch import chosen_device, cores, warp
from ..simulation.boundaries import BodyState, Boundary
from ..simulation.particles.engine import Grains
from ..simulation.particles.packing import fill_box
from ..simulation.particles.setup import GrainSetup, Kind
from ..worlds.built import TriangleMesh

__all__ = ["ASKED", "box_of_grains", "measure", "run"]

ASKED = {"cpu": 0.4e6, "cuda": 100e6}
"""Grain-steps per second that are asked of two cores with 20,000 grains, and of an H200 with a million."""
RADIUS, SPREAD = 5e-3, 0.15
YOUNG, DENSITY = 1e7, 2500.0
SHARE = 0.58
"""Share of the room that the grains fill at first, without overlap: a bed with five contacts a grain is there after some hundred steps."""
SETTLE, STEPS = 1500, 400
"""Steps before the measurement, and of it."""


def _slab(low: tuple[float, ...], high: tuple[float, ...], name: str) -> Boundary:
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], dtype=np.int32)
    return Boundary(name, TriangleMesh(corners, faces), "static", True, 0.5)


def box_of_grains(grains: int, device: str, *, depth: float = 0.5, seed: int = 0) -> tuple[GrainSetup, BodyState]:
    """Grains packed at random over the floor of a box, `depth` times as deep as wide, and the box at rest."""
    volume = grains * 4.0 / 3.0 * math.pi * RADIUS**3 * (1 + SPREAD**2) / SHARE
    half = 0.5 * (volume / depth) ** (1 / 3)
    inner, tall = half - 1.2 * RADIUS, 2.3 * depth * half + 4 * RADIUS
    position, radius = fill_box(
        np.array([-inner, -inner, 1.2 * RADIUS]), np.array([inner, inner, tall]), RADIUS, share=SHARE, spread=SPREAD, seed=seed
    )
    lowest = np.sort(np.argsort(position[:, 2], kind="stable")[:grains])
    position, radius = position[lowest], radius[lowest]
    assert len(radius) == grains
    t = 10 * RADIUS
    walls = (
        _slab((-half - t, -half - t, -t), (half + t, half + t, 0), "floor/body"),
        _slab((half, -half - t, 0), (half + t, half + t, 1.2 * tall), "east/body"),
        _slab((-half - t, -half - t, 0), (-half, half + t, 1.2 * tall), "west/body"),
        _slab((-half, half, 0), (half, half + t, 1.2 * tall), "north/body"),
        _slab((-half, -half - t, 0), (half, -half, 1.2 * tall), "south/body"),
    )
    setup = GrainSetup(
        lower=np.array([-half - 2 * t, -half - 2 * t, -2 * t]), upper=np.array([half + 2 * t, half + 2 * t, 1.5 * tall + 2 * t]),
        kinds=(Kind("sand", DENSITY, YOUNG, 0.25, 0.3, 0.5, 0.1, 0.0),), position=position, velocity=np.zeros((grains, 3)),
        radius=radius, kind=np.zeros(grains, dtype=np.int32), gravity=np.array([0.0, 0.0, -9.81]), boundaries=walls,
        centers=tuple(w.mesh.vertices.mean(axis=0) for w in walls), device=device,
    )  # fmt: skip
    zero, turns = np.zeros((5, 3)), np.tile(np.eye(3), (5, 1, 1))
    centers = np.array(setup.centers)
    still = BodyState(zero, turns, centers, zero.copy(), zero.copy(), np.zeros(5), np.zeros((5, 3, 3)), zero.copy())
    return setup, still


def measure(grains: int, device: str, *, settle: int = SETTLE, steps: int = STEPS) -> dict[str, Any]:
    """Let the grains fall together for `settle` steps, then time about `steps` more."""
    where = chosen_device(device)
    start = time.perf_counter()
    setup, still = box_of_grains(grains, where)
    engine = Grains(setup)
    dt = engine.stable_dt()
    built = time.perf_counter() - start
    start = time.perf_counter()
    for _ in range(max(1, settle // 50)):
        engine.step(50 * dt, still)
    warm = time.perf_counter() - start
    rebuilds, taken = engine.rebuilds, 0
    start, cpu = time.perf_counter(), time.process_time()
    for _ in range(max(1, steps // 50)):
        taken += engine.step(50 * dt, still).steps
    wall, cpu = time.perf_counter() - start, time.process_time() - cpu
    now = engine.now
    entries, met = _contacts(engine)
    rate = engine.count * taken / wall
    return {
        "device": str(warp().get_device(where).name),
        "cores": cores(),
        "grains": engine.count,
        "steps": taken,
        "grain_steps_per_s": round(rate),
        "of_asked": round(rate / ASKED["cpu" if where == "cpu" else "cuda"], 3),
        "grain_steps_per_cpu_s": round(engine.count * taken / max(cpu, 1e-9)),
        "ms_per_step": round(1e3 * wall / taken, 4),
        "build_s": round(built, 2),
        "settle_s": round(warm, 2),
        "step_s": dt,
        "listed_per_grain": round(entries, 2),
        "contacts_per_grain": round(met, 2),
        "lists_made": engine.rebuilds - rebuilds,
        "pairs_with_walls": now.pair_count,
        "fastest_m_per_s": round(engine.speed, 4),
        "lost": grains - engine.count,
    }


def _contacts(engine: Grains) -> tuple[float, float]:
    """Mean number of listed neighbours and of those in contact."""
    from ..simulation.particles.grain_kernels import MET

    now, n = engine.now, engine.count
    count = now.count[:n].numpy()
    near = now.near.numpy()
    rows = near.reshape(now.capacity, now.room)[:n] if now.stride == 1 else near.reshape(now.room, now.capacity).T[:n]
    listed = np.arange(now.room) < count[:, None]
    return float(count.mean()), float((listed & (rows >= MET)).sum() / max(n, 1))


def run() -> dict[str, Any]:
    """20,000 grains on the processor's cores."""
    found = measure(20_000, "cpu")
    assert math.isfinite(found["grain_steps_per_s"])
    return found
