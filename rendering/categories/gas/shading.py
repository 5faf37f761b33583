"""Light of a preview in a gas: what each cell sends on, of the sun, of the sky and of its own heat.

Light that is scattered more than once is told by how easily it escapes (escape probability): with albedo w, unscattered light S and the
mean P of what six ways out leave of light, a thick gas sends back w S / (1 - w (1 - P)). It is exact where the gas is thin, where it
scatters nothing, and where it takes nothing in light from all sides.
"""

from __future__ import annotations

import numpy as np

from ....worlds.arrays import F32, F64
from ...glow import glow
from ..layer import Daylight
from .boxes import GasBox

__all__ = ["depth_towards", "emitted", "source_of"]

DAYLIGHT = 235.0
"""[W/(m^2 sr)] Radiance of a white sheet in the sun that previews show as white: 700 W/m^2 of clear sky, as in the path tracer."""


def depth_towards(sigma: F32, way: F64, cell: float) -> F64:
    """Optical depth from each cell's centre out of the box along a unit direction, shape (nx, ny, nz).

    Slice by slice across the axis that the direction follows most; what enters through a side comes from clear air.
    """
    axis = int(np.abs(way).argmax())
    turned = np.moveaxis(np.asarray(sigma, dtype=np.float64), axis, 0)
    if way[axis] < 0:
        turned = turned[::-1]
    across = np.delete(way, axis) / abs(way[axis])
    length = cell / abs(float(way[axis]))
    found = np.empty_like(turned)
    found[-1] = 0.5 * length * turned[-1]
    for k in range(len(turned) - 2, -1, -1):
        found[k] = _shifted(found[k + 1] + 0.5 * length * turned[k + 1], across) + 0.5 * length * turned[k]
    if way[axis] < 0:
        found = found[::-1]
    return np.moveaxis(found, 0, axis)


def _shifted(plane: F64, by: F64) -> F64:
    """A plane of cells looked up so many cells on, none beyond its edge."""
    for axis, cells in enumerate(by.tolist()):
        whole = int(np.floor(cells))
        share = cells - whole
        if share == 0.0 and whole == 0:
            continue
        padded = np.pad(plane, [(2, 2) if k == axis else (0, 0) for k in range(2)])
        index = np.arange(plane.shape[axis]) + 2 + whole
        plane = (1 - share) * padded.take(index, axis=axis) + share * padded.take(index + 1, axis=axis)
    return plane


def _escape(box: GasBox) -> tuple[F64, tuple[F64, ...]]:
    """Mean share of light that six ways out leave, and each of them (-x, +x, -y, +y, -z, +z), shape (nx, ny, nz)."""
    ways = []
    half = 0.5 * box.cell * np.asarray(box.sigma, dtype=np.float64)
    for axis in range(3):
        before = box.cell * np.cumsum(box.sigma, axis=axis, dtype=np.float64)
        total = np.take(before, [-1], axis=axis)
        ways += [np.exp(-(before - half)), np.exp(-(total - before + half))]
    return np.mean(ways, axis=0), tuple(ways)


def source_of(box: GasBox, light: Daylight) -> F32:
    """Radiance of gas that is thick in each cell, on the scale of previews, shape (nx, ny, nz, 3)."""
    escape, ways = _escape(box)
    full = box.sigma > 0
    sunny = np.zeros(box.sigma.shape)
    sunny[full] = light.share(box.centers[full])
    sunny *= np.exp(-depth_towards(box.sigma, light.sun, box.cell))
    # Isotropic scattering: a quarter of what a sheet across the sun gives back.
    around = 0.5 * (light.sky + light.ground)
    came = 0.25 * sunny[..., None] * light.sunlight
    came += (
        np.sum(ways[:4], axis=0)[..., None] * around + ways[4][..., None] * light.ground + ways[5][..., None] * light.sky
    ) / 6.0
    albedo = box.look.albedo
    sent = albedo * came / (1.0 - albedo * (1.0 - escape[..., None]))
    return (sent + emitted(box) / DAYLIGHT).astype(np.float32)


def emitted(box: GasBox) -> F64:
    """Radiance of the heat of gas that is thick in each cell [W/(m^2 sr)], shape (nx, ny, nz, 3): that of a black body, less the albedo."""
    if not box.hot:
        return np.zeros((*box.sigma.shape, 3))
    return (1.0 - box.look.albedo) * glow(box.temperature)
