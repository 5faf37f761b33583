"""Solids that a liquid has wetted: darker and glossier where a film of it is left (R99).

Surfaces near places that are ever wet are cut into small triangles, and their corners carry the share of the film that is left at
a frame. Under clear liquid the solid shows dry: there the light that turns back under the liquid's own face darkens it already.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ....worlds.arrays import F32, F64
from ....worlds.candidate import Candidate
from ....worlds.categories.liquid.wet import WetMap
from ...tracer.surfaces import Surface
from .meshes import look_of

__all__ = ["Link", "Wetness", "darkened", "film_at", "finely"]

INDEX = 1.33
"""Refractive index of the film; other liquids differ by less than 0.15."""
NEAR = 4
"""Places of the wet map that a corner takes its film from."""
REACH = 2.5
"""[distances of places] Farther ones tell nothing."""
ALIKE = 0.5
"""Least cosine between the normals of a corner and of a place that is on its side."""
COVERED = (0.5, 1.5)
"""[spacings] Depth from none to all of which what is wet counts as seen through the liquid."""
Link = tuple[str, Any, F64]
"""Instance, places about every corner (v, NEAR), their weights."""
ROUNDS = 40
"""Most halvings of a triangle's longest edge."""


def darkened(color: Any) -> Any:
    """Diffuse reflectance under a film: A / (A + n^2 (1 - A)) by Angstrom (1925), doi:10.2307/519996."""
    a = np.asarray(color, dtype=np.float64)
    return a / (a + INDEX**2 * (1.0 - a))


def finely(surface: Surface, chosen: Any, size: float) -> Surface:
    """The surface with the chosen triangles halved until no edge of theirs is longer than `size` [m]."""
    keep, fine = surface.faces[~chosen], surface.faces[chosen]
    values = np.concatenate([surface.positions, surface.normals, surface.uv], axis=1)
    for _ in range(ROUNDS):
        corner = values[fine, :3]
        edge = np.linalg.norm(np.roll(corner, -1, axis=1) - corner, axis=2)
        long = edge.max(axis=1) > size
        if not long.any():
            break
        # The longest edge first, turned to be that from corner 0 to 1; shared edges meet at one new corner each.
        turn = (edge[long].argmax(axis=1)[:, None] + np.arange(3)) % 3
        split = np.take_along_axis(fine[long], turn, axis=1)
        ends, middle = np.unique(np.sort(split[:, :2], axis=1), axis=0, return_inverse=True)
        new = (len(values) + middle.reshape(-1)).astype(fine.dtype)
        values = np.concatenate([values, 0.5 * (values[ends[:, 0]] + values[ends[:, 1]])])
        a, b, c = split.T
        fine = np.concatenate([fine[~long], np.stack([a, new, c], axis=1), np.stack([new, b, c], axis=1)])
    normals = values[:, 3:6] / np.maximum(np.linalg.norm(values[:, 3:6], axis=1), 1e-12)[:, None]
    return Surface(values[:, :3], normals, values[:, 6:], np.concatenate([keep, fine]).astype(np.int32))


@dataclass(frozen=True, eq=False)
class Wetness:
    """Film of all liquids of a candidate on its solids, for those who draw them."""

    candidate: Candidate

    @cached_property
    def maps(self) -> dict[str, WetMap]:
        """Complete wet maps by instance."""
        found = {n: WetMap(c) for n, c in self.candidate.liquid_caches.items()}
        return {n: m for n, m in found.items() if m.count() >= m.cache.index.frames > 0}

    @cached_property
    def _ever(self) -> dict[str, Any]:
        """Which places are ever wet."""
        return {n: np.isfinite(m.state(m.cache.index.frames - 1).last) for n, m in self.maps.items()}

    def entities(self) -> frozenset[str]:
        """Solids that are ever wet."""
        found = set()
        for name, wet in self.maps.items():
            found |= {wet.texels.parts[k][0] for k in np.unique(wet.texels.part[self._ever[name]])}
        return frozenset(found)

    def refined(self, entity: str, body: str, part: str, surface: Surface) -> Surface:
        """A part's surface, cut finely where it is ever wet; places are known to about half a spacing."""
        from scipy.spatial import cKDTree

        chosen, size = np.zeros(len(surface.faces), dtype=bool), np.inf
        for name, wet in self.maps.items():
            rows = self._rows(name, entity, body, part)
            rows = rows[self._ever[name][rows]]
            if not len(rows):
                continue
            size = min(size, 2.0 * wet.texels.size)
            reach = REACH * wet.texels.size
            corner = surface.positions[surface.faces]
            places = wet.texels.position[rows]
            low, high = corner.min(axis=1) - reach, corner.max(axis=1) + reach
            # Large triangles by their boxes, small ones by their middles.
            middle, radius = corner.mean(axis=1), np.linalg.norm(corner - corner.mean(axis=1, keepdims=True), axis=2).max(axis=1)
            near = cKDTree(places).query(middle)[0] <= radius + reach
            chosen |= near & (high >= places.min(axis=0)).all(axis=1) & (low <= places.max(axis=0)).all(axis=1)
        return finely(surface, chosen, size) if chosen.any() else surface

    def _rows(self, name: str, entity: str, body: str, part: str) -> Any:
        texels = self.maps[name].texels
        number = [k for k, n in enumerate(texels.parts) if n == (entity, body, part)]
        return np.flatnonzero(texels.part == number[0]) if number else np.zeros(0, dtype=np.intp)

    def links(self, entity: str, body: str, part: str, surface: Surface) -> list[Link]:
        """Per instance, the places about every corner of a part's surface (v, NEAR) and their weights, which sum to 1 or 0."""
        from scipy.spatial import cKDTree

        found = []
        for name, wet in self.maps.items():
            rows = self._rows(name, entity, body, part)
            if not len(rows):
                continue
            gap, at = cKDTree(wet.texels.position[rows]).query(
                surface.positions, k=NEAR, distance_upper_bound=REACH * wet.texels.size
            )
            there = np.isfinite(gap)
            at = rows[np.minimum(at, len(rows) - 1)]
            facing = np.einsum("vkx,vx->vk", wet.texels.normal[at], surface.normals)
            weight = np.where(there & (facing > ALIKE), 1.0 / (np.where(there, gap, 1.0) + 0.1 * wet.texels.size) ** 2, 0.0)
            total = weight.sum(axis=1, keepdims=True)
            found.append((name, at, np.where(total > 0, weight / np.maximum(total, 1e-300), 0.0)))
        return found

    def film(self, name: str, frame: int) -> F64:
        """Share of the film that is seen at every place of an instance's map, shape (t,)."""
        wet, spec = self.maps[name], self.candidate.spec
        looks = [spec.materials[spec.entities[b].material] for b in wet.cache.index.bodies]
        state = wet.state(frame)
        share = state.film(frame / wet.cache.index.fps, np.array([m.appearance.drying for m in looks]))
        clear = np.array([look_of(m).clear for m in looks])[np.maximum(state.fluid, 0)]
        low, high = (c * float(wet.about()["touch"]) for c in COVERED)
        t = np.clip((np.nan_to_num(state.depth, nan=0.0) - low) / (high - low), 0.0, 1.0)
        return np.asarray(np.where(clear, share * (1.0 - t * t * (3.0 - 2.0 * t)), share))


def film_at(wetness: Wetness, links: list[Link], count: int, frame: int, known: dict[str, F64]) -> F32:
    """Film at the corners of a surface at a frame, shape (v,): the most that any instance left."""
    found = np.zeros(count)
    for name, at, weight in links:
        if name not in known:
            known[name] = wetness.film(name, frame)
        found = np.maximum(found, (known[name][at] * weight).sum(axis=1))
    return found.astype(np.float32)
