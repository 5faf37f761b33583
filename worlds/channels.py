"""Every channel and recorded quantity of the caches, joined from the declarations of the categories of matter.

Frames are checked against this registry when they are written and when they are read (`worlds/cache.py`); `worlds/writers.py` says
which kinds of writer an instance is. Frame k is the state at time k / fps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from .categories.registry import CATEGORIES
from .channel import RECORD, Channel

__all__ = ["CHANNELS", "DIMENSIONS", "QUANTITIES", "RECORD", "Channel", "mismatch", "names_written"]

DIMENSIONS: Mapping[str, str] = {
    "bodies": "`CacheIndex.bodies`: moving bodies `entity/body`; entities of a liquid or particle instance",
    "boundaries": "`CacheIndex.colliders` of an instance that meets bodies",
    "pushed": "`bodies` of a rigid instance, `boundaries` of any other",
    "drivers": "`CacheIndex.drivers`",
    "vertices": "simulation vertices of all `deformables`; of cloth that can tear, corners: 3 t, 3 t + 1, 3 t + 2 of triangle t",
    "particles": "particles; of grains in the order of their ids",
    **{name: meaning for category in CATEGORIES.values() for name, meaning in category.dimensions.items()},
}
"""Named dimensions and what their rows are."""


def _joined() -> dict[str, Channel]:
    """Every channel by name with the kinds of writer that have it, in the order of the categories."""
    declared = [(channel, of) for c in CATEGORIES.values() for of, channels in c.channels.items() for channel in channels]
    writers: dict[str, tuple[str, ...]] = {}
    for channel, of in declared:
        writers[channel.name] = (*writers.get(channel.name, ()), of)
    return {channel.name: replace(channel, of=writers[channel.name]) for channel, _ in declared}


CHANNELS: Mapping[str, Channel] = _joined()
"""Every channel by name."""
QUANTITIES: Mapping[str, Channel] = {n.removeprefix(RECORD): c for n, c in CHANNELS.items() if n.startswith(RECORD)}
"""Recorded quantities by name, without the prefix of their channels."""


def mismatch(data: Mapping[str, Any], sizes: Mapping[str, int] | None) -> str:
    """First way in which arrays differ from what is declared of them, as text; empty where they do not.

    Args:
        data: arrays by channel.
        sizes: known sizes by dimension; the others need only be the same in all channels. None: any number of rows is right.
    """
    found = dict(sizes or {})
    for name, values in data.items():
        channel, array = CHANNELS.get(name), np.asarray(values)
        if channel is None:
            return f"{name!r} is not declared"
        if array.dtype != channel.type:
            return f"{name!r} is {array.dtype.str}, declared {channel.type.str}"
        wanted = [
            d if isinstance(d, int) else n if sizes is None else found.setdefault(d, n)
            for d, n in zip(channel.shape, array.shape, strict=False)
        ]
        if list(array.shape) != wanted or len(array.shape) != len(channel.shape):
            return f"{name!r} has shape {array.shape}, declared {channel.shape}" + (f" = {tuple(wanted)}" if wanted else "")
    return ""


@cache
def names_written(writers: frozenset[str]) -> frozenset[str]:
    """Names of the channels that an instance which is all of these writes in every frame."""
    return frozenset(c.name for c in CHANNELS.values() if writers & set(c.of))
