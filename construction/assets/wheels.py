"""Things about an axle that generators share: rings, spoked wheels, posts with a hole for an axle."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

from .made import Body

__all__ = ["Axle", "facets", "pierced", "spoked"]


class Axle(NamedTuple):
    """An axis along x or y through a point [m]."""

    center: tuple[float, float, float]
    along: Literal["x", "y"] = "x"

    def at(self, radius: float, angle: float, offset: float) -> tuple[float, float, float]:
        """Point at a radius and an angle [rad] in the wheel's plane (from +y, or +x, towards +z), `offset` along the axis."""
        x, y, z = self.center
        a, b = radius * math.cos(angle), radius * math.sin(angle)
        return (x + offset, y + a, z + b) if self.along == "x" else (x + a, y + offset, z + b)

    def ring(
        self,
        body: Body,
        name: str,
        profile: list[tuple[float, float]],
        *,
        segments: int,
        spin: float = 0.0,
        material: str | None = None,
    ) -> None:
        """Add an outline of (radius, offset) turned about the axis, with a corner at the angle `spin`."""
        if self.along == "y":
            profile = [(r, -w) for r, w in profile]
        euler = (math.pi / 2, -spin, math.pi / 2 if self.along == "x" else 0.0)
        body.turned(name, profile, self.center, segments=segments, euler=euler, material=material)

    def sector(
        self,
        body: Body,
        name: str,
        radii: tuple[float, float],
        angles: tuple[float, float],
        offsets: tuple[float, float],
        *,
        material: str | None = None,
    ) -> None:
        """Add the hull of a piece between two radii, angles and offsets: spokes, blades, felloes."""
        body.hull(name, [self.at(r, a, w) for r in radii for a in angles for w in offsets], material=material)

    def bar(
        self,
        body: Body,
        name: str,
        radii: tuple[float, float],
        angle: float,
        widths: tuple[float, float],
        offsets: tuple[float, float],
        *,
        material: str | None = None,
    ) -> None:
        """Add a radial bar of a width at its inner and its outer end."""
        points = []
        for r, w in zip(radii, widths, strict=True):
            for s in (-1, 1):
                turn, reach = math.atan2(s * w / 2, r), math.hypot(r, w / 2)
                points += [self.at(reach, angle + turn, o) for o in offsets]
        body.hull(name, points, material=material)


def facets(spokes: int) -> int:
    """Flat sides of the tyre of a wheel with so many spokes."""
    return 6 * spokes if spokes % 2 == 0 else 8 * spokes


def spoked(body: Body, axle: Axle, radius: float, width: float, spokes: int, *, wood: str, tyre: str, spin: float = 0.0) -> float:
    """Add a wheel of wood with a hub, spokes, a rim and a tyre of metal, a flat side down.

    Its sides are 4 to 8 degrees wide: a hoop that rolls over an edge of an angle a loses a^2 / 2 of its energy, half a percent at most.

    Args:
        body: to which it is added.
        axle: of the wheel.
        radius: to the corners of the tyre [m].
        width: of the rim [m].
        spokes: their number.
        wood: material of the wheel.
        tyre: material of its tyre.
        spin: turn of the spokes [rad]; the same wheel may be varied by it where the tyre is not on the ground.

    Returns:
        distance from the axis to a flat side of the tyre [m].
    """
    segments = facets(spokes)
    begin = -math.pi / 2 + math.pi / segments + spin
    w, band, felloe = width / 2, max(0.008, 0.025 * radius), max(0.03, 0.11 * radius)
    inner = radius - band - felloe
    axle.ring(
        body,
        "tyre",
        [(radius - band, -w), (radius, -w), (radius, w), (radius - band, w)],
        segments=segments,
        spin=begin,
        material=tyre,
    )
    axle.ring(
        body,
        "rim",
        [(inner, -0.9 * w), (radius - band, -w), (radius - band, w), (inner, 0.9 * w)],
        segments=segments,
        spin=begin,
        material=wood,
    )
    hub, long = max(0.16 * radius, 0.025), 1.5 * w
    first = begin + math.pi / segments
    turn = first - math.pi / spokes
    shape = [(0, -long), (0.85 * hub, -long), (hub, -0.7 * w), (hub, 0.7 * w), (0.85 * hub, long), (0, long)]
    axle.ring(body, "hub", shape, segments=spokes, spin=turn, material=wood)
    flat_rim, flat_hub = inner * math.cos(math.pi / segments), hub * math.cos(math.pi / spokes)
    wide = min(0.9 * 2 * hub * math.sin(math.pi / spokes), 0.9 * 2 * inner * math.sin(math.pi / segments), 0.07 * radius + 0.012)
    for k in range(spokes):
        axle.bar(
            body,
            f"spoke_{k + 1}",
            (flat_hub, flat_rim),
            first + 2 * math.pi * k / spokes,
            (wide, 0.75 * wide),
            (-0.45 * w, 0.45 * w),
            material=wood,
        )
    return radius * math.cos(math.pi / segments)


def pierced(
    body: Body,
    name: str,
    low: tuple[float, float, float],
    high: tuple[float, float, float],
    center: tuple[float, float],
    radius: float,
    *,
    material: str | None = None,
) -> None:
    """Add a post with a square hole along x about (y, z), `radius` to each side: four pieces about an axle."""
    (x0, y0, _), (x1, y1, _), (y, z) = low, high, center
    body.box(f"{name}_low", low, (x1, y1, z - radius), material=material)
    body.box(f"{name}_front", (x0, y0, z - radius), (x1, y - radius, z + radius), material=material)
    body.box(f"{name}_back", (x0, y + radius, z - radius), (x1, y1, z + radius), material=material)
    body.box(f"{name}_high", (x0, y0, z + radius), high, material=material)
