"""Channels of grains and of flying particles."""

from __future__ import annotations

from collections.abc import Mapping

from ...channel import Channel, quantity
from ..shared_channels import DRIVER_WORK, EXCHANGES, FIELD_IMPULSE, GIVEN, IN_DOMAIN, MOTION, POINTS, REACTION

__all__ = ["CHANNELS"]

CHANNELS: Mapping[str, tuple[Channel, ...]] = {
    "particles": (
        *POINTS,
        *MOTION,
        *IN_DOMAIN,
        DRIVER_WORK,
        GIVEN,
        REACTION,
        FIELD_IMPULSE,
        EXCHANGES,
        Channel("particle/member", "i4", ("particles",), "1", "index into `CacheIndex.bodies`", sign="+"),
        Channel("particle/radius", "f4", ("particles",), "m", "radius", sign="+"),
        Channel("particle/spin", "f4", ("particles", 3), "rad/s", "angular velocity"),
        Channel("outflow/momentum", "f8", (3,), "N s", "carried out of the domain over the frame", "sum"),
        quantity("rotation_energy", "J", "of the spins of particles", sign="+"),
        quantity("wall_work", "J", "work of the motion of bodies on grains in contact since frame 0"),
        quantity("contact_energy", "J", "elastic energy of contacts by their depths, among grains and with bodies"),
        quantity("spring_energy", "J", "elastic energy of the springs that resist slip and rolling in contacts"),
        quantity("mean_speed", "m/s", "of all particles at the frame", total="max", sign="+"),
        quantity("inflow_count", "1", "particles that emitters let out since frame 0", sign="+"),
        quantity("died_count", "1", "particles that died at surfaces or of age since frame 0", sign="+"),
        quantity("died_mass", "kg", "their mass", sign="+"),
        quantity("outflow_count", "1", "particles that left the domain since frame 0", sign="+"),
    ),
}  # fmt: skip
"""By kind of writer."""
