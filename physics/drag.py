"""Drag of a medium on bodies, faces and spheres.

References:
    Quadratic drag, F = 1/2 rho C A u^2: G. K. Batchelor, An Introduction to Fluid Dynamics (1967), section 5.11,
    doi:10.1017/CBO9780511800955.
    Spheres: G. G. Stokes (1851), F = 6 pi mu r u; the correction 1 + 0.15 Re^0.687 is by L. Schiller and A. Naumann, Zeitschrift des
    Vereines Deutscher Ingenieure 77 (1933) 318, and 0.44 is Newton's coefficient; both as in R. Clift, J. R. Grace and M. E. Weber,
    Bubbles, Drops and Particles (1978), table 5.1.
    Shown area of a convex body: half the sum of |n . u| dA, after A. Cauchy (1850).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .arrays import F64, I64

__all__ = [
    "FACINGS",
    "FaceDrag",
    "Medium",
    "area_vectors",
    "drag_force",
    "face_drag",
    "gathering",
    "projected_area",
    "sphere_drag_rate",
]

FACINGS = 128
"""Directions into which the faces of a body are gathered when it has more of them."""
NEWTON = 0.44
"""Drag coefficient of a sphere above `TURBULENT`."""
TURBULENT = 1000.0
"""Reynolds number from which on a sphere's drag is Newton's."""


@dataclass(frozen=True)
class Medium:
    """A gas or liquid at n points, through which things move."""

    velocity: F64
    """[m/s], shape (n, 3)."""
    density: F64
    """[kg/m^3], shape (n,); 0 where there is none."""
    viscosity: F64
    """Dynamic [Pa s], shape (n,)."""
    coefficient: F64
    """Drag coefficient of rigid bodies, shape (n,)."""

    def at(self, points: I64) -> Medium:
        """The medium at some of the points."""
        return Medium(self.velocity[points], self.density[points], self.viscosity[points], self.coefficient[points])


@dataclass(frozen=True)
class FaceDrag:
    """Forces of a medium on n faces."""

    force: F64
    """[N], shape (n, 3)."""
    rate: F64
    """Force over relative speed [kg/s], shape (n,)."""


def area_vectors(vertices: F64) -> F64:
    """Outward normals times areas [m^2] of the convex hull of a body, shape (at most `FACINGS`, 3), in the frame of the vertices."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(np.asarray(vertices, dtype=np.float64))
    except (QhullError, ValueError):
        return np.zeros((1, 3))
    corner = hull.points[hull.simplices]
    areas = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    found: F64 = hull.equations[:, :3] * areas[:, None]
    if len(found) <= FACINGS:
        return found
    merged = np.zeros((FACINGS, 3))
    np.add.at(merged, gathering(hull.equations[:, :3]), found)
    # Faces that are joined at an angle lose area; on the whole it stays.
    kept: F64 = merged * (areas.sum() / np.linalg.norm(merged, axis=1).sum())
    return kept


def gathering(normals: F64) -> I64:
    """Nearest of `FACINGS` directions, spread evenly over a sphere, to each normal, shape (n, 3) -> (n,)."""
    step = np.arange(FACINGS) + 0.5
    height, turn = 1.0 - 2.0 * step / FACINGS, step * math.pi * (1.0 + math.sqrt(5.0))
    ring = np.sqrt(1.0 - height**2)
    directions = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    return np.asarray(np.argmax(normals @ directions.T, axis=1))


def projected_area(vectors: F64, owner: I64, turns: F64, flow: F64) -> F64:
    """Area that each of n convex bodies shows to its flow [m^2], shape (n,).

    Args:
        vectors: normals times areas of all bodies in their frames, shape (m, 3).
        owner: body of each, shape (m,).
        turns: orientation of the bodies, shape (n, 3, 3).
        flow: velocity relative to the body, shape (n, 3); its length does not matter.
    """
    speed = np.linalg.norm(flow, axis=1)
    local = np.einsum("nji,nj->ni", turns, flow / np.maximum(speed, 1e-300)[:, None])
    seen = 0.5 * np.bincount(owner, weights=np.abs((vectors * local[owner]).sum(axis=1)), minlength=len(turns))
    return seen.astype(np.float64)


def drag_force(medium: Medium, area: F64, velocity: F64) -> F64:
    """Drag on bodies [N], shape (n, 3): 1/2 rho C A |u| u along the relative flow u.

    Args:
        medium: at the bodies.
        area: A that they show to the flow [m^2], shape (n,).
        velocity: of the bodies [m/s], shape (n, 3).
    """
    flow = medium.velocity - velocity
    speed = np.linalg.norm(flow, axis=1)
    result: F64 = (0.5 * medium.density * medium.coefficient * area * speed)[:, None] * flow
    return result


def face_drag(medium: Medium, corners: F64, velocity: F64) -> FaceDrag:
    """Drag on the faces of a closed surface that face the flow: the law of `drag_force`, by the area that each shows.

    Args:
        medium: at the centres of the faces.
        corners: of outward triangles [m], shape (n, 3, 3).
        velocity: of their centres [m/s], shape (n, 3).
    """
    vector = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flow = medium.velocity - velocity
    speed = np.linalg.norm(flow, axis=1)
    shown = np.maximum(-(vector * flow).sum(axis=1) / np.maximum(speed, 1e-300), 0.0)
    return FaceDrag(drag_force(medium, shown, velocity), 0.5 * medium.density * medium.coefficient * shown * speed)


def sphere_drag_rate(medium: Medium, radius: F64, mass: F64, velocity: F64) -> F64:
    """Rate at which a medium takes the relative velocity of spheres [1/s], shape (n,): drag over mass and relative speed.

    6 pi mu r (1 + 0.15 Re^0.687) up to the Reynolds number Re = 2 rho r u / mu of 1000, then Newton's 1/2 rho 0.44 pi r^2 u. At
    their meeting the coefficient is continuous within 0.4 %.

    Args:
        medium: at the spheres.
        radius: r [m], shape (n,).
        mass: [kg], shape (n,).
        velocity: [m/s], shape (n, 3).
    """
    speed = np.linalg.norm(medium.velocity - velocity, axis=1)
    stokes = 6.0 * np.pi * medium.viscosity * radius
    number = 2.0 * medium.density * speed * radius / np.maximum(medium.viscosity, 1e-12)
    corrected = stokes * (1.0 + 0.15 * np.minimum(number, TURBULENT) ** 0.687)
    inertial = 0.5 * NEWTON * np.pi * radius**2 * medium.density * speed
    drag = np.where(number > TURBULENT, np.maximum(inertial, 0.0), np.maximum(corrected, 0.0))
    result: F64 = np.where(medium.density > 0, drag, 0.0) / mass
    return result
