"""Elastic bodies (R62, R64, R74, R101), per body:

- `category:elastic:shape:<entity>`: every vertex is finite and no tetrahedron is inverted, at every frame.
- `:strain:`: the largest principal strain stays within the contract's `max_strain`.
- `:self:`: the visible surface passes nowhere through itself, at every frame, by an exact query of its own.
- `:volume:`: the volume changes by no more than `max_strain` allows at the declared Poisson's ratio.
- `:step:`: no node travels farther in a step than half the shortest edge of the surface that collides.
- `:recovery:`: where the body comes to rest, it is back in its shape: within `recovery` of its size and what its load explains.
- `:pins:`: what pins hold stays where they hold it.
- `:flight:`: where nothing touches or pins the body, its centre of mass falls freely.

Per instance with elastic members: `categories/elastic/books.py`. All of it is measured on cached vertices in float64; no solver is asked.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ....geometry import Solid, self_crossings
from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh
from ....worlds.candidate import Candidate
from ....worlds.errors import EvidenceError, InputError
from ....worlds.spec import ElasticPhysics
from ...ledgers.strains import require_deforming, strains_of
from ...rows.corrections import correction, pointer
from ...rows.findings import Finding, judged
from . import books as elastic_books
from . import holds as elastic_holds
from .rows import elastic_row, physics_of

if TYPE_CHECKING:
    from ....worlds.requirements import Row

__all__ = ["category_rows", "check_entity"]

TRAVEL_SHARE = 0.5
"""Own choice: a surface that moves farther per step than this share of its shortest edge may jump over another."""
CROSSING = 1e-6
"""Relative to the size: surfaces that touch themselves may cross by rounding."""
VOLUME_NOISE = 0.01
"""Own choice: relative change of volume that no material is asked to avoid."""


def check_entity(candidate: Candidate, entity: str) -> list[Row]:
    """Rows of one elastic body; `unverified` where evidence is missing."""
    checks: dict[str, Callable[[Candidate, str], Finding]] = {
        "shape": _shape,
        "strain": _strain,
        "self": _self,
        "volume": _volume,
        "step": _step,
        "recovery": elastic_holds.recovery,
        "pins": elastic_holds.pins,
        "flight": elastic_holds.flight,
    }
    return [elastic_row(candidate, name, entity, judged(function, candidate, entity)) for name, function in checks.items()]


def category_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of one instance and of its elastic members; none where it has no such member."""
    members = candidate.spec.simulation.solvers[solver].members
    soft = [m for m in members if m in candidate.spec.entities and isinstance(candidate.spec.entities[m].physics, ElasticPhysics)]
    rows = [r for name in soft for r in check_entity(candidate, name)]
    return [*rows, *elastic_books.check(candidate, solver)] if soft else []


def _shape(candidate: Candidate, entity: str) -> Finding:
    found = strains_of(require_deforming(candidate, entity), candidate.frame_count)
    lost = ~np.isfinite(found.volume)
    wrong = lost | (found.inverted > 0)
    frame = int(np.argmax(wrong)) if wrong.any() else None
    finite = found.least_volume[~lost]
    least = float(finite.min()) if len(finite) else None
    text = f"no tetrahedron of {entity} is inverted; the least has {0.0 if least is None else least:.3g} of its volume at rest"
    if frame is not None:
        what = "a vertex is not finite" if lost[frame] else f"{found.inverted[frame]} tetrahedra are inverted"
        text = f"{what} at frame {frame}"
    return Finding(
        "pass" if frame is None else "fail",
        text,
        measured=least if frame is None or not lost[frame] else None,
        bound=0.0,
        comparison=">=",
        unit="1",
        frame=frame,
        hints=(_shorter(candidate, entity), _finer(candidate, entity)),
        evidence={"inverted": int(found.inverted.max())},
    )


def _strain(candidate: Candidate, entity: str) -> Finding:
    found = strains_of(require_deforming(candidate, entity), candidate.frame_count)
    bound = physics_of(candidate, entity).max_strain
    wrong = ~(found.largest <= bound)
    frame = int(np.argmax(wrong)) if wrong.any() else None
    worst = float(np.nanmax(found.largest)) if np.isfinite(found.largest).any() else None
    at = int(np.nanargmax(found.largest)) if worst is not None else 0
    text = f"largest principal strain {'not finite' if worst is None else f'{worst:.3g}'} at frame {at}, allowed {bound:g}"
    stiffer = correction(
        "the body is softer than its load",
        "stiffness",
        f"raise young_modulus about {1.0 if worst is None else worst / bound:.2g} times",
        pointers=(pointer("entities", entity, "physics", "young_modulus"),),
    )
    return Finding(
        "pass" if frame is None else "fail",
        text,
        measured=worst,
        bound=bound,
        unit="1",
        frame=frame,
        hints=(stiffer, _finer(candidate, entity), _shorter(candidate, entity)),
        evidence={"place": np.nan_to_num(found.place[at]).tolist(), "worst_frame": at},
    )


def _self(candidate: Candidate, entity: str) -> Finding:
    """The surface at every frame against itself; frames whose vertices repeat are searched once."""
    built, known = candidate.entity(entity), dict[bytes, tuple[int, float]]()
    require_deforming(candidate, entity)
    pairs, reach = np.zeros(candidate.frame_count, dtype=np.intp), np.zeros(candidate.frame_count)
    for part in built.parts:
        for frame in range(candidate.frame_count):
            at = candidate.surface(entity, part.part, frame)
            key = part.part.encode() + at.tobytes()
            if key not in known:
                known[key] = _crossings(at, part.render.faces)
            pairs[frame] += known[key][0]
            reach[frame] = max(reach[frame], known[key][1])
    frame_of = int(np.argmax(pairs > 0)) if pairs.any() else None
    text = f"{candidate.frame_count} frames searched, {'none' if frame_of is None else int((pairs > 0).sum())} with crossings"
    if frame_of is not None:
        text += f"; {pairs[frame_of]} pairs of triangles first at frame {frame_of}, by up to {reach.max() * 1e3:.3g} mm"
    return Finding(
        "pass" if frame_of is None else "fail",
        text,
        measured=float(pairs.max()),
        bound=0.0,
        unit="1",
        frame=frame_of,
        hints=(_finer(candidate, entity), _shorter(candidate, entity)),
        evidence={"reach_m": float(reach.max())},
    )


def _crossings(vertices: F64, faces: object) -> tuple[int, float]:
    try:
        solid = Solid.from_mesh(TriangleMesh(vertices, np.asarray(faces, dtype=np.int32)), closed=True)
    except InputError as error:
        raise EvidenceError(f"its surface cannot be inspected: {error}") from error
    found = self_crossings(solid, noise=CROSSING * solid.size)
    return len(found.pairs), float(found.reach.max(initial=0.0))


def _volume(candidate: Candidate, entity: str) -> Finding:
    found, physics = strains_of(require_deforming(candidate, entity), candidate.frame_count), physics_of(candidate, entity)
    change = np.abs(found.volume / found.rest - 1.0)
    bound = max(VOLUME_NOISE, 3.0 * (1.0 - 2.0 * physics.poisson_ratio) * physics.max_strain)
    wrong = ~(change <= bound)
    frame = int(np.argmax(wrong)) if wrong.any() else None
    worst = float(np.nanmax(change)) if np.isfinite(change).any() else None
    text = f"volume changes by at most {'?' if worst is None else f'{worst:.2%}'}, {bound:.2%} are possible within the strain allowed"
    poisson = correction(
        "the material gives way in volume",
        "stiffness",
        "raise poisson_ratio, at most 0.49",
        pointers=(pointer("entities", entity, "physics", "poisson_ratio"),),
    )
    return Finding(
        "pass" if frame is None else "fail",
        text,
        measured=worst,
        bound=bound,
        unit="1",
        frame=frame,
        hints=(poisson, _shorter(candidate, entity)),
        evidence={"rest_m3": found.rest},
    )


def _step(candidate: Candidate, entity: str) -> Finding:
    soft = require_deforming(candidate, entity)
    travel: F64 = soft.cache.series("record/elastic_travel_per_step")
    edges = [_shortest(m.vertices, m.faces) for m in soft.meshes.values()]
    bound = TRAVEL_SHARE * min(edges)
    wrong = ~(travel <= bound)
    frame = int(np.argmax(wrong)) if wrong.any() else None
    worst = float(travel.max()) if np.isfinite(travel).all() else None
    text = f"a node travels {'not finite' if worst is None else f'{worst:.3g} m'} in a step at most; {bound:.3g} m are allowed"
    return Finding(
        "pass" if frame is None else "fail",
        text,
        measured=worst,
        bound=bound,
        unit="m",
        frame=frame,
        hints=(_shorter(candidate, entity),),
        evidence={"shortest_edge_m": min(edges), "skin_m": _settings(candidate, entity).skin},
    )


def _shortest(vertices: F64, faces: object) -> float:
    """Median edge of the collision surface [m]: single short ones of cut solids decide nothing."""
    corner = vertices[np.asarray(faces)]
    return float(np.median(np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2)))


def _settings(candidate: Candidate, entity: str):  # type: ignore[no-untyped-def]
    return next(s.settings for s in candidate.spec.simulation.rigid.values() if entity in s.members)


def _solver(candidate: Candidate, entity: str) -> str:
    return next((n for n, s in candidate.spec.simulation.rigid.items() if entity in s.members), "rigid")


def _shorter(candidate: Candidate, entity: str):  # type: ignore[no-untyped-def]
    place = f"/simulation/solvers/{_solver(candidate, entity)}/settings/step"
    step = _settings(candidate, entity).step
    patch = ({"op": "add", "path": place, "value": round(max(2e-5, step / 2), 9)},)
    return correction("a strong impact and too long a step", "step", "halve the step", pointers=(place,), patch=patch)


def _finer(candidate: Candidate, entity: str):  # type: ignore[no-untyped-def]
    place = pointer("entities", entity, "physics", "resolution")
    return correction("the cells are too coarse for the dent", "resolution", "lower physics.resolution", pointers=(place,))
