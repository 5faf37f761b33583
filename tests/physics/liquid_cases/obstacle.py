"""SPHERIC test 2: a broken dam meets a box (Kleefsman et al. 2005, doi:10.1016/j.jcp.2004.12.007)."""

from __future__ import annotations

import numpy as np
from worldagent.simulation.boundaries import Boundary
from worldagent.simulation.step_reports import StepReport
from worldagent.worlds.arrays import F64

from .world import EngineName, Figure, advance, below, box_mesh, lattice, liquid, make, near

__all__ = ["kleefsman"]

TANK, DAM, DEPTH = (3.22, 1.0, 1.0), 1.992, 0.55
PEAK, ARRIVAL = 8127.0, 0.411
"""Measured peak of pressure P2 [Pa] and the time when it passes a quarter of that [s]."""
GAUGES = np.array([
    (0.40, 0.0464, 0.4595), (0.42, 0.0577, 0.4541), (0.44, 0.0746, 0.4469), (0.46, 0.0803, 0.4403), (0.48, 0.0875, 0.4339),
    (0.50, 0.0988, 0.4261), (0.70, 0.1314, 0.3628), (0.72, 0.1355, 0.3561), (0.74, 0.1395, 0.3501), (0.76, 0.1410, 0.3438),
    (0.78, 0.1445, 0.3377), (1.00, 0.1791, 0.2789), (1.02, 0.1831, 0.2735), (1.04, 0.1851, 0.2681), (1.06, 0.1838, 0.2630),
    (1.08, 0.1861, 0.2588),
])  # fmt: skip
"""Time [s] and height of water [m] at H2 (x = 0.992) and H4 (x = 2.638), read off the traces that SPHERIC distributes."""


def _pressure(place: F64, position: F64, pressure: F64, reach: float) -> float:
    """Shepard mean within a reach [Pa]; none of what is fewer than two particles."""
    q = np.linalg.norm(position - place, axis=1) / reach
    w = np.clip(1.0 - q, 0.0, None) ** 2
    return float((w * pressure).sum() / w.sum()) if (w > 0.1).sum() >= 2 else 0.0


def kleefsman(engine: EngineName, cells: int) -> list[Figure]:
    """Until 1.1 s; `cells` over the depth of 0.55 m."""
    s = DEPTH / cells
    box = Boundary("box", box_mesh((0.161, 0.403, 0.161), (0.744, 0.497, 0.0805)), "static")
    water = lattice((TANK[0] - s * round((TANK[0] - DAM) / s), 0, 0), (TANK[0], s * round(TANK[1] / s), DEPTH), s)
    running = make(engine, liquid(s, water, (TANK[0], s * round(TANK[1] / s), TANK[2]), boundaries=(box,)))
    volume = len(water) * s**3
    course: list[tuple[float, ...]] = []

    def look(time: float, _: StepReport) -> None:
        p = running.particles()
        x = p.position
        hit = _pressure(np.array([0.8245, 0.471, 0.061]), x, p.pressure, 2 * s)
        near_middle = np.abs(x[:, 1] - 0.5) < 0.1
        heights = []
        for gauge in (0.992, 2.638):
            there = near_middle & (np.abs(x[:, 0] - gauge) < s)
            heights.append(float(p.volume[there].sum() / (2 * s * 0.2)))
        course.append((time, hit, *heights))

    advance(running, 1.1, [box], look, longest=0.005)
    t, hit, *heights = np.array(course).T
    # a mean over 5 ms: the pressure of single steps scatters
    smooth = np.array([hit[np.abs(t - now) <= 0.0025].mean() for now in t])
    early = t < 0.9
    off = [np.abs(np.interp(GAUGES[:, 0], t, h) - GAUGES[:, k]).mean() / GAUGES[:, k].max() for k, h in enumerate(heights, 1)]
    found = running.particles()
    return [
        near("arrival at P2", float(t[np.argmax(smooth > 0.25 * PEAK)]), ARRIVAL, 0.20, "s"),
        near("peak of P2", smooth[early].max(), PEAK, 0.20, "Pa"),
        below("height H2, mean error / largest", off[0], 0.10),
        below("height H4, mean error / largest (from 0.40 s)", off[1], 0.10),
        below("mass, drift", abs(found.volume.sum() / volume - 1), 0.01),
    ]
