"""Parts that lie inside others of the same body, or in a closed cavity, where no camera sees them, and what they weigh (R154).

A block of wood with a core of something heavy would move as no block of wood does. What such parts weigh may be a small share of what
the parts that can be seen weigh, unless the entity's role says that it is weighted, which the register prints.
"""

from __future__ import annotations

import hashlib
import re
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...geometry.inside import contains
from ...geometry.solids import Solid
from ...worlds.arrays import F64, cross
from ...worlds.built import TriangleMesh
from ...worlds.spec import Mesh, RigidPhysics
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from .bounds import DENSER, FACES_TOLD, HIDDEN_DEPTH, HIDDEN_MASS, HIDDEN_SURFACE, HIDDEN_TRIANGLES, SHEET
from .enclosed import nested, shut_in
from .surfaces import surfaces_of

if TYPE_CHECKING:
    from ...worlds.built import BuiltPart
    from ...worlds.candidate import Candidate

__all__ = ["hidden_finding", "hidden_lines", "hidden_parts", "nested_lumps"]

_WEIGHTED = re.compile(r"\b(weighted|ballast|ballasted|loaded)\b", re.IGNORECASE)
"""Words of a role that declare a hidden weight."""
_CORNERS = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [1, 3, 3], [3, 1, 3], [3, 3, 1]])
_SPOTS = _CORNERS / _CORNERS.sum(axis=1, keepdims=True)
"""Barycentric coordinates of the samples of a triangle."""


class _Weighed(NamedTuple):
    """A part with its solid and its mass [kg], or a lump of its mesh inside another one."""

    part: BuiltPart
    solid: Solid
    mass: float
    opaque: bool
    lump: int = 0
    """Number of the lump of its mesh that lies inside another; 0: the part without those."""

    @property
    def name(self) -> str:
        """Name of the part, with the number of the lump."""
        return f"{self.part.part}#{self.lump}" if self.lump else self.part.part

    @property
    def density(self) -> float:
        """[kg/m^3]"""
        return self.mass / abs(self.solid.volume)


def hidden_parts(candidate: Candidate, name: str) -> dict[str, float]:
    """Masses [kg] of the parts of an entity that lie inside larger opaque ones; empty where there are none, or nothing moves it."""
    parts = _free_parts(candidate, name)
    if not parts:
        return {}
    content = hashlib.sha256()
    for part in parts:
        shape = part.render
        content.update(repr((part.part, part.body, part.material, part.closed, shape.vertices.shape, shape.faces.dtype)).encode())
        content.update(np.ascontiguousarray(shape.vertices).tobytes() + np.ascontiguousarray(shape.faces).tobytes())
    # Rooms hold many things of one shape: equal parts hide equal ones.
    return candidate.memo(("hidden", content.digest()), lambda: {w.name: w.mass for w in _hidden(_weighed(candidate, name))})


def _free_parts(candidate: Candidate, name: str) -> tuple[BuiltPart, ...]:
    """Parts of a free rigid entity that has several, or a mesh; none of another."""
    entity, built = candidate.spec.entities[name], candidate.built.get(name)
    rigid = isinstance(entity.physics, RigidPhysics) and entity.motion == "dynamic" and entity.generator is None
    if built is None or not rigid or entity.breakable is not None:
        return ()
    if len(built.parts) < 2 and not any(_meshed(candidate, name, part.part) for part in built.parts):
        return ()
    return built.parts


def _meshed(candidate: Candidate, name: str, part: str) -> bool:
    """True if the specification gives a part as a mesh, which may have several lumps."""
    declared = candidate.spec.entities[name].parts.get(part)
    return declared is not None and isinstance(declared.shape, Mesh)


def nested_lumps(candidate: Candidate, name: str, part: BuiltPart) -> list[Solid]:
    """Lumps of a part's mesh that lie in the matter of another lump of it: its volume counts them twice."""
    if not part.closed or not _meshed(candidate, name, part.part) or not np.isfinite(part.render.vertices).all():
        return []
    solid = surfaces_of(candidate).solid_of(part.render, closed=True)
    return candidate.memo(("nested lumps", id(solid)), lambda: nested(solid))


def _weighed(candidate: Candidate, name: str) -> list[_Weighed]:
    """Closed parts of a free rigid entity, the largest first."""
    found = []
    for part in _free_parts(candidate, name):
        material = candidate.spec.materials.get(part.material)
        if part.closed and material is not None and np.isfinite(part.render.vertices).all():
            solid = surfaces_of(candidate).solid_of(part.render, closed=True)
            opaque = material.appearance.transmission == 0.0
            inner = nested_lumps(candidate, name, part)
            own = abs(solid.volume) - sum(abs(s.volume) for s in inner)
            found.append(_Weighed(part, solid, own * material.density, opaque))
            found += [_Weighed(part, s, abs(s.volume) * material.density, opaque, k + 1) for k, s in enumerate(inner)]
    return sorted(found, key=lambda w: -abs(w.solid.volume))


def _hidden(weighed: list[_Weighed]) -> list[_Weighed]:
    found = []
    for k, inner in enumerate(weighed):
        if inner.lump:
            found.append(inner)
            continue
        around = [w.solid for w in weighed[:k] if w.opaque and w.part.body == inner.part.body]
        if around and _share_inside(inner.solid, around) >= HIDDEN_SURFACE:
            found.append(inner)
    return found + _in_cavities([w for w in weighed if w not in found])


def _in_cavities(weighed: list[_Weighed]) -> list[_Weighed]:
    """Parts that the others shut in, and that are much denser than what can be seen.

    Linings, racks and works of sheet and bars are told of only where the body weighs more than it would as a block of the densest that can be
    seen; a lump always.
    """
    found = []
    for inner in weighed:
        around = [w for w in weighed if w is not inner and w.opaque and w.part.body == inner.part.body]
        lighter = [w for w in around if DENSER * w.density < inner.density]
        if lighter and shut_in(inner.solid, [w.solid for w in lighter]):
            found.append(inner)
    seen = [w for w in weighed if w not in found]
    bodies = {w.part.body for w in found}
    heavy = {b for b in bodies if _beyond_solid([w for w in weighed if w.part.body == b], [w for w in seen if w.part.body == b])}
    return [w for w in found if w.part.body in heavy or 2.0 * abs(w.solid.volume) > SHEET * w.solid.area]


def _beyond_solid(own: list[_Weighed], seen: list[_Weighed]) -> bool:
    """True if a body weighs more than the hull of its parts, filled with the densest of what can be seen."""
    from scipy.spatial import ConvexHull

    hull = float(ConvexHull(np.concatenate([w.solid.vertices for w in own])).volume)
    return bool(sum(w.mass for w in own) > hull * max(w.density for w in seen))


def _share_inside(inner: Solid, around: list[Solid]) -> float:
    """Share of a solid's surface that lies inside others, to a depth of HIDDEN_DEPTH of its size; below HIDDEN_SURFACE a share that it may be at most."""
    corners: F64 = inner.triangles
    areas = 0.5 * np.linalg.norm(cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    largest = np.argsort(-areas, kind="stable")[:HIDDEN_TRIANGLES]
    inwards = inner.face_normals[largest, None] * (HIDDEN_DEPTH * inner.size)
    points = np.einsum("sk,fkj->fsj", _SPOTS, corners[largest]) - inwards
    covered = np.zeros(points.shape[:2], dtype=bool)
    flat = points.reshape(-1, 3)
    low, high = flat.min(axis=0), flat.max(axis=0)
    near = [s for s in around if (s.lower <= high).all() and (s.upper >= low).all()]
    for solid in near:
        covered |= ((flat >= solid.lower) & (flat <= solid.upper)).all(axis=1).reshape(covered.shape)
    total = float(areas[largest].sum())
    weight = areas[largest] / total if total > 0.0 else np.zeros(len(largest))
    most = float(weight @ covered.mean(axis=1))
    if most < HIDDEN_SURFACE:  # what lies in no box lies in no solid
        return most
    covered[:] = False
    for solid in near:
        covered |= contains(solid, flat).reshape(covered.shape)
    return float(weight @ covered.mean(axis=1))


def hidden_finding(candidate: Candidate, name: str) -> Finding:
    """Judge whether the parts of an entity that no camera sees weigh little beside those that can be seen."""
    weighed = _weighed(candidate, name)
    hidden = _hidden(weighed)
    inside = sum(w.mass for w in hidden)
    seen = sum(w.mass for w in weighed) - inside
    share = inside / seen
    named = " and ".join(f"{w.name!r} of {w.part.material!r}, {w.mass:.4g} kg" for w in hidden)
    told = _WEIGHTED.search(candidate.spec.entities[name].role)
    heavy = share > HIDDEN_MASS and told is None
    text = f"inside {name!r}, where no camera sees it, lies {named}; what can be seen weighs {seen:.4g} kg"
    if told is not None:
        text += f"; its role says that it is {told.group(0).lower()}"
    places = [pointer("entities", name, "parts", w.part.part) for w in hidden if not w.lump]
    meshes = [w.part.part for w in hidden if w.lump]
    patch: list[dict[str, Any]] = [{"op": "remove", "path": place} for place in places]
    patch += [edit for part in dict.fromkeys(meshes) for edit in _without_lumps(candidate, name, part)]
    return Finding(
        "fail" if heavy else "pass",
        text,
        min(share, HIDDEN_MASS) if told is not None else share,
        HIDDEN_MASS,
        hints=(
            correction(
                "a part that no camera sees makes the body heavier than it looks",
                "mass",
                f"Drop the hidden part of {name!r} (of a mesh: the faces of its inner lump), or choose a material that weighs what the body should; where it is meant to be weighted, "
                "say `weighted` in its role, with a weakening_reason; both are printed.",
                pointers=(*places, pointer("entities", name, "role")),
                patch=tuple(patch),
            ),
        ),
        evidence={"hidden": {w.name: w.mass for w in hidden}, "hidden_kg": inside, "seen_kg": seen},
        frames=(0, 0),
        extra=candidate.spec.entities[name].role,
    )


def _without_lumps(candidate: Candidate, name: str, part: str) -> list[dict[str, Any]]:
    """Edit that leaves the lumps inside another lump of a part's mesh out of its faces; none where the faces that stay are too many for a message."""
    shape = candidate.spec.entities[name].parts[part].shape
    assert isinstance(shape, Mesh)
    vertices, faces = np.asarray(shape.vertices, dtype=np.float64), np.asarray(shape.faces, dtype=np.int64)
    inner = nested(Solid.from_mesh(TriangleMesh(vertices, faces.astype(np.int32)), closed=True))
    gone = {tuple(v) for s in inner for v in s.vertices[np.unique(s.faces)].tolist()}
    inside = np.array([tuple(v) in gone for v in vertices.tolist()])
    kept = faces[~inside[faces].all(axis=1)]
    if not inner or not 4 <= len(kept) <= FACES_TOLD:
        return []
    return [{"op": "replace", "path": pointer("entities", name, "parts", part, "shape", "faces"), "value": kept.tolist()}]


def hidden_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of the register: parts that no camera sees, and what they weigh."""
    lines = []
    for name in candidate.spec.entities:
        for part, mass in hidden_parts(candidate, name).items():
            lines.append(
                {"what": f"part {name}/{part} lies hidden inside others", "effect": f"it weighs {mass:.4g} kg and is never seen"}
            )
    return lines
