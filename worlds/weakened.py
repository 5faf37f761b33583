"""Quantities of nature and surfaces whose change makes requirements easier to meet (R157); the story's own are in `patch.py`.

A quantity of nature is a weakening where a declared beat or requirement is easier to meet by it, or where it leaves what the
specification takes by default; else it is a repair in its group. `directions.py` says of every field which of these it is.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from functools import reduce
from typing import Any

from .categories.registry import CATEGORIES
from .directions import way_of
from .parameters import Parameter
from .spec import SimulationPlan, WorldSpec

__all__ = ["claim_weakenings", "physical_weakenings", "relation_weakenings", "surface_weakenings"]

Document = Mapping[str, Any]
GRAVITY: list[float] = list(SimulationPlan.model_fields["gravity"].default)
"""[m/s^2] What the specification takes by default."""


def physical_weakenings(before: WorldSpec, after: WorldSpec, old: Document, new: Document) -> Iterator[str]:
    """Weakenings by quantities of nature and by how finely time is looked at, in words.

    Args:
        before: the specification before the edit.
        after: the one after it.
        old: `before` as JSON without nulls.
        new: `after` as JSON without nulls.
    """
    yield from _plan(old["simulation"], new["simulation"])
    for key, material in old["materials"].items():
        now = new["materials"].get(key)
        if now is not None and now["density"] != material["density"] and now["substance"] == "other":
            yield f"/materials/{key}/density {material['density']:g} -> {now['density']:g} kg/m^3, which its substance 'other' does not hold"
    for key, entity in old["entities"].items():
        if key in new["entities"]:
            yield from _entity(key, entity, new["entities"][key], old["story"])
            for category in CATEGORIES.values():
                yield from category.eased(key, before.entities[key], after.entities[key])


def _plan(old: Document, new: Document) -> Iterator[str]:
    if new["gravity"] != old["gravity"] and new["gravity"] != GRAVITY:
        yield f"/simulation/gravity {old['gravity']} -> {new['gravity']} m/s^2, by default {GRAVITY}"
    if new["fps"] < old["fps"]:
        yield f"/simulation/fps {old['fps']} -> {new['fps']}: rows ask at fewer frames of a second"
    lasts = [(plan["frames"] - 1) / plan["fps"] for plan in (old, new)]
    if new["fps"] > old["fps"] and new["frames"] >= old["frames"] and lasts[1] < lasts[0] * (1.0 - 1e-9):
        yield f"/simulation/fps {old['fps']} -> {new['fps']}: the sequence lasts {lasts[1]:.3g} s, before {lasts[0]:.3g} s"
    for key, coupling in old["couplings"].items():
        now = new["couplings"].get(key, {})
        pair = {coupling["source"], coupling["target"]}
        still = any(c["direction"] == "two_way" and {c["source"], c["target"]} == pair for c in new["couplings"].values())
        if coupling["direction"] == "two_way" and not still:
            yield f"/simulation/couplings/{key} two_way -> {now.get('direction', 'none')}: no reaction any more"


def _entity(key: str, old: Document, new: Document, story: Document) -> Iterator[str]:
    place, was, now = f"/entities/{key}", old["physics"], new["physics"]
    if was["category"] != now["category"]:
        yield f"{place}/physics/category {was['category']} -> {now['category']}"
        return
    if "mass" in now and now["mass"] != was.get("mass"):
        before = f"{was['mass']:g} kg" if "mass" in was else "density times volume"
        yield f"{place}/physics/mass {before} -> {now['mass']:g} kg"
    if now.get("hollow") and not was.get("hollow"):
        yield f"{place}/physics/hollow declared: it may weigh less than its volume"
    span, active = old.get("active", [0, math.inf]), new.get("active", [0, math.inf])
    if active[0] > span[0] or active[1] < span[1]:
        yield f"{place}/active {old.get('active', 'all frames')} -> {new['active']}: it is judged at fewer frames"
    for category in CATEGORIES.values():
        if category.name == was["category"] or category.contract in old:
            for parameter in (p for p in category.parameters if p.eases):
                yield from _bound(parameter, key, old, new, story)
    if "breakable" in old and "breakable" not in new:
        yield f"{place}/breakable removed: it breaks no more"


def _bound(parameter: Parameter, entity: str, old: Document, new: Document, story: Document) -> Iterator[str]:
    """A field of strength or stiffness that moved to where what is asked of the entity is easier."""
    path = parameter.pointer.split("/")[3:]
    was, now = (reduce(lambda node, token: node.get(token, {}), path[:-1], e).get(path[-1], parameter.absent) for e in (old, new))
    if was is None or now is None or was == now:
        return
    side = "more" if now < was else "less"
    names = _asks(story, entity, parameter.eases).get(side, [])
    if names:
        place = f"/entities/{entity}/{'/'.join(path)}"
        yield f"{place} {was:g} -> {now:g}, by which {', '.join(names)} {'is' if len(names) == 1 else 'are'} easier to meet"


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
    """Fields of a relation that ask for less than before, or may."""
    for field in sorted({*old, *new} - {"text"}):
        was, now = old.get(field), new.get(field)
        if was == now:
            continue
        way = way_of(f"{place}/{field}")
        up = way is not None and way.direction == "harder_up"
        if (
            way is not None
            and way.direction in ("harder_up", "harder_down")
            and was is not None
            and now is not None
            and ((now > was) == up)
        ):
            continue
        yield f"{place}/{field} {'default' if was is None else was} -> {'default' if now is None else now}"


def claim_weakenings(old: Mapping[str, Any], new: Mapping[str, Any]) -> Iterator[str]:
    """Edits of claims, as JSON, that ask for less (R157): compared by quote, since ids may change."""
    before, now = ({(c["quote"], c.get("nth", 1)): c for c in claims.values()} for claims in (old, new))
    for place, claim in before.items():
        told, after = f"claim of {place[0]!r}", now.get(place)
        if after is None:
            yield f"{told} dropped: these words are filler"
        elif after.get("waived") and not claim.get("waived"):
            yield f"{told} waived: {after['waived']}"
        elif after["type"] != claim["type"] and not claim.get("waived"):
            yield f"{told} is {after['type']}, was {claim['type']}"
        else:
            lost = sorted(set(claim.get("by", ())) - set(after.get("by", ())))
            if lost:
                yield f"{told} is no longer judged by {', '.join(lost)}"
    for place, claim in now.items():
        if place not in before and claim.get("waived") and old:
            yield f"claim of {place[0]!r} waived: {claim['waived']}"
