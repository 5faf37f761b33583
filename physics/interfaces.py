"""Area in which two kinds of matter touch, from the particles of one or both.

References:
    J. U. Brackbill, D. B. Kothe, C. Zemach, A continuum method for modeling surface tension, Journal of Computational Physics 100 (1992) 335,
    doi:10.1016/0021-9991(92)90240-Y: the gradient of a smoothed colour, whose integral across an interface is 1.
    J. P. Morris, Simulating surface tension with smoothed particle hydrodynamics, International Journal for Numerical Methods in Fluids 33
    (2000) 333: the same on particles.
    H. Wendland, Piecewise polynomial, positive definite and compactly supported radial functions of minimal degree, Advances in
    Computational Mathematics 4 (1995) 389: the kernel (1 - q)^4 (1 + 4 q) of two continuous derivatives.
"""

from __future__ import annotations

import numpy as np

from .arrays import F64

__all__ = ["SUPPORT", "facing_area", "kernel", "slope", "wetted_share"]

SUPPORT = 2.5
"""Own choice: radius of the kernel in spacings of particles: 65 neighbours."""


def kernel(distance: F64, radius: float) -> F64:
    """Kernel of a support of a radius [m] at distances [m]; its integral over space is 1 [1/m^3]."""
    q = np.minimum(distance / radius, 1.0)
    return np.asarray(21.0 / (2.0 * np.pi * radius**3) * (1.0 - q) ** 4 * (1.0 + 4.0 * q))


def slope(distance: F64, radius: float) -> F64:
    """Derivative of the kernel by the distance [1/m^4], never above 0."""
    q = np.minimum(distance / radius, 1.0)
    return np.asarray(-210.0 / (np.pi * radius**4) * q * (1.0 - q) ** 3)


def facing_area(volume: F64, gradient: F64) -> F64:
    """Area of the interface with another liquid that belongs to each particle [m^2], shape (n,).

    The interface lies in both liquids: its area is the sum over the particles of both, so that what curves towards one is no smaller.

    Args:
        volume: of the particles [m^3], shape (n,).
        gradient: sum over the other liquid's particles of their volume times the gradient of the kernel [1/m], shape (n, 3).
    """
    return np.asarray(volume * np.sqrt((gradient * gradient).sum(axis=1)))


def wetted_share(colour: F64) -> F64:
    """Share of pieces of a solid's surface that is wet: twice the smoothed colour there, since liquid is on one side of it, at most 1.

    Args:
        colour: sum over the liquid's particles of their volume times the kernel [1].
    """
    return np.asarray(np.clip(2.0 * colour, 0.0, 1.0))
