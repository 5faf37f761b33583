"""Corrections that several watches of particles name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.requirements import Correction
from ...rows.corrections import correction

if TYPE_CHECKING:
    from .frames import Swarm

__all__ = ["emitted_slower", "stiffer"]


def emitted_slower(swarm: Swarm) -> tuple[Correction, ...]:
    """Let them out more slowly; nothing where no emitter does."""
    drivers = swarm.candidate.spec.simulation.drivers
    taps = [n for n, d in drivers.items() if d.kind == "emitter" and d.entity in swarm.members]
    if not taps:
        return ()
    pointers = tuple(f"/simulation/drivers/{n}/speed" for n in taps)
    return (
        correction("an emitter lets them out too fast", "drivers", f"lower the speed of {', '.join(taps)}", pointers=pointers),
    )


def stiffer(swarm: Swarm, cause: str, factor: float) -> Correction:
    """Take stiffer grains."""
    pointers = tuple(f"/entities/{m}/physics/young_modulus" for m in swarm.members)
    patch = tuple(
        {"op": "add", "path": p, "value": float(f"{min(1e11, swarm.physics(k).young_modulus * factor):.3g}")}
        for k, p in enumerate(pointers)
    )
    return correction(
        cause, "mass", f"raise young_modulus {factor:.3g} times; steps get shorter by its root", pointers=pointers, patch=patch
    )
