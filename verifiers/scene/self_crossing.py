"""Surfaces that pass through themselves: reported, and refused where they leave open what is inside.

A closed surface may cross itself as a union of solids does; then the winding number is 0 outside and at least 1 inside,
and every clearance is well defined. Where a lobe is turned inside out the winding number is negative somewhere, regions
of opposite sign cancel, and bodies hidden in them would count as outside. Such a surface fails: the row is mandatory.
Two kinds of surface are proven instead of searched: the ground under a height field, which cannot cross itself, and a large
union of convex pieces (the trunks of a forest), whose inside is definite however they overlap.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...geometry import Solid, is_convex_union, is_height_field, self_crossings, winding_number
from ...worlds.arrays import F64
from ..rows.answers import row_of
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from .bounds import BETWEEN, CROSSING_NOISE
from .questions import SELF_CROSSING

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from .surfaces import Surfaces

__all__ = ["search_together", "self_rows"]

SAMPLES = 256
"""Own choice: triangles over whose outer side the winding number is taken, besides those that cross."""
LIFT = 1e-4
"""Relative to the size of the triangle: height over it at which the winding number is taken."""
TOGETHER, SMALL = 20, 2000
"""Own choice: so many unknown surfaces of at most so many triangles are searched at once."""
COMPILED = 20_000
"""Own choice: triangles of all together from which on compiled loops find those that come near each other; loading them takes half a second."""
SPACING = 2.0
"""[1] Of the lattice on which they lie then, each scaled to a diagonal of 1."""
ALIKE = 0.999
"""[1] Share of the noise with which they are searched together, for the rounding of their places: one more is searched by itself."""
MANY = 4000
"""Own choice: triangles from which on a union of convex pieces is proven, not searched: 64,000 of a forest take a minute."""


class _Found(NamedTuple):
    pairs: int
    reach: float
    """[m]"""
    place: F64
    """Centre of the triangle that reaches through farthest, in the body's frame [m]."""
    lowest: float
    """Lowest winding number on the outer side of a triangle."""


_known: dict[bytes, _Found | None] = {}
"""By content of the mesh: equal parts are searched once per process."""


def _search(solid: Solid) -> _Found | None:
    if solid.convex:
        return None
    key = _key(solid)
    if key not in _known:
        _known[key] = None if _proven(solid) else _crossed(solid)
    return _known[key]


def _key(solid: Solid) -> bytes:
    return hashlib.sha256(solid.vertices.tobytes() + solid.faces.tobytes()).digest()


def search_together(surfaces: Surfaces) -> None:
    """Search the many small surfaces of a large world at once, in their places on a lattice; those that cross are searched again, one by one."""
    solids = {id(p.solid): p.solid for p in surfaces.parts if not p.solid.convex and len(p.solid.faces) <= SMALL}
    fresh = {key: solid for solid in solids.values() if (key := _key(solid)) not in _known}
    if len(fresh) < TOGETHER:
        return
    own = list(fresh.values())
    side = int(np.ceil(len(own) ** (1.0 / 3.0)))
    places = SPACING * np.stack(np.unravel_index(np.arange(len(own)), (side, side, side)), axis=1)
    first = np.cumsum([0, *(len(s.vertices) for s in own)])
    vertices = np.concatenate([(s.vertices - s.sphere_center) / s.size + at for s, at in zip(own, places, strict=True)])
    faces = np.concatenate([s.faces + k for s, k in zip(own, first[:-1], strict=True)]).astype(np.int32)
    count = np.array([len(s.faces) for s in own])
    groups = count if count.sum() >= COMPILED else None
    found = self_crossings(Solid(vertices, faces, True), noise=CROSSING_NOISE * ALIKE, groups=groups)
    owner = np.repeat(np.arange(len(own)), count)
    crossing = {*owner[found.pairs[:, 0]].tolist()}
    _known.update({key: None for k, key in enumerate(fresh) if k not in crossing})


def _proven(solid: Solid) -> bool:
    return is_height_field(solid) or (len(solid.faces) > MANY and is_convex_union(solid))


def _crossed(solid: Solid) -> _Found | None:
    found = self_crossings(solid, noise=CROSSING_NOISE * solid.size)
    if len(found.pairs) == 0:
        return None
    deepest = int(found.reach.argmax())
    spread = np.linspace(0, len(solid.faces) - 1, min(len(solid.faces), SAMPLES)).astype(np.intp)
    faces = np.unique(np.concatenate([spread, found.pairs[:SAMPLES].reshape(-1)]))
    sign = 1.0 if solid.volume >= 0.0 else -1.0
    lift = LIFT * solid.reaches[faces]
    points = solid.centroids[faces] + sign * lift[:, None] * solid.face_normals[faces]
    lowest = float((sign * winding_number(solid.triangles, points)).min()) if solid.closed else 0.0
    return _Found(len(found.pairs), float(found.reach[deepest]), solid.centroids[found.pairs[deepest, 0]], lowest)


def self_rows(surfaces: Surfaces, entity: str) -> list[Row]:
    """One row where a part of the entity passes through itself, about its worst part; none elsewhere."""
    crossed = [(i, f) for i in surfaces.parts_of[entity] if (f := _search(surfaces.parts[i].solid)) is not None]
    if not crossed:
        return []
    worst, found = min(crossed, key=lambda item: item[1].lowest)
    part = surfaces.parts[worst].part
    ok = found.lowest > -BETWEEN
    text = f"{entity}/{part} passes through itself in {found.pairs} pairs of triangles, by up to {found.reach * 1e3:.4g} mm; "
    text += "inside stays definite" if ok else "a lobe is turned inside out, so that inside is not definite"
    path = pointer("entities", entity, "parts", part, "shape")
    mend = correction(
        f"the surface of {entity}/{part} crosses itself and one of its lobes faces inwards",
        "shape",
        f"Write the mesh of {entity}/{part} as one outward surface without crossings, or as several parts.",
        pointers=(path,),
    )
    answer = Finding(
        "pass" if ok else "fail",
        text,
        float(np.round(found.lowest, 6)),
        -BETWEEN,
        hints=(mend,),
        evidence={
            "parts": [surfaces.parts[i].part for i, _ in crossed],
            "crossing_pairs": found.pairs,
            "reach_m": found.reach,
            "point_local": found.place.tolist(),
        },
        frames=(0, 0),
    )
    return [row_of(surfaces.candidate, SELF_CROSSING, (entity,), answer, entities=(entity,))]
