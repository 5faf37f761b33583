"""Judges whether what media gave to bodies that declare lift is what the law of plates says (R18, R66).

A body that nothing else touches is flown anew from each frame to the next; where contacts or joints lead it, the law is asked along the way
between both frames, and what it changes by on that way, or by what a contact can have changed the velocity, is left open.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....physics.substances import AIR_DENSITY
from ....worlds.arrays import F64
from ....worlds.extents import told_mass
from ....worlds.fields import lifted_members
from ...ledgers.gliding import Air, Given, along, ends_of, glide, slope

if TYPE_CHECKING:
    from ....physics.lift import Hull
    from ....worlds.fields import Fields
    from ....worlds.spec import WorldSpec
    from ...ledgers.balance import Books

__all__ = ["lift_lines", "lifted_off"]

TINY = 1e-12
"""[N s, N m s]"""
MOVED_ALONG = 0.455
"""[1] Mass of the medium that a square plate moves along across itself, over its density and the cube of the side: 0.579 pi / 4 (DNV-RP-C205, table D-2)."""


def lifted_off(books: Books, body: int, found: Fields, hull: Hull, told: tuple[F64, F64], astray: F64) -> F64:
    """Deviation of recorded impulses and twists [N s, N m s], (F - 1, 3) each, from the law, as share of their largest, shape (F - 1,).

    `astray`: largest deviation of the velocity on the way from the straight line between both frames [m/s], by what may have touched the body.
    """
    air, ends, owner, h = air_about(books, body, found), ends_of(books, body), books.owner[body], books.duration
    mass = float(books.body_mass[body])
    flown = glide(hull, (mass, books.inertia[body]), books.gravity, air, ends, h)
    led = along(hull, mass, air, ends, h)
    free = books.lone[owner] & ~books.touched[:, owner] & ~books.liquid.wet[:, owner]
    past = np.linalg.norm(air.velocity[::2] - ends.velocity, axis=2).max(axis=0) + astray
    loose = h * np.stack([bent(air), astray]) * slope(hull, air, past)
    reach = float(np.linalg.norm(hull.arms, axis=1).max(initial=0.0) + np.linalg.norm(hull.center))
    worst = np.zeros(len(free))
    for k, (given, lever) in enumerate(zip(told, (1.0, reach), strict=True)):
        worst = np.maximum(worst, _share(given, (flown, led), k, free, loose * lever))
    return worst


def bent(air: Air) -> F64:
    """By how much the air in the middle of each interval differs from the mean of that at both ends [m/s], shape (k,): as much is not known of it."""
    return np.asarray(np.linalg.norm(air.velocity[1] - 0.5 * (air.velocity[0] + air.velocity[2]), axis=1))


def _share(given: F64, laws: tuple[Given, Given], which: int, free: F64, loose: F64) -> F64:
    """Deviation of one of impulse and twist as share of its largest; `loose`: what is left open of free bodies, and more of others."""
    flown, led = (law[which] for law in laws)
    scale = max(
        float(np.linalg.norm(np.where(free[:, None], flown, led), axis=1).max(initial=0.0)),
        float(np.linalg.norm(given, axis=1).max(initial=0.0)),
    )
    off = np.maximum(np.linalg.norm(given - flown, axis=1) - loose[0], 0.0)
    bound = np.linalg.norm(given - led, axis=1) - laws[1].uneven[:, which] - loose.sum(axis=0)
    return np.asarray(np.where(free, off, np.maximum(bound, 0.0)) / max(scale, TINY))


def air_about(books: Books, body: int, found: Fields) -> Air:
    """Fields about a body at both ends and in the middle of every interval."""
    x, v, h = books.body_centers[:, body], books.velocity[:, body], books.duration
    places = (x[:-1], 0.5 * (x[:-1] + x[1:]) - h / 8 * (v[1:] - v[:-1]), x[1:])
    # A field that ends with the frame acts in all of it: that at the end is that of just before.
    times = (books.times[:-1], books.times[:-1] + 0.5 * h, books.times[1:] - 1e-9)
    count = books.frames - 1
    velocity, pressure, pull = np.zeros((3, count, 3)), np.zeros((3, count)), np.zeros((3, count, 3))
    for k, (place, when) in enumerate(zip(places, times, strict=True)):
        for row, time in enumerate(when.tolist()):
            pull[k, row] = found.acceleration(place[row : row + 1], time)[0]
            if found.has_medium:
                medium = found.medium(place[row : row + 1], time)
                velocity[k, row], pressure[k, row] = medium.velocity[0], 0.5 * float(medium.density[0] * medium.coefficient[0])
    return Air(velocity, pressure, pull)


def lift_lines(spec: WorldSpec, solver: str) -> list[dict[str, str]]:
    """Lines of the approximation register about the members of an instance that lift acts on."""
    found = []
    for name in lifted_members(spec, solver):
        *_, wide, long = sorted(spec.entities[name].dimensions.size)
        own = told_mass(spec, name)
        along = MOVED_ALONG * AIR_DENSITY * (wide * long) ** 1.5 / own if own > 0.0 else 0.0
        told = f", in air about {along:.1%} of its own mass" if along else ""
        found += [
            {
                "what": f"lift and torque of a medium on {name!r} are those of a steady flow past a plate about as long as wide, by the flatness of its hull",
                "effect": "no stall that lags, no lift by spin, no vortices that leave its edges: a strip, a tumbling or fluttering card keeps its manner and loses its measure",
            },
            {
                "what": f"what of the medium moves along with {name!r} has no mass{told}",
                "effect": "it speeds up and turns sooner by as much",
            },
            {
                "what": f"the medium about {name!r} is that at its centre of mass",
                "effect": "shear and eddies smaller than it neither turn nor lift it; its torque is not taken from a gas that feels it",
            },
        ]
    return found
