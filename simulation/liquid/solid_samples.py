"""Samples that fill a solid near its surface, so that sums over them are integrals of the kernel over the solid.

The integral is as smooth as the kernel and ends where the solid ends: liquid at rest then stands half a spacing off every surface,
as in a lattice that goes on behind it (Koschier and Bender 2017, density maps; here the integral is a midpoint sum over cells of
half a spacing, with the parts of cells that the surface cuts).
"""

from __future__ import annotations

import numpy as np

from ...geometry.launch import launch, warp
from ...worlds.arrays import F64, I64
from ...worlds.built import TriangleMesh

__all__ = ["CELL", "DEPTH", "fill_solid"]

CELL = 0.5
"""Size of a cell in spacings: a quarter of the kernel's support, for which sums are smooth."""
DEPTH = 1.8
"""Depth in spacings down to which a solid is filled: its kernel reaches 2 from a particle that keeps a quarter."""
WEIGHT = 1.0436
"""Factor on all volumes: midpoint sums count 0.1799 at half a spacing from a plane, where the integral is 0.1878."""
CHUNK = 1 << 21
"""Cells judged at once."""


def fill_solid(mesh: TriangleMesh, spacing: float, *, lower: F64 | None = None, upper: F64 | None = None) -> tuple[F64, F64]:
    """Centres (n, 3) [m] and volumes (n,) [m^3] of the filled parts of cells within DEPTH of the surface, in the mesh's frame.

    Args:
        mesh: closed, outward faces.
        spacing: distance of liquid particles [m].
        lower: only the part above this corner.
        upper: and below this one.
    """
    size = CELL * spacing
    low = mesh.vertices.min(axis=0) if len(mesh.vertices) else np.zeros(3)
    cells = _near(mesh, low, size, int(np.ceil(DEPTH / CELL)), lower, upper)
    wp = warp()
    surface = wp.Mesh(
        points=wp.array((mesh.vertices - low).astype(np.float32), dtype=wp.vec3, device="cpu"),
        indices=wp.array(mesh.faces.astype(np.int32).ravel(), dtype=wp.int32, device="cpu"),
        support_winding_number=True,
    )
    from .boundary_queries import inside_cells

    places, volumes = [np.zeros((0, 3))], [np.zeros(0)]
    for start in range(0, len(cells), CHUNK):
        center = (cells[start : start + CHUNK] + 0.5) * size
        points = wp.array(center.astype(np.float32), dtype=wp.vec3, device="cpu")
        moved = wp.zeros(len(center), dtype=wp.vec3, device="cpu")
        share = wp.zeros(len(center), dtype=wp.float32, device="cpu")
        launch(inside_cells, len(center), [surface.id, points, float(size), float(DEPTH * spacing), moved, share], device="cpu")
        part = share.numpy().astype(float)
        kept = part > 0
        places.append(moved.numpy().astype(float)[kept] + low)
        volumes.append(WEIGHT * part[kept] * size**3)
    place, volume = np.concatenate(places), np.concatenate(volumes)
    if lower is not None and upper is not None:
        kept = ((place >= lower) & (place <= upper)).all(axis=1)
        place, volume = place[kept], volume[kept]
    return place, volume


def _near(mesh: TriangleMesh, low: F64, size: float, layers: int, lower: F64 | None, upper: F64 | None) -> F64:
    """Numbers (n, 3) of the cells that may lie within some layers of a surface."""
    first = np.full(3, -np.inf) if lower is None else (np.asarray(lower) - low) / size - 1
    last = np.full(3, np.inf) if upper is None else (np.asarray(upper) - low) / size + 1
    blocks = np.unique(_touched((mesh.vertices[mesh.faces] - low) / (size * layers), first / layers, last / layers), axis=0)
    around = np.stack(np.meshgrid(*[np.arange(-1, 2)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    blocks = np.unique((blocks[:, None] + around).reshape(-1, 3), axis=0)
    inner = np.stack(np.meshgrid(*[np.arange(layers)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = (blocks[:, None] * layers + inner).reshape(-1, 3)
    kept = ((cells >= np.maximum(first, -1)) & (cells <= last)).all(axis=1)
    return np.asarray(cells[kept], dtype=float)


def _touched(corner: F64, first: F64, last: F64) -> I64:
    """Numbers (n, 3) of the unit blocks that triangles (t, 3, 3) may touch, between two blocks."""
    low = np.floor(np.maximum(corner.min(axis=1), first)).astype(np.int64)
    high = np.floor(np.minimum(corner.max(axis=1), last)).astype(np.int64)
    seen = (low <= high).all(axis=1)
    corner, low, high = corner[seen], low[seen], high[seen]
    small = (high - low <= 1).all(axis=1)
    found = [np.where(np.array(bits, dtype=bool), high[small], low[small]) for bits in np.ndindex(2, 2, 2)]
    for one, a, b in zip(corner[~small], low[~small], high[~small], strict=True):
        normal = np.cross(one[1] - one[0], one[2] - one[0])
        normal /= max(float(np.linalg.norm(normal)), 1e-300)
        axis = int(np.argmax(np.abs(normal)))
        flat = [k for k in range(3) if k != axis]
        across = np.stack(np.meshgrid(*[np.arange(a[k], b[k] + 1) for k in flat], indexing="ij"), axis=-1).reshape(-1, 2)
        plane = one[0][axis] - ((across + 0.5) - one[0][flat]) @ normal[flat] / normal[axis]
        spread = 0.5 * np.abs(normal[flat]).sum() / abs(normal[axis])
        for k in range(int(np.ceil(2 * spread)) + 2):
            block = np.zeros((len(across), 3), dtype=np.int64)
            block[:, flat] = across
            block[:, axis] = np.floor(plane - spread).astype(np.int64) + k
            found.append(block[(block[:, axis] >= a[axis]) & (block[:, axis] <= b[axis])])
    return np.concatenate([np.zeros((0, 3), dtype=np.int64), *found])
