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

from ...worlds.arrays import F64
from ...worlds.cache import Cache, CacheIndex, write_container
from ...worlds.candidate import Candidate
from ...worlds.spec import (
    Box,
    Coupling,
    DfsphInstance,
    DfsphSettings,
    Entity,
    FlipInstance,
    FlipSettings,
    LiquidPhysics,
    Material,
    RigidInstance,
    SidedDomain,
    SimulationPlan,
    WorldSpec,
)
from . import small_worlds as sw

__all__ = ["DENSITY", "Flow", "G", "lattice", "liquid_world", "pool_in_tank", "stream", "tank", "water"]

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
    from ...worlds.spec import Part

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
    """Volume of each particle [m^3]."""
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
    touches: Sequence[sw.Touch] = ()
    """Contacts among solids."""
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

    def drained(self) -> Flow:
        """A copy in which what has left the domain is gone and counted."""
        domain = next(iter(self.spec.simulation.liquid.values())).settings.domain
        low, high = (np.array(domain.center) + s * 0.5 * np.array(domain.size) for s in (-1.0, 1.0))
        gone: set[int] = set()
        position, velocity, identity, left = [], [], [], []
        for p, v, i in zip(self.position, self.velocity, self.identity, strict=True):
            out = ((p < low) | (p > high)).any(axis=1)
            gone |= set(np.asarray(i)[out].tolist())
            keep = ~np.isin(i, list(gone))
            position.append(p[keep])
            velocity.append(v[keep])
            identity.append(np.asarray(i)[keep])
            left.append(self.volume * DENSITY * len(gone))
        return self.edited(position=position, velocity=velocity, identity=identity, left=np.array(left))

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
        base = sw.make_candidate(
            folder, self.spec, tracks=self.tracks, channels=self.rigid, records=self._rigid_records(), touches=self.touches
        )
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

    def _rigid_records(self) -> dict[str, Any]:
        """Records of the rigid instance, whose bodies move without turning."""
        spec, total = (
            self.spec,
            dict.fromkeys(("kinetic_energy", "potential_energy", "momentum_x", "momentum_y", "momentum_z", "max_speed"), 0.0),
        )
        gravity, built = np.array(spec.simulation.gravity), sw.build_all(spec)
        moving = [n for n, e in spec.entities.items() if e.motion == "dynamic" and e.physics.category == "rigid"]
        for row, name in enumerate(moving):
            body = built[name].bodies[0]
            position = np.broadcast_to(
                np.asarray(self.tracks.get(name, (spec.entities[name].pose.position,))[0]), (self.frames, 3)
            )
            velocity = self.rigid["velocity"][:, row] if "velocity" in self.rigid else np.zeros((self.frames, 3))
            speed = np.linalg.norm(velocity, axis=1)
            add = {
                "kinetic_energy": 0.5 * body.mass * speed**2,
                "potential_energy": -body.mass * ((position + body.center) @ gravity),
            }
            add |= {f"momentum_{a}": body.mass * velocity[:, i] for i, a in enumerate("xyz")}
            total = {n: v + add.get(n, 0.0) for n, v in total.items()} | {"max_speed": np.maximum(total["max_speed"], speed)}
        step = 5e-4
        mass = sum(built[n].bodies[0].mass for n in moving)
        return {**total, "driver_work": 0.0, "mass": mass, "body_count": len(moving), "joint_error": 0.0, "step": step, "steps": 84,
                "max_travel_per_step": np.asarray(total["max_speed"]) * step * 2, "iterations_capped": 0, "iterations_max": 3, "contacts_max": 0, "contact_gain": 0, "overflows": 0}  # fmt: skip

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
        from ...worlds.categories.liquid.surface import surface_folder

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
    domain = SidedDomain(
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


def stream(
    *, speed: float = 1.0, width: float = 0.08, height: float = 0.8, spacing: float = 0.02, frames: int = 24, fps: int = 24, others: Mapping[str, Entity] | None = None,
    offset: Sequence[float] = (0.0, 0.0),
) -> Flow:  # fmt: skip
    """Water that an inflow at `height` [m] lets fall freely out of the open bottom of the domain; layers one spacing apart."""
    from ...worlds.spec import InflowDriver, Pose

    entities = {"pool": water((width, width, 2 * spacing), (offset[0], offset[1], height - spacing), spacing), **(others or {})}
    # Local +z of the opening looks down: a half turn about x.
    driver = InflowDriver(
        entity="pool",
        pose=Pose(position=(offset[0], offset[1], height), quaternion=(0, 1, 0, 0)),
        size=(width, width),
        speed=speed,
    )
    low, high = (-0.3, -0.3, 0.0), (0.3, 0.3, height + 0.2)
    spec = liquid_world(entities, spacing=spacing, low=low, high=high, frames=frames, fps=fps, drivers={"tap": driver})
    n = round(width / spacing)
    axis = (np.arange(n) + 0.5) * spacing - width / 2
    layer = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2) + np.array(offset)
    born = np.concatenate(
        [
            [-1.5 * spacing / speed, -0.5 * spacing / speed],
            (np.arange(int(frames / fps * speed / spacing) + 1) + 0.5) * spacing / speed,
        ]
    )
    position, velocity, identity, came, left = [], [], [], [], []
    mass = len(layer) * spacing**3 * DENSITY
    for k in range(frames):
        age = k / fps - born
        # Those of the initial volume start at rest depth with the speed of the flow.
        z = height - speed * np.maximum(age, 0.0) - 0.5 * G * np.maximum(age, 0.0) ** 2
        first = np.array([-1.5, -0.5]) * spacing
        z[:2] = height + first[::-1] * 1.0 - speed * k / fps - 0.5 * G * (k / fps) ** 2
        fall = np.where(np.arange(len(born)) < 2, k / fps, np.maximum(age, 0.0))
        there = ((age >= 0.0) | (np.arange(len(born)) < 2)) & (z > 0.0)
        rows = np.flatnonzero(there)
        position.append(np.concatenate([np.column_stack([layer, np.full(len(layer), z[r])]) for r in rows]))
        velocity.append(np.concatenate([np.tile([0.0, 0.0, -speed - G * fall[r]], (len(layer), 1)) for r in rows]))
        identity.append(np.concatenate([np.arange(len(layer)) + len(layer) * r for r in rows]))
        came.append(mass * float((age[2:] >= 0.0).sum()))
        gone = ((age >= 0.0) | (np.arange(len(born)) < 2)) & ~there
        left.append(mass * float(gone.sum()))
    order = [np.argsort(i) for i in identity]
    return Flow(
        spec.model_copy(update={"entities": {**spec.entities, "pool": spec.entities["pool"].model_copy(update={"physics": spec.entities["pool"].physics.model_copy(update={"linear_velocity": (0.0, 0.0, -speed)})})}}),
        [p[o] for p, o in zip(position, order, strict=True)], [v[o] for v, o in zip(velocity, order, strict=True)], [i[o] for i, o in zip(identity, order, strict=True)],
        spacing**3, tuple(f"{n}/body" for n in (others or {})), inflow={"tap": np.array(came)}, left=np.array(left),
    )  # fmt: skip


def middle_column(width: float, spacing: float) -> float:
    """x of a column of the lattice that fills `width` about 0, next to its middle."""
    return 0.5 * spacing if round(width / spacing) % 2 == 0 else 0.0


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
        "tank": tank(inner, wall, gap=gap, gap_at=middle_column(x, spacing)),
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
