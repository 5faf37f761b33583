"""Laws of rigid bodies: the largest excess over one, and the finding about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...rows.corrections import bake_again, halve_step
from ...rows.findings import Finding

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction

__all__ = ["Excess", "Law", "judged_law", "largest"]


@dataclass(frozen=True)
class Law:
    """Greatest sound value of a quantity, and its words."""

    bound: float
    unit: str
    """SI, of the bound."""
    quantity: str
    """For the sentence of a finding."""
    none: str
    """Why there is no case, where there is none."""


@dataclass(frozen=True)
class Excess:
    """The largest excess over a law: value, whose, and first frame over the bound (or the frame of the largest)."""

    law: Law
    names: tuple[str, ...]
    """All that were looked at."""
    value: float = 0.0
    entity: str | None = None
    frame: int = 0
    over: bool = False
    judged: int = 0
    """How many cases the law could be applied to."""


def largest(law: Law, names: tuple[str, ...], excess: F64, judged: NDArray[np.bool_] | None = None, *, shift: int = 1) -> Excess:
    """The worst of a table.

    Args:
        law: what it is held against.
        names: of the columns.
        excess: per interval and entity, shape (intervals, E), in the law's unit.
        judged: where the law applies, same shape; default where the excess is finite.
        shift: frame of row 0: 1 where rows are the intervals that end at a frame.
    """
    judged = np.isfinite(excess) if judged is None else judged
    values = np.where(judged, excess, -np.inf)
    count = int(np.count_nonzero(judged))
    if not count:
        return Excess(law, names)
    over = values > law.bound
    peak = max(float(values.max()), 0.0)
    if over.any():
        row = int(np.argmax(over.any(axis=1)))
        column = int(np.argmax(values[row]))
    else:
        row, column = (int(i) for i in np.unravel_index(int(np.argmax(values)), values.shape))
    return Excess(law, names, peak, names[column], row + shift, bool(over.any()), count)


def judged_law(
    candidate: Candidate,
    solver: str,
    found: Excess,
    *,
    hints: tuple[Correction, ...] = (),
    evidence: dict[str, object] | None = None,
) -> Finding:
    """The finding about an excess over a law: `not_applicable` where the caches prove that there is no case of it.

    Args:
        candidate: what is judged.
        solver: instance.
        found: the excess.
        hints: corrections of a failure before those that always apply: halve the step, bake again.
        evidence: further evidence.
    """
    law = found.law
    if not found.judged:
        return Finding("not_applicable", law.none)
    names = tuple(dict.fromkeys(found.names))
    proof = {"cases": found.judged, **(evidence or {})}
    if not found.over:
        text = f"largest {law.quantity} is {found.value:.3g} {law.unit}, {found.entity} at frame {found.frame} ({found.judged} cases)"
        return Finding("pass", text, found.value, law.bound, law.unit, evidence=proof, entities=names)
    text = (
        f"{law.quantity} of {found.entity} is over {law.bound:.3g} {law.unit} first at frame {found.frame}; "
        f"largest {found.value:.4g} {law.unit}"
    )
    hints = (*hints, halve_step(candidate, solver, "the step is too long for what happens"), bake_again())
    return Finding("fail", text, found.value, law.bound, law.unit, found.entity, found.frame, hints, proof, entities=names)
