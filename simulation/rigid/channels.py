"""Channels that a rigid instance writes."""

from __future__ import annotations

from ..protocol import Channel

__all__ = ["BROKEN", "CHANNELS", "EXCHANGED", "FIELDS"]

CHANNELS = (
    Channel("position", "f8", "m", ("bodies", "3"), "body"),
    Channel("quaternion", "f8", "1", ("bodies", "4"), "body"),
    Channel("velocity", "f8", "m/s", ("bodies", "3"), "body"),
    Channel("angular_velocity", "f8", "rad/s", ("bodies", "3"), "body"),
    # 1 asleep, 2 asleep since a time within the frame.
    Channel("asleep", "u1", "1", ("bodies",), "body"),
    Channel("joint", "f8", "rad or m", ("joints",), "joint"),
    Channel("contact/pair", "i4", "1", ("pairs", "2"), "pair"),
    Channel("contact/impulse", "f8", "N s", ("pairs",), "pair"),
    Channel("contact/vector", "f8", "N s", ("pairs", "3"), "pair"),
    Channel("contact/max_force", "f8", "N", ("pairs",), "pair"),
    Channel("contact/min_gap", "f8", "m", ("pairs",), "pair"),
    Channel("event/time", "f8", "s", ("events",), "event"),
    Channel("event/pair", "i4", "1", ("events", "2"), "event"),
    Channel("event/point", "f8", "m", ("events", "3"), "event"),
    Channel("event/speed", "f8", "m/s", ("events",), "event"),
    Channel("event/impulse", "f8", "N s", ("events",), "event"),
    Channel("driver/active", "u1", "1", ("drivers",), "frame"),
)
EXCHANGED = Channel("exchange/impulse", "f8", "N s, N m s", ("bodies", "6"), "body")
FIELDS = Channel("field/impulse", "f8", "N s", ("bodies", "3"), "body")
BROKEN = (
    Channel("bond/broken", "u1", "1", ("bonds",), "bond"),
    Channel("bond/stress", "f4", "1", ("bonds",), "bond"),
    Channel("break/time", "f8", "s", ("breaks",), "break"),
    Channel("break/bond", "i4", "1", ("breaks",), "break"),
    Channel("break/point", "f8", "m", ("breaks", "3"), "break"),
    Channel("break/cause", "i4", "1", ("breaks",), "break"),
    Channel("break/ratio", "f8", "1", ("breaks",), "break"),
    Channel("break/energy", "f8", "J", ("breaks",), "break"),
    Channel("break/case", "i4", "1", ("breaks",), "break"),
    Channel("case/count", "i4", "1", ("cases",), "case"),
    Channel("case/spin", "f8", "rad/s", ("cases", "3"), "case"),
    Channel("case/piece", "i4", "1", ("case loads",), "load"),
    Channel("case/load", "f8", "N, N m", ("case loads", "6"), "load"),
    Channel("load/piece", "i4", "1", ("loaded pieces",), "load"),
    Channel("load/impulse", "f8", "N s, N m s", ("loaded pieces", "6"), "load"),
)
"""Only of instances with breakable members."""
