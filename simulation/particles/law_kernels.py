# mypy: ignore-errors
"""The contact law of two spheres as Warp functions: Hertz, Mindlin with history, rolling springs, adhesion. method.md has sources."""

import warp as wp

__all__ = ["Law", "Touch", "touch"]


@wp.struct
class Law:
    """Constants of a pair of kinds."""

    young: wp.float32
    """Effective modulus [Pa]."""
    shear: wp.float32
    """Effective shear modulus [Pa]."""
    damping: wp.float32
    """Factor of the damped oscillator that the restitution asks for: 2 sqrt(5/6) beta."""
    friction: wp.float32
    rolling: wp.float32
    """Rolling resistance in effective radii."""
    pull: wp.float32
    """Adhesion in effective radii [N/m]: 2 pi w."""


@wp.struct
class Touch:
    """Forces of one contact."""

    force: wp.vec3
    """On the first [N]."""
    couple: wp.vec3
    """Couple of rolling resistance, on the first [N m]."""
    spring: wp.vec3
    """Tangential force that is stored, on the first [N]."""
    roll: wp.vec3
    """Rolling couple that is stored, on the first [N m]."""


@wp.func
def tangent(stored: wp.vec3, n: wp.vec3):
    """A stored force turned into the present tangent plane at its length."""
    flat = stored - wp.dot(stored, n) * n
    was = wp.length_sq(stored)
    now = wp.length_sq(flat)
    kept = wp.vec3(0.0, 0.0, 0.0)
    if now > 1.0e-6 * was and was > 0.0:
        kept = flat * wp.sqrt(was / now)
    return kept


@wp.func
def touch(
    law: Law,
    n: wp.vec3,
    depth: wp.float32,
    radius: wp.float32,
    mass: wp.float32,
    slip: wp.vec3,
    turn: wp.vec3,
    spring: wp.vec3,
    roll: wp.vec3,
    dt: wp.float32,
):
    """One contact over one step.

    `n` points from the second to the first; `slip` and `turn` are velocity and angular velocity of the first relative to the second
    at the contact; `radius` and `mass` are effective; `spring` and `roll` are what was stored.
    """
    out = Touch()
    a = wp.sqrt(radius * depth)
    closing = wp.dot(slip, n)
    stiff = 2.0 * law.young * a
    elastic = 0.66666667 * stiff * depth
    push = elastic - law.damping * wp.sqrt(stiff * mass) * closing
    limit = law.friction * wp.max(push, 0.0)
    along = slip - closing * n
    side = 8.0 * law.shear * a
    kept = tangent(spring, n)
    before = depth + closing * dt
    if closing > 0.0 and before > depth:
        # The contact shrinks: what the lost area bore is gone (Thornton, Cummins, Cleary 2013).
        kept = kept * wp.sqrt(depth / before)
    kept = kept - (side * dt) * along
    damp = (-law.damping * wp.sqrt(side * mass)) * along
    drag = kept + damp
    size = wp.length(drag)
    if size > limit:
        drag = drag * (limit / size)
        kept = drag - damp
    out.force = (push - law.pull * radius) * n + drag
    out.spring = kept
    out.couple = wp.vec3(0.0, 0.0, 0.0)
    out.roll = wp.vec3(0.0, 0.0, 0.0)
    if law.rolling > 0.0:
        most = law.rolling * radius * wp.max(push, 0.0)
        firm = side * radius * radius
        wound = roll - (firm * dt) * turn
        calm = (-law.damping * radius * wp.sqrt(firm * mass)) * turn
        size = wp.length(wound)
        if size > most:
            wound = wound * (most / size)
            calm = wp.vec3(0.0, 0.0, 0.0)
        out.roll = wound
        out.couple = wound + calm
    return out
