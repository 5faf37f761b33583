"""Sound liquid worlds in closed form, which the seeded defects of liquids start from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import Entity
from ..worlds import small_worlds as sw
from ..worlds.liquid_worlds import DENSITY, Flow, G, lattice, liquid_world, middle_column, pool_in_tank, water

__all__ = ["SPACING", "block", "crate_afloat", "draining", "falling", "pool", "sheet", "slosh"]

SPACING = 0.02
CRATE = 0.12
"""Edge of the floating crate [m]: six spacings, half of them under water."""


def pool(rng: np.random.Generator, *, frames: int = 18, **more: Any) -> Flow:
    """Still water in an open tank of random size."""
    size = tuple(SPACING * float(n) for n in rng.integers((14, 10, 6), (20, 14, 9)))
    return pool_in_tank(size=size, spacing=SPACING, **{"wall": float(rng.uniform(0.015, 0.04)), "frames": frames, **more})


def slosh(rng: np.random.Generator, *, amplitude: float = 0.004, frames: int = 18) -> Flow:
    """Water that sways slowly to and fro in a tank as one: the least mode of a shallow tank, each particle on its ellipse.

    Deep-water kinematics of a standing wave (Lamb, Hydrodynamics, art. 227): displacement along x a sinh, along z a cosh.
    """
    flow = pool(rng, frames=frames)
    base = flow.position[0]
    length = 2.0 * float(np.abs(base[:, 0]).max()) + SPACING
    depth = float(base[:, 2].max()) + 0.5 * SPACING
    k = np.pi / length
    omega = float(np.sqrt(G * k * np.tanh(k * depth)))
    x, z = base[:, 0] + 0.5 * length, base[:, 2]
    shape = np.stack([-np.cosh(k * z) * np.sin(k * x), 0 * x, np.sinh(k * z) * np.cos(k * x)], axis=1) / np.sinh(k * depth)
    times = np.arange(flow.frames) / flow.spec.simulation.fps
    position = [base + amplitude * np.cos(omega * t) * shape for t in times]
    velocity = [-amplitude * omega * np.sin(omega * t) * shape for t in times]
    return flow.edited(position=position, velocity=velocity)


def crate_afloat(
    rng: np.random.Generator, *, frames: int = 18, sinking: float = 0.0, density: float = 500.0, depth: float = 0.2
) -> Flow:
    """A crate at its draft in a tank, coupled both ways; it sinks at `sinking` g where the water gives it that much less."""
    crate = sw.box(CRATE, CRATE, CRATE, motion="dynamic", at=(0, 0, 0)).model_copy(update={"material": "cork"})
    draft = density / DENSITY * CRATE
    fall = 0.5 * sinking * G * (np.arange(frames) / 24.0) ** 2
    place = crate.model_copy(update={"pose": sw.pose((0.0, 0.0, depth - draft + CRATE / 2))})
    from ...worlds.spec import Material

    flow = pool_in_tank(
        size=(0.4, 0.32, depth),
        spacing=SPACING,
        wall=float(rng.uniform(0.02, 0.04)),
        frames=frames,
        others={"crate": place},
        two_way=True,
        below=0.1,
    )
    spec = flow.spec.model_copy(update={"materials": {**flow.spec.materials, "cork": Material(density=density)}})
    points = flow.position[0]
    # The crate takes the place of water; what it sinks into is left where it is.
    low = depth - draft
    inside = (np.abs(points[:, :2]) < CRATE / 2).all(axis=1) & (points[:, 2] > low)
    keep = points[~inside]
    track = np.stack([np.zeros(frames), np.zeros(frames), place.pose.position[2] - fall], axis=1)
    rise = np.stack([np.zeros(frames), np.zeros(frames), -sinking * G * np.arange(frames) / 24.0], axis=1)[:, None]
    weight = density * CRATE**3 * G / 24.0
    push = np.zeros((frames, 6))
    push[1:, 2] = (1.0 - sinking) * weight
    row = flow.colliders.index("crate/body")
    channels = {"velocity": rise, "exchange/impulse": push[:, None]}
    return flow.edited(
        spec=spec, position=[keep.copy() for _ in range(frames)], velocity=[np.zeros_like(keep) for _ in range(frames)],
        identity=[np.arange(len(keep))] * frames, share={row: push}, tracks={"crate": (track, sw.IDENTITY)}, rigid=channels,
    )  # fmt: skip


def falling(rng: np.random.Generator, *, frames: int = 12) -> Flow:
    """A block of water in free fall above the ground, which it does not reach."""
    size = tuple(SPACING * float(n) for n in rng.integers(4, 8, 3))
    return block(size, (0.0, 0.0, float(rng.uniform(2.0, 2.4))), frames=frames)


def block(size: Sequence[float], at: Sequence[float], *, frames: int = 12, beside: Mapping[str, Entity] | None = None) -> Flow:
    """A block of water in free fall, and more static bodies."""
    entities = {"ground": sw.ground(1.0), "pool": water(size, at, SPACING), **(beside or {})}
    spec = liquid_world(entities, spacing=SPACING, low=(-1, -1, -0.1), high=(1, 1, 3.2), frames=frames)
    start = lattice([a - s / 2 for a, s in zip(at, size, strict=True)], size, SPACING)
    times = np.arange(frames) / 24.0
    position = [start + np.array([0, 0, -0.5 * G * t * t]) for t in times]
    velocity: list[F64] = [np.tile([0.0, 0.0, -G * t], (len(start), 1)) for t in times]
    return Flow(spec, position, velocity, [np.arange(len(start))] * frames, float(np.prod(size)) / len(start), ("ground/body",))


def draining(rng: np.random.Generator, *, gap: float, wide: bool = False, frames: int = 24) -> Flow:
    """A pool over a slit of `gap` [m] in the tank's floor: layer by layer, water above it falls through, and on below.

    With `wide` the way is many spacings across, and what falls through is as it should be.
    """
    flow = pool(rng, frames=frames, gap=gap, below=0.6)
    points = flow.position[0]
    at = middle_column(2.0 * float(np.abs(points[:, 0]).max()) + SPACING, SPACING)
    reach = gap / 2 - 0.5 * SPACING if wide else 0.3 * SPACING
    falls = np.abs(points[:, 0] - at) <= reach + 1e-9
    order = np.argsort(points[falls, 2] + 0.01 * rng.random(int(falls.sum())))
    rows = np.flatnonzero(falls)[order]
    start = np.full(len(points), np.inf)
    # A column falls as one when nothing holds it; one drop after another through a slit.
    start[rows] = 2.0 / 24 if wide else np.linspace(2.0 / 24, 16.0 / 24, len(rows))
    position, velocity = [], []
    times = np.arange(frames) / 24.0
    for t in times:
        age = np.maximum(t - start, 0.0)
        age[~np.isfinite(age)] = 0.0
        p, v = points.copy(), np.zeros_like(points)
        p[:, 2] -= 0.5 * G * age**2
        v[:, 2] = -G * age
        position.append(p)
        velocity.append(v)
    return flow.edited(position=position, velocity=velocity).drained()


def sheet(points: F64, *, top: float, margin: float = 0.0) -> tuple[F64, Any]:
    """A closed box around particles, half a spacing outside of them, as 12 x 12 squares on each side."""
    import trimesh

    low, high = points.min(axis=0) - 0.5 * SPACING - margin, points.max(axis=0) + 0.5 * SPACING + margin
    high[2] += top
    made = trimesh.creation.box(bounds=[low, high])
    for _ in range(4):
        made = made.subdivide()
    return np.array(made.vertices), np.array(made.faces)
