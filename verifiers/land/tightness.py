"""Judges whether the ground holds water: no holes in a landscape, closed grounds, no gaps between those that adjoin."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

from ...geometry import Solid, kept_solid
from ...worlds.errors import InputError
from ...worlds.landscape import SavedLandscape
from .bounds import SEAM
from .grounds import Patch, patches
from .landscapes import Measurement

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["tight_finding"]


def tight_finding(candidate: Candidate, name: str, land: SavedLandscape) -> Measurement:
    """Leaks of a landscape and of the grounds cut from it, and the place of the first [m]."""
    leaks = [*_holes(land), *_open_grounds(candidate, name), *_gaps(candidate, name, land)]
    grounds = len(patches(candidate.spec, name))
    text = "; ".join(t for t, _ in leaks[:4]) or f"the land has no hole, and its {grounds} grounds are closed and adjoin"
    return Measurement(float(len(leaks)), text, leaks[0][1] if leaks else None)


def _holes(land: SavedLandscape) -> list[tuple[str, tuple[float, float]]]:
    """Cells without land that land surrounds; those that reach the edge lie outside the land."""
    height = land.field("height")
    label, _ = ndimage.label(~np.isfinite(height), np.ones((3, 3)))
    outside = set(np.unique(np.concatenate([label[0], label[-1], label[:, 0], label[:, -1]])).tolist())
    found = []
    for number, where in enumerate(ndimage.find_objects(label), start=1):
        if number in outside or where is None:
            continue
        cells = np.argwhere(label[where] == number) + np.array([where[0].start, where[1].start])
        row, col = (float(v) for v in cells.mean(axis=0))
        place = (col - 0.5 * (height.shape[1] - 1)) * land.cell, (row - 0.5 * (height.shape[0] - 1)) * land.cell
        found.append((f"a hole of {len(cells)} cells at ({place[0]:.2f}, {place[1]:.2f})", place))
    return found


def _open_grounds(candidate: Candidate, name: str) -> list[tuple[str, tuple[float, float]]]:
    found = []
    for patch in patches(candidate.spec, name):
        built = next((p for p in candidate.entity(patch.entity).parts if p.part == patch.part), None)
        try:
            solid = None if built is None else kept_solid(built.render, closed=True)
        except InputError:
            solid = None
        if solid is not None and solid.is_watertight:
            continue
        place = _middle(patch) if solid is None else _rim(candidate, patch, solid)
        found.append((f"the surface of ground {patch.entity!r} is open at ({place[0]:.2f}, {place[1]:.2f})", place))
    return found


def _middle(patch: Patch) -> tuple[float, float]:
    x, y = 0.5 * (patch.low + patch.high)
    return float(x), float(y)


def _rim(candidate: Candidate, patch: Patch, solid: Solid) -> tuple[float, float]:
    """Places at which an edge is not met from its other side."""
    edges = solid.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    count = len(solid.vertices)
    lone = ~np.isin(edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0])
    where = solid.vertices[edges[lone][0]] if lone.any() else solid.vertices[:1]
    x, y, _ = candidate.pose(patch.entity, 0).apply(where).mean(axis=0)
    return float(x), float(y)


def _gaps(candidate: Candidate, name: str, land: SavedLandscape) -> list[tuple[str, tuple[float, float]]]:
    """Open strips between grounds whose sides face each other less than a cell of the landscape apart."""
    found = []
    for one, two in itertools.combinations(patches(candidate.spec, name), 2):
        apart = np.maximum(one.low - two.high, two.low - one.high)
        for axis in (0, 1):
            if not (SEAM < apart[axis] < land.cell and apart[1 - axis] < -SEAM):
                continue
            low, high = np.maximum(one.low, two.low), np.minimum(one.high, two.high)
            x, y = (float(v) for v in 0.5 * (low + high))
            text = f"a gap of {apart[axis]:.3g} m between the grounds {one.entity!r} and {two.entity!r} at ({x:.2f}, {y:.2f})"
            found.append((text, (x, y)))
    return found
