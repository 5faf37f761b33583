"""Procedural, seamlessly repeating colour tiles for the patterns of `Appearance`: wood, checker, concrete, tiles, bricks.

A tile is a linear RGB picture whose mean is the material's colour. One *period* is `Appearance.pattern_scale`;
a wood tile shows `BOARDS` boards, each one period wide. Boards start at their own joint, so that a part smaller
than a board can be placed inside one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...worlds.arrays import F32, F64

Pattern = Literal["plain", "wood", "checker", "concrete", "tiles", "bricks"]
"""Patterns of `Appearance`."""

__all__ = ["BOARDS", "BOARD_LENGTH", "Tile", "board_joint", "brick_middle", "pattern_tiles"]

BOARDS = 4
"""Boards side by side in a wood tile."""
BOARD_LENGTH = 16
"""Length of a board in periods; also the length of a wood tile."""
PIXELS = 128
"""Pixels across one period of wood, or one tile of a floor."""
JOINT = 0.02
"""[1] Own choice: width of a joint as share of a tile: 4 mm of 200."""
BRICK = 126
"""Pixels along a brick with its joint, one period; a multiple of 3 and of 2."""
BRICKS = (8, 4)
"""Periods along and up a picture of bricks: 8 in each of 12 courses."""
COURSES = 3
"""[1] Courses in one period: a brick and joint are 225 x 75 mm (BS EN 771-1, 215 x 65 mm with joints of 10 mm)."""
MORTAR_JOINT = 10.0 / 225.0
"""[1] Width of a joint as share of the period, the same source."""
MORTAR = (1.2, 2.2, 2.8)
"""[1] Own choice: mortar of lime and cement, by channel as share of the bricks' colour; greyer and lighter than red bricks."""
GROUT = 0.42
"""[1] Own choice: brightness of a joint as share of the tiles'."""


@dataclass(frozen=True)
class Tile:
    """A repeating picture and how many periods it spans."""

    image: F32
    """Linear RGB, shape (rows, columns, 3)."""
    periods: tuple[float, float]
    """Periods along u (columns) and v (rows)."""
    sharp: bool = False
    """Nearest-texel lookup instead of bilinear."""


def board_joint(board: int) -> float:
    """Where board number `board` starts along the grain, in periods."""
    return (board * 0.618034 % 1.0) * BOARD_LENGTH


def _noise(random: np.random.Generator, rows: int, columns: int, across: float, along: float) -> F32:
    """Periodic Gaussian noise, unit deviation; correlation lengths in pixels over rows and columns."""
    fy = np.fft.fftfreq(rows)[:, None]
    fx = np.fft.rfftfreq(columns)[None]
    transfer = np.exp(-2 * math.pi**2 * ((fy * across) ** 2 + (fx * along) ** 2))
    field = np.fft.irfft2(np.fft.rfft2(random.standard_normal((rows, columns))) * transfer, s=(rows, columns))
    field -= field.mean()
    return np.asarray(field / max(float(field.std()), 1e-12), dtype=np.float32)


def _tint(shade: F32, color: tuple[float, float, float], warmth: tuple[float, float, float]) -> F32:
    """Colour a shade (1 = the material's colour): darker places keep more red; the mean stays the colour."""
    tinted = np.stack([np.maximum(shade, 0.02) ** w for w in warmth], axis=-1)
    tinted /= tinted.mean((0, 1), keepdims=True)
    return np.asarray(np.clip(tinted * np.array(color), 0.0, 0.95), dtype=np.float32)


def _ring_shade(radius: F32) -> F32:
    """Early wood fades into a dark line of late wood, then starts again; one ring per unit of radius."""
    phase = radius % 1.0
    end = np.clip((phase - 0.90) / 0.10, 0, 1)
    return np.asarray(phase**3 * (1 - end * end * (3 - 2 * end)), dtype=np.float32)


def _wood(color: tuple[float, float, float], seed: int) -> Tile:
    """Plain-sawn boards: the growth cones of the trunk, cut lengthwise, give arches and long lines."""
    random = np.random.default_rng([seed, 1])
    rows, columns = PIXELS, BOARD_LENGTH * PIXELS // 2
    boards = []
    for board in range(BOARDS):
        start = int(board_joint(board) / BOARD_LENGTH * columns)
        x = (((np.arange(columns) - start) % columns) / columns * BOARD_LENGTH)[None].astype(np.float32)
        y = ((np.arange(rows) + 0.5) / rows)[:, None].astype(np.float32)
        warp = _noise(random, rows, columns, 26, 150) * 0.05 + _noise(random, rows, columns, 7, 60) * 0.010
        center = random.uniform(0.25, 0.75)
        depth = random.uniform(0.05, 0.5) + random.choice([-1.0, 1.0]) * 0.045 * (x - random.uniform(2, 14))
        radius = np.sqrt((y - center + warp) ** 2 + depth**2) + warp * 0.5
        rings = _ring_shade(radius * random.uniform(8, 11))
        fibre = _noise(random, rows, columns, 0.6, 40)
        pores = np.clip(_noise(random, rows, columns, 0.5, 9) - 1.5, 0, 1.5)
        shade = 1.0 - 0.42 * rings + 0.045 * fibre - 0.10 * pores + 0.05 * _noise(random, rows, columns, 40, 300)
        shade *= random.uniform(0.88, 1.10)
        groove = np.minimum(np.arange(rows), np.arange(rows)[::-1]) < 1
        shade[groove] *= 0.55
        shade[:, [(start + k) % columns for k in (-1, 0)]] *= 0.55
        boards.append(shade)
    return Tile(_tint(np.concatenate(boards), color, (0.9, 1.1, 1.35)), (BOARD_LENGTH, BOARDS))


def _end_grain(color: tuple[float, float, float], seed: int) -> Tile:
    random = np.random.default_rng([seed, 2])
    size = PIXELS
    grid = (np.arange(size, dtype=np.float32) + 0.5) / size
    cells = []
    for _ in range(4):
        cy, cx = random.uniform(-0.6, -0.2), random.uniform(0.2, 0.8)
        warp = _noise(random, size, size, 20, 20) * 0.02
        radius = np.hypot(grid[None] - cx, grid[:, None] - cy) + warp
        cells.append(0.82 - 0.38 * _ring_shade(radius * 10) + 0.05 * _noise(random, size, size, 0.7, 0.7))
    return Tile(_tint(np.block([cells[:2], cells[2:]]).astype(np.float32), color, (0.9, 1.1, 1.35)), (2, 2))


def _concrete(color: tuple[float, float, float], seed: int) -> Tile:
    random = np.random.default_rng([seed, 3])
    size = 768
    shade = np.ones((size, size), dtype=np.float32)
    for length, weight in ((110.0, 0.07), (35.0, 0.05), (10.0, 0.035), (2.5, 0.03), (0.7, 0.035)):
        shade += weight * _noise(random, size, size, length, length)
    pores = _noise(random, size, size, 1.6, 1.6)
    shade -= 0.5 * np.clip(pores - 3.0, 0, 0.7)
    return Tile(_tint(np.clip(shade, 0.2, 1.8), color, (1.0, 1.0, 1.02)), (6, 6))


def _checker(color: tuple[float, float, float]) -> Tile:
    dark = np.array(color) * 0.25
    light = np.array(color)
    return Tile(np.array([[light, dark], [dark, light]], dtype=np.float32), (1, 1), sharp=True)


def _paved(color: tuple[float, float, float], seed: int) -> Tile:
    """Six by six square tiles, none quite like the next, with joints between and a bevel at their edges."""
    random = np.random.default_rng([seed, 4])
    count, size = 6, PIXELS
    at = (np.arange(size, dtype=np.float32) + 0.5) / size
    edge = np.minimum(at, 1.0 - at)
    inside = np.minimum(edge[:, None], edge[None])
    joint = inside < JOINT / 2
    bevel = np.clip(1.0 - (inside - JOINT / 2) / JOINT, 0.0, 1.0)
    rows = []
    for _ in range(count):
        row = []
        for _ in range(count):
            shade = (
                random.uniform(0.93, 1.07) + 0.02 * _noise(random, size, size, 30, 30) + 0.012 * _noise(random, size, size, 1, 1)
            )
            row.append(np.where(joint, GROUT * (1.0 + 0.08 * _noise(random, size, size, 1, 1)), shade * (1.0 - 0.12 * bevel)))
        rows.append(row)
    return Tile(_tint(np.block(rows).astype(np.float32), color, (1.0, 1.0, 1.0)), (count, count))


def brick_middle(random: F64) -> F64:
    """Texture coordinates in a picture of bricks, shape (2,), of the middle of one of them; `random` two numbers in [0, 1)."""
    column, course = np.floor(random[:2] * (BRICKS[0], BRICKS[1] * COURSES))
    return np.array([(column + 0.5 + 0.5 * (course % 2)) / BRICKS[0], (course + 0.5) / (BRICKS[1] * COURSES)])


def _bricks(color: tuple[float, float, float], seed: int) -> Tile:
    """Courses of bricks in running bond, each brick of a tone of its own, with joints of mortar."""
    random = np.random.default_rng([seed, 5])
    columns, courses, high = BRICKS[0], BRICKS[1] * COURSES, BRICK // COURSES
    along, up = ((np.arange(n, dtype=np.float32) + 0.5) / BRICK for n in (BRICK, high))
    inside = np.minimum(np.minimum(along, 1.0 - along)[None], np.minimum(up, 1.0 / COURSES - up)[:, None])
    rows = []
    for course in range(courses):
        tones = random.normal(1.0, 0.13, columns).clip(0.6, 1.4)  # burnt darker or lighter, brick by brick
        row = np.repeat(tones, BRICK)[None] * np.ones((high, 1))
        rows.append(np.roll(np.concatenate([row[None], np.tile(inside, columns)[None]]), course % 2 * (BRICK // 2), axis=2))
    shade, edge = np.concatenate(rows, axis=1)
    grain = [_noise(random, shade.shape[0], shade.shape[1], length, length) for length in (14.0, 3.0, 0.8)]
    mottled = shade * (1.0 + 0.06 * grain[0] + 0.05 * grain[1] + 0.05 * grain[2])
    # Edges of bricks are worn by a millimetre or two.
    mortar = (edge + 0.004 * grain[1] < MORTAR_JOINT / 2)[..., None]
    image = np.where(mortar, (1.0 + 0.06 * grain[2])[..., None] * MORTAR, mottled[..., None])
    image *= np.array(color) / image.mean((0, 1))
    return Tile(np.asarray(np.clip(image, 0.0, 0.95), dtype=np.float32), BRICKS)


def pattern_tiles(pattern: Pattern, color: tuple[float, float, float], *, seed: int = 0) -> dict[str, Tile]:
    """Tiles of a pattern by layer: `side`, and `end` for the end grain of wood; empty for `plain`."""
    if pattern == "wood":
        return {"side": _wood(color, seed), "end": _end_grain(color, seed)}
    if pattern == "concrete":
        return {"side": _concrete(color, seed)}
    if pattern == "tiles":
        return {"side": _paved(color, seed)}
    if pattern == "bricks":
        return {"side": _bricks(color, seed)}
    if pattern == "checker":
        return {"side": _checker(color)}
    return {}
