"""Gases of one frame as media for Mitsuba: boxes of index 1 whose inside takes and scatters light."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...tracer.meshes import rgb
from ..layer import GLOWS, Fog, TracedShapes
from .boxes import GasBox
from .look import ASYMMETRY
from .shading import emitted

__all__ = ["fogs_of"]

INSET = 0.02
"""[cells] Own choice: how far the face of a box lies within its cells, so that a floor is not in one plane with it."""
ROUNDING = 5e-4
"""[1] The same in shares of 1 m and of coordinates: single precision of the tracer, which starts rays 1.5e-4 of them off a surface."""


def fogs_of(mi: Any, boxes: Mapping[str, GasBox]) -> TracedShapes:
    """Boxes of gas, by entity, and the lights that stand for their heat."""
    shapes, fogs = {}, {}
    for entity, box in boxes.items():
        name, fog = f"gas-{entity}", _fog(mi, box)
        shapes[name] = mi.load_dict(
            {"type": "cube", "to_world": _placed(mi, fog.low, fog.high), "bsdf": {"type": "null"}, "interior": fog.medium}
        )
        fogs[name] = fog
        shapes |= {f"{kind}-{entity}": light for kind, light in zip(GLOWS, _lights(mi, box), strict=False)}
    return TracedShapes(shapes, fogs=fogs)


def _lights(mi: Any, box: GasBox) -> list[Any]:
    """Points that shine as the heat of a gas does, each of a like share of its power; none of a gas that is cold.

    Gas of extinction k and radiance J where it is thick gives k J per volume into every direction; what it takes of that itself on the
    way out, the medium takes from the light of the points.
    """
    if not box.hot:
        return []
    given = box.sigma[..., None] * emitted(box) * box.cell**3
    power = given.sum(-1)
    full = power > 0
    given, power, places = given[full], power[full], box.centers[full]
    along = np.argsort(places[:, int(np.ptp(places, axis=0).argmax())], kind="stable")
    share = np.minimum(np.cumsum(power[along]) / power.sum() * len(GLOWS), len(GLOWS) - 1).astype(np.int64)
    found = []
    for k in np.unique(share):
        own = along[share == k]
        middle = np.average(places[own], axis=0, weights=power[own])
        found.append(mi.load_dict({"type": "point", "position": middle.tolist(), "intensity": rgb(given[own].sum(0))}))
    return found


def _placed(mi: Any, low: Any, high: Any) -> Any:
    """Transform of the cube from -1 to 1 to a box."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    return mi.ScalarTransform4f().translate(middle.tolist()).scale(half.tolist())


def _fog(mi: Any, box: GasBox) -> Fog:
    # A grid of Mitsuba fills the unit cube, x fastest.
    grid = mi.VolumeGrid(np.ascontiguousarray(np.transpose(box.sigma, (2, 1, 0))[..., None]))
    size = box.high - box.low
    place = mi.ScalarTransform4f().translate(box.low.tolist()).scale(size.tolist())
    medium = mi.load_dict(
        {
            "type": "heterogeneous",
            "sigma_t": {"type": "gridvolume", "grid": grid, "raw": True, "to_world": place, "wrap_mode": "clamp"},
            "albedo": {"type": "constvolume", "value": rgb(box.look.albedo)},
            "phase": {"type": "hg", "g": ASYMMETRY},
        }
    )
    inset = np.maximum(INSET * box.cell, ROUNDING * (1.0 + np.maximum(np.abs(box.low), np.abs(box.high))))
    inset = np.minimum(inset, 0.2 * size)
    return Fog(box.low + inset, box.high - inset, medium)
