"""Do the pairs of `materials` help? Blocks that slide over a plate of another material, with friction of the pair and with that of the names alone.

The figure is the share of blocks that stop where the friction of the source says, `v^2 / (2 mu g)`, within a tenth.
"""

from __future__ import annotations

import json
import random
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..construction.build import build_entity
from ..simulation.rigid import SolverRigid
from ..testing.worlds.small_worlds import box, world
from ..worlds.materials import friction_between, row_named
from ..worlds.spec import ContactPair, Material, RigidPhysics

__all__ = ["measure", "way"]

SKILL = Path(__file__).resolve().parent.parent / "skills" / "materials"
G, FPS, SIZE, GAP = 9.81, 24, 0.1, 1e-3
FRAMES = 200
STILL = 1e-5
"""[m] A block that came no further in a frame has stopped."""
BLOCK = 0
"""Its row among the bodies that move."""
NEAR = 0.1
"""[1] Own choice: share by which the way may be off."""


def _material(name: str) -> Material:
    found = row_named(name)
    if found is None:
        raise ValueError(f"the table of materials has no {name!r}")
    figures = {q: found[1].figures[q].range[1] for q in ("density", "friction") if q in found[1].figures}
    return Material.model_validate({"of": name, "substance": found[1].substance, **figures})


def way(block: str, plate: str, speed: float, friction: float | None) -> float:
    """Level way [m] that a block slides from a speed [m/s]; friction is that of the pair, or None for what the two materials give."""
    contacts = {} if friction is None else {"pair": ContactPair(a="block", b="plate", friction=friction)}
    spec = world(
        {
            "plate": box(200, 2, 0.2, at=(0, 0, -0.1), material=plate),
            "block": box(
                SIZE, SIZE, SIZE / 2, at=(0, 0, SIZE / 4 + GAP), motion="dynamic", material=block,
                physics=RigidPhysics(linear_velocity=(speed, 0.0, 0.0)),
            ),
        },
        materials={name: _material(name) for name in (block, plate)},
    )  # fmt: skip
    plan = spec.simulation.model_copy(update={"contacts": contacts})
    spec = spec.model_copy(update={"simulation": plan})
    solver = SolverRigid(spec, {n: build_entity(spec, n, Path()) for n in spec.entities}, "rigid")
    solver.prepare()
    before = 0.0
    for frame in range(1, FRAMES):
        solver.advance(frame)
        now = float(solver.frame_data()["position"][BLOCK][0])
        if now - before < STILL:
            break
        before = now
    return now


def measure(seeds: Sequence[int]) -> dict[str, Any]:
    """Blocks, and how many stop where the source says per arm."""
    pairs = json.loads((SKILL / "pairs.json").read_text())
    (case,) = json.loads((SKILL / "evals" / "cases.json").read_text()).values()
    drawn, right = 0, {"with": 0, "without": 0}
    for seed in seeds:
        for names, friction in pairs.items():
            block, plate = names.split()
            speed = random.Random(f"{names} {seed}").uniform(*case["speed"])
            sourced = friction_between(block, plate)
            wanted = speed**2 / (2 * G * (friction if sourced is None else sourced.range[1]))
            drawn += 1
            for arm, own in (("with", friction), ("without", None)):
                went = way(block, plate, speed, own)
                right[arm] += abs(went - wanted) <= NEAR * wanted
                print(f"{names} {seed} {arm}: {went:.3f} m of {wanted:.3f} m", file=sys.stderr)
    return {"blocks": drawn, **{f"right_{arm}": n for arm, n in right.items()}}
