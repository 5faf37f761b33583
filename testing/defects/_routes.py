"""Rooms, doors, stairs and bridges at any place and angle, for the seeded defects of navigability."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import Box, BoxRegion, Connects, Cylinder, CylinderRegion, Entity, Extrusion, LiquidPhysics, Mesh, Part, Shape
from ..worlds.small_worlds import Track, entity, make_candidate, mesh_of, pose, world
from .cases import World

__all__ = ["EAST", "WEST", "Site", "block", "carrier", "flight", "furniture", "prism", "ramp", "site", "stairs", "tanks"]

RNG = np.random.Generator
WEST, EAST = -3.6, 3.6
"""[m] Ends of a hall."""


def block(x0: float, x1: float, y0: float, y1: float, z0: float, z1: float, **more: Any) -> Part:
    """A box between two corners."""
    middle = ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2)
    return Part(shape=Box(size=(x1 - x0, y1 - y0, z1 - z0)), pose=pose(middle), **more)


def prism(profile: Sequence[tuple[float, float]], y0: float, y1: float) -> Part:
    """A profile of (x, z), counter-clockwise seen from -y, drawn along y."""
    turned = pose((0, (y0 + y1) / 2, 0), euler=(math.pi / 2, 0, 0))
    return Part(shape=Extrusion(polygon=list(profile), height=y1 - y0), pose=turned)


def carrier(rng: RNG, **fields: Any) -> Connects:
    """A walker or an object of random size, to be asked from region `a` to region `b`."""
    walker = rng.random() < 0.5
    if walker or fields.get("carrier") == "walker":  # which is a person
        fields["headroom"] = max(float(fields.get("headroom", 2.0)), 1.9)
    if walker:
        return Connects(a="a", b="b", **fields)
    width = float(rng.uniform(0.6, 1.1))
    chosen: dict[str, Any] = {
        "carrier": "object",
        "width": width,
        "headroom": float(rng.uniform(0.8, 2.2)),
        "max_step": float(rng.uniform(0.02, 0.25)),
        "max_slope": float(rng.uniform(0.1, 0.7)),
    }
    if fields.get("carrier") == "walker":  # which is a person
        chosen |= {
            "headroom": 1.9,
            "max_step": min(float(chosen["max_step"]), 0.22),
            "max_slope": min(float(chosen["max_slope"]), 0.6),
        }
    return Connects(a="a", b="b", **{**chosen, **fields})


@dataclass
class Site:
    """A hall along x with walls, at some place and angle; regions `a` in the west and `b` in the east."""

    rng: RNG
    half: float
    """Half the width of the hall [m]."""
    yaw: float
    place: F64
    things: dict[str, Entity] = field(default_factory=dict)
    regions: dict[str, Any] = field(default_factory=dict)

    @property
    def frame(self) -> dict[str, Any]:
        """Where the hall stands, for `entity`."""
        return {"at": self.place.tolist(), "euler": (0.0, 0.0, self.yaw)}

    def add(self, name: str, *parts: Part | Shape) -> None:
        """A static entity whose parts are given in the hall's frame."""
        self.things[name] = entity(*parts, **self.frame)

    def put(
        self, name: str, shape: Shape, at: Sequence[float], *, turn: float = 0.0, motion: str = "static", **more: Any
    ) -> None:
        """An entity with a frame of its own at a place of the hall."""
        self.things[name] = entity(shape, at=self.out(at).tolist(), euler=(0, 0, self.yaw + turn), motion=motion, **more)

    def out(self, point: Sequence[float]) -> F64:
        """World coordinates of a point of the hall."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        x, y, z = point
        return np.asarray(self.place + np.array([c * x - s * y, s * x + c * y, z]))

    def track(self, points: Sequence[Sequence[float]], turns: Sequence[float] | float = 0.0) -> Track:
        """Motion of a body through places of the hall, turned about z."""
        angle = 0.5 * (self.yaw + np.broadcast_to(np.asarray(turns, dtype=float), (len(points),)))
        zero = np.zeros(len(points))
        return np.array([self.out(p) for p in points]), np.stack([np.cos(angle), zero, zero, np.sin(angle)], axis=-1)

    def region(self, name: str, low: Sequence[float], high: Sequence[float]) -> None:
        """A region between two corners in the hall's frame: a box that rides on the floor, or a cylinder in the world."""
        if self.rng.random() < 0.6:
            self.regions[name] = BoxRegion(min=tuple(low), max=tuple(high), relative_to="floor")
        else:
            middle = [(p + q) / 2 for p, q in zip(low, high, strict=True)]
            radius = min(high[0] - low[0], high[1] - low[1]) / 2
            self.regions[name] = CylinderRegion(center=tuple(self.out(middle).tolist()), radius=radius, height=high[2] - low[2])

    def ends(self, *, rise: float = 0.0, far: float = EAST, low: float = 0.0) -> None:
        """Regions at both ends of the hall."""
        self.region("a", (WEST + 0.5, -self.half + 0.2, low), (WEST + 1.5, self.half - 0.2, low + 0.5))
        self.region("b", (far - 1.5, -self.half + 0.2, rise), (far - 0.5, self.half - 0.2, rise + 0.5))

    def wall(self, name: str, x: float, door: float, *, middle: float = 0.0, tall: float = 2.6, lintel: float = 2.3) -> None:
        """A wall across the hall with a door."""
        thick = float(self.rng.choice([0.004, 0.05, 0.12, 0.4]))
        left, right = middle - door / 2, middle + door / 2
        parts = [block(x, x + thick, -self.half, left, 0, tall), block(x, x + thick, right, self.half, 0, tall)]
        if self.rng.random() < 0.7:
            parts.append(block(x, x + thick, left, right, lintel, tall))
        self.add(name, *parts)

    def clutter(self) -> None:
        """Things that stand near, but outside the hall, and above it."""
        for k in range(int(self.rng.integers(0, 6))):
            side = float(self.rng.choice([-1.0, 1.0]))
            shape = furniture(self.rng, (0.4, 0.4, 0.8))
            self.put(f"near{k}", shape, (float(self.rng.uniform(-2.5, 2.5)), side * (self.half + 0.5 + 0.5 * k), 0.4))

    def world(
        self,
        folder: Path,
        relation: Connects,
        *culprits: str,
        tracks: Mapping[str, Track] | None = None,
        frames: int = 4,
        **more: Any,
    ) -> World:
        """The candidate; a defect must be found in the relation `way`, and name one of `culprits` where given."""
        spec = world(self.things, regions=self.regions, relations={"way": relation}, frames=frames, **more)
        made = make_candidate(folder, spec, tracks=tracks)
        return World(made, culprits)


def site(rng: RNG, *, half: float | None = None, floor: bool = True, far: float = EAST) -> Site:
    """A hall of random width, angle and place; its floor reaches from x = -3.6 to `far`."""
    reach = float(rng.choice([0.0, 10.0, 2000.0]))
    yaw = float(rng.choice([0.0, math.pi / 6, math.pi / 4, rng.uniform(-math.pi, math.pi)]))
    made = Site(rng, float(rng.uniform(1.0, 1.6)) if half is None else half, yaw, rng.uniform(-1, 1, 3) * reach)
    if floor:
        made.add("floor", block(WEST, far, -made.half, made.half, -0.2, 0.0))
    return made


def furniture(rng: RNG, size: Sequence[float]) -> Shape:
    """A crate, drum, or an import of a box that is open or inside out, of the given outer size."""
    x, y, z = (float(s) for s in size)
    kind = int(rng.integers(4))
    if kind == 0 and abs(x - y) < 1e-9:
        return Cylinder(radius=x / 2, height=z)
    if kind >= 2:
        mesh = mesh_of(Box(size=(x, y, z)))
        faces = mesh.faces[:, ::-1] if kind == 2 else mesh.faces[2:]
        return Mesh(vertices=[tuple(v) for v in mesh.vertices.tolist()], faces=[tuple(f) for f in faces.tolist()])
    return Box(size=(x, y, z))


def flight(rises: Sequence[float], going: float, wide: float, *, solid: bool) -> list[Part]:
    """Treads from x = 0, each `rises` above the one before; solid down to z = 0, or boards of 4 cm."""
    parts, z = [], 0.0
    for k, rise in enumerate(rises):
        z += rise
        parts.append(block(k * going, (k + 1) * going, -wide / 2, wide / 2, 0.0 if solid else z - 0.04, z))
    return parts


def stairs(hall: Site, rises: list[float], going: float, *, solid: bool, wide: float = 1.4) -> float:
    """A flight from x = 0 onto a deck; the height of the deck [m]."""
    hall.add("stairs", *flight(rises, going, wide, solid=solid))
    end, top = len(rises) * going, float(sum(rises))
    hall.add("deck", block(end, end + 2.5, -hall.half, hall.half, top - 0.05, top))
    hall.ends(rise=top, far=end + 2.5)
    return top


def ramp(hall: Site, slopes: list[tuple[float, float]]) -> float:
    """A ramp from x = 0 of stretches (run, slope [rad]) up to a deck; its height [m]."""
    x, z, points = 0.0, 0.0, [(0.0, 0.0)]
    for run, slope in slopes:
        x, z = x + run, z + run * math.tan(slope)
        points.append((x, z))
    hall.add("ramp", prism([(0.0, -0.1), (x, -0.1), *points[::-1]], -hall.half, hall.half))
    hall.add("deck", block(x, x + 2.5, -hall.half, hall.half, z - 0.05, z))
    hall.ends(rise=z, far=x + 2.5)
    return z


def tanks(rng: RNG, width: float, hole: float, cell: float, *, gate: float | None = None) -> tuple[Site, Connects]:
    """Two closed basins with an opening between them; a gate stands `gate` high in the opening."""
    hall = site(rng, half=0.4, floor=False)
    x, y, z, level = 0.6, 0.4, 0.8, float(rng.uniform(0.05, 0.3))
    walls = [
        block(-x, x, -y, y, -0.05, 0),
        block(-x, x, -y, y, z, z + 0.05),
        block(-x - 0.05, -x, -y, y, 0, z),
        block(x, x + 0.05, -y, y, 0, z),
        block(-x, x, -y - 0.05, -y, 0, z),
        block(-x, x, y, y + 0.05, 0, z),
    ]
    hall.add("floor", *walls)
    thick, side = float(rng.choice([0.01, 0.1, 0.3])), float(rng.uniform(-0.1, 0.1))
    left, right, top = side - hole / 2, side + hole / 2, level + hole
    hall.add(
        "wall",
        block(0, thick, -y, left, 0, z),
        block(0, thick, right, y, 0, z),
        block(0, thick, left, right, 0, level),
        block(0, thick, left, right, top, z),
    )
    if gate is not None:
        hall.add("gate", block(0.4 * thick, 0.6 * thick, left, right, level, level + gate))
    hall.add("water", block(-0.55, -0.1, -0.35, 0.35, 0.01, 0.6))
    hall.things["water"] = hall.things["water"].model_copy(update={"physics": LiquidPhysics(resolution=cell)})
    hall.regions["a"] = BoxRegion(min=(-0.5, -0.25, 0.2), max=(-0.15, 0.25, 0.75), relative_to="floor")
    hall.regions["b"] = BoxRegion(min=(0.4, -0.25, 0.05), max=(0.55, 0.25, 0.7), relative_to="floor")
    return hall, Connects(a="a", b="b", carrier="fluid", width=width)
