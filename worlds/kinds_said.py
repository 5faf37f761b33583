"""Words by which an entity is said to be of a kind, and edits of them that rows about it answer to (R157).

Rows about the size of a kind, about hidden weights and about what opens ask what the role of an entity says that it is. Once such a row
failed, another role is no repair of the thing: it is told like any other way around the row.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from .requirements import Row
from .spec import Entity, WorldSpec

__all__ = ["ASKED_BY_ROLE", "kinds_said_otherwise", "role_weakenings", "said_of"]

ASKED_BY_ROLE = frozenset(("scale:kind", "scale:hidden", "navigability:joint"))
"""Questions that are asked by what the role of an entity says it is."""


def said_of(rows: Iterable[Row]) -> set[str]:
    """Entities that rows asked by their roles name."""
    return {name for row in rows if row.question in ASKED_BY_ROLE for name in row.entities}


def role_weakenings(before: WorldSpec, after: WorldSpec, judged: Collection[str]) -> Iterator[str]:
    """Edits by which a thing is said to be another than the one that failed, in words.

    Args:
        before: the specification before the edit.
        after: the one after it.
        judged: entities on which a row failed that their roles ask.
    """
    why = "by which a failing row was asked"
    fresh = _hung(after) - _hung(before)
    for key in sorted(n for n in judged if n in before.entities and n in after.entities):
        was, now = before.entities[key], after.entities[key]
        if was.role != now.role:
            yield f"/entities/{key}/role {was.role!r} -> {now.role!r}, {why}"
        if _maker(was) != _maker(now):
            yield f"/entities/{key}/asset/generator {_maker(was) or 'none'} -> {_maker(now) or 'none'}, {why}"
        if key in _hung(before) - _hung(after):
            yield f"/entities/{key} hangs on no joint any more: what is fixed is not asked to open, and a failing row asked it"
        if key in fresh:
            yield f"/entities/{key} is hung from another by a joint: a role tells no kind of what hangs, and a failing row asked it"


def kinds_said_otherwise(before: WorldSpec, after: WorldSpec, judged: Collection[str]) -> Iterator[str]:
    """Lines on entities of another world, under the ids of the first, whose roles end in another noun than those on which a row failed."""
    for key in sorted(n for n in judged if n in before.entities and n in after.entities):
        was, now = (spec.entities[key].role for spec in (before, after))
        if was.split()[-1:] != now.split()[-1:]:
            yield f"/entities/{key}/role {was!r} -> {now!r}, by which a failing row was asked"


def _maker(entity: Entity) -> str:
    return "" if entity.asset is None else entity.asset.generator


def _hung(spec: WorldSpec) -> set[str]:
    return {j.child for j in spec.simulation.joints.values() if j.parent is not None}
