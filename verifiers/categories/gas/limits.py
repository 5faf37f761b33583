"""Bounds that no gas leaves: temperatures between those of air, sources and flames, soot between none and what sources and fire make (R100)."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from .bounds import EVEN, SEEP, WARM
from .questions import LIMITS
from .rows import kept_within, recomputed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.findings import Finding
    from ...rows.questions import Question
    from .cells import GasFrame
    from .frames import GasBox

__all__ = ["Limits"]

TINY = 1e-12


class Limits:
    """Extremes of every frame."""

    questions: ClassVar[Mapping[str, Question]] = LIMITS

    def __init__(self, box: GasBox) -> None:
        self.box = box
        known = [box.ambient, *(float(box.physics(m).temperature) for m in box.members)]
        if box.combustion is not None:
            known.append(box.combustion.hottest)
        self.bounds = (min(known), max(known))
        """Least and greatest temperature that can be [K]."""
        self.light = (float(box.lightness_at(self.bounds[0])), float(box.lightness_at(self.bounds[1])))
        self.most = max(box.dark(m) for m in box.members)
        self.start = 0.0
        self.warm: list[float] = []
        self.thick: list[float] = []
        self.where: dict[tuple[str, int], list[float]] = {}
        self.range = [np.inf, -np.inf]

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Look at one frame."""
        from .extreme_kernels import extremes, hottest_beyond, sootiest_beyond

        box, room = self.box, np.ascontiguousarray(now.room)
        light = box.lightness(now)
        if before is None:
            self.start = float(now.soot.max())
        span = max(self.light[1] - self.light[0], float(box.lightness_at(box.ambient + (1.0 if box.heats else EVEN))))
        least, greatest = extremes(now.temperature, room)
        self.range = [min(self.range[0], float(least)), max(self.range[1], float(greatest))]
        # Gas that gives off heat shrinks, and its soot with it.
        most = max(self.most, self.start) * (1.0 + (float(light.max()) if self.range[1] > box.ambient else 0.0))
        warm = hottest_beyond(light, room, self.light[0], self.light[1], span)
        thick = sootiest_beyond(now.soot, room, np.float32(most), np.float32(max(self.most, self.start, TINY)))
        for name, kept, bound, found in (("warm", self.warm, WARM, warm), ("thick", self.thick, SEEP, thick)):
            kept.append(float(found[0]))
            if kept[-1] > bound:
                self.where[name, now.index] = now.place(np.unravel_index(int(found[1]), room.shape))

    def findings(self) -> dict[str, Finding]:
        """Findings on the two questions by name."""
        box, warm, thick = self.box, np.array(self.warm), np.array(self.thick)
        low, high = self.bounds

        def heat(frame: int | None) -> str:
            head = f"temperatures lie between {self.range[0]:.5g} K and {self.range[1]:.5g} K"
            return (
                head
                if frame is None
                else f"{head}; at frame {frame} gas at {self.where['warm', frame]} is outside {low:g} K to {high:g} K"
            )

        def soot(frame: int | None) -> str:
            if frame is None:
                return f"soot stays between 0 and that of a source, to {thick.max():.2g} of it"
            return f"at frame {frame} soot at {self.where['thick', frame]} is outside 0 to {self.most:g} kg/m^3, by {thick[frame]:.3g} of it"

        def first(name: str, values: np.ndarray[tuple[int], np.dtype[np.float64]], bound: float) -> dict[str, object] | None:
            return {"at": self.where[name, int(np.argmax(values > bound))]} if (values > bound).any() else None

        return {
            "temperature": kept_within(warm, WARM, "1", heat, recomputed(box), first("warm", warm, WARM)),
            "dense": kept_within(thick, SEEP, "1", soot, recomputed(box), first("thick", thick, SEEP)),
        }
