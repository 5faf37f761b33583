"""Conditions of an event as one sentence and as data: what each measured where most was reached, and which broke first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64

__all__ = ["AskedOf", "conditions_told"]


class AskedOf(NamedTuple):
    """One condition of an event, per interval of a span."""

    name: str
    value: F64
    """Measured, per interval."""
    bound: float
    sense: str
    """`>=` or `<=`."""
    unit: str
    holds: NDArray[np.bool_]
    """Where the condition holds; one that needs no more than another has, too."""


def _since(holds: NDArray[np.bool_], start: int, i: int) -> int | None:
    """First interval of those up to i in which a condition does not hold; None if it never held from `start` on."""
    k = i
    while k >= start and not holds[k]:
        k -= 1
    return None if k < start else k + 1


def conditions_told(asked: Sequence[AskedOf], start: int, i: int, first: int) -> tuple[str, dict[str, Any]]:
    """Sentence and data about the conditions at interval i of a run that began at `start`.

    Args:
        asked: the conditions, and first the measure as far as it goes without the others.
        start: first interval of the run.
        i: the interval.
        first: frame at whose end the first interval ends.
    """
    told: list[str] = []
    data: list[dict[str, Any]] = []
    broken: list[tuple[bool, bool, int, str]] = []
    for k, one in enumerate(asked):
        so, since = bool(one.holds[i]), None
        words = (
            f"{one.name} {float(one.value[i]):.3g}{' ' + one.unit if one.unit != '1' else ''} (needs {one.sense} {one.bound:.3g})"
        )
        if so:
            words += ": so"
        else:
            since = _since(one.holds, start, i)
            # The measure comes last: it is short because something else broke. What never held says less than what broke.
            broken.append((k == 0, since is None, start if since is None else since, one.name))
            words += ": not so" + (", never up to there" if since is None else f" since frame {first + since}")
        told.append(words)
        data.append(
            {
                "condition": one.name,
                "measured": float(one.value[i]),
                "needs": f"{one.sense} {one.bound:.3g} {one.unit}",
                "holds": so,
                **({} if since is None else {"broke_at_frame": first + since}),
            }
        )
    text = f"at frame {first + i}, where it came furthest: " + "; ".join(told)
    found: dict[str, Any] = {"conditions": data, "conditions_frame": first + i}
    if broken:
        _, _, at, name = min(broken)
        text += f". First to fail, at frame {first + at}: {name}"
        found |= {"failed_first": name, "failed_first_frame": first + at}
    return text, found
