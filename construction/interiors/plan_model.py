"""The constraints of plans, for CP-SAT: rooms of every storey, corridors with steps, stairwells that stand over each other."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, get_args

from .plans import CELL, OUTSIDE, SLACK, STEPS, UPPER, WING, Need, Plan, Rect, Side, cells

__all__ = ["solved"]

EFFORT = 8.0
"""Deterministic time of the solver, about seconds on one core: the same on every machine."""
TIDY = 4
"""Own choice: weight of the difference of a room's sides against that of its area, both in cells."""
BETWEEN = 3
"""Own choice: a corridor with so many doors to rooms has rooms on both sides."""
LEAST_PART = 2.5
"""[m] Own choice: length of a corridor below and above its steps, at least."""
LEAST_WING, LEAST_NOTCH = 1.5, 1.0
"""[m] Own choice: clear sides of the wing of an L-shaped room, and how much narrower it is than the room, at least."""
WING_SHARE = (25, 70)
"""[%] Own choice: area of the wing against that of the rest of its room."""
EACH = 3
"""Own choice: one of so many rooms beside a corridor with steps at least is on either level."""
SIDES: tuple[Side, ...] = get_args(Side)
OPPOSITE: Mapping[Side, Side] = {"west": "east", "east": "west", "south": "north", "north": "south"}
LEFT: Mapping[Side, Side] = {"south": "west", "north": "east", "west": "north", "east": "south"}
"""Side on the left of who climbs straight from a front."""
FLIPPED: Mapping[Side, Side] = {"west": "east", "east": "west", "south": "south", "north": "north"}


class _Box(NamedTuple):
    """Variables of a room, in cells."""

    x: Any
    y: Any
    w: Any
    d: Any
    x1: Any
    y1: Any
    ix: Any
    iy: Any
    area: Any


def solved(
    needs: Mapping[str, Need],
    pairs: Sequence[tuple[str, str]],
    extent: tuple[int, int],
    *,
    wall: float,
    door: float,
    seed: int,
    entrance: Side | None,
) -> tuple[Plan, ...] | None:
    """Plans of all storeys on a rectangle of so many cells; None where there are none, or none is found in the time."""
    from ortools.sat.python import cp_model

    flipped = seed % 2 == 1
    made = _Model(needs, extent, wall, cells(door + wall))
    for a, b in pairs:
        made.join(a, b, FLIPPED[entrance] if entrance and flipped else entrance)
    made.finish(pairs)
    solver = cp_model.CpSolver()
    solver.parameters.random_seed = seed % 2**31
    solver.parameters.num_workers = 1
    solver.parameters.max_deterministic_time = EFFORT
    if solver.solve(made.model) not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        return None
    return made.plans(solver, pairs, flipped=flipped)


class _Model:
    """Variables and constraints of the rooms of all storeys."""

    def __init__(self, needs: Mapping[str, Need], extent: tuple[int, int], wall: float, reach: int) -> None:
        from ortools.sat.python import cp_model

        self.needs, self.extent, self.wall, self.reach = needs, extent, wall, reach
        self.model = cp_model.CpModel()
        self.boxes: dict[str, _Box] = {}
        self.storeys: dict[str, tuple[int, ...]] = {}
        self.upper: dict[str, Any] = {}
        """Literal of each room on a storey with steps: its floor is the upper one."""
        self.front: dict[str, list[Any]] = {}
        self.mirrored: dict[str, Any] = {}
        """Literal of each stairwell with a straight flight: it is on the right."""
        self.ways: dict[tuple[str, str], list[Any]] = {}
        """Literals of each pair of parts of rooms of which one says that a door has a place between them."""
        self.terms: list[Any] = []
        self.stepped = {s for n in needs.values() if n.flight for s in n.storeys}
        for name, need in needs.items():
            self._room(name, need)
        for storey in range(1 + max(s for n in needs.values() for s in n.storeys)):
            here = [self.boxes[n] for n, s in self.storeys.items() if storey in s]
            self.model.add_no_overlap_2d([b.ix for b in here], [b.iy for b in here])
            self.model.add(sum(b.area for b in here) == extent[0] * extent[1])

    def _box(self, name: str, storeys: tuple[int, ...], least: int) -> _Box:
        model, (wide, deep) = self.model, self.extent
        x, y, x1, y1 = (model.new_int_var(0, top, f"{name}_{k}") for k, top in enumerate((wide, deep, wide, deep)))
        w, d = model.new_int_var(least, wide, f"{name}_w"), model.new_int_var(least, deep, f"{name}_d")
        area = model.new_int_var(least * least, wide * deep, f"{name}_area")
        model.add_multiplication_equality(area, [w, d])
        ix, iy = model.new_interval_var(x, w, x1, f"{name}_ix"), model.new_interval_var(y, d, y1, f"{name}_iy")
        self.boxes[name] = box = _Box(x, y, w, d, x1, y1, ix, iy, area)
        self.storeys[name] = storeys
        return box

    def _room(self, name: str, need: Need) -> None:
        model = self.model
        if need.well is not None:
            self._well(name, need, need.well)
        elif need.corridor:
            self._corridor(name, need)
        else:
            box = self._box(name, need.storeys, max(2, cells(need.width + self.wall)))
            goal, area = self._scale(need.storeys[0]) * need.area / CELL**2, box.area
            if need.wing:
                area += self._wing(name, need, box).area
            model.add(area >= math.floor((1 - SLACK) * goal))
            model.add(area <= math.ceil((1 + SLACK) * goal))
            model.add(100 * box.w <= round(100 * need.aspect) * box.d)
            model.add(100 * box.d <= round(100 * need.aspect) * box.w)
            wide, deep = self.extent
            off, slim = model.new_int_var(0, wide * deep, f"{name}_off"), model.new_int_var(0, max(wide, deep), f"{name}_slim")
            model.add_abs_equality(off, area - round(goal))
            model.add_abs_equality(slim, box.w - box.d)
            self.terms += [off, TIDY * slim] if need.aspect <= 3 else [off]
        if need.storeys[0] in self.stepped and name not in self.upper:
            self.upper[name] = model.new_constant(0) if need.well else model.new_bool_var(f"{name}_upper")
            self.upper |= dict.fromkeys(self._parts(name), self.upper[name])
        if need.daylight:
            model.add_bool_or([lit for part in self._parts(name) for lit in self._at_edge(self.boxes[part], part)])

    def _parts(self, name: str) -> list[str]:
        """Boxes of a room: one, or two of an L-shaped one."""
        return [name, f"{name}_{WING}"] if name in self.needs and self.needs[name].wing else [name]

    def _wing(self, name: str, need: Need, main: _Box) -> _Box:
        """The second box of an L-shaped room: on one side of the first, flush with one of its ends and shorter by a notch."""
        model, key, notch = self.model, f"{name}_{WING}", cells(LEAST_NOTCH)
        box = self._box(key, need.storeys, cells(LEAST_WING + self.wall))
        least, most = WING_SHARE
        model.add(100 * box.area >= least * main.area)
        model.add(100 * box.area <= most * main.area)
        model.add(100 * box.w <= round(100 * need.aspect) * box.d)
        model.add(100 * box.d <= round(100 * need.aspect) * box.w)
        cases = []
        for side, meets in zip(SIDES, ((box.x1, main.x), (box.y1, main.y), (main.x1, box.x), (main.y1, box.y)), strict=True):
            low, high = ("y", "y1") if side in ("west", "east") else ("x", "x1")
            for flush, other, sign in ((low, high, 1), (high, low, -1)):
                literal = model.new_bool_var(f"{key}_{side}_{flush}")
                model.add(meets[0] == meets[1]).only_enforce_if(literal)
                model.add(getattr(box, flush) == getattr(main, flush)).only_enforce_if(literal)
                model.add(sign * (getattr(main, other) - getattr(box, other)) >= notch).only_enforce_if(literal)
                cases.append(literal)
        model.add_exactly_one(cases)
        return box

    def _scale(self, storey: int) -> float:
        """Area that the rooms of a storey get over what they ask for; wells and corridors are as they are."""
        left, asked = self.extent[0] * self.extent[1] * CELL**2, 0.0
        for need in self.needs.values():
            if storey in need.storeys:
                if need.well is None:
                    asked += need.area
                else:
                    left -= math.prod(cells(s + self.wall) * CELL for s in need.well)
        return left / asked

    def _well(self, name: str, need: Need, well: tuple[float, float]) -> None:
        """A stairwell of fixed sides; one of its short sides is the front."""
        model, (across, along) = self.model, (cells(side + self.wall) for side in well)
        box = self._box(name, need.storeys, min(across, along))
        self.front[name] = sides = [model.new_bool_var(f"{name}_front_{s}") for s in SIDES]
        model.add_exactly_one(sides)
        if need.straight:
            self.mirrored[name] = model.new_bool_var(f"{name}_mirrored")
        for side, literal in zip(SIDES, sides, strict=True):
            w, d = (along, across) if side in ("west", "east") else (across, along)
            model.add(box.w == w).only_enforce_if(literal)
            model.add(box.d == d).only_enforce_if(literal)

    def _corridor(self, name: str, need: Need) -> None:
        """A corridor of its width; with steps in three parts in a row: below, the flight, above."""
        model, width = self.model, cells(need.width + self.wall)
        along = model.new_bool_var(f"{name}_along_x")
        names = [name, f"{name}_{STEPS}", f"{name}_{UPPER}"] if need.flight else [name]
        least = [cells(LEAST_PART), 2, cells(LEAST_PART)] if need.flight else [2]
        boxes = [self._box(n, need.storeys, 2) for n in names]
        first = boxes[0]
        for literal, across in ((along, "d"), (along.negated(), "w")):
            for box in boxes:
                model.add(getattr(box, across) == width).only_enforce_if(literal)
        model.add(first.w >= first.d).only_enforce_if(along)
        model.add(first.d >= first.w).only_enforce_if(along.negated())
        inner = sum(1 for n in self.needs.values() if name in n.doors) + sum(d != OUTSIDE for d in need.doors) >= BETWEEN
        for literal, low, high, end in ((along, "y", "y1", self.extent[1]), (along.negated(), "x", "x1", self.extent[0])):
            if inner:
                model.add(getattr(first, low) > 0).only_enforce_if(literal)
                model.add(getattr(first, high) < end).only_enforce_if(literal)
            for box in boxes[1:]:
                model.add(getattr(box, low) == getattr(first, low)).only_enforce_if(literal)
        # A plan may be turned over, so that the upper part need only be tried on one side.
        for one, two in itertools.pairwise(boxes):
            model.add(one.x1 == two.x).only_enforce_if(along)
            model.add(one.y1 == two.y).only_enforce_if(along.negated())
        for box, long in zip(boxes, least, strict=True):
            model.add(box.w >= long).only_enforce_if(along)
            model.add(box.d >= long).only_enforce_if(along.negated())
        if need.flight:
            model.add(boxes[1].w == cells(need.flight)).only_enforce_if(along)
            model.add(boxes[1].d == cells(need.flight)).only_enforce_if(along.negated())
            self.upper |= {n: model.new_constant(int(k > 0)) for k, n in enumerate(names)}

    def _at_edge(self, box: _Box, name: str) -> list[Any]:
        """Literals of which each says that a room touches a side of the plan."""
        literals, (wide, deep) = [], self.extent
        for side, (variable, value) in enumerate(((box.x, 0), (box.y, 0), (box.x1, wide), (box.y1, deep))):
            literal = self.model.new_bool_var(f"{name}_edge_{side}")
            self.model.add(variable == value).only_enforce_if(literal)
            literals.append(literal)
        return literals

    def join(self, a: str, b: str, entrance: Side | None) -> None:
        """Ask for a wall between two rooms, or to the outside (on a side, where one is given), that is wide enough for a door."""
        if b == OUTSIDE:
            for part in self._parts(a):
                literals = self._at_edge(self.boxes[part], f"{part}_door")
                self.ways[part, b] = literals if entrance is None else [literals[SIDES.index(entrance)]]
            self.model.add_bool_or([lit for part in self._parts(a) for lit in self.ways[part, b]])
            if a in self.upper:
                self.model.add(self.upper[a] == 0)
            return
        one, two = (a, b) if self.needs[b].flight else (b, a)
        if not self.needs[two].flight:
            self.model.add_bool_or(self._between(self._parts(a), self._parts(b)))
            if a in self.upper and b in self.upper:
                self.model.add(self.upper[a] == self.upper[b])
            return
        for part, literal in ((two, self.upper[one].negated()), (f"{two}_{UPPER}", self.upper[one])):
            self.model.add_bool_or(self._between(self._parts(one), [part])).only_enforce_if(literal)

    def _between(self, ones: Sequence[str], twos: Sequence[str]) -> list[Any]:
        """Literals of which each says that a door has a place between two of these parts of rooms."""
        for one, two in itertools.product(ones, twos):
            self.ways[one, two] = self.ways[two, one] = self._share(one, two)
        return [literal for pair in itertools.product(ones, twos) for literal in self.ways[pair]]

    def _share(self, a: str, b: str) -> list[Any]:
        """Literals of which each says that two rooms have enough cells of a wall in common on one side of the first."""
        model, one, two, literals = self.model, self.boxes[a], self.boxes[b], []
        cases: tuple[tuple[Side, Any, Any, int], ...] = (
            ("east", one.x1, two.x, 1),
            ("west", two.x1, one.x, 1),
            ("north", one.y1, two.y, 0),
            ("south", two.y1, one.y, 0),
        )
        for side, end, start, across in cases:
            literal = model.new_bool_var(f"{a}_{b}_share_{side}")
            low, high = across, 4 + across
            model.add(end == start).only_enforce_if(literal)
            model.add(one[high] - two[low] >= self.reach).only_enforce_if(literal)
            model.add(two[high] - one[low] >= self.reach).only_enforce_if(literal)
            for well, own in ((a, side), (b, OPPOSITE[side])):
                if well in self.mirrored:
                    self._beside_flight(well, own, literal)
                elif well in self.front:
                    model.add_implication(literal, self.front[well][SIDES.index(own)])
            literals.append(literal)
        return literals

    def _beside_flight(self, well: str, side: Side, literal: Any) -> None:
        """A door on a side of a stairwell: its straight flight is not along that side."""
        for front, faces in zip(SIDES, self.front[well], strict=True):
            on_left, on_right = side == LEFT[front], side == OPPOSITE[LEFT[front]]
            if on_left or on_right:
                mirrored = self.mirrored[well]
                self.model.add_bool_or([literal.negated(), faces.negated(), mirrored if on_left else mirrored.negated()])

    def finish(self, pairs: Sequence[tuple[str, str]]) -> None:
        """Rooms on both levels beside a corridor with steps, and what is to be least."""
        for name, need in self.needs.items():
            beside = [a if b == name else b for a, b in pairs if name in (a, b) and OUTSIDE not in (a, b)] if need.flight else []
            least = max(1, len(beside) // EACH)
            if len(beside) > 1:
                self.model.add(sum(self.upper[r] for r in beside) >= least)
                self.model.add(sum(self.upper[r] for r in beside) <= len(beside) - least)
        self.model.minimize(sum(self.terms))

    def plans(self, solver: Any, pairs: Sequence[tuple[str, str]], *, flipped: bool) -> tuple[Plan, ...]:
        """Plans of the storeys from the values that were found."""
        value, (wide, deep) = solver.value, (CELL * side for side in self.extent)
        rects = {n: Rect(*(CELL * value(v) for v in (b.x, b.y, b.x1, b.y1))) for n, b in self.boxes.items()}
        fronts = {n: SIDES[[value(v) for v in sides].index(1)] for n, sides in self.front.items()}
        mirrored = {n for n, v in self.mirrored.items() if bool(value(v)) != flipped}
        if flipped:
            rects = {n: Rect(wide - r.x1, r.y0, wide - r.x0, r.y1) for n, r in rects.items()}
            fronts = {n: FLIPPED[s] for n, s in fronts.items()}
        raised = frozenset(n for n, v in self.upper.items() if value(v) and not n.endswith(f"_{STEPS}"))
        doors = []
        for a, b in pairs:
            for name, other in ((a, b), (b, a)):
                if b != OUTSIDE and self.needs[name].flight and other in raised:
                    a, b = (f"{a}_{UPPER}", b) if a == name else (a, f"{b}_{UPPER}")
            ends = itertools.product(self._parts(a), [b] if b == OUTSIDE else self._parts(b))
            doors.append(next(pair for pair in ends if any(value(v) for v in self.ways[pair])))
        count = 1 + max(s for own in self.storeys.values() for s in own)
        found = []
        for storey in range(count):
            here = {n: r for n, r in rects.items() if storey in self.storeys[n]}
            inside = tuple((a, b) for a, b in doors if a in here and (b in here or (b == OUTSIDE and storey == 0)))
            own = {n: s for n, s in fronts.items() if n in here}
            found.append(Plan(wide, deep, here, raised & set(here), own, frozenset(mirrored & set(here)), inside))
        return tuple(found)
