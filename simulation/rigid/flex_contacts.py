"""Surfaces of elastic bodies as flexes of their own, each small enough for the engine to keep all of its contacts with what they meet.

A flex of tetrahedra has one contact per tetrahedron with a geom, anywhere on a face that lies flat, and MuJoCo keeps 50 of them for an
interpolated flex and a geom, others in every step (4.0.0). A cushion that lay on the ground trembled for ever, and each step solved for
contacts that the one before did not know. So each vertex of the surface has a small tetrahedron that ends in it, whose contact has one place; the tetrahedra behind
the faces hold what pokes in between vertices, and act one skin later. Both are dealt out to flexes of at most `MOST`, which hang on the
body's own nodes, carry no elasticity and meet geoms alone. The flex with the elasticity meets other elastic bodies, and itself.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64, I32
from ..elastic import Lattice
from .holds import DEALT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .flex import FlexBody
    from .model import RigidModel

__all__ = ["AMONG", "MOST", "Surface", "add_surfaces", "part_flexes", "surfaces_of"]

MOST = 48
"""Tetrahedra of one flex: each has one contact with a geom, of which the engine keeps 50."""
AMONG = 1 << 30
"""contype and conaffinity of flexes with elasticity, which meet each other."""
BITS = 3
"""Bits of an elastic body that does not meet all others."""
TIP = 0.1
"""Length of the tetrahedron behind a vertex, in edges of a cell: less than any body is thick."""
NARROW = 0.3
"""Radius of its base, in its length: it stays inside a corner of three right angles."""


class Surface(NamedTuple):
    """Tetrahedra that meet geoms."""

    vertices: F64
    """In the body's frame at rest [m], shape (n, 3)."""
    tets: I32
    """Shape (k, 4), at most `MOST`, of positive volume."""
    margin: float
    """Distance at which they begin to act, beside the other side's [m]."""


def surfaces_of(lattice: Lattice, skin: float) -> list[Surface]:
    """The surface of an elastic body in parts: its vertices, which act at their skin, and its faces, which act at none.

    Args:
        lattice: of the body.
        skin: of the instance [m].
    """
    mesh = lattice.mesh
    points, tips = _tips(lattice)
    behind = mesh.tets[_outer(mesh.tets)]
    return [
        Surface(vertices, tets[group], margin)
        for vertices, tets, margin in ((points, tips, skin), (mesh.vertices, behind, 0.0))
        for group in _dealt(vertices[tets].mean(axis=1))
    ]


def _tips(lattice: Lattice) -> tuple[F64, I32]:
    """A slender tetrahedron behind each vertex of the surface, which ends in it: vertices [m], shape (4 n, 3), and tetrahedra, shape (n, 4)."""
    places, faces = lattice.mesh.vertices, lattice.mesh.faces
    corner = places[faces]
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    outward = np.zeros_like(places)
    for k in range(3):
        np.add.at(outward, faces[:, k], across)
    own = np.unique(faces)
    normal = outward[own] / np.maximum(np.linalg.norm(outward[own], axis=1, keepdims=True), 1e-300)
    side = np.cross(normal, np.where(np.abs(normal[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-300)
    length = TIP * float(lattice.edge.min())
    base, third = places[own] - length * normal, np.cross(normal, side)
    turns = [2.0 * math.pi * k / 3.0 for k in range(3)]
    rim = [base + NARROW * length * (math.cos(t) * side + math.sin(t) * third) for t in turns]
    rows = np.arange(len(own), dtype=np.int32)[:, None]
    return np.concatenate([places[own], *rim]), rows + len(own) * np.arange(4, dtype=np.int32)[[0, 1, 3, 2]]


def _outer(tets: I32) -> Any:
    """Rows of the tetrahedra with a face that no other one shares."""
    faces = np.sort(tets[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]], axis=2)
    _, which, count = np.unique(faces.reshape(-1, 3), axis=0, return_inverse=True, return_counts=True)
    return np.flatnonzero((count[which.reshape(-1, 4)] == 1).any(axis=1))


def _dealt(places: F64) -> list[Any]:
    """Rows of places in groups of neighbours, at most `MOST` each: cut across their longest extent."""

    def cut(group: Any, parts: int) -> list[Any]:
        if parts == 1:
            return [group]
        own = places[group]
        order = group[np.argsort(own[:, int(np.ptp(own, axis=0).argmax())], kind="stable")]
        middle = len(order) * (parts // 2) // parts
        return cut(order[:middle], parts // 2) + cut(order[middle:], parts - parts // 2)

    return cut(np.arange(len(places)), math.ceil(len(places) / MOST))


def add_surfaces(out: Any, bodies: Sequence[FlexBody], skin: float) -> None:
    """Add the flexes of all surfaces to the engine's specification, after those with the elasticity.

    Args:
        out: the specification of the engine.
        bodies: elastic bodies, whose flexes are there already.
        skin: of the instance [m].
    """
    for index, body in enumerate(bodies):
        main = out.flex(body.entity)
        for k, surface in enumerate(surfaces_of(body.lattice, skin)):
            used, place = np.unique(surface.tets, return_inverse=True)
            flex = out.add_flex(name=f"{body.entity}/surface{k}")
            flex.group, flex.contype, flex.conaffinity, flex.margin = index, DEALT, 0, surface.margin
            for name in ("dim", "radius", "order", "cellcount", "nodebody", "node", "condim", "friction", "solimp"):
                setattr(flex, name, getattr(main, name))
            flex.vertbody = ["world"] * len(used)
            flex.vert = body.pose.apply(surface.vertices[used]).ravel().tolist()
            flex.elem = place.reshape(-1).tolist()


def part_flexes(rigid: RigidModel) -> None:
    """Let each of the pairs `rigid.parted` pass through each other.

    Every elastic body of such a pair has three bits of its own: by the first two it meets elastic bodies, by the third geoms, all but those of
    its pairs. Written after anything that writes contact types.
    """
    model = rigid.model
    for index, body in enumerate(rigid.flexes):
        partners = {n for pair in rigid.parted if body.entity in pair for n in pair - {body.entity}}
        if not partners:
            continue
        meets = np.array([rigid.colliders[c] not in partners for c in rigid.geom_collider])
        mine, theirs, solid = (1 << (2 + BITS * index + k) for k in range(BITS))
        geoms = np.flatnonzero(meets[: model.ngeom])
        model.geom_conaffinity[geoms] |= solid
        model.body_conaffinity[np.unique(model.geom_bodyid[geoms])] |= solid
        others = [k for k in np.flatnonzero(meets[model.ngeom :]).tolist() if k != index]
        model.flex_contype[others] |= theirs
        model.flex_conaffinity[others] |= mine
        model.flex_contype[index], model.flex_conaffinity[index] = mine, theirs
        model.flex_contype[np.flatnonzero(model.flex_group == index)[1:]] = solid
