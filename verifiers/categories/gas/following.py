"""Gas that a part of its box follows, solved there alone: nothing gets out of that part, and air beyond it is still and ambient (R100).

The part is a record of the frames. Where it is told wrongly, gas lies beyond it or along its sides, or sources and bodies that move do.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ...rows.corrections import correction
from ...rows.findings import Finding
from .books import declared
from .bounds import BOOKS, EVEN, THIN
from .cells import layer
from .questions import FOLLOWING
from .rows import kept_within, recomputed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.requirements import Correction
    from ...rows.questions import Question
    from .cells import GasFrame
    from .frames import GasBox

__all__ = ["Following"]

TINY = 1e-12
DEEP = 2
"""[cells] Along its inner sides, in which nothing may be: what a sweep takes along."""


class Following:
    """The active part of every frame."""

    questions: ClassVar[Mapping[str, Question]] = FOLLOWING

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.arrived: list[float] = []
        self.beyond: list[float] = []
        self.missed: list[float] = []

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Look at one frame."""
        gas = self._shares(now)
        along = [0.0]
        for side in now.inner_sides:
            along += [float(layer(gas[now.active], side, depth).max()) for depth in range(DEEP)]
        self.arrived.append(max(along))
        outside = np.ones(now.room.shape, dtype=bool)
        outside[now.active] = False
        off = (now.soot != 0.0) | (now.temperature != np.float32(self.box.ambient)) | (now.speed != 0.0)
        if now.fire is not None:
            off |= (now.fire.fuel != 0.0) | (now.fire.product != 0.0)
        self.beyond.append(float((off & outside & now.open).sum()))
        self.missed.append(float(self._working(now, before, outside).sum()))

    def _shares(self, now: GasFrame) -> F64:
        """Soot or excess heat of cells, over those of a source."""
        box = self.box
        most = max([TINY, *(box.dark(m) for m in box.members)])
        span = max(
            float(box.lightness_at(box.ambient + (1.0 if box.heats else EVEN))),
            *(abs(float(box.lightness_at(box.physics(m).temperature))) for m in box.members),
        )
        return np.asarray(np.maximum(np.abs(now.soot) / most, np.abs(box.lightness(now)) / span))

    def _working(self, now: GasFrame, before: GasFrame | None, outside: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> F64:
        """Cells outside in which a source let out gas over the frame, or which bodies filled or left."""
        found = np.zeros(now.room.shape, dtype=bool)
        end, duration = self.box.duration * now.index, self.box.duration
        for source in self.box.sources:
            if now.index and source.emitted(end) > source.emitted(end - duration):
                found |= source.cells(now, 0.0, duration) & now.open
        if before is not None:
            # A body that came to rest early in the frame may have been let go since.
            was = np.zeros(now.room.shape, dtype=bool)
            was[before.active] = True
            found |= (now.room != before.room) & ~was
        return np.asarray(found & outside, dtype=np.float64)

    def findings(self) -> dict[str, Finding]:
        """Findings on the four questions by name."""
        box, hints = self.box, (*recomputed(self.box), self._whole())
        arrived, beyond, missed = np.array(self.arrived), np.array(self.beyond), np.array(self.missed)
        given, slipped = declared(box), {"soot": box.record("slipped_soot"), "heat": box.record("slipped_heat")}
        scale = {n: max(float(np.abs(given[n]).max()), TINY) for n in slipped}
        scale["heat"] = max(
            scale["heat"] + float(box.burnt("released_heat").max(initial=0.0)), 0.0 if box.heats else box.even_heat
        )
        off = np.max([np.abs(v) / scale[n] for n, v in slipped.items()], axis=0)

        def near(frame: int | None) -> str:
            value = arrived.max() if frame is None else arrived[frame]
            head = f"{value:.2g} of a source's soot or heat lies along sides of the active part inside the box"
            return f"{head} at most" if frame is None else f"{head} at frame {frame}"

        def out(frame: int | None) -> str:
            k = -1 if frame is None else frame
            text = ", ".join(f"{v[k]:.2g} {u} of {n}" for (n, v), u in zip(slipped.items(), ("kg", "J"), strict=True))
            return f"{text} left through these sides" + ("" if frame is None else f" by frame {frame}")

        def counted(values: F64, words: str) -> Finding:
            return kept_within(
                values, 0.0, "cells",
                lambda k: f"{values.max() if k is None else values[k]:.0f} cells outside the active part {words}" + ("" if k is None else f" at frame {k}"),
                hints,
            )  # fmt: skip

        return {
            "arrived": kept_within(arrived, THIN, "1", near, hints),
            "slipped": kept_within(off, BOOKS, "1", out, hints),
            "beyond": counted(beyond, "hold gas that is not ambient air at rest"),
            "followed": counted(missed, "have a source that lets out gas, or a body that moves"),
        }

    def _whole(self) -> Correction:
        """Solve in the whole box."""
        place = f"/simulation/solvers/{self.box.solver}/settings/follows"
        return correction(
            "the active part does not follow the gas", "gas", "set follows to false", pointers=(place,),
            patch=({"op": "add", "path": place, "value": False},),
        )  # fmt: skip
