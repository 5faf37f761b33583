"""Heights that a liquid can get to by what is declared, and the solids and gaps there that its spacing does not resolve (R58).

Solids are known by their declared shapes. What only their built surfaces tell is refused when the liquid is set up
(`simulation/liquid/resolved.py`), and judged once it has run (`category:liquid:obstacles` and `passages`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...arrays import F64, pose_of, rotation_matrix
from ...extents import initial_box, least_extent, part_box
from ...fields import acting_on
from ...problems import Problem
from ..loose import domain_box, told_box
from .facts import LEAST_SPACINGS, LEAST_WALL, WALL_SLACK, fastest, inflows_of, spacing_of

if TYPE_CHECKING:
    from ...spec import LiquidInstance, WorldSpec

__all__ = ["gap_warnings", "own_reach", "thin_problems", "thin_warnings"]

LEAST_GAP = 0.5
"""[spacings] Own choice: less than that is closed to a liquid, and no gap that anyone wants it to run through."""
WIDE_GAP = 2.0
"""Own choice: a gap counts where it is so many times longer and wider than what is resolved: a short one leads nowhere."""
SQUARE = 1e-6
"""Least part of a quaternion by which a body counts as turned: with less it lies along the axes."""


class _Solid(NamedTuple):
    """A fixed part of simple shape."""

    entity: str
    part: str
    low: F64
    high: F64
    thick: float
    """Least extent [m]."""
    block: bool
    """True of one that stands still and fills its box."""
    path: bool
    """True if it moves on a path, and may come anywhere."""


def own_reach(spec: WorldSpec, name: str) -> float:
    """Height over the origin against gravity to which a liquid rises by its own energy, at the start or in an inflow [m]."""
    up, strength = _up(spec)
    if strength == 0.0:
        return math.inf
    tops = [-math.inf]
    for member in spec.simulation.liquid[name].members:
        entity = spec.entities.get(member)
        if entity is None or entity.physics.category != "liquid":
            continue
        box = initial_box(entity)
        if box is None:
            return math.inf
        tops.append(_top(box, up) + fastest(entity) ** 2 / (2.0 * strength))
    for inflow in inflows_of(spec, name).values():
        pose = pose_of(inflow.pose)
        rise = float(np.abs(up @ rotation_matrix(pose.quaternion)[:, :2]) @ (0.5 * np.array(inflow.size)))
        tops.append(float(pose.position @ up) + rise + inflow.flow_speed**2 / (2.0 * strength))
    return max(tops)


def _driven_reach(spec: WorldSpec, name: str) -> float:
    """The same by what else may lift it: bodies that fall into it lift it to where they came from, all other drivers anywhere."""
    plan, (up, strength), members = spec.simulation, _up(spec), set(spec.simulation.liquid[name].members)
    for driver in plan.drivers.values():
        if driver.kind in ("inflow", "outflow", "release", "detach"):
            continue
        if driver.kind == "field" and not members & set(acting_on(spec, driver)):
            continue
        return math.inf
    tops = [own_reach(spec, name)]
    for entity in spec.entities.values():
        if entity.motion == "dynamic" and entity.physics.category != "liquid":
            box = initial_box(entity)
            if box is None or strength == 0.0:
                return math.inf
            tops.append(_top(box, up) + math.hypot(*getattr(entity.physics, "linear_velocity", (0.0,))) ** 2 / (2.0 * strength))
    return max(tops)


def thin_problems(spec: WorldSpec, name: str, instance: LiquidInstance) -> Iterator[Problem]:
    """Fixed parts thinner than the spacing resolves, which the liquid reaches by itself: nothing could be simulated with them."""
    for solid in _thin(spec, name, instance, None, own_reach(spec, name)):
        why = (
            f"its path may bring it into the liquid of {name!r}"
            if solid.path
            else f"the liquid of {name!r} rises as high by itself"
        )
        yield _thin_problem(solid, spec, name, instance, why)


def thin_warnings(spec: WorldSpec, name: str, instance: LiquidInstance) -> Iterator[Problem]:
    """The same where only bodies or drivers could bring the liquid to them; of each entity its thinnest part, with the number of the others."""
    own = own_reach(spec, name)
    by_entity: dict[str, list[_Solid]] = {}
    for solid in _thin(spec, name, instance, own, _driven_reach(spec, name)):
        by_entity.setdefault(solid.entity, []).append(solid)
    for solids in by_entity.values():
        thinnest = min(solids, key=lambda s: s.thick)
        more = f" ({len(solids) - 1} more of its parts are too thin there)" if len(solids) > 1 else ""
        why = f"bodies or drivers may throw the liquid of {name!r} there (by itself it rises to {own:.3g} m): category:liquid:obstacles fails where it is wet{more}"
        yield _thin_problem(thinnest, spec, name, instance, why)


def _thin(spec: WorldSpec, name: str, instance: LiquidInstance, above: float | None, below: float) -> Iterator[_Solid]:
    """Parts that are too thin and begin between two heights [m]; None: from the depths."""
    up, _ = _up(spec)
    least = (1.0 - WALL_SLACK) * LEAST_WALL[instance.engine] * spacing_of(spec, name)
    for solid in _solids(spec, instance):
        foot = -math.inf if solid.path else -_top((solid.low, solid.high), -up)
        if solid.thick < least and (above is None or above < foot) and foot <= below:
            yield solid


def _thin_problem(solid: _Solid, spec: WorldSpec, name: str, instance: LiquidInstance, why: str) -> Problem:
    bound, spacing = LEAST_WALL[instance.engine], spacing_of(spec, name)
    return Problem(
        f"/entities/{solid.entity}/parts/{solid.part}/shape",
        f"{solid.entity}/{solid.part} at {told_box(solid.low, solid.high)} is {solid.thick:.3g} m thick, {solid.thick / spacing:.2g} spacings of "
        f"{spacing:g} m; {why}, and {instance.engine} resolves {bound:g} or more: make it at least {bound * spacing:.3g} m thick, use a resolution of "
        f"at most {solid.thick / bound:.3g} m, or keep it out of the domain",
    )


def gap_warnings(spec: WorldSpec, name: str, instance: LiquidInstance) -> Iterator[Problem]:
    """Gaps between level blocks that do not move, too narrow for the spacing and where liquid can get to."""
    spacing, (low, high) = spacing_of(spec, name), domain_box(instance)
    up, _ = _up(spec)
    reach, least = own_reach(spec, name), LEAST_SPACINGS * spacing
    blocks = [s for s in _solids(spec, instance) if s.block]
    for k, one in enumerate(blocks):
        for two in blocks[k + 1 :]:
            apart = np.maximum(one.low - two.high, two.low - one.high)
            axis = int(np.argmax(apart))
            width = float(apart[axis])
            across = [a for a in range(3) if a != axis]
            if not LEAST_GAP * spacing < width < (1.0 - WALL_SLACK) * least or apart[across].max() >= 0.0:
                continue
            least_corner, most_corner = np.maximum(one.low, two.low), np.minimum(one.high, two.high)
            least_corner[axis], most_corner[axis] = sorted((float(most_corner[axis]), float(least_corner[axis])))
            least_corner, most_corner = np.maximum(least_corner, low), np.minimum(most_corner, high)
            size = most_corner - least_corner
            foot = -_top((least_corner, most_corner), -up)
            if (size[across] < WIDE_GAP * least).any() or foot > reach or _between(blocks, least_corner, most_corner, (one, two)):
                continue
            yield Problem(
                f"/entities/{one.entity}/parts/{one.part}/pose",
                f"the gap between {one.entity}/{one.part} and {two.entity}/{two.part} at {told_box(least_corner, most_corner)} is {width:.3g} m wide, "
                f"{width / spacing:.2g} spacings of {spacing:g} m, and the liquid of {name!r} can get there: it carries {LEAST_SPACINGS:g} or more "
                f"(category:liquid:passages, density and leak). Use a resolution of at most {width / LEAST_SPACINGS:.3g} m, make it {least:.3g} m wide, or close it",
            )


def _between(blocks: list[_Solid], low: F64, high: F64, but: tuple[_Solid, _Solid]) -> bool:
    """True where another block fills most of a gap."""
    middle = 0.5 * (low + high)
    return any((b.low <= middle).all() and (middle <= b.high).all() for b in blocks if b not in but)


def _solids(spec: WorldSpec, instance: LiquidInstance) -> Iterator[_Solid]:
    """Fixed parts of simple shape that collide and reach into the domain."""
    low, high = domain_box(instance)
    members = {m for rigid in spec.simulation.rigid.values() for m in rigid.members}
    for entity, contract in spec.entities.items():
        if contract.motion == "dynamic" or entity not in members or contract.physics.category != "rigid":
            continue
        for part, made in contract.parts.items():
            box, thick = part_box(contract, part), least_extent(made.shape)
            still = contract.motion == "static"
            if box is None or thick is None or not made.collides:
                continue
            if still and ((box[0] > high).any() or (box[1] < low).any()):
                continue
            turned = max(_turn(pose_of(p).quaternion) for p in (contract.pose, made.pose))
            yield _Solid(entity, part, *box, thick, still and made.shape.kind == "box" and turned < SQUARE, not still)


def _turn(quaternion: F64) -> float:
    """Deviation from lying along the axes: the second largest share of a quaternion, 0 for none."""
    return float(np.sort(np.abs(quaternion))[-2])


def _up(spec: WorldSpec) -> tuple[F64, float]:
    gravity = np.array(spec.simulation.gravity, dtype=np.float64)
    strength = float(np.linalg.norm(gravity))
    return (-gravity / strength if strength > 0.0 else np.array([0.0, 0.0, 1.0])), strength


def _top(box: tuple[F64, F64], up: F64) -> float:
    """Height of the highest corner of a box [m]."""
    return float(np.maximum(box[0] * up, box[1] * up).sum())
