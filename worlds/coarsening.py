"""Coarser probes (R78): overrides of the specification, by the knobs that its categories declare.

The step of rigid contact is no knob: what bodies do depends on it. A coarse probe vouches for the bake of the same freeze, whose
event order and times are checked against it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from .categories.registry import CATEGORIES
from .errors import EvidenceError, InputError
from .folder import write_atomically

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = [
    "COARSEST",
    "OVERRIDES",
    "Factors",
    "coarsened",
    "overrides_for",
    "read_factors",
    "read_overrides",
    "sketched",
    "write_factors",
    "write_overrides",
]

COARSEST = 2.0
"""Own choice: a liquid of twice the spacing, or grains of twice the radius, have an eighth of the particles and about a sixteenth of the cost; coarser ones lose the
layers and passages that production resolves."""
SKETCHIEST = 4.0
"""Own choice: a sixty-fourth of the particles; fewer show no flow."""
LONGEST_STEP = 5e-3
"""Longest step of a rigid instance, as its field has it [s]."""
OVERRIDES = "overrides.json"
"""File of them in the folder of a probe."""
FACTORS = "factors.json"
"""File in the folder of a sketch that says by what it is coarser."""


def overrides_for(spec: WorldSpec, factor: float) -> dict[str, float]:
    """Pointers and values of a probe that is coarser by a factor; empty for a factor of 1.

    Raises:
        InputError: the factor is out of range, or nothing in the world can be coarser.
    """
    if not 1.0 <= factor <= COARSEST:
        raise InputError(f"coarser is {factor:g}; allowed: 1 (production settings) to {COARSEST:g}")
    if factor == 1.0:
        return {}
    found = {pointer: value * factor for pointer, value in _knobs(spec).items()}
    if not found:
        raise InputError(
            f"coarser is {factor:g}, but no engine of this world can run coarser: rigid contact depends on its step. "
            "Leave coarser out; a rigid probe is short instead"
        )
    return found


def _knobs(spec: WorldSpec) -> dict[str, float]:
    """Production values of all knobs, by pointer."""
    return {
        f"/entities/{member}/physics/{knob}": float(getattr(spec.entities[member].physics, knob))
        for solver in spec.simulation.solvers.values()
        for member in solver.members
        if member in spec.entities
        for knob in CATEGORIES[spec.entities[member].physics.category].knobs.get(solver.engine, ())
    }


def coarsened(spec: WorldSpec, overrides: Mapping[str, float]) -> WorldSpec:
    """The specification that a probe with these overrides runs.

    Raises:
        EvidenceError: an override is no knob of this world, or out of its range.
    """
    known = _knobs(spec)
    for pointer, value in overrides.items():
        least = known.get(pointer, math.nan)
        if not least <= value <= COARSEST * least * (1.0 + 1e-9):
            raise EvidenceError(
                f"the probe overrides {pointer} with {value:g}, which is no setting that probes may leave coarser; call probe_sim again"
            )
    return _with_knobs(spec, overrides)


def _with_knobs(spec: WorldSpec, values: Mapping[str, float]) -> WorldSpec:
    """The specification with other values of knobs."""
    entities = dict(spec.entities)
    for pointer, value in values.items():
        _, _, name, _, knob = pointer.split("/")
        physics = entities[name].physics.model_copy(update={knob: value})
        entities[name] = entities[name].model_copy(update={"physics": physics})
    return spec.model_copy(update={"entities": entities}) if values else spec


def sketched(spec: WorldSpec, coarser: float, steps: float) -> tuple[WorldSpec, dict[str, float]]:
    """The specification that a sketch runs, and by pointer the values that it leaves coarser than production.

    A sketch vouches for nothing, so that it may also lengthen the step of rigid contact.

    Args:
        spec: production settings.
        coarser: factor of spacings, cells and radii.
        steps: factor of the steps of rigid instances, to at most the longest that a specification allows.

    Raises:
        InputError: a factor is out of range.
    """
    for name, factor in (("coarser", coarser), ("steps", steps)):
        if not 1.0 <= factor <= SKETCHIEST:
            raise InputError(f"{name} of a sketch is {factor:g}; allowed: 1 (production settings) to {SKETCHIEST:g}")
    values = {pointer: value * coarser for pointer, value in _knobs(spec).items()} if coarser > 1 else {}
    told, solvers = dict(values), dict(spec.simulation.solvers)
    for name, solver in spec.simulation.rigid.items() if steps > 1 else ():
        step = min(solver.settings.step * steps, LONGEST_STEP)
        solvers[name] = solver.model_copy(update={"settings": solver.settings.model_copy(update={"step": step})})
        told[f"/simulation/solvers/{name}/settings/step"] = step
    plan = spec.simulation.model_copy(update={"solvers": solvers})
    return _with_knobs(spec, values).model_copy(update={"simulation": plan}), told


class Factors(NamedTuple):
    """By what a sketch is coarser."""

    coarser: float
    """Factor of spacings, cells and radii."""
    steps: float
    """Factor of the steps of rigid instances."""
    judged: bool
    """True once its rows are told."""


def write_factors(sketch: Path, factors: Factors) -> None:
    """Record by what the sketch in a folder is coarser, so that its frames can be read."""
    sketch.mkdir(parents=True, exist_ok=True)
    write_atomically(sketch / FACTORS, json.dumps(factors._asdict()).encode())


def read_factors(sketch: Path) -> Factors:
    """Factors of the sketch in a folder.

    Raises:
        EvidenceError: there is none, or its record is damaged.
    """
    try:
        held = json.loads((sketch / FACTORS).read_text())
        return Factors(float(held["coarser"]), float(held["steps"]), bool(held["judged"]))
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise EvidenceError(
            f"{FACTORS} of the sketch is missing or damaged ({error}); call probe_sim(sketch=...) again"
        ) from error


def read_overrides(probe: Path) -> dict[str, float]:
    """Overrides of the probe in a folder; empty where it runs at production settings.

    Raises:
        EvidenceError: the record is damaged.
    """
    path = probe / OVERRIDES
    if not path.exists():
        return {}
    try:
        return {str(k): float(v) for k, v in json.loads(path.read_text()).items()}
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise EvidenceError(f"{OVERRIDES} of the probe is damaged ({error}); call probe_sim again") from error


def write_overrides(probe: Path, overrides: Mapping[str, float]) -> None:
    """Record the overrides of a probe."""
    write_atomically(probe / OVERRIDES, json.dumps(overrides, sort_keys=True).encode())
