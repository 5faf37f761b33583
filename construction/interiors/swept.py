"""Room that the joints of a thing sweep, and what stands in it: what opens is to open where it stands (R49, R95).

A volume is a set of upright boxes. What moves is cut into small boxes across its axis; those of two neighbouring positions, with the height
of the arc between them, are one box of the volume, so that it holds all of the way and little more.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from ...worlds.arrays import F64, RigidPose
from ..assets.made import MAIN, Joint, Made

__all__ = ["LIGHT", "Volume", "swept_by"]

ENOUGH = 1.2
"""[rad] Own choice: how far what turns is to open, 69 degrees; the check asks for 60."""
LESS = {"upright_piano_lid": 0.6}
"""[rad] Joints, by generator and name, whose function asks for less: the lid of a piano is propped up, and the wall is behind it."""
PIECE = 0.1
"""[m] Own choice: pieces into which what moves is cut."""
TRAVEL = 0.05
"""[m] Own choice: way between two positions."""
LIGHT = 4.0
"""[kg] Own choice: what weighs less is pushed away by what opens; the check pushes 4.5 kg, with which 22 N slide it at friction 0.5."""


class Volume:
    """Upright boxes.

    Args:
        low: least corners [m], shape (n, 3).
        high: greatest corners [m], shape (n, 3).
    """

    def __init__(self, low: F64, high: F64) -> None:
        self.low, self.high = low, high

    @cached_property
    def around(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Least and greatest corner of all [m]."""
        if len(self.low) == 0:
            return (math.inf,) * 3, (-math.inf,) * 3
        return tuple(self.low.min(0).tolist()), tuple(self.high.max(0).tolist())

    def placed(self, x: float, y: float, z: float, yaw: float) -> Volume:
        """The volume of a thing that stands at a point [m], turned about z [rad]; its boxes are upright again."""
        c, s = math.cos(yaw), math.sin(yaw)
        middle, half = (self.low + self.high) / 2, (self.high - self.low) / 2
        turn, reach = (
            np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]),
            np.array([[abs(c), abs(s), 0.0], [abs(s), abs(c), 0.0], [0.0, 0.0, 1.0]]),
        )
        at, half = middle @ turn.T + (x, y, z), half @ reach.T
        return Volume(at - half, at + half)

    def meets(self, other: Volume) -> bool:
        """True if a box of one overlaps one of the other."""
        (a0, a1, a2), (b0, b1, b2) = self.around
        (c0, c1, c2), (d0, d1, d2) = other.around
        if not (a0 < d0 and c0 < b0 and a1 < d1 and c1 < b1 and a2 < d2 and c2 < b2):
            return False
        return bool(((self.low[:, None] < other.high) & (other.low < self.high[:, None])).all(axis=2).any())

    def within(self, low: tuple[float, float, float], high: tuple[float, float, float]) -> bool:
        """True if all boxes lie between two corners [m]."""
        least, most = self.around
        return all(a >= b for a, b in zip(least, low, strict=True)) and all(a <= b for a, b in zip(most, high, strict=True))


def swept_by(generator: str, made: Made, boxes: Mapping[str, tuple[F64, F64]]) -> Volume:
    """Boxes that the joints of a thing sweep as they open, in its own frame.

    Joints without a range turn on and on within their thing; one that holds the whole thing lets it swing and opens nothing.

    Args:
        generator: of the thing.
        made: its bodies and joints.
        boxes: least and greatest corners of the parts of each body [m], shapes (n, 3).
    """
    lows, highs = [np.empty((0, 3))], [np.empty((0, 3))]
    for name, joint in made.joints.items():
        if joint.kind not in ("hinge", "slide") or joint.range is None or joint.axis is None or joint.child == MAIN:
            continue
        moving = _moving(made, joint.child)
        low, high = (np.concatenate([boxes[body][k] for body in sorted(moving)]) for k in (0, 1))
        for end in joint.range:
            least = min(abs(end), LESS.get(f"{generator}_{name}", ENOUGH)) if joint.kind == "hinge" else abs(end)
            if least > 0.0:
                way = _turned if joint.kind == "hinge" else _slid
                one, two = way(joint, low, high, math.copysign(least, end))
                lows.append(one)
                highs.append(two)
    return Volume(np.concatenate(lows), np.concatenate(highs))


def _moving(made: Made, child: str) -> set[str]:
    """Bodies that go along with one."""
    moving = {child}
    for _ in made.joints:
        moving |= {j.child for j in made.joints.values() if j.parent in moving}
    return moving


def _slid(joint: Joint, low: F64, high: F64, end: float) -> tuple[F64, F64]:
    way = end * _unit(joint)
    return np.minimum(low, low + way).min(0)[None], np.maximum(high, high + way).max(0)[None]


def _unit(joint: Joint) -> F64:
    axis = np.array(joint.axis, dtype=np.float64)
    return np.asarray(axis / np.linalg.norm(axis))


def _turned(joint: Joint, low: F64, high: F64, end: float) -> tuple[F64, F64]:
    """Boxes of what turns between every two positions."""
    axis, anchor = _unit(joint), np.array(joint.anchor, dtype=np.float64)
    low, high = _cut(low - anchor, high - anchor, int(np.abs(axis).argmax()))
    corners = np.array([[(low, high)[k][:, n] for n, k in enumerate(which)] for which in np.ndindex(2, 2, 2)])
    points = corners.transpose(2, 0, 1)
    radius = float(np.linalg.norm(np.cross(points, axis), axis=2).max())
    count = max(2, math.ceil(abs(end) * radius / TRAVEL) + 1)
    positions = np.linspace(0.0, end, count)
    lows, highs = [], []
    for q in positions:
        turn = np.array([math.cos(q / 2), *(math.sin(q / 2) * axis)])
        at = RigidPose(np.zeros(3), turn).apply(points.reshape(-1, 3)).reshape(points.shape)
        lows.append(at.min(1))
        highs.append(at.max(1))
    bulge = radius * (1.0 - math.cos(abs(end) / (count - 1) / 2))
    one = [np.minimum(a, b) - bulge + anchor for a, b in itertools.pairwise(lows)]
    two = [np.maximum(a, b) + bulge + anchor for a, b in itertools.pairwise(highs)]
    return np.concatenate(one), np.concatenate(two)


def _cut(low: F64, high: F64, along: int) -> tuple[F64, F64]:
    """Boxes cut on a grid across an axis; those of one cell are one box."""
    across = [k for k in range(3) if k != along]
    found: dict[tuple[int, int], tuple[F64, F64]] = {}
    for a, b in zip(low, high, strict=True):
        for cell in _cells(a[across], b[across]):
            one, two = a.copy(), b.copy()
            one[across] = np.maximum(a[across], np.array(cell) * PIECE)
            two[across] = np.minimum(b[across], (np.array(cell) + 1) * PIECE)
            if cell in found:
                one, two = np.minimum(one, found[cell][0]), np.maximum(two, found[cell][1])
            found[cell] = one, two
    return np.array([b[0] for b in found.values()]), np.array([b[1] for b in found.values()])


def _cells(low: F64, high: F64) -> Iterator[tuple[int, int]]:
    first, last = np.floor(low / PIECE).astype(int), np.ceil(high / PIECE).astype(int)
    for i in range(int(first[0]), max(int(first[0]) + 1, int(last[0]))):
        for j in range(int(first[1]), max(int(first[1]) + 1, int(last[1]))):
            yield i, j
