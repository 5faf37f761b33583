"""Contact stiffness and damping that make restitution measure what the material says.

A contact is a unilateral spring-damper in acceleration form, a = -b v - k r (MuJoCo's direct `solref`). With
natural period / 2 pi = N steps, k = 1 / (N dt)^2, and b = 2 zeta sqrt(k). The coefficient of restitution is a
function of zeta alone when the contact ends as the force vanishes (T. Schwager and T. Poeschel, Granular Matter 9
(2007) 465, give the closed form). Here the same law is integrated with the engine's own scheme, so that the
discretisation is calibrated too.
"""

from __future__ import annotations

from functools import lru_cache

__all__ = ["IMPEDANCE", "contact_reference", "damping_ratio", "rebound"]

IMPEDANCE = 0.97
"""Constant impedance d of contacts: a share 1 - d of the unconstrained acceleration passes. Below 1 the
solver converges in 2-3 iterations instead of 10 or more; what is left, (1 - d) of gravity, sinks a resting body by
(1 - d) / d g (N dt)^2, below a nanometre."""
PHASES = 32
"""Impact instants within a step that a rebound is averaged over."""


def rebound(zeta: float, steps: float) -> float:
    """Mean ratio of separation to approach speed of the discretised contact, in units of dt = 1.

    Args:
        zeta: damping ratio of the contact.
        steps: N, natural period / 2 pi in steps.
    """
    k = 1.0 / steps**2
    b = 2.0 * zeta / steps
    total = 0.0
    for phase in range(PHASES):
        v, r = -1.0, (phase + 0.5) / PHASES
        for _ in range(int(40 * steps)):
            a = -b * v - k * r if r < 0 else 0.0
            v += max(a, 0.0)
            r += v
            if r > 0 and v > 0:
                break
        total += v
    return max(0.0, total / PHASES)


@lru_cache(maxsize=256)
def damping_ratio(restitution: float, steps: float) -> float:
    """Damping ratio whose discretised rebound is `restitution`; 1 (critical) for 0.

    Bisection on `rebound`, which falls with zeta.
    """
    if restitution <= rebound(1.0, steps):
        return 1.0
    low, high = 0.0, 1.0
    if rebound(0.0, steps) <= restitution:
        return 0.0
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if rebound(middle, steps) > restitution else (low, middle)
    return (low + high) / 2


def contact_reference(restitution: float, steps: float, dt: float) -> tuple[float, float]:
    """Stiffness k [1/s^2] and damping b [1/s] of a contact; MuJoCo takes them negated."""
    omega = 1.0 / (steps * dt)
    return omega * omega, 2.0 * damping_ratio(restitution, steps) * omega
