"""Plans of one storey: rooms as rectangles that tile a rectangle, found by constraint programming (R48, R95).

Source of the formulation: exact cover by rectangles with no-overlap and area constraints, as in the examples of OR-tools (CP-SAT,
`cover_rectangle_sat`); ranges of areas and widths after Infinigen Indoors (Raistrick et al. 2024, arXiv:2406.11824).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ...worlds.errors import InputError

__all__ = ["OUTSIDE", "Need", "Plan", "Rect", "solve_plan"]

CELL = 0.25
"""[m] Own choice: grid of plans; walls stand on its lines."""
OUTSIDE = "outside"
"""Name that stands for the outside among the doors of a room."""
SLACK = 0.3
"""Own choice: share by which a room's area may differ from what is asked for."""
EFFORT = 8.0
"""Deterministic time of the solver, about seconds on one core: the same on every machine."""
TIDY = 4
"""Own choice: weight of the difference of a room's sides against that of its area, both in cells."""


@dataclass(frozen=True)
class Need:
    """Area, doors and daylight of a room."""

    area: float
    """[m^2]"""
    width: float
    """Least clear side [m]."""
    aspect: float
    """Longest side over the shortest, at most."""
    doors: tuple[str, ...] = ()
    """Rooms to which a door leads, or `OUTSIDE`."""
    daylight: bool = False
    """It has a side on the outside."""


@dataclass(frozen=True)
class Rect:
    """A rectangle of the plan between the middles of its walls [m]."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def area(self) -> float:
        """[m^2]"""
        return (self.x1 - self.x0) * (self.y1 - self.y0)


@dataclass(frozen=True)
class Plan:
    """Rooms of a storey, its corner at the origin."""

    width: float
    """Extent x [m]."""
    depth: float
    """Extent y [m]."""
    rooms: Mapping[str, Rect]


def solve_plan(needs: Mapping[str, Need], *, size: tuple[float, float] | None, wall: float, door: float, seed: int) -> Plan:
    """A plan in which every room has its area, its doors and its daylight.

    Args:
        needs: of every room, by id.
        size: extent x, y between the middles of the outer walls [m]; None finds one.
        wall: thickness of walls [m].
        door: width of an opening with its frame [m].
        seed: of the plan among those that are as good.

    Raises:
        InputError: there is no such plan, with what does not fit where it is known.
    """
    whole = sum(n.area for n in needs.values())
    if size is None:
        options = [_near(whole, ratio) for ratio in (1.3, 1.0, 1.6)]
    else:
        options = [(max(1, round(size[0] / CELL)), max(1, round(size[1] / CELL)))]
        room = options[0][0] * options[0][1] * CELL**2
        if abs(room / whole - 1) > SLACK:
            raise InputError(
                f"size {size[0]:g} x {size[1]:g} m has {room:.1f} m^2, the rooms ask for {whole:.1f} m^2; both may differ by {100 * SLACK:.0f} %: "
                "change size or areas, or leave size out"
            )
    for extent in options:
        found = _solved(needs, extent, wall, door, seed)
        if found is not None:
            return Plan(extent[0] * CELL, extent[1] * CELL, found)
    doors = sum(len(n.doors) for n in needs.values())
    raise InputError(
        f"no plan of {len(needs)} rooms of {whole:.0f} m^2 has all of the {doors} doors asked for, daylight, least widths and aspects; "
        "ask for fewer doors or windows, more area for halls, or another size"
    )


def _near(area: float, ratio: float) -> tuple[int, int]:
    """Cells of a rectangle of nearly an area."""
    depth = round(math.sqrt(area / ratio) / CELL)
    return max(1, round(area / CELL**2 / depth)), depth


def _solved(needs: Mapping[str, Need], extent: tuple[int, int], wall: float, door: float, seed: int) -> dict[str, Rect] | None:
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    wide, deep = extent
    scale = wide * deep * CELL**2 / sum(n.area for n in needs.values())
    boxes, terms, areas = {}, [], []
    for name, need in needs.items():
        least = max(2, math.ceil((need.width + wall) / CELL))
        goal = scale * need.area / CELL**2
        x, y, x1, y1 = (model.new_int_var(0, top, f"{name}_{k}") for k, top in enumerate((wide, deep, wide, deep)))
        w, d = model.new_int_var(least, wide, f"{name}_w"), model.new_int_var(least, deep, f"{name}_d")
        area = model.new_int_var(math.floor((1 - SLACK) * goal), math.ceil((1 + SLACK) * goal), f"{name}_area")
        model.add_multiplication_equality(area, [w, d])
        areas.append(area)
        model.add(100 * w <= round(100 * need.aspect) * d)
        model.add(100 * d <= round(100 * need.aspect) * w)
        boxes[name] = (
            x,
            y,
            w,
            d,
            x1,
            y1,
            model.new_interval_var(x, w, x1, f"{name}_ix"),
            model.new_interval_var(y, d, y1, f"{name}_iy"),
        )
        off, slim = model.new_int_var(0, wide * deep, f"{name}_off"), model.new_int_var(0, max(wide, deep), f"{name}_slim")
        model.add_abs_equality(off, area - round(goal))
        model.add_abs_equality(slim, w - d)
        terms += [off, TIDY * slim] if need.aspect <= 3 else [off]
        if need.daylight:
            model.add_bool_or(_at_edge(model, boxes[name], extent, name))
    model.add_no_overlap_2d([b[6] for b in boxes.values()], [b[7] for b in boxes.values()])
    model.add(sum(areas) == wide * deep)
    reach = math.ceil((door + wall) / CELL)
    for a, b in _pairs(needs):
        if b == OUTSIDE:
            model.add_bool_or(_at_edge(model, boxes[a], extent, f"{a}_door"))
        else:
            _share(model, boxes[a], boxes[b], reach, f"{a}_{b}")
    model.minimize(sum(terms))
    solver = cp_model.CpSolver()
    solver.parameters.random_seed = seed % 2**31
    solver.parameters.num_workers = 1
    solver.parameters.max_deterministic_time = EFFORT
    if solver.solve(model) not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        return None
    value = solver.value
    found = {n: Rect(*(CELL * value(v) for v in (b[0], b[1], b[4], b[5]))) for n, b in boxes.items()}
    return found if seed % 2 == 0 else {n: Rect(wide * CELL - r.x1, r.y0, wide * CELL - r.x0, r.y1) for n, r in found.items()}


def _pairs(needs: Mapping[str, Need]) -> list[tuple[str, str]]:
    """Pairs of rooms between which a door leads, each once, in order."""
    found: dict[frozenset[str], tuple[str, str]] = {}
    for name, need in needs.items():
        for other in need.doors:
            if other != OUTSIDE and other not in needs:
                raise InputError(
                    f"room {name!r} has a door to {other!r}, which is no room; there are {sorted(needs)} and {OUTSIDE!r}"
                )
            found.setdefault(frozenset((name, other)), (name, other))
    return list(found.values())


def _at_edge(model: Any, box: Sequence[Any], extent: tuple[int, int], name: str) -> list[Any]:
    """Literals of which each says that a room touches a side of the plan."""
    literals = []
    for side, (variable, value) in enumerate(((box[0], 0), (box[1], 0), (box[4], extent[0]), (box[5], extent[1]))):
        literal = model.new_bool_var(f"{name}_edge_{side}")
        model.add(variable == value).only_enforce_if(literal)
        literals.append(literal)
    return literals


def _share(model: Any, a: Sequence[Any], b: Sequence[Any], reach: int, name: str) -> None:
    """Ask that two rooms have so many cells of a wall in common."""
    literals = []
    for side, (end, start, across) in enumerate(((a[4], b[0], 1), (b[4], a[0], 1), (a[5], b[1], 0), (b[5], a[1], 0))):
        literal = model.new_bool_var(f"{name}_share_{side}")
        low, high = across, 4 + across
        model.add(end == start).only_enforce_if(literal)
        model.add(a[high] - b[low] >= reach).only_enforce_if(literal)
        model.add(b[high] - a[low] >= reach).only_enforce_if(literal)
        literals.append(literal)
    model.add_bool_or(literals)
