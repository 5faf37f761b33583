"""Benchmark `liquid-dambreak`: the particle liquid beside SPlisHSPlasH on the same dam break, error bound and machine.

0.4 x 0.8 x 0.46 m of water in a tank of 1.6 x 1.0 x 0.5 m, radius 12.5 mm, 0.5 s. The peer (`pip install pysplishsplash==2.19.0`) runs
in the Python that `$WORLDAGENT_PEER_PYTHON` names; its wheel brings an own libGL, which must be replaced by the system's where both are
present (`patchelf --replace-needed`). Its best of 1 and 2 threads counts, with OMP_WAIT_POLICY=passive. Drift of the surface's volume
and the cost of judging come from the same scene baked as a world.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..simulation.boundaries import BodyState
from ..simulation.liquid.dfsph import Dfsph, DfsphSettings
from ..simulation.liquid.engine import Fluid, LiquidSetup
from .liquid_dambreak_world import dambreak_figures, dambreak_spec

__all__ = ["run"]

ENV_PEER = "WORLDAGENT_PEER_PYTHON"
RADIUS, SECONDS, ERROR = 0.0125, 0.5, 5e-4
WATER, TANK = (0.4, 0.8, 0.46), (1.6, 1.0, 0.5)
_PEER = """
import json, re, sys, time
import pysplishsplash as sph
base = sph.Exec.SimulatorBase()
base.init(sceneFile=sys.argv[1], useGui=False, initialPause=False, outputDir=sys.argv[2], stopAt=float(sys.argv[3]))
base.initSimulation()
start = time.perf_counter()
base.runSimulation()
spent = time.perf_counter() - start
base.cleanup()
print("PEER " + json.dumps({"seconds": spent}))
"""

_SAID = {"step_s": "Time step size", "iterations_density": "DFSPH - iterations", "iterations_divergence": "DFSPH - iterationsV"}


def _scene() -> dict[str, Any]:
    low = [-0.5 * TANK[0], 0.0, -0.5 * TANK[1]]
    water = [low[0] + WATER[0], WATER[2], low[2] + WATER[1]]
    return {
        "Configuration": {
            "particleRadius": RADIUS,
            "numberOfStepsPerRenderUpdate": 100,
            "simulationMethod": 4,
            "gravitation": [0, -9.81, 0],
            "cflMethod": 1,
            "cflFactor": 0.4,
            "cflMaxTimeStepSize": 0.005,
            "timeStepSize": 0.001,
            "maxIterations": 100,
            "maxError": 100 * ERROR,
            "maxIterationsV": 100,
            "maxErrorV": 0.1,
            "boundaryHandlingMethod": 0,
        },
        "Materials": [{"id": "Fluid", "density0": 1000, "viscosity": 0.0, "viscosityMethod": 0}],
        "RigidBodies": [
            {
                "geometryFile": "",
                "translation": [0, 0.5 * TANK[2], 0],
                "scale": [TANK[0], TANK[2], TANK[1]],
                "isDynamic": False,
                "isWall": True,
                "mapInvert": True,
                "samplingMode": 1,
            }
        ],
        "FluidBlocks": [{"denseMode": 0, "start": low, "end": water}],
    }


def _peer(threads: int) -> tuple[dict[str, float] | None, str]:
    """Its seconds, steps and mean iterations, or why there are none."""
    from trimesh.creation import box

    with tempfile.TemporaryDirectory() as folder:
        scene = _scene()
        mesh = Path(folder) / "box.obj"
        box((1, 1, 1)).export(mesh)
        scene["RigidBodies"][0]["geometryFile"] = str(mesh)
        path = Path(folder) / "scene.json"
        path.write_text(json.dumps(scene))
        command = [os.environ.get(ENV_PEER, sys.executable), "-c", _PEER, str(path), folder, str(SECONDS)]
        env = {**os.environ, "OMP_WAIT_POLICY": "passive", "OMP_NUM_THREADS": str(threads)}
        ended = subprocess.run(command, capture_output=True, text=True, check=False, env=env, timeout=1200)
        said = [line for line in ended.stdout.splitlines() if line.startswith("PEER ")]
    if not said:
        lines = ended.stderr.strip().splitlines()
        return None, lines[-1] if lines else f"it ended with code {ended.returncode}"
    found = {"seconds": float(json.loads(said[-1][5:])["seconds"])}
    for name, label in _SAID.items():
        number = re.search(rf"Average number: {re.escape(label)}: ([0-9.e+-]+)", ended.stdout)
        if number:
            found[name] = float(number.group(1))
    return found, ""


def _ours() -> dict[str, Any]:
    s = 2 * RADIUS
    cells = [round(extent / s) for extent in WATER]
    x = (np.indices(cells).reshape(3, -1).T + 0.5) * s
    n = len(x)
    setup = LiquidSetup(
        spacing=s,
        lower=np.zeros(3),
        upper=np.array(TANK),
        sides=("closed",) * 6,
        fluids=(Fluid("water", 1000.0, 0.0),),
        gravity=np.array([0.0, 0.0, -9.81]),
        position=np.asarray(x, dtype=np.float64),
        velocity=np.zeros((n, 3)),
        fluid=np.zeros(n, dtype=np.int32),
        volume=np.full(n, s**3),
    )
    none = np.zeros((0, 3))
    state = BodyState(none, np.zeros((0, 3, 3)), none, none, none, np.zeros(0), np.zeros((0, 3, 3)), none)
    Dfsph(setup).step(1e-3, state)
    engine = Dfsph(setup, DfsphSettings(density_error=ERROR))
    reports = []
    start, cpu = time.perf_counter(), time.process_time()
    while engine.time < SECONDS:
        reports.append(engine.step(SECONDS - engine.time + 1e-9, state))
    return {
        "seconds": time.perf_counter() - start,
        "cpu_seconds": time.process_time() - cpu,
        "particles": n,
        "steps": len(reports),
        "iterations_density": float(np.mean([r.iterations[0] for r in reports])),
        "iterations_divergence": float(np.mean([r.iterations[1] for r in reports])),
        "capped": sum(r.capped for r in reports),
        "density_error": float(np.mean([r.density_error[0] for r in reports])),
        "packing": engine.full,
        "lost": engine.lost,
    }


def run() -> dict[str, Any]:
    """Seconds of ours and of the peer; ratio ours / theirs."""
    ours = min((_ours() for _ in range(2)), key=lambda found: float(found["seconds"]))
    print(f"ours {ours['seconds']:.2f} s", file=sys.stderr, flush=True)
    theirs: dict[int, dict[str, float]] = {}
    why = ""
    for threads in (1, 2):
        found, reason = _peer(threads)
        if found is None:
            why = reason
            break
        theirs[threads] = found
        print(f"peer, {threads} threads {found['seconds']:.2f} s", file=sys.stderr, flush=True)
    best = min((found["seconds"] for found in theirs.values()), default=None)
    return {
        **{name: round(value, 6) if isinstance(value, float) else value for name, value in ours.items()},
        "peer": {str(k): {name: round(v, 6) for name, v in found.items()} for k, found in theirs.items()},
        "ratio_vs_splishsplash": round(ours["seconds"] / best, 3) if best else None,
        **dambreak_figures(dambreak_spec(WATER, TANK, 2 * RADIUS, SECONDS)),
        **({"left_out": {"splishsplash": why}} if why else {}),
    }
