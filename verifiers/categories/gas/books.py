"""Soot and heat: what came, what is there, what left, and whether the records say so (R100).

The contents are summed here from the cells. What the drivers let out is worked out from the specification: volume at the temperature of the
source, its soot, and its heat above that of ambient air (where none comes, gaps are compared with `EVEN` of all air). What left is as
recorded; `escapes.py` holds that against the velocities.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from .bounds import BOOKS, EMITTED
from .questions import BOOKS as ASKED
from .rows import kept_within, recomputed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.findings import Finding
    from ...rows.questions import Question
    from .cells import GasFrame
    from .frames import GasBox

__all__ = ["Books", "declared"]

TINY = 1e-12


def declared(box: GasBox) -> dict[str, F64]:
    """Volume [m^3], soot [kg], heat [J] and tracer [kg] that drivers let out and surfaces gave since frame 0, each shape (frames,)."""
    times = box.duration * np.arange(box.frames)
    found = {name: np.zeros(box.frames) for name in ("volume", "soot", "heat", "tracer")}
    for source in box.sources:
        volume = np.array([source.emitted(t) for t in times])
        physics = box.physics(source.entity)
        found["volume"] += volume
        found["soot"] += volume * physics.soot_density
        found["heat"] += volume * box.joule * float(box.lightness_at(physics.temperature))
        found["tracer"] += volume * box.source_tracer(source.entity)
    if box.surfaces is not None:
        mass, volume = box.surfaces.given()
        found["volume"] += volume
        found["heat"] += (volume - mass / box.air) * box.joule
        found["tracer"] += mass
    return found


class Books:
    """Sums of every frame."""

    questions: ClassVar[Mapping[str, Question]] = ASKED

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.soot: list[float] = []
        self.heat: list[float] = []

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Sum up one frame."""
        self.soot.append(self.box.soot_mass(now))
        self.heat.append(self.box.heat(now))

    def findings(self) -> dict[str, Finding]:
        """Findings on the four questions by name."""
        box = self.box
        soot, heat = np.array(self.soot), np.array(self.heat)
        given = declared(box)
        made, burnt = box.burnt("made_soot"), self._burnt()
        scale_soot = _scale(soot, given["soot"] + made)
        scale_heat = _scale(heat, given["heat"] + burnt) if box.heats else box.even_heat
        came = {n: box.record(r) for n, r in (("volume", "volume_emitted"), ("soot", "emitted_soot"), ("heat", "emitted_heat"))}
        return {
            "emitted": self._emitted(given, came),
            "records": self._records({"soot_mass": (soot, scale_soot), "heat": (heat, scale_heat)}),
            "soot": self._balance("soot", "kg", soot, came["soot"] + made, box.record("escaped_soot"), scale_soot),
            "heat": self._balance(
                "heat", "J", heat, came["heat"] + burnt, box.record("escaped_heat") + box.record("lost_heat"), scale_heat
            ),
        }

    def _burnt(self) -> F64:
        """Heat that burning has added since frame 0 [J], shape (frames,)."""
        box = self.box
        soot = 0.0 if box.combustion is None else box.combustion.soot_heat
        return box.burnt("released_heat") + soot * box.burnt("made_soot")

    def _emitted(self, given: dict[str, F64], came: dict[str, F64]) -> Finding:
        units = {"volume": "m^3", "soot": "kg", "heat": "J"}
        off = {n: np.abs(came[n] - given[n]) / max(float(np.abs(given[n]).max()), TINY) for n in units}
        worst = max(off, key=lambda n: float(off[n].max()))

        def told(frame: int | None) -> str:
            if frame is None:
                return (
                    "; ".join(f"{came[n][-1]:.4g} {u} of {given[n][-1]:.4g} {u} {n}" for n, u in units.items())
                    + " came by the last frame"
                )
            return f"{came[worst][frame]:.4g} {units[worst]} of {worst} came by frame {frame}, declared are {given[worst][frame]:.4g}"

        evidence = {"came": {n: float(v[-1]) for n, v in came.items()}, "declared": {n: float(v[-1]) for n, v in given.items()}}
        return kept_within(off[worst], EMITTED, "1", told, recomputed(self.box), evidence)

    def _records(self, own: dict[str, tuple[F64, float]]) -> Finding:
        off = {n: np.abs(self.box.record(n) - value) / scale for n, (value, scale) in own.items()}
        worst = max(off, key=lambda n: float(off[n].max()))

        def told(frame: int | None) -> str:
            if frame is None:
                return f"records are those of the cells; largest deviation {off[worst].max():.2g} of what was emitted ({worst})"
            return f"record {worst} is off by {off[worst][frame]:.3g} of what was emitted at frame {frame}"

        return kept_within(off[worst], BOOKS, "1", told, recomputed(self.box))

    def _balance(self, name: str, unit: str, inside: F64, came: F64, left: F64, scale: float) -> Finding:
        missing = inside[0] - came[0] + left[0] + came - left - inside
        off = np.abs(missing) / scale

        def told(frame: int | None) -> str:
            if frame is None:
                return f"{came[-1]:.4g} {unit} came, {left[-1]:.4g} left, {inside[-1]:.4g} are there at the last frame; largest gap {off.max():.2g}"
            word = "missing" if missing[frame] > 0 else "too much"
            return (
                f"{abs(missing[frame]):.4g} {unit} of {name} are {word} at frame {frame}: {came[frame]:.4g} came, {left[frame]:.4g} left, "
                f"{inside[frame]:.4g} are there"
            )

        evidence = {f"inside_{unit}": float(inside[-1]), f"came_{unit}": float(came[-1]), f"left_{unit}": float(left[-1])}
        return kept_within(off, BOOKS, "1", told, recomputed(self.box), evidence)


def _scale(inside: F64, given: F64) -> float:
    """Amount that was emitted, or that was there at first where that is more; never 0."""
    return max(float(np.abs(given).max()), float(np.abs(inside[0])), TINY)
