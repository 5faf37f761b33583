"""Bodies of an asset: parts, joints and places, in the asset's own frame.

The origin is on the ground in the middle of the asset, x to the right, z up; it looks towards -y, its back is at +y.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.spec import Box, Capsule, Cylinder, Extrusion, Hull, Part, Pose, Revolution, Shape, Sphere, Sweep

__all__ = ["Body", "Joint", "Made", "Place", "Point"]

Point = Sequence[float] | F64
"""Coordinates [m] in the asset's frame."""
MAIN = ""
"""Name of the body that bears the asset's own id."""
DIGITS = 9
"""Decimals to which lengths are written: 1 nm, far below every skin, and no noise in the last digits."""


def _rounded(point: Point) -> tuple[float, float, float]:
    x, y, z = (round(float(c), DIGITS) + 0.0 for c in point)
    return (x, y, z)


def _flat(points: Sequence[Point]) -> list[tuple[float, float]]:
    return [(round(float(a), DIGITS) + 0.0, round(float(b), DIGITS) + 0.0) for a, b in points]


@dataclass
class Body:
    """One rigid body of an asset, with its parts in the asset's frame.

    Parts may touch and must not overlap, since each has its mass.
    """

    role: str
    material: str
    motion: Literal["static", "dynamic"] | None = None
    """None: as the whole asset is asked for."""
    parts: dict[str, Part] = field(default_factory=dict)
    breakable: dict[str, Any] | None = None
    """The field `breakable` of the entity, as JSON."""
    physics: dict[str, Any] | None = None
    """The field `physics` of the entity, as JSON; default rigid."""

    def add(
        self, name: str, shape: Shape, at: Point = (0, 0, 0), *, euler: Point | None = None, material: str | None = None
    ) -> None:
        """Add a part of any shape with its own origin at a point; `euler` [rad] turns it about fixed x, then y, then z.

        Raises:
            ValueError: there is a part of that name.
        """
        if name in self.parts:
            raise ValueError(f"the part {name!r} is there already")
        turn = None if euler is None or not any(euler) else _rounded(euler)
        own = None if material == self.material else material
        self.parts[name] = Part(shape=shape, pose=Pose(position=_rounded(at), euler=turn), material=own)

    def box(self, name: str, low: Point, high: Point, *, material: str | None = None) -> None:
        """Add an upright box from its least to its greatest corner."""
        low, high = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
        if (high - low).min() <= 0:
            raise InputError(
                f"the part {name!r} would have sizes {_rounded(high - low)} m; these parameters leave no room for it"
            )
        self.add(name, Box(size=_rounded(high - low)), (low + high) / 2, material=material)

    def cylinder(self, name: str, foot: Point, head: Point, radius: float, *, material: str | None = None) -> None:
        """Add a cylinder between the centres of its two ends."""
        length, middle, euler = _along(foot, head)
        self.add(name, Cylinder(radius=radius, height=length), middle, euler=euler, material=material)

    def capsule(self, name: str, foot: Point, head: Point, radius: float, *, material: str | None = None) -> None:
        """Add a cylinder with half balls about its two end points."""
        length, middle, euler = _along(foot, head)
        self.add(name, Capsule(radius=radius, length=length), middle, euler=euler, material=material)

    def sphere(self, name: str, center: Point, radius: float, *, material: str | None = None) -> None:
        """Add a ball."""
        self.add(name, Sphere(radius=radius), center, material=material)

    def turned(
        self,
        name: str,
        profile: Sequence[Point],
        at: Point = (0, 0, 0),
        *,
        segments: int = 24,
        euler: Point | None = None,
        material: str | None = None,
    ) -> None:
        """Add a closed outline of (r, z) turned about the z axis through a point."""
        shape = Revolution(profile=_flat(profile), segments=segments)
        self.add(name, shape, at, euler=euler, material=material)

    def prism(
        self,
        name: str,
        polygon: Sequence[Point],
        low: float,
        high: float,
        *,
        axis: Literal["x", "y", "z"] = "z",
        material: str | None = None,
    ) -> None:
        """Add a polygon that is drawn out along an axis from `low` to `high`.

        Points are (x, y) for z, (x, z) for y, (y, z) for x.
        """
        middle, outline = (low + high) / 2, list(polygon)
        at, euler = {
            "z": ((0, 0, middle), None),
            "y": ((0, middle, 0), (math.pi / 2, 0, 0)),
            "x": ((middle, 0, 0), (math.pi / 2, 0, math.pi / 2)),
        }[axis]
        self.add(name, Extrusion(polygon=_flat(outline), height=high - low), at, euler=euler, material=material)

    def hull(self, name: str, points: Sequence[Point], *, material: str | None = None) -> None:
        """Add the convex hull of points."""
        self.add(name, Hull(points=[_rounded(p) for p in points]), material=material)

    def taper(
        self,
        name: str,
        foot: Point,
        head: Point,
        foot_size: tuple[float, float],
        head_size: tuple[float, float],
        *,
        material: str | None = None,
    ) -> None:
        """Add a straight piece with level rectangular ends of sizes (x, y) about two points: legs, posts, splayed too."""
        ends = ((foot, foot_size), (head, head_size))
        corners = [(p[0] + sx * s[0] / 2, p[1] + sy * s[1] / 2, p[2]) for p, s in ends for sx in (-1, 1) for sy in (-1, 1)]
        self.hull(name, corners, material=material)

    def sweep(
        self,
        name: str,
        path: Sequence[Point],
        profile: Sequence[Point],
        *,
        scales: Sequence[float] | None = None,
        closed: bool = False,
        material: str | None = None,
    ) -> None:
        """Add a profile (u to the right, v up) carried along a path."""
        shape = Sweep(
            path=[_rounded(p) for p in path],
            profile=_flat(profile),
            scales=None if scales is None else [float(s) for s in scales],
            closed=closed,
        )
        self.add(name, shape, material=material)


def _along(foot: Point, head: Point) -> tuple[float, Point, tuple[float, float, float]]:
    """Length, middle and Euler angles of what lies along z between two points."""
    a, b = np.asarray(foot, dtype=np.float64), np.asarray(head, dtype=np.float64)
    way = b - a
    length = float(np.linalg.norm(way))
    if length <= 0:
        raise InputError("a bar between two equal points has no length; these parameters leave no room for it")
    lean = math.atan2(math.hypot(way[0], way[1]), way[2])
    return length, (a + b) / 2, (0.0, lean, math.atan2(way[1], way[0]) if lean > 1e-12 else 0.0)


@dataclass(frozen=True)
class Joint:
    """Joint between two bodies of an asset: fields of the joint as in the specification, points in the asset's frame."""

    child: str
    kind: Literal["hinge", "slide", "ball", "weld"]
    anchor: Point
    parent: str = MAIN
    axis: Point | None = None
    range: tuple[float, float] | None = None
    """[rad] or [m] from the initial position."""
    damping: float = 0.0
    """[N m s/rad] or [N s/m]."""
    friction: float = 0.0
    """Dry friction [N m] or [N]."""


@dataclass(frozen=True)
class Place:
    """A level rectangle of an asset on which things stand."""

    center: Point
    """Middle of the rectangle [m]; its height is that of the surface."""
    size: tuple[float, float]
    """Extent x, y [m]."""
    clearance: float = math.inf
    """Free height above it [m]."""
    body: str = MAIN


@dataclass
class Made:
    """An asset: its bodies by name, the one named "" bears the asset's id."""

    bodies: dict[str, Body] = field(default_factory=dict)
    joints: dict[str, Joint] = field(default_factory=dict)
    places: dict[str, Place] = field(default_factory=dict)
    carries: list[tuple[str, str]] = field(default_factory=list)
    """Bodies (carrier, carried) of which one lies loosely on the other."""

    @classmethod
    def of(cls, body: Body) -> Made:
        """An asset of one body."""
        return cls({MAIN: body})

    @property
    def main(self) -> Body:
        """The body that bears the asset's id."""
        return self.bodies[MAIN]
