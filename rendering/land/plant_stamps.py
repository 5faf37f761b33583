"""Plants in previews: small silhouettes with crown and trunk, told by their shape, their height in pixels and how steeply one looks."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...geometry.camera import Camera
from ...worlds.arrays import F64

__all__ = ["Stamp", "Stand", "draw_plants", "stamp_of"]

TALLEST = 480
"""Most pixels that a plant is high."""
FINE = 12
"""Heights up to this are drawn as they are [pixels]; larger ones in steps."""
STEP = 1.07
"""Factor between the heights of larger stamps."""
PITCHES = 6
"""Stamps from level to straight down."""
VARIANTS = 3
NEAREST = 1.0
"""Plants nearer than this are left out [m]."""
BARK = (0.11, 0.08, 0.055)
BARE = 8
"""Stamps less high than this have no trunk of their own colour [pixels]."""
CROWNS = {"broad": (0.66, 0.29, 0.34), "bush": (0.45, 0.52, 0.5), "rock": (0.3, 0.7, 0.6), "column": (0.5, 0.09, 0.5)}
"""Round crowns: height of the middle, half width and half height, over the height of the plant."""
TRUNKS = {"broad": (0.5, 0.022), "cone": (0.2, 0.018), "palm": (0.9, 0.016)}
"""Height up to which the trunk shows, and half its width."""


class Stamp(NamedTuple):
    """Pixels of a silhouette, each of shape (n,)."""

    right: np.ndarray
    """Pixels to the right of the plant's foot."""
    down: np.ndarray
    light: F64
    """Factor on the colour."""
    bark: np.ndarray
    """True where it is trunk."""


class Stand(NamedTuple):
    """Plants to draw."""

    foot: F64
    """[m], shape (n, 3)."""
    tall: F64
    """[m], shape (n,)."""
    shape: tuple[str, ...]
    """Names of the shapes."""
    kind: np.ndarray
    """Index into `shape`, shape (n,)."""
    color: F64
    """Linear, shape (n, 3)."""


@lru_cache(maxsize=4096)
def stamp_of(shape: str, tall: int, pitch: int, variant: int) -> Stamp:
    """The silhouette of a plant.

    Args:
        shape: `broad`, `cone`, `palm`, `bush`, `tuft`, `column` or `rock`.
        tall: height [pixels], as seen from the side.
        pitch: 0 seen from the side to `PITCHES` - 1 seen from above.
        variant: of its outline.
    """
    steep = (pitch + 0.5) / PITCHES
    level = float(np.sqrt(1 - steep**2))
    reach = max(1, int(np.ceil(0.75 * tall)))
    down, right = np.mgrid[-tall - 1 : reach + 1, -reach : reach + 1]
    across, up = right / tall, (0.5 - down) / tall
    noise = np.random.default_rng([variant, tall]).uniform(-1, 1, across.shape)
    if shape == "cone":
        crown, light = _pointed(across, up, level, steep, variant)
    elif shape in ("palm", "tuft"):
        crown, light = _fan(shape, across, up, level, steep, variant)
    else:
        crown, light = _round(shape, across, up, level, steep, variant)
    high, half = TRUNKS.get(shape, (0.0, 0.0))
    trunk = (np.abs(across) <= max(half, 0.5 / tall)) & (up >= 0) & (up <= high * level) & ~crown
    if tall < BARE:
        trunk[:] = False
    shown = crown | trunk
    if not shown.any():
        shown[tall, reach] = True
    light = np.clip(light + 0.1 * noise, 0.35, 1.5)
    return Stamp(right[shown], down[shown], np.where(trunk, 1.0, light)[shown], trunk[shown])


def _round(shape: str, across: F64, up: F64, level: float, steep: float, variant: int) -> tuple[np.ndarray, F64]:
    """An ellipsoid with lumps."""
    middle, wide, high = CROWNS[shape]
    seen = np.hypot(high * level, wide * steep)
    x, y = across / wide, (up - middle * level) / seen
    turn = np.arctan2(y, x)
    lumps = 0.0 if shape == "column" else 0.1 * np.sin(5 * turn + 2.1 * variant) + 0.05 * np.sin(11 * turn + variant)
    return np.hypot(x, y) <= 1 + lumps, 0.78 + 0.32 * y - 0.08 * x


def _pointed(across: F64, up: F64, level: float, steep: float, variant: int) -> tuple[np.ndarray, F64]:
    """A conifer: tiers of branches to a tip, and from above the ring of the lowest."""
    foot, wide = 0.12, 0.21
    height = (up / max(level, 1e-3) - foot) / (1 - foot)
    tier = np.mod(height * 5 + 0.3 * variant, 1.0)
    half = wide * (1 - height) * (1.12 - 0.35 * tier) + 0.01
    side = (height >= 0) & (height <= 1) & (np.abs(across) <= half)
    ring = np.hypot(across / wide, (up - foot * level) / max(wide * steep, 1e-3))
    spikes = 1 + 0.12 * np.sin(9 * np.arctan2(up - foot * level, across) + variant)
    light = 0.62 + 0.35 * np.clip(height, 0, 1) - 0.25 * (tier - 0.5) * (level > 0.5)
    return side | (ring <= spikes), np.where(side, light, 0.95 - 0.4 * np.minimum(ring, 1))


def _fan(shape: str, across: F64, up: F64, level: float, steep: float, variant: int) -> tuple[np.ndarray, F64]:
    """Fronds or blades that spread from a point."""
    middle, wide, count = (0.88, 0.34, 9) if shape == "palm" else (0.0, 0.95, 7)
    x, y = across, up - middle * level
    away, turn = np.hypot(x, y / np.hypot(level, steep)), np.arctan2(y, x)
    blades = np.abs(np.mod(turn * count / (2 * np.pi) + 0.21 * variant, 1.0) - 0.5) < 0.34 - 0.2 * away / wide
    found = (away <= wide) & (blades | (away < 0.25 * wide))
    if shape == "tuft":
        found &= up >= 0
    return found, 0.75 + 0.5 * y / wide


def draw_plants(picture: F64, depth: F64, stand: Stand, camera: Camera, light: float) -> None:
    """Draw plants into a linear picture (height, width, 3) where nothing is nearer; near ones cover far ones.

    Args:
        picture: changed in place.
        depth: of what is there, along the viewing axis [m], shape (height, width).
        stand: the plants.
        camera: the view.
        light: factor on all.
    """
    if not len(stand.foot):
        return
    height, width = depth.shape
    pixels, away = camera.project(stand.foot)
    before = away > NEAREST
    tall = np.zeros(len(away))
    tall[before] = camera.focal * stand.tall[before] / away[before]
    near = (
        before
        & (pixels > -TALLEST).all(axis=1)
        & (pixels < (width + TALLEST, height + TALLEST)).all(axis=1)
        & (tall <= 4 * TALLEST)
    )
    shown = np.flatnonzero(near)
    if not len(shown):
        return
    size = _steps(np.minimum(tall[shown], TALLEST))
    sight = camera.position - stand.foot[shown]
    steep = np.clip(sight[:, 2] / np.maximum(np.linalg.norm(sight, axis=1), 1e-9), 0, 1)
    pitch = np.minimum((steep * PITCHES).astype(np.int64), PITCHES - 1)
    variant = np.where(size > FINE, shown % VARIANTS, 0)
    rank = np.empty(len(shown), dtype=np.int64)
    rank[np.argsort(-away[shown], kind="stable")] = np.arange(len(shown))
    keys = np.stack([stand.kind[shown].astype(np.int64), size, pitch, variant], axis=1)
    groups, member = np.unique(keys, axis=0, return_inverse=True)
    order = np.argsort(member.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(member.ravel(), minlength=len(groups)))
    found = []
    for key, own in zip(groups.tolist(), np.split(order, ends[:-1]), strict=True):
        stamp = stamp_of(stand.shape[key[0]], *key[1:])
        who = shown[own]
        column = (np.floor(pixels[who, 0]).astype(np.int64)[:, None] + stamp.right).ravel()
        row = (np.floor(pixels[who, 1]).astype(np.int64)[:, None] + stamp.down).ravel()
        plant = np.repeat(own, len(stamp.right))
        part = np.tile(np.arange(len(stamp.right)), len(who))
        inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        column, row, plant, part = column[inside], row[inside], plant[inside], part[inside]
        far = away[shown[plant]] - 0.3 * stand.tall[shown[plant]]
        clear = far < depth[row, column]
        column, row, plant, part = column[clear], row[clear], plant[clear], part[clear]
        tint = 0.55 + 0.45 * np.mod(0.618 * shown[plant], 1.0)
        shade = np.where(stamp.bark[part][:, None], np.outer(tint, BARK), stand.color[shown[plant]])
        found.append((rank[plant], row, column, shade * (light * stamp.light[part])[:, None]))
    ranks, rows, columns, colors = (np.concatenate([f[k] for f in found]) for k in range(4))
    last = np.argsort(ranks, kind="stable")
    picture[rows[last], columns[last]] = colors[last]


def _steps(tall: F64) -> np.ndarray:
    """Heights as stamps have them [pixels]."""
    fine = np.maximum(np.round(tall), 1).astype(np.int64)
    coarse = np.round(FINE * STEP ** np.round(np.log(np.maximum(tall, FINE) / FINE) / np.log(STEP))).astype(np.int64)
    return np.where(fine <= FINE, fine, coarse)
