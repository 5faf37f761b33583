"""Ground without a landscape: flat, a slope, or hills of noise, as heights in the specification."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..worlds.arrays import F64
from ..worlds.limits import check_limits
from ..worlds.patch import apply_patch
from .landscapes import ground_material, membership
from .session import Session

__all__ = ["PlainGround", "lay"]

BASE = 0.5
"""Thickness of the ground below its lowest point [m]."""
OCTAVES, WAVES = 5, 4
"""Wave numbers of hills, and waves of each."""


@dataclass(frozen=True)
class PlainGround:
    """Shape of a ground without a landscape."""

    kind: Literal["flat", "slope", "hills"]
    size: tuple[float, float]
    """Extent x, y [m]."""
    cells: int
    """Along the longer side."""
    relief: float
    """Rise of a slope, or height range of hills [m]."""
    plain_radius: float
    """Radius of the level circle among hills [m]."""
    seed: int

    def heights(self) -> F64:
        """Heights [m], rows from south to north."""
        longer = max(self.size)
        x, y = (np.linspace(-s / 2, s / 2, max(2, round(self.cells * s / longer)) + 1) for s in self.size)
        xx, yy = np.meshgrid(x, y)
        if self.kind == "flat" or self.relief == 0:
            return np.zeros_like(xx)
        if self.kind == "slope":
            return self.relief * (xx + self.size[0] / 2) / self.size[0]
        return self._hills(xx, yy)

    def _hills(self, xx: F64, yy: F64) -> F64:
        """Sum of plane waves with amplitude falling as 1 / wave number: a landscape without ridges or steps."""
        longer, rng, z = max(self.size), np.random.default_rng(self.seed), np.zeros_like(xx)
        for octave in range(1, OCTAVES + 1):
            for _ in range(WAVES):
                angle, phase = rng.uniform(0, 2 * np.pi, 2)
                k = 2 * np.pi * octave / longer
                z += np.sin(k * (xx * np.cos(angle) + yy * np.sin(angle)) + phase) / octave
        z = (z - z.min()) / np.ptp(z) * self.relief
        away = np.hypot(xx, yy) - self.plain_radius
        fade = np.clip(away / max(self.plain_radius, 0.2 * longer), 0, 1)
        hills: F64 = z * fade * fade * (3 - 2 * fade)
        return hills


def lay(session: Session, entity: str, ground: PlainGround, material: str | None, hypothesis: str) -> dict[str, Any]:
    """Make the ground the next revision of a world; its heights, cells and the revision for the reply."""
    z = ground.heights().round(6)
    low, high = float(z.min()), float(z.max())
    shape = {"kind": "heightfield", "size": list(ground.size), "heights": z.tolist(), "base": BASE}
    contract = {
        "role": f"ground ({ground.kind})",
        "motion": "static",
        "material": ground_material(session.spec, material),
        "dimensions": {"size": [*ground.size, high - low + BASE]},
        "parts": {"land": {"shape": shape}},
    }
    patch: list[dict[str, Any]] = [{"op": "add", "path": f"/entities/{entity}", "value": contract}]
    patch += membership(session.spec, entity)
    after = apply_patch(session.spec, patch)
    check_limits(after)
    outcome = session.commit(after, patch=patch, hypothesis=hypothesis)
    rows, columns = z.shape
    return {**outcome, "height_range": [low, high], "cells": [columns - 1, rows - 1]}
