"""Seeded defects of wet maps: they are made of a sound world, and then forged with their digests."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...simulation.surfaces import map_wet_solids
from ...worlds.cache import Cache, digest_arrays, read_container, write_container
from ...worlds.categories.liquid.wet import wet_folder
from . import _liquid_scenes as scenes
from ._liquid_scenes import SPACING
from .cases import World

__all__ = ["dried", "drowned", "shifted", "wetted"]

Change = Callable[[int, dict[str, Any]], None]


def wetted(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A swaying pool with its wet maps."""
    flow = scenes.slosh(rng, amplitude=magnitude)
    candidate = flow.candidate(folder)
    map_wet_solids(candidate.spec, candidate.built, candidate.caches)
    return World(dataclasses.replace(candidate), ("tank", "water", "pool"))


def _forged(folder: Path, rng: np.random.Generator, change: Change) -> World:
    world = wetted(folder, 0.004, rng)
    cache = world.candidate.caches["water"]
    files = Cache(wet_folder(cache))
    digests = files.digests()
    for k in range(int(rng.integers(2, 8)), cache.index.frames):
        held = read_container(files.path(k))
        change(k, held)
        digests[k] = write_container(files.path(k), held)
    files.begin_digests(digests)
    return world


def dried(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """A share of what is wet is called dry from a frame on."""

    def change(frame: int, held: dict[str, Any]) -> None:
        keep = rng.random(len(held["wet/texel"])) >= magnitude
        held |= {n: held[n][keep] for n in ("wet/texel", "wet/depth", "wet/fluid")}

    return _forged(folder, rng, change)


def drowned(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """All is said to lie deeper by `magnitude` spacings from a frame on."""

    def change(frame: int, held: dict[str, Any]) -> None:
        held["wet/depth"] = (held["wet/depth"] + magnitude * SPACING).astype(np.float32)

    return _forged(folder, rng, change)


def shifted(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The places of the map lie `magnitude` [m] off the surfaces."""
    world = wetted(folder, 0.004, rng)
    files = Cache(wet_folder(world.candidate.caches["water"]))
    held = read_container(files.folder / "texels.npz")
    held["texel/position"] = (held["texel/position"] + magnitude * held["texel/normal"]).astype(np.float32)
    write_container(files.folder / "texels.npz", held)
    about = json.loads((files.folder / "wet.json").read_text())
    (files.folder / "wet.json").write_text(json.dumps({**about, "texels": digest_arrays(held)}))
    return world
