"""A brick wall, a beam and a ball that hits them: short specifications for tests of bodies that break."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from worldagent.construction import build_entity
from worldagent.simulation.rigid import SolverRigid
from worldagent.simulation.schedule import run_frames
from worldagent.tests.physics import rigid_world
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.spec import WorldSpec

__all__ = ["STONE", "bond", "bricks", "cantilever", "simulate", "solver_of", "struck_wall"]

BRICK = (0.24, 0.11, 0.07)
STONE = {"brick": {"density": 1800.0, "friction": 0.6}, "iron": {"density": 7200.0, "friction": 0.4}}


def bond(tension: float = 3e5, **more: Any) -> dict[str, Any]:
    return {"tension": tension, "shear": 1.5 * tension, **more}


def bricks(size: tuple[float, float, float] = BRICK, joint: float = 0.01, **more: Any) -> dict[str, Any]:
    return {"kind": "bricks", "size": size, "joint": joint, **more}


def cantilever(tension: float, pieces: int = 5, length: float = 1.0, section: tuple[float, float] = (0.1, 0.2)) -> WorldSpec:
    """A beam of `pieces` blocks that is bonded to the world at x-, over an empty floor."""
    pattern = bricks((length / pieces, section[0], section[1]), joint=0.0)
    broken = {"pattern": pattern, "bond": bond(tension, shear=1e8), "fixed": ["x-"]}
    beam = rigid_world.box(length, *section, at=(0, 0, 2.0), material="brick", breakable=broken)
    return rigid_world.world({"floor": rigid_world.floor(), "beam": beam}, seconds=0.2, materials=STONE)


def struck_wall(
    speed: float, *, tension: float = 3e5, seconds: float = 0.25, size: tuple[float, float] = (0.75, 0.4), **settings: Any
) -> WorldSpec:
    """A small wall on a floor, bonded at its foot, and an iron ball that flies at its middle."""
    broken = {"pattern": bricks(), "bond": bond(tension), "fixed": ["z-"]}
    wall = rigid_world.box(size[0], 0.12, size[1], at=(0, 0, size[1] / 2 + 1e-3), material="brick", breakable=broken)
    ball = rigid_world.ball(0.05, at=(0.01, -0.3, 0.6 * size[1]), v=(0, speed, 0), material="iron")
    entities = {"floor": rigid_world.floor(), "wall": wall, "ball": ball}
    return rigid_world.world(entities, seconds=seconds, materials=STONE, settings={"refine": 1, **settings})


def solver_of(spec: WorldSpec) -> SolverRigid:
    built = {n: build_entity(spec, n, rigid_world.NO_ASSETS) for n in spec.entities}
    solver = SolverRigid(spec, built, "main")
    solver.prepare()
    return solver


def simulate(folder: Path, spec: WorldSpec) -> Candidate:
    """The specification's motion in `folder/run`, ready for the checks."""
    built = {n: build_entity(spec, n, rigid_world.NO_ASSETS) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return Candidate(folder, spec, built, "full", caches, "run", cache_digest(caches))
