"""Small liquid worlds with caches written by hand, for tests and seeded defects: particles on lattices in closed-form motion.

Channels are those of `worlds/cache.py`. Nothing here comes from a solver: what boundaries gave is worked out from the motion
(change of momentum less gravity), so that a sound world is sound by construction.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..worlds.arrays import F64
from ..worlds.cache import Cache, CacheIndex, write_container
from ..worlds.candidate import Candidate
from ..worlds.spec import (
    Box,
    Coupling,
    DfsphInstance,
    DfsphSettings,
    Entity,
    FlipInstance,
    FlipSettings,
    LiquidDomain,
    LiquidPhysics,
    Material,
    RigidInstance,
    SimulationPlan,
    WorldSpec,
)
from . import small_worlds as sw

__all__ = ["DENSITY", "Flow", "G", "lattice", "liquid_world", "pool_in_tank", "tank", "water"]

G = 9.81
DENSITY = 1000.0
MATERIALS = {**sw.MATERIALS, "water": Material(density=DENSITY, substance="water")}


def lattice(low: Sequence[float], size: Sequence[float], spacing: float) -> F64:
    """Middles of cubes that fill a box, shape (n, 3)."""
    counts = [max(1, round(s / spacing)) for s in size]
    axes = [a + (np.arange(n) + 0.5) * s / n for a, s, n in zip(low, size, counts, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def water(size: Sequence[float], at: Sequence[float], spacing: float, **physics: Any) -> Entity:
    """A box of water."""
    made = sw.box(*size, motion="dynamic", at=at)
    return made.model_copy(update={"physics": LiquidPhysics(resolution=spacing, **physics), "material": "water"})


def tank(
    inner: Sequence[float], wall: float, at: Sequence[float] = (0.0, 0.0, 0.0), *, gap: float = 0.0, gap_at: float = 0.0
) -> Entity:
    """An open tank of five boxes whose floor's top is z = 0 of its frame; `gap` [m] splits the floor along y at x = `gap_at`."""
    x, y, z = inner
    boxes = [
        ((wall, y + 2 * wall, z), ((x + wall) / 2, 0, z / 2)),
        ((wall, y + 2 * wall, z), (-(x + wall) / 2, 0, z / 2)),
        ((x, wall, z), (0, (y + wall) / 2, z / 2)),
        ((x, wall, z), (0, -(y + wall) / 2, z / 2)),
    ]
    left, right = -(x / 2 + wall), x / 2 + wall
    cuts = [(left, right)] if gap == 0.0 else [(left, gap_at - gap / 2), (gap_at + gap / 2, right)]
    boxes += [((b - a, y + 2 * wall, wall), ((a + b) / 2, 0, -wall / 2)) for a, b in cuts]
    from ..worlds.spec import Part

    return sw.entity(
        *(Part(shape=Box(size=s), pose=sw.pose(p)) for s, p in boxes), at=at, size=(x + 2 * wall, y + 2 * wall, z + wall)
    )


@dataclass
class Flow:
    """Particles at every frame, and how they are shared out: what a cache of a liquid instance is written from."""

    spec: WorldSpec
    position: list[F64]
    velocity: list[F64]
    identity: list[Any]
    volume: float
    """Of each particle [m^3]."""
    colliders: tuple[str, ...] = ()
    holder: int = 0
    """Row of the boundary that gave what gravity did not."""
    share: dict[int, F64] = field(default_factory=dict)
    """Row -> impulse given to that boundary over every frame (frames, 6); the holder has the rest."""
    inflow: dict[str, F64] = field(default_factory=dict)
    """Driver -> mass let in since frame 0 (frames,)."""
    outflow: dict[str, F64] = field(default_factory=dict)
    left: F64 | None = None
    """Mass that left through open sides since frame 0 (frames,)."""
    tracks: dict[str, Any] = field(default_factory=dict)
    rigid: dict[str, Any] = field(default_factory=dict)
    """Further channels of the rigid cache."""
    change: dict[tuple[int, str], Any] = field(default_factory=dict)
    """(frame, channel) -> value written instead."""
    surface: Any = None
    """Called with (frame, position) -> vertices, faces."""

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(self.position)

    def edited(self, **more: Any) -> Flow:
        """A copy with other fields."""
        copy = {"position": [p.copy() for p in self.position], "velocity": [v.copy() for v in self.velocity],
                "identity": [np.array(i) for i in self.identity], "change": dict(self.change), "share": dict(self.share)}  # fmt: skip
        return dataclasses.replace(self, **(copy | more))

    def impulses(self) -> F64:
        """Given to every boundary over each frame (frames, b, 6): the holder gets what the change of momentum less gravity leaves."""
        given = np.zeros((self.frames, len(self.colliders), 6))
        for row, value in self.share.items():
            given[:, row] = value
        if not self.colliders:
            return given
        mass, h = self.volume * DENSITY, 1.0 / self.spec.simulation.fps
        gravity = np.array(self.spec.simulation.gravity)
        for k in range(1, self.frames):
            _, here, there = np.intersect1d(self.identity[k], self.identity[k - 1], assume_unique=True, return_indices=True)
            both = mass * (self.velocity[k][here] - self.velocity[k - 1][there]).sum(axis=0)
            rest = both - mass * len(here) * h * gravity
            others = given[k, np.arange(len(self.colliders)) != self.holder, :3].sum(axis=0)
            given[k, self.holder, :3] = -rest - others
        return given

    def candidate(self, folder: Path) -> Candidate:
        """Write both caches and open them."""
        base = sw.make_candidate(folder, self.spec, tracks=self.tracks, channels=self.rigid)
        name = next(iter(self.spec.simulation.liquid))
        plan, instance = self.spec.simulation, self.spec.simulation.liquid[name]
        cache = Cache(folder / "cache" / name)
        drivers = (*self.inflow, *self.outflow)
        index = CacheIndex(
            name, instance.engine, plan.fps, self.frames, tuple(instance.members), self.colliders, (), drivers, "test", {}
        )
        cache.folder.mkdir(parents=True, exist_ok=True)
        cache.write_index(index)
        given, digests = self.impulses(), []
        for k in range(self.frames):
            held = self._frame(k, given[k])
            held |= {c: v for (f, c), v in self.change.items() if f == k}
            digests.append(write_container(cache.path(k), held))
        cache.begin_digests(digests)
        if self.surface is not None:
            self._surfaces(cache, digests)
        return dataclasses.replace(base, caches={**base.caches, name: cache})

    def _frame(self, k: int, given: F64) -> dict[str, Any]:
        p, v, n = self.position[k], self.velocity[k], len(self.position[k])
        mass, gravity = self.volume * DENSITY, np.array(self.spec.simulation.gravity)
        origin = np.array([0.25, -0.5, 0.0])
        came = [float(m[k]) for m in self.inflow.values()]
        went = [float(m[k]) for m in self.outflow.values()]
        left = 0.0 if self.left is None else float(self.left[k])
        h, step = 1.0 / self.spec.simulation.fps, 1.0 / self.spec.simulation.fps / 12
        records = {
            "mass": mass * n, "volume": self.volume * n, "particles": n, "kinetic_energy": 0.5 * mass * float((v**2).sum()),
            "potential_energy": -mass * float((p @ gravity).sum()), "max_speed": float(np.linalg.norm(v, axis=1).max(initial=0.0)),
            "density_error_mean": 1e-4, "density_error_max": 1e-3, "iterations_pressure": 8, "iterations_divergence": 3,
            "iterations_capped": 0, "steps": 12 if k else 0, "step": step if k else h / 12, "lost": 0, "inflow_mass": sum(came), "outflow_mass": sum(went),
            "domain_outflow": left, **{f"momentum_{a}": mass * float(v[:, i].sum()) for i, a in enumerate("xyz")},
        }  # fmt: skip
        return {
            "origin": origin,
            "particle/position": (p - origin).astype(np.float32),
            "particle/velocity": v.astype(np.float32),
            "particle/id": np.asarray(self.identity[k], dtype=np.int32),
            "particle/fluid": np.zeros(n, dtype=np.int32),
            "particle/volume": np.full(n, self.volume, dtype=np.float32),
            "particle/density": np.full(n, DENSITY, dtype=np.float32),
            "particle/pressure": np.zeros(n, dtype=np.float32),
            "exchange/impulse": given.copy(),
            "exchange/reaction": -given,
            "inflow/mass": np.array(came),
            "outflow/mass": np.array(went),
            **{f"record/{q}": np.array(float(x)) for q, x in records.items()},
        }

    def _surfaces(self, cache: Cache, digests: Sequence[str]) -> None:
        from ..worlds.liquid_surface import surface_folder

        files = Cache(surface_folder(cache))
        files.folder.mkdir(parents=True, exist_ok=True)
        (files.folder / "surface.json").write_text('{"spacing": 0.02}')
        found = []
        for k in range(self.frames):
            vertices, faces = self.surface(k, self.position[k])
            corner = vertices[faces]
            a, b, c = corner[:, 0], corner[:, 1], corner[:, 2]
            origin = np.array([0.25, -0.5, 0.0])
            found.append(
                write_container(
                    files.path(k),
                    {
                        "origin": origin, "source": np.frombuffer(bytes.fromhex(digests[k]), dtype=np.uint8),
                        "surface/vertices": (vertices - origin).astype(np.float32), "surface/faces": faces.astype(np.int32),
                        "surface/fluid": np.zeros(len(faces), dtype=np.int32), "surface/velocity": np.zeros((len(vertices), 3), dtype=np.float32),
                        "spray/position": np.zeros((0, 3), dtype=np.float32), "spray/volume": np.zeros(0, dtype=np.float32),
                        "record/surface_volume": np.array(float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)),
                        "record/surface_area": np.array(float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)),
                        "record/surface_components": np.array(1.0), "record/spray_volume": np.array(0.0),
                    },
                )
            )  # fmt: skip
        files.begin_digests(found)


def liquid_world(
    entities: Mapping[str, Entity],
    *,
    spacing: float,
    low: Sequence[float],
    high: Sequence[float],
    sides: Sequence[str] = ("open",) * 6,
    frames: int = 24,
    fps: int = 24,
    engine: str = "dfsph",
    drivers: Mapping[str, Any] | None = None,
    gravity: Sequence[float] = (0.0, 0.0, -G),
    two_way: bool = False,
    **more: Any,
) -> WorldSpec:
    """A specification with a liquid instance `water` that moves the liquids, and a rigid one `rigid` that has all else."""
    domain = LiquidDomain(
        center=tuple((np.array(low) + np.array(high)) / 2), size=tuple(np.array(high) - np.array(low)), sides=tuple(sides)
    )
    liquids = [n for n, e in entities.items() if e.physics.category == "liquid"]
    solids = [n for n in entities if n not in liquids]
    fluid: Any = DfsphInstance(members=liquids, settings=DfsphSettings(domain=domain))
    if engine == "flip":
        fluid = FlipInstance(members=liquids, settings=FlipSettings(domain=domain))
    solvers = {**({"rigid": RigidInstance(engine="mujoco", members=solids)} if solids else {}), "water": fluid}
    couplings = (
        {"c": Coupling(source="water", target="rigid", direction="two_way", variables=["motion", "wrench"])} if two_way else {}
    )
    base = sw.world(entities, frames=frames, fps=fps, materials=MATERIALS, **more)
    plan = SimulationPlan(
        fps=fps,
        frames=frames,
        gravity=tuple(gravity),
        solvers=solvers,
        drivers=dict(drivers or {}),
        couplings=couplings,
        limits=base.simulation.limits,
    )
    return base.model_copy(update={"simulation": plan})


def pool_in_tank(
    *,
    size: Sequence[float] = (0.4, 0.3, 0.16),
    spacing: float = 0.02,
    wall: float = 0.02,
    frames: int = 24,
    fps: int = 24,
    engine: str = "dfsph",
    gap: float = 0.0,
    others: Mapping[str, Entity] | None = None,
    below: float = 0.3,
    **more: Any,
) -> Flow:
    """Still water in an open tank that stands in a domain with `below` [m] of air under it."""
    x, y, depth = size
    inner = (x, y, 2 * depth)
    entities = {
        "tank": tank(inner, wall, gap=gap, gap_at=0.5 * spacing),
        "pool": water((x, y, depth), (0, 0, depth / 2), spacing),
        **(others or {}),
    }
    low = (-x / 2 - wall - 0.05, -y / 2 - wall - 0.05, -wall - below)
    high = (x / 2 + wall + 0.05, y / 2 + wall + 0.05, 2.2 * depth + 0.1)
    spec = liquid_world(entities, spacing=spacing, low=low, high=high, frames=frames, fps=fps, engine=engine, **more)
    points = lattice((-x / 2, -y / 2, 0.0), size, spacing)
    volume = x * y * depth / len(points)
    names = tuple(f"{n}/body" for n in entities if n != "pool")
    ids = np.arange(len(points))
    return Flow(
        spec,
        [points.copy() for _ in range(frames)],
        [np.zeros_like(points) for _ in range(frames)],
        [ids] * frames,
        volume,
        names,
    )
