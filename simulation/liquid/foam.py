"""Which particles fly apart from the liquid (spray) and where foam lies on it.

Potentials of trapped air, wave crests and energy: Ihmsen et al. (2012), doi:10.1007/s00371-012-0697-9. Unlike there, foam
is no system of particles of its own: it rides on the liquid's particles near the surface, grows with the potentials and fades.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, I32
from .surround import Surroundings

__all__ = ["FoamState", "bubbles", "grow_foam", "spray_of"]

ALONE = 5
"""Fewer neighbours within two spacings than this make a particle spray; a lattice's face has about 20."""
DROPLET = 24
"""Clumps of fewer particles are spray: too small for a mesh."""
STAY = 1.4
"""Spray stays spray until it has this many times the neighbours or clump: else it would flicker."""
TRAPPED = (3.0, 14.0)
"""Range of the potential of trapped air [m/s]; own choice, 5..20 in the source."""
CREST = (2.0, 8.0)
"""Range of the potential of wave crests, as in the source."""
ENERGY = (0.4, 6.0)
"""Range of kinetic energy per mass [m^2/s^2]: 0.9 to 3.5 m/s; own choice, the source's depends on particle size."""
GROWTH, LIFE = 6.0, 1.2
"""Growth at full potential [1/s] and time in which foam fades to 1/e [s]; own choice."""
LEAST = 0.04
"""Foam below this amount is gone."""
BUBBLES = 16
"""Bubbles of a particle at amount 1."""


@dataclass(frozen=True)
class FoamState:
    """Particles that carry foam, ordered by id."""

    identity: I32
    amount: NDArray[np.float32]


def spray_of(count: NDArray[np.int32], clump: NDArray[np.int64], was: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Particles apart from the liquid, by neighbours, size of the clump, and whether they were so before; each (n,)."""
    factor = np.where(was, STAY, 1.0)
    return (count < ALONE * factor) | (clump < DROPLET * factor)


def _ramp(value: F64, bounds: tuple[float, float]) -> F64:
    return np.clip((value - bounds[0]) / (bounds[1] - bounds[0]), 0.0, 1.0)


def grow_foam(
    identity: I32, velocity: F64, around: Surroundings, liquid: NDArray[np.bool_], before: FoamState | None, dt: float
) -> tuple[FoamState, F64]:
    """Foam after another frame, and its amount on every particle, 0..1, shape (n,).

    Args:
        identity: of the particles (n,).
        velocity: (n, 3) [m/s].
        around: their surroundings.
        liquid: those that are not spray.
        before: at the frame before; None at the first.
        dt: time between frames [s].
    """
    amount = np.zeros(len(identity))
    if before is not None and len(before.identity):
        place = np.minimum(np.searchsorted(before.identity, identity), len(before.identity) - 1)
        amount = np.where(before.identity[place] == identity, before.amount[place], 0.0)
    surface = (around.normal != 0).any(1) & liquid
    potential = _ramp(0.5 * (velocity**2).sum(1), ENERGY) * (_ramp(around.trapped, TRAPPED) + _ramp(around.crest, CREST))
    fed = surface * np.clip(potential, 0.0, 1.0)
    amount = amount * np.exp(-dt / LIFE)
    amount = np.where(liquid, amount + (1 - amount) * (1 - np.exp(-GROWTH * fed * dt)), 0.0)
    amount[amount < LEAST] = 0.0
    kept = np.flatnonzero(amount)
    kept = kept[np.argsort(identity[kept], kind="stable")]
    return FoamState(identity[kept].astype(np.int32), amount[kept].astype(np.float32)), amount * surface


def _hashed(key: NDArray[np.uint64]) -> F64:
    """Repeatable numbers in [0, 1) from integers (splitmix64)."""
    with np.errstate(over="ignore"):
        x = key + np.uint64(0x9E3779B97F4A7C15)
        x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        x = x ^ (x >> np.uint64(31))
    return (x >> np.uint64(11)).astype(np.float64) / 2.0**53


def bubbles(identity: I32, position: F64, normal: F64, amount: F64, spacing: float) -> F64:
    """Places of bubbles around the particles that carry foam, on the liquid's face; shape (f, 3) [m].

    They keep their places relative to their particle, so that foam does not boil.
    """
    owner = np.repeat(np.arange(len(identity)), np.ceil(BUBBLES * amount).astype(np.int64) * (amount > 0))
    if not len(owner):
        return np.empty((0, 3))
    rank = np.arange(len(owner)) - np.searchsorted(owner, owner)
    key = (identity[owner].astype(np.uint64) * np.uint64(64) + rank.astype(np.uint64)) * np.uint64(4)
    shift = np.stack([_hashed(key + np.uint64(k)) for k in range(3)], axis=1) * 2 - 1
    outward = normal[owner]
    flat = shift - (shift * outward).sum(1)[:, None] * outward
    return np.asarray(position[owner] + spacing * (0.9 * flat + (0.42 + 0.1 * shift[:, :1]) * outward))
