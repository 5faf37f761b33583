"""Quantities of nature and surfaces whose change makes requirements easier to meet (R157); the story's own are in `patch.py`.

A quantity of nature is a weakening where a beat, a requirement or a claim binds it (`bound_fields.py`), or where it leaves the
default of the schema; else its change is a repair in its group, and so is the way back to the default unless a claim binds it. Of
strengths and stiffnesses it is known which way what is asked becomes easier: only that way is one.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from .bound_fields import Bound, binders_of, bound_fields
from .categories.registry import CATEGORIES
from .directions import field_of, way_of
from .quoting import listed
from .slices import physical_materials
from .spec import WorldSpec

__all__ = [
    "directed_weakenings",
    "physical_weakenings",
    "relation_weakenings",
    "surface_weakenings",
    "told_by_motion",
]

Document = Mapping[str, Any]
MOST_NAMED = 4
"""Beats, requirements and claims that a line names."""
_GRAVITY = "/simulation/gravity"
"""A law of the world: any value but its default has left it."""
_PAIR = "/simulation/contacts/*"
_JOINTS = "/simulation/joints/"
_SIDES = ("harder_up", "harder_down")
_RANGE = "/simulation/limits/scale_ratio"
_REQUIRED = object()
"""Stands for the default of a field that has none."""
_TOLD_BY_MOTION = re.compile(
    r"/simulation/(frames|fps) |/story/(beats|requirements)/[^/ ]+/(subject|owner|predicate|frames|causes|margins)\b"
    r"|claim of .* is no longer judged by /story/(beats|requirements)/[^,/]*(, /story/(beats|requirements)/[^,/]*)*$"
)


def told_by_motion(line: str) -> bool:
    """True if only motion is evidence against such a weakening: geometry at frame 0 says nothing of what is told there."""
    return _TOLD_BY_MOTION.match(line) is not None


def physical_weakenings(
    before: WorldSpec, after: WorldSpec, old: Document, new: Document, places: Iterable[str]
) -> Iterator[str]:
    """Weakenings by quantities of nature and by how finely time is looked at, in words.

    Args:
        before: the specification before the edit.
        after: the one after it.
        old: `before` as JSON without nulls.
        new: `after` as JSON without nulls.
        places: JSON pointers at which they differ.
    """
    yield from _plan(old["simulation"], new["simulation"])
    judged = set[str]()
    for key, entity in old["entities"].items():
        if key in new["entities"] and entity != new["entities"][key]:
            yield from _entity(key, entity, new["entities"][key])
            for place, told in _strengths(key, entity, new["entities"][key], old["story"]):
                judged.add(place)
                if told:
                    yield told
            for category in CATEGORIES.values():
                yield from category.eased(key, before.entities[key], after.entities[key])
    yield from _quantities(before, after, [p for p in places if p not in judged])


class _Held(NamedTuple):
    """A quantity of a specification."""

    value: Any
    default: Any
    """`_REQUIRED` where the schema gives none."""
    said: str


def _quantities(before: WorldSpec, after: WorldSpec, places: Iterable[str]) -> Iterator[str]:
    """Lines of quantities that changed where something binds them, or that left their default."""
    bound = bound_fields(before)
    for place in places:
        field = field_of(place)
        if field is not None and field.pointer == _PAIR:
            yield from _pair(place, before, after, bound)
        elif field is not None and field.physical and not _other_kind(before, after, place):
            yield from _changed(place, _held(before, place), _held(after, place), binders_of(bound, place))


def _changed(place: str, was: _Held, now: _Held, binders: Sequence[str]) -> Iterator[str]:
    if was.value == now.value:
        return  # two materials that differ in their look alone
    has, back = now.default is not _REQUIRED, now.value == now.default
    if binders and (not back or any(who.startswith("claim ") for who in binders)):
        yield f"{place} {was.said} -> {now.said}, bound by {listed(binders, MOST_NAMED)}"
    elif has and not back and (was.value == was.default or place == _GRAVITY):
        yield f"{place} {was.said} -> {now.said}, which leaves its default"


def _pair(place: str, before: WorldSpec, after: WorldSpec, bound: Bound) -> Iterator[str]:
    """A pair with friction or restitution of its own that comes or goes."""
    was, now = (spec.simulation.contacts.get(place.rpartition("/")[2]) for spec in (before, after))
    pair = was or now
    assert pair is not None, place
    binders = dict.fromkeys(who for name in (pair.a, pair.b) for who in binders_of(bound, f"/entities/{name}/physics"))
    if binders:
        own = ", ".join(
            f"{k} {v:g}" for k in ("friction", "static_friction", "restitution") if (v := getattr(pair, k)) is not None
        )
        yield f"{place} {'added' if was is None else 'removed'}: {own} of {pair.a} and {pair.b}, bound by {listed([*binders], MOST_NAMED)}"


def _held(spec: WorldSpec, place: str) -> _Held:
    """Value at a pointer with its default; a material is what it is made of, whatever its name.

    A word has no default: `other` says of a substance that it is unknown.
    """
    holder: Any = spec
    *path, last = place.split("/")[1:]
    for token in path:
        holder = holder[token] if isinstance(holder, dict) else getattr(holder, token)
    value, info = getattr(holder, last), type(holder).model_fields[last]
    if last == "material":
        name = value or spec.entities[path[1]].material
        return _Held(physical_materials({"": spec.materials[name]}) if name in spec.materials else name, _REQUIRED, name)
    default = _REQUIRED if info.is_required() or isinstance(info.default, str) else info.default
    return _Held(value, default, _said(value))


def _said(value: Any) -> str:
    if value is None:
        return "default"
    return f"{value:g}" if isinstance(value, float) else str(list(value) if isinstance(value, tuple) else value)


def _other_kind(before: WorldSpec, after: WorldSpec, place: str) -> bool:
    """True if a pointer leads into an entity of another category or a joint of another kind, of which other lines tell."""
    if place.startswith(_JOINTS):
        was, now = (spec.simulation.joints[place.split("/")[3]] for spec in (before, after))
        return was.kind != now.kind
    name = place.split("/")[2]
    return place.startswith("/entities/") and before.entities[name].physics.category != after.entities[name].physics.category


def _plan(old: Document, new: Document) -> Iterator[str]:
    lasts = [(plan["frames"] - 1) / plan["fps"] for plan in (old, new)]
    if new["fps"] > old["fps"] and new["frames"] >= old["frames"] and lasts[1] < lasts[0] * (1.0 - 1e-9):
        yield f"/simulation/fps {old['fps']} -> {new['fps']}: the sequence lasts {lasts[1]:.3g} s, before {lasts[0]:.3g} s"
    for key, coupling in old["couplings"].items():
        now = new["couplings"].get(key, {})
        pair = {coupling["source"], coupling["target"]}
        still = any(c["direction"] == "two_way" and {c["source"], c["target"]} == pair for c in new["couplings"].values())
        if coupling["direction"] == "two_way" and not still:
            yield f"/simulation/couplings/{key} two_way -> {now.get('direction', 'none')}: no reaction any more"


def _entity(key: str, old: Document, new: Document) -> Iterator[str]:
    place, was, now = f"/entities/{key}", old["physics"], new["physics"]
    if was["category"] != now["category"]:
        yield f"{place}/physics/category {was['category']} -> {now['category']}"
        return
    span, active = old.get("active", [0, math.inf]), new.get("active", [0, math.inf])
    if active[0] > span[0] or active[1] < span[1]:
        yield f"{place}/active {old.get('active', 'all frames')} -> {new['active']}: it is judged at fewer frames"
    if "breakable" in old and "breakable" not in new:
        yield f"{place}/breakable removed: it breaks no more"


def _strengths(entity: str, old: Document, new: Document, story: Document) -> Iterator[tuple[str, str]]:
    """Strengths and stiffnesses that changed and on which something that is asked depends one way: pointer, and line or nothing."""
    matter = old["physics"]["category"]
    if matter != new["physics"]["category"]:
        return
    held = (c for c in CATEGORIES.values() if c.name == matter or c.contract in old)
    for parameter in (p for category in held for p in category.parameters if p.eases):
        path = parameter.pointer.split("/")[3:]
        was, now = (_at(e, path[:-1]).get(path[-1], parameter.absent) for e in (old, new))
        asked = _asks(story, entity, parameter.eases)
        if was is None or now is None or was == now or not asked:
            continue
        place, names = f"/entities/{entity}/{'/'.join(path)}", asked.get("more" if now < was else "less", [])
        meets = f"by which {', '.join(names)} {'is' if len(names) == 1 else 'are'} easier to meet"
        yield place, f"{place} {was:g} -> {now:g}, {meets}" if names else ""


def _asks(story: Document, entity: str, kinds: Collection[str]) -> dict[str, list[str]]:
    """Beats and requirements that ask an entity to give way more, or less, as these kinds measure it."""
    found: dict[str, list[str]] = {}
    for group in ("beats", "requirements"):
        for name, item in story[group].items():
            for side in sorted(_sides(item["predicate"], entity, kinds, turned=False)):
                found.setdefault(side, []).append(name)
    return found


def _sides(predicate: Document, entity: str, kinds: Collection[str], *, turned: bool) -> set[str]:
    kind, found = predicate["kind"], set[str]()
    if kind in kinds and predicate.get("entity") in (entity, "each"):
        bounded = {"less"} if predicate.get("max") is not None else set()
        if predicate.get("min") is not None or not bounded:
            bounded.add("more")
        found |= {"more" if s == "less" else "less" for s in bounded} if turned else bounded
    if kind == "count" and entity not in predicate["entities"]:
        return found
    inner = [
        *predicate.get("of", ()),
        *(predicate[k] for k in ("predicate", "hold", "goal") if isinstance(predicate.get(k), Mapping)),
    ]
    for one in inner:
        found |= _sides(one, entity, kinds, turned=turned != (kind == "not"))
    return found


def surface_weakenings(old: Document, new: Document, judged: Collection[str]) -> Iterator[str]:
    """Surfaces that an edit takes from entities on which a failing row was judged.

    A part that comes in its place is a scene edit, however it is formed: rows judge the new surface.

    Args:
        old: entities before, as JSON.
        new: those after.
        judged: entities that failing rows name.
    """
    for key in (k for k in old if k in new and k in judged):
        parts, now = old[key]["parts"], new[key]["parts"]
        fresh = sum(p["collides"] for name, p in now.items() if name not in parts or not parts[name]["collides"])
        for name, part in parts.items():
            if not part["collides"]:
                continue
            if name not in now:
                if not fresh and not ("generator" in new[key] and now == {}):
                    yield f"/entities/{key}/parts/{name} removed, on which a failing row was judged"
                fresh = max(0, fresh - 1)
            elif not now[name]["collides"]:
                yield f"/entities/{key}/parts/{name} collides no more, on which a failing row was judged"


def relation_weakenings(place: str, old: Document, new: Document) -> Iterator[str]:
    """Fields of a relation that make it another one; those with a harder side are a matter of `directed_weakenings`."""
    for field in sorted({*old, *new} - {"text"}):
        was, now = old.get(field), new.get(field)
        way = way_of(f"{place}/{field}")
        if was != now and (way is None or way.direction not in _SIDES):
            yield f"{place}/{field} {'default' if was is None else was} -> {'default' if now is None else now}"


def _at(document: Document, path: Sequence[str]) -> Any:
    """Value at a path; an empty mapping where there is none."""
    at: Any = document
    for token in path:
        at = at.get(token, {})
    return at


def directed_weakenings(old: Document, new: Document, places: Iterable[str]) -> Iterator[str]:
    """Fields that moved against the side on which they are harder, and ranges of limits that grew.

    Bounds of predicates are compared by their kind, in `patch.py`.

    Args:
        old: the specification before the edit, as JSON without nulls.
        new: the one after it.
        places: JSON pointers at which they differ.
    """
    for place in places:
        way = None if "/predicate/" in place else way_of(place)
        path = place.split("/")[1:]
        was, now = (_at(document, path) for document in (old, new))
        if place == _RANGE:
            weaker = now[0] < was[0] or now[1] > was[1]
        elif way is not None and way.direction in _SIDES and {} not in (was, now):
            weaker = now < was if way.direction == "harder_up" else now > was
        else:
            continue
        if weaker:
            yield f"{place} {was} -> {now}"
