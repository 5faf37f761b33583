"""Bounds that a specification cannot define away (R91, R154): the agent writes it, so the server asks these by itself.

Bounds of events stand clear of noise. An intended overlap stays smaller than the bodies. What is held is let go.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from ..noise import least_impulse, least_margin, least_travel
from ..predicates.registry import PREDICATES, is_invariant
from ..problems import Problem, replaced
from ..spec import Beat, Fastened, ReleaseDriver, WorldSpec

__all__ = ["bound_problems", "hold_problems", "overlap_problems"]

OVERLAP_SHARE = 0.5
"""Own choice: at least half of the smaller body stays outside (a post may be buried that deep), measured along its longest side."""
MOVING_OVERLAP_SHARE = 0.1
"""Own choice: two bodies that move are joined by glue, pegs or screws, not sunk into each other."""


def bound_problems(spec: WorldSpec) -> list[Problem]:
    """Bounds of beats that noise alone would meet (R154)."""
    found: list[Problem] = []
    for name, beat in spec.story.beats.items():
        found += _small_margins(spec, name, beat)
        if not is_invariant(beat.predicate):
            document = beat.predicate.model_dump(mode="json", exclude_none=True)
            for place, one in _nested(document, f"/story/beats/{name}/predicate"):
                found += [*_always_true(one, place), *_within_noise(spec, one, place, beat.subject)]
    for name, requirement in spec.story.requirements.items():
        document = requirement.predicate.model_dump(mode="json", exclude_none=True)
        for place, one in _nested(document, f"/story/requirements/{name}/predicate"):
            found += _always_true(one, place)
    return found


def _small_margins(spec: WorldSpec, name: str, beat: Beat) -> Iterator[Problem]:
    """Causal margins that noise alone would meet."""
    floor = least_margin(spec, beat)
    for cause, margin in beat.margins.items():
        if floor is not None and margin.value is not None and margin.value < floor.value:
            place = f"/story/beats/{name}/margins/{cause}/value"
            text = f"a causal margin of {margin.value:g} {floor.unit} is within noise; ask for at least {floor.value:g} {floor.unit} ({floor.how})"
            yield Problem(place, text, replaced(place, floor.value))


def _nested(predicate: Mapping[str, Any], place: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """A predicate after those that it holds, with their pointers; none below a `not`."""
    for index, inner in enumerate(predicate.get("of", ())):
        yield from _nested(inner, f"{place}/of/{index}")
    for field in ("predicate", "goal"):
        if isinstance(predicate.get(field), Mapping) and predicate["kind"] != "not":
            yield from _nested(predicate[field], f"{place}/{field}")
    yield place, predicate


def _always_true(predicate: Mapping[str, Any], place: str) -> Iterator[Problem]:
    """Bounds that hold for every value."""
    kind = predicate["kind"]
    if kind == "count":
        low, high, total = predicate.get("min", 0), predicate.get("max"), len(predicate["entities"])
        if low <= 0 and (high is None or high >= total):
            yield Problem(
                place, f"a count of {total} entities with min {low:g} is always true; ask for min >= 1 or a smaller max"
            )
    elif kind == "tilts" and predicate.get("min", 0.0) <= 0.0 and predicate.get("max", 0.0) >= math.pi:
        yield Problem(
            f"{place}/max", f"a tilt of at most {predicate['max']:g} rad is always true, angles end at pi; ask for a smaller max"
        )


def _within_noise(spec: WorldSpec, predicate: Mapping[str, Any], place: str, subject: str) -> Iterator[Problem]:
    """Bounds that noise alone would meet."""
    kind = predicate["kind"]
    if kind == "displacement":
        least, _, how = least_travel(spec, predicate.get("entity", subject))
        for field, sign in (("min", 1.0), ("max", -1.0)):
            value = sign * predicate.get(field, 0.0)
            if 0.0 < value < least:
                text = f"a displacement of {value:g} m is within noise; ask for at least {least:g} m ({how})"
                yield Problem(f"{place}/{field}", text, replaced(f"{place}/{field}", sign * least))
    if kind == "contact":
        floor, value = least_impulse(spec, predicate["a"], predicate["b"]), predicate.get("min_impulse", 0.0)
        if floor is not None and 0.0 < value < floor.value:
            text = f"a contact of {value:g} N s is within noise; ask for at least {floor.value:g} N s ({floor.how}), or for the touch alone"
            yield Problem(f"{place}/min_impulse", text, replaced(f"{place}/min_impulse", floor.value))
    noise = PREDICATES[kind].noise
    for field, value, text in noise.bounds(spec, predicate, subject) if noise is not None else ():
        yield Problem(f"{place}/{field}", text, replaced(f"{place}/{field}", round(value, 9)))
    for field, least in PREDICATES[kind].least.items():
        value = predicate.get(field)
        if value is not None and 0.0 < value < least:
            text = f"{kind} with {field} {value:g} is within noise; ask for at least {least:g}"
            yield Problem(f"{place}/{field}", text, replaced(f"{place}/{field}", least))


def overlap_problems(spec: WorldSpec) -> list[Problem]:
    """Overlaps declared intended that are as large as the bodies themselves (R91, R154)."""
    found = []
    for name, relation in spec.graph.relations.items():
        if not isinstance(relation, Fastened) or not {relation.a, relation.b} <= set(spec.entities):
            continue
        sizes = [(n, spec.entities[n].dimensions.size) for n in (relation.a, relation.b)]
        _, length, small = min((sum(s * s for s in size), max(size), n) for n, size in sizes)
        moving = all(spec.entities[n].motion != "static" for n in (relation.a, relation.b))
        most = (MOVING_OVERLAP_SHARE if moving else OVERLAP_SHARE) * length
        if relation.max_depth > most:
            place = f"/graph/relations/{name}/max_depth"
            found.append(
                Problem(
                    place,
                    f"an intended overlap of {relation.max_depth:g} m is more than {most / length:.0%} of the length {length:g} m of "
                    f"{small!r}; give at most {most:g} m",
                    replaced(place, round(most, 6)),
                )
            )
    return found


def hold_problems(spec: WorldSpec) -> list[Problem]:
    """Holds that never let go within the sequence: they would keep a body in mid-air without a support (R154)."""
    end = (spec.simulation.frames - 1) / spec.simulation.fps
    return [
        Problem(
            f"/simulation/drivers/{name}/time",
            f"driver {name!r} lets go of {driver.entity!r} at {driver.time:g} s, after the last frame at {end:g} s: a hold is no support; "
            "let go within the sequence, or put the body on something, hang it on a joint, or make it static",
        )
        for name, driver in spec.simulation.drivers.items()
        if isinstance(driver, ReleaseDriver) and driver.time >= end
    ]
