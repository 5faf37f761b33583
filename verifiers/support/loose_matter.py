"""Liquids and grains at frame 0: they lie on something, or the story moves them (R92, R154).

Particles fall into clumps. A clump is held where a solid or a closed side of the domain is right beneath one of its
columns, or where it comes in through an opening; a wall beside it holds nothing. What hangs in the air falls at once, so that a beat has to tell of it.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry import Solid, distance_to_surface
from ...geometry.triangles import ray_hits
from ...worlds.arrays import F64
from ...worlds.built import TriangleMesh
from ...worlds.categories.loose import domain_box
from ...worlds.errors import EvidenceError
from ...worlds.spec import DemInstance, InflowDriver
from ..categories.clumps import clumps_of
from ..categories.loose import Loose
from ..categories.registry import judge_of
from ..rows.answers import row_of
from ..rows.corrections import correction, move_by, pointer
from ..rows.findings import Finding
from .bounds import CLUMP, HANGING_SHARE, LOOSE_REACH, LOWEST_ASKED, SIDEWAYS
from .moved import moves_of
from .questions import LOOSE

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import LiquidInstance

__all__ = ["loose_rows"]

RAY_PAIRS = 200_000
"""Rays times triangles asked at once: some 100 MB."""


class _Matter(NamedTuple):
    """All particles that can rest on something, at frame 0."""

    owner: tuple[str, ...]
    entity: NDArray[np.intp]
    """Index into `owner`, shape (n,)."""
    position: F64
    """World [m], shape (n, 3)."""
    mass: F64
    """[kg], shape (n,)."""
    held: NDArray[np.bool_]
    """True for particles of clumps that something holds, shape (n,)."""
    pitch: F64
    """Distance of the particles of each owner [m]."""


def loose_rows(candidate: Candidate) -> list[Row]:
    """Rows `support:matter:<entity>` of liquids and grains that touch each other; none before anything was simulated, nor without gravity."""
    if candidate.stage == "static" or not any(candidate.spec.simulation.gravity):
        return []
    return [row_of(candidate, LOOSE, (n,), partial(_finding, candidate, n), entities=(n,)) for n in _resting(candidate)]


def _resting(candidate: Candidate) -> dict[str, LiquidInstance | DemInstance]:
    """Instances of the entities whose particles can lie on something, by entity."""
    solvers = candidate.spec.simulation
    kinds = {**solvers.liquid, **{n: s for n, s in solvers.solvers.items() if isinstance(s, DemInstance)}}
    return {member: instance for instance in kinds.values() for member in instance.members}


def _finding(candidate: Candidate, entity: str) -> Finding:
    matter = candidate.memo("loose matter at the start", lambda: _matter(candidate))
    own = matter.entity == matter.owner.index(entity)
    if not own.any():
        return Finding("not_applicable", f"nothing of {entity!r} is there at frame 0")
    total, loose = float(matter.mass[own].sum()), own & ~matter.held
    share = float(matter.mass[loose].sum()) / total
    if share <= HANGING_SHARE:
        return Finding(
            "pass", f"{entity!r} lies on solids or comes in through an opening", share, HANGING_SHARE, "1", frames=(0, 0)
        )
    first = moves_of(candidate.spec).direct.get(entity)
    if first is not None:
        text = f"{share:.0%} of {entity!r} is in the air, of whose motion a beat tells from frame {first} on"
        return Finding("pass", text, evidence={"share_in_the_air": share, "from_frame": first}, frames=(0, 0))
    where = matter.position[loose].mean(axis=0)
    hanging, pitch = matter.position[loose], float(matter.pitch[matter.owner.index(entity)])
    gap = _gap(candidate, hanging[_bottom(candidate, hanging, pitch)])
    above = f"{gap:.3g} m from the nearest solid" if np.isfinite(gap) else "with no solid in the world"
    above = "beside a solid that is not beneath it" if gap <= LOOSE_REACH * pitch else above
    text = (
        f"{share:.0%} of {entity!r} ({matter.mass[loose].sum():.4g} kg) hangs in the air at frame 0 about {[round(float(x), 3) for x in where]}, "
        f"{above}: nothing holds it, and no beat tells of its fall"
    )
    told = correction(
        "it is meant to fall",
        "story",
        f"Tell of it: a beat with {entity!r} as its subject, such as `falls`, `pours` or `lands`, or let an inflow give it.",
        pointers=("/story/beats",),
    )
    lower = move_by(
        candidate, entity, None, "it is placed above what is to hold it", f"Lower {entity!r} until it lies on what is to hold it."
    )
    parts = correction(
        "its volume reaches beyond what holds it",
        "shape",
        "Make its volume smaller.",
        pointers=(pointer("entities", entity, "parts"),),
    )
    hints = (lower, told) if share > 1.0 - HANGING_SHARE else (parts, told)
    evidence = {"place": where.tolist(), "share_in_the_air": share}
    return Finding("fail", text, share, HANGING_SHARE, "1", entity, 0, hints, evidence, frames=(0, 0))


def _matter(candidate: Candidate) -> _Matter:
    """Particles at frame 0, and which of them something holds."""
    owner, samples, pitch = [], [], []
    for entity in _resting(candidate):
        judge = judge_of(candidate.spec, entity)
        assert isinstance(judge, Loose)
        solver, _, row = judge.held(candidate, entity)
        sample = judge.sample(candidate, solver, row, 0)
        density = candidate.spec.materials[candidate.spec.entities[entity].material].density
        owner.append(entity)
        samples.append(sample)
        pitch.append(float(np.cbrt(sample.mass.mean() / density)) if len(sample.mass) else 0.0)
    position = np.concatenate([s.position for s in samples])
    mass = np.concatenate([s.mass for s in samples])
    number = np.repeat(np.arange(len(owner)), [len(s.mass) for s in samples])
    if not np.isfinite(position).all():
        raise EvidenceError("coordinates of particles are not finite at frame 0; bake again")
    held = np.zeros(len(position), dtype=bool)
    if len(position):
        label = clumps_of(position, CLUMP * max(pitch))
        rows = _bottom(candidate, position, max(pitch))
        fixed = np.zeros(label.max() + 1, dtype=bool)
        reach = LOOSE_REACH * np.array(pitch)[number[rows]]
        fixed[label[rows[_held(candidate, tuple(owner), number[rows], position[rows], reach)]]] = True
        held = fixed[label]
    return _Matter(tuple(owner), number, position, mass, held, np.array(pitch))


def _held(candidate: Candidate, owner: tuple[str, ...], number: NDArray[np.intp], points: F64, reach: F64) -> NDArray[np.bool_]:
    """Which points something holds, shape (n,): it is near, and beneath them."""
    found = np.zeros(len(points), dtype=bool)
    down = _down(candidate)
    for entity, instance in _resting(candidate).items():
        mine = np.flatnonzero(number == owner.index(entity))
        found[mine] |= _at_sides(instance, down, points[mine], reach[mine]) | _fed(candidate, entity, points[mine], reach[mine])
    for solid in _solids(candidate, points[~found], float(reach.max(initial=0.0))):
        rows = np.flatnonzero(~found)
        near = distance_to_surface(solid, points[rows])
        touching = near.distance <= reach[rows]
        under = (near.point - points[rows]) @ down >= SIDEWAYS * near.distance
        found[rows[touching & under]] = True
        beside = rows[touching & ~under]
        found[beside] = _over(solid, points[beside], down, reach[beside])
    return found


def _down(candidate: Candidate) -> F64:
    """Direction of gravity, shape (3,)."""
    gravity = np.array(candidate.spec.simulation.gravity)
    return np.asarray(gravity / np.linalg.norm(gravity))


def _over(solid: Solid, points: F64, down: F64, reach: F64) -> NDArray[np.bool_]:
    """Which points have a surface of the solid straight beneath them within reach, counted from half of it above, shape (n,)."""
    if not len(points):
        return np.zeros(0, dtype=bool)
    corner, step = solid.triangles, float(reach.max())
    low, high = points.min(axis=0) - step, points.max(axis=0) + step
    close = ((corner.min(axis=1) <= high) & (corner.max(axis=1) >= low)).all(axis=1)
    if not close.any():
        return np.zeros(len(points), dtype=bool)
    rows = max(1, RAY_PAIRS // int(close.sum()))
    parts = [slice(k, k + rows) for k in range(0, len(points), rows)]
    hits = [ray_hits(corner[close], points[p] - 0.5 * reach[p, None] * down, np.tile(down, (len(points[p]), 1))) for p in parts]
    return np.asarray(np.concatenate([h.min(axis=1) for h in hits]) <= 1.5 * reach)


def _at_sides(instance: LiquidInstance | DemInstance, down: F64, points: F64, reach: F64) -> NDArray[np.bool_]:
    """Which points are at closed lower sides of the domain of an instance."""
    low, high = domain_box(instance)
    sides = getattr(instance.settings.domain, "sides", ("open",) * 6)
    gaps = np.stack([g for axis in range(3) for g in (points[:, axis] - low[axis], high[axis] - points[:, axis])], axis=1)
    outward = [sign * down[axis] for axis in range(3) for sign in (-1.0, 1.0)]
    holding = [s == "closed" and d >= SIDEWAYS for s, d in zip(sides, outward, strict=True)]
    return np.asarray((gaps[:, holding] <= reach[:, None]).any(axis=1))


def _fed(candidate: Candidate, entity: str, points: F64, reach: F64) -> NDArray[np.bool_]:
    """Which points are at an opening that lets the entity in from frame 0 on."""
    found = np.zeros(len(points), dtype=bool)
    for driver in candidate.spec.simulation.drivers.values():
        if isinstance(driver, InflowDriver) and driver.entity == entity and driver.start <= 0.0:
            half = 0.5 * float(np.linalg.norm(driver.size))
            found |= np.linalg.norm(points - np.array(driver.pose.position), axis=1) <= half + reach
    return found


def _solids(candidate: Candidate, points: F64, reach: float) -> Iterator[Solid]:
    """Visible surfaces of parts within reach of the box of points, at frame 0."""
    if not len(points):
        return
    low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
    for name in candidate.solids:
        for part in candidate.entity(name).parts:
            place = candidate.surface(name, part.part, 0)
            if np.isfinite(place).all() and (place.min(axis=0) <= high).all() and (place.max(axis=0) >= low).all():
                yield Solid.from_mesh(TriangleMesh(place, part.render.faces), closed=part.closed)


def _gap(candidate: Candidate, points: F64) -> float:
    """Least distance of points from a solid [m]; infinite where there is none."""
    return min((float(distance_to_surface(s, points).distance.min()) for s in _solids(candidate, points, np.inf)), default=np.inf)


def _bottom(candidate: Candidate, points: F64, width: float) -> NDArray[np.intp]:
    """Rows of the lowest points of upright columns, at most `LOWEST_ASKED` of them, evenly."""
    up = -_down(candidate)
    across = np.eye(3)[np.argsort(np.abs(up))[:2]]
    column = np.floor(points @ (across - np.outer(across @ up, up)).T / (CLUMP * width)).astype(np.int64)
    order = np.lexsort((points @ up, column[:, 1], column[:, 0]))
    rows = order[np.insert((np.diff(column[order], axis=0) != 0).any(axis=1), 0, True)]
    return np.asarray(rows[:: max(1, -(-len(rows) // LOWEST_ASKED))])
