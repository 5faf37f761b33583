"""Requirements that a specification cannot define away (R154-R157): the agent writes it, so the server asks these by itself.

A clause of the prompt that tells an event asks for a beat that can be seen and is not optional; one that tells of a way
asks for a route. Bounds of events stand clear of noise. An intended overlap stays smaller than the bodies. The word lists
are English; a clause in another language asks for no more than a pointer to something that is judged.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from ..categories.registry import CATEGORIES
from ..drivers import behind
from ..noise import least_impulse, least_margin, least_travel
from ..predicates import atoms_of, entities_of
from ..predicates.registry import PREDICATES, is_invariant
from ..problems import Problem, replaced
from ..references import kinds_of
from ..spec import Beat, Clause, Connects, Fastened, ReleaseDriver, WorldSpec
from ..walkers import carrier_words, easier_than_a_person
from .scenery_words import missing_scenery
from .wording import (
    event_words,
    goals_in,
    has_pronoun,
    lasting_words,
    names_in,
    numbers_in,
    objects_in,
    piece_words,
    telling,
    walks,
    way_words,
)

__all__ = ["bound_problems", "clause_problems", "hold_problems", "overlap_problems"]

UNMET_SHARE = 0.5
"""Own choice: with more of its clauses given up, a world is not the prompt's any more."""
OVERLAP_SHARE = 0.5
"""Own choice: at least half of the smaller body stays outside (a post may be buried that deep), measured along its longest side."""

ESCAPE = "or say in static_because why these words ask for no such thing (printed with the acceptance)"
"""Way out where a word means something else."""
_JUDGED = re.compile(r"^/(entities|terrains|story/beats|story/requirements|graph/relations|shots)/([^/]+)")

MOVING_OVERLAP_SHARE = 0.1
"""Own choice: two bodies that move are joined by glue, pegs or screws, not sunk into each other."""


def _names(spec: WorldSpec, beat: Beat) -> set[str]:
    """Words by which the specification calls what a beat is about, singular."""
    entities = [n for n in (beat.subject, *entities_of(beat.predicate)) if n in spec.entities]
    return {w for n in entities for w in names_in(f"{n} {spec.entities[n].role}")}


def _called(spec: WorldSpec, word: str, *, moving: bool) -> list[str]:
    """Entities whose id or role has the word."""
    return [n for n, e in spec.entities.items() if (not moving or e.motion != "static") and word in names_in(f"{n} {e.role}")]


def clause_problems(spec: WorldSpec, clauses: Mapping[str, str]) -> list[Problem]:
    """Clauses that are met by nothing that is judged, or by less than their words ask for (R155).

    Args:
        spec: the specification.
        clauses: text of every clause of its prompt, by id.
    """
    found: list[Problem] = []
    for key, text in clauses.items():
        clause = spec.clauses.get(key)
        if clause is not None and clause.met_by and not clause.unmet:
            found += _clause(spec, key, text, clause)
    given_up = [k for k in clauses if k in spec.clauses and spec.clauses[k].unmet]
    if len(given_up) > UNMET_SHARE * len(clauses):
        text = f"{len(given_up)} of {len(clauses)} clauses are given up, at most {UNMET_SHARE:.0%} may be; meet more of {given_up[:6]}"
        found.append(Problem("/clauses", text))
    return found


def _clause(spec: WorldSpec, key: str, text: str, clause: Clause) -> Iterator[Problem]:
    named = [m.groups() for p in clause.met_by if (m := _JUDGED.match(p))]
    place = f"/clauses/{key}/met_by"
    if not named:
        yield Problem(
            place, f"clause {key} {text!r} is met by nothing that is judged; add an entity, beat, requirement, relation or shot"
        )
    optional = [n for kind, n in named if kind == "story/beats" and n in spec.story.beats and not spec.story.beats[n].mandatory]
    if optional and len(optional) == len(named):
        yield Problem(place, f"clause {key} {text!r} is met by optional beats only ({', '.join(optional)}); make one mandatory")
    if clause.static_because:
        return
    yield from _numbers(spec, key, text)
    for word, _, what in missing_scenery(spec, text):
        yield Problem(
            place,
            f"clause {key} {text!r} names {word!r} and nothing is it: declare {what}, or a static entity called so; {ESCAPE}",
        )
    for category in CATEGORIES.values():
        for word, what in category.missing(spec, text, clause.met_by):
            yield Problem(
                place, f"clause {key} {text!r} tells of {category.noun} ({word}) that nothing simulates: {what}; {ESCAPE}"
            )
    beats = {n: spec.story.beats[n] for k, n in named if k == "story/beats" and n in spec.story.beats}
    yield from _events(spec, key, text, beats)
    lasts = lasting_words(text)
    kept = [
        n
        for kind, n in named
        if kind == "story/requirements" and n in spec.story.requirements and spec.story.requirements[n].mandatory
    ]
    if lasts and not kept and not any(b.mandatory and is_invariant(b.predicate) for b in beats.values()):
        yield Problem(
            place,
            f"clause {key} {text!r} tells of what lasts ({', '.join(lasts)}): name a mandatory requirement in met_by, or a beat whose predicate "
            f"holds always; {ESCAPE}",
        )
    yield from _ways(spec, place, f"clause {key} {text!r}", text, [n for kind, n in named if kind == "graph/relations"])


def _ways(spec: WorldSpec, place: str, clause: str, text: str, named: list[str]) -> Iterator[Problem]:
    """Whether a way that the clause tells of is a declared route, and one for people where people walk."""
    ways = way_words(text)
    routes = {n: r for n in named if isinstance(r := spec.graph.relations.get(n), Connects)}
    if not ways:
        return
    if not routes:
        yield Problem(place, f"{clause} tells of a way ({', '.join(ways)}): name a `connects` relation in met_by; {ESCAPE}")
    elif walks(text) and not any(r.carrier == "walker" and not easier_than_a_person(r) for r in routes.values()):
        told = "; ".join(f"{n} is for {carrier_words(r)}" for n, r in list(routes.items())[:3])
        yield Problem(
            place,
            f"{clause} tells of people who walk ({', '.join(ways)}): name a `connects` relation for a walker in met_by; {told}; {ESCAPE}",
        )


def _events(spec: WorldSpec, key: str, text: str, beats: Mapping[str, Beat]) -> Iterator[Problem]:
    words = event_words(text)
    if not words:
        return
    place, tells = f"/clauses/{key}/met_by", f"clause {key} {text!r} tells an event ({', '.join(words)})"
    good = {n: b for n, b in beats.items() if b.mandatory and b.observe and not is_invariant(b.predicate)}
    if not good:
        yield Problem(place, f"{tells}: name a beat in met_by that is mandatory, observed and no lasting state; {ESCAPE}")
        return
    for word, verb in words.items():
        kinds = telling(verb)
        if kinds is not None and not any(kinds & set(kinds_of(b.predicate)) for b in good.values()):
            yield Problem(
                place,
                f"{tells}: no beat in met_by can tell {word!r}; give one a predicate of {', '.join(sorted(kinds))}; {ESCAPE}",
            )
    yield from _pieces(place, tells, text, good)
    yield from _goals(spec, place, tells, text, good)
    yield from _actors(spec, place, tells, text, good)


def _pieces(place: str, tells: str, text: str, good: Mapping[str, Beat]) -> Iterator[Problem]:
    """Whether what goes to pieces has to do more than crack."""
    words = piece_words(text)
    asked = [a for b in good.values() for a in atoms_of(b.predicate)]
    least = {info.kind: info.pieces for info in PREDICATES.values() if info.pieces is not None}
    least = dict(sorted(least.items(), key=lambda item: -item[1]))
    enough = any((getattr(a, "min", None) or 0.0) >= least.get(str(getattr(a, "kind", "")), math.inf) for a in asked)
    if words and not enough:
        bounded = " or ".join(f"{kind} with min {value:g} or more" for kind, value in least.items() if value > 0.0)
        free = " or ".join(f"a {kind}" for kind, value in least.items() if value == 0.0)
        yield Problem(place, f"{tells} of something in pieces ({', '.join(words)}): ask {bounded}, or {free}; {ESCAPE}")


def _goals(spec: WorldSpec, place: str, tells: str, text: str, good: Mapping[str, Beat]) -> Iterator[Problem]:
    """Whether a beat says that the event leads where the clause says it does."""
    atoms = [a for b in good.values() for a in atoms_of(b.predicate)]
    if any(getattr(a, "region", None) is not None or PREDICATES[str(getattr(a, "kind", ""))].placed for a in atoms):
        return
    known = {w for b in good.values() for w in _names(spec, b)}
    for words in goals_in(text):
        alike = {n for w in words for n in _called(spec, w, moving=False)}
        if alike and not known & set(words):
            yield Problem(
                place,
                f"{tells} that leads to {' '.join(words)!r}, but no beat in met_by says that it gets there: give one a predicate about "
                f"{', '.join(sorted(alike)[:3])} (contact, rests_on, submerged_fraction, liquid_arrives) or a region there; {ESCAPE}",
            )


def _actors(spec: WorldSpec, place: str, tells: str, text: str, good: Mapping[str, Beat]) -> Iterator[Problem]:
    """Whether the beats are about what the clause names; what is acted on takes part and moves for a reason."""
    # What brings a beat about takes part in it.
    beats = spec.story.beats
    known = {w for n, b in good.items() for c in (n, *b.causes) if c in beats for w in _names(spec, beats[c])}
    if not has_pronoun(text) and not known & set(names_in(text)):
        called = sorted({b.subject for b in good.values()})
        yield Problem(
            place,
            f"{tells}, but nothing in the clause is called like {', '.join(called)} or what else its beats are about; give these entities "
            f"the role that the prompt names, or name the right beat; {ESCAPE}",
        )
        return
    for word in objects_in(text):
        alike = _called(spec, word, moving=True)
        if alike and word not in known:
            yield Problem(place, f"{tells}, but no beat in met_by is about {word!r} ({', '.join(alike[:3])}); name one; {ESCAPE}")
        mine = {n: b for n, b in good.items() if b.subject in alike}
        for name, beat in mine.items():
            # Of several that are called so the one may act and the other be acted on.
            acts = any(beat.subject != b.subject and name in behind(spec, n) for n, b in mine.items())
            if not beat.causes and not acts:
                yield Problem(
                    place,
                    f"{tells} that something does to {word!r}, but beat {name!r} names no causes; say what brings it about; {ESCAPE}",
                )


def _numbers(spec: WorldSpec, key: str, text: str) -> Iterator[Problem]:
    """Numbers of things in the clause against the entities, or parts of one entity, that are called so."""
    for number, words in numbers_in(text):
        for word in words:
            alike = _called(spec, word, moving=False)
            if not alike:
                continue
            have = max(len(alike), *(len(spec.entities[n].parts) for n in alike))
            if have < number:
                yield Problem(
                    f"/clauses/{key}/met_by",
                    f"clause {key} {text!r} asks for {number} {word!r}, the specification has {len(alike)} ({', '.join(alike[:4])}); {ESCAPE}",
                )
            break


# ---------------------------------------------------------------- bounds


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
