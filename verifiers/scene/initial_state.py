"""Frame 0 of rigid instances against what was declared: places and velocities (R64, R105).

Rows `numerical:<what>:<solver>`, one instance of any kind each; those of other matter are answered in `categories/<name>/start.py`:

- `placed`: bodies, pieces and vertices stand at their declared pose, but for what opening of collision skins may take: one summed
  skin per contact on the way to the next fixed thing. The middle of a liquid is that of its declared volume.
- `amount`: grains take up the share of their volume that was declared. (Volume of liquids at frame 0: `category:liquid:start`; masses of
  bodies: `category:rigid:mass`.)
- `started`: velocities are the declared ones.

A preroll lets things settle: what is free in it is told with the way it took, and bounded where a `supports` relation says that it
rests or where it was declared in contact with what lies beneath. What is held meanwhile, by a release or because it starts with a velocity, is judged as without one. No frame holds the state
before the preroll.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64, RigidPose, compose, pose_of, rotation_matrix
from ...worlds.errors import EvidenceError
from ...worlds.settled import settling
from ...worlds.spec import PathDriver, ReleaseDriver, Supports
from ..categories.questions import PLACED, STARTED
from ..rows.corrections import bake_again, correction, separate
from ..rows.findings import Finding
from .bounds import CORNERS, GAP_CAP, ROUNDING, SETTLED, SPEED, SPEED_SHARE
from .declared import Declared

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate
    from ..categories.container import Function
    from ..rows.questions import Question

__all__ = [
    "STARTS",
    "Opened",
    "moved_vertices",
    "of_places",
    "of_speeds",
    "opened",
    "speeds_of_vertices",
    "start_lines",
]

EXACT = 300
"""Members of a group up to which the way from each to its farthest is looked for: it takes their number squared."""


class Opened(NamedTuple):
    """Distance of an entity from its declared place at frame 0."""

    entity: str
    moved: float
    """[m]"""
    bound: float
    """[m]; infinite where a preroll may take it anywhere."""
    turned: float = 0.0
    """[rad]"""
    most: float = np.inf
    """[rad]"""
    settled: bool = False
    """It was free in a preroll."""

    @property
    def share(self) -> float:
        """Larger of displacement and turn, as a share of its bound; at most 1 passes."""
        return max(self.moved / self.bound, self.turned / self.most)


def held_at_start(candidate: Candidate, entity: str) -> bool:
    """True if an entity keeps its place during the preroll: held by a release, or because it starts with a velocity."""
    plan, physics = candidate.spec.simulation, candidate.spec.entities[entity].physics
    fast = any((*getattr(physics, "linear_velocity", ()), *getattr(physics, "angular_velocity", ())))
    return fast or any(isinstance(d, ReleaseDriver) and d.entity == entity for d in plan.drivers.values())


def _rests(candidate: Candidate, entity: str) -> bool:
    """True if something solid is declared to carry it at frame 0."""
    spec = candidate.spec
    return any(
        isinstance(r, Supports) and r.b == entity and (r.frames is None or r.frames[0] == 0)
        and r.a in spec.entities and spec.entities[r.a].physics.body
        for r in spec.graph.relations.values()
    )  # fmt: skip


def _pathed(candidate: Candidate) -> frozenset[str]:
    return frozenset(d.entity for d in candidate.spec.simulation.drivers.values() if isinstance(d, PathDriver))


def _read(cache: Cache, names: tuple[str, ...]) -> dict[str, F64]:
    """Channels of frame 0.

    Raises:
        EvidenceError: one is missing, or not finite.
    """
    found = {name: np.asarray(values, dtype=np.float64) for name, values in cache.read(0, names).items()}
    return {name: _finite(name, values) for name, values in found.items()}


def _finite(name: str, values: F64) -> F64:
    if not np.isfinite(values).all():
        raise EvidenceError(f"{name} is not finite at frame 0; see numerical:finite")
    return values


# ---------------------------------------------------------------- bodies of a rigid instance


def _skin(candidate: Candidate, solver: str, entity: str) -> float:
    """Collision skin of an entity, and how far its collision shapes may stand out from what is seen [m]."""
    deviation = max((max(p.deviation) for p in candidate.entity(entity).parts if p.collision), default=0.0)
    deviation = min(deviation, GAP_CAP)
    return candidate.spec.simulation.rigid[solver].settings.skin + deviation


def _chains(candidate: Candidate, solver: str) -> dict[str, int]:
    """Largest number of contacts between each moving entity and something fixed, or the far end of its group; at least 1.

    Entities are taken as neighbours where their boxes come within their skins, or a joint links them.
    """
    spec = candidate.spec
    names = [m for m in spec.simulation.rigid[solver].members if spec.entities[m].motion == "dynamic"]
    boxes = []
    for name in names:
        at = pose_of(spec.entities[name].pose)
        points = np.concatenate(
            [_declared(candidate, name, p.body, at).apply(p.render.vertices) for p in candidate.entity(name).parts]
        )
        skin = 2.0 * _skin(candidate, solver, name) + ROUNDING
        boxes.append((points.min(axis=0) - skin, points.max(axis=0) + skin))
    links: dict[str, set[str]] = {n: set() for n in names}
    low, high = (np.array([b[k] for b in boxes]).reshape(-1, 3) for k in (0, 1))
    for k, name in enumerate(names):
        near = ((low[k] <= high) & (high[k] >= low)).all(axis=1)
        links[name] |= {names[j] for j in np.flatnonzero(near).tolist()} - {name}
    for joint in spec.simulation.joints.values():
        if joint.parent in links and joint.child in links:
            links[joint.parent].add(joint.child)
            links[joint.child].add(joint.parent)
    return {n: 1 + far for n, far in _farthest(links).items()}


def _farthest(links: dict[str, set[str]]) -> dict[str, int]:
    """Hops from each to the farthest of its group; in large groups twice those from one of it, which none exceeds."""
    found: dict[str, int] = {}
    for start in links:
        if start in found:
            continue
        hops, group = _hops(links, start)
        exact = len(group) <= EXACT
        found |= {n: _hops(links, n)[0] if exact else 2 * hops for n in group}
    return found


def _hops(links: dict[str, set[str]], start: str) -> tuple[int, set[str]]:
    """Hops to the farthest that can be reached, and all that can."""
    seen, front, hops = {start}, {start}, 0
    while front := {m for n in front for m in links[n]} - seen:
        seen |= front
        hops += 1
    return hops, seen


def _declared(candidate: Candidate, entity: str, body: str, at: RigidPose) -> RigidPose:
    """Declared pose of a body of an entity that is placed `at`."""
    return compose(at, candidate.body(entity, body).pose)


def opened(candidate: Candidate, solver: str, cache: Cache) -> list[Opened]:
    """Distances of bodies, pieces and elastic vertices of a rigid instance from their declared places."""
    spec, chains = candidate.spec, _chains(candidate, solver)
    members = spec.simulation.rigid[solver].members
    moving, fixed = (
        max((_skin(candidate, solver, m) for m in members if (spec.entities[m].motion == "dynamic") is moves), default=0.0)
        for moves in (True, False)
    )
    prerolled, pathed, found = spec.simulation.preroll > 0, _pathed(candidate), []
    put, settles = Declared(candidate), frozenset(settling(spec))
    for entity in dict.fromkeys(n.split("/", 1)[0] for n in (*cache.index.bodies, *cache.index.deformables)):
        if entity not in spec.entities or entity in pathed or entity in settles:
            continue  # what follows a path is judged by `category:rigid:driven`, what settles by `numerical:settled`
        bound = CORNERS * ((2 * chains.get(entity, 1) - 1) * moving + max(moving, fixed)) + ROUNDING
        if spec.entities[entity].motion == "kinematic":
            bound = ROUNDING
        settled = prerolled and spec.entities[entity].motion == "dynamic" and not held_at_start(candidate, entity)
        own = moved_vertices(candidate, entity) if entity in candidate.deforming else _moved_bodies(candidate, cache, entity)
        for moved, turned, thin, size in own:
            most = bound / max(thin, ROUNDING)
            if settled:
                rests = _rests(candidate, entity) or put.stands(entity)
                bound, most = (max(bound, SETTLED * size) if rests else np.inf), np.inf
            found.append(Opened(entity, moved, bound, turned, most, settled))
    return found


def _moved_bodies(candidate: Candidate, cache: Cache, entity: str) -> Iterator[tuple[float, float, float, float]]:
    """Per body: displacement of its centre of mass [m], turn [rad], least and greatest extent [m]."""
    at = pose_of(candidate.spec.entities[entity].pose)
    frame = _read(cache, ("position", "quaternion"))
    for row, name in enumerate(cache.index.bodies):
        if name.split("/", 1)[0] != entity:
            continue
        body = candidate.body(*name.split("/", 1))
        wanted, there = _declared(candidate, entity, body.name, at), RigidPose(frame["position"][row], frame["quaternion"][row])
        way = float(np.linalg.norm(there.apply(body.center[None]) - wanted.apply(body.center[None])))
        apart = rotation_matrix(there.quaternion) @ rotation_matrix(wanted.quaternion).T
        turn = 2.0 * float(np.arcsin(min(1.0, np.linalg.norm(apart - np.eye(3)) / np.sqrt(8.0))))
        parts = candidate.entity(entity).parts_of(body.name)
        extent = np.ptp(np.concatenate([p.render.vertices for p in parts]), axis=0) if parts else np.zeros(3)
        yield way, turn, 0.5 * float(extent.min()), float(np.linalg.norm(extent))


def moved_vertices(candidate: Candidate, entity: str) -> Iterator[tuple[float, float, float, float]]:
    """Largest displacement of a vertex of a deforming entity from its rest shape at the declared pose."""
    soft = candidate.deforming[entity]
    wanted = pose_of(candidate.spec.entities[entity].pose).apply(soft.rest)
    away = np.linalg.norm(_finite("vertex/position", soft.positions(0)) - wanted, axis=1)
    yield float(away.max(initial=0.0)), 0.0, 1.0, float(np.linalg.norm(np.ptp(soft.rest, axis=0)))


def _placed_bodies(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    return of_places(opened(candidate, solver, cache))


def of_places(found: list[Opened]) -> Finding:
    """Finding on distances from declared places."""
    if not found:
        return Finding(
            "not_applicable",
            "nothing in it moves but on paths, which category:rigid:driven judges, or settles, which numerical:settled judges",
        )
    worst = max(found, key=lambda o: o.share)
    far = max(found, key=lambda o: o.moved)
    settled = sorted({o.entity for o in found if o.settled})
    evidence = {
        "moved_m": {o.entity: o.moved for o in sorted(found, key=lambda o: o.moved)[-12:] if o.moved > ROUNDING},
        "settled_in_preroll": settled[:50],
    }
    if worst.share <= 1.0:
        text = f"at most {far.moved:.3g} m from where it was declared, {far.entity!r}"
        text += f"; {len(settled)} settled before frame 0, in the preroll" if settled else ""
        judged = [o for o in found if np.isfinite(o.bound)]
        near = max(judged, key=lambda o: o.share, default=None)
        if near is None:
            return Finding("pass", text + "; the declared places are those before it", evidence=evidence)
        return Finding("pass", text, near.moved, near.bound, "m", near.entity, evidence=evidence)
    entity, turned = worst.entity, worst.turned / worst.most > worst.moved / worst.bound
    measured, bound, unit = (worst.turned, worst.most, "rad") if turned else (worst.moved, worst.bound, "m")
    text = (
        f"{entity!r} stands {worst.moved:.4g} m and {worst.turned:.3g} rad from where it was declared, allowed {bound:.3g} {unit}"
    )
    pointer = f"/entities/{entity}/pose"
    hints = (
        separate(entity),
        correction(
            "it was declared where it cannot stay: in something, or where it falls from before frame 0",
            "placement",
            f"declare {entity!r} where it is at frame 0, or hold it during the preroll with a release",
            pointers=(pointer,),
        ),
        bake_again(),
    )
    return Finding("fail", text, measured, bound, unit, entity, 0, hints, evidence)


def start_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of the approximation register about bodies that opened skins, or a preroll, moved before frame 0."""
    lines = []
    for solver, cache in candidate.rigid_caches.items():
        try:
            found = [o for o in opened(candidate, solver, cache) if o.moved > ROUNDING]
        except EvidenceError as error:
            lines.append({"what": f"how far skins of {solver!r} were opened before frame 0 is not known", "effect": str(error)})
            continue
        for settled in (False, True):
            some = [o for o in found if o.settled == settled]
            if not some:
                continue
            far = max(some, key=lambda o: o.moved)
            count = len({o.entity for o in some})
            what = (
                f"skins of {solver!r} were opened before frame 0"
                if not settled
                else f"the preroll moved members of {solver!r}, skins opened"
            )
            text = f"{count} of its members stand elsewhere than declared, {far.entity!r} farthest, by {far.moved:.3g} m"
            lines.append({"what": what, "effect": text})
    return lines


# ---------------------------------------------------------------- velocities


def _started_bodies(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    found = [*_speeds_of_bodies(candidate, cache), *speeds_of_vertices(candidate, cache)]
    return of_speeds(found)


class _Speed(NamedTuple):
    entity: str
    off: float
    """From the declared one [m/s]."""
    bound: float


def _bound(declared: float) -> float:
    return SPEED + SPEED_SHARE * declared


def _speeds_of_bodies(candidate: Candidate, cache: Cache) -> Iterator[_Speed]:
    spec, pathed = candidate.spec, _pathed(candidate)
    frame = _read(cache, ("position", "quaternion", "velocity", "angular_velocity"))
    owners = [n.split("/", 1)[0] for n in cache.index.bodies]
    for entity in dict.fromkeys(owners):
        if entity not in spec.entities or entity in pathed:
            continue
        rows = [k for k, o in enumerate(owners) if o == entity]
        bodies = [candidate.body(*cache.index.bodies[k].split("/", 1)) for k in rows]
        places = np.array(
            [
                RigidPose(frame["position"][k], frame["quaternion"][k]).apply(b.center[None])[0]
                for k, b in zip(rows, bodies, strict=True)
            ]
        )
        mass = np.array([b.mass for b in bodies])
        physics = spec.entities[entity].physics
        linear, spin = (np.array(getattr(physics, f"{n}_velocity", (0.0,) * 3), dtype=float) for n in ("linear", "angular"))
        if spec.simulation.preroll > 0 and spec.entities[entity].motion == "dynamic" and not held_at_start(candidate, entity):
            continue  # it has what the preroll left it
        if spec.entities[entity].motion == "kinematic":
            linear, spin = np.zeros(3), np.zeros(3)
        arms = places - (mass @ places / max(float(mass.sum()), 1e-300))
        wanted = linear + np.cross(spin, arms)
        reach = max((float(np.linalg.norm(p.render.vertices, axis=1).max()) for p in candidate.entity(entity).parts), default=0.0)
        off = np.linalg.norm(frame["velocity"][rows] - wanted, axis=1) + reach * np.linalg.norm(
            frame["angular_velocity"][rows] - spin, axis=1
        )
        fast = float(np.linalg.norm(wanted, axis=1).max()) + reach * float(np.linalg.norm(spin))
        yield _Speed(entity, float(off.max()), _bound(fast))


def speeds_of_vertices(candidate: Candidate, cache: Cache) -> Iterator[_Speed]:
    """Speeds of vertices against the declared one; those that pins hold may stand still, or go with their body."""
    spec = candidate.spec
    for entity in dict.fromkeys(n.split("/", 1)[0] for n in cache.index.deformables):
        physics = spec.entities[entity].physics
        free_before = spec.simulation.preroll > 0 and not held_at_start(candidate, entity)
        if free_before or entity not in candidate.deforming:
            continue
        wanted = np.array(getattr(physics, "linear_velocity", (0.0,) * 3), dtype=float)
        speeds = _finite("vertex/velocity", candidate.deforming[entity].velocities(0))
        off = np.linalg.norm(speeds - wanted, axis=1)
        if getattr(physics, "pins", None):
            off = np.minimum(off, np.linalg.norm(speeds, axis=1))
        yield _Speed(entity, float(off.max(initial=0.0)), _bound(float(np.linalg.norm(wanted))))


def of_speeds(found: list[_Speed]) -> Finding:
    """Finding on velocities against declared ones."""
    if not found:
        return Finding("not_applicable", "all that moves has the velocity of its path, or what the preroll left it")
    worst = max(found, key=lambda s: s.off / s.bound)
    if worst.off <= worst.bound:
        return Finding("pass", f"velocities are off by at most {worst.off:.2g} m/s", worst.off, worst.bound, "m/s", worst.entity)
    text = f"{worst.entity!r} starts with another velocity than declared: {worst.off:.4g} m/s off, its turning included"
    hints = (
        bake_again(),
        correction(
            "it was declared with another velocity", "drivers", "declare the velocity that it is to start with",
            pointers=(f"/entities/{worst.entity}/physics",),
        ),
    )  # fmt: skip
    return Finding("fail", text, worst.off, worst.bound, "m/s", worst.entity, 0, hints)


# ---------------------------------------------------------------- what is judged how

STARTS: Mapping[Question, Function] = {PLACED: _placed_bodies, STARTED: _started_bodies}
"""By question about frame 0 of a rigid instance; other matter answers in the folder of its category."""
