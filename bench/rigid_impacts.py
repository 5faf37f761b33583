"""Benchmark `rigid-impacts`: 200 random piles, chains and cradles, restitution from 0 to 1, and the energy that any of them gains.

All are closed: gravity, a floor, no driver. A pile is of balls, boxes and rods that fall on each other; a chain of balls or boxes in a row,
touching or not, into which some run; a cradle of balls on hinged rods, some of which are let go. Nothing in them is tuned.
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
from ..worlds.arrays import F64
from ..worlds.spec import HingeJoint, RigidPhysics, WorldSpec

__all__ = ["KINDS", "SCENES", "gained", "random_scene", "run"]

SCENES = 200
KINDS = ("pile", "chain", "cradle")
SECONDS, FPS = 1.0, 120
GRAVITY = 9.81
NOTABLE = 1e-3
"""Share of the energy from which on a gain is listed."""
SKINS = 1e-3
"""Two default skins [m]: nearer bodies touch."""


def _entity(shape: dict[str, Any], at: Any, *, motion: str = "dynamic", **physics: Any) -> dict[str, Any]:
    """An entity of one part of the one material."""
    pose = {"position": tuple(map(float, at)), "euler": physics.pop("euler", None)}
    return {
        "role": "test object",
        "motion": motion,
        "material": "m",
        "dimensions": {"size": (1, 1, 1)},
        "physics": {"category": "rigid", **physics},
        "pose": pose,
        "parts": {"p": {"shape": shape}},
    }


def _shape(random: np.random.Generator, size: float) -> dict[str, Any]:
    """A ball, a box or a rod within a ball of radius `size` [m]."""
    kind = int(random.integers(3))
    if kind == 0:
        return {"kind": "sphere", "radius": size}
    if kind == 1:
        return {"kind": "box", "size": tuple((size * random.uniform(0.5, 1.1, 3)).tolist())}
    radius = size * float(random.uniform(0.2, 0.4))
    return {"kind": "capsule", "radius": radius, "length": 2.0 * (size - radius)}


def _pile(random: np.random.Generator) -> dict[str, Any]:
    """Three to twelve bodies that fall on each other, turning."""
    made: dict[str, Any] = {}
    for k in range(int(random.integers(3, 13))):
        size = float(random.uniform(0.04, 0.12))
        at = (*random.uniform(-0.12, 0.12, 2), 0.15 + 0.25 * k)
        made[f"b{k}"] = _entity(
            _shape(random, size),
            at,
            euler=tuple(random.uniform(-3, 3, 3).tolist()),
            linear_velocity=tuple(random.uniform(-1, 1, 3).tolist()),
            angular_velocity=tuple(random.uniform(-8, 8, 3).tolist()),
        )
    return made


def _chain(random: np.random.Generator) -> dict[str, Any]:
    """Three to eight balls or boxes in a row on the floor, touching or with gaps, into which the first run."""
    made: dict[str, Any] = {}
    count = int(random.integers(3, 9))
    let = int(random.integers(1, count))
    gaps = SKINS * np.where(random.random(count) < 0.5, 1.0, random.uniform(1.0, 4.0, count))
    speed, boxes, size = float(random.uniform(0.3, 4.0)), bool(random.random() < 0.4), float(random.uniform(0.02, 0.08))
    x = 0.0
    for k in range(count):
        x += 2 * size + float(gaps[k]) + (size if k == let else 0.0)
        shape = {"kind": "box", "size": (2 * size,) * 3} if boxes else {"kind": "sphere", "radius": size}
        mass = float(random.uniform(0.5, 2.0)) if random.random() < 0.5 else 1.0
        made[f"b{k}"] = _entity(shape, (x, 0, size + SKINS), mass=mass, linear_velocity=(speed if k < let else 0.0, 0, 0))
    return made


def _cradle(random: np.random.Generator) -> tuple[dict[str, Any], dict[str, Any]]:
    """Three to six balls on hinged rods, touching or not, some of which swing into the rest."""
    made: dict[str, Any] = {}
    joints: dict[str, Any] = {}
    count = int(random.integers(3, 7))
    let, radius, length = int(random.integers(1, count)), float(random.uniform(0.02, 0.05)), float(random.uniform(0.2, 0.5))
    pitch = 2 * radius + SKINS * float(random.choice([1.0, 1.0, 1.2, 3.0]))
    angle, top = float(random.uniform(0.3, 1.2)), 1.0
    for k in range(count):
        turned = angle if k < let else 0.0
        at = (pitch * k - length * np.sin(turned), 0.0, top - length * np.cos(turned))
        made[f"b{k}"] = _entity({"kind": "sphere", "radius": radius}, at, mass=0.5)
        joints[f"j{k}"] = {"kind": "hinge", "child": f"b{k}", "anchor": (pitch * k, 0.0, top), "axis": (0, 1, 0)}
    return made, joints


def random_scene(seed: int) -> WorldSpec:
    """One scene; its kind follows from the seed."""
    random = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    joints: dict[str, Any] = {}
    if kind == "cradle":
        made, joints = _cradle(random)
    else:
        made = _pile(random) if kind == "pile" else _chain(random)
    floor = _entity({"kind": "box", "size": (20, 20, 1)}, (0, 0, -0.5), motion="static")
    restitution = float(random.choice([0.0, 1.0, random.uniform(0, 1), random.uniform(0, 1)]))
    friction = float(random.choice([0.0, random.uniform(0.0, 1.0), random.uniform(0.0, 1.0)]))
    entities = {"floor": floor, **made}
    return WorldSpec.model_validate(
        {
            "title": kind,
            "prompt": kind,
            "materials": {"m": {"density": 1000.0, "friction": friction, "restitution": restitution}},
            "entities": entities,
            "simulation": {
                "fps": FPS,
                "frames": round(SECONDS * FPS) + 1,
                "joints": joints,
                "solvers": {"main": {"engine": "mujoco", "members": list(entities)}},
            },
        }
    )


def _lowest(spec: WorldSpec) -> float:
    """Least potential energy of what hangs on hinges [J]; infinite where nothing does."""
    total = 0.0
    hinges = [j for j in spec.simulation.joints.values() if isinstance(j, HingeJoint)]
    for hinge in hinges:
        entity = spec.entities[hinge.child]
        mass = entity.physics.mass if isinstance(entity.physics, RigidPhysics) else None
        arm = np.subtract(entity.pose.position, hinge.anchor)
        total += (mass or 0.0) * GRAVITY * (hinge.anchor[2] - float(np.linalg.norm(arm)))
    return total if hinges else float("inf")


def gained(spec: WorldSpec) -> tuple[float, float, float]:
    """Largest rise of the energy of a scene over the first, over what it was at any time before, and what is left; in parts of the first.

    Heights count from where all lies lowest. Velocities are half a step behind positions, so that gravity's work of half a step is put back.
    """
    solver = SolverRigid(spec, {n: build_entity(spec, n, Path()) for n in spec.entities}, "main")
    solver.prepare()
    energies, lowest = [], _lowest(spec)
    for frame in range(spec.simulation.frames):
        if frame:
            solver.advance(frame)
        data = solver.frame_data()
        lag = 0.5 * float(data["record/step"]) * GRAVITY * float(data["record/momentum_z"]) if frame else 0.0
        lowest = min(lowest, float(data["record/potential_energy"]))
        energies.append(float(data["record/kinetic_energy"]) + float(data["record/potential_energy"]) - lag)
    energy: F64 = np.array(energies) - lowest
    before = float((energy - np.minimum.accumulate(energy)).max())
    return float(energy.max() / energy[0]) - 1.0, before / float(energy[0]), float(energy[-1] / energy[0])


def run(count: int = SCENES) -> dict[str, Any]:
    """Measure; progress goes to stderr."""
    found, begin = [], time.process_time()
    for seed in range(count):
        first, before, left = gained(random_scene(seed))
        found.append((first, before, seed))
        if before > NOTABLE:
            print(f"{KINDS[seed % len(KINDS)]} {seed}: gains {before:.3g}, keeps {left:.3g}", file=sys.stderr)
    per_kind = {kind: [f for f in found if KINDS[f[2] % len(KINDS)] == kind] for kind in KINDS}
    return {
        "name": "rigid-impacts",
        "scenes": count,
        "largest_gain_over_first": max(f[0] for f in found),
        "largest_gain_over_any_before": max(f[1] for f in found),
        "worst": {
            k: {"over_first": max(own)[0], "over_any_before": max(f[1] for f in own)} for k, own in per_kind.items() if own
        },
        "over_1e-3_of_any_before": [f[2] for f in found if f[1] > NOTABLE],
        "cpu_s": round(time.process_time() - begin, 1),
    }


if __name__ == "__main__":
    print(json.dumps(run()))
