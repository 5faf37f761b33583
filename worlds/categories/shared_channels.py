"""Channels and quantities that several categories write, each declared once."""

from __future__ import annotations

from ..channel import Channel, quantity, vector

__all__ = [
    "CONTACTS", "DRIVER_WORK", "EXCHANGES", "FIELD_IMPULSE", "GIVEN", "IN_DOMAIN", "ITERATIONS_CAPPED", "MOTION", "ORIGIN", "POINTS", "REACTION", "VERTICES",
]  # fmt: skip

MOTION = (
    quantity("kinetic_energy", "J", "sum over moving bodies, fluids or particles", sign="+"),
    quantity("potential_energy", "J", "gravity, against z = 0, plus springs; of a gas, by how much heavier it is than the air around"),
    *vector("momentum", "kg m/s", "sum over moving bodies or fluids"),
    quantity("mass", "kg", "sum over moving bodies; of a fluid, what is in the domain, air of a gas included", sign="+", conserved=True),
    quantity("max_speed", "m/s", "fastest centre of mass or particle over all steps of the frame", total="max", sign="+"),
    quantity("steps", "1", "solver steps taken in the frame", sign="+"),
    quantity("step", "s", "time step used in the frame; of a fluid, their mean", total="max", sign="+"),
)  # fmt: skip
"""Records of everything that moves."""
DRIVER_WORK = quantity("driver_work", "J", "work done by drivers since frame 0, positive into the bodies or the liquid")
GIVEN = Channel(
    "exchange/impulse",
    "f8",
    ("pushed", 6),
    "N s, N m s",
    "given to each body over the frame, about its centre of mass: what the instance gave, or the rigid engine integrated",
    "sum",
)
REACTION = Channel(
    "exchange/reaction",
    "f8",
    ("boundaries", 6),
    "N s, N m s",
    "change of the matter's own momentum through each body over the frame, measured on the matter",
    "sum",
)
FIELD_IMPULSE = Channel("field/impulse", "f8", ("bodies", 3), "N s", "of force fields over the frame", "sum")
CONTACTS = quantity("contacts_max", "1", "most contacts in one step of the frame; of cloth, near pairs", total="max", sign="+")
ITERATIONS_CAPPED = quantity("iterations_capped", "1", "steps that ended at the iteration cap", sign="+")
EXCHANGES = quantity("exchanges", "1", "times in the frame at which cloth or particles looked at the air and at bodies", sign="+")
ORIGIN = Channel("origin", "f8", (3,), "m", "what float32 positions are relative to, world", finite=True)
POINTS = (
    ORIGIN,
    Channel("particle/position", "f4", ("particles", 3), "m", "relative to `origin`", finite=True),
    Channel("particle/velocity", "f4", ("particles", 3), "m/s", "world axes", finite=True),
    Channel("particle/id", "i4", ("particles",), "1", "stays with a particle for life", sign="+"),
)  # fmt: skip
"""Loose matter, point by point."""
IN_DOMAIN = (
    quantity("volume", "m^3", "sum of the particles' volumes at rest density", sign="+"),
    quantity("particles", "1", "particles in the domain", sign="+"),
    quantity("lost", "1", "particles that are no longer there and that nothing took away, since frame 0", sign="+"),
    quantity("inflow_mass", "kg", "let in by inflows or emitters since frame 0", sign="+"),
    quantity("domain_outflow", "kg", "left the domain since frame 0", sign="+"),
)  # fmt: skip
"""Loose matter in its domain, and what came and went."""
VERTICES = (
    Channel("vertex/position", "f8", ("vertices", 3), "m", "world"),
    Channel("vertex/velocity", "f4", ("vertices", 3), "m/s", "world"),
)  # fmt: skip
"""Surfaces that deform."""
