"""Which surfaces may burn in the box of a gas, cut into pieces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import compose, pose_of
from ...worlds.built import TriangleMesh
from ...worlds.categories.gas.facts import flammable_parts
from .surfaces import COARSER, MOST_PIECES, Pieces, cut_into_pieces

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...worlds.built import BuiltEntity
    from ...worlds.categories.gas.facts import Grid
    from ...worlds.categories.gas.models import Flammable
    from ...worlds.spec import WorldSpec

__all__ = ["pieces_of"]


def pieces_of(spec: WorldSpec, name: str, built: Mapping[str, BuiltEntity], grid: Grid) -> Pieces | None:
    """Pieces of all surfaces that may burn in the box of an instance; None where there are none."""
    held = [
        (mesh, kind, spec.materials[material].density)
        for entity, parts in flammable_parts(spec, name).items()
        for mesh, kind, material in _meshes(spec, entity, built[entity], parts)
    ]
    if not held:
        return None
    widest = grid.cell
    cut = [cut_into_pieces(mesh, widest) for mesh, _, _ in held]
    while sum(len(c[2]) for c in cut) > MOST_PIECES:
        widest *= COARSER
        cut = [cut_into_pieces(mesh, widest) for mesh, _, _ in held]
    depth = [_volume(mesh) / float(c[2].sum()) for (mesh, _, _), c in zip(held, cut, strict=True)]
    count = [len(c[2]) for c in cut]
    return Pieces(
        part=np.repeat(np.arange(len(held), dtype=np.int32), count),
        point=np.concatenate([c[0] for c in cut]),
        normal=np.concatenate([c[1] for c in cut]),
        area=np.concatenate([c[2] for c in cut]),
        depth=np.repeat(depth, count),
        density=np.repeat([density for _, _, density in held], count),
        kind=tuple(kind for _, kind, _ in held),
    )


def _meshes(
    spec: WorldSpec, entity: str, built: BuiltEntity, parts: Mapping[str, Flammable]
) -> list[tuple[TriangleMesh, Flammable, str]]:
    """Surfaces in the world of the parts that may burn, with their material."""
    found = []
    for name, kind in parts.items():
        part = next(p for p in built.parts if p.part == name)
        body = next(b for b in built.bodies if b.name == part.body)
        pose = compose(pose_of(spec.entities[entity].pose), body.pose)
        found.append((TriangleMesh(pose.apply(part.render.vertices), part.render.faces), kind, part.material))
    return found


def _volume(mesh: TriangleMesh) -> float:
    """Inside a closed surface [m^3]."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] - mesh.vertices[0] for k in range(3))
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6.0
