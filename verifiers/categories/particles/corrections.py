"""Corrections of a beat about particles that fails."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...rows.corrections import correction
from ...story.bounds import BEHIND, MORE

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction
    from ...predicates.outcome import Outcome

__all__ = ["stock"]


def stock(candidate: Candidate, entity: str, outcome: Outcome, details: Mapping[str, object]) -> list[Correction]:
    """Corrections for grains that are too few in a region, by whether there are enough at all and whether the others lie above it."""
    drivers, physics = candidate.spec.simulation.drivers.values(), candidate.spec.entities[entity].physics
    in_all, above = details.get("in_all"), details.get("above")
    if not isinstance(in_all, float) or not isinstance(above, float) or outcome.comparison != ">=":
        return []
    fed = any(d.kind == "emitter" and d.entity == entity for d in drivers)
    if outcome.value is None or outcome.bound is None or fed or getattr(physics, "law", "") != "granular":
        return []
    unit = "" if outcome.unit == "1" else f" {outcome.unit}"
    parts, own = (f"/entities/{entity}/parts",), f"/entities/{entity}/physics"
    more = f"fill a volume at frame 0 that is larger by a factor of {MORE * outcome.bound / max(in_all, 1e-12):.3g}"
    if in_all < outcome.bound:
        cause = f"there are not enough of them: {in_all:.4g}{unit} in all, {outcome.bound:.4g}{unit} asked for there"
        return [
            correction(cause, "shape", more, pointers=parts),
            correction(cause, "grains", "raise packing, if they lie loosely", pointers=(f"{own}/packing",)),
        ]
    if above >= BEHIND * (outcome.bound - outcome.value):
        return []
    cause = (
        f"they lie wider: of {in_all:.4g}{unit} in all {in_all - outcome.value:.4g} are elsewhere, {above:.4g} of them higher up"
    )
    return [
        correction(cause, "grains", "raise rolling, so that they heap more steeply", pointers=(f"{own}/rolling",)),
        correction(
            cause, "shape", f"{MORE:g} times as large a volume at frame 0, so that enough of them stay there", pointers=parts
        ),
    ]
