"""Findings of series of frames, and points for evidence."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ...rows.findings import Finding

if TYPE_CHECKING:
    from ....worlds.requirements import Correction

__all__ = ["first_over", "place", "worst"]


def worst(values: F64, bound: float) -> tuple[float, int | None, int]:
    """Largest of a series, first frame over the bound (None where none is) and frame of the largest.

    Raises:
        EvidenceError: nothing of the series could be judged.
    """
    known = np.where(np.isnan(values), -np.inf, values)
    if not len(known) or np.isneginf(known).all():
        raise EvidenceError("no frame has such a case")
    over = known > bound
    return float(known.max()), int(np.argmax(over)) if over.any() else None, int(np.argmax(known))


def first_over(values: F64, bound: float, unit: str, what: str, hints: tuple[Correction, ...] = (), **more: Any) -> Finding:
    """Finding of a series that must not exceed a bound; a value that is not a number is not judged."""
    value, frame, at = worst(values, bound)
    named = "" if unit == "1" else f" {unit}"
    text = f"{what} is at most {value:.4g}{named} (frame {at}), allowed {bound:.4g}{named}"
    if frame is not None:
        text = f"{what} is {values[frame]:.4g}{named} at frame {frame}, largest {value:.4g}{named} at frame {at}, allowed {bound:.4g}{named}"
    return Finding("pass" if frame is None else "fail", text, value, bound, unit, frame=frame, hints=hints, **more)


def place(point: F64) -> list[float]:
    """A point for evidence [m]."""
    return [round(float(c), 6) for c in point]
