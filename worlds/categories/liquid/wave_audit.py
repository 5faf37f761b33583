"""Rows of the audit about declared waves: whether they can exist, are resolved, and have room for their zones."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ....physics.waves import breaking_steepness, wavelength
from ...extents import initial_box
from ...problems import Problem, replaced
from ...waves import developed, heading, inward, waves_of
from ..loose import domain_box
from .facts import spacing_of

if TYPE_CHECKING:
    from ...spec import LiquidInstance, WavesDriver, WorldSpec

__all__ = ["wave_problems"]

LEAST_LENGTH = 10.0
"""Spacings of a peak wavelength."""
LEAST_HEIGHT = 1.0
"""Own choice: lower waves are lost in the roughness of a surface of particles."""
ROOM = 0.5
"""Own choice: peak wavelengths between two zones that face each other."""
SIDES = ("-x", "+x", "-y", "+y")
ENTERS = 0.17
"""Cosine of direction and inward normal, 10 degrees off the side."""
PERIODS = 1.5
"""Full waves that a run must hold, so that they can be judged."""


def wave_problems(spec: WorldSpec, name: str, instance: LiquidInstance) -> Iterator[Problem]:
    """Problems of the waves of an instance."""
    found = waves_of(spec, name)
    spacing = spacing_of(spec, name)
    gravity = spec.simulation.gravity
    for number, (key, driver) in enumerate(found.items()):
        place = f"/simulation/drivers/{key}"
        if number:
            yield Problem(place, f"{name!r} has waves {next(iter(found))!r} already; declare one sea for an instance")
        elif gravity[0] or gravity[1] or not gravity[2] < 0.0:
            yield Problem("/simulation/gravity", f"waves {key!r} need gravity along -z, it is {list(gravity)}")
        else:
            yield from _sea(place, key, driver, -gravity[2], spacing)
            yield from _zones(place, key, driver, name, instance, -gravity[2])
            yield from _water(spec, place, key, driver, name)
            yield from _times(spec, place, key, driver)


def _sea(place: str, key: str, driver: WavesDriver, gravity: float, spacing: float) -> Iterator[Problem]:
    length = wavelength(driver.period, driver.depth, gravity)
    most = breaking_steepness(driver.period, driver.depth, gravity)
    if driver.height / length > most:
        yield Problem(
            f"{place}/height",
            f"waves {key!r} of {driver.height:g} m height and {length:.3g} m length (period {driver.period:g} s, depth {driver.depth:g} m) "
            f"are steeper ({driver.height / length:.3f}) than {most:.3f}, at which they break; use a height of at most "
            f"{most * length:.3g} m or a longer period",
        )
    if length < LEAST_LENGTH * spacing:
        yield Problem(
            f"{place}/period",
            f"waves {key!r} are {length:.3g} m long, less than {LEAST_LENGTH:g} spacings of {spacing:g} m; use a longer period or a "
            f"resolution of at most {length / LEAST_LENGTH:.3g} m",
        )
    if driver.height < LEAST_HEIGHT * spacing:
        yield Problem(
            f"{place}/height",
            f"waves {key!r} are {driver.height:g} m high, less than a spacing of {spacing:g} m; use higher waves or a resolution of at "
            f"most {driver.height / LEAST_HEIGHT:.3g} m (half of it shows them well)",
        )


def _zones(place: str, key: str, driver: WavesDriver, name: str, instance: LiquidInstance, gravity: float) -> Iterator[Problem]:
    length = wavelength(driver.period, driver.depth, gravity)
    if driver.zone < length * (1.0 - 1e-6):
        value = math.ceil(length * 1000.0) / 1000.0
        yield Problem(
            f"{place}/zone",
            f"zones of waves {key!r} are {driver.zone:g} m wide, less than one wavelength of {length:.4g} m: they would reflect",
            replaced(f"{place}/zone", value),
        )
    low, high = domain_box(instance)
    sides = [*driver.generate, *driver.absorb]
    for axis, letter in enumerate("xy"):
        zones = sum(f"{sign}{letter}" in sides for sign in "-+")
        wanted = (zones * driver.zone + ROOM * length) if zones else 0.0
        if high[axis] - low[axis] < wanted:
            yield Problem(
                f"/simulation/solvers/{name}/settings/domain/size",
                f"the domain is {high[axis] - low[axis]:.4g} m along {letter}: {zones} zones of {driver.zone:g} m and half a wavelength "
                f"between them need {wanted:.4g} m",
            )
    declared = dict(zip(SIDES, instance.settings.domain.sides[:4], strict=True))
    for field, chosen in (("generate", driver.generate), ("absorb", driver.absorb)):
        for k, side in enumerate(chosen):
            if declared[side] != "closed":
                yield Problem(
                    f"{place}/{field}/{k}",
                    f"side {side} of the domain is open, so that water leaves there; waves {key!r} need it closed",
                )
    if all(float(heading(driver) @ inward(side)) < ENTERS for side in driver.generate):
        yield Problem(
            f"{place}/generate",
            f"waves {key!r} travel towards {driver.direction:g} degrees, into the domain from none of {', '.join(driver.generate)}; "
            "turn direction or generate on the side that they come from",
        )


def _water(spec: WorldSpec, place: str, key: str, driver: WavesDriver, name: str) -> Iterator[Problem]:
    instance, spacing = spec.simulation.liquid[name], spacing_of(spec, name)
    low, high = domain_box(instance)
    if driver.level + driver.height > high[2]:
        yield Problem(
            f"/simulation/solvers/{name}/settings/domain",
            f"crests of waves {key!r} would reach {driver.level + driver.height:.4g} m, the domain ends at {high[2]:.4g} m",
        )
    if driver.level - driver.depth < low[2] - spacing:
        yield Problem(
            f"{place}/depth",
            f"the bed of waves {key!r} is at {driver.level - driver.depth:.4g} m (level - depth), below the domain at {low[2]:.4g} m",
        )
    boxes = [initial_box(spec.entities[m]) for m in instance.members if m in spec.entities]
    tops = [float(b[1][2]) for b in boxes if b is not None]
    if tops and len(tops) == len(boxes) and abs(max(tops) - driver.level) > spacing:
        yield Problem(
            f"{place}/level",
            f"still water of waves {key!r} is declared at {driver.level:.4g} m, the liquid's top at frame 0 is {max(tops):.4g} m",
            replaced(f"{place}/level", round(max(tops), 6)),
        )


def _times(spec: WorldSpec, place: str, key: str, driver: WavesDriver) -> Iterator[Problem]:
    plan = spec.simulation
    if driver.start < -plan.preroll:
        yield Problem(
            f"{place}/start", f"waves {key!r} start at {driver.start:g} s, before the preroll of {plan.preroll:g} s; lengthen it"
        )
    end = (plan.frames - 1) / plan.fps
    wanted = developed(driver, -plan.gravity[2]) + PERIODS * driver.period
    if end < wanted:
        yield Problem(
            f"{place}/start",
            f"waves {key!r} have passed their zone and shown {PERIODS:g} periods at {wanted:.3g} s, the last frame is at {end:.3g} s; use "
            "more frames, or a negative start within a preroll",
        )
