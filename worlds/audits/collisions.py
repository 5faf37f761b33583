"""Contacts of surfaces as far as the specification tells: skins that fit the bodies, and one entry per pair of contacts (R89, R154)."""

from __future__ import annotations

from collections.abc import Iterator

from ..extents import box_extent
from ..problems import Problem, removed, replaced
from ..spec import ContactPair, RigidInstance, WorldSpec

__all__ = ["pair_problems", "skin_problems"]

GAP_SHARE = 0.9
"""Two skins may take at most this share of the contact tolerance: a body placed at two skins must count as touching."""
THICKNESS_SHARE = 0.5
"""A skin thicker than half of what it covers is more skin than body: its contacts act farther out than the body is wide."""


def skin_problems(spec: WorldSpec) -> list[Problem]:
    """Collision skins beyond the contact tolerance, or thicker than half of the thinnest part that they cover."""
    return [
        p
        for name, instance in spec.simulation.rigid.items()
        for p in (*_beside_gap(spec, name, instance), *_beside_parts(spec, name, instance))
    ]


def _beside_gap(spec: WorldSpec, name: str, instance: RigidInstance) -> Iterator[Problem]:
    skin, gap = instance.settings.skin, spec.simulation.limits.contact_gap
    if 2 * skin > GAP_SHARE * gap:
        yield Problem(
            f"/simulation/solvers/{name}/settings/skin",
            f"two skins of {skin:g} m exceed {GAP_SHARE:g} of the contact tolerance {gap:g} m; "
            f"use a skin of at most {GAP_SHARE * gap / 2:g} m or a smaller step",
        )


def _beside_parts(spec: WorldSpec, name: str, instance: RigidInstance) -> Iterator[Problem]:
    found = [(size, what) for member in instance.members if member in spec.entities for what, size in _thickness(spec, member)]
    thin, what = min(found, default=(0.0, ""))
    skin, most = instance.settings.skin, THICKNESS_SHARE * thin
    if not what or skin <= most * (1.0 + 1e-9):
        return
    place = f"/simulation/solvers/{name}/settings/skin"
    yield Problem(
        place,
        f"skin {skin:g} m of {name!r} is more than half of the {thin:g} m that {what!r} is thick: allowed is 0 to {most:g} m; give a thinner "
        f"skin, with a shorter step (2 skin >= 1.5 speed x step), or a thicker part",
        replaced(place, most),
    )


def _thickness(spec: WorldSpec, member: str) -> Iterator[tuple[str, float]]:
    """Parts of a member that collide, and their least extents [m]; upper bounds of it for what is no simple shape."""
    entity = spec.entities[member]
    if entity.generator is not None:
        yield member, 2.0 * entity.generator.radius
    for key, part in entity.parts.items():
        size = box_extent(part.shape) if part.collides else None
        if size is not None:
            yield f"{member}/{key}", size


def pair_problems(spec: WorldSpec) -> list[Problem]:
    """Entries of `simulation.contacts` about a pair that an earlier entry is about, in either order."""
    first: dict[frozenset[str], str] = {}
    found = []
    for name, pair in spec.simulation.contacts.items():
        earlier = first.setdefault(frozenset((pair.a, pair.b)), name)
        if earlier != name:
            place = f"/simulation/contacts/{name}"
            text = (
                f"{name!r} ({_told(pair)}) is about {pair.a!r} and {pair.b!r}, and so is {earlier!r} "
                f"({_told(spec.simulation.contacts[earlier])}): one entry per pair, in either order, is allowed; keep the one that is meant"
            )
            found.append(Problem(place, text, removed(place)))
    return found


def _told(pair: ContactPair) -> str:
    given = {"friction": pair.friction, "restitution": pair.restitution}
    return ", ".join(f"{k} {v:g}" for k, v in given.items() if v is not None) or "nothing of its own"
