"""Thickness of what stands in a liquid, against its spacing (R58).

Wet at frame 0 is what the declared volume touches: judged at the static stage, for good. Wet later is what particles came
to, which is decided when the frames asked for are there: until then a part that seems thin keeps the row open and fails nothing.

What another solid covers is not wet. Of a breakable body the wall of the whole counts, as it was built: cut edges of its pieces are
covered while bonds hold, and the edges of loose shards are no walls.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.probe_length import probe_frames
from ...rows.corrections import thicken
from ...rows.findings import Finding
from .bounds import EDGES, FACETS, LEAST_WALL, WIDE_BODY
from .corrections import refine
from .rows import place
from .samples import scattered
from .solids import Piece, deepest, pieces_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from .declared import Declared
    from .throats import Visited

__all__ = ["obstacles_finding"]

SOME = 1000
"""Places of a part at which its thickness is measured."""
LEVELS = 16
"""Depths at which it is asked whether a place is still inside, up to twice what is needed."""
POSES = 6
"""Frames between the poses at which a moving solid is looked at."""
COVERED = 0.05
"""[spacings] A place whose surroundings are another solid's this far out is covered by it."""


class _Wet(Protocol):
    """Where liquid is or was."""

    def at(self, points: F64) -> NDArray[np.bool_]:
        """True for points at which it is, shape (n,)."""


class _Thin(NamedTuple):
    """The thinnest wet part."""

    piece: Piece
    value: float
    """Thickness that all but EDGES of its wet surface reach [spacings]."""
    where: list[float]
    frame: int
    wet: int
    """Wet places."""
    parts: int
    """Wet parts that were looked at."""


def obstacles_finding(liquid: Declared, visited: Visited | None = None) -> Finding:
    """Finding on all parts that are wet at frame 0, and on those that particles came to.

    Args:
        liquid: as it is declared.
        visited: where particles have been; None before any motion.
    """
    bound = LEAST_WALL[liquid.plan.engine]
    box = liquid.box
    found = None if box is None else _thinnest(liquid, liquid, *box, later=False)
    after = None if visited is None or _short(found, bound) else _thinnest(liquid, visited, visited.low, visited.high, later=True)
    if after is not None and (found is None or after.value < found.value):
        unseen = _unseen(liquid.candidate)
        if unseen is not None and _short(after, bound):
            name = f"{after.piece.entity}/{after.piece.part}"
            text = f"{name} is {after.value:.3g} spacings thick where liquid came up to frame {unseen[0]}; later frames decide"
            return Finding("unverified", text, after.value, bound, "spacings", comparison=">=", frames=(0, unseen[1]))
        found = after
    if found is None:
        return Finding("not_applicable", "no fixed solid is wet")
    s, name = liquid.spacing, f"{found.piece.entity}/{found.piece.part}"
    most = "or more " if found.value >= 2.0 * bound else ""
    text = f"the thinnest of {found.parts} wet parts, {name}, is {found.value * s:.3g} m {most}thick about {found.where}, {found.value:.3g} spacings of {s:g} m"
    evidence = {"place": found.where, "part": found.piece.part, "parts": found.parts, "wet_places": found.wet}
    if not _short(found, bound):
        return Finding("pass", text, found.value, bound, "spacings", comparison=">=", evidence=evidence)
    entity, thick = found.piece.entity, found.value * s
    hints = (
        thicken(entity, "the solid is thinner than the liquid resolves", f"{bound * s:.3g} m about {found.where}"),
        *((refine(liquid, "the spacing does not resolve the solid", thick / bound),) if thick > 0.0 else ()),
    )
    return Finding("fail", text, found.value, bound, "spacings", entity, found.frame, hints, evidence, ">=")


def _short(found: _Thin | None, bound: float) -> bool:
    return found is not None and found.value < bound * (1.0 - FACETS)


def _unseen(candidate: Candidate) -> tuple[int, int] | None:
    """Last frame that is there, and the last that is asked for; None where all of them are."""
    spec = candidate.spec
    asked = (probe_frames(spec) if candidate.stage == "probe" else spec.simulation.frames) - 1
    return (candidate.last_frame, asked) if candidate.last_frame < asked else None


def _thinnest(liquid: Declared, wet: _Wet, low: F64, high: F64, *, later: bool) -> _Thin | None:
    """The thinnest of the parts that meet a box of the world and are wet in it.

    Args:
        liquid: as it is declared.
        wet: where liquid is or was.
        low: least corner of the box [m].
        high: greatest corner.
        later: look at what moves at later frames too.
    """
    found = [t for piece in pieces_of(liquid.candidate) if (t := _thin(liquid, piece, wet, (low, high), later)) is not None]
    return min(found, key=lambda t: t.value)._replace(parts=len(found)) if found else None


def _thin(liquid: Declared, piece: Piece, wet: _Wet, box: tuple[F64, F64], later: bool) -> _Thin | None:
    """Thickness of one part at the first pose in which it is wet; None where it never is, or drifts with the liquid."""
    candidate, s = liquid.candidate, liquid.spacing
    contract = candidate.spec.entities[piece.entity]
    breaks = contract.breakable is not None
    if not piece.solid_through or (contract.motion == "dynamic" and _width(candidate, piece, whole=breaks) < WIDE_BODY * s):
        return None
    for frame in range(0, candidate.frame_count, POSES) if later and not piece.still else (0,):
        low, high = piece.box(frame)
        if (low > box[1]).any() or (high < box[0]).any():
            continue
        corner = np.array([[box[k >> a & 1][a] for a in range(3)] for k in range(8)])
        near = piece.local(corner, frame)
        local, facing = scattered(piece.solid, s, near.min(axis=0), near.max(axis=0))
        points, normals = piece.world(local, frame), facing @ piece.turn[frame].T
        rows = np.flatnonzero(wet.at(points + 0.5 * s * normals) | wet.at(points + s * normals))
        whole = 0 if breaks else frame
        points, normals = piece.world(local[rows], whole), facing[rows] @ piece.turn[whole].T
        free = np.ones(len(rows), dtype=bool)
        for other in deepest(pieces_of(candidate), points + COVERED * s * normals, whole, 0.0):
            free[other.rows] = False
        points, normals = points[free], normals[free]
        if len(points):
            some = np.unique(np.linspace(0, len(points) - 1, SOME).astype(np.intp))
            thick = _thickness(liquid, points[some], normals[some], whole)
            value = float(np.quantile(thick, EDGES, method="lower"))
            at = some[int(np.argmin(np.abs(thick - value)))]
            return _Thin(piece, value, place(points[at]), frame, len(points), 1)
    return None


def _width(candidate: Candidate, piece: Piece, *, whole: bool) -> float:
    """Second largest extent of a piece, or of the whole that it was built as a part of [m]."""
    if not whole:
        return float(sorted(piece.solid.upper - piece.solid.lower)[1])
    boxes = [p.box(0) for p in pieces_of(candidate) if p.entity == piece.entity]
    return float(sorted(np.max([b[1] for b in boxes], axis=0) - np.min([b[0] for b in boxes], axis=0))[1])


def _thickness(liquid: Declared, points: F64, outward: F64, frame: int) -> F64:
    """Distance that solids reach behind places of a surface [spacings], at most twice what is needed, shape (n,)."""
    s, bound = liquid.spacing, LEAST_WALL[liquid.plan.engine]
    reach = np.zeros(len(points))
    going = np.arange(len(points))
    for depth in np.linspace(0.0, 2.0 * bound, LEVELS + 1)[1:]:
        # Just within: a wall of exactly this depth reaches it.
        asked = points[going] - (depth * (1.0 - 0.5 * FACETS)) * s * outward[going]
        inside = np.zeros(len(going), dtype=bool)
        for found in deepest(pieces_of(liquid.candidate), asked, frame, -1e-3 * s):
            inside[found.rows] = True
        going = going[inside]
        reach[going] = depth
        if not len(going):
            break
    return reach
