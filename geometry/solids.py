"""A triangle mesh prepared for distance queries: topology, convex facets, mass properties, search trees.

Everything derived is computed on first use and kept, so that a solid is built once and queried many times.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..worlds.arrays import F64, I32, cross, length
from ..worlds.built import TriangleMesh
from ..worlds.errors import InputError
from .crossings import RayGrid

__all__ = ["Facets", "Solid"]

CONVEX_TOLERANCE = 1e-9
"""Own choice: a vertex may stand this far above a face plane, relative to the size, and the mesh still be convex."""
COPLANAR = 1e-11
"""Own choice: triangles whose corners lie this close to one plane, relative to the size, count as one facet."""
FEW_FACES = 16
"""Own choice: faces, evenly over the list, that are tried first for a vertex above them."""
CHUNK = 100_000
"""Elements of a temporary matrix: it stays in the cache, which is several times as fast as tens of megabytes."""


@dataclass(frozen=True)
class Facets:
    """Faces of a convex polyhedron with coplanar triangles merged."""

    normals: F64
    """Outward unit normals, shape (k, 3)."""
    offsets: F64
    """Plane offsets h [m], shape (k,): inside means normal . x <= h."""
    centers: F64
    """Mean of the vertices of each facet [m], shape (k, 3)."""
    tangents: F64
    """Two unit vectors in each facet plane, shape (k, 2, 3)."""
    members: NDArray[np.bool_]
    """Which vertices lie on which facet, shape (k, n)."""
    edges: I32
    """Edges between different facets, as vertex indices, shape (e, 2)."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A surface ready for queries. Build it with `from_mesh`.

    `closed` is the promise that the surface bounds a volume; without it nothing lies inside.
    """

    vertices: F64
    """Welded vertices [m], shape (n, 3)."""
    faces: I32
    """Triangles without the degenerate ones, shape (m, 3), counter-clockwise seen from outside."""
    closed: bool

    @classmethod
    def from_mesh(cls, mesh: TriangleMesh, *, closed: bool) -> Solid:
        """Weld equal vertices and drop triangles without area.

        Args:
            mesh: the surface; vertices that coincide bit for bit are merged.
            closed: whether the surface is meant to bound a volume.

        Raises:
            InputError: no triangle with area is left, or a coordinate is not finite.
        """
        points = np.asarray(mesh.vertices, dtype=np.float64).reshape(-1, 3) + 0.0
        triangles = np.asarray(mesh.faces, dtype=np.int64).reshape(-1, 3)
        if not np.isfinite(points).all():
            raise InputError("mesh has vertices that are not finite; rebuild the part from finite dimensions")
        vertices, index = _welded(points)
        faces = index[triangles]
        corner = vertices[faces]
        area = length(cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]))
        faces = faces[area > 0.0]
        if len(faces) == 0:
            raise InputError(f"mesh with {len(triangles)} triangles has none with area > 0; give it at least one")
        used, index = np.unique(faces, return_inverse=True)
        return cls(np.ascontiguousarray(vertices[used]), np.ascontiguousarray(index.reshape(-1, 3).astype(np.int32)), closed)

    @cached_property
    def lower(self) -> F64:
        """Least corner of the local bounding box [m], shape (3,)."""
        return np.asarray(self.vertices.min(axis=0))

    @cached_property
    def upper(self) -> F64:
        """Greatest corner of the local bounding box [m], shape (3,)."""
        return np.asarray(self.vertices.max(axis=0))

    @cached_property
    def size(self) -> float:
        """Diagonal of the local bounding box [m]."""
        return float(np.linalg.norm(self.upper - self.lower))

    @cached_property
    def sphere_center(self) -> F64:
        """Centre of a bounding sphere (that of the bounding box) [m], shape (3,)."""
        return 0.5 * (self.lower + self.upper)

    @cached_property
    def sphere_radius(self) -> float:
        """Radius of the bounding sphere about `sphere_center` [m]."""
        return float(length(self.vertices - self.sphere_center).max())

    @cached_property
    def triangles(self) -> F64:
        """Corners of all triangles [m], shape (m, 3, 3)."""
        return np.ascontiguousarray(self.vertices[self.faces])

    @cached_property
    def face_bounds(self) -> tuple[F64, F64]:
        """Bounding box of each triangle [m]: least and greatest corners, shape (m, 3) each."""
        return np.asarray(self.triangles.min(axis=1)), np.asarray(self.triangles.max(axis=1))

    @cached_property
    def face_normals(self) -> F64:
        """Outward unit normals, shape (m, 3)."""
        t = self.triangles
        n = cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
        return np.asarray(n / length(n)[:, None])

    @cached_property
    def planes(self) -> tuple[F64, F64]:
        """Outward normals of the triangles, shape (m, 3), and offsets of their planes [m], shape (m,)."""
        return self.face_normals, np.einsum("ij,ij->i", self.face_normals, self.triangles[:, 0])

    @cached_property
    def edges(self) -> I32:
        """Unique undirected edges as vertex indices, shape (e, 2)."""
        pairs = np.sort(self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
        keys = np.sort(pairs[:, 0] * len(self.vertices) + pairs[:, 1])
        keys = keys[np.concatenate([[True], keys[1:] != keys[:-1]])]
        return np.asarray(np.stack(np.divmod(keys, len(self.vertices)), axis=1), dtype=np.int32)

    @cached_property
    def is_watertight(self) -> bool:
        """True if every directed edge is met by its opposite exactly as often (no rim, consistent winding)."""
        directed = self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
        n = len(self.vertices)
        forth = np.sort(directed[:, 0] * n + directed[:, 1])
        back = np.sort(directed[:, 1] * n + directed[:, 0])
        return bool(np.array_equal(forth, back))

    @cached_property
    def convex(self) -> bool:
        """True if it is closed, watertight and no vertex stands above any face plane (1e-9 of the size)."""
        if not (self.closed and self.is_watertight):
            return False
        offsets = self.planes[1]
        step = max(1, CHUNK // len(self.vertices))
        # A few faces tell of most solids that are not convex.
        few = np.linspace(0, len(self.faces) - 1, min(FEW_FACES, len(self.faces))).astype(np.intp)
        rest = (slice(i, i + step) for i in range(0, len(self.faces), step)) if len(few) < len(self.faces) else ()
        blocks: list[slice | NDArray[np.intp]] = [few, *rest]
        for rows in blocks:
            highest = (self.face_normals[rows] @ self.vertices.T).max(axis=1)
            if (highest - offsets[rows]).max() > CONVEX_TOLERANCE * self.size:
                return False
        return True

    @cached_property
    def facets(self) -> Facets:
        """Merged faces of a convex solid.

        Raises:
            InputError: the solid is not convex.
        """
        if not self.convex:
            raise InputError("facets exist for convex solids only; query this one through its triangles")
        offsets = self.planes[1]
        step = max(1, CHUNK // len(self.vertices))
        bits = []
        for i in range(0, len(self.faces), step):
            height = self.face_normals[i : i + step] @ self.vertices.T - offsets[i : i + step, None]
            bits.append(np.packbits(height > -COPLANAR * self.size, axis=1))
        packed = np.ascontiguousarray(np.concatenate(bits))
        # Rows as whole byte strings, which compare the same and much faster than column by column.
        _, first, label = np.unique(packed.view(f"V{packed.shape[1]}").reshape(-1), return_index=True, return_inverse=True)
        keys = packed[first]
        members = np.unpackbits(keys, axis=1, count=len(self.vertices)).view(np.bool_)
        t = self.triangles
        area = length(cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]))
        order = np.lexsort((area, label))
        largest = order[np.searchsorted(label[order], np.arange(len(keys)), side="right") - 1]
        normals = self.face_normals[largest]
        first = t[largest, 1] - t[largest, 0]
        first /= np.linalg.norm(first, axis=1)[:, None]
        sums = [members[i : i + step] @ self.vertices for i in range(0, len(keys), step)]
        centers = np.concatenate(sums) / members.sum(axis=1)[:, None]
        return Facets(
            normals=normals,
            offsets=np.einsum("ij,ij->i", normals, t[largest, 0]),
            centers=centers,
            tangents=np.stack([first, cross(normals, first)], axis=1),
            members=members,
            edges=self._sharp_edges(label),
        )

    def _sharp_edges(self, label: NDArray[np.intp]) -> I32:
        pairs = np.sort(self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        count = len(self.vertices)
        key, index = np.unique(pairs[:, 0].astype(np.int64) * count + pairs[:, 1], return_inverse=True)
        side = np.repeat(label, 3)
        low = np.full(len(key), np.iinfo(np.int64).max)
        high = np.full(len(key), -1)
        np.minimum.at(low, index, side)
        np.maximum.at(high, index, side)
        return np.asarray(np.stack(np.divmod(key[low != high], count), axis=1), dtype=np.int32)

    @cached_property
    def volume(self) -> float:
        """Enclosed volume by the divergence theorem [m^3]; negative where the winding is inside out."""
        t = self.triangles - self.sphere_center
        return float(np.einsum("ij,ij->i", t[:, 0], cross(t[:, 1], t[:, 2])).sum() / 6.0)

    @cached_property
    def area(self) -> float:
        """Area of the surface [m^2]."""
        t = self.triangles
        return float(0.5 * length(cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])).sum())

    @cached_property
    def center(self) -> F64:
        """Centroid of the enclosed volume [m], shape (3,); of the surface where the volume is zero."""
        t = self.triangles - self.sphere_center
        six = np.einsum("ij,ij->i", t[:, 0], cross(t[:, 1], t[:, 2]))
        if not self.closed or abs(self.volume) < 1e-14 * self.size**3:
            weight = length(cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]))
            return np.asarray(self.sphere_center + (weight[:, None] * t.mean(axis=1)).sum(axis=0) / weight.sum())
        return np.asarray(self.sphere_center + (six[:, None] * t.sum(axis=1)).sum(axis=0) / (24.0 * self.volume))

    def inertia(self, density: float) -> F64:
        """Inertia tensor about the centroid [kg m^2], shape (3, 3), for a uniform density [kg/m^3].

        Second moments of signed tetrahedra (exact for polyhedra): the integral of x x^T over a tetrahedron with one
        corner at the origin is det / 120 * (sum_i v_i v_i^T + (sum_i v_i)(sum_i v_i)^T).
        Source: Blow and Binstock (2004), "How to find the inertia tensor of a 3D solid body".
        """
        t = self.triangles - self.center
        det = np.einsum("ij,ij->i", t[:, 0], cross(t[:, 1], t[:, 2]))
        total = t.sum(axis=1)
        second = np.einsum("f,fki,fkj->ij", det, t, t) + np.einsum("f,fi,fj->ij", det, total, total)
        second *= density / 120.0
        return np.asarray(np.trace(second) * np.eye(3) - second)

    @cached_property
    def bvh(self) -> Any:
        """The mesh as an `fcl.BVHModel` in local coordinates."""
        import fcl

        model = fcl.BVHModel()
        model.beginModel(len(self.vertices), len(self.faces))
        model.addSubModel(self.vertices, self.faces)
        model.endModel()
        return model

    @cached_property
    def component(self) -> I32:
        """Connected component of each vertex, shape (n,)."""
        return connected(len(self.vertices), self.edges)

    @cached_property
    def interior_point(self) -> F64 | None:
        """A point well inside a closed solid [m], shape (3,); None for open ones."""
        if not self.closed:
            return None
        if self.convex:
            return self.center
        from .inside import contains, distance_to_surface

        few = np.linspace(0, len(self.faces) - 1, min(len(self.faces), 32)).astype(int)
        steps = self.size * np.array([0.2, 0.05, 0.0125, 0.003, 1e-4])
        inward = self.triangles[few].mean(axis=1)[:, None] - steps[None, :, None] * self.face_normals[few][:, None]
        points = np.concatenate([self.center[None], inward.reshape(-1, 3)])
        distance, _ = distance_to_surface(self, points)
        depth = np.where(contains(self, points), distance, -1.0)
        best = int(depth.argmax())
        return points[best] if depth[best] > 0.0 else None

    @cached_property
    def vertex_tree(self) -> Any:
        """k-d tree over the vertices."""
        from scipy.spatial import cKDTree

        return cKDTree(self.vertices)

    @cached_property
    def centroid_tree(self) -> Any:
        """k-d tree over the triangle centroids."""
        from scipy.spatial import cKDTree

        return cKDTree(self.centroids)

    @cached_property
    def centroids(self) -> F64:
        """Centroids of the triangles [m], shape (m, 3)."""
        return np.asarray(self.triangles.mean(axis=1))

    @cached_property
    def reaches(self) -> F64:
        """Largest distance from the centroid of each triangle to its corners [m], shape (m,)."""
        return np.asarray(length(self.triangles - self.centroids[:, None]).max(axis=1))

    @cached_property
    def common_reach(self) -> float:
        """Twice the reach that nine in ten triangles stay below [m]."""
        return 2.0 * float(np.quantile(self.reaches, 0.9))

    @cached_property
    def large_faces(self) -> NDArray[np.intp]:
        """The few triangles beyond `common_reach`."""
        return np.flatnonzero(self.reaches > self.common_reach)

    @cached_property
    def coplanar(self) -> I32:
        """Label of each triangle: equal for coplanar triangles joined across their edges, shape (m,)."""
        pairs = np.sort(self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1).astype(np.int64)
        key = pairs[:, 0] * len(self.vertices) + pairs[:, 1]
        order = np.argsort(key, kind="stable")
        same = np.flatnonzero(key[order][1:] == key[order][:-1])
        joined = np.stack([order[same] // 3, order[same + 1] // 3], axis=1)
        turn = np.linalg.norm(self.face_normals[joined[:, 0]] - self.face_normals[joined[:, 1]], axis=1)
        return connected(len(self.faces), joined[turn < CONVEX_TOLERANCE])

    @cached_property
    def ray_grid(self) -> RayGrid:
        """Grid for winding numbers of large watertight meshes."""
        return RayGrid(self.triangles)

    @cached_property
    def component_heads(self) -> F64:
        """One vertex of each connected component [m], shape (k, 3)."""
        if self.convex and len(self.vertices) - len(self.edges) + len(self.faces) == 2:  # Euler's formula of one piece
            return self.vertices[:1]
        return np.asarray(self.vertices[np.unique(self.component, return_index=True)[1]])


def _welded(points: F64) -> tuple[F64, NDArray[np.intp]]:
    """Different points in order of x, y and z, and which of them each is; `numpy.unique` of rows takes several times as long."""
    order = np.lexsort((points[:, 2], points[:, 1], points[:, 0]))
    ordered = points[order]
    new = np.ones(len(points), dtype=bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    index = np.empty(len(points), dtype=np.intp)
    index[order] = np.cumsum(new) - 1
    return ordered[new], index


def connected(count: int, edges: NDArray[Any]) -> I32:
    """Label connected components of `count` nodes joined by `edges`, shape (e, 2)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(edges), dtype=np.int8), (edges[:, 0], edges[:, 1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int32)
