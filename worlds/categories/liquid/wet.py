"""Wet maps of a liquid instance: which places of the solids' surfaces it touched, at which frames, and how deep they lay in it.

They stand in `wet/` in the folder of the instance's cache. `texels.npz` holds the places, evenly spread over the surfaces of the
solids that the liquid may reach; every frame has a container of those that are wet then. When a place was wet first and last, how
long in all and how deep at most follows from the frames. Drying is a declared law and no simulation: the film that a liquid leaves
fades as exp(-t / drying), with `appearance.drying` of the liquid's material. Tracks are one too: where a surface with a film meets
another, the film splits and each keeps half of both (the usual ratio of ink between smooth faces, Walker and Fetsko 1955).

`worlds/channels.py` says what the channels of a frame hold. Those of `texels.npz`: `texel/position` on the visible surface in the frame
of its body [m] and outward `texel/normal`, f4 (t, 3); `texel/area` that it stands for [m^2], f4 (t,); `texel/part`, i4 (t,), index into
`parts` of `wet.json`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import F64, I32
from ...cache import Cache, digest_arrays, read_container
from ...derived import Derived
from ...errors import EvidenceError

__all__ = ["Texels", "WetMap", "WetState", "wet_folder"]

TEXELS = "texels.npz"
"""File of the places, beside the frames."""


def wet_folder(cache: Cache) -> Path:
    """Folder of the wet maps of an instance."""
    return cache.folder / "wet"


@dataclass(frozen=True, eq=False)
class Texels:
    """Places on surfaces."""

    position: F64
    """In the frame of the body [m], shape (t, 3)."""
    normal: F64
    area: F64
    """[m^2], shape (t,)"""
    part: I32
    """Index into `parts`."""
    parts: tuple[tuple[str, str, str], ...]
    """(entity, body, part)."""
    size: float
    """About the distance between neighbours [m]."""

    def of(self, entity: str) -> NDArray[np.intp]:
        """Texels of an entity."""
        mine = [k for k, names in enumerate(self.parts) if names[0] == entity]
        return np.flatnonzero(np.isin(self.part, mine))


@dataclass(frozen=True, eq=False)
class WetState:
    """Wetting of all texels up to a frame; times in seconds since frame 0, NaN where never wet, each of shape (t,)."""

    first: F64
    last: F64
    total: F64
    """Time wet in all [s], to a frame."""
    deepest: F64
    """Greatest depth so far [m]."""
    depth: F64
    """At the frame [m]; NaN where dry then."""
    fluid: I32
    """Index of the last liquid that it touched, or had a film of; -1 where none."""
    amount: F64
    """Amount of film at `since`: 1 under liquid, less where contact carried it."""
    since: F64
    """When the film was left or carried there; NaN where there is none."""

    def film(self, time: float, drying: F64) -> F64:
        """Film at a time [s]: 1 where wet, exp(-t / drying) after, shared where surfaces met; `drying` [s] per liquid."""
        age = np.where(np.isfinite(self.since), time - self.since, np.inf)
        return np.asarray(self.amount * np.exp(-age / drying[np.maximum(self.fluid, 0)]))


class WetMap(Derived):
    """Reader of the wet maps that were made of a cache; its note says recipe, parts, size and touch [m], digest of the texels."""

    one, many, note = "wet map", "wet maps", "wet.json"
    beside = (TEXELS,)

    def __init__(self, cache: Cache) -> None:
        super().__init__(cache, wet_folder(cache))
        self._state: tuple[int, WetState] | None = None

    def _understand(self, data: dict[str, Any]) -> None:
        if not all(isinstance(data[k], float) for k in ("size", "touch")):
            raise ValueError("it has no size and touch")
        if not all(len(names) == 3 and all(isinstance(n, str) for n in names) for names in data["parts"]):
            raise ValueError("its parts are no names")

    @cached_property
    def texels(self) -> Texels:
        """The places.

        Raises:
            EvidenceError: they are missing or were altered.
        """
        about, found = self.about(), read_container(self.files.folder / TEXELS)
        if digest_arrays(found) != about.get("texels"):
            raise EvidenceError(f"texels of {self.cache.folder.name!r} were altered; bake again")
        position, normal, area = (np.asarray(found[f"texel/{n}"], dtype=np.float64) for n in ("position", "normal", "area"))
        return Texels(position, normal, area, found["texel/part"], tuple(map(tuple, about["parts"])), about["size"])

    def state(self, frame: int) -> WetState:
        """Wetting from frame 0 to a frame; fast where frames are asked for in order.

        Raises:
            EvidenceError: as `read`.
        """
        if self._state is None or self._state[0] > frame:
            nothing = np.full(len(self.texels.area), np.nan)
            zero = np.zeros(len(nothing))
            none = np.full(len(nothing), -1, dtype=np.int32)
            self._state = (-1, WetState(nothing, nothing, zero, zero, nothing, none, zero, nothing))
        start, state = self._state
        step = 1.0 / self.cache.index.fps
        for k in range(start + 1, frame + 1):
            found = self.read(k)
            rows, depth = found["wet/texel"], found["wet/depth"].astype(np.float64)
            first, last, total, deepest = (x.copy() for x in (state.first, state.last, state.total, state.deepest))
            fluid = state.fluid.copy()
            now = np.full(len(first), np.nan)
            first[rows] = np.where(np.isnan(first[rows]), k * step, first[rows])
            last[rows], now[rows], fluid[rows] = k * step, depth, found["wet/fluid"]
            total[rows] += step
            deepest[rows] = np.maximum(deepest[rows], depth)
            amount, since = state.amount.copy(), state.since.copy()
            amount[rows], since[rows] = 1.0, k * step
            met = found["track/texel"]
            amount[met], since[met], fluid[met] = found["track/film"], k * step, found["track/fluid"]
            state = WetState(first, last, total, deepest, now, fluid, amount, since)
        self._state = (frame, state)
        return state

    def _more(self) -> list[str]:
        return [str(self.about().get("texels"))]
