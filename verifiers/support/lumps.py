"""Rows about lumps of one mesh: what touches none of the others is no part of the same thing (R92, R154).

Of parts this is asked one by one (`support/held.py`, `support/one_piece.py`). A mesh may have several closed surfaces: those that bound
a void belong to the lump around them, those that lie in the matter of another lump are judged by their mass (`scene/hidden.py`).
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...geometry import apart
from ...geometry.solids import Solid
from ...worlds.built import TriangleMesh
from ...worlds.spec import Mesh
from ..rows.answers import row_of
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from ..scene.enclosed import lumps, within_one
from .bounds import LUMPS_MOST, SEAM_SHARE
from .questions import LUMPS

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ..scene.surfaces import Surfaces
    from .landed import Ground

__all__ = ["lump_rows"]


def lump_rows(surfaces: Surfaces, ground: Ground) -> list[Row]:
    """Rows `support:lumps:<entity>` of entities with a mesh of several lumps; lumps on a landscape may stand by themselves."""
    found: list[Row] = []
    for name in surfaces.entities:
        if name in surfaces.broken or name in surfaces.candidate.deforming:
            continue
        meshes = [i for i in surfaces.parts_of[name] if _several(surfaces, i)]
        if meshes and not (surfaces.is_static(name) and ground.over(name)):
            judge = partial(_judged, surfaces, name, meshes)
            found.append(row_of(surfaces.candidate, LUMPS, (name,), judge, entities=(name,)))
    return found


def _several(surfaces: Surfaces, part: int) -> bool:
    own = surfaces.parts[part]
    declared = surfaces.candidate.spec.entities[own.entity].parts.get(own.part)
    if declared is None or not isinstance(declared.shape, Mesh):
        return False
    return len(surfaces.shapes.solid(part, 0).component_heads) > 1


def _filled(solid: Solid) -> list[Solid]:
    """The lumps of a mesh with the voids in them, the largest first, without those that lie in the matter of others."""
    own = lumps(solid)
    if not solid.closed:
        return own
    sign = np.sign(solid.volume)
    voids = [s for s in own if s.volume * sign < 0.0]
    found: list[Solid] = []
    for lump in (s for s in own if s.volume * sign >= 0.0):
        inside = any(within_one(lump, larger) for larger in found)
        if inside and not any(within_one(lump, void) for void in voids):
            continue
        holes = [v for v in voids if within_one(v, lump)]
        found.append(_joined([lump, *holes]) if holes else lump)
    return found


def _joined(solids: list[Solid]) -> Solid:
    starts = np.cumsum([0, *(len(s.vertices) for s in solids)])
    points = np.concatenate([s.vertices for s in solids])
    faces = np.concatenate([s.faces + start for s, start in zip(solids, starts, strict=False)])
    return Solid.from_mesh(TriangleMesh(points, faces), closed=True)


def _judged(surfaces: Surfaces, name: str, meshes: list[int]) -> Finding:
    reason = surfaces.candidate.spec.entities[name].afloat
    bodies = dict.fromkeys(surfaces.parts[i].body for i in meshes)
    off = [one for body in bodies for one in _loose(surfaces, name, body, meshes)]
    frames = (0, 0)
    if not off or reason is not None:
        text = f"the lumps of every mesh of {name!r} hang together" if not off else f"lumps of {name!r} float: {reason}"
        return Finding("pass", text, frames=frames, extra=[reason])
    part, lump, gap = off[0]
    pose = surfaces.track(name, surfaces.parts[part].body).at(0)
    place = ", ".join(f"{c:.4g}" for c in pose.apply(lump.center[None])[0])
    what = f"{name}/{surfaces.parts[part].part}"
    return Finding(
        "fail",
        f"a lump of the mesh {what} at ({place}) touches nothing else within {gap * 1e3:.4g} mm: nothing is between them",
        float(len(off)),
        0.0,
        hints=(
            correction(
                "lumps of one mesh lie apart",
                "shape",
                "Move the lump until it touches the others, add a part that is between them, or make it an entity of its own.",
                pointers=(
                    pointer("entities", name, "parts", surfaces.parts[part].part, "shape"),
                    pointer("entities", name, "parts"),
                ),
            ),
        ),
        evidence={"part": surfaces.parts[part].part, "lumps": len(off)},
        frames=frames,
        extra=[reason],
    )


def _loose(surfaces: Surfaces, name: str, body: str, meshes: list[int]) -> list[tuple[int, Solid, float]]:
    """Lumps of meshes that no chain of contacts within the body joins with the rest of it: part, lump, and gap of contact [m]."""
    nodes: list[tuple[int, Solid]] = []
    for i in surfaces.parts_of[name]:
        if surfaces.parts[i].body == body:
            solid = surfaces.shapes.solid(i, 0)
            own = _filled(solid) if i in meshes else [solid]
            nodes += [(i, lump) for lump in own]
    if len(nodes) > LUMPS_MOST:
        return []
    pose, still = surfaces.track(name, body).at(0), surfaces.is_static(name)
    size = float(np.linalg.norm(np.ptp([p for _, s in nodes for p in (s.lower, s.upper)], axis=0)))
    gap = max(surfaces.contact_gap(name, name), SEAM_SHARE * size)
    largest = max(range(len(nodes)), key=lambda k: abs(nodes[k][1].volume))
    # What never moves is held where it touches something else that does not, each such lump by itself.
    heads = [k for k, (i, lump) in enumerate(nodes) if _leans(surfaces, name, i, lump, gap)] if still else []
    heads = heads or [largest]
    joined, waiting = set(heads), list(heads)
    while waiting:
        one = nodes[waiting.pop()][1]
        for k, (_, other) in enumerate(nodes):
            near = np.maximum(other.lower - one.upper, one.lower - other.upper).max() <= gap
            if k not in joined and near and not apart(one, pose, other, pose, gap=gap):
                joined.add(k)
                waiting.append(k)
    # Of what never moves, whole parts are judged by `support/held.py`.
    return [(i, lump, gap) for k, (i, lump) in enumerate(nodes) if k not in joined and (i in meshes or not still)]


def _leans(surfaces: Surfaces, name: str, part: int, lump: Solid, gap: float) -> bool:
    """True if a lump of what never moves touches anything else that never moves."""
    pose = surfaces.track(name, surfaces.parts[part].body).at(0)
    corners = pose.apply(lump.vertices)
    low, high = (box[:, 0] for box in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    away = np.maximum(low - corners.max(axis=0), corners.min(axis=0) - high).max(axis=1)
    for j in np.flatnonzero(away <= gap).tolist():
        other = surfaces.parts[j]
        if other.entity == name or not surfaces.is_static(other.entity):
            continue
        if not apart(lump, pose, surfaces.shapes.solid(j, 0), surfaces.track(other.entity, other.body).at(0), gap=gap):
            return True
    return False
