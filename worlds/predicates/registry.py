"""Metadata of every predicate kind: unit, needed evidence, and which way a bound tightens (for R157)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, get_args

from ..vocabulary import Ref, SpecModel

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = [
    "PREDICATES",
    "PredicateInfo",
    "atoms_of",
    "describe_predicate",
    "entities_of",
    "interval_tightens",
    "is_invariant",
]

Tightens = Literal["up", "down", "none"]
Interval = Literal["narrower", "wider", "end", "either"]
"""Which change of its frames makes a predicate harder to meet; `end`: only the last frame counts; `either`: it cannot be told."""


@dataclass(frozen=True)
class PredicateInfo:
    """What a verifier needs to judge one kind."""

    kind: str
    unit: str
    """Unit of the measured value; `1` for counts and truth values."""
    channels: tuple[str, ...]
    """Cache channels that must be present; a missing one makes the row `unverified`."""
    tightens: Mapping[str, Tightens] = field(default_factory=dict)
    """Per numeric field: the direction in which the requirement becomes harder to meet."""
    frames: Interval | Literal["when", "inner", "own"] = "when"
    """Which frames are harder: `when` as that field says; `inner` as what it holds; `own` it may have frames of its own."""


_BAND: dict[str, Tightens] = {"min": "up", "max": "down"}
_POSE = ("position", "quaternion")
_LIQUID = ("origin", "particle/position", "particle/fluid", "particle/volume")
_GRAINS = ("origin", "particle/position", "particle/member", "particle/radius")
_SHEETS = ("vertex/position",)
_BONDS = ("bond/broken", "break/time", "break/bond", "break/cause")
_KINDS = (
    PredicateInfo("reaches", "m", _POSE),
    PredicateInfo("stays_in", "m", _POSE),
    PredicateInfo("crosses", "m", _POSE, frames="narrower"),
    PredicateInfo("contact", "N s", ("contact/pair", "contact/impulse"), {"min_impulse": "up"}, frames="narrower"),
    PredicateInfo("no_contact", "N s", ("contact/pair", "contact/impulse"), frames="wider"),
    PredicateInfo("rests_on", "m/s", (*_POSE, "velocity", "angular_velocity"), {"max_speed": "down"}),
    PredicateInfo("supported", "1", _POSE),
    PredicateInfo("tilts", "rad", _POSE, _BAND),
    PredicateInfo("topples", "rad", _POSE, {"min_angle": "up"}, frames="either"),
    PredicateInfo("speed", "m/s", ("velocity",), _BAND),
    PredicateInfo("displacement", "m", _POSE, _BAND),
    PredicateInfo("separation", "m", _POSE, _BAND),
    PredicateInfo("joint_angle", "rad", ("joint",), _BAND),
    PredicateInfo("deflection", "m", ("vertex/position",), _BAND),
    PredicateInfo("strain", "1", ("vertex/position",), _BAND),
    PredicateInfo(
        "landscape_water",
        "1",
        (),
        _BAND | {"min_depth": "up", "min_area": "up", "min_length": "up", "min_width": "up"},
        frames="either",
    ),
    PredicateInfo("landscape_field", "1", (), _BAND, frames="either"),
    PredicateInfo("liquid_volume_in", "m^3", _LIQUID, _BAND),
    PredicateInfo("liquid_level_at", "m", _LIQUID, _BAND),
    PredicateInfo("liquid_flux_through", "m^3", (*_LIQUID, "particle/id"), _BAND, frames="either"),
    PredicateInfo("liquid_arrives", "m^3", _LIQUID, {"min_volume": "up", "within": "down"}, frames="narrower"),
    PredicateInfo("submerged_fraction", "1", _LIQUID, _BAND),
    PredicateInfo("wet_area", "m^2", _LIQUID, _BAND),
    PredicateInfo("splash_height", "m", _LIQUID, _BAND),
    PredicateInfo("liquid_speed", "m/s", (*_LIQUID, "particle/velocity"), _BAND),
    PredicateInfo("liquid_temperature", "K", (*_LIQUID, "particle/temperature"), _BAND),
    PredicateInfo("particle_count_in", "1", _GRAINS, _BAND),
    PredicateInfo("particle_volume_in", "m^3", _GRAINS, _BAND),
    PredicateInfo("pile_height", "m", _GRAINS, _BAND),
    PredicateInfo("run_out", "m", _GRAINS, _BAND),
    PredicateInfo("particles_settled", "m/s", (*_GRAINS, "particle/velocity"), {"max_speed": "down"}),
    PredicateInfo("broken", "1", _BONDS, _BAND),
    PredicateInfo("breach", "m", (*_POSE, *_BONDS), {"min_width": "up", "min_height": "up"}),
    PredicateInfo("debris", "1", (*_POSE, *_BONDS), _BAND | {"min_distance": "up"}),
    PredicateInfo("drape", "1", _SHEETS, _BAND),
    PredicateInfo(
        "flutters",
        "m",
        _SHEETS,
        {"min_amplitude": "up", "max_amplitude": "down", "min_cycles": "up", "min_frequency": "up", "max_frequency": "down"},
        frames="either",
    ),
    PredicateInfo("torn", "m", (*_SHEETS, "edge/open", "tear/corner", "tear/side", "tear/cause"), _BAND),
    PredicateInfo("pinned", "m", _SHEETS, {"max_slip": "down"}),
    PredicateInfo("count", "1", (), _BAND, frames="inner"),
    PredicateInfo("always", "1", (), frames="own"),
    PredicateInfo("eventually", "1", (), frames="own"),
    PredicateInfo("until", "1", (), frames="either"),
    PredicateInfo("before", "frame", (), frames="either"),
    PredicateInfo("after", "frame", (), frames="either"),
    PredicateInfo("within", "frame", (), {"frames": "down"}, frames="either"),
    PredicateInfo("and", "1", (), frames="inner"),
    PredicateInfo("or", "1", (), frames="inner"),
    PredicateInfo("not", "1", (), frames="inner"),
)
PREDICATES: Mapping[str, PredicateInfo] = {info.kind: info for info in _KINDS}


def _children(predicate: SpecModel) -> list[SpecModel]:
    found: list[SpecModel] = []
    for name in type(predicate).model_fields:
        value = getattr(predicate, name)
        for item in value if isinstance(value, list) else [value]:
            if isinstance(item, SpecModel):
                found.append(item)
    return found


def atoms_of(predicate: SpecModel) -> list[SpecModel]:
    """The predicates that it is made of and that hold no others; itself where it holds none."""
    inner = _children(predicate)
    return [a for child in inner for a in atoms_of(child)] if inner else [predicate]


def entities_of(predicate: SpecModel) -> tuple[str, ...]:
    """Entity ids a predicate speaks of, in order of appearance, without `each`."""
    names: dict[str, None] = {}
    for name, info in type(predicate).model_fields.items():
        value = getattr(predicate, name)
        marks = [*info.metadata, *(m for part in get_args(info.annotation) for m in getattr(part, "__metadata__", ()))]
        if any(isinstance(m, Ref) and m.target == "entity" for m in marks) and isinstance(value, str):
            names[value] = None
        if name == "entities" and isinstance(value, list):
            names.update(dict.fromkeys(str(v) for v in value))
    for child in _children(predicate):
        names.update(dict.fromkeys(entities_of(child)))
    names.pop("each", None)
    return tuple(names)


INVARIANTS = frozenset({"always", "stays_in", "supported", "no_contact", "not", "landscape_water", "landscape_field"})


def is_invariant(predicate: SpecModel) -> bool:
    """Whether the predicate speaks of a state that lasts, not of an event."""
    kind = getattr(predicate, "kind", "")
    if kind == "count":
        return is_invariant(predicate.predicate)  # type: ignore[attr-defined]
    if kind in ("and", "or"):
        return all(is_invariant(p) for p in predicate.of)  # type: ignore[attr-defined]
    return kind in INVARIANTS or getattr(predicate, "when", "") == "always"


def _turned(interval: Interval) -> Interval:
    return {"narrower": "wider", "wider": "narrower"}.get(interval, interval)  # type: ignore[return-value]


def interval_tightens(predicate: Mapping[str, Any]) -> Interval:
    """Which change of the frames of a beat or requirement makes its predicate, as JSON, harder to meet.

    What has to happen is harder in fewer frames, what has to last in more.
    """
    kind, info = str(predicate.get("kind")), PREDICATES.get(str(predicate.get("kind")))
    if info is None:
        return "either"
    if info.frames == "inner":
        if kind == "count" and predicate.get("max") is not None:
            return "either"
        inner = [predicate["predicate"]] if "predicate" in predicate else list(predicate["of"])
        found = {interval_tightens(p) for p in inner}
        one = found.pop() if len(found) == 1 else "either"
        return _turned(one) if kind == "not" else one
    if info.frames == "own":
        mine: Interval = "wider" if kind == "always" else "narrower"
        return mine if predicate.get("frames") is None else "either"
    if info.frames == "when":
        by_when: dict[str, Interval] = {"eventually": "narrower", "always": "wider", "end": "end"}
        return by_when.get(str(predicate.get("when")), "either")
    return info.frames


def describe_predicate(predicate: SpecModel) -> str:
    """One line for the requirements matrix, e.g. `topples(entity=d1, min_angle=0.6)`."""
    shown = []
    for name, value in predicate.model_dump(exclude={"kind"}, exclude_none=True).items():
        raw = getattr(predicate, name)
        if isinstance(raw, SpecModel):
            shown.append(describe_predicate(raw))
        elif isinstance(raw, list) and raw and isinstance(raw[0], SpecModel):
            shown.extend(describe_predicate(item) for item in raw)
        elif isinstance(raw, list) and len(raw) > 4:
            shown.append(f"{name}=[{raw[0]}..{raw[-1]}: {len(raw)}]")
        else:
            shown.append(f"{name}={value}")
    return f"{getattr(predicate, 'kind', '?')}({', '.join(shown)})"
