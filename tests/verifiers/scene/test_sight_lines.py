"""Lines of sight that leave a surface, against the triangles of all that stands about it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from worldagent.construction.primitives import build_shape
from worldagent.geometry.solids import Solid
from worldagent.geometry.triangles import ray_hits
from worldagent.verifiers.scene.enclosed import _open
from worldagent.worlds.built import TriangleMesh
from worldagent.worlds.shapes import Box


def boxes(rng: np.random.Generator, count: int) -> list[Solid]:
    """Boxes here and there, their sides along the axes."""
    found = []
    for _ in range(count):
        mesh = build_shape(Box(kind="box", size=tuple(rng.uniform(0.2, 0.9, 3))), Path()).render
        found.append(Solid.from_mesh(TriangleMesh(mesh.vertices + rng.uniform(-1, 1, 3), mesh.faces), closed=True))
    return found


def test_lines_get_past_what_none_of_their_triangles_stops() -> None:
    """Boxes about solids leave out no line that meets them: lines along the axes, from a plane of a side, and at an angle."""
    rng = np.random.default_rng(7)
    around = boxes(rng, 12)
    starts = rng.uniform(-1.5, 1.5, (400, 3))
    starts[:60, 0] = around[0].lower[0]
    ways = rng.normal(size=(400, 3))
    ways[::4] = np.eye(3)[rng.integers(0, 3, 100)] * rng.choice([-1.0, 1.0], 100)[:, None]
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    stopped = np.zeros(400, dtype=bool)
    for solid in around:
        stopped |= np.isfinite(ray_hits(solid.triangles, starts, ways)).any(axis=1)
    assert 40 < stopped.sum() < 360
    assert np.array_equal(_open(around, starts, ways), ~stopped)
