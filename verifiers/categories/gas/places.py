"""Where gas is: bodies and what they leave open, sources, sides of the box (R71, R100, R106).

Bodies are measured from the surfaces of the entities, where they are at the frame: a cell whose middle lies deeper in one than half its
diagonal is closed, and one that no body's box cuts is open; between, the fields may round.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ...rows.corrections import bake_again, correction
from ...rows.findings import Finding
from .bodies import depth_in
from .bounds import ACROSS, CUT, THIN
from .cells import WHOLE, layer
from .outflow import NAMES
from .questions import PLACES
from .rows import finer, kept_within, larger_box, recomputed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .cells import GasFrame
    from .frames import GasBox

__all__ = ["Places"]

HALF_DIAGONAL = 0.87
"""[cells] From the middle of a cell to its corners."""
BEYOND = 0.1
"""[cells] So far beyond a closed side the body is looked for whose surface it is."""
TINY = 1e-12


class Places:
    """Cells of every frame against bodies and sides."""

    questions: ClassVar[Mapping[str, Question]] = PLACES

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.inside: list[float] = []
        self.wrong: list[float] = []
        self.where: dict[tuple[str, int], list[float]] = {}
        self.sides: list[F64] = []

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Look at one frame."""
        depth = self.box.bodies.depth(now)
        self._inside(now, depth)
        reach = HALF_DIAGONAL * self.box.cell
        wrong = ((depth > reach) & now.open) | ((depth == -np.inf) & (now.room < WHOLE))
        self.wrong.append(float(wrong.sum()))
        if wrong.any():
            self.where["room", now.index] = now.place(np.unravel_index(int(wrong.argmax()), wrong.shape))
        self.sides.append(np.array([self._thickness(now, side) for side in range(6)]))

    def _inside(self, now: GasFrame, depth: F64) -> None:
        box = self.box
        most = max([TINY, *(box.dark(m) for m in box.members)])
        span = max([TINY, *(abs(float(box.lightness_at(box.physics(m).temperature))) for m in box.members)])
        shut = np.flatnonzero(~now.open | (depth > HALF_DIAGONAL * box.cell))
        soot, temperature = (a.reshape(-1)[shut] for a in (now.soot, now.temperature))
        light = np.abs(box.lightness_at(np.maximum(temperature, 1e-3)))
        share = np.maximum(np.abs(soot) / most, light / span)
        self.inside.append(float(share.max(initial=0.0)))
        if self.inside[-1] > THIN:
            self.where["inside", now.index] = now.place(np.unravel_index(int(shut[share.argmax()]), depth.shape))

    def _thickness(self, now: GasFrame, side: int) -> float:
        """Largest optical depth along a side; along a closed one, of what is against no body."""
        box = self.box
        soot = layer(now.held, side)
        if box.sides[side] == "closed":
            soot = np.where(box.bodies.beyond(now, side, BEYOND) == -np.inf, soot, 0.0)
        return box.extinction * box.cell * max(float(soot.sum(axis=a).max(initial=0.0)) for a in range(2))

    def findings(self) -> dict[str, Finding]:
        """Findings on the six questions by name."""
        box, inside, wrong = self.box, np.array(self.inside), np.array(self.wrong)

        def within(frame: int | None) -> str:
            if frame is None:
                return "there is no gas in bodies or in closed cells"
            return f"{inside[frame]:.3g} of a source's soot or heat is in a body or a closed cell at frame {frame}, at {self.where['inside', frame]}"

        def rooms(frame: int | None) -> str:
            if frame is None:
                return "cells in bodies are closed, and those away from them open"
            return f"{wrong[frame]:.0f} cells are open in bodies or closed away from them at frame {frame}, first at {self.where['room', frame]}"

        def at(name: str, values: F64, bound: float) -> dict[str, object] | None:
            return {"at": self.where[name, int(np.argmax(values > bound))]} if (values > bound).any() else None

        return {
            "inside": kept_within(inside, THIN, "1", within, recomputed(box), at("inside", inside, THIN)),
            "room": kept_within(wrong, 0.0, "cells", rooms, (bake_again(),), at("room", wrong, 0.0)),
            "source": self._source(),
            "resolved": self._resolved(),
            "cut": self._side("open", "ends at the open side"),
            "stopped": self._side("closed", "is stopped by nothing that is seen at the closed side"),
        }

    def _source(self) -> Finding:
        box, worst, name = self.box, 0.0, self.box.members[0]
        for source in box.sources:
            points = source.samples()
            low, high = box.read(0).corner, box.read(0).corner + box.size
            out = ~((points >= low) & (points <= high)).all(axis=1) | (depth_in(box.bodies.pieces, points, 0, 0.0) > 0.0)
            if float(out.mean()) > worst:
                worst, name = float(out.mean()), source.entity
        hint = correction(
            "the source is in a body or outside the box",
            "placement",
            f"move {name!r} into open air",
            pointers=(f"/entities/{name}/pose",),
        )
        text = (
            f"{worst:.0%} of the source {name} is in a body or outside the box"
            if worst
            else "sources are in the open, inside the box"
        )
        return Finding(
            "fail" if worst else "pass", text, worst, 0.0, "1", entity=name if worst else None, hints=(hint,) if worst else ()
        )

    def _resolved(self) -> Finding:
        box = self.box
        source = min(box.sources, key=lambda s: float((s.upper - s.lower).min()))
        across = float((source.upper - source.lower).min()) / box.cell
        ok = across >= ACROSS - 1e-6
        hints = () if ok else (finer(box, source.entity, ACROSS / across),)
        text = f"the source {source.entity} is {across:.3g} cells across"
        return Finding("pass" if ok else "fail", text, across, ACROSS, "cells", entity=None if ok else source.entity, hints=hints)

    def _side(self, kind: str, words: str) -> Finding:
        box = self.box
        rows = [side for side in range(6) if box.sides[side] == kind]
        if not rows:
            return Finding("not_applicable", f"no side is {kind}")
        depth = np.array(self.sides)[:, rows]
        worst = depth.max(axis=1)
        first = int(np.argmax(worst > CUT)) if (worst > CUT).any() else None
        side = rows[int(depth[-1 if first is None else first].argmax())]

        def told(frame: int | None) -> str:
            if frame is None:
                return (
                    f"no smoke is seen to end at a side that is {kind}; the optical depth along one is {worst.max():.2g} at most"
                )
            return f"smoke with an optical depth of {worst[frame]:.3g} {words} {NAMES[side]} from frame {frame} on, {worst.max():.3g} at most"

        hint = larger_box(box, side, "the box ends where smoke is still seen", NAMES[side])
        return kept_within(worst, CUT, "1", told, (hint,), {"side": NAMES[side]} if first is not None else None)
