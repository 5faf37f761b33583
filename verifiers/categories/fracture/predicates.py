"""Evaluators of predicates about bodies that break: from the log of bonds and the poses of pieces."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.bonds import components
from ....worlds.errors import EvidenceError
from ....worlds.predicates import Breach, Broken, Debris
from ...predicates.kinematic import region_offset
from ...predicates.outcome import Comparison, Outcome, Series, band, judge
from .frames import Frames

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import SpecModel
    from ...predicates.scope import Scope

__all__ = ["breach", "broken", "by_cause", "debris", "frames_of"]

P = TypeVar("P")
CELLS = 12
"""Cells across the shorter side of an opening that is asked for."""
SEEN = 3.0
"""The view reaches so many sizes of the opening to all sides of its point."""
THICK = 0.5
"""Pieces within this share of the body's thickness before and behind it can close an opening; those farther fly or lie."""


def _typed(predicate: SpecModel, kind: type[P]) -> P:
    assert isinstance(predicate, kind)
    return predicate


def frames_of(candidate: Candidate, entity: str) -> Frames:
    """Bonds and pieces of a breakable entity over the frames.

    Raises:
        EvidenceError: it is none, or no rigid instance moves it.
    """
    contract = candidate.spec.entities.get(entity)
    if contract is None:
        raise EvidenceError(f"entity {entity!r} is not in the specification")
    if contract.breakable is None:
        raise EvidenceError(f"{entity!r} is not breakable; give it breakable with a pattern and bonds")
    for solver, instance in candidate.spec.simulation.rigid.items():
        if entity in instance.members:
            return Frames(candidate, solver, entity)
    raise EvidenceError(f"no rigid instance moves {entity!r}; add it to members")


def broken(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: share of the bonds that broke since the interval began, by the cause that is asked for."""
    p = _typed(predicate, Broken)
    frames = frames_of(scope.candidate, p.entity)
    total = max(1, len(frames.bonds))
    first, last = scope.frames
    before = frames.broken(max(0, first - 1))
    value = np.array([float((frames.broken(f) & ~before).sum()) / total for f in range(first, last + 1)])
    if p.by is not None:
        value = by_cause(frames, p.entity, p.by, scope.frames)
    margin, side = band(value, p.min, p.max)

    def tell(i: int) -> str:
        by = "" if p.by is None else f" by {p.by}"
        return f"{value[i]:.1%} of the {total} bonds of {p.entity} were broken{by} at frame {first + i}"

    return judge(Series(scope.frames, value, margin, "1", p.entity, side, tell), p.when)


def by_cause(frames: Frames, entity: str, cause: str, span: tuple[int, int]) -> F64:
    """Share of an entity's bonds that broke since a span of frames began by one cause, or by pieces that it set in motion, per frame."""
    counted, shares = 0, []
    for f in range(span[0], span[1] + 1):
        for event in frames.breaks(f) if f else []:
            name = frames.collider(event.cause)
            counted += name == cause or (name == entity and counted > 0)
        shares.append(counted / max(1, len(frames.bonds)))
    return np.array(shares)


def debris(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: lumps of pieces still bonded, or single ones, that the world does not hold, were built in the region, and whose centre
    of mass lies farther than asked from where they were built, or along an axis of it."""
    p = _typed(predicate, Debris)
    frames = frames_of(scope.candidate, p.entity)
    rest = frames.rest_points(np.array([b.pose.position for b in frames.built.bodies]))
    mass = np.array([b.mass for b in frames.built.bodies])
    first, last = scope.frames
    needed = None if p.min is None else max(1, math.ceil(p.min))
    counts, most, apart = [], [], []
    for f in range(first, last + 1):
        position, _ = frames.poses(f)
        labels, fixed = components(len(rest), frames.bonds, ~frames.broken(f))
        built, moved = (_centers(labels, mass, x) for x in (rest, position - rest))
        far = np.linalg.norm(moved, axis=1) if p.axis is None else moved @ np.array(p.axis) / np.linalg.norm(p.axis)
        asked = ~fixed & _built_in(scope.candidate, p.region, built)
        off = asked & (far > p.min_distance)
        apart.append(np.sort(far[asked])[::-1])
        counts.append(float(off.sum()))
        most.append(int(off[labels].sum()))
    value = np.array(counts)
    margin, side = band(value, p.min, p.max)

    def tell(i: int) -> str:
        lumps = f"{value[i]:.0f} loose lumps of {p.entity} ({most[i]} of its {len(rest)} pieces)"
        where = "" if p.region is None else f", built in {p.region},"
        way = "off their place" if p.axis is None else f"along {list(p.axis)} of their place"
        return f"{lumps}{where} lay {p.min_distance:g} m {way} at frame {first + i}"

    def detail(i: int) -> dict[str, Any]:
        """Number of lumps that are loose, and the way of as many as asked for from their places [m]: at any frame, where one decides."""
        at = range(len(apart)) if p.when == "eventually" else [i]
        far = {k: float(apart[k][needed - 1]) for k in at if needed is not None and needed <= len(apart[k])}
        best = max(far, key=lambda k: far[k], default=None)
        if best is None or not np.isfinite(far[best]):
            return {"lumps": max(len(apart[k]) for k in at)}
        return {"lumps": len(apart[best]), "reached": far[best], "largest_frame": first + best}

    return judge(Series(scope.frames, value, margin, "1", p.entity, side, tell, detail), p.when)


def _centers(labels: NDArray[np.int32], mass: F64, points: F64) -> F64:
    """Mean of the pieces' points, weighted with their mass, per lump: shape (n, 3) -> (lumps, 3)."""
    total = np.bincount(labels, weights=mass)
    return np.stack([np.bincount(labels, weights=mass * c) for c in points.T], axis=1) / total[:, None]


def _built_in(candidate: Candidate, name: str | None, centers: F64) -> NDArray[np.bool_]:
    """Which lumps' centres lie in a region of the world; all where none is named."""
    if name is None:
        return np.ones(len(centers), dtype=bool)
    region = candidate.spec.graph.regions.get(name)
    if region is None or region.relative_to is not None:
        known = [n for n, r in candidate.spec.graph.regions.items() if r.relative_to is None]
        raise EvidenceError(f"debris is built in a region of the world; {name!r} is none of {known}: add it to graph.regions")
    return np.asarray(region_offset(region, centers)[0] >= 0.0)


def breach(scope: Scope, predicate: SpecModel) -> Outcome:
    """Measured: width [m] of the widest open rectangle of the asked height that holds the point, seen along the direction."""
    p = _typed(predicate, Breach)
    view = _View(frames_of(scope.candidate, p.entity), p)
    first, last = scope.frames
    value = np.array([view.width(f) for f in range(first, last + 1)])

    def side(i: int) -> tuple[float, Comparison]:
        del i
        return p.min_width, ">="

    def tell(i: int) -> str:
        return f"the opening of {p.entity} was {value[i]:.3g} m wide over a height of {p.min_height:g} m at frame {first + i}"

    return judge(Series(scope.frames, value, value - p.min_width, "m", p.entity, side, tell), p.when)


class _View:
    """Pieces of an entity as they cover a grid of points across a level direction."""

    def __init__(self, frames: Frames, predicate: Breach) -> None:
        self.frames, self.asked = frames, predicate
        along = np.array([predicate.direction[0], predicate.direction[1], 0.0])
        self.along = along / np.linalg.norm(along)
        self.axes = np.stack([np.cross([0.0, 0.0, 1.0], self.along), [0.0, 0.0, 1.0]])
        self.cell = min(predicate.min_width, predicate.min_height) / CELLS
        half = np.ceil(SEEN * np.array([predicate.min_width, predicate.min_height]) / self.cell).astype(int)
        self.middle = np.array([half[1], half[0]])
        across, up = (np.arange(-n, n + 1) * self.cell for n in half)
        origin = self.axes @ np.array(predicate.point)
        self.grid = np.stack([a.ravel() for a in np.meshgrid(origin[0] + across, origin[1] + up)], axis=1)
        self.shape = (len(up), len(across))
        bodies = frames.built.bodies
        self.hulls: list[F64] = [np.concatenate([q.render.vertices for q in frames.built.parts_of(b.name)]) for b in bodies]
        rest = np.concatenate([frames.rest_points(h + b.pose.position) for h, b in zip(self.hulls, bodies, strict=True)])
        depth = rest @ self.along
        thick = float(np.ptp(depth))
        self.slab = (float(depth.min()) - THICK * thick, float(depth.max()) + THICK * thick)
        self._kept: dict[int, tuple[F64, NDArray[np.bool_]]] = {}

    def _cover(self, piece: int, position: F64, turn: F64) -> NDArray[np.bool_]:
        """Which grid points a piece covers."""
        from scipy.spatial import ConvexHull

        key = np.concatenate([position, turn.ravel()])
        known = self._kept.get(piece)
        if known is not None and np.abs(known[0] - key).max() < 1e-9:
            return known[1]
        flat = (self.hulls[piece] @ turn.T + position) @ self.axes.T
        low, high = flat.min(axis=0), flat.max(axis=0)
        covered = ((self.grid >= low) & (self.grid <= high)).all(axis=1)
        if covered.any():
            planes = ConvexHull(flat).equations
            inside = self.grid[covered] @ planes[:, :2].T + planes[:, 2]
            covered[covered] = inside.max(axis=1) <= 0
        found: NDArray[np.bool_] = np.asarray(covered)
        self._kept[piece] = (key, found)
        return found

    def width(self, frame: int) -> float:
        """Width of the opening at a frame [m]; 0 where the point is covered or nothing is left to see."""
        position, turn = self.frames.poses(frame)
        near = position @ self.along
        taken = np.zeros(len(self.grid), dtype=bool)
        for piece in np.flatnonzero((near >= self.slab[0]) & (near <= self.slab[1])).tolist():
            taken |= self._cover(piece, position[piece], turn[piece])
        free: NDArray[np.bool_] = ~taken.reshape(self.shape)
        row, column = self.middle
        tall = max(1, round(self.asked.min_height / self.cell))
        widest = 0
        for start in range(max(0, row - tall + 1), min(row, self.shape[0] - tall) + 1):
            open_: NDArray[np.bool_] = np.asarray(free[start : start + tall].all(axis=0))
            if open_[column]:
                shut = np.flatnonzero(~open_)
                left, right = shut[shut < column].max(initial=-1), shut[shut > column].min(initial=self.shape[1])
                widest = max(widest, int(right - left - 1))
        return widest * self.cell
