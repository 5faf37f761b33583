"""Claims of the prompt against the motion and the pictures (R2, R131, R154, R155).

- `claim:thing:<claim>`: what a span names is in a picture: the least shown of its entities and lands fills `limits.visible_pixels` of one.
- `claim:count:<claim>`: exactly so many separate bodies are there, and do what is told of them (`counts.py`).
- `claim:quantity:<claim>`: what is measured is the number of its words, and neither half nor twice of it (`quantities.py`).
- `claim:event:<claim>`: its beats come true, no rival reading of its words does (`rivals.py`), and what its words say is crossed is (`crossings.py`).
- `claim:order:<claim>`: what it says comes first does, and neither the reverse nor simultaneity is true (`order.py`).
- `claim:negation:<claim>`: its requirements, negated by the server, hold over all frames, and what they deny could happen (`negations.py`).

Claims that describe have rows in modules of their own (`described/`). Claims of other types are judged by the audit; what no rule judges and
nothing measures is printed as the agent's reading, and so are waived ones.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ...worlds.claims import named_in
from ...worlds.predicates import describe_predicate
from ..predicates.evaluators import beat_times, evaluate
from ..predicates.times import last_needed
from ..rows.answers import row_of
from ..rows.corrections import correction
from ..rows.findings import Finding
from ..shots.plan import shots_at
from ..shots.sight import sight_of
from . import counts, quantities, unseen_help
from .bounds import LOOKS
from .counts import count_of
from .crossings import uncrossed
from .described.check import check as described
from .described.lands import lands_of, share_of_pictures
from .naming import beats_of, requirements_of
from .negations import negation_of
from .order import order_of
from .quantities import quantity_of
from .questions import COUNT, EVENT, NEGATION, ORDER, QUANTITY, THING
from .rivals import rivals_of

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ..shots.sight import Sight

__all__ = ["check"]


def check(candidate: Candidate) -> list[Row]:
    """One row per claim that the motion or the pictures judge."""
    rows = []
    for name, claim in candidate.spec.claims.items():
        judge = _JUDGES.get(claim.type)
        measured = _MEASURED.get(claim.type)
        if judge is None or claim.waived is not None or (measured is not None and not measured(candidate.spec, name)):
            continue
        question, function = judge
        extra = [claim.model_dump(mode="json"), _told(candidate, name)]
        finding = partial(function, candidate, name)
        whole = candidate.spec.entities if claim.type in _WHOLE else None
        rows.append(row_of(candidate, question, (name,), finding, extra=extra, recipe_entities=whole))
    return [*rows, *described(candidate), *unseen_help.check(candidate)]


def _told(candidate: Candidate, name: str) -> list[object]:
    """Beats and requirements that a claim names, as JSON: the verdict depends on them; of some types on all, and on all claims."""
    story = candidate.spec.story
    if candidate.spec.claims[name].type in _WHOLE:
        return [story.model_dump(mode="json"), {n: c.model_dump(mode="json") for n, c in candidate.spec.claims.items()}]
    found = [story.beats[b].model_dump(mode="json") for b in beats_of(candidate.spec, name)]
    return [*found, *(story.requirements[r].model_dump(mode="json") for r in requirements_of(candidate.spec, name))]


# ---------------------------------------------------------------- things


def _thing(candidate: Candidate, name: str) -> Finding:
    spec, least = candidate.spec, candidate.spec.simulation.limits.visible_pixels
    entities = [n for n in named_in(spec, name, "entities") if n in spec.entities]
    sight = sight_of(candidate)
    shown = {entity: _most(candidate, sight, entity, least) for entity in entities}
    shown |= {pointer: share_of_pictures(candidate, pointer, least).share for pointer in lands_of(spec, name)}
    worst = min(shown, key=lambda n: shown[n])
    quote = spec.claims[name].quote
    if shown[worst] >= least:
        return Finding(
            "pass",
            f"{quote!r} is in a picture: {worst!r} fills {shown[worst]:.2%}",
            shown[worst],
            least,
            entities=tuple(entities),
        )
    said = f"{worst!r} of {quote!r} fills at most {shown[worst]:.3%} of any picture"
    hint = correction(
        said, "shots", f"let a shot show {worst!r}: add it to the shot's subjects and aim the camera at it", pointers=("/shots",)
    )
    return Finding(
        "fail", said, shown[worst], least, entity=worst if worst in entities else None, hints=(hint,), entities=tuple(entities)
    )


def _most(candidate: Candidate, sight: Sight, entity: str, enough: float) -> float:
    """Largest share of a picture that an entity fills, over some frames of every shot; no more is looked for once it is enough."""
    best = 0.0
    for name, shot in candidate.spec.shots.items():
        first, last = shot.frames[0], min(shot.frames[1], candidate.last_frame)
        frames = sorted({round(first + (last - first) * k / (LOOKS - 1)) for k in range(LOOKS)}) if last >= first else []
        for frame in frames:
            if name in shots_at(candidate, frame):
                best = max(best, sight.seen(entity, name, frame).share)
            if best >= enough:
                return best
    return best


# ---------------------------------------------------------------- events


def _event(candidate: Candidate, name: str) -> Finding:
    claim, times = candidate.spec.claims[name], beat_times(candidate)
    beats = beats_of(candidate.spec, name)
    outcomes = {b: times.outcome(b) for b in beats}
    missed = [b for b, o in outcomes.items() if o.status == "fail"]
    unknown = [b for b, o in outcomes.items() if o.status == "unverified"]
    rivals = [] if missed or unknown else [r for b in beats for r in rivals_of(candidate, b)]
    judged = [(r, evaluate(candidate, r.predicate, r.frames)) for r in rivals]
    true = [r for r, o in judged if o.status == "pass"]
    open_ = {r.text: o.explanation for r, o in judged if o.status == "unverified"}
    evidence = {
        "quote": claim.quote,
        "beats": {b: o.first_true_frame for b, o in outcomes.items()},
        "rivals": [r.text for r in rivals],
        "true_rivals": [r.text for r in true],
        "undecided_rivals": open_,
    }
    if unknown:
        return Finding(
            "unverified",
            f"whether {unknown[0]} comes true is not known: {outcomes[unknown[0]].explanation}",
            evidence=evidence,
            frames=(0, last_needed(candidate.spec, beats)),
        )
    crossed = None if missed or true else uncrossed(candidate, name, beats)
    bad = len(missed) + len(true) + (crossed is not None)
    if missed:
        said = f"{claim.quote!r} is judged by {missed[0]}, which does not come true: {outcomes[missed[0]].explanation}"
        hint = correction(said, "story", f"mend beat {missed[0]!r}: see its own row", pointers=(f"/story/beats/{missed[0]}",))
    elif true:
        said = f"{claim.quote!r} does not tell this motion from another: {true[0].text} is true as well"
        action = f"give {true[0].beat!r} a predicate that {true[0].text} does not meet, or mend the motion"
        if "roles swapped" in true[0].text:
            action += "; where the two do it to each other, as in a collision, ask `contact`, which has no roles"
        hint = correction(said, "story", action, pointers=(f"/story/beats/{true[0].beat}/predicate",))
    elif crossed is not None:
        said = f"{claim.quote!r}: {crossed}"
        action = "let it go from one side of what the words name to the other, over it, or mark as a thing right behind the verb what it crosses"
        hint = correction(said, "story", action, pointers=(f"/claims/{name}/by",))
    else:
        asked = ", ".join(describe_predicate(candidate.spec.story.beats[b].predicate) for b in beats[:3])
        told = f"{claim.quote!r}: {asked} came true, and none of {len(rivals) - len(open_)} rivals"
        told += f"; nobody can tell of {', '.join(open_)}" if open_ else ""
        return Finding("pass", told, 0.0, 0.0, evidence=evidence)
    return Finding("fail", said, float(bad), 0.0, hints=(hint,), evidence=evidence)


_JUDGES = {
    "thing": (THING, _thing),
    "count": (COUNT, count_of),
    "quantity": (QUANTITY, quantity_of),
    "event": (EVENT, _event),
    "order": (ORDER, order_of),
    "negation": (NEGATION, negation_of),
}
_MEASURED = {"count": counts.is_measured, "quantity": quantities.is_measured}
"""By type, whether something measured tells of a claim; of the other types all have a row."""
_WHOLE = frozenset({"count", "negation", "order", "quantity"})
"""Types whose rows look at what else is claimed and told."""
