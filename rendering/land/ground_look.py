"""Colours of the ground of a landscape: its materials, grass where it is moist, forest floor, snow, wet banks, and grain."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import ndimage

from ...worlds.candidate import Candidate
from ...worlds.landscape import SavedLandscape

__all__ = ["ground_bsdf", "ground_image"]

DEFAULT_LOOK: dict[str, tuple[float, float, float]] = {
    "bare-rock": (0.23, 0.21, 0.19),
    "river-sediment": (0.33, 0.29, 0.23),
    "soil": (0.16, 0.14, 0.07),
}
"""Linear colours of ground that no rule covers."""
GRASS = (0.10, 0.16, 0.035)
SNOW = (0.85, 0.87, 0.9)
FOREST = (0.03, 0.055, 0.015)
CLOSED = 0.012
"""Trees per m^2 from which the ground between them lies in their shade."""
IMAGE_PIXELS = 1_500_000
"""Most pixels of a picture of the ground."""
GRAIN_M = (9.0, 0.9)
"""Size of the tiles that vary brightness at a distance and near [m]."""


def ground_image(candidate: Candidate, land: SavedLandscape) -> np.ndarray:
    """Colours of the ground, linear RGB, shape (rows, cols, 3), row 0 south."""
    names = land.about["cover"]
    looks = np.array([_look(candidate, n) for n in names], dtype=np.float32)
    index = land.raw("cover")
    image = looks[index]
    green = np.clip((land.field("moisture") - 0.2) / 0.45, 0, 1) * np.clip(land.field("soil_depth") / 0.3, 0, 1)
    green *= index == names.index("soil")
    image += (green[..., None] * 0.85 * (np.array(GRASS) - image)).astype(np.float32)
    if "tree_density" in land.names:
        shade = np.clip(land.field("tree_density") / CLOSED, 0, 0.8) * ~land.raw("wet").astype(bool)
        image += (shade[..., None] * (np.array(FOREST) - image)).astype(np.float32)
    wet = np.exp(-np.nan_to_num(land.field("water_distance"), posinf=1e6) / (0.7 * land.cell)) * 0.35
    image *= (1 - wet)[..., None].astype(np.float32)
    snow = land.field("snow")
    image += (snow[..., None] * (np.array(SNOW) - image)).astype(np.float32)
    rng = np.random.default_rng(3)
    return np.asarray(np.clip(image * rng.normal(1.0, 0.06, (*index.shape, 1)), 0, 1), dtype=np.float32)


def _look(candidate: Candidate, name: str) -> tuple[float, float, float]:
    if name in DEFAULT_LOOK:
        return DEFAULT_LOOK[name]
    return candidate.spec.materials[name].appearance.color if name in candidate.spec.materials else (0.3, 0.3, 0.3)


def _ragged(image: np.ndarray) -> np.ndarray:
    """The picture finer, with borders between materials that wander instead of following cells."""
    rows, cols = image.shape[:2]
    factor = int(np.clip(np.sqrt(IMAGE_PIXELS / (rows * cols)), 1, 4))
    if factor == 1:
        return image
    rng = np.random.default_rng(5)
    v, u = np.meshgrid(
        (np.arange(rows * factor) + 0.5) / factor - 0.5, (np.arange(cols * factor) + 0.5) / factor - 0.5, indexing="ij"
    )
    for k, reach in ((1.0, 0.5), (2.5, 0.6)):
        v += reach * ndimage.gaussian_filter(rng.normal(size=v.shape), k * factor / 2) * k * factor
        u += reach * ndimage.gaussian_filter(rng.normal(size=v.shape), k * factor / 2) * k * factor
    return np.stack([ndimage.map_coordinates(image[..., c], [v, u], order=1, mode="nearest") for c in range(3)], axis=-1)


def _grain(seed: int) -> np.ndarray:
    """A tile of soft grain, 0 to 1, that continues at its edges."""
    rng = np.random.default_rng(seed)
    total = np.zeros((256, 256))
    for k in (1.0, 2.5, 6.0, 14.0):
        part = ndimage.gaussian_filter(rng.normal(size=(256, 256)), k, mode="wrap")
        total += part / part.std()
    share = 0.5 + 0.22 * total / total.std()
    return np.asarray(np.clip(share, 0, 1), dtype=np.float32)[..., None]


def ground_bsdf(mi: Any, image: np.ndarray, land: SavedLandscape) -> Any:
    """Matt ground coloured by a picture whose row 0 lies south, lighter and darker by two tiles of grain."""
    picture = _ragged(image)
    extent = max(land.shape) * land.cell

    def coloured(factor: float) -> dict[str, Any]:
        bitmap = mi.Bitmap(np.ascontiguousarray(np.clip(picture * factor, 0, 1), dtype=np.float32))
        texture = {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": "clamp"}
        return {"type": "diffuse", "reflectance": texture}

    def tile(seed: int, size: float) -> dict[str, Any]:
        scale = mi.ScalarTransform3f().scale(extent / (16 * size))
        return {"type": "bitmap", "bitmap": mi.Bitmap(_grain(seed)), "raw": True, "wrap_mode": "repeat", "to_uv": scale}

    far, near = GRAIN_M
    dark = {"type": "blendbsdf", "weight": tile(1, near), "a": coloured(0.45), "b": coloured(0.95)}
    light = {"type": "blendbsdf", "weight": tile(2, near), "a": coloured(0.95), "b": coloured(1.55)}
    return mi.load_dict({"type": "twosided", "bsdf": {"type": "blendbsdf", "weight": tile(3, far), "a": dark, "b": light}})
