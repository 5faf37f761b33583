"""Which surfaces may burn in the box of a gas, cut into pieces and bound to what carries them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, compose, pose_of
from ...worlds.built import TriangleMesh
from ...worlds.categories.gas.burning import burning_sheets, flammable_parts
from ...worlds.errors import InputError
from .pieces import STANDS, Pieces, cut_into_pieces, cut_sheet

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...worlds.built import BuiltEntity
    from ...worlds.categories.gas.facts import Grid
    from ...worlds.categories.gas.models import Flammable
    from ...worlds.spec import WorldSpec
    from ..boundaries import Surround

__all__ = ["pieces_of"]

MOST_PIECES = 20_000
"""Own choice: of all surfaces; more are cut coarser."""
COARSER = 1.3


class _Held(NamedTuple):
    """A part that may burn."""

    mesh: TriangleMesh
    """In the frame of the body that carries it, of what stands in the world; of cloth its triangles at rest."""
    kind: Flammable
    density: float
    """[kg/m^3]"""
    carrier: int
    """Row among the boundaries; `STANDS`."""
    depth: float | None = None
    """Thickness of cloth [m]; None of a solid."""
    first: int = 0
    """Vertex of its boundary that is the first of this sheet."""


class _Cut(NamedTuple):
    """Pieces of one part."""

    point: F64
    normal: F64
    area: F64
    corner: NDArray[np.int64]
    weight: F64


def pieces_of(spec: WorldSpec, name: str, built: Mapping[str, BuiltEntity], grid: Grid, surround: Surround) -> Pieces | None:
    """Pieces of all surfaces that may burn in the box of an instance; None where there are none."""
    sheets, held = burning_sheets(spec, name), list[_Held]()
    for entity, parts in flammable_parts(spec, name).items():
        held += (_sheets if entity in sheets else _solids)(spec, entity, built[entity], parts, surround)
    if not held:
        return None
    widest = grid.cell
    cut = [_cut(one, widest) for one in held]
    while sum(len(c.area) for c in cut) > MOST_PIECES:
        widest *= COARSER
        cut = [_cut(one, widest) for one in held]
    depth = [_volume(h.mesh) / float(c.area.sum()) if h.depth is None else h.depth for h, c in zip(held, cut, strict=True)]
    count = [len(c.area) for c in cut]
    return Pieces(
        part=np.repeat(np.arange(len(held), dtype=np.int32), count),
        point=np.concatenate([c.point for c in cut]),
        normal=np.concatenate([c.normal for c in cut]),
        area=np.concatenate([c.area for c in cut]),
        depth=np.repeat(depth, count),
        density=np.repeat([h.density for h in held], count),
        kind=tuple(h.kind for h in held),
        carrier=np.repeat(np.array([h.carrier for h in held], dtype=np.int64), count),
        corner=np.concatenate([c.corner for c in cut]),
        weight=np.concatenate([c.weight for c in cut]),
        thin=np.repeat([h.depth is not None for h in held], count),
    )


def _solids(spec: WorldSpec, entity: str, built: BuiltEntity, parts: Mapping[str, Flammable], surround: Surround) -> list[_Held]:
    """Parts of a rigid entity."""
    stands, rows = spec.entities[entity].motion == "static", {b.name: k for k, b in enumerate(surround.boundaries)}
    found = []
    for name, kind in parts.items():
        part = next(p for p in built.parts if p.part == name)
        mesh, row = part.render, STANDS
        if stands:
            body = next(b for b in built.bodies if b.name == part.body)
            pose = compose(pose_of(spec.entities[entity].pose), body.pose)
            mesh = TriangleMesh(pose.apply(mesh.vertices), mesh.faces)
        else:
            row = rows.get(f"{entity}/{part.body}", STANDS)
            if row == STANDS:
                raise InputError(f"{entity!r} moves and may burn, and its body {part.body!r} has no collision shape; give it one")
        found.append(_Held(mesh, kind, spec.materials[part.material].density, row))
    return found


def _sheets(spec: WorldSpec, entity: str, built: BuiltEntity, parts: Mapping[str, Flammable], surround: Surround) -> list[_Held]:
    """Parts of cloth, whose triangles a boundary of the surround has one part after the other."""
    physics: Any = spec.entities[entity].physics
    row = next(k for k, soft in surround.soft.items() if soft.entity == entity)
    meshes = {p.part: p.simulation for p in built.parts if p.simulation is not None}
    start = dict(zip(meshes, np.cumsum([0, *(len(m.vertices) for m in meshes.values())]).tolist(), strict=False))
    density = physics.area_density / physics.thickness
    return [
        _Held(TriangleMesh(meshes[n].vertices, meshes[n].faces), kind, density, row, physics.thickness, start[n])
        for n, kind in parts.items()
    ]


def _cut(held: _Held, widest: float) -> _Cut:
    """A part in pieces no wider than a length [m]."""
    if held.depth is None:
        point, normal, area = cut_into_pieces(held.mesh, widest)
        return _Cut(point, normal, area, np.zeros((len(area), 3), dtype=np.int64), np.zeros((len(area), 3)))
    sheet = cut_sheet(held.mesh.vertices, held.mesh.faces, widest)
    corner = np.asarray(held.mesh.faces, dtype=np.int64)[sheet.face] + held.first
    return _Cut(sheet.point, sheet.normal, sheet.area, corner, sheet.weight)


def _volume(mesh: TriangleMesh) -> float:
    """Inside a closed surface [m^3]."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] - mesh.vertices[0] for k in range(3))
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6.0
