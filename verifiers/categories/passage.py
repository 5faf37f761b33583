"""Traffic of loose matter in and out of a vessel over an interval: how much is inside, and how each part of it left."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .bounds import BRIMFUL, LIES, POUR_FALL, RIM_CELLS, UPRIGHT

if TYPE_CHECKING:
    from .granules import Granules, Matter
    from .vessel import Vessel

__all__ = ["Passage", "passage"]

Ids = NDArray[np.int64]
ALONG = 12
"""Places at which a particle's way out is looked at."""


@dataclass(frozen=True)
class Passage:
    """Volumes over the frames of an interval [m^3], each shape (frames,); what left is counted since the interval began."""

    content: F64
    poured: F64
    """Left over the rim while the vessel leaned, and fell, or got away from the mouth of one that lies."""
    overflowed: F64
    """Left over the rim of the full, upright vessel."""
    leaked: F64
    """Left lower than the rim and than the surface inside, by a way that meets no wall."""
    spilled: F64
    """Left over the rim of an upright vessel that was not full."""
    level: F64
    """Height of the content over the lowest place inside, of the inside's [1]."""
    tilt: F64
    """[rad]"""


class _Out:
    """Particles that are outside after they were inside: how each left, and where."""

    def __init__(self) -> None:
        self.left: dict[str, dict[int, F64]] = {how: {} for how in ("poured", "over", "low", "spilled")}
        self.vanished = dict.fromkeys(self.left, 0.0)
        """Volume of those that left so and then the domain, or by an outflow [m^3]."""

    def forget(self, identity: Ids) -> None:
        """Those that are inside again."""
        for left in self.left.values():
            for n in left.keys() & set(identity.tolist()):
                del left[n]

    def lose(self, before: Granules, now: Granules) -> None:
        """Keep count of those that are no more."""
        gone = ~np.isin(before.identity, now.identity)
        for how, left in self.left.items() if gone.any() else ():
            rows = np.flatnonzero(gone & np.isin(before.identity, list(left)))
            self.vanished[how] += float(before.volume[rows].sum())
            for n in before.identity[rows].tolist():
                del left[n]

    def volume(self, now: Granules, how: str) -> float:
        """Volume of those that left in one way [m^3]."""
        return self.vanished[how] + float(now.volume[np.isin(now.identity, list(self.left[how]))].sum())

    def fallen(self, now: Granules, how: str, least: float, up: F64, *, lies: bool) -> float:
        """Volume of those that are at least so far [m] below where they left, or, out of a vessel that lies, away from there [m^3]."""
        rows = np.flatnonzero(np.isin(now.identity, list(self.left[how])))
        if not len(rows):
            return self.vanished[how]
        way = np.array([self.left[how][n] for n in now.identity[rows].tolist()]) - now.position[rows]
        far = way @ up >= least
        if lies:
            far |= np.linalg.norm(way, axis=1) >= least
        return self.vanished[how] + float(now.volume[rows][far].sum())


def passage(matter: Matter, vessel: Vessel, frames: tuple[int, int]) -> Passage:
    """All that happens between a vessel and loose matter in an interval."""
    count = frames[1] - frames[0] + 1
    table = np.zeros((7, count))  # in the order of the fields of Passage
    out = _Out()
    fall = max(POUR_FALL * vessel.height, 2.0 * matter.pitch)
    before: Granules | None = None
    held = np.zeros(0, dtype=bool)
    for i, index in enumerate(range(frames[0], frames[1] + 1)):
        now = matter.at(index)
        local = vessel.local(now.position, index)
        inside = vessel.inside(local)
        if before is not None:
            out.lose(before, now)
            full = table[5, i - 1] >= BRIMFUL
            _leave(out, matter, vessel, (before, held, now, inside), index, full=full)
        level = float(np.quantile(vessel.level(local[inside]), 0.99)) if inside.any() else 0.0
        table[:, i] = (
            float(now.volume[inside].sum()),
            out.fallen(now, "poured", fall, matter.up, lies=vessel.tilt(index) >= LIES),
            out.volume(now, "over"),
            out.volume(now, "low"),
            out.volume(now, "spilled"),
            level,
            vessel.tilt(index),
        )
        before, held = now, inside
    return Passage(*table)


def _leave(
    out: _Out, matter: Matter, vessel: Vessel, states: tuple[Granules, NDArray[np.bool_], Granules, NDArray[np.bool_]], index: int, *, full: bool
) -> None:  # fmt: skip
    """Note how each particle left that was inside at the frame before, and forget those that came back."""
    before, held, now, inside = states
    out.forget(now.identity[inside])
    _, here, there = np.intersect1d(now.identity, before.identity, return_indices=True)
    gone = np.flatnonzero(held[there] & ~inside[here])
    if not len(gone):
        return
    here, there = here[gone], there[gone]
    start, end = vessel.local(before.position[there], index - 1), vessel.local(now.position[here], index)
    share = np.linspace(0.0, 1.0, ALONG + 1)
    way = start[:, None] + share[None, :, None] * (end - start)[:, None]
    within = vessel.inside(way.reshape(-1, 3)).reshape(len(gone), -1)
    last = way[np.arange(len(gone)), within.shape[1] - 1 - np.argmax(within[:, ::-1], axis=1)]
    near = max(RIM_CELLS * vessel.cell, 2.0 * matter.pitch)
    over = vessel.below_rim(last) <= near
    heights = before.position[held] @ matter.up
    surface = float(np.quantile(heights, 0.95)) if len(heights) else -np.inf
    leans = vessel.tilt(index) > UPRIGHT
    places = (last @ vessel.axes) @ vessel.lead.turn[index].T + vessel.lead.position[index]
    walled = np.zeros(len(gone), dtype=bool)
    for piece in vessel.pieces:
        a, b = (x @ vessel.axes @ vessel.lead.turn[index].T + vessel.lead.position[index] for x in (start, end))
        walled |= piece.between(a, b, index)
    for k, n in enumerate(now.identity[here].tolist()):
        if over[k]:
            out.left["poured" if leans else "over" if full else "spilled"][n] = places[k]
        elif float(places[k] @ matter.up) < surface - matter.pitch and not walled[k]:
            out.left["low"][n] = places[k]
