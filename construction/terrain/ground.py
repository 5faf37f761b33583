"""Ground materials by rules over fields (R41, R42): the last matching rule wins; weights of all materials sum to one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ...worlds.arrays import F64
from ...worlds.spec.terrain import Terrain
from .grid import Grid
from .zones import declared_zone, zone_distance

__all__ = ["DEFAULT_GROUND", "GroundCover", "cover"]

DEFAULT_GROUND = {"bare-rock": 0.05, "river-sediment": 0.3, "soil": 0.5}
"""Ground of cells that no rule matches, with how well it holds water: steep, laid down by water, and the rest."""
STEEP = 0.84
"""Slope from which unmatched ground is bare rock: 40 degrees, above the repose of any soil."""
LAID_DOWN = 0.05
"""Deposit from which unmatched ground beside water is sediment [m]."""


@dataclass(frozen=True)
class GroundCover:
    """Which material covers each cell."""

    names: tuple[str, ...]
    """Materials of the specification, and the keys of `DEFAULT_GROUND`."""
    index: np.ndarray
    """Index of the winning material, shape (rows, cols)."""
    retention: F64
    """Share of water that the ground holds, 0 to 1, shape (rows, cols)."""
    blend: tuple[float, ...]
    """Width over which each material fades into its neighbours [m]."""

    def weights(self, grid: Grid) -> np.ndarray:
        """Share of every material, shape (materials, rows, cols), float32; sums to one in each cell."""
        found = np.stack([(self.index == k).astype(np.float32) for k in range(len(self.names))])
        for k, width in enumerate(self.blend):
            if width > 0:
                found[k] = ndimage.gaussian_filter(found[k], 0.5 * width / grid.cell, mode="nearest")
        return np.asarray(found / found.sum(axis=0))


def cover(grid: Grid, terrain: Terrain, fields: Mapping[str, F64], *, bed: np.ndarray) -> GroundCover:
    """Apply the rules.

    Args:
        grid: of all fields.
        terrain: its `ground` holds the rules.
        fields: by name (`worlds.spec.terrain.FIELD_NAMES`).
        bed: cells of river and stream beds.

    Raises:
        InputError: a rule names an unknown zone.
    """
    rules = sorted(terrain.ground.items(), key=lambda item: (item[1].order, item[0]))
    names = list(dict.fromkeys([*DEFAULT_GROUND, *(rule.material for _, rule in rules)]))
    kinds = list(DEFAULT_GROUND)
    index = np.full(grid.shape, kinds.index("soil"), dtype=np.uint8)
    index[bed | (fields["deposit"] > LAID_DOWN) & (fields["height_above_water"] < 2.0)] = kinds.index("river-sediment")
    index[fields["slope"] > STEEP] = kinds.index("bare-rock")
    retention = np.array([DEFAULT_GROUND[k] for k in kinds])[index]
    blend = dict.fromkeys(names, 0.0)
    for _, rule in rules:
        match = np.ones(grid.shape, dtype=bool)
        for condition in rule.where:
            value = fields[condition.field]
            if condition.at_least is not None:
                match &= value >= condition.at_least
            if condition.at_most is not None:
                match &= value <= condition.at_most
        if rule.zone is not None:
            match &= zone_distance(grid, declared_zone(terrain, rule.zone)) <= 0
        index[match] = names.index(rule.material)
        retention = np.where(match, rule.retention, retention)
        blend[rule.material] = max(blend[rule.material], rule.blend)
    return GroundCover(tuple(names), index, retention, tuple(blend[k] for k in names))
