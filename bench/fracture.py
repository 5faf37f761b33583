"""Benchmark `fracture`: an iron ball breaches a wall of about 500 bricks.

Twice: a heavy slow ball (52 kg at 20 m/s) that takes a part of the wall with it, and that of a 24-pounder (10.9 kg) which arrives at
100 m/s and punches through.
Figures: processor time over simulated time (the engine runs in one thread; other processes count as far as they take its caches),
pieces, how many bonds broke, clusters are loose and pieces knocked out, with what speed the ball leaves the wall, and the energy and
mass books.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..construction import build_entity
from ..simulation.rigid import SolverRigid
from ..worlds.spec import WorldSpec

__all__ = ["run", "wall_world"]

SECONDS = 1.5
FPS = 24
BALL = 0.12
SPEED = 20.0
CANNON_BALL = 0.0712
CANNON_SPEED = 100.0
KNOCKED_OUT = 0.05
"""Pieces that moved farther than this [m] count as knocked out."""
WALL = (4.0, 0.12, 2.4)
SETTINGS = {"step": 1e-3, "refine": 0, "impratio": 1.0, "tolerance": 1e-4}
"""The step is the contact time of the bonds, over which a blow loads them. Friction of debris need not hold to the last digit."""
BRICK = (0.24, 0.11, 0.07)


def wall_world(
    *,
    seconds: float = SECONDS,
    speed: float = SPEED,
    ball: float = BALL,
    wall: tuple[float, float, float] = WALL,
    tension: float = 5e5,
) -> WorldSpec:
    """A brick wall bonded at its foot and an iron ball in front of it."""

    def entity(
        role: str, motion: str, material: str, shape: dict[str, Any], at: tuple[float, ...], **more: Any
    ) -> dict[str, Any]:
        size = shape.get("size") or (2 * shape["radius"],) * 3
        return {
            "role": role,
            "motion": motion,
            "material": material,
            "dimensions": {"size": size},
            "pose": {"position": at},
            "parts": {"body": {"shape": shape}},
            **more,
        }

    bond = {"tension": tension, "shear": 1.5 * tension}
    broken = {"pattern": {"kind": "bricks", "size": BRICK, "joint": 0.01}, "bond": bond, "fixed": ["z-"]}
    flight = {"category": "rigid", "linear_velocity": (0.0, speed, 0.0)}
    entities = {
        "ground": entity("ground", "static", "stone", {"kind": "box", "size": (30.0, 30.0, 0.4)}, (0.0, 0.0, -0.2)),
        "wall": entity(
            "wall", "dynamic", "brick", {"kind": "box", "size": wall}, (0.0, 0.0, wall[2] / 2 + 1e-3), breakable=broken
        ),
        "ball": entity(
            "ball", "dynamic", "iron", {"kind": "sphere", "radius": ball}, (0.03, -1.0, 0.6 * wall[2]), physics=flight
        ),
    }
    return WorldSpec.model_validate(
        {
            "title": "breach",
            "prompt": "A cannonball breaches a brick wall.",
            "materials": {
                "brick": {"density": 1800.0, "friction": 0.6, "appearance": {"color": (0.5, 0.16, 0.09), "roughness": 0.9}},
                "iron": {"density": 7200.0, "friction": 0.4, "appearance": {"color": (0.08, 0.08, 0.09), "roughness": 0.5}},
                "stone": {"density": 2600.0, "friction": 0.6, "appearance": {"color": (0.4, 0.42, 0.36), "roughness": 1.0}},
            },
            "entities": entities,
            "simulation": {
                "fps": FPS,
                "frames": round(seconds * FPS) + 1,
                "solvers": {"main": {"engine": "mujoco", "members": list(entities), "settings": SETTINGS}},
            },
        }
    )


def run() -> dict[str, Any]:
    """Measure both shots; progress goes to stderr."""
    return {"name": "fracture", **breach(wall_world()), "cannon": breach(wall_world(speed=CANNON_SPEED, ball=CANNON_BALL))}


def breach(spec: WorldSpec) -> dict[str, Any]:
    """Figures of one wall."""
    begin = time.process_time()
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    cutting = time.process_time() - begin
    solver = SolverRigid(spec, built, "main")
    solver.prepare()
    start = solver.frame_data()
    begin, slowest, ball = time.process_time(), 0.0, solver.rigid.bodies.index("ball/body")
    leaves, clear = 0.0, WALL[1] / 2 + spec.entities["ball"].dimensions.size[0] / 2
    for frame in range(1, spec.simulation.frames):
        before = time.process_time()
        solver.advance(frame)
        state = solver.frame_data()
        if not leaves and state["position"][ball, 1] > clear:
            leaves = float(state["velocity"][ball, 1])
        slowest = max(slowest, time.process_time() - before)
        print(f"frame {frame}: {time.process_time() - begin:.1f} s", file=sys.stderr, flush=True)
    seconds = time.process_time() - begin
    data = solver.frame_data()
    clusters = solver.breakage.clusters("wall")
    pieces = [k for k, name in enumerate(solver.rigid.bodies) if name.startswith("wall/")]
    moved = np.linalg.norm((data["position"] - start["position"])[pieces], axis=1)
    return {
        "pieces": len(pieces),
        "bonds": len(data["bond/broken"]),
        "broken": int(data["bond/broken"].sum()),
        "ball_leaves_m_s": round(leaves, 2),
        "loose_clusters": sum(not c.fixed for c in clusters),
        "knocked_out": int((moved > KNOCKED_OUT).sum()),
        "times_real_time": round(seconds / SECONDS, 2),
        "slowest_frame_s": round(slowest, 2),
        "cut_s": round(cutting, 2),
        "step_s": spec.simulation.rigid["main"].settings.step,
        "mass_drift": float(abs(data["record/mass"] / start["record/mass"] - 1)),
        "fracture_energy_j": round(float(data["record/fracture_energy"]), 1),
        "impact_energy_j": round(float(start["record/kinetic_energy"]), 1),
    }


if __name__ == "__main__":
    print(json.dumps(run()))
