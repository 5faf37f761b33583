"""Rows about settling before frame 0 (`simulation.settle`): it came to rest, starts from there, stays until something acts, and is not far.

Judged are the last frames of the settle run, which lie beside those of each instance, and the first ones of the run itself, up to the
first driver that acts or the first contact with what did not settle. How far settling moved everything stands in the register.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64, RigidPose, compose, pose_of
from ...worlds.drivers import acts_from
from ...worlds.errors import EvidenceError
from ...worlds.settled import HOLD_SECONDS, SettledFrames, hold_frames, rest_way, settling
from ...worlds.spec import FieldDriver, PathDriver
from ..categories.questions import SETTLED
from ..rows.answers import row_of
from ..rows.corrections import bake_again, correction, pointer, set_value
from ..rows.findings import Finding, cache_of
from .bounds import ASIDE, ROUNDING

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row

__all__ = ["settled_lines", "settled_rows"]

LONGEST = 120.0
"""Longest settle run that a specification may ask for [s]."""


class _Came(NamedTuple):
    """One entity that settled."""

    entity: str
    way: float
    """Farthest that it was in the last frames of its settle run, or in the first of the run itself, from where it was at frame 0 [m]."""
    within: str
    """Which of the two."""
    off: float
    """Distance of frame 0 from the end of the settle run [m]."""
    moved: float
    """From where it was declared to frame 0 [m]."""
    aside: float
    """Of that, across gravity [m]."""
    size: float
    """Diagonal of it as declared [m]."""
    rest: float
    """Longest way of what rests [m]."""

    def faults(self) -> tuple[tuple[float, float, str], ...]:
        """(measured, bound, words) of what is asked of it."""
        return (
            (self.way, self.rest, f"moves by {self.way:.3g} m {self.within}"),
            (self.off, ROUNDING, f"stands {self.off:.3g} m from where its settle run left it"),
            (self.aside, ASIDE * self.size, f"went {self.aside:.3g} m aside while it settled: it slid, rolled or flowed away"),
        )

    @property
    def share(self) -> float:
        """Largest fault, as a share of its bound; at most 1 passes."""
        return max(measured / max(bound, 1e-12) for measured, bound, _ in self.faults())


def settled_rows(candidate: Candidate) -> list[Row]:
    """Rows `numerical:settled:<solver>` of instances of which something settles."""
    listed = frozenset(settling(candidate.spec))
    return [
        row_of(candidate, SETTLED, (solver,), partial(_finding, candidate, solver), entities=own)
        for solver, instance in candidate.spec.simulation.solvers.items()
        if (own := [m for m in instance.members if m in listed])
    ]


def _finding(candidate: Candidate, solver: str) -> Finding:
    cache = cache_of(candidate, solver)
    found, seconds = _came(candidate, solver, cache), SettledFrames(cache).about()["seconds"]
    worst, far = max(found, key=lambda c: c.share), max(found, key=lambda c: c.moved)
    measured, bound, words = max(worst.faults(), key=lambda f: f[0] / max(f[1], 1e-12))
    moved = {c.entity: c.moved for c in sorted(found, key=lambda c: c.moved)[-12:]}
    evidence = {"seconds": seconds, "moved_m": moved, "moves_m": {c.entity: c.way for c in found if c.way > c.rest}}
    if worst.share <= 1.0:
        text = (
            f"{len(found)} came to rest in {seconds:.3g} s, {far.entity!r} farthest from where it was declared, {far.moved:.3g} m"
        )
        calm = max(found, key=lambda c: c.way / max(c.rest, 1e-12))
        return Finding("pass", text, calm.way, calm.rest, entity=calm.entity, evidence=evidence)
    restless = [c for c in found if c.way > c.rest]
    text = f"{worst.entity!r} {words}, allowed {bound:.3g} m"
    if restless and measured == worst.way:
        text += f" (at most {worst.way / HOLD_SECONDS:.3g} m/s; {len(restless)} of {len(found)} move) after {seconds:.3g} s"
    return Finding("fail", text, measured, bound, "m", worst.entity, 0, tuple(_corrections(candidate, worst, measured)), evidence)


def _corrections(candidate: Candidate, worst: _Came, measured: float) -> Sequence[Correction]:
    place = pointer("entities", worst.entity, "pose")
    if measured == worst.off:
        return (bake_again(),)
    nearer = correction(
        "it was declared where it cannot stay, or far from where it rests", "placement",
        f"place {worst.entity!r} nearer to where it rests, on ground that is less steep or more hollow, or give it a coarser material",
        pointers=(place,),
    )  # fmt: skip
    settle = candidate.spec.simulation.settle
    if (
        measured == worst.aside or settle is None or worst.way > worst.size
    ):  # it falls or rolls away, and no time brings it to rest
        return (nearer,)
    longer = min(LONGEST, 2.0 * settle.max_time)
    at = "/simulation/settle/max_time"
    wait = correction(
        "its settle run ended before it came to rest", "interval", f"let it settle for up to {longer:g} s",
        pointers=(at,), patch=set_value(at, longer),
    )  # fmt: skip
    return (wait, nearer) if settle.max_time < LONGEST else (nearer,)


def settled_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of the approximation register about what settled before frame 0."""
    lines, listed = [], frozenset(settling(candidate.spec))
    for solver, cache in candidate.caches.items():
        if listed.isdisjoint(candidate.spec.simulation.solvers[solver].members):
            continue
        what = f"members of {solver!r} settled before frame 0, without drivers, and start from there at rest"
        try:
            found = _came(candidate, solver, cache)
            far = max(found, key=lambda c: c.moved)
            seconds = SettledFrames(cache).about()["seconds"]
            text = f"{len(found)} settled for {seconds:.3g} s; {far.entity!r} moved farthest from where it was declared, by {far.moved:.3g} m"
        except EvidenceError as error:
            text = str(error)
        lines.append({"what": what, "effect": text})
    return lines


# ---------------------------------------------------------------- measures


def _came(candidate: Candidate, solver: str, cache: Cache) -> list[_Came]:
    """Measures of all that settled of an instance.

    Raises:
        EvidenceError: its settled frames are missing, altered or too few.
    """
    kept = SettledFrames(cache)
    if not kept.there():
        raise EvidenceError(f"{solver!r} has no settled frames; probe and bake again")
    files, digests = kept.files, kept.files.digests()
    count, wanted = files.index.frames, hold_frames(candidate.spec)
    if any(files.frame_digest(k) != digests[k] for k in range(count)):
        raise EvidenceError(f"the settled frames of {solver!r} were altered; probe and bake again")
    if count < wanted or (files.index.bodies, files.index.deformables) != (cache.index.bodies, cache.index.deformables):
        raise EvidenceError(
            f"the settled frames of {solver!r} are {count} of other members or fewer than {wanted}; probe and bake again"
        )
    listed = frozenset(settling(candidate.spec))
    last = min(candidate.last_frame, wanted - 1, _undisturbed(candidate))
    found = []
    for entity in candidate.spec.simulation.solvers[solver].members:
        if entity in listed:
            before = [_points(candidate, solver, files.read(k), entity) for k in range(count)]
            after = [_points(candidate, solver, cache.read(k), entity) for k in range(last + 1)]
            found.append(_measured(candidate, entity, before, after))
    return found


def _measured(candidate: Candidate, entity: str, before: list[_Points], after: list[_Points]) -> _Came:
    loose = candidate.spec.entities[entity].physics.shape == "loose"
    settling_way = max(_apart(p, before[-1], loose) for p in before)
    first_way = max(_apart(p, after[0], loose) for p in after)
    within = f"in the last {HOLD_SECONDS:g} s of its settle run"
    if first_way > settling_way:
        within = f"in the first {len(after) - 1} frames, though nothing acts yet"
    declared = _declared(candidate, entity)
    size = float(np.linalg.norm(np.ptp(declared, axis=0)))
    start = (
        declared if len(declared) == len(after[0].place) and not loose else 0.5 * (declared.min(axis=0) + declared.max(axis=0))
    )
    way: F64 = after[0].place.mean(axis=0) - start.mean(axis=0) if start.ndim == 2 else after[0].place.mean(axis=0) - start
    gravity = np.array(candidate.spec.simulation.gravity, dtype=np.float64)
    strength = float(np.linalg.norm(gravity))
    down = gravity / strength if strength > 0.0 else np.zeros(3)
    aside = float(np.linalg.norm(way - (way @ down) * down))
    return _Came(
        entity, max(settling_way, first_way), within, _apart(after[0], before[-1], False), float(np.linalg.norm(way)), aside, size,
        rest_way(candidate.spec, entity),
    )  # fmt: skip


class _Points(NamedTuple):
    """Points of an entity at a frame."""

    place: F64
    """World [m], shape (n, 3)."""
    names: Any
    """Of particles; None where all are there at every frame."""


def _points(candidate: Candidate, solver: str, data: Mapping[str, Any], entity: str) -> _Points:
    cache = candidate.caches[solver]
    if "particle/id" in data:
        row = list(candidate.spec.simulation.solvers[solver].members).index(entity)
        mine = np.asarray(data.get("particle/member", data.get("particle/fluid"))) == row
        place = np.asarray(data["origin"]) + np.asarray(data["particle/position"], dtype=np.float64)[mine]
        return _Points(_finite(place, entity), np.asarray(data["particle/id"])[mine])
    ends = np.cumsum([0, *cache.index.vertices])
    own = [k for k, n in enumerate(cache.index.deformables) if n.split("/", 1)[0] == entity]
    if own:
        return _Points(_finite(np.concatenate([data["vertex/position"][ends[k] : ends[k + 1]] for k in own]), entity), None)
    found = []
    for row, name in enumerate(cache.index.bodies):
        if name.split("/", 1)[0] == entity:
            pose = RigidPose(data["position"][row], data["quaternion"][row])
            found += [pose.apply(p.render.vertices) for p in candidate.entity(entity).parts_of(name.split("/", 1)[1])]
    if not found:
        raise EvidenceError(f"the settled frames lack {entity!r}; probe and bake again")
    return _Points(_finite(np.concatenate(found), entity), None)


def _finite(place: F64, entity: str) -> F64:
    if not np.isfinite(place).all():
        raise EvidenceError(f"the settled place of {entity!r} is not finite; see numerical:finite")
    return place


def _apart(one: _Points, two: _Points, typical: bool) -> float:
    """Farthest distance of a point between two frames [m]; with `typical` the root of the mean square."""
    a, b = one.place, two.place
    if one.names is not None:
        _, rows, others = np.intersect1d(one.names, two.names, return_indices=True)
        a, b = a[rows], b[others]
    if a.shape != b.shape or not len(a):
        return float("inf") if one.place.shape != two.place.shape else 0.0
    way = np.linalg.norm(a - b, axis=1)
    return float(np.sqrt((way**2).mean())) if typical else float(way.max())


def _declared(candidate: Candidate, entity: str) -> F64:
    """Visible vertices of an entity where it was declared, shape (n, 3)."""
    at = pose_of(candidate.spec.entities[entity].pose)
    bodies = {b.name: b for b in candidate.entity(entity).bodies}
    return np.concatenate(
        [compose(at, bodies[p.body].pose).apply(p.render.vertices) if p.body in bodies else at.apply(p.render.vertices)
         for p in candidate.entity(entity).parts]
    )  # fmt: skip


# ---------------------------------------------------------------- until something acts


def _undisturbed(candidate: Candidate) -> int:
    """The last frame at which nothing can have disturbed what settled: no driver, and no contact with what moves and did not settle."""
    spec = candidate.spec
    times = [_acts(candidate, n) for n in spec.simulation.drivers]
    frames = [int(np.floor(t * spec.simulation.fps + 1e-9)) for t in times if np.isfinite(t)]
    listed = frozenset(settling(spec))
    for solver, instance in spec.simulation.solvers.items():
        if solver not in spec.simulation.rigid and not listed.issuperset(instance.members):
            frames.append(0)  # matter that flows from frame 0 on
    others = {n for n, e in spec.entities.items() if e.motion != "static" and n not in listed}
    for cache in candidate.rigid_caches.values() if others else ():
        owners = [c.split("/", 1)[0] for c in cache.index.colliders]
        for frame, log in enumerate(cache.ragged("contact/pair")):
            pairs = [{owners[i], owners[j]} for i, j in log["contact/pair"].tolist()]
            if frame and any(p & others and p & listed for p in pairs):
                frames.append(frame - 1)
                break
    return max(0, min(frames, default=candidate.last_frame))


def _acts(candidate: Candidate, name: str) -> float:
    """When a driver acts first [s]: never, of a medium at rest; of a path, when it leaves its first pose."""
    driver = candidate.spec.simulation.drivers[name]
    if isinstance(driver, FieldDriver) and driver.field.kind == "drag":
        return float("inf")
    if isinstance(driver, PathDriver):
        keys = sorted(driver.keys.values(), key=lambda k: k.time)
        return next((a.time for a, b in itertools.pairwise(keys) if a.pose != b.pose), float("inf"))
    return acts_from(candidate.spec, name)[0]
