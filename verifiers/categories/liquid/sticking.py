"""Liquid that stays where nothing bears it: on a wall, under a ceiling, in the air (R70).

- `sticks`: what neither liquid nor a solid bears from below leaves its place in the time that a fall, or a film of it, takes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ...rows.corrections import bake_again
from ...rows.findings import Finding
from ..soft_solids import soft_gaps
from .bounds import BEARING, BELOW, FEW_STUCK, FILM, STAYS_SECONDS, STAYS_SHARE, STAYS_WAY, STEEP, STUCK
from .corrections import ease, refine
from .questions import STICKING
from .rows import place
from .solids import deepest, pieces_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.requirements import Correction
    from ...rows.questions import Question
    from .frames import Frame, Liquid, Rows, Step

__all__ = ["Sticking"]


class Sticking:
    """Particles that should fall and stay."""

    questions: ClassVar[Mapping[str, Question]] = STICKING

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.pieces = pieces_of(liquid.candidate)
        g, s = liquid.strength, liquid.spacing
        self.seconds = max(STAYS_SECONDS, float(np.sqrt(2.0 * STAYS_WAY * s / (STAYS_SHARE * g)))) if g > 0.0 else np.inf
        """A fall goes on for so long before it is asked how far it went."""
        self.way = STAYS_SHARE * 0.5 * g * self.seconds**2 if g > 0.0 else np.inf
        self.judged = np.array([self._falls(m) for m in range(len(liquid.members))])
        """Which liquids are judged, by index of the members."""
        self.identity = np.zeros(0, dtype=np.int64)
        self.anchor = np.zeros((0, 3))
        self.since: NDArray[np.intp] = np.zeros(0, dtype=np.intp)
        self.patience = np.inf
        self.looks = self.most = self.total = 0
        self.stuck: set[int] = set()
        self.first: tuple[int, int, list[float], str] | None = None

    def _falls(self, member: int) -> bool:
        """True if drops of a spacing fall off: larger ones than surface tension holds do."""
        liquid = self.liquid
        if liquid.fields and liquid.fields[member]:  # it may be drawn to where it is, or blown
            return False
        tension = liquid.physics(liquid.members[member]).surface_tension
        return bool(liquid.strength * liquid.rest_density[member] * liquid.spacing**2 > tension)

    def _patience(self, frame: Frame) -> F64:
        """Time that particles get for leaving their place [s], shape (n,)."""
        liquid = self.liquid
        physics = [liquid.physics(m) for m in liquid.members]
        viscosity = np.array([p.viscosity for p in physics])[frame.fluid]
        heat = frame.others.get("particle/temperature")
        if heat is not None and len(heat) == frame.count:
            order = np.argsort(frame.others["particle/id"], kind="stable")
            rate, usual = (np.array([getattr(p, n) for p in physics])[frame.fluid] for n in ("activation", "temperature"))
            warm = np.maximum(np.asarray(heat, dtype=np.float64)[order], 1.0)
            viscosity = viscosity * np.exp(np.clip(rate * (1.0 / warm - 1.0 / usual), -50.0, 50.0))
        weight = liquid.rest_density[frame.fluid] * liquid.strength * liquid.spacing**2
        found = np.maximum(self.seconds, FILM * self.way * 3.0 * viscosity / weight)
        found[~self.judged[frame.fluid]] = np.inf
        return np.asarray(found)

    def see(self, step: Step) -> None:
        """Follow how long every particle has stayed in its place."""
        frame = step.now
        anchor, since = frame.position.copy(), np.full(frame.count, frame.index, dtype=np.intp)
        if step.before is not None and len(step.here):
            at = np.searchsorted(self.identity, frame.identity[step.here])
            stays = np.linalg.norm(frame.position[step.here] - self.anchor[at], axis=1) < self.way
            anchor[step.here[stays]], since[step.here[stays]] = self.anchor[at[stays]], self.since[at[stays]]
        self.identity, self.anchor, self.since = frame.identity, anchor, since
        every = max(1, round(0.5 * self.seconds / step.duration)) if np.isfinite(self.seconds) else 1
        if not frame.count or not np.isfinite(self.way) or (frame.index % every and frame.index != self.liquid.frames - 1):
            return
        self.total = max(self.total, frame.count)
        patience = self._patience(frame)
        self.patience = min(self.patience, float(patience.min()))
        rows = np.flatnonzero((frame.index - since) * step.duration >= patience)
        self.looks += 1
        rows = self._unborne(frame, rows)
        self.stuck |= set(frame.identity[rows].tolist())
        self.most = max(self.most, len(rows))
        if self.first is None and len(rows) > self._allowed(frame.count):
            where = frame.position[rows[int(np.argmin(since[rows]))]]
            self.first = (frame.index, len(rows), place(where), self._beside(where, frame.index))

    def _allowed(self, count: int) -> float:
        return max(float(FEW_STUCK), STUCK * count)

    def _unborne(self, frame: Frame, rows: Rows) -> Rows:
        """Those of the particles that neither other particles nor surfaces bear."""
        if not len(rows):
            return rows
        liquid = self.liquid
        rows = rows[~_over_others(frame.position, rows, liquid.up, liquid.pitch)]
        down = -liquid.up * liquid.spacing
        for share in (0.5, 1.0, BEARING):
            if len(rows):
                points = frame.position[rows] + share * down
                borne = self._beyond_closed(points)
                for found in deepest(self.pieces, points, frame.index, 0.0):
                    borne[found.rows] = True
                rows = rows[~borne]
        if len(rows):
            rows = rows[~self._on_surface(frame.position[rows], frame.index)]
        return rows[~_on_others(frame.position, rows, liquid.up, liquid.pitch)] if len(rows) else rows

    def _beyond_closed(self, points: F64) -> NDArray[np.bool_]:
        shut = np.array(self.liquid.closed).reshape(3, 2)
        low, high = points < self.liquid.lower, points > self.liquid.upper
        return np.asarray((low & shut[:, 0]).any(axis=1) | (high & shut[:, 1]).any(axis=1))

    def _on_surface(self, points: F64, index: int) -> NDArray[np.bool_]:
        """Which points have a surface beside and below them, or lie in a solid."""
        from ....geometry import distance_to_surface

        found = np.zeros(len(points), dtype=bool)
        reach = BEARING * self.liquid.spacing
        found |= np.isfinite(soft_gaps(self.liquid.candidate, self.liquid.solver, points, index, reach))
        for piece in self.pieces:
            low, high = piece.box(index)
            near = np.flatnonzero(((points >= low - reach) & (points <= high + reach)).all(axis=1) & ~found)
            if len(near):
                local = piece.local(points[near], index)
                gap = distance_to_surface(piece.solid, local)
                drop = (points[near] - piece.world(gap.point, index)) @ self.liquid.up
                found[near] = (gap.distance <= reach) & (drop >= STEEP * gap.distance) | (piece.depth(local) > 0.0)
        return found

    def _beside(self, point: F64, index: int) -> str:
        """`entity/part` whose surface is within reach of a point; empty where none is."""
        from ....geometry import distance_to_surface

        gaps = {
            f"{p.entity}/{p.part}": float(distance_to_surface(p.solid, p.local(point[None], index)).distance[0])
            for p in self.pieces
        }
        best = min(gaps, key=lambda n: gaps[n], default="")
        return best if best and gaps[best] <= BEARING * self.liquid.spacing else ""

    def findings(self) -> dict[str, Finding]:
        """Findings on the number of particles that stick, and where the first do."""
        liquid, seconds = self.liquid, (self.liquid.frames - 1) * self.liquid.duration
        if liquid.strength == 0.0:
            return {"sticks": Finding("not_applicable", "nothing falls without gravity")}
        if not self.judged.any():
            text = f"surface tension holds drops of {liquid.spacing:g} m, the spacing, on walls"
            return {"sticks": Finding("not_applicable", text)}
        if not self.looks or self.patience > seconds:
            wanted = "" if not np.isfinite(self.patience) else f": films of it take {self.patience:.3g} s to leave their place"
            return {
                "sticks": Finding("not_applicable", f"the sequence of {seconds:.3g} s is too short to tell what sticks{wanted}")
            }
        allowed = self._allowed(self.total)
        if self.first is None:
            text = f"at most {self.most} particles stay where nothing bears them"
            return {"sticks": Finding("pass", text, float(self.most), allowed, "1")}
        index, count, where, part = self.first
        entity = part.split("/")[0] or None
        spot = f"at {part}" if part else "in the air"
        text = (
            f"{count} particles stay {spot} at frame {index} where nothing bears them, e.g. at {where}, for {self.patience:.3g} s or longer; "
            f"at most {self.most} do"
        )
        hints: tuple[Correction, ...] = (
            ease(liquid, "the wall holds the liquid", "lower wall_friction (dfsph) or roughness (flip), and viscosity if it is too high",
                 "viscosity", settings=("wall_friction",)),
            refine(liquid, "liquid is caught in a corner or gap that its spacing does not resolve"),
            bake_again(),
        )  # fmt: skip
        evidence = {"place": where, "part": part, "particles": count, "cases": len(self.stuck)}
        return {"sticks": Finding("fail", text, float(self.most), allowed, "1", entity, index, hints, evidence)}


def _over_others(position: F64, rows: Rows, up: F64, pitch: float) -> NDArray[np.bool_]:
    """Which of the particles have another one in the nine cubes of one of the two layers below them."""
    base = _across(up)
    cell = np.floor(position @ base.T / pitch).astype(np.int64)
    cell -= cell.min(axis=0) - 2
    span = cell.max(axis=0) + 2
    key = (cell[:, 2] * span[0] + cell[:, 0]) * span[1] + cell[:, 1]
    taken = np.unique(key)
    found = np.zeros(len(rows), dtype=bool)
    for layer in (1, 2):
        for shift in (x * span[1] + y for x in (-1, 0, 1) for y in (-1, 0, 1)):
            open_ = np.flatnonzero(~found)
            wanted = key[rows[open_]] - layer * span[0] * span[1] + shift
            at = np.minimum(np.searchsorted(taken, wanted), len(taken) - 1)
            found[open_] = taken[at] == wanted
    return found


def _across(up: F64) -> F64:
    """Axes as rows, the last of them upwards."""
    side = np.eye(3)[int(np.argmin(np.abs(up)))]
    first = np.cross(up, side)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(up, first), up])


def _on_others(position: F64, rows: Rows, up: F64, pitch: float) -> NDArray[np.bool_]:
    """Which of the particles have another one below and beside them, within reach."""
    from scipy.spatial import cKDTree

    low, high = position[rows].min(axis=0) - BEARING * pitch, position[rows].max(axis=0) + BEARING * pitch
    near = position[((position >= low) & (position <= high)).all(axis=1)]
    pairs = cKDTree(position[rows]).sparse_distance_matrix(cKDTree(near), BEARING * pitch, output_type="coo_matrix")
    below = (position[rows[pairs.row]] - near[pairs.col]) @ up
    found = np.zeros(len(rows), dtype=bool)
    found[pairs.row[(below >= BELOW * pairs.data) & (below > 0.0)]] = True
    return found
