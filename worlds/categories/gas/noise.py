"""Least values of predicates about gases that are no noise: what rounding and a scheme spread, and what no eye or hand tells (R154)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from ...predicate_base import Noise
from .models import GasPhysics

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["GAS_NOISE", "Least", "gas_bounds", "least_of_gas"]

SOOT_SHARE = 1e-3
"""[1] Own choice: of the soot of its source, a tenth of what counts as arrived; cells of single precision spread 1e-7 of it."""
KELVIN = 1.0
"""[K] Own choice: no skin tells less, and a scheme of cells keeps still air to a hundredth of it."""
WATTS = 10.0
"""[W] Own choice, that of `burns`: a tenth of what a candle gives."""
DIMMED = 0.02
"""[1] Koschmieder's least contrast: of light, what an eye does not miss."""


class Least(NamedTuple):
    """Least value that is no noise."""

    value: float
    unit: str
    how: str


def least_of_gas(spec: WorldSpec, kind: str, entity: str) -> Least | None:
    """Least difference that a predicate about a gas may ask for; None where the specification has no such gas."""
    known = spec.entities.get(entity)
    if known is None or not isinstance(known.physics, GasPhysics):
        return None
    if kind in ("gas_density_in", "gas_arrives"):
        value = float(f"{SOOT_SHARE * known.physics.soot_density:.3g}")
        return Least(value, "kg/m^3", f"{SOOT_SHARE:g} of the soot of its source")
    if kind == "plume_height":
        return Least(known.physics.resolution, "m", "one of its cells")
    return {
        "gas_temperature_in": Least(KELVIN, "K", "the least that is felt"),
        "heat_release": Least(WATTS, "W", "the least that counts as a fire"),
        "light_through": Least(DIMMED, "1", "the least contrast that is seen"),
    }[kind]


def gas_bounds(spec: WorldSpec, predicate: Mapping[str, Any], subject: str) -> Iterator[tuple[str, float, str]]:
    """Bounds of a predicate that noise alone would meet: field, the least that is taken, and the sentence why."""
    kind, entity = predicate["kind"], predicate.get("entity", subject)
    least = least_of_gas(spec, kind, entity)
    if least is None:
        return
    zero = _still_air(spec, entity) if kind == "gas_temperature_in" else 0.0
    full = zero if kind == "gas_temperature_in" else 1.0 if kind == "light_through" else None
    unit = "" if least.unit == "1" else f" {least.unit}"
    for field in ("min", "min_density"):
        value = predicate.get(field)
        if value is not None and zero < value < zero + least.value:
            asked = f"at least {zero + least.value:g}{unit} ({least.how})"
            yield field, zero + least.value, f"{kind} with {field} {value:g}{unit} is within noise; ask for {asked}"
    value = predicate.get("max")
    if full is not None and value is not None and full - least.value < value < full:
        asked = f"at most {full - least.value:g}{unit} ({least.how})"
        yield "max", full - least.value, f"{kind} with max {value:g}{unit} is within noise; ask for {asked}"


def _still_air(spec: WorldSpec, entity: str) -> float:
    """Temperature of the air around a gas [K]."""
    found = (s.settings.ambient_temperature for s in spec.simulation.gas.values() if entity in s.members)
    return next(found, 293.15)


GAS_NOISE = Noise(gas_bounds, least_of_gas)
"""Noise of predicates about gases."""
