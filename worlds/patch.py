"""Edits of a specification: JSON Patch (RFC 6902), validation with pointers, differences, weakening (R1, R113, R157)."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

from pydantic import ValidationError

from .bounds import check_document, extent, shown
from .categories.registry import CATEGORIES
from .documents import bare_document, document_of
from .errors import SpecError
from .hints import patch_problem, spec_problem
from .holding import holding_weakenings
from .limits import CAPS, check_cap
from .named_materials import declared_by_name, filled_materials
from .scenery import of_scenery, scenery
from .spec import WorldSpec
from .weakened import directed_weakenings, physical_weakenings, relation_weakenings, surface_weakenings
from .weakened_claims import claim_weakenings
from .weakened_story import story_weakenings

__all__ = ["apply_patch", "differences", "entity_weakenings", "parse_edit", "parse_spec", "weakenings"]

_ERROR_CHARACTERS = 300
_SHOWN_PROBLEMS = 20
_LISTED_PROBLEMS = 10_000
_FIRST_MEMBERS = 40


def parse_spec(document: Any) -> WorldSpec:
    """Validate a document.

    Raises:
        LimitError: it is larger than any specification may be.
        SpecError: with every problem as (JSON pointer, message), at most 20 of them in the text.
    """
    check_document(document, "the specification")
    try:
        return WorldSpec.model_validate(document)
    except ValidationError as error:
        count, problems = error.error_count(), _problems(document, error)
    text = "\n".join(f"  {place}: {message}" for place, message in problems[:_SHOWN_PROBLEMS])
    more = f"\n  and {count - _SHOWN_PROBLEMS} more" if count > _SHOWN_PROBLEMS else ""
    raise SpecError(
        f"the specification does not validate, nothing was changed:\n{text}{more}\n{_advice(problems)}, then send it again.",
        tuple(problems),
    )


def _problems(document: Any, error: ValidationError) -> list[tuple[str, str]]:
    """(JSON pointer, message) of every problem; of very many, those in the first members of each collection.

    Listing a million problems takes pydantic ten times as long as finding them.
    """
    if error.error_count() > _LISTED_PROBLEMS:
        try:
            WorldSpec.model_validate(_first_members(document))
        except ValidationError as fewer:
            error = fewer
        if error.error_count() > _LISTED_PROBLEMS:
            return [("", "hardly anything in it is as the schema has it")]
    found: list[tuple[str, str]] = []
    for item in error.errors(include_url=False):
        if len(found) < _SHOWN_PROBLEMS:
            place, message = spec_problem(document, dict(item))
        else:
            place, message = "/" + "/".join(str(p) for p in item["loc"]), f"{item['msg']} (got {shown(item.get('input'))})"
        place = place if len(place) <= _ERROR_CHARACTERS else f"{place[:_ERROR_CHARACTERS]}..."
        found.append((place, message[: 3 * _ERROR_CHARACTERS]))
    return found


def _advice(problems: Sequence[tuple[str, str]]) -> str:
    place = problems[0][0].rpartition("/")[0] if problems else ""
    asked = f"inspect_world(part='schema', pointer={place or '/'!r})"
    return f"{asked} tells the fields and ranges there, worldagent://schema/world all of them"


def _first_members(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _first_members(value[key]) for key in islice(value, _FIRST_MEMBERS)}
    return [_first_members(item) for item in value[:_FIRST_MEMBERS]] if isinstance(value, list) else value


def apply_patch(spec: WorldSpec, operations: Sequence[Mapping[str, Any]]) -> WorldSpec:
    """Apply RFC 6902 operations; the prompt cannot change. What interiors say was made of them loses the entities that go.

    Raises:
        LimitError: too many operations, or they add or copy too much.
        SpecError: an operation fails, the result does not validate, or the prompt would change.
    """
    check_cap("patch_operations", len(operations), what="this patch")
    changed: Any = bare_document(spec)
    own: dict[int, Any] = {}
    added = 0
    for number, operation in enumerate(operations):
        for pointer in (operation.get("from"), operation.get("path")):
            changed = _with_own(changed, pointer, own)
        changed, more = _applied(changed, operation, number)
        added += more
        check_cap("patch_values", added, what=f"operations 0 to {number} of this patch")
    if not isinstance(changed, dict) or changed.get("prompt") != spec.prompt:
        raise SpecError("the prompt is immutable; create another world for another prompt")
    return parse_edit(_struck(spec, changed))


def _struck(spec: WorldSpec, document: dict[str, Any]) -> dict[str, Any]:
    """The document without entities that are gone in the lists of interiors: a record of the server's own, which nobody writes by hand."""
    entities, interiors = document.get("entities"), document.get("interiors")
    if not isinstance(entities, dict) or not isinstance(interiors, dict):
        return document
    gone, kept = spec.entities.keys() - entities.keys(), dict(interiors)
    for name, interior in interiors.items():
        listed = interior.get("entities") if isinstance(interior, dict) else None
        if isinstance(listed, list):
            left = [e for e in listed if not isinstance(e, str) or e not in gone]
            kept[name] = interior if len(left) == len(listed) else {**interior, "entities": left}
    return {**document, "interiors": kept}


def parse_edit(document: Any) -> WorldSpec:
    """Validate a document that a client edited; materials that it only names get what they are from the table of materials.

    Raises:
        LimitError: it is larger than any specification may be.
        SpecError: as `parse_spec`; the table has no such row.
    """
    check_document(document, "the specification")
    return declared_by_name(parse_spec(filled_materials(document)))


def _with_own(document: Any, pointer: Any, own: dict[int, Any]) -> Any:
    """The document with copies of what an operation at a pointer may change, so that whoever shares the original keeps it as it is.

    Args:
        document: objects and arrays, some of them shared.
        pointer: JSON pointer; what leads nowhere changes nothing.
        own: copies that earlier operations made, by identity; takes the new ones.
    """

    def owned(value: Any) -> Any:
        if id(value) not in own:
            value = value.copy()
            own[id(value)] = value
        return value

    if not isinstance(document, dict | list) or not isinstance(pointer, str):
        return document
    document = at = owned(document)
    for token in pointer.split("/")[1:-1]:
        key: Any = token.replace("~1", "/").replace("~0", "~")
        if isinstance(at, list):
            key = int(key) if key.isdecimal() and int(key) < len(at) else None
        elif key not in at:
            key = None
        if key is None or not isinstance(at[key], dict | list):
            break
        child = at[key] = owned(at[key])
        at = child
    return document


def _applied(document: Any, operation: Mapping[str, Any], number: int) -> tuple[Any, int]:
    """The document after one operation, and how many values that put into it: copies can double it each time."""
    import jsonpatch
    import jsonpointer

    what = f"operation {number} of the patch"
    try:
        carried = operation.get("value")
        if operation.get("op") in ("copy", "move"):
            carried = jsonpointer.JsonPointer(operation["from"]).resolve(document)
        size = extent(carried, most=CAPS["patch_values"].value, what=what)
        check_cap("patch_values", size.values, what=what)
        path = operation.get("path")
        levels = path.count("/") if isinstance(path, str) else 0
        check_cap("spec_depth", levels + size.depth, what=what)
        return jsonpatch.apply_patch(document, [dict(operation)], in_place=True), size.values
    except (jsonpatch.JsonPatchException, jsonpointer.JsonPointerException, TypeError, KeyError, AttributeError) as error:
        raise SpecError(
            f"{what} cannot be applied, nothing was changed: {patch_problem(document, operation, error)}. "
            "Paths are JSON pointers into world.json"
        ) from error


def differences(old: Any, new: Any, pointer: str = "") -> Iterator[str]:
    """JSON pointers at which two documents differ, leaves or whole added and removed subtrees."""
    if old == new:
        return
    if isinstance(old, dict) and isinstance(new, dict):
        for key in sorted({*old, *new}):
            place = f"{pointer}/{key}"
            if key not in old or key not in new:
                yield place
            else:
                yield from differences(old[key], new[key], place)
    else:
        yield pointer


def _robustness_weakenings(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[str]:
    """Fewer beats or other draws; how many and how large trials are is a matter of `directed_weakenings`."""
    for key, item in old.items():
        place, now = f"/story/robustness/{key}", new.get(key)
        if now is None or now["kind"] != item["kind"]:
            yield f"{place} removed"
            continue
        for field in ("beats", "seed", "entities"):
            before, after = item.get(field), now.get(field)
            if not set(before) <= set(after) if field == "beats" else before != after:
                yield f"{place}/{field} {before} -> {after}"


def _graph_weakenings(old: Mapping[str, Any], new: Mapping[str, Any], there: Collection[str]) -> Iterator[str]:
    """Relations and regions that ask for less; nobody asked anything of two of which one was not `there` before the edit."""
    now = new["relations"]
    for key, relation in old["relations"].items():
        if relation == now.get(key):
            continue
        if key not in now:
            if relation["kind"] != "fastened":
                yield f"/graph/relations/{key} ({relation['kind']}) removed"
        else:
            yield from relation_weakenings(f"/graph/relations/{key}", relation, now[key])
    for key, relation in now.items():
        fastened = relation["kind"] == "fastened" and old["relations"].get(key, {}).get("kind") != "fastened"
        if fastened and {relation["a"], relation["b"]} <= set(there):
            yield f"/graph/relations/{key}: overlap of {relation['a']} and {relation['b']} declared intended"
    for key, region in old["regions"].items():
        if key in new["regions"] and {**region, "role": ""} != {**new["regions"][key], "role": ""}:
            yield f"/graph/regions/{key} changed"


def entity_weakenings(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[str]:
    """Entities that went, are moved by nobody any more, or ask less of their category; both as JSON by id."""
    for key, entity in old.items():
        if key not in new:
            yield f"/entities/{key} removed"
            continue
        now = new[key]
        if now == entity:
            continue
        if entity["motion"] == "dynamic" and now["motion"] != "dynamic":
            yield f"/entities/{key}/motion dynamic -> {now['motion']}"
        if now.get("afloat") and not entity.get("afloat"):
            yield f"/entities/{key}/afloat: said to float in the air: {now['afloat']}"
        category, place = CATEGORIES[entity["physics"]["category"]], f"/entities/{key}/physics"
        yield from category.weakenings(place, entity["physics"], now["physics"])
        if "nominal_diagonal" in entity and new[key].get("nominal_diagonal") != entity["nominal_diagonal"]:
            yield f"/entities/{key}/nominal_diagonal changed"


def _shot_weakenings(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[str]:
    """Beats and subjects that no shot covers or frames any more, taking all shots together: shots may be cut anew."""
    for field, what in (("covers", "beat"), ("subjects", "subject")):
        before, now = ({name for shot in shots.values() for name in shot[field]} for shots in (old, new))
        yield from (f"/shots: {what} {name} is in no shot's {field} any more" for name in sorted(before - now))


def weakenings(before: WorldSpec, after: WorldSpec, judged: Collection[str] = ()) -> list[str]:
    """Changes that make the specification easier to satisfy (R157), in words.

    Args:
        before: the specification before the edit.
        after: the one after it.
        judged: entities that failing rows name: their surfaces are what was judged.
    """
    old, new = bare_document(before), bare_document(after)
    found = list(story_weakenings(old["story"], new["story"]))
    found += _robustness_weakenings(old["story"]["robustness"], new["story"]["robustness"])
    found += _graph_weakenings(old["graph"], new["graph"], old["entities"])
    found += entity_weakenings(old["entities"], new["entities"])
    found += surface_weakenings(old["entities"], new["entities"], judged)
    places = list(differences(document_of(before), document_of(after)))
    found += directed_weakenings(old, new, places)
    found += physical_weakenings(before, after, old, new, places)
    found += holding_weakenings(before, after)
    found += _shot_weakenings(old["shots"], new["shots"])
    found += claim_weakenings(old, new)
    free = scenery(before) - set(judged) if found else set()
    return [line for line in found if not of_scenery(line, before, after, free)]
