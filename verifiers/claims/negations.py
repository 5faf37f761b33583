"""Claims of a negation: what is denied never comes true, and could have (R131, R154).

A negation has no rival, but one of what cannot happen says nothing. What it denies is therefore tried on the forged motion of its kind
(`verifiers/forged`): a plain one, of a body as large as the one that is spoken of. What does not even come true there asks for more than its
words, unless a claim of a quantity quotes the bound. Bodies that cannot move or break are told by the audit. Of matter no motion is forged: a
bound of its own is compared with the measure of a plain event (`verifiers/forged/matter.py`), and one that a plain event does not reach is refused.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.claims import targets_of
from ...worlds.decoys import unspoken
from ...worlds.predicates import And, Count, Not, Or, Until, atoms_of, describe_predicate, entities_of
from ...worlds.predicates.registry import PREDICATES
from ..forged.matter import plain_measures
from ..forged.trial import forged_outcome, is_forged
from ..predicates.combine import substitute
from ..predicates.evaluators import evaluate
from ..rows.corrections import correction
from ..rows.findings import Finding
from .lookalikes import alike
from .mapping import told_of
from .naming import requirements_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...worlds.candidate import Candidate
    from ...worlds.predicate_base import PredicateInfo
    from ...worlds.spec import Requirement, SpecModel, WorldSpec

__all__ = ["negation_of"]


def negation_of(candidate: Candidate, name: str) -> Finding:
    """The finding about a claim of a negation."""
    spec, last = candidate.spec, candidate.spec.simulation.frames - 1
    asked = {r: spec.story.requirements[r] for r in requirements_of(spec, name)}
    outcomes = {r: evaluate(candidate, q.asked, q.frames or (0, last)) for r, q in asked.items()}
    bad = [r for r, o in outcomes.items() if o.status == "fail"]
    unknown = [r for r, o in outcomes.items() if o.status == "unverified"]
    quote = spec.claims[name].quote
    if bad:
        said = f"{quote!r}, but {outcomes[bad[0]].explanation}"
        hint = correction(
            said, "story", "change the motion so that it does not happen", pointers=(f"/story/requirements/{bad[0]}",)
        )
        return Finding("fail", said, float(len(bad)), 0.0, hints=(hint,), frame=outcomes[bad[0]].first_failing_frame)
    vacuous = {r: why for r, q in asked.items() if not _quoted(spec, r) and (why := impossible(candidate, q.predicate))}
    evidence = {"vacuous": vacuous}
    if vacuous:
        first, why = next(iter(vacuous.items()))
        said = f"{quote!r} denies by {first!r} what is more than its words: {why}"
        hint = correction(
            said,
            "story",
            f"leave the bounds of {first!r} to the kind, or quote them by a claim of a quantity",
            pointers=(f"/story/requirements/{first}/predicate",),
        )
        return Finding("fail", said, float(len(vacuous)), 0.0, hints=(hint,), evidence=evidence)
    twin = _by_a_twin(candidate, asked)
    if twin is not None:
        action = "claim the other body by words of its own, let it not happen to that one either, or take it away"
        hint = correction(twin, "story", action, pointers=("/claims",))
        return Finding("fail", f"{quote!r}, but {twin}", 1.0, 0.0, hints=(hint,), evidence=evidence)
    if unknown:
        # A probe that ended where the beats do has not seen all of it: that waits for the bake.
        over = (0, max((asked[r].frames or (0, last))[1] for r in unknown))
        return Finding("unverified", f"{quote!r}: {outcomes[unknown[0]].explanation}", evidence=evidence, frames=over)
    return Finding("pass", f"{quote!r}: {', '.join(asked)} held over frames 0..{last}", 0.0, 0.0, evidence=evidence)


def _by_a_twin(candidate: Candidate, asked: Mapping[str, Requirement]) -> str | None:
    """Words on what is denied of a body and happens to another that looks the same and that no claim speaks of; None where nothing does."""
    spec, last = candidate.spec, candidate.last_frame
    rest = [n for n in unspoken(spec) if n in candidate.solids]
    for requirement in asked.values():
        denied = [n for n in dict.fromkeys(entities_of(requirement.predicate)) if n in candidate.solids]
        for body, other in ((b, o) for b in denied for o in rest if o not in denied and alike(candidate, b, o)):
            first, end = requirement.frames or (0, last)
            outcome = evaluate(candidate, told_of(requirement.predicate, body, other), (first, min(end, last)))
            if outcome.status == "pass":
                return f"{other!r} looks the same as {body!r}, no claim speaks of it, and of it it is true: {outcome.explanation}"
    return None


def _quoted(spec: WorldSpec, requirement: str) -> bool:
    """True where a claim of a quantity quotes a bound of a requirement."""
    place = f"/story/requirements/{requirement}/predicate/"
    told = [n for n, c in spec.claims.items() if c.type == "quantity" and c.waived is None]
    return any(p.startswith(place) for n in told for p in targets_of(spec.claims, n))


def impossible(candidate: Candidate, predicate: SpecModel) -> str | None:
    """Why a predicate cannot come true on forged motions of its kinds; None where it can, or where nothing tells."""
    if isinstance(predicate, Count):
        reasons = [impossible(candidate, substitute(predicate.predicate, n)) for n in predicate.entities]
        able = sum(r is None for r in reasons)
        if able >= max(1.0, predicate.min or 0.0):
            return None
        return next((r for r in reasons if r), f"{predicate.min:g} of {len(predicate.entities)} cannot do it")
    if isinstance(predicate, Or):
        found = [impossible(candidate, member) for member in predicate.of]
        return found[0] if all(found) else None
    if isinstance(predicate, And):
        return next((why for member in predicate.of if (why := impossible(candidate, member))), None)
    if isinstance(predicate, Until):
        return impossible(candidate, predicate.goal)
    if isinstance(predicate, Not):
        return None
    if atoms_of(predicate) != [predicate]:
        return impossible(candidate, predicate.predicate)  # type: ignore[attr-defined]
    return _atom(candidate, predicate)


def _atom(candidate: Candidate, atom: SpecModel) -> str | None:
    info = PREDICATES.get(str(getattr(atom, "kind", "")))
    if info is None:
        return None
    if not is_forged(info.kind):
        return _of_matter(candidate, atom, info)
    outcome = forged_outcome(candidate, atom)
    if outcome.status != "fail":
        return None
    return f"{describe_predicate(atom)} does not come true where it plainly happens: {outcome.explanation}"


def _of_matter(candidate: Candidate, atom: SpecModel, info: PredicateInfo) -> str | None:
    """Why what matter does is asked for beyond a plain event of its kind; None where it is not."""
    plain = plain_measures(candidate, atom)
    for name, easier in info.tightens.items():
        value, default = getattr(atom, name, None), type(atom).model_fields[name].default
        if not value or value == default or (name == "max" and not info.event):
            continue
        if name in plain:
            high = easier == "up"
            if (value > plain[name]) if high else (value < plain[name]):
                most = f"at {'most' if high else 'least'} {plain[name]:.3g}"
                return f"{describe_predicate(atom)} asks for a {name} of {value:g}, and what plainly does so has {most}"
        elif info.event:
            return f"{describe_predicate(atom)} asks for a {name} of its own"
    return None
