"""Plans found by constraint programming, and refusals of those that cannot be (R48, R95).

Source of the formulation: exact cover by rectangles with no-overlap and area constraints, as in the examples of OR-tools (CP-SAT,
`cover_rectangle_sat`); ranges of areas and widths after Infinigen Indoors (Raistrick et al. 2024, arXiv:2406.11824).
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from ...worlds.errors import InputError
from .plan_model import solved
from .plans import CELL, OUTSIDE, SLACK, Need, Plan, Side, cells

__all__ = ["solve_plans"]

MOST_STRETCH = 2.5
"""Own choice: factor by which rooms of which no area is asked for grow, so that a storey fills the one below it."""
RATIOS = (1.3, 1.0, 1.6)
LONG_RATIOS = (1.3, 1.8, 2.4, 1.0)
"""Own choice: extent x over y of plans, tried in order; the second with corridors."""
FEW = 3
"""Own choice: fewer rooms beside a stairwell often do not fill a rectangle."""


def solve_plans(
    needs: Mapping[str, Need],
    *,
    size: tuple[float, float] | None,
    wall: float,
    door: float,
    seed: int,
    entrance: Side | None = None,
) -> tuple[Plan, ...]:
    """Plans of all storeys in which every room has its area, its doors and its daylight, and stairwells stand over each other.

    Args:
        needs: of every room, by id.
        size: extent x, y between the middles of the outer walls [m]; None finds one.
        wall: thickness of walls [m].
        door: width of an opening with its frame [m].
        seed: of the plan among those that are as good.
        entrance: side on which rooms with a door to the outside lie; None for any.

    Raises:
        InputError: there is no such plan, with what does not fit where it is known.
    """
    pairs = _pairs(needs)
    _check_storeys(needs, pairs)
    count = 1 + max(s for n in needs.values() for s in n.storeys)
    sums = [sum(_area(n, wall) for n in needs.values() if s in n.storeys) for s in range(count)]
    if size is None:
        ratios = LONG_RATIOS if any(n.corridor for n in needs.values()) else RATIOS
        options = [_near(max(sums), ratio) for ratio in ratios]
        for need in needs.values():
            if need.well is not None and need.straight:
                # A long well runs from wall to wall of a small house, or leaves no room at its end.
                long = cells(max(need.well) + wall)
                across = max(1, round(max(sums) / CELL**2 / long))
                options = [(across, long), *options, (long, across)]
    else:
        options = [(max(1, round(size[0] / CELL)), max(1, round(size[1] / CELL)))]
    for storey, whole in enumerate(sums):
        _check_area(needs, storey, whole, options[0], size)
    for extent in options:
        found = solved(needs, pairs, extent, wall=wall, door=door, seed=seed, entrance=entrance)
        if found is not None:
            return found
    few = [s for s in range(count) if any(n.well and s in n.storeys for n in needs.values()) and _rooms_on(needs, s) < FEW]
    beside = "".join(f" (storey {s} has {_rooms_on(needs, s)} rooms beside its stairs: more of them fill it better)" for s in few)
    raise InputError(
        f"no plan of {len(needs)} rooms of {max(sums):.0f} m^2{beside} has all of the {len(pairs)} doors asked for, daylight, least widths and "
        "aspects; ask for fewer doors or windows, more area for halls, or another size"
    )


def _rooms_on(needs: Mapping[str, Need], storey: int) -> int:
    """Rooms of a storey that are no stairwells."""
    return sum(storey in n.storeys and n.well is None for n in needs.values())


def _area(need: Need, wall: float) -> float:
    """Area that a room takes of a plan [m^2]."""
    if need.well is None:
        return need.area
    return math.prod(cells(side + wall) * CELL for side in need.well)


def _check_area(
    needs: Mapping[str, Need], storey: int, whole: float, extent: tuple[int, int], size: tuple[float, float] | None
) -> None:
    """Refuse a storey whose rooms would have to be stretched or shrunk too far."""
    room = extent[0] * extent[1] * CELL**2
    asked = (size is not None and storey == 0) or any(n.asked for n in needs.values() if storey in n.storeys and n.well is None)
    most = 1 + SLACK if asked else MOST_STRETCH
    if whole == 0:
        raise InputError(f"storey {storey} has no rooms; number storeys from 0 without a gap")
    if not 1 - SLACK <= room / whole <= most:
        told = f"size {size[0]:g} x {size[1]:g} m" if size is not None else "the plan of the largest storey"
        raise InputError(
            f"{told} has {room:.1f} m^2, the rooms of storey {storey} ask for {whole:.1f} m^2; both may differ by {100 * SLACK:.0f} % "
            "(rooms without an area of their own may grow more): change size or areas, or leave size out"
        )


def _check_storeys(needs: Mapping[str, Need], pairs: list[tuple[str, str]]) -> None:
    """Refuse doors between storeys, and wells of stairs with two doors on one storey."""
    taken: dict[tuple[str, int], str] = {}
    for a, b in pairs:
        if b == OUTSIDE:
            if 0 not in needs[a].storeys:
                raise InputError(f"room {a!r} on storey {needs[a].storeys[0]} has a door to the outside; only storey 0 has")
            continue
        both = sorted({*needs[a].storeys} & {*needs[b].storeys})
        if not both:
            raise InputError(
                f"rooms {a!r} and {b!r} are on storeys {needs[a].storeys[0]} and {needs[b].storeys[0]}; a door leads to stairs "
                "(a room of kind 'stairs'), which lead to the other storey"
            )
        for well, other in ((a, b), (b, a)):
            if needs[well].well is not None and not needs[well].straight and (well, both[0]) in taken:
                raise InputError(
                    f"stairs {well!r} have doors to {taken[well, both[0]]!r} and {other!r} on storey {both[0]}; one fits: let it lead to a hall"
                )
            if needs[well].well is not None:
                taken[well, both[0]] = other


def _near(area: float, ratio: float) -> tuple[int, int]:
    """Cells of a rectangle of nearly an area."""
    depth = round(math.sqrt(area / ratio) / CELL)
    return max(1, round(area / CELL**2 / depth)), depth


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
