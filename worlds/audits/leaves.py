"""Values at JSON pointers of a specification, and the units in which its fields are given."""

from __future__ import annotations

from typing import Any

import regex

from ..predicates.registry import PREDICATES
from ..prompts.measures import SI_UNITS

__all__ = ["DIMENSIONS", "dimension_at", "leaf_at", "value_at"]

_UNITS: tuple[tuple[str, str], ...] = (
    (
        r"terrains/.*/density|stiffness|damping|max_effort|/contacts/|/settings/(?:iterations|tolerance|impratio|refine|contact_steps)",
        "",
    ),
    (r"motor", ""),
    (r"/(?:linear_velocity|velocity|speed|max_speed)$", "m/s"),
    (r"/speeds$", "m/s"),
    (r"/angular_velocity$", "rad/s"),
    (r"/mass$", "kg"),
    (r"/density$", "kg/m3"),
    (r"/(?:gravity|acceleration)$", "m/s2"),
    (r"(?:_deg|/euler|/max_slope|/quaternion)$", "rad"),
    (r"/temperature$", "K"),
    (r"/(?:time|start|end|period|gust_period|preroll|life|contact_time)$", "s"),
    (r"^/simulation/frames$|/frames$", "s"),
    (r"/fps$", "Hz"),
    (r"/(?:young_modulus|tension|shear|strength|pressure)$", "Pa"),
    (r"/force$", "N"),
    (r"/torque$", "N m"),
    (r"/(?:power|heat_release)$", "W"),
    (r"/(?:friction|restitution|roughness|metallic|transmission|packing|min_fraction|poisson_ratio)$", "1"),
    (r"/min_volume$", "m3"),
    (
        r"/(?:size|radius|height|length|width|depth|position|target|anchor|center|point|points|parent_point|child_point|rest_length|thickness|"
        r"distance|extent|cell|level|datum|sea_level|headroom|waypoints|segment_length|resolution|min|max|rim|joint)$",
        "m",
    ),
)
"""Units of numbers by the end of their pointer, outside predicates; empty where it depends on more than that."""
_OWN = {
    "min_impulse": "N s", "min_angle": "rad", "max_speed": "m/s", "min_volume": "m^3", "min_depth": "m", "min_length": "m", "min_width": "m",
    "min_height": "m", "min_area": "m^2", "within": "m", "min_amplitude": "m", "max_amplitude": "m", "min_frequency": "Hz", "max_frequency": "Hz",
    "min_cycles": "1", "max_slip": "m", "min_distance": "m",
}  # fmt: skip
"""Units of bounds of predicates that are not that of their kind."""
_VARIOUS = frozenset(("joint_angle", "landscape_water", "landscape_field", "compares"))
"""Kinds whose bounds have the unit of what they ask about."""
_KNOWN = tuple((regex.compile(pattern), unit) for pattern, unit in _UNITS)
DIMENSIONS = {unit: dimension for dimension, unit in SI_UNITS.items()}
"""Dimension of each unit of SI."""


def value_at(document: Any, pointer: str) -> Any:
    """Value at a JSON pointer; None where there is none."""
    at = document
    for token in pointer.strip("/").split("/"):
        key = token.replace("~1", "/").replace("~0", "~")
        if isinstance(at, dict):
            at = at.get(key)
        else:
            at = at[int(key)] if isinstance(at, list) and key.isdigit() and int(key) < len(at) else None
    return at


def leaf_at(document: Any, pointer: str) -> float | None:
    """Number at a JSON pointer; None where there is none."""
    at = value_at(document, pointer)
    return float(at) if isinstance(at, (int, float)) and not isinstance(at, bool) else None


def dimension_at(document: Any, pointer: str) -> str | None:
    """Dimension of the number at a JSON pointer, as `length`; its unit where words have no quantity of it; None where it is not known."""
    bare = regex.sub(r"(?:/\d+)+$", "", pointer)
    above, _, field = bare.rpartition("/")
    holder = value_at(document, above)
    kind = str(holder.get("kind")) if isinstance(holder, dict) else ""
    if field == "frames":
        return "time"
    if kind == "motor" or kind in _VARIOUS:
        return None
    info = PREDICATES.get(kind) if "/predicate" in pointer else None
    if info is not None and field in info.tightens and field not in _OWN:
        unit = info.unit
    else:
        unit = _OWN.get(field) or next((unit for pattern, unit in _KNOWN if pattern.search(bare)), "")
    unit = unit.replace("^", "")
    return DIMENSIONS.get(unit, unit) if unit else None
