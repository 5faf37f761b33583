"""Evaluators of predicates about predicates: counting, quantifying over frames, ordering, logic."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.predicates import (
    After,
    Always,
    And,
    Before,
    Count,
    Eventually,
    Not,
    Or,
    Until,
    Within,
    describe_predicate,
    entities_of,
)
from ...worlds.quoting import listed
from .between import passing
from .outcome import Comparison, Outcome, Truth, Verdict, missing

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...worlds.spec import SpecModel
    from .between import Passing
    from .scope import Scope

__all__ = ["after", "always", "and_", "before", "count", "eventually", "not_", "or_", "substitute", "until", "within"]

SHOWN = 12
"""Entities named in a sentence; the row lists all of them."""


def substitute(predicate: SpecModel, entity: str) -> SpecModel:
    """The predicate with `each` replaced by `entity`, at any depth outside a nested `count`."""
    changes: dict[str, Any] = {}
    for name in type(predicate).model_fields:
        value = getattr(predicate, name)
        if value == "each" and name in {"entity", "a", "b", "on", "other", "target"}:
            changes[name] = entity
        elif isinstance(predicate, Count):
            continue
        elif hasattr(value, "model_fields_set"):
            changes[name] = substitute(value, entity)
        elif isinstance(value, list) and value and hasattr(value[0], "model_fields_set"):
            changes[name] = [substitute(v, entity) for v in value]
    return predicate.model_copy(update=changes)


def _first(truth: Truth, frames: tuple[int, int]) -> int | None:
    at = np.flatnonzero(truth)
    return frames[0] + int(at[0]) if len(at) else None


def count(scope: Scope, p: Count) -> Outcome:
    """Measured: how many satisfy the inner predicate. The first failing entity is the first that does not.

    First true: the frame at which the number reaches `min`; without `min`, the first frame within `max`.
    """
    results = {name: scope.judge(substitute(p.predicate, name)) for name in p.entities}
    passed = [n for n, r in results.items() if r.status == "pass"]
    unknown = [n for n, r in results.items() if r.status == "unverified"]
    failed = [n for n, r in results.items() if r.status == "fail"]
    low = p.min if p.min is not None else -np.inf
    high = p.max if p.max is not None else np.inf
    certain = low <= len(passed) and len(passed) + len(unknown) <= high
    impossible = len(passed) + len(unknown) < low or len(passed) > high
    status: Verdict = "pass" if certain else "fail" if impossible else "unverified"
    below = p.min is not None and (p.max is None or len(passed) - low <= high - len(passed))
    bound, comparison = (float(low), ">=") if below else (float(high), "<=")
    culprits = failed if below else passed
    named = listed(culprits, SHOWN)
    text = f"{len(passed)} of {len(results)} satisfy {describe_predicate(p.predicate)}"
    if status == "fail":
        text += f"; {'not' if below else 'too many:'} {named}"
        if culprits:
            text += f" ({results[culprits[0]].explanation})"
    if unknown:
        text += f"; no evidence for {', '.join(unknown[:SHOWN])} ({results[unknown[0]].explanation})"
    frames_true = sorted(r.first_true_frame for n, r in results.items() if r.first_true_frame is not None and n in passed)
    need = max(1, int(np.ceil(low))) if p.min is not None else 0
    first_true = scope.frames[0] if need == 0 else frames_true[need - 1] if len(frames_true) >= need else None
    truths = [r.truth for r in results.values()]
    number = None if any(t is None for t in truths) else np.sum([t for t in truths if t is not None], axis=0)
    worst = culprits[0] if status == "fail" and culprits else None
    return Outcome(
        status,
        scope.frames,
        "1",
        text,
        value=float(len(passed)),
        bound=bound,
        comparison=comparison,  # type: ignore[arg-type]
        truth=None if number is None else (number >= low) & (number <= high),
        margin=float(min(len(passed) - low, high - len(passed))),
        first_true_frame=first_true,
        first_failing_entity=worst,
        first_failing_frame=results[worst].first_failing_frame
        if worst and below
        else (scope.frames[1] if status == "fail" else None),
        failing=tuple(culprits) if status == "fail" else (),
        details={"satisfied": passed, "unsatisfied": failed, "nearest": dict(results[worst].details) if worst else {}},
    )


def _quantified(scope: Scope, predicate: SpecModel, frames: tuple[int, int] | None, *, every: bool) -> Outcome:
    inner = scope.judge(predicate, frames)
    span = inner.frames
    if inner.status == "unverified":
        return inner
    if inner.truth is None:
        if inner.details.get("non_finite"):
            return inner
        return missing(span, "1", f"{describe_predicate(predicate)} has no truth value per frame, only one over the interval")
    truth = inner.truth
    ok = bool(truth.all() if every else truth.any())
    first = _first(truth, span)
    fails_at = span[0] + int(np.argmin(truth)) if every else span[1]
    share = f"true at {int(truth.sum())} of {len(truth)} frames"
    text = f"{describe_predicate(predicate)} was {share} {span[0]}..{span[1]}"
    if not ok:
        text += f", first false at frame {fails_at}: {inner.explanation}" if every else f": {inner.explanation}"
    # Robustness of the inner series carries over only where the inner verdict used the same quantifier.
    same = inner.margin if inner.margin is not None and (inner.margin >= 0) == ok else None
    return Outcome(
        "pass" if ok else "fail",
        span,
        "1",
        text,
        value=float(truth.mean()),
        bound=1.0 if every else 1.0 / len(truth),
        comparison=">=",
        truth=truth,
        margin=same,
        first_true_frame=first,
        first_failing_entity=None if ok else inner.first_failing_entity or (inner.failing[0] if inner.failing else None),
        first_failing_frame=None if ok else fails_at,
        failing=() if ok else inner.failing,
        details=inner.details,
    )


def always(scope: Scope, p: Always) -> Outcome:
    """Measured: share of frames at which the inner predicate is true."""
    return _quantified(scope, p.predicate, p.frames, every=True)


def eventually(scope: Scope, p: Eventually) -> Outcome:
    """Measured: share of frames at which the inner predicate is true."""
    return _quantified(scope, p.predicate, p.frames, every=False)


def until(scope: Scope, p: Until) -> Outcome:
    """Measured: frames at which `hold` was false before the goal came true."""
    goal, hold = scope.judge(p.goal), scope.judge(p.hold)
    if goal.status == "unverified" or hold.status == "unverified":
        worse = goal if goal.status == "unverified" else hold
        return missing(scope.frames, "1", worse.explanation)
    if goal.first_true_frame is None:
        text = f"the goal never came true: {goal.explanation}"
        return replace(goal, status="fail", explanation=text, first_failing_frame=scope.frames[1], details={**goal.details})
    if hold.truth is None:
        return missing(scope.frames, "1", f"{describe_predicate(p.hold)} has no truth value per frame")
    before = hold.truth[: goal.first_true_frame - scope.frames[0]]
    broken = int((~before).sum())
    frame = scope.frames[0] + int(np.argmin(before)) if broken else None
    text = (
        f"the goal came true at frame {goal.first_true_frame}; {describe_predicate(p.hold)} was false at {broken} frames before"
    )
    return Outcome(
        "fail" if broken else "pass",
        scope.frames,
        "1",
        text + (f", first at frame {frame}: {hold.explanation}" if broken else ""),
        value=float(broken),
        bound=0.0,
        comparison="<=",
        margin=float(-broken) if broken else float(len(before)),
        first_true_frame=None if broken else goal.first_true_frame,
        first_failing_entity=hold.first_failing_entity if broken else None,
        first_failing_frame=frame,
        failing=hold.failing if broken else (),
        details=hold.details if broken else goal.details,
    )


def _ordered(scope: Scope, inner: SpecModel, beat: str, *, relation: str, most: int | None = None) -> Outcome:
    mine, other = scope.judge(inner), scope.beats.outcome(beat)
    if mine.status == "unverified" or other.status == "unverified":
        return missing(scope.frames, "frame", (mine if mine.status == "unverified" else other).explanation)
    if mine.status == "fail":
        return mine
    if other.first_true_frame is None or mine.first_true_frame is None:
        text = f"beat {beat} never came true, so nothing can come {relation} it: {other.explanation}"
        entity = other.first_failing_entity or mine.first_failing_entity
        return Outcome(
            "fail", scope.frames, "frame", text, first_failing_entity=entity, first_failing_frame=other.first_failing_frame
        )
    gap = mine.first_true_frame - other.first_true_frame
    bound, comparison, margin = _order_bound(relation, gap, most)
    ok = margin >= 0
    text = (
        f"first true at frame {mine.first_true_frame}, beat {beat} at frame {other.first_true_frame}: "
        f"{abs(gap)} frames {'after' if gap > 0 else 'before' if gap < 0 else 'apart'}"
    )
    subjects = scope.candidate.spec.story.beats[beat].subject
    return Outcome(
        "pass" if ok else "fail",
        scope.frames,
        "frame",
        text,
        value=float(gap),
        bound=bound,
        comparison=comparison,
        truth=mine.truth if ok else None,
        margin=float(margin),
        first_true_frame=mine.first_true_frame if ok else None,
        first_failing_entity=None if ok else subjects,
        first_failing_frame=None if ok else mine.first_true_frame,
        details={"gap_frames": gap, "order": relation},
    )


def _order_bound(relation: str, gap: int, most: int | None) -> tuple[float, Comparison, int]:
    if relation == "before":
        return -1.0, "<=", -1 - gap
    if most is None:
        return 1.0, ">=", gap - 1
    return (0.0, ">=", gap) if gap < 0 else (float(most), "<=", most - gap)


def before(scope: Scope, p: Before) -> Outcome:
    """Measured: frames from the other beat's first true frame to this one's; must be negative."""
    return _ordered(scope, p.predicate, p.beat, relation="before")


def after(scope: Scope, p: After) -> Outcome:
    """Measured: frames from the other beat's first true frame to this one's; must be positive."""
    return _ordered(scope, p.predicate, p.beat, relation="after")


def within(scope: Scope, p: Within) -> Outcome:
    """Measured: frames from the other beat's first true frame to this one's; 0 to `frames`."""
    return _ordered(scope, p.predicate, p.beat, relation="after", most=p.frames)


def _worst(outcomes: Sequence[Outcome]) -> Outcome:
    return min(
        outcomes, key=lambda o: (o.status != "fail", o.status != "unverified", o.margin if o.margin is not None else np.inf)
    )


def _joined(outcomes: Sequence[Outcome], *, every: bool) -> Truth | None:
    truths = [o.truth for o in outcomes]
    if any(t is None for t in truths) or len({len(t) for t in truths if t is not None}) != 1:
        return None
    stacked = np.array(truths, dtype=bool)
    joined: Truth = np.asarray(stacked.all(axis=0) if every else stacked.any(axis=0))
    return joined


def and_(scope: Scope, p: And) -> Outcome:
    """Every member's own verdict must hold; measured is the worst member's value.

    First true: when the last member has come true.
    """
    outcomes = [scope.judge(q) for q in p.of]
    worst = _worst(outcomes)
    text = worst.explanation if worst.status != "pass" else "; ".join(o.explanation for o in outcomes)
    firsts = [o.first_true_frame for o in outcomes]
    latest = max(f for f in firsts if f is not None) if all(f is not None for f in firsts) else None
    failing = tuple(dict.fromkeys(e for o in outcomes for e in o.failing))
    truth, details = _joined(outcomes, every=True), worst.details
    if worst.status == "fail":
        asks = next(str(getattr(q, "kind", "")) for q, o in zip(p.of, outcomes, strict=True) if o is worst)
        details = {"asks": asks, **details}
    return replace(
        worst, explanation=text, truth=truth, first_true_frame=latest, failing=failing, frames=scope.frames, details=details
    )


def or_(scope: Scope, p: Or) -> Outcome:
    """One member's verdict must hold; measured is the best member's value."""
    outcomes = [scope.judge(q) for q in p.of]
    passing = [o for o in outcomes if o.status == "pass"]
    unknown = [o for o in outcomes if o.status == "unverified"]
    truth = _joined(outcomes, every=False)
    if passing:
        firsts = [o.first_true_frame for o in passing if o.first_true_frame is not None]
        best = max(passing, key=lambda o: o.margin if o.margin is not None else 0.0)
        return replace(best, truth=truth, first_true_frame=min(firsts, default=None), frames=scope.frames)
    if unknown:
        return missing(scope.frames, unknown[0].unit, unknown[0].explanation)
    nearest = max(outcomes, key=lambda o: o.margin if o.margin is not None else -np.inf)
    text = "none holds: " + "; ".join(o.explanation for o in outcomes)
    return replace(nearest, explanation=text, truth=truth, first_true_frame=None, frames=scope.frames)


def _as_passed(inner: Outcome, passed: Passing) -> Outcome:
    """The outcome of a predicate that held between two frames, as if at the second one."""
    truth = None if inner.truth is None else inner.truth.copy()
    if truth is not None and inner.frames[0] <= passed.frame <= inner.frames[1]:
        truth[passed.frame - inner.frames[0]] = True
    return replace(
        inner,
        status="pass",
        explanation=passed.told,
        truth=truth,
        margin=None if inner.margin is None else abs(inner.margin),
        value=None,
        bound=None,
        comparison="",
        first_true_frame=passed.frame,
        details={**inner.details, "between_frames": passed.frame},
    )


def not_(scope: Scope, p: Not) -> Outcome:
    """The negated verdict over the interval, between its frames too; measured is the inner value.

    Not-a-number and missing evidence are not negated.
    """
    inner = scope.judge(p.predicate)
    if inner.status == "unverified" or inner.details.get("non_finite"):
        return inner
    passed = passing(scope, p.predicate) if inner.status == "fail" else None
    if passed is not None and not passed.sure:
        said = f"between frames: {passed.told}, which the frames do not resolve; raise simulation.fps"
        return replace(missing(scope.frames, inner.unit, said), details={**inner.details, "between_frames": passed.frame})
    if passed is not None:
        inner = _as_passed(inner, passed)
    ok = inner.status == "fail"
    truth = None if inner.truth is None else ~inner.truth
    flipped: dict[str, Comparison] = {">=": "<=", "<=": ">="}
    return Outcome(
        "pass" if ok else "fail",
        scope.frames,
        inner.unit,
        f"{describe_predicate(p.predicate)} {'does not hold' if ok else 'holds'}: {inner.explanation}",
        value=inner.value,
        bound=inner.bound,
        comparison=flipped.get(inner.comparison, inner.comparison),
        truth=truth,
        margin=None if inner.margin is None else -inner.margin,
        first_true_frame=_first(truth, inner.frames) if truth is not None else scope.frames[0] if ok else None,
        first_failing_entity=None if ok else (inner.first_failing_entity or next(iter(entities_of(p.predicate)), None)),
        first_failing_frame=None if ok else inner.first_true_frame,
        details=inner.details,
    )
