"""Gases of a candidate as boxes of cells at a frame: what of them pictures see."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ....worlds.arrays import F32, F64
from ....worlds.cache import Cache
from ....worlds.candidate import Candidate
from ....worlds.errors import EvidenceError
from ...glow import COLD
from .look import GasLook, look_of

__all__ = ["FAINT", "THICK", "GasBox", "Sights", "cropped", "extents_of", "gases_of", "marched"]

FAINT = 1e-4
"""[1] Own choice: optical depth across a whole box below which a cell counts as empty; a thousandth of what eight bits show."""
THICK = 0.25
"""[1] Own choice: optical depth from which on a pixel counts as the gas's: a fifth of the light from behind is gone."""
STEP = 0.7
"""[cells] Own choice: between two looks along a ray."""
MOST_LOOKS = 600
"""Own choice: looks along the diagonal of a box."""


class GasBox(NamedTuple):
    """Cells of one gas at a frame."""

    sigma: F32
    """Extinction at cell centres [1/m], shape (nx, ny, nz)."""
    temperature: F32
    """[K], the same shape."""
    low: F64
    """Lower corner of the first cell [m], shape (3,)."""
    cell: float
    """[m]"""
    look: GasLook

    @property
    def high(self) -> F64:
        """Upper corner of the last cell [m], shape (3,)."""
        return np.asarray(self.low + self.cell * np.array(self.sigma.shape))

    @property
    def hot(self) -> bool:
        """True where any of it glows."""
        return bool((self.temperature > COLD).any())

    @property
    def diagonal(self) -> float:
        """[m]"""
        return self.cell * float(np.linalg.norm(self.sigma.shape))

    @property
    def centers(self) -> F64:
        """Centres of all cells [m], shape (nx, ny, nz, 3)."""
        axes = [self.low[k] + self.cell * (np.arange(n) + 0.5) for k, n in enumerate(self.sigma.shape)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


def cropped(box: GasBox, depth: float = FAINT) -> GasBox | None:
    """The least box that holds all cells of a gas of which a whole box would have an optical depth, and a cell more; None where none has."""
    full = np.argwhere(box.sigma > depth / box.diagonal)
    if not len(full):
        return None
    first, last = np.maximum(full.min(0) - 1, 0), np.minimum(full.max(0) + 2, box.sigma.shape)
    cut = tuple(slice(a, b) for a, b in zip(first.tolist(), last.tolist(), strict=True))
    sigma, temperature = np.ascontiguousarray(box.sigma[cut]), np.ascontiguousarray(box.temperature[cut])
    return GasBox(sigma, temperature, box.low + box.cell * first, box.cell, box.look)


@dataclass(frozen=True)
class Gas:
    """One gas of a candidate."""

    candidate: Candidate
    entity: str
    cache: Cache

    @cached_property
    def look(self) -> GasLook:
        """Look of its material."""
        return look_of(self.candidate.spec.materials[self.candidate.spec.entities[self.entity].material])

    def at(self, frame: int) -> GasBox | None:
        """Its cells at a frame; None where nothing of it is seen.

        Raises:
            EvidenceError: the cache is damaged.
        """
        names = ("gas_soot", "gas_temperature", "gas_corner")
        found = self.cache.read(min(frame, self.cache.index.frames - 1), names)
        sigma = np.maximum(np.nan_to_num(found["gas_soot"]), 0.0).astype(np.float32) * np.float32(self.look.extinction)
        cell = self.candidate.spec.entities[self.entity].physics.flow_cell
        return cropped(GasBox(sigma, found["gas_temperature"], np.array(found["gas_corner"], dtype=np.float64), cell, self.look))


def gases_of(candidate: Candidate) -> list[Gas]:
    """Gases of a candidate that caches hold, by entity id.

    Raises:
        EvidenceError: a cache lacks its index or names what is no entity.
    """
    found = {e: c for c in candidate.gas_caches.values() for e in c.index.bodies}
    missing = [e for e in found if e not in candidate.spec.entities]
    if missing:
        raise EvidenceError(f"the cache holds gases {missing[:3]} that the specification does not have; bake again")
    return [Gas(candidate, e, found[e]) for e in sorted(found)]


def extents_of(candidate: Candidate) -> list[tuple[F64, F64]]:
    """Corners of the boxes of what is seen of each gas in the middle of a run and at its end, each (3,) [m]."""
    frames = {candidate.last_frame // 2, candidate.last_frame}
    found = [gas.at(k) for gas in gases_of(candidate) for k in sorted(frames)]
    boxes = [cropped(box, THICK) for box in found if box is not None]
    return [(box.low, box.high) for box in boxes if box is not None]


class Sights(NamedTuple):
    """Rays through a gas."""

    tau: F64
    """Optical depth (n,)."""
    reach: F64
    """Distance at which it passes `THICK` [m], infinite where it does not, shape (n,)."""
    gain: F64
    """Radiance that the gas sends back (n, 3)."""


def marched(box: GasBox, eyes: F64, ways: F64, spans: F64, source: F32 | None = None) -> Sights:
    """Rays through a box.

    Args:
        box: the gas.
        eyes: where they start [m], shape (n, 3) or (1, 3).
        ways: unit directions, shape (n, 3) or (1, 3).
        spans: first and last distance along each [m], shape (n, 2).
        source: radiance of thick gas by cell, shape (nx, ny, nz, 3); None where no light is asked for.
    """
    from .march_kernels import march  # numba compiles it

    count = len(spans)
    sights = Sights(np.zeros(count), np.full(count, np.inf), np.zeros((count, 3)))
    light = np.zeros((0, 0, 0, 3), np.float32) if source is None else source
    step = max(STEP * box.cell, box.diagonal / MOST_LOOKS)
    rays = (np.ascontiguousarray(one, dtype=np.float64) for one in (eyes, ways, spans))
    march(box.sigma, light, np.stack([box.low, box.high]), box.cell, *rays, step, THICK, *sights)
    return sights
