"""Columns of grains that collapse and heaps that drain, against measured run-outs and slopes, as one JSON object.

    python -m worldagent.bench.grains_collapse [--case round planar repose] [--across 25] [--aspects 0.5 1 2 4] [--device cuda]

Needs numpy, scipy and warp-lang only, and this package on the path. References: round columns by Lube et al. 2004 (doi
10.1017/S0022112004009036) and Lajeunesse et al. 2004 (doi 10.1063/1.1736611), columns in a channel by Lube et al. 2005 (doi
10.1103/PhysRevE.72.041301) and Lajeunesse et al. 2005 (doi 10.1063/1.2087687), slopes of heaps by Zhou et al. 2002 (doi
10.1016/S0032-5910(01)00520-4).
"""

from __future__ import annotations

import argparse
import json
import math
import time
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..geometry.launch import chosen_device
from ..simulation.boundaries import BodyState, Boundary
from ..simulation.particles.engine import Grains
from ..simulation.particles.packing import fill_box
from ..simulation.particles.setup import GrainSetup, Kind, wall_law
from ..worlds.arrays import F64
from ..worlds.built import TriangleMesh

__all__ = ["BANDS", "Column", "Heap", "collapse", "drain", "planar_column", "round_column", "zhou"]

G = 9.81
SAND = Kind("sand", 2600.0, 1e7, 0.25, 0.3, 0.5, 0.1, 0.0)
"""What `skill://particles` names for sand: friction 0.5, rolling resistance 0.1."""
SPREAD = 0.15
COVERED = 0.5
"""Of the ground by grains seen from above: where it is less, the deposit has ended and single grains lie about."""
EXCHANGE = 1e-2
"""[s] Between looks of the host at the walls, which stand still."""
CALM = 5e-3
"""Of the run-out: a front that moved less during half of sqrt(H / g) has stopped."""
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


def zhou(diameter: float) -> float:
    """Slope [degrees] of a heap of glass beads of a diameter [m], with friction and rolling lengths held (Zhou et al. 2002)."""
    return 29.6 * (1e3 * diameter) ** -0.206


class Column(NamedTuple):
    """A column behind a gate: grains, walls with the gate last, and what is measured."""

    setup: GrainSetup
    gate: int
    """Row of the gate."""
    across: float
    """Radius or length of the column [m]."""
    width: float
    """Of the channel [m]; 0 for a round column."""
    diameter: float


def _slab(low: Any, high: Any, name: str) -> Boundary:
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], dtype=np.int32)
    return Boundary(name, TriangleMesh(corners, faces), "static", True, 0.0)


def _rough(low: Any, high: Any, pitch: float, height: float, name: str) -> Boundary:
    """Ground with a random height up to `height` at every `pitch`, its highest points at z = 0, as a sheet."""
    counts = [max(2, round((high[k] - low[k]) / pitch) + 1) for k in (0, 1)]
    x, y = (np.linspace(low[k], high[k], counts[k]) for k in (0, 1))
    z = -height * np.random.default_rng(11).random(counts)
    points = np.stack([*np.meshgrid(x, y, indexing="ij"), z], axis=-1).reshape(-1, 3)
    corner = np.arange(counts[0] * counts[1]).reshape(counts)
    a, b, c, d = (corner[s].ravel() for s in (np.s_[:-1, :-1], np.s_[1:, :-1], np.s_[1:, 1:], np.s_[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)
    return Boundary(name, TriangleMesh(points, faces), "static", False, 0.0)


def _pipe(radius: float, height: float, name: str, sides: int = 64) -> Boundary:
    """An open upright pipe, a sheet whose inside has at least this radius."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = radius / math.cos(np.pi / sides) * np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=1)
    points = np.concatenate([ring, ring + np.array([0.0, 0.0, height])])
    k = np.arange(sides)
    n = (k + 1) % sides
    faces = np.concatenate([np.stack([k, n, n + sides], axis=1), np.stack([k, n + sides, k + sides], axis=1)]).astype(np.int32)
    return Boundary(name, TriangleMesh(points, faces), "static", False, 0.0)


def _setup(
    kind: Kind, position: F64, radius: F64, walls: list[Boundary], smooth: set[int], lower: Any, upper: Any, device: str
) -> GrainSetup:
    laws = {(b, 0): wall_law(kind, 0.0 if b in smooth else kind.friction, kind.restitution) for b in range(len(walls))}
    for b in smooth:
        laws[b, 0] = replace(laws[b, 0], rolling=0.0)
    return GrainSetup(
        lower=np.asarray(lower, dtype=float), upper=np.asarray(upper, dtype=float), kinds=(kind,), position=position,
        velocity=np.zeros_like(position), radius=radius, kind=np.zeros(len(radius), dtype=np.int32),
        gravity=np.array([0.0, 0.0, -G]), boundaries=tuple(walls), centers=tuple(np.zeros(3) for _ in walls), walls=laws, device=device,
    )  # fmt: skip


def round_column(
    across: float,
    aspect: float,
    device: str,
    *,
    radius: float = 2e-3,
    kind: Kind = SAND,
    rough: bool = False,
    share: float = 0.58,
) -> Column:
    """A column `across` grain diameters in radius and `aspect` times as high."""
    d = 2 * radius
    around, high = across * d, aspect * across * d
    reach = around * (2.2 + 1.3 * max(lajeunesse_round(aspect), 1.0))
    floor = _ground(reach, reach, d, rough=rough)
    position, sizes = fill_box(
        np.array([-around, -around, 0]), np.array([around, around, high]), radius, share=share, spread=SPREAD, seed=3
    )
    keep = (np.hypot(position[:, 0], position[:, 1]) < around - sizes) & (position[:, 2] > sizes) & (position[:, 2] < high)
    setup = _setup(
        kind, position[keep], sizes[keep], [floor, _pipe(around, 1.1 * high, "gate/body")], {1},
        (-reach, -reach, -4 * d), (reach, reach, high + 8 * d), device,
    )  # fmt: skip
    return Column(setup, 1, around, 0.0, d)


def _ground(x: float, y: float, d: float, *, rough: bool) -> Boundary:
    if rough:
        return _rough((-x, -y), (x, y), d, 0.5 * d, "floor/body")
    return _slab((-x, -y, -4 * d), (x, y, 0), "floor/body")


def planar_column(
    across: float, aspect: float, device: str, *, radius: float = 2e-3, kind: Kind = SAND, rough: bool = False,
    thick: float = 10.0, share: float = 0.58,
) -> Column:  # fmt: skip
    """A column `across` grain diameters long before a wall, in a channel of smooth walls `thick` diameters apart."""
    d = 2 * radius
    long, high, width = across * d, aspect * across * d, thick * d
    reach = long * (2.0 + 1.4 * max(lajeunesse_planar(aspect), 1.0))
    floor = _ground(reach, width, d, rough=rough)
    t = 4 * d
    walls = [
        floor,
        _slab((-t, -width, -t), (0, width, 1.1 * high), "back/body"),
        _slab((-t, -0.5 * width - t, -t), (reach, -0.5 * width, 1.2 * high), "south/body"),
        _slab((-t, 0.5 * width, -t), (reach, 0.5 * width + t, 1.2 * high), "north/body"),
        _slab((long, -0.5 * width, 0), (long + t, 0.5 * width, 1.1 * high), "gate/body"),
    ]
    position, sizes = fill_box(
        np.array([0, -0.5 * width, 0]), np.array([long, 0.5 * width, high]), radius, share=share, spread=SPREAD, seed=3
    )
    inside = (position > np.array([0, -0.5 * width, 0]) + sizes[:, None]).all(axis=1)
    inside &= (position < np.array([long, 0.5 * width, high + d]) - sizes[:, None]).all(axis=1)
    setup = _setup(
        kind, position[inside], sizes[inside], walls, {2, 3, 4}, (-2 * t, -width, -2 * t), (reach, width, high + 8 * d), device
    )
    return Column(setup, 4, long, width, d)


GLASS = Kind("glass", 2500.0, 1e7, 0.25, 0.5, 0.4, 0.0, 0.0)
"""Beads of Zhou et al. 2002: friction 0.4 among them; rolling by lengths (below)."""
GLASS_WALL = 0.5
"""Their friction against walls."""
ROLLED, ROLLED_WALL = 5e-5, 1e-4
"""[m] Their rolling friction among beads and against walls, in Zhou's lengths: torque over normal force."""
SOFT = 2.16e8
"""[Pa/m] Modulus per diameter: 2.16e6 Pa at 10 mm as theirs; so the weight of as many beads overlaps them by the same share."""
PLATE, OUTLET, DEEP = 16.0, 5.0, 10.0
"""[diameters] Half the plate that the heap stays on, the opening at either side, and the depth of beads before they drain."""


class Heap(NamedTuple):
    """Beads over a plate and closed outlets at both its sides; the outlets' doors are the last wall."""

    setup: GrainSetup
    gate: int
    diameter: float


def heap(diameter: float, device: str, *, thick: float = 8.0, smooth: bool = True) -> Heap:
    """Beads of one diameter [m] between a front and a rear wall `thick` diameters apart."""
    d, r = diameter, 0.5 * diameter
    kind = replace(GLASS, rolling=ROLLED / (0.5 * r), young=SOFT * d)
    side, high, half = (PLATE + OUTLET) * d, 1.2 * DEEP * d, 0.5 * thick * d
    t = 4 * d
    doors = [
        _slab((s * PLATE * d if s > 0 else -side, -half, -t), (side if s > 0 else s * PLATE * d, half, 0), "") for s in (1, -1)
    ]
    count = len(doors[0].mesh.vertices)
    gate = TriangleMesh(
        np.concatenate([x.mesh.vertices for x in doors]), np.concatenate([doors[0].mesh.faces, doors[1].mesh.faces + count])
    )
    walls = [
        _slab((-PLATE * d, -half, -t), (PLATE * d, half, 0), "plate/body"),
        _slab((-side - t, -half, -8 * d), (-side, half, high), "west/body"),
        _slab((side, -half, -8 * d), (side + t, half, high), "east/body"),
        _slab((-side - t, -half - t, -8 * d), (side + t, -half, high), "south/body"),
        _slab((-side - t, half, -8 * d), (side + t, half + t, high), "north/body"),
        Boundary("doors/body", gate, "static", True, 0.0),
    ]
    low, top = np.array([-side, -half, 0]), np.array([side, half, DEEP * d])
    position, sizes = fill_box(low, top, r, share=0.58, spread=0.0, seed=3)
    inside = (position > low + sizes[:, None]).all(axis=1) & (position < top - sizes[:, None]).all(axis=1)
    setup = _setup(
        kind, position[inside], sizes[inside], walls, {3, 4} if smooth else set(), (-side - t, -half - t, -5 * d),
        (side + t, half + t, high), device,
    )  # fmt: skip
    rough = {b: wall_law(replace(kind, rolling=ROLLED_WALL / r), GLASS_WALL, kind.restitution) for b in range(len(walls))}
    laws = {(b, k): law if law.friction == 0 else rough[b] for (b, k), law in setup.walls.items()}
    return Heap(replace(setup, walls=laws), 5, d)


def drain(case: Heap) -> dict[str, Any]:
    """Let the beads settle, open the doors, and measure the slope of what stays on the plate."""
    begun = time.perf_counter()
    engine, d = Grains(case.setup), case.diameter
    count, grains = len(case.setup.boundaries), engine.count
    unit = math.sqrt(d / G)
    _rest(engine, still(count), 8.0 * unit)
    seconds, opened = 0.0, still(count, case.gate)
    while seconds < 200.0 * unit:
        _rest(engine, opened, 10.0 * unit)
        seconds += 10.0 * unit
        c = engine.columns()
        on = c["position"][:, 2] > 0
        if seconds > 50.0 * unit and float(np.linalg.norm(c["velocity"][on], axis=1).mean()) < 0.01 * math.sqrt(G * d):
            break
    slopes = [_slope(case, c, side) for side in (1, -1)]
    found, expected = float(np.mean(slopes)), zhou(d)
    return {
        "case": "repose", "grains": grains, "on_plate": int((c["position"][:, 2] > 0).sum()), "diameter": d, "slopes": [round(s, 2) for s in slopes],
        "slope": round(found, 2), "zhou": round(expected, 2), "off": round(found - expected, 2),
        "time": round(seconds / unit, 1), "wall_s": round(time.perf_counter() - begun, 1),
    }  # fmt: skip


def _slope(case: Heap, c: dict[str, Any], side: int) -> float:
    """Of the surface [degrees] of one side: a line through the highest beads of strips two diameters wide."""
    d = case.diameter
    x, top = side * c["position"][:, 0], c["position"][:, 2] + c["radius"]
    edges = d * np.arange(2.0, PLATE - 1.0, 2.0)
    strips = [(x >= a) & (x < a + 2 * d) & (top > 0) for a in edges]
    at = np.array([float(x[s].mean()) for s in strips if s.any()])
    height = np.array([float(np.sort(top[s])[-5:].mean()) for s in strips if s.any()])
    return math.degrees(math.atan(-np.polyfit(at, height, 1)[0]))


def still(count: int, away: int | None = None) -> BodyState:
    """Walls at rest; the one that is taken away stands high above."""
    zero = np.zeros((count, 3))
    place = zero.copy()
    if away is not None:
        place[away, 2] = 100.0
    return BodyState(
        place, np.tile(np.eye(3), (count, 1, 1)), place.copy(), zero, zero, np.zeros(count), np.zeros((count, 3, 3)), zero
    )


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


def _rest(engine: Grains, walls: BodyState, seconds: float) -> int:
    steps = 0
    for _ in range(max(1, round(seconds / EXCHANGE))):
        steps += engine.step(EXCHANGE, walls).steps
    return steps


def collapse(column: Column) -> dict[str, Any]:
    """Let a column settle behind its gate, take the gate away, and measure the deposit."""
    begun = time.perf_counter()
    engine, count = Grains(column.setup), len(column.setup.boundaries)
    grains = engine.count
    shut, opened = still(count), still(count, column.gate)
    top = float(column.setup.position[:, 2].max())
    steps = _rest(engine, shut, 6.0 * math.sqrt(0.1 * top / G) + 0.1)
    c = engine.columns()
    # The height of what has settled: twice that of its centre of mass.
    high = 2.0 * float(c["mass"] @ c["position"][:, 2]) / float(c["mass"].sum())
    ground = np.pi * column.across**2 if column.width == 0 else column.across * column.width
    share = float((4 / 3 * np.pi * c["radius"] ** 3).sum()) / (ground * high)
    unit = math.sqrt(high / G)
    fronts = [front(column, c)]
    taken = 0.0
    while taken < LONGEST:
        steps += _rest(engine, opened, 0.5 * unit)
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


def _height(column: Column, c: dict[str, Any]) -> float:
    """Of the deposit's middle (three diameters about it), or at the back wall [m]."""
    way = np.hypot(c["position"][:, 0], c["position"][:, 1]) if column.width == 0 else c["position"][:, 0]
    near = way < 3.0 * column.diameter
    return float((c["position"][near, 2] + c["radius"][near]).max(initial=0.0))


def _main() -> list[dict[str, Any]]:
    parser = argparse.ArgumentParser()
    parser.add_argument("--case", nargs="+", default=["round", "planar", "repose"], choices=["round", "planar", "repose"])
    parser.add_argument("--across", type=float, nargs="+", default=[25.0])
    parser.add_argument("--aspects", type=float, nargs="+", default=[0.5, 1.0, 2.0, 4.0])
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--rough", action="store_true")
    parser.add_argument("--frictional", action="store_true", help="front and rear walls of heaps with friction")
    parser.add_argument("--friction", type=float, default=SAND.friction)
    parser.add_argument("--rolling", type=float, default=SAND.rolling)
    given = parser.parse_args()
    kind = replace(SAND, friction=given.friction, rolling=given.rolling)
    made = {"round": round_column, "planar": planar_column}
    found = []
    for diameter in (0.01, 0.005, 0.002) if "repose" in given.case else ():
        found.append(drain(heap(diameter, chosen_device(given.device), smooth=not given.frictional)))
        print(json.dumps(found[-1]), flush=True)
    for case in (c for c in given.case if c in made):
        for across in given.across:
            for aspect in given.aspects:
                column = made[case](across, aspect, chosen_device(given.device), kind=kind, rough=given.rough)
                found.append(collapse(column))
                print(json.dumps(found[-1]), flush=True)
    return found


if __name__ == "__main__":
    _main()
