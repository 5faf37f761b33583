"""Loose matter, cloth and contact forces at a frame, as `inspect_world(part='state')` tells them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from ..verifiers.categories.cloth.frames import cloth_run
from ..verifiers.categories.liquid.frames import liquid_of
from ..verifiers.categories.particles.frames import swarm_of
from ..verifiers.predicates.kinematic import points_in_region
from ..worlds.arrays import F64
from ..worlds.cache import Cache
from ..worlds.candidate import Candidate

__all__ = ["Forces", "Loose", "Stretch", "forces_on", "loose_told", "reader_of_loose", "reader_of_stretch", "rounded"]

REGIONS = 8
"""Own choice: regions of the scene graph that a reply counts in."""
LEAST_WAY = 1e-3
"""[m] Own choice: matter whose centre has moved less than this has no front."""
LEAST_FORCE = 1e-6
"""[N] Own choice: less is no contact."""
Forces: TypeAlias = dict[str, F64]
"""Mean force over the frame by who gives it [N], shape (3,) each."""


def rounded(values: Any, digits: int = 5) -> list[float]:
    """Numbers for a reply."""
    return [round(float(v), digits) for v in values]


# ---------------------------------------------------------------- loose matter


class Loose(NamedTuple):
    """The particles of one entity at a frame."""

    position: F64
    """World [m], shape (n, 3)."""
    speed: F64
    """[m/s]"""
    mass: F64
    """[kg]"""

    @property
    def centre(self) -> F64:
        """Centre of mass [m], shape (3,); there must be particles."""
        return np.asarray(self.mass @ self.position / self.mass.sum())


def reader_of_loose(candidate: Candidate, name: str) -> Callable[[int], Loose] | None:
    """Reads the particles of a liquid or of grains by frame; None of what is neither, or has not moved yet."""
    plan = candidate.spec.simulation
    solver = next((s for s, p in plan.particles.items() if name in p.members and s in candidate.caches), None)
    if solver is not None:
        swarm = swarm_of(candidate, solver)
        member = swarm.members.index(name)

        def grains(frame: int) -> Loose:
            found = swarm.read(frame)
            rows = found.member == member
            return Loose(found.position[rows], np.linalg.norm(found.velocity[rows], axis=1), found.mass[rows])

        return grains
    solver = next((s for s, p in plan.liquid.items() if name in p.members and s in candidate.caches), None)
    if solver is None:
        return None
    liquid = liquid_of(candidate, solver)
    fluid = liquid.members.index(name)

    def drops(frame: int) -> Loose:
        found = liquid.read(frame)
        rows = found.fluid == fluid
        return Loose(found.position[rows], found.speed[rows], found.mass[rows])

    return drops


def loose_told(candidate: Candidate, name: str, read: Callable[[int], Loose], frame: int) -> dict[str, Any]:
    """Count, mass, mean and largest speed, centre, box and front of particles at a frame, and what of them lies in each region.

    The front is the particle that is farthest the way the centre has gone since they were first there.
    """
    now = read(frame)
    told: dict[str, Any] = {"count": len(now.mass)}
    if not len(now.mass):
        return told
    told |= {
        "mass": float(f"{now.mass.sum():.5g}"),
        "mean_speed": round(float(now.speed.mean()), 4),
        "max_speed": round(float(now.speed.max()), 4),
        "centre": rounded(now.centre, 4),
        "box_min": rounded(now.position.min(0), 4),
        "box_max": rounded(now.position.max(0), 4),
    }
    way = now.centre - candidate.memo(("first centre", name), lambda: _first_centre(read, frame))
    if np.linalg.norm(way) >= LEAST_WAY:
        told["front"] = rounded(now.position[int((now.position @ way).argmax())], 4)
    regions = {}
    for region in list(candidate.spec.graph.regions)[:REGIONS]:
        rows = points_in_region(candidate, region, now.position, frame)
        speed = round(float(now.speed[rows].mean()), 4) if rows.any() else 0.0
        regions[region] = {"count": int(rows.sum()), "mass": float(f"{now.mass[rows].sum():.5g}"), "mean_speed": speed}
    return told | ({"regions": regions} if regions else {})


def _first_centre(read: Callable[[int], Loose], frame: int) -> F64:
    """Centre at the first frame that has particles; one of them has, at the latest the given one."""
    return next(found.centre for found in map(read, range(frame + 1)) if len(found.mass))


# ---------------------------------------------------------------- cloth


class Stretch(NamedTuple):
    """Extension of the edges of a sheet at a frame, over their length at rest."""

    largest: float
    place_at_rest: F64
    """Middle of that edge, in the entity's frame [m]."""
    point: F64
    """Its middle in the world [m]."""
    axes: str
    """The two longest of the sheet at rest, e.g. `xy`."""
    ninths: list[list[float | None]]
    """Largest in each of 3 x 3 parts along those axes: rows along the second; None where there is no edge."""

    def told(self) -> dict[str, Any]:
        """For a reply."""
        return {
            "largest": round(self.largest, 5),
            "place_at_rest": rounded(self.place_at_rest, 4),
            "point": rounded(self.point, 4),
            f"thirds_of_{self.axes}": [[None if v is None else round(v, 5) for v in row] for row in self.ninths],
        }


def reader_of_stretch(candidate: Candidate, name: str) -> Callable[[int], Stretch] | None:
    """Reads the stretch of a cloth entity by frame; None of what is no cloth, or has not moved yet."""
    solver = next((s for s in candidate.cloth_caches if name in candidate.spec.simulation.solvers[s].members), None)
    if solver is None:
        return None
    run = cloth_run(candidate, solver)
    own = [p for p in run.pieces if p.entity == name]
    edges, length = np.concatenate([p.edges for p in own]), np.concatenate([p.length for p in own])
    rest = np.concatenate([p.vertices[p.edges - p.rows.start].mean(axis=1) for p in own])
    low, size = rest.min(axis=0), np.ptp(rest, axis=0)
    axes = sorted(np.argsort(size)[-2:].tolist())
    cell = np.clip((3.0 * (rest - low) / np.maximum(size, 1e-12)).astype(int), 0, 2)[:, axes]

    def stretch(frame: int) -> Stretch:
        x, _ = run.frame(frame)
        ends = x[edges]
        ratio = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) / length - 1.0
        worst = int(ratio.argmax())
        parts = [[ratio[(cell == (i, j)).all(axis=1)] for i in range(3)] for j in range(3)]
        ninths = [[float(p.max()) if len(p) else None for p in row] for row in parts]
        return Stretch(float(ratio[worst]), rest[worst], ends[worst].mean(axis=0), "".join("xyz"[a] for a in axes), ninths)

    return stretch


# ---------------------------------------------------------------- forces


def forces_on(candidate: Candidate, name: str, frame: int) -> Forces:
    """Mean contact force over the interval that ends at a frame on an entity, friction included, by who gives it [N].

    Bodies by the contacts that rigid instances log, of which there are none while they sleep; cloth, grains and liquids by what they gave through
    their couplings, whole instances at a time.
    """
    found: Forces = {}
    for solver, cache in candidate.caches.items():
        if solver in candidate.rigid_caches:
            pushes = _contacts(cache, name, frame)
        else:
            pushes = {} if solver in candidate.gas_caches else _given(candidate, solver, name, frame)
        for other, push in pushes.items():
            found[other] = found.get(other, np.zeros(3)) + push * candidate.spec.simulation.fps
    return {other: f for other, f in found.items() if np.linalg.norm(f) >= LEAST_FORCE}


def _contacts(cache: Cache, name: str, frame: int) -> Forces:
    """Impulses on an entity by the other, from the log of a rigid instance [N s]."""
    colliders = cache.index.colliders
    if name not in colliders:
        return {}
    log, row, found = cache.read(frame, ("contact/pair", "contact/vector")), colliders.index(name), dict[str, F64]()
    for (a, b), given in zip(log["contact/pair"].tolist(), np.asarray(log["contact/vector"], dtype=np.float64), strict=True):
        if row in (a, b) and a != b:
            other = colliders[b if row == a else a]
            found[other] = found.get(other, np.zeros(3)) + (-given if row == a else given)
    return found


def _given(candidate: Candidate, solver: str, name: str, frame: int) -> Forces:
    """Impulses between a body and an instance of cloth, grains or liquid, on the one of the two that is named [N s]."""
    cache, members = candidate.caches[solver], candidate.spec.simulation.solvers[solver].members
    bodies = [collider.partition("/")[0] for collider in cache.index.colliders]
    if name not in bodies and list(members) != [name]:
        return {}  # what several sheets or liquids of one instance were given cannot be told apart
    given, found = (
        np.asarray(cache.read(frame, ("exchange/impulse",))["exchange/impulse"], dtype=np.float64)[:, :3],
        dict[str, F64](),
    )
    for body, push in zip(bodies, given, strict=True):
        if name in (body, *members):
            other = " and ".join(members) if name == body else body
            found[other] = found.get(other, np.zeros(3)) + (push if name == body else -push)
    return found
