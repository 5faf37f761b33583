"""The surface that a liquid is shown with, against the particles that it stands for (R99: chunks, spikes, popping, continuity).

- `surface`: its volume and that of the spray is the particles' volume (`VOLUME`), and drifts by at most `DRIFT` while the liquid
  is calm.
- `closed`: every edge belongs to two faces, nothing of it is far from all particles, and records are those of the mesh.
- `pop`: from frame to frame its volume changes by what came in and went out, and its points move no faster than the liquid.
"""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ....geometry.launch import launch, warp
from ....worlds.arrays import F64
from ....worlds.categories.liquid.surface import LiquidSurface, mesh_of
from ....worlds.errors import EvidenceError
from ...rows.corrections import bake_again
from ...rows.findings import Finding
from .bounds import CALM_SPEED, DRIFT, FAR, POP, STRANGE, SUDDEN, VOLUME
from .questions import SHOWN
from .rows import first_over, place

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Liquid, Step

__all__ = ["Shown"]

SOME = 2000
"""Vertices looked at per frame."""


class Shown:
    """Surfaces of every frame."""

    questions: ClassVar[Mapping[str, Question]] = SHOWN

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.files = LiquidSurface(liquid.cache)
        self.count = self.files.count()
        self.ratio: list[float] = []
        self.calm: list[bool] = []
        self.jump: list[float] = []
        self.open: list[float] = []
        self.far: list[float] = []
        self.sudden: list[float] = []
        self.wrong: list[float] = []
        self.spot: list[list[float]] = []
        self.pop_spot: list[list[float]] = []
        self._before: tuple[float, float, F64, F64] | None = None

    def see(self, step: Step) -> None:
        """Look at one frame."""
        from scipy.spatial import cKDTree

        frame = step.now
        if frame.index >= self.count:
            return
        held = self.files.read(frame.index)
        vertices, faces = mesh_of(held)
        volume, area, gaps = _measures(vertices, faces)
        spray = float(held.get("record/spray_volume", 0.0))
        own = max(float(frame.volume.sum()), 1e-15)
        self.ratio.append((volume + spray) / own)
        speed = float(np.sqrt(frame.squared.mean())) if frame.count else 0.0
        self.calm.append(frame.count > 0 and speed < CALM_SPEED)
        self.wrong.append(_misrecorded(held, volume, area))
        self.open.append(float(gaps))
        d, h = self.liquid.pitch, step.duration
        some = (
            np.unique(np.linspace(0, len(vertices) - 1, min(SOME, len(vertices))).astype(np.intp))
            if len(vertices)
            else np.zeros(0, dtype=np.intp)
        )
        points = vertices[some]
        far = np.zeros(0)
        if len(points) and frame.count:
            far, _ = cKDTree(frame.position, balanced_tree=False, compact_nodes=False).query(points)
        self.far.append(float((far > FAR * d).mean()) if len(far) else float(len(points) > 0))
        self.spot.append(place(points[int(np.argmax(far))]) if len(far) else [])
        self.jump.append(0.0)
        self.sudden.append(0.0)
        self.pop_spot.append([])
        if self._before is not None and step.before is not None:
            then, then_own, then_points, then_velocity = self._before
            self.jump[-1] = abs((volume + spray - then) - (own - then_own)) / max(own, then_own)
            if len(points) and len(then_points):
                gap, at = cKDTree(then_points, balanced_tree=False, compact_nodes=False).query(points)
                carried = np.maximum(np.linalg.norm(then_velocity[at], axis=1), 0.0) * h
                late = gap - carried > SUDDEN * d + self.liquid.strength * h * h
                if late.any():
                    # Spray that is new liquid of the surface, and inflow, come from particles that were not shown.
                    seen, _ = (
                        cKDTree(step.before.position).query(points[late])
                        if step.before.count
                        else (np.full(int(late.sum()), np.inf), 0)
                    )
                    rows = np.flatnonzero(late)
                    new = seen > FAR * d + frame.fastest * h
                    self.sudden[-1] = float(new.sum()) / len(points)
                    if new.any():
                        self.pop_spot[-1] = place(points[rows[new]].mean(axis=0))
        velocity = np.asarray(held.get("surface/velocity", np.zeros_like(held["surface/vertices"])), dtype=np.float64)
        used = np.zeros(len(velocity), dtype=bool)
        used[held["surface/faces"]] = True
        self._before = (volume + spray, own, vertices, velocity[used])

    def findings(self) -> dict[str, Finding]:
        """Volume, closedness, popping."""
        if self.count == 0:
            none = Finding("not_applicable", "no surface was made of this liquid")
            return dict.fromkeys(self.questions, none)
        if self.count < self.liquid.frames:
            raise EvidenceError(f"the liquid has {self.count} of {self.liquid.frames} surfaces; bake again to resume")
        remade = bake_again("the surface is not that of the particles")
        return {"surface": self._volume(remade), "closed": self._closed(remade), "pop": self._pop(remade)}

    def _volume(self, hint: Any) -> Finding:
        ratio, calm = np.array(self.ratio), np.array(self.calm)
        off = first_over(np.abs(ratio - 1.0), VOLUME, "1", "relative error of the surface's volume", (hint,))
        if off.status == "fail" or calm.sum() < 2:
            return off
        drift = np.where(calm, np.abs(ratio / ratio[int(np.argmax(calm))] - 1.0), np.nan)
        return first_over(
            drift,
            DRIFT,
            "1",
            "drift of the surface's volume while the liquid is calm",
            (hint,),
            evidence={"calm_frames": int(calm.sum())},
        )

    def _closed(self, hint: Any) -> Finding:
        wrong, gaps, far = np.array(self.wrong), np.array(self.open), np.array(self.far)
        if (wrong > DRIFT).any():
            return first_over(wrong, DRIFT, "1", "error of recorded volume or area", (bake_again(),))
        if gaps.any():
            return first_over(gaps, 0.0, "1", "number of edges that do not belong to two faces", (hint,))
        found = first_over(
            far,
            max(STRANGE, 1.0 / SOME),
            "1",
            f"share of the surface farther than {FAR:g} particle distances from all particles",
            (hint,),
        )
        where = self.spot[found.frame] if found.frame is not None else []
        return Finding(
            found.status, found.text, found.measured, found.bound, "1", None, found.frame, found.hints, {"place": where}
        )

    def _pop(self, hint: Any) -> Finding:
        sudden = first_over(
            np.array(self.sudden), max(STRANGE, 1.0 / SOME), "1", "share of the surface that appears where no liquid was", (hint,)
        )
        if sudden.status == "fail":
            assert sudden.frame is not None
            return Finding(
                "fail",
                sudden.text,
                sudden.measured,
                sudden.bound,
                "1",
                None,
                sudden.frame,
                sudden.hints,
                {"place": self.pop_spot[sudden.frame]},
            )
        allowed = np.array([POP[c] for c in self.calm])
        text = "change of the surface's volume in a frame without a source, over what is allowed,"
        return first_over(np.array(self.jump) / allowed, 1.0, "1", text, (hint,))


def _measures(vertices: F64, faces: Any) -> tuple[float, float, int]:
    """Volume inside [m^3], area [m^2], and directed edges without their opposite."""
    if not len(faces):
        return 0.0, 0.0, 0
    from .mesh_kernels import measure

    wp = warp()
    points = wp.array(np.ascontiguousarray(vertices), dtype=wp.vec3d, device="cpu")
    corners = wp.array(np.ascontiguousarray(faces, dtype=np.int32), dtype=wp.int32, device="cpu")
    volume, area = (wp.empty(len(faces), dtype=wp.float64, device="cpu") for _ in range(2))
    marks = wp.empty(len(faces), dtype=wp.uint64, device="cpu")
    # Nobody knows the key beforehand: marks of an open mesh add up to nothing once in 2^64 times.
    given = [points, corners, wp.vec3d(*vertices[0]), wp.uint64(secrets.randbits(64)), volume, area, marks]
    launch(measure, len(faces), given, device="cpu", slice_size=8192)
    gaps = _open_edges(faces) if int(marks.numpy().sum()) else 0
    return float(volume.numpy().sum()) / 6.0, 0.5 * float(area.numpy().sum()), gaps


def _misrecorded(held: dict[str, Any], volume: float, area: float) -> float:
    """Relative error of what is recorded of the mesh."""
    errors = [
        abs(float(held[f"record/{n}"]) - v) / max(abs(v), 1e-12)
        for n, v in (("surface_volume", volume), ("surface_area", area))
        if f"record/{n}" in held and abs(v) > 1e-12
    ]
    return max(errors, default=0.0)


def _open_edges(faces: Any) -> int:
    """Directed edges without their opposite."""
    if not len(faces):
        return 0
    n = int(faces.max()) + 1
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    low, high = edges.min(axis=1), edges.max(axis=1)
    # Sorted by their ends, with the direction as the last bit: the two directions of an edge cancel.
    key = np.sort(2 * (low * n + high) + (edges[:, 0] < edges[:, 1]))
    start = np.concatenate([[0], np.flatnonzero(np.diff(key >> 1)) + 1])
    return int(np.abs(np.add.reduceat(2 * (key & 1) - 1, start)).sum())
