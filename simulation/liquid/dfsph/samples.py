"""Samples of the boundaries of a particle liquid: where they lie, and in the order of their cells on a device."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....geometry import Solid
from ....geometry.inside import nearest_faces
from ....geometry.launch import warp
from ....worlds.arrays import F64, I32
from ....worlds.built import TriangleMesh
from ..boundary import Sampled, sample_surface
from ..engine import LiquidSetup
from ..solid_samples import fill_solid

if TYPE_CHECKING:
    from ...passes import Passes

__all__ = ["Samples", "sampled_boundaries", "stays"]


def stays(boundary: Any) -> bool:
    """True if a boundary never moves."""
    return boundary.motion == "static" and not boundary.deforming


def sampled_boundaries(setup: LiquidSetup) -> list[Sampled]:
    """Samples of every boundary; of fixed ones only what liquid can meet (moving ones are sampled whole)."""
    return [_sampled(setup, k) for k in range(len(setup.boundaries))]


def _sampled(setup: LiquidSetup, row: int) -> Sampled:
    boundary, margin = setup.boundaries[row], 2.0 * setup.spacing
    box: dict[str, Any] = {"lower": None, "upper": None}
    if stays(boundary):
        box = {"lower": np.asarray(setup.lower) - margin, "upper": np.asarray(setup.upper) + margin}
    if not boundary.closed:
        return sample_surface(boundary.mesh, setup.spacing, seed=setup.seed + row, **box)
    place, volume = fill_solid(boundary.mesh, setup.spacing, **box)
    if boundary.deforming and len(place):
        return Sampled(place, volume, *_on_surface(boundary.mesh, place))
    return Sampled(place, volume, np.zeros(len(place), dtype=np.int32), np.zeros((len(place), 3)))


def _on_surface(mesh: TriangleMesh, place: F64) -> tuple[I32, F64]:
    """Faces nearest to places, and barycentric weights of the nearest points on them."""
    _, point, face = nearest_faces(Solid.from_mesh(mesh, closed=True), place)
    a, b, c = (mesh.vertices[mesh.faces[face, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    double = np.maximum((normal**2).sum(axis=1), 1e-300)
    v = (np.cross(point - a, c - a) * normal).sum(axis=1) / double
    w = (np.cross(b - a, point - a) * normal).sum(axis=1) / double
    return face.astype(np.int32), np.stack([1.0 - v - w, v, w], axis=1)


class Samples:
    """Samples of several bodies on a device, in the order of their cells."""

    def __init__(self, device: str, local: F64, volume: F64, body: Any, cells: int) -> None:
        from .boundary_kernels import Samples as Arranged

        wp = warp()
        self.count = n = len(local)
        self.local = wp.array(np.asarray(local, dtype=np.float32), dtype=wp.vec3, device=device)
        self.volume = wp.array(np.asarray(volume, dtype=np.float32), dtype=wp.float32, device=device)
        self.body = wp.array(np.asarray(body, dtype=np.int32), dtype=wp.int32, device=device)
        self.x = wp.zeros(n, dtype=wp.vec3, device=device)
        self.stays = wp.zeros(n, dtype=wp.int32, device=device)
        self.key, self.index = (wp.zeros(2 * n, dtype=wp.int32, device=device) for _ in range(2))
        self.arranged = out = Arranged()
        out.count = n
        out.x = wp.zeros(n, dtype=wp.vec3, device=device)
        out.volume = wp.zeros(n, dtype=wp.float32, device=device)
        out.body = wp.zeros(n, dtype=wp.int32, device=device)
        out.span = wp.zeros(cells if n else 1, dtype=wp.vec2i, device=device)
        self._sorted = False

    def arrange(self, passes: Passes, name: str, rotation: Any, position: Any, grid: list[Any]) -> None:
        """Carry the samples with their bodies and sort them into cells."""
        from . import boundary_kernels as kernels
        from . import grid_kernels

        n, out = self.count, self.arranged
        out.low, out.inverse, out.size = grid
        if n == 0:
            return
        if self._sorted:
            passes(name + "clear", grid_kernels.clear_spans, n, [self.key, out.span])()
        passes(name + "place", kernels.place, n, [self.local, self.body, rotation, position, self.x])()
        passes(name + "keys", grid_kernels.keys, n, [self.x, self.stays, *grid, self.key, self.index])()
        warp().utils.radix_sort_pairs(self.key, self.index, n)
        passes(name + "arrange", kernels.arrange, n, [self.index, self.x, self.volume, self.body, out])()
        passes(name + "spans", grid_kernels.spans, n, [n, self.key, out.span])()
        self._sorted = True
