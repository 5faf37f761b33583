"""Elastic bodies (R62, R64, R74, R101), measured on cached vertices in float64: no solver is asked.

`questions.py` lists what is asked of each body and of each instance, and the tables below which function answers: of shape here, of
holds and flight in `holds.py`, of ledgers in `books.py`, `exchange.py` and `fields.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ....geometry import Solid, self_crossings
from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh
from ....worlds.cache import Cache
from ....worlds.candidate import Candidate
from ....worlds.errors import EvidenceError, InputError
from ...ledgers.strains import require_deforming, strains_of
from ...rows.answers import row_of
from ...rows.corrections import halve_step
from ...rows.findings import Finding
from .books import energy, mass, records, solve
from .bounds import CROSSING, TRAVEL_SHARE, VOLUME_NOISE
from .exchange import exchange, together
from .fields import fields
from .holds import flight, pins, recovery
from .questions import ENTITY, INSTANCE
from .rows import change_physics, elastic_members, judge_frames, physics_of

if TYPE_CHECKING:
    from ....worlds.requirements import Correction, Row

__all__ = ["category_rows"]


def category_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of one instance and of its elastic members; none where it has no such member."""
    members = elastic_members(candidate, solver)
    if not members:
        return []
    growth = [candidate.spec.simulation.limits.energy_growth]

    def ask(function: Callable[[Candidate, str, Cache], Finding]) -> Finding:
        cache = candidate.rigid_caches.get(solver)
        if cache is None or not cache.index.deformables:
            raise EvidenceError(f"instance {solver!r} has no cache of elastic members yet; probe or bake it")
        return function(candidate, solver, cache)

    return [
        row_of(candidate, q, (name,), partial(OF_ENTITY[q.id], candidate, name), entities=(name,), extra=growth)
        for name in members
        for q in ENTITY
    ] + [row_of(candidate, q, (solver,), partial(ask, OF_INSTANCE[q.id]), entities=members, extra=growth) for q in INSTANCE]


def _shape(candidate: Candidate, entity: str) -> Finding:
    found = strains_of(require_deforming(candidate, entity), candidate.frame_count)
    lost = ~np.isfinite(found.volume)
    wrong = lost | (found.inverted > 0)
    finite = found.least_volume[~lost]
    least = float(finite.min()) if len(finite) else None
    text = f"no tetrahedron of {entity} is inverted; the least has {0.0 if least is None else least:.3g} of its volume at rest"
    if wrong.any():
        frame = int(np.argmax(wrong))
        what = "a vertex is not finite" if lost[frame] else f"{found.inverted[frame]} tetrahedra are inverted"
        text, least = f"{what} at frame {frame}", None if lost[frame] else least
    hints = _shorter(candidate, entity), _finer(entity)
    return judge_frames(wrong, text, least, 0.0, *hints, evidence={"inverted": int(found.inverted.max())})


def _strain(candidate: Candidate, entity: str) -> Finding:
    found = strains_of(require_deforming(candidate, entity), candidate.frame_count)
    bound = physics_of(candidate, entity).max_strain
    worst = float(np.nanmax(found.largest)) if np.isfinite(found.largest).any() else None
    at = int(np.nanargmax(found.largest)) if worst is not None else 0
    text = f"largest principal strain {'not finite' if worst is None else f'{worst:.3g}'} at frame {at}, allowed {bound:g}"
    action = f"raise young_modulus about {1.0 if worst is None else worst / bound:.2g} times"
    stiffer = change_physics([entity], "young_modulus", "the body is softer than its load", "stiffness", action)
    evidence = {"place": np.nan_to_num(found.place[at]).tolist(), "worst_frame": at}
    hints = stiffer, _finer(entity), _shorter(candidate, entity)
    return judge_frames(~(found.largest <= bound), text, worst, bound, *hints, evidence=evidence)


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
    wrong = pairs > 0
    text = f"{candidate.frame_count} frames searched, {int(wrong.sum()) or 'none'} with crossings"
    if wrong.any():
        frame = int(np.argmax(wrong))
        text += f"; {pairs[frame]} pairs of triangles first at frame {frame}, by up to {reach.max() * 1e3:.3g} mm"
    hints = _finer(entity), _shorter(candidate, entity)
    return judge_frames(wrong, text, float(pairs.max()), 0.0, *hints, evidence={"reach_m": float(reach.max())})


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
    worst = float(np.nanmax(change)) if np.isfinite(change).any() else None
    text = f"volume changes by at most {'?' if worst is None else f'{worst:.2%}'}, {bound:.2%} are possible within the strain allowed"
    cause, action = "the material gives way in volume", "raise poisson_ratio, at most 0.49"
    hints = change_physics([entity], "poisson_ratio", cause, "stiffness", action), _shorter(candidate, entity)
    return judge_frames(~(change <= bound), text, worst, bound, *hints, evidence={"rest_m3": found.rest})


def _step(candidate: Candidate, entity: str) -> Finding:
    soft = require_deforming(candidate, entity)
    travel: F64 = soft.cache.series("record/elastic_travel_per_step")
    edge = min(_median_edge(m.vertices, m.faces) for m in soft.meshes.values())
    bound = TRAVEL_SHARE * edge
    worst = float(travel.max()) if np.isfinite(travel).all() else None
    text = f"a node travels {'not finite' if worst is None else f'{worst:.3g} m'} in a step at most; {bound:.3g} m are allowed"
    skin = candidate.spec.simulation.rigid[_solver(candidate, entity)].settings.skin
    evidence = {"shortest_edge_m": edge, "skin_m": skin}
    return judge_frames(~(travel <= bound), text, worst, bound, _shorter(candidate, entity), evidence=evidence)


def _median_edge(vertices: F64, faces: object) -> float:
    """Median edge of the collision surface [m]: single short ones of cut solids decide nothing."""
    corner = vertices[np.asarray(faces)]
    return float(np.median(np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2)))


def _solver(candidate: Candidate, entity: str) -> str:
    return next(n for n, s in candidate.spec.simulation.rigid.items() if entity in s.members)


def _shorter(candidate: Candidate, entity: str) -> Correction:
    return halve_step(candidate, _solver(candidate, entity), "a strong impact and too long a step")


def _finer(entity: str) -> Correction:
    cause, action = "the cells are too coarse for the dent", "lower physics.resolution"
    return change_physics([entity], "resolution", cause, "resolution", action)


OF_ENTITY: Mapping[str, Callable[[Candidate, str], Finding]] = {
    "category:elastic:shape": _shape,
    "category:elastic:strain": _strain,
    "category:elastic:self": _self,
    "category:elastic:volume": _volume,
    "category:elastic:step": _step,
    "category:elastic:recovery": recovery,
    "category:elastic:pins": pins,
    "category:elastic:flight": flight,
}
"""Functions of one body, by id of the question."""
OF_INSTANCE: Mapping[str, Callable[[Candidate, str, Cache], Finding]] = {
    "category:elastic:energy": energy,
    "category:elastic:solve": solve,
    "category:elastic:records": records,
    "category:elastic:mass": mass,
    "category:elastic:exchange": exchange,
    "category:elastic:fields": fields,
    "category:elastic:together": together,
}
"""Functions of one instance, by id of the question."""
