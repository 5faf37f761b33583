"""Particle-steps per second of the particle liquid on one device, with bodies, and the times of its kernels, as one JSON object.

    python -m worldagent.bench.liquid_gpu [--particles 2000000] [--steps 30] [--device cuda] [--bodies 20]

Needs numpy, scipy and warp-lang only, and this package on the path.
"""

from __future__ import annotations

import argparse
import cProfile
import json
import pstats
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.launch import chosen_device, warp
from ..simulation.boundaries import BodyState, Boundary
from ..simulation.liquid.dfsph import Dfsph, DfsphSettings
from ..simulation.liquid.engine import Fluid, LiquidSetup
from ..simulation.passes import Chain, Pass
from ..worlds.arrays import F64
from ..worlds.built import TriangleMesh

__all__ = ["measure", "run"]

ASKED = 80e6
"""Particle-steps per second that are asked of an H200 at 2 million particles."""
SPACING = 0.02
SIDE = 8
"""Edge of a floating box in spacings."""
_CORNERS = np.array([(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_FACES = [
    (0, 1, 3),
    (0, 3, 2),
    (4, 6, 7),
    (4, 7, 5),
    (0, 4, 5),
    (0, 5, 1),
    (2, 3, 7),
    (2, 7, 6),
    (0, 2, 6),
    (0, 6, 4),
    (1, 5, 7),
    (1, 7, 3),
]


def _scene(particles: int, bodies: int, device: str) -> tuple[LiquidSetup, BodyState]:
    """A dam of twice its depth, two and a half times as long a tank, and boxes of half the density in it."""
    depth = max(8, round((particles / 4) ** (1 / 3)))
    cells = np.array([2 * depth, 2 * depth, depth])
    x = (np.indices(tuple(cells)).reshape(3, -1).T + 0.5) * SPACING
    side = SIDE * SPACING
    places = [(i + 0.5) * 1.5 * side for i in range(int(2 * depth / SIDE / 1.5))]
    center = np.array([(a, b, 0.5 * depth * SPACING) for a in places for b in places])[:bodies].reshape(-1, 3)
    grid = np.zeros(tuple(cells), dtype=bool)
    for c in center:
        low, high = (np.clip(np.round((c + sign * 0.5 * side) / SPACING).astype(int), 0, cells) for sign in (-1, 1))
        grid[low[0] : high[0], low[1] : high[1], low[2] : high[2]] = True
    x = x[~grid.ravel()]
    n, b = len(x), len(center)
    mesh = TriangleMesh(side * _CORNERS, np.array(_FACES, dtype=np.int32))
    setup = LiquidSetup(
        spacing=SPACING,
        lower=np.zeros(3),
        upper=np.array([5.0, 2.0, 2.0]) * depth * SPACING,
        sides=("closed",) * 6,
        fluids=(Fluid("water", 1000.0, 1e-3),),
        gravity=np.array([0.0, 0.0, -9.81]),
        position=x,
        velocity=np.zeros((n, 3)),
        fluid=np.zeros(n, dtype=np.int32),
        volume=np.full(n, SPACING**3),
        boundaries=tuple(Boundary(f"box{k}", mesh, "dynamic") for k in range(b)),
        device=device,
    )
    mass = 500.0 * side**3
    fall = np.tile([0.0, 0.0, -9.81], (b, 1))
    turns, spin = np.tile(np.eye(3), (b, 1, 1)), np.tile(np.eye(3) * 6.0 / (mass * side**2), (b, 1, 1))
    state = BodyState(center, turns, center, np.zeros((b, 3)), np.zeros((b, 3)), np.full(b, 1.0 / mass), spin, fall)
    return setup, state


def _advance(state: BodyState, given: F64, dt: float) -> None:
    """Free bodies, not turning: enough to keep them in the liquid for some steps."""
    state.velocity = state.velocity + given[:, :3] * state.inverse_mass[:, None] + dt * state.acceleration
    state.position = state.center = state.center + dt * state.velocity


def measure(particles: int, steps: int, device: str, bodies: int) -> dict[str, Any]:
    """Build the scene, warm up, time `steps` steps, then some more with every kernel timed alone."""
    where = chosen_device(device)
    start = time.perf_counter()
    setup, state = _scene(particles, bodies, where)
    engine = Dfsph(setup, DfsphSettings(density_error=5e-4))
    built = time.perf_counter() - start
    start = time.perf_counter()
    for _ in range(3):
        report = engine.step(1.0, state)
        _advance(state, report.impulse, report.dt)
    warm_up = time.perf_counter() - start
    iterations = []
    start, cpu, begin = time.perf_counter(), time.process_time(), engine.time
    for _ in range(steps):
        report = engine.step(1.0, state)
        _advance(state, report.impulse, report.dt)
        iterations.append(report.iterations)
    wall, cpu = time.perf_counter() - start, time.process_time() - cpu
    rate = engine.store.count * steps / wall
    found = {
        "device": str(warp().get_device(where).name),
        "particles": engine.store.count,
        "bodies": len(setup.boundaries),
        "steps": steps,
        "build_s": round(built, 2),
        "warm_up_s": round(warm_up, 2),
        "particle_steps_per_s": round(rate),
        "of_asked": round(rate / ASKED, 3),
        "particle_steps_per_cpu_s": round(engine.store.count * steps / max(cpu, 1e-9)),
        "ms_per_step": round(1e3 * wall / steps, 3),
        "simulated_s": round(engine.time - begin, 5),
        "iterations_density": float(np.mean([i[0] for i in iterations])),
        "iterations_divergence": float(np.mean([i[1] for i in iterations])),
        "density_error": report.density_error[0],
        "neighbours": round(float(engine.work.count[: engine.store.count].numpy().mean()), 2),
        "memory_gib": 0.0 if where == "cpu" else round(warp().get_mempool_used_mem_high(where) / 2**30, 3),
    }
    few = min(5, steps)
    found["host_per_step"] = _host_work(engine, state, few)
    found["kernels_per_step"] = (_host_times if where == "cpu" else _device_times)(engine, state, few, where)
    return found


def _step(engine: Dfsph, state: BodyState, steps: int) -> None:
    for _ in range(steps):
        report = engine.step(1.0, state)
        _advance(state, report.impulse, report.dt)


def _host_work(engine: Dfsph, state: BodyState, steps: int) -> dict[str, float]:
    """Work of the host in a step: reads (each waits for the device), writes, launches, graphs; and where its time goes."""
    wp = warp()
    made: dict[str, int] = defaultdict(int)
    kinds = {
        "reads": (wp.array, "numpy"),
        "writes": (wp.array, "assign"),
        "passes": (Pass, "__call__"),
        "chains": (Chain, "__call__"),
    }
    kinds |= {"made_passes": (Pass, "__init__"), "made_chains": (Chain, "__init__")}
    plain = {name: getattr(owner, attribute) for name, (owner, attribute) in kinds.items()}

    def counted(name: str) -> Any:
        def call(*given: Any, **named: Any) -> Any:
            made[name] += 1
            return plain[name](*given, **named)

        return call

    profile = cProfile.Profile()
    try:
        for name, (owner, attribute) in kinds.items():
            setattr(owner, attribute, counted(name))
        _step(engine, state, steps)
    finally:
        for name, (owner, attribute) in kinds.items():
            setattr(owner, attribute, plain[name])
    profile.runcall(_step, engine, state, steps)
    slow = sorted(pstats.Stats(profile).stats.items(), key=lambda item: -item[1][2])[:12]  # type: ignore[attr-defined]
    times = {f"{Path(file).name}:{line} {name}": round(1e3 * row[2] / steps, 3) for (file, line, name), row in slow}
    return {**{name: made[name] / steps for name in kinds}, **times}


def _device_times(engine: Dfsph, state: BodyState, steps: int, device: str) -> dict[str, list[float]]:
    """Milliseconds and number of everything that the device does in a step, by its own clock (without graphs)."""
    wp = warp()
    engine.passes.graphs = False
    wp.timing_begin(cuda_filter=wp.TIMING_ALL)
    _step(engine, state, steps)
    spent: dict[str, list[float]] = defaultdict(lambda: [0.0, 0.0])
    for one in wp.timing_end():
        name = one.name.replace("forward kernel ", "")
        spent[name][0] += one.elapsed / steps
        spent[name][1] += 1 / steps
    engine.passes.graphs = True
    rows = sorted(spent.items(), key=lambda item: -item[1][0])
    total = [round(sum(row[k] for _, row in rows), 3) for k in (0, 1)]
    return {"all": total, **{name: [round(v, 3) for v in row] for name, row in rows}}


def _host_times(engine: Dfsph, state: BodyState, steps: int, device: str) -> dict[str, list[float]]:
    """Milliseconds and number of all passes of a step, by the host's clock."""
    spent: dict[str, list[float]] = defaultdict(lambda: [0.0, 0.0])
    plain = Pass.__call__

    def timed(one: Pass) -> None:
        start = time.perf_counter()
        plain(one)
        spent[one.name][0] += 1e3 * (time.perf_counter() - start) / steps
        spent[one.name][1] += 1 / steps

    Pass.__call__ = timed  # type: ignore[method-assign, assignment]
    try:
        _step(engine, state, steps)
    finally:
        Pass.__call__ = plain  # type: ignore[method-assign]
    return {name: [round(v, 3) for v in row] for name, row in sorted(spent.items(), key=lambda item: -item[1][0])}


def run() -> dict[str, Any]:
    """A small scene on the device that `$WORLDAGENT_DEVICE` names (the CPU by default)."""
    return measure(20_000, 20, "", 4)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--particles", type=int, default=2_000_000)
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--device", default="cuda")
    parser.add_argument("--bodies", type=int, default=20)
    given = parser.parse_args()
    print(json.dumps(measure(given.particles, given.steps, given.device, given.bodies)))
