"""How a check of rigid bodies states its verdict: one row of an instance, and what a law came to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..worlds.requirements import Correction, Row, Status
from .verdicts import correction, make_row

if TYPE_CHECKING:
    from ..worlds.arrays import F64
    from ..worlds.candidate import Candidate

__all__ = ["Excess", "largest", "law_row", "rigid_row", "step_hint"]


def rigid_row(
    candidate: Candidate,
    row_id: str,
    status: Status,
    predicate: str,
    explanation: str,
    *,
    measured: float | None = None,
    bound: float | None = None,
    unit: str = "",
    entities: tuple[str, ...] = (),
    entity: str | None = None,
    frame: int | None = None,
    corrections: tuple[Correction, ...] = (),
    evidence: dict[str, object] | None = None,
) -> Row:
    """A row of the category check."""
    return make_row(
        candidate,
        row_id,
        check="category",
        group="physical",
        predicate=predicate,
        status=status,
        explanation=explanation,
        frames=(0, candidate.last_frame),
        measured=measured,
        bound=bound,
        comparison="<=" if measured is not None else "",
        unit=unit,
        entities=entities,
        first_failing_entity=entity,
        first_failing_frame=frame,
        corrections=corrections,
        evidence=evidence,
        extra=[candidate.spec.simulation.limits.energy_growth],
    )


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


def step_hint(candidate: Candidate, solver: str, cause: str) -> Correction:
    """Halve the step."""
    pointer = f"/simulation/solvers/{solver}/settings/step"
    step = candidate.spec.simulation.rigid[solver].settings.step
    patch = ({"op": "add", "path": pointer, "value": round(max(2e-5, step / 2), 9)},)
    return correction(cause, "step", "halve the step", pointers=(pointer,), patch=patch)


def law_row(
    candidate: Candidate,
    solver: str,
    name: str,
    predicate: str,
    found: Excess,
    *,
    bound: float,
    unit: str,
    what: str,
    none: str,
    entities: tuple[str, ...],
    hints: tuple[Correction, ...] = (),
    evidence: dict[str, object] | None = None,
) -> Row:
    """The row of one law, `not_applicable` where the caches prove that there is no case of it.

    Args:
        candidate: what is judged.
        solver: instance.
        name: second part of the id.
        predicate: the law.
        found: what it came to.
        bound: greatest sound value.
        unit: of value and bound.
        what: what the value is, for the sentence.
        none: why there is no case.
        entities: all that were looked at.
        hints: corrections of a failure; default: bake again, halve the step.
        evidence: further evidence.
    """
    row_id = f"category:rigid:{name}:{solver}"
    if not found.judged:
        return rigid_row(candidate, row_id, "not_applicable", predicate, none)
    again = correction("the cache was edited or is of another run", "interval", "bake again", pointers=("/simulation/frames",))
    text = f"largest {what} is {found.value:.3g} {unit}, {found.entity} at frame {found.frame} ({found.judged} cases)"
    if found.over:
        text = (
            f"{what} of {found.entity} is over {bound:.3g} {unit} first at frame {found.frame}; largest {found.value:.4g} {unit}"
        )
    return rigid_row(
        candidate,
        row_id,
        "fail" if found.over else "pass",
        predicate,
        text,
        measured=found.value,
        bound=bound,
        unit=unit,
        entities=entities,
        entity=found.entity if found.over else None,
        frame=found.frame if found.over else None,
        corrections=(*hints, step_hint(candidate, solver, "the step is too long for what happens"), again) if found.over else (),
        evidence={"cases": found.judged, **(evidence or {})},
    )
