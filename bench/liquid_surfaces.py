"""Benchmark `liquid-surfaces`: surface, spray and foam of a stream's frames beside splashsurf's own pipeline on the same particles.

    worldagent bench liquid-surfaces

44 x 8 x 1 m of water in markers of 0.15 m between banks, 12 frames. The peer makes one smoothed mesh of each frame with velocities at its
vertices, with the same kernel, threshold and cubes; ours besides follows spray and foam, keeps volume, fits the banks and writes the frames.
Both in turns, on all cores.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..simulation.liquid.surface import SurfaceSettings, default_settings, mesh_surfaces
from ..simulation.liquid.surface_mesh import SMOOTHING
from ..worlds.arrays import F64
from ..worlds.built import TriangleMesh
from ..worlds.cache import Cache, CacheIndex, write_container

__all__ = ["run"]

SIZE, SPACING, FRAMES = (44.0, 8.0, 1.0), 0.15, 12


def _particles(frame: int) -> tuple[F64, F64]:
    """Markers under a wavy surface that travels (n, 3) [m], and their velocities [m/s]."""
    rng = np.random.default_rng(frame)
    axes = [np.arange(SPACING / 2, side, SPACING) for side in SIZE]
    place = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    place = place + rng.uniform(-0.4, 0.4, place.shape) * SPACING
    height = SIZE[2] - SPACING + 0.1 * np.sin(1.3 * place[:, 0] - 0.2 * frame) * np.cos(place[:, 1])
    place = place[place[:, 2] < height]
    return place, np.column_stack([1.5 + 0 * place[:, 0], 0.2 * np.sin(place[:, 0]), 0 * place[:, 0]])


def _banks() -> TriangleMesh:
    x, y = np.meshgrid(np.linspace(-1, SIZE[0] + 1, 80), np.linspace(-4, SIZE[1] + 4, 33), indexing="ij")
    corner = np.stack([x, y, np.where((y < 0.2) | (y > SIZE[1] - 0.2), 1.5, 0.02)], axis=-1).reshape(-1, 3)
    index = np.arange(x.size).reshape(x.shape)
    a, b, c, d = (v.ravel() for v in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    return TriangleMesh(corner, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32))


def _cache(folder: Path) -> Cache:
    cache = Cache(folder / "water")
    cache.folder.mkdir()
    cache.write_index(CacheIndex("water", "flip", 24, FRAMES, ("water",), (), (), (), "", {}))
    digests = []
    for frame in range(FRAMES):
        place, speed = _particles(frame)
        n = len(place)
        digests.append(
            write_container(
                cache.path(frame),
                {
                    "origin": np.zeros(3),
                    "particle/position": place.astype(np.float32),
                    "particle/velocity": speed.astype(np.float32),
                    "particle/id": np.arange(n, dtype=np.int32),
                    "particle/fluid": np.zeros(n, dtype=np.int32),
                    "particle/volume": np.full(n, SPACING**3, dtype=np.float32),
                },
            )
        )
    cache.begin_digests(digests)
    return cache


def _peer(cache: Cache, settings: SurfaceSettings) -> None:
    import pysplashsurf

    for frame in range(FRAMES):
        data = cache.read(frame)
        pysplashsurf.reconstruction_pipeline(
            np.ascontiguousarray(data["particle/position"] / SPACING, dtype=np.float32),
            attributes_to_interpolate={"velocity": data["particle/velocity"]},
            particle_radius=0.5, smoothing_length=settings.support, cube_size=2 * settings.cell,
            iso_surface_threshold=settings.threshold, mesh_smoothing_iters=SMOOTHING, mesh_smoothing_weights=True,
        )  # fmt: skip


def run(rounds: int = 3) -> dict[str, Any]:
    """Seconds per frame of both, medians over the rounds, and ours divided by the peer's."""
    ours, peer = [], []
    banks = [_banks()]
    with tempfile.TemporaryDirectory() as folder:
        for n in range(rounds + 1):
            (Path(folder) / str(n)).mkdir()
            cache = _cache(Path(folder) / str(n))
            settings = default_settings(cache)
            start = time.perf_counter()
            mesh_surfaces(cache, settings=settings, walls=lambda frame: banks)
            between = time.perf_counter()
            _peer(cache, settings)
            ours.append((between - start) / FRAMES)
            peer.append((time.perf_counter() - between) / FRAMES)
    # The first round compiles and warms.
    mine, theirs = float(np.median(ours[1:])), float(np.median(peer[1:]))
    return {"seconds_per_frame": mine, "splashsurf_seconds_per_frame": theirs, "ratio_to_splashsurf": mine / theirs}
