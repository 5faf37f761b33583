"""The part of a program that a room has space for, decided before anything is placed (R95).

Two budgets, floor and wall: a small room, or one whose walls are doors, asks for less furniture, the least important left out first, and
for smaller sizes of it. All that is granted here has to find a place afterwards.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .arrangement import Frame
from .faces import common_area, free_wall
from .floor_space import FloorSpace
from .pieces import Piece, Stock
from .wishes import RoomKind, Wish

__all__ = ["Fitted", "Item", "everything", "fitted"]

USE_SHARE = 0.2
"""Own choice: share of the floor from which a thing is used that counts; ways and other things use it too."""
WALL_SHARE = 0.8
"""Own choice: share of the length of walls beside doors along which furniture stands, at most."""
TALL_SHARE = 0.76
"""Own choice: the same of walls beside doors and windows, for what is higher than a sill or hangs there."""
RUG_SHARE = 0.25
"""Own choice: share of the floor that is left which a rug covers, at most."""
BETWEEN = 0.05
"""[m] Own choice: wall that a thing takes beyond its width."""
HIGH = 0.905
"""[m] Own choice: what is higher stands in front of windows."""
OVERHEAD = 2.0
"""[m] Own choice: windows that begin higher leave the wall below them to furniture and what hangs."""
MOST = {"above": 1, "on": 1, "before": 1, "facing": 1, "beside": 2}
"""Companions of a thing by rule, at most."""
GROUND = ("wall", "row", "free", "around", "before", "facing", "beside", "pairs", "line")
ALONG_WALLS = ("wall", "row", "facing")


@dataclass(eq=False)
class Item:
    """One thing that a room asks for."""

    wish: Wish
    pieces: list[Piece]
    """Its sizes, the most welcome first."""
    size: int
    """Index of the first of these that is tried."""
    companions: list[Item] = field(default_factory=list)
    """Things that belong to it and are placed with it."""
    number: int = 0
    """Which of those of its wish it is, from 0."""

    @property
    def name(self) -> str:
        """Generator of it."""
        return self.pieces[0].generator

    @property
    def claim(self) -> float:
        """Floor that it and its companions take, with a share of what they are used from [m^2]."""
        return _floor(self.wish, self.pieces[self.size]) + sum(c.claim for c in self.companions)


class Fitted(NamedTuple):
    """Things that a room asks for after its program was fitted to its size."""

    items: list[Item]
    """Needed, in order of importance; companions stand in theirs."""
    extras: list[Item]
    """Welcome."""
    left_out: list[str]
    """Sentences about what the room is too small for."""


@dataclass
class _Budget:
    floor: float
    """[m^2]"""
    wall: float
    """[m]"""
    tall: float
    """[m]"""

    def allows(self, cost: tuple[float, float, float]) -> bool:
        return cost[0] <= self.floor and cost[1] <= self.wall and cost[2] <= self.tall

    def take(self, cost: tuple[float, float, float]) -> None:
        self.floor, self.wall, self.tall = self.floor - cost[0], self.wall - cost[1], self.tall - cost[2]

    def short_of(self, cost: tuple[float, float, float]) -> str:
        return "floor" if cost[0] > self.floor else "wall"


def fitted(frame: Frame, kind: RoomKind, space: FloorSpace, stock: Stock, rng: np.random.Generator) -> Fitted:
    """Choose what a room asks for: first all in their least sizes as long as the budgets last, then larger ones with what is left."""
    budget = _budget(space, kind.floor_share)
    items: list[Item] = []
    extras: list[Item] = []
    left_out: list[str] = []
    for wish in kind.wishes:
        low, high = wish.count
        for number in range(low + int(rng.integers(high - low + 1))):
            name = str(rng.choice(wish.generators))
            pieces = [stock.take(of or name, parameters) for of, parameters in wish.parameter_sets(frame.height)]
            item = Item(wish, pieces, len(pieces) - 1, number=number)
            anchors = [i for i in everything(items) if i.name == wish.to and i.wish.rule != "above" and _free_for(i, wish)]
            cost = _cost(item)
            if number >= low:
                extras.append(item)
            elif wish.to and not anchors:
                left_out.append(f"{frame.id}: no {name}, as there is no {wish.to} for it")
            elif not budget.allows(cost):
                left_out.append(f"{frame.id}: no {name}, as the room has too little {budget.short_of(cost)} left for it")
            else:
                budget.take(cost)
                if anchors:
                    min(anchors, key=lambda a: len(a.companions)).companions.append(item)
                else:
                    items.append(item)
    for item in everything(items):
        _enlarge(item, budget)
    return Fitted(items, extras, left_out)


def everything(items: list[Item]) -> list[Item]:
    """Items and their companions, and those of these."""
    return [j for i in items for j in (i, *everything(i.companions))]


def _free_for(anchor: Item, wish: Wish) -> bool:
    """True if a thing has not as many companions of a rule as there is place for."""
    return sum(c.wish.rule == wish.rule for c in anchor.companions) < MOST.get(wish.rule, len(anchor.companions) + 1)


def _enlarge(item: Item, budget: _Budget) -> None:
    least = _cost(item)
    for size in range(item.size):
        cost = _cost(Item(item.wish, item.pieces, size))
        more = (cost[0] - least[0], cost[1] - least[1], cost[2] - least[2])
        if budget.allows(more):
            budget.take(more)
            item.size = size
            return


def _floor(wish: Wish, piece: Piece) -> float:
    foot = piece.foot
    wide, deep = foot.x1 - foot.x0, foot.y1 - foot.y0
    if wish.rule == "flat":
        return RUG_SHARE * wide * deep
    return wide * (deep + USE_SHARE * wish.use) if wish.rule in GROUND else 0.0


def _cost(item: Item) -> tuple[float, float, float]:
    """Floor [m^2], wall [m], and wall without windows [m] that a thing takes."""
    wish, piece = item.wish, item.pieces[item.size]
    wide = piece.foot.x1 - piece.foot.x0 + BETWEEN
    along = wide if wish.rule in ALONG_WALLS else 0.0
    high = wide if wish.rule == "hung" or (along and piece.height > HIGH) else 0.0
    return _floor(wish, piece), along, high


def _budget(space: FloorSpace, floor_share: float) -> _Budget:
    r = space.room
    area = space.area - sum(common_area(d, r) for d in space.doors)
    windows = [rect for rect, sill in space.windows if sill < OVERHEAD]
    along, beside = free_wall(r, space.doors, notch=space.notch), free_wall(r, [*space.doors, *windows], notch=space.notch)
    return _Budget(floor_share * area, WALL_SHARE * along, TALL_SHARE * beside)
