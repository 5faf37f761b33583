"""Contact law: Newton's impact law for closing contacts, a soft recovery for those that stay.

MuJoCo solves a contact for an acceleration a = -b v - k r (direct `solref`), r < 0 being the depth inside the summed
skins. With b = 1 / dt the approach ends within one step whatever the phase of the impact, so that a body enters a skin
by at most v dt and friction sticks within a step too; k = 1 / (N dt)^2 pushes what entered back out, softly, because
depth that is pushed out fast comes back as speed (phase / N^2 of the approach speed).

Restitution is not left to the spring: a contact that closes faster than `rest_speed` gets the reference acceleration
-(1 + e) v / dt instead, which is Newton's law v' = -e v (J. J. Moreau, *Unilateral contact and dry friction in finite
freedom dynamics*, 1988, for several contacts at once). A calibrated spring-damper gave e +-0.02 depending on the phase
of the impact, dipped N times deeper, and left friction nearly no damping when e was near 1.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64

__all__ = ["IMPEDANCE", "Restitution", "contact_reference", "rest_speed"]

IMPEDANCE = 0.99
"""Constant impedance d of contacts: a share 1 - d of the unconstrained acceleration passes. Below 1 the
solver converges in 2-4 iterations instead of 10 or more; what is left, (1 - d) of gravity, sinks a resting body by
(1 - d) / d g (N dt)^2, a few micrometres."""
SLOWEST_BOUNCE = 0.01
"""[m/s] Contacts that close slower do not bounce: a hop from there is 5 micrometres high."""
GRAVITY_STEPS = 4.0
"""Contacts that close slower than gravity makes them in this many steps do not bounce either, or nothing would rest."""


def contact_reference(steps: float, dt: float) -> tuple[float, float]:
    """Stiffness k [1/s^2] and damping b [1/s] of a contact; MuJoCo takes them negated."""
    return 1.0 / (steps * dt) ** 2, 1.0 / dt


def rest_speed(gravity: float, dt: float) -> float:
    """Closing speed below which a contact does not bounce [m/s]."""
    return max(SLOWEST_BOUNCE, GRAVITY_STEPS * gravity * dt)


class Restitution:
    """Gives closing contacts their rebound, between the velocity stage of a step and its solution.

    Args:
        geoms: restitution per geom, shape (ngeom,).
        bodies: body per geom, shape (ngeom,).
        colliders: collider per geom, shape (ngeom,).
        pairs: restitution of pairs of colliders that have their own.
    """

    def __init__(self, geoms: F64, bodies: Any, colliders: Any, pairs: dict[tuple[int, int], float]) -> None:
        self.geoms, self.colliders = geoms, colliders
        self.count = int(colliders.max(initial=0)) + 1
        table = sorted((min(p) * self.count + max(p), e) for p, e in pairs.items())
        self._keys = np.array([k for k, _ in table], dtype=np.int64)
        self._values = np.array([e for _, e in table])
        bouncing = np.unique(bodies[geoms > 0])
        self.any = len(bouncing) > 1 or bool((self._values > 0).any())
        """Whether any contact can bounce at all."""

    def of(self, geoms: Any) -> F64:
        """Restitution of contacts between geoms, shape (n, 2) -> (n,): the smaller one, or the pair's own."""
        value = self.geoms[geoms].min(axis=1)
        if len(self._keys):
            sides = self.colliders[geoms]
            key = sides.min(axis=1) * self.count + sides.max(axis=1)
            place = np.minimum(np.searchsorted(self._keys, key), len(self._keys) - 1)
            value = np.where(self._keys[place] == key, self._values[place], value)
        return np.asarray(value)

    def apply(self, data: Any, dt: float, slowest: float) -> None:
        """Write the rebound into the reference accelerations of contacts that close faster than `slowest` [m/s]."""
        if not data.ncon or not data.nefc:
            return
        rows = data.contact.efc_address
        speed = data.efc_vel[rows]
        hit = speed < -slowest
        if not hit.any():
            return
        hit &= rows >= 0
        bounce = self.of(data.contact.geom[hit])
        fast = bounce > 0
        target = rows[hit][fast]
        data.efc_aref[target] = -(1.0 + bounce[fast]) * speed[hit][fast] / (dt * IMPEDANCE)
