"""Refusal, by name and before anything runs, of geometry that a liquid's spacing cannot resolve (R58)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.walls import wall_thickness
from ...worlds.arrays import F64
from ...worlds.categories.liquid.facts import LEAST_SPACINGS, LEAST_WALL, WALL_SLACK
from ...worlds.errors import InputError
from .engine import Inflow, LiquidSetup
from .filling import PlacedSolid

__all__ = ["require_resolved"]

PITCH = 0.5
"""Cell of the grid on which passages are looked for, in spacings."""
MOST_CELLS = 8_000_000
"""Cells of that grid; above, the pitch grows to a whole spacing, and beyond that passages are not looked for."""
LEAST_ROOM = 27
"""Spacings cubed of a space behind a passage that counts."""


def require_resolved(setup: LiquidSetup, solids: Sequence[PlacedSolid], motion: Mapping[str, str], engine: str) -> None:
    """Refuse sources inside solids, walls that leak, and passages that liquid should pass but could not.

    Args:
        setup: the liquid.
        solids: parts of its boundaries at their places, named by their boundary.
        motion: of every boundary.
        engine: that will move it.

    Raises:
        InputError: names the inflow, the wall or the passage, its size and the spacing that would resolve it.
    """
    fixed = [s for s in solids if motion[s.name] != "dynamic"]
    for inflow in setup.inflows:
        _require_open(inflow, fixed, setup.spacing)
    for solid in fixed:
        corners = np.array([[solid.box[k >> a & 1][a] for a in range(3)] for k in range(8)])
        if motion[solid.name] == "static" and not _reachable(setup, corners).any():
            continue  # dry: what is wet after all is judged by where the liquid was
        thick = wall_thickness(solid.solid)
        if thick < (1.0 - WALL_SLACK) * LEAST_WALL[engine] * setup.spacing:
            place = ", ".join(f"{v:.3g}" for v in 0.5 * (solid.box[0] + solid.box[1]))
            raise InputError(
                f"{solid.name.split('/')[0]!r} is {thick:.3g} m thick about [{place}] m where it is thin, which a spacing of {setup.spacing:g} m does not "
                f"resolve; make it at least {LEAST_WALL[engine] * setup.spacing:.3g} m thick, or use a resolution of at most "
                f"{thick / LEAST_WALL[engine]:.3g} m"
            )
    _require_passages(setup, [s for s in solids if motion[s.name] == "static"])


def _require_open(inflow: Inflow, solids: Sequence[PlacedSolid], spacing: float) -> None:
    count = [max(2, round(2 * h / (0.5 * spacing)) + 1) for h in inflow.half_size]
    x, y = (np.linspace(-0.95, 0.95, n) * h for n, h in zip(count, inflow.half_size, strict=True))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    if inflow.round:
        grid = grid[((grid / np.array(inflow.half_size)) ** 2).sum(axis=1) <= 1.0]
    local = np.column_stack([grid, np.full(len(grid), 0.5 * spacing)])
    points = inflow.center + local @ inflow.rotation.T
    for solid in solids:
        share = float(solid.inside(points).mean())
        if share > 0.0:
            raise InputError(
                f"{share:.0%} of inflow {inflow.name!r} lies in {solid.name.split('/')[0]!r}; move it with "
                f"/simulation/drivers/{inflow.name}/pose or make it smaller"
            )


def _require_passages(setup: LiquidSetup, static: Sequence[PlacedSolid]) -> None:
    """Refuse a space that liquid would reach through a passage narrower than `LEAST_SPACINGS`, and only through it."""
    from scipy import ndimage

    grid = _grid(setup)
    if grid is None or not static:
        return
    axes, points, pitch = grid
    shape = (len(axes[0]), len(axes[1]), len(axes[2]))
    blocked = np.zeros(len(points), dtype=bool)
    owner = np.full(len(points), -1, dtype=np.int32)
    for number, solid in enumerate(static):
        within = solid.inside_lattice(axes).reshape(-1)
        owner[within & ~blocked] = number
        blocked |= within
    free = (~blocked & _reachable(setup, points)).reshape(shape)
    # Outside of the domain is open: walls are what the world holds.
    room = ndimage.distance_transform_edt(np.pad(~blocked.reshape(shape), 1, constant_values=True))[1:-1, 1:-1, 1:-1] * pitch
    wide = free & (room > 0.5 * LEAST_SPACINGS * setup.spacing - 0.5 * pitch)
    whole, _ = ndimage.label(free)
    parts, count = ndimage.label(wide)
    if count < 2:
        return
    wet = np.unique(parts.reshape(-1)[_cells(setup, shape, pitch)])
    wet = wet[wet > 0]
    if not len(wet):
        return
    ids = np.arange(1, count + 1)
    first = np.array(ndimage.maximum(whole, parts, ids))
    size = ndimage.sum_labels(wide, parts, ids) * pitch**3
    reached = np.isin(first, first[wet - 1])
    dry = ids[reached & ~np.isin(ids, wet) & (size >= LEAST_ROOM * setup.spacing**3)]
    if len(dry):
        names = [s.name.split("/")[0] for s in static]
        seeds = np.where(np.isin(parts, wet), 1, np.where(parts == int(dry[np.argmax(size[dry - 1])]), 2, 0))
        _refuse(_Spaces(free, room, seeds, points), names, owner, setup.spacing)


def _reachable(setup: LiquidSetup, points: F64) -> NDArray[np.bool_]:
    """Places that the liquid's energy at the start, or in an inflow, can lift it to."""
    strength = float(np.linalg.norm(setup.gravity))
    if strength == 0.0:
        return np.ones(len(points), dtype=bool)
    up = -setup.gravity / strength
    speed = float(np.linalg.norm(setup.velocity, axis=1).max(initial=0.0))
    tops = [float((setup.position @ up).max(initial=-np.inf)) + 0.5 * setup.spacing + speed**2 / (2 * strength)]
    for i in setup.inflows:
        rise = float(np.abs(up @ i.rotation[:, :2]) @ np.array(i.half_size))
        tops.append(float(i.center @ up) + rise + i.speed**2 / (2 * strength))
    return np.asarray(points @ up <= max(tops))


def _grid(setup: LiquidSetup) -> tuple[list[F64], F64, float] | None:
    for pitch in (PITCH * setup.spacing, setup.spacing):
        counts = np.maximum(1, np.round((setup.upper - setup.lower) / pitch)).astype(int)
        if int(np.prod(counts)) <= MOST_CELLS:
            axes = [setup.lower[k] + pitch * (np.arange(counts[k]) + 0.5) for k in range(3)]
            points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
            return axes, points, pitch
    return None


def _cells(setup: LiquidSetup, shape: tuple[int, int, int], pitch: float) -> NDArray[np.intp]:
    """Flat indices of the grid's cells that hold liquid at the start, or an inflow's opening."""
    mouths = [i.center + 2.0 * setup.spacing * i.rotation[:, 2] for i in setup.inflows]
    points = np.concatenate([setup.position, np.array(mouths).reshape(-1, 3)])
    index = np.clip(((points - setup.lower) / pitch).astype(int), 0, np.array(shape) - 1)
    return np.unique(np.ravel_multi_index(tuple(index.T), shape))


class _Spaces(NamedTuple):
    """Two spaces on a grid, and the free cells between them."""

    free: NDArray[np.bool_]
    room: F64
    """Distance of each cell to the nearest wall [m]."""
    seeds: NDArray[np.int64]
    """1: the space with liquid, 2: the one that none would reach, 0: neither."""
    points: F64
    """Middles of the cells (n, 3) [m]."""


def _refuse(spaces: _Spaces, names: Sequence[str], owner: NDArray[np.int32], spacing: float) -> None:
    """Name the passage: where the two spaces, grown through free cells in order of width, meet.

    Args:
        spaces: what the passage joins.
        names: of the walls' entities.
        owner: wall that each cell lies in, -1: none (n,).
        spacing: of the liquid [m].

    Raises:
        InputError: names place, width and walls of the passage.
    """
    from scipy.spatial import cKDTree
    from skimage.segmentation import watershed

    room, points = spaces.room, spaces.points
    grown = watershed(-room, spaces.seeds, mask=spaces.free)
    a, b = (np.argwhere(grown == k) for k in (1, 2))
    gap, pair = cKDTree(a).query(b)
    touching = np.flatnonzero(gap <= np.sqrt(3.0) + 1e-9)
    if not len(touching):
        return
    widths = room[tuple(b[touching].T)] + room[tuple(a[pair[touching]].T)]
    best = b[touching[int(np.argmax(widths))]]
    width, place = float(widths.max()), points[np.ravel_multi_index(tuple(best), room.shape)]
    near = cKDTree(points[owner >= 0]).query(place, k=min(64, int((owner >= 0).sum())))[1]
    beside = list(dict.fromkeys(names[k] for k in owner[owner >= 0][np.atleast_1d(near)]))[:2]
    least = LEAST_SPACINGS * spacing
    raise InputError(
        f"the passage at [{', '.join(f'{v:.3g}' for v in place)}] m between {' and '.join(repr(n) for n in beside)} is about {width:.2g} m "
        f"wide, less than {LEAST_SPACINGS:g} spacings ({least:.3g} m): liquid would not pass. Use a resolution of at most "
        f"{width / LEAST_SPACINGS:.2g} m, widen the passage, or close it"
    )
