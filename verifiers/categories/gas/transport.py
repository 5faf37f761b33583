"""Judges whether soot and heat go where the velocities carry them: to cells within reach alone, and in the middle by the right way (R100).

Between two frames gas comes to a cell from no farther than the fastest gas nearby gets, by ways through open cells. So a cell holds no more
soot than the most, and no less than the least, that was within that reach, where air beyond open sides and sources count. And over a frame the
moment of the soot changes by what its velocities carry, by what sources let out where they are and what leaves where it does: an
identity of fluxes, which the frames at both ends bound.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....physics.substances import air_density
from ....worlds.arrays import F64
from ...rows.findings import Finding
from .bounds import COURSE, SEEP, SLIVER
from .outflow import outflow
from .questions import TRANSPORT
from .reach import reach_of, within_reach
from .rows import kept_within, recomputed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .cells import GasFrame, Mask
    from .frames import GasBox
    from .kindled import KindledSurfaces
    from .outflow import Outflow

__all__ = ["Transport"]

TINY = 1e-12
BESIDE = 2.0
"""[cells] How far from a piece of surface the cell lies that its gas is given to."""


class Transport:
    """Fields of every frame against those of the one before."""

    questions: ClassVar[Mapping[str, Question]] = TRANSPORT

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.over: list[float] = [0.0]
        self.under: list[float] = [0.0]
        self.off: list[float] = [0.0]
        self.where: dict[tuple[str, int], list[float]] = {}
        self.flow: Outflow | None = None

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Compare one frame with the one before."""
        flow = outflow(self.box, now)
        if before is not None and self.flow is not None:
            self._reached(now, before)
            self.off.append(max(self._carried(n, now, before, flow, self.flow) for n in range(2 if self.box.heats else 1)))
        self.flow = flow

    def _reached(self, now: GasFrame, before: GasFrame) -> None:
        from .extreme_kernels import out_of_reach

        box, (way, walls) = self.box, reach_of(self.box, now, before)
        lit = _emitting(box, now)
        most = max([0.0, *(box.source_concentration(s.entity) for s in box.sources), *(source for _, source in lit)])
        upper = box.concentration(before)
        scale, lower = max(most, float(upper.max()), TINY), -upper
        for cells, source in lit:
            upper, lower = (np.where(cells, np.maximum(a, s), a) for a, s in ((upper, source), (lower, -source)))
        highest = within_reach(upper, way, walls, (0.0,) * 6)
        lowest = within_reach(lower, way, walls, tuple(0.0 if s == "open" else -np.inf for s in box.sides))
        held, room = (np.ascontiguousarray(a) for a in (box.concentration(now), now.room))
        over, first, under, second = out_of_reach(held, room, np.float32(SLIVER), highest, lowest)
        for name, kept, excess, at in (("continuity", self.over, over, first), ("gaps", self.under, under, second)):
            kept.append(float(excess) / scale)
            if kept[-1] > SEEP:
                self.where[name, now.index] = now.place(np.unravel_index(int(at), room.shape))

    def _carried(self, n: int, now: GasFrame, before: GasFrame, flow: Outflow, last: Outflow) -> float:
        """Difference of the way of the middle over that of the velocities."""
        box, step, middle = self.box, self.box.duration, now.places.middle
        (new, new_rate, new_path, new_doubt), (old, old_rate, old_path, old_doubt) = (
            _moments_of(box, f, n) for f in (now, before)
        )
        came, loose = np.zeros(3), 0.0
        for source in box.sources:
            physics = box.physics(source.entity)
            content = box.source_tracer(source.entity) if n == 0 else box.joule * float(box.lightness_at(physics.temperature))
            for volume, place, off in source.given(now, step):
                came += volume * content * (place - middle)
                loose += abs(volume * content) * off
        if box.surfaces is not None:
            given = self._given(n, box.surfaces, now, middle)
            came, loose = came + given[0], loose + given[1]
        hot = self._heated(now, before) if n == 1 else (np.zeros(3), 0.0)
        came, loose = came + hot[0], loose + hot[1]
        predicted = 0.5 * step * (new_rate + old_rate) + came - 0.5 * step * (_about(flow, n, middle) + _about(last, n, middle))
        doubt = loose + 0.5 * step * (float(np.linalg.norm(new_rate - old_rate)) + new_doubt + old_doubt)
        reach = float(np.linalg.norm(0.5 * box.size))
        doubt += 0.5 * step * reach * float(abs(flow.rate[n] - last.rate[n]) + flow.doubt[n] + last.doubt[n])
        path = 0.5 * step * (new_path + old_path)
        self.parts = (new - old, predicted, doubt, path)
        return max(0.0, float(np.linalg.norm(new - old - predicted)) - doubt) / max(path, TINY)

    def _given(self, n: int, surfaces: KindledSurfaces, now: GasFrame, middle: F64) -> tuple[F64, float]:
        """Moment of tracer or heat that surfaces gave over a frame [kg m or J m], and how far that may be off."""
        box, mass = self.box, surfaces.giving(now.index)
        light = surfaces.of("ignition") / air_density(1.0) - 1.0 / box.air
        amount = mass if n == 0 else mass * light * box.joule
        ways = surfaces.along(now.index, box.cell)
        off = BESIDE * box.cell + 0.5 * np.linalg.norm(ways[-1] - ways[0], axis=1)
        return np.tensordot(amount, 0.5 * (ways[0] + ways[-1]) - middle, axes=1), float(np.abs(amount) @ off)

    def _heated(self, now: GasFrame, before: GasFrame) -> tuple[F64, float]:
        """Moment of the heat that fire gave over a frame by its power at both ends [J m], and how far that may be off."""
        box, arm = self.box, now.places.arms
        new, old = (box.fields.of(f, "heated", partial(_heat, box, f)) for f in (now, before))
        gave = 0.5 * box.duration * np.tensordot(new + old, arm, axes=3)
        doubt = 0.5 * box.duration * float(np.linalg.norm(np.tensordot(new - old, arm, axes=3)))
        if box.combustion is not None:
            recorded = box.record("released_heat") - box.record("lost_heat")
            flickers = recorded[now.index] - recorded[before.index] - 0.5 * box.duration * float((new + old).sum())
            doubt += abs(flickers) * float(np.linalg.norm(0.5 * box.size))
        return gave, doubt

    def findings(self) -> dict[str, Finding]:
        """Findings on the three questions by name."""
        hints = recomputed(self.box)
        over, under, off = (np.array(v) for v in (self.over, self.under, self.off))

        def place(name: str, frame: int | None) -> dict[str, object] | None:
            return None if (name, frame) not in self.where else {"at": self.where[name, int(frame or 0)]}

        def told(name: str, values: F64, word: str) -> Finding:
            def text(frame: int | None) -> str:
                if frame is None:
                    return f"soot of every cell is within what was in reach a frame ago; largest {word} {values.max():.2g} of the greatest"
                return f"at frame {frame} a cell has {values[frame]:.3g} of the greatest soot {word} than was in its reach, at {self.where[name, frame]}"

            first = int(np.argmax(values > SEEP)) if (values > SEEP).any() else None
            return kept_within(values, SEEP, "1", text, hints, place(name, first))

        def course(frame: int | None) -> str:
            if frame is None:
                return f"the middle of soot and heat moves as the velocities carry them, to {off.max():.2g} of the way"
            return f"the middle of soot or heat moves otherwise than the velocities carry it at frame {frame}, by {off[frame]:.3g} of the way"

        return {
            "continuity": told("continuity", over, "more"),
            "gaps": told("gaps", under, "less"),
            "carried": kept_within(off, COURSE, "1", course, hints),
        }


def _emitting(box: GasBox, now: GasFrame) -> list[tuple[Mask, float]]:
    """Cells about every source that let gas out over the frame, with its soot."""
    end = box.duration * now.index
    burning = box.surfaces
    given = [] if burning is None else [(burning.beside(now, burning.giving(now.index) > 0.0, int(BESIDE)), 1.0)]
    return given + [
        (source.cells(now, box.cell, box.duration), box.source_concentration(source.entity))
        for source in box.sources
        if source.emitted(end) > source.emitted(end - box.duration)
    ]


def _about(flow: Outflow, n: int, middle: F64) -> F64:
    """Moment of what leaves about a place [kg m/s or W m]."""
    return np.asarray(flow.moment[n] - flow.rate[n] * middle)


def _heat(box: GasBox, frame: GasFrame) -> F64:
    """Power of fire that stays in each cell [W]."""
    return np.asarray(box.heating(frame) * frame.room * box.volume)


def _moments_of(box: GasBox, frame: GasFrame, n: int) -> tuple[F64, F64, float, float]:
    """Moments of a frame, which the next one asks for again."""
    return box.fields.of(frame, f"moments {n}", lambda: _moments(box, frame, n))


def _moments(box: GasBox, frame: GasFrame, n: int) -> tuple[F64, F64, float, float]:
    """First moment of tracer or heat about the middle of the box [kg m or J m], its rate by the velocities, the length of the way that they carry
    in a second, and how far the rate may be off: by cells, or by faces with what flows to them, as along a floor that gas sinks on."""
    from .flow_kernels import through

    amount: F64 = (box.tracer(frame) if n == 0 else box.joule * box.lightness(frame)) * frame.room * box.volume
    rate = np.tensordot(amount, box.velocity(frame), axes=3)
    # Rates by what flows through the faces between cells, each from the cell that the gas there comes from.
    off = float(np.linalg.norm(rate - np.array([float(np.sum(through(amount, frame.velocity, a))) for a in range(3)])))
    return np.tensordot(amount, frame.places.arms, axes=3), rate, float(np.sum(np.abs(amount) * frame.speed)), off
