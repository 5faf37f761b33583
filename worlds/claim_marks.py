"""Claims from marked text, and marked text from claims: `A [ball](thing ball) [rolls off](event roll) ...` (R2, R155)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from .errors import InputError
from .patch import parse_spec
from .prompts.marks import Mark, marked_text, occurrence, parse_marks
from .references import closest
from .spec import CLAIM_TYPES, WorldSpec

__all__ = ["claim_operations", "claims_from", "marked_claims", "target_pointer", "with_claims"]

_ID = re.compile(r"[^a-z0-9]+")
_ALL = ("entities", "terrains", "story/beats", "story/requirements", "graph/relations", "graph/regions", "shots", "materials")
_FIRST: Mapping[str, tuple[str, ...]] = {
    "event": ("story/beats",),
    "order": ("story/beats", "story/requirements"),
    "negation": ("story/requirements",),
    "route": ("graph/relations", "graph/regions", "story/beats"),
    "place": ("graph/regions", "graph/relations", "entities", "terrains"),
    "look": ("shots",),
    "time": ("story/beats", "shots"),
}
"""Where a bare id of a claim is looked for first."""
_PLACES = (*_ALL, "simulation/drivers", "simulation/solvers", "simulation/joints")


def claims_from(marked: str, spec: WorldSpec) -> dict[str, dict[str, Any]]:
    """Claims, as JSON by id, that marked text says of a specification.

    Args:
        marked: the prompt with marks; without them it must equal the prompt.
        spec: where bare ids of targets are looked up.

    Raises:
        InputError: the text differs from the prompt, a type or target is unknown, or an option is.
    """
    marks = parse_marks(marked, spec.prompt)
    names = _names(marks)
    found = {}
    for name, mark in zip(names, marks, strict=True):
        # A mark that only waives says of no type; it counts as waived whatever it would have been.
        kind = mark.type if mark.type in CLAIM_TYPES else "property"
        claim: dict[str, Any] = {"quote": mark.quote, "nth": mark.nth, "type": kind}
        if mark.targets:
            claim["by"] = [target_pointer(spec, target, kind=mark.type, quote=mark.quote) for target in mark.targets]
        if mark.type == "waived":
            claim["waived"] = mark.options["because"]
        if "same_as" in mark.options:
            claim["same_as"] = _same(mark, names, marks)
        found[name] = claim
    return found


def claim_operations(marked: str, spec: WorldSpec) -> list[dict[str, Any]]:
    """JSON Patch that gives a specification the claims of marked text; one of version 1 becomes version 2.

    Raises:
        InputError: as `claims_from`.
    """
    claims = {"op": "add", "path": "/claims", "value": claims_from(marked, spec)}
    if spec.spec_version == "2":
        return [claims]
    return [{"op": "replace", "path": "/spec_version", "value": "2"}, {"op": "remove", "path": "/clauses"}, claims]


def with_claims(document: Mapping[str, Any], prompt: str, marked: str) -> dict[str, Any]:
    """The JSON of a specification without its prompt, as version 2 with the claims of marked text.

    Raises:
        InputError: as `claims_from`.
        SpecError: the document does not validate.
    """
    plain = {key: part for key, part in document.items() if key not in ("claims", "clauses")} | {"spec_version": "2"}
    return plain | {"claims": claims_from(marked, parse_spec({**plain, "prompt": prompt}))}


def marked_claims(spec: WorldSpec) -> str:
    """The prompt with its claims as marks; those whose quote is not found are left out."""
    found = []
    for claim in spec.claims.values():
        try:
            start, end = occurrence(spec.prompt, claim.quote, claim.nth)
        except InputError:
            continue
        options = {k: v for k, v in (("same_as", claim.same_as), ("because", claim.waived)) if v}
        found.append(Mark(start, end, claim.quote, "waived" if claim.waived else claim.type, tuple(claim.by), options, claim.nth))
    return marked_text(spec.prompt, tuple(sorted(found, key=lambda m: m.start)))


def _names(marks: tuple[Mark, ...]) -> list[str]:
    """Ids of claims: after their words in Latin letters, else after their type."""
    found: list[str] = []
    for mark in marks:
        base = _ID.sub("_", mark.quote.lower()).strip("_")[:40] if mark.quote.isascii() else ""
        base = base if base[:1].isalpha() else f"{mark.type}_{base}".rstrip("_")
        found.append(next(n for k in range(1, len(marks) + 1) if (n := base if k == 1 else f"{base}_{k}") not in found))
    return found


def _same(mark: Mark, names: list[str], marks: tuple[Mark, ...]) -> str:
    """Id of the claim that a mark is the same as, named by its id or by its words."""
    wanted = mark.options["same_as"]
    if wanted in names:
        return wanted
    by_words = [n for n, m in zip(names, marks, strict=True) if m.quote == wanted and m is not mark]
    if not by_words:
        near = closest(wanted, set(names))
        hint = f"; did you mean {near!r}?" if near else f"; claims are {', '.join(names[:8])}"
        raise InputError(f"the mark of {mark.quote!r} is same_as {wanted!r}, and no claim has that id or these words{hint}")
    return by_words[0]


def target_pointer(spec: WorldSpec, target: str, *, kind: str, quote: str) -> str:
    """Pointer that a target of a claim stands for, written as a pointer, as a bare id, or as ENTITY/PART.

    Args:
        spec: where ids are looked up.
        target: as in a mark.
        kind: type of the claim, which says where an id is looked for first.
        quote: words of the claim, for the error.

    Raises:
        InputError: nothing has this id.
    """
    if target.startswith("/"):
        return target
    if "/" in target and any(target.startswith(f"{place.partition('/')[0]}/") for place in _PLACES):
        return f"/{target}"
    first = _FIRST.get(kind, ())
    known = {place: _members(spec, place) for place in (*first, *_PLACES)}
    name, _, rest = target.partition("/")
    for place, members in known.items():
        if place == "entities" and name in members and rest in spec.entities[name].parts:
            return f"/entities/{name}/parts/{rest}"
        if name in members:
            return f"/{place}/{target}" if rest else f"/{place}/{name}"
    near = closest(name, set().union(*known.values()))
    hint = (
        f"; did you mean {near!r}?"
        if near
        else "; give the id of an entity, beat, requirement, relation or region, or a pointer such as /look/sky"
    )
    raise InputError(f"the mark of {quote!r} names {target!r}, which is nothing in the specification{hint}")


def _members(spec: WorldSpec, place: str) -> set[str]:
    at: Any = spec
    for key in place.split("/"):
        at = getattr(at, key)
    return set(at)
