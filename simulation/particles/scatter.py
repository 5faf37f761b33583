"""Flying particles at frame 0 and out of emitters: places, velocities, sizes and lives, drawn from the seed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ...geometry.solids import Solid
from ...worlds.arrays import F64, pose_of, rotation_matrix
from ...worlds.errors import InputError
from .solids import Placed

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.spec import EmitterDriver, ParticlePhysics, WorldSpec

__all__ = ["emitted", "scattered"]

TRIES = 60


def _sizes(physics: ParticlePhysics, rng: np.random.Generator, n: int) -> tuple[F64, F64]:
    """Radii [m] and lives [s]."""
    radius = physics.radius * (1.0 + physics.radius_spread * rng.uniform(-1.0, 1.0, n))
    life = np.full(n, math.inf)
    if physics.life is not None:
        life = physics.life * (1.0 + physics.life_spread * rng.uniform(-1.0, 1.0, n))
    return radius, life


def scattered(spec: WorldSpec, built: BuiltEntity, member: str, row: int) -> dict[str, Any]:
    """The declared number of particles at random places in a member's volume, at rest.

    Raises:
        InputError: the volume is so thin that none is found in it.
    """
    entity = spec.entities[member]
    physics: ParticlePhysics = entity.physics  # type: ignore[assignment]
    rng = np.random.default_rng([spec.simulation.seed, 31, row])
    parts = [Placed(Solid.from_mesh(p.render, closed=True), pose_of(entity.pose)) for p in built.parts]
    found: list[F64] = [np.zeros((0, 3))]
    if physics.count:
        low = np.min([p.box[0] for p in parts], axis=0)
        high = np.max([p.box[1] for p in parts], axis=0)
        for _ in range(TRIES):
            points = rng.uniform(low, high, (2 * physics.count, 3))
            within = np.zeros(len(points), dtype=bool)
            for part in parts:
                within |= part.depth(points, 1e-6) >= 0
            found.append(points[within])
            if sum(map(len, found)) >= physics.count:
                break
        else:
            raise InputError(
                f"no room for {physics.count} particles was found in the volume of {member!r}; make its parts larger"
            )
    position = np.concatenate(found)[: physics.count]
    radius, life = _sizes(physics, rng, len(position))
    return {
        "position": position, "velocity": np.zeros_like(position), "radius": radius, "life": life,
        "kind": np.full(len(position), row, dtype=np.int32),
    }  # fmt: skip


def emitted(
    spec: WorldSpec, driver: EmitterDriver, number: int, before: int, start: float, end: float, members: tuple[str, ...]
) -> tuple[dict[str, Any], F64, int]:
    """Particles that an emitter lets out during [start, end), their times of birth [s], and how many it let out so far."""
    last = end if driver.end is None else min(end, driver.end)
    total = max(before, math.floor(driver.rate * max(0.0, last - driver.start) + 1e-9))
    if start < 0 or total <= before:
        return {}, np.zeros(0), before
    physics: ParticlePhysics = spec.entities[driver.entity].physics  # type: ignore[assignment]
    n = total - before
    rng = np.random.default_rng([spec.simulation.seed, 37, number, before])
    born = np.clip(driver.start + (np.arange(before, total) + 1.0) / driver.rate, start, end)
    pose = pose_of(driver.pose)
    turn = rotation_matrix(pose.quaternion)
    angle, share = 2 * np.pi * rng.random(n), np.sqrt(rng.random(n))
    disc = np.stack(
        [0.5 * driver.size[0] * share * np.cos(angle), 0.5 * driver.size[1] * share * np.sin(angle), np.zeros(n)], axis=1
    )
    height, about = 1.0 - rng.random(n) * (1.0 - math.cos(driver.cone)), 2 * np.pi * rng.random(n)
    ring = np.sqrt(np.maximum(0.0, 1.0 - height**2))
    way = np.stack([ring * np.cos(about), ring * np.sin(about), height], axis=1)
    speed = driver.speed * (1.0 + driver.speed_spread * rng.uniform(-1.0, 1.0, n))
    radius, life = _sizes(physics, rng, n)
    made = {
        "position": pose.position + disc @ turn.T, "velocity": (speed[:, None] * way) @ turn.T, "radius": radius, "life": life,
        "kind": np.full(n, members.index(driver.entity), dtype=np.int32),
    }  # fmt: skip
    return made, born, total
