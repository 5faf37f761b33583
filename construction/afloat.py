"""The float line: how deep a body of given mass lies in a liquid, by the volume that its surfaces displace."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..worlds.arrays import F64, RigidPose, compose
from ..worlds.errors import InputError
from .scenes import Body

__all__ = ["FloatLine", "float_line", "submerged"]

RASTER = 256
"""Own choice: columns along the longer side in which open hulls are looked for."""
LEVELS = 64
"""Own choice: depths between which the float line is looked for first."""
EXACT = 1e-9
"""Relative to the height: where bisection ends."""


@dataclass(frozen=True)
class FloatLine:
    """A floating body at rest: its pose, and what of it is under the level."""

    pose: RigidPose
    draught: float
    """From its lowest point to the level [m]."""
    freeboard: float
    """From the level to its highest point [m]."""
    displaced: float
    """Volume under the level, the air in an open hull included [m^3]."""
    lever: float
    """Distance across between the centres of mass and of buoyancy [m]: it heels or trims until that is gone."""


class _Hull:
    """Columns of air above the upper surfaces that a rim keeps dry.

    A flood from outside over the upper surface gives the least level at which each column fills; edges are drawn into the
    surface, so that walls thinner than a column hold.
    """

    def __init__(self, triangles: F64) -> None:
        from scipy.ndimage import minimum_filter

        low, high = triangles.reshape(-1, 3).min(0), triangles.reshape(-1, 3).max(0)
        self.side = float((high - low)[:2].max()) / RASTER
        counts = np.maximum(1, np.ceil((high - low)[:2] / self.side).astype(int))
        self.x, self.y = (low[k] + (np.arange(counts[k]) + 0.5) * self.side for k in (0, 1))
        top = _upper(triangles, self.x, self.y)
        rim = top.copy()
        _draw_edges(triangles, low, self.side, rim)
        # Priority flood by repeated relaxation: every column fills at the level of the lowest way in.
        ground = np.pad(rim, 1, constant_values=low[2])
        spill = np.full(ground.shape, np.inf)
        spill[[0, -1], :] = spill[:, [0, -1]] = low[2]
        cross = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], dtype=bool)
        while True:
            after = np.maximum(ground, minimum_filter(spill, footprint=cross))
            after = np.minimum(after, spill)
            if np.array_equal(after, spill):
                break
            spill = after
        self.spill = spill[1:-1, 1:-1]
        self.top = top

    def dry(self, level: float) -> tuple[float, F64]:
        """Volume of air below a level that stays dry [m^3], and its first moment about the world's origin [m^4], x and y."""
        depth = np.where((self.spill > level) & np.isfinite(self.top), np.maximum(level - self.top, 0.0), 0.0) * self.side**2
        return float(depth.sum()), np.array([float((depth * self.x).sum()), float((depth * self.y[:, None]).sum())])


def submerged(triangles: F64, level: float) -> tuple[float, F64]:
    """Volume of a closed surface below a level [m^3], and its first moment about the world's origin [m^4], x and y.

    By the divergence theorem with (0, 0, z - level), which vanishes on the water plane; exact for polyhedra.

    Args:
        triangles: corners, counter-clockwise seen from outside [m], shape (n, 3, 3).
        level: z of the water plane [m].
    """
    below = triangles[:, :, 2] < level
    count = below.sum(1)
    pieces = [triangles[count == 3]]
    for wet, which in ((1, below), (2, ~below)):
        part = triangles[count == wet]
        lone = which[count == wet].argmax(1)
        a, b, c = (part[np.arange(len(part)), (lone + k) % 3] for k in (0, 1, 2))
        ab, ac = _cut(a, b, level), _cut(a, c, level)
        pieces += [np.stack([a, ab, ac], 1)] if wet == 1 else [np.stack([ab, b, c], 1), np.stack([ab, c, ac], 1)]
    t = np.concatenate(pieces)
    one, two = t[:, 1, :2] - t[:, 0, :2], t[:, 2, :2] - t[:, 0, :2]
    area = 0.5 * (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    deep = t[:, :, 2] - level
    moments = [area @ (t[:, :, k] * deep).sum(1) / 12 + area @ (t[:, :, k].sum(1) * deep.sum(1)) / 12 for k in (0, 1)]
    return float(area @ deep.mean(1)), np.array(moments)


def _cut(a: F64, b: F64, level: float) -> F64:
    """Points at a level between points on either side of it."""
    share = (level - a[:, 2]) / (b[:, 2] - a[:, 2])
    return np.asarray(a + share[:, None] * (b - a))


def float_line(body: Body, pose: RigidPose, mass: float, center: F64, *, density: float, level: float) -> FloatLine:
    """Lower a body until the liquid that it displaces weighs what it does.

    Solids displace their volume; an open hull besides the air up to its rim. Rooms under a deck count as flooded, unless body and
    deck are one solid.

    Args:
        body: surfaces, not crossing each other.
        pose: orientation and place; its height does not matter.
        mass: [kg].
        center: of mass in the body's frame [m], shape (3,).
        density: of the liquid [kg/m^3].
        level: of the liquid [m].

    Raises:
        InputError: it sinks.
    """
    triangles = np.concatenate(
        [compose(pose, place).apply(s.triangles.reshape(-1, 3)).reshape(-1, 3, 3) for place, s in body.solids]
    )
    low, high = float(triangles[:, :, 2].min()), float(triangles[:, :, 2].max())
    hull = _Hull(triangles)

    def displaced(plane: float) -> tuple[float, F64]:
        volume, moment = submerged(triangles, plane)
        air, more = hull.dry(plane)
        return volume + air, moment + more

    wanted = mass / density
    planes = np.linspace(low, high, LEVELS + 1)
    volumes = [displaced(float(p))[0] for p in planes]
    enough = next((k for k, v in enumerate(volumes) if v >= wanted), None)
    if enough is None or enough == 0:
        raise InputError(
            f"it sinks: of {mass:.4g} kg, and of the liquid of {density:g} kg/m^3 it displaces at most {density * max(volumes):.4g} kg; "
            "give it less mass, a hull with a higher rim, or a place on the bed with on"
        )
    lower, upper = float(planes[enough - 1]), float(planes[enough])
    while upper - lower > EXACT * (high - low):
        middle = 0.5 * (lower + upper)
        lower, upper = (lower, middle) if displaced(middle)[0] >= wanted else (middle, upper)
    volume, moment = displaced(upper)
    across = moment / volume - pose.apply(np.asarray(center)[None])[0, :2]
    lowered = RigidPose(pose.position + np.array([0.0, 0.0, level - upper]), pose.quaternion)
    return FloatLine(lowered, upper - low, high - upper, volume, float(np.hypot(*across)))


def _upper(triangles: F64, x: F64, y: F64) -> F64:
    """Height of the highest surface in the middle of each column, -inf where there is none, shape (len(y), len(x))."""
    top = np.full((len(y), len(x)), -np.inf)
    side = float(x[1] - x[0]) if len(x) > 1 else float(y[1] - y[0]) if len(y) > 1 else 1.0
    for a, b, c in triangles:
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area <= 0:  # seen from below, or from the side
            continue
        lows, highs = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
        i0, i1 = (int(np.clip(np.floor((v - x[0]) / side) + k, 0, len(x))) for v, k in ((lows[0], 0), (highs[0], 2)))
        j0, j1 = (int(np.clip(np.floor((v - y[0]) / side) + k, 0, len(y))) for v, k in ((lows[1], 0), (highs[1], 2)))
        u, v = x[None, i0:i1] - a[0], y[j0:j1, None] - a[1]
        s = (u * (c[1] - a[1]) - v * (c[0] - a[0])) / area
        t = (v * (b[0] - a[0]) - u * (b[1] - a[1])) / area
        z = a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2])
        inside = (s >= 0) & (t >= 0) & (s + t <= 1)
        top[j0:j1, i0:i1] = np.where(inside, np.maximum(top[j0:j1, i0:i1], z), top[j0:j1, i0:i1])
    return top


def _draw_edges(triangles: F64, low: F64, side: float, top: F64) -> None:
    """Raise columns that an edge of the surface crosses to the height of the edge."""
    starts, ends = triangles.reshape(-1, 3), np.roll(triangles, -1, axis=1).reshape(-1, 3)
    counts = np.ceil(np.linalg.norm((ends - starts)[:, :2], axis=1) / (0.5 * side)).astype(int) + 1
    share = np.concatenate([np.linspace(0.0, 1.0, c) for c in counts])
    points = np.repeat(starts, counts, axis=0) + share[:, None] * np.repeat(ends - starts, counts, axis=0)
    column = np.clip(((points[:, :2] - low[:2]) / side).astype(int), 0, np.array(top.shape)[::-1] - 1)
    np.maximum.at(top, (column[:, 1], column[:, 0]), points[:, 2])
