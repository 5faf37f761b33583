"""Newton's VBD and MuJoCo's flex on the sheet of the cloth benchmark, each run by a Python of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import Any

__all__ = ["ENV_NEWTON", "mujoco_flex", "newton_vbd"]

ENV_NEWTON = "WORLDAGENT_NEWTON_PYTHON"
"""Python of an environment with `pip install newton==1.8.0`."""
_COMMON = """
import json, sys, time
import numpy as np
what = json.loads(sys.argv[1])
def grid(columns, rows, edge):
    x, z = np.meshgrid(np.arange(columns) * edge, (np.arange(rows) - rows + 1) * edge)
    points = np.stack([x.ravel(), 0 * x.ravel(), z.ravel()], 1)
    a = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    even = (((np.arange(rows - 1)[:, None] + np.arange(columns - 1)) % 2) == 0).ravel()[:, None]
    b, c = a + 1, a + columns
    d = c + 1
    one = np.where(even, np.stack([a, b, d], 1), np.stack([a, b, c], 1))
    two = np.where(even, np.stack([a, d, c], 1), np.stack([b, d, c], 1))
    return points, np.concatenate([one, two])
"""
_NEWTON = (
    _COMMON
    + """
import warp as wp
wp.config.quiet = True
import newton
def made(columns, rows, edge, contact):
    points, faces = grid(columns, rows, edge)
    b = newton.ModelBuilder()
    # A St. Venant-Kirchhoff sheet of Poisson's ratio 0: Young's modulus times thickness is twice tri_ke.
    b.add_cloth_mesh(pos=wp.vec3(0, 0, 0), rot=wp.quat_identity(), scale=1.0, vel=wp.vec3(0, 0, 0), vertices=[wp.vec3(*p) for p in points],
                     indices=faces.ravel().tolist(), density=what["density"], tri_ke=0.5 * what["stiffness"], tri_ka=0.0, tri_kd=what["damping"],
                     edge_ke=what["bend"], edge_kd=0.0, particle_radius=0.15 * edge)
    for i in np.flatnonzero(points[:, 2] > -1e-9):
        b.particle_mass[int(i)] = 0.0
        b.particle_flags[int(i)] = b.particle_flags[int(i)] & ~int(newton.ParticleFlags.ACTIVE)
    b.color()
    model = b.finalize(device=what.get("device", "cpu"))
    solver = newton.solvers.SolverVBD(model, iterations=what["iterations"], particle_enable_self_contact=contact,
                                      particle_self_contact_margin=0.3 * edge, particle_self_contact_gap=0.3 * edge)
    return model, solver, points
def frames(model, solver, count):
    one, two, control = model.state(), model.state(), model.control()
    pipeline = newton.CollisionPipeline(model)
    contacts = pipeline.contacts()
    dt = 1.0 / 24 / what["substeps"]
    def frame():
        a, b = one, two
        pipeline.collide(a, contacts)
        if solver.particle_enable_self_contact and hasattr(solver, "rebuild_bvh"):
            solver.rebuild_bvh(a)
        for _ in range(what["substeps"]):
            a.clear_forces()
            solver.step(a, b, control, contacts, dt)
            a, b = b, a
        if a is not one:
            one.assign(a)
    launch, spent = frame, []
    if model.device.is_cuda:
        frame()
        with wp.ScopedCapture() as captured:
            frame()
        launch = lambda: wp.capture_launch(captured.graph)
    for _ in range(count):
        start = time.perf_counter()
        launch()
        wp.synchronize()
        spent.append(time.perf_counter() - start)
    return one.particle_q.numpy(), spent
columns, rows, edge = what["strip"]
model, solver, points = made(columns, rows, edge, False)
x, _ = frames(model, solver, what["settle"])
low = points[:, 2] < points[:, 2].min() + 1e-9
found = {"stretch_m": float(points[low, 2].mean() - x[low, 2].mean())}
if what["sheet"]:
    columns, rows, edge = what["sheet"]
    model, solver, _ = made(columns, rows, edge, True)
    _, spent = frames(model, solver, 3)
    found["ms_per_frame"] = 1e3 * min(spent[1:])
print("PEER " + json.dumps(found))
"""
)
_MUJOCO = (
    _COMMON
    + """
import mujoco
def made(columns, rows, edge, contact):
    mass = what["density"] * (columns - 1) * (rows - 1) * edge**2
    text = f'''<mujoco><option timestep="{what['step']}" integrator="discrete" solver="CG" jacobian="sparse"/><size memory="4G"/><worldbody>
<flexcomp name="s" type="grid" dim="2" count="{columns} {rows} 1" spacing="{edge} {edge} {edge}" mass="{mass}" radius="{0.075 * edge}" euler="90 0 0">
<contact selfcollide="{'auto' if contact else 'none'}"/><edge equality="false"/>
<elasticity young="{1e3 * what['stiffness']}" poisson="0" thickness="1e-3" damping="{what['damping']}" elastic2d="both"/>
<pin gridrange="0 {rows - 1} {columns - 1} {rows - 1}"/></flexcomp></worldbody></mujoco>'''
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data
model, data = made(*what["strip"], False)
low = data.flexvert_xpos[:, 2].min()
seen = []
for k in range(round(what["settle"] / 24 / what["step"])):
    mujoco.mj_step(model, data)
    if k % 10 == 0:
        seen.append(low - data.flexvert_xpos[:, 2].min())
found = {"stretch_m": float(np.mean(seen[-len(seen) // 3:]))}
if what["sheet"]:
    model, data = made(*what["sheet"], True)
    mujoco.mj_step(model, data)
    start, count = time.perf_counter(), 0
    while count < 3 or time.perf_counter() - start < 2.0:
        mujoco.mj_step(model, data)
        count += 1
    found["ms_per_frame"] = 1e3 * (time.perf_counter() - start) / count / 24 / what["step"]
print("PEER " + json.dumps(found))
"""
)


def _asked(python: str, script: str, what: dict[str, Any]) -> tuple[dict[str, float] | None, str]:
    """Answer of a peer, or the reason why there is none."""
    try:
        ended = subprocess.run(
            [python, "-c", script, json.dumps(what)], capture_output=True, text=True, check=False, timeout=3600
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return None, str(error)[:200]
    said = [line for line in ended.stdout.splitlines() if line.startswith("PEER ")]
    if said:
        found: dict[str, float] = json.loads(said[-1][5:])
        return found, ""
    lines = ended.stderr.strip().splitlines()
    return None, lines[-1] if lines else f"it ended with code {ended.returncode}"


def newton_vbd(what: dict[str, Any]) -> tuple[dict[str, float] | None, str]:
    """Stretch of the strip [m] and time of a frame of the sheet [ms]."""
    python = os.environ.get(ENV_NEWTON)
    return _asked(python, _NEWTON, what) if python else (None, f"${ENV_NEWTON} names no Python with newton")


def mujoco_flex(what: dict[str, Any]) -> tuple[dict[str, float] | None, str]:
    """The same of MuJoCo's flex with this Python's MuJoCo."""
    return _asked(sys.executable, _MUJOCO, what)
