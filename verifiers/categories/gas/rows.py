"""Findings and corrections that several watches of gas share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...rows.corrections import bake_again, correction, halve_step, pointer
from ...rows.findings import Finding

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.requirements import Correction
    from .frames import GasBox

__all__ = ["finer", "hold_the_flame", "kept_within", "larger_box", "recomputed", "shorter"]


def kept_within(
    off: F64,
    bound: float,
    unit: str,
    told: Callable[[int | None], str],
    hints: tuple[Correction, ...] = (),
    evidence: dict[str, Any] | None = None,
) -> Finding:
    """Finding on a value of every frame that may not exceed a bound; `told` says in words what is there, at the first frame over it or in all."""
    over = ~(off <= bound)
    frame = int(np.argmax(over)) if over.any() else None
    return Finding(
        "pass" if frame is None else "fail", told(frame), float(off.max(initial=0.0)), bound, unit, frame=frame,
        hints=() if frame is None else hints, evidence=evidence,
    )  # fmt: skip


def recomputed(box: GasBox) -> tuple[Correction, ...]:
    """Bake again, then with a shorter step."""
    return (bake_again(), shorter(box))


def shorter(box: GasBox) -> Correction:
    """Halve the longest step."""
    return halve_step(box.candidate, box.solver, "the step is too long for the flow")


def finer(box: GasBox, member: str, factor: float) -> Correction:
    """Finer cells."""
    place = f"/entities/{member}/physics/resolution"
    value = float(f"{box.physics(member).resolution / factor:.3g}")
    return correction(
        "cells are too coarse for it", "resolution", f"lower resolution to {value:g} m; cells and steps grow with its fourth power",
        pointers=(place,), patch=({"op": "add", "path": place, "value": value},),
    )  # fmt: skip


def larger_box(box: GasBox, side: int, cause: str, name: str) -> Correction:
    """A domain that goes on by a quarter beyond a side."""
    place, axis = f"/simulation/solvers/{box.solver}/settings/domain", side // 2
    more = box.cell * max(1, round(0.25 * box.size[axis] / box.cell))
    size, center = ([float(v) for v in a] for a in (box.size, box.settings.domain.center))
    size[axis] += more
    center[axis] += (0.5 if side % 2 else -0.5) * more
    return correction(
        cause, "domain", f"extend the domain by {more:.3g} m beyond side {name}", pointers=(f"{place}/size", f"{place}/center"),
        patch=tuple({"op": "add", "path": f"{place}/{k}", "value": [round(c, 6) for c in v]} for k, v in (("size", size), ("center", center))),
    )  # fmt: skip


def hold_the_flame(entity: str, details: Mapping[str, Any]) -> list[Correction]:
    """Correction of flames that ended with the spark that lit them."""
    spark = dict(details.get("flames") or {}).get("spark")
    if not spark:
        return []
    place = pointer("simulation", "drivers", spark, "end")
    action = f"let {spark} stay on as a pilot flame (remove {place}), or feed {entity} with more gas in a wider source: a flame of a few cells keeps itself alight"
    return [
        correction(
            f"the flames end with ignition {spark}: their gas is too cold to burn on by itself",
            "drivers",
            action,
            pointers=(place,),
            patch=({"op": "remove", "path": place},),
        )
    ]
