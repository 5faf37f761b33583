"""Spheres in a cast picture."""

from __future__ import annotations

import numpy as np

from ....geometry.camera import Camera
from ....geometry.idcast import IdImage
from ....worlds.arrays import F64

__all__ = ["splat", "unseen"]

LEAST_PIXELS = 0.6
"""Radius in pixels at which particles are drawn at least: sparks and rain are smaller than a pixel."""
MOST_PIXELS = 160


def unseen(camera: Camera) -> IdImage:
    """A picture in which nothing is seen."""
    size = (camera.height, camera.width)
    return IdImage(np.full(size, -1, np.int32), np.full(size, np.inf, np.float32), np.zeros((*size, 3), np.float32))


def splat(image: IdImage, spheres: tuple[F64, F64], camera: Camera, number: int) -> None:
    """Draw spheres of centres (n, 3) and radii (n,) [m] into a picture, in place, where they are nearer: every pixel of a sphere's square looks along its own ray."""
    height, width = image.ids.shape
    eye, directions = camera.rays()
    pixel, far = camera.project(spheres[0])
    size = np.clip(spheres[1] * camera.focal / np.maximum(far, 1e-9), LEAST_PIXELS, MOST_PIXELS)
    seen = (
        (far > 0) & (pixel[:, 0] > -size) & (pixel[:, 0] < width + size) & (pixel[:, 1] > -size) & (pixel[:, 1] < height + size)
    )
    center, pixel, far, size = spheres[0][seen], pixel[seen], far[seen], size[seen]
    if not len(center):
        return
    radius = np.maximum(spheres[1][seen], size * far / camera.focal)
    reach = int(np.ceil(size.max())) + 1
    best = image.depth.reshape(-1).astype(np.float64)
    owner = np.full(best.shape, -1, dtype=np.int64)
    base = np.floor(pixel).astype(np.int64)
    for dy in range(-reach, reach + 1):
        for dx in range(-reach, reach + 1):
            column, row = base[:, 0] + dx, base[:, 1] + dy
            near = np.flatnonzero(
                (np.hypot(dx, dy) <= size + 1.5) & (column >= 0) & (column < width) & (row >= 0) & (row < height)
            )
            if not len(near):
                continue
            place = row[near] * width + column[near]
            ray = directions.reshape(-1, 3)[place]
            way = center[near] - eye
            along = (way * ray).sum(axis=1)
            gap = radius[near] ** 2 - ((way**2).sum(axis=1) - along**2)
            hit = gap >= 0
            t = along[hit] - np.sqrt(gap[hit])
            deep = t * -(ray[hit] @ camera.axes[2])
            at = place[hit]
            order = np.argsort(-deep, kind="stable")  # of several in one pixel the nearest is written last
            at, deep, who = at[order], deep[order], near[hit][order]
            closer = (deep > 0) & (deep < best[at])
            best[at[closer]], owner[at[closer]] = deep[closer], who[closer]
    drawn = np.flatnonzero(owner >= 0)
    if not len(drawn):
        return
    ray = directions.reshape(-1, 3)[drawn]
    t = best[drawn] / -(ray @ camera.axes[2])
    out = eye + t[:, None] * ray - center[owner[drawn]]
    image.ids.reshape(-1)[drawn] = number
    image.depth.reshape(-1)[drawn] = best[drawn].astype(np.float32)
    image.normals.reshape(-1, 3)[drawn] = (out / np.maximum(np.linalg.norm(out, axis=1), 1e-12)[:, None]).astype(np.float32)
