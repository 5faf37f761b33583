"""Small worlds of a cart whose wheels turn freely: held on a slope by a wedge under a wheel, and on level ground beside a block."""

from __future__ import annotations

import math

import numpy as np

from ...worlds.spec import Cylinder, Entity, HingeJoint, Material, RigidSettings, WorldSpec
from .small_worlds import box, entity, world

__all__ = ["parked", "wedged"]

WHEEL, TRACK, BASE, GAP = 0.1, 0.4, 0.5, 0.0005
"""Radius of the wheels, their distances across and along [m], and what is left between things that touch [m]."""
WOOD = {"wood": Material(density=600.0, friction=0.6, restitution=0.0, substance="wood")}


def _cart(slope: float, stop: Entity | None = None, at: float = 0.0) -> WorldSpec:
    """A cart on a slope [rad] that goes down along x, and a block, in the slope's frame, whose near face lies `at` along x."""
    turn = np.array([[math.cos(slope), 0, math.sin(slope)], [0, 1, 0], [-math.sin(slope), 0, math.cos(slope)]])

    def place(x: float, y: float, z: float) -> list[float]:
        return [float(v) for v in turn @ np.array([x, y, z])]

    bed = box(0.7, 0.3, 0.08, motion="dynamic", at=place(0, 0, WHEEL + GAP), euler=(0, slope, 0))
    entities = {"ramp": box(6.0, 2.0, 0.2, at=place(0, 0, -0.1), euler=(0, slope, 0)), "cart": bed}
    joints = {}
    for name, x, y in (("fl", 1, 1), ("fr", 1, -1), ("bl", -1, 1), ("br", -1, -1)):
        center = place(0.5 * BASE * x, 0.5 * TRACK * y, WHEEL + GAP)
        wheel = Cylinder(radius=WHEEL, height=0.04)
        entities[name] = entity(wheel, motion="dynamic", at=center, euler=(math.pi / 2, 0, 0), size=(2 * WHEEL, 2 * WHEEL, 0.04))
        joints[name] = HingeJoint(parent="cart", child=name, anchor=(center[0], center[1], center[2]), axis=(0, 1, 0))
    if stop is not None:
        size = stop.dimensions.size
        entities["block"] = box(*size, at=place(at + 0.5 * size[0], 0.5 * TRACK, 0.5 * size[2]), euler=(0, slope, 0))
    return world(entities, frames=30, settings=RigidSettings(step=1e-3), joints=joints, materials=WOOD)


def wedged() -> WorldSpec:
    """A block before the front wheel of a cart on a slope of 6 degrees holds the cart."""
    return _cart(math.radians(6.0), box(0.1, 0.1, 0.2), 0.5 * BASE + WHEEL + GAP)


def parked() -> WorldSpec:
    """A cart stands on level ground, a block touches its front wheel."""
    return _cart(0.0, box(0.1, 0.1, 0.2), 0.5 * BASE + WHEEL + GAP)
