"""Channels of gases: fields on the cells of their box, and sums that must balance."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from ...channel import Channel, quantity
from ...instances import felt_by
from ..shared_channels import MOTION
from .burning import flammable_parts
from .facts import gas_of
from .steam_facts import steams_of

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["CHANNELS", "DIMENSIONS", "writers"]

DIMENSIONS: Mapping[str, str] = {
    "cells x": "cells of the gas's box along x",
    "cells y": "along y",
    "cells z": "along z",
    "pieces": "pieces of surfaces that may burn",
    "hot": "hot entities that steam cools, by driver",
}
BOX = ("cells x", "cells y", "cells z")
CHANNELS: Mapping[str, tuple[Channel, ...]] = {
    "gas": (
        *MOTION,
        Channel("gas_corner", "f8", (3,), "m", "lower corner of the first cell, world", finite=True),
        Channel("gas_soot", "f4", BOX, "kg/m^3", "soot, droplets or dust"),
        Channel("gas_temperature", "f4", BOX, "K", "present temperature", sign="+"),
        Channel("gas_velocity", "f4", (*BOX, 3), "m/s", "at the middle of each cell, world axes"),
        Channel("gas_room", "f4", BOX, "1", "share of each cell that is open to the gas", sign="+"),
        quantity("soot_mass", "kg", "in the box"),
        quantity("emitted_soot", "kg", "made by emissions since frame 0", sign="+"),
        quantity("escaped_soot", "kg", "carried out through open sides since frame 0"),
        quantity("heat", "J", "enthalpy of the gas in the box above that of ambient air"),
        quantity("emitted_heat", "J", "of gas made by emissions since frame 0, above ambient air"),
        quantity("escaped_heat", "J", "carried out through open sides since frame 0"),
        quantity("lost_heat", "J", "given up otherwise since frame 0: radiated, or taken by walls"),
        quantity("volume_emitted", "m^3", "of gas made by emissions since frame 0, at its temperature", sign="+"),
        quantity("volume_escaped", "m^3", "of gas and air that left through open sides since frame 0, less what came in"),
        quantity("divergence", "1", "largest flux out of a cell after a step of the frame beyond what sources ask for, over the largest speed", total="max", sign="+"),
        quantity("iterations", "1", "most iterations of the pressure solves in a step of the frame", total="max", sign="+"),
        quantity("capped", "1", "steps of the frame that ended at the iteration cap", sign="+"),
    ),
    "gas follow": (
        Channel("gas_active", "i4", (2, 3), "cells", "first cell, and the one behind the last, along each axis, of the part of the box that was solved; air is still elsewhere", sign="+"),
        quantity("slipped_soot", "kg", "that left through sides of that part inside the box since frame 0; part of what escaped, and none should"),
        quantity("slipped_heat", "J", "the same of heat"),
    ),
    "gas feel": (
        Channel("gas_returned", "f4", (*BOX, 3), "N s/m^3", "momentum that its velocities took over the frame from what it carries and feels, by cell", finite=True),
        Channel("gas_gained", "f8", (3,), "N s", "the same of all cells", finite=True),
    ),
    "gas fire": (
        Channel("gas_fuel", "f4", BOX, "kg/m^3", "fuel that has not burnt"),
        Channel("gas_product", "f4", BOX, "kg/m^3", "what fuel and its air have become, without soot"),
        Channel("gas_released", "f4", BOX, "W/m^3", "heat that burning released in the last step of the frame", sign="+"),
        Channel("gas_radiated", "f4", BOX, "W/m^3", "of it, and of hot soot, what was radiated in that step", sign="+"),
        quantity("fuel_mass", "kg", "fuel in the box that has not burnt"),
        quantity("emitted_fuel", "kg", "made by emissions since frame 0", sign="+"),
        quantity("escaped_fuel", "kg", "carried out unburnt through open sides since frame 0"),
        quantity("escaped_product", "kg", "products carried out through open sides since frame 0"),
        quantity("burnt_fuel", "kg", "burnt since frame 0", sign="+"),
        quantity("released_heat", "J", "by what has burnt since frame 0", sign="+"),
        quantity("made_soot", "kg", "by what has burnt since frame 0", sign="+"),
    ),
    "gas kindling": (
        Channel("burning_part", "i4", ("pieces",), "1", "number of its part among those that may burn, by the names of entities and parts", sign="+"),
        Channel("burning_point", "f8", ("pieces", 3), "m", "middle, world; it goes along with its body or its cloth", finite=True),
        Channel("burning_area", "f8", ("pieces",), "m^2", "area; of cloth at rest, of one side", sign="+"),
        Channel("burning_left", "f8", ("pieces",), "kg/m^2", "mass below it that can still become gas; 0 of cloth that is consumed", sign="+"),
        Channel("burning_temperature", "f8", ("pieces",), "K", "of the surface", sign="+"),
        Channel("burning_heat", "f8", ("pieces",), "J/m^2", "heat below it above that at frame 0"),
        quantity("gasified_fuel", "kg", "given off by surfaces since frame 0; part of what was emitted", sign="+"),
        quantity("taken_heat", "J", "that gas gave surfaces which may burn since frame 0; part of what it lost"),
        quantity("taken_light", "J", "of flames on these surfaces since frame 0, less what they radiate"),
        quantity("surface_heat", "J", "in these surfaces above that at frame 0"),
        quantity("gasification_heat", "J", "that has made gas of them since frame 0", sign="+"),
    ),
    "gas steam": (
        Channel("steam_area", "f8", ("hot",), "m^2", "of hot entities against water", sign="+"),
        Channel("steam_temperature", "f8", ("hot",), "K", "of hot entities", sign="+"),
        Channel("steam_given", "f8", ("hot",), "J", "heat that they gave to make steam since frame 0", sign="+"),
        quantity("steam_mass", "kg", "of water that has become steam since frame 0; its liquid keeps it", sign="+"),
    ),
}  # fmt: skip
"""By kind of writer."""


def writers(spec: WorldSpec, name: str) -> Iterator[str]:
    """Further kinds of writer: a gas that burns, solids and cloth that burn in it, and what makes steam."""
    held = gas_of(spec, name) if name in spec.simulation.gas else None
    if held is not None and spec.simulation.gas[name].settings.follows:
        yield "gas follow"
    if held is not None and felt_by(spec, name):
        yield "gas feel"
    if held is not None and held[2].fuel is not None:
        yield "gas fire"
    if held is not None and flammable_parts(spec, name):
        yield "gas kindling"
    if held is not None and steams_of(spec, name):
        yield "gas steam"
