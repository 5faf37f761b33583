"""What a specification may not define away (R154-R157): the agent writes it, so the server asks these by itself.

A clause of the prompt that tells an event asks for a beat that can be seen and is not optional; one that tells of a way
asks for a route. Bounds of events stand clear of noise. An intended overlap stays smaller than the bodies. The word lists
are English; a clause in another language asks for no more than a pointer to something that is judged.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from .predicates import entities_of, is_invariant
from .references import kinds_of
from .spec import Beat, Clause, Fastened, WorldSpec

__all__ = ["Problem", "bound_problems", "clause_problems", "event_words", "overlap_problems", "way_words"]

UNMET_SHARE = 0.5
"""Own choice: with more of its clauses given up, a world is not the prompt's any more."""
LEAST_TRAVEL_SHARE = 0.02
"""Own choice: a displacement counts as an event from this share of the entity's diagonal on, within the two limits below."""
LEAST_TRAVEL = (0.001, 0.02)
"""[m]: above what bodies settle into their skins, and no more than one can see on a large body."""
LEAST = {"speed": 0.02, "tilts": 0.02, "topples": 0.2, "joint_angle": 0.005}
"""Least bound of an event per kind of predicate [m/s, rad, rad, rad or m]. Own choice: twice what counts as rest; a lean
one can see; a fall that does not rock back."""
OVERLAP_SHARE = 0.5
"""Own choice: at least half of the smaller body stays outside (a post may be buried that deep), measured along its longest side."""

_MOTION = frozenset({"displacement", "reaches", "crosses", "speed", "separation", "topples", "tilts", "joint_angle", "rests_on"})
_FALL = _MOTION - {"speed"}
_BLOW = _MOTION | {"contact"}
EVENTS: Mapping[str, frozenset[str] | None] = {
    **dict.fromkeys(("collapse", "crumble", "drop", "fall", "tip", "topple", "tumble"), _FALL),
    **dict.fromkeys(("fly", "roll", "slide", "slip", "swing", "throw"), _MOTION),
    **dict.fromkeys(("bounce", "collide", "crash", "hit", "knock", "push", "smash", "strike"), _BLOW),
    **dict.fromkeys(("break", "burst", "explode", "pour", "shatter", "spill", "splash"), None),
}
"""Verbs that tell an event, and the kinds of predicate that can tell it; None: any kind of event."""
_FORMS = {
    "break": "broke|broken", "fall": "fell|fallen", "fly": "flies|flew|flown", "hit": "hits|hit", "slide": "slid", "strike": "struck",
    "swing": "swung", "throw": "threw|thrown", "drop": "dropped", "slip": "slipped", "tip": "tipped",
}  # fmt: skip
_NOUNS = re.compile(
    r"\b(?:a|an|the|some|two|three|several|of|its|his|her|their|no|each|every|playground|rain|water)\s+$", re.IGNORECASE
)
"""What stands before such a word when it is a noun ("a slide", "drops of water")."""
_WAYS = re.compile(r"\b(?:walks?|walkable|walking|route|doorway|corridor|stairs|staircase|passage|passageway)\b", re.IGNORECASE)
_PRONOUN = re.compile(r"\b(?:it|they|them|this|that|these|those|one|everything|something)\b", re.IGNORECASE)
_WORD = re.compile(r"[a-z]{4,}")
_JUDGED = re.compile(r"^/(entities|story/beats|story/requirements|graph/relations|shots)/([^/]+)")


class Problem(NamedTuple):
    """One finding: where, what to do, and the edit that would do it where there is only one."""

    pointer: str
    text: str
    patch: dict[str, Any] | None = None


def _verb(word: str) -> str:
    stem = word[:-1] if word.endswith("e") else word
    plural = f"{word}es" if word.endswith(("s", "sh", "ch")) else f"{word}s"
    return f"{plural}|{stem}ed|{word}|{_FORMS[word]}" if word in _FORMS else f"{plural}|{stem}ed|{word}"


_EVENT = re.compile("|".join(rf"(?P<{w}>\b(?:{_verb(w)})\b)" for w in EVENTS), re.IGNORECASE)


def event_words(text: str) -> dict[str, str]:
    """Words of a clause that tell an event: the verb by the word as it stands there."""
    return {m.group().lower(): str(m.lastgroup) for m in _EVENT.finditer(text) if not _NOUNS.search(text[: m.start()])}


def _names(spec: WorldSpec, beat: Beat) -> set[str]:
    """Words by which the specification calls what a beat is about, singular."""
    entities = [n for n in (beat.subject, *entities_of(beat.predicate)) if n in spec.entities]
    text = " ".join(f"{n} {spec.entities[n].role}" for n in entities).replace("_", " ").replace("-", " ").lower()
    return {_singular(w) for w in _WORD.findall(text)}


def _singular(word: str) -> str:
    for ending in ("oes", "ches", "shes", "xes"):
        if word.endswith(ending):
            return word[:-2]
    return word.removesuffix("s")


def way_words(text: str) -> tuple[str, ...]:
    """Words of a clause that tell of a way to go."""
    return tuple(m.group().lower() for m in _WAYS.finditer(text))


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
    yield from _events(spec, key, text, [spec.story.beats[n] for k, n in named if k == "story/beats" and n in spec.story.beats])
    ways = way_words(text)
    routes = [
        n for kind, n in named if kind == "graph/relations" and getattr(spec.graph.relations.get(n), "kind", "") == "connects"
    ]
    if ways and not routes:
        yield Problem(
            place,
            f"clause {key} {text!r} tells of a way ({', '.join(ways)}): name a `connects` relation in met_by; or say in static_because why "
            "nobody needs to pass (printed with the acceptance)",
        )


def _events(spec: WorldSpec, key: str, text: str, beats: list[Beat]) -> Iterator[Problem]:
    words = event_words(text)
    if not words:
        return
    place, tells = f"/clauses/{key}/met_by", f"clause {key} {text!r} tells an event ({', '.join(words)})"
    escape = "or say in static_because why these words ask for no such beat (printed with the acceptance)"
    good = [b for b in beats if b.mandatory and b.observe and not is_invariant(b.predicate)]
    if not good:
        yield Problem(place, f"{tells}: name a beat in met_by that is mandatory, observed and no lasting state; {escape}")
        return
    for word, verb in words.items():
        kinds = EVENTS[verb]
        if kinds is not None and not any(kinds & set(kinds_of(b.predicate)) for b in good):
            yield Problem(
                place,
                f"{tells}: no beat in met_by can tell {word!r}; give one a predicate of {', '.join(sorted(kinds))}; {escape}",
            )
    own = {_singular(w) for w in _WORD.findall(text.lower())}
    if not _PRONOUN.search(text) and not any(own & _names(spec, b) for b in good):
        called = sorted({b.subject for b in good})
        yield Problem(
            place,
            f"{tells}, but nothing in the clause is called like {', '.join(called)} or what else its beats are about; give these entities "
            f"the role that the prompt names, or name the right beat; {escape}",
        )


# ---------------------------------------------------------------- bounds


def bound_problems(spec: WorldSpec) -> list[Problem]:
    """Bounds of beats that noise alone would meet (R154)."""
    found: list[Problem] = []
    for name, beat in spec.story.beats.items():
        if not is_invariant(beat.predicate):
            found += _bounds(
                spec, beat.predicate.model_dump(mode="json", exclude_none=True), f"/story/beats/{name}/predicate", beat.subject
            )
    for name, requirement in spec.story.requirements.items():
        predicate = requirement.predicate.model_dump(mode="json", exclude_none=True)
        found += [p for p in _bounds(spec, predicate, f"/story/requirements/{name}/predicate", "") if "count" in p.text]
    return found


def _bounds(spec: WorldSpec, predicate: Mapping[str, Any], place: str, subject: str) -> Iterator[Problem]:
    kind = predicate["kind"]
    for index, inner in enumerate(predicate.get("of", ())):
        yield from _bounds(spec, inner, f"{place}/of/{index}", subject)
    for field in ("predicate", "goal"):
        if isinstance(predicate.get(field), Mapping) and kind != "not":
            yield from _bounds(spec, predicate[field], f"{place}/{field}", subject)
    if kind == "count":
        low, high, total = predicate.get("min", 0), predicate.get("max"), len(predicate["entities"])
        if low <= 0 and (high is None or high >= total):
            yield Problem(
                place, f"a count of {total} entities with min {low:g} is always true; ask for min >= 1 or a smaller max"
            )
    elif kind == "displacement":
        least = _least_travel(spec, predicate.get("entity", subject))
        for field, sign in (("min", 1.0), ("max", -1.0)):
            value = sign * predicate.get(field, 0.0)
            if 0.0 < value < least:
                yield Problem(
                    f"{place}/{field}", f"a displacement of {value:g} m is within noise; ask for at least {least:g} m",
                    {"op": "replace", "path": f"{place}/{field}", "value": sign * least},
                )  # fmt: skip
    elif kind in LEAST:
        field = "min_angle" if kind == "topples" else "min"
        value = predicate.get(field)
        if value is not None and 0.0 < value < LEAST[kind]:
            yield Problem(
                f"{place}/{field}", f"{kind} with {field} {value:g} is within noise; ask for at least {LEAST[kind]:g}",
                {"op": "replace", "path": f"{place}/{field}", "value": LEAST[kind]},
            )  # fmt: skip


def _least_travel(spec: WorldSpec, entity: str) -> float:
    sizes = [spec.entities[n].dimensions.size for n in ([entity] if entity in spec.entities else [])]
    diagonal = min((sum(s * s for s in size) ** 0.5 for size in sizes), default=0.0)
    return round(min(max(LEAST_TRAVEL_SHARE * diagonal, LEAST_TRAVEL[0]), LEAST_TRAVEL[1]), 6)


def overlap_problems(spec: WorldSpec) -> list[Problem]:
    """Overlaps declared intended that are as large as the bodies themselves (R91, R154)."""
    found = []
    for name, relation in spec.graph.relations.items():
        if not isinstance(relation, Fastened) or not {relation.a, relation.b} <= set(spec.entities):
            continue
        sizes = [(n, spec.entities[n].dimensions.size) for n in (relation.a, relation.b)]
        _, length, small = min((sum(s * s for s in size), max(size), n) for n, size in sizes)
        most = OVERLAP_SHARE * length
        if relation.max_depth > most:
            place = f"/graph/relations/{name}/max_depth"
            found.append(
                Problem(
                    place,
                    f"an intended overlap of {relation.max_depth:g} m is more than {OVERLAP_SHARE:.0%} of the length {length:g} m of "
                    f"{small!r}; give at most {most:g} m",
                    {"op": "replace", "path": place, "value": round(most, 6)},
                )
            )
    return found
