"""Static friction beside that of motion (R61, R101)."""

from __future__ import annotations

__all__ = ["MOST_AT_REST", "STATIC_FRICTION", "check_static_friction"]

MOST_AT_REST = 2.0
"""[1] Static over kinetic friction at most: dry pairs have 1.0 to 1.8 (R. C. Weast, CRC Handbook, coefficients of friction; Rabinowicz 1995)."""
STATIC_FRICTION = (
    "Coulomb coefficient of what does not slide between rigid or elastic bodies, friction to twice as much; default friction"
)


def check_static_friction(friction: float | None, at_rest: float | None) -> None:
    """Refuse a static friction that no dry pair has.

    Raises:
        ValueError: it is smaller than the friction, more than `MOST_AT_REST` times as large, or given without it.
    """
    if at_rest is None:
        return
    if friction is None:
        raise ValueError(f"static_friction {at_rest:g} needs friction, that of motion, beside it")
    if not friction <= at_rest <= MOST_AT_REST * friction:
        raise ValueError(
            f"static_friction {at_rest:g} must be {friction:g} (friction) to {MOST_AT_REST * friction:g} ({MOST_AT_REST:g} x friction)"
        )
