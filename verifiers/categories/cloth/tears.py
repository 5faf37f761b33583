"""Tears of cloth: none without a pull over the strength, and none missing where a pull stays over it.

The judge finds tensions anew, from places alone: the stretch of each triangle along its warp and its weft and the shear between
them, times the contract's stiffness, as a mean over the triangles around a vertex.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import F64, I32, pose_of
from ....worlds.categories.cloth.facts import tears
from ....worlds.categories.cloth.tears import Flags, Seams, following, seams_of, welded
from ....worlds.errors import EvidenceError
from ...rows.corrections import bake_again
from ...rows.findings import Finding
from .bounds import ALIGNED, OVER, REACH, SAME, UPRIGHT
from .frames import at_most

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .frames import ClothRun, Piece

__all__ = ["TearingPiece", "held_strength", "tearing_pieces", "torn_with_cause"]

CHANNELS = (
    "vertex/position",
    "edge/open",
    *(f"tear/{n}" for n in ("time", "corner", "tension", "cause", "side", "triangle", "place")),
)


class _Event(NamedTuple):
    time: float
    corner: int
    tension: float
    cause: int
    sides: I32
    """Indices among the part's corners (k, 2)."""
    triangles: I32
    places: F64


class TearingPiece:
    """One part of a sheet that can tear; corners are counted from its first."""

    def __init__(self, run: ClothRun, piece: Piece) -> None:
        physics = piece.physics
        assert physics.tear is not None
        self.run, self.piece, self.entity, self.rows = run, piece, piece.entity, piece.rows
        self.strength = physics.tear.strength
        stretch = physics.stretch_stiffness
        self.stiffness: F64 = np.array([stretch, physics.weft_stiffness or stretch, physics.shear_stiffness or 0.1 * stretch])
        self.seams: Seams = seams_of(piece.vertices)
        self.area = piece.area
        contract = run.candidate.spec.entities[piece.entity]
        pose, part = pose_of(contract.pose), pose_of(contract.parts[piece.part].pose)
        self.rest = pose.apply(piece.vertices).reshape(-1, 3, 3)
        warp = pose.apply(part.apply(np.array([[1.0, 0.0, 0.0]]))) - pose.apply(part.apply(np.zeros((1, 3))))
        self.inverse = self._material(warp[0])

    def _material(self, warp: F64) -> F64:
        """Inverse of each triangle's edges in its warp and weft (t, 2, 2)."""
        first, second = self.rest[:, 1] - self.rest[:, 0], self.rest[:, 2] - self.rest[:, 0]
        normal = np.cross(first, second)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        along = warp - np.outer(normal @ warp, np.ones(3)) * normal
        steep = np.linalg.norm(along, axis=1) < UPRIGHT
        other = np.roll(warp, 1)
        along[steep] = (other - np.outer(normal @ other, np.ones(3)) * normal)[steep]
        along /= np.linalg.norm(along, axis=1)[:, None]
        across = np.cross(normal, along)
        edges = np.stack([first, second], axis=2)
        return np.linalg.inv(np.einsum("atk,tkj->taj", np.stack([along, across]), edges))

    def stress(self, places: F64, triangles: I32 | slice = slice(None)) -> F64:
        """Tension tensors (m, 3, 3) [N/m] of triangles with corners at places (m, 3, 3) [m]."""
        edges = np.stack([places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]], axis=2)
        gradient = edges @ self.inverse[triangles]
        length = np.linalg.norm(gradient, axis=1)
        unit = gradient / length[:, None]
        slide = (unit[:, :, 0] * unit[:, :, 1]).sum(axis=1)
        force = self.stiffness * np.column_stack([length - 1.0, slide])
        inner = np.stack([force[:, 0], force[:, 2], force[:, 2], force[:, 1]], axis=1).reshape(-1, 2, 2)
        return np.asarray(unit @ inner @ unit.swapaxes(1, 2))

    def around(self, places: F64, label: I32) -> tuple[F64, F64]:
        """Tension at each vertex (n,) [N/m] and its direction (n, 3), with the part's triangles at places (t, 3, 3)."""
        count = int(label.max()) + 1
        weight, total = np.zeros(count), np.zeros((count, 3, 3))
        np.add.at(weight, label, np.repeat(self.area, 3))
        np.add.at(total, label, np.repeat(self.area[:, None, None] * self.stress(places), 3, axis=0))
        value, direction = np.linalg.eigh(total / weight[:, None, None])
        return value[:, 2], direction[:, :, 2]

    @cached_property
    def frames(self) -> list[tuple[F64, Flags, list[_Event]]]:
        """Per frame: corners (c, 3), open sides (c,) and tears."""
        return [self._frame(k) for k in range(self.run.candidate.frame_count)]

    def _frame(self, k: int) -> tuple[F64, Flags, list[_Event]]:
        data = self.run.cache.read(k, CHANNELS)
        rows, count = self.rows, sum(self.run.cache.index.vertices)
        if (
            data["edge/open"].shape != (count,)
            or len({len(data[f"tear/{n}"]) for n in ("time", "corner", "tension", "cause")}) != 1
        ):
            raise EvidenceError(f"the log of tears of frame {k} of {self.run.solver!r} is not whole; bake again")
        found = []
        for e, corner in enumerate(data["tear/corner"].tolist()):
            if not rows.start <= corner < rows.stop:
                continue
            sides, own = data["tear/side"], data["tear/triangle"]
            found.append(
                _Event(
                    float(data["tear/time"][e]),
                    corner - rows.start,
                    float(data["tear/tension"][e]),
                    int(data["tear/cause"][e]),
                    sides[sides[:, 0] == e, 1:] - rows.start,
                    (own[own[:, 0] == e, 1] - rows.start) // 3,
                    data["tear/place"][own[:, 0] == e],
                )
            )
        x = np.asarray(data["vertex/position"], dtype=np.float64)[rows]
        return x, data["edge/open"][rows].astype(bool), found

    def open_length(self, frame: int) -> float:
        """Length at rest of its open edges [m]."""
        return 0.5 * self.length_of(np.flatnonzero(self.frames[frame][1]).astype(np.int32))

    def length_of(self, sides: I32) -> float:
        """Summed length at rest of sides [m]."""
        flat = self.rest.reshape(-1, 3)
        return float(np.linalg.norm(flat[following(sides)] - flat[sides], axis=1).sum())


def tearing_pieces(run: ClothRun) -> tuple[TearingPiece, ...]:
    """All parts of an instance that can tear."""
    spec = run.candidate.spec
    return run.candidate.memo(
        ("tearing pieces", run), lambda: tuple(TearingPiece(run, p) for p in run.pieces if tears(spec, p.entity))
    )


# ---------------------------------------------------------------------- rows


def torn_with_cause(run: ClothRun) -> Finding:
    """Every side that opened did so in a logged tear, under a tension over the strength; the rest stays together."""
    pieces = tearing_pieces(run)
    if not pieces:
        return Finding("not_applicable", "nothing of this instance can tear")
    count, least = 0, np.inf
    for piece in pieces:
        before = np.zeros(len(piece.seams.kin), dtype=bool)
        for k, (x, now, events) in enumerate(piece.frames):
            for event, problem, ratio in _judged(run, piece, k, before.copy()):
                if problem:
                    place = event.places.reshape(-1, 3).mean(axis=0).round(4).tolist() if len(event.places) else []
                    return _bad(piece, k, f"the tear of {piece.entity} at {event.time:.4f} s near {place} {problem}", ratio)
                count, least = count + 1, min(least, ratio)
            logged = before.copy()
            for event in events:
                logged[event.sides] = True
            if not np.array_equal(logged, now):
                return _bad(
                    piece, k, f"{int((logged != now).sum())} sides of {piece.entity} opened or closed without a tear in the log"
                )
            label = welded(piece.seams, now)
            first = np.unique(label, return_index=True)[1]
            gap = float(np.linalg.norm(x - x[first][label], axis=1).max())
            if gap > 0.0:
                return _bad(piece, k, f"corners of {piece.entity} are {gap:.3g} m apart though no side between them is open")
            before = now
    if count == 0:
        return Finding("pass", "nothing tore, and all corners are together", 1.0, 1.0, "1")
    text = f"{count} tears, the weakest under {least:.4f} of the strength"
    return Finding("pass", text, float(least), 1.0, "1")


def _bad(piece: TearingPiece, frame: int, text: str, ratio: float | None = None) -> Finding:
    bound = None if ratio is None else 1.0
    return Finding("fail", text, ratio, bound, "1", entity=piece.entity, frame=frame, hints=(bake_again(),))


def _judged(run: ClothRun, piece: TearingPiece, frame: int, opened: Flags) -> Iterator[tuple[_Event, str, float]]:
    """Tears of a frame with what is wrong with them, and their tension over the strength."""
    for event in piece.frames[frame][2]:
        problem = _misplaced(run, piece, frame, event, opened)
        if problem:
            yield event, problem, 0.0
            continue
        area = piece.area[event.triangles]
        tensor = np.einsum("t,tij->ij", area, piece.stress(event.places, event.triangles)) / area.sum()
        tension = float(np.linalg.eigvalsh(tensor)[2])
        yield event, _uncaused(run, piece, frame, event, tension), tension / piece.strength
        opened[event.sides] = True


def _misplaced(run: ClothRun, piece: TearingPiece, frame: int, event: _Event, opened: Flags) -> str:
    """Sentence on a tear whose time, sides or triangles cannot be; empty where they can."""
    fps, label = run.candidate.spec.simulation.fps, welded(piece.seams, opened)
    if not (frame > 0 and (frame - 1) / fps - 1e-9 < event.time <= frame / fps + 1e-9):
        return "is not of its frame"
    mates = piece.seams.mate[event.sides[:, 0]]
    if len(event.sides) == 0 or not np.array_equal(mates, event.sides[:, 1]) or opened[event.sides].any():
        return "opens sides that do not lie along each other, or were open"
    own = np.flatnonzero(label == label[event.corner]) // 3
    return "" if np.array_equal(np.sort(event.triangles), own) else "was judged by other triangles than those around it"


def _uncaused(run: ClothRun, piece: TearingPiece, frame: int, event: _Event, tension: float) -> str:
    """Sentence on a tear that its tension, places or cause do not explain; empty where they do."""
    cache = run.cache
    if tension / piece.strength < 1.0 - SAME:
        return f"happened under {tension:.4g} N/m, below the strength of {piece.strength:g} N/m"
    if abs(tension - event.tension) > SAME * piece.strength:
        return f"is logged with {event.tension:.4g} N/m and was under {tension:.4g} N/m"
    if _far(run, piece, frame, event):
        return "was where its triangles cannot have been at that time"
    if event.cause >= 0 and not np.abs(cache.read(frame, ("exchange/impulse",))["exchange/impulse"][event.cause, :3]).any():
        return f"is laid to {cache.index.colliders[event.cause]}, which gave nothing"
    return ""


def _far(run: ClothRun, piece: TearingPiece, frame: int, event: _Event) -> bool:
    """True if the places of a tear lie farther from those of the frames around it than the fastest vertex gets."""
    rows = (3 * event.triangles[:, None] + np.arange(3)).ravel()
    fps, speed = run.candidate.spec.simulation.fps, REACH * float(run.record("max_speed")[frame])
    places, passed = event.places.reshape(-1, 3), event.time - (frame - 1) / fps
    sides = ((piece.frames[frame - 1][0], passed), (piece.frames[frame][0], 1.0 / fps - passed))
    return any(np.linalg.norm(places - x[rows], axis=1).max() > speed * max(time, 0.0) + SAME for x, time in sides)


def held_strength(run: ClothRun) -> Finding:
    """No vertex that could tear bears more than its strength at two frames in a row."""
    pieces = tearing_pieces(run)
    if not pieces:
        return Finding("not_applicable", "nothing of this instance can tear")
    worst, entity, frame = 0.0, pieces[0].entity, 0
    for piece in pieces:
        before: Flags | None = None
        for k, (x, now, events) in enumerate(piece.frames):
            label = welded(piece.seams, now)
            tension, direction = piece.around(x.reshape(-1, 3, 3), label)
            could = _could_tear(piece, x, now, label, direction)
            ratio = np.where(could, tension / piece.strength, 0.0)[label]
            if before is not None:
                lasting = np.where(before & ~_beside(piece, events), ratio, 0.0)
                if lasting.max() > worst:
                    worst, entity, frame = float(lasting.max()), piece.entity, k
            before = ratio > 1.0 + OVER
    if worst == 0.0:
        return Finding("pass", "no vertex bears more than the strength from one frame to the next", 0.0, 1.0 + OVER, "1")
    text = f"a vertex of {entity} bears {worst:.4f} of its strength at frames {frame - 1} and {frame} and stays whole"
    return replace(at_most(text, worst, 1.0 + OVER, "1", frame, bake_again()), entity=entity)


def _could_tear(piece: TearingPiece, x: F64, opened: Flags, label: I32, direction: F64) -> Flags:
    """Vertices with sides across the tension: one where they lie at a rim or a tear, else two, to both sides."""
    corner = np.arange(len(label), dtype=np.int32)
    inner = (piece.seams.mate >= 0) & ~opened
    edge = x[following(corner)] - x
    edge /= np.linalg.norm(edge, axis=1)[:, None]
    across = inner & (np.abs((edge * direction[label]).sum(axis=1)) <= ALIGNED)
    count = int(label.max()) + 1
    sides, triangles = np.bincount(label, inner, minlength=count), np.bincount(label, minlength=count)
    return np.asarray(np.bincount(label, across, minlength=count) >= np.where(sides == triangles, 2, 1))


def _beside(piece: TearingPiece, events: list[_Event]) -> Flags:
    """Corners of triangles around which something tore, and of their vertices."""
    found = np.zeros(int(piece.seams.kin.max()) + 1, dtype=bool)
    for event in events:
        found[piece.seams.kin[(3 * event.triangles[:, None] + np.arange(3)).ravel()]] = True
    return np.asarray(found[piece.seams.kin])
