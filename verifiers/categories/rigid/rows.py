"""What a law of rigid bodies came to: the largest excess over it, and the finding about that."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....worlds.requirements import Correction
from ...rows.findings import Finding, again, halve

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate

__all__ = ["Excess", "judged_law", "largest"]


@dataclass(frozen=True)
class Excess:
    """The largest excess over what a law allows: value, whose, and first frame over the bound (or the frame of the largest)."""

    value: float
    entity: str | None
    frame: int
    over: bool
    judged: int
    """How many cases the law could be applied to."""


def largest(excess: F64, judged: NDArray[np.bool_], entities: tuple[str, ...], bound: float, *, shift: int = 1) -> Excess:
    """The worst of a table.

    Args:
        excess: per interval and entity, shape (intervals, E), in the bound's unit.
        judged: where the law applies, same shape, bool.
        entities: names of the columns.
        bound: greatest sound value.
        shift: frame of row 0: 1 where rows are the intervals that end at a frame.
    """
    values = np.where(judged, excess, -np.inf)
    count = int(np.count_nonzero(judged))
    if not count:
        return Excess(0.0, None, 0, False, 0)
    over = values > bound
    peak = float(values.max())
    if over.any():
        frame = int(np.argmax(over.any(axis=1)))
        return Excess(max(peak, 0.0), entities[int(np.argmax(values[frame]))], frame + shift, True, count)
    row, column = np.unravel_index(int(np.argmax(values)), values.shape)
    return Excess(max(peak, 0.0), entities[int(column)], int(row) + shift, False, count)


def judged_law(
    candidate: Candidate,
    solver: str,
    found: Excess,
    *,
    bound: float,
    unit: str,
    what: str,
    none: str,
    entities: tuple[str, ...],
    hints: tuple[Correction, ...] = (),
    evidence: dict[str, object] | None = None,
) -> Finding:
    """What the excess over a law comes to, `not_applicable` where the caches prove that there is no case of it.

    Args:
        candidate: what is judged.
        solver: instance.
        found: the excess.
        bound: greatest sound value.
        unit: of value and bound.
        what: what the value is, for the sentence.
        none: why there is no case.
        entities: all that were looked at.
        hints: corrections of a failure; default: bake again, halve the step.
        evidence: further evidence.
    """
    if not found.judged:
        return Finding("not_applicable", none)
    proof = {"cases": found.judged, **(evidence or {})}
    if not found.over:
        text = f"largest {what} is {found.value:.3g} {unit}, {found.entity} at frame {found.frame} ({found.judged} cases)"
        return Finding("pass", text, found.value, bound, unit, evidence=proof, entities=entities)
    text = f"{what} of {found.entity} is over {bound:.3g} {unit} first at frame {found.frame}; largest {found.value:.4g} {unit}"
    hints = (
        *hints,
        halve(candidate, solver, "the step is too long for what happens"),
        again("the cache was edited or is of another run"),
    )
    return Finding("fail", text, found.value, bound, unit, found.entity, found.frame, hints, proof, entities=entities)
