"""A gas that feels what it carries loses what these get of it, where they are (R66, R67, R105).

Both sides are counted by themselves: the gas tells what its velocities took, cell by cell, what it carries what drag gave to it; that this is what a
stream past it gives is another row's matter (`pushing.py`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.instances import felt_by
from ...ledgers.balance import books_of
from ...rows.corrections import bake_again
from ...rows.findings import Finding
from ..cloth.frames import cloth_run
from .bounds import ASTRAY, NEAR, RETURNED
from .frames import box_of
from .pushed import given_by
from .questions import RETURNING
from .rows import kept_within

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.candidate import Candidate
    from ...rows.questions import Question
    from .cells import GasFrame
    from .frames import GasBox
    from .stream import Given

__all__ = ["Returning", "returned_share"]

TINY = 1e-12
"""[N s]"""
SINGLE = 2.0**-23
"""[1] Of a velocity, that single precision cannot tell."""
BETWEEN = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Shares of the way between two frames at which it is asked where things are."""


class Returning:
    """Momentum that a gas takes from what it carries."""

    questions: ClassVar[Mapping[str, Question]] = RETURNING

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.felt = felt_by(box.candidate.spec, box.solver)
        self.gained: list[F64] = []
        self.cells: list[F64] = []
        self.grain: list[float] = []
        """Momentum that single precision cannot tell [N s]."""
        self.astray: list[float] = []

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Look at one frame."""
        taken = self.box.returned(now.index) if self.felt else None
        if taken is None:
            return
        size = np.linalg.norm(taken, axis=3)
        self.gained.append(np.asarray(self.box.cache.read(now.index, ("gas_gained",))["gas_gained"], dtype=np.float64))
        self.cells.append(taken.sum(axis=(0, 1, 2)))
        heavy = self.box.volume * self.box.density(now) * now.room
        self.grain.append(SINGLE * float((heavy * now.speed)[size > 0.0].sum()))
        if before is None or not size.any():
            self.astray.append(0.0)
            return
        near = _near(self.box, self.felt, now)
        self.astray.append(float(size[~near].sum() / size.sum()))

    def findings(self) -> dict[str, Finding]:
        """Findings on the questions by name."""
        if not self.felt:
            return {name: Finding("not_applicable", "no two_way coupling lets it feel what it carries") for name in RETURNING}
        return {"returned": self._returned(), "returned_there": self._there()}

    def _returned(self) -> Finding:
        """Momentum that it lost against what these got, summed from frame 0 over intervals at whose ends all of it is in the box."""
        found = [g for g in given_by(self.box) if self._owner(g) in self.felt]
        inside = np.all([g.inside for g in found], axis=0) if found else np.zeros(0, dtype=bool)
        if not inside.any():
            return Finding(
                "unverified",
                "what it carries is never all in its box from one frame to the next, so that nothing tells what it lost",
            )
        got = sum((g.recorded for g in found), np.zeros_like(found[0].recorded))
        gained, cells = np.array(self.gained)[1:], np.array(self.cells)[1:]
        count = min(len(got), len(gained))
        kept = inside[:count, None]
        sums = [np.cumsum(np.where(kept, a[:count], 0.0), axis=0) for a in (got, gained, cells)]
        scale = max(float(np.linalg.norm(np.cumsum(np.where(kept, np.abs(got[:count]), 0.0), axis=0), axis=1).max()), TINY)
        # What a velocity cannot tell waits at its face until it can.
        rounding = np.array(self.grain)[1 : count + 1]
        off = np.maximum.reduce([np.linalg.norm(sums[0] + s, axis=1) for s in sums[1:]])
        off = np.concatenate([[0.0], np.maximum(off - np.maximum.accumulate(rounding), 0.0) / scale])
        who = ", ".join(dict.fromkeys(e for g in found for e in g.entities))

        def told(frame: int | None) -> str:
            k = -1 if frame is None else max(frame - 1, 0)
            by = "the last frame" if frame is None else f"frame {frame}"
            sizes = [f"{float(np.linalg.norm(s[k])):.4g}" for s in sums]
            return f"{who} got {sizes[0]} N s of it by {by}, and it lost {sizes[1]} N s, {sizes[2]} N s by its cells ({inside.sum()} intervals)"

        evidence = {"got_Ns": sums[0][-1].tolist(), "gained_Ns": sums[1][-1].tolist()}
        return kept_within(off, RETURNED, "1", told, (bake_again(),), evidence)

    def _there(self) -> Finding:
        """Share of what it lost that it lost away from what it carries."""
        off = np.array(self.astray)

        def told(frame: int | None) -> str:
            share = off.max(initial=0.0) if frame is None else off[frame]
            return f"{share:.2%} of what it lost to what it carries was lost more than {NEAR:g} cells from all of it" + (
                " in any interval" if frame is None else f" in the interval before frame {frame}"
            )

        return kept_within(off, ASTRAY, "1", told, (bake_again(),))

    def _owner(self, given: Given) -> str:
        solvers = self.box.candidate.spec.simulation.solvers
        return next((n for n in self.felt if given.entities[0] in solvers[n].members), "")


def returned_share(candidate: Candidate, name: str) -> str:
    """Sentence about the momentum that a gas lost to what it carries."""
    if name not in candidate.caches:
        return "how much that is, is known after a probe"
    total = np.abs(np.asarray(box_of(candidate, name).cache.series("gas_gained"), dtype=np.float64)).sum(axis=0)
    return f"it took {float(np.linalg.norm(total)):.2g} N s from it in all"


def _near(box: GasBox, felt: tuple[str, ...], now: GasFrame) -> NDArray[np.bool_]:
    """Cells near what a gas carries, anywhere on its way over the interval before a frame."""
    from scipy.ndimage import distance_transform_edt

    there = np.ones(now.room.shape, dtype=bool)
    widest = 0.0
    for name in felt:
        start, end, half = _places(box.candidate, name, now.index)
        widest = max(widest, half)
        for share in BETWEEN:
            cell = np.floor((start + share * (end - start) - now.corner) / now.cell).astype(np.int64)
            cell = np.clip(cell, 0, np.array(there.shape) - 1)
            there[tuple(cell.T)] = False
    if there.all():
        return np.zeros(there.shape, dtype=bool)
    return np.asarray(distance_transform_edt(there) <= NEAR + widest / box.cell)


def _places(candidate: Candidate, name: str, frame: int) -> tuple[F64, F64, float]:
    """Places at the frame before and at a frame of what an instance moves, (n, 3) [m] each, and half the size of the largest [m]."""
    if name in candidate.rigid_caches:
        books = books_of(candidate, candidate.rigid_caches[name])
        solids = [v for e in books.entities for v in _spans(candidate, e)]
        return books.body_centers[frame - 1], books.body_centers[frame], max(solids, default=0.0)
    if name in candidate.cloth_caches:
        run = cloth_run(candidate, name)
        return run.frame(frame - 1)[0], run.frame(frame)[0], 0.0
    found = []
    for k in (frame - 1, frame):
        data = candidate.particle_caches[name].read(k, ("origin", "particle/position", "particle/id"))
        found.append((data["particle/id"], data["origin"] + data["particle/position"].astype(np.float64)))
    (was, start), (now, end) = found
    _, here, there = np.intersect1d(was, now, return_indices=True)
    alone = [start[np.setdiff1d(np.arange(len(was)), here)], end[np.setdiff1d(np.arange(len(now)), there)]]
    return np.concatenate([start[here], *alone]), np.concatenate([end[there], *alone]), 0.0


def _spans(candidate: Candidate, entity: str) -> list[float]:
    """Half the diagonals of the parts of an entity [m]."""
    if candidate.spec.entities[entity].motion != "dynamic":
        return []
    return [0.5 * float(np.linalg.norm(np.ptp(p.render.vertices, axis=0))) for p in candidate.entity(entity).parts]
