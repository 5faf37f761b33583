"""Numbers, directions and lists as the account writes them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...worlds.arrays import F64

__all__ = ["letters", "number", "place", "seconds", "sizes", "towards"]

SHARE = 0.4
"""Own choice: part of a direction's length from which on an axis is named: 0.38 is 22.5 degrees off the other axis."""


def number(value: float) -> str:
    """A number to three digits; what rounds to nothing beside a millimetre is 0."""
    return f"{0.0 if abs(value) < 5e-5 else value:.3g}"


def seconds(value: float) -> str:
    """A time [s] to a hundredth."""
    return f"{max(0.0, value):.2f}"


def sizes(values: Sequence[float]) -> str:
    """Lengths [m], `0.4 x 0.2 x 0.1 m`; empty for none."""
    return " x ".join(number(v) for v in values) + " m" if values else ""


def place(point: F64) -> str:
    """A point of the world [m], to a centimetre or three digits."""
    return f"({', '.join(number(round(float(v), 3)) for v in point)})"


def towards(vector: F64) -> str:
    """The axes along which a vector points: `+x`, `-y and down`."""
    length = float(np.linalg.norm(vector))
    if not length > 0.0:
        return "nowhere"
    names = (("-x", "+x"), ("-y", "+y"), ("down", "up"))
    return " and ".join(names[k][int(v > 0.0)] for k, v in enumerate(vector / length) if abs(v) >= SHARE)


def letters(count: int) -> str:
    """Letters of the thing of a rank: A to Z, then AA, AB."""
    found = ""
    count += 1
    while count:
        count, left = divmod(count - 1, 26)
        found = chr(ord("A") + left) + found
    return found
