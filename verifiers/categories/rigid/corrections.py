"""Corrections that only rigid bodies have."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...rows.corrections import correction

if TYPE_CHECKING:
    from ....worlds.requirements import Correction

__all__ = ["closer_masses", "compare_materials", "declare_source"]


def compare_materials(cause: str) -> Correction:
    """Look for what a contact is declared to have."""
    action = "look at the materials of the two, and at the contact that is declared of them"
    return correction(cause, "material", action, pointers=("/materials",))


def declare_source(cause: str, what: str = "force") -> Correction:
    """Declare the driver of a force or torque that nothing explains."""
    return correction(
        cause, "drivers", f"declare the driver of a {what}, or let a contact do it", pointers=("/simulation/drivers",)
    )


def closer_masses(cause: str, which: str) -> Correction:
    """Bring the masses of bodies closer together that are joined or touch."""
    return correction(cause, "mass", f"bring the masses of {which} bodies closer together")
