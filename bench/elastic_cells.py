"""Cells of an elastic cantilever against beam theory and processor time, and what contacts cost: `python -m worldagent.bench.elastic_cells`.

A beam ten times longer than high (Poisson's ratio 0.3) sags under its weight; its tip is averaged over two periods and held against
rho g A L^4 / (8 E I). A block of two cells each way lies on a floor. Progress on stderr, one JSON object as the last line of stdout.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..construction.build import build_entity
from ..simulation.rigid import SolverRigid
from ..testing.worlds.small_worlds import box, ground, world
from ..worlds.spec import ElasticPhysics, Entity, Material, Pin, RigidSettings

__all__ = ["run"]

LONG, HIGH, YOUNG, DENSITY, STEP = 1.0, 0.1, 5e7, 1000.0, 1e-3
"""[m], [m], [Pa], [kg/m^3], [s]"""
SAG = DENSITY * 9.81 * HIGH**2 * LONG**4 / (8 * YOUNG * HIGH**4 / 12)
"""By Euler and Bernoulli [m]."""
FPS, FRAMES = 87, 49
"""Two periods of 0.277 s."""
EDGES = (LONG / 4, LONG / 8, HIGH, HIGH / 2)
"""`resolution` [m]: cells along the beam, then the default, then two across."""


def _solver(things: dict[str, Entity], frames: int, fps: int) -> tuple[SolverRigid, dict[str, Any]]:
    matter = {"wood": Material(density=DENSITY, friction=0.6)}
    spec = world(things, frames=frames, fps=fps, materials=matter, settings=RigidSettings(step=STEP, skin=5e-4))
    built = {n: build_entity(spec, n, Path()) for n in things}
    solver = SolverRigid(spec, built, "rigid")
    solver.prepare()
    return solver, built


def _beam(edge: float) -> dict[str, Any]:
    pins = {"wall": Pin(center=(-LONG / 2, 0, 0), size=(1e-3, 1, 1))}
    soft = ElasticPhysics(young_modulus=YOUNG, poisson_ratio=0.3, damping=5e-4, resolution=edge, pins=pins)
    solver, built = _solver({"beam": box(LONG, HIGH, HIGH, motion="dynamic", at=(0, 0, 1), physics=soft)}, FRAMES, FPS)
    mesh = built["beam"].parts[0].simulation
    tip, sags, begun = mesh.vertices[:, 0] > LONG / 2 - 1e-9, [], time.process_time()
    for frame in range(1, FRAMES):
        solver.advance(frame)
        sags.append(1.0 - float(solver.frame_data()["vertex/position"][tip, 2].mean()))
    seconds = time.process_time() - begun
    steps = (FRAMES - 1) / FPS / STEP
    return {
        "cells": " x ".join(str(int(c)) for c in mesh.cells), "of_beam_theory": round(float(np.mean(sags)) / SAG, 3),
        "degrees_of_freedom": int(solver.model.nv), "cpu_ms_per_step": round(1e3 * seconds / steps, 1),
    }  # fmt: skip


def _block() -> dict[str, Any]:
    """Lying on a floor, with as many contacts as its lower side has."""
    soft = ElasticPhysics(young_modulus=5e4, poisson_ratio=0.4, damping=0.004)
    block = box(HIGH, HIGH, HIGH, motion="dynamic", at=(0, 0, HIGH / 2 + 1e-3), physics=soft)
    solver, _ = _solver({"floor": ground(), "block": block}, 25, 50)
    for frame in range(1, 13):
        solver.advance(frame)
    contacts, begun = [], time.process_time()
    for frame in range(13, 25):
        solver.advance(frame)
        contacts.append(int(solver.data.ncon))
    seconds = time.process_time() - begun
    return {
        "contacts": int(np.median(contacts)), "degrees_of_freedom": int(solver.model.nv),
        "cpu_ms_per_step": round(1e3 * seconds / (12 / 50 / STEP), 1),
    }  # fmt: skip


def run() -> dict[str, Any]:
    """Figures of every beam, and of the block."""
    beams = []
    for edge in EDGES:
        beams.append(_beam(edge))
        print(beams[-1], file=sys.stderr)
    return {"beams": beams, "lying": _block()}


if __name__ == "__main__":
    told = {"name": "elastic-cells", **run()}
    print(json.dumps(told))
