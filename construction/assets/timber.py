"""Timber: logs, piles of logs, firewood, planks, beams."""

from __future__ import annotations

import math

import numpy as np
from pydantic import Field

from ...worlds.arrays import F64
from .generator import Generator, Parameters, material
from .made import MAIN, Body, Made, Place

__all__ = ["GENERATORS"]

GAP = 1.1e-3
"""Between loose pieces [m]."""


class LogParameters(Parameters):
    """A log that lies along x, with bark and stubs of branches."""

    length: float = Field(default=1.8, ge=0.3, le=6.0, description="along x [m]")
    diameter: float = Field(default=0.3, ge=0.1, le=0.9, description="over the bark [m]")
    bark: bool = Field(default=True, description="a layer of bark about the wood")
    stubs: int = Field(default=3, ge=0, le=8, description="stubs of branches")
    material: str = material("pine", "oak", "spruce", "beech", "birch", "larch")


def _round(sides: int, rng: np.random.Generator) -> F64:
    """Uneven convex polygon about the origin of mean radius 1, (sides, 2), counter-clockwise, its longest side down and level."""
    angles = 2 * math.pi * (np.arange(sides) + rng.uniform(-0.15, 0.15, sides)) / sides
    oval = 1 + 0.04 * np.cos(2 * (angles - rng.uniform(0, math.pi)))
    points = oval[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    sides_at = np.roll(points, -1, axis=0) - points
    longest = sides_at[int(np.argmax(np.linalg.norm(sides_at, axis=1)))]
    turn = -math.atan2(longest[1], longest[0])
    c, s = math.cos(turn), math.sin(turn)
    turned: F64 = points @ np.array([[c, s], [-s, c]])
    return turned


def _log(p: LogParameters, rng: np.random.Generator) -> Made:
    body, half = Body("log", p.material), p.length / 2
    ring = _round(16, rng) * p.diameter / 2
    ring[:, 1] -= ring[:, 1].min()
    middle = np.array([0.0, float(ring[:, 1].mean())])
    if p.bark:
        core = middle + (ring - middle) * (1 - min(0.14, 0.03 / p.diameter))
        ends = [half - float(rng.uniform(0.002, 0.03)) for _ in range(2)]
        body.hull("wood", [(x, y, z) for x in (-half, half) for y, z in core])
        for k in range(len(ring)):
            j = (k + 1) % len(ring)
            body.hull(
                f"bark_{k + 1}",
                [(x, y, z) for x in (-ends[0], ends[1]) for y, z in (ring[k], ring[j], core[k], core[j])],
                material="pine_bark",
            )
    else:
        inset = middle + (ring - middle) * 0.96
        body.hull(
            "wood",
            [
                *((x, y, z) for x in (-half + 0.01, half - 0.01) for y, z in ring),
                *((x, y, z) for x in (-half, half) for y, z in inset),
            ],
        )
    faces = [k for k in range(len(ring)) if (ring[k] + ring[(k + 1) % len(ring)])[1] / 2 > middle[1] * 1.05]
    for number in range(p.stubs):
        k = faces[int(rng.integers(len(faces)))]
        a, b = ring[k], ring[(k + 1) % len(ring)]
        way = (b - a) / np.linalg.norm(b - a)
        out = np.array([way[1], -way[0]])
        x = (-0.42 + 0.84 * (number + float(rng.uniform(0.35, 0.65))) / p.stubs) * p.length
        r = min(0.48 * float(np.linalg.norm(b - a)), 0.05, 0.09 * p.length / p.stubs)
        long, lean = float(rng.uniform(1.5, 4.0)) * r, float(rng.uniform(-0.5, 0.5))
        base = (a + b) / 2
        tip = base + out * long
        ringed = [(math.cos(t), math.sin(t)) for t in np.linspace(0, 2 * math.pi, 9)[:-1]]
        points = [(x + r * u, *(base + way * r * v)) for u, v in ringed]
        points += [(x + lean * long + 0.75 * r * u, *(tip + way * 0.75 * r * v)) for u, v in ringed]
        body.hull(f"stub_{number + 1}", points)
    return Made.of(body)


class LogPileParameters(Parameters):
    """Loose logs along y, piled on two bearers between chocks or stakes."""

    bottom: int = Field(default=4, ge=2, le=7, description="logs of the lowest row")
    rows: int = Field(default=3, ge=1, le=7, description="rows, each of one log less; at most as many as the lowest row has logs")
    diameter: float = Field(default=0.24, ge=0.1, le=0.6, description="of a log [m]")
    length: float = Field(default=1.8, ge=0.6, le=5.0, description="of a log along y [m]")
    stakes: bool = Field(default=False, description="upright stakes at the sides instead of chocks")
    uneven: float = Field(default=0.05, ge=0.0, le=0.15, description="by how much ends stand out [m]")
    rack: str = material("oak", "larch", of="bearers")
    material: str = material("spruce", "pine", "beech", "larch", "birch")


def _log_pile(p: LogPileParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("bearers", p.rack))
    r, pitch, sill = p.diameter / 2, p.diameter + GAP, 0.3 * p.diameter
    edge = (p.bottom - 1) / 2 * pitch
    reach = edge + r + (0.55 * r + 2 * GAP if p.stakes else 0.45 * r)
    for s, end in ((-1, "front"), (1, "back")):
        y = s * 0.3 * p.length
        made.main.box(f"bearer_{end}", (-reach, y - 0.3 * r, 0), (reach, y + 0.3 * r, sill))
        for t, side in ((-1, "left"), (1, "right")):
            if p.stakes:
                a, b = sorted((t * (edge + r + GAP), t * (edge + 1.45 * r)))
                made.main.box(
                    f"stake_{end}_{side}",
                    (a, y - 0.3 * r, sill),
                    (b, y + 0.3 * r, sill + min(p.rows, p.bottom) * 1.5 * r + 0.5 * r),
                )
                continue
            face = edge + (math.sqrt(2) - 1) * r + math.sqrt(2) * GAP * 2
            top = edge + 1.4 * r
            outline = [(face, sill), (top, sill), (top, sill + top - face)]
            made.main.hull(f"chock_{end}_{side}", [(t * x, y + w, z) for x, z in outline for w in (-0.3 * r, 0.3 * r)])
    made.main.box("tie", (-0.25 * r, -0.3 * p.length + 0.3 * r, 0), (0.25 * r, 0.3 * p.length - 0.3 * r, 0.6 * sill))
    # Flat sides meet where the logs lie on each other, so that none rolls on.
    turns = [2 * math.pi * (k + 0.5) / 24 for k in range(24)]
    section = [(r / math.cos(math.pi / 24) * math.cos(a), r / math.cos(math.pi / 24) * math.sin(a)) for a in turns]
    below: list[str] = []
    for row in range(min(p.rows, p.bottom)):
        names = []
        z = sill + GAP + r + row * pitch * math.sqrt(0.75)
        for k in range(p.bottom - row):
            x = (k - (p.bottom - row - 1) / 2) * pitch
            shift = float(rng.uniform(-1, 1)) * min(p.uneven, 0.1 * p.length)
            name = f"log_{row + 1}_{k + 1}"
            body = made.bodies[name] = Body("log", p.material)
            ends = (shift - p.length / 2, shift + p.length / 2)
            body.hull("log", [(x + u, y, z + v) for u, v in section for y in ends])
            made.carries += [(MAIN, name)] if row == 0 else [(below[k], name), (below[k + 1], name)]
            names.append(name)
        below = names
    return made


class FirewoodParameters(Parameters):
    """Split wood stacked in a rack, as parts of it or as loose pieces."""

    width: float = Field(default=1.2, ge=0.5, le=2.5, description="of the rack along x [m]")
    height: float = Field(default=0.8, ge=0.3, le=1.5, description="of the stack [m]")
    piece: float = Field(default=0.33, ge=0.25, le=0.5, description="length of a piece along y [m]")
    split: float = Field(
        default=0.12, ge=0.08, le=0.2, description="thickness of a piece, more where there would be too many [m]"
    )
    loose: bool = Field(default=False, description="pieces are bodies of their own")
    rack: str = material("oak", "larch", "pine", of="rack")
    material: str = material("beech", "birch", "oak", "pine", "ash")


def _firewood(p: FirewoodParameters, rng: np.random.Generator) -> Made:
    made = Made.of(Body("firewood", p.rack))
    rack, post, sill, half = made.main, 0.06, 0.07, p.width / 2 - 0.06
    y = 0.3 * p.piece
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * half, s * (half + post)))
        rack.box(f"foot_{side}", (a, -p.piece / 2 - 0.05, 0), (b, p.piece / 2 + 0.05, sill))
        for t, end in ((-1, "front"), (1, "back")):
            rack.box(f"post_{side}_{end}", (a, t * y - 0.03, sill), (b, t * y + 0.03, sill + p.height * 1.08))
        rack.box(f"top_{side}", (a, -y + 0.03, sill + p.height * 0.98), (b, y - 0.03, sill + p.height * 1.05))
    for t, end in ((-1, "front"), (1, "back")):
        rack.box(f"sill_{end}", (-half, t * y - 0.03, 0), (half, t * y + 0.03, sill))
    grown = max(1.0, math.sqrt(2 * half * p.height / p.split**2 / 95))
    columns, rows = max(2, round(2 * half / (p.split * grown))), max(2, round(p.height / (p.split * grown)))
    wide, high = 2 * half / columns, p.height / rows
    grid = np.empty((rows + 1, columns + 1, 2))
    air = 0.5 * GAP if p.loose else 0.0
    wide -= 2 * air / columns
    for j in range(rows + 1):
        for k in range(columns + 1):
            inner_x, inner_z = 0 < k < columns, j > 0
            grid[j, k] = (
                -half + air + k * wide + inner_x * float(rng.uniform(-0.22, 0.22)) * wide,
                sill + j * high + inner_z * float(rng.uniform(-0.22, 0.22)) * high,
            )
    for j in range(rows):
        for k in range(columns):
            quad = np.array([grid[j, k], grid[j, k + 1], grid[j + 1, k + 1], grid[j + 1, k]])
            name = f"piece_{j + 1}_{k + 1}"
            body = rack
            if p.loose:
                body = made.bodies[name] = Body("firewood", p.material)
                quad = _inset(quad, 0.5 * GAP)
                quad[:, 1] += 0.5 * GAP
                made.carries += [(MAIN, name)] if j == 0 or k in (0, columns - 1) else []
            ends = [p.piece / 2 + float(rng.uniform(-0.03, 0.02)) for _ in range(2)]
            c = 0.012
            small = quad.mean(0) + (quad - quad.mean(0)) * 0.9
            points = [(x, v, z) for v in (-ends[0] + c, ends[1] - c) for x, z in quad] + [
                (x, v, z) for v in (-ends[0], ends[1]) for x, z in small
            ]
            body.hull("wood" if p.loose else name, points, material=p.material)
    if p.loose:
        made.carries += [(f"piece_{j}_{k}", f"piece_{j + 1}_{k}") for j in range(1, rows) for k in range(1, columns + 1)]
    return made


def _inset(quad: F64, by: float) -> F64:
    """A convex quadrilateral (4, 2), counter-clockwise, whose sides are moved inwards [m]."""
    sides = np.roll(quad, -1, axis=0) - quad
    normals = np.stack([-sides[:, 1], sides[:, 0]], axis=1) / np.linalg.norm(sides, axis=1, keepdims=True)
    offsets = np.einsum("ij,ij->i", normals, quad) + by
    found = [np.linalg.solve(np.array([normals[k - 1], normals[k]]), np.array([offsets[k - 1], offsets[k]])) for k in range(4)]
    return np.array(found)


class PlankParameters(Parameters):
    """A sawn plank along x that lies flat, its long edges eased and its ends not quite square."""

    length: float = Field(default=2.0, ge=0.2, le=6.0, description="along x [m]")
    width: float = Field(default=0.2, ge=0.05, le=0.5, description="along y [m]")
    thickness: float = Field(default=0.032, ge=0.01, le=0.08, description="along z [m]")
    skew: float = Field(default=0.006, ge=0.0, le=0.03, description="by how much its ends are out of square [m]")
    cleats: bool = Field(default=False, description="cross pieces on its upper side, as on a gangplank")
    material: str = material("pine", "oak", "spruce", "larch", "beech")


def _plank(p: PlankParameters, rng: np.random.Generator) -> Made:
    body, half, wide = Body("plank", p.material), p.length / 2, p.width / 2
    c = min(0.004, 0.2 * p.thickness)
    shift = [float(rng.uniform(-1, 1)) * min(p.skew, 0.2 * p.width) for _ in range(2)]
    section = [
        (-wide + c, 0),
        (wide - c, 0),
        (wide, c),
        (wide, p.thickness - c),
        (wide - c, p.thickness),
        (-wide + c, p.thickness),
        (-wide, p.thickness - c),
        (-wide, c),
    ]
    body.hull("plank", [(s * half + d * y / wide, y, z) for s, d in ((-1, shift[0]), (1, shift[1])) for y, z in section])
    count = max(1, round(p.length / 0.35))
    step = p.length / count
    if p.cleats:
        for k in range(count):
            x = -half + (k + 0.5) * step + (0.25 * step if count % 2 else 0.0)
            body.hull(
                f"cleat_{k + 1}",
                [
                    (x + w, y, z)
                    for y in (-0.85 * wide, 0.85 * wide)
                    for w, z in (
                        (-0.02, p.thickness),
                        (0.02, p.thickness),
                        (-0.012, p.thickness + 0.018),
                        (0.012, p.thickness + 0.018),
                    )
                ],
            )
    made = Made.of(body)
    made.places["top"] = Place((0, 0, p.thickness), (0.1 if p.cleats else 0.9 * p.length, 2 * (wide - c)))
    return made


class BeamParameters(Parameters):
    """A squared beam along x with stopped chamfers, with tenons where asked for."""

    length: float = Field(default=3.0, ge=0.4, le=8.0, description="along x, without tenons [m]")
    width: float = Field(default=0.14, ge=0.06, le=0.4, description="along y [m]")
    height: float = Field(default=0.18, ge=0.06, le=0.5, description="along z [m]")
    chamfer: float = Field(default=0.02, ge=0.0, le=0.05, description="of its edges between the ends [m]")
    tenons: bool = Field(default=False, description="tongues at both ends")
    material: str = material("oak", "spruce", "pine", "larch", "douglas_fir")


def _beam(p: BeamParameters, rng: np.random.Generator) -> Made:
    body, half, y, h = Body("beam", p.material), p.length / 2, p.width / 2, p.height
    c = min(p.chamfer, 0.25 * p.width, 0.25 * h)
    stop = min(0.3, 0.15 * p.length)
    inner = half - stop
    square = [(-y, 0), (y, 0), (y, h), (-y, h)]
    eight = [(-y + c, 0), (y - c, 0), (y, c), (y, h - c), (y - c, h), (-y + c, h), (-y, h - c), (-y, c)]
    if c > 1e-4:
        body.hull("beam", [(x, a, b) for x in (-inner, inner) for a, b in eight])
        for s, side in ((-1, "left"), (1, "right")):
            lead = s * (inner + min(2 * c, 0.4 * stop))
            body.hull(f"lead_{side}", [*((s * inner, a, b) for a, b in eight), *((lead, a, b) for a, b in square)])
            body.hull(f"end_{side}", [(x, a, b) for x in (lead, s * half) for a, b in square])
    else:
        body.hull("beam", [(x, a, b) for x in (-half, half) for a, b in square])
    if p.tenons:
        for s, side in ((-1, "left"), (1, "right")):
            a, b = sorted((s * half, s * (half + 0.08)))
            body.box(f"tenon_{side}", (a, -y / 3, 0.2 * h), (b, y / 3, 0.8 * h))
    made = Made.of(body)
    made.places["top"] = Place((0, 0, h), (2 * inner, 2 * (y - c)))
    return made


GENERATORS = (
    Generator("log", "log with bark and stubs of branches", LogParameters, _log, ("trunk", "tree", "wood", "forest", "camp")),
    Generator("log_pile", "pile of loose logs on bearers between chocks or stakes", LogPileParameters, _log_pile,
              ("logs", "timber", "forest", "wood", "lumber", "stack")),
    Generator("firewood_stack", "rack of split firewood, of one body or of loose pieces", FirewoodParameters, _firewood,
              ("logs", "wood", "fuel", "fireplace", "cabin", "pile")),
    Generator("plank", "sawn plank that lies flat, with cleats where asked for", PlankParameters, _plank, ("board", "timber", "lumber", "gangplank", "wood")),
    Generator("beam", "squared beam with stopped chamfers and tenons", BeamParameters, _beam, ("timber", "joist", "girder", "lintel", "wood")),
)  # fmt: skip
