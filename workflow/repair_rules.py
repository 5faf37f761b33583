"""The rules of repair (R111-R113): one causal group per change, a test before the next, an undo at any time."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from ..worlds.documents import document_of
from ..worlds.groups import group_of
from ..worlds.patch import differences
from ..worlds.references import references
from ..worlds.requirements import Row
from ..worlds.spec import HeightField, WorldSpec

__all__ = ["CAUSAL_CLASSES", "UNDONE", "causal_groups", "cut_grounds", "failed", "judged_on", "same_causes"]

CAUSAL_CLASSES = ("scene", "solver")
UNDONE = "undone"
"""Word that stands in the place of a test where a change was taken back untested."""
_POSITION = "/pose/position"


def causal_groups(places: Sequence[str], grounds: Collection[str] = ()) -> list[str]:
    """Causal parameter groups of an edit.

    What follows from a shape goes along with it, for the same entity: its declared size; its position, where parts or generator
    change (a longer sheet hangs from the same line with its middle lower); the place of a ground that is cut from a landscape,
    for where it is cut decides what it is.

    Args:
        places: JSON pointers that the edit changes.
        grounds: entities that are ground cut from a landscape.
    """
    by_group: dict[str, set[str]] = {}
    for place in places:
        info = group_of(place)
        if info.edit_class in CAUSAL_CLASSES:
            by_group.setdefault(info.name, set()).add(place)
    shapes = by_group.get("shape", set())
    shaped = {_entity(p) for p in shapes}
    if {_entity(p) for p in by_group.get("dimensions", {""})} <= shaped:
        del by_group["dimensions"]
    formed = {_entity(p) for p in shapes if p.split("/")[3:4] in (["parts"], ["generator"])}
    follows = {f"{e}{_POSITION}" for e in formed}
    cut = shaped & {f"/entities/{name}" for name in grounds}
    if all(p in follows or _entity(p) in cut for p in by_group.get("placement", {""})):
        del by_group["placement"]
    return sorted(by_group)


def _entity(place: str) -> str:
    return "/".join(place.split("/")[:3])


def cut_grounds(*specs: WorldSpec) -> set[str]:
    """Entities that are ground cut from a landscape in each of these specifications."""
    found = [
        {
            name
            for name, entity in spec.entities.items()
            if any(isinstance(p.shape, HeightField) and p.shape.file is not None for p in entity.parts.values())
        }
        for spec in specs
    ]
    return set.intersection(*found)


def same_causes(one: WorldSpec, other: WorldSpec) -> bool:
    """True if two specifications are equal in everything causal: scene and solver.

    Materials of which nothing is made count for nothing, nor do the lists of what was made of interiors.
    """
    places = differences(document_of(_causes_of(one)), document_of(_causes_of(other)))
    return not any(group_of(p).edit_class in CAUSAL_CLASSES for p in places)


def _causes_of(spec: WorldSpec) -> WorldSpec:
    used = {value for _, target, value in references(spec, "") if target == "material"}
    materials = {k: m for k, m in spec.materials.items() if k in used}
    interiors = {k: i.model_copy(update={"entities": []}) for k, i in spec.interiors.items()}
    return spec.model_copy(update={"materials": materials, "interiors": interiors})


def judged_on(rows: Iterable[Row]) -> set[str]:
    """Entities that rows name: on their surfaces they were judged."""
    return {name for row in rows for name in (*row.entities, row.first_failing_entity) if name}


def failed(row: Row) -> bool:
    """True if the last judgement of a row was a failure, even if an edit made it stale since."""
    return row.status == "fail" or (row.status == "unverified" and row.evidence.get("was") == "fail")
