"""Does the rule for the stiffness of grains help? Hits of drawn speed and size on a bed of grains, with the rule's modulus and the default.

The figure is the share of hits in which no two grains overlap by more than the check allows.
"""

from __future__ import annotations

import json
import random
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..simulation.boundaries import BodyState, Boundary
from ..simulation.particles.engine import Grains
from ..simulation.particles.packing import fill_box
from ..simulation.particles.setup import GrainSetup, Kind
from ..verifiers.categories.particles.bounds import OVERLAP
from ..worlds.arrays import F64
from ..worlds.built import TriangleMesh
from ..worlds.spec import ParticlePhysics

__all__ = ["by_default", "by_skill", "largest_overlap", "measure"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "particles"
BED = 6.0
"""[radii] Depth of the bed; it is twice as wide."""


def by_skill(speed: float, density: float, ball: float | None) -> float:
    """Modulus by the rule of the skill [Pa]."""
    rules = json.loads((SKILL / "softness.json").read_text())
    hit = rules["hit"] * density if ball is None else rules["struck"] * max(ball, density)
    return float(max(rules["least"], hit * speed**2))


def by_default(speed: float, density: float, ball: float | None) -> float:
    """Modulus as the specification has it when nobody chooses [Pa]."""
    return ParticlePhysics(radius=1.0).young_modulus


def floor(half: float, thick: float) -> Boundary:
    """A slab whose top is at z = 0."""
    corners = np.array([[x, y, z] for x in (-half, half) for y in (-half, half) for z in (-thick, 0.0)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], dtype=np.int32)
    return Boundary("floor/body", TriangleMesh(corners, faces), "static", True, 0.5)


def still(count: int) -> BodyState:
    """Bodies at rest at the origin."""
    zero = np.zeros((count, 3))
    turn = np.tile(np.eye(3), (count, 1, 1))
    return BodyState(zero, turn, zero.copy(), zero.copy(), zero.copy(), np.zeros(count), np.zeros((count, 3, 3)), zero.copy())


def _overlap(position: F64, radius: F64) -> float:
    from scipy.spatial import cKDTree

    pairs = cKDTree(position).query_pairs(2.0 * float(radius.max()), output_type="ndarray")
    depth = radius[pairs].sum(axis=1) - np.linalg.norm(position[pairs[:, 0]] - position[pairs[:, 1]], axis=1)
    return float((depth / radius[pairs].min(axis=1)).max(initial=0.0)) if len(pairs) else 0.0


def largest_overlap(case: dict[str, Any], speed: float, radius: float, density: float, young: float, seed: int) -> float:
    """Largest overlap among grains of a bed that is hit, in smaller radii."""
    reach = 2.0 * BED * radius
    bed, sizes = fill_box(
        np.array([-reach, -reach, radius]), np.array([reach, reach, BED * radius]), radius, share=0.55, spread=0.1, seed=seed
    )
    if case["ball"] is not None:
        top, more, kind = np.array([[0.0, 0.0, (BED + 5.2) * radius]]), np.array([4.0 * radius]), 1
    else:
        top, more = fill_box(
            np.array([-reach / 2, -reach / 2, (BED + 2.5) * radius]),
            np.array([reach / 2, reach / 2, (BED + 6.0) * radius]),
            radius,
            share=0.5,
            spread=0.1,
            seed=seed,
        )
        kind = 0
    kinds = tuple(Kind(n, d, young, 0.25, 0.3, 0.5, 0.1, 0.0) for n, d in (("bed", density), ("ball", case["ball"] or density)))
    n = len(sizes)
    setup = GrainSetup(
        lower=np.full(3, -4 * reach), upper=np.full(3, 4 * reach), kinds=kinds, position=np.concatenate([bed, top]),
        velocity=np.concatenate([np.zeros_like(bed), np.tile([0.0, 0.0, -speed], (len(top), 1))]), radius=np.concatenate([sizes, more]),
        kind=np.concatenate([np.zeros(n), np.full(len(more), kind)]).astype(np.int32), gravity=np.array([0.0, 0.0, -9.81]),
        boundaries=(floor(4 * reach, reach),), centers=(np.zeros(3),),
    )  # fmt: skip
    grains, worst = Grains(setup), 0.0
    seconds = 6.0 * BED * radius / speed
    for _ in range(30):
        grains.step(seconds / 30, still(1))
        c = grains.columns()
        own = c["kind"] == 0
        worst = max(worst, _overlap(c["position"][own], c["radius"][own]))
    return worst


def measure(seeds: Sequence[int]) -> dict[str, Any]:
    """Share of hits without too much overlap, with the rule and without."""
    cases = json.loads((SKILL / "evals" / "cases.json").read_text())
    arms = {"with": by_skill, "without": by_default}
    passed = dict.fromkeys(arms, 0)
    total = 0
    for seed in seeds:
        for name, case in cases.items():
            draw = random.Random(f"{name} {seed}")
            speed, radius, density = (draw.uniform(*case[k]) for k in ("speed", "radius", "density"))
            total += 1
            for arm, modulus in arms.items():
                passed[arm] += (
                    largest_overlap(case, speed, radius, density, modulus(speed, density, case["ball"]), seed) <= OVERLAP
                )
    return {arm: {"cases": total, "passed": n} for arm, n in passed.items()}
