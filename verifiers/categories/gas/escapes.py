"""Soot and heat that left through open sides, by the velocities of the frames: a second route to the recorded escape (R100)."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ...rows.findings import Finding
from .books import declared
from .bounds import ESCAPE
from .outflow import NAMES, Outflow, outflow
from .questions import ESCAPES
from .rows import kept_within, recomputed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .cells import GasFrame
    from .frames import GasBox

__all__ = ["Escapes"]

TINY = 1e-12


class Escapes:
    """Flow through the sides of every frame."""

    questions: ClassVar[Mapping[str, Question]] = ESCAPES

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.flows: list[Outflow] = []

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Look at the sides at one frame."""
        self.flows.append(outflow(self.box, now))

    def findings(self) -> dict[str, Finding]:
        """Findings on the two questions by name."""
        given = declared(self.box)
        return {
            "escape": self._judged(0, self.box.carries, "kg", self.box.escaped_tracer(), given["tracer"]),
            "escape_heat": self._judged(
                1, "heat", "J", self.box.record("escaped_heat"), given["heat"] + self.box.burnt("released_heat")
            ),
        }

    def _judged(self, n: int, name: str, unit: str, recorded: F64, given: F64) -> Finding:
        if "open" not in self.box.sides and not recorded.any():
            return Finding("not_applicable", "no side is open, and nothing is recorded to have left")
        rate, doubt = (np.array([getattr(f, k)[n] for f in self.flows]) for k in ("rate", "doubt"))
        step = self.box.duration
        left = np.concatenate([[0.0], np.cumsum(0.5 * step * (rate[1:] + rate[:-1]))])
        within = 0.5 * step * (np.abs(np.diff(rate)) + doubt[1:] + doubt[:-1])
        within = np.concatenate([[0.0], np.cumsum(within)])
        least = self.box.even_heat if n == 1 and not self.box.heats else TINY
        scale = max(float(np.abs(given).max()), float(np.abs(recorded).max()), least)
        gone = recorded - recorded[0]
        off = np.maximum(np.abs(gone - left) - within, 0.0) / scale

        def told(frame: int | None) -> str:
            k = -1 if frame is None else frame
            at = "by the last frame" if frame is None else f"by frame {frame}"
            return f"{gone[k]:.4g} {unit} of {name} are recorded to have left {at}, by the velocities {left[k]:.4g} +- {within[k]:.2g}"

        total = step * np.sum([f.sides[:, n] for f in self.flows], axis=0)
        evidence = {"left_by_side": {s: float(v) for s, v in zip(NAMES, total, strict=True) if v}, "doubt": float(within[-1])}
        return kept_within(off, ESCAPE, "1", told, recomputed(self.box), evidence)
