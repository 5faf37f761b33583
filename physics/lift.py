"""Lift, drag and turning of bodies in a flow, between two published limits: compact debris and plates.

Wind engineers tell wind-borne bodies apart as compact ones, which have drag alone, rods and sheets (Wills, Lee and Wyatt 2002,
doi:10.1016/S0167-6105(01)00201-7). A body here lies between the first and the last by how flat its hull is.

References:
    Plates: the force acts along the normal; C_N = 1.7 a / 40 up to an angle of attack a of 40 degrees and 1.15 beyond, at a centre of pressure
    ahead of the middle by 0.3 - 0.22 a / 38 of the length up to 38 degrees and 0.08 cos(2 (a - 38)) beyond, as P. J. Richards, N. Williams,
    B. Laing, M. McCarty and M. Pond, Journal of Wind Engineering and Industrial Aerodynamics 96 (2008) 2188, doi:10.1016/j.jweia.2008.02.030,
    and B. Kordi and G. A. Kopp, Journal of Engineering Mechanics 135 (2009) 657, doi:10.1061/(ASCE)EM.1943-7889.0000008, use them for
    plates about as long as wide, after ESDU 70015 (1970). S. F. Hoerner, Fluid-Dynamic Drag (1965), chapter 3, has 1.17 for a square plate
    across the flow and the same stall near 40 degrees. These pages were not at hand when this was written: compare before you cite.
    Compact bodies: drag by the area that the hull shows, as `drag.py`.
    Resistance to turning: the plate's law by strips, each of which meets the flow past it (blade elements; H. Glauert, 1926).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import F64, I64
from .drag import FACINGS, gathering

__all__ = ["CENTRED", "PEAK", "Hull", "Hulls", "Wrench", "hull_of", "normal_share", "pressure_point", "stacked", "wrenches"]

ACROSS = 1.15
"""C_N of a plate across the flow, of which a declared coefficient takes the place."""
STALL = 40.0
"""[degrees] Angle of attack up to which C_N rises."""
FALLEN = 45.0
"""[degrees] Own choice: angle at which it has fallen to that of a plate across; the sources have a step at 40."""
PEAK = 1.7 / ACROSS
"""C_N at the stall over that across the flow."""
KNEE = 38.0
"""[degrees] Angle beyond which the centre of pressure comes back to the middle more slowly."""
CENTRED = 83.0
"""[degrees] Angle from which on it is in the middle."""
STRIPS = 0.375
"""Speed by which a plate resists its own turning in still air, over its length times its spin: the integral of |x|^3 over that of x^2."""
TINY = 1e-300


@dataclass(frozen=True)
class Hull:
    """Faces of the convex hull of a body, in its frame."""

    vectors: F64
    """Outward normals times areas [m^2], shape (m, 3)."""
    arms: F64
    """From the middle of the surface to those of the faces [m], shape (m, 3)."""
    center: F64
    """From the centre of mass to the middle of the surface [m], shape (3,)."""
    flatness: float
    """1 for a thin plate, 0 for what is as thick as wide: one less the second of the principal areas over the first."""
    spans: F64
    """Twelve times the variance of the surface's places [m^2], shape (3, 3): of a rectangle the squares of its lengths."""
    rolls: F64
    """Half the integral of (r x n)(r x n)^T over the surface, about its middle [m^4], shape (3, 3)."""
    surface: float
    """[m^2]"""
    length: float
    """Greatest of its lengths, as a rectangle has them [m]."""


@dataclass(frozen=True)
class Hulls:
    """Hulls of n bodies with m faces in all."""

    vectors: F64
    arms: F64
    owner: I64
    """Body of each face, shape (m,)."""
    center: F64
    flatness: F64
    spans: F64
    rolls: F64
    surface: F64
    length: F64

    def of(self, bodies: I64) -> Hulls:
        """Hulls of some of them, in ascending order."""
        if len(bodies) == len(self.surface):
            return self
        faces = np.isin(self.owner, bodies)
        own = np.searchsorted(bodies, self.owner[faces])
        rest = (v[bodies] for v in (self.center, self.flatness, self.spans, self.rolls, self.surface, self.length))
        return Hulls(self.vectors[faces], self.arms[faces], own, *rest)


@dataclass(frozen=True)
class Wrench:
    """Push of a medium on n bodies, world axes."""

    force: F64
    """[N], shape (n, 3)."""
    torque: F64
    """About the centres of mass, but for the resistance [N m], shape (n, 3)."""
    resistance: F64
    """Torque against a spin, per spin [N m s], shape (n, 3, 3)."""
    flow: F64
    """Velocity of the medium past the middles of the surfaces [m/s], shape (n, 3)."""

    def turning(self, spin: F64) -> F64:
        """The whole torque on bodies with a spin [N m], shape (n, 3)."""
        return np.asarray(self.torque - np.einsum("nij,nj->ni", self.resistance, spin))


def normal_share(degrees: F64) -> F64:
    """Normal force coefficient of a plate at angles of attack, over that of one across the flow."""
    return np.asarray(np.interp(degrees, [0.0, STALL, FALLEN], [0.0, PEAK, 1.0]))


def pressure_point(degrees: F64) -> F64:
    """Distance of the centre of pressure of a plate from its middle, into the flow, over its length."""
    near = 0.3 - 0.22 * degrees / KNEE
    far = 0.08 * np.cos(np.radians(2.0 * (np.minimum(degrees, CENTRED) - KNEE)))
    return np.asarray(np.where(degrees < KNEE, near, np.maximum(far, 0.0)))


def hull_of(vertices: F64, center: F64) -> Hull | None:
    """Hull of the vertices of a body whose centre of mass is `center` [m]; None where they enclose nothing."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(np.asarray(vertices, dtype=np.float64))
    except (QhullError, ValueError):
        return None
    corner, normal = hull.points[hull.simplices], hull.equations[:, :3]
    areas = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    surface = float(areas.sum())
    middle = (areas[:, None] * corner.mean(axis=1)).sum(axis=0) / surface
    corner = corner - middle
    sums = corner.sum(axis=1)
    # The second moment of a triangle about the middle is that of its corners and of their sum.
    second = (np.einsum("fci,fcj->fij", corner, corner) + sums[:, :, None] * sums[:, None, :]) * (areas / 12.0)[:, None, None]
    turned = np.zeros((len(areas), 3, 3))
    turned[:, 0, 1], turned[:, 1, 2], turned[:, 2, 0] = normal[:, 2], normal[:, 0], normal[:, 1]
    turned -= np.swapaxes(turned, 1, 2)
    spans = 12.0 * second.sum(axis=0) / surface
    rolls = 0.5 * np.einsum("fij,fjk,flk->il", turned, second, turned)
    principal = np.linalg.eigvalsh(np.einsum("f,fi,fj->ij", areas, normal, normal))
    vectors, arms = normal * areas[:, None], corner.mean(axis=1)
    if len(vectors) > FACINGS:
        vectors, arms = _gathered(normal, areas, arms)
    return Hull(
        vectors=vectors,
        arms=arms,
        center=middle - np.asarray(center, dtype=np.float64),
        flatness=float(1.0 - principal[1] / principal[2]),
        spans=spans,
        rolls=rolls,
        surface=surface,
        length=float(np.sqrt(np.linalg.eigvalsh(spans)[-1])),
    )


def _gathered(normal: F64, areas: F64, arms: F64) -> tuple[F64, F64]:
    """Faces gathered into `FACINGS` directions: vectors [m^2], on the whole of the same area, and their middles [m]."""
    where = gathering(normal)
    merged, middle, held = np.zeros((FACINGS, 3)), np.zeros((FACINGS, 3)), np.zeros(FACINGS)
    np.add.at(merged, where, normal * areas[:, None])
    np.add.at(middle, where, arms * areas[:, None])
    np.add.at(held, where, areas)
    return merged * (areas.sum() / np.linalg.norm(merged, axis=1).sum()), middle / np.maximum(held, TINY)[:, None]


def stacked(hulls: list[Hull]) -> Hulls:
    """Hulls of several bodies together; there is at least one."""
    return Hulls(
        vectors=np.concatenate([h.vectors for h in hulls]),
        arms=np.concatenate([h.arms for h in hulls]),
        owner=np.repeat(np.arange(len(hulls)), [len(h.vectors) for h in hulls]),
        center=np.array([h.center for h in hulls]),
        flatness=np.array([h.flatness for h in hulls]),
        spans=np.array([h.spans for h in hulls]),
        rolls=np.array([h.rolls for h in hulls]),
        surface=np.array([h.surface for h in hulls]),
        length=np.array([h.length for h in hulls]),
    )


def wrenches(hulls: Hulls, turns: F64, flow: F64, spin: F64, pressure: F64) -> Wrench:
    """Push of a medium on bodies.

    F = 1/2 rho C u^2 [(1 - s) A u/|u| + s sum of C_N(a)/C_N(90) dA (-n) over the faces that look into the flow], with s the flatness, A the
    area that the hull shows and a the angle of the flow to each face; at the faces' middles and, for a plate, ahead of them by the
    centre of pressure. The flow is that past the middle of the surface. What it takes from a spin are the same pressures on strips that meet it.
    With no spin the force never drives a body against the flow, and with any the power in the frame of the medium is none that it gains.

    Args:
        hulls: of the n bodies.
        turns: their orientations, shape (n, 3, 3).
        flow: velocity of the medium past their centres of mass [m/s], shape (n, 3).
        spin: world axes [rad/s], shape (n, 3).
        pressure: 1/2 rho C of the medium and the body [kg/m^3], shape (n,).
    """
    count, owner = len(turns), hulls.owner
    arm = np.einsum("nij,nj->ni", turns, hulls.center)
    past = flow - _cross(spin, arm)
    speed = np.linalg.norm(past, axis=1)
    way = np.einsum("nji,nj->ni", turns, past / np.maximum(speed, TINY)[:, None])
    along = -(hulls.vectors * way[owner]).sum(axis=1)
    size = np.linalg.norm(hulls.vectors, axis=1)
    share = normal_share(_angle(np.maximum(along, 0.0) / np.maximum(size, TINY)))
    loads = -share[:, None] * hulls.vectors
    plate, moment = (_sums(owner, v, count) for v in (loads, _cross(hulls.arms, loads)))
    shown = 0.5 * np.bincount(owner, weights=np.abs(along), minlength=count)
    moment += _cross(_ahead(hulls, plate, way), plate)
    whole, flat = pressure * speed**2, hulls.flatness
    force = whole[:, None] * ((1.0 - flat) * shown)[:, None] * way + (whole * flat)[:, None] * plate
    force, turning = (np.einsum("nij,nj->ni", turns, v) for v in (force, (whole * flat)[:, None] * moment))
    strips = 2.0 * speed + STRIPS * hulls.length * np.linalg.norm(spin, axis=1)
    resistance = (pressure * flat * strips)[:, None, None] * np.einsum("nij,njk,nlk->nil", turns, hulls.rolls, turns)
    return Wrench(force, turning + _cross(arm, force), resistance, past)


def _cross(a: F64, b: F64) -> F64:
    """Vector products of rows, as numpy's own in a tenth of its time for a few."""
    (x, y, z), (u, v, w) = a.T, b.T
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=1)


def _angle(sine: F64) -> F64:
    return np.degrees(np.arcsin(np.minimum(sine, 1.0)))


def _sums(owner: I64, values: F64, count: int) -> F64:
    """Sums of rows by owner, shape (n, 3)."""
    return np.stack([np.bincount(owner, weights=v, minlength=count) for v in values.T], axis=1)


def _ahead(hulls: Hulls, plate: F64, way: F64) -> F64:
    """From the middles of the faces to the centres of pressure [m], shape (n, 3): along the faces into the flow."""
    normal = plate / np.maximum(np.linalg.norm(plate, axis=1), TINY)[:, None]
    sine = (normal * way).sum(axis=1)
    along = way - sine[:, None] * normal
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-12)[:, None]
    length = np.sqrt(np.maximum(np.einsum("ni,nij,nj->n", along, hulls.spans, along), 0.0))
    return np.asarray(-(pressure_point(_angle(np.maximum(sine, 0.0))) * length)[:, None] * along)
