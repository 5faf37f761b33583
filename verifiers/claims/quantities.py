"""Claims of a quantity against what is measured (R131, R154).

Words that say about a number exclude half of it and twice it: what is measured has to be nearer to the number than to either, in
ratios. A plain number is held closer: what is built to a twentieth, what motion gives to a quarter. Words that give the least or the most have no rival: the bound is the number that they say. What nothing measures stays the agent's
reading, which the verdict prints.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ...worlds.claims import targets_of
from ...worlds.quantities import quantity_said
from ..rows.corrections import correction
from ..rows.findings import Finding
from .bounds import AS_BUILT, AS_SAID, NEARER
from .measured import is_told, measured_at

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.prompts.numbers import Quantity
    from ...worlds.spec import WorldSpec
    from .measured import Measured

__all__ = ["is_measured", "quantity_of"]

CELSIUS = 273.15
"""[K] Temperatures are doubled in degrees Celsius, as people say them."""


class Limits(NamedTuple):
    """Values that the words leave open."""

    low: float
    high: float


def is_measured(spec: WorldSpec, name: str) -> bool:
    """True where the words of a claim state a quantity and something measured tells of what it names."""
    return _wanted(spec, name) is not None and any(is_told(p) for p in targets_of(spec.claims, name))


def _wanted(spec: WorldSpec, name: str) -> Quantity | None:
    return quantity_said(spec, name)


def limits_of(wanted: Quantity, plainly: float = NEARER) -> Limits:
    """Values that are no rival of a quantity, in its unit; of temperatures in degrees Celsius.

    Args:
        wanted: what the words say.
        plainly: ratio within which a number without a hedge is met.
    """
    shift = CELSIUS if wanted.dimension == "temperature" else 0.0
    low, value, high = (v - shift for v in (wanted.low, wanted.value, wanted.high))
    if wanted.how in ("at least", "at most") or value <= 0.0:
        return Limits(low, high)
    ratio = plainly if wanted.how == "written" else NEARER
    return Limits(min(low, value / ratio), max(high, value * ratio))


def quantity_of(candidate: Candidate, name: str) -> Finding:
    """The finding about a claim of a quantity."""
    spec, wanted = candidate.spec, _wanted(candidate.spec, name)
    assert wanted is not None
    quote, by = spec.claims[name].quote, targets_of(spec.claims, name)
    limits = limits_of(wanted, AS_SAID if any(p.startswith("/story/") for p in by) else AS_BUILT)
    found = [m for p in by for m in measured_at(candidate, p)]
    if not found:
        return Finding("unverified", f"{quote!r}: nothing measured tells of what it names")
    lost = [m for m in found if m.value is None]
    if lost:
        return Finding("unverified", f"{quote!r}: {lost[0].text}")
    other = [m for m in found if m.unit.replace("^", "") != wanted.unit]
    hint_at = (f"/claims/{name}/by",)
    if other:
        said = f"{quote!r} is a {wanted.dimension} in {wanted.unit}, and what it names is measured in {other[0].unit}: {other[0].text}"
        hint = correction(said, "story", f"name a number in {wanted.unit}", pointers=hint_at)
        return Finding("fail", said, hints=(hint,))
    values = [_value(m, wanted) for m in found]
    worst = min(range(len(values)), key=lambda i: _over(values[i], limits))
    value, told = values[worst], found[worst].text
    bound, sign = (limits.low, ">=") if value - limits.low <= limits.high - value else (limits.high, "<=")
    evidence = {"quote": quote, "says": wanted.value, "how": wanted.how, "rivals": _rivals(wanted), "measured": values}
    if _over(value, limits) > 0.0 or (wanted.how in ("at least", "at most") and _over(value, limits) >= 0.0):
        text = f"{quote!r}: measured {value:.3g} {wanted.unit}; {told}"
        return Finding("pass", text, value, bound, wanted.unit, comparison=sign, evidence=evidence)  # type: ignore[arg-type]
    said = f"{quote!r}, but what it names measures {value:.3g} {wanted.unit}: {told}"
    if wanted.how not in ("at least", "at most"):
        said += f"; {limits.low:.3g} to {limits.high:.3g} {wanted.unit} are what the words say"
    hint = correction(said, "story", "change the motion or the body so that it measures what the words say", pointers=hint_at)
    return Finding("fail", said, value, bound, wanted.unit, hints=(hint,), comparison=sign, evidence=evidence)  # type: ignore[arg-type]


def _value(measured: Measured, wanted: Quantity) -> float:
    value = float(measured.value or 0.0)
    if wanted.dimension == "temperature":
        return value - CELSIUS
    return abs(value) if wanted.value >= 0.0 else value


def _over(value: float, limits: Limits) -> float:
    """Distance to the nearer limit, negative beyond it."""
    return min(value - limits.low, limits.high - value)


def _rivals(wanted: Quantity) -> list[str]:
    if wanted.how in ("at least", "at most"):
        return []
    return [f"half: {wanted.value / 2:g} {wanted.unit}", f"twice: {2 * wanted.value:g} {wanted.unit}"]
