"""Rows that do not pass cite the diagnosis tables of the skills (R69-R75): ranked causes, one group, patch, cheapest probe.

Rows in, rows out: no status and no number changes. `diagnose` ranks by what the row measured, `cite` adds what past
edits of the same world did to the row, given as data.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ...worlds.directions import field_of
from ...worlds.requirements import Attempt, Correction, Outcome, Row
from ..rows.corrections import owning_up
from .names import names_of
from .table import Cause, Condition, Entry, PatchRule, entries

if TYPE_CHECKING:
    from ...worlds.spec import WorldSpec

__all__ = ["MIN_EFFECT", "cite", "diagnose"]

MIN_EFFECT = 0.1
"""Share by which an edit must bring a row closer to its bound to count as having an effect. Own choice: below a tenth,
more of the same takes over ten edits."""
NEAREST = 2.5e-3
"""Least gap [m] that a suggested move leaves: two skins of 1.2 mm, the largest that the audit lets pass by default."""
CHAINED = ("beat", "causal", "robustness")
"""Checks whose rows hang on a chain of bodies: an edit of any of them is about the row."""
CITED = 3
"""Most past edits told per cause."""
AGAINST = "against it: "
"""Begins the evidence that speaks against a cause: such a one carries no patch of the table."""
EASIER_GROUPS = ("story", "limits")
SUPPORTED, OPEN, CONTRADICTED = 0, 1, 3
"""Ranks by evidence; an edit that makes the specification easier goes one further down."""
_COMPARE: Mapping[str, Callable[[Any, Any], bool]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}


def diagnose(row: Row, spec: WorldSpec | None = None) -> Row:
    """A row that does not pass, with ranked causes and the cheapest probe of its entry; others unchanged.

    Args:
        row: as its check wrote it.
        spec: what it judged; with it patches are computed for causes whose numbers determine one.
    """
    found = _entry(row)
    if found is None:
        return row
    source, entry = found
    cited = f"{source}#{entry.id}"
    names = names_of(row, spec)
    ruled = spec is not None and row.status == "fail" and any(c.patch for c in entry.causes)
    document = spec.model_dump(mode="json", exclude_none=True) if spec is not None and ruled else None
    ranked: list[tuple[int, Correction]] = []
    for measured in row.corrections:
        cause = _same(entry, measured.group, row, names)
        rank, because = _rank(row, cause, measured.group)
        ranked.append((rank, _joined(measured, cause, row, names, spec, document, cited, because)))
    known = {c.group for c in row.corrections}
    for cause in entry.causes:
        if cause.group not in known and set(cause.needs) <= set(names) and _settable(cause, names, spec):
            rank, because = _rank(row, cause, cause.group)
            ranked.append((rank, _joined(None, cause, row, names, spec, document, cited, because)))
    ranked.sort(key=lambda item: item[0])  # stable: what the check measured stays before what the table adds
    corrections = tuple(owning_up(c, spec) if spec is not None and _of_nature(c) else c for _, c in ranked)
    # The rule of repair goes by what the check itself measured; the table only adds ideas.
    classes = sorted({c.edit_class for c in row.corrections})
    told: dict[str, Any] = {
        "symptom": entry.symptom,
        "cheapest_probe": [_filled(p.model_dump(), names) for p in entry.cheapest_probe],
    }
    if corrections and row.status == "fail":
        told = {"change": corrections[0].group, **told}
    evidence = {**row.evidence, **({"edit_classes": classes} if classes else {}), "diagnosis": told}
    return row.model_copy(update={"corrections": corrections, "evidence": evidence})


def cite(row: Row, attempts: Sequence[Attempt]) -> Row:
    """A row that does not pass, with what past edits did to it: causes tried without effect go last, and say so.

    Args:
        row: diagnosed.
        attempts: past edits while this row failed, newest first.
    """
    if row.status not in ("fail", "unverified"):
        return row
    told = [a for a in attempts if a.test is not None and _concerns(row, a)]
    if not told:
        return row
    fresh: list[Correction] = []
    spent: list[Correction] = []
    for correction in row.corrections:
        own = [a for a in told if a.group == correction.group and _touches(correction, a)]
        text = "; ".join(_attempt_text(a) for a in own[:CITED])
        useless = bool(own) and _effect(own[0]) in ("without effect", "made it worse")
        (spent if useless else fresh).append(correction.model_copy(update={"tried": text}))
    corrections = (*fresh, *spent)
    diagnosis = {**row.evidence.get("diagnosis", {}), "tried": [_attempt_text(a) for a in told[: 2 * CITED]]}
    if fresh and "change" in diagnosis:
        diagnosis["change"] = fresh[0].group
    if row.corrections and not fresh:
        diagnosis["note"] = "every listed cause was tried without effect: question the hypothesis, look at the evidence again"
    return row.model_copy(update={"corrections": corrections, "evidence": {**row.evidence, "diagnosis": diagnosis}})


# ---------------------------------------------------------------- entries and ranks


def _entry(row: Row) -> tuple[str, Entry] | None:
    for source, pattern, entry in entries():
        if row.status in entry.statuses and pattern.match(row.id) and all(_holds(row, c) is True for c in entry.when):
            return source, entry
    return None


def _same(entry: Entry, group: str, row: Row, names: Mapping[str, Any]) -> Cause | None:
    """The cause of the table that speaks of a group: the one that the evidence supports best."""
    own = [c for c in entry.causes if c.group == group and set(c.needs) <= set(names)]
    return min(own, key=lambda c: _rank(row, c, group)[0], default=None)


def _rank(row: Row, cause: Cause | None, group: str) -> tuple[int, str]:
    """Rank of a cause by the evidence, and the evidence in words."""
    rank, because = OPEN, ""
    if cause is not None:
        against = [c for c in cause.unless if _holds(row, c)]
        if against:
            rank, because = CONTRADICTED, AGAINST + _words(row, against[0])
        elif cause.when and all(_holds(row, c) for c in cause.when):
            rank, because = SUPPORTED, "; ".join(dict.fromkeys(_words(row, c) for c in cause.when))
    easier = group in EASIER_GROUPS or (cause is not None and cause.weakens)
    return rank + easier, because + ("; it makes the specification easier" if easier and because else "")


def _of_nature(correction: Correction) -> bool:
    """True if its patch changes a quantity of nature, which what the story names may bind."""
    fields = (field_of(str(operation["path"])) for operation in correction.patch)
    return any(field is not None and field.physical for field in fields)


def _value(row: Row, key: str) -> Any:
    """Value of a row under a key; None where there is none."""
    first, *rest = key.split(".")
    at: Any = getattr(row, first, None)
    for name in rest:
        if isinstance(at, Mapping):
            at = at.get(name)
        else:
            at = at[int(name)] if isinstance(at, list | tuple) and name.isdigit() and int(name) < len(at) else None
    return at


def _holds(row: Row, condition: Condition) -> bool | None:
    """True if a condition holds; None where the row does not tell."""
    value = _value(row, condition.key)
    if condition.compare in ("present", "absent"):
        return (value is not None) == (condition.compare == "present")
    other = condition.value
    if condition.than is not None:
        found = _value(row, condition.than)
        other = None if found is None else float(found) * condition.times
    if value is None or other is None:
        return None
    try:
        return bool(_COMPARE[condition.compare](value, other))
    except TypeError:
        return None


def _words(row: Row, condition: Condition) -> str:
    name, value = condition.key.removeprefix("evidence."), _value(row, condition.key)
    if condition.compare == "absent" or value is None:
        return f"there is no {name}"
    shown = f"{value:.4g}" if isinstance(value, float) else repr(value) if not isinstance(value, list | dict) else "given"
    return f"{name} is {shown}"


# ---------------------------------------------------------------- what an entry says of this row


def _joined(
    measured: Correction | None,
    cause: Cause | None,
    row: Row,
    names: Mapping[str, Any],
    spec: WorldSpec | None,
    document: dict[str, Any] | None,
    cited: str,
    because: str,
) -> Correction:
    """A correction from what the check measured, filled up by the table; or from the table alone."""
    patch: tuple[dict[str, Any], ...] = ()
    if cause is not None and document is not None and not because.startswith(AGAINST):
        patch = tuple(_operations(row, cause.patch, names, document))
    if measured is not None:
        update: dict[str, Any] = {"skill": measured.skill or cited, "because": because}
        if patch and not measured.patch:
            places = tuple(str(o["path"]) for o in patch)
            update |= {"patch": patch, "pointers": tuple(dict.fromkeys((*measured.pointers, *places)))}
        return measured.model_copy(update=update)
    assert cause is not None
    return Correction(
        cause=cause.cause,
        edit_class=cause.edit_class,
        group=cause.group,
        action=_filled(cause.action, names),
        pointers=tuple(p for p in (_filled(p, names) for p in cause.pointers) if _has_setting(p, spec)),
        patch=patch,
        skill=cited,
        because=because,
    )


def _settable(cause: Cause, names: Mapping[str, Any], spec: WorldSpec | None) -> bool:
    """True if the instances of this world have any of the settings that a cause speaks of; true of causes that speak of none."""
    return not cause.pointers or any(_has_setting(_filled(p, names), spec) for p in cause.pointers)


def _has_setting(pointer: str, spec: WorldSpec | None) -> bool:
    """False of a pointer to a setting that the engine of its instance does not have."""
    found = re.match(r"/simulation/solvers/([^/<]+)/settings/([^/<]+)", pointer)
    if found is None or spec is None or found[1] not in spec.simulation.solvers:
        return True
    return found[2] in type(spec.simulation.solvers[found[1]].settings).model_fields


def _filled(value: Any, names: Mapping[str, Any]) -> Any:
    """Text, lists and objects with their placeholders filled; those that the row does not tell stay."""
    if isinstance(value, Mapping):
        return {k: _filled(v, names) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_filled(v, names) for v in value]
    if not isinstance(value, str):
        return value
    whole = re.fullmatch(r"<(\w+)>", value)
    if whole:
        return names.get(whole.group(1), value)
    return re.sub(r"<(\w+)>", lambda m: str(names.get(m.group(1), m.group(0))), value)


def _operations(row: Row, rules: Sequence[PatchRule], names: Mapping[str, Any], document: dict[str, Any]) -> list[dict[str, Any]]:
    """The operations of all rules, or none where one of them is not determined or would change nothing."""
    found = []
    for rule in rules:
        pointer = _filled(rule.pointer, names)
        if "<" in pointer:
            return []
        present = _at(document, pointer)
        wanted = _nearer(document, pointer, rule, names) if rule.toward else _wanted(row, rule, present)
        if wanted is None or wanted == present:
            return []
        found.append({"op": "replace" if pointer.rpartition("/")[2].isdigit() else "add", "path": pointer, "value": wanted})
        found += _spun(document, pointer, present, wanted)
    return found


def _spun(document: Any, pointer: str, present: Any, wanted: Any) -> list[dict[str, Any]]:
    """The spin of what starts rolling, by the factor of its velocity: with another one it would slide at first."""
    place, _, field = pointer.rpartition("/")
    spin = _at(document, f"{place}/angular_velocity")
    if field != "linear_velocity" or not isinstance(wanted, list) or not any(spin or ()) or not any(present or ()):
        return []
    factor = math.hypot(*wanted) / math.hypot(*present)
    return [{"op": "add", "path": f"{place}/angular_velocity", "value": [round(factor * float(c), 6) for c in spin]}]


def _at(document: Any, pointer: str) -> Any:
    at = document
    for token in pointer.split("/")[1:]:
        if isinstance(at, dict):
            at = at.get(token)
        elif isinstance(at, list) and token.isdigit() and int(token) < len(at):
            at = at[int(token)]
        else:
            return None
    return at


def _nearer(document: dict[str, Any], pointer: str, rule: PatchRule, names: Mapping[str, Any]) -> list[float] | None:
    """Position of an entity, moved level towards another until it is in its reach; None where it is, or would touch."""
    name, other = pointer.split("/")[2], _filled(rule.toward, names)
    one, two = (document["entities"].get(n) for n in (name, other))
    if one is None or two is None or rule.reach is None or name == other:
        return None
    here, there = one["pose"]["position"], two["pose"]["position"]
    way = [a - b for a, b in zip(here[:2], there[:2], strict=True)]
    apart = math.hypot(*way)
    if apart == 0.0:
        return None
    touch = sum(_half_width(e, [w / apart for w in way]) for e in (one, two)) + NEAREST
    wanted = max(rule.reach * two["dimensions"]["size"][2], touch)
    if wanted >= apart:
        return None
    return [*(round(t + w * wanted / apart, 6) for t, w in zip(there[:2], way, strict=True)), here[2]]


def _half_width(entity: Mapping[str, Any], along: Sequence[float]) -> float:
    """Half of an entity's level extent [m] along a unit direction; of its diagonal where it is turned."""
    x, y = entity["dimensions"]["size"][:2]
    turned = any(k in entity["pose"] for k in ("euler", "quaternion"))
    return 0.5 * (math.hypot(x, y) if turned else abs(along[0]) * x + abs(along[1]) * y)


def _wanted(row: Row, rule: PatchRule, present: Any) -> Any:
    """The new value of a rule; None where the row or the specification does not determine it."""
    if rule.value is not None:
        return rule.value
    if isinstance(present, list) and present and all(isinstance(v, int | float) for v in present):
        parts = [_wanted(row, rule, v) for v in present]
        return None if None in parts else parts
    if isinstance(present, bool) or not isinstance(present, int | float):
        return None
    value = float(present)
    if rule.scale is not None:
        value *= rule.scale
    elif rule.ratio is not None:
        a, b = (_value(row, k) for k in rule.ratio)
        if not all(isinstance(v, int | float) for v in (a, b)) or b == 0 or a / b <= 0:
            return None
        value *= (a / b) ** rule.power * rule.margin
    elif rule.plus is not None:
        more = _value(row, rule.plus)
        if isinstance(more, bool) or not isinstance(more, int | float):
            return None
        value += more * rule.times
    value = max(value, rule.low) if rule.low is not None else value
    value = min(value, rule.high) if rule.high is not None else value
    return round(value) if isinstance(present, int) else float(f"{value:.6g}")


# ---------------------------------------------------------------- past edits


def _miss(outcome: Outcome) -> float | None:
    """Distance of a row's value from its bound."""
    return None if outcome.measured is None or outcome.bound is None else abs(outcome.measured - outcome.bound)


def _effect(attempt: Attempt) -> str:
    """Effect of an edit on the row, in words."""
    before, after = attempt.before, attempt.after
    if after is None:
        return "not measured afterwards"
    if after.status != "fail":
        return "cured it then"
    if before is None:
        return "it failed again"
    was, now = _miss(before), _miss(after)
    if was is None or now is None or before.unit != after.unit:
        return "another failure" if (before.entity, before.frame) != (after.entity, after.frame) else "without effect"
    if now > (1 + MIN_EFFECT) * was:
        return "made it worse"
    if now <= (1 - MIN_EFFECT) * was:
        return "better, not enough"
    # Counts and ranks do not tell how far a chain came; where and when it broke does.
    moved = was == now and (before.entity, before.frame) != (after.entity, after.frame)
    return "it fails elsewhere" if moved else "without effect"


def _attempt_text(attempt: Attempt) -> str:
    told = [f"{'/'.join(p.split('/')[-2:])} {old} -> {new}" for p, old, new in attempt.changes[:2] if new is not None]
    change = ", ".join(told) or attempt.group
    before, after = attempt.before, attempt.after
    numbers = ""
    if before is not None and after is not None and before.measured is not None and after.measured is not None:
        numbers = f", measured {before.measured:.4g} -> {after.measured:.4g} {after.unit}".rstrip()
    return f"tried in revision {attempt.revision} ({attempt.group}): {change}{numbers}: {_effect(attempt)}"


def _concerns(row: Row, attempt: Attempt) -> bool:
    """True if an edit was about this row: it changed something of its entities, something of all, or what it measures."""
    before, after = attempt.before, attempt.after
    if before is not None and after is not None and before != after:
        return True
    if row.check in CHAINED:
        return True
    named = {*row.entities, *(p.split("/")[2] for c in row.corrections for p in c.pointers if p.startswith("/entities/"))}
    places = [p.split("/") for p, _, _ in attempt.changes]
    return not places or any(p[1] != "entities" or (len(p) > 2 and p[2] in named) for p in places)


def _touches(correction: Correction, attempt: Attempt) -> bool:
    """True if an edit changed what a correction points at; one that names no place speaks for its whole group."""
    places = [p for p in correction.pointers if "<" not in p]
    changed = [p for p, _, _ in attempt.changes]
    if not places or not changed:
        return True
    return any(a == b or a.startswith(b + "/") or b.startswith(a + "/") for a in places for b in changed)
