"""The wet maps that were made of a liquid, against its particles and the solids that it wets (R99).

- `wet`: what they call wet is what liquid is next to, as deep as they say; their places lie on the solids and leave none out; films
  elsewhere were carried there by wet surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.categories.liquid.wet import Texels, WetMap
from ....worlds.errors import EvidenceError
from ...rows.corrections import bake_again
from ...rows.findings import Finding
from .bounds import AREA, BEHIND, DEEP, OFF, OVER, SHALLOW, TOUCH, UNCOVERED
from .corrections import refine
from .questions import WETTED
from .rows import place
from .samples import scattered
from .solids import Piece, pieces_of
from .tracks import Carried

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Frame, Liquid, Step

__all__ = ["Wetted", "touched"]

WIDE, NARROW = 1.5, 0.6
"""[spacings] Radii of columns: what is wet lies no deeper than under the top of the wide one."""
GAP = 2.5
"""[spacings] of air that end a column of liquid."""
EVERY = 4
"""Frames between those that are looked at; every one's digest is."""
SOME = 200
"""Places of a frame whose depth is looked at."""
PROBES = 4000
"""Most points over one part at which it is asked whether a place is near."""


def touched(position: F64, points: F64, normals: F64, spacing: float) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
    """Which places have liquid next to their outer side, and the row of the nearest particle (the number of them where none is)."""
    from scipy.spatial import cKDTree

    if not len(position) or not len(points):
        return np.zeros(len(points), dtype=bool), np.full(len(points), len(position), dtype=np.intp)
    reach = TOUCH * spacing
    low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
    some = np.flatnonzero(((position >= low) & (position <= high)).all(axis=1))
    if not len(some):
        return np.zeros(len(points), dtype=bool), np.full(len(points), len(position), dtype=np.intp)
    gap, at = cKDTree(position[some], balanced_tree=False, compact_nodes=False).query(points, distance_upper_bound=reach)
    found = np.isfinite(gap)
    at = np.append(some, len(position))[at]
    rows = np.flatnonzero(found)
    found[rows] = np.einsum("ij,ij->i", position[at[rows]] - points[rows], normals[rows]) >= -BEHIND * spacing
    return found, np.asarray(at, dtype=np.intp)


@dataclass
class _Worst:
    """The worst of one kind so far."""

    value: float = 0.0
    frame: int = 0
    entity: str = ""
    where: tuple[float, ...] = ()

    def add(self, value: float, frame: int, entity: str, where: list[float]) -> None:
        if value > self.value:
            self.value, self.frame, self.entity, self.where = value, frame, entity, tuple(where)


class Wetted:
    """Wet maps of every frame."""

    questions: ClassVar[Mapping[str, Question]] = WETTED

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.map = WetMap(liquid.cache)
        self.count = self.map.count()
        self.area, self.deep, self.flat, self.bare, self.track = (_Worst() for _ in range(5))
        self.looked = 0
        if not self.count:
            return
        if self.count < liquid.frames:
            raise EvidenceError(f"the liquid has {self.count} of {liquid.frames} wet maps; bake again to resume")
        self.known = known = {(p.entity, p.body, p.part): p for p in pieces_of(liquid.candidate)}
        texels = self.map.texels
        alien = [n for n in texels.parts if n not in known]
        if alien:
            raise EvidenceError(f"wet maps are of {'/'.join(alien[0])}, which the world does not have; bake again")
        self.pieces = [known[n] for n in texels.parts]
        self.groups = [np.flatnonzero(texels.part == k) for k in range(len(self.pieces))]
        self.own = dict(zip(texels.parts, self.groups, strict=True))
        self.carried = Carried(texels, self.pieces, self.groups, liquid.candidate.spec.simulation.limits.contact_gap)
        self.probes = {n: _probes(p, liquid, texels.size) for n, p in known.items()}

    def see(self, step: Step) -> None:
        """Compare one frame."""
        frame = step.now
        if not self.count:
            return
        held = self.map.read(frame.index)
        film, entity, where = self.carried.see(frame.index, held)
        self.track.add(film, frame.index, entity, place(where))
        if frame.index % EVERY and frame.index != self.liquid.frames - 1:
            return
        self.looked += 1
        self._compare(frame, held)
        if frame.index % (2 * EVERY) == 0:
            self._cover(frame)

    def _compare(self, frame: Frame, held: Mapping[str, Any]) -> None:
        texels, s = self.map.texels, self.liquid.spacing
        said = np.zeros(len(texels.area), dtype=bool)
        said[held["wet/texel"]] = True
        deep = np.full(len(said), np.nan)
        deep[held["wet/texel"]] = held["wet/depth"]
        wrong, union, worst = 0.0, 0.0, (0.0, "", np.zeros(3))
        looked: list[tuple[F64, NDArray[np.intp], F64]] = []
        for piece, mine in zip(self.pieces, self.groups, strict=True):
            points, normals = _placed(piece, texels, mine, frame.index)
            wet, at = touched(frame.position, points, normals, s)
            if not _shown(self.liquid, piece.entity, frame.index):
                wet[:] = False
            off = wet != said[mine]
            own = texels.area[mine]
            union += float(own[wet | said[mine]].sum())
            wrong += float(own[off].sum())
            if off.any() and own[off].sum() > worst[0]:
                worst = (float(own[off].sum()), piece.entity, points[int(np.flatnonzero(off)[0])])
            both = np.flatnonzero(wet & said[mine])
            both = both[np.unique(np.linspace(0, len(both) - 1, SOME).astype(np.intp))] if len(both) else both
            looked.append((points[both], at[both], deep[mine[both]]))
        self.area.add(wrong / max(union, 16.0 * texels.size**2), frame.index, worst[1], place(worst[2]))

        points, at, said_deep = (np.concatenate([x[k] for x in looked]) for k in range(3))
        if len(points) >= 16:
            more = said_deep - self._depths(frame, points, at, WIDE)
            less = self._depths(frame, points, at, NARROW) - said_deep
            self.deep.add(float(more.max()) / s, frame.index, "", place(points[int(np.argmax(more))]))
            self.flat.add(float((less > DEEP * s).mean()), frame.index, "", place(points[int(np.argmax(less))]))

    def _depths(self, frame: Frame, points: F64, at: NDArray[np.intp], radius: float) -> F64:
        """Depth of places under the top of the column of so many spacings about their nearest particle [m]."""
        from scipy.spatial import cKDTree

        up, s = self.liquid.up, self.liquid.spacing
        height = frame.position @ up
        flat = frame.position - height[:, None] * up
        rows, which = np.unique(at, return_inverse=True)
        tops = np.zeros(len(rows))
        for k, near in enumerate(cKDTree(flat).query_ball_point(flat[rows], radius * s)):
            column = np.sort(height[near])
            column = column[column >= height[rows[k]]]
            gap = np.flatnonzero(np.diff(column) > GAP * s)
            tops[k] = column[gap[0]] if len(gap) else column[-1]
        return np.maximum(0.0, tops[which.reshape(-1)] + 0.5 * self.liquid.pitch - points @ up)

    def _cover(self, frame: Frame) -> None:
        """Wet places of the surfaces themselves that no place of the map is near."""
        from scipy.spatial import cKDTree

        texels = self.map.texels
        for (entity, body, part), (points, normals) in self.probes.items():
            if not len(points) or not _shown(self.liquid, entity, frame.index):
                continue
            piece = self.known[entity, body, part]
            world, outward = piece.world(points, frame.index), normals @ piece.turn[frame.index].T
            wet, _ = touched(frame.position, world, outward, self.liquid.spacing)
            if wet.sum() < 16:
                continue
            rows = self.own.get((entity, body, part), np.zeros(0, dtype=np.intp))
            gap = cKDTree(texels.position[rows]).query(points[wet])[0] if len(rows) else np.full(int(wet.sum()), np.inf)
            bare = gap > 3.0 * texels.size
            if bare.any():
                self.bare.add(float(bare.mean()), frame.index, entity, place(world[wet][int(np.argmax(gap))]))

    def findings(self) -> dict[str, Finding]:
        """Judge whether the maps are right."""
        if not self.count:
            return {"wet": Finding("not_applicable", "no wet map was made: no solid meets the domain, or it is of an older bake")}
        off = self._off()
        checks = (
            (off, OFF, "distance of its places from the surfaces they are said to be on [m]"),
            (self.bare, UNCOVERED, "share of a wet surface without a place of the map nearby"),
            (self.area, AREA, "share of the wet area that the map calls dry, or the other way round"),
            (self.deep, OVER, "depth of a wet place over that of all liquid about it [spacings]"),
            (self.flat, SHALLOW, f"share of wet places that are said to lie {DEEP:g} spacings less deep than they do"),
            (self.track, 0.0, "film of a track that no wet surface near it can have left"),
        )
        hints = (
            refine(self.liquid, "the edge of what is wet lies within what a spacing tells"),
            bake_again("the wet map is not that of the particles"),
        )
        for worst, bound, what in checks:
            if worst.value > bound:
                where, on = list(worst.where), f" on {worst.entity}" if worst.entity else ""
                text = f"{what} is {worst.value:.3g} at frame {worst.frame}, about {where}{on}, allowed {bound:g}"
                unit = "m" if worst is off else "1"
                return {
                    "wet": Finding(
                        "fail", text, worst.value, bound, unit, worst.entity or None, worst.frame, hints, {"place": where}
                    )
                }
        text = f"wet maps differ from the particles on {self.area.value:.2g} of the wet area at most ({self.looked} frames looked at)"
        return {"wet": Finding("pass", text, self.area.value, AREA, "1")}

    def _off(self) -> _Worst:
        from ....geometry import distance_to_surface

        worst, texels = _Worst(), self.map.texels
        for piece, mine in zip(self.pieces, self.groups, strict=True):
            some = mine[np.unique(np.linspace(0, len(mine) - 1, SOME).astype(np.intp))] if len(mine) else mine
            if len(some):
                gap = distance_to_surface(piece.solid, texels.position[some]).distance - 1e-6 * piece.solid.size
                worst.add(
                    float(gap.max()), 0, piece.entity, place(piece.world(texels.position[some[[int(np.argmax(gap))]]], 0)[0])
                )
        return worst


def _placed(piece: Piece, texels: Texels, rows: NDArray[np.intp], frame: int) -> tuple[F64, F64]:
    return piece.world(texels.position[rows], frame), texels.normal[rows] @ piece.turn[frame].T


def _shown(liquid: Liquid, entity: str, frame: int) -> bool:
    interval = liquid.candidate.spec.entities[entity].active
    return interval is None or interval[0] <= frame <= interval[1]


def _probes(piece: Piece, liquid: Liquid, size: float) -> tuple[F64, F64]:
    """Points over a part where the liquid may get, in its body's frame, and the normals there."""
    low, high = (x + m * liquid.spacing for x, m in zip(liquid.extent, (-1.0, 1.0), strict=True))
    if not np.isfinite(low).all():
        return np.zeros((0, 3)), np.zeros((0, 3))
    if piece.still:
        corner = np.array([[(low, high)[k >> a & 1][a] for a in range(3)] for k in range(8)])
        near = piece.local(corner, 0)
        points, normals = scattered(piece.solid, 2.0 * size, near.min(axis=0), near.max(axis=0))
    else:
        points, normals = scattered(piece.solid, 2.0 * size, piece.solid.lower, piece.solid.upper)
    some = (
        np.unique(np.linspace(0, len(points) - 1, min(PROBES, len(points))).astype(np.intp))
        if len(points)
        else np.zeros(0, np.intp)
    )
    return points[some], normals[some]
