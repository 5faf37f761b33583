"""Things that never move and stand on nothing: what touches them from the side or above has to bear them (R92, R154).

Such a thing is glued, screwed or built in where it touches; nobody draws the screws. Where a `fastened` or `supports` relation says so it is
believed, as is what reaches into or hooks into what holds it. Else what touches is taken for a joint of `BOND`: a shelf on its wall, a
picture and a beam between posts are borne by far; a slab whose edge meets a thin pole is not.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.arrays import F64, cross
from ...worlds.errors import EvidenceError
from ...worlds.spec import Fastened, Supports
from ..ledgers import motion
from ..rows.answers import row_of
from ..rows.corrections import correction, pointer, say_afloat
from ..rows.findings import Finding
from .bounds import BOND, BOND_MOST
from .questions import HUNG
from .touching import contacts_of

if TYPE_CHECKING:
    from ...worlds.requirements import Correction, Row
    from ..scene.surfaces import Surfaces

__all__ = ["Hanging", "hanging", "hung_rows"]

Pair = tuple[str, str]


class Hanging(NamedTuple):
    """Things that hang together and stand on nothing, and where they touch what does."""

    members: tuple[str, ...]
    meets: tuple[Pair, ...]
    """Pairs (what holds, member)."""


def hanging(names: Sequence[str], ground: frozenset[str], touching: Sequence[Pair], stands: frozenset[Pair]) -> Iterator[Hanging]:
    """Groups of things that no chain of standing leads to from the ground.

    Args:
        names: of all things that never move.
        ground: those that are the ground.
        touching: pairs that touch.
        stands: pairs (below, above).
    """
    above: dict[str, list[str]] = {}
    for a, b in stands:
        above.setdefault(a, []).append(b)
    reached, waiting = set(ground), list(ground)
    while waiting:
        for b in above.get(waiting.pop(), ()):
            if b not in reached:
                reached.add(b)
                waiting.append(b)
    beside: dict[str, list[str]] = {n: [] for n in names}
    for a, b in touching:
        if a in beside and b in beside:
            beside[a].append(b)
            beside[b].append(a)
    left = [n for n in names if n not in reached]
    while left:
        members, waiting = {left[0]}, [left[0]]
        while waiting:
            for b in beside[waiting.pop()]:
                if b not in reached and b not in members:
                    members.add(b)
                    waiting.append(b)
        left = [n for n in left if n not in members]
        ordered = tuple(n for n in names if n in members)
        yield Hanging(ordered, tuple((a, m) for m in ordered for a in beside[m] if a in reached))


def hung_rows(surfaces: Surfaces, groups: Sequence[Hanging], hooked: frozenset[Pair], down: F64) -> list[Row]:
    """Rows `support:hung:<entity>` of groups that touch what stands.

    Args:
        surfaces: of the candidate.
        groups: what stands on nothing.
        hooked: pairs of which each is in the way of the other's falling.
        down: unit vector along gravity.
    """
    spec = surfaces.candidate.spec
    said: dict[Pair, str] = {}
    for key, relation in spec.graph.relations.items():
        if isinstance(relation, Fastened | Supports):
            said[(relation.a, relation.b)] = key
            if isinstance(relation, Fastened):
                said[(relation.b, relation.a)] = key
    found = []
    for group in groups:
        if not group.meets or any(spec.entities[m].afloat is not None for m in group.members):
            continue
        at = group.members[0]
        answer = _judged(surfaces, group, said, hooked, down)
        found.append(row_of(surfaces.candidate, HUNG, (at,), answer, entities=(at, *dict.fromkeys(a for a, _ in group.meets))))
    return found


def _judged(surfaces: Surfaces, group: Hanging, said: Mapping[Pair, str], hooked: frozenset[Pair], down: F64) -> Finding:
    at, holders = group.members[0], sorted({a for a, _ in group.meets})
    what = repr(at) if len(group.members) == 1 else f"{at!r} with {', '.join(map(repr, group.members[1:5]))}"
    named = ", ".join(map(repr, holders[:4]))
    told = next((said[p] for p in group.meets if p in said), None)
    into = next((p for p in group.meets if _overlap(surfaces, p) or p in hooked), None)
    extra = [told, *group.members]
    if told is not None:
        return Finding("pass", f"{what} is held by {named}, as relation {told!r} says", frames=(0, 0), extra=extra)
    if into is not None:
        return Finding("pass", f"{into[1]!r} reaches into {into[0]!r}, which holds {what}", frames=(0, 0), extra=extra)
    share = _borne(surfaces, group, down)
    ok = share >= 1.0
    much = f"{BOND * 1e-6:g} MPa where they touch" + ("" if ok else f" bear {share:.3g} of its weight")
    return Finding(
        "pass" if ok else "fail",
        f"{what} stands on nothing and hangs beside or under {named}: {much}{' bear it' if ok else ', and nothing says what holds it'}",
        share,
        1.0,
        hints=() if ok else tuple(_corrections(at, holders)),
        evidence={"held_by": holders[:20], "members": list(group.members)[:20]},
        entities=(at, *holders[:4]),
        frames=(0, 0),
        extra=extra,
    )


def _overlap(surfaces: Surfaces, pair: Pair) -> bool:
    a, b = pair
    depth = surfaces.first.get((a, b), surfaces.first.get((b, a), 0.0))
    return bool(depth < -surfaces.noise(a, b))


def _borne(surfaces: Surfaces, group: Hanging, down: F64) -> float:
    """Share of the weight of a group that contacts and bonds of `BOND` at the places that touch bear, at most `BOND_MOST`.

    Raises:
        EvidenceError: the solver gives none.
    """
    from scipy.optimize import linprog

    candidate = surfaces.candidate
    masses = np.array([motion.entity_mass(candidate, n) for n in group.members])
    center = masses @ np.array([candidate.center(n, 0) for n in group.members]) / masses.sum()
    weight = float(masses.sum() * np.linalg.norm(candidate.spec.simulation.gravity))
    size = sum(surfaces.size(n) for n in group.members)
    columns, most = [], []
    for holder, member in group.meets:
        contacts = contacts_of(surfaces, member, holder, 0)
        if not len(contacts.points):
            continue
        points = np.unique(np.round(contacts.points, 6), axis=0)
        strength = BOND * _area(points, candidate.spec.simulation.limits.contact_gap) / len(points) / weight
        for point in points:
            columns += [_wrench(way, point - center, size) for way in (*np.eye(3), *-np.eye(3))]
            most += [strength] * 6
        columns += [_wrench(n, p - center, size) for n, p in zip(contacts.normals, contacts.points, strict=True)]
        most += [BOND_MOST * 10.0] * len(contacts.points)
    if not columns:
        return 0.0
    load = np.concatenate([down, np.zeros(3)])
    matrix = np.column_stack([*columns, load])
    bounds = [(0.0, m) for m in most] + [(0.0, BOND_MOST)]
    price = np.zeros(len(bounds))
    price[-1] = -1.0
    found = linprog(price, A_eq=matrix, b_eq=np.zeros(6), bounds=bounds, method="highs")
    if found.x is None:
        raise EvidenceError(f"the balance of bonds has no numeric solution: {found.message}")
    return float(found.x[-1])


def _wrench(force: F64, arm: F64, size: float) -> F64:
    return np.concatenate([force, cross(arm, force) / size])


def _area(points: F64, gap: float) -> float:
    """Area of the box about points that touch, along their own axes, each side no less than the contact tolerance [m^2]."""
    away = points - points.mean(axis=0)
    axes = np.linalg.svd(away, full_matrices=False)[2] if len(points) > 1 else np.eye(3)
    extent = np.sort(np.ptp(away @ axes.T, axis=0))[::-1]
    extent = np.concatenate([extent, np.zeros(2)])[:2]
    return float(np.maximum(extent, gap).prod())


def _corrections(at: str, holders: Sequence[str]) -> Iterator[Correction]:
    holder = holders[0]
    yield correction(
        f"{at!r} is bolted, glued or built into {holder!r}",
        "relations",
        f"Say so: a `fastened` relation of {holder!r} and {at!r} with the reason, which is printed.",
        pointers=("/graph/relations",),
    )
    yield correction(
        "what would bear it is not drawn",
        "shape",
        f"Put a post, bracket or ledge under {at!r}, or let more of it meet {holder!r}.",
        pointers=(pointer("entities", at, "parts"), pointer("entities", at, "pose")),
    )
    yield say_afloat(at, "it is meant to float in the air")
