"""Heaps of grains that stay on a plate when the rest has drained at both its sides, and their slopes.

The slope of glass beads by diameter is that of Zhou, Xu, Yu, Zulli 2002 (doi 10.1016/S0032-5910(01)00520-4), who measured and
computed it with the same friction and the same lengths of rolling friction for all diameters.
"""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..simulation.boundaries import Boundary
from ..simulation.particles.engine import Grains
from ..simulation.particles.packing import fill_box
from ..simulation.particles.setup import GrainSetup, Kind, wall_law
from ..worlds.built import TriangleMesh
from .grain_scenes import SPREAD, G, rest, rough_ground, setup_of, slab, still

__all__ = ["SLOPES", "Heap", "drain", "heap", "zhou"]

GLASS = Kind("glass", 2500.0, 1e7, 0.25, 0.5, 0.4, 0.0, 0.0)
"""Beads of Zhou et al. 2002: friction 0.4 among them; rolling by lengths (below)."""
GLASS_WALL = 0.5
"""Their friction against walls."""
ROLLED, ROLLED_WALL = 5e-5, 1e-4
"""[m] Their rolling friction among beads and against walls, in Zhou's lengths: torque over normal force."""
SOFT = 2.16e8
"""[Pa/m] Modulus per diameter: 2.16e6 Pa at 10 mm as theirs; so the weight of as many beads overlaps them by the same share."""
THICK = 0.08
"""[m] Between the front and the rear wall of their heaps; held, as all but the diameter is."""
PLATE, OUTLET, DEEP = 16.0, 5.0, 10.0
"""[diameters] Half the plate that the heap stays on, the opening at either side, and the depth of beads before they drain."""
SAND_OUTLET, SAND_DEEP = 8.0, 18.0
"""The same of sand, which makes bridges and steeper heaps."""

SLOPES = ((0.2, 0.0), (0.5, 0.0), (0.5, 0.1), (0.5, 0.2), (0.7, 0.3))
"""Friction and rolling resistance whose slopes `skill://particles` tells."""


def zhou(diameter: float) -> float:
    """Slope [degrees] of a heap of glass beads of a diameter [m], with friction and rolling lengths held (Zhou et al. 2002)."""
    return 29.6 * math.pow(1e3 * diameter, -0.206)


class Heap(NamedTuple):
    """Beads over a plate and closed outlets at both its sides; the outlets' doors are the last wall."""

    setup: GrainSetup
    gate: int
    diameter: float


def heap(diameter: float, device: str, *, sand: Kind | None = None, thick: float | None = None) -> Heap:
    """Beads of one diameter [m] as Zhou's; or grains of another kind on a rough plate between smooth walls.

    Args:
        diameter: of the beads, or of the mean grain [m].
        device: where it runs.
        sand: other grains than beads.
        thick: diameters between the front and the rear wall; default `THICK`.
    """
    d, r = diameter, 0.5 * diameter
    thick = THICK / d if thick is None else thick
    kind = sand or replace(GLASS, rolling=ROLLED / (0.5 * r), young=SOFT * d)
    outlet, deep = (OUTLET, DEEP) if sand is None else (SAND_OUTLET, SAND_DEEP)
    side, high, half = (PLATE + outlet) * d, 1.2 * deep * d, 0.5 * thick * d
    t = 4 * d
    doors = [
        slab((s * PLATE * d if s > 0 else -side, -half, -t), (side if s > 0 else s * PLATE * d, half, 0), "") for s in (1, -1)
    ]
    count = len(doors[0].mesh.vertices)
    gate = TriangleMesh(
        np.concatenate([x.mesh.vertices for x in doors]), np.concatenate([doors[0].mesh.faces, doors[1].mesh.faces + count])
    )
    walls = [
        slab((-PLATE * d, -half, -t), (PLATE * d, half, 0), "plate/body")
        if sand is None
        else rough_ground((-PLATE * d, -half), (PLATE * d, half), d, 0.5 * d, "plate/body"),
        slab((-side - t, -half, -8 * d), (-side, half, high), "west/body"),
        slab((side, -half, -8 * d), (side + t, half, high), "east/body"),
        slab((-side - t, -half - t, -8 * d), (side + t, -half, high), "south/body"),
        slab((-side - t, half, -8 * d), (side + t, half + t, high), "north/body"),
        Boundary("doors/body", gate, "static", True, 0.0),
    ]
    low, top = np.array([-side, -half, 0]), np.array([side, half, deep * d])
    position, sizes = fill_box(low, top, r, share=0.58, spread=SPREAD if sand else 0.0, seed=3)
    inside = (position > low + sizes[:, None]).all(axis=1) & (position < top - sizes[:, None]).all(axis=1)
    setup = setup_of(
        kind, position[inside], sizes[inside], walls, {3, 4} if sand else set(), (-side - t, -half - t, -5 * d),
        (side + t, half + t, high), device,
    )  # fmt: skip
    if sand is None:
        law = wall_law(replace(kind, rolling=ROLLED_WALL / r), GLASS_WALL, kind.restitution)
        setup = replace(setup, walls={(b, 0): law for b in range(len(walls))})
    return Heap(setup, 5, d)


def drain(case: Heap) -> dict[str, Any]:
    """Let the beads settle, open the doors, and measure the slope of what stays on the plate."""
    begun = time.perf_counter()
    engine, d = Grains(case.setup), case.diameter
    count, grains = len(case.setup.boundaries), engine.count
    unit = math.sqrt(d / G)
    rest(engine, still(count), 8.0 * unit)
    seconds, opened = 0.0, still(count, case.gate)
    while seconds < 200.0 * unit:
        rest(engine, opened, 10.0 * unit)
        seconds += 10.0 * unit
        c = engine.columns()
        on = c["position"][:, 2] > 0
        if seconds > 50.0 * unit and float(np.linalg.norm(c["velocity"][on], axis=1).mean()) < 0.01 * math.sqrt(G * d):
            break
    slopes = [_slope(case, c, side) for side in (1, -1)]
    found = float(np.mean(slopes))
    expected = round(zhou(d), 2) if case.setup.kinds[0].name == GLASS.name else None
    return {
        "case": "repose", "friction": case.setup.kinds[0].friction, "rolling": round(case.setup.kinds[0].rolling, 3), "grains": grains, "on_plate": int((c["position"][:, 2] > 0).sum()), "diameter": d, "slopes": [round(s, 2) for s in slopes],
        "slope": round(found, 2), "zhou": expected,
        "time": round(seconds / unit, 1), "wall_s": round(time.perf_counter() - begun, 1),
    }  # fmt: skip


def _slope(case: Heap, c: dict[str, Any], side: int) -> float:
    """Slope [degrees] of one side's surface: a line through the highest beads of strips two diameters wide."""
    d = case.diameter
    x, top = side * c["position"][:, 0], c["position"][:, 2] + c["radius"]
    edges = d * np.arange(2.0, PLATE - 1.0, 2.0)
    strips = [(x >= a) & (x < a + 2 * d) & (top > 0) for a in edges]
    at = np.array([float(x[s].mean()) for s in strips if s.any()])
    height = np.array([float(np.sort(top[s])[-5:].mean()) for s in strips if s.any()])
    return math.degrees(math.atan(-np.polyfit(at, height, 1)[0]))
