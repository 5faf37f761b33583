"""Numerical health of a gas (R105): rows `numerical:<what>:<solver>`."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ...rows.corrections import bake_again, correction
from ...rows.findings import Finding
from .bounds import CAPPED
from .questions import NUMBERS
from .rows import kept_within, shorter

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .cells import GasFrame
    from .frames import GasBox

__all__ = ["Numbers"]


class Numbers:
    """Speeds and counters."""

    questions: ClassVar[Mapping[str, Question]] = NUMBERS

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.speed: list[float] = []

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Look at one frame."""
        self.speed.append(float(now.speed.max()))

    def findings(self) -> dict[str, Finding]:
        """Findings on the four questions by name; a frame that is not finite cannot be read at all."""
        box = self.box
        limit = box.candidate.spec.simulation.limits.max_speed
        speed = np.maximum(np.array(self.speed), box.record("max_speed"))

        def fast(frame: int | None) -> str:
            return f"gas has {speed.max() if frame is None else speed[frame]:.4g} m/s" + (
                " at most" if frame is None else f" at frame {frame}"
            )

        return {
            "finite": Finding("pass", "every frame was read, and all of it is finite"),
            "speed": kept_within(speed, limit, "m/s", fast, (shorter(box),)),
            "iterations": self._iterations(),
            "counters": self._counters(),
        }

    def _iterations(self) -> Finding:
        box = self.box
        steps, capped = box.record("steps"), box.record("capped")
        total = max(float(steps.sum()), 1.0)
        share = np.cumsum(capped) / total
        place = f"/simulation/solvers/{box.solver}/settings/iterations"
        hints = (
            correction("the pressure solve does not converge", "step", "double the iterations", pointers=(place,)),
            shorter(box),
        )
        return kept_within(
            share, CAPPED, "1", lambda k: f"{share[-1]:.2%} of {total:.0f} steps ended at the iteration cap", hints
        )

    def _counters(self) -> Finding:
        box = self.box
        steps, capped, iterations = (box.record(n) for n in ("steps", "capped", "iterations"))
        least = np.full(box.frames, box.duration / box.settings.max_step * (1.0 - 1e-6))
        least[0] = 0.0
        wrong = (steps < np.floor(least)) | (capped < 0) | (capped > steps) | (iterations < 0)
        for name in ("emitted_soot", "escaped_soot", "volume_emitted"):
            wrong |= np.diff(box.record(name), prepend=0.0) < -1e-9 * max(float(box.record(name).max()), 1e-12)
        return kept_within(
            wrong.astype(np.float64), 0.0, "frames",
            lambda k: "counters are possible" if k is None else f"frame {k} records {steps[k]:g} steps, {capped[k]:g} of them capped, or a sum that falls",
            (bake_again("counters are impossible"),),
        )  # fmt: skip
