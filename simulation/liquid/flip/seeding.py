"""Marker particles from the initial particles of a setup."""

from __future__ import annotations

import numpy as np

from ....worlds.errors import InputError
from ..engine import LiquidSetup, Particles

__all__ = ["check", "seed"]

JITTER = 0.25
"""Largest random offset along each axis, in distances between markers: breaks the lattice without clumps."""


def check(setup: LiquidSetup) -> None:
    """Refuse what the grid engine does not do.

    Raises:
        InputError: several densities, conduction of heat, or no extent.
    """
    if not setup.fluids:
        raise InputError("the grid engine got no liquid; give it one entity of category liquid")
    densities = sorted({fluid.density for fluid in setup.fluids})
    if len(densities) > 1:
        raise InputError(
            f"the grid engine got liquids of densities {densities} kg/m^3; it holds one density: use engine 'dfsph' for layers"
        )
    for fluid in setup.fluids:
        if fluid.conductivity > 0.0:
            raise InputError(
                f"the grid engine carries heat but does not conduct it ({fluid.name!r}: {fluid.conductivity:g} W/(m K)); "
                "set conductivity 0 or use engine 'dfsph'"
            )
    if not setup.spacing > 0.0:
        raise InputError(f"the size of a cell is {setup.spacing!r} m; it must be above 0")


def seed(setup: LiquidSetup, per_cell: int) -> Particles:
    """Initial particles, split into cubes of 2^3 or 3^3 parts until a full cell holds `per_cell`, with random offsets."""
    n = len(setup.position)
    position = np.asarray(setup.position, dtype=np.float64).reshape(n, 3)
    volume = np.asarray(setup.volume, dtype=np.float64).reshape(n)
    side = setup.spacing / round(per_cell ** (1 / 3))
    parts = max(1, round(float(np.median(np.cbrt(volume))) / side)) if n else 1
    ticks = (np.arange(parts) + 0.5) / parts - 0.5
    offset = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    many = len(offset)
    random = np.random.default_rng(setup.seed)
    edge = np.cbrt(volume)
    split = position[:, None] + edge[:, None, None] * offset
    jitter = 0.0 if setup.scattered and parts == 1 else JITTER
    split = split.reshape(-1, 3) + jitter * random.uniform(-1.0, 1.0, (n * many, 3)) * np.repeat(edge / parts, many)[:, None]
    inset = 1e-3 * setup.spacing
    split = np.clip(split, np.asarray(setup.lower) + inset, np.asarray(setup.upper) - inset)
    total = n * many
    fluid = np.repeat(np.asarray(setup.fluid, dtype=np.int32), many)
    return Particles(
        split,
        np.repeat(np.asarray(setup.velocity, dtype=np.float64).reshape(n, 3), many, axis=0),
        np.arange(total, dtype=np.int32),
        fluid,
        np.repeat(volume / many, many),
        np.full(total, setup.fluids[0].density),
        np.zeros(total),
        np.array([f.temperature for f in setup.fluids])[fluid],
    )
