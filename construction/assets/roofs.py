"""Roofs on wall plates, with rafters under boards and lapped courses."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from pydantic import Field

from .generator import Generator, Parameters, material
from .made import Body, Made

__all__ = ["GENERATORS"]

PLATE = 0.12
"""Side of a wall plate [m]."""
THICK, THIN = 0.055, 0.018
"""Thickness of a course at its lower and its upper edge [m]."""
BOARD = 0.028
"""Thickness of boards [m]."""
LAP = 0.014
"""Rise of a ridge tile over its length [m]."""


class GableRoofParameters(Parameters):
    """A roof of two slopes, its ridge along x; its plates stand on the walls (z = 0)."""

    length: float = Field(default=5.0, ge=1.5, le=12.0, description="of the walls under it along x [m]")
    width: float = Field(default=4.0, ge=1.5, le=8.0, description="of the walls under it along y [m]")
    pitch_deg: float = Field(default=42.0, ge=20.0, le=58.0, description="of the slopes [degrees]")
    eaves: float = Field(default=0.35, ge=0.1, le=0.7, description="overhang beyond the walls, in plan [m]")
    verge: float = Field(default=0.25, ge=0.05, le=0.6, description="overhang beyond the gables [m]")
    covering: Literal["tiles", "shingles", "boards"] = Field(
        default="tiles", description="lapped courses of tiles or shingles, or upright boards with cover strips"
    )
    gables: bool = Field(default=True, description="gable walls of boards at both ends")
    cover: str = material("roof_tile", "slate", "cedar", "larch", "zinc", of="covering")
    material: str = material("spruce", "pine", "oak", "larch")


def _gable_roof(p: GableRoofParameters, rng: np.random.Generator) -> Made:
    body = Body("roof", p.material)
    half, slope = p.width / 2, math.tan(math.radians(p.pitch_deg))
    long, reach = p.length / 2 + p.verge, half + p.eaves
    rafter, deep = 0.07, 0.14 / math.cos(math.radians(p.pitch_deg))
    # Underside of the rafters passes the inner upper edge of the plates.
    ridge = PLATE + (half - PLATE) * slope + deep
    wide = min(PLATE, (PLATE - 0.03) / slope)
    outer = half - PLATE + wide
    for s, side in ((-1, "front"), (1, "back")):
        outline = [(outer, 0), (half - PLATE, 0), (half - PLATE, PLATE), (outer, PLATE - wide * slope)]
        body.hull(f"plate_{side}", [(x, s * y, z) for x in (-p.length / 2, p.length / 2) for y, z in outline])
    count = max(2, min(9, round(p.length / 0.8))) + 1
    for k in range(count):
        x = -p.length / 2 + rafter / 2 + (p.length - rafter) * k / (count - 1)
        for s, side in ((-1, "front"), (1, "back")):
            line = [(0.03, ridge - 0.03 * slope), (reach, ridge - reach * slope)]
            points = [(x + w, s * y, z - d) for y, z in line for d in (0.0, deep) for w in (-rafter / 2, rafter / 2)]
            body.hull(f"rafter_{side}_{k + 1}", points)
    body.hull(
        "ridge_board",
        [
            (x, y, z)
            for x in (-p.length / 2, p.length / 2)
            for y in (-0.03, 0.03)
            for z in (ridge - 0.03 * slope - 1.2 * deep, ridge - 0.03 * slope)
        ],
    )
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * p.length / 2, s * (p.length / 2 - PLATE)))
        body.box(f"tie_{side}", (a, -half + PLATE, 0), (b, half - PLATE, PLATE * 0.8))
        if p.gables:
            _gable(body, side, s, half - PLATE, ridge - deep, slope, p)
    if p.covering == "boards":
        _boards(body, long, reach, ridge, slope, p)
    else:
        _courses(body, long, reach, ridge, slope, p, rng)
    lapped = p.covering != "boards"
    fall = _shallow(reach / _rows(reach, p.pitch_deg), slope, THICK, THIN) if lapped else slope
    _ridge_tiles(body, long, ridge + (THIN if lapped else BOARD), fall, cover=p.cover)
    return Made.of(body)


def _rows(reach: float, pitch_deg: float) -> int:
    """Courses of a slope."""
    return max(4, min(12, round(reach / math.cos(math.radians(pitch_deg)) / 0.3)))


def _ridge_tiles(body: Body, long: float, top: float, fall: float, *, cover: str, crown: float = 0.13) -> None:
    """Lapped tiles along the ridge from -long to long, which rest on it and on nothing else."""
    tiles = max(2, min(8, round(2 * long / 0.45)))
    for k in range(tiles):
        ends = ((-long + 2 * long * k / tiles, 0.0), (-long + 2 * long * (k + 1) / tiles, LAP))
        for s, side in ((-1, "a"), (1, "b")):
            points = [(x, s * y, top - y * fall + lift + t) for x, lift in ends for y in (0.0, crown) for t in (0.0, 0.035)]
            body.hull(f"ridge_tile_{k + 1}{side}", points, material=cover)


def _gable(body: Body, side: str, s: int, half: float, apex: float, slope: float, p: GableRoofParameters) -> None:
    """Upright boards under the last rafters, their heads cut to the slope."""
    a, b = sorted((s * p.length / 2, s * (p.length / 2 - 0.022)))
    number = 2 * max(2, min(4, round(half / 0.25)))
    base = 0.8 * PLATE
    for k in range(number):
        y0, y1 = -half + 2 * half * k / number, -half + 2 * half * (k + 1) / number

        def under(y: float) -> float:
            return min(apex - abs(y) * slope, apex - 0.03 * slope - 0.2 * 0.14 / math.cos(math.radians(p.pitch_deg)))

        if max(under(y0), under(y1)) < base + 0.03:
            continue
        tops = [(y, max(under(y), base)) for y in (y0, y1)]
        x0, x1 = (a, b) if k % 2 == 0 else (a + 0.004, b - 0.004)
        body.hull(f"gable_{side}_{k + 1}", [(x, y, z) for x in (x0, x1) for y, top in tops for z in (base, top)])


def _courses(
    body: Body, long: float, reach: float, ridge: float, slope: float, p: GableRoofParameters, rng: np.random.Generator
) -> None:
    """Lapped courses on each slope, cut into tiles where there is room for them."""
    rows = _rows(reach, p.pitch_deg)
    pieces = max(1, min(4, round(2 * long / 1.2), 48 // (2 * rows)))
    for s, side in ((-1, "front"), (1, "back")):
        for k in range(rows):
            a, b = reach * (1 - k / rows), reach * (1 - (k + 1) / rows)
            cuts = [
                -long,
                *(
                    -long + 2 * long * (j + 0.5 * (k % 2) + float(rng.uniform(-0.1, 0.1))) / pieces
                    for j in range(1 - k % 2, pieces)
                ),
                long,
            ]
            for j in range(len(cuts) - 1):
                drop = float(rng.uniform(0, 0.01))
                outline = ((a, 0.0), (a, THICK - drop), (b, 0.0), (b, THIN))
                body.hull(
                    f"course_{side}_{k + 1}_{j + 1}",
                    [(x, s * y, ridge - y * slope + t) for x in cuts[j : j + 2] for y, t in outline],
                    material=p.cover,
                )


def _boards(body: Body, long: float, reach: float, ridge: float, slope: float, p: GableRoofParameters) -> None:
    """Boards down the slope with strips over their joints."""
    number = max(4, min(14, round(2 * long / 0.28)))
    for s, side in ((-1, "front"), (1, "back")):
        for k in range(number):
            a, b = -long + 2 * long * k / number, -long + 2 * long * (k + 1) / number
            body.hull(
                f"board_{side}_{k + 1}",
                [(x, s * y, ridge - y * slope + t) for x in (a, b) for y in (0.0, reach) for t in (0.0, BOARD)],
                material=p.cover,
            )
    for s, side in ((-1, "front"), (1, "back")):
        for k in range(1, number):
            x = -long + 2 * long * k / number
            points = [
                (x + w, s * y, ridge - y * slope + t) for w in (-0.03, 0.03) for y in (0.15, reach - 0.02) for t in (0.028, 0.05)
            ]
            body.hull(f"strip_{side}_{k + 1}", points, material=p.cover)


class HippedRoofParameters(Parameters):
    """A roof of four equal slopes, its ridge along x; its plates stand on the walls (z = 0)."""

    length: float = Field(
        default=5.5, ge=1.5, le=12.0, description="of the walls under it along x, made no shorter than the width [m]"
    )
    width: float = Field(default=4.0, ge=1.5, le=8.0, description="of the walls under it along y [m]")
    pitch_deg: float = Field(default=38.0, ge=20.0, le=58.0, description="of the slopes [degrees]")
    eaves: float = Field(default=0.35, ge=0.1, le=0.7, description="overhang beyond the walls, in plan [m]")
    finials: bool = Field(default=True, description="turned points on the ends of the ridge")
    cover: str = material("slate", "roof_tile", "cedar", "copper", of="covering")
    material: str = material("spruce", "pine", "oak", "larch")


def _hipped_roof(p: HippedRoofParameters, rng: np.random.Generator) -> Made:
    body = Body("roof", p.material)
    slope = math.tan(math.radians(p.pitch_deg))
    y, x = p.width / 2, max(p.length, p.width) / 2
    reach = y + p.eaves
    stretch = x - y
    foot = PLATE * 0.8
    for s, side in ((-1, "front"), (1, "back")):
        a, b = sorted((s * y, s * (y - PLATE)))
        body.box(f"plate_{side}", (-x, a, 0), (x, b, foot))
    for s, side in ((-1, "left"), (1, "right")):
        a, b = sorted((s * x, s * (x - PLATE)))
        body.box(f"plate_{side}", (a, -y + PLATE, 0), (b, y - PLATE, foot))
    # The underside of the slopes passes the outer upper edge of the plates.
    ridge = foot + y * slope
    rows, deck = _rows(reach, p.pitch_deg), 0.03

    def corners(d: float, s: int, side: str) -> list[tuple[float, float]]:
        """Ends of the line of a slope at a distance from the ridge in plan."""
        if side in ("front", "back"):
            return [(-stretch - d, s * d), (stretch + d, s * d)]
        return [(s * (stretch + d), -d), (s * (stretch + d), d)]

    for s, side in ((-1, "front"), (1, "right"), (1, "back"), (-1, "left")):
        bottom = [(*q, ridge - d * slope + t) for d in (0.0, reach) for q in corners(d, s, side) for t in (0.0, deck)]
        body.hull(f"deck_{side}", bottom)
        for k in range(rows):
            a, b = reach * (1 - k / rows), reach * (1 - (k + 1) / rows)
            rough = float(rng.uniform(0.85, 1.0)) if side == "front" else 0.92
            points = [
                (*q, ridge - d * slope + deck + t)
                for d, ts in ((a, (0.0, THICK * rough)), (b, (0.0, THIN)))
                for q in corners(d, s, side)
                for t in ts
            ]
            body.hull(f"course_{side}_{k + 1}", points, material=p.cover)
    top = ridge + deck + THIN
    if stretch > 0.15:
        _ridge_tiles(body, stretch, top, _shallow(reach / rows, slope, THICK, THIN), cover=p.cover, crown=0.1)
    if p.finials:
        point = [(0, 0), (0.02, 0), (0.03, 0.1), (0.012, 0.16), (0.03, 0.24), (0, 0.5)]
        if stretch <= 0.15:
            body.turned("finial", point, (0, 0, top), segments=12, material="copper")
            return Made.of(body)
        tile = 2 * stretch / max(2, min(8, round(2 * stretch / 0.45)))
        for x, side in ((-stretch + 0.04, "left"), (stretch - 0.04, "right")):
            lift = LAP * (0.06 if x < 0 else tile - 0.02) / tile
            body.turned(f"finial_{side}", point, (x, 0, top + 0.035 + lift), segments=12, material="copper")
    return Made.of(body)


def _shallow(run: float, slope: float, thick: float, thin: float) -> float:
    """Least fall of the upper side of the topmost course, whose lower edge is thicker."""
    return slope - (thick - thin) / run


GENERATORS = (
    Generator("gable_roof", "gable roof for walls whose tops are at z = 0, with rafters, gables of boards and lapped tiles, shingles or boards", GableRoofParameters, _gable_roof,
              ("house", "barn", "pitched", "tiles", "shingles", "building"), motion="static", stands=False),
    Generator("hipped_roof", "hipped roof for walls whose tops are at z = 0, of four slopes with lapped courses and a ridge", HippedRoofParameters, _hipped_roof,
              ("house", "villa", "tiles", "slate", "building", "pavilion"), motion="static", stands=False),
)  # fmt: skip
