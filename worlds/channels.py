"""Every channel and recorded quantity of the caches, declared once: type, shape, unit, sign, how values add up, and who writes it.

Frames are checked against this registry when they are written and when they are read (`worlds/cache.py`); `worlds/writers.py` says
which kinds of writer an instance is. Frame k is the state at time k / fps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, Literal

import numpy as np

__all__ = ["CHANNELS", "DIMENSIONS", "QUANTITIES", "RECORD", "Channel", "Writer", "mismatch", "names_written"]

RECORD = "record/"
"""Prefix of the channels that hold one number per frame."""

Writer = Literal[
    "rigid", "rigid coupled", "rigid blown", "fracture", "elastic", "elastic coupled", "elastic blown", "liquid", "liquid heat",
    "cloth", "tearing", "particles", "surface", "surface heat", "wet",
]  # fmt: skip
"""What writes channels: an instance of a category, `coupled` two-way or with members that are `blown` on by force fields; rigid ones with
breakable or elastic members; liquids that declare heat; cloth that can tear; what is made of a liquid's cache (surfaces, wet maps)."""

DIMENSIONS: Mapping[str, str] = {
    "bodies": "`CacheIndex.bodies`: moving bodies `entity/body`; entities of a liquid or particle instance",
    "boundaries": "`CacheIndex.colliders` of an instance that meets bodies",
    "pushed": "`bodies` of a rigid instance, `boundaries` of any other",
    "joints": "`CacheIndex.joints`: hinges and slides",
    "drivers": "`CacheIndex.drivers`",
    "deformables": "`CacheIndex.deformables`",
    "vertices": "simulation vertices of all `deformables`; of cloth that can tear, corners: 3 t, 3 t + 1, 3 t + 2 of triangle t",
    "pairs": "pairs of colliders that touched since the last frame",
    "events": "contacts that began in the frame, in order of time",
    "bonds": "bonds of the entities of `CacheIndex.breakables`, one after the other",
    "breaks": "bonds that broke in the frame",
    "cases": "load cases under which bonds broke in the frame",
    "case loads": "loads of all cases, one case after the other",
    "loaded pieces": "pieces that contacts pushed in the frame, counted through all `breakables`",
    "tears": "vertices of cloth that tore in the frame",
    "sides": "sides that opened in the frame; a side leads from a corner to the next and has its row",
    "triangles": "triangles around the tears of the frame",
    "particles": "particles; of grains in the order of their ids",
    "surface vertices": "vertices of the closed meshes of all liquids",
    "surface faces": "triangles of these meshes",
    "spray": "particles apart from the liquid, left out of the meshes",
    "bubbles": "bubbles on the surface; they carry no mass",
    "foaming": "particles that carry foam: the state that the next frame continues from",
    "wet": "texels with liquid on their outer side, ascending",
    "tracked": "texels whose film changed by contact with another surface since the frame before, ascending",
}
"""Named dimensions and what their rows are."""


@dataclass(frozen=True)
class Channel:
    """One named array of every frame."""

    name: str
    dtype: str
    """Code of numpy, as in `f8`."""
    shape: tuple[str | int, ...]
    """Sizes, or names of `DIMENSIONS`; the first one says where the values live. Empty: one number per frame."""
    unit: str
    meaning: str
    of: tuple[Writer, ...]
    total: Literal["sum", "max", "min", ""] = ""
    """How values of several instances, and of several rows, make one; empty where they do not."""
    sign: Literal["+", ""] = ""
    """`+`: no value is negative."""
    conserved: bool = False
    """Whether physics keeps the total."""
    finite: bool = False
    """The writer promises finite numbers; elsewhere those that are not are evidence of a fault, which checks judge."""

    @cached_property
    def type(self) -> np.dtype[Any]:
        """The numpy type."""
        return np.dtype(self.dtype)

    def combined(self, columns: Sequence[Any]) -> Any:
        """Values of several instances as one; each of any shape, all alike."""
        stack = np.stack([np.asarray(column, dtype=np.float64) for column in columns])
        return {"max": stack.max, "min": stack.min}.get(self.total, stack.sum)(axis=0)


def mismatch(data: Mapping[str, Any], sizes: Mapping[str, int] | None) -> str:
    """First way in which arrays differ from what is declared of them, as text; empty where they do not.

    Args:
        data: arrays by channel.
        sizes: known sizes by dimension; the others need only be the same in all channels. None: any number of rows is right.
    """
    found = dict(sizes or {})
    for name, values in data.items():
        channel, array = CHANNELS.get(name), np.asarray(values)
        if channel is None:
            return f"{name!r} is not declared"
        if array.dtype != channel.type:
            return f"{name!r} is {array.dtype.str}, declared {channel.type.str}"
        wanted = [
            d if isinstance(d, int) else n if sizes is None else found.setdefault(d, n)
            for d, n in zip(channel.shape, array.shape, strict=False)
        ]
        if list(array.shape) != wanted or len(array.shape) != len(channel.shape):
            return f"{name!r} has shape {array.shape}, declared {channel.shape}" + (f" = {tuple(wanted)}" if wanted else "")
    return ""


def _quantity(name: str, unit: str, meaning: str, of: tuple[Writer, ...], *, total: Any = "sum", **more: Any) -> Channel:
    """A quantity of one number per frame; values of several instances add up unless told."""
    return Channel(RECORD + name, "f8", (), unit, meaning, of, total, **more)


def _vector(name: str, unit: str, meaning: str, of: tuple[Writer, ...]) -> tuple[Channel, ...]:
    """The three components of a recorded vector."""
    return tuple(_quantity(f"{name}_{axis}", unit, meaning, of) for axis in "xyz")


_RIGID: tuple[Writer, ...] = ("rigid",)
_FRACTURE: tuple[Writer, ...] = ("fracture",)
_ELASTIC: tuple[Writer, ...] = ("elastic",)
_LIQUID: tuple[Writer, ...] = ("liquid",)
_HEAT: tuple[Writer, ...] = ("liquid heat",)
_CLOTH: tuple[Writer, ...] = ("cloth",)
_TEARING: tuple[Writer, ...] = ("tearing",)
_PARTICLES: tuple[Writer, ...] = ("particles",)
_MATTER: tuple[Writer, ...] = ("liquid", "particles")
_SOFT: tuple[Writer, ...] = ("elastic", "cloth")
_SURFACE: tuple[Writer, ...] = ("surface",)
_SURFACE_HEAT: tuple[Writer, ...] = ("surface heat",)
_WET: tuple[Writer, ...] = ("wet",)
_DERIVED: tuple[Writer, ...] = ("surface", "wet")
_DRIVEN: tuple[Writer, ...] = ("rigid", "liquid", "particles")
_ALL: tuple[Writer, ...] = ("rigid", "liquid", "cloth", "particles")

_CHANNELS = (
    # Bodies
    Channel("position", "f8", ("bodies", 3), "m", "origin of the body's frame, world", _RIGID),
    Channel("quaternion", "f8", ("bodies", 4), "1", "orientation of the body's frame (w, x, y, z)", _RIGID),
    Channel("velocity", "f8", ("bodies", 3), "m/s", "of the centre of mass, world", _RIGID),
    Channel("angular_velocity", "f8", ("bodies", 3), "rad/s", "world axes", _RIGID),
    Channel("asleep", "u1", ("bodies",), "1", "1: the body sleeps; 2: since a time within the frame", _RIGID),
    Channel("joint", "f8", ("joints",), "rad or m", "coordinate of hinge and slide joints", _RIGID),
    Channel("driver/active", "u1", ("drivers",), "1", "the driver acted during the frame", _RIGID),
    # Contacts of bodies
    Channel("contact/pair", "i4", ("pairs", 2), "1", "indices a < b into `CacheIndex.colliders`", _RIGID, sign="+"),
    Channel("contact/impulse", "f8", ("pairs",), "N s", "normal impulse over the frame", _RIGID, "sum", "+"),
    Channel("contact/vector", "f8", ("pairs", 3), "N s",
            "what contacts gave to b over the frame, friction included, world; a was given the opposite; 0 where a = b", _RIGID, "sum"),
    Channel("contact/max_force", "f8", ("pairs",), "N", "largest normal force in the frame", _RIGID, "max", "+"),
    Channel("contact/min_gap", "f8", ("pairs",), "m", "smallest distance of collision shapes over the steps", _RIGID, "min"),
    Channel("event/time", "f8", ("events",), "s", "when the contact begins", _RIGID),
    Channel("event/pair", "i4", ("events", 2), "1", "indices a < b into `CacheIndex.colliders`", _RIGID, sign="+"),
    Channel("event/point", "f8", ("events", 3), "m", "where, world", _RIGID),
    Channel("event/speed", "f8", ("events",), "m/s", "closing speed at the contact", _RIGID),
    Channel("event/impulse", "f8", ("events",), "N s", "normal impulse within the frame, from the event on", _RIGID, "sum", "+"),
    # Bonds of breakable bodies
    Channel("bond/broken", "u1", ("bonds",), "1", "the bond is broken", _FRACTURE),
    Channel("bond/stress", "f4", ("bonds",), "1", "largest stress over strength found in the frame; 0: no load was solved for",
            _FRACTURE, "max", "+"),
    Channel("break/time", "f8", ("breaks",), "s", "end of the step in which the bond broke", _FRACTURE),
    Channel("break/bond", "i4", ("breaks",), "1", "which bond", _FRACTURE, sign="+"),
    Channel("break/point", "f8", ("breaks", 3), "m", "middle of its face, world", _FRACTURE),
    Channel("break/cause", "i4", ("breaks",), "1",
            "index into `CacheIndex.colliders` of what loaded the cluster most; -1: gravity or its own motion", _FRACTURE),
    Channel("break/ratio", "f8", ("breaks",), "1",
            "stress over strength; with a toughness, no more than the root of energy over toughness", _FRACTURE, "max", "+"),
    Channel("break/energy", "f8", ("breaks",), "J", "elastic energy of the bond when the load reached its strength", _FRACTURE, "sum", "+"),
    Channel("break/case", "i4", ("breaks",), "1", "load case", _FRACTURE, sign="+"),
    Channel("case/count", "i4", ("cases",), "1", "number of loads of each case", _FRACTURE, "sum", "+"),
    Channel("case/spin", "f8", ("cases", 3), "rad/s",
            "angular velocity of the cluster, entity's frame; 0 where the world holds it", _FRACTURE),
    Channel("case/piece", "i4", ("case loads",), "1", "loaded piece", _FRACTURE, sign="+"),
    Channel("case/load", "f8", ("case loads", 12), "N, N m",
            "smoothed contact force and torque about its centre, entity's frame: the lasting part, then the sudden rest", _FRACTURE),
    Channel("load/piece", "i4", ("loaded pieces",), "1", "pieces that contacts pushed in the frame", _FRACTURE, sign="+"),
    Channel("load/impulse", "f8", ("loaded pieces", 6), "N s, N m s",
            "summed contact impulse on each, about its centre, world", _FRACTURE, "sum"),
    # Surfaces that deform
    Channel("vertex/position", "f8", ("vertices", 3), "m", "world", _SOFT),
    Channel("vertex/velocity", "f4", ("vertices", 3), "m/s", "world", _SOFT),
    Channel("edge/open", "u1", ("vertices",), "1", "the side that begins at this corner is open", _TEARING),
    Channel("tear/time", "f8", ("tears",), "s", "end of the exchange after which it opened", _TEARING),
    Channel("tear/corner", "i4", ("tears",), "1", "a corner at the vertex that tore", _TEARING, sign="+"),
    Channel("tear/point", "f8", ("tears", 3), "m", "where, world", _TEARING, finite=True),
    Channel("tear/tension", "f8", ("tears",), "N/m", "around it, the largest over all directions", _TEARING, "max"),
    Channel("tear/cause", "i4", ("tears",), "1",
            "index into `CacheIndex.colliders` of the moving body that pulled or pushed most; -1: air, weight or its own motion", _TEARING),
    Channel("tear/side", "i4", ("sides", 3), "1", "which tear, a side, and the one along it", _TEARING, sign="+"),
    Channel("tear/triangle", "i4", ("triangles", 2), "1", "which tear, and the first corner of a triangle around it", _TEARING, sign="+"),
    Channel("tear/place", "f8", ("triangles", 3, 3), "m", "where that triangle's corners were", _TEARING, finite=True),
    # Liquids and particles
    Channel("origin", "f8", (3,), "m", "what float32 positions are relative to, world", (*_MATTER, "surface"), finite=True),
    Channel("particle/position", "f4", ("particles", 3), "m", "relative to `origin`", _MATTER, finite=True),
    Channel("particle/velocity", "f4", ("particles", 3), "m/s", "world axes", _MATTER, finite=True),
    Channel("particle/id", "i4", ("particles",), "1", "stays with a particle for life", _MATTER, sign="+"),
    Channel("particle/fluid", "i4", ("particles",), "1", "index into `CacheIndex.bodies`", _LIQUID, sign="+"),
    Channel("particle/volume", "f4", ("particles",), "m^3", "at rest density", _LIQUID, "sum", "+"),
    Channel("particle/density", "f4", ("particles",), "kg/m^3", "present density", _LIQUID),
    Channel("particle/pressure", "f4", ("particles",), "Pa", "present pressure", _LIQUID),
    Channel("particle/temperature", "f4", ("particles",), "K", "present temperature", _HEAT, sign="+"),
    Channel("particle/member", "i4", ("particles",), "1", "index into `CacheIndex.bodies`", _PARTICLES, sign="+"),
    Channel("particle/radius", "f4", ("particles",), "m", "radius", _PARTICLES, sign="+"),
    Channel("particle/spin", "f4", ("particles", 3), "rad/s", "angular velocity", _PARTICLES),
    Channel("inflow/mass", "f8", ("drivers",), "kg", "let in since frame 0; 0 for outflows", _LIQUID, "sum", "+"),
    Channel("outflow/mass", "f8", ("drivers",), "kg", "taken away since frame 0; 0 for inflows", _LIQUID, "sum", "+"),
    Channel("outflow/momentum", "f8", (3,), "N s", "carried out of the domain over the frame", _PARTICLES, "sum"),
    # Pushes of instances and fields
    Channel("exchange/impulse", "f8", ("pushed", 6), "N s, N m s",
            "given to each body over the frame, about its centre of mass: what the instance gave, or the rigid engine integrated",
            ("rigid coupled", "liquid", "cloth", "particles"), "sum"),
    Channel("exchange/reaction", "f8", ("boundaries", 6), "N s, N m s",
            "change of the matter's own momentum through each body over the frame, measured on the matter", _MATTER, "sum"),
    Channel("exchange/soft", "f8", ("deformables", 6), "N s, N m s",
            "what the rigid engine integrated of others' forces on each elastic member, about its centre of mass", ("elastic coupled",), "sum"),
    Channel("field/impulse", "f8", ("bodies", 3), "N s", "of force fields over the frame", ("rigid blown", "particles"), "sum"),
    Channel("field/soft", "f8", ("deformables", 3), "N s", "of force fields over the frame", ("elastic blown",), "sum"),
    # Made of a liquid's cache
    Channel("source", "u1", (32,), "1", "digest of the particles' container", _DERIVED),
    Channel("surface/vertices", "f4", ("surface vertices", 3), "m", "relative to `origin`", _SURFACE),
    Channel("surface/velocity", "f4", ("surface vertices", 3), "m/s", "of the liquid", _SURFACE),
    Channel("surface/temperature", "f4", ("surface vertices",), "K", "of the liquid", _SURFACE_HEAT),
    Channel("surface/faces", "i4", ("surface faces", 3), "1", "vertices of each triangle, outward", _SURFACE, sign="+"),
    Channel("surface/fluid", "i4", ("surface faces",), "1", "index into `CacheIndex.bodies`", _SURFACE, sign="+"),
    Channel("spray/position", "f4", ("spray", 3), "m", "relative to `origin`", _SURFACE),
    Channel("spray/velocity", "f4", ("spray", 3), "m/s", "world axes", _SURFACE),
    Channel("spray/volume", "f4", ("spray",), "m^3", "at rest density", _SURFACE, "sum", "+"),
    Channel("spray/fluid", "i4", ("spray",), "1", "index into `CacheIndex.bodies`", _SURFACE, sign="+"),
    Channel("spray/id", "i4", ("spray",), "1", "of the particle", _SURFACE, sign="+"),
    Channel("spray/temperature", "f4", ("spray",), "K", "of the particle", _SURFACE_HEAT),
    Channel("foam/position", "f4", ("bubbles", 3), "m", "relative to `origin`", _SURFACE),
    Channel("foam/id", "i4", ("foaming",), "1", "of the particle that carries foam", _SURFACE, sign="+"),
    Channel("foam/amount", "f4", ("foaming",), "1", "0 to 1", _SURFACE, sign="+"),
    Channel("wet/texel", "i4", ("wet",), "1", "which texel", _WET, sign="+"),
    Channel("wet/depth", "f4", ("wet",), "m", "under the top of the liquid that it touches, along gravity", _WET, "max", "+"),
    Channel("wet/fluid", "i4", ("wet",), "1", "index into `CacheIndex.bodies` of what it touches", _WET, sign="+"),
    Channel("track/texel", "i4", ("tracked",), "1", "which texel", _WET, sign="+"),
    Channel("track/film", "f4", ("tracked",), "1", "amount of film that it has then, 1 under liquid", _WET, sign="+"),
    Channel("track/fluid", "i4", ("tracked",), "1", "index into `CacheIndex.bodies` of what the film is of", _WET),
)  # fmt: skip

_QUANTITIES = (
    _quantity("kinetic_energy", "J", "sum over moving bodies, liquid or particles", _ALL, sign="+"),
    _quantity("potential_energy", "J", "gravity, against z = 0, plus springs", _ALL),
    _quantity("driver_work", "J", "work done by drivers since frame 0, positive into the bodies or the liquid", _DRIVEN),
    *_vector("momentum", "kg m/s", "sum over moving bodies or liquid", _ALL),
    *_vector("driver_impulse", "kg m/s", "momentum that zones of waves gave to a liquid since frame 0", _LIQUID),
    *_vector("field_impulse", "kg m/s", "momentum that force fields gave to a liquid since frame 0", _LIQUID),
    _quantity("field_work", "J", "work that force fields did on a liquid since frame 0", _LIQUID),
    _quantity("mass", "kg", "sum over moving bodies; of a liquid, what is in the domain", _ALL, sign="+", conserved=True),
    _quantity("body_count", "1", "moving bodies", _RIGID, sign="+", conserved=True),
    _quantity("max_speed", "m/s", "fastest centre of mass or particle over all steps of the frame", _ALL, total="max", sign="+"),
    _quantity("max_travel_per_step", "m", "largest surface travel in one step of the frame", _RIGID, total="max", sign="+"),
    _quantity("steps", "1", "solver steps taken in the frame", _ALL, sign="+"),
    _quantity("step", "s", "time step used in the frame; of a liquid, their mean", _ALL, total="max", sign="+"),
    _quantity("contacts_max", "1", "most contacts in one step of the frame; of cloth, near pairs", ("rigid", "cloth"), total="max", sign="+"),
    _quantity("contact_gain", "J", "most energy that contacts of bodies that touch gave in one step of the frame; none is sound", _RIGID,
              total="max"),
    _quantity("iterations_max", "1", "most solver iterations in one step of the frame", _RIGID, total="max", sign="+"),
    _quantity("iterations_capped", "1", "steps that ended at the iteration cap", ("rigid", "liquid"), sign="+"),
    _quantity("overflows", "1", "engine warnings: full contact or constraint buffers, bad states", _RIGID, sign="+"),
    _quantity("joint_error", "m", "largest gap of a welded, hinged or sliding joint", _RIGID, total="max", sign="+"),
    _quantity("strain_energy", "J", "stored in the deformation of elastic bodies", _ELASTIC),
    _quantity("elastic_kinetic_energy", "J", "sum over the nodes of elastic bodies", _ELASTIC, sign="+"),
    _quantity("elastic_potential_energy", "J", "gravity, against z = 0, of elastic bodies", _ELASTIC),
    *_vector("elastic_momentum", "kg m/s", "sum over the nodes of elastic bodies", _ELASTIC),
    _quantity("elastic_travel_per_step", "m", "farthest that a node of an elastic body went in one step of the frame", _ELASTIC,
              total="max", sign="+"),
    _quantity("soft_field_work", "J", "work of force fields on elastic bodies in the frame", ("elastic blown",)),
    _quantity("soft_exchange_work", "J", "work of others' forces on elastic bodies in the frame", ("elastic coupled",)),
    _quantity("fracture_energy", "J", "of the bonds that broke since frame 0", _FRACTURE, sign="+"),
    _quantity("solve_residual", "1", "largest relative residual of the elastic solve that did not converge; 0 where all did", _ELASTIC,
              total="max", sign="+"),
    _quantity("surface_volume", "m^3", "inside the reconstructed surface of a liquid", _SURFACE),
    _quantity("surface_area", "m^2", "of that surface", _SURFACE, sign="+"),
    _quantity("surface_components", "1", "separate pieces of that surface, cavities not counted", _SURFACE, sign="+"),
    _quantity("spray_volume", "m^3", "of particles apart from the liquid, which the surface leaves out", _SURFACE, sign="+"),
    _quantity("volume", "m^3", "sum of the particles' volumes at rest density", _MATTER, sign="+"),
    _quantity("particles", "1", "particles in the domain", _MATTER, sign="+"),
    _quantity("density_error_mean", "1", "largest mean compression at the end of a step of the frame", _LIQUID, total="max"),
    _quantity("density_error_max", "1", "largest compression at the end of a step of the frame", _LIQUID, total="max"),
    _quantity("iterations_pressure", "1", "most iterations of the density or pressure solve in a step of the frame", _LIQUID,
              total="max", sign="+"),
    _quantity("iterations_divergence", "1", "most iterations of the divergence solve in a step of the frame", _LIQUID,
              total="max", sign="+"),
    _quantity("lost", "1", "particles that are no longer there and that nothing took away, since frame 0", _MATTER, sign="+"),
    _quantity("inflow_mass", "kg", "let in by inflows or emitters since frame 0", _MATTER, sign="+"),
    _quantity("outflow_mass", "kg", "taken away by outflows since frame 0", _LIQUID, sign="+"),
    _quantity("torn_length", "m", "of all open edges of cloth, at rest", _TEARING, sign="+"),
    _quantity("stretch_energy", "J", "elastic, of stretch and shear of cloth", _CLOTH),
    _quantity("bending_energy", "J", "elastic, of the bending of cloth", _CLOTH),
    _quantity("stretch_max", "1", "largest extension of an edge of cloth over its length at rest", _CLOTH, total="max"),
    _quantity("stretch_min", "1", "largest shortening of an edge of cloth over its length at rest, negative", _CLOTH, total="min"),
    _quantity("exchanges", "1", "times in the frame at which cloth or particles looked at the air and at bodies", ("cloth", "particles"),
              sign="+"),
    _quantity("cut_vertices", "1", "vertices of cloth whose way was cut short so that nothing crosses, over all exchanges", _CLOTH,
              sign="+"),
    *_vector("air_impulse", "kg m/s", "momentum that air and fields gave to cloth since frame 0", _CLOTH),
    *_vector("hold_impulse", "kg m/s", "momentum that what holds vertices gave to cloth since frame 0", _CLOTH),
    *_vector("solid_impulse", "kg m/s", "momentum that contact with solids gave to cloth since frame 0", _CLOTH),
    *_vector("cut_impulse", "kg m/s", "momentum that ways cut short gave to cloth since frame 0", _CLOTH),
    *_vector("load_impulse", "kg m/s", "momentum that others' forces at its vertices gave to cloth since frame 0", _CLOTH),
    _quantity("air_work", "J", "work of air and fields on cloth since frame 0", _CLOTH),
    _quantity("hold_work", "J", "work of what holds vertices on cloth since frame 0", _CLOTH),
    _quantity("solid_work", "J", "work of moving solids in contact on cloth since frame 0", _CLOTH),
    _quantity("load_work", "J", "work of others' forces at its vertices on cloth since frame 0", _CLOTH),
    _quantity("domain_outflow", "kg", "left the domain since frame 0", _MATTER, sign="+"),
    _quantity("rotation_energy", "J", "of the spins of particles", _PARTICLES, sign="+"),
    _quantity("wall_work", "J", "work of the motion of bodies on grains in contact since frame 0", _PARTICLES),
    _quantity("contact_energy", "J", "elastic energy of contacts by their depths, among grains and with bodies", _PARTICLES),
    _quantity("spring_energy", "J", "elastic energy of the springs that resist slip and rolling in contacts", _PARTICLES),
    _quantity("mean_speed", "m/s", "of all particles at the frame", _PARTICLES, total="max", sign="+"),
    _quantity("inflow_count", "1", "particles that emitters let out since frame 0", _PARTICLES, sign="+"),
    _quantity("died_count", "1", "particles that died at surfaces or of age since frame 0", _PARTICLES, sign="+"),
    _quantity("died_mass", "kg", "their mass", _PARTICLES, sign="+"),
    _quantity("outflow_count", "1", "particles that left the domain since frame 0", _PARTICLES, sign="+"),
)  # fmt: skip

CHANNELS: Mapping[str, Channel] = {c.name: c for c in (*_CHANNELS, *_QUANTITIES)}
"""Every channel by name."""
QUANTITIES: Mapping[str, Channel] = {c.name.removeprefix(RECORD): c for c in _QUANTITIES}
"""Recorded quantities by name, without the prefix of their channels."""


@cache
def names_written(writers: frozenset[Writer]) -> frozenset[str]:
    """Names of the channels that an instance which is all of these writes in every frame."""
    return frozenset(c.name for c in CHANNELS.values() if writers & set(c.of))
