"""Travel of bodies in one step, against the walls that they could pass: `numerical:step_travel:<solver>`.

A body that travels more than half of a wall's thickness in one step may be pushed out on its far side. That concerns two colliders
only if they could meet: they are in the contact log of the frame, or the boxes that they sweep in it overlap, skins included.

- **Travel** of a body is that of its surface at the ends of the frame. What only hits change, between frames, is in the record of
  the frame's fastest step: where no body's own speed explains that, all that touched something or feel a joint, a driver or a
  field may have gone so fast.
- **Boxes** hold each part at both ends of the frame, as far about its middle as it reaches, and what the path may lie beside the
  straight one. What stands still has its own box.
- **Thickness** of a part is the least width of its collision piece. Pieces that tile one part are no walls by themselves: there it
  is the thickness of the part's own walls, where that is more. A piece of a body that was cut beforehand has the walls of the whole
  body, or its own where it is deepest: the sharp edges of an oblique cut are no thin wall.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import Solid, cut_thickness, wall_thickness
from ...worlds.arrays import F64, rotation_matrix
from ...worlds.built import TriangleMesh
from ...worlds.errors import EvidenceError
from ..rows.corrections import LEAST_STEP, correction, set_value, thicken
from ..rows.findings import Finding
from .bounds import EXPLAINED, THICKNESS_SHARE

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity, BuiltPart, Convex
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Status

__all__ = ["step_travel", "thickness"]


def thickness(piece: Convex) -> float:
    """Smallest width of a convex collision piece [m]."""
    p = piece.params
    if piece.kind == "box":
        return 2 * min(p)
    if piece.kind in {"sphere", "capsule"}:
        return 2 * p[0]
    if piece.kind == "cylinder":
        return 2 * min(p)
    if piece.kind == "heightfield":
        return p[2]  # below its lowest place; under the others there is more
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(piece.points)
    except QhullError:
        return 0.0  # flat: nothing holds a body on its side
    # The smallest width of a polytope is taken between a face and a vertex, or between two edges; the latter is
    # smaller only for needle-like hulls, and then by little.
    heights = piece.points @ hull.equations[:, :3].T + hull.equations[:, 3]
    return float(-heights.min(axis=0).max())


def _part_thickness(part: BuiltPart) -> float:
    least = min(thickness(c) for c in part.collision)
    if len(part.collision) == 1:
        return least
    return max(least, wall_thickness(Solid.from_mesh(part.render, closed=part.closed)))


@dataclass(frozen=True)
class _Parts:
    """Colliding parts of an instance, n of them."""

    entity: tuple[str, ...]
    collider: NDArray[np.int64]
    """Collider of each part, among the index's colliders."""
    row: NDArray[np.int64]
    """Body of each in the cache; -1: it stands still."""
    thick: F64
    """[m]"""
    middle: F64
    """In its body's frame, of what stands still in the world [m], shape (n, 3)."""
    half: F64
    """Half size of its box: of what moves, as far as it reaches about its middle, on every axis [m], shape (n, 3)."""


class _Frame(NamedTuple):
    """One interval between frames: the parts' swept boxes and travel."""

    low: F64
    high: F64
    travel: F64
    """In one step [m], shape (n,)."""
    met: NDArray[np.bool_]
    """Pairs of colliders in the contact log, shape (C, C)."""


class _Steps:
    """Parts, tracks and speeds of one instance."""

    def __init__(self, candidate: Candidate, solver: str, cache: Cache) -> None:
        self.candidate, self.cache, self.solver = candidate, cache, solver
        settings = candidate.spec.simulation.rigid[solver].settings
        self.skins = 2.0 * settings.skin
        self.record: F64 = np.asarray(cache.series("record/max_travel_per_step"), dtype=np.float64)
        self.step: F64 = np.asarray(cache.series("record/step"), dtype=np.float64)
        self.gravity = float(np.linalg.norm(candidate.spec.simulation.gravity))
        self.duration = 1.0 / candidate.spec.simulation.fps
        self.parts = self._collect()
        if not len(self.parts.thick):
            raise EvidenceError(f"instance {solver!r} has no collision shapes")
        if cache.index.bodies:
            self.position, self.quaternion, self.velocity, self.spin = (
                np.asarray(cache.series(n), dtype=np.float64) for n in ("position", "quaternion", "velocity", "angular_velocity")
            )
        self.logged = cache.ragged("contact/pair")
        self.bound_bodies = self._bound()

    def _pieces(self, entity: BuiltEntity) -> dict[str, float]:
        """Thickness [m] by part of the pieces of an entity that is cut, where one of them collides by several convex pieces."""
        if all(len(p.collision) <= 1 or not p.closed for p in entity.parts) or len(entity.parts) < 2:
            return {}
        solids = []
        for part in entity.parts:
            points = self.candidate.pose(entity.entity, 0, part.body).apply(part.render.vertices)
            solids.append(Solid.from_mesh(TriangleMesh(points, part.render.faces), closed=part.closed))
        return dict(zip((p.part for p in entity.parts), cut_thickness(solids), strict=True))

    def _collect(self) -> _Parts:
        rows = {b: i for i, b in enumerate(self.cache.index.bodies)}
        names, colliders, row, thick, middle, half = [], [], [], [], [], []
        for index, name in enumerate(self.cache.index.colliders):
            entity = self.candidate.entity(name)
            cut = self._pieces(entity) if self.candidate.spec.entities[name].breakable is not None else {}
            for part in entity.parts:
                if not part.collision:
                    continue
                own = rows.get(f"{name}/{part.body}", -1)
                points = part.render.vertices
                if own < 0:
                    points = self.candidate.pose(name, 0, part.body).apply(points)
                low, high = points.min(axis=0), points.max(axis=0)
                center = 0.5 * (low + high)
                reach = np.full(3, np.linalg.norm(points - center, axis=1).max()) if own >= 0 else 0.5 * (high - low)
                if name in self.candidate.deformables:
                    reach = np.full(3, np.inf)  # it may be anywhere
                names.append(name)
                colliders.append(index)
                row.append(own)
                thick.append(max(_part_thickness(part), cut.get(part.part, 0.0)))
                middle.append(center)
                half.append(reach)
        return _Parts(
            tuple(names),
            np.array(colliders, dtype=np.int64),
            np.array(row, dtype=np.int64),
            np.array(thick),
            np.array(middle).reshape(-1, 3),
            np.array(half).reshape(-1, 3),
        )

    def _bound(self) -> NDArray[np.bool_]:
        """True where each part feels more than gravity and contacts: joints, drivers, fields, other solvers."""
        plan = self.candidate.spec.simulation
        if any(getattr(d, "kind", "") == "field" for d in plan.drivers.values()) or len(plan.solvers) > 1:
            return np.ones(len(self.parts.thick), dtype=bool)
        names = {getattr(d, "entity", None) for d in plan.drivers.values()}
        names |= {n for j in plan.joints.values() for n in (j.parent, j.child)}
        generated = {n for n, e in self.candidate.spec.entities.items() if e.generator is not None}
        names |= generated | {
            n
            for g in generated
            if (made := self.candidate.spec.entities[g].generator) is not None
            for n in (made.attach_start, made.attach_end)
        }
        return np.array([n in names for n in self.parts.entity], dtype=bool)

    def frame(self, k: int) -> _Frame:
        """The interval that ends at frame k; of frame 0, the state itself."""
        parts, before = self.parts, max(k - 1, 0)
        count = len(parts.thick)
        low, high, travel = parts.middle - parts.half, parts.middle + parts.half, np.zeros(count)
        met = np.zeros((len(self.cache.index.colliders),) * 2, dtype=bool)
        pairs = np.asarray(self.logged[k]["contact/pair"], dtype=np.int64).reshape(-1, 2)
        met[pairs[:, 0], pairs[:, 1]] = met[pairs[:, 1], pairs[:, 0]] = True
        moving = np.flatnonzero(parts.row >= 0)
        if len(moving):
            rows = parts.row[moving]
            ends, speeds = [], []
            for frame in (before, k):
                turn = rotation_matrix(self.quaternion[frame, rows])
                ends.append(self.position[frame, rows] + np.einsum("nij,nj->ni", turn, parts.middle[moving]))
                reach = np.linalg.norm(parts.middle[moving], axis=1) + parts.half[moving, 0]
                speeds.append(
                    np.linalg.norm(self.velocity[frame, rows], axis=1) + np.linalg.norm(self.spin[frame, rows], axis=1) * reach
                )
            time = self.duration if k else 0.0
            with np.errstate(invalid="ignore"):  # what is not finite is no number here either
                chord = np.linalg.norm(ends[1] - ends[0], axis=1)
            # In free flight the speed is largest at an end of the frame; the way says more where something let go in between.
            own = np.maximum(np.maximum(*speeds), chord / self.duration)
            travel[moving] = np.minimum(own * self.step[k], self.record[k])
            free = np.zeros(count, dtype=bool)
            free[moving] = ~(np.asarray(met.any(axis=1))[parts.collider[moving]] | self.bound_bodies[moving])
            if not (EXPLAINED * travel[moving] >= self.record[k]).any():
                hidden = moving[~free[moving]] if (~free[moving]).any() else moving
                travel[hidden] = self.record[k]
            way = travel[moving] / self.step[k] * time if self.step[k] > 0 else chord
            beside = 0.5 * np.maximum(way - chord, 0.0) + 0.125 * self.gravity * time**2
            margin = (parts.half[moving, 0] + beside)[:, None]
            low[moving], high[moving] = np.minimum(*ends) - margin, np.maximum(*ends) + margin
        return _Frame(low - self.skins / 2, high + self.skins / 2, travel, met)

    def worst(self, k: int) -> tuple[float, float, int, int, int] | None:
        """Worst of the pairs that could meet up to frame k: travel by its bound [1], travel [m], thin part, fast part, the other one."""
        parts, now = self.parts, self.frame(k)
        best: tuple[float, float, int, int, int] | None = None
        bound = THICKNESS_SHARE * parts.thick
        # The thin ones first: what no body's travel comes near cannot be the worst.
        for thin in np.argsort(bound, kind="stable").tolist():
            ratio = float(now.travel.max(initial=0.0)) / max(bound[thin], 1e-300)
            if best is not None and ratio <= best[0]:
                break
            others = (parts.collider != parts.collider[thin]) | ((parts.row != parts.row[thin]) & (parts.row >= 0))
            boxes = ((now.low[thin] <= now.high) & (now.high[thin] >= now.low)).all(axis=1)
            near = np.flatnonzero(np.asarray(others) & (boxes | now.met[parts.collider[thin], parts.collider]))
            if not len(near):
                continue
            fast = np.maximum(now.travel[near], now.travel[thin])
            at = int(np.argmax(fast))
            mover, other = (int(near[at]), thin) if now.travel[near[at]] >= now.travel[thin] else (thin, int(near[at]))
            found = (float(fast[at]) / max(bound[thin], 1e-300), float(fast[at]), thin, mover, other)
            best = found if best is None or found[0] > best[0] else best
        return best


def step_travel(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Travel per step of bodies against the thickness of what they could meet."""
    steps = _Steps(candidate, solver, cache)
    if not np.isfinite(steps.record).all():
        frame = int(np.argmax(~np.isfinite(steps.record)))
        return Finding("fail", f"largest travel per step is not finite at frame {frame}", None, None, "m", None, frame)
    found = [(k, worst) for k in range(len(steps.record)) if (worst := steps.worst(k)) is not None]
    if not found:
        return Finding("pass", "no two colliders could meet", float(steps.record.max()), None, "m")
    frame, (ratio, travel, thin, fast, other) = max(found, key=lambda f: f[1][0])
    first = next((k for k, worst in found if not worst[0] <= 1.0), None)
    parts = steps.parts
    wall, mover, met = (parts.entity[part] for part in (thin, fast, other))
    bound = THICKNESS_SHARE * float(parts.thick[thin])
    text = f"{mover} travels {travel:.3g} m per step at frame {frame}, where it could meet " + (
        f"{met}, {parts.thick[thin]:.3g} m thick" if thin != fast else f"{met}; itself it is {parts.thick[thin]:.3g} m thick"
    )
    pointer = f"/simulation/solvers/{solver}/settings/step"
    step = candidate.spec.simulation.rigid[solver].settings.step
    fitting = float(f"{max(LEAST_STEP['step'], 0.9 * step / max(ratio, 1e-12)):.2g}")
    hints = (
        correction(
            "a body may pass through the thin one within a step",
            "step",
            f"cut the step to {fitting:.2g} s",
            pointers=(pointer,),
            patch=set_value(pointer, fitting),
        ),
        thicken(wall, "the collider is thin"),
    )
    status: Status = "pass" if first is None else "fail"
    evidence = {"thickness": float(parts.thick[thin]), "fast": mover, "thin": wall}
    return Finding(status, text, travel, bound, "m", wall, first, hints, evidence)
