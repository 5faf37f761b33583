"""Rivers in the water of a landscape: where they enter and leave a rectangle, and how fast they run in it (R38, R57).

Beds are cut for bankfull flow and filled to its level, so the water that is there runs with the bankfull discharge: its speed is
that over the area of each cross section, along the course.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.watercourses import centre_line
from ...worlds.arrays import F64
from ...worlds.landscape import SavedLandscape
from .grid import Grid
from .water import BANKFULL, GRAIN_M
from .waters import WaterBody

__all__ = ["BED_ROUGHNESS", "Course", "Gate", "river_courses", "river_gates"]

BED_ROUGHNESS = 6.8 * GRAIN_M / 30.0
"""Roughness length of the beds [m]: a thirtieth of the roughness height, which is 6.8 D_50 (Clifford et al. 1992)."""
CLEAR = (0.5, 0.6, 0.7, 0.8, 0.9)
"""Shares of the deepest place of a section that openings reach down to; the largest is taken. Banks stay free."""
INSET = 0.96
"""Size of an opening over that of the rectangle that fits."""
GRAVITY = 9.81
MOST_POINTS = 200
"""Most points of a course that a specification takes."""


@dataclass(frozen=True)
class Gate:
    """Where a river comes into a rectangle, or leaves it: an upright opening across it."""

    reach: int
    enters: bool
    center: tuple[float, float, float]
    direction: tuple[float, float]
    """Direction of the flow, horizontal unit vector."""
    size: tuple[float, float]
    """Width and height of the opening [m]: of one that enters, clear of the banks; of one that leaves, over all of the water."""
    discharge: float
    """At the level of the water, bankfull [m^3/s]."""


@dataclass(frozen=True)
class Course:
    """A river inside the rectangle, downstream."""

    reach: int
    points: F64
    """On the water's surface (n, 3) [m]."""
    speeds: F64
    """Discharge over area of the section (n,) [m/s]."""
    width: float
    """Twice the largest distance of its water from the course [m]."""


@dataclass(frozen=True)
class _Reach:
    number: int
    line: F64
    along: F64
    discharge: F64
    width: F64

    def runs(self, low: F64, high: F64) -> Iterator[tuple[int, int]]:
        """First and last point of every stay between two corners."""
        inside = ((self.line >= low) & (self.line <= high)).all(axis=1)
        edge = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int)))
        yield from zip(edge[::2].tolist(), (edge[1::2] - 1).tolist(), strict=True)


@dataclass(frozen=True)
class _Section:
    """Wet stretch across a river."""

    points: F64
    depth: F64
    level: float
    step: float

    @property
    def area(self) -> float:
        return float(self.depth.sum()) * self.step

    @property
    def width(self) -> float:
        return len(self.depth) * self.step

    def speed(self, discharge: float) -> float:
        """Speed of the flow, at most that of waves on the mean depth [m/s]."""
        return min(discharge / self.area, float(np.sqrt(GRAVITY * self.area / self.width)))

    def whole(self) -> tuple[F64, float, float, float]:
        """Middle, width, bottom and top of the rectangle around it."""
        return self.points.mean(axis=0), self.width, self.level - float(self.depth.max()), self.level

    def opening(self) -> tuple[F64, float, float, float]:
        """Middle, width, bottom and top of the largest rectangle that is clear of the banks."""
        middle = int(self.depth.argmax())
        runs = [_run(self.depth >= share * self.depth[middle], middle) for share in CLEAR]
        first, last = max(runs, key=lambda run: (run[1] - run[0]) * float(self.depth[run[0] : run[1] + 1].min()))
        bottom = self.level - float(self.depth[first : last + 1].min())
        return 0.5 * (self.points[first] + self.points[last]), (last - first) * self.step, bottom, self.level


def _run(flags: NDArray[np.bool_], at: int) -> tuple[int, int]:
    """Ends of the run of true values about a place."""
    before, after = np.flatnonzero(~flags[:at]), np.flatnonzero(~flags[at:])
    return (int(before[-1]) + 1 if len(before) else 0), (at + int(after[0]) - 1 if len(after) else len(flags) - 1)


def _reaches(land: SavedLandscape) -> Iterator[_Reach]:
    grid = Grid(*land.shape, land.cell)
    for number, reach in enumerate(land.about["reaches"]):
        cells = np.array(reach["cells"])
        if len(cells) < 2:
            continue
        share = np.linspace(0.0, 1.0, len(cells))
        first, last = reach["discharge"]
        wide = reach["width"]
        line = centre_line(cells, 0.5 * (wide[0] + wide[1]), grid.shape, grid.cell)
        along = np.gradient(line, axis=0)
        along /= np.maximum(np.linalg.norm(along, axis=1), 1e-9)[:, None]
        flow = BANKFULL * ((1 - share) * first + share * last)
        yield _Reach(number, line, along, flow, (1 - share) * wide[0] + share * wide[1])


class _Sections:
    """Cross sections of a body of water."""

    def __init__(self, body: WaterBody, cell: float) -> None:
        from scipy.interpolate import RegularGridInterpolator

        self.cell = cell
        self.low, self.high = np.array([body.x[0], body.y[0]]), np.array([body.x[-1], body.y[-1]])
        self._ground = RegularGridInterpolator((body.y, body.x), body.ground)
        self._level = RegularGridInterpolator((body.y, body.x), body.level)

    def at_side(self, reach: _Reach, k: int) -> tuple[F64, F64]:
        """Where a course that comes in before its point `k` crosses a side of the rectangle, and the way in, square to that side."""
        before, after = reach.line[k - 1], reach.line[k]
        step = after - before
        limit = np.where(step > 0, self.low, self.high)
        outside = (before < self.low) | (before > self.high)
        share = np.where(outside, (limit - before) / np.where(step == 0, 1.0, step), 0.0)
        axis = int(np.argmax(share))
        place = before + share[axis] * step
        place[axis] = limit[axis]
        along = np.zeros(2)
        along[axis] = np.sign(step[axis])
        return place, along

    def at(self, place: F64, along: F64, width: float) -> _Section | None:
        """The section at a point of a course; None where it is dry."""
        step = 0.05 * min(width, self.cell)
        offsets = np.arange(-2.0 * width - self.cell, 2.0 * width + self.cell, step)
        points = place + offsets[:, None] * np.array([along[1], -along[0]])
        inside = ((points >= self.low) & (points <= self.high)).all(axis=1)
        offsets, points = offsets[inside], points[inside]
        ground, level = (of(points[:, ::-1]) for of in (self._ground, self._level))
        depth = np.nan_to_num(level - ground, nan=-1.0)
        near = np.flatnonzero(np.abs(offsets) <= 0.5 * width + self.cell)
        if not len(near) or depth[near].max() <= 0:
            return None
        middle = int(near[depth[near].argmax()])
        first, last = _run(depth > 0, middle)
        return _Section(points[first : last + 1], depth[first : last + 1], float(level[middle]), step)


def river_gates(land: SavedLandscape, body: WaterBody, *, inset: float, flush: bool = False) -> list[Gate]:
    """Openings across the rivers that come into the rectangle or leave it.

    Args:
        land: the landscape.
        body: water of the rectangle.
        inset: how far inside the rectangle they are [m].
        flush: those that enter lie in the rectangle's side instead, square to it.
    """
    sections, found = _Sections(body, land.cell), []
    for reach in _reaches(land):
        ends: list[tuple[int, bool]] = []
        for first, last in reach.runs(sections.low + inset, sections.high - inset):
            ends += [(first, True)] * (first > 0 and not flush) + [(last, False)] * (last < len(reach.line) - 1)
        if flush:
            ends += [(first, True) for first, _ in reach.runs(sections.low, sections.high) if first > 0]
        for k, enters in ends:
            place, along = sections.at_side(reach, k) if enters and flush else (reach.line[k], reach.along[k])
            section = sections.at(place, along, float(reach.width[k]))
            if section is None:
                continue
            middle, width, bottom, top = section.opening() if enters else section.whole()
            size = (INSET * width, INSET * (top - bottom)) if enters else (width, top - bottom)
            if min(size) > 0:
                center = (float(middle[0]), float(middle[1]), 0.5 * (top + bottom))
                flow = float(reach.discharge[k])
                found.append(Gate(reach.number, enters, center, (float(along[0]), float(along[1])), size, flow))
    return found


def river_courses(land: SavedLandscape, body: WaterBody) -> list[Course]:
    """The rivers in the rectangle and their speeds: discharge over area, at most that of waves on their depth."""
    sections, found = _Sections(body, land.cell), []
    for reach in _reaches(land):
        for first, last in reach.runs(sections.low, sections.high):
            every = max(1, -(-(last - first) // (MOST_POINTS - 2)))
            stations = sorted({*range(first, last + 1, every), last})
            cut = [(k, sections.at(reach.line[k], reach.along[k], float(reach.width[k]))) for k in stations]
            wet = [(k, s) for k, s in cut if s is not None]
            if len(wet) < 2:
                continue
            speeds = [s.speed(float(reach.discharge[k])) for k, s in wet]
            points = np.array([[*reach.line[k], s.level] for k, s in wet])
            far = max(float(np.linalg.norm(s.points - reach.line[k], axis=1).max()) for k, s in wet)
            found.append(Course(reach.number, points, np.array(speeds), 2.0 * far))
    return found
