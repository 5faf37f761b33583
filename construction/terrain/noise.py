"""Band-limited random fields that do not change their character with resolution: functions of the place in metres."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypedDict, Unpack

import numpy as np

from ...worlds.arrays import F64
from .slices import in_slices

__all__ = ["billow", "fractal", "gradient_noise", "ridged", "warped"]

POINTS = 65536
"""Points that one thread takes at a time."""


def gradient_noise(x: F64, y: F64, wavelength: float, seed: int) -> F64:
    """Gradient noise (Perlin 2002) at points [m]: zero mean, about -1 to 1, features of the size of `wavelength` [m].

    The value at a place depends on nothing but the place and the seed.
    """
    from .noise_kernels import gradient

    wide = np.broadcast_arrays(np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64))
    flat = [np.ascontiguousarray(a).ravel() for a in wide]
    found = np.empty(flat[0].size)

    def work(first: int, last: int) -> None:
        found[first:last] = gradient(flat[0][first:last], flat[1][first:last], wavelength, seed)

    in_slices(found.size, work, size=POINTS)
    return found.reshape(wide[0].shape)


def _octaves(wavelength: float, cell: float, octaves: int) -> int:
    """Octaves that the grid can carry: the shortest has at least two cells."""
    most = int(np.floor(np.log2(max(wavelength / (2.0 * cell), 1.0)))) + 1
    return max(1, min(octaves, most))


class Octaves(TypedDict):
    """Octaves of a field: of halved wavelength [m] and amplitude times `gain`.

    Those finer than two cells of the grid are left out, the coarse ones stay as they are: a finer grid adds detail only.
    """

    wavelength: float
    octaves: int
    gain: float
    seed: int
    cell: float


def _summed(x: F64, y: F64, part: Callable[[float, F64], F64], given: Octaves) -> F64:
    """Sum of what `part` makes of the amplitude and the noise of each octave, over the sum of all amplitudes."""
    wavelength, octaves = given["wavelength"], given["octaves"]
    total, amplitude, norm = np.zeros(np.broadcast_shapes(np.shape(x), np.shape(y))), 1.0, 0.0
    for k in range(octaves):
        norm += amplitude
        if k < _octaves(wavelength, given["cell"], octaves):
            total += part(amplitude, gradient_noise(x, y, wavelength / 2**k, given["seed"] + 7919 * k))
        amplitude *= given["gain"]
    return total / norm


def fractal(x: F64, y: F64, **octaves: Unpack[Octaves]) -> F64:
    """Fractional Brownian motion; about -1 to 1."""
    return _summed(x, y, lambda amplitude, noise: amplitude * noise, octaves)


def ridged(x: F64, y: F64, **octaves: Unpack[Octaves]) -> F64:
    """Ridged multifractal (Musgrave 1993): sharp crests, each octave weighted by the one before; 0 to 1."""
    weight: Any = 1.0

    def part(amplitude: float, noise: F64) -> F64:
        nonlocal weight
        crest = (1.0 - np.minimum(np.abs(noise), 1.0)) ** 2
        own, weight = amplitude * crest * weight, np.clip(2.0 * crest, 0.0, 1.0)
        return np.asarray(own)

    return _summed(x, y, part, octaves)


def billow(x: F64, y: F64, **octaves: Unpack[Octaves]) -> F64:
    """Sum of absolute octaves: rounded hills with sharp valleys; 0 to 1."""
    return _summed(x, y, lambda amplitude, noise: amplitude * np.minimum(np.abs(noise), 1.0), octaves)


def warped(x: F64, y: F64, *, wavelength: float, strength: float, seed: int) -> tuple[F64, F64]:
    """Points [m] moved by noise of this wavelength, by about `strength` [m]: breaks straight lines and circles."""
    dx = gradient_noise(x, y, wavelength, seed + 101)
    dy = gradient_noise(x, y, wavelength, seed + 211)
    return np.asarray(x) + strength * dx, np.asarray(y) + strength * dy
