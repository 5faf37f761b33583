"""Loose matter, cloth and contact forces at a frame, as `inspect_world(part='state')` tells them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ..worlds.arrays import F64
from ..worlds.cache import Cache
from ..worlds.candidate import Candidate
from ..worlds.channels import CHANNELS
from ..worlds.writers import writers_of

if TYPE_CHECKING:
    from ..verifiers.categories.loose import Sample

__all__ = ["Forces", "forces_on", "loose_told", "reader_of_loose", "rounded", "stretch_told"]

REGIONS = 8
"""Own choice: regions of the scene graph that a reply counts in."""
LEAST_WAY = 1e-3
"""[m] Own choice: matter whose centre has moved less than this has no front."""
LEAST_FORCE = 1e-6
"""[N] Own choice: less is no contact."""
GIVEN = "exchange/impulse"
Forces: TypeAlias = dict[str, F64]
"""Mean force over the frame by who gives it [N], shape (3,) each."""


def rounded(values: Any, digits: int = 5) -> list[float]:
    """Numbers for a reply."""
    return [round(float(v), digits) for v in values]


# ---------------------------------------------------------------- loose matter


def reader_of_loose(candidate: Candidate, name: str) -> Callable[[int], Sample] | None:
    """Reads the particles of a liquid or of grains, or the cells of a gas, by frame; None of what is none of these, or has not moved yet."""
    from ..verifiers.categories.loose import Loose
    from ..verifiers.categories.registry import judged

    judge = judged(candidate.spec).get(name)
    if not isinstance(judge, Loose) or not any(name in cache.index.bodies for cache in judge.caches(candidate).values()):
        return None
    solver, _, row = judge.held(candidate, name)
    return partial(judge.sample, candidate, solver, row)


def loose_told(candidate: Candidate, name: str, read: Callable[[int], Sample], frame: int) -> dict[str, Any]:
    """Count, mass, mean and largest speed, centre, box and front of particles at a frame, and what of them lies in each region.

    The front is the particle that is farthest the way the centre has gone since they were first there.
    """
    from ..verifiers.predicates.kinematic import points_in_region

    position, velocity, mass = read(frame)
    told: dict[str, Any] = {"count": len(mass)}
    if not len(mass):
        return told
    speed, centre = np.linalg.norm(velocity, axis=1), _centre(position, mass)
    told |= {
        "mass": float(f"{mass.sum():.5g}"),
        "mean_speed": round(float(speed.mean()), 4),
        "max_speed": round(float(speed.max()), 4),
        "centre": rounded(centre, 4),
        "box_min": rounded(position.min(0), 4),
        "box_max": rounded(position.max(0), 4),
    }
    way = centre - candidate.memo(("first centre", name), lambda: _first_centre(read, frame))
    if np.linalg.norm(way) >= LEAST_WAY:
        told["front"] = rounded(position[int((position @ way).argmax())], 4)
    regions = {}
    for region in list(candidate.spec.graph.regions)[:REGIONS]:
        rows = points_in_region(candidate, region, position, frame)
        mean = round(float(speed[rows].mean()), 4) if rows.any() else 0.0
        regions[region] = {"count": int(rows.sum()), "mass": float(f"{mass[rows].sum():.5g}"), "mean_speed": mean}
    return told | ({"regions": regions} if regions else {})


def _centre(position: F64, mass: F64) -> F64:
    return np.asarray(mass @ position / mass.sum())


def _first_centre(read: Callable[[int], Sample], frame: int) -> F64:
    """Centre at the first frame that has particles; one of them has, at the latest the given one."""
    return next(_centre(found.position, found.mass) for found in map(read, range(frame + 1)) if len(found.mass))


def stretch_told(candidate: Candidate, name: str, frame: int) -> dict[str, Any]:
    """Largest stretch of a sheet at a frame, where that is, and by thirds of the sheet; nothing of what is no sheet or has not moved yet."""
    from ..verifiers.categories.registry import judged

    judge = judged(candidate.spec).get(name)
    found = judge.stretch(candidate, name, frame) if judge is not None and name in candidate.deforming else None
    if found is None:
        return {}
    return {
        "largest": round(found.largest, 5),
        "place_at_rest": rounded(found.place_at_rest, 4),
        "point": rounded(found.point, 4),
        f"thirds_of_{found.axes}": [[None if v is None else round(v, 5) for v in row] for row in found.thirds],
    }


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
            gives = writers_of(candidate.spec, solver) & set(CHANNELS[GIVEN].of)
            pushes = _given(candidate, solver, name, frame) if gives else {}
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
        np.asarray(cache.read(frame, (GIVEN,))[GIVEN], dtype=np.float64)[:, :3],
        dict[str, F64](),
    )
    for body, push in zip(bodies, given, strict=True):
        if name in (body, *members):
            other = " and ".join(members) if name == body else body
            found[other] = found.get(other, np.zeros(3)) + (push if name == body else -push)
    return found
