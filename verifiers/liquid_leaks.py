"""Liquid that got to the other side of a surface although no way leads there that it could take (R73, R99).

Space around each barrier (all solids that stand still together, and every moving body in its own frame) is cut into cubes of
half a spacing. Cubes that a surface passes through are closed, and with them every gap narrower than a cube: liquid of this
spacing is not resolved there. A particle whose straight way since it was last in an open cube leads through closed ones has
leaked where no open cubes connect both ends nearby, within the length of that way and a few spacings around it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64
from .findings import Finding
from .liquid_rows import coarse, longer_step, place
from .liquid_samples import samples
from .liquid_solids import Piece, pieces_of
from .verdicts import correction

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .liquid_frames import Liquid, Rows, Step

__all__ = ["LEAKED", "OFF", "Barrier", "Leaks", "liquid_space", "still_barrier"]

CUBE = 0.5
"""[spacings] Size of a cube."""
THICK = 0.35
"""[cubes] Surfaces are sampled on both sides at this distance too, so that no chain of cubes slips between samples."""
MOST_CUBES = 48_000_000
"""Own choice: larger spaces get larger cubes."""
MARGIN = 4.0
"""[spacings] of space around the places where liquid is."""
OFF = np.array([0.37, 0.41, 0.43])
"""[cubes] by which the corner of a space lies off the planes that people build on."""
LEAKED = 1e-4
"""Own choice: share of the liquid's particles that may have passed a surface; never less than one."""
SLACK = 6
"""[cubes] How far around a particle's way another one is searched, at least."""
POCKET = 64
"""[cubes] Open spaces smaller than this, between surfaces that nearly touch, count as closed: no liquid is resolved in them."""
PATIENCE = 6
"""Frames after which particles that stay next to a surface are asked on which side they are."""
SOME = 2000
"""Most ways searched per barrier and frame; further ones count like these in proportion."""


@dataclass(frozen=True, eq=False)
class Barrier:
    """Solids that keep their places among each other, in a frame of their own."""

    pieces: tuple[Piece, ...]
    low: F64
    """Least corner of the space around them [m], in their frame."""
    high: F64
    cube: float

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Cubes along each axis."""
        return tuple(int(n) for n in np.maximum(np.ceil((self.high - self.low) / self.cube), 1))

    @cached_property
    def closed(self) -> NDArray[np.bool_]:
        """Cubes that a surface passes through."""
        grid = np.zeros(self.shape, dtype=bool)
        for piece in self.pieces:
            points, normals = samples(piece.solid, 0.5 * self.cube, *self._local_box(piece))
            for away in (-THICK, 0.0, THICK):
                for start in range(0, len(points), 1_000_000):
                    part = slice(start, start + 1_000_000)
                    cell, inside = self.cells(self._placed(piece, points[part] + away * self.cube * normals[part]))
                    grid[tuple(cell[inside].T)] = True
        return _filled(grid)

    def _local_box(self, piece: Piece) -> tuple[F64, F64]:
        if not self.world:
            return self.low, self.high
        corner = np.array([[(self.low, self.high)[k >> a & 1][a] for a in range(3)] for k in range(8)])
        local = piece.local(corner, 0)
        return local.min(axis=0), local.max(axis=0)

    @property
    def world(self) -> bool:
        """Whether its frame is the world."""
        return self.pieces[0].still

    def _placed(self, piece: Piece, points: F64) -> F64:
        return piece.world(points, 0) if self.world else points

    def own(self, points: F64, frame: int) -> F64:
        """World points in the barrier's frame."""
        return points if self.world else self.pieces[0].local(points, frame)

    def cells(self, points: F64) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """Cubes of points, shape (n, 3), and which lie in the space."""
        cell = np.floor((points - self.low) / self.cube).astype(np.intp)
        return cell, np.asarray(((cell >= 0) & (cell < np.array(self.shape))).all(axis=1))

    def is_closed(self, points: F64) -> NDArray[np.bool_]:
        """Which points lie in closed cubes; outside of the space nothing is closed."""
        cell, inside = self.cells(points)
        result = np.zeros(len(points), dtype=bool)
        result[inside] = self.closed[tuple(cell[inside].T)]
        return result

    def nearest(self, point: F64) -> Piece:
        """The piece whose surface is nearest to a point of the barrier's frame."""
        from ..geometry import distance_to_surface

        local = [(p.local(point[None], 0) if self.world else point[None]) for p in self.pieces]
        near = [
            p
            for p, x in zip(self.pieces, local, strict=True)
            if ((x[0] >= p.solid.lower - 8 * self.cube) & (x[0] <= p.solid.upper + 8 * self.cube)).all()
        ]
        chosen = near or list(self.pieces)
        return min(
            chosen,
            key=lambda p: float(distance_to_surface(p.solid, p.local(point[None], 0) if self.world else point[None]).distance[0]),
        )


@dataclass
class _Waiting:
    """Particles in closed cubes, and where they were last in an open one, or the one next to where they began (barrier's frame)."""

    identity: NDArray[np.int64]
    position: F64


class Leaks:
    """Ways of particles through surfaces."""

    claims: ClassVar[Mapping[str, str]] = {
        "leak": f"no liquid gets to the other side of a surface where no resolved way leads; at most {LEAKED:g} of the particles"
    }

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.barriers: list[Barrier] | None = None
        self.waiting: dict[int, _Waiting] = {}
        self.known: dict[tuple[int, ...], bool] = {}
        self.leaks: list[tuple[int, int, Barrier, F64, NDArray[np.int64]]] = []
        self.particles = 0
        self.leaked: set[int] = set()

    def _make(self) -> list[Barrier]:
        """Barriers that reach into the space that the liquid fills at some frame."""
        space = liquid_space(self.liquid)
        if space is None:
            return []
        low, high, cube = space
        margin = MARGIN * self.liquid.spacing
        pieces = pieces_of(self.liquid.candidate)
        still = still_barrier(self.liquid)
        made = [still] if still is not None else []
        for key in dict.fromkeys((p.entity, p.body) for p in pieces if not p.still):
            mine = tuple(p for p in pieces if (p.entity, p.body) == key)
            least = np.min([p.solid.lower for p in mine], axis=0) - margin
            most = np.max([p.solid.upper for p in mine], axis=0) + margin
            size = max(cube, float(np.cbrt(np.prod(most - least) / MOST_CUBES)))
            if any(_meet(p.box(k), (low, high)) for p in mine for k in range(0, self.liquid.frames, 4)):
                made.append(Barrier(mine, least - OFF * size, most, size))
        return made

    def see(self, step: Step) -> None:
        """Follow every particle by one frame."""
        if self.barriers is None:
            self.barriers = self._make()
        self.particles = max(self.particles, step.now.count)
        for number, barrier in enumerate(self.barriers):
            self._follow(number, barrier, step)

    def _follow(self, number: int, barrier: Barrier, step: Step) -> None:
        frame, before = step.now, step.before
        here = barrier.own(frame.position, frame.index)
        near = ((here >= barrier.low) & (here <= barrier.high)).all(axis=1)
        held = self.waiting.get(number, _Waiting(np.zeros(0, dtype=np.int64), np.zeros((0, 3))))
        start = np.full((frame.count, 3), np.nan)
        if before is not None:
            then = barrier.own(before.position[step.there], before.index)
            start[step.here] = then
            start[step.here[barrier.is_closed(then)]] = np.nan
            where = np.searchsorted(frame.identity, held.identity)
            found = (
                (where < frame.count) & (frame.identity[np.minimum(where, max(frame.count - 1, 0))] == held.identity)
                if frame.count
                else np.zeros(len(held.identity), dtype=bool)
            )
            start[where[found]] = held.position[found]
        shut = np.zeros(frame.count, dtype=bool)
        shut[near] = barrier.is_closed(here[near])
        lost = np.flatnonzero(shut & np.isnan(start[:, 0]))
        start[lost] = _beside(barrier, here[lost])
        keep = shut & ~np.isnan(start[:, 0])
        self.waiting[number] = _Waiting(frame.identity[keep], start[keep])
        rows = np.flatnonzero(~shut & ~np.isnan(start[:, 0]))
        reach = np.maximum(
            np.minimum(start[rows], here[rows]) - barrier.high, barrier.low - np.maximum(start[rows], here[rows])
        ).max(axis=1, initial=-np.inf)
        self._judge(number, barrier, frame.index, rows[reach <= 0.0], start, here, frame.identity)
        if frame.index % PATIENCE == 0 or frame.index == self.liquid.frames - 1:
            # What stays in closed cubes is where the nearest open one is.
            rows = np.flatnonzero(keep)
            here = here.copy()
            here[rows] = _beside(barrier, here[rows])
            self._judge(number, barrier, frame.index, rows[~np.isnan(here[rows, 0])], start, here, frame.identity)

    def _judge(
        self, number: int, barrier: Barrier, index: int, rows: Rows, start: F64, here: F64, identity: NDArray[np.int64]
    ) -> None:
        through = rows[_blocked(barrier, start[rows], here[rows])]
        if len(through) > SOME:
            through = through[np.linspace(0, len(through) - 1, SOME).astype(np.intp)]
        bad = [
            r for r in through if int(identity[r]) not in self.leaked and not self._connected(number, barrier, start[r], here[r])
        ]
        if bad:
            self.leaked |= set(identity[bad].tolist())
            middle = np.array([_middle(barrier, start[r], here[r]) for r in bad])
            self.leaks.append((index, len(bad), barrier, middle, identity[bad]))

    def _connected(self, number: int, barrier: Barrier, a: F64, b: F64) -> bool:
        """Whether open cubes lead from one point to the other nearby; ways between the same cubes are searched once."""
        ends, _ = barrier.cells(np.stack([a, b]))
        key = (number, *ends.ravel().tolist())
        if key not in self.known:
            self.known[key] = _joined(barrier, ends, SLACK) or _joined(
                barrier, ends, SLACK + int(np.abs(ends[1] - ends[0]).max())
            )
        return self.known[key]

    def findings(self) -> dict[str, Finding]:
        """How many particles leaked, and where most did."""
        if not self.barriers:
            return {"leak": Finding("not_applicable", "no solid reaches to where the liquid is")}
        bound = max(1.0, np.floor(LEAKED * self.particles))
        count = float(len(self.leaked))
        if count <= bound:
            text = f"{count:.0f} of {self.particles} particles passed a surface (allowed {bound:.0f})"
            return {"leak": Finding("pass", text, count, bound, "1")}
        index, gap, piece, sizes = self._gap()
        where = place(gap)
        name = f"{piece.entity}/{piece.part}"
        text = (
            f"{count:.0f} of {self.particles} particles passed through {name} where no way of a spacing ({self.liquid.spacing:g} m) leads, "
            f"first at frame {index}, most about {where}"
        )
        hints = (
            correction(f"{name} has a gap or a hole there", "shape", f"close {piece.entity} about {where}, or widen the way to at least "
                       f"{3 * self.liquid.spacing:.3g} m", pointers=(f"/entities/{piece.entity}/parts",)),
            longer_step(self.liquid, "particles run through the wall in a step"),
            coarse(self.liquid, "the wall is thinner than the liquid resolves"),
        )  # fmt: skip
        evidence: dict[str, Any] = {"place": where, "collider": piece.entity, "part": piece.part, "gap_extent": sizes,
                                    "per_frame": [[i, n] for i, n, *_ in self.leaks[:20]], "share": count / max(self.particles, 1)}  # fmt: skip
        return {"leak": Finding("fail", text, count, bound, "1", piece.entity, index, hints, evidence)}

    def _gap(self) -> tuple[int, F64, Piece, list[float]]:
        """First frame, place of the densest cluster of crossings in the world, the piece there and the cluster's extent."""
        index, _, barrier, _, _ = max(self.leaks, key=lambda e: e[1])
        mine = [(i, m) for i, _, b, m, _ in self.leaks if b is barrier]
        points = np.concatenate([m for _, m in mine])
        cell = np.floor(points / (4.0 * barrier.cube))
        _, which, count = np.unique(cell, axis=0, return_inverse=True, return_counts=True)
        middle = np.median(points[which.reshape(-1) == int(np.argmax(count))], axis=0)
        near = points[(np.abs(points - middle) <= 8.0 * barrier.cube).all(axis=1)]
        world = middle if barrier.world else barrier.pieces[0].world(middle[None], index)[0]
        return self.leaks[0][0], world, barrier.nearest(middle), place(np.ptp(near, axis=0))


def liquid_space(liquid: Liquid) -> tuple[F64, F64, float] | None:
    """Corners of the space about all places where a liquid's particles are [m], and the size of its cubes; None without any."""
    low, high = liquid.extent
    if not np.isfinite(low).all():
        return None
    margin = MARGIN * liquid.spacing
    low, high = (np.clip(x, liquid.lower - margin, liquid.upper + margin) for x in (low - margin, high + margin))
    return low, high, max(CUBE * liquid.spacing, float(np.cbrt(np.prod(high - low) / MOST_CUBES)))


def still_barrier(liquid: Liquid) -> Barrier | None:
    """All solids that stand still where the liquid gets to, made once per liquid; None where there are none."""
    store: dict[str, Barrier | None] = vars(liquid).setdefault("_barriers", {})
    if "still" not in store:
        space = liquid_space(liquid)
        still = () if space is None else tuple(p for p in pieces_of(liquid.candidate) if p.still and _meet(p.box(0), space[:2]))
        # A corner off the planes that people build on, so that slits do not fall between cubes.
        store["still"] = Barrier(still, space[0] - OFF * space[2], space[1], space[2]) if space is not None and still else None
    return store["still"]


def _filled(grid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The grid with small open pockets closed."""
    from scipy.ndimage import label

    marks, count = label(~grid)
    small = np.bincount(marks.ravel(), minlength=count + 1) < POCKET
    small[0] = True
    return np.asarray(small[marks])


def _meet(a: tuple[F64, F64], b: tuple[F64, F64]) -> bool:
    return bool((a[0] <= b[1]).all() and (a[1] >= b[0]).all())


def _blocked(barrier: Barrier, start: F64, end: F64) -> NDArray[np.bool_]:
    """Which straight ways lead through closed cubes."""
    result = np.zeros(len(start), dtype=bool)
    steps = np.ceil(np.linalg.norm(end - start, axis=1) / (0.5 * barrier.cube)).astype(np.intp) + 1
    for low in 4 ** np.arange(0, 8):
        mine = np.flatnonzero((steps >= low) & (steps < 4 * low))
        for s in np.linspace(0.0, 1.0, 4 * int(low))[1:-1] if len(mine) else ():
            mine = mine[~result[mine]]
            result[mine] = barrier.is_closed(start[mine] + s * (end[mine] - start[mine]))
    return result


def _beside(barrier: Barrier, points: F64) -> F64:
    """Middle of the open cube nearest to each point in a closed one; NaN where none is within two cubes."""
    result = np.full(points.shape, np.nan)
    steps = np.stack(np.meshgrid(*[np.arange(-2, 3)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    cell, _ = barrier.cells(points)
    least = np.full(len(points), np.inf)
    for step in steps:
        middle = barrier.low + (cell + step + 0.5) * barrier.cube
        gap = np.linalg.norm(middle - points, axis=1)
        rows = np.flatnonzero(gap < least)
        rows = rows[~barrier.is_closed(middle[rows])]
        least[rows], result[rows] = gap[rows], middle[rows]
    return result


def _middle(barrier: Barrier, start: F64, end: F64) -> F64:
    """Middle of the closed cubes on a way."""
    count = int(np.ceil(np.linalg.norm(end - start) / (0.25 * barrier.cube))) + 2
    way = start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)
    return np.asarray(way[barrier.is_closed(way)].mean(axis=0))


def _joined(barrier: Barrier, ends: NDArray[np.intp], slack: int) -> bool:
    from scipy.ndimage import label

    low = np.maximum(ends.min(axis=0) - slack, 0)
    high = np.minimum(ends.max(axis=0) + slack + 1, barrier.shape)
    outside = (ends < 0) | (ends >= barrier.shape)
    if outside.any(axis=1).any():
        return True
    marks, _ = label(~barrier.closed[tuple(slice(a, b) for a, b in zip(low, high, strict=True))])
    a, b = (marks[tuple(e - low)] for e in ends)
    return bool(a == b and a > 0)
