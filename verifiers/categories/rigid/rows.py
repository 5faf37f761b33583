"""Laws of rigid bodies: the finding about a table of excesses over one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...rows.corrections import bake_again
from ...rows.findings import Finding

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.requirements import Correction

__all__ = ["Law"]


@dataclass(frozen=True)
class Law:
    """Greatest sound value of a quantity, and its words."""

    bound: float
    unit: str
    quantity: str
    """For the sentence of a finding."""
    none: str = "there is only one frame"
    """Why there is no case, where there is none."""
    hint: Callable[[str], Correction] | None = None
    """Correction for an entity that fails, before those that always apply."""

    def judge(
        self,
        names: tuple[str, ...],
        excess: F64,
        judged: NDArray[np.bool_] | None = None,
        *,
        shift: int = 1,
        evidence: dict[str, Any] | None = None,
        proof: Callable[[str, int], dict[str, Any]] | None = None,
    ) -> Finding:
        """The finding about the largest excess: `not_applicable` where the caches prove that there is no case of the law.

        Args:
            names: of the columns.
            excess: per interval and entity, shape (intervals, E), in the law's unit.
            judged: where the law applies, same shape; default where the excess is finite.
            shift: frame of row 0: 1 where rows are the intervals that end at a frame.
            evidence: further evidence.
            proof: further evidence about the entity and frame of a failure.
        """
        judged = np.isfinite(excess) if judged is None else judged
        values = np.where(judged, excess, -np.inf)
        count = int(np.count_nonzero(judged))
        if not count:
            return Finding("not_applicable", self.none)
        value, over = max(float(values.max()), 0.0), (values > self.bound).any(axis=1)
        row = int(np.argmax(over if over.any() else values.max(axis=1)))
        entity, frame = names[int(np.argmax(values[row]))], row + shift
        known, named = {"cases": count, **(evidence or {})}, tuple(dict.fromkeys(names))
        if not over.any():
            text = f"largest {self.quantity} is {value:.3g} {self.unit}, {entity} at frame {frame} ({count} cases)"
            return Finding("pass", text, value, self.bound, self.unit, evidence=known, entities=named)
        text = (
            f"{self.quantity} of {entity} is over {self.bound:.3g} {self.unit} first at frame {frame}; "
            f"largest {value:.4g} {self.unit}"
        )
        known |= proof(entity, frame) if proof else {}
        hints = (*([self.hint(entity)] if self.hint else []), bake_again())
        return Finding("fail", text, value, self.bound, self.unit, entity, frame, hints, known, entities=named)
