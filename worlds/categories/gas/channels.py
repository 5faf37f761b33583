"""Channels of gases: fields on the cells of their box, and sums that must balance."""

from __future__ import annotations

from collections.abc import Mapping

from ...channel import Channel, quantity
from ..shared_channels import MOTION

__all__ = ["CHANNELS", "DIMENSIONS"]

DIMENSIONS: Mapping[str, str] = {
    "cells x": "cells of the gas's box along x",
    "cells y": "along y",
    "cells z": "along z",
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
}  # fmt: skip
"""By kind of writer."""
