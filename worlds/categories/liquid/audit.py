"""Rows of the audit about liquids: resolution, domain, openings (R57, R58)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import pose_of
from ...extents import initial_box
from ...problems import Problem, replaced
from ..loose import ROUNDED, domain_box, told_box
from .facts import LEAST_MOUTH, LEAST_SPACINGS, gauge_of, inflows_of, spacing_of
from .reach import gap_warnings, thin_problems, thin_warnings
from .wave_audit import wave_problems

if TYPE_CHECKING:
    from ...spec import LiquidInstance, WorldSpec

__all__ = ["liquid_problems", "liquid_warnings"]

MOST_STRETCH = 0.06
"""Share of a spacing by which a lattice may be stretched between two closed sides. Measured, still water of engine dfsph 4 to 10 spacings
wide: at 5.4 % all rows pass, at 6.2 % the energy and from 8.3 % on the density fail."""
LEVEL = 0.01
"""Slope of gravity across z from which on a level is none."""


def liquid_problems(spec: WorldSpec) -> list[Problem]:
    """Problems of liquids, their instances and their drivers."""
    found = [*_entities(spec)]
    for name, instance in spec.simulation.liquid.items():
        found += _instance(spec, name, instance)
        if np.isfinite(spacing_of(spec, name)):
            found += [*wave_problems(spec, name, instance), *thin_problems(spec, name, instance), *_levels(spec, name, instance)]
    found += _drivers(spec)
    return found


def liquid_warnings(spec: WorldSpec) -> Iterator[Problem]:
    """Thin parts that liquid may be thrown to, gaps that it cannot run through, pools that particles do not fill evenly."""
    for name, instance in spec.simulation.liquid.items():
        if np.isfinite(spacing_of(spec, name)):
            yield from thin_warnings(spec, name, instance)
            yield from gap_warnings(spec, name, instance)
            yield from _uneven(spec, name, instance)


def _uneven(spec: WorldSpec, name: str, instance: LiquidInstance) -> Iterator[Problem]:
    """Pools between two closed sides that are no whole number of spacings wide: their lattice is stretched or squeezed to fit."""
    low, high = domain_box(instance)
    spacing, sides = spacing_of(spec, name), instance.settings.domain.sides
    for member in instance.members if instance.engine == "dfsph" else ():
        entity = spec.entities.get(member)
        box = None if entity is None or entity.physics.category != "liquid" else initial_box(entity)
        if box is None:
            continue
        for axis in range(3):
            width, between = float(box[1][axis] - box[0][axis]), float(high[axis] - low[axis])
            if sides[2 * axis] != "closed" or sides[2 * axis + 1] != "closed" or between - width > spacing:
                continue
            number = width / spacing
            whole = max(1, round(number))
            if abs(number / whole - 1.0) > MOST_STRETCH:
                yield Problem(
                    f"/entities/{member}/physics/resolution",
                    f"{member!r} is {width:.4g} m wide between the closed sides of {name!r} along {'xyz'[axis]}, {number:.3g} spacings of {spacing:g} m: "
                    f"{whole} particles lie {width / whole / spacing:.1%} of a spacing apart there, {1 - MOST_STRETCH:.0%} to {1 + MOST_STRETCH:.0%} is allowed "
                    f"(category:liquid:density and energy). Use a resolution of {width / whole:.4g} m or {width / (whole + 1):.4g} m, or a width of {whole * spacing:.4g} m",
                )


def _entities(spec: WorldSpec) -> Iterator[Problem]:
    for name, entity in spec.entities.items():
        if entity.physics.category != "liquid":
            continue
        if entity.motion != "dynamic":
            text = f"the liquid {name!r} is {entity.motion}; liquids are dynamic"
            place = f"/entities/{name}/motion"
            yield Problem(place, text, replaced(place, "dynamic"))
        if entity.generator is not None:
            yield Problem(
                f"/entities/{name}/generator", f"the liquid {name!r} has a generator; give it parts that hold its volume"
            )


def _instance(spec: WorldSpec, name: str, instance: LiquidInstance) -> Iterator[Problem]:
    place = f"/simulation/solvers/{name}/settings"
    low, high = domain_box(instance)
    spacing = spacing_of(spec, name)
    if not np.isfinite(spacing):
        return
    least = LEAST_SPACINGS * spacing
    if (high - low).min() < (1.0 - ROUNDED) * least:
        yield Problem(
            f"{place}/domain/size",
            f"the domain is {(high - low).min():g} m wide, less than {LEAST_SPACINGS:g} spacings of {spacing:g} m",
        )
    for member in instance.members:
        entity = spec.entities.get(member)
        if entity is None or entity.physics.category != "liquid":
            continue
        if entity.physics.resolution != spacing:
            where = f"/entities/{member}/physics/resolution"
            yield Problem(
                where,
                f"{member!r} has resolution {entity.physics.resolution:g} m, another member of {name!r} {spacing:g} m; an instance has one",
                replaced(where, spacing),
            )
        box = initial_box(entity)
        if box is None:
            continue
        thin = float((box[1] - box[0]).min())
        if thin < (1.0 - ROUNDED) * least:
            yield Problem(
                f"/entities/{member}/physics/resolution",
                f"{member!r} is {thin:g} m thin, less than {LEAST_SPACINGS:g} spacings of {spacing:g} m; use at most {thin / LEAST_SPACINGS:.3g} m",
            )
        if (box[0] < low - 1e-9).any() or (box[1] > high + 1e-9).any():
            yield Problem(
                f"{place}/domain",
                f"the domain {told_box(low, high)} cuts the initial volume of {member!r} {told_box(*box)}; it must hold all of it",
            )
    for key, inflow in inflows_of(spec, name).items():
        where = f"/simulation/drivers/{key}"
        pose, half = pose_of(inflow.pose), 0.5 * np.array(inflow.size)
        corners = pose.apply(np.array([[sx * half[0], sy * half[1], 0.0] for sx in (-1, 1) for sy in (-1, 1)]))
        if (corners < low - 1e-9).any() or (corners > high + 1e-9).any():
            yield Problem(
                f"{where}/pose",
                f"inflow {key!r} {told_box(corners.min(0), corners.max(0))} reaches out of the domain {told_box(low, high)}",
            )
        mouth = LEAST_MOUTH[instance.engine]
        if min(inflow.size) < mouth * spacing:
            yield Problem(
                f"{where}/size",
                f"inflow {key!r} is {min(inflow.size):g} m wide, less than {mouth:g} spacings of {spacing:g} m; "
                f"widen it or use a resolution of at most {min(inflow.size) / mouth:.3g} m",
            )
        if not inflow.start < (spec.simulation.frames - 1) / spec.simulation.fps:
            yield Problem(f"{where}/start", f"inflow {key!r} starts at {inflow.start:g} s, after the last frame")


def _levels(spec: WorldSpec, name: str, instance: LiquidInstance) -> Iterator[Problem]:
    """Inflows and outflows that hold a level, which has to be in the domain and to be read there."""
    low, high = domain_box(instance)
    least, gravity = LEAST_SPACINGS * spacing_of(spec, name), spec.simulation.gravity
    for key, driver in spec.simulation.drivers.items():
        if driver.kind not in ("inflow", "outflow") or driver.entity not in instance.members:
            continue
        place = f"/simulation/drivers/{key}"
        if driver.level is None:
            if driver.gauge is not None:
                yield Problem(
                    f"{place}/gauge",
                    f"{driver.kind} {key!r} has a gauge and no level that it holds; give level, or leave gauge out",
                )
            continue
        if driver.kind == "inflow" and instance.engine != "flip":
            text = f"inflow {key!r} holds a level, and engine {instance.engine!r} gives layers at one speed only; use engine flip, or leave level out"
            yield Problem(f"{place}/level", text)
        if gravity[2] >= 0.0 or max(abs(gravity[0]), abs(gravity[1])) > LEVEL * abs(gravity[2]):
            yield Problem(
                f"{place}/level",
                f"{driver.kind} {key!r} holds a level, and gravity {gravity!r} does not point down; leave level out",
            )
        if not low[2] + least <= driver.level <= high[2] - least:
            yield Problem(
                f"{place}/level",
                f"{driver.kind} {key!r} holds the level {driver.level:g} m; it is read from {least:.3g} m below to as much above, "
                f"and the domain reaches from {low[2]:g} to {high[2]:g} m",
            )
        gauge = np.array(gauge_of(driver))
        if (gauge < low[:2] - 1e-9).any() or (gauge > high[:2] + 1e-9).any():
            text = f"{driver.kind} {key!r} reads the surface at x, y = {gauge[0]:g}, {gauge[1]:g} m, outside of the domain {told_box(low, high)}"
            yield Problem(f"{place}/gauge", text)


def _drivers(spec: WorldSpec) -> Iterator[Problem]:
    for name, driver in spec.simulation.drivers.items():
        if driver.kind in ("inflow", "outflow", "waves"):
            entity = spec.entities.get(driver.entity)
            if entity is not None and entity.physics.category != "liquid":
                yield Problem(
                    f"/simulation/drivers/{name}/entity", f"{driver.kind} {name!r} acts on {driver.entity!r}, which is no liquid"
                )
        moved = spec.entities.get(getattr(driver, "entity", ""))
        if driver.kind not in ("inflow", "outflow", "waves") and moved is not None and moved.physics.category == "liquid":
            yield Problem(
                f"/simulation/drivers/{name}",
                f"driver {driver.kind!r} cannot act on a liquid; use inflow, outflow, waves, gravity, or a kinematic solid that moves it",
            )
