"""Which plant grows where, and each single one: suitability from real responses, then scattering by priority and size (R44, R45)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.spec.terrain import BIOME_NAMES, SPECIES_OF_FORM
from .grid import Grid
from .slices import in_slices

__all__ = ["Plants", "Species", "biomes_of", "fitness", "plant_table", "scatter", "species_of", "suitability", "trapezoid"]

RESPONSES = ("moisture", "temperature", "slope", "soil", "light", "exposure")
HECTARE = 1e4
TRIES = 6.0
"""Darts per plant wanted. Own choice: with six, thinning by distance and chance leaves 95 % of a sparse population."""


@dataclass(frozen=True)
class Species:
    """One kind of plant (or stone)."""

    name: str
    form: str
    shape: str
    height: tuple[float, float]
    """[m]"""
    radius: float
    """Half the least distance to another of its size [m]."""
    priority: int
    """Higher ones are placed first."""
    density: float
    """Individuals per hectare where everything suits."""
    responses: Mapping[str, tuple[float, float, float, float]]
    source: str


@dataclass(frozen=True)
class Plants:
    """All instances. Arrays of shape (n,), unless said otherwise."""

    species: tuple[str, ...]
    shapes: tuple[str, ...]
    """Form of each species: `broad`, `cone`, `palm`, `bush`, `tuft`, `column`, `rock`."""
    kind: np.ndarray
    """Index into `species`."""
    position: F64
    """Foot [m], shape (n, 3)."""
    height: F64
    """[m]"""
    radius: F64
    """Half the distance it keeps from others of its size [m]."""
    yaw: F64
    """[rad]"""

    def __len__(self) -> int:
        return len(self.kind)


@cache
def _table() -> dict[str, Any]:
    return dict(json.loads((Path(__file__).parent / "species.json").read_text()))


def species_of(biome: str) -> tuple[Species, ...]:
    """Species of a biome, highest priority first.

    Raises:
        InputError: no species of it are known.
    """
    found = [
        Species(
            name, row["form"], row["shape"], tuple(row["height"]), row["radius"], row["priority"], row["density"],
            {k: tuple(v) for k, v in row["responses"].items()}, row["source"],
        )
        for name, row in _table().items()
        if biome in row["biomes"]
    ]  # fmt: skip
    if not found:
        known = sorted({b for row in _table().values() for b in row["biomes"]})
        raise InputError(f"biome {biome!r} has no species; known: {', '.join(known)}")
    return tuple(sorted(found, key=lambda s: (-s.priority, -s.radius, s.name)))


def biomes_of(species: str) -> tuple[str, ...]:
    """Biomes in which a species grows."""
    return tuple(_table()[species]["biomes"])


def plant_table() -> str:
    """All species as a Markdown table: form, shape, height, spacing, number per hectare, what each needs, and biomes."""
    head = (
        "species",
        "form",
        "shape",
        "height [m]",
        "apart [m]",
        "per ha",
        "moisture",
        "mean temperature [deg C]",
        "slope <=",
        "biomes",
    )
    rows = [head, ("---",) * len(head)]
    for name, row in sorted(_table().items(), key=lambda item: (list(SPECIES_OF_FORM).index(item[1]["form"]), item[0])):
        wants = row["responses"]
        any_place = row["form"] in ("rock", "pebble")
        rows.append(
            (
                f"`{name}`", row["form"], row["shape"], _span(row["height"]), f"{2 * row['radius']:g}", f"{row['density']:g}",
                "any" if any_place else _span((max(wants["moisture"][0], 0), min(wants["moisture"][3], 1))),
                "any" if any_place else _span((wants["temperature"][0], wants["temperature"][3])),
                f"at least {wants['slope'][0]:g}" if any_place else f"{wants['slope'][3]:g}",
                "all" if len(row["biomes"]) == len(BIOME_NAMES) else ", ".join(row["biomes"]),
            )
        )  # fmt: skip
    return "\n".join(f"| {' | '.join(cells)} |" for cells in rows)


def _span(ends: Sequence[float]) -> str:
    return f"{ends[0]:g} to {ends[1]:g}"


def trapezoid(value: F64, corners: Sequence[float]) -> F64:
    """0 below the first corner and above the last, 1 between the middle two, linear between."""
    a, b, c, d = corners
    rise = np.ones_like(value) if b <= a else np.clip((value - a) / (b - a), 0.0, 1.0)
    fall = np.ones_like(value) if d <= c else np.clip((d - value) / (d - c), 0.0, 1.0)
    return np.asarray(np.minimum(np.where(value < a, 0.0, rise), np.where(value > d, 0.0, fall)))


def suitability(species: Species, fields: Mapping[str, F64]) -> F64:
    """Suitability of a place for a species, 0 to 1: the product of its responses.

    Args:
        species: the kind.
        fields: `moisture` (0 to 1), `temperature` [deg C], `slope` [m/m], `soil` [m], `light` (share of the sun on level
            open ground), `exposure` (0 to 1), each of shape (rows, cols).
    """
    total = np.ones_like(fields["moisture"])
    for name in RESPONSES:
        total *= trapezoid(fields[name], species.responses[name])
    return total


def fitness(kinds: Sequence[Species], fields: Mapping[str, F64], allowed: np.ndarray) -> dict[str, F64]:
    """Suitability for each species by name, 0 where nothing may grow: water, bed, road, building (R45).

    Args:
        kinds: the species.
        fields: of `suitability`.
        allowed: cells where something may grow, shape (rows, cols).
    """
    found = {s.name: np.zeros(allowed.shape) for s in kinds}

    def work(first: int, last: int) -> None:
        part = np.s_[first:last]
        given = {name: values[part] for name, values in fields.items()}
        for species in kinds:
            found[species.name][part] = np.where(allowed[part], suitability(species, given), 0.0)

    in_slices(len(allowed), work, size=16)
    return found


def scatter(
    grid: Grid,
    height: F64,
    kinds: Sequence[Species],
    fitting: Mapping[str, F64],
    *,
    clearance: F64,
    density: float,
    rng: np.random.Generator,
    most: int,
) -> Plants:
    """Instances of all kinds: the tall ones first, each at its distance from all that stand.

    Args:
        grid: of all fields.
        height: of the ground [m].
        kinds: highest priority first.
        fitting: of `fitness`.
        clearance: distance to the nearest cell that is not allowed [m].
        density: factor on the density of every kind.
        rng: where and how large.
        most: cap of the number of instances.

    Raises:
        InputError: the estimate exceeds `most`.
    """
    expected = {s.name: float(fitting[s.name].sum()) * grid.cell_area * s.density / HECTARE * density for s in kinds}
    if sum(expected.values()) > most:
        largest = max(expected, key=lambda k: expected[k])
        raise InputError(
            f"about {sum(expected.values()):,.0f} plants (most of them {largest!r}: {expected[largest]:,.0f}), cap {most:,}; lower the density "
            f"{density}, leave out {largest!r}, or give a smaller region"
        )
    return _thrown(grid, height, kinds, fitting, expected, clearance, rng)


def _thrown(
    grid: Grid,
    height: F64,
    kinds: Sequence[Species],
    fitting: Mapping[str, F64],
    expected: Mapping[str, float],
    clearance: F64,
    rng: np.random.Generator,
) -> Plants:
    from .scatter_kernels import throw

    room = int(sum(expected.values()) * 1.5) + 64
    left, bottom = -0.5 * grid.extent[0], -0.5 * grid.extent[1]
    size = max(2.0 * max(s.radius for s in kinds), max(grid.extent) / 4096)
    cols, rows = int(grid.extent[0] / size) + 1, int(grid.extent[1] / size) + 1
    head, chain = np.full(rows * cols, -1, dtype=np.int64), np.full(room, -1, dtype=np.int64)
    x, y, radius = np.zeros(room), np.zeros(room), np.zeros(room)
    kind, tall = np.zeros(room, dtype=np.int16), np.zeros(room)
    count = 0
    for index, species in enumerate(kinds):
        suits = fitting[species.name].ravel()
        wanted = expected[species.name]
        if wanted < 0.5:
            continue
        darts = int(TRIES * wanted)
        # Cells drawn by their suitability, a uniform point in each.
        cells = np.sort(np.searchsorted(np.cumsum(suits), rng.uniform(0, suits.sum(), darts)))
        cells = rng.permutation(np.minimum(cells, suits.size - 1))
        px, py = (
            (cells % grid.cols + rng.uniform(0, 1, darts)) * grid.cell + left,
            (cells // grid.cols + rng.uniform(0, 1, darts)) * grid.cell + bottom,
        )
        scale = rng.uniform(0, 1, darts)
        own = species.radius * (0.7 + 0.3 * scale)
        fits = (clearance.ravel()[cells] > own) & (suits[cells] > 0)
        before = count
        limit = min(room, before + round(wanted))
        count = throw(
            px[fits], py[fits], own[fits], x[:limit], y[:limit], radius[:limit],
            head, chain, count, cols, rows, size, left, bottom,
        )  # fmt: skip
        kind[before:count] = index
        share = (radius[before:count] / species.radius - 0.7) / 0.3
        tall[before:count] = species.height[0] + share * (species.height[1] - species.height[0])
    foot = grid.sample(height, x[:count], y[:count])
    return Plants(
        species=tuple(s.name for s in kinds),
        shapes=tuple(s.shape for s in kinds),
        kind=kind[:count],
        position=np.stack([x[:count], y[:count], foot], axis=1),
        height=tall[:count],
        radius=radius[:count],
        yaw=rng.uniform(0, 2 * np.pi, count),
    )
