"""Buildings on uneven ground: the floor at the height of the entrance, a plinth below the walls, steps before doors (R50)."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from ...worlds.spec import Interior
from .built import LOOSE, SLAB, BuiltInterior, block_entity, numbers
from .layout import Storey
from .plans import OUTSIDE, Plan, Rect
from .walls import Block, Opening

__all__ = ["Heights", "Site", "put_ground", "seated"]

Heights = Callable[[F64], F64]
"""Height of the ground [m] over points x, y of the world, shape (n, 2); NaN beside it."""
THRESHOLD = 0.03
"""[m] Own choice: floor over the ground before the entrance where nothing asks for more, so that rain stays outside."""
OVER = 0.05
"""[m] Own choice: floor over the highest ground under the building."""
RISE, TREAD, PLATFORM = 0.17, 0.3, 1.0
"""[m] Own choice: height of steps before a door at most, their depth, and that of the platform at the door (2 R + G = 0.64 m)."""
MOST_STEPS = 5
"""Own choice: more steps need railings (a fall of more than 0.6 m at their sides: UK Approved Document K 3.1)."""
MOST_PLINTH = 1.6
"""[m] Own choice: height of the plinth over the lowest ground; a building that stands higher needs a storey below."""
PIECE = 1.0
"""[m] Own choice: length of the pieces of a plinth, each of which follows the ground."""
DEEP = 0.12
"""[m] Own choice: how deep plinth and steps stand in the ground at their lowest place."""
LOWEST = 0.15
"""[m] Height of the pieces of a plinth, at least."""
SPACING = 0.25
"""[m] Own choice: places at which the ground is looked at."""
BESIDE = 0.2
"""[m] Own choice: how far platform and steps reach beyond the opening of a door on both sides."""
BEFORE = (1.2, 1.2)
"""[m] Own choice: extent across and along of the ground before a door from which it is entered."""


class _Front(NamedTuple):
    """The outside of a door: its middle on the outer face, and the ways out and across."""

    door: Opening
    middle: F64
    out: F64
    across: F64

    def rect(self, near: float, far: float, half: float) -> Rect:
        """A rectangle before the door, from `near` to `far` [m] away from the wall, in the plan."""
        ends = np.array([self.middle + self.out * d + self.across * s for d in (near, far) for s in (-half, half)])
        low, high = ends.min(0), ends.max(0)
        return Rect(float(low[0]), float(low[1]), float(high[0]), float(high[1]))


class Steps(NamedTuple):
    """Steps from the ground up to a door."""

    front: _Front
    number: int
    rise: float
    """Height of one step [m]; with no steps what remains from the ground to the floor."""

    @property
    def reach(self) -> float:
        """Their length from the wall [m]."""
        return PLATFORM + (self.number - 1) * TREAD if self.number else 0.0


class Site(NamedTuple):
    """A building's stand on the ground."""

    floor: float
    """Height of its lowest floor [m]."""
    steps: tuple[Steps, ...]
    """Before its doors to the outside, the entrance first."""
    heights: Heights
    """Ground under the plan: points of the plan, heights over the lowest floor."""
    lowest: float
    """Lowest ground under its outer walls over the floor, negative [m]."""


def _lattice(rect: Rect) -> F64:
    """Places of a rectangle, its edges included [m], shape (n, 2)."""
    xs = np.linspace(rect.x0, rect.x1, max(2, math.ceil((rect.x1 - rect.x0) / SPACING) + 1))
    ys = np.linspace(rect.y0, rect.y1, max(2, math.ceil((rect.y1 - rect.y0) / SPACING) + 1))
    return np.stack([v.ravel() for v in np.meshgrid(xs, ys)], axis=1)


def _whole(plan: Plan, wall: float) -> Rect:
    return Rect(-wall / 2, -wall / 2, plan.width + wall / 2, plan.depth + wall / 2)


def _front(door: Opening, plan: Plan, wall: float) -> _Front:
    x, y = door.center
    if door.along == "x":
        sign = -1.0 if y < plan.depth / 2 else 1.0
        return _Front(door, np.array([x, y + sign * wall / 2]), np.array([0.0, sign]), np.array([1.0, 0.0]))
    sign = -1.0 if x < plan.width / 2 else 1.0
    return _Front(door, np.array([x + sign * wall / 2, y]), np.array([sign, 0.0]), np.array([0.0, 1.0]))


def seated(interior: Interior, storey: Storey, ground: Heights) -> Site:
    """Find the floor of a building at its entrance: level with the ground there, and over all ground under the building.

    Raises:
        InputError: the ground is not there, or too steep, with the numbers.
    """
    plan, wall = storey.plan, interior.wall
    corner = np.array([interior.at[0] - plan.width / 2, interior.at[1] - plan.depth / 2])

    def at(points: F64) -> F64:
        found = ground(points + corner)
        if not np.isfinite(found).all():
            x, y = (points + corner)[~np.isfinite(found)][0]
            raise InputError(
                f"there is no ground of {interior.on!r} at x, y = {x:.4g}, {y:.4g} m, under or before the building of {plan.width:g} x "
                f"{plan.depth:g} m; move it by `at`, or build a larger ground"
            )
        return found

    fronts = [_front(d, plan, wall) for d in storey.doors if d.rooms[1] == OUTSIDE]
    if not fronts:
        raise InputError("a building on the ground has no entrance; give a room of storey 0 a door to 'outside'")
    under = at(_lattice(_whole(plan, wall)))
    entrance = at(_lattice(fronts[0].rect(0.1, 0.5, 0.5 * fronts[0].door.width)))
    floor = max(float(entrance.max()) + THRESHOLD, float(under.max()) + OVER)
    if floor - float(under.min()) > MOST_PLINTH:
        fall = float(under.max() - under.min())
        raise InputError(
            f"the ground under the building of {plan.width:g} x {plan.depth:g} m falls by {fall:.2f} m (slope about "
            f"{fall / math.hypot(plan.width, plan.depth):.2f}), its plinth would be {floor - float(under.min()):.2f} m high, at most "
            f"{MOST_PLINTH:g} m: level the place with a `flatten` layer of the terrain, choose a flatter one "
            "(inspect_world(part='terrain', find='flat')), or a smaller plan"
        )
    steps = tuple(_steps(front, at, floor) for front in fronts)
    return Site(floor, steps, lambda points: at(points) - floor, float(under.min()) - floor)


def _steps(front: _Front, at: Heights, floor: float) -> Steps:
    """The fewest steps that lead from the ground to a door."""
    half = front.door.width / 2
    rises = []
    for count in range(MOST_STEPS + 1):
        steps = Steps(front, count, 0.0)
        foot = at(_lattice(front.rect(steps.reach + 0.05, steps.reach + 0.3, half)))
        rise = floor - float(foot.min() if count == 0 else np.median(foot))
        if rise < -RISE:
            raise InputError(
                f"the ground before the door {front.door.id!r} lies {-rise:.2f} m over the floor, which follows the ground at the entrance; "
                "put that door on another side, or level the ground with a `flatten` layer"
            )
        if rise <= RISE * max(1, count):
            return steps._replace(rise=rise / max(1, count))
        rises.append(rise)
    raise InputError(
        f"the floor lies {rises[-1]:.2f} m over the ground {PLATFORM + (MOST_STEPS - 1) * TREAD:.1f} m before the door {front.door.id!r}: "
        f"more than {MOST_STEPS} steps of {RISE:g} m; turn the door uphill (`entrance`), level the ground with a `flatten` layer, or "
        "choose a flatter place"
    )


def put_ground(found: BuiltInterior, name: str, interior: Interior, plan: Plan, site: Site) -> None:
    """Write plinth, steps before doors, the ground before each door, and the ways in."""
    plinth = _plinth(plan, interior.wall, site)
    origin = found.place(0.0, 0.0, 0.0)
    key = f"{name}_plinth"
    found.entities[key] = block_entity("plinth of the building", "limestone", plinth, origin)
    found.supports(f"{name}_floor_lies", key, f"{name}_floor")
    sunk = {
        key: _depth(plinth, site),
        f"{name}_floor": max(0.0, float(site.heights(_lattice(_whole(plan, interior.wall))).max()) + SLAB),
    }
    for steps in site.steps:
        room = steps.front.door.rooms[0]
        if steps.number:
            blocks = _step_blocks(steps, site)
            own = f"{name}_{room}_steps_outside"
            found.entities[own] = block_entity("steps before the door", "limestone", blocks, origin)
            sunk[own] = _depth(blocks, site)
        _way_in(found, name, room, steps, site)
    for entity, depth in sunk.items():
        found.relations[f"{entity}_founded"] = {
            "kind": "fastened", "a": entity, "b": interior.on, "max_depth": round(depth + 0.05, 3),
            "reason": "foundation: it stands in the ground, which is dug out for it",
        }  # fmt: skip


def _depth(blocks: dict[str, tuple[Block, str | None]], site: Site) -> float:
    """Greatest depth of blocks in the ground [m]."""
    depths = [float(site.heights(_lattice(Rect(*b.low[:2], *b.high[:2]))).max()) - b.low[2] for b, _ in blocks.values()]
    return max(0.0, *depths)


def _sunk(rect: Rect, top: float, site: Site) -> Block:
    """A block over a rectangle that stands in the ground."""
    low = min(float(site.heights(_lattice(rect)).min()) - DEEP, top - LOWEST)
    return Block((rect.x0, rect.y0, low), (rect.x1, rect.y1, top))


def _plinth(plan: Plan, wall: float, site: Site) -> dict[str, tuple[Block, str | None]]:
    """Pieces of a wall below the outer walls, from the ground up to the floor's underside."""
    whole, top = _whole(plan, wall), -SLAB - LOOSE
    sides = [
        Rect(whole.x0, whole.y0, whole.x1, whole.y0 + wall),
        Rect(whole.x0, whole.y1 - wall, whole.x1, whole.y1),
        Rect(whole.x0, whole.y0 + wall, whole.x0 + wall, whole.y1 - wall),
        Rect(whole.x1 - wall, whole.y0 + wall, whole.x1, whole.y1 - wall),
    ]
    found: dict[str, tuple[Block, str | None]] = {}
    for side in sides:
        wide, deep = side.x1 - side.x0, side.y1 - side.y0
        count = max(1, math.ceil(max(wide, deep) / PIECE))
        for k in range(count):
            a, b = k / count, (k + 1) / count
            piece = (
                Rect(side.x0 + a * wide, side.y0, side.x0 + b * wide, side.y1)
                if wide > deep
                else Rect(side.x0, side.y0 + a * deep, side.x1, side.y0 + b * deep)
            )
            found[f"piece_{len(found) + 1}"] = (_sunk(piece, top, site), None)
    return found


def _step_blocks(steps: Steps, site: Site) -> dict[str, tuple[Block, str | None]]:
    """A platform at the door, level with the floor, and treads down to the ground."""
    half = steps.front.door.width / 2 + BESIDE
    found: dict[str, tuple[Block, str | None]] = {"platform": (_sunk(steps.front.rect(LOOSE, PLATFORM, half), 0.0, site), None)}
    for k in range(1, steps.number):
        near = PLATFORM + (k - 1) * TREAD
        found[f"tread_{k}"] = (_sunk(steps.front.rect(near, near + TREAD, half), -k * steps.rise, site), None)
    return found


def _way_in(found: BuiltInterior, name: str, room: str, steps: Steps, site: Site) -> None:
    """The ground before a door as a region, and the way from there into the room."""
    rect = steps.front.rect(steps.reach + 0.1, steps.reach + 0.1 + BEFORE[1], BEFORE[0] / 2)
    heights = site.heights(_lattice(rect))
    region = f"{name}_{room}_outside"
    found.regions[region] = {
        "kind": "box",
        "min": numbers(found.place(rect.x0, rect.y0, float(heights.min()) - 0.1)),
        "max": numbers(found.place(rect.x1, rect.y1, float(heights.max()) + 1.0)),
    }
    found.relations[f"{region}_to_{room}"] = {
        "kind": "connects",
        "a": region,
        "b": f"{name}_{room}",
        "width": 0.6,
        "headroom": 1.95,
    }
