"""Channels of rigid instances: poses, contacts, joints, drivers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from ...channel import Channel, quantity
from ...fields import fields_of, lifted_members
from ...instances import coupled_groups
from ..shared_channels import CONTACTS, DRIVER_WORK, FIELD_IMPULSE, GIVEN, ITERATIONS_CAPPED, MOTION

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["CHANNELS", "DIMENSIONS", "writers"]

DIMENSIONS: Mapping[str, str] = {
    "joints": "`CacheIndex.joints`: hinges and slides",
    "pairs": "pairs of colliders that touched since the last frame",
    "events": "contacts that began in the frame, in order of time",
    "impacts": "impacts of single contacts in the frame, in the order in which they followed one another",
}

CHANNELS: Mapping[str, tuple[Channel, ...]] = {
    "rigid": (
        Channel("position", "f8", ("bodies", 3), "m", "origin of the body's frame, world"),
        Channel("quaternion", "f8", ("bodies", 4), "1", "orientation of the body's frame (w, x, y, z)"),
        Channel("velocity", "f8", ("bodies", 3), "m/s", "of the centre of mass, world"),
        Channel("angular_velocity", "f8", ("bodies", 3), "rad/s", "world axes"),
        Channel("asleep", "u1", ("bodies",), "1", "1: the body sleeps; 2: since a time within the frame"),
        Channel("joint", "f8", ("joints",), "rad or m", "coordinate of hinge and slide joints"),
        Channel("driver/active", "u1", ("drivers",), "1", "the driver acted during the frame"),
        Channel("contact/pair", "i4", ("pairs", 2), "1", "indices a < b into `CacheIndex.colliders`", sign="+"),
        Channel("contact/impulse", "f8", ("pairs",), "N s", "normal impulse over the frame", "sum", "+"),
        Channel("contact/vector", "f8", ("pairs", 3), "N s", "what contacts gave to b over the frame, friction included, world; a was given the opposite; 0 where a = b", "sum"),
        Channel("contact/max_force", "f8", ("pairs",), "N", "largest normal force in the frame", "max", "+"),
        Channel("contact/min_gap", "f8", ("pairs",), "m", "smallest distance of collision shapes over the steps", "min"),
        Channel("event/time", "f8", ("events",), "s", "when the contact begins"),
        Channel("event/pair", "i4", ("events", 2), "1", "indices a < b into `CacheIndex.colliders`", sign="+"),
        Channel("event/point", "f8", ("events", 3), "m", "where, world"),
        Channel("event/speed", "f8", ("events",), "m/s", "closing speed at the contact"),
        Channel("event/impulse", "f8", ("events",), "N s", "normal impulse within the frame, from the event on", "sum", "+"),
        Channel("impact/time", "f8", ("impacts",), "s", "end of the step in which it was"),
        Channel("impact/pair", "i4", ("impacts", 2), "1", "indices a < b into `CacheIndex.colliders`", sign="+"),
        Channel("impact/turn", "i4", ("impacts",), "1", "which of those of the step that followed one another; those of one turn were at once", sign="+"),
        Channel("impact/normal", "f8", ("impacts", 3), "1", "of the contact, from a to b, world"),
        Channel("impact/vector", "f8", ("impacts", 3), "N s", "what it gave to b, friction included, world; a was given the opposite"),
        quantity("body_count", "1", "moving bodies", sign="+", conserved=True),
        quantity("max_travel_per_step", "m", "largest surface travel in one step of the frame", total="max", sign="+"),
        quantity("contact_gain", "J", "most energy that contacts of bodies that touch gave in one step of the frame; none is sound", total="max"),
        quantity("iterations_max", "1", "most solver iterations in one step of the frame", total="max", sign="+"),
        quantity("overflows", "1", "engine warnings: full contact or constraint buffers, bad states", sign="+"),
        quantity("joint_error", "m", "largest gap of a welded, hinged or sliding joint", total="max", sign="+"),
        *MOTION,
        DRIVER_WORK,
        CONTACTS,
        ITERATIONS_CAPPED,
    ),
    "rigid coupled": (
        GIVEN,
    ),
    "rigid blown": (
        FIELD_IMPULSE,
    ),
    "rigid lifted": (
        Channel("field/twist", "f8", ("bodies", 3), "N m s", "angular impulse of media with lift over the frame, about each body's centre of mass", "sum"),
    ),
}  # fmt: skip
"""By kind of writer."""


def writers(spec: WorldSpec, name: str) -> Iterator[str]:
    """More kinds of writer that a rigid instance is: one that others push, one with bodies in force fields."""
    if name not in spec.simulation.rigid:
        return
    if any(name in group for group in coupled_groups(spec)):
        yield "rigid coupled"
    members = [m for m in spec.simulation.solvers[name].members if m in spec.entities]
    if any(spec.entities[m].physics.category == "rigid" and fields_of(spec, m) for m in members):
        yield "rigid blown"
    if lifted_members(spec, name):
        yield "rigid lifted"
