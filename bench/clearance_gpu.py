"""The kernels of batched clearance on the CPU and on a GPU: the same queries, differences and times, as one JSON object.

    python -m worldagent.bench.clearance_gpu [--bodies 1000] [--frames 240] [--device cuda]

Needs numpy, scipy and warp-lang only, and this package on the path.
"""

from __future__ import annotations

import argparse
import json
import time
from typing import Any

import numpy as np

from ..geometry import Forest, Solid, meetings, turned_boxes
from ..geometry import batch as route
from ..geometry.clearance import NOISE, relative_poses
from ..geometry.depth import PRECISION
from ..geometry.launch import chosen_device, cores, load, warp
from ..geometry.polytopes import Relative
from ..worlds.arrays import F64, I32
from .contact_shapes import lattice

__all__ = ["compare"]

REACH = 4e-3
"""[m] Clearances above are lower bounds, as in the contact check."""
SAME = 1e-12
"""Relative to the size: rounding may differ between devices by this much (fused operations, square roots)."""
SEED = 1


def _queries(bodies: int, frames: int) -> tuple[Forest, I32, Relative]:
    """Near pairs of the lattice, and as many with bodies pushed into each other, so that crossings are compared too."""
    made = lattice(bodies, frames, 24, SEED)
    solids = [Solid.from_mesh(m, closed=True) for m in made.meshes]
    low, high = (np.stack([getattr(s, name) for s in solids]) for name in ("lower", "upper"))
    radius = np.array([s.sphere_radius for s in solids])

    def boxes(part: slice) -> tuple[F64, F64]:
        return turned_boxes(0.5 * (low + high), 0.5 * (high - low), radius, made.position[:, part], made.quaternion[:, part])

    met = meetings(boxes, frames, REACH)
    pairs = np.stack([met.first, met.second], axis=1)
    one, two = ((made.position[k, met.frame], made.quaternion[k, met.frame]) for k in (met.first, met.second))
    apart = relative_poses(one, two)
    pushed = Relative(apart.rotation[::16], 0.97 * apart.translation[::16])
    poses = Relative(*(np.concatenate(both) for both in zip(apart, pushed, strict=True)))
    return Forest(solids), np.concatenate([pairs, pairs[::16]]), poses


def _run(forest: Forest, pairs: I32, poses: Relative, device: str) -> tuple[list[Any], dict[str, float]]:
    from ..geometry.clearance_kernels import nearest
    from ..geometry.depth_kernels import deepest

    start = time.perf_counter()
    load(nearest, device)
    load(deepest, device)
    compiled = time.perf_counter() - start
    start = time.perf_counter()
    wood = route.wood_on(forest, device)
    uploaded = time.perf_counter() - start
    sizes = np.array([s.size for s in forest.solids])
    touch = NOISE * sizes[pairs].sum(axis=1)
    limit = np.full(len(pairs), REACH)
    answers: list[Any] = []
    best = np.inf
    for _ in range(3):
        start = time.perf_counter()
        parts = [
            route.descend(wood, pairs[s], Relative(*(x[s] for x in poses)), touch[s], limit[s], device)
            for s in (slice(k, k + route.CHUNK) for k in range(0, len(pairs), route.CHUNK))
        ]
        best = min(best, time.perf_counter() - start)
        answers = [np.concatenate(column) for column in zip(*parts, strict=True)]
    rows = np.flatnonzero((answers[1] & (answers[0] <= touch)) | answers[2])
    route.depths(wood, pairs, poses, touch, rows[:1], device)
    start = time.perf_counter()
    answers.append(route.depths(wood, pairs, poses, touch, rows, device))
    spent = time.perf_counter() - start
    figures = {"compile_s": compiled, "upload_s": uploaded, "seconds": best, "us_per_query": 1e6 * best / len(pairs)}
    return answers, {**figures, "depths": float(len(rows)), "us_per_depth": 1e6 * spent / max(1, len(rows))}


def compare(bodies: int, frames: int, device: str) -> dict[str, Any]:
    """Run the same queries on the CPU and on `device`, and compare every answer."""
    forest, pairs, poses = _queries(bodies, frames)
    (here, found_here, held_here, deep_here), cpu = _run(forest, pairs, poses, "cpu")
    where = chosen_device(device)
    (there, found_there, held_there, deep_there), other = _run(forest, pairs, poses, where)
    size = np.array([s.size for s in forest.solids])[pairs].sum(axis=1)
    touch = NOISE * size
    both = found_here & found_there
    gap = np.abs(here - there) / size
    same_rows = len(deep_here) == len(deep_there)
    told = (deep_here > 0) & (deep_there > 0) if same_rows else np.zeros(len(deep_here), dtype=bool)
    depth_gap = np.abs(deep_here - deep_there)[told] / deep_here[told] if same_rows else np.array([np.inf])
    return {
        "queries": len(pairs),
        "bodies": bodies,
        "frames": frames,
        "device": str(warp().get_device(where).name),
        "cpu_threads": cores(),
        "cpu": cpu,
        "other": other,
        "speedup": cpu["seconds"] / other["seconds"],
        "largest_difference_of_size": float(gap[both].max(initial=0.0)),
        "differing_bounds": int((found_here != found_there).sum()),
        "differing_touches": int((both & ((here <= touch) != (there <= touch))).sum()),
        "differing_containments": int((held_here != held_there).sum()),
        "largest_relative_difference_of_depth": float(depth_gap.max(initial=0.0)),
        "depths_handed_back": [int((d < 0).sum()) for d in (deep_here, deep_there)],
        "touching": int((both & (here <= touch)).sum()),
        "agree": bool(
            (gap[both] <= SAME).all()
            and (found_here == found_there).all()
            and (held_here == held_there).all()
            and (depth_gap <= 2.0 * PRECISION).all()
        ),
    }


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bodies", type=int, default=1000)
    parser.add_argument("--frames", type=int, default=240)
    parser.add_argument("--device", default="cuda")
    given = parser.parse_args()
    print(json.dumps(compare(given.bodies, given.frames, given.device)))
