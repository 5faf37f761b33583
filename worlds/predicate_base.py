"""Parts that the models of predicates share, their metadata, and reading of nested ones."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, get_args

from pydantic import StringConstraints, model_validator

from .vocabulary import Finite, Ref, SpecModel

__all__ = [
    "BAND",
    "POSE",
    "Band",
    "Interval",
    "PredicateInfo",
    "Subject",
    "Tightens",
    "When",
    "atoms_of",
    "describe_predicate",
    "entities_of",
    "predicates_in",
    "some_bound",
]

When = Literal["eventually", "always", "end"]
Subject = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,63}$"), Ref("entity")]
"""An entity id, or `each` inside `count`."""


Bounded = TypeVar("Bounded", bound=SpecModel)


def some_bound(model: Bounded) -> Bounded:
    """A model with a `min`, a `max`, or both in order.

    Raises:
        ValueError: it has neither, or they are the wrong way round.
    """
    low, high = getattr(model, "min", None), getattr(model, "max", None)
    if low is None and high is None:
        raise ValueError("give min, max or both")
    if low is not None and high is not None and low > high:
        raise ValueError("min must be <= max")
    return model


class Band(SpecModel):
    """A measured value that must lie in [min, max]; one of them may be left out."""

    min: Finite | None = None
    max: Finite | None = None
    _ordered = model_validator(mode="after")(some_bound)


Tightens = Literal["up", "down", "none"]
Interval = Literal["narrower", "wider", "end", "either"]
"""Change of its frames that makes a predicate harder to meet; `end`: only the last frame counts; `either`: it cannot be told."""
BAND: Mapping[str, Tightens] = {"min": "up", "max": "down"}
"""Direction in which each bound of a `Band` tightens."""
POSE = ("position", "quaternion")
"""Channels of the poses of bodies."""


class Noise(NamedTuple):
    """Noise of a kind of predicate that depends on the specification."""

    bounds: Callable[[Any, Mapping[str, Any], str], Iterator[tuple[str, float, str]]]
    """Bounds that noise alone would meet, as field, the least that is taken, and why; of a specification, a predicate as JSON and a subject."""
    least: Callable[[Any, str, str], tuple[float, str, str] | None]
    """Least difference that may be asked for, its unit, and the rule in words; of a specification, a kind and an entity."""


@dataclass(frozen=True)
class PredicateInfo:
    """Metadata of one kind of predicate."""

    kind: str
    unit: str
    """Unit of the measured value; `1` for counts and truth values."""
    channels: tuple[str, ...]
    """Cache channels that must be present; a missing one makes the row `unverified`."""
    tightens: Mapping[str, Tightens] = field(default_factory=dict)
    """Per numeric field: the direction in which the requirement becomes harder to meet."""
    frames: Interval | Literal["when", "inner", "own"] = "when"
    """Frames that are harder: `when` as that field says; `inner` as what it holds; `own` it may have frames of its own."""
    bodily: bool = False
    """It asks for the place or the surface of a body."""
    matter: str = ""
    """Its field that names loose matter, which is no such body."""
    lasting: bool = False
    """It speaks of a state that lasts, whatever its fields say."""
    least: Mapping[str, float] = field(default_factory=dict)
    """Per field: the least bound that stands clear of noise. Own choice."""
    noise: Noise | None = None
    """Its noise where that depends on the specification."""
    event: bool = False
    """It says that something happens, by a physical definition: place, level or speed alone do not meet it."""
    adds_up: bool = False
    """Its measure adds up over the interval, as bonds that break or what flows through do."""
    directed: bool = False
    """The event is done by `entity` to `other`, and is another one with the two exchanged."""
    ends: bool = False
    """Its subject is no longer seen once it has come true, so that pictures show it before."""
    gloss: str = ""
    """Definition of an event with its thresholds, in one plain sentence."""
    source: str = ""
    """Source of that definition: paper, standard, handbook, or own choice with its reason."""


def _children(predicate: SpecModel) -> list[SpecModel]:
    found: list[SpecModel] = []
    for name in type(predicate).model_fields:
        value = getattr(predicate, name)
        found += [item for item in (value if isinstance(value, list) else [value]) if isinstance(item, SpecModel)]
    return found


def atoms_of(predicate: SpecModel) -> list[SpecModel]:
    """The predicates that it is made of and that hold no others; itself where it holds none."""
    inner = _children(predicate)
    return [a for child in inner for a in atoms_of(child)] if inner else [predicate]


def predicates_in(predicate: SpecModel) -> list[SpecModel]:
    """The predicate and all that it holds, at any depth."""
    return [predicate, *(p for child in _children(predicate) for p in predicates_in(child))]


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
