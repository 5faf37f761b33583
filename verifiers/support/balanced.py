"""Balance of things that never move: what only stands on others has its centre of mass over what it stands on (R92, R154).

Things that touch from the side or overlap, one that hangs under another, and what a `fastened` relation joins hang together as one
piece. The ground and whatever is one piece with it needs no balance. Every other piece, of one thing or of several (walls, rooms, frames), is
asked as a body at rest would be: contacts push, and friction is as large as any material has it. What hangs is asked by `support/hung.py`
whether what touches it can bear it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.spec import Fastened
from ..ledgers import motion
from ..rows.answers import row_of, rows_of
from ..rows.corrections import correction, move_by, pointer
from ..rows.findings import Finding
from ..scene.room import in_the_way
from .bounds import OUTSIDE
from .equilibrium import Balance, Group, solve
from .graph import gravity_direction
from .hung import hanging, hung_rows
from .questions import BALANCE, HELD
from .touching import contacts_of

if TYPE_CHECKING:
    from ...worlds.requirements import Correction, Row
    from .held import Held

__all__ = ["balanced_rows"]

Pair = tuple[str, str]


class _Pieces:
    """Things that never move, as pieces that hang together, and which piece stands on which."""

    def __init__(self, held: Held) -> None:
        self.held, self.surfaces = held, held.surfaces
        self.ground = frozenset(n for n in held.names if set(self.surfaces.parts_of[n]) & held.foundation)

    @cached_property
    def touching(self) -> tuple[Pair, ...]:
        """Pairs of things that touch."""
        name = [part.entity for part in self.surfaces.parts]
        met = ((name[i], name[j]) for i, others in self.held.touching.items() for j in others)
        return tuple(sorted({(a, b) for a, b in met if a < b}))

    @cached_property
    def stands(self) -> frozenset[Pair]:
        """Pairs (below, above) of things that touch, of which the lower one is in the way of the other's falling."""
        return self._in_the_way - self.hooked

    @cached_property
    def hooked(self) -> frozenset[Pair]:
        """Pairs of which each holds the other: they hook into each other."""
        return frozenset(p for p in self._in_the_way if p[::-1] in self._in_the_way)

    @cached_property
    def _in_the_way(self) -> frozenset[Pair]:
        return frozenset(p for a, b in self.touching for p in ((a, b), (b, a)) if self._carries(*p))

    def _carries(self, below: str, above: str) -> bool:
        return bool(self.surfaces.carries(below, above, until=1)[0])

    @cached_property
    def hung(self) -> frozenset[Pair]:
        """Pairs of which one has no way to the ground by standing on things, and hangs beside or under the other."""
        found: set[Pair] = set()
        reached, fresh = set[str](), set(self.ground)
        while fresh:
            reached |= fresh
            fresh = {b for a, b in self.stands if a in reached and b not in reached}
            if not fresh:
                sides = [(a, b) for a, b in self.touching if (a in reached) != (b in reached)]
                found |= set(sides)
                fresh = {b if a in reached else a for a, b in sides}
        return frozenset(found)

    @cached_property
    def piece(self) -> dict[str, str]:
        """For each thing the first one of its piece."""
        label = {name: name for name in self.held.names}
        for a, b in self._joined():
            old, new = label[b], label[a]
            label = {name: new if at == old else at for name, at in label.items()}
        return label

    def _joined(self) -> Iterator[Pair]:
        surfaces = self.surfaces
        relations = surfaces.candidate.spec.graph.relations.values()
        fastened = {(r.a, r.b) for r in relations if isinstance(r, Fastened)}
        for a, b in self.touching:
            rests = {(a, b), (b, a)} & self.stands and (a, b) not in self.hung
            overlap = surfaces.first.get((a, b), surfaces.first.get((b, a), 0.0)) < -surfaces.noise(a, b)
            if not rests or overlap or (a, b) in fastened or (b, a) in fastened:
                yield a, b

    @cached_property
    def base(self) -> frozenset[str]:
        """Pieces that need no balance: with the ground, with what is said to float, or that nothing holds at all."""
        spec = self.surfaces.candidate.spec
        found = set()
        for name, at in self.piece.items():
            if name in self.ground or spec.entities[name].afloat is not None or self.held.loose(name):
                found.add(at)
        return frozenset(found)

    def groups(self) -> Iterator[Group]:
        """Pieces that stand on each other, with all that they stand on."""
        surfaces, down = self.surfaces, gravity_direction(self.surfaces)
        assert down is not None
        members = [at for at in dict.fromkeys(self.piece.values()) if at not in self.base]
        rests = [(a, b) for a, b in sorted(self.stands) if self.piece[a] != self.piece[b]]
        while members:
            some, waiting = [], [members[0]]
            while waiting:
                at = waiting.pop()
                if at in members:
                    members.remove(at)
                    some.append(at)
                    waiting += [
                        o for p in rests if at in (q := (self.piece[p[0]], self.piece[p[1]])) for o in q if o not in self.base
                    ]
            named = [(self.piece[b], self.piece[a], b, a) for a, b in rests if {self.piece[a], self.piece[b]} & set(some)]
            contacts = tuple((above, below, contacts_of(surfaces, b, a, 0)) for above, below, b, a in named)
            yield self._group(tuple(some), contacts)

    def _group(self, members: tuple[str, ...], contacts: tuple[Any, ...]) -> Group:
        surfaces, down = self.surfaces, gravity_direction(self.surfaces)
        assert down is not None
        strength = float(np.linalg.norm(surfaces.candidate.spec.simulation.gravity))
        centers, weights, sizes = [], [], []
        for at in members:
            names = [n for n, label in self.piece.items() if label == at]
            masses = np.array([motion.entity_mass(surfaces.candidate, n) for n in names])
            places = np.array([surfaces.candidate.center(n, 0) for n in names])
            centers.append(masses @ places / masses.sum())
            weights.append(strength * masses.sum())
            sizes.append(0.5 * sum(surfaces.size(n) for n in names))
        return Group(members, contacts, np.array(centers), np.array(weights), np.array(sizes), down)


def balanced_rows(held: Held) -> list[Row]:
    """Rows `support:balance:<entity>` of things that never move and stand on others, by what nothing but contact from below holds them."""
    surfaces = held.surfaces
    if gravity_direction(surfaces) is None or not held.names:
        return []

    def found() -> list[Row]:
        pieces = _Pieces(held)
        down = gravity_direction(surfaces)
        assert down is not None
        groups = list(hanging([n for n in held.names if not held.loose(n)], pieces.ground, pieces.touching, pieces.stands))
        hung = hung_rows(surfaces, groups, pieces.hooked, down)
        return hung + [
            row_of(surfaces.candidate, BALANCE, (at,), _tips(pieces, group, at, balance), entities=(at,))
            for group in pieces.groups()
            for at, balance in solve(group, shift=OUTSIDE).items()
        ]

    return rows_of(surfaces.candidate, HELD, (), found)


def _tips(pieces: _Pieces, group: Group, at: str, balance: Balance) -> Finding:
    candidate = pieces.surfaces.candidate
    own = [n for n, label in pieces.piece.items() if label == at]
    on = sorted({a for a, b in pieces.stands if b in own and a not in own})
    what = repr(at) if len(own) == 1 else f"{at!r} with {', '.join(map(repr, sorted(set(own) - {at})[:4]))}"
    ok = balance.shift <= OUTSIDE
    where = "over" if ok else f"{balance.shift * 1e3:.4g} mm outside of"
    return Finding(
        "pass" if ok else "fail",
        f"the centre of mass of {what} lies {where} where contact with {', '.join(map(repr, on[:4]))} can hold it",
        balance.shift,
        OUTSIDE,
        hints=() if ok else tuple(_corrections(pieces, at, on, balance)),
        evidence={"carriers": on, "group": list(group.members)[:20]},
        entities=(at, *on[:4]),
        frames=(0, 0),
        predicate=f"the centre of mass of {at}, seen along gravity, lies within {OUTSIDE:g} m of where its contacts can hold it",
        extra=[candidate.spec.entities[at].afloat, *sorted(own)],
    )


def _corrections(pieces: _Pieces, at: str, on: Sequence[str], balance: Balance) -> Iterator[Correction]:
    carrier = on[0] if on else "the ground"
    length = balance.shift * 1e3
    surfaces, way = pieces.surfaces, balance.way * (1.0 + OUTSIDE / balance.shift)
    yield move_by(
        surfaces.candidate,
        at,
        way if in_the_way(surfaces, surfaces.parts_of[at], way) is None else None,
        f"{at!r} stands on too little, and would tip",
        f"Move {at!r} at least {length:.4g} mm towards the middle of what it stands on, or put more under it.",
    )
    yield correction(
        f"{at!r} is bolted, glued or built into {carrier!r}",
        "relations",
        f"Say so: a `fastened` relation of {carrier!r} and {at!r} with the reason, which is printed; or give {at!r} a foot that reaches farther.",
        pointers=("/graph/relations", pointer("entities", at, "parts")),
    )
