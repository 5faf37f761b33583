"""Travel of bodies in one step, against the walls that they could pass: `numerical:step_travel:<solver>`.

A body that travels more than half of a wall's thickness in one step may be pushed out on its far side. That concerns two colliders
only if they could meet: they are in the contact log of the frame, or the boxes that they sweep in it overlap, skins included, and
where a wall would be too thin for that, exact distances do not prove the two parts apart (`reach.py`). Every part that is too thin is told,
the worst first, with the step that would do.

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
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import Solid, cut_thickness, wall_thickness
from ...worlds.arrays import F64, rotation_matrix
from ...worlds.built import TriangleMesh
from ...worlds.errors import EvidenceError
from ..rows.corrections import LEAST_STEP, correction, set_value, thicken
from ..rows.findings import Finding
from .bounds import EXPLAINED, THICKNESS_SHARE
from .reach import Reach, joined

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity, BuiltPart, Convex
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Status

__all__ = ["step_travel", "thickness"]

TOLD = 12
"""Own choice: parts that are too thin are told up to so many, the worst first."""
THICKENED = 3
"""Own choice: entities that a correction makes thicker."""


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
    built: tuple[BuiltPart, ...]
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
    way: F64
    """No point of the part goes farther in the frame [m], shape (n,)."""
    met: NDArray[np.bool_]
    """Pairs of colliders in the contact log, shape (C, C)."""


class _Pair(NamedTuple):
    """Two parts that could meet."""

    ratio: float
    """Travel by its bound [1]."""
    travel: float
    """[m]"""
    thin: int
    fast: int
    other: int
    """The one that the fast one could meet."""
    frame: int


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
        self.reach, self.apart = Reach(candidate, self.skins), self._never()

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
        names, built, colliders, row, thick, middle, half = [], [], [], [], [], [], []
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
                built.append(part)
                colliders.append(index)
                row.append(own)
                thick.append(max(_part_thickness(part), cut.get(part.part, 0.0)))
                middle.append(center)
                half.append(reach)
        return _Parts(
            tuple(names),
            tuple(built),
            np.array(colliders, dtype=np.int64),
            np.array(row, dtype=np.int64),
            np.array(thick),
            np.array(middle).reshape(-1, 3),
            np.array(half).reshape(-1, 3),
        )

    def _never(self) -> NDArray[np.bool_]:
        """Pairs of colliders that never push each other, shape (C, C)."""
        never = np.zeros((len(self.cache.index.colliders),) * 2, dtype=bool)
        place = {n: i for i, n in enumerate(self.cache.index.colliders) if len(self.candidate.entity(n).bodies) == 1}
        for a, b in (sorted(pair) for pair in joined(self.candidate.spec) if pair <= set(place)):
            never[place[a], place[b]] = never[place[b], place[a]] = True
        return never

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
        low, high, travel, ways = parts.middle - parts.half, parts.middle + parts.half, np.zeros(count), np.zeros(count)
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
            ways[moving] = np.where(
                free[moving], np.maximum(own * time, chord), np.maximum(self.record[k] / self.step[k] * time, chord)
            )
            margin = (parts.half[moving, 0] + beside)[:, None]
            low[moving], high[moving] = np.minimum(*ends) - margin, np.maximum(*ends) + margin
        return _Frame(low - self.skins / 2, high + self.skins / 2, travel, ways, met)

    def _near(self, thin: int, now: _Frame) -> NDArray[np.intp]:
        """Parts of other bodies that could meet one, by their boxes and the contact log."""
        parts = self.parts
        others = (parts.collider != parts.collider[thin]) | ((parts.row != parts.row[thin]) & (parts.row >= 0))
        others &= ~self.apart[parts.collider[thin], parts.collider]
        boxes = ((now.low[thin] <= now.high) & (now.high[thin] >= now.low)).all(axis=1)
        return np.flatnonzero(np.asarray(others) & (boxes | now.met[parts.collider[thin], parts.collider]))

    def _meet(self, k: int, now: _Frame, a: int, b: int) -> bool:
        """False where two parts are proved apart throughout the interval that ends at frame k."""
        parts = self.parts
        one, other = ((parts.entity[i], parts.built[i]) for i in (a, b))
        return self.reach.met(one, other, (max(k - 1, 0), k), float(now.way[a] + now.way[b]))

    def _denied(self, k: int, now: _Frame, a: int, b: int) -> bool:
        """True where the contact log names two entities of which no two parts seem to have met: then the ways are wrong."""
        one, other = self.parts.collider[a], self.parts.collider[b]
        if not now.met[one, other]:
            return False
        mine, theirs = (np.flatnonzero(self.parts.collider == c) for c in (one, other))
        gaps = np.maximum(now.low[mine][:, None] - now.high[theirs], now.low[theirs] - now.high[mine][:, None]).max(axis=2)
        nearest = np.argsort(gaps, axis=None, kind="stable")[: int((gaps <= 0.0).sum())]
        places = np.stack(np.unravel_index(nearest, gaps.shape), axis=1).tolist()
        return not any(self._meet(k, now, int(mine[i]), int(theirs[j])) for i, j in places if mine[i] != theirs[j])

    def told(self, k: int, worst: dict[int, _Pair]) -> tuple[_Pair | None, bool]:
        """The worst pair of the interval that ends at frame k and keeps its bound, and whether another does not.

        Args:
            k: the frame.
            worst: by thin part, the worst pair that does not keep its bound yet; what is worse now is put in.
        """
        parts, now = self.parts, self.frame(k)
        best: _Pair | None = None
        failed, denied = False, dict[tuple[int, int], bool]()
        bound = THICKNESS_SHARE * parts.thick
        # The thin ones first: what no body's travel comes near cannot be the worst.
        for thin in np.argsort(bound, kind="stable").tolist():
            beaten = max(best.ratio if best is not None else -1.0, 1.0 if worst else -1.0)
            if float(now.travel.max(initial=0.0)) / max(bound[thin], 1e-300) <= beaten:
                break
            near = self._near(thin, now)
            fast = np.maximum(now.travel[near], now.travel[thin])
            for at in np.argsort(-fast, kind="stable").tolist():
                other = int(near[at])
                mover, met = (other, thin) if now.travel[other] >= now.travel[thin] else (thin, other)
                pair = _Pair(float(fast[at]) / max(bound[thin], 1e-300), float(fast[at]), thin, mover, met, k)
                if pair.ratio <= 1.0:
                    best = pair if best is None or pair.ratio > best.ratio else best
                    break
                if failed and thin in worst and pair.ratio <= worst[thin].ratio:
                    break
                key = (int(parts.collider[thin]), int(parts.collider[other]))
                meets = self._meet(k, now, thin, other)
                if not meets and key not in denied:
                    denied[key] = denied[key[::-1]] = self._denied(k, now, thin, other)
                if meets or denied[key]:
                    failed = True
                    if thin not in worst or pair.ratio > worst[thin].ratio:
                        worst[thin] = pair
                    break
        return best, failed


def step_travel(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Travel per step of bodies against the thickness of what they could meet."""
    steps = _Steps(candidate, solver, cache)
    if not np.isfinite(steps.record).all():
        frame = int(np.argmax(~np.isfinite(steps.record)))
        return Finding("fail", f"largest travel per step is not finite at frame {frame}", None, None, "m", None, frame)
    worst: dict[int, _Pair] = {}
    first, kept = None, None
    for k in range(len(steps.record)):
        best, failed = steps.told(k, worst)
        first = k if failed and first is None else first
        kept = best if best is not None and (kept is None or best.ratio > kept.ratio) else kept
    parts, step = steps.parts, candidate.spec.simulation.rigid[solver].settings.step
    pairs = sorted(worst.values(), key=lambda p: -p.ratio) or ([kept] if kept is not None else [])
    if not pairs:
        return Finding("pass", "no two colliders could meet", float(steps.record.max()), None, "m")
    told = [_offender(steps, pair, step) for pair in pairs[:TOLD]]
    lead = pairs[0]
    text = _sentence(steps, lead)
    if len(worst) > 1:
        text += f"; {len(worst)} parts are too thin for the step: " + ", ".join(_brief(o) for o in told)
        text += f" and {len(worst) - len(told)} more" if len(worst) > len(told) else ""
    status: Status = "pass" if first is None else "fail"
    evidence: dict[str, Any] = {
        "thickness": float(parts.thick[lead.thin]),
        "fast": parts.entity[lead.fast],
        "thin": parts.entity[lead.thin],
    }
    if worst:
        evidence |= {"offenders": told, "offenders_total": len(worst)}
    bound = THICKNESS_SHARE * float(parts.thick[lead.thin])
    hints = _remedies(solver, told)
    return Finding(status, text, lead.travel, bound, "m", parts.entity[lead.thin], first, hints, evidence)


def _sentence(steps: _Steps, pair: _Pair) -> str:
    parts = steps.parts
    wall, mover, met = (f"{parts.entity[i]} ({parts.built[i].part})" for i in (pair.thin, pair.fast, pair.other))
    thick = f"{parts.thick[pair.thin]:.3g} m thick"
    return f"{mover} travels {pair.travel:.3g} m per step at frame {pair.frame}, where it could meet " + (
        f"{met}, {thick}" if pair.thin != pair.fast else f"{met}; itself {wall} is {thick}"
    )


def _offender(steps: _Steps, pair: _Pair, step: float) -> dict[str, Any]:
    """A part that is too thin, what makes it so, and the step that would do [s], as data."""
    parts = steps.parts
    fitting = float(f"{max(LEAST_STEP['step'], 0.9 * step / max(pair.ratio, 1e-12)):.2g}")
    return {
        "entity": parts.entity[pair.thin],
        "part": parts.built[pair.thin].part,
        "thickness": float(parts.thick[pair.thin]),
        "travel": pair.travel,
        "fast": parts.entity[pair.fast],
        "other": parts.entity[pair.other],
        "frame": pair.frame,
        "step": fitting,
    }


def _brief(told: dict[str, Any]) -> str:
    return f"{told['entity']}/{told['part']} {told['thickness']:.3g} m at frame {told['frame']} (step {told['step']:g} s)"


def _remedies(solver: str, told: list[dict[str, Any]]) -> tuple[Correction, ...]:
    """The step that does for all of them, or thicker parts, by entity."""
    pointer = f"/simulation/solvers/{solver}/settings/step"
    fitting = told[0]["step"]
    cut = correction(
        "a body may pass through the thin one within a step",
        "step",
        f"cut the step to {fitting:.2g} s",
        pointers=(pointer,),
        patch=set_value(pointer, fitting),
    )
    thin: dict[str, list[str]] = {}
    for one in told:
        least = 1.1 * one["travel"] / THICKNESS_SHARE
        thin.setdefault(one["entity"], []).append(f"{one['part']} {least:.2g} m")
    return (cut, *(thicken(name, "the collider is thin", ", ".join(least)) for name, least in list(thin.items())[:THICKENED]))
