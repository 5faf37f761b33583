"""Columns of grains that collapse, in the round and in a channel, against measured run-outs.

References: round columns by Lube et al. 2004 (doi 10.1017/S0022112004009036) and Lajeunesse et al. 2004 (doi 10.1063/1.1736611),
columns in a channel by Lube et al. 2005 (doi 10.1103/PhysRevE.72.041301) and Lajeunesse et al. 2005 (doi 10.1063/1.2087687).

What was found to matter (H200, 2026-11-22; 25 diameters across, SAND with a modulus of 5e6 Pa, rough floor):

- The range that an exponent is fitted over. Between height over radius 2 and 4 the run-out of round columns goes as a^0.7, beyond as
  a^0.4; over 2 to 8, as far as the published fits reach about, it goes as a^0.54 (Lube: a^0.5 beyond 1.7). Two points at 2 and 4 tell nothing.
- Walls of the channel. At a = 3.9 columns run out by 6.5 lengths between walls without friction (20 diameters long), by 6.0 between walls of
  friction 0.3 that are two lengths apart, by 5.6 where they are one length apart, by 4.5 at half a length; measured 4.7. Balmforth and
  Kerswell 2005 (doi 10.1017/S0022112005005537) measured the same: run-out as a^0.9 in wide channels, as a^0.65 in narrow ones. The
  channel of Lajeunesse et al. is 45 mm wide for columns up to 102 mm long: `NARROW`, with walls of glass, `GLASS_SIDES`.
- Rolling resistance: 0.2 in place of 0.1 shortens 5.6 to 5.0. Nothing else does: restitution 0.6 in place of 0.3 gives 5.7, a pipe that is
  lifted at 1.9 sqrt(g R), as in Lajeunesse et al. 2004, in place of one that is gone at once 3.7 in place of 3.8 (a = 3.9) and 5.2 in place of 4.8
  (a = 7.6), 40 diameters across 3.8 as well. An end of the deposit where a whole layer of grains ends, in place of half of one, lies
  0.1 to 0.3 radii or lengths nearer.
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
from .grain_scenes import SAND, SPREAD, G, pipe, rest, rough_ground, setup_of, slab, still

__all__ = ["BANDS", "Column", "collapse", "exponents", "planar_column", "round_column"]

NARROW = 12.0
"""[diameters] Between the walls of a channel whose columns are 25 diameters long: half a length."""
GLASS_SIDES = 0.3
"""Friction of sand and beads on glass: 16 to 17 degrees. A bed of SAND slides on a wall of that friction by just as much (measured)."""
SETTLES = 1.07
"""A column is filled higher by as much: it settles under its weight."""
COVERED = 0.5
"""Share of the ground that grains cover, seen from above: where it is less, the deposit has ended and single grains lie about."""
CALM = 5e-3
"""Share of the run-out: a front that moved less during half of sqrt(H / g) has stopped."""
LONGEST = 12.0
"""[sqrt(H / g)] After which it is looked at anyway."""


def lube_round(a: float) -> float:
    """(R - R0) / R0 of a round column (Lube et al. 2004)."""
    return 1.24 * a if a < 1.7 else 1.6 * math.sqrt(a)


def lajeunesse_round(a: float) -> float:
    """The same (Lajeunesse et al. 2004)."""
    return a if a < 0.74 else 2.0 * math.sqrt(a)


def lube_planar(a: float) -> float:
    """(L - L0) / L0 of a column in a channel (Lube et al. 2005)."""
    return 1.2 * a if a < 2.3 else 1.9 * math.cbrt(a) ** 2


def lajeunesse_planar(a: float) -> float:
    """The same (Lajeunesse et al. 2005)."""
    return 1.8 * a if a < 3.0 else 1.9 * math.cbrt(a) ** 2


BANDS = {"round": (lube_round, lajeunesse_round), "planar": (lube_planar, lajeunesse_planar)}
"""Two measurements of each collapse; the gate is what lies between them, widened by a fifth."""
WIDENED = 0.2
LAWS = {"round": (1.7, (1.0, 0.15), (0.5, 0.12)), "planar": (2.3, None, (2.0 / 3.0, 0.12))}
"""Where the law changes (Lube et al.), and the exponents below and above with what they may be off."""


class Column(NamedTuple):
    """A column behind a gate: grains, walls with the gate last, and what is measured."""

    setup: GrainSetup
    gate: int
    """Row of the gate."""
    across: float
    """Radius or length of the column [m]."""
    width: float
    """Width of the channel [m]; 0 for a round column."""
    diameter: float


def round_column(
    across: float,
    aspect: float,
    device: str,
    *,
    radius: float = 2e-3,
    kind: Kind = SAND,
    rough: bool = True,
    share: float = 0.58,
) -> Column:
    """A column `across` grain diameters in radius and `aspect` times as high."""
    d = 2 * radius
    around, high = across * d, SETTLES * aspect * across * d
    reach = around * (2.2 + 1.3 * max(lajeunesse_round(aspect), 1.0))
    floor = _ground(reach, reach, d, rough=rough)
    position, sizes = fill_box(
        np.array([-around, -around, 0]), np.array([around, around, high]), radius, share=share, spread=SPREAD, seed=3
    )
    keep = (np.hypot(position[:, 0], position[:, 1]) < around - sizes) & (position[:, 2] > sizes) & (position[:, 2] < high)
    setup = setup_of(
        kind, position[keep], sizes[keep], [floor, pipe(around, 1.1 * high, "gate/body")], {1},
        (-reach, -reach, -4 * d), (reach, reach, high + 8 * d), device,
    )  # fmt: skip
    return Column(setup, 1, around, 0.0, d)


def _ground(x: float, y: float, d: float, *, rough: bool) -> Boundary:
    if rough:
        return rough_ground((-x, -y), (x, y), d, 0.5 * d, "floor/body")
    return slab((-x, -y, -4 * d), (x, y, 0), "floor/body")


def planar_column(
    across: float, aspect: float, device: str, *, radius: float = 2e-3, kind: Kind = SAND, rough: bool = True,
    thick: float = NARROW, sides: float = GLASS_SIDES, share: float = 0.58,
) -> Column:  # fmt: skip
    """A column `across` grain diameters long before a wall, in a channel `thick` diameters wide with sides of a friction `sides`."""
    d = 2 * radius
    long, high, width = across * d, SETTLES * aspect * across * d, thick * d
    reach = long * (3.0 + 2.0 * max(lajeunesse_planar(aspect), 1.0))
    floor = _ground(reach, width, d, rough=rough)
    t = 4 * d
    walls = [
        floor,
        slab((-t, -width, -t), (0, width, 1.1 * high), "back/body"),
        slab((-t, -0.5 * width - t, -t), (reach, -0.5 * width, 1.2 * high), "south/body"),
        slab((-t, 0.5 * width, -t), (reach, 0.5 * width + t, 1.2 * high), "north/body"),
        slab((long, -0.5 * width, 0), (long + t, 0.5 * width, 1.1 * high), "gate/body"),
    ]
    position, sizes = fill_box(
        np.array([0, -0.5 * width, 0]), np.array([long, 0.5 * width, high]), radius, share=share, spread=SPREAD, seed=3
    )
    inside = (position > np.array([0, -0.5 * width, 0]) + sizes[:, None]).all(axis=1)
    inside &= (position < np.array([long, 0.5 * width, high + d]) - sizes[:, None]).all(axis=1)
    setup = setup_of(
        kind, position[inside], sizes[inside], walls, {2, 3, 4}, (-2 * t, -width, -2 * t), (reach, width, high + 8 * d), device
    )
    if sides:
        law = wall_law(kind, sides, kind.restitution)
        setup = replace(setup, walls=setup.walls | {(b, 0): law for b in (2, 3)})
    return Column(setup, 4, long, width, d)


def front(column: Column, c: dict[str, Any]) -> float:
    """Where less than `COVERED` of the ground is covered by grains [m] from the axis or the back wall."""
    way = np.hypot(c["position"][:, 0], c["position"][:, 1]) if column.width == 0 else c["position"][:, 0]
    step = column.diameter
    edges = step * np.arange(math.ceil(float(way.max()) / step) + 2)
    area = np.pi * np.diff(edges**2) if column.width == 0 else np.diff(edges) * column.width
    covered = np.histogram(way, edges, weights=np.pi * c["radius"] ** 2)[0] / area
    first = int(np.argmax(covered < COVERED))
    if first == 0:
        return 0.0
    # Between the middles of two rings.
    drop = covered[first - 1] - covered[first]
    return float(edges[first] + step * (min((covered[first - 1] - COVERED) / drop, 1.0) - 0.5))


def collapse(column: Column) -> dict[str, Any]:
    """Let a column settle behind its gate, take the gate away, and measure the deposit."""
    begun = time.perf_counter()
    engine, count = Grains(column.setup), len(column.setup.boundaries)
    grains = engine.count
    shut, opened = still(count), still(count, column.gate)
    top = float(column.setup.position[:, 2].max())
    steps = rest(engine, shut, 6.0 * math.sqrt(0.1 * top / G) + 0.1)
    c = engine.columns()
    # The height of what has settled: twice that of its centre of mass.
    high = 2.0 * float(c["mass"] @ c["position"][:, 2]) / float(c["mass"].sum())
    ground = np.pi * column.across**2 if column.width == 0 else column.across * column.width
    share = float((4 / 3 * np.pi * c["radius"] ** 3).sum()) / (ground * high)
    unit = math.sqrt(high / G)
    fronts = [front(column, c)]
    taken = 0.0
    while taken < LONGEST:
        steps += rest(engine, opened, 0.5 * unit)
        taken += 0.5
        fronts.append(front(column, engine.columns()))
        if taken >= 3.0 and fronts[-1] - fronts[-2] < CALM * (fronts[-1] - column.across):
            break
    c = engine.columns()
    aspect, run_out = high / column.across, fronts[-1] / column.across - 1.0
    kind = "planar" if column.width else "round"
    expected = [f(aspect) for f in BANDS[kind]]
    low, most = (1 - WIDENED) * min(expected), (1 + WIDENED) * max(expected)
    return {
        "case": kind, "grains": grains, "across_d": round(column.across / column.diameter, 2), "aspect": round(aspect, 3),
        "packing": round(share, 3), "run_out": round(run_out, 3), "measured": [round(e, 3) for e in expected],
        "of_mean": round(run_out / (0.5 * sum(expected)) - 1.0, 3), "gate": [round(low, 3), round(most, 3)],
        "within": bool(low <= run_out <= most), "height": round(_height(column, c) / column.across, 3),
        "time": round(taken, 1), "lost": grains - engine.count, "steps": steps, "wall_s": round(time.perf_counter() - begun, 1),
    }  # fmt: skip


def exponents(found: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Exponents of run-outs over aspect, fitted below and above the change of the law, where there are columns enough."""
    fits = []
    for case, (change, *laws) in LAWS.items():
        own = [(f["aspect"], f["run_out"]) for f in found if f["case"] == case]
        parts = [[p for p in own if p[0] < change], [p for p in own if p[0] >= change]]
        for points, law in zip(parts, laws, strict=True):
            if law is None or len(points) < 2:
                continue
            aspects, ways = np.log(np.array(points)).T
            exponent = float(np.polyfit(aspects, ways, 1)[0])
            fits.append({
                "case": f"exponent of {case}", "columns": len(points), "from": min(points)[0], "to": max(points)[0],
                "exponent": round(exponent, 3), "measured": round(law[0], 3), "gate": law[1], "within": abs(exponent - law[0]) <= law[1],
            })  # fmt: skip
    return fits


def _height(column: Column, c: dict[str, Any]) -> float:
    """Height of the deposit's middle (three diameters about it), or at the back wall [m]."""
    way = np.hypot(c["position"][:, 0], c["position"][:, 1]) if column.width == 0 else c["position"][:, 0]
    near = way < 3.0 * column.diameter
    return float((c["position"][near, 2] + c["radius"][near]).max(initial=0.0))
