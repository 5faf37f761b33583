"""Input and step report of an engine of grains."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ...worlds.arrays import F64, I32
from ..boundaries import Boundary
from ..step_reports import StepReport

__all__ = ["GrainReport", "GrainSetup", "Kind", "Pair", "law_of", "wall_law"]


@dataclass(frozen=True)
class Kind:
    """Material of the grains of one entity."""

    name: str
    density: float
    """[kg/m^3]"""
    young: float
    """[Pa]"""
    poisson: float
    restitution: float
    friction: float
    rolling: float
    """Rolling resistance in effective radii."""
    cohesion: float
    """Energy of adhesion per area [J/m^2]."""


@dataclass(frozen=True)
class Pair:
    """Constants of a pair; see `law_kernels.Law`."""

    young: float
    shear: float
    damping: float
    friction: float
    rolling: float
    pull: float


def damping_of(restitution: float) -> float:
    """2 sqrt(5/6) beta of the damped Hertz oscillator that returns this share of the speed (Antypov, Elliott 2011)."""
    if restitution >= 1.0:
        return 0.0
    logarithm = math.log(max(restitution, 1e-6))
    return -2.0 * math.sqrt(5.0 / 6.0) * logarithm / math.hypot(logarithm, math.pi)


def law_of(a: Kind, b: Kind, *, friction: float | None = None, restitution: float | None = None) -> Pair:
    """Two kinds of grains: the larger friction and the smaller restitution hold, unless the pair has its own."""
    young = 1.0 / ((1 - a.poisson**2) / a.young + (1 - b.poisson**2) / b.young)
    shear = 1.0 / sum(2 * (2 - k.poisson) * (1 + k.poisson) / k.young for k in (a, b))
    return Pair(
        young=young,
        shear=shear,
        damping=damping_of(min(a.restitution, b.restitution) if restitution is None else restitution),
        friction=max(a.friction, b.friction) if friction is None else friction,
        rolling=max(a.rolling, b.rolling),
        pull=2.0 * math.pi * math.sqrt(a.cohesion * b.cohesion),
    )


def wall_law(kind: Kind, friction: float, restitution: float) -> Pair:
    """A kind against a surface that is as stiff as its grains."""
    wall = Kind("", kind.density, kind.young, kind.poisson, restitution, friction, kind.rolling, kind.cohesion)
    return law_of(kind, wall, friction=friction, restitution=restitution)


@dataclass(frozen=True)
class GrainSetup:
    """Grains at the start of the preroll, and what they may meet."""

    lower: F64
    upper: F64
    """Corners of the domain [m]; what leaves it is gone."""
    kinds: tuple[Kind, ...]
    position: F64
    """(n, 3) [m]"""
    velocity: F64
    radius: F64
    """(n,) [m]"""
    kind: I32
    gravity: F64
    boundaries: tuple[Boundary, ...] = ()
    centers: tuple[F64, ...] = ()
    """Centre of mass of each boundary's body in its frame."""
    pairs: dict[tuple[int, int], Pair] = field(default_factory=dict)
    """Laws of pairs of kinds that differ from `law_of`."""
    walls: dict[tuple[int, int], Pair] = field(default_factory=dict)
    """Laws of (boundary, kind); default: friction of the boundary, restitution of the kind."""
    step_share: float = 0.15
    """Step in units of the time in which a Rayleigh wave crosses the smallest grain."""
    device: str = "cpu"

    def __post_init__(self) -> None:
        assert np.asarray(self.position).shape == (len(self.radius), 3)


@dataclass(frozen=True, kw_only=True)
class GrainReport(StepReport):
    """One exchange of grains or flying particles."""

    blown: F64 = field(default_factory=lambda: np.zeros(3))
    """Impulse of fields per member (m, 3), or none (3,) [N s]."""
    work: float = 0.0
    """Work of fields [J]."""
    wall_work: float = 0.0
    """Work that the motion of bodies did on grains in contact [J]."""
    left: F64 = field(default_factory=lambda: np.zeros(5))
    """Totals that left the domain: number, mass [kg], momentum [N s] (5,)."""
    came: tuple[int, float] = (0, 0.0)
    """Number and mass [kg] of what was let in."""
    died: tuple[int, float] = (0, 0.0)
    """The same of what died."""
