"""Caps of the categories of matter: plain numbers, so that whoever lists the server's caps loads no category's code."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["CATEGORY_CAPS", "CLOTH_CAPS", "GAS_CAPS", "LOOSE_CAPS", "PIECES", "Cap"]


@dataclass(frozen=True)
class Cap:
    """The largest amount of something that the server takes on."""

    name: str
    value: int
    unit: str
    knob: str
    """The change that keeps below it."""


LOOSE_CAPS = (
    Cap(
        "particles",
        20_000_000,
        "particles",
        "a larger /entities/<liquid>/physics/resolution or radius of grains, a smaller volume or domain, or inflows that end sooner",
    ),
    Cap(
        "particle_steps",
        100_000_000_000,
        "particle steps",
        "a larger /entities/<liquid>/physics/resolution or radius of grains, softer grains (young_modulus), fewer frames, or engine flip instead of dfsph",
    ),
)
"""Caps of liquids and particles."""
CLOTH_CAPS = (
    Cap("vertices", 1_000_000, "vertices of cloth", "a larger /entities/<cloth>/parts/<part>/shape/resolution"),
    Cap(
        "vertex_steps",
        100_000_000_000,
        "vertex steps",
        "a larger resolution of the sheets, a smaller stretch_stiffness or damping, or fewer frames",
    ),
)
GAS_CAPS = (
    Cap(
        "cell_steps",
        50_000_000_000,
        "cell steps",
        "a larger /entities/<gas>/physics/resolution, a smaller domain, a larger courant or max_step, or fewer frames",
    ),
)
PIECES = Cap("pieces", 2_000, "pieces", "fewer pieces in /entities/<id>/breakable/pattern, or larger bricks")
CATEGORY_CAPS = (*LOOSE_CAPS, *CLOTH_CAPS, *GAS_CAPS, PIECES)
"""Caps of all categories; a test compares them with those that the categories declare."""
